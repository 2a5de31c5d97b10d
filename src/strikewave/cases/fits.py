"""[[fit]]: what values of a case were fitted to, and the fields that they were fitted under, with their values then."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import NamedTuple

from pydantic import Field

from strikewave.base import declare
from strikewave.base.declare import KEY
from strikewave.base.errors import InputError, nearest
from strikewave.base.quantities import Range, Value
from strikewave.cases.paths import Form
from strikewave.cases.provenance import SAME
from strikewave.cases.tables.base import CaseTable

NONE = "none"
"""Stands for a field, or a table, that the case did not have when it was fitted."""


class FitTable(CaseTable):
    """[[fit]]: the ``fields`` fitted ``to`` what, and ``under`` which values of fields the result depends on.

    Among the fields of ``under`` are the fitted ones; "none" stands for a field or table that was left out. Where one
    differs, the fit no longer applies. ``standard_error`` holds that of each field that the data fix, and
    ``correlation`` a row for each of them; ``records`` the SHA-256 of the files by their names.
    """

    fields: tuple[str, ...] = Field(min_length=1)
    to: str = ""
    under: dict[str, str | int | float] = Field(min_length=1)
    standard_error: dict[str, str | int | float] = Field(default_factory=dict)
    correlation: tuple[tuple[float, ...], ...] = ()
    records: dict[str, str] = Field(default_factory=dict)


class ChangedField(NamedTuple):
    """A field that differs from what it was under a fit: its path, what it was then, what it is now, as typed."""

    path: str
    then: str
    now: str


@declare.dataclass
class StaleFit:
    """A value whose fit no longer applies: its path, what it was fitted to, and the fields that changed since."""

    field: str = declare.word("path of the fitted value", column=KEY)
    to: str
    changed: tuple[ChangedField, ...]

    @declare.computed(declare.word("paths of the fields under which it was fitted and that differ now", key="changed"))
    def changed_paths(self) -> list[str]:
        """The paths of what changed."""
        return [change.path for change in self.changed]

    @property
    def since(self) -> str:
        """That it no longer applies, and why, in words."""
        listed = ", ".join(f"{path} ({now}, then {then})" for path, then, now in self.changed)
        return f"fit no longer applies: {listed} changed"


def check_fit(fit: FitTable, form: Form, path: str) -> None:
    """Refuse a fit that names what is no field, or gives one what it cannot be.

    Raises
    ------
    InputError
        If so.
    """
    for name in fit.fields:
        if form.range_at(name.split(".")) is None:
            raise InputError(f"{path}.fields", name, f"a quantity of the {form.name}", _like(name, form))
    for name, size in fit.standard_error.items():
        if name not in fit.fields:
            raise InputError(f"{path}.standard_error", name, "one of its fields", nearest(name, fit.fields))
        _check_error(f"{path}.standard_error.{name}", form, name, size)
    rows, count = fit.correlation, len(fit.standard_error)
    square = len(rows) == count and all(len(row) == count for row in rows)
    if rows and not (square and _is_correlation(rows)):
        words = f"{count} rows of {count} numbers from -1 to 1, those of a correlation of the standard errors"
        raise InputError(f"{path}.correlation", str(rows), words)
    for name, then in fit.under.items():
        *places, key = name.split(".")
        if key not in form.keys_at(places):
            raise InputError(f"{path}.under", name, f"a field of the {form.name}", _like(name, form))
        allowed = form.range_at([*places, key])
        if allowed is not None and then != NONE:
            try:
                allowed.read(then)
            except InputError as error:
                raise error.at(f"{path}.under.{name}") from None


def _check_error(path: str, form: Form, name: str, error: str | int | float) -> None:
    """Refuse a standard error that is none above 0 in the unit of its field."""
    allowed = form.range_at(name.split("."))
    unit = "" if allowed is None else allowed.unit
    try:
        Range(unit, 0.0, open_low=True).read(error)
    except InputError as wrong:
        raise wrong.at(path) from None


def _is_correlation(rows: tuple[tuple[float, ...], ...]) -> bool:
    """Tell whether rows are those of a correlation: ones on the diagonal, symmetric, of no negative variance."""
    import numpy as np

    matrix = np.array(rows)
    alike = np.allclose(matrix, matrix.T, atol=1e-6) and np.allclose(np.diag(matrix), 1.0, atol=1e-6)
    return bool(alike and np.all(np.abs(matrix) <= 1.0 + 1e-9) and np.linalg.eigvalsh(matrix)[0] > -1e-6)


def _like(name: str, form: Form) -> str:
    *places, key = name.split(".")
    return nearest(key, form.keys_at(places))


def changed_since(
    fit: FitTable, entries: Mapping[str, float | str], values: Mapping[str, Value], form: Form
) -> Iterator[ChangedField]:
    """Yield the fields that differ from what they were under a fit.

    Parameters
    ----------
    fit : FitTable
        A checked one.
    entries : mapping of str to float or str
        Every quantity (SI) and choice of the case now.
    values : mapping of str to Value
        Every quantity of the case now.
    form : Form
        Of the case.
    """
    for path, then in fit.under.items():
        now = entries.get(path)
        if then == NONE and now is None:
            if any(entry.startswith(f"{path}.") for entry in entries):
                yield ChangedField(path, NONE, "given")
        elif now is None or not _same(now, then, path, form):
            typed = str(values[path].typed) if path in values else NONE if now is None else str(now)
            yield ChangedField(path, str(then), typed)


def _same(now: float | str, then: str | float, path: str, form: Form) -> bool:
    """Tell whether an entry, in SI or a choice, is what was typed then."""
    if isinstance(now, str):
        return now == then
    allowed = form.range_at(path.split("."))
    read = None if allowed is None or then == NONE else allowed.read(then)
    return isinstance(read, Value) and math.isclose(read.si, now, rel_tol=SAME)
