"""Dampers beside the elastic force of a contact, F = K d^n + c d^p d': how they relate to the restitution.

With p = (n - 1)/2 the motion is that of a linear oscillator in another time. With x = (K/m)^(1/2) d^((n+1)/2) and
ds = (K/m)^(1/2) d^((n-1)/2) dt,

    x'' + 2 zeta w x' + w^2 x = 0,   w^2 = (n + 1)/2,   c = zeta [2 (n + 1) m K]^(1/2),

so that the restitution depends on zeta alone, not on speed, mass or n. It differs only by where the contact ends.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from strikewave.contact.damping import asked
from strikewave.contact.law import Damper, not_negative, positive
from strikewave.contact.registry import CHECKED, QUOTED, DamperLaw, law_named, with_added
from strikewave.contact.stiffness import Stiffness

Array = NDArray[np.float64]

_BELOW_CRITICAL = 1.0 - 1e-16
"""Largest damping ratio below 1 that a float holds: there the restitution is zero already."""
_CRITICAL = 1e-9
"""Distance from critical damping within which 0/0 stands for its limit: the function is flat to as much there."""
_NEWTON_STEPS = 30
"""Newton's steps to a damping ratio: the decay is concave, so that they come from below, and six leave all digits."""
_FAR = 2.0
"""Decay from which on ln(2 zeta) is nearer to it than its slope at 0 times zeta: where to begin."""
_OWN: dict[str, DamperLaw] = {}
"""The laws of this module by name; `_law` fills it."""


def pulling_restitution(damping_ratio: ArrayLike) -> Array:
    """Return e = exp(-pi zeta/sqrt(1 - zeta^2)) of a damper that may pull: the contact ends where d is zero again.

    Zero from zeta = 1 on, where the bodies stay together. Source: the damped oscillator; Schwager & Poschel 2007,
    eq (15).

    Examples
    --------
    >>> print(pulling_restitution([0.0, 0.2155]).round(3))
    [1.  0.5]
    """
    zeta = np.minimum(not_negative("the damping ratio", damping_ratio), _BELOW_CRITICAL)
    return np.asarray(np.exp(-np.pi * zeta / np.sqrt((1.0 - zeta) * (1.0 + zeta))))


def logarithmic_damping_ratio(restitution_asked: ArrayLike) -> Array:
    """Return zeta = -ln e/sqrt(pi^2 + ln^2 e), 0 < e <= 1: inverse of `pulling_restitution`.

    Source: Anagnostopoulos 1988; for n = 3/2 Antypov & Elliott 2011.

    Examples
    --------
    >>> print(logarithmic_damping_ratio(0.5).round(6))
    0.215454
    """
    decay = 0.0 - np.log(asked(restitution_asked))
    return np.asarray(decay / np.hypot(np.pi, decay))


def _decay_to_turning(zeta: Array) -> Array:
    """Return zeta arccos(zeta)/sqrt(1 - zeta^2), continued by arcosh beyond 1."""
    return _decay_and_slope(zeta)[0]


def _decay_and_slope(zeta: Array) -> tuple[Array, Array]:
    """Return `_decay_to_turning` and its slope."""
    near = np.abs(zeta - 1.0) < _CRITICAL
    z = np.where(near, 0.5, zeta)
    turned = np.where(z < 1.0, np.arccos(np.minimum(z, 1.0)), np.arccosh(np.maximum(z, 1.0)))
    decay = np.where(near, 1.0, z * turned / np.sqrt(np.abs(1.0 - z * z)))
    square = (1.0 - z) * (1.0 + z)
    angle = turned / np.sqrt(np.abs(square))
    return decay, np.where(near, 2.0 / 3.0, angle + z * (z * angle - 1.0) / square)


def cut_off_restitution(damping_ratio: ArrayLike) -> Array:
    """Return the restitution of a spring and damper that never pull, zeta = c / (2 sqrt(k m)).

    e = exp(-2 zeta arccos(zeta) / sqrt(1 - zeta^2)), continued by arcosh beyond zeta = 1; the contact
    ends when the force, not the compression, is back at zero. Source: Schwager & Poschel 2007 (their
    eqs for e with the arctangent of a double angle reduced).

    Examples
    --------
    >>> print(cut_off_restitution([0.0, 1.0]).round(4))
    [1.     0.1353]
    """
    return np.exp(-2.0 * _decay_to_turning(not_negative("the damping ratio", damping_ratio)))


def approach_restitution(damping_ratio: ArrayLike) -> Array:
    """Return the restitution of a damper that acts on approach only, exp(-zeta arccos(zeta)/sqrt(1 - zeta^2)).

    The largest x of the damped oscillator of this module returns without loss.

    Examples
    --------
    >>> print((approach_restitution(0.3) ** 2 / cut_off_restitution(0.3)).round(12))
    1.0
    """
    return np.exp(-_decay_to_turning(not_negative("the damping ratio", damping_ratio)))


