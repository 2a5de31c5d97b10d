"""Speed of waves of different frequency along a round bar.

In a bar the sides move in and out, so that short waves run slower than the bar speed c0 = sqrt(E/rho). The first
longitudinal mode of the Pochhammer-Chree theory is exact for an endless bar; the Love-Rayleigh theory adds only the
sideways inertia: to 0.4 % up to d/Lambda = 0.3 in steel.

Symbols: w angular frequency (rad/s), k wave number (1/m), Lambda = 2 pi/k wavelength (m), a radius, d diameter (m),
nu Poisson's ratio, c = w/k phase speed, c1 and c2 speeds of pressure and shear waves (m/s).
"""

from __future__ import annotations

import math
from typing import Literal, NamedTuple, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from strikewave.base.errors import nearest
from strikewave.waves._dispersion_kernels import follow_frequency, follow_wavelength

Theory = Literal["none", "love-rayleigh", "pochhammer-chree"]
SHORTEST = 2000.0
"""w a/c0 beyond which the wave counts as a surface wave, whose speed stays to 1e-4."""
THEORIES: tuple[Theory, ...] = get_args(Theory)
"""Theories by name; `wave_number` has their equations."""


class Rod(NamedTuple):
    """A round bar as dispersion knows it: radius (m), bar speed c0 (m/s), Poisson's ratio from above -1 to 0.5."""

    radius: float
    bar_speed: float
    poissons_ratio: float


def wave_number(
    angular_frequency: ArrayLike, rod: Rod, theory: Theory = "pochhammer-chree", bar_speed: ArrayLike | None = None
) -> NDArray[np.complex128]:
    """Return the wave number of the first longitudinal mode at angular frequencies, 1/m.

    none: k = w/c0.

    love-rayleigh: k = w/sqrt(c0^2 - nu^2 a^2 w^2/2), the sideways inertia alone (Love 1927, section 278); above
    w = sqrt(2) c0/(nu a) nothing runs and k is imaginary. Theory: :eq:`wave-dispersion`.

    pochhammer-chree: with A^2 = (w a/c1)^2 - (k a)^2 and B^2 = (w a/c2)^2 - (k a)^2 the root of

        2 A (B^2 + (k a)^2) J1(A) J1(B) - (B^2 - (k a)^2)^2 J0(A) J1(B) - 4 (k a)^2 A B J1(A) J0(B) = 0

    that begins as k = w/c0 and is followed from there (Graff 1975, section 8.2). It holds for any nu in (-1, 0.5] and
    every frequency; beyond w a/c0 = 2000 the speed stays. A nu of 0 has no dispersion. For a nu below about 0.05 two
    modes nearly touch at w a/c0 = 1.26, and the root may go on along the faster one, which is what a load would
    excite.

    Parameters
    ----------
    angular_frequency : array_like
        w, rad/s, real or complex, any shape and order; complex ones with an imaginary part at most zero, where
        waves exp(i (w t - k x)) die away.
    rod : Rod
        The bar.
    theory : str
        One of `THEORIES`.
    bar_speed : array_like, optional
        Complex c0 at each frequency, m/s, of a bar that loses energy; that of the rod when left out. Its
        Poisson's ratio is then taken as real and the same at all frequencies.

    Returns
    -------
    ndarray
        k, complex; real frequencies of a lossless bar give real values (but for love-rayleigh above its limit).

    Raises
    ------
    ValueError
        If the theory is not known or a value makes no sense.

    Examples
    --------
    >>> steel = Rod(0.01, 5000.0, 0.29)
    >>> k = wave_number(2e5 * math.pi, steel)
    >>> print((2e5 * math.pi / k).round(2))
    (4751.96+0j)
    """
    _check(rod)
    if theory not in THEORIES:
        raise ValueError(f"unknown theory of dispersion {theory!r}; {nearest(str(theory), THEORIES)}")
    w = np.asarray(angular_frequency, dtype=complex)
    if not np.all(np.isfinite(w)):
        raise ValueError("every frequency must be finite")
    c0 = np.broadcast_to(np.asarray(rod.bar_speed if bar_speed is None else bar_speed, dtype=complex), w.shape)
    if theory == "none" or rod.poissons_ratio == 0.0:
        return np.asarray(w / c0)
    nu, a = rod.poissons_ratio, rod.radius
    if theory == "love-rayleigh":
        k = w / np.sqrt(c0**2 - 0.5 * (nu * a * w) ** 2)
        return np.where(k.imag > 0.0, np.conj(k), k)  # of two roots the one that dies away
    omega = (w * a / c0).ravel()
    size = np.abs(omega)
    omega *= SHORTEST / np.maximum(size, SHORTEST)
    mirrored = omega.real < 0.0
    omega[mirrored] = -np.conj(omega[mirrored])
    order = np.argsort(omega.real, kind="stable")
    ratio = np.empty(omega.size, dtype=complex)
    ratio[order] = follow_frequency(omega[order], *_squares(nu))[0]
    ratio[mirrored] = np.conj(ratio[mirrored])
    return np.asarray(w / c0 * np.sqrt(ratio).reshape(w.shape))


