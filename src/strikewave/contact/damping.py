"""Damping laws: the hysteresis factor chi of F = K d^n (1 + chi d'/v0) for a restitution asked for.

For two free bodies the restitution that comes out depends on chi alone, not on n, K, mass or speed
(see `restitution`), so each law can be judged once and for all: only `exact` gives what is asked.
One law, one short function; `factor` looks one up by name.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from strikewave.contact import _kernels
from strikewave.contact.law import AnyContact, PressureCap, RequestedDamping, not_negative, refuse
from strikewave.contact.registry import CHECKED, FROM_MEMORY, QUOTED, DampingLaw, law_named, with_added
from strikewave.contact.stiffness import LogarithmicStiffness, Stiffness

Array = NDArray[np.float64]
Factor = Callable[[ArrayLike], Array]

_OWN: dict[str, DampingLaw] = {}
"""The laws of this module by name; `_law` fills it."""
_RANGE = "0 < e <= 1"
"""Where every law holds: at e = 0 the factor is infinite, and above 1 energy would be gained."""
_REVIEW_CODE = "code of a review's first author (ladisk/DyS, after Machado et al. 2012)"
_PEER_DOCS = "documentation of Exudyn"
"""Where the formulas were seen whose papers could not be opened."""


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
    """Return chi = 3 (1 - e)/2 of Hunt & Crossley 1975, for e near 1; 0.5 comes out as 0.663.

    Examples
    --------
    >>> print(hunt_crossley(0.5))
    0.75
    """
    return 1.5 * (1.0 - asked(restitution_asked))


@_law(
    "herbert-mcwhannell",
    "chi = 6 (1 - e)/[(2 e - 1)^2 + 3]",
    "herbert-mcwhannell-1977",
    _REVIEW_CODE,
    note="for e near 1",
)
def herbert_mcwhannell(restitution_asked: ArrayLike) -> Array:
    """Return chi = 6 (1 - e)/[(2 e - 1)^2 + 3] of Herbert & McWhannell 1977, for e near 1; 0.5 comes out as 0.594.

    Examples
    --------
    >>> print(herbert_mcwhannell(0.5))
    1.0
    """
    e = asked(restitution_asked)
    return np.asarray(6.0 * (1.0 - e) / ((2.0 * e - 1.0) ** 2 + 3.0))


@_law("lee-wang", "chi = 3 (1 - e)/4", "lee-wang-1983", _REVIEW_CODE)
def lee_wang(restitution_asked: ArrayLike) -> Array:
    """Return chi = 3 (1 - e)/4 of Lee & Wang 1983; 0.5 comes out as 0.799.

    Examples
    --------
    >>> print(lee_wang(0.5))
    0.375
    """
    return 0.75 * (1.0 - asked(restitution_asked))


@_law(
    "lankarani-nikravesh",
    "chi = 3 (1 - e^2)/4",
    "lankarani-nikravesh-1990",
    _REVIEW_CODE,
    note="for e near 1; the factor in Pereira's cylinder law too",
)
def lankarani_nikravesh(restitution_asked: ArrayLike) -> Array:
    """Return chi = 3 (1 - e^2)/4 of Lankarani & Nikravesh 1990, for e near 1; 0.5 comes out as 0.725.

    Examples
    --------
    >>> print(lankarani_nikravesh(0.5))
    0.5625
    """
    return np.asarray(0.75 * (1.0 - asked(restitution_asked) ** 2))


@_law("gonthier", "chi = (1 - e^2)/e", "gonthier-2004", _PEER_DOCS, note="the approximate form of the paper")
def gonthier(restitution_asked: ArrayLike) -> Array:
    """Return chi = (1 - e^2)/e of Gonthier et al. 2004 (their approximation); 0.5 comes out as 0.488.

    Examples
    --------
    >>> print(gonthier(0.5))
    1.5
    """
    e = asked(restitution_asked)
    return np.asarray((1.0 - e * e) / e)


@_law("zhiying-qishao", "chi = 3 (1 - e^2) exp[2 (1 - e)]/4", "zhiying-qishao-2006", _REVIEW_CODE)
def zhiying_qishao(restitution_asked: ArrayLike) -> Array:
    """Return chi = 3 (1 - e^2) exp[2 (1 - e)]/4 of Zhiying & Qishao 2006; 0.5 comes out as 0.483.

    Examples
    --------
    >>> print(zhiying_qishao(0.5).round(4))
    1.529
    """
    e = asked(restitution_asked)
    return np.asarray(0.75 * (1.0 - e * e) * np.exp(2.0 * (1.0 - e)))


@_law(
    "flores", "chi = 8 (1 - e)/(5 e)", "flores-2011", _REVIEW_CODE, note="Ye, Li & Zhu 2009 give the same for n = 3/2"
)
def flores(restitution_asked: ArrayLike) -> Array:
    """Return chi = 8 (1 - e)/(5 e) of Flores et al. 2011, derived for n = 3/2; 0.5 comes out as 0.470.

    Examples
    --------
    >>> print(flores(0.5))
    1.6
    """
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
    """Return chi = 1/e of Gharib & Hurmuzlu 2012, for small e; 0.9 comes out as 0.567. From memory.

    Examples
    --------
    >>> print(gharib_hurmuzlu(0.5))
    2.0
    """
    return np.asarray(1.0 / asked(restitution_asked))


@_law(
    "hu-guo",
    "chi = 3 (1 - e)/(2 e)",
    "hu-guo-2015",
    note="the limit for e near 1 bears it out; the code of a review prints half of it",
    status=FROM_MEMORY,
)
def hu_guo(restitution_asked: ArrayLike) -> Array:
    """Return chi = 3 (1 - e)/(2 e) of Hu & Guo 2015; 0.5 comes out as 0.488. From memory.

    Examples
    --------
    >>> print(hu_guo(0.5))
    1.5
    """
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
    """Return chi = 3 (1 - e)(11 - e)/[2 (1 + 9 e)] of Carvalho & Martins 2019; 0.5 comes out as 0.5002.

    Examples
    --------
    >>> print(carvalho_martins(0.5).round(6))
    1.431818
    """
    e = asked(restitution_asked)
    return np.asarray(1.5 * (1.0 - e) * (11.0 - e) / (1.0 + 9.0 * e))


@_law("safaeifar-farshidianfar", "chi = 5 (1 - e)/(4 e)", "safaeifar-farshidianfar-2020", status=FROM_MEMORY)
def safaeifar_farshidianfar(restitution_asked: ArrayLike) -> Array:
    """Return chi = 5 (1 - e)/(4 e) of Safaeifar & Farshidianfar 2020; 0.5 comes out as 0.536. From memory.

    Examples
    --------
    >>> print(safaeifar_farshidianfar(0.5))
    1.25
    """
    e = asked(restitution_asked)
    return np.asarray(1.25 * (1.0 - e) / e)


@_law("li-ma-printed", "chi = 30 (1 - e)/(19 e)", "li-ma-2019", note="as printed, eq (24); takes an integral as 3/10")
def li_ma_printed(restitution_asked: ArrayLike) -> Array:
    """Return the factor of Li & Ma 2019 as printed, chi = 30 (1 - e) / (19 e), 0 < e <= 1.

    The energy estimate behind it misses the restitution asked for: 0.5 comes out as 0.4740, 0.3 as
    0.2591. Source: Li & Ma 2019, eq (24).

    Examples
    --------
    >>> print(li_ma_printed(0.5).round(6))
    1.578947
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

    Examples
    --------
    >>> print(li_ma_corrected(0.5).round(6))
    1.523191
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
    """Return the damping laws by name: our own, and those that installed packages add.

    Examples
    --------
    >>> damping_laws()["flores"].equation
    'chi = 8 (1 - e)/(5 e)'
    """
    return with_added(DampingLaw, _OWN)


