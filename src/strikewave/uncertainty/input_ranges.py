"""The range of each input of a case: as stated, or a default by its provenance and its field.

A stated tolerance counts as it stands. Without one, what was measured, published, or typed by the user is known to half
a unit of its last digit, and to 1 % at best; what was inferred, fitted or assumed to the share of `DEFAULTS`. A field
that nobody can weigh or read off (`strikewave.cases.plausible`) keeps its plausible range while its value is assumed or
the user's, whatever tolerance stands there: it says how a machine scatters about a value that nobody knows. To narrow
it, mark the value as measured. A fitted value whose fit no longer applies is an assumed one. What a named material
stands for (`strikewave.cases.materials_of_case`) is known as its table has it, and as pieces of it differ.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from strikewave.base.quantities import AUTO, TRUNCATION, Range, Value
from strikewave.base.units import take_apart
from strikewave.cases.case import Case
from strikewave.cases.contact_of_case import automatic_pressures
from strikewave.cases.materials_of_case import named_numbers
from strikewave.cases.paths import row_name
from strikewave.cases.plausible import NOT_MOVED, PLAUSIBLE, GoesWith, PlausibleRange
from strikewave.cases.tables.machine import LaunchedTable
from strikewave.uncertainty.draws import (
    FELT,
    OF_EACH_STRIKER,
    STATED,
    Shape,
    UncertainInput,
    drawn_strikers,
    range_of,
    stated,
    within,
)

UNSTATED, PLAUSIBLE_BASIS = "no tolerance stated", "plausible range"
"""Bases of inputs whose case states no tolerance, and of those that nobody can weigh or read off."""
FITTED_BASIS = "standard error of its fit"
"""Basis of an input that was fitted to measurements which fix it that well."""
NAMED_BASIS = "table of materials"
"""Basis of an input that a named material stands for."""
LEAST = 0.01
"""Least half width of what was measured, as a share: scales, gauges and tachometers of a test house keep 1 % together
with whoever reads them, however many digits are typed."""
MOST = 0.10
"""Most that the last digit typed stands for, as a share: who types 1 kg does not mean half a kilogram."""
DEFAULTS = {
    "measured": (LEAST, "measured: half a unit of its last digit, at least 1 %"),
    "published": (LEAST, "published: half a unit of its last digit, at least 1 %"),
    "user": (LEAST, "typed by the user: half a unit of its last digit, at least 1 %"),
    "inferred": (0.05, "inferred: from numbers of 1 to 2 % each by a relation that is nearly true"),
    "fitted": (0.05, "fitted: as well as a shock accelerometer reads what it was fitted to"),
    "assumed": (0.10, "assumed: nobody has weighed or measured it"),
}
"""Half width of a value without tolerance, as a share of it, and why, by its provenance."""
BY_DIGITS = ("measured", "published", "user")
"""Provenances of values whose last digit counts."""
UNKNOWN = ("assumed", "user")
"""Provenances of values that are in their plausible range at least, where the field has one."""
UNIFORM: Shape = "uniform"
JITTER = 1e-9  # added to the variances of a correlation, so that two inputs that always go together have a factor


def known_inputs(case: Case, tables: Sequence[str] = FELT) -> tuple[UncertainInput, ...]:
    """Return every input of a case that moves within what is known of it, by path; of a stale fit nothing is known.

    Parameters
    ----------
    case : Case
        Case of a machine, or of a bar alone.
    tables : sequence of str, optional
        Tables that the results depend on.

    Examples
    --------
    >>> from strikewave import load_case
    >>> known = {row.path: row for row in known_inputs(load_case("li-ma-2019", ["machine.engagement=5 mm"]))}
    >>> engagement = known["machine.engagement"]
    >>> engagement.basis, round(engagement.low, 6), round(engagement.high, 6)
    ('plausible range', 0.0025, 0.0075)
    """
    inputs = []
    goes_with = case.machine.goes_with() if isinstance(case.machine, LaunchedTable) else {}
    fitted = _fitted_inputs(case)
    for path, value in sorted(case.with_stale_fits_assumed().values().items()):
        if path.partition(".")[0] in tables:
            is_fitted = path in fitted and value.provenance == "fitted" and value.tolerance is None
            known = fitted[path] if is_fitted else known_input(case, path, value)
            if known is not None:
                known = _going_with(known, goes_with)
                inputs += [known] * (known.high > known.low)
    return (*inputs, *_material_inputs(case, tables), *_pressure_inputs(case, tables))


def _material_inputs(case: Case, tables: Sequence[str]) -> Iterator[UncertainInput]:
    """Yield the numbers that named materials stand for, each drawn once for all parts that take it."""
    for path, number in sorted(named_numbers(case).items()):
        fields = tuple(field for field in number.fields if field.partition(".")[0] in tables)
        if not fields or field_of(case, fields[0]) in NOT_MOVED:
            continue
        value, allowed = number.value, range_of(case, fields[0])
        if number.plausible is not None:
            low, high, shape = _plausible_ends(value, allowed, number.plausible)
            reason = number.plausible.reason
        else:
            share, known = default_share(value)
            low, high, shape = *within(allowed, value.si * (1.0 - share), value.si * (1.0 + share)), UNIFORM
            reason = f"±{100.0 * share:.2g} %, {known}"
        reason = f"{value.note}; {reason}"
        yield UncertainInput(path, value, allowed, low, high, shape, basis=NAMED_BASIS, reason=reason, sets=fields)


def _pressure_inputs(case: Case, tables: Sequence[str]) -> Iterator[UncertainInput]:
    """Yield the pressures at which contacts yield that follow from named materials."""
    for path, pressure in automatic_pressures(case).items():
        if path.partition(".")[0] in tables:
            value = Value(si=pressure.best, typed=f"{pressure.best / 1e9:.4g} GPa", provenance="inferred")
            yield UncertainInput(
                path,
                value,
                range_of(case, path),
                pressure.low,
                pressure.high,
                "log-uniform",
                basis=NAMED_BASIS,
                reason=f'"{AUTO}", by the softer material: from its hardness up to a metal that piles up or hardens',
                sets=(path,),
            )


def _fitted_inputs(case: Case) -> dict[str, UncertainInput]:
    """Return the inputs whose fit says how well it fixes them, normal and correlated as it says, by path."""
    inputs, values = dict[str, UncertainInput](), case.values()
    for fit in case.fit:
        order = list(fit.standard_error)
        rows = np.array(fit.correlation) if fit.correlation else np.eye(len(order))
        factor = np.linalg.cholesky(rows + JITTER * np.eye(len(rows)))
        factor = factor / np.linalg.norm(factor, axis=1, keepdims=True)
        for place, path in enumerate(order):
            if path not in values:
                continue
            allowed, value = range_of(case, path), values[path]
            error = Range(allowed.unit).read(fit.standard_error[path]).si
            reach = error * TRUNCATION
            low, high = within(allowed, value.si - reach, value.si + reach)
            weights = tuple((order[k], float(factor[place, k])) for k in range(place) if factor[place, k])
            reason = f"fitted to {fit.to}" if fit.to else "fitted"
            inputs[path] = UncertainInput(
                path, value, allowed, low, high, "normal", error, FITTED_BASIS, reason, fitted_with=weights
            )
    return inputs


def _going_with(known: UncertainInput, goes_with: Mapping[str, GoesWith]) -> UncertainInput:
    """Return an input with the others from the same drawing, which err together with it.

    A measured quantity, or one with a tolerance of its own, errs apart from them.
    """
    others = goes_with.get(known.path)
    if others is None or known.basis == STATED or known.value.provenance == "measured":
        return known
    names = ", ".join(path.rpartition(".")[2] for path in others.powers)
    return dataclasses.replace(
        known,
        low=max(known.low, others.least),
        high=max(known.high, others.least),
        reason=f"{known.reason}; at the values of {names} in the case, with which it changes",
        goes_with=tuple(others.powers.items()),
    )


def known_input(case: Case, path: str, value: Value) -> UncertainInput | None:
    """Return the range of a quantity of a case; None where it is a choice, or 0 without a range of its own."""
    allowed, field = range_of(case, path), field_of(case, path)
    if allowed.unit == "count" or field in NOT_MOVED:
        return None
    strikers = drawn_strikers(case, path)
    if strikers == ():
        return None
    plausible = PLAUSIBLE.get(field)
    by_tolerance = None if value.tolerance is None else stated(path, value, allowed, strikers or ())
    if plausible is not None and value.provenance in UNKNOWN:
        low, high, shape = _plausible_ends(value, allowed, plausible)
        each = (strikers or ()) if plausible.each else ()  # what is unknown of all strikers is drawn once
        by_field = UncertainInput(
            path, value, allowed, low, high, shape, basis=PLAUSIBLE_BASIS, reason=plausible.reason, strikers=each
        )
        if by_tolerance is None or (by_field.width > by_tolerance.width and not plausible.each):
            return by_field
    if by_tolerance is not None or value.si == 0.0:
        return by_tolerance
    share, reason = default_share(value)
    half = share * abs(value.si)
    low, high = within(allowed, value.si - half, value.si + half)
    return UncertainInput(path, value, allowed, low, high, basis=UNSTATED, reason=f"±{100.0 * share:.2g} %, {reason}")


def field_of(case: Case, path: str) -> str:
    """Return the path of a quantity without the names of rows: the field that all rows share.

    Examples
    --------
    >>> from strikewave import load_case
    >>> field_of(load_case("li-ma-2019-fig13"), "stack.joint.nose.stiffness")
    'stack.joint.stiffness'
    """
    table, *places = path.split(".")
    part, keys = getattr(case, table), [table]
    for place in places:
        if isinstance(part, tuple):
            part = next(row for k, row in enumerate(part) if row_name(row, k) == place)
        else:
            part = getattr(part, place)
            keys.append(place)
    field = ".".join(keys)
    if field.startswith("striker.each."):
        return next((of_all for of_all, own in OF_EACH_STRIKER.items() if own == keys[-1]), field)
    return field


def default_share(value: Value) -> tuple[float, str]:
    """Return the half width of a value without tolerance as a share of it, and why.

    Examples
    --------
    >>> [default_share(Value(si=1.0, typed=typed, provenance="user"))[0] for typed in ("1.25 kg", "8 mm", "730 rpm")]
    [0.01, 0.0625, 0.01]
    """
    share, reason = DEFAULTS[value.provenance]
    if value.provenance in BY_DIGITS:
        share = min(max(share, half_a_digit(value.typed)), MOST)
    return share, reason


def half_a_digit(typed: str | float) -> float:
    """Return half a unit of the last digit typed as a share of the number; 0 where the text is no quantity.

    Examples
    --------
    >>> half_a_digit("1.25 kg"), half_a_digit("8 mm"), half_a_digit(0.5), half_a_digit("2e3 N")
    (0.004, 0.0625, 0.1, 0.25)
    """
    parts = take_apart(typed)
    mantissa = "" if parts is None else parts.number.lower().partition("e")[0].lstrip("+-")
    number = float(mantissa or 0.0)
    return 0.5 * 10.0 ** -len(mantissa.partition(".")[2]) / number if number else 0.0


def _plausible_ends(value: Value, allowed: Range, plausible: PlausibleRange) -> tuple[float, float, Shape]:
    """Return the ends of the plausible range of a field, SI, and how it is drawn between them."""
    low, high = within(allowed, *plausible.ends(value.si))
    return low, high, "log-uniform" if plausible.form == "factor" and low > 0.0 else UNIFORM
