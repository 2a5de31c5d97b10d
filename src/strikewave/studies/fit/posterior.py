"""The posterior of the values of a fit, sampled: bounds as flat priors on the scale on which each is searched.

The likelihood is that of the fit: the rise of its sum of squares, adjusted so that its curvature is the covariance of
the fit (Ribatet, Cooley & Davison 2012), in which the colour of the noise, what is left beyond it, and the scatter from
shot to shot are; as wide as the intervals of the fit have it by Student's t. What the data do not determine is left to
the prior.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strikewave.base import declare
from strikewave.base.declare import NOT_MEASURED
from strikewave.base.errors import MissingPackageError
from strikewave.base.shock_quantities import RATIO
from strikewave.studies.fit.checking import DRAWS, drawn_places
from strikewave.studies.fit.covariance import NORMAL, Estimate
from strikewave.studies.fit.estimation import Residuals, each_or_none
from strikewave.studies.fit.measured import MeasuredPulse
from strikewave.studies.fit.problem import Problem, Solved

Array = NDArray[np.float64]

SEED = 20  # random seed of the chains: equal seeds reproduce them bit for bit
WALKERS = DRAWS  # chains that move together: more than twice the most free fields, as the ensemble needs it
LONG, ENOUGH = 50.0, 2000.0
"""Autocorrelation times that a chain is long at least (Foreman-Mackey et al. 2013), and independent draws in all: ends
of a 95 % interval are then good to 3 % of its half."""
STEPS_AT_ONCE, MOST_RUNS = 25, 40_000
"""Steps between two looks at the chains, and runs at which they end whatever they are."""
TAILS = 4.0
"""Degrees of freedom of Student's t from which places are proposed: heavier tails than any posterior of a fit."""
INDEPENDENT = 0.7
"""Share of moves that propose from the covariance of the fit: its draws forget where they came from. The others, of
affine-invariant ensembles, find what that covariance does not know of."""
SMALLEST = 1e-16  # variance in the unit cube that stands for none
MOST_BANDS = 6  # pulses that get one: as many as are drawn over one another
PREDICTED = 100
"""Draws of which the predictive band of a pulse is made: its ends, 2.5 %, lie between the second and third of them."""


@declare.dataclass(eq=False)
class Posterior:
    """Draws of the posterior, and how far they can be trusted.

    Beside what documents have:

    Attributes
    ----------
    draws : ndarray
        Places in the unit cube, without the first two autocorrelation times; shape (draws, fields).
    runs : int
        Runs of the model at each setting.
    stopped : bool
        True if it was interrupted.
    """

    draws: Array
    walkers = declare.computed(declare.count("chains that move together"))(lambda posterior: WALKERS)
    steps: int = declare.count("steps of each chain")
    memory: float = declare.number(
        RATIO, "longest autocorrelation time of any field, steps", key="autocorrelation_time"
    )
    independent = declare.computed(declare.number(NOT_MEASURED, "independent draws, about", key="independent_draws"))(
        lambda posterior: WALKERS * posterior.steps / posterior.memory
    )
    accepted: float = declare.number(RATIO, "share of moves that were accepted")
    runs: int
    stopped: bool = False

    @declare.computed(declare.word("whether chains are too short to be trusted"))
    def too_short(self) -> bool:
        """True if chains are too short to be trusted."""
        return not (self.steps >= LONG * self.memory and self.independent >= ENOUGH)

    seed = declare.computed(declare.count("seed of the chains"))(lambda posterior: SEED)

    def quantiles(self, share: float) -> Array:
        """Return the place below which a share of the draws lies, of each field."""
        return np.asarray(np.quantile(self.draws, share, axis=0))

    def some(self, count: int) -> list[Array]:
        """Return draws evenly spaced along the chains."""
        return list(self.draws[np.linspace(0, len(self.draws) - 1, min(count, len(self.draws))).astype(int)])


def check_sampler() -> None:
    """Refuse to sample where emcee is not installed."""
    try:
        import emcee  # noqa: F401
    except ImportError:
        raise MissingPackageError("--bayes", "emcee", "bayes") from None


def widened(found: Estimate) -> Array:
    """Return the covariance of a normal distribution whose 95 % are those of the fit, where that has Student's t."""
    wider = np.where(np.isfinite(found.errors), found.reach / NORMAL, 1.0)
    return np.asarray(found.covariance * np.outer(wider, wider))


def adjustment(found: Estimate) -> Array:
    """Return A, with which misfit(best + A (place - best)) has the covariance V of `widened`: A'HA = 1/V, H = J'J."""
    size = found.place.size
    lost = found.undetermined @ found.undetermined.T
    values, vectors = np.linalg.eigh(np.eye(size) - lost)
    kept = vectors[:, values > 0.5]
    information = kept.T @ found.jacobian.T @ found.jacobian @ kept
    covariance = kept.T @ widened(found) @ kept
    return np.asarray(lost + kept @ _root(information) @ _root(covariance) @ kept.T)


def _root(matrix: Array) -> Array:
    """Return M^(-1/2) of a symmetric matrix."""
    values, vectors = np.linalg.eigh(matrix)
    return np.asarray(vectors / np.sqrt(np.maximum(values, SMALLEST)) @ vectors.T)


