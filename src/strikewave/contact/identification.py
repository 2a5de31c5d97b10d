"""Identify a contact from one measured force pulse, and report what it cannot determine.

The law is F = K d^n (1 + chi d'/v0) of two free bodies. A force pulse alone determines m v and K v^n, never K, m and v
one by one (see ``contact/force_pulse.py``): one of them must be given. Exponent and restitution follow from the shape.

The fit by least squares has five unknowns: begin, peak, width, n and e. Two known of stiffness, mass and speed take one
of them away, three take peak and width away. It starts from several shapes: pulses of a low restitution look much like
those of a high one, so that there are two minima.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from strikewave.base.errors import nearest
from strikewave.base.texts import percent
from strikewave.contact.force_pulse import ForcePulse, PulseRecord, cut_out, shape, unit_impact

Array = NDArray[np.float64]

VALUES = ("stiffness", "exponent", "restitution", "mass", "speed")
"""Values that can be given or found: K (N/m^n), n, e, reduced mass m (kg), approach speed v (m/s)."""
SCALES = ("stiffness", "mass", "speed")
"""Values of which one must be given, so that the pulse determines the other two."""
EXPONENTS, RESTITUTIONS = (0.2, 8.0), (0.001, 1.0)  # a fit at a bound shows a pulse of another law
"""Bounds of the search, well beyond contacts, n of 1 to 3 or so."""
FREE = ("begin", "peak", "width", "exponent", "restitution")
"""Fitted values where nothing is known."""
LOW = np.array([-1.0, -100.0, -100.0, math.log(EXPONENTS[0]), RESTITUTIONS[0]])
HIGH = np.array([1.0, 100.0, 100.0, math.log(EXPONENTS[1]), 1.0])
"""Bounds of the unknowns: the begin within a length of the record, sizes within exp(+-100), which is no bound."""
FARTHEST = 100.0  # beyond is a wrong unit, a factor of 1000
"""Largest ratio of the size of a pulse and that of the known values."""
_STEP = 1e-5  # the cube root of rounding, where the error of the slope and rounding are alike
"""Step of central differences."""
_BASINS = (0.5, 0.7, 0.85, 0.97), (0.05, 0.12, 0.25)  # shapes of e above and below some 0.3 look alike
"""Restitutions at the start, for each of the two minima."""
_FIRST_EXPONENTS = 1.0, 1.5, 2.5  # a spring, spheres, and a blunter contact
"""Exponents at the start."""
_INSIDE = 1e-3  # the trust-region method must begin inside of them
"""Distance of a start from the bounds."""
_CONVERGED, _MOST_EVALUATIONS = 1e-13, 300
"""Relative changes that end the fit, some hundred times rounding, and most evaluations; usual fits take below fifty."""
_NEAR_ELASTIC = 0.9  # chosen: further off it never fits as well
"""Fitted restitution from which on the limit e = 1 is tried as well."""
_AS_GOOD, _PERFECT = 1e-6, 1e-15
"""Excess of the squared misfit with which the limit e = 1 is taken: as a share, and a sample, which is the rounding of
pulses without noise."""
_LEAST_PEAK = 0.1  # a shape far off would else begin with no pulse
"""Least share of the measured peak of a first guess."""
_TRIED_EXPONENTS = np.geomspace(0.3, 6.0, 61)
"""Exponents tried against the known values, 5 % apart: the fit does the rest."""
_CLOSER = 0.1  # it decides only among equally good ones
"""Weight of the distance of exponents beside that of peak and width."""
_ABOVE = 0.1  # noise far from it would count the more
"""Share of the peak above which samples count in the moments of a pulse."""


@dataclass(frozen=True)
class PulseFitProblem:
    """Record and known values; the unknowns are logarithms, but for e and the begin, a share of the length."""

    record: PulseRecord
    given: Mapping[str, float]

    @cached_property
    def scales(self) -> frozenset[str]:
        """Known values of `SCALES`."""
        return frozenset(self.given) & frozenset(SCALES)

    @cached_property
    def without_scales(self) -> PulseFitProblem:
        """Problem of the pulse alone, with n and e as known."""
        return PulseFitProblem(self.record, {name: value for name, value in self.given.items() if name not in SCALES})

    @cached_property
    def free(self) -> Array:
        """Places in `FREE` that are fitted: two known scales leave peak or width, three neither."""
        follows = {"peak", "width"} if len(self.scales) == 3 else set()
        if len(self.scales) == 2:
            follows = {"width"} if self.scales == {"stiffness", "mass"} else {"peak"}
        return np.array([k for k, name in enumerate(FREE) if name not in self.given and name not in follows])

    def pulse(self, unknown: Array) -> ForcePulse:
        """Return the pulse of the fitted unknowns."""
        full = np.zeros(len(FREE))
        full[self.free] = unknown
        n, e = self.given.get("exponent", math.exp(full[3])), self.given.get("restitution", float(full[4]))
        peak, width = self._size(math.exp(full[1]), math.exp(full[2]), n, e)
        return ForcePulse(float(self.record.time[0]) + float(full[0]) * self.record.length, peak, width, n, e)

    def _size(self, peak: float, width: float, n: float, e: float) -> tuple[float, float]:
        """Return peak and width; two known scales replace one of them, three replace both."""
        if len(self.scales) < 2:
            return peak, width
        K, m, v = (self.given.get(name, math.nan) for name in SCALES)
        unit = unit_impact(n, e)[0]
        if self.scales == {"mass", "speed"}:
            return m * v * (1.0 + e) / width, width
        if self.scales == {"stiffness", "speed"}:
            return unit * K * (v * unit * width / (1.0 + e)) ** n, width
        if self.scales == {"stiffness", "mass"}:
            v = (peak / unit) ** ((n + 1.0) / (2.0 * n)) * (K * m**n) ** (-0.5 / n)
        else:
            peak = unit * (K * m**n) ** (1.0 / (n + 1.0)) * v ** (2.0 * n / (n + 1.0))
        return peak, m * v * (1.0 + e) / peak

    def unknowns(self, pulse: ForcePulse) -> Array:
        """Return the fitted unknowns of a pulse."""
        begin = (pulse.begin - self.record.time[0]) / self.record.length
        full = [begin, *np.log([pulse.peak, pulse.width, pulse.exponent]), pulse.restitution]
        return np.array(full)[self.free]

    def misfit(self, unknown: Array) -> Array:
        """Return fitted minus measured, as a share of the peak."""
        return (self.pulse(unknown).force(self.record.time) - self.record.force) / self.record.peak

    def scaled(self, pulse: ForcePulse) -> tuple[float, float, float]:
        """Return stiffness, mass and speed of a pulse; those of 1 m/s where none is known."""
        n, momentum, K = pulse.exponent, pulse.momentum, self.given.get("stiffness", 1.0)
        v = self.given.get("speed", momentum / self.given.get("mass", momentum))
        if self.scales == {"stiffness"}:
            v = (pulse.stiffness_speed / K) ** (1.0 / n)
        return self.given.get("stiffness", pulse.stiffness_speed / v**n), self.given.get("mass", momentum / v), v

    def logarithms(self, unknown: Array) -> Array:
        """Return the logarithms of all values and combinations, and the begin as it is."""
        pulse = self.pulse(unknown)
        K, m, v = self.scaled(pulse)
        momentum = pulse.momentum
        values = [K, pulse.exponent, pulse.restitution, m, v]
        sums = [momentum, momentum * (1.0 + pulse.restitution), pulse.peak, pulse.duration, pulse.stiffness_speed]
        return np.append(np.log(values + sums), pulse.begin)


@dataclass(frozen=True)
class PulseFit:
    """A solved problem: its unknowns, the derivatives of the misfit, and whether e is at its limit 1."""

    problem: PulseFitProblem
    unknown: Array
    jacobian: Array
    elastic: bool = False

    @cached_property
    def misfit(self) -> Array:
        """Fitted minus measured, as a share of the peak; shape (samples,)."""
        return self.problem.misfit(self.unknown)

    @property
    def deviation(self) -> float:
        """Standard deviation of a sample that the misfit shows, as a share of the peak."""
        return math.sqrt(float(self.misfit @ self.misfit) / max(self.misfit.size - self.unknown.size, 1))


def solve(problem: PulseFitProblem, start: Array) -> PulseFit:
    """Return the minimum reached from a start, or the limit e = 1 where that fits as well.

    Source: trust-region least squares within bounds (Branch, Coleman & Li 1999).
    """
    from scipy.optimize import least_squares

    low, high = LOW[problem.free], HIGH[problem.free]

    def slopes(unknown: Array) -> Array:
        return derivatives(problem.misfit, unknown, high)

    inside = np.clip(start, low + _INSIDE, high - _INSIDE)
    ends = {"xtol": _CONVERGED, "ftol": _CONVERGED, "gtol": _CONVERGED, "max_nfev": _MOST_EVALUATIONS}
    minimum = least_squares(problem.misfit, inside, slopes, (low, high), x_scale="jac", **ends)
    fit = PulseFit(problem, minimum.x, slopes(minimum.x))
    if "restitution" in problem.given or minimum.x[-1] < _NEAR_ELASTIC:
        return fit
    limit = solve(replace(problem, given={**problem.given, "restitution": 1.0}), minimum.x[:-1])
    most = (1.0 + _AS_GOOD) * float(fit.misfit @ fit.misfit) + _PERFECT * fit.misfit.size
    if float(limit.misfit @ limit.misfit) > most:
        return fit
    unknown = np.append(limit.unknown, 1.0)
    return PulseFit(problem, unknown, slopes(unknown), True)


def derivatives(function: Callable[[Array], Array], at: Array, high: Array) -> Array:
    """Return the derivatives of a function, shape (its values, unknowns): central, one-sided below a bound."""
    columns = []
    for k in range(at.size):
        step = np.zeros(at.size)
        step[k] = _STEP
        if at[k] + _STEP > high[k]:  # of second order too: e is often at its limit
            change = 3.0 * function(at) - 4.0 * function(at - step) + function(at - 2.0 * step)
        else:
            change = function(at + step) - function(at - step)
        columns.append(change / (2.0 * _STEP))
    return np.column_stack(columns)


def minima(problem: PulseFitProblem) -> list[PulseFit]:
    """Return the fits of the pulse alone, best first: the shapes of low and of high restitution are much alike."""
    starts = [_start(problem, restitutions) for restitutions in _BASINS]
    fits = [solve(problem, start) for start in (starts[:1] if "restitution" in problem.given else starts)]
    return sorted(fits, key=lambda fit: fit.deviation)


def _start(problem: PulseFitProblem, restitutions: tuple[float, ...]) -> Array:
    """Return the unknowns of the best of some shapes, each of the area, middle and standard deviation of the pulse."""
    record = problem.record
    middle, deviation = _moments(record.time, record.force)
    best, least = np.zeros(0), math.inf
    for n, e in itertools.product(_FIRST_EXPONENTS, restitutions):
        n, e = problem.given.get("exponent", n), problem.given.get("restitution", e)
        unit_middle, unit_deviation = _moments(*shape(n, e)[:2])
        width = deviation / unit_deviation
        pulse = ForcePulse(middle - width * unit_middle, 1.0, width, n, e)
        form = pulse.force(record.time)
        peak = max(float(form @ record.force / (form @ form)), _LEAST_PEAK * record.peak)
        unknown = problem.unknowns(replace(pulse, peak=peak))
        miss = problem.misfit(unknown)
        if miss @ miss < least:
            best, least = unknown, float(miss @ miss)
    return best


def _moments(time: Array, force: Array) -> tuple[float, float]:
    """Return mean and standard deviation of time, weighted by the force near the peak."""
    weight = np.where(force > _ABOVE * force.max(), force, 0.0)
    weight = weight / np.trapezoid(weight, time)
    middle = np.trapezoid(weight * time, time)
    return float(middle), math.sqrt(np.trapezoid(weight * (time - middle) ** 2, time))


def near(problem: PulseFitProblem, alone: PulseFit) -> Array:
    """Return the unknowns, of several exponents, whose peak and width come nearest to those of the pulse alone.

    Raises
    ------
    ValueError
        If what is known makes a pulse that is a hundred times higher, lower, longer or shorter.
    """
    pulse = alone.problem.pulse(alone.unknown)
    exponents = [pulse.exponent, *([] if "exponent" in problem.given else _TRIED_EXPONENTS)]

    def distance(n: float) -> float:
        try:
            other = problem.pulse(problem.unknowns(replace(pulse, exponent=n)))
            shift = math.hypot(math.log(other.peak / pulse.peak), math.log(other.width / pulse.width))
        except (ArithmeticError, ValueError):
            return math.inf
        return shift + _CLOSER * abs(math.log(n / pulse.exponent))

    best = min(exponents, key=distance)
    if not distance(best) < math.log(FARTHEST):
        known = ", ".join(sorted(problem.scales))
        raise ValueError(
            f"the {known} known make another pulse altogether than this one, of {pulse.peak:.3g} N peak and "
            f"{pulse.momentum:.3g} N s mass x speed: check their units and the calibration"
        )
    return problem.unknowns(replace(pulse, exponent=best))


COMBINATIONS = ("momentum", "impulse", "peak_force", "duration", "stiffness_speed")
"""Combinations that a pulse determines, whatever is known."""
DESCRIBED = 0.01  # chosen: above the error of a good measuring chain, below what a reader sees in the figure
"""Systematic misfit over the peak beyond which the law does not describe a pulse."""
# Chosen: at 0.9 either value alone is known less than half as well as with the other given, 1/sqrt(1 - 0.9^2) = 2.3.
TRADING, LOOSE = 0.9, 0.2
"""Correlation and relative standard error from which on a notice is given."""
PATTERN = 3.5  # 1 in 2000 of white noise
"""Standard errors beyond which the lag-1 autocorrelation of the misfit is no chance."""
PATTERN_SEEN = 1e-5  # below it lies the error of the shapes, 2e-6
"""Systematic misfit over the peak that is reported."""
ABOVE_NOISE = 4.0  # 1 record in 30 000
"""Standard errors by which a misfit exceeds the noise to count as more."""
# 5 standard deviations of a sample, squared, in the sum of squares, a tenth of the misfit, and the error of the
# shapes, without which exact pulses would always disagree.
DISAGREEING, WORSE, WORSE_BY = 25.0, 1.1, 1e-6
"""Excess of known values that disagree with a pulse."""
AS_GOOD, AS_GOOD_OFF, OTHER = 9.0, 1.2, 0.05
"""Excess with which another shape fits as well: 3 standard deviations, squared, or a fifth of the misfit where the law
does not describe the pulse; least difference in restitution of another shape."""
ONE_SIDED_95 = 1.645  # one-sided, since e cannot exceed 1
"""Standard deviations of a normal distribution below which 95 % lie."""
NO_LOSS = 0.9995  # to three digits it is 1
"""Lower bound of e from which on no loss is seen."""
AT_BOUND = 0.05, 0.01
"""Relative distances of e and of n from the bounds of the search within which they count as at them (chosen)."""
_TINY = 1e-300  # a perfect fit has no misfit, and no correlation
"""Divisor in place of zero."""


class IdentifiedValue(NamedTuple):
    """A value and its standard error: both None where it is not determined, the latter None where it was given."""

    value: float | None
    standard_error: float | None = None
    given: bool = False


@dataclass(frozen=True, eq=False)
class Identified:
    """Values of a contact that a force pulse determines.

    Attributes
    ----------
    values : dict of str to IdentifiedValue
        Each of `VALUES`, SI.
    begin : IdentifiedValue
        First touch, s.
    combinations : dict of str to IdentifiedValue
        Combinations that a pulse determines, whatever is given: ``momentum`` m v (N s), ``impulse`` m v (1 + e) (N s),
        ``peak_force`` (N), ``duration`` (s), ``stiffness_speed`` K v^n (N/s^n).
    names : tuple of str
        Names of the rows and columns of the correlation: values that were determined and not given.
    correlation : ndarray
        Correlation of the errors of logarithms, ``begin`` as it is; shape (names, names).
    noise : float
        Standard deviation of a sample on which the standard errors rest, N.
    residual : float
        Root mean square of measured minus fitted, as a share of the peak.
    time, measured, fitted : ndarray
        The samples taken, baseline taken off, and the fit, s and N; shape (samples,).
    offset : float
        Baseline before the pulse, N.
    pulse : ForcePulse
        The fit.
    described : bool
        True if the law describes the pulse.
    words : tuple of str
        Sentences on what is not determined, or not well; that on the misfit last.
    """

    values: dict[str, IdentifiedValue]
    begin: IdentifiedValue
    combinations: dict[str, IdentifiedValue]
    names: tuple[str, ...]
    correlation: Array
    noise: float
    residual: float
    time: Array
    measured: Array
    fitted: Array
    offset: float
    pulse: ForcePulse
    described: bool
    words: tuple[str, ...]

    def correlated(self, one: str, other: str) -> float | None:
        """Return the correlation of the errors of two values; None where one is given or not determined."""
        if one not in self.names or other not in self.names:
            return None
        return float(self.correlation[self.names.index(one), self.names.index(other)])


def identify(
    time: ArrayLike,
    force: ArrayLike,
    known: Mapping[str, float] | None = None,
    noise: float | None = None,
    window: tuple[float, float] | None = None,
) -> Identified:
    """Fit F = K d^n (1 + chi d'/v0) of two free bodies to the largest pulse of a record, by least squares.

    Parameters
    ----------
    time, force : array_like
        Samples, s and N; shape (N,), times ascending. A push is positive.
    known : mapping, optional
        Known values, by the names in `VALUES`. One of mass, speed and stiffness determines the other two.
    noise : float, optional
        Standard deviation of a sample, N; else from the samples before the pulse, and from the residual where that is
        larger or there are none.
    window : tuple of float, optional
        First and last time to fit, s; else from foot to foot of the largest pulse, and a fifth of it beyond.

    Returns
    -------
    Identified
        Values with standard errors, which hold for white noise and a pulse that the law describes.

    Raises
    ------
    ValueError
        If the record has no whole positive pulse of eight samples, or a known value is out of range or makes a pulse
        of quite another size.

    Notes
    -----
    Source: the closed form of ``contact/_kernels.py``; standard errors from the Jacobian (Gauss-Newton), that of
    the baseline included.

    Examples
    --------
    >>> t = np.arange(300) * 1e-6
    >>> pulse = identify(t, ForcePulse(50e-6, 2e4, 60e-6, 1.5, 0.6).force(t), {"mass": 0.1})
    >>> {name: float(f"{estimate.value:.3g}") for name, estimate in pulse.values.items()}
    {'stiffness': 3860000000.0, 'exponent': 1.5, 'restitution': 0.6, 'mass': 0.1, 'speed': 7.5}
    >>> identify(t, ForcePulse(50e-6, 2e4, 60e-6, 1.5, 0.6).force(t)).values["mass"].value is None
    True
    """
    given = _checked_known(known or {})
    if noise is not None and not 0.0 < noise < math.inf:
        raise ValueError(f"the noise must be a standard deviation above zero, N, got {noise!r}")
    stamps = np.atleast_1d(np.asarray(time, dtype=float))
    start = float(stamps[0]) if stamps.size and math.isfinite(stamps[0]) else 0.0
    within = None if window is None else (window[0] - start, window[1] - start)
    problem = PulseFitProblem(cut_out(stamps - start, force, within), given)
    alone = minima(problem.without_scales)
    if len(problem.scales) < 2:
        result = _identified([replace(fit, problem=problem) for fit in alone], alone[0], noise)
    else:
        fits = [solve(problem, near(problem, fit)) for fit in alone]
        result = _identified(sorted(fits, key=lambda fit: fit.deviation), alone[0], noise)
    begin, error, is_given = result.begin  # counted from the first sample, whose stamp may be large
    pulse = replace(result.pulse, begin=result.pulse.begin + start)
    begin_of_record = IdentifiedValue((begin or 0.0) + start, error, is_given)
    return replace(result, begin=begin_of_record, time=result.time + start, pulse=pulse)


def _checked_known(known: Mapping[str, float]) -> dict[str, float]:
    for name, value in known.items():
        if name not in VALUES:
            raise ValueError(f"{name!r} cannot be known; {nearest(str(name), VALUES)}")
        if not isinstance(value, int | float | np.number):
            raise ValueError(f"the {name} known must be a number, SI, got {value!r}")
        low, high = {"exponent": EXPONENTS, "restitution": RESTITUTIONS}.get(name, (0.0, math.inf))
        if not (low <= value <= high and 0.0 < value < math.inf):
            allowed = f"within {low:g} to {high:g}" if high < math.inf else "above zero and finite"
            raise ValueError(f"the {name} known must be {allowed}, got {value!r}")
    return {name: float(value) for name, value in known.items()}


class _Quality(NamedTuple):
    """Noise of a sample (N), misfit, its part that is no noise, and its lag-1 autocorrelation."""

    noise: float
    residual: float
    systematic: float
    autocorrelation: float


def _quality(fit: PulseFit, noise: float | None) -> _Quality:
    """Compare the misfit with the noise stated or seen before the pulse, and look for a pattern in it."""
    record, miss = fit.problem.record, fit.misfit
    deviation, freedom = fit.deviation * record.peak, max(miss.size - fit.unknown.size, 1)
    expected, count = (noise, math.inf) if noise is not None else (record.noise, record.before - 1)
    autocorrelation = float(miss[1:] @ miss[:-1]) / max(float(miss @ miss), _TINY)
    patterned = abs(autocorrelation) > PATTERN / math.sqrt(miss.size)
    systematic = math.sqrt(abs(autocorrelation)) * deviation if patterned else 0.0
    if expected is None:
        expected = deviation
    elif deviation**2 > expected**2 * (1.0 + ABOVE_NOISE * math.sqrt(2.0 / freedom + 2.0 / count)):
        systematic = max(systematic, math.sqrt(deviation**2 - expected**2))
        expected = deviation if noise is None else noise
    elif noise is None:
        expected = math.sqrt((freedom * deviation**2 + count * expected**2) / (freedom + count))
    residual = math.sqrt(float(miss @ miss) / miss.size)
    return _Quality(expected, residual, systematic / record.peak, autocorrelation)


def _identified(fits: list[PulseFit], alone: PulseFit, noise: float | None) -> Identified:
    fit = fits[0]
    problem, record = fit.problem, fit.problem.record
    quality = _quality(fit, noise)
    inverse = np.linalg.pinv(fit.jacobian) * (quality.noise / record.peak)
    baseline = inverse.sum(axis=1) / math.sqrt(max(record.before, 1))
    gradient = derivatives(problem.logarithms, fit.unknown, HIGH[problem.free])
    covariance = gradient @ (inverse @ inverse.T + np.outer(baseline, baseline) * (record.before > 0)) @ gradient.T
    value, error = problem.logarithms(fit.unknown), np.sqrt(np.diag(covariance))
    estimates = [
        IdentifiedValue(math.exp(x), math.exp(x) * float(s)) for x, s in zip(value[:-1], error[:-1], strict=True)
    ]
    values = dict(zip(VALUES, estimates, strict=False))
    values |= {name: IdentifiedValue(x, None, True) for name, x in problem.given.items()}
    if not problem.scales:
        values |= dict.fromkeys(SCALES, IdentifiedValue(None))
    determined = [k for k, name in enumerate(VALUES) if values[name].standard_error is not None] + [value.size - 1]
    scale = np.maximum(error[determined], _TINY)
    pulse = problem.pulse(fit.unknown)
    result = Identified(
        values=values,
        begin=IdentifiedValue(float(value[-1]), float(error[-1])),
        combinations=dict(zip(COMBINATIONS, estimates[len(VALUES) :], strict=True)),
        names=tuple([*VALUES, *COMBINATIONS, "begin"][k] for k in determined),
        correlation=covariance[np.ix_(determined, determined)] / np.outer(scale, scale),
        noise=quality.noise,
        residual=quality.residual,
        time=record.time,
        measured=record.force,
        fitted=pulse.force(record.time),
        offset=record.offset,
        pulse=pulse,
        described=quality.systematic <= DESCRIBED,
        words=(),
    )
    return replace(result, words=tuple(_notices(result, fits, alone, quality)))


def _notices(result: Identified, fits: list[PulseFit], alone: PulseFit, quality: _Quality) -> list[str]:
    """Return sentences on values not determined, loosely determined, or in disagreement."""
    fit, notices = fits[0], []
    if not fit.problem.scales:
        notices.append(
            "stiffness, mass and speed cannot be told apart from a force pulse: it fixes mass x speed = "
            f"{result.combinations['momentum'].value:.3g} N s and stiffness x speed^n only; give one of the three"
        )
    notices += [*_limits(result, fit), *_trades(result), *_others(fits, quality)]
    excess = float(fit.misfit @ fit.misfit - alone.misfit @ alone.misfit) * fit.problem.record.peak**2
    disagree = (
        fit.unknown.size < alone.unknown.size
        and excess > DISAGREEING * quality.noise**2
        and (fit.deviation > WORSE * alone.deviation + WORSE_BY)
    )
    if disagree:
        notices.append(
            f"the values given do not agree with the pulse: the misfit is {percent(quality.residual, 2)} of the peak "
            f"with them, {percent(alone.deviation, 2)} without; check {', '.join(sorted(fit.problem.scales))} and the "
            "calibration"
        )
    if quality.systematic > PATTERN_SEEN:
        law = "the law with the values given" if disagree else "the law"
        verdict = "" if result.described else f"{law} does not describe this pulse; "
        notices.append(
            f"the misfit is {percent(quality.residual, 2)} of the peak and follows a pattern (lag-1 autocorrelation "
            f"{quality.autocorrelation:.2f}): {verdict}the standard errors are too small"
        )
    return notices


def _others(fits: list[PulseFit], quality: _Quality) -> list[str]:
    """Return sentences on other shapes that fit as well."""
    best, notices = fits[0], []
    pulse = best.problem.pulse(best.unknown)
    for fit in fits[1:]:
        other = fit.problem.pulse(fit.unknown)
        more = float(fit.misfit @ fit.misfit - best.misfit @ best.misfit) * best.problem.record.peak**2
        close = more < AS_GOOD * quality.noise**2 or (
            quality.systematic > 0.0 and fit.deviation < AS_GOOD_OFF * best.deviation
        )
        if close and abs(other.restitution - pulse.restitution) > OTHER:
            notices.append(
                f"restitution {other.restitution:.2g} with exponent {other.exponent:.2g} fits about as well as "
                f"{pulse.restitution:.2g} with {pulse.exponent:.2g}: give the restitution, or both mass and speed"
            )
    return notices


def _limits(result: Identified, fit: PulseFit) -> list[str]:
    """Return sentences on values at a bound of the search."""
    notices = []
    near_e, near_n = AT_BOUND
    n, e = result.values["exponent"], result.values["restitution"]
    if fit.elastic:
        least = math.exp(-ONE_SIDED_95 * (e.standard_error or 0.0))
        bound = f"it is above {least:.3g} with 95 % confidence" if least < NO_LOSS else "no loss is seen in this pulse"
        notices.append(f"restitution is at its limit 1: {bound}")
    elif not e.given and (e.value or 0.0) < (1.0 + near_e) * RESTITUTIONS[0]:
        notices.append(f"restitution is at the lower bound of the search, {RESTITUTIONS[0]:g}")
    if not n.given and not (1.0 + near_n) * EXPONENTS[0] < (n.value or 0.0) < (1.0 - near_n) * EXPONENTS[1]:
        notices.append(f"exponent is at the bound of the search, {n.value:.3g}: the law does not suit this pulse")
    return notices


def _trades(result: Identified) -> list[str]:
    """Return sentences on values that trade against each other, and on loosely determined ones."""
    notices = []
    shared = result.correlated("exponent", "restitution")
    if shared is not None and abs(shared) > TRADING:
        notices.append(
            f"exponent and restitution trade against each other (correlation {shared:.2f}): give one to know the "
            "other better"
        )
    loose = {
        name: x.standard_error / x.value
        for name, x in result.values.items()
        if x.value and x.standard_error is not None and x.standard_error > LOOSE * x.value
    }
    if loose:
        notices.append(
            "loosely determined: " + ", ".join(f"{name} to {percent(share, 0)}" for name, share in loose.items())
        )
    return notices
