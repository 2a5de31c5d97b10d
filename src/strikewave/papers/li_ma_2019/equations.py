"""The numbered equations of Li & Ma 2019, a row each: words from equations.toml, numbers computed on two examples.

The paper gives neither contact length nor speed, restitution nor specimen: those of the examples are assumed.
Materials are the paper's, the struck mass follows from its simulated force and acceleration. Each equation is judged
for itself, with what enters it repaired and C that of the exact factor.

Contact force, (1) to (25): K stiffness (N/m^n), C damping (N s/m^(n + 1)), chi = C v0/K, n = 10/9, d indentation (m),
m_eq equivalent mass (kg), v0 closing speed (m/s), e restitution, I the integral of (15).

Stress wave, (26) to (40): times count from the first arrival at x; t0 transit of the specimen (s), tl = (l - x)/c the
rest of it behind x, F_I and F_II reflections, gamma first strain over incident strain, eps_i incident strain, Z
impedance.
"""

from __future__ import annotations

import math
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field
from importlib import resources
from statistics import harmonic_mean
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import quad, simpson
from scipy.optimize import brentq
from scipy.special import i0, i1, j0, j1

from strikewave.base import declare
from strikewave.base.constants import Material, material
from strikewave.base.declare import Quantity
from strikewave.base.shock_quantities import RATIO
from strikewave.contact import (
    Chain,
    ChainContact,
    ChainMotion,
    Impact,
    Stiffness,
    exact,
    factor,
    impact_history,
    palmgren,
    reduced_mass,
    restitution,
    simulate,
    solve_impact,
)
from strikewave.papers.li_ma_2019.published import EXPONENT, SEE_UNIT, published_number
from strikewave.waves import BONDED, BarRun, End, Layer, LoadPulse, Stack, Tap, WantedError, round_bar, run_bar
from strikewave.waves.dispersion import phase_speed
from strikewave.waves.li_ma import Incident, Sandwich, acceleration, arrivals, mean_acceleration, strain, velocity

Array = NDArray[np.float64]
FarEnd = Literal["free", "matched", "rigid"]

STEPS_OF_TRANSIT = 256
"""Steps of the delay lines in a transit of the specimen: a power of two, so that x/l = 1/4 lies on a step."""
SAMPLES = 2001
"""Samples of each half of the integrated motion: an odd number for Simpson's rule, whose error falls as its 4th
power."""
LEAST_REFLECTION = 0.05
"""Least share of a wave that both interfaces reflect: its square, the second echo, must stand out of rounding."""
SIMULATED_FORCE = published_number("force simulated").value
"""Contact force that the paper simulates, N."""
STRUCK_MASS = round(SIMULATED_FORCE / published_number("rigid peak simulated").value, 3)
"""Mass that this force accelerates to the simulated peak, kg."""
SLOWEST = published_number("wave width").value
"""The paper's longest pulse, s."""
TOLERANCE = 1e-12
"""Local error of the integrated motion: as small as double precision bears, since it judges formulas."""
FOLLOWED = 1.5
"""Time of the integrated motion over the duration of the closed form, so that the release lies within it."""
TURNING = 1e-9
"""Accuracy of the time of the largest indentation, over the duration: the rate is 0 there, and so its error."""


@dataclass(frozen=True)
class ContactExample:
    """Two free bodies in line contact; contact length, striker mass, speed and restitution are assumed."""

    striker: Material = field(default_factory=lambda: material("65Mn"))
    struck: Material = field(default_factory=lambda: material("65Mn"))
    contact_length: float = 0.04  # m
    striker_mass: float = 0.2  # kg
    struck_mass: float = STRUCK_MASS  # kg
    speed: float = 20.0  # m/s
    restitution: float = 0.5  # that is asked for

    def __post_init__(self) -> None:
        if not 0.0 < self.restitution < 1.0:
            raise ValueError(
                f"the restitution must lie between 0 and 1 for a loss to be there, got {self.restitution!r}"
            )