def log_likelihood(residuals: Residuals, found: Estimate) -> Callable[[Array], float]:
    """Return the logarithm of the likelihood at a place, but for a constant: -S/2 with S the rise of the misfit."""
    return functools.partial(_log_likelihood, residuals, found.place, found.misfit, adjustment(found))


def _log_likelihood(residuals: Residuals, best: Array, misfit: float, adjusted: Array, place: Array) -> float:
    left = residuals(np.clip(best + adjusted @ (place - best), 0.0, 1.0))
    return -0.5 * (float(left @ left) - misfit)


def sample(
    residuals: Residuals, found: Estimate, advance: Callable[[int, float], None] | None = None, seed: int = SEED
) -> Posterior | None:
    """Sample the posterior until chains are long enough; Ctrl-C keeps what there is, None where that is nothing."""
    import emcee

    likelihood, size, runs = log_likelihood(residuals, found), found.place.size, 0

    def many(places: Array) -> Array:
        nonlocal runs
        inside = np.all((places >= 0.0) & (places <= 1.0), axis=1)
        answers = each_or_none(likelihood, list(places[inside]))
        runs += len(answers)
        values = np.full(len(places), -math.inf)
        values[inside] = [-math.inf if answer is None or math.isnan(answer) else answer for answer in answers]
        if advance is not None:
            advance(runs, found.misfit)
        return values

    sampler = emcee.EnsembleSampler(WALKERS, size, many, moves=_moves(found), vectorize=True)
    sampler.random_state = np.random.RandomState(seed).get_state()
    begin, stopped = np.array(drawn_places(found)), False
    begin[~np.isfinite(many(begin))] = found.place
    try:
        for _ in sampler.sample(begin, iterations=MOST_RUNS // WALKERS, skip_initial_state_check=True):
            if sampler.iteration % STEPS_AT_ONCE == 0 and not _sampled(sampler, runs, False).too_short:
                break
    except KeyboardInterrupt:
        stopped = True
    return _sampled(sampler, runs, stopped) if sampler.iteration >= STEPS_AT_ONCE else None


def _sampled(sampler: Any, runs: int, stopped: bool) -> Posterior:
    steps = int(sampler.iteration)
    times = sampler.get_autocorr_time(tol=0)
    memory = max(float(np.max(times)), 1.0) if np.all(np.isfinite(times)) else math.inf
    discard = min(math.ceil(2.0 * memory), steps // 2) if math.isfinite(memory) else steps // 2
    draws, accepted = sampler.get_chain(discard=discard, flat=True), float(np.mean(sampler.acceptance_fraction))
    return Posterior(draws, steps, memory, accepted, runs, stopped)


def _moves(found: Estimate) -> Any:
    """Return the moves: from the covariance of the fit where it knows all directions, and those of ensembles."""
    import emcee

    ensemble = [(emcee.moves.StretchMove(), 0.5), (emcee.moves.DEMove(), 0.5)]
    if found.undetermined.shape[1]:
        return ensemble
    values, vectors = np.linalg.eigh(widened(found))
    scale = np.sqrt(np.maximum(values, SMALLEST))
    size = found.place.size

    def log_density(places: Array) -> Array:
        apart = (places - found.place) @ vectors / scale
        return np.asarray(-0.5 * (TAILS + size) * np.log1p(np.sum(apart**2, axis=1) / TAILS))

    def propose(places: Array, random: Any) -> tuple[Array, Array]:
        normal = random.standard_normal(places.shape)
        shrink = np.sqrt(random.chisquare(TAILS, len(places)) / TAILS)
        new = found.place + (normal / shrink[:, None] * scale) @ vectors.T
        return new, log_density(places) - log_density(new)

    independent = [(emcee.moves.MHMove(propose), INDEPENDENT)]
    return independent + [(move, (1.0 - INDEPENDENT) * share) for move, share in ensemble]


def predictive_bands(solved: Solved, posterior: Posterior, most: int) -> list[tuple[Array, Array]]:
    """Return ends of the 95 % band of the first pulses, sample by sample: of draws of the posterior, and of the noise.

    Each run is laid on its record, as in the fit.
    """
    problem = solved.problem
    pulses = [datum for datum in problem.measured if isinstance(datum, MeasuredPulse)][:most]
    if not pulses:
        return []
    answers = each_or_none(functools.partial(_curves, problem), posterior.some(PREDICTED))
    curves = [answer for answer in answers if answer is not None]
    bands = []
    for k, pulse in enumerate(pulses):
        low, middle, high = np.quantile([curve[k] for curve in curves], (0.025, 0.5, 0.975), axis=0)
        noise = NORMAL * pulse.deviation
        bands.append((middle - np.hypot(middle - low, noise), middle + np.hypot(high - middle, noise)))
    return bands


def _curves(problem: Problem, place: Array) -> list[Array]:
    """Return the computed pulses at a place, each laid on its record."""
    pairs = problem.with_runs(problem.runs(place))
    return [datum.laid(run).computed for datum, run in pairs if isinstance(datum, MeasuredPulse)]
