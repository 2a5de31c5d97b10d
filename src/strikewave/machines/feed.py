"""The hydraulic feed: it moves the carriage with the object to the strike position and back."""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class Feed:
    """Valve, stroke and timing of the feed.

    Both ways the speed rises as (1 - cos)/2 over a share of the time, stays, and falls alike over another, the
    cushioning; with halves the way is cycloidal, s = u - sin(2 pi u)/(2 pi).

    Parameters
    ----------
    wait : float
        Time at speed before the valve signal, s.
    valve_delay : float
        From valve signal to first motion, s.
    stroke : float
        Way of the carriage, m.
    stroke_time : float
        Time of the stroke, s.
    arrival : float
        Where in the striking period the stroke ends, 0 to 1 after the last striker's apex: the valve
        signal is timed for it.
    blows : int
        Wanted number of passes; the retract command comes at the apex of the last.
    release_delay : float
        From retract command to first motion, s.
    retract_time : float
        Time of the retraction, s.
    acceleration, cushion : float, optional
        Shares of the time of a stroke in which it speeds up and is cushioned, together 1 at most.
    hold : float, optional
        Longest time in the strike position, s: then the retract command comes, blows or not.
    """

    wait: float
    valve_delay: float
    stroke: float
    stroke_time: float
    arrival: float
    blows: int
    release_delay: float
    retract_time: float
    acceleration: float = 0.5
    cushion: float = 0.5
    hold: float = math.inf

    @property
    def fastest(self) -> float:
        """Highest speed of the stroke, m/s: (way/time) / (1 - (acceleration + cushion)/2)."""
        return self.stroke / self.stroke_time / (1.0 - 0.5 * (self.acceleration + self.cushion))


def angle_at_valve_signal(feed: Feed, speed: float, pitch: float) -> float:
    """Return the turntable's angle at the valve signal, in 0..pitch, rad.

    Chosen so that, at the given speed, the stroke ends ``arrival`` of a pitch after a striker's apex.

    Examples
    --------
    >>> import math
    >>> feed = Feed(1.0, 0.01, 0.015, 0.04, 0.5, 11, 0.003, 0.03)
    >>> round(angle_at_valve_signal(feed, speed=80.0, pitch=math.pi / 2), 6)
    1.497787
    """
    travelled = speed * (feed.valve_delay + feed.stroke_time)
    return (feed.arrival * pitch - travelled) % pitch


def expected_time(feed: Feed, pitch_time: float) -> float:
    """Return about how long it takes from the valve signal to the end of the retraction, s.

    Examples
    --------
    >>> round(expected_time(Feed(1.0, 0.01, 0.015, 0.04, 0.5, 11, 0.003, 0.03), pitch_time=0.02), 3)
    0.323
    """
    way = feed.valve_delay + feed.stroke_time + feed.release_delay + feed.retract_time
    return way + min((feed.blows + 1) * pitch_time, feed.hold)