@dataclass(frozen=True, eq=False)
class SolvedContact:
    """A contact example solved twice: in closed form, and by integrating both bodies in time (DOP853)."""

    example: ContactExample
    stiffness: float  # K, N/m^n
    exponent: float  # n
    damping: float  # C = chi K/v0 of the exact factor, N s/m^(n + 1)
    mass: float  # m_eq, kg
    closed: Impact
    motion: ChainMotion
    turning: float  # time of the largest indentation in the motion, s
    end: float  # time of the release, s

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
        striker, struck = self.motion.positions(times).T
        fast, slow = self.motion.speeds(times).T
        return np.maximum(striker - struck, 0.0), fast - slow


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


@dataclass(frozen=True)
class WaveExample:
    """A specimen of another impedance between two endless bars, seen at x = position l.

    The bars are 65Mn, 2A12, 65Mn of 30 mm, the specimen 50 mm long (assumed); the lengths of the others do not count.
    """

    upper: Layer = field(default_factory=lambda: round_bar("upper", material("65Mn"), 0.05, 0.03))
    specimen: Layer = field(default_factory=lambda: round_bar("specimen", material("2A12"), 0.05, 0.03))
    lower: Layer = field(default_factory=lambda: round_bar("lower", material("65Mn"), 0.05, 0.03))
    position: float = 0.5  # assumed
    force: float = SIMULATED_FORCE  # peak of the incident wave, N
    short: float = 20e-6  # length of a pulse of about two transits, s (assumed)
    slow: float = SLOWEST  # length of the paper's slowest pulse, s

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
        """The three bars in the form of the paper's route."""
        return Sandwich(self.upper, self.specimen, self.lower)

    @property
    def rest(self) -> float:
        """(l - x)/l, the paper's t_(l-x) over t0."""
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

    The endless bars are cut to the transit of the specimen: every transit is a whole number of steps, so that the delay
    lines are exact, and nothing comes back from behind the lower one. With a free or rigid end the specimen is the last
    layer.
    """
    place = example.position if position is None else position
    transit = example.specimen.transit
    upper, lower = (
        Layer(bar.name, bar.density, bar.modulus, bar.area, bar.bar_speed * transit)
        for bar in (example.upper, example.lower)
    )
    bars = (upper, example.specimen, lower) if end == "matched" else (upper, example.specimen)
    stack = Stack(bars, (BONDED,) * (len(bars) - 1), End(end))
    first = (1.0 + place) * transit
    wanted = WantedError(step=transit / STEPS_OF_TRANSIT)
    run: BarRun = run_bar(stack, pulse, [Tap(1, place)], first + transits * transit, wanted)
    strain = run.force[:, 0] / (example.specimen.modulus * example.specimen.area)
    return Watched(run.time - first, strain, run.velocity[:, 0], run.acceleration[:, 0])


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


Section = Literal["3.1", "3.2"]
Verdict = Literal["right", "approximate", "misprint", "wrong", "definition"]
Basis = Literal["independent", "round trip", "identity"]


@declare.dataclass
class EquationRow:
    """One numbered equation of the paper: as printed, corrected, exact."""

    number: str = declare.word('as the paper numbers it, "(24)"; that which it uses twice is "(35)" and "second (35)"')
    section: Section = declare.word("3.1 contact force, 3.2 stress wave")
    what: str = declare.word("what the equation says")
    formula: str = declare.word("the printed formula, plain Unicode text")
    tex: str = declare.word("it to typeset, as TeX")
    corrected: str = declare.word("the repaired formula; empty where the printed one stands")
    corrected_tex: str = declare.word("it to typeset, as TeX")
    quantity: str = declare.word("the number that is compared")
    unit: str = declare.word('its unit; "1" without one')
    printed: float | None = declare.number(
        Quantity.of_data("SI, see printed_unit, else unit"), "what the printed formula gives"
    )
    corrected_value: float | None = declare.number(SEE_UNIT, "what the corrected one gives")
    exact: float | None = declare.number(SEE_UNIT, "the answer that they are held against: see basis")
    verdict: Verdict = declare.word(
        "right: the numbers agree within rounding; approximate: an estimate, off by what the row shows; misprint: the "
        "formula as printed cannot be meant; wrong: it does not hold; definition: an identity or a name"
    )
    note: str = declare.word("why, and where the exact number comes from")
    basis: Basis = declare.word(
        "what the exact one is: independent, found another way; round trip, the same rule inverted, or a number that "
        "was put in and is read back; identity, the same thing by algebra or by the conservation that the solution is "
        "built on",
        default="independent",
    )
    printed_unit: str = declare.word("unit of the printed number where it is not unit", default="")

    @declare.computed(declare.number(RATIO, "what the printed value is off the exact one; null in another unit"))
    def deviation(self) -> float | None:
        """Deviation of the printed value, relative to the exact one (absolute where the exact one is 0).

        None where the two are not in one unit.
        """
        return None if self.printed_unit else _deviation(self.printed, self.exact)

    @declare.computed(declare.number(RATIO, "what the corrected value is off the exact one"))
    def corrected_deviation(self) -> float | None:
        """Deviation of the corrected value from the exact one, as `deviation`."""
        return _deviation(self.corrected_value, self.exact)


def _deviation(value: float | None, exact: float | None) -> float | None:
    """Return (value - exact)/|exact|, or the difference where exact is 0; None where one is missing."""
    if value is None or exact is None:
        return None
    return (value - exact) / (abs(exact) or 1.0)


EQUAL = 5e-7
"""Relative difference that is written as 0 %: as much is left by integration and rounding."""


@dataclass(frozen=True)
class Values:
    """Numbers of an equation as printed, corrected and exact; ``words`` are those that its text mentions by name."""

    printed: float | None
    corrected: float | None = None
    exact: float | None = None
    words: Mapping[str, float | str] = field(default_factory=dict)


FORCE = 20e3
"""Force of the rows on stiffness, N: about the 19.7 kN that the paper simulates."""
SHALLOW = 1e-6
"""Depth at which K is read off Palmgren's formula, m: any would do, since the formula is a power."""
PRINTED_INTEGRAL = 0.3
"""Right side of (15)."""
INTEGRAL = 0.25 * math.sqrt(math.pi) * math.gamma(19.0 / 18.0) / math.gamma(23.0 / 9.0)
"""Left side of (15), B(19/18, 3/2)/2."""
BEARING_MODULUS = 206e9 / (1.0 - 0.3**2)
"""E' of bearing steel, for which the rule of roller bearings holds, Pa."""


