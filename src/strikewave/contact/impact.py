"""One blow of two free bodies: the exact answer in closed form."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from strikewave.contact import _kernels


@dataclass(frozen=True)
class Contact:
    """The force law of a contact, F = K d^n (1 + chi d'/v0), never negative.

    Parameters
    ----------
    stiffness : array_like
        K, N/m^n.
    exponent : array_like
        n, at least 0.1.
    hysteresis_factor : array_like, optional
        chi; 0 is elastic. v0 is the approach speed of the contact.
    """

    stiffness: ArrayLike
    exponent: ArrayLike
    hysteresis_factor: ArrayLike = 0.0


@dataclass(frozen=True)
class Impact:
    """What comes out of an impact; every attribute has the broadcast shape of the input.

    Attributes
    ----------
    restitution : ndarray
        Separation speed over approach speed.
    max_indentation : ndarray
        Largest indentation, m.
    peak_force : ndarray
        Largest force, N.
    duration : ndarray
        Length of the contact, s.
    energy_lost : ndarray
        Kinetic energy lost, J.
    """

    restitution: NDArray[np.float64]
    max_indentation: NDArray[np.float64]
    peak_force: NDArray[np.float64]
    duration: NDArray[np.float64]
    energy_lost: NDArray[np.float64]


def reduced_mass(mass1: ArrayLike, mass2: ArrayLike) -> NDArray[np.float64]:
    """Return m1 m2 / (m1 + m2), either of which may be infinite, kg.

    Raises
    ------
    ValueError
        If a mass is not positive, or both are infinite.

    Examples
    --------
    >>> print(reduced_mass(0.2, np.inf), reduced_mass(2.0, 2.0))
    0.2 1.0
    """
    one, other = np.broadcast_arrays(np.asarray(mass1, dtype=float), np.asarray(mass2, dtype=float))
    if not np.all((one > 0.0) & (other > 0.0)):
        raise ValueError(f"masses must be positive, got {mass1!r} and {mass2!r}")
    if np.any(np.isinf(one) & np.isinf(other)):
        raise ValueError("one of the masses must be finite")
    return np.asarray(1.0 / (1.0 / one + 1.0 / other))


def elastic_indentation(contact: Contact, mass: float, speed: float) -> float:
    """Return the largest indentation without losses, [(n + 1) m v0^2 / (2 K)]^(1/(n + 1)), m.

    Examples
    --------
    >>> round(elastic_indentation(Contact(1e9, 1.0), mass=1.0, speed=1.0) * 1e6, 3)
    31.623
    """
    n, k = float(np.asarray(contact.exponent)), float(np.asarray(contact.stiffness))
    return float(((n + 1.0) * mass * speed**2 / (2.0 * k)) ** (1.0 / (n + 1.0)))


def solve_impact(contact: Contact, mass1: ArrayLike, mass2: ArrayLike, speed: ArrayLike) -> Impact:
    """Solve the impact of two free bodies exactly.

    All arguments broadcast against each other; a million impacts take about two seconds.

    Parameters
    ----------
    contact : Contact
        The force law.
    mass1, mass2 : array_like
        Masses, kg; at most one of them infinite.
    speed : array_like
        Approach speed v0, m/s.

    Returns
    -------
    Impact
        Restitution to 1e-15, indentation and force to 1e-14, duration to 1e-10 (e > 0.001, n from 1 to 2).

    Raises
    ------
    ValueError
        If a stiffness, mass or speed is not positive, an exponent is not within 0.1 to 10, or a factor is negative.

    Notes
    -----
    Source: the integral of the phase plane in ``contact/_kernels.py``; the duration by the double
    exponential rule (Takahasi & Mori 1974).

    Examples
    --------
    Two glass spheres of 10 mm radius at 20 m/s:

    >>> import math
    >>> from strikewave.contact import Contact, solve_impact
    >>> ball = 4 / 3 * math.pi * 0.01**3 * 2800
    >>> stiffness = 4 / 3 * 48e9 / (2 * (1 - 0.2**2)) * math.sqrt(0.005)
    >>> result = solve_impact(Contact(stiffness, 1.5), ball, ball, 20.0)
    >>> print(round(float(result.peak_force), 1), round(float(result.duration) * 1e6, 3))
    10696.9 40.339
    """
    mass = reduced_mass(mass1, mass2)
    (k, n, chi, m, v), shape = _kernels.flat(
        contact.stiffness, contact.exponent, contact.hysteresis_factor, mass, speed
    )
    for name, values in (("stiffness", k), ("speed", v)):
        if not np.all((values > 0.0) & np.isfinite(values)):
            raise ValueError(
                f"{name} must be positive and finite, got {values[~((values > 0) & np.isfinite(values))][0]!r}"
            )
    if not np.all((n >= 0.1) & (n <= 10.0)):
        raise ValueError("the exponent must lie within 0.1 to 10")
    if not np.all((chi >= 0.0) & np.isfinite(chi)):
        raise ValueError("the hysteresis factor must be finite and >= 0")
    out = np.empty((4, k.size))
    _kernels.impacts(k, n, chi, m, v, out)
    e, depth, force, duration = (row.reshape(shape) for row in out)
    with np.errstate(over="ignore", invalid="ignore"):
        lost = (0.5 * m * v**2).reshape(shape) * (1.0 - e) * (1.0 + e)
    return Impact(e, depth, force, duration, lost)
