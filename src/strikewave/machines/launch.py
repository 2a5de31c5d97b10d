"""Launch of a striker: fall, pendulum, Machete hammer, gas gun, and the pulse of a drop table.

One law, one short function. A striker bar needs none of its own: `strikewave.hopkinson.bars.StrikerBar` gives the
strain v/(2c) and the duration 2L/c of the pulse that it makes.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import scipy
from numpy.typing import ArrayLike, NDArray

from strikewave.base.constants import STANDARD_GRAVITY
from strikewave.contact.damping import cut_off_damping_ratio
from strikewave.contact.impact import solve_impact
from strikewave.contact.law import AnyContact, Contact, Damper, not_negative, positive, refuse

Array = NDArray[np.float64]

_NEAR_BRANCH = 0.02
"""Distance from its branch point below which Lambert's W comes from its series, which keeps all digits there."""


def fall_speed(
    height: ArrayLike,
    gravity: float = STANDARD_GRAVITY,
    friction: ArrayLike = 0.0,
    viscous: ArrayLike = 0.0,
    drag: ArrayLike = 0.0,
) -> Array:
    """Return the speed after a fall from rest, m/s.

    With g' = g (1 - friction), v = sqrt(2 g' h); against a viscous guide, v' = g' - r v, the speed is
    (g'/r) (1 + W(-exp(-1 - r^2 h/g'))), W Lambert's function; against a drag, v' = g' - c v^2, it is
    sqrt(g' (1 - exp(-2 c h))/c). Theory: :eq:`machine-fall`.

    Parameters
    ----------
    height : array_like
        h, m.
    gravity : float, optional
        g, m/s^2.
    friction : array_like, optional
        Friction of the guide as a share of the weight, 0 to 1.
    viscous : array_like, optional
        Viscous friction of the guide over the mass, r, 1/s.
    drag : array_like, optional
        Quadratic drag over the mass, c, 1/m.

    Returns
    -------
    ndarray
        In the broadcast shape of the input, m/s.

    Raises
    ------
    ValueError
        If a number is out of range, or both viscous friction and drag are given.

    Notes
    -----
    Source: Newton's law, v dv/dh = v', integrated.

    Examples
    --------
    >>> print(fall_speed([0.5, 1.0]).round(4), fall_speed(1.0, friction=0.05).round(4))
    [3.1316 4.4287] 4.3166
    >>> print(fall_speed(1.0, viscous=0.1).round(4), fall_speed(1.0, drag=0.1).round(4))
    4.3623 4.2162
    """
    h, c, r = not_negative("the height", height), not_negative("the drag", drag), not_negative("the friction", viscous)
    share = np.asarray(friction, dtype=float)
    refuse("the friction of the guide", share, (share >= 0.0) & (share < 1.0), "from 0 to below 1, a share of weight")
    if np.any(r > 0.0) and np.any(c > 0.0):
        raise ValueError("a fall has viscous friction or drag, not both")
    pull = positive("gravity", gravity) * (1.0 - share)
    guided = np.where(r > 0.0, _viscous_share(r**2 * h / pull), np.sqrt(_saturation(2.0 * c * h)))
    return np.asarray(np.sqrt(2.0 * pull * h) * guided)


def _saturation(x: Array) -> Array:
    """Return (1 - exp(-x))/x, 1 at x = 0."""
    return np.where(x > 0.0, -np.expm1(-x) / np.where(x > 0.0, x, 1.0), 1.0)


def _viscous_share(x: Array) -> Array:
    """Return (1 + W(-exp(-1 - x)))/sqrt(2 x) for x >= 0: speed in a viscous guide over that of a free fall."""
    p = np.sqrt(2.0 * x * _saturation(x))
    series = 1.0 + p * (-1 / 3 + p * (11 / 72 + p * (-43 / 540 + p * (769 / 17280 - p * 221 / 8505))))
    closed_form = (1.0 + scipy.special.lambertw(-np.exp(-1.0 - x)).real) / np.sqrt(2.0 * np.where(x > 0.0, x, 1.0))
    return np.where(p < _NEAR_BRANCH, np.sqrt(_saturation(x)) * series, closed_form)