def contact_values(example: ContactExample) -> dict[str, Values]:
    """Return the numbers of (1) to (25)."""
    length, e = example.contact_length, example.restitution
    # stiffness, (2) to (5)
    compliance = sum((1.0 - body.poissons_ratio**2) / body.youngs_modulus for body in (example.striker, example.struck))
    printed_modulus, modulus = 2.0 * compliance, 2.0 / compliance
    law: Stiffness = palmgren(example.striker, example.struck, length)
    depth = roller_indentation(FORCE, modulus, length)
    bearing = 3.84e-5 * FORCE**0.9 / (1e3 * length) ** 0.8 * 1e-3 * (BEARING_MODULUS / modulus) ** 0.9
    at_depth = brentq(lambda f: roller_indentation(f, modulus, length) / SHALLOW - 1.0, 1.0, 1e6, xtol=1e-9, rtol=1e-14)
    plane = [body.youngs_modulus / (1.0 - body.poissons_ratio**2) for body in (example.striker, example.struck)]
    upside_down = roller_indentation(1.0, printed_modulus, length) ** -EXPONENT
    # the blow, (1) and (6) to (11)
    blow = solve_blow(example)
    m1, m2, v0 = example.striker_mass, example.struck_mass, example.speed
    time = float(blow.closed.peak_time)
    peak = impact_history(blow.closed, [time])
    indentation, rate = float(peak.indentation[0]), float(peak.rate[0])
    force = blow.stiffness * indentation**EXPONENT + blow.damping * indentation**EXPONENT * rate
    fast, slow = (float(speed) for speed in blow.motion.speeds(blow.end))
    lost = 0.5 * m1 * (v0**2 - fast**2) - 0.5 * m2 * slow**2
    impulse = work = 0.0
    for begin, end in ((0.0, blow.turning), (blow.turning, blow.end)):
        times = np.linspace(begin, end, SAMPLES)
        pressed = blow.motion.forces(times)[:, 0]
        impulse += float(simpson(pressed, x=times))
        work += float(simpson(pressed * blow.approach(times)[1], x=times))
    integrated_e, closed_loss = (slow - fast) / v0, float(blow.closed.energy_lost)
    before, after = blow.damping_work(0.0, blow.turning), blow.damping_work(blow.turning, blow.end)
    # the loss, (12) to (16), with the true C and depth
    power = EXPONENT + 1.0
    unit = blow.damping * v0 * blow.deepest**power
    integral = float(quad(lambda x: x**EXPONENT * math.sqrt(1.0 - x * x), 0.0, 1.0, epsabs=1e-13, epsrel=1e-13)[0])
    elastic, asked_loss = blow.stiffness * blow.deepest**power / power, blow.energy * (1.0 - e**2)
    # the balance at the largest indentation, (17) to (21)
    speeds = blow.motion.speeds(blow.turning)
    turning_depth = float(blow.approach(np.array([blow.turning]))[0][0])
    common = m1 * v0 / (m1 + m2)
    kinetic = 0.5 * (m1 * float(speeds[0]) ** 2 + m2 * float(speeds[1]) ** 2)
    stored = float(quad(lambda d: blow.stiffness * d**EXPONENT, 0.0, turning_depth, epsrel=1e-12)[0])
    estimate = PRINTED_INTEGRAL * blow.damping * v0
    printed_depth = (blow.energy / (blow.stiffness / power + estimate)) ** (1.0 / power)
    energies = {"kinetic": 0.5 * (m1 + m2) * common**2, "kinetic_exact": kinetic}
    # the damping, and the restitution that it gives, (22) to (25)
    true = lost / ((before + after) / blow.damping)
    estimated = blow.energy * (1.0 - e) / (PRINTED_INTEGRAL * v0 * blow.deepest**power)
    printed, better, right = (float(factor(name, e)) for name in ("li-ma-printed", "li-ma-corrected", "exact"))
    out, over = delivered(e), blow.stiffness / v0
    tried = {name: delivered(other).printed for name, other in (("tenth", 0.1), ("third", 0.3), ("half", 0.5))}
    return {
        "(2)": Values(depth, words={"bearing": bearing, "off": 100.0 * (depth / bearing - 1.0)}),
        "(3)": Values(law.stiffness * depth**law.exponent, exact=FORCE),
        "(4)": Values(law.stiffness, exact=at_depth / SHALLOW**EXPONENT, words={"printed_modulus": upside_down}),
        "(5)": Values(printed_modulus, modulus, harmonic_mean(plane)),
        "(1)": Values(force, exact=float(blow.motion.forces(time)[0])),
        "(6)": Values(lost, exact=closed_loss),
        "(7)": Values((m1 * (v0 - fast) - m2 * slow) / (m1 * v0), exact=0.0),
        "(8)": Values(integrated_e, exact=e),
        "(9)": Values(blow.energy * (1.0 - integrated_e**2), exact=work),
        "(10)": Values(m1 * m2 / (m1 + m2), exact=impulse / (v0 * (1.0 + integrated_e))),
        "(11)": Values(before + after, exact=closed_loss),
        "(12)": Values(unit * INTEGRAL, blow.energy - elastic, before),
        "(13)": Values(unit * e * INTEGRAL, elastic - blow.energy * e**2, after),
        "(14)": Values(unit * (1.0 + e) * INTEGRAL, asked_loss, before + after),
        "(15)": Values(PRINTED_INTEGRAL, INTEGRAL, integral),
        "(16)": Values(unit * (1.0 + e) * PRINTED_INTEGRAL, asked_loss, before + after),
        "(17)": Values(kinetic + stored + before, exact=0.5 * m1 * v0**2),
        "(18)": Values(elastic, exact=stored),
        "(19)": Values(estimate * blow.deepest**power, blow.energy - elastic, before, energies),
        "(20)": Values(printed_depth, blow.deepest, turning_depth),
        "(21)": Values(common, exact=float(speeds[1])),
        "(22)": Values((before + after) / lost, exact=1.0),
        "(23)": Values(estimated, right * over, true),
        "(24)": Values(printed * over, right * over, true, {"factor": better * e / (1.0 - e), "better": better * over}),
        "(25)": Values(
            out.printed, float(restitution(exact(e))), integrated_e, {**tried, "better": out.integral_exact, "asked": e}
        ),
    }


