"""Least squares of the force of one impact: which unknowns are fitted when some are known, and from where it starts.

The pulse alone has five: begin, peak, width, n and e. Two known of stiffness, mass and speed take one of them away,
three take peak and width away. The fit starts from several shapes: those of low restitution look much like those of
a high one, so that there are two minima.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from strikewave.contact.force_pulse import ForcePulse, PulseRecord, shape, unit_impact

Array = NDArray[np.float64]

VALUES = ("stiffness", "exponent", "restitution", "mass", "speed")
"""What can be given or found: K (N/m^n), n, e, reduced mass m (kg), approach speed v (m/s)."""
SCALES = ("stiffness", "mass", "speed")
"""Those of which one must be given, so that the pulse determines the other two."""
EXPONENTS, RESTITUTIONS = (0.2, 8.0), (0.001, 1.0)
"""Bounds of the search: exponents well beyond those of contacts, 1 to 3 or so, that a fit at a bound shows a pulse of
another law."""
FREE = ("begin", "peak", "width", "exponent", "restitution")
"""What is fitted, where nothing is known."""
LOW = np.array([-1.0, -100.0, -100.0, math.log(EXPONENTS[0]), RESTITUTIONS[0]])
HIGH = np.array([1.0, 100.0, 100.0, math.log(EXPONENTS[1]), 1.0])
"""Bounds of the unknowns: the begin within a length of the record, sizes within exp(+-100), which is no bound."""
FARTHEST = 100.0
"""How many times another size than that of the pulse what is known may make: more is a wrong unit (a factor of
1000)."""
_STEP = 1e-5
"""Step of central differences: the cube root of rounding, where the error of the slope and rounding are alike."""
_BASINS = (0.5, 0.7, 0.85, 0.97), (0.05, 0.12, 0.25)
"""Restitutions that the fit begins from, of each of the two minima: the shapes of e above and below some 0.3 look
alike."""
_FIRST_EXPONENTS = 1.0, 1.5, 2.5
"""Exponents that the fit begins from: a spring, spheres, and a blunter contact."""
_INSIDE = 1e-3
"""Distance from the bounds at which a start is taken: the trust-region method must begin inside of them."""
_CONVERGED, _MOST_EVALUATIONS = 1e-13, 300
"""Relative changes that end the fit, some hundred times rounding, and evaluations after which it is left as it is;
usual fits take fewer than fifty."""
_NEAR_ELASTIC = 0.9
"""Fitted restitution from which on the limit e = 1 is tried as well."""
_AS_GOOD, _PERFECT = 1e-6, 1e-15
"""The limit e = 1 is taken where its squared misfit is larger by no more than this share, or than this a sample, which
is rounding in pulses without noise."""
_LEAST_PEAK = 0.1
"""Share of the measured peak that a first guess is high at least: a shape far off would else begin with no pulse."""
_TRIED_EXPONENTS = np.geomspace(0.3, 6.0, 61)
"""Exponents among which the one is found that fits what is known, 5 % apart: the fit does the rest."""
_CLOSER = 0.1
"""Weight of how far an exponent is from that of the pulse alone, beside how far peak and width are: it decides only
among exponents that suit what is known equally well."""
_ABOVE = 0.1
"""Share of the peak above which samples count in the moments of a pulse: noise far from it would count the more."""


@dataclass(frozen=True)
class PulseFitProblem:
    """A record and what is known; the unknowns are logarithms, but for e and the begin, a share of the time taken."""

    record: PulseRecord
    given: Mapping[str, float]

    @cached_property
    def scales(self) -> frozenset[str]:
        """Which of `SCALES` are known."""
        return frozenset(self.given) & frozenset(SCALES)

    @cached_property
    def without_scales(self) -> PulseFitProblem:
        """The problem of the pulse alone, n and e as they are known."""
        return PulseFitProblem(self.record, {name: value for name, value in self.given.items() if name not in SCALES})

    @cached_property
    def free(self) -> Array:
        """Places in `FREE` that are fitted: two known scales leave one of peak and width, three none."""
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
    """Return the minimum that is reached from a start; at the limit e = 1 exactly where that fits as well.

    Source: trust-region least squares within bounds (Branch, Coleman & Li 1999).

    Examples
    --------
    >>> from strikewave.contact.force_pulse import ForcePulse, cut_out
    >>> t = np.arange(300) * 1e-6
    >>> problem = PulseFitProblem(cut_out(t, ForcePulse(50e-6, 2e4, 60e-6, 1.5, 0.6).force(t)), {"exponent": 1.5})
    >>> fit = solve(problem, problem.unknowns(ForcePulse(40e-6, 1e4, 50e-6, 1.5, 0.8)))
    >>> round(problem.pulse(fit.unknown).restitution, 6)
    0.6
    """
    from scipy.optimize import least_squares

    low, high = LOW[problem.free], HIGH[problem.free]

    def slopes(unknown: Array) -> Array:
        return derivatives(problem.misfit, unknown, high)

    inside = np.clip(start, low + _INSIDE, high - _INSIDE)
    minimum = least_squares(
        problem.misfit,
        inside,
        slopes,
        (low, high),
        xtol=_CONVERGED,
        ftol=_CONVERGED,
        gtol=_CONVERGED,
        x_scale="jac",
        max_nfev=_MOST_EVALUATIONS,
    )
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
        if at[k] + _STEP > high[k]:
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