def corded_fall(
    height: float, mass: float, force: float = 0.0, stiffness: float = 0.0, friction: float = 0.0
) -> tuple[float, float]:
    """Return speed (m/s) and time (s) of a fall from rest that elastic cords pull along.

    With the pull F = F0 + k (h - x) after the way x, v^2 = 2 g (1 - friction) h + (2 F0 h + k h^2)/m. The acceleration
    a0 + k (h - x)/m makes x = (a/c) (1 - cos(sqrt(c) t)), a = a0 + c h, c = k/m.

    Parameters
    ----------
    height : float
        h, m.
    mass : float
        Falling mass, m, kg.
    force : float, optional
        Pull of all cords where the fall ends, F0, N.
    stiffness : float, optional
        Stiffness of all cords, k, N/m.
    friction : float, optional
        Friction of the guide as a share of the weight, 0 to 1.

    Raises
    ------
    ValueError
        If a number is out of range.

    Notes
    -----
    Source: Newton's law, m v dv/dx = m g (1 - friction) + F, integrated.
    """
    free = float(fall_speed(height, friction=friction))
    m, end, k = positive("the mass", mass), not_negative("the force", force), not_negative("the stiffness", stiffness)
    speed = math.sqrt(free**2 + float(2.0 * end * height + k * height**2) / float(m))
    last = STANDARD_GRAVITY * (1.0 - friction) + float(end / m)
    ratio = float(k / m) * height / last
    # 1 - cos = ratio/(1 + ratio); by the half angle, which keeps its digits where the cords are soft
    angle = 2.0 * math.asin(math.sqrt(0.5 * ratio / (1.0 + ratio)))
    time = angle / math.sqrt(float(k / m)) if k > 0.0 else 2.0 * height / speed
    return speed, time


@dataclass(frozen=True)
class RigidPendulum:
    """A rigid pendulum that strikes."""

    mass: float
    """kg."""
    centre: float
    """Pivot to centre of gravity, m."""
    inertia: float
    """Moment of inertia about the pivot, kg m^2; at least mass times centre squared."""
    radius: float
    """Pivot to the point that strikes, m."""

    def __post_init__(self) -> None:
        for name in ("mass", "centre", "inertia", "radius"):
            positive(f"the {name} of the pendulum", getattr(self, name))
        least = self.mass * self.centre**2
        if self.inertia < least * (1.0 - 1e-12):  # a point mass has exactly this inertia, but for rounding
            raise ValueError(
                f"the inertia about the pivot must be at least mass times centre squared, {least:g} kg m^2"
            )

    @property
    def effective_mass(self) -> float:
        """Mass that a body would feel at the point that strikes, J/R^2, kg."""
        return self.inertia / self.radius**2

    @property
    def reduced_length(self) -> float:
        """Length of the simple pendulum of the same period, J/(m r), m: strike there and the pivot feels nothing."""
        return self.inertia / (self.mass * self.centre)


def inertia_of_period(mass: float, centre: float, period: float, gravity: float = STANDARD_GRAVITY) -> float:
    """Return the moment of inertia about the pivot from the period of small swings, m g r (t/2 pi)^2, kg m^2.

    Source: t = 2 pi sqrt(J/(m g r)) of a rigid body that swings little; the way of ISO 148-2.
    """
    return mass * gravity * centre * (period / (2.0 * math.pi)) ** 2


def pendulum_energy(
    pendulum: RigidPendulum, angle: ArrayLike, strike_angle: float = 0.0, gravity: float = STANDARD_GRAVITY
) -> Array:
    """Return the energy of a pendulum let go at an angle when it strikes, m g r (cos b - cos a), J.

    Parameters
    ----------
    pendulum : RigidPendulum
        Pendulum that swings.
    angle : array_like
        a, from hanging, rad; up to pi.
    strike_angle : float, optional
        b, from hanging, rad.
    gravity : float, optional
        m/s^2.

    Raises
    ------
    ValueError
        If it does not fall from one angle to the other.
    """
    a = np.asarray(angle, dtype=float)
    refuse("the angle of release", a, (np.abs(a) <= math.pi) & (np.abs(a) >= abs(strike_angle)), "above the strike's")
    fall = 2.0 * np.sin(0.5 * (a + strike_angle)) * np.sin(0.5 * (a - strike_angle))
    return np.asarray(pendulum.mass * gravity * pendulum.centre * fall)


def pendulum_speed(
    pendulum: RigidPendulum, angle: ArrayLike, strike_angle: float = 0.0, gravity: float = STANDARD_GRAVITY
) -> Array:
    """Return the speed of the striking point of a pendulum let go at an angle, R sqrt(2 E/J), m/s.

    A simple pendulum (J = m r^2, R = r) gives the sqrt(2 g L (1 - cos a)) of ISO 13802 and ISO 148-2. See
    `pendulum_energy`.
    """
    energy = pendulum_energy(pendulum, angle, strike_angle, gravity)
    return np.asarray(pendulum.radius * np.sqrt(2.0 * energy / pendulum.inertia))


