"""Bands as they are shown: a table of results with their ranges, and one of what is known of the inputs."""

from __future__ import annotations

import re
from collections.abc import Mapping

from strikewave.base.result import BandMethod, MovedInput, Result
from strikewave.base.units import in_unit
from strikewave.reporting.numbers import listed, percent, spelled, with_band
from strikewave.reporting.parts import Cell, Section, Table, written

BAND_HEADS = ("result", "value and range", "inputs that matter most, with their shares", "rest")
"""Heads of the table of bands."""
MOVED_HEADS = ("input", "as typed", "from", "to", "what is known", "why")
"""Heads of the table of inputs."""
_UNIT = re.compile(r"[^\W\d_][^\d]*.*$|%$")
"""Unit of a quantity as it was typed."""
SHOWN = {"peak": ("m/s^2", "g"), "acceleration": ("m/s^2", "g"), "width": ("s", "us"), "interval": ("s", "ms")}
SHOWN |= {"velocity_change": ("m/s", "m/s"), "velocity": ("m/s", "m/s"), "force": ("N", "kN")}
"""SI unit of a result with a band, and the one in which it is shown as a rule, by how its name ends."""


def units_of(name: str) -> tuple[str, str]:
    """Return the SI unit of a result with a band, and the one in which it is shown as a rule.

    Examples
    --------
    >>> units_of("first.rigid_peak"), units_of("interval"), units_of("tap.end.peak_velocity")
    (('m/s^2', 'g'), ('s', 'ms'), ('m/s', 'm/s'))
    """
    return next(SHOWN[end] for end in sorted(SHOWN, key=len, reverse=True) if name.endswith(end))


def band_rows(result: Result, values: Mapping[str, float]) -> list[list[Cell]]:
    """Return a row for each result with a band: its name, its value with the range, the inputs, and the rest.

    Parameters
    ----------
    result : Result
        With bands.
    values : mapping of str to float
        The results themselves, SI, by the names of the bands.
    """
    rest = {} if result.band_method is None else result.band_method.rest
    return [
        [
            name.replace(".", " ").replace("_", " "),
            with_band(values.get(name), band, *units_of(name)),
            ", ".join(f"{one.field} {percent(one.share, 0)}" for one in band.inputs) or "none",
            percent(rest.get(name, 0.0), 0),
        ]
        for name, band in result.band.items()
    ]


def moved_rows(method: BandMethod) -> list[list[Cell]]:
    """Return a row for each input that moved: its range, in the unit in which it was typed."""
    return [[one.field, str(one.typed), *_ends(one), one.basis, one.reason] for one in method.inputs]


def _ends(one: MovedInput) -> list[str]:
    """Return the ends of the range of an input with its unit."""
    found = _UNIT.search(str(one.typed))
    unit = found[0] if found and one.unit else one.unit
    ends = (in_unit(end, one.unit, unit) if unit else end for end in (one.low, one.high))
    return [f"{written(float(end), 4)} {spelled(unit)}".strip() for end in ends]


def band_section(result: Result, values: Mapping[str, float]) -> list[Section]:
    """Return the section of a page on bands; none where there are none."""
    method = result.band_method
    if not result.band or method is None:
        return []
    text = (
        f"{method.words().capitalize()}. A share is that of an input in the variance of the result, by itself; the "
        "rest is what inputs make together, and what no polynomial in them explains."
        + (f" Of {listed(list(method.ranked))} it is the variance of the ranks." if method.ranked else "")
    )
    tables = [
        Table("Results and their ranges", list(BAND_HEADS), band_rows(result, values)),
        Table("What is known of the inputs", list(MOVED_HEADS), moved_rows(method)),
    ]
    return [Section("How far the results may be off", text, tables)]
