"""[[fit]]: what values of a case were fitted to, and the fields that they were fitted under, with their values then."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import NamedTuple

from pydantic import Field

from strikewave.base.errors import InputError, nearest
from strikewave.base.quantities import Value
from strikewave.cases.paths import Form
from strikewave.cases.provenance import SAME
from strikewave.cases.tables import CaseTable

NONE = "none"
"""Stands for a field, or a table, that the case did not have when it was fitted."""


class FitTable(CaseTable):
    """[[fit]]: the ``fields`` fitted ``to`` what, and ``under`` which values of fields the result depends on.

    Among the fields of ``under`` are the fitted ones; "none" stands for a field or table that was left out. Where one
    differs, the fit no longer applies.
    """

    fields: tuple[str, ...] = Field(min_length=1)
    to: str = ""
    under: dict[str, str | int | float] = Field(min_length=1)


class ChangedField(NamedTuple):
    """A field that differs from what it was under a fit: its path, what it was then, what it is now, as typed."""

    path: str
    then: str
    now: str


class StaleFit(NamedTuple):
    """A value whose fit no longer applies: its path, what it was fitted to, and the fields that changed since."""

    field: str
    to: str
    changed: tuple[ChangedField, ...]

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
    for name, then in fit.under.items():
        *places, key = name.split(".")
        if key not in form.keys_at(places):
            raise InputError(f"{path}.under", name, f"a field of the {form.name}", _like(name, form))
        allowed = form.range_at([*places, key])
        if allowed is not None and then != NONE:
            try:
                allowed.read(then)
            except InputError as error:
                raise InputError(f"{path}.under.{name}", error.got, error.allowed, error.hint) from None


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
