"""Whether the first striker meets an object that stands: still on its way in, or thrown by the feed."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from strikewave.base.percents import plain
from strikewave.base.result import Notice
from strikewave.machines import Blow
from strikewave.machines.run import MachineRun

STANDING_SHARE = 0.02
"""An object stands if its speed is below this share of the nominal approach speed, and lies in place if it is off by
less than this share of the engagement. Chosen: the peak of a blow goes about as its speed, so 2 % of it."""
JUST_BEFORE = 1e-9
"""How long before first touch the object is looked at, s: nothing pushes it there yet."""


def feed_notices(run: MachineRun, blows: Sequence[Blow]) -> Iterator[Notice]:
    """Warn where strikers meet an object that is still fed, or that the feed has thrown off its stop.

    Parameters
    ----------
    run : MachineRun
        Of a machine with a drive.
    blows : sequence of Blow
        Its blows, in order of time.
    """
    struck = [blow for blow in blows if blow.kind != "missed"]
    if not struck:
        return
    drive, first, fed = run.machine.drive, struck[0], run.held[0]
    nominal = run.machine.nominal_approach
    before = run.sample(np.array([max(first.time - JUST_BEFORE, 0.0)]))
    forward = -float(before.object_speed[0])
    short = float(before.face_place[0]) + drive.engagement
    moving, away = abs(forward) > STANDING_SHARE * nominal, abs(short) > STANDING_SHARE * drive.engagement
    if first.time < fed and (moving or away):
        more = sum(blow.time < fed for blow in struck) - 1
        where = f"{plain(short * 1e3)}\xa0mm short of its place" if away else "in its place"
        message = (
            f"the first blow{f' and {more} more' if more else ''} meets the object while it is still fed: at first "
            f"touch it is {where} and comes with {plain(forward)}\xa0m/s, and the approach is "
            f"{plain(first.approach_speed)}\xa0m/s instead of {plain(nominal)}\xa0m/s; the feed ends "
            f"{plain((fed - first.time) * 1e3)}\xa0ms later: let it end between two strikers (feed.arrival), or take a "
            "shorter feed.stroke_time"
        )
        yield Notice("struck-while-fed", message, first.time, fed)
    elif moving:
        way = "towards the striker" if forward > 0.0 else "away from the striker"
        message = (
            f"the first blow meets an object that still moves, {plain(abs(forward))}\xa0m/s {way}: the approach is "
            f"{plain(first.approach_speed)}\xa0m/s instead of {plain(nominal)}\xa0m/s; {_why_it_moves(run)}lengthen "
            "feed.stroke_time, raise object.preload, or let it arrive earlier (feed.arrival)"
        )
        yield Notice("first-blow-moving", message, abs(forward), STANDING_SHARE * nominal)


def _why_it_moves(run: MachineRun) -> str:
    """Return in words that the feed is quicker than the preload can follow, if it is; largest slope of (1 - cos)/2."""
    feed, struck = run.machine.drive.feed, run.machine.struck
    largest = 0.5 * math.pi * feed.fastest / (min(feed.acceleration, feed.cushion) * feed.stroke_time)
    held = struck.preload / struck.mass - struck.gravity
    if largest <= held:
        return ""
    return (
        f"the feed speeds up and stops with up to {plain(largest)}\xa0m/s^2, and the preload holds the object on "
        f"its stop only up to {plain(held)}\xa0m/s^2: "
    )