class Delivered(NamedTuple):
    """The restitution asked for, and the results as printed, with (15) exact and with the exact factor."""

    asked: float
    printed: float
    integral_exact: float
    exact: float


def delivered(asked: float) -> Delivered:
    """Return the restitution that each damping factor gives where one is asked for."""
    laws = ("li-ma-printed", "li-ma-corrected", "exact")
    return Delivered(asked, *(float(restitution(factor(law, asked))) for law in laws))


def roller_indentation(force: float, modulus: float, length: float) -> float:
    """Return Palmgren's indentation, equation (2), m; force in N, E' in Pa, length in m."""
    return 3.81 * (2.0 / (math.pi * modulus)) ** 0.9 * force**0.9 / length**0.8


LOW_FREQUENCY = 2.0 * math.pi * 100.0
"""rad/s: a wave a thousand times as long as the bar of the example is thick, where c = sqrt(E/rho) must hold."""
INTO_WINDOW = 0.3
"""Place in its window, over t0, at which an equation with several waves is read: away from arrivals."""
BEHIND_FRONT = 0.01
"""Distance behind a front, over t0, at which its height is read: past the jump, before the next one."""
PASSED = 6.0
"""Transits after the pulse for which a wave is followed: until the echoes that count have passed."""
NOTHING = 1e-30
"""Share of an area that stands for a free end (its inverse for a wall): below rounding, no division by 0."""
SETTLED = 60.0
"""Transits after which a step has settled to rounding in all but extreme examples."""


