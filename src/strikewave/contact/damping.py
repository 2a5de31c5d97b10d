"""Damping of a contact: the hysteresis factor chi of F = K d^n (1 + chi d'/v0), and dampers F = K d^n + c d^p d'.

For two free bodies the restitution that comes out depends on chi alone, not on n, K, mass or speed
(see `restitution`), so each law can be judged once and for all: only `exact` gives what is asked.
One law, one short function; `factor` looks one up by name.

With a damper of p = (n - 1)/2 the motion is that of a linear oscillator in another time. With x = (K/m)^(1/2)
d^((n+1)/2) and ds = (K/m)^(1/2) d^((n-1)/2) dt,

    x'' + 2 zeta w x' + w^2 x = 0,   w^2 = (n + 1)/2,   c = zeta [2 (n + 1) m K]^(1/2),

so that the restitution depends on zeta alone, not on speed, mass or n. It differs only by where the contact ends.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from strikewave.base.citations import CHECKED, FROM_MEMORY, QUOTED
from strikewave.contact import _kernels
from strikewave.contact.law import AnyContact, Damper, PressureCap, RequestedDamping, not_negative, positive, refuse
from strikewave.contact.registry import DamperLaw, DampingLaw, law_named, with_added
from strikewave.contact.stiffness import LogarithmicStiffness, Stiffness

Array = NDArray[np.float64]
Factor = Callable[[ArrayLike], Array]

_OWN: dict[str, DampingLaw] = {}
"""The laws of this module by name; `_law` fills it."""
_RANGE = "0 < e <= 1"
"""Range of every law: at e = 0 the factor is infinite, and above 1 energy would be gained."""
_REVIEW_CODE = "code of a review's first author (ladisk/DyS, after Machado et al. 2012)"
_PEER_DOCS = "documentation of Exudyn"
"""Places of the formulas whose papers could not be opened."""


def _law(name: str, equation: str, source: str, seen: str = "", **details: str) -> Callable[[Factor], Factor]:
    """Put a function into the table of damping laws."""
    details.setdefault("status", QUOTED if seen else CHECKED)

    def register(function: Factor) -> Factor:
        _OWN[name] = DampingLaw(name, function, equation, _RANGE, source=source, seen=seen, **details)
        return function

    return register


def asked(restitution_asked: ArrayLike) -> Array:
    """Return restitutions as an array, or raise ValueError where one lies outside 0 < e <= 1."""
    e = np.asarray(restitution_asked, dtype=float)
    refuse("the restitution", e, (e > 0.0) & (e <= 1.0), "0 < e <= 1 (0 would need an infinite factor: try 0.001)")
    return e


@_law(
    "exact",
    "(1 + chi)/(1 - e chi) = exp(chi (1 + e))",
    "hunt-crossley-1975",
    note="the integral of the phase plane: gives the restitution asked for, whatever n",
)
def exact(restitution_asked: ArrayLike) -> Array:
    """Return the hysteresis factor that gives exactly the restitution asked for, 0 < e <= 1.

    chi is the root of (1 + chi)/(1 - e chi) = exp(chi (1 + e)), found through L = chi (1 + e):
    e = [1 - exp(-L)(1 + L)] / (L - 1 + exp(-L)). Exact for every exponent n. Source: integral of the
    phase plane of Hunt & Crossley's law; the derivation stands in ``contact/_kernels.py``.
    Theory: :eq:`contact-restitution`.

    Returns
    -------
    ndarray
        Hysteresis factor chi, in the shape of the input.

    Raises
    ------
    ValueError
        If a restitution lies outside 0 < e <= 1 (e = 0 would need an infinite factor).

    Examples
    --------
    >>> print(exact(0.5).round(6))
    1.432751
    """
    (e,), shape = _kernels.flat(asked(restitution_asked))
    out = np.empty_like(e)
    _kernels.factors(e, out)
    return out.reshape(shape)


@_law("hunt-crossley", "chi = 3 (1 - e)/2", "hunt-crossley-1975", _PEER_DOCS, note="for e near 1")
def hunt_crossley(restitution_asked: ArrayLike) -> Array:
    """Return chi = 3 (1 - e)/2 of Hunt & Crossley 1975, for e near 1; 0.5 comes out as 0.663."""
    return 1.5 * (1.0 - asked(restitution_asked))


@_law(
    "herbert-mcwhannell",
    "chi = 6 (1 - e)/[(2 e - 1)^2 + 3]",
    "herbert-mcwhannell-1977",
    _REVIEW_CODE,
    note="for e near 1",
)
def herbert_mcwhannell(restitution_asked: ArrayLike) -> Array:
    """Return chi = 6 (1 - e)/[(2 e - 1)^2 + 3] of Herbert & McWhannell 1977, for e near 1; 0.5 comes out as 0.594."""
    e = asked(restitution_asked)
    return np.asarray(6.0 * (1.0 - e) / ((2.0 * e - 1.0) ** 2 + 3.0))


@_law("lee-wang", "chi = 3 (1 - e)/4", "lee-wang-1983", _REVIEW_CODE)
def lee_wang(restitution_asked: ArrayLike) -> Array:
    """Return chi = 3 (1 - e)/4 of Lee & Wang 1983; 0.5 comes out as 0.799."""
    return 0.75 * (1.0 - asked(restitution_asked))


@_law(
    "lankarani-nikravesh",
    "chi = 3 (1 - e^2)/4",
    "lankarani-nikravesh-1990",
    _REVIEW_CODE,
    note="for e near 1; the factor in Pereira's cylinder law too",
)
def lankarani_nikravesh(restitution_asked: ArrayLike) -> Array:
    """Return chi = 3 (1 - e^2)/4 of Lankarani & Nikravesh 1990, for e near 1; 0.5 comes out as 0.725."""
    return np.asarray(0.75 * (1.0 - asked(restitution_asked) ** 2))


@_law("gonthier", "chi = (1 - e^2)/e", "gonthier-2004", _PEER_DOCS, note="the approximate form of the paper")
def gonthier(restitution_asked: ArrayLike) -> Array:
    """Return chi = (1 - e^2)/e of Gonthier et al. 2004 (their approximation); 0.5 comes out as 0.488."""
    e = asked(restitution_asked)
    return np.asarray((1.0 - e * e) / e)


@_law("zhiying-qishao", "chi = 3 (1 - e^2) exp[2 (1 - e)]/4", "zhiying-qishao-2006", _REVIEW_CODE)
def zhiying_qishao(restitution_asked: ArrayLike) -> Array:
    """Return chi = 3 (1 - e^2) exp[2 (1 - e)]/4 of Zhiying & Qishao 2006; 0.5 comes out as 0.483."""
    e = asked(restitution_asked)
    return np.asarray(0.75 * (1.0 - e * e) * np.exp(2.0 * (1.0 - e)))


@_law(
    "flores", "chi = 8 (1 - e)/(5 e)", "flores-2011", _REVIEW_CODE, note="Ye, Li & Zhu 2009 give the same for n = 3/2"
)
def flores(restitution_asked: ArrayLike) -> Array:
    """Return chi = 8 (1 - e)/(5 e) of Flores et al. 2011, derived for n = 3/2; 0.5 comes out as 0.470."""
    e = asked(restitution_asked)
    return np.asarray(1.6 * (1.0 - e) / e)


@_law(
    "gharib-hurmuzlu",
    "chi = 1/e",
    "gharib-hurmuzlu-2012",
    note="for small e only: 1 comes out as 0.593",
    status=FROM_MEMORY,
)
def gharib_hurmuzlu(restitution_asked: ArrayLike) -> Array:
    """Return chi = 1/e of Gharib & Hurmuzlu 2012, for small e; 0.9 comes out as 0.567. From memory."""
    return np.asarray(1.0 / asked(restitution_asked))


@_law(
    "hu-guo",
    "chi = 3 (1 - e)/(2 e)",
    "hu-guo-2015",
    note="the limit for e near 1 bears it out; the code of a review prints half of it",
    status=FROM_MEMORY,
)
def hu_guo(restitution_asked: ArrayLike) -> Array:
    """Return chi = 3 (1 - e)/(2 e) of Hu & Guo 2015; 0.5 comes out as 0.488. From memory."""
    e = asked(restitution_asked)
    return np.asarray(1.5 * (1.0 - e) / e)


@_law(
    "carvalho-martins",
    "chi = 3 (1 - e)(11 - e)/[2 (1 + 9 e)]",
    "carvalho-martins-2019",
    _PEER_DOCS,
    note="the best of the estimates",
)
def carvalho_martins(restitution_asked: ArrayLike) -> Array:
    """Return chi = 3 (1 - e)(11 - e)/[2 (1 + 9 e)] of Carvalho & Martins 2019; 0.5 comes out as 0.5002."""
    e = asked(restitution_asked)
    return np.asarray(1.5 * (1.0 - e) * (11.0 - e) / (1.0 + 9.0 * e))


@_law("safaeifar-farshidianfar", "chi = 5 (1 - e)/(4 e)", "safaeifar-farshidianfar-2020", status=FROM_MEMORY)
def safaeifar_farshidianfar(restitution_asked: ArrayLike) -> Array:
    """Return chi = 5 (1 - e)/(4 e) of Safaeifar & Farshidianfar 2020; 0.5 comes out as 0.536. From memory."""
    e = asked(restitution_asked)
    return np.asarray(1.25 * (1.0 - e) / e)


@_law("li-ma-printed", "chi = 30 (1 - e)/(19 e)", "li-ma-2019", note="as printed, eq (24); takes an integral as 3/10")
def li_ma_printed(restitution_asked: ArrayLike) -> Array:
    """Return the factor of Li & Ma 2019 as printed, chi = 30 (1 - e) / (19 e), 0 < e <= 1.

    The energy estimate behind it misses the restitution asked for: 0.5 comes out as 0.4740, 0.3 as
    0.2591. Source: Li & Ma 2019, eq (24).
    """
    e = asked(restitution_asked)
    return np.asarray(30.0 * (1.0 - e) / (19.0 * e))


@_law(
    "li-ma-corrected",
    "chi = 9 (1 - e)/(19 I e), I = B(19/18, 3/2)/2",
    "li-ma-2019",
    note="eq (24) with its integral exact; the estimate still misses",
)
def li_ma_corrected(restitution_asked: ArrayLike) -> Array:
    """Return the factor of Li & Ma 2019 with its integral exact, chi = 1.523191 (1 - e)/e.

    I = int_0^1 x^(10/9) sqrt(1 - x^2) dx = B(19/18, 3/2)/2, where eq (15) prints 3/10. Source: Li & Ma 2019.
    """
    e = asked(restitution_asked)
    integral = 0.5 * math.gamma(19.0 / 18.0) * math.gamma(1.5) / math.gamma(19.0 / 18.0 + 1.5)
    return np.asarray(9.0 * (1.0 - e) / (19.0 * integral * e))


def restitution(hysteresis_factor: ArrayLike) -> Array:
    """Return the restitution that a hysteresis factor gives two free bodies, chi >= 0.

    Inverse of `exact`; whatever law the factor came from. Theory: :eq:`contact-restitution`.

    Returns
    -------
    ndarray
        Coefficient of restitution, in the shape of the input.

    Raises
    ------
    ValueError
        If a factor is negative or not finite.

    Examples
    --------
    >>> print(restitution(li_ma_printed(0.5)).round(4))
    0.474
    """
    (chi,), shape = _kernels.flat(not_negative("the hysteresis factor", hysteresis_factor))
    out = np.empty_like(chi)
    _kernels.restitutions(chi, out)
    return out.reshape(shape)


def damping_laws() -> dict[str, DampingLaw]:
    """Return the damping laws by name: our own, and those that installed packages add."""
    return with_added(DampingLaw, _OWN)


def damping_law(name: str, field: str = "damping") -> DampingLaw:
    """Return a damping law by its name, or raise `InputError`, which offers the nearest."""
    return law_named(damping_laws(), name, field, "a damping law")


def factor(name: str, restitution_asked: ArrayLike) -> Array:
    """Return the hysteresis factor of a named law.

    Raises
    ------
    InputError
        If no law has that name.
    """
    return np.asarray(damping_law(name).function(restitution_asked))


def named_contact(
    stiffness: Stiffness | LogarithmicStiffness, law: str, restitution_asked: ArrayLike, cap: PressureCap | None = None
) -> AnyContact:
    """Return a contact whose hysteresis a named law gives; its impacts report a restitution missed.

    Raises
    ------
    InputError
        If no law has that name.
    """
    contact = stiffness.contact(factor(law, restitution_asked), cap)
    return replace(contact, asked=RequestedDamping(law, restitution_asked))


_BELOW_CRITICAL = 1.0 - 1e-16  # there the restitution is zero already
"""Largest damping ratio below 1 that a float holds."""
_CRITICAL = 1e-9  # the function is flat to as much there
"""Distance from critical damping within which the limit stands for 0/0."""
_NEWTON_STEPS = 30  # the decay is concave, so that they come from below, and six leave all digits
"""Newton's steps to a damping ratio."""
_FAR = 2.0
"""Decay from which on Newton's steps begin at ln(2 zeta), which is nearer there than the slope at 0 times zeta."""
_OWN_DAMPERS: dict[str, DamperLaw] = {}
"""The laws of this module by name; `_law` fills it."""


