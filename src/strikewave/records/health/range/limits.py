"""What a limit of sensor or amplifier did to blows: flat tops, and slopes that went no further."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from strikewave.base.percents import percent
from strikewave.records.health.examined import BLOW, Examined
from strikewave.records.health.range.shape import OVER, STRAIGHT, SURE, TIP, UPPER, BlowShape
from strikewave.records.health.ringing import goes_back
from strikewave.records.health_notice import HealthNotice

FLATTER = 0.02
"""By how much a top is flatter before it is suspect: the tip of a sin^0.7 is by as much; a limit that takes 5 % off a
half-sine, a haversine or a pulse of Hertz makes 0.05 to 0.06."""
TIP_BY_PEAK = 1.8
"""Change of that ratio with the share by which the peak is off: of sin^0.7 to sin^3, 1.81 to 1.62."""
CORNER = 0.02
"""By how much a top is more pointed than a smooth one before it is a corner: the tip of x exp(-x) is by 0.015."""
ONE_SLOPE = 0.35
"""Slope of one side over that of the other from which on one limit may have made both, and no saw-tooth is meant.

Of a saw-tooth that rises over 0.7 of its length and falls as a cosine does it is 0.29."""
GOES_ON, SAMPLES_OF_TIP = 0.02, 2.0
"""By how much a straight side goes on above the peak before its tip counts as bent, and samples on which a recorder's
filter rounds the tip of a saw-tooth, or delays it."""
WRONG = 0.05
"""By how much the half-sine of the flanks is higher than the peak before it is worth a word."""
ALIKE = 0.1
"""Share by which the slopes of two sides differ that one limit makes; their noise is less."""
SAW_TOOTH = 0.2
"""Slope of one straight side over that of the other below which a pulse is a saw-tooth as standards have it."""


def limited(record: Examined) -> list[HealthNotice]:
    """Find what a limit of sensor or amplifier did to blows: flat tops, and slopes that went no further.

    Both look at the shape of each blow, which is measured once.
    """
    shapes = [BlowShape(record, pulse) for pulse in record.pulses if pulse.method == "record" and pulse.width > 0.0]
    return [*_saturated(shapes), *_slew_limited(record, shapes)]


def _saturated(shapes: Sequence[BlowShape]) -> list[HealthNotice]:
    """Find tops flatter than any that an elastic contact makes: an amplifier near its limit, or flat pulses.

    Which of them is not known from one record. What swings after a blow may have bent its top as well.
    """
    top = top_of(shapes)
    if top is not None and top.sharpness > top.usual + FLATTER + top.doubt:
        message = (
            f"the top is flat: {percent(top.sharpness, 0)} as wide at {percent(TIP, 0)} of the peak as at "
            f"{percent(UPPER, 0)} (an elastic pulse's {percent(top.usual, 0)}): sensor or amplifier may be near its "
            "limit; a pulse that is meant to be flat, or made by yielding, cannot be told from it"
        )
        higher = float(np.mean([shape.half_sine_of_flanks for shape in shapes])) - 1.0
        if higher > WRONG:
            message += f"; the half-sine of its flanks would be {percent(higher, 0)} higher"
        return [_of_range("flat-top", message, top.sharpness, shapes)]
    higher = min(map(_bent_off, shapes), default=0.0)
    if higher > 0.0:
        message = (
            f"a straight side, as that of a saw-tooth, would go on {percent(higher, 0)} above the peak, and bends "
            "before it: sensor or amplifier may be near its limit; a tip that is meant to be round cannot be told from "
            "it"
        )
        return [_of_range("flat-top", message, higher, shapes)]
    return []


def _slew_limited(record: Examined, shapes: Sequence[BlowShape]) -> list[HealthNotice]:
    """Find an amplifier that is too slow for a blow, by a straight side or a corner.

    A side is straight where a pulse is curved, or the top is a corner where it is round: such an amplifier follows
    the rise in a straight line until that meets the fall. A saw-tooth, straight on both sides and much steeper on one,
    is meant to be so.
    """
    for shape in shapes:
        other, steep = sorted(shape.flanks)
        own_slope = other.slope < (1.0 - ALIKE) * steep.slope
        saw_tooth = other.bend < STRAIGHT and other.slope < SAW_TOOTH * steep.slope
        if not steep.bend < STRAIGHT or saw_tooth:
            continue
        sides = "one side is" if own_slope else "its sides are"
        message = (
            f"the blow at {shape.pulse.time:.6g}\xa0s: {sides} straight over {percent(OVER, 0)} of the peak, at "
            f"{record.text(1e-6 * steep.slope)} per us, where a smooth pulse is curved: the amplifier may be too slow "
            "(slew rate), unless the pulse is meant to be straight; the true peak may be larger, the width smaller"
        )
        return [_of_range("slew-rate", message, steep.slope, [shape])]
    even = [shape for shape in shapes if shape.pulse.rigid is None and not goes_back(record, shape.pulse)[0] > 0.0]
    top = top_of(even)  # ringing makes corners too
    if top is None or not top.sharpness < top.usual - CORNER - top.doubt:
        return []
    low, high = np.mean([sorted(shape.slope_halfway(side) for side in (-1, 1)) for shape in even], axis=0)
    if not low > ONE_SLOPE * high:
        return []
    message = (
        f"the top is a corner: {percent(top.sharpness, 0)} as wide at {percent(TIP, 0)} of the peak as at "
        f"{percent(UPPER, 0)} (a smooth pulse's {percent(top.usual, 0)}): an amplifier that is too slow (slew rate) "
        "rises in a straight line until it meets the fall, unless the pulse is meant to be pointed; the true peak may "
        "be larger, the width smaller"
    )
    return [_of_range("slew-rate", message, float(high), even)]


def _of_range(code: str, message: str, value: float, shapes: Sequence[BlowShape]) -> HealthNotice:
    begin, end = shapes[0].pulse.begin, shapes[-1].pulse.end
    return HealthNotice(code, message, value, severity="suspect", harms=BLOW, start=begin, end=end)


class Top(NamedTuple):
    """How sharp the tops of some pulses are, in the mean, what smooth ones with their flanks are, and the doubt."""

    sharpness: float
    usual: float
    doubt: float


def top_of(shapes: Sequence[BlowShape]) -> Top | None:
    """Return how sharp the tops of some blows of a record are, all together; None where no shape is known.

    One amplifier takes all of them alike: what noise does is less in their mean, what rings is not.

    Examples
    --------
    >>> from strikewave.records.measuring import find_pulses
    >>> values = np.sin(np.pi * np.clip(np.arange(900.0) / 80.0 - 5.0, 0.0, 1.0))
    >>> top = top_of([BlowShape(Examined(values, 1e-6), pulse) for pulse in find_pulses(values, 1e-6)])
    >>> round(top.sharpness, 2), round(top.usual, 2), top.doubt < 0.01
    (0.43, 0.43, True)
    """
    known = [shape for shape in shapes if not math.isnan(shape.tip)]
    if not known:
        return None
    noise = math.sqrt(float(np.mean(np.square([shape.noise_of_top for shape in known]))) / len(known))
    swing = float(np.mean([shape.swing_to_both_sides for shape in known]))
    sharpness, usual = np.mean([(shape.tip, shape.usual_tip) for shape in known], axis=0)
    return Top(float(sharpness), float(usual), TIP_BY_PEAK * (SURE * noise + swing))


def _bent_off(shape: BlowShape) -> float:
    """Return by how much a straight side of a blow goes on above its peak, over the peak; 0 where that may be chance.

    A limit leaves the time of the peak as it is, and the lower part of a side.
    """
    straight = [flank for flank in shape.flanks if flank.bend < STRAIGHT]
    if not straight:
        return 0.0
    flank = min(straight)
    rounded = SAMPLES_OF_TIP * flank.slope * shape.record.step / abs(shape.pulse.peak)
    higher = flank.goes_on - 1.0
    return higher if higher > GOES_ON + rounded + SURE * shape.noise_of_top else 0.0
