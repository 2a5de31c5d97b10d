"""The pulse of a drop table on its shaper, and the drop that gives the one wanted."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from strikewave.base.constants import STANDARD_GRAVITY
from strikewave.contact.dampers import cut_off_damping_ratio
from strikewave.contact.impact import solve_impact
from strikewave.contact.law import AnyContact, Contact, Damper, not_negative, positive, refuse


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

    Examples
    --------
    >>> pulse = shaper_pulse(Contact(7.9e8, 1.0), speed=2.35, mass=20.0)
    >>> print(round(pulse.peak / 9.80665), round(pulse.width * 1e3, 4), round(pulse.velocity_change, 6))
    1506 0.4999 4.7
    """
    blow = solve_impact(contact, mass, math.inf, speed)
    change = (1.0 + float(blow.restitution)) * speed
    return TablePulse(float(blow.peak_force) / mass, float(blow.duration), change, float(blow.max_indentation))


def linear_shaper(stiffness: float, mass: float, restitution: float = 1.0) -> Contact:
    """Return a linear shaper that throws a table back with a restitution: spring and dashpot that never pull.

    The damping is that of Schwager & Poschel 2007. The pulse of such a shaper is no half sine: it begins with a step.

    Examples
    --------
    >>> pulse = shaper_pulse(linear_shaper(7.9e8, 20.0, restitution=0.5), speed=2.35, mass=20.0)
    >>> round(pulse.velocity_change / 2.35, 6)
    1.5
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

    Examples
    --------
    >>> drop = drop_for_half_sine(1500 * 9.80665, 0.5e-3, restitution=0.0)
    >>> print(round(drop.speed, 2), round(drop.height, 3))
    4.68 1.118
    """
    a, t, g = (float(positive(*pair)) for pair in (("the peak", peak), ("the width", width), ("gravity", gravity)))
    refuse("the restitution", restitution, np.asarray(0.0 <= restitution <= 1.0), "within 0 to 1")
    speed = 2.0 * a * t / (math.pi * (1.0 + restitution))
    return ShapedDrop(speed, 0.5 * speed**2 / g, (math.pi / t) ** 2)