def pulling_restitution(damping_ratio: ArrayLike) -> Array:
    """Return e = exp(-pi zeta/sqrt(1 - zeta^2)) of a damper that may pull: the contact ends where d is zero again.

    Zero from zeta = 1 on, where the bodies stay together. Source: the damped oscillator; Schwager & Poschel 2007,
    eq (15).
    """
    zeta = np.minimum(not_negative("the damping ratio", damping_ratio), _BELOW_CRITICAL)
    return np.asarray(np.exp(-np.pi * zeta / np.sqrt((1.0 - zeta) * (1.0 + zeta))))


def logarithmic_damping_ratio(restitution_asked: ArrayLike) -> Array:
    """Return zeta = -ln e/sqrt(pi^2 + ln^2 e), 0 < e <= 1: inverse of `pulling_restitution`.

    Source: Anagnostopoulos 1988; for n = 3/2 Antypov & Elliott 2011.
    """
    decay = 0.0 - np.log(asked(restitution_asked))  # 0 - ln 1 is +0, where -ln 1 would be -0
    return np.asarray(decay / np.hypot(np.pi, decay))


def _decay_and_slope(zeta: Array) -> tuple[Array, Array]:
    """Return zeta arccos(zeta)/sqrt(1 - zeta^2), continued by arcosh beyond 1, and its slope."""
    near = np.abs(zeta - 1.0) < _CRITICAL
    z = np.where(near, 0.5, zeta)
    # both branches are evaluated: each keeps to its own range
    turned = np.where(z < 1.0, np.arccos(np.minimum(z, 1.0)), np.arccosh(np.maximum(z, 1.0)))
    decay = np.where(near, 1.0, z * turned / np.sqrt(np.abs(1.0 - z * z)))
    square = (1.0 - z) * (1.0 + z)  # as a product, for 1 - z^2 loses the digits of 1 - z near critical damping
    angle = turned / np.sqrt(np.abs(square))
    return decay, np.where(near, 2.0 / 3.0, angle + z * (z * angle - 1.0) / square)