def phase_speed(diameter_over_wavelength: ArrayLike, poissons_ratio: float) -> NDArray[np.float64]:
    """Return c/c0 of the first Pochhammer-Chree mode at wavelengths given as d/Lambda.

    Long waves follow Rayleigh's c/c0 = 1 - (pi nu d/(2 Lambda))^2, short ones the speed of Rayleigh surface waves.

    Returns
    -------
    ndarray
        Phase speed over bar speed, in the shape of ``diameter_over_wavelength``.

    Raises
    ------
    ValueError
        If a value is negative or not finite, or Poisson's ratio is not within (-1, 0.5].

    Examples
    --------
    >>> print(phase_speed([0.1, 0.5, 2.0], 0.3).round(6))
    [0.997744 0.918537 0.58524 ]
    """
    _check(Rod(1.0, 1.0, poissons_ratio))
    ka = math.pi * np.asarray(diameter_over_wavelength, dtype=float)
    if not (np.all(np.isfinite(ka)) and np.all(ka >= 0.0)):
        raise ValueError("every d/Lambda must be zero or above, and finite")
    flat = ka.ravel()
    order = np.argsort(flat, kind="stable")
    squares = np.empty(flat.size)
    squares[order] = follow_wavelength(flat[order], *_squares(poissons_ratio))
    return np.asarray(np.sqrt(squares).reshape(ka.shape))


def group_speed(angular_frequency: ArrayLike, rod: Rod) -> NDArray[np.float64]:
    """Return the speed dw/dk of a packet of the first Pochhammer-Chree mode, m/s, at real frequencies, rad/s."""
    _check(rod)
    omega = np.asarray(angular_frequency, dtype=float) * rod.radius / rod.bar_speed
    flat = np.abs(omega.ravel())
    order = np.argsort(flat, kind="stable")
    x, slope = follow_frequency(flat[order].astype(complex), *_squares(rod.poissons_ratio))
    speed = np.empty(flat.size)
    speed[order] = (np.sqrt(x) / (x + flat[order] ** 2 * slope)).real
    return np.asarray(rod.bar_speed * speed.reshape(omega.shape))


def _squares(nu: float) -> tuple[float, float]:
    """Return (c0/c2)^2 and (c0/c1)^2."""
    return 2.0 * (1.0 + nu), (1.0 + nu) * (1.0 - 2.0 * nu) / (1.0 - nu)


def _check(rod: Rod) -> None:
    if not (0.0 < rod.radius < math.inf and 0.0 < rod.bar_speed < math.inf):
        raise ValueError(f"radius and bar speed must be above zero and finite, got {rod}")
    if not -1.0 < rod.poissons_ratio <= 0.5:
        raise ValueError(f"Poisson's ratio lies above -1 and at most at 0.5, got {rod.poissons_ratio!r}")
