"""Numbers with a band: one digit more than its width leaves, in sentences and tables alike, and the ends without it."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterable

from strikewave.base.result import Band
from strikewave.base.units import in_unit
from strikewave.reporting.numbers import decimals_of, fixed, rounded, shown, spelled, with_unit
from strikewave.reporting.shown_units import shown_unit

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