@dataclass(frozen=True)
class MacheteHammer:
    """A hammer arm on a ratchet wheel: each tooth turns it back by one pitch and lifts a weight that drives it.

    The weight is held by a rope from a drum on the arm's shaft; a drum without a weight leaves an arm that falls by
    itself. The rope pushes nothing: when the head strikes, the weight takes no part.
    """

    teeth: int
    """Teeth on the whole wheel."""
    inertia: float
    """Moment of inertia of arm, head and counterweight about the shaft, kg m^2."""
    radius: float
    """Shaft to the point that strikes, m."""
    unbalance: float = 0.0
    """Mass of the arm times the distance of its centre of gravity, kg m; 0 with a full counterweight."""
    weight: float = 0.0
    """Mass of the driving weight, kg."""
    drum: float = 0.0
    """Radius of its drum, m."""
    friction: float = 0.0
    """Torque of friction, N m."""
    strike_angle: float = 0.0
    """Angle of the arm at the strike, from hanging down, rad."""

    def __post_init__(self) -> None:
        for name in ("teeth", "inertia", "radius"):
            positive(f"the {name} of the hammer", getattr(self, name))
        for name in ("unbalance", "weight", "drum", "friction"):
            not_negative(f"the {name} of the hammer", getattr(self, name))

    @property
    def pitch(self) -> float:
        """Angle of a tooth, rad."""
        return 2.0 * math.pi / self.teeth

    @property
    def turning_inertia(self) -> float:
        """Inertia of what turns before the strike, the weight on its drum included, kg m^2."""
        return self.inertia + self.weight * self.drum**2

    @property
    def effective_mass(self) -> float:
        """Mass that a body would feel at the point that strikes, without the weight on its rope, kg."""
        return self.inertia / self.radius**2


def machete_energy(hammer: MacheteHammer, teeth: ArrayLike, gravity: float = STANDARD_GRAVITY) -> Array:
    """Return the energy of the whole hammer when it strikes after a number of teeth, weight included, J.

    With the angle a = n 2 pi/N, the drum r, the weight M, the arm's unbalance u and the strike at the angle b from
    hanging, E = M g r a + u g (cos b - cos(a + b)) - T a.

    Parameters
    ----------
    hammer : MacheteHammer
        The hammer.
    teeth : array_like
        n, from 0; a part of a tooth holds nowhere and is refused.
    gravity : float, optional
        m/s^2.

    Raises
    ------
    ValueError
        If it is no number of teeth, or the arm does not come down from there.

    Notes
    -----
    Source: work of the weights. The build of the hammer (ratchet, arm, weight, tooth number) is from memory; Phan &
    Duong 2024 tell of a hammer for parts of weapons that is set by the angle to which it is lifted.
    """
    n = np.asarray(teeth, dtype=float)
    refuse("the number of teeth", n, (n >= 0.0) & (n == np.floor(n)) & np.isfinite(n), "a whole number from 0")
    angle = n * hammer.pitch
    lifted = 2.0 * np.sin(0.5 * angle + hammer.strike_angle) * np.sin(0.5 * angle)
    drive = hammer.weight * gravity * hammer.drum - hammer.friction
    energy = np.asarray(drive * angle + hammer.unbalance * gravity * lifted)
    refuse("the energy from this tooth, J,", energy, energy >= 0.0, "positive, or the arm stays: see its friction")
    return energy


def machete_speed(hammer: MacheteHammer, teeth: ArrayLike, gravity: float = STANDARD_GRAVITY) -> Array:
    """Return the speed at which a Machete hammer strikes after a number of teeth, R sqrt(2 E/(J + M r^2)), m/s.

    See `machete_energy`. A balanced arm gives a speed that goes as the root of the number of teeth.
    """
    return np.asarray(hammer.radius * np.sqrt(2.0 * machete_energy(hammer, teeth, gravity) / hammer.turning_inertia))


