"""Warnings on a bar calibrated by its echoes."""

from __future__ import annotations

import math
from collections.abc import Iterator

from strikewave.analyses.hopkinson.notices import MISMATCH
from strikewave.base.percents import percent, plain
from strikewave.base.result import Notice
from strikewave.hopkinson import Bar
from strikewave.hopkinson.echoes import Echoes, Way

LENGTH_MISMATCH = 0.01
"""Share by which a stated length may differ from round trips and speed with no warning: a bar is measured better, and a
wrong gauge distance shows itself here."""
GAIN = 1e-3
"""Share of amplitude that passes may seem to gain in a round trip with no warning: no bar gains any; a thousandth is
what noise leaves of a good record."""
OTHER_WAY = 0.5
"""Misfit of the times, or difference of the speed, with the other way over that with the stated one, below which the
other way is proposed: it must be clearly better."""


def echo_notices(found: Echoes, bar: Bar, way: Way) -> Iterator[Notice]:
    """Yield what does not fit: speed, length, losses, the way of the first pulse, passes at the begin."""
    yield from _speed_notices(found, bar, way)
    yield from _length_notices(found, bar)
    gained = -2.0 * found.length.value * found.attenuation.value
    if gained > max(GAIN, 2.0 * found.length.value * 2.0 * found.attenuation.error):
        message = (
            f"passes gain {percent(gained, 2)} of amplitude in a round trip: do pulses overlap, or was "
            "one met on its way?"
        )
        yield Notice("attenuation-negative", message, found.attenuation.value, 0.0)
    if found.odd is not None:
        number = found.odd.number
        message = (
            f"pass {number} does not go with those after it: {plain(found.odd.late * 1e6, sign='+')}\xa0us late, "
            f"{plain(found.odd.strength)} times as "
            f"strong as they say; did it meet a specimen? echoes.skip = {number} leaves it out"
        )
        yield Notice("first-passes-differ", message, float(number), math.nan)


def _speed_notices(found: Echoes, bar: Bar, way: Way) -> Iterator[Notice]:
    speed, other = found.speed, found.other_way
    off = found.difference
    limit = max(MISMATCH, speed.student * speed.error / bar.speed if speed.freedom > 0 else 0.0)
    turned = "away" if way == "towards" else "towards"
    ask = f'echoes.way = "{turned}" would give {plain(other.speed, 5)}\xa0m/s: which way does the first pulse run?'
    if other.misfit < OTHER_WAY:
        message = f"the times of the passes fit the other way of the first pulse better; {ask}"
        yield Notice("way-differs", message, other.misfit, OTHER_WAY)
    if abs(off) > limit:
        message = (
            f"the speed by echoes, {plain(speed.value, 5)}\xa0m/s, is {percent(off, 2, '+')} off the stated "
            f"{plain(bar.speed, 5)}\xa0m/s"
        )
        if not other.misfit < OTHER_WAY and abs(other.speed / bar.speed - 1.0) < OTHER_WAY * abs(off):
            message += f"; {ask}"
        yield Notice("speed-differs", message, off, limit)
    if speed.freedom < 1:
        yield Notice("no-scatter", "the speed stands on as few passes as tell it: it has no error", 0.0, 1.0)


def _length_notices(found: Echoes, bar: Bar) -> Iterator[Notice]:
    off = found.round_trip.value / bar.length - 1.0 if math.isfinite(bar.length) else 0.0
    if abs(off) > LENGTH_MISMATCH:
        message = (
            f"the stated length of {plain(bar.length * 1e3, 5)}\xa0mm is {percent(-off / (1.0 + off), 1, '+')} off the "
            f"{plain(found.round_trip.value * 1e3, 5)}\xa0mm by round trips and turns at the near end: is it, or "
            "the gauge distance, off?"
        )
        yield Notice("length-differs", message, off, LENGTH_MISMATCH)