def cut_off_restitution(damping_ratio: ArrayLike) -> Array:
    """Return the restitution of a spring and damper that never pull, zeta = c / (2 sqrt(k m)).

    e = exp(-2 zeta arccos(zeta) / sqrt(1 - zeta^2)), continued by arcosh beyond zeta = 1; the contact
    ends when the force, not the compression, is back at zero. Source: Schwager & Poschel 2007 (their
    eqs for e with the arctangent of a double angle reduced).
    """
    return np.exp(-2.0 * _decay_and_slope(not_negative("the damping ratio", damping_ratio))[0])


def approach_restitution(damping_ratio: ArrayLike) -> Array:
    """Return the restitution of a damper that acts on approach only, exp(-zeta arccos(zeta)/sqrt(1 - zeta^2)).

    The largest x of the damped oscillator of this module returns without loss.
    """
    return np.exp(-_decay_and_slope(not_negative("the damping ratio", damping_ratio))[0])


def cut_off_damping_ratio(restitution_asked: ArrayLike) -> Array:
    """Return the damping ratio that gives a restitution if the force never pulls: inverse of `cut_off_restitution`.

    Raises
    ------
    ValueError
        If a restitution lies outside 0 < e <= 1.
    """
    decay = -0.5 * np.log(asked(restitution_asked))
    zeta = np.where(decay > _FAR, 0.5 * np.exp(decay), 2.0 / np.pi * decay)
    for _ in range(_NEWTON_STEPS):
        reached, slope = _decay_and_slope(zeta)
        onward = zeta + (decay - reached) / slope
        if np.array_equal(onward, zeta):  # the last bit stands still: no tolerance is needed
            break
        zeta = onward
    return np.asarray(zeta)