class Arrivals(NamedTuple):
    """The times at which the waves of a step come to x after the first, over t0."""

    printed: tuple[float, ...]
    corrected: tuple[float, ...]
    exact: tuple[float, ...]


def arrival_times(example: WaveExample, count: int = 5) -> Arrivals:
    """Return when the first waves come to x: by (36), corrected, and by delay lines; over t0."""
    sums = (arrivals(example.sandwich, example.position, count, route) for route in ("as printed", "corrected"))
    printed, corrected = (tuple(sorted(wave.transits for wave in waves)) for waves in sums)
    exact_times = watch(example, step_of(example), float(count)).arrivals() / example.specimen.transit
    return Arrivals(printed, corrected, tuple(round(float(time), 9) for time in exact_times[:count]))


def wave_values(example: WaveExample) -> dict[str, Values]:
    """Return the numbers of (26) to (40)."""
    upper, specimen, sandwich = example.upper, example.specimen, example.sandwich
    rest, transit, place = example.rest, specimen.transit, example.position
    gamma, first, second = sandwich.gamma, sandwich.first_reflection, sandwich.second_reflection
    routes = ("as printed", "corrected")
    step = incident_of(example, step_of(example))
    watched = watch(example, step_of(example), PASSED)
    # the first wave, (26) to (29)
    now = float(watched.strain[watched.at(0.5 * rest * transit)])
    entry, incident = 2.0 / (1.0 + upper.impedance / specimen.impedance), example.force / upper.area
    # echoes one by one under a step, (30) to the second (35)
    came = watched.arrivals()
    height, echo = (float(watched.strain[watched.at(came[k] + BEHIND_FRONT * transit)]) for k in (0, 1))
    values = {
        "(26)": Values(entry * upper.area / specimen.area * incident, exact=specimen.modulus * now),
        "(27)": Values(entry, exact=specimen.modulus * specimen.area * now / example.force),
        "(28)": Values(gamma * incident, gamma * example.incident, now),
        "(29)": Values(gamma, exact=now / example.incident),
        "(30)": Values(rest * transit, 2.0 * rest * transit, float(came[1])),
        "(31)": Values(second, exact=echo / height - 1.0),
        "(33)": Values((1.0 + rest) * transit, 2.0 * transit, float(came[2])),
    }
    terms = (gamma, gamma * second, -first * second, -first * second**2, first**2 * second**2)  # brackets as printed
    for number, count in (("(32)", 2), ("(34)", 3), ("(35)", 4), ("second (35)", 5)):
        time = (rest + count - 2 + INTO_WINDOW) * transit
        bracket, corrected = (
            float(strain(sandwich, step, place, [time], route, waves)[0])
            for route, waves in zip(routes, (count, None), strict=True)
        )
        exact_strain = float(watched.strain[watched.at(time)])
        words = {"bracket": bracket} if count > 2 else {}
        values[number] = Values(example.incident * sum(terms[:count]), corrected, exact_strain, words)
    # any number of waves, (36) and (37)
    short = pulse_of(example, example.short)
    watched = watch(example, short, example.short / transit + PASSED)
    printed_strain, strain_sum = (
        float(strain(sandwich, incident_of(example, short), place, watched.time, route).max()) for route in routes
    )
    settled = float(strain(sandwich, step, place, [SETTLED * transit], "as printed")[0])
    times = arrival_times(example)
    printed, true = (", ".join(f"{time:g}" for time in row) for row in (times.printed, times.exact))
    texts: dict[str, float | str] = {
        "short_us": example.short * 1e6,
        "settled": settled,
        "places": f"{printed} t₀ instead of {true} t₀",
    }
    early = sum(time < 2.0 for time in times.exact)
    # velocity, speed and acceleration, (38) to (40)
    free, wall = (end_speeds(example, end) for end in ("free", "rigid"))
    slow = pulse_of(example, example.slow)
    slowly = watch(example, slow, example.slow / transit + PASSED)
    printed_acceleration, corrected_acceleration = (
        float(acceleration(sandwich, incident_of(example, slow), place, slowly.time, route).max()) for route in routes
    )
    solid = solid_bar_speed(specimen) if specimen.poissons_ratio else None
    short_wave = {"short_wave": float(phase_speed(1.0, specimen.poissons_ratio or 0.0))}
    impedances = {"slow_us": example.slow * 1e6, "impedances": example.lower.impedance / specimen.impedance}
    return values | {
        "(36)": Values(printed_strain, strain_sum, float(watched.strain.max()), texts),
        "(37)": Values(float(len(arrivals(sandwich, place, 2, "as printed"))), exact=float(early)),
        "(38)": Values(*free, {"rigid_printed": wall[0], "rigid_exact": wall[2]}),
        "(39)": Values(specimen.bar_speed, exact=solid, words=short_wave),
        "(40)": Values(printed_acceleration, corrected_acceleration, float(slowly.acceleration.max()), impedances),
    }