def rope_tension(hammer: MacheteHammer, teeth: int, gravity: float = STANDARD_GRAVITY) -> float:
    """Return the least force in the rope of a Machete hammer on its way, M (g - r w'), N; 0 without a weight.

    The turning is w' = (M g r + u g sin(c) - T)/(J + M r^2) at the angle c from hanging; see `machete_energy`. A
    negative force no rope can bear: it is slack there.
    """
    begin, end = hammer.strike_angle + teeth * hammer.pitch, hammer.strike_angle
    crests = [c for c in (0.5 * math.pi, 2.5 * math.pi) if end <= c <= begin]
    steepest = 1.0 if crests else max(math.sin(begin), math.sin(end))
    torque = hammer.weight * gravity * hammer.drum + hammer.unbalance * gravity * steepest - hammer.friction
    return hammer.weight * (gravity - hammer.drum * torque / hammer.turning_inertia)


STANDARD_ATMOSPHERE = 101325.0
"""Pa."""
NEAR_ISOTHERMAL = 1e-6  # the sums of powers then cancel to as many digits as this limit leaves out
"""Excess of the heat ratio over 1 below which a gas is taken as isothermal."""


@dataclass(frozen=True)
class GunBarrel:
    """A reservoir, a barrel and a projectile."""

    pressure: float
    """Pressure of the reservoir before the shot, absolute, Pa."""
    volume: float
    """Volume of the reservoir, m^3."""
    bore: float
    """Area of the barrel, m^2."""
    length: float
    """Way of the projectile in the barrel, m."""
    mass: float
    """Mass of the projectile, kg."""
    friction: float = 0.0
    """Friction in the barrel, N."""
    ambient: float = STANDARD_ATMOSPHERE
    """Pressure before the projectile, Pa; 0 in an evacuated barrel."""
    heat_ratio: float = 1.4
    """gamma of the gas; 1 for an isothermal expansion."""

    def __post_init__(self) -> None:
        for name in ("pressure", "volume", "bore", "length", "mass"):
            positive(f"the {name} of the gas gun", getattr(self, name))
        for name in ("friction", "ambient"):
            not_negative(f"the {name} of the gas gun", getattr(self, name))
        if not 1.0 <= self.heat_ratio <= 5.0 / 3.0 + 1e-9:
            raise ValueError(f"the heat ratio of a gas lies within 1 to 5/3, got {self.heat_ratio!r}")

    @property
    def held_back(self) -> float:
        """Force of friction and ambient pressure on the projectile, N."""
        return self.friction + self.ambient * self.bore


def muzzle_speed(gun: GunBarrel) -> float:
    """Return the muzzle speed of a projectile before a gas that expands without inertia, m/s.

    With the swept volume A L, m v^2/2 = P V (1 - (V/(V + A L))^(g - 1))/(g - 1) - A L P_amb - L f, and
    P V ln(1 + A L/V) at g = 1.

    Raises
    ------
    ValueError
        If the gas cannot push the projectile to the muzzle.

    Notes
    -----
    Source: Rohrbach et al. 2012, eqs (2) and (3), who measured less than both, since their valve throttled. Holds
    while the speed is far below the speed of sound in the gas (compare `wave_muzzle_speed`), the gas is light beside
    the projectile and no valve throttles: an upper bound.
    """
    swept, g = gun.bore * gun.length, gun.heat_ratio - 1.0
    grown = math.log1p(swept / gun.volume)
    work = gun.pressure * gun.volume * (grown if g == 0.0 else -math.expm1(-g * grown) / g)
    left = work - gun.length * gun.held_back
    if left <= 0.0 or gun.pressure * gun.bore <= gun.held_back:
        raise ValueError(
            f"the gas cannot push the projectile to the muzzle: it works {work:.4g} J and friction with ambient "
            f"pressure takes {gun.length * gun.held_back:.4g} J"
        )
    return math.sqrt(2.0 * left / gun.mass)


def wave_muzzle_speed(gun: GunBarrel, sound_speed: float) -> float:
    """Return the muzzle speed where gas must follow by its own inertia, from a chamber no wider than the barrel, m/s.

    In a long chamber of the bore of the barrel the gas behind a projectile at the speed u has the pressure
    P s^n with s = 1 - (g - 1) u/(2 a) and n = 2 g/(g - 1), and Newton's law, without friction and ambient pressure,

        L = (m/(P A)) (2 a/(g - 1))^2 [(s^(1 - n) - 1)/(n - 1) - (s^(2 - n) - 1)/(n - 2)];

    an isothermal gas has the pressure P exp(-u/a), its limit for g = 1. A wider chamber gives more: see
    `reservoir_muzzle_speed`.

    Parameters
    ----------
    gun : GunBarrel
        The gun; its volume, friction and ambient pressure are not asked.
    sound_speed : float
        a of the gas at rest, m/s.

    Raises
    ------
    ValueError
        If the sound speed is not positive.

    Notes
    -----
    Source: u + 2 c/(g - 1) stays the same across the waves that run into the gas at rest, c the speed of sound, and
    P/c^n along an isentrope; integrated here. See Siegel 1965. Holds until the first wave comes back from the end of
    the chamber. The speed never reaches 2 a/(g - 1).
    """
    a = float(positive("the speed of sound", sound_speed))
    return _behind_a_wave(gun.length * gun.pressure * gun.bore / gun.mass, a, 0.0, gun.heat_ratio)


