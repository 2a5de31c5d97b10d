"""How fast the projectile of a gas gun leaves the muzzle."""

from __future__ import annotations

import math
from dataclasses import dataclass

import scipy

from strikewave.contact.law import not_negative, positive

STANDARD_ATMOSPHERE = 101325.0
"""Pa."""
NEAR_ISOTHERMAL = 1e-6
"""Heat ratio above 1 below which a gas is taken as isothermal: the sums of powers then cancel to as many digits as this
limit leaves out."""


@dataclass(frozen=True)
class GunBarrel:
    """A reservoir, a barrel and a projectile.

    Parameters
    ----------
    pressure : float
        Of the reservoir before the shot, absolute, Pa.
    volume : float
        Of the reservoir, m^3.
    bore : float
        Area of the barrel, m^2.
    length : float
        Way of the projectile in the barrel, m.
    mass : float
        Of the projectile, kg.
    friction : float, optional
        In the barrel, N.
    ambient : float, optional
        Pressure before the projectile, Pa; 0 in an evacuated barrel.
    heat_ratio : float, optional
        gamma of the gas; 1 for an isothermal expansion.
    """

    pressure: float
    volume: float
    bore: float
    length: float
    mass: float
    friction: float = 0.0
    ambient: float = STANDARD_ATMOSPHERE
    heat_ratio: float = 1.4

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

    Examples
    --------
    >>> gun = GunBarrel(pressure=5e5, volume=4e-3, bore=1.2e-3, length=1.0, mass=0.2)
    >>> round(muzzle_speed(gun), 2)
    61.36
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

    Examples
    --------
    >>> gun = GunBarrel(pressure=5e5, volume=4e-3, bore=1.2e-3, length=1.0, mass=0.2)
    >>> round(wave_muzzle_speed(gun, sound_speed=343.0), 2)
    70.21
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

    Examples
    --------
    >>> gun = GunBarrel(pressure=5e5, volume=4e-3, bore=1.2e-3, length=1.0, mass=0.2)
    >>> round(reservoir_muzzle_speed(gun, sound_speed=343.0), 2)
    76.78
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
    """Tell whether a gas is so near an isothermal one that the limit is exact to that difference."""
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
    while missing(lowest) < 0.0:
        lowest *= 2.0
    return start + b * -math.expm1(scipy.optimize.brentq(missing, lowest, 0.0, xtol=1e-300, rtol=1e-14))