def solid_bar_speed(bar: Layer, angular_frequency: float = LOW_FREQUENCY) -> float:
    """Return the speed of a long wave in a round bar as an elastic solid, m/s: it knows no sqrt(E/rho).

    First root c = w/k of Pochhammer's and Chree's equation (Graff 1975, section 8.2), with lambda and mu of Lame,
    c1^2 = (lambda + 2 mu)/rho, c2^2 = mu/rho, s^2 = k^2 - (w/c1)^2, q^2 = (w/c2)^2 - k^2 and a the radius:

        (2/a) (q^2 + k^2) s I1(s a) J1(q a) + (q^2 - k^2)^2 I0(s a) J1(q a) - 4 k^2 q s I1(s a) J0(q a) = 0.
    """
    nu, radius = bar.poissons_ratio or 0.0, 0.5 * bar.diameter
    if nu <= 0.0:
        raise ValueError(f"the bar needs a Poisson's ratio above 0, got {nu!r}")
    lame, shear = bar.modulus * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)), bar.modulus / (2.0 * (1.0 + nu))
    fast, slow = math.sqrt((lame + 2.0 * shear) / bar.density), math.sqrt(shear / bar.density)

    def residual(speed: float) -> float:
        k = angular_frequency / speed
        s, q = math.sqrt(k**2 - (angular_frequency / fast) ** 2), math.sqrt((angular_frequency / slow) ** 2 - k**2)
        pressure, turn = s * i1(s * radius), j1(q * radius)
        mixed = (q**2 - k**2) ** 2 * i0(s * radius) * turn - 4.0 * k**2 * q * pressure * j0(q * radius)
        return float(2.0 / radius * (q**2 + k**2) * pressure * turn + mixed)

    return float(brentq(residual, 1.01 * slow, 0.999 * fast, xtol=1e-9))