def reservoir_muzzle_speed(gun: GunBarrel, sound_speed: float) -> float:
    """Return the muzzle speed where the gas must follow by its own inertia, from an endless wide reservoir, m/s.

    Gas that stands in a wide reservoir enters the barrel in steady flow, at the speed of sound at most. What follows
    the projectile has come in no faster than it flies, so the pressure behind it is at most that of the steady flow,
    P [1 - (g - 1) u^2/(2 a^2)]^(g/(g - 1)), up to the speed of sound there, u = a sqrt(2/(g + 1)), and from there on
    that of a wave that starts with this speed. Newton's law then gives up to there

        u^2 = (2 a^2/(g - 1)) [1 - (1 + P A L/(m a^2))^(1 - g)],

    and an upper bound for every reservoir; `wave_muzzle_speed` is the other end.

    Parameters
    ----------
    gun : GunBarrel
        The gun; its volume, friction and ambient pressure are not asked.
    sound_speed : float
        a of the gas at rest, m/s.

    Raises
    ------
    ValueError
        If the sound speed is not positive.

    Notes
    -----
    Source: steady flow from rest, and the forward characteristics u + 2 c/(g - 1) of gas in a barrel, along which that
    sum is the one at the entrance; it grows with the speed there up to the speed of sound. Integrated here.
    """
    a, g = float(positive("the speed of sound", sound_speed)), gun.heat_ratio
    way = gun.length * gun.pressure * gun.bore / (gun.mass * a**2)
    sonic = math.sqrt(2.0 / (g + 1.0))
    ratio = math.exp(-0.5) if _isothermal(g) else sonic ** (2.0 * g / (g - 1.0))
    to_sonic = sonic**2 / ratio - 1.0  # density at rest over that at the speed of sound, less 1
    if way <= to_sonic:
        taken = math.log1p(way) if _isothermal(g) else -math.expm1((1.0 - g) * math.log1p(way)) / (g - 1.0)
        return a * math.sqrt(2.0 * taken)
    return _behind_a_wave((way - to_sonic) * ratio * a**2, sonic * a, sonic * a, g)


def _isothermal(heat_ratio: float) -> bool:
    """Return whether a gas is so near an isothermal one that the limit is exact to that difference."""
    return heat_ratio - 1.0 < NEAR_ISOTHERMAL


def _behind_a_wave(drive: float, sound_speed: float, start: float, heat_ratio: float) -> float:
    """Return the speed of a projectile that a simple wave follows, m/s.

    It begins with the speed ``start`` u0, gas of the same speed and the sound speed c behind it. With b = 2 c/(g - 1),
    U = u0 + b, s = (U - u)/b and n = 2 g/(g - 1), ``drive`` = p A L/m = b [U (s^(1 - n) - 1)/(n - 1) -
    b (s^(2 - n) - 1)/(n - 2)]; at g = 1 it is c^2 [(u/c - 1) exp((u - u0)/c) - u0/c + 1].
    """
    c, g = sound_speed, heat_ratio
    if _isothermal(g):
        x = start / c
        # W of the smallest argument, -1/e, is where rounding could leave its real branch
        inside = max((drive / c**2 + x - 1.0) * math.exp(x - 1.0), -math.exp(-1.0))
        return c * (1.0 + float(scipy.special.lambertw(inside).real))
    n, b = 2.0 * g / (g - 1.0), 2.0 * c / (g - 1.0)
    escape = start + b

    def missing(log_s: float) -> float:
        fast = escape * math.expm1((1.0 - n) * log_s) / (n - 1.0)
        return fast - b * math.expm1((2.0 - n) * log_s) / (n - 2.0) - drive / b

    lowest = -1.0 / n
    while missing(lowest) < 0.0:  # the slowest gas: doubled until the root is bracketed
        lowest *= 2.0
    return start + b * -math.expm1(scipy.optimize.brentq(missing, lowest, 0.0, xtol=1e-300, rtol=1e-14))


