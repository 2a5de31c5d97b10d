"""One blow of two free bodies: exact where the law allows it, by the integrator where not."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from strikewave.base.errors import IntegrationError
from strikewave.contact import _kernels, _pair_kernels
from strikewave.contact._chain_kernels import SWITCHES
from strikewave.contact._integrator import Control, empty_record
from strikewave.contact._law_kernels import DAMPER, DAMPING, EXPONENT, STIFFNESS, YIELD_LOAD
from strikewave.contact._pair_kernels import MEMORIES, STATES, PairSystem
from strikewave.contact.law import (
    AnyContact,
    Contact,
    HardeningContact,
    RequestedDamping,
    flat,
    not_negative,
    positive,
    refuse,
    rows_beside,
)
from strikewave.contact.motion import FIRST_STEP, MotionState, integrate

Array = NDArray[np.float64]

CLOSED_FORM, INTEGRATOR = "closed form", "integrator"
"""Methods that solve an impact."""
SAME_RESTITUTION = 1e-6  # ten times the error of the integrator
"""Largest difference of equal restitutions."""
_STEPS = 1000  # usual ones take 10 to 30 (counted); a damper close to critical takes far more, as bodies hardly part
"""Most steps of one impact."""
_LARGEST_ENERGY = 1e60  # powers of such depths would overflow
"""m v0^2 beyond this, or below its inverse, is refused by the integrator, J."""
# Restitutions are then good to 1e-7, far better than any law, and a curve to its rounding.
TOLERANCE, HISTORY_TOLERANCE = 1e-8, 1e-9
"""Local errors of a step over its scales, of many impacts and of one in time."""
_HISTORY_STEPS = 500  # 0.2 % of the contact, finer than a curve in a figure shows
"""Steps of a history where no times are given."""
_ROUNDING = 1e-12  # the duration itself is good to 1e-10
"""Share of the duration by which a time may lie behind it."""


@dataclass(frozen=True, eq=False)
class ImpactProblem:
    """An impact as flat arrays: law rows (N, columns), reduced mass (kg), approach speed (m/s), depth yielded (m)."""

    laws: Array
    mass: Array
    speed: Array
    deepest: Array
    shape: tuple[int, ...]

    @property
    def closed(self) -> bool:
        """True if the closed form covers it: a power law with hysteresis alone."""
        return not np.any(self.laws[:, _pair_kernels.BEYOND_CLOSED_FORM]) and bool(
            np.all(np.isinf(self.laws[:, YIELD_LOAD]))
        )

    @property
    def numbers(self) -> tuple[Array, Array, Array, Array, Array]:
        """Stiffness, exponent, hysteresis factor, mass and speed."""
        k, n, chi = (np.ascontiguousarray(self.laws[:, place]) for place in (STIFFNESS, EXPONENT, DAMPING))
        return k, n, chi, self.mass, self.speed


@dataclass(frozen=True, eq=False)
class Impact:
    """Result of an impact; every array has the broadcast shape of the input.

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
    deepest : ndarray
        Depth to which the spot has yielded, m; 0 without a pressure cap.
    residual_indentation : ndarray
        Indentation that stays, m.
    flattening : ndarray
        Radius of the unloaded spot over that before it yielded.
    method : str
        ``closed form`` or ``integrator``.
    """

    restitution: Array
    max_indentation: Array
    peak_force: Array
    duration: Array
    energy_lost: Array
    deepest: Array
    residual_indentation: Array
    flattening: Array
    method: str
    problem: ImpactProblem = field(repr=False, compare=False)
    asked: RequestedDamping | None = field(default=None, repr=False, compare=False)
    _times: Array | None = field(default=None, repr=False, compare=False)

    @cached_property
    def _moments(self) -> Array:
        if self._times is not None:
            return self._times
        out = np.empty((2, self.problem.mass.size))
        k, n, chi, m, v = self.problem.numbers
        _kernels.all_moments(k, n, chi, m, v, out)
        return out

    @property
    def words(self) -> tuple[str, ...]:
        """Report the restitution that misses most the one asked of a named law."""
        if self.asked is None:
            return ()
        wanted, reached = np.broadcast_arrays(np.asarray(self.asked.restitution, dtype=float), self.restitution)
        misses = np.abs(reached - wanted).reshape(-1)
        if misses.max() <= SAME_RESTITUTION:
            return ()
        at = int(misses.argmax())
        pair = f"e = {reached.reshape(-1)[at]:.4f}, not the {wanted.reshape(-1)[at]:g} asked for"
        if np.any(self.flattening > 1.0):
            return (f"the contact yields: {pair} of {self.asked.law} alone",)
        return (f"the damping law {self.asked.law} gives {pair}; exact gives it",)

    @property
    def peak_time(self) -> Array:
        """Time of the largest force after first touch, s."""
        return self._moments[0].reshape(self.problem.shape)

    @property
    def turning_time(self) -> Array:
        """Time of the largest indentation after first touch, s."""
        return self._moments[1].reshape(self.problem.shape)


@dataclass(frozen=True, eq=False)
class ImpactHistory:
    """An impact in time: time after first touch (s), indentation (m), its rate (m/s), force (N)."""

    time: Array
    indentation: Array
    rate: Array
    force: Array
    method: str


def reduced_mass(mass1: ArrayLike, mass2: ArrayLike) -> Array:
    """Return m1 m2 / (m1 + m2), either of which may be infinite, kg.

    Returns
    -------
    ndarray
        In the broadcast shape of both, kg.

    Raises
    ------
    ValueError
        If a mass is not positive, or both are infinite; with the index of the first such pair.

    Examples
    --------
    >>> print(reduced_mass(0.2, np.inf), reduced_mass(2.0, 2.0))
    0.2 1.0
    """
    m1, m2 = np.broadcast_arrays(np.asarray(mass1, dtype=float), np.asarray(mass2, dtype=float))
    refuse("the first mass", m1, m1 > 0.0, "positive")
    refuse("the second mass", m2, m2 > 0.0, "positive")
    refuse("the second mass", m2, ~(np.isinf(m1) & np.isinf(m2)), "finite where the first is not")
    return np.asarray(1.0 / (1.0 / m1 + 1.0 / m2))  # not m1 m2/(m1 + m2), which is inf/inf for a fixed body


def solve_impact(
    contact: AnyContact,
    mass1: ArrayLike,
    mass2: ArrayLike,
    speed: ArrayLike,
    deepest: ArrayLike = 0.0,
    tolerance: float = TOLERANCE,
) -> Impact:
    """Solve the impact of two free bodies: exactly for a power law with hysteresis, by the integrator for the rest.

    Theory: :eq:`contact-phase-plane`.

    Nothing checks whether the bodies yield: without a pressure cap the contact is elastic to any force (`first_yield`
    has the load at which it begins to yield inside).

    All arguments broadcast against each other; a million impacts take one to two seconds in closed form, 15 to
    60 by the integrator.

    Parameters
    ----------
    contact : Contact, LogarithmicContact or HardeningContact
        The force law.
    mass1, mass2 : array_like
        Masses, kg; at most one of them infinite.
    speed : array_like
        Approach speed v0, m/s.
    deepest : array_like, optional
        Depth to which the spot has yielded in earlier blows, m: the `Impact.deepest` of the one before.
    tolerance : float, optional
        Tolerance of the integrator, per step.

    Returns
    -------
    Impact
        In closed form restitution to 1e-15, indentation and force to 1e-14, duration to 1e-10 (e > 0.001, n from 1
        to 2); by the integrator to 1e-7 at the default tolerance.

    Raises
    ------
    ValueError
        If a number of the law, a mass or a speed is out of range; with its index where there are several.
    IntegrationError
        If an impact cannot be followed, or presses beyond the end of a logarithmic law.

    Notes
    -----
    Source: the integral of the phase plane in ``contact/_kernels.py``; the duration by the double
    exponential rule (Takahasi & Mori 1974). Integrator: DOP853 (Hairer, Norsett & Wanner 1993).

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
    never = "positive and finite: bodies that do not approach each other never meet"
    mass, v = reduced_mass(mass1, mass2), positive("the approach speed", speed, never)
    before = not_negative("the depth yielded before", deepest)
    laws, shape = rows_beside(contact, mass, v, before)
    problem = ImpactProblem(laws, flat(mass, shape), flat(v, shape), flat(before, shape), shape)
    if not problem.closed:
        return replace(_by_steps(contact, problem, tolerance), asked=contact.asked)
    out = np.empty((4, problem.mass.size))
    k, n, chi, m, v = problem.numbers
    _kernels.impacts(k, n, chi, m, v, out)
    zeros, ones = np.zeros(shape), np.ones(shape)
    return replace(_impact(problem, out, zeros, zeros, ones, CLOSED_FORM), asked=contact.asked)


