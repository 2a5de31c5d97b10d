"""Drive of a rotary machine: turntable with motor, controller and brake, and the hydraulic feed of the object."""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class Turntable:
    """A driven disc that carries the strikers.

    The controller asks the drive for the drag at set speed plus ``speed_gain`` times the motor's speed error and
    gets 0 to ``torque``. The drag is viscous. Motor and belt are given as the turntable would have them: with a motor
    of i turns a turn, its inertia times i^2 and its torque times i.
    """

    inertia: float
    """Moment of inertia with the strikers, kg m^2."""
    radius: float
    """Radius of the strikers' path, m."""
    speed: float
    """Set speed, rad/s."""
    torque: float
    """Largest torque of the drive at the turntable, behind the belt, N m."""
    speed_gain: float
    """Torque per speed error, N m s/rad."""
    drag: float
    """Viscous drag, N m s/rad."""
    brake: float
    """Torque of the brake, N m."""
    motor_inertia: float = 0.0
    """kg m^2."""
    belt_stiffness: float = math.inf
    """N m/rad; a rigid belt makes the motor's inertia belong to each blow."""
    belt_damping: float = 0.0
    """N m s/rad."""
    ripple: float = 0.0
    """Share of the set speed by which it swings."""
    ripple_order: float = 1.0
    """Swings a turn."""
    ripple_phase: float = 0.0
    """Phase of the swing at angle 0, rad."""

    @property
    def turning(self) -> float:
        """Inertia of turntable and motor together, kg m^2."""
        return self.inertia + self.motor_inertia

    @property
    def rigid_belt(self) -> bool:
        """True if the motor turns with the turntable."""
        return math.isinf(self.belt_stiffness)


def spin_up_time(turntable: Turntable, tolerance: float = 1e-4) -> float:
    """Return the time from rest until the speed is within ``tolerance`` of the set speed, s.

    Closed form of J w' = T - c w: full torque until the controller asks for less, then an exponential
    approach with the rate (gain + c)/J.

    Raises
    ------
    ValueError
        If the torque cannot hold the set speed against the drag.
    """
    t = turntable
    drag_torque = t.drag * t.speed
    if drag_torque >= t.torque:
        raise ValueError(
            f"the drive's {t.torque:.4g} N m cannot hold {t.speed:.4g} rad/s against a drag of {drag_torque:.4g} N m"
        )
    limit = max(t.speed - (t.torque - drag_torque) / t.speed_gain, 0.0)
    full = t.turning * limit / t.torque * _log_share(-t.drag * limit / t.torque)
    error = t.speed - limit
    approach = t.turning / (t.speed_gain + t.drag) * math.log(max(error / (tolerance * t.speed), 1.0))
    return full + approach


def speed_after_wait(turntable: Turntable, wait: float, tolerance: float = 1e-4) -> float:
    """Return the speed after waiting at speed, rad/s: the rest of the error dies out exponentially."""
    rate = (turntable.speed_gain + turntable.drag) / turntable.turning
    return turntable.speed * (1.0 - tolerance * math.exp(-rate * wait))


def braking_time(turntable: Turntable, speed: float) -> float:
    """Return the time from a speed to rest under brake and drag, s: (J/c) ln(1 + c w / T_brake)."""
    t = turntable
    return t.turning * speed / t.brake * _log_share(t.drag * speed / t.brake)


def _log_share(x: float) -> float:
    """Return ln(1 + x)/x, 1 at x = 0."""
    # below, the next term of the series, x^2/3, is less than rounding
    return math.log1p(x) / x if abs(x) > 1e-9 else 1.0 - 0.5 * x


@dataclass(frozen=True)
class Feed:
    """Valve, stroke and timing of the feed.

    Both ways the speed rises as (1 - cos)/2 over a share of the time, stays, and falls alike over another, the
    cushioning; with halves the way is cycloidal, s = u - sin(2 pi u)/(2 pi).
    """

    wait: float
    """Time at speed before the valve signal, s."""
    valve_delay: float
    """Time from valve signal to first motion, s."""
    stroke: float
    """Way of the carriage, m."""
    stroke_time: float
    """s."""
    arrival: float
    """End of the stroke in the striking period, 0 to 1 after the last striker's apex; it times the valve signal."""
    blows: int
    """Wanted number of passes; the retract command comes at the apex of the last."""
    release_delay: float
    """Time from retract command to first motion, s."""
    retract_time: float
    """s."""
    acceleration: float = 0.5
    """Share of the time of a stroke in which it speeds up."""
    cushion: float = 0.5
    """Share in which it is cushioned; both together 1 at most."""
    hold: float = math.inf
    """Longest time in the strike position, s, after which the retract command comes, blows or not."""

    @property
    def fastest(self) -> float:
        """Highest speed of the stroke, m/s: (way/time) / (1 - (acceleration + cushion)/2)."""
        return self.stroke / self.stroke_time / (1.0 - 0.5 * (self.acceleration + self.cushion))


def angle_at_valve_signal(feed: Feed, speed: float, pitch: float) -> float:
    """Return the turntable's angle at the valve signal, in 0..pitch, rad.

    Chosen so that, at the given speed, the stroke ends ``arrival`` of a pitch after a striker's apex.
    """
    travelled = speed * (feed.valve_delay + feed.stroke_time)
    return (feed.arrival * pitch - travelled) % pitch


def expected_time(feed: Feed, pitch_time: float) -> float:
    """Return about how long it takes from the valve signal to the end of the retraction, s."""
    way = feed.valve_delay + feed.stroke_time + feed.release_delay + feed.retract_time
    return way + min((feed.blows + 1) * pitch_time, feed.hold)