def end_speeds(example: WaveExample, end: FarEnd) -> tuple[float, float, float]:
    """Return the speed of the specimen's far end under a step, m/s: as printed, corrected, by delay lines.

    Taken one transit after the wave has come there.
    """
    area = {"free": NOTHING, "rigid": 1.0 / NOTHING}[end] * example.specimen.area
    behind = Layer("behind", example.lower.density, example.lower.modulus, area, example.lower.length)
    sandwich = Sandwich(example.upper, example.specimen, behind)
    time = example.specimen.transit
    pulse = step_of(example)
    printed, corrected = (
        float(velocity(sandwich, incident_of(example, pulse), 1.0, [time], route)[0])
        for route in ("as printed", "corrected")
    )
    watched = watch(example, pulse, 2.0, end, position=1.0)
    return printed, corrected, float(watched.velocity[watched.at(time)])


def mean_over_rigid(example: WaveExample) -> float:
    """Return the largest mean of the wave acceleration over the specimen, over its largest net force per mass.

    The mean is that of the corrected route, the force that of delay lines. It is 1: the wave's mean is the rigid-body
    acceleration, which cannot be added to it.
    """
    pulse, specimen = pulse_of(example, example.slow), example.specimen
    transits = example.slow / specimen.transit + PASSED
    first, last = (watch(example, pulse, transits, position=place) for place in (0.0, 1.0))
    times = first.time
    leaving = np.interp(times, last.time + specimen.transit, last.strain)
    net = specimen.modulus * specimen.area * (first.strain - leaving) / specimen.mass
    mean = mean_acceleration(example.sandwich, incident_of(example, pulse), times, "corrected")
    return float(mean.max() / net.max())


def equation_rows(contact: ContactExample | None = None, wave: WaveExample | None = None) -> tuple[EquationRow, ...]:
    """Return all numbered equations in their order, (1) to (25) on ``contact`` and (26) to (40) on ``wave``.

    Examples
    --------
    >>> rows = equation_rows()
    >>> len(rows), rows[14].number, rows[14].verdict, round(rows[14].deviation, 4)
    (41, '(15)', 'approximate', -0.0353)
    """
    values = {**contact_values(contact or ContactExample()), **wave_values(wave or WaveExample())}
    text = (resources.files("strikewave.papers.li_ma_2019") / "equations.toml").read_text("utf-8")
    rows = []
    for entry in tomllib.loads(text)["equation"]:
        numbers = values[entry["number"]]
        filled = {key: entry[key].format(**numbers.words) for key in ("quantity", "note")}
        texts: dict[str, Any] = {"corrected": "", "corrected_tex": "", **entry, **filled}
        rows.append(
            EquationRow(**texts, printed=numbers.printed, corrected_value=numbers.corrected, exact=numbers.exact)
        )
    return tuple(rows)
