"""The two examples on which every equation of Li & Ma 2019 is worked out, and their solutions.

The paper gives neither contact length nor speed, restitution nor specimen: those here are assumed. Materials are
the paper's, the struck mass follows from its simulated force and acceleration.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import simpson
from scipy.optimize import brentq

from strikewave.base.constants import Material, material
from strikewave.contact import (
    Chain,
    ChainContact,
    ChainMotion,
    Impact,
    exact,
    palmgren,
    reduced_mass,
    simulate,
    solve_impact,
)
from strikewave.papers.li_ma_2019.published import published_number
from strikewave.waves import BONDED, BarRun, End, Layer, LoadPulse, Stack, Tap, WantedError, round_bar, run_bar
from strikewave.waves.li_ma import Incident, Sandwich

Array = NDArray[np.float64]
FarEnd = Literal["free", "matched", "rigid"]

STEPS_OF_TRANSIT = 256
"""Steps of the delay lines in which a wave crosses the specimen; all transits are whole numbers of them, so that
the delay lines are exact. A power of two: a place such as x/l = 1/4 lies on a step."""
SAMPLES = 2001
"""Samples of the integrated motion up to the largest indentation, and as many after it: the error of Simpson's rule,
which takes an odd number, falls with its fourth power."""
LEAST_REFLECTION = 0.05
"""Share of a wave that both interfaces of a wave example must reflect: the second echo has its square, a 400th of the
wave, and the equations are judged by it."""
FORCE = published_number("force simulated").value
"""Contact force that the paper simulates, N."""
STRUCK_MASS = round(FORCE / published_number("rigid peak simulated").value, 3)
"""Mass that this force accelerates to the simulated peak, kg."""
SLOWEST = published_number("wave width").value
"""The paper's longest pulse, s."""
TOLERANCE = 1e-12
"""Local error of the integrated motion: as small as double precision bears, since formulas are judged by it."""
FOLLOWED = 1.5
"""Time of the integrated motion over the duration of the closed form, so that the release lies within it."""
TURNING = 1e-9
"""Accuracy of the time of the largest indentation, over the duration: there the rate, and so its error, is nothing."""


@dataclass(frozen=True)
class ContactExample:
    """Two free bodies in line contact.

    Attributes
    ----------
    striker, struck : Material
        Materials of the half-cylinder and of the plane.
    contact_length : float
        h, m (assumed).
    striker_mass, struck_mass : float
        m1, assumed, and m2, 19 685.34 N over 4 374.52 g; kg.
    speed : float
        v0, m/s (assumed).
    restitution : float
        e that is asked for (assumed).
    """

    striker: Material = field(default_factory=lambda: material("65Mn"))
    struck: Material = field(default_factory=lambda: material("65Mn"))
    contact_length: float = 0.04
    striker_mass: float = 0.2
    struck_mass: float = STRUCK_MASS
    speed: float = 20.0
    restitution: float = 0.5

    def __post_init__(self) -> None:
        if not 0.0 < self.restitution < 1.0:
            raise ValueError(
                f"the restitution must lie between 0 and 1 for a loss to be there, got {self.restitution!r}"
            )


@dataclass(frozen=True, eq=False)
class SolvedContact:
    """A contact example solved twice: in closed form, and by integrating both bodies in time.

    Attributes
    ----------
    example : ContactExample
        Solved example, with the factor that gives exactly the restitution asked for.
    stiffness, exponent, damping : float
        K, N/m^n; n; C = chi K/v0, N s/m^(n + 1).
    mass : float
        m_eq, kg.
    closed : Impact
        The closed form.
    motion : ChainMotion
        Both bodies by DOP853.
    turning, end : float
        Times of the largest indentation and of the release in that motion, s.
    """

    example: ContactExample
    stiffness: float
    exponent: float
    damping: float
    mass: float
    closed: Impact
    motion: ChainMotion
    turning: float
    end: float

    @property
    def deepest(self) -> float:
        """Largest indentation in closed form, m."""
        return float(self.closed.max_indentation)

    @property
    def energy(self) -> float:
        """Energy of the approach, m_eq v0^2/2, J."""
        return 0.5 * self.mass * self.example.speed**2

    def damping_work(self, begin: float, end: float) -> float:
        """Return the work of C d^n d' over the integrated motion between two times, J."""
        times = np.linspace(begin, end, SAMPLES)
        depth, rate = self.approach(times)
        return float(simpson(self.damping * depth**self.exponent * rate**2, x=times))

    def approach(self, times: Array) -> tuple[Array, Array]:
        """Return indentation (m) and its rate (m/s) of the integrated motion."""
        one, other = self.motion.positions(times).T
        fast, slow = self.motion.speeds(times).T
        return np.maximum(one - other, 0.0), fast - slow


def solve_blow(example: ContactExample) -> SolvedContact:
    """Solve an example in closed form and by the integrator.

    Examples
    --------
    >>> blow = solve_blow(ContactExample())
    >>> round(blow.deepest * 1e3, 4), round(float(blow.closed.peak_force) / 1e3, 1)
    (0.134, 324.9)
    """
    law = palmgren(example.striker, example.struck, example.contact_length)
    factor = float(exact(example.restitution))
    contact = law.contact(factor)
    closed = solve_impact(contact, example.striker_mass, example.struck_mass, example.speed)
    bodies = {"striker": example.striker_mass, "struck": example.struck_mass}
    chain = Chain(bodies, [ChainContact("striker", "struck", contact)])
    motion = simulate(chain, {}, {"striker": example.speed}, FOLLOWED * float(closed.duration), TOLERANCE)
    end = float(motion.contacts(0)[0, 1])

    def rate(time: float) -> float:
        return float(-np.diff(motion.speeds(time))[0])

    turning = float(brentq(rate, 0.0, end, xtol=TURNING * end))
    mass = float(reduced_mass(example.striker_mass, example.struck_mass))
    damping = factor * law.stiffness / example.speed
    return SolvedContact(example, law.stiffness, law.exponent, damping, mass, closed, motion, turning, end)


