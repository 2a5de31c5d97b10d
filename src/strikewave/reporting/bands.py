"""Bands on faces: numbers with their ranges in sentences and tables, and the ranges of the inputs."""

from __future__ import annotations

import dataclasses
import math
from collections import Counter
from collections.abc import Iterable, Mapping

from strikewave.base.constants import MATERIAL
from strikewave.base.declare import banded_quantities
from strikewave.base.result import Band, BandMethod, Notice, Result
from strikewave.base.texts import percent, rounded
from strikewave.base.units import in_unit, take_apart
from strikewave.reporting.numbers import (
    decimals_of,
    fixed,
    listed,
    share_with_error,
    shown,
    shown_unit,
    spelled,
    with_unit,
)
from strikewave.reporting.parts import NONE, Cell, Section, Table, written

TWO_DIGITS_BELOW = 3.0  # rounding then moves an end by a sixth of the half width at most
"""Leading digits of a half width below which the ends of a band have two digits, others one."""
MOST_DIGITS = 4  # the balances hold to 1e-6, but nobody measures a shock so well
"""Significant digits of a result with a narrow band."""


def decimals_within(low: float, high: float) -> int:
    """Return the decimals that the ends of a band keep; below 0 for tens, hundreds and so on.

    Examples
    --------
    >>> decimals_within(800.0, 1570.0), decimals_within(0.98, 1.26), decimals_within(4151.2, 4151.4)
    (-2, 2, 0)
    """
    half, largest = 0.5 * abs(high - low), max(abs(low), abs(high))
    if not (math.isfinite(half) and largest > 0.0):
        return MOST_DIGITS - 1
    finest = MOST_DIGITS - 1 - math.floor(math.log10(largest))
    if half == 0.0:
        return finest
    place = math.floor(math.log10(half))
    return min(finest, -place + (1 if half / 10.0**place < TWO_DIGITS_BELOW else 0))


def decimals_beside(low: float, high: float) -> int:
    """Return the decimals of a number beside its band: one more than the ends have, `MOST_DIGITS` digits at most.

    What is not known of the inputs moves all that is shown together, so that numbers that differ are told apart by it.

    Examples
    --------
    >>> decimals_beside(800.0, 1570.0), decimals_beside(0.98, 1.26), decimals_beside(4151.2, 4151.4)
    (-1, 3, 0)
    """
    largest = max(abs(low), abs(high))
    within = decimals_within(low, high)
    return min(within + 1, MOST_DIGITS - 1 - math.floor(math.log10(largest))) if largest > 0.0 else within


def table_decimals(bands: Iterable[Band], si: str, usual: str, decimals: int = MOST_DIGITS) -> int:
    """Return the decimals of a column of a table, in its usual unit: those beside the narrowest of its bands.

    Without a band, and at most, there are so many.

    Examples
    --------
    >>> table_decimals([Band(7850.0, 15400.0, 0.95)], "m/s^2", "g", 1), table_decimals([], "m/s^2", "g", 1)
    (-1, 1)
    """
    ends = [[float(in_unit(end, si, usual)) for end in (band.low, band.high)] for band in bands]
    allowed = [decimals_beside(*pair) for pair in ends if all(map(math.isfinite, pair))]
    return min(decimals, max(allowed, default=decimals))


def fixed_within(value: float | None, bands: Iterable[Band], si: str, usual: str, decimals: int = MOST_DIGITS) -> str:
    """Write an SI value of a table with the decimals that its bands leave it; without a band with those of a sentence.

    Examples
    --------
    >>> fixed_within(11421.3, [Band(7850.0, 15400.0, 0.95)], "m/s^2", "g", 1), fixed_within(980.5, [], "m/s^2", "g", 0)
    ('1160', '99.98')
    """
    bands = list(bands)
    decimals = table_decimals(bands, si, usual, decimals)
    return fixed(value, si, usual, decimals if bands else decimals_of(value, si, usual, decimals))


