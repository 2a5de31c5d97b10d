"""Bands as they are shown: numbers with their ranges in sentences and tables, and what is known of the inputs."""

from __future__ import annotations

import dataclasses
import math
from collections import Counter
from collections.abc import Iterable, Mapping

from strikewave.base.constants import MATERIAL
from strikewave.base.declare import banded_quantities
from strikewave.base.result import Band, BandMethod, MovedInput, Notice, Result
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

TWO_DIGITS_BELOW = 3.0
"""Half widths of a band that begin with 1 or 2 are stated with two digits, others with one: rounding then moves an end
by a sixth of the half width at most."""
MOST_DIGITS = 4
"""Significant digits of a result with a narrow band: the balances hold to 1e-6, but nobody measures a shock so well."""


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
    """Write an SI value of a table as `fixed` does, with so many decimals as `table_decimals` leaves of its bands.

    Without a band it has as many digits as `with_band` gives it in a sentence, at least.

    Examples
    --------
    >>> band = Band(7850.0, 15400.0, 0.95)
    >>> fixed_within(11421.3, [band], "m/s^2", "g", 1), fixed_within(9806.65, [], "m/s^2", "g", 1)
    ('1160', '1000.0')
    >>> fixed_within(980.5, [], "m/s^2", "g", 0), with_band(980.5, None, "m/s^2", "g")
    ('99.98', '99.98 g')
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
    decimals = decimals_beside(*(shown(end, si, usual) for end in (band.low, band.high)))
    name = spelled(shown_unit(si, usual))
    return f"{rounded(shown(value, si, usual), decimals)} {name} ({band_text(band, si, usual)})"


def band_text(band: Band, si: str, usual: str) -> str:
    """Write the ends of a band with their unit, in the digits that its width leaves.

    Examples
    --------
    >>> band_text(Band(7850.0, 15400.0, 0.95), "m/s^2", "g")
    '800 to 1600 g'
    """
    low, high = (shown(end, si, usual) for end in (band.low, band.high))
    decimals = decimals_within(low, high)
    return f"{rounded(low, decimals)} to {rounded(high, decimals)} {spelled(shown_unit(si, usual))}".rstrip()


BAND_HEADS = ("result", "value and range", "shares of the inputs that matter most", "rest")
"""Heads of the table of bands on the screen."""
MOVED_HEADS = ("input", "as typed", "from", "to", "what is known", "why")
"""Heads of the table of inputs."""
NO_BAND_OF_ELEMENTS = (
    "No band: it would take dozens of runs like this one, minutes each. How far the inputs move the result is seen in "
    "the band of the same bodies as a machine or a layered bar."
)
"""Why a run of finite elements has no band."""


def band_words(bands: Mapping[str, Band]) -> list[str]:
    """Say what the bands beside the key numbers are, and what the first one depends on; nothing without bands."""
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


def short_label(name: str) -> str:
    """Say in few words what a result with a band is called, for a narrow table.

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
    fewest = {field: 2 if field.startswith(f"{MATERIAL}.") else 1 for field in fields}
    ends = {
        field: [".".join(field.split(".")[-k:]) for k in range(least, field.count(".") + 2)]
        for field, least in fewest.items()
    }
    counts = Counter(end for of_one in ends.values() for end in of_one)
    return {field: next((end for end in of_one if counts[end] == 1), field) for field, of_one in ends.items()}


def units_of(result: Result, name: str) -> tuple[str, str]:
    """Return the SI unit of a result with a band, and the one in which it is shown as a rule, as its field declares.

    Examples
    --------
    >>> from strikewave import load_case, run_case
    >>> solution = run_case(load_case("li-ma-2019", ["feed.blows=1"]))
    >>> units_of(solution, "first.rigid_peak"), units_of(solution, "interval"), units_of(solution, "sensor.a.peak")
    (('m/s^2', 'g'), ('s', 'ms'), ('m/s^2', 'g'))
    """
    return banded_quantities(type(result))[name.rpartition(".")[2]][:2]


def band_rows(result: Result, values: Mapping[str, float], whole: bool = True) -> list[list[str]]:
    """Return a row for each result with a band: its name, its value with the range, the inputs, and the rest.

    Parameters
    ----------
    result : Result
        With bands.
    values : mapping of str to float
        The results themselves, SI, by the names of the bands.
    whole : bool
        True if names of results and fields are whole, not shortened for a narrow table.
    """
    method = result.band_method
    short = {} if whole or method is None else short_fields(one.field for one in method.inputs)
    return [
        [
            band_label(name) if whole else short_label(name),
            with_band(values.get(name), band, *units_of(result, name)),
            ", ".join(_shares(band, short)) or NONE,
            _rest(result, name),
        ]
        for name, band in result.band.items()
    ]


def _shares(band: Band, called: Mapping[str, str] | None = None) -> list[str]:
    return [
        f"{(called or {}).get(one.field, one.field)} {share_with_error(one.share, one.standard_error)}"
        for one in band.inputs
    ]


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
        inputs, ends = _shares(band), band_text(band, *units_of(result, name))
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
    typed = take_apart(one.typed)
    unit = typed.unit if typed is not None and typed.unit and one.unit else one.unit
    ends = (in_unit(end, one.unit, unit) if unit else end for end in (one.low, one.high))
    return [f"{written(float(end), 4)} {spelled(unit)}".strip() for end in ends]
