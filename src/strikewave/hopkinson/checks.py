"""Checks of a split-Hopkinson test from its own records: equilibrium, momentum, energy, striker, slope of the rise.

An elastic specimen between two equal bars reaches a uniform stress by multiple reflections: each time r = (1 - beta)/
(1 + beta) of the force is reflected, and the forces on the two faces approach each other.

Symbols: beta = Z_specimen/Z_bar, t0 transit time of the specimen (s), k number of the transit, from 1,
alpha = 2 (F1 - F2)/(F1 + F2).

Source: L. M. Yang, V. P. W. Shim, An analysis of stress uniformity in split Hopkinson bar test specimens,
International Journal of Impact Engineering 31 (2005) 129-150 (not opened: the closed form is the sum of echoes,
with which the tests compare it, and with the delay lines of `strikewave.waves`); the usual 5 %: Ravichandran & Subhash
1994.
"""

from __future__ import annotations

import math
from dataclasses import field, replace
from itertools import product
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from strikewave.base import declare
from strikewave.base.declare import MAIN, NO_UNIT, Quantity
from strikewave.base.shock_quantities import ENERGY, MEASURED_IMPULSE, MICROSECONDS, RATIO, SHARE
from strikewave.hopkinson.bars import StrikerBar
from strikewave.hopkinson.pulses import Pulses
from strikewave.hopkinson.reduction import Analysis, Reduction, StressStrainCurve, reduce

Array = NDArray[np.float64]

UNIFORM = 0.05
"""Largest force difference in equilibrium, as a share of the mean force: usual since Ravichandran & Subhash 1994."""
MOST_TRANSITS = 100_000
"""Largest number of transits: a wave of r = 0.9999 has fallen to 5e-5 by then."""
NEGLIGIBLE = 1e-18
"""Share of the incident force below which an echo adds nothing to a sum in floating point."""
PER_TRANSIT, LONG = 200, 5000.0
"""Instants a transit at which the forces are compared, and the transits from which one is enough: nothing changes
within one there."""
MORE = 4.0
"""Least number of transits looked at, and those beyond the estimate: the rise of the load shifts all by some."""
SAFETY = 0.01
"""Share of the limit at which the estimate of the transits ends, so that alpha stays below the limit after it."""
TINY = 1e-300
"""Smallest argument of the logarithm, for a specimen as stiff as the bar."""


def stress_difference(beta: ArrayLike, transit: ArrayLike) -> Array:
    """Return the magnitude of alpha during the k-th transit after a step: (k - 1) t0 < t < k t0.

        alpha_k = 2 beta (1 - beta)^(k-1) / [(1 + beta)^k - (1 - beta)^(k-1)]

    written with r = (1 - beta)/(1 + beta), so that it neither overflows nor cancels.
    Theory: :eq:`hopkinson-uniformity`.

    Parameters
    ----------
    beta : array_like
        Impedance ratio, above 0.
    transit : array_like
        k, from 1; both broadcast.

    Returns
    -------
    ndarray
        Stress difference of the faces over their mean, in the broadcast shape of both.

    Raises
    ------
    ValueError
        If one is out of range.

    Examples
    --------
    >>> stress_difference(0.5, [1, 2, 3, 4, 5]).round(4).tolist()
    [2.0, 0.2857, 0.08, 0.0253, 0.0083]
    """
    b, k = np.asarray(beta, dtype=float), np.asarray(transit, dtype=float)
    if not (np.all(np.isfinite(b)) and np.all(b > 0.0) and np.all(k >= 1.0)):
        raise ValueError("beta must be above zero and the transit at least 1")
    log = (k - 1.0) * np.log(np.maximum(np.abs((1.0 - b) / (1.0 + b)), TINY))
    sign = np.where((b > 1.0) & (k % 2.0 == 0.0), -1.0, 1.0)
    left = sign * np.exp(log)
    below = np.where(sign > 0.0, b - np.expm1(log), 1.0 + b - left)
    return np.asarray(np.abs(2.0 * b * left / below))