def damping_law(name: str, field: str = "damping") -> DampingLaw:
    """Return a damping law by its name.

    Raises
    ------
    InputError
        If no law has that name; the nearest is offered.
    """
    return law_named(damping_laws(), name, field, "a damping law")


def factor(name: str, restitution_asked: ArrayLike) -> Array:
    """Return the hysteresis factor of a named law.

    Raises
    ------
    InputError
        If no law has that name.

    Examples
    --------
    >>> print(factor("exact", 1.0))
    0.0
    """
    return np.asarray(damping_law(name).function(restitution_asked))


def named_contact(
    stiffness: Stiffness | LogarithmicStiffness,
    law: str,
    restitution_asked: ArrayLike,
    cap: PressureCap | None = None,
) -> AnyContact:
    """Return a contact whose hysteresis a named law gives; its impacts report a restitution missed.

    Raises
    ------
    InputError
        If no law has that name.

    Examples
    --------
    >>> from strikewave.contact import Stiffness, solve_impact
    >>> blow = solve_impact(named_contact(Stiffness(4.7e9, 10 / 9), "flores", 0.5), 0.2, 0.459, 20.0)
    >>> blow.words
    ('the damping law flores gives e = 0.4704, not the 0.5 asked for; exact gives it',)
    """
    contact = stiffness.contact(factor(law, restitution_asked), cap)
    return replace(contact, asked=RequestedDamping(law, restitution_asked))
