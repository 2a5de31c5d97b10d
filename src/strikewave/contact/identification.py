"""Identify a contact from one measured force pulse, and report what it cannot determine.

The law is F = K d^n (1 + chi d'/v0) of two free bodies. A force pulse alone determines m v and K v^n, never K, m and v
one by one (see ``contact/force_pulse.py``): one of them must be given. Exponent and restitution follow from the shape.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from strikewave.base.errors import nearest
from strikewave.base.percents import percent
from strikewave.contact.force_pulse import ForcePulse, cut_out
from strikewave.contact.pulse_fit import (
    EXPONENTS,
    HIGH,
    RESTITUTIONS,
    SCALES,
    VALUES,
    PulseFit,
    PulseFitProblem,
    derivatives,
    minima,
    near,
    solve,
)

Array = NDArray[np.float64]

COMBINATIONS = ("momentum", "impulse", "peak_force", "duration", "stiffness_speed")
"""What a pulse determines, whatever is given."""
DESCRIBED = 0.01
"""Misfit that is no noise, as a share of the peak, beyond which the law does not describe a pulse. Chosen: above the
error of a good measuring chain, below what a reader sees in the figure."""
TRADING, LOOSE = 0.9, 0.2
"""Correlation and relative standard error from which on a notice is given. Chosen: at 0.9 either value alone is known
less than half as well as with the other given (1/sqrt(1 - 0.9^2) = 2.3)."""
PATTERN = 3.5
"""Standard errors beyond which the lag-1 autocorrelation of the misfit is no chance: 1 record in 2000 of white
noise."""
PATTERN_SEEN = 1e-5
"""Misfit that is no noise, as a share of the peak, that is reported: below it lies the error of the shapes, 2e-6."""
ABOVE_NOISE = 4.0
"""Standard errors by which a misfit must exceed the noise to count as more than noise: 1 record in 30 000."""
DISAGREEING, WORSE, WORSE_BY = 25.0, 1.1, 1e-6
"""Values given do not agree with a pulse where they raise the sum of squares by 5 standard deviations of a sample,
squared, and the misfit by a tenth and by more than the error of the shapes: exact pulses would else always disagree."""
AS_GOOD, AS_GOOD_OFF, OTHER = 9.0, 1.2, 0.05
"""Another shape fits as well within 3 standard deviations, squared, or, where the law does not describe the pulse
anyway, within a fifth more misfit. It is another one from this difference in restitution on."""
ONE_SIDED_95 = 1.645
"""Standard deviations of a normal distribution below which 95 % lie: one-sided, since e cannot exceed 1."""
NO_LOSS = 0.9995
"""Lower bound of e from which on no loss is seen: to three digits it is 1."""
AT_BOUND = 0.05, 0.01
"""Distances of e and of n from the bounds of the search, relative, within which they count as lying at them."""
_TINY = 1e-300
"""Stands for zero below a fraction: a perfect fit has no misfit, and no correlation."""


class IdentifiedValue(NamedTuple):
    """A value and its standard error: both None where it is not determined, the latter None where it was given."""

    value: float | None
    standard_error: float | None = None
    given: bool = False


@dataclass(frozen=True, eq=False)
class Identified:
    """What a force pulse determines of a contact.

    Attributes
    ----------
    values : dict of str to IdentifiedValue
        Each of `VALUES`, SI.
    begin : IdentifiedValue
        First touch, s.
    combinations : dict of str to IdentifiedValue
        What a pulse determines, whatever is given: ``momentum`` m v (N s), ``impulse`` m v (1 + e) (N s),
        ``peak_force`` (N), ``duration`` (s), ``stiffness_speed`` K v^n (N/s^n).
    names : tuple of str
        Of the rows and columns of the correlation: what was determined and not given.
    correlation : ndarray
        Of the errors of logarithms, ``begin`` as it is; shape (names, names).
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
        Whether the law describes the pulse.
    words : tuple of str
        What is not determined, or not well, in sentences; that of the misfit last.
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
        What is known, by the names in `VALUES`. One of mass, speed and stiffness determines the other two.
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
    return _from(result, start)


def _from(result: Identified, start: float) -> Identified:
    """Return a result with its times counted as those of the record, not from its first sample."""
    begin, error, given = result.begin
    pulse = replace(result.pulse, begin=result.pulse.begin + start)
    return replace(
        result, begin=IdentifiedValue((begin or 0.0) + start, error, given), time=result.time + start, pulse=pulse
    )


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
    """How the misfit looks: noise of a sample (N), misfit, its part that is no noise, and its lag-1 autocorrelation."""

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
    """Report what is not determined, not well, or does not agree."""
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
    """Report which other shape fits as well: within the noise, or nearly where the law does not describe the pulse."""
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
    """Report which values lie at a bound of the search."""
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
    """Report which values trade against each other, and which are determined loosely."""
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