def cut_off_damping_ratio(restitution_asked: ArrayLike) -> Array:
    """Return the damping ratio that gives a restitution if the force never pulls: inverse of `cut_off_restitution`.

    Raises
    ------
    ValueError
        If a restitution lies outside 0 < e <= 1.

    Examples
    --------
    >>> print(cut_off_restitution(cut_off_damping_ratio(0.3)).round(12))
    0.3
    """
    decay = -0.5 * np.log(asked(restitution_asked))
    zeta = np.where(decay > _FAR, 0.5 * np.exp(decay), 2.0 / np.pi * decay)
    for _ in range(_NEWTON_STEPS):
        reached, slope = _decay_and_slope(zeta)
        onward = zeta + (decay - reached) / slope
        if np.array_equal(onward, zeta):
            break
        zeta = onward
    return np.asarray(zeta)


def damper_of_ratio(stiffness: Stiffness, mass: ArrayLike, damping_ratio: ArrayLike, style: str) -> Damper:
    """Return the damper of a damping ratio: c = zeta [2 (n + 1) m K]^(1/2), p = (n - 1)/2.

    Examples
    --------
    >>> damper = damper_of_ratio(Stiffness(1e8, 1.0), 1.0, 0.5, "pulls")
    >>> print(damper.coefficient, damper.exponent)
    10000.0 0.0
    """
    k, n = stiffness.stiffness, stiffness.exponent
    c = np.asarray(damping_ratio) * np.sqrt(2.0 * (n + 1.0) * positive("the mass", mass) * k)
    return Damper(c, 0.5 * (n - 1.0), style)


Make = Callable[..., Damper]


def _law(name: str, equation: str, source: str, **details: Any) -> Callable[[Make], Make]:
    """Put a function into the table of dampers."""

    def register(function: Make) -> Make:
        status = QUOTED if details.get("seen") else CHECKED
        _OWN[name] = DamperLaw(name, function, equation, details.pop("limits"), status, source, **details)
        return function

    return register


def _linear(stiffness: Stiffness) -> Stiffness:
    if stiffness.exponent != 1.0:
        raise ValueError(f"the exponent must be 1 for a linear damper, got {stiffness.exponent!r}: take tsuji")
    return stiffness


@_law(
    "kelvin-voigt",
    "F = K d + c d', c = 2 zeta sqrt(K m), zeta = -ln e/sqrt(pi^2 + ln^2 e)",
    "anagnostopoulos-1988",
    limits="n = 1, 0 < e <= 1",
    exponent=1.0,
    seen="abstract of Feng 2026, arXiv:2603.27764",
    note="gives e if it may pull until d is zero again; it does pull before the end, and its force begins with a jump",
    given=lambda e, n: asked(e),
)
def kelvin_voigt(stiffness: Stiffness, mass: ArrayLike, restitution_asked: ArrayLike) -> Damper:
    """Return the damper of Kelvin and Voigt: linear, and pulling before the end; gives the restitution asked for.

    Examples
    --------
    >>> print(kelvin_voigt(Stiffness(1e8, 1.0), 1.0, 1.0).coefficient)
    0.0
    """
    ratio = logarithmic_damping_ratio(restitution_asked)
    return damper_of_ratio(_linear(stiffness), mass, ratio, "pulls")


@_law(
    "anagnostopoulos",
    "as kelvin-voigt, cut off where it would pull",
    "anagnostopoulos-1988",
    limits="n = 1, 0 < e <= 1",
    exponent=1.0,
    seen="abstract of Feng 2026, arXiv:2603.27764",
    note="cut off at no tension it gives more than is asked for: cut_off_restitution(zeta)",
    given=lambda e, n: cut_off_restitution(logarithmic_damping_ratio(e)),
)
def anagnostopoulos(stiffness: Stiffness, mass: ArrayLike, restitution_asked: ArrayLike) -> Damper:
    """Return the linear damper of Anagnostopoulos 1988, cut off where it would pull; 0.5 comes out as 0.550.

    Examples
    --------
    >>> print(cut_off_restitution(logarithmic_damping_ratio(0.5)).round(4))
    0.5503
    """
    ratio = logarithmic_damping_ratio(restitution_asked)
    return damper_of_ratio(_linear(stiffness), mass, ratio, "never-pulls")