class TablePulse(NamedTuple):
    """Pulse of a table on its shaper: peak (m/s^2), width (s), velocity change (m/s), crush of the shaper (m)."""

    peak: float
    width: float
    velocity_change: float
    crush: float


def half_sine_pulse(speed: float, mass: float, stiffness: float, gravity: float = 0.0) -> TablePulse:
    """Return the pulse of a table that falls on a linear shaper without loss.

    With w = sqrt(k/m): v w and pi/w, half a sine. Gravity adds its own: the peak is sqrt((v w)^2 + g^2), the table
    leaves the shaper after (2/w) (pi - arctan(v w/g)), and the crush is (g + sqrt((v w)^2 + g^2))/w^2.
    Theory: :eq:`machine-programmer`.

    Parameters
    ----------
    speed : float
        v at first touch, m/s.
    mass : float
        m of the table with what it carries, kg.
    stiffness : float
        k of the shaper, N/m.
    gravity : float, optional
        g, m/s^2; 0 leaves it out, as usual.

    Returns
    -------
    TablePulse
        Peak (m/s^2), width (s), velocity change (m/s) and crush (m).

    Raises
    ------
    ValueError
        If a number is out of range.

    Notes
    -----
    Source: the solution of m x'' = m g - k x with x = 0 and x' = v at first touch.

    Examples
    --------
    >>> pulse = half_sine_pulse(2.35, mass=20.0, stiffness=7.9e8)
    >>> print(round(pulse.peak / 9.80665), round(pulse.width * 1e3, 4), pulse.velocity_change)
    1506 0.4999 4.7
    """
    v, m, k = (float(positive(*pair)) for pair in (("speed", speed), ("mass", mass), ("stiffness", stiffness)))
    g = float(not_negative("gravity", gravity))
    w = math.sqrt(k / m)
    peak = math.hypot(v * w, g)
    return TablePulse(peak, 2.0 * (math.pi - math.atan2(v * w, g)) / w, 2.0 * v, (g + peak) / w**2)


def shaper_pulse(contact: AnyContact, speed: float, mass: float) -> TablePulse:
    """Return the pulse of a table that falls on a shaper of any contact law; gravity is left out during the pulse.

    The peak of m v'' = -F, the whole duration of the contact and (1 + e) v, by `strikewave.contact.solve_impact`.
    """
    blow = solve_impact(contact, mass, math.inf, speed)
    change = (1.0 + float(blow.restitution)) * speed
    return TablePulse(float(blow.peak_force) / mass, float(blow.duration), change, float(blow.max_indentation))


def linear_shaper(stiffness: float, mass: float, restitution: float = 1.0) -> Contact:
    """Return a linear shaper that throws a table back with a restitution: spring and dashpot that never pull.

    The damping is that of Schwager & Poschel 2007. The pulse of such a shaper is no half sine: it begins with a step.
    """
    coefficient = 2.0 * float(cut_off_damping_ratio(restitution)) * math.sqrt(stiffness * mass)
    return Contact(stiffness, 1.0, damper=Damper(coefficient) if coefficient > 0.0 else None)


class ShapedDrop(NamedTuple):
    """A drop that makes a pulse: speed (m/s), height (m), stiffness of the shaper over the mass (1/s^2)."""

    speed: float
    height: float
    stiffness_over_mass: float


def drop_for_half_sine(
    peak: float, width: float, restitution: float = 1.0, gravity: float = STANDARD_GRAVITY
) -> ShapedDrop:
    """Return the drop whose pulse is a half sine of a wanted peak and width.

    The velocity change 2 A T/pi is (1 + e) v: v = 2 A T/(pi (1 + e)), h = v^2/(2 g), k/m = (pi/T)^2. Without loss it
    undoes `half_sine_pulse`; with e = 0 the height is the equivalent drop height of JESD22-B104.

    Parameters
    ----------
    peak : float
        A, m/s^2.
    width : float
        T from zero to zero, s.
    restitution : float, optional
        e of the table on its shaper, 0 to 1.
    gravity : float, optional
        m/s^2.

    Raises
    ------
    ValueError
        If a number is out of range.
    """
    a, t, g = (float(positive(*pair)) for pair in (("the peak", peak), ("the width", width), ("gravity", gravity)))
    refuse("the restitution", restitution, np.asarray(0.0 <= restitution <= 1.0), "within 0 to 1")
    speed = 2.0 * a * t / (math.pi * (1.0 + restitution))
    return ShapedDrop(speed, 0.5 * speed**2 / g, (math.pi / t) ** 2)
