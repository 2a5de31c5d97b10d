"""Bands as they are shown: in words, a table of results with their ranges, and one of what is known of the inputs."""

from __future__ import annotations

import re
from collections.abc import Mapping

from strikewave.base.result import Band, BandMethod, MovedInput, Result
from strikewave.base.units import in_unit
from strikewave.reporting.numbers import band_text, listed, percent, spelled, with_band
from strikewave.reporting.parts import NONE, Cell, Section, Table, written

BAND_HEADS = ("result", "value and range", "inputs that matter most, with their shares", "rest")
"""Heads of the table of bands on the screen."""
MOVED_HEADS = ("input", "as typed", "from", "to", "what is known", "why")
"""Heads of the table of inputs."""
BAND_UNITS = {
    "rigid_peak": ("m/s^2", "g"),
    "peak": ("m/s^2", "g"),
    "peak_acceleration": ("m/s^2", "g"),
    "width": ("s", "us"),
    "interval": ("s", "ms"),
    "velocity_change": ("m/s", "m/s"),
    "peak_velocity": ("m/s", "m/s"),
    "peak_force": ("N", "kN"),
    "peak_stress": ("Pa", "MPa"),
}
"""SI unit of a result with a band and the unit in which it is shown as a rule, by the last part of its name."""
NO_BAND_OF_ELEMENTS = (
    "No band: it would take dozens of runs like this one, minutes each. How far the inputs move the result is seen in "
    "the band of the same bodies as a machine or a layered bar."
)
"""Why a run of finite elements has no band."""
_UNIT = re.compile(r"[^\W\d_][^\d]*.*$|%$")
"""Unit of a quantity as it was typed."""


def band_words(bands: Mapping[str, Band]) -> list[str]:
    """Say what the bands beside the key numbers are, and what the first one depends on; nothing without bands."""
    if not bands:
        return []
    name, band = next(iter(bands.items()))
    most = listed([f"{one.field} ({percent(one.share, 0)})" for one in band.inputs])
    depends = f" What moves the {band_label(name)} most, with its share of the variance: {most}." if most else ""
    return [
        f"In brackets: the range of {percent(band.level, 0)} of all results when inputs move within what is known of "
        f"them; the model's own error is not in it.{depends}"
    ]


def band_label(name: str) -> str:
    """Say in words what a result with a band is called.

    Examples
    --------
    >>> band_label("first.rigid_peak"), band_label("sensor.buffered.peak"), band_label("interval")
    ('rigid peak of the first blow', 'peak of sensor buffered', 'interval of the blows, median')
    """
    where, _, quantity = name.rpartition(".")
    if not where:
        return {"interval": "interval of the blows, median"}.get(name, name.replace("_", " "))
    words = {"first": "the first blow", "typical": "later blows, median"}.get(where, where.replace(".", " "))
    return f"{quantity.replace('_', ' ')} of {words}"


def units_of(name: str) -> tuple[str, str]:
    """Return the SI unit of a result with a band, and the one in which it is shown as a rule.

    Examples
    --------
    >>> units_of("first.rigid_peak"), units_of("interval"), units_of("tap.end.peak_velocity")
    (('m/s^2', 'g'), ('s', 'ms'), ('m/s', 'm/s'))
    """
    return BAND_UNITS[name.rpartition(".")[2]]


def band_rows(result: Result, values: Mapping[str, float]) -> list[list[str]]:
    """Return a row for each result with a band: its name, its value with the range, the inputs, and the rest.

    Parameters
    ----------
    result : Result
        With bands.
    values : mapping of str to float
        The results themselves, SI, by the names of the bands.
    """
    return [
        [
            band_label(name),
            with_band(values.get(name), band, *units_of(name)),
            ", ".join(_shares(band)) or NONE,
            _rest(result, name),
        ]
        for name, band in result.band.items()
    ]


def _shares(band: Band) -> list[str]:
    return [f"{one.field} {percent(one.share, 0)}" for one in band.inputs]


def _rest(result: Result, name: str) -> str:
    """Return the share of the variance of a result that no input makes by itself."""
    rest = {} if result.band_method is None else result.band_method.rest
    return percent(rest[name], 0) if name in rest else NONE


def band_sections(result: Result) -> list[Section]:
    """List the band of each result, the inputs that matter most, and what is known of each; nothing without bands."""
    if not result.band:
        return []
    most = max(len(band.inputs) for band in result.band.values())
    rows: list[list[Cell]] = []
    for name, band in result.band.items():
        inputs, ends = _shares(band), band_text(band, *units_of(name))
        rows.append([band_label(name), ends, *inputs, *[NONE] * (most - len(inputs)), _rest(result, name)])
    heads = ["result", "range", *(f"{nth} input" for nth in ("largest", "second", "third", "fourth", "fifth")[:most])]
    tables = [Table("Ranges and the inputs that matter most", [*heads, "rest"], rows)]
    text = (
        "A share is that of an input, by itself, in the variance of the result; the rest is what inputs make together, "
        "and what the fit does not explain. The model's own error is not in these ranges."
    )
    method = result.band_method
    if method is not None:
        text = f"The ranges hold {method.words()}. {text}" + _rank_words(method)
        tables.append(Table("What is known of the inputs", list(MOVED_HEADS), moved_rows(method)))
    return [Section("What the results depend on", text, tables)]


def _rank_words(method: BandMethod) -> str:
    """Say of which results the shares are those in the variance of their ranks."""
    named = [band_label(name) for name in method.ranked]
    return f" For {listed(named)}, whose few outliers hide the rest, it is the variance of the ranks." if named else ""


def moved_rows(method: BandMethod) -> list[list[Cell]]:
    """Return a row for each input that moved: its range, in the unit in which it was typed."""
    return [[one.field, str(one.typed), *_ends(one), one.basis, one.reason] for one in method.inputs]


def _ends(one: MovedInput) -> list[str]:
    """Return the ends of the range of an input with its unit."""
    found = _UNIT.search(str(one.typed))
    unit = found[0] if found and one.unit else one.unit
    ends = (in_unit(end, one.unit, unit) if unit else end for end in (one.low, one.high))
    return [f"{written(float(end), 4)} {spelled(unit)}".strip() for end in ends]