def _by_steps(contact: AnyContact, problem: ImpactProblem, tolerance: float) -> Impact:
    laws, count = problem.laws, problem.mass.size
    with np.errstate(over="ignore", under="ignore"):
        energy = problem.mass * problem.speed**2
    followed = (energy > 1.0 / _LARGEST_ENERGY) & (energy < _LARGEST_ENERGY)
    within = f"such that m v0^2 lies within {1 / _LARGEST_ENERGY:.0e} to {_LARGEST_ENERGY:.0e} J"
    refuse("the approach speed", problem.speed.reshape(problem.shape), followed.reshape(problem.shape), within)
    out = np.empty((_pair_kernels.ANSWERS, count))
    record = empty_record(_STEPS, STATES, 1, MEMORIES)
    _pair_kernels.impacts(laws, problem.mass, problem.speed, problem.deepest, tolerance, record, out)
    lost = np.flatnonzero(~np.all(np.isfinite(out), axis=0))
    if lost.size:
        at, where = lost[0], np.unravel_index(lost[0], problem.shape)
        raise IntegrationError(
            f"the impact {_index(where)} of {problem.mass[at]:.3g} kg at {problem.speed[at]:.3g} m/s could not be "
            f"followed in {_STEPS} steps, or its bodies never part (a damper that pulls, zeta >= 1): see its stiffness "
            f"{laws[at, STIFFNESS]:.3g}, damper {laws[at, DAMPER]:.3g} and yield load {laws[at, YIELD_LOAD]:.3g}, SI"
        )
    if not isinstance(contact, Contact):
        end = np.broadcast_to(contact.end_depth, problem.shape).reshape(-1)
        beyond = np.flatnonzero(out[_pair_kernels.INDENTATION] >= end)
        if beyond.size:
            where = np.unravel_index(beyond[0], problem.shape)
            what, do = "logarithmic law", "take a power law"
            if isinstance(contact, HardeningContact):
                what, do = "law of the cushion", "it bottoms out: take a thicker or larger one"
            raise IntegrationError(
                f"impact {_index(where)} presses {out[_pair_kernels.INDENTATION, beyond[0]] * 1e3:.3g} mm deep, beyond "
                f"the end of the {what} at {end[beyond[0]] * 1e3:.3g} mm: {do}"
            )
    spots = np.empty((3, count))
    spots[0] = out[_pair_kernels.DEEPEST]
    _pair_kernels.spots(laws, spots[0], spots[1], spots[2])
    deepest, left, flattened = (row.reshape(problem.shape) for row in spots)
    impact = _impact(problem, out, deepest, left, flattened, INTEGRATOR)
    return replace(impact, _times=out[_pair_kernels.PEAK_TIME : _pair_kernels.PEAK_TIME + 2])