class Faces(NamedTuple):
    """Forces on the two faces of the specimen over the plateau of the incident force, and their alpha."""

    first: Array
    second: Array

    @property
    def alpha(self) -> Array:
        """2 (F1 - F2)/(F1 + F2); NaN where nothing has come yet."""
        total = self.first + self.second
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.where(total > 0.0, 2.0 * (self.first - self.second) / total, np.nan)


def face_forces(beta: float, time: ArrayLike, rise: float = 0.0) -> Faces:
    """Return the forces on both faces under an incident force that rises in a straight line to 1 and stays.

        P(t) = T sum_m r^(2m) s(t - 2m),  F1 = P(t) + r P(t - 2),  F2 = (1 + r) P(t - 1)

    with T = 2 beta/(1 + beta), r = (1 - beta)/(1 + beta), the incident force s, and times, the rise among them, in
    transits t0 after the wave reaches the first face. At a step, values are those just after it.

    Examples
    --------
    >>> faces = face_forces(0.5, [0.5, 1.5, 2.5])
    >>> (abs(faces.alpha) - stress_difference(0.5, [1, 2, 3])).round(15).tolist()
    [0.0, 0.0, 0.0]
    """
    t = np.asarray(time, dtype=float)
    if not 0.0 < beta < math.inf or not 0.0 <= rise < math.inf or not np.all(np.isfinite(t)):
        raise ValueError("beta must be above zero, the rise zero or above, times finite")
    if t.size and float(t.max()) > MOST_TRANSITS:
        raise ValueError(f"at most {MOST_TRANSITS} transits, got {float(t.max()):g}")
    let, r = 2.0 * beta / (1.0 + beta), (1.0 - beta) / (1.0 + beta)

    def incident(at: Array) -> Array:
        return np.clip(at / rise, 0.0, 1.0) if rise > 0.0 else np.where(at >= 0.0, 1.0, 0.0)

    def running(at: Array) -> Array:
        total = np.zeros_like(at)
        for m in range(int(max(float(at.max(initial=0.0)), 0.0) // 2.0) + 1):
            share = r ** (2 * m)
            if share < NEGLIGIBLE:
                break
            total += share * incident(at - 2.0 * m)
        return let * total

    return Faces(running(t) + r * running(t - 2.0), (1.0 + r) * running(t - 1.0))


def transits_to_uniform(beta: float, rise: float = 0.0, limit: float = UNIFORM) -> float:
    """Return the number of transits after which |alpha| stays below a limit.

    It is found on a grid of 1/200 of a transit; from 5000 transits on of one transit.

    Examples
    --------
    >>> transits_to_uniform(0.5), transits_to_uniform(0.1), transits_to_uniform(0.1, rise=2.0) < 2.25
    (3.0, 8.0, True)
    """
    if not (0.0 < limit < 2.0 and 0.0 < beta < math.inf):
        raise ValueError(f"the limit lies between 0 and 2, and beta above zero, got {limit!r} and {beta!r}")
    r = abs((1.0 - beta) / (1.0 + beta))
    needed = 2.0 if r == 0.0 else 2.0 + math.log(SAFETY * limit * min(beta, 1.0)) / math.log(r)
    last = min(max(needed, MORE) + 2.0 * rise + MORE, MOST_TRANSITS)
    per = PER_TRANSIT if last < LONG else 1
    time = (np.arange(int(last * per)) + 0.5) / per
    above = np.flatnonzero(~(np.abs(face_forces(beta, time, rise).alpha) < limit))
    return float(above[-1] + 1) / per if above.size else 0.0


SLOPE_BAND = (0.1, 0.5)
"""Shares of the largest stress between which the slope of the rise is fitted: below a tenth lies the noise of the foot,
above half of it many specimens yield."""
FEWEST_OF_SLOPE = 3
"""Least number of samples for a slope: two always lie on a line."""
LASTING = 3.0
"""Rise times for which forces must agree to be in equilibrium: averaged over one, they agree by chance for about as
long."""
PLATEAU = Quantity(NO_UNIT, "ustrain", "plateau strain")
HALF_WIDTH = Quantity("s", "us", "pulse width at 50 %")
RISE_SLOPE = Quantity("Pa", "GPa", "slope of the rise", digits=3)
STANDS_OUT = 5.0
"""Standard deviations of both traces that a mean force must have for its ratio R, which is then known to 0.2."""


@declare.dataclass
class Equilibrium:
    """The agreement of the forces on both faces.

    R stays below the limit in a stretch; begin and end are NaN if none lasts for `LASTING` rise times of the incident
    pulse.
    """

    ratio: Array = field(repr=False)
    """R(t) = 2 |F1 - F2|/|F1 + F2|, shape (N,); NaN where the forces do not stand out of the noise."""
    misfit: float = declare.number(
        Quantity(NO_UNIT, "%", "force difference over mean force", 1, 0),
        "integral of |F1 - F2| over that of (F1 + F2)/2 while the incident wave lasts",
        headline="force difference",
    )
    force_ratio: float = declare.number(
        Quantity(NO_UNIT, NO_UNIT, "impulse on face 1 over face 2", 4, 0),
        "impulse on the first face over that on the second, while the incident wave lasts",
    )
    begin: float = declare.number(
        MICROSECONDS,
        "begin of the longest stretch of the loading in which the forces on both faces are alike, after the arrival",
    )
    end: float = declare.number(MICROSECONDS, "end of that stretch")
    share: float = declare.number(
        Quantity(NO_UNIT, "%", decimals=0, digits=0),
        "part of the loading in which they are alike, in one stretch or in many",
    )


def equilibrium(reduction: Reduction, limit: float = UNIFORM) -> Equilibrium:
    """Compare the forces on the two faces.

    ``begin``, ``end`` and ``share`` take R of forces averaged over the rise time of the incident pulse, so that noise
    does not end a stretch.
    """
    f1, f2, on = reduction.first_force, reduction.second_force, reduction.loading
    mean = 0.5 * (f1 + f2)
    noise = math.hypot(
        reduction.bars[0].stiffness * reduction.waves.noise[0], reduction.bars[1].stiffness * reduction.waves.noise[1]
    )
    stands_out = np.abs(mean) > STANDS_OUT * noise
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = np.where(stands_out, np.abs(f1 - f2) / np.abs(mean), np.nan)
    total = float(np.sum(mean[on]))
    second = float(np.sum(f2[on]))
    return Equilibrium(
        ratio=ratio,
        misfit=float(np.sum(np.abs(f1 - f2)[on])) / total if total > 0.0 else math.nan,
        force_ratio=float(np.sum(f1[on])) / second if second else math.nan,
        **_stretch(reduction, limit),
    )


def _stretch(reduction: Reduction, limit: float) -> dict[str, float]:
    """Return begin and end of the longest stretch in which smoothed forces agree, and the share of the loading."""
    waves, on = reduction.waves, np.flatnonzero(reduction.loading)
    # noise must not end a stretch: forces are averaged over a rise time
    width = max(round(waves.window / waves.step), 1)
    box = np.ones(width) / width
    f1, f2 = (np.convolve(f, box, "same")[on] for f in (reduction.first_force, reduction.second_force))
    agree = np.abs(f1 - f2) <= limit * 0.5 * np.abs(f1 + f2)
    edges = np.flatnonzero(np.diff(np.concatenate([[False], agree, [False]]).astype(int)))
    begins, ends = edges[::2], edges[1::2] - 1
    share = float(np.mean(agree))
    if not begins.size or (longest := int((ends - begins).max())) * waves.step < LASTING * waves.window:
        return {"begin": math.nan, "end": math.nan, "share": share}
    k = int(np.argmax(ends - begins == longest))
    return {"begin": float(reduction.time[on[begins[k]]]), "end": float(reduction.time[on[ends[k]]]), "share": share}


@declare.dataclass
class Momentum:
    """Impulses of the waves over the window, and their closure.

    The first is incident + reflected, the second the transmitted one, that of the specimen m (v1 + v2)/2. The closure
    is (first - second - specimen) over the incident impulse; a specimen of unknown density counts as without mass.
    """

    incident: float = declare.number(
        MEASURED_IMPULSE, "of the incident wave: E A times the integral of its strain", column=MAIN
    )
    reflected: float = declare.number(
        MEASURED_IMPULSE, "of the reflected wave; negative for a specimen softer than the bar", column=MAIN
    )
    transmitted: float = declare.number(MEASURED_IMPULSE, "of the transmitted wave", column=MAIN)
    first: float = declare.number(MEASURED_IMPULSE, "on the first face of the specimen")
    second: float = declare.number(MEASURED_IMPULSE, "on the second face")
    specimen: float = declare.number(
        Quantity("N s", "mN s", digits=3),
        "of the specimen at the end of the window; null where its density is not known",
    )
    closure: float = declare.number(RATIO, "what is missing, over the incident momentum")

    @declare.computed(
        declare.number(SHARE, "closure", label="missing impulse", headline="impulse missing", in_document=False)
    )
    def missing(self) -> float | None:
        """Missing share of the incident impulse; None for an excess."""
        return self.closure if self.closure >= 0.0 else None

    @declare.computed(
        declare.number(SHARE, "closure", label="excess impulse", headline="impulse in excess", in_document=False)
    )
    def excess(self) -> float | None:
        """Excess as a share of the incident impulse; None where some is missing."""
        return None if self.closure >= 0.0 else -self.closure


def momentum(reduction: Reduction) -> Momentum:
    """Return the impulses of the waves while the incident wave lasts, and their closure.

    Over that time the specimen gains the impulse at its first face less that at the second.
    """
    waves, bars = reduction.waves, reduction.bars
    last = int(np.flatnonzero(reduction.loading)[-1])
    came, back, on = (
        bar.stiffness * float(reduction.integral(strain)[last])
        for bar, strain in ((bars[0], waves.incident), (bars[0], waves.reflected), (bars[1], waves.transmitted))
    )
    mass = reduction.specimen.mass
    mean = 0.5 * float(reduction.first_velocity[last] + reduction.second_velocity[last])
    own = math.nan if mass is None else mass * mean
    gained = 0.0 if math.isnan(own) else own
    first = came + back
    return Momentum(came, back, on, first, on, own, (first - on - gained) / came)


@declare.dataclass
class Energy:
    """Energy of the waves, and of the specimen.

    The absorbed energy equals ``deformation``, the integral of the mean force times v1 - v2, and ``acceleration``, that
    of F1 - F2 times the mean velocity.
    """

    incident: float = declare.number(ENERGY, "energy of the incident wave", column=MAIN)
    reflected: float = declare.number(ENERGY, "energy of the reflected wave", column=MAIN)
    transmitted: float = declare.number(ENERGY, "energy of the transmitted wave", column=MAIN)
    absorbed: float = declare.number(ENERGY, "incident less reflected less transmitted", label="absorbed energy")
    deformation: float = declare.number(ENERGY, "the part that deforms the specimen")
    acceleration: float = declare.number(Quantity("J", "J", digits=3), "the part that accelerates it")


def energy(reduction: Reduction) -> Energy:
    """Return the energy of the waves while the incident wave lasts: E A c times the integral of strain squared.

    F1 v1 - F2 v2 = (F1 + F2)(v1 - v2)/2 + (F1 - F2)(v1 + v2)/2: the deformation of the specimen, and its motion.
    """
    waves, bars = reduction.waves, reduction.bars
    last = int(np.flatnonzero(reduction.loading)[-1])

    def upto(values: Array) -> float:
        return float(reduction.integral(values)[last])

    first, second = (bar.stiffness * bar.speed for bar in bars)
    came = first * upto(waves.incident**2)
    back = first * upto(waves.reflected**2)
    on = second * upto(waves.transmitted**2)
    f1, f2, v1, v2 = (
        reduction.first_force,
        reduction.second_force,
        reduction.first_velocity,
        reduction.second_velocity,
    )
    deformed, moved = upto(0.5 * (f1 + f2) * (v1 - v2)), upto(0.5 * (f1 - f2) * (v1 + v2))
    return Energy(came, back, on, came - back - on, deformed, moved)


@declare.dataclass
class StrikerCheck:
    """The incident pulse and the one that its striker should make; NaN where a speed is not known."""

    strain: float = declare.number(PLATEAU, "plateau of the incident pulse", column=MAIN, tables="measured")
    strain_expected: float = declare.number(PLATEAU, "by theory of the striker", column=MAIN, tables="expected")
    duration: float = declare.number(HALF_WIDTH, "width of the incident pulse", column=MAIN, tables="measured")
    duration_expected: float = declare.number(HALF_WIDTH, "by theory of the striker", column=MAIN, tables="expected")
    speed: float = declare.number(Quantity("m/s", "m/s"), "speed of the striker that the plateau stands for")


def striker_check(pulses: Pulses, reduction: Reduction, striker: StrikerBar) -> StrikerCheck:
    """Compare the incident pulse with its striker: plateau v Zs/((Zs+Zb) cb), length 2 Ls/cs."""
    bar = reduction.bars[0]
    per_speed = striker._replace(speed=1.0).strain(bar)
    return StrikerCheck(
        pulses.plateau, striker.strain(bar), pulses.width, striker.pulse_length, pulses.plateau / per_speed
    )


@declare.dataclass
class Slope:
    """Slope of the rise of a stress-strain curve, with its range under a misalignment of a sample."""

    value: float = declare.number(RISE_SLOPE, "slope of the rise of the stress-strain curve, by 1, 2 or 3 waves")
    low: float = declare.number(RISE_SLOPE, "low end, where the waves are misaligned by a sample", default=math.nan)
    high: float = declare.number(RISE_SLOPE, "high end of that", default=math.nan)


def rise_slope(curve: StressStrainCurve, loading: NDArray[np.bool_]) -> float:
    """Return the slope of the first rise of a curve from 10 to 50 % of the largest stress, Pa; NaN without samples.

    By least squares of strain on stress. A Hopkinson test does not measure Young's modulus well: equilibrium comes
    late in the rise and the bar faces are pressed in. The slope is a check, not a property.
    """
    compliance = _rise_compliance(curve, loading)
    return 1.0 / compliance if compliance else math.nan


def rise_slopes(reduction: Reduction, analysis: Analysis) -> Slope:
    """Return `rise_slope` by an analysis, with its values where reflected and transmitted wave are a sample off.

    ``high`` is infinite where the rise is upright, or leans backwards, within a sample.
    """
    waves, compliances = reduction.waves, []
    for back, on in product((-1, 0, 1), repeat=2):
        moved = replace(waves, reflected=np.roll(waves.reflected, back), transmitted=np.roll(waves.transmitted, on))
        shifted = reduce(moved, reduction.bars, reduction.specimen)
        compliances.append(_rise_compliance(shifted.curve(analysis), reduction.loading))
    if any(math.isnan(compliance) for compliance in compliances) or max(compliances) <= 0.0:
        return Slope(rise_slope(reduction.curve(analysis), reduction.loading))
    high = 1.0 / min(compliances) if min(compliances) > 0.0 else math.inf
    return Slope(rise_slope(reduction.curve(analysis), reduction.loading), 1.0 / max(compliances), high)


def _rise_compliance(curve: StressStrainCurve, loading: NDArray[np.bool_]) -> float:
    """Return strain over stress of the first rise, 1/Pa; NaN where it has fewer than three samples."""
    stress, strain = curve.stress[loading], curve.strain[loading]
    top = float(stress.max(initial=0.0))
    high = int(np.argmax(stress >= SLOPE_BAND[1] * top)) if top > 0.0 else 0
    below = np.flatnonzero(stress[:high] < SLOPE_BAND[0] * top)
    low = int(below[-1]) + 1 if below.size else 0
    if high - low < FEWEST_OF_SLOPE:
        return math.nan
    x = stress[low:high] - stress[low:high].mean()
    return float(x @ strain[low:high] / (x @ x))
