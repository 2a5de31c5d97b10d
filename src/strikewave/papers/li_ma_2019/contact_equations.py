"""Equations (1) to (25) of Li & Ma 2019, the contact force: their numbers on an example.

Each is taken for itself, with what enters it repaired and C that of the exact factor. Symbols: K stiffness
(N/m^n), C damping (N s/m^(n + 1)), chi = C v0/K, n = 10/9, d indentation (m), m_eq equivalent mass (kg), v0 closing
speed (m/s), e restitution, I the integral of (15).
"""

from __future__ import annotations

import math
from statistics import harmonic_mean
from typing import NamedTuple

import numpy as np
from scipy.integrate import quad, simpson
from scipy.optimize import brentq

from strikewave.base.materials import Material
from strikewave.contact import Stiffness, exact, factor, impact_history, palmgren, restitution
from strikewave.papers.li_ma_2019.examples import SAMPLES, ContactExample, SolvedContact, solve_blow
from strikewave.papers.li_ma_2019.values import Values

EXPONENT = 10.0 / 9.0
"""Exponent n of the line contact, as (2) and (3) print it."""
FORCE = 20e3
"""Force of the rows on stiffness, N: about the 19.7 kN that the paper simulates."""
SHALLOW = 1e-6
"""Depth at which K is read off Palmgren's formula, m: any would do, since the formula is a power."""
PRINTED_INTEGRAL = 0.3
"""The right side of (15)."""
INTEGRAL = 0.25 * math.sqrt(math.pi) * math.gamma(19.0 / 18.0) / math.gamma(23.0 / 9.0)
"""Its left side, B(19/18, 3/2)/2."""
BEARING_MODULUS = 206e9 / (1.0 - 0.3**2)
"""E' of bearing steel, for which the rule of roller bearings holds, Pa."""


def contact_values(example: ContactExample) -> dict[str, Values]:
    """Return the numbers of (1) to (25).

    Examples
    --------
    >>> values = contact_values(ContactExample())
    >>> round(values["(25)"].printed, 4), round(values["(25)"].exact, 4)
    (0.474, 0.5)
    """
    blow = solve_blow(example)
    return {**_stiffness(example), **_impact(blow), **_losses(blow), **_turning(blow), **_damping(blow)}


class Delivered(NamedTuple):
    """Restitution that was asked for, and what comes out as printed, with (15) exact, and with the exact factor."""

    asked: float
    printed: float
    integral_exact: float
    exact: float


def delivered(asked: float) -> Delivered:
    """Return what comes out where a restitution is asked for.

    Examples
    --------
    >>> print([round(value, 4) for value in delivered(0.3)])
    [0.3, 0.2591, 0.2672, 0.3]
    """
    laws = ("li-ma-printed", "li-ma-corrected", "exact")
    return Delivered(asked, *(float(restitution(factor(law, asked))) for law in laws))


def equivalent_modulus(one: Material, other: Material) -> tuple[float, float]:
    """Return what (5) gives as printed, 1/Pa, and with both sums below the line, Pa."""
    total = sum((1.0 - body.poissons_ratio**2) / body.youngs_modulus for body in (one, other))
    return 2.0 * total, 2.0 / total


def roller_indentation(force: float, modulus: float, length: float) -> float:
    """Return Palmgren's indentation, equation (2), m; force in N, E' in Pa, length in m."""
    return 3.81 * (2.0 / (math.pi * modulus)) ** 0.9 * force**0.9 / length**0.8


def _stiffness(example: ContactExample) -> dict[str, Values]:
    """Return (2) to (5)."""
    printed, modulus = equivalent_modulus(example.striker, example.struck)
    law: Stiffness = palmgren(example.striker, example.struck, example.contact_length)
    length = example.contact_length
    depth = roller_indentation(FORCE, modulus, length)
    bearing = 3.84e-5 * FORCE**0.9 / (1e3 * length) ** 0.8 * 1e-3 * (BEARING_MODULUS / modulus) ** 0.9
    at_depth = brentq(lambda f: roller_indentation(f, modulus, length) / SHALLOW - 1.0, 1.0, 1e6, xtol=1e-9, rtol=1e-14)
    plane = [body.youngs_modulus / (1.0 - body.poissons_ratio**2) for body in (example.striker, example.struck)]
    upside_down = roller_indentation(1.0, printed, length) ** -EXPONENT
    return {
        "(2)": Values(depth, words={"bearing": bearing, "off": 100.0 * (depth / bearing - 1.0)}),
        "(3)": Values(law.stiffness * depth**law.exponent, exact=FORCE),
        "(4)": Values(law.stiffness, exact=at_depth / SHALLOW**EXPONENT, words={"printed_modulus": upside_down}),
        "(5)": Values(printed, modulus, harmonic_mean(plane)),
    }


def _impact(blow: SolvedContact) -> dict[str, Values]:
    """Return (1) and (6) to (11)."""
    one, other, v0 = blow.example.striker_mass, blow.example.struck_mass, blow.example.speed
    time = float(blow.closed.peak_time)
    peak = impact_history(blow.closed, [time])
    depth, rate = float(peak.indentation[0]), float(peak.rate[0])
    fast, slow = (float(speed) for speed in blow.motion.speeds(blow.end))
    lost = 0.5 * one * (v0**2 - fast**2) - 0.5 * other * slow**2
    impulse, work = _impulse_and_work(blow)
    e = (slow - fast) / v0
    closed_loss = float(blow.closed.energy_lost)
    damped = blow.damping_work(0.0, blow.turning) + blow.damping_work(blow.turning, blow.end)
    force = blow.stiffness * depth**EXPONENT + blow.damping * depth**EXPONENT * rate
    return {
        "(1)": Values(force, exact=float(blow.motion.forces(time)[0])),
        "(6)": Values(lost, exact=closed_loss),
        "(7)": Values((one * (v0 - fast) - other * slow) / (one * v0), exact=0.0),
        "(8)": Values(e, exact=blow.example.restitution),
        "(9)": Values(blow.energy * (1.0 - e**2), exact=work),
        "(10)": Values(one * other / (one + other), exact=impulse / (v0 * (1.0 + e))),
        "(11)": Values(damped, exact=closed_loss),
    }