def _index(where: tuple[np.intp, ...]) -> str:
    return "at index " + ", ".join(str(int(i)) for i in where) if where else "here"


def _impact(problem: ImpactProblem, out: Array, deepest: Array, left: Array, flat: Array, method: str) -> Impact:
    e, depth, force, duration = (row.reshape(problem.shape) for row in out[:4])
    with np.errstate(over="ignore", invalid="ignore"):
        # as a product: 1 - e^2 would lose the digits of 1 - e where little is lost
        lost = (0.5 * problem.mass * problem.speed**2).reshape(problem.shape) * (1.0 - e) * (1.0 + e)
    return Impact(e, depth, force, duration, np.asarray(lost), deepest, left, flat, method, problem)


def impact_history(
    impact: Impact, times: ArrayLike | None = None, tolerance: float = HISTORY_TOLERANCE
) -> ImpactHistory:
    """Return a single impact in time, from first touch to release.

    Parameters
    ----------
    impact : Impact
        One impact, not an array of them.
    times : array_like, optional
        Ascending times within the contact, s; 501 equal steps by default.
    tolerance : float, optional
        Tolerance of the integrator, where the closed form does not serve.

    Returns
    -------
    ImpactHistory
        Time (s), indentation (m), its rate (m/s) and force (N), in the shape of ``times``.

    Raises
    ------
    ValueError
        If it is several impacts, or a time lies outside the contact.
    """
    problem, duration = impact.problem, float(impact.duration.reshape(-1)[0])
    if problem.mass.size != 1:
        raise ValueError(f"a history is that of one impact, got {problem.mass.size}")
    if times is None:
        times = np.linspace(0.0, duration, _HISTORY_STEPS + 1)
    t = np.atleast_1d(np.asarray(times, dtype=float))
    if np.any(np.diff(t) < 0.0) or t[0] < 0.0 or t[-1] > duration * (1.0 + _ROUNDING):
        raise ValueError(f"times must ascend within the contact, 0 to {duration:g} s")
    if impact.method == CLOSED_FORM:
        out = np.empty((3, t.size))
        k, n, chi, m, v = problem.numbers
        _kernels.history(k[0], n[0], chi[0], m[0], v[0], t, out)
        return ImpactHistory(t, out[0], out[1], out[2], CLOSED_FORM)
    y, mode, memory = np.empty(STATES), np.empty(1, dtype=np.int64), np.empty(MEMORIES)
    _pair_kernels.begin(problem.laws[0], problem.speed[0], problem.deepest[0], y, mode, memory)
    depth, speed = float(impact.max_indentation.reshape(-1)[0]), float(problem.speed[0])
    period = depth / speed
    control = Control(tolerance, np.array([depth, speed]), FIRST_STEP * period, duration, 2.0 * duration)
    system = PairSystem(problem.laws[0], float(problem.mass[0]), _pair_kernels.FIRST_STEP * period)
    motion = integrate(system, MotionState(0.0, y, mode, memory), control, (1, SWITCHES))
    states, forces = motion.sample(np.minimum(t, motion.end.time))
    return ImpactHistory(t, states[:, 0], states[:, 1], forces[:, 0], INTEGRATOR)
