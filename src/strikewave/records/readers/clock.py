"""Time in text files: its units, the digits it was printed with, its step, and rates named above the data."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Sequence

import numpy as np

from strikewave.records.record import Array

_SECONDS = {
    "s": 1.0, "sec": 1.0, "secs": 1.0, "second": 1.0, "seconds": 1.0, "sekunde": 1.0, "sekunden": 1.0,
    "ms": 1e-3, "msec": 1e-3, "millisecond": 1e-3, "milliseconds": 1e-3,
    "us": 1e-6, "usec": 1e-6, "mus": 1e-6, "microsecond": 1e-6, "microseconds": 1e-6,
    "ns": 1e-9, "nsec": 1e-9, "nanosecond": 1e-9, "nanoseconds": 1e-9,
    "ps": 1e-12, "min": 60.0, "minute": 60.0, "minutes": 60.0, "h": 3600.0, "hour": 3600.0, "hours": 3600.0,
    "millisekunden": 1e-3, "mikrosekunden": 1e-6, "nanosekunden": 1e-9,
}  # fmt: skip
"""Seconds of a unit of time as instruments write it, in English and German."""
UNITS_OF_TIME = ("s", "ms", "us", "ns", "ps", "min", "h")
"""Units that are offered for one that is none."""
_HERTZ = {"": 1.0, "k": 1e3, "m": 1e6, "g": 1e9}
"""Factors before Hz; ``m`` is mega, as no instrument samples in millihertz."""
_DIGITS = re.compile(r"[+-]?(\d*)(?:[.,](\d*))?(?:[eE]([+-]?\d{1,4}))?")
"""A printed number: whole digits, decimals, power of ten."""
_NUMBER = r"([+-]?(?:\d{1,25}(?:[.,]\d{0,25})?|[.,]\d{1,25})(?:[eE][+-]?\d{1,3})?)"
"""A number in a line; its parts are bounded, so that hostile lines take no time."""
_LINK = r"\"?\s{0,5}(?:[\[(]([^\])]{1,12})[\])])?\"?\s{0,5}[:=,;\t ]\s{0,5}\"?(?:[A-Za-z]\w{0,9}:)?\s{0,5}"
"""What stands between a name and its number: a unit in brackets, a mark, blanks, the letters of a drive or channel."""
_NO_DATE = r"(?!\d|[-/:.]\d)"
"""What follows a number that is not the first one of a date or a time of day."""
_AFTER = r"\"?[\s,;]{0,5}\"?([A-Za-zµμ/]{0,14})"
"""A unit after the number."""
_RATE = r"sampl(?:e|ing)[ _-]?(?:rate|frequency|freq\.?)|fs|f_s|abtastrate|abtastfrequenz|samples per second"
"""Names of a sampling rate, in English and German."""
_INTERVAL = (
    r"sampl(?:e|ing)[ _-]?(?:interval|period|time)|abtast(?:intervall|zeit|periode)|dt|delta[ _-]?[tx]|tinc|"
    r"xincr|x[ _-]?increment|(?:horizontal|time)[ _-](?:interval|step|increment)|time ?step|increment"
)
"""Names of a step in time."""
_START = r"t0|x0|t_0|xzero|start"
"""Names of the time of the first sample."""
_STATED = {
    kind: re.compile(rf"(?<![A-Za-z0-9_])(?:{names}){_LINK}{_NUMBER}{_NO_DATE}{_AFTER}", re.IGNORECASE)
    for kind, names in (("rate", _RATE), ("interval", _INTERVAL), ("start", _START))
}
"""Patterns of a rate, a step and a start in the lines above the data."""
_CHUNK = 2**20
"""Time stamps compared at once: keeps the memory beside them small."""
_LONGEST_SETTING = 500
"""Characters of a line in which a rate or step is looked for: bounds the time of patterns on hostile lines."""
_WITHIN_DIGIT = 1.01
"""Times the last printed digit that stamps may stray by: rounding by half a digit at both ends, and floating point."""
_WITHIN_STEP = 0.01
"""Share of a step by which stamps may stray whose digits are finer than it."""
_EVEN = 0.1
"""Share of a step by which stamps may stray and still have the mean step: jitter, not gaps."""
_ROUNDING = 8.0
"""Units in the last place by which computed stamps may stray."""
_ALIKE, _FAR_LARGER = 0.95, 1.5
"""Share of differences that must be the usual one, and how many times it the others must be, where there are gaps
alone."""
_COARSE = 4.0
"""Printed digits within a step below which the step is taken over a lag, where rounding counts less."""


def seconds_in(unit: str) -> float | None:
    """Return how many seconds a unit of time has; None for what is no unit of time.

    Examples
    --------
    >>> seconds_in("µs"), seconds_in("V")
    (1e-06, None)
    """
    return _SECONDS.get(unit.strip().lower().replace("µ", "u").replace("μ", "u"))


def to_seconds(values: Array, unit: str, stated: float | None = None) -> Array:
    """Bring times to seconds, in place; by a whole divisor, so that 20 us are 2e-05 s and not a digit less.

    Seconds of the unit that are stated overrule the unit; a divisor that is not whole, such as that of 3 ms, is none.
    """
    factor = stated or seconds_in(unit) or 1.0
    parts = round(1.0 / factor)
    if parts and 1.0 / parts == factor:
        values /= parts
    else:
        values *= factor
    return values


def last_digit(cells: Iterable[str]) -> float:
    """Return the worth of the last printed digit of the largest number; zero where nothing is a number.

    Digits are counted where most are printed, as trailing zeros may be left out elsewhere.

    Examples
    --------
    >>> last_digit(["0.1", "0.125"]), last_digit(["1.25e-6", "2.5e-5"])
    (0.001, 1e-07)
    """
    finest, most, largest = math.inf, 0, -math.inf
    for cell in cells:
        match = _DIGITS.fullmatch(cell.strip())
        if match is None or not (match[1] or match[2]):
            continue
        whole, decimals, power = match[1], match[2] or "", int(match[3] or 0)
        finest = min(finest, power - len(decimals))
        figures = (whole + decimals).lstrip("0")
        if figures:
            most = max(most, len(figures))
            largest = max(largest, len(figures) - 1 - len(decimals) + power)
    if math.isinf(finest):
        return 0.0
    return float(f"1e{int(max(finest, largest - most + 1))}")


def rises_evenly(values: Array, digit: float) -> bool:
    """Tell whether values rise by the same step within the rounding of their digits."""
    if values.size < 3 or not np.all(np.isfinite(values)) or np.any(np.diff(values) < 0.0):
        return False
    step = (values[-1] - values[0]) / (values.size - 1)
    room = _WITHIN_DIGIT * digit if np.unique(values).size < values.size or digit < step else _WITHIN_STEP * step
    return bool(step > 0.0 and _strays(values, step) <= room + 1e-9 * np.abs(values).max())


def step_of(stamps: Array, digit: float) -> float:
    """Return the step of time stamps: from end to end where they are even within rounding, else the median.

    Parameters
    ----------
    stamps : ndarray
        Times, s.
    digit : float
        Worth of the last digit they are printed with, s.

    Examples
    --------
    >>> step_of(np.array([0.0, 0.33, 0.67, 1.0]), digit=0.01)
    0.3333333333333333
    """
    if stamps.size < 2:
        return math.nan
    step = float(stamps[-1] - stamps[0]) / (stamps.size - 1)
    strays = _strays(stamps, step)
    noise = _ROUNDING * np.finfo(float).eps * max(abs(float(stamps[0])), abs(float(stamps[-1])))
    if step > 0.0 and strays <= _EVEN * step + noise:
        return step
    typical, gaps = _typical(stamps)
    if step > 0.0 and strays <= _WITHIN_DIGIT * digit + noise and not gaps:
        return step
    if typical <= _COARSE * digit and not gaps:
        lag = max(1, stamps.size // 8)
        typical = float(np.nanmedian(stamps[lag:] - stamps[:-lag])) / lag
    return typical if typical > 0.0 else math.nan


def _strays(stamps: Array, step: float) -> float:
    """Return the largest distance from a straight line through the first stamp, s; missing stamps have none."""
    worst = 0.0
    for k in range(0, stamps.size, _CHUNK):
        part = stamps[k : k + _CHUNK]
        line = stamps[0] + step * np.arange(k, k + part.size)
        worst = float(np.fmax.reduce(np.abs(part - line), initial=worst))
    return worst


def _typical(stamps: Array) -> tuple[float, bool]:
    """Return the median difference, and whether nearly all others are that or far larger, as gaps make them."""
    differences = np.diff(stamps[: 4 * _CHUNK])
    differences = differences[np.isfinite(differences)]
    if not differences.size:
        return math.nan, False
    middle = float(np.median(differences))
    same = np.abs(differences - middle) <= _EVEN * abs(middle)
    rest = differences[~same]
    return middle, bool(middle > 0.0 and same.mean() >= _ALIKE and np.all(np.abs(rest) >= _FAR_LARGER * middle))


def said_step(lines: Sequence[str]) -> tuple[float, float]:
    """Return the step and the start, s, that lines above the data name; NaN for a step they do not name.

    Examples
    --------
    >>> said_step(["Sampling rate: 200 kHz", "t0 = -1 ms"])
    (5e-06, -0.001)
    """
    interval = _stated(lines, "interval")
    rate = _stated(lines, "rate")
    step = interval if interval > 0.0 else 1.0 / rate if rate > 0.0 else math.nan
    start = _stated(lines, "start")
    return (step if math.isfinite(step) else math.nan), (start if math.isfinite(start) else 0.0)


def names_a_step(line: str) -> bool:
    """Tell whether a line names a rate, an interval or a start."""
    return any(pattern.search(line[:_LONGEST_SETTING]) for pattern in _STATED.values())


def _stated(lines: Iterable[str], kind: str) -> float:
    for line in lines:
        for match in _STATED[kind].finditer(line[:_LONGEST_SETTING]):
            factor = _hertz(match[1] or match[3]) if kind == "rate" else seconds_in(match[1] or match[3] or "s")
            if factor is not None:
                value = float(match[2].replace(",", "."))
                return value * factor if factor >= 1.0 else value / round(1.0 / factor)
    return math.nan


def _hertz(unit: str) -> float | None:
    match = re.fullmatch(r"([kmg]?)(?:hz|sa?(?:mples?)?/s(?:ec)?|sps|1/s)?", unit.lower())
    return None if match is None else _HERTZ[match[1]]