def with_band(value: float | None, band: Band | None, si: str, usual: str, digits: int = 4) -> str:
    """Write an SI value with its unit and its band, by which its digits go; without a band with so many digits.

    Bands are of sizes: beside a value below zero the band is that of its sign.

    Examples
    --------
    >>> with_band(11424.0, Band(7850.0, 15400.0, 0.95), "m/s^2", "g")
    '1160 g (800 to 1600 g)'
    >>> with_band(-19680.0, Band(17700.0, 21700.0, 0.95), "N", "kN")
    '-19.68 kN (-21.7 to -17.7 kN)'
    """
    if value is None or math.isnan(value) or band is None or not math.isfinite(band.low + band.high):
        return with_unit(value, si, usual, digits)
    if value < 0.0 <= band.low:
        band = dataclasses.replace(band, low=-band.high, high=-band.low)
    decimals = decimals_beside(shown(band.low, si, usual), shown(band.high, si, usual))
    name = spelled(shown_unit(si, usual))
    return f"{rounded(shown(value, si, usual), decimals)} {name} ({band_text(band, si, usual)})"


def band_text(band: Band, si: str, usual: str) -> str:
    """Write the ends of a band with their unit, in the digits that its width leaves.

    Examples
    --------
    >>> band_text(Band(7850.0, 15400.0, 0.95), "m/s^2", "g")
    '800 to 1600 g'
    """
    low, high = shown(band.low, si, usual), shown(band.high, si, usual)
    decimals = decimals_within(low, high)
    return f"{rounded(low, decimals)} to {rounded(high, decimals)} {spelled(shown_unit(si, usual))}".rstrip()


BAND_HEADS = ("result", "value and range", "shares of the inputs that matter most", "rest")
"""Heads of the table of bands on the screen."""
NO_BAND_OF_ELEMENTS = (
    "No band: it would take dozens of runs like this one, minutes each. How far the inputs move the result is seen in "
    "the band of the same bodies as a machine or a layered bar."
)
"""Reason why a run of finite elements has no band."""


def band_words(bands: Mapping[str, Band]) -> list[str]:
    """Explain the bands beside the key numbers, and what moves the first one most; nothing without bands."""
    if not bands:
        return []
    name, band = next(iter(bands.items()))
    most = listed([f"{one.field} ({share_with_error(one.share, one.standard_error)})" for one in band.inputs])
    depends = f" What moves the {band_label(name)} most, with its share of the variance: {most}." if most else ""
    return [
        f"In brackets: the range of {percent(band.level, 0)} of all results when inputs move within what is known of "
        f"them; a number is rounded to one digit more than its range, and the model's own error is not in it.{depends}"
    ]


def banded_words(result: Result) -> list[str]:
    """Say in sentences what the ranges of a result are, and how many of their runs failed a check."""
    return [*band_words(result.band), *([] if result.band_method is None else result.band_method.broken_words())]


def lacking_notices(names: Iterable[str], bands: Mapping[str, Band], method: BandMethod | None) -> list[Notice]:
    """Return a notice where results that may have a band have none, with what failed.

    Examples
    --------
    >>> method = BandMethod("full runs", 0.95, 1, 128, failed=128, why="striker.mass: too small")
    >>> print(lacking_notices(["first.rigid_peak"], {}, method)[0].message)
    no band of the rigid peak of the first blow: too few of 128 runs at moved inputs gave one; 128 could not be made, \
    the first because of striker.mass: too small
    """
    lacking = [name for name in names if name not in bands]
    if not lacking or method is None:
        return []
    what = listed([f"the {band_label(name)}" for name in lacking])
    failed = f"; {method.failed} could not be made, the first because of {method.why}" if method.failed else ""
    runs = method.runs + method.first_runs + method.sensor_runs
    message = f"no band of {what}: too few of {runs} runs at moved inputs gave one{failed}"
    return [Notice("no-band", message, float(method.failed), float(runs))]