@_law(
    "tsuji",
    "F = K d^n + alpha sqrt(m K) d^((n-1)/2) d', alpha = -sqrt(2 (n+1)) ln e/sqrt(pi^2 + ln^2 e)",
    "tsuji-1992",
    limits="any n, 0 < e <= 1",
    seen="documentation of Woo (n = 3/2); abstract of Feng 2026, arXiv:2603.27764 (any n)",
    note="gives e if it may pull until d is zero again; alpha by Antypov & Elliott 2011",
    given=lambda e, n: asked(e),
)
def tsuji(stiffness: Stiffness, mass: ArrayLike, restitution_asked: ArrayLike) -> Damper:
    """Return the damper of Tsuji, Tanaka & Ishida 1992 with Antypov & Elliott's alpha, pulling before the end.

    Examples
    --------
    >>> damper = tsuji(Stiffness(1e9, 1.5), 1.0, 0.5)
    >>> print(round(float(damper.coefficient / 1e9**0.5), 4), damper.exponent)
    0.4818 0.25
    """
    return damper_of_ratio(stiffness, mass, logarithmic_damping_ratio(restitution_asked), "pulls")


@_law(
    "tsuji-cut-off",
    "as tsuji, cut off where it would pull; zeta solves e = exp(-2 zeta arccos(zeta)/sqrt(1 - zeta^2))",
    "schwager-poschel-2007",
    limits="any n, 0 < e <= 1",
    seen="code that cites their eq (21) (n = 1); any n by the change of time in contact/dampers.py",
    note="gives the restitution asked for, and never pulls",
    given=lambda e, n: asked(e),
)
def tsuji_cut_off(stiffness: Stiffness, mass: ArrayLike, restitution_asked: ArrayLike) -> Damper:
    """Return Tsuji's damper for a contact that never pulls; gives the restitution asked for, whatever n.

    Examples
    --------
    >>> damper = tsuji_cut_off(Stiffness(1e9, 1.5), 1.0, 0.5)
    >>> print(round(float(damper.coefficient / 1e9**0.5), 4))
    0.5708
    """
    return damper_of_ratio(stiffness, mass, cut_off_damping_ratio(restitution_asked), "never-pulls")


def _jankowski_ratio(restitution_asked: ArrayLike, exponent: float) -> Array:
    """Return zeta for xi = (9 sqrt 5/2)(1 - e^2)/{e [e (9 pi - 16) + 16]}."""
    e = asked(restitution_asked)
    xi = 4.5 * np.sqrt(5.0) * (1.0 - e * e) / (e * (e * (9.0 * np.pi - 16.0) + 16.0))
    return np.asarray(2.0 * xi / np.sqrt(2.0 * (exponent + 1.0)))


@_law(
    "jankowski",
    "F = K d^n + 2 xi sqrt(m K) d^((n-1)/2) d' while d' > 0, xi = (9 sqrt(5)/2)(1 - e^2)/{e [e (9 pi - 16) + 16]}",
    "jankowski-2006",
    limits="n = 3/2, 0 < e <= 1",
    seen="documentation of OpenSees, JankowskiImpact",
    note="no loss on the way back; zeta = 2 xi/sqrt(5) gives approach_restitution(zeta), not e",
    given=lambda e, n: approach_restitution(_jankowski_ratio(e, n)),
)
def jankowski(stiffness: Stiffness, mass: ArrayLike, restitution_asked: ArrayLike) -> Damper:
    """Return the damper of Jankowski 2005 with his xi of 2006: on approach only; 0.65 comes out as 0.647 (n = 3/2).

    Examples
    --------
    >>> print(approach_restitution(2 * 0.3728 / 5**0.5).round(4))
    0.6471
    """
    return damper_of_ratio(stiffness, mass, _jankowski_ratio(restitution_asked, stiffness.exponent), "on-approach")


@_law(
    "kuwabara-kono",
    "F = K (d^n + n A d^(n-1) d')",
    "kuwabara-kono-1987",
    limits="any n >= 1, A >= 0 s",
    seen="code that cites Brilliantov et al. 1996",
    note="e cannot be prescribed: it falls with the speed; A (s) is a time of the material",
)
def kuwabara_kono(stiffness: Stiffness, mass: ArrayLike, time: ArrayLike) -> Damper:
    """Return the viscoelastic damper of Kuwabara & Kono 1987 (Brilliantov et al. 1996): c = n A K, p = n - 1.

    A is a time of the material, s. The restitution depends on the speed, through A v0/d_max, and cannot be prescribed.

    Examples
    --------
    >>> print(kuwabara_kono(Stiffness(1e9, 1.5), 1.0, 1e-6).coefficient)
    1500.0
    """
    n = stiffness.exponent
    return Damper(n * stiffness.stiffness * not_negative("the time", time), n - 1.0)


def damper_laws() -> dict[str, DamperLaw]:
    """Return the laws of dampers by name: our own, and those that installed packages add.

    Examples
    --------
    >>> sorted(damper_laws())[0]
    'anagnostopoulos'
    """
    return with_added(DamperLaw, _OWN)


def damper_law(name: str, field: str = "damper") -> DamperLaw:
    """Return a law of a damper by its name.

    Raises
    ------
    InputError
        If no law has that name; the nearest is offered.
    """
    return law_named(damper_laws(), name, field, "a damper law")