def damper_of_ratio(stiffness: Stiffness, mass: ArrayLike, damping_ratio: ArrayLike, style: str) -> Damper:
    """Return the damper of a damping ratio: c = zeta [2 (n + 1) m K]^(1/2), p = (n - 1)/2."""
    k, n = stiffness.stiffness, stiffness.exponent
    c = np.asarray(damping_ratio) * np.sqrt(2.0 * (n + 1.0) * positive("the mass", mass) * k)
    return Damper(c, 0.5 * (n - 1.0), style)


Make = Callable[..., Damper]


def _damper(name: str, equation: str, source: str, **details: Any) -> Callable[[Make], Make]:
    """Put a function into the table of dampers."""

    def register(function: Make) -> Make:
        status = QUOTED if details.get("seen") else CHECKED
        _OWN_DAMPERS[name] = DamperLaw(name, function, equation, details.pop("limits"), status, source, **details)
        return function

    return register


def _linear(stiffness: Stiffness) -> Stiffness:
    if stiffness.exponent != 1.0:
        raise ValueError(f"the exponent must be 1 for a linear damper, got {stiffness.exponent!r}: take tsuji")
    return stiffness


@_damper(
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
    """Return the damper of Kelvin and Voigt: linear, and pulling before the end; gives the restitution asked for."""
    ratio = logarithmic_damping_ratio(restitution_asked)
    return damper_of_ratio(_linear(stiffness), mass, ratio, "pulls")


@_damper(
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
    """Return the linear damper of Anagnostopoulos 1988, cut off where it would pull; 0.5 comes out as 0.550."""
    ratio = logarithmic_damping_ratio(restitution_asked)
    return damper_of_ratio(_linear(stiffness), mass, ratio, "never-pulls")


@_damper(
    "tsuji",
    "F = K d^n + alpha sqrt(m K) d^((n-1)/2) d', alpha = -sqrt(2 (n+1)) ln e/sqrt(pi^2 + ln^2 e)",
    "tsuji-1992",
    limits="any n, 0 < e <= 1",
    seen="documentation of Woo (n = 3/2); abstract of Feng 2026, arXiv:2603.27764 (any n)",
    note="gives e if it may pull until d is zero again; alpha by Antypov & Elliott 2011",
    given=lambda e, n: asked(e),
)
def tsuji(stiffness: Stiffness, mass: ArrayLike, restitution_asked: ArrayLike) -> Damper:
    """Return the damper of Tsuji, Tanaka & Ishida 1992 with Antypov & Elliott's alpha, pulling before the end."""
    return damper_of_ratio(stiffness, mass, logarithmic_damping_ratio(restitution_asked), "pulls")


@_damper(
    "tsuji-cut-off",
    "as tsuji, cut off where it would pull; zeta solves e = exp(-2 zeta arccos(zeta)/sqrt(1 - zeta^2))",
    "schwager-poschel-2007",
    limits="any n, 0 < e <= 1",
    seen="code that cites their eq (21) (n = 1); any n by the change of time in contact/damping.py",
    note="gives the restitution asked for, and never pulls",
    given=lambda e, n: asked(e),
)
def tsuji_cut_off(stiffness: Stiffness, mass: ArrayLike, restitution_asked: ArrayLike) -> Damper:
    """Return Tsuji's damper for a contact that never pulls; gives the restitution asked for, whatever n."""
    return damper_of_ratio(stiffness, mass, cut_off_damping_ratio(restitution_asked), "never-pulls")


def _jankowski_ratio(restitution_asked: ArrayLike, exponent: float) -> Array:
    """Return zeta for xi = (9 sqrt 5/2)(1 - e^2)/{e [e (9 pi - 16) + 16]}."""
    e = asked(restitution_asked)
    xi = 4.5 * np.sqrt(5.0) * (1.0 - e * e) / (e * (e * (9.0 * np.pi - 16.0) + 16.0))
    return np.asarray(2.0 * xi / np.sqrt(2.0 * (exponent + 1.0)))


@_damper(
    "jankowski",
    "F = K d^n + 2 xi sqrt(m K) d^((n-1)/2) d' while d' > 0, xi = (9 sqrt(5)/2)(1 - e^2)/{e [e (9 pi - 16) + 16]}",
    "jankowski-2006",
    limits="n = 3/2, 0 < e <= 1",
    seen="documentation of OpenSees, JankowskiImpact",
    note="no loss on the way back; zeta = 2 xi/sqrt(5) gives approach_restitution(zeta), not e",
    given=lambda e, n: approach_restitution(_jankowski_ratio(e, n)),
)
def jankowski(stiffness: Stiffness, mass: ArrayLike, restitution_asked: ArrayLike) -> Damper:
    """Return the damper of Jankowski 2005 with his xi of 2006: on approach only; 0.65 comes out as 0.647 (n = 3/2)."""
    return damper_of_ratio(stiffness, mass, _jankowski_ratio(restitution_asked, stiffness.exponent), "on-approach")


@_damper(
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
    """
    n = stiffness.exponent
    return Damper(n * stiffness.stiffness * not_negative("the time", time), n - 1.0)


def damper_laws() -> dict[str, DamperLaw]:
    """Return the laws of dampers by name: our own, and those that installed packages add."""
    return with_added(DamperLaw, _OWN_DAMPERS)


def damper_law(name: str, field: str = "damper") -> DamperLaw:
    """Return a law of a damper by its name, or raise `InputError`, which offers the nearest."""
    return law_named(damper_laws(), name, field, "a damper law")