def _bar(name: str, of: str) -> Layer:
    return round_bar(name, material(of), 0.05, 0.03)


@dataclass(frozen=True)
class WaveExample:
    """A specimen of another impedance between two endless bars, seen at x = position l.

    Attributes
    ----------
    upper, specimen, lower : Layer
        The bars: 65Mn, 2A12, 65Mn of 30 mm, the specimen 50 mm long (assumed); the lengths of the others do not count.
    position : float
        x/l (assumed).
    force : float
        Peak of the wave that comes in, N: the contact force that the paper simulates.
    short, slow : float
        Lengths of a short pulse, about two transits (assumed), and of the paper's slowest one, s.
    """

    upper: Layer = field(default_factory=lambda: _bar("upper", "65Mn"))
    specimen: Layer = field(default_factory=lambda: _bar("specimen", "2A12"))
    lower: Layer = field(default_factory=lambda: _bar("lower", "65Mn"))
    position: float = 0.5
    force: float = FORCE
    short: float = 20e-6
    slow: float = SLOWEST

    def __post_init__(self) -> None:
        if not (0.0 < self.position < 1.0 and (self.position * STEPS_OF_TRANSIT).is_integer()):
            raise ValueError(
                f"the position x/l must be a multiple of 1/{STEPS_OF_TRANSIT} between 0 and 1, got {self.position!r}"
            )
        echoes = abs(self.sandwich.first_reflection), abs(self.sandwich.second_reflection)
        if not LEAST_REFLECTION < min(echoes) <= max(echoes) < 1.0:
            raise ValueError(
                f"both interfaces must reflect more than {LEAST_REFLECTION:g} of a wave for echoes to be seen, got "
                f"{echoes[0]:.3g} and {echoes[1]:.3g}: take a specimen of another impedance"
            )

    @property
    def sandwich(self) -> Sandwich:
        """The three as the paper's route takes them."""
        return Sandwich(self.upper, self.specimen, self.lower)

    @property
    def rest(self) -> float:
        """(l - x)/l: what the paper's t_(l-x) is of t0."""
        return 1.0 - self.position

    @property
    def incident(self) -> float:
        """Strain of the incident wave at its peak."""
        return self.force / (self.upper.modulus * self.upper.area)


@dataclass(frozen=True, eq=False)
class Watched:
    """Waves in the specimen at x by delay lines: time from the first arrival there (s), strain, m/s, m/s^2."""

    time: Array
    strain: Array
    velocity: Array
    acceleration: Array

    def at(self, time: float) -> int:
        """Return the sample at a time."""
        return int(np.argmin(np.abs(self.time - time)))

    def arrivals(self) -> Array:
        """Return when the strain jumps, s."""
        jumps = np.abs(np.diff(self.strain)) > 1e-9 * np.abs(self.strain).max()
        return self.time[1:][jumps]


def watch(
    example: WaveExample, pulse: LoadPulse, transits: float, end: FarEnd = "matched", position: float | None = None
) -> Watched:
    """Follow an incident wave through the bars by delay lines, for so many transits of the specimen.

    The endless bars are cut to the transit of the specimen, so that every transit is a whole number of steps and the
    delay lines are exact; behind the lower one nothing comes back. With a free or rigid end the specimen is the last
    layer.

    Examples
    --------
    >>> example = WaveExample()
    >>> seen = watch(example, step_of(example), 5.0)
    >>> print((seen.arrivals() / example.specimen.transit).round(9))
    [0. 1. 2. 3. 4. 5.]
    """
    place = example.position if position is None else position
    transit = example.specimen.transit
    upper, lower = (_cut(bar, transit) for bar in (example.upper, example.lower))
    bars = (upper, example.specimen, lower) if end == "matched" else (upper, example.specimen)
    stack = Stack(bars, (BONDED,) * (len(bars) - 1), End(end))
    first = (1.0 + place) * transit
    wanted = WantedError(step=transit / STEPS_OF_TRANSIT)
    run: BarRun = run_bar(stack, pulse, [Tap(1, place)], first + transits * transit, wanted)
    strain = run.force[:, 0] / (example.specimen.modulus * example.specimen.area)
    return Watched(run.time - first, strain, run.velocity[:, 0], run.acceleration[:, 0])


def _cut(bar: Layer, transit: float) -> Layer:
    """Return a bar of a wanted transit time, without a diameter of its own."""
    return Layer(bar.name, bar.density, bar.modulus, bar.area, bar.bar_speed * transit)


def step_of(example: WaveExample) -> LoadPulse:
    """Return a jump of the incident wave that stays."""
    return LoadPulse("rectangle", example.force, 1.0, kind="incident")


def pulse_of(example: WaveExample, duration: float) -> LoadPulse:
    """Return a smooth incident pulse, F0 sin^2(pi t/T)."""
    return LoadPulse("sine-squared", example.force, duration, kind="incident")


def incident_of(example: WaveExample, pulse: LoadPulse) -> Incident:
    """Return strain and strain rate of an incident pulse, the rate of a jump being zero."""
    over = 1.0 / (example.upper.modulus * example.upper.area)

    def rate(t: Array) -> Array:
        if pulse.shape == "rectangle":
            return np.zeros_like(t)
        slope = pulse.peak * math.pi / pulse.duration * np.sin(2.0 * math.pi * t / pulse.duration)
        return np.where((t >= 0.0) & (t < pulse.duration), over * slope, 0.0)

    return Incident(lambda t: over * pulse.at(t), rate)