def _impulse_and_work(blow: SolvedContact) -> tuple[float, float]:
    """Return impulse (N s) and work (J) of the contact force over the integrated motion."""
    impulse = work = 0.0
    for begin, end in ((0.0, blow.turning), (blow.turning, blow.end)):
        times = np.linspace(begin, end, SAMPLES)
        force = blow.motion.forces(times)[:, 0]
        impulse += float(simpson(force, x=times))
        work += float(simpson(force * blow.approach(times)[1], x=times))
    return impulse, work


def _losses(blow: SolvedContact) -> dict[str, Values]:
    """Return (12) to (16): the estimate of the loss with the true C and depth."""
    v0, e = blow.example.speed, blow.example.restitution
    unit = blow.damping * v0 * blow.deepest ** (EXPONENT + 1.0)
    integral = float(quad(lambda x: x**EXPONENT * math.sqrt(1.0 - x * x), 0.0, 1.0, epsabs=1e-13, epsrel=1e-13)[0])
    elastic = _elastic_energy(blow)
    before = blow.damping_work(0.0, blow.turning)
    after = blow.damping_work(blow.turning, blow.end)
    lost = blow.energy * (1.0 - e**2)
    return {
        "(12)": Values(unit * INTEGRAL, blow.energy - elastic, before),
        "(13)": Values(unit * e * INTEGRAL, elastic - blow.energy * e**2, after),
        "(14)": Values(unit * (1.0 + e) * INTEGRAL, lost, before + after),
        "(15)": Values(PRINTED_INTEGRAL, INTEGRAL, integral),
        "(16)": Values(unit * (1.0 + e) * PRINTED_INTEGRAL, lost, before + after),
    }


def _elastic_energy(blow: SolvedContact) -> float:
    """Return U(max) of (18) at the largest indentation of the closed form, J."""
    return blow.stiffness * blow.deepest ** (EXPONENT + 1.0) / (EXPONENT + 1.0)


def _turning(blow: SolvedContact) -> dict[str, Values]:
    """Return (17) to (21): the balance at the largest indentation."""
    one, other, v0 = blow.example.striker_mass, blow.example.struck_mass, blow.example.speed
    speeds = blow.motion.speeds(blow.turning)
    depth = float(blow.approach(np.array([blow.turning]))[0][0])
    common = one * v0 / (one + other)
    kinetic = 0.5 * (one * float(speeds[0]) ** 2 + other * float(speeds[1]) ** 2)
    stored = float(quad(lambda d: blow.stiffness * d**EXPONENT, 0.0, depth, epsrel=1e-12)[0])
    lost = blow.damping_work(0.0, blow.turning)
    estimate = PRINTED_INTEGRAL * blow.damping * v0
    printed_depth = (blow.energy / (blow.stiffness / (EXPONENT + 1.0) + estimate)) ** (1.0 / (EXPONENT + 1.0))
    words = {"kinetic": 0.5 * (one + other) * common**2, "kinetic_exact": kinetic}
    return {
        "(17)": Values(kinetic + stored + lost, exact=0.5 * one * v0**2),
        "(18)": Values(_elastic_energy(blow), exact=stored),
        "(19)": Values(estimate * blow.deepest ** (EXPONENT + 1.0), blow.energy - _elastic_energy(blow), lost, words),
        "(20)": Values(printed_depth, blow.deepest, depth),
        "(21)": Values(common, exact=float(speeds[1])),
    }


def _damping(blow: SolvedContact) -> dict[str, Values]:
    """Return (22) to (25): the damping, and the restitution that comes of it."""
    example, v0, e = blow.example, blow.example.speed, blow.example.restitution
    fast, slow = (float(speed) for speed in blow.motion.speeds(blow.end))
    lost = 0.5 * example.striker_mass * (v0**2 - fast**2) - 0.5 * example.struck_mass * slow**2
    damped = blow.damping_work(0.0, blow.turning) + blow.damping_work(blow.turning, blow.end)
    true = lost / (damped / blow.damping)
    estimated = blow.energy * (1.0 - e) / (PRINTED_INTEGRAL * v0 * blow.deepest ** (EXPONENT + 1.0))
    printed, better, right = (float(factor(law, e)) for law in ("li-ma-printed", "li-ma-corrected", "exact"))
    out = delivered(e)
    words = {name: delivered(asked).printed for name, asked in (("tenth", 0.1), ("third", 0.3), ("half", 0.5))}
    over = blow.stiffness / v0
    return {
        "(22)": Values(damped / lost, exact=1.0),
        "(23)": Values(estimated, right * over, true),
        "(24)": Values(printed * over, right * over, true, {"factor": better * e / (1.0 - e), "better": better * over}),
        "(25)": Values(
            out.printed,
            float(restitution(exact(e))),
            (slow - fast) / v0,
            {**words, "better": out.integral_exact, "asked": e},
        ),
    }