def band_label(name: str) -> str:
    """Return the name of a result with a band, in words.

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


def short_label(name: str) -> str:
    """Return the name of a result with a band in few words, for a narrow table.

    Examples
    --------
    >>> short_label("first.rigid_peak"), short_label("typical.width"), short_label("tap.end.peak_velocity")
    ('rigid peak, first', 'width, later', 'peak velocity, tap end')
    """
    where, _, quantity = name.rpartition(".")
    words = quantity.replace("_", " ")
    return f"{words}, {({'typical': 'later'}).get(where, where.replace('.', ' '))}" if where else words


def short_fields(fields: Iterable[str]) -> dict[str, str]:
    """Return the last words of each field, as few as tell it from the others; of a named material its name too.

    Examples
    --------
    >>> short_fields(["object.mass", "striker.mass", "machine.engagement"])
    {'object.mass': 'object.mass', 'striker.mass': 'striker.mass', 'machine.engagement': 'engagement'}
    >>> short_fields(["stack.layer.upper.diameter", "stack.layer.lower.diameter"])
    {'stack.layer.upper.diameter': 'upper.diameter', 'stack.layer.lower.diameter': 'lower.diameter'}
    >>> short_fields(["material.PTFE.modulus"])
    {'material.PTFE.modulus': 'PTFE.modulus'}
    """
    counts = Counter[str]()
    ends: dict[str, list[str]] = {}
    for field in fields:
        names = field.split(".")
        shortest = 2 if names[0] == MATERIAL else 1
        ends[field] = [".".join(names[-count:]) for count in range(shortest, len(names) + 1)]
        counts.update(ends[field])
    return {field: next((end for end in endings if counts[end] == 1), field) for field, endings in ends.items()}


def units_of(result: Result, name: str) -> tuple[str, str]:
    """Return the SI unit of a result with a band, and the one in which it is shown as a rule, as its field declares.

    Examples
    --------
    >>> from strikewave import load_case, run_case
    >>> solution = run_case(load_case("li-ma-2019", ["feed.blows=1"]))
    >>> units_of(solution, "first.rigid_peak"), units_of(solution, "interval")
    (('m/s^2', 'g'), ('s', 'ms'))
    """
    return banded_quantities(type(result))[name.rpartition(".")[2]][:2]


def band_rows(result: Result, values: Mapping[str, float], whole: bool = True) -> list[list[str]]:
    """Return a row for each result with a band: its name, its value with the range, the inputs, and the rest.

    ``values`` are the results themselves, SI, by the names of the bands; names are shortened for a narrow table unless
    they are to be ``whole``.
    """
    method = result.band_method
    short = {} if whole or method is None else short_fields([moved.field for moved in method.inputs])
    rows = []
    for name, band in result.band.items():
        label = band_label(name) if whole else short_label(name)
        shares, rest = _shares(result, name, short)
        rows.append(
            [label, with_band(values.get(name), band, *units_of(result, name)), ", ".join(shares) or NONE, rest]
        )
    return rows


def _shares(result: Result, name: str, short: Mapping[str, str]) -> tuple[list[str], str]:
    """Return the shares of the inputs in the variance of a result, and the rest that none makes by itself."""
    shares = [
        f"{short.get(one.field, one.field)} {share_with_error(one.share, one.standard_error)}"
        for one in result.band[name].inputs
    ]
    rest = {} if result.band_method is None else result.band_method.rest
    return shares, percent(rest[name], 0) if name in rest else NONE


def band_sections(result: Result) -> list[Section]:
    """List the band of each result, the inputs that matter most, and what is known of each; nothing without bands."""
    if not result.band:
        return []
    most = max([len(band.inputs) for band in result.band.values()])
    rows: list[list[Cell]] = []
    for name, band in result.band.items():
        (shares, rest), ends = _shares(result, name, {}), band_text(band, *units_of(result, name))
        rows.append([band_label(name), ends, *shares, *[NONE] * (most - len(shares)), rest])
    heads = ["result", "range", *(f"{nth} input" for nth in ("largest", "second", "third", "fourth", "fifth")[:most])]
    tables = [Table("Ranges and the inputs that matter most", [*heads, "rest"], rows)]
    text = (
        "A share is that of an input, by itself, in the variance of the result; the rest is what inputs make together, "
        "and what the fit does not explain. The model's own error is not in these ranges."
    )
    method = result.band_method
    if method is not None:
        text = f"The ranges hold {method.words()}. {text}"
        ranked = [band_label(name) for name in method.ranked]
        if ranked:
            text += f" For {listed(ranked)}, whose few outliers hide the rest, it is the variance of the ranks."
        heads = ["input", "as typed", "from", "to", "what is known", "why"]
        tables.append(Table("What is known of the inputs", heads, moved_rows(method)))
    return [Section("What the results depend on", text, tables)]


def moved_rows(method: BandMethod) -> list[list[Cell]]:
    """Return a row for each input that moved: its range, in the unit in which it was typed."""
    rows: list[list[Cell]] = []
    for moved in method.inputs:
        typed = take_apart(moved.typed)
        unit = typed.unit if typed is not None and typed.unit and moved.unit else moved.unit
        ends = [float(in_unit(end, moved.unit, unit) if unit else end) for end in (moved.low, moved.high)]
        shown_ends = [f"{written(end, 4)} {spelled(unit)}".strip() for end in ends]
        rows.append([moved.field, str(moved.typed), *shown_ends, moved.basis, moved.reason])
    return rows
