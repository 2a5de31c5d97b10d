"""Equations (26) to (40) of Li & Ma 2019, the stress wave: their numbers on an example.

Times count from the first arrival at x. Symbols: t0 transit of the specimen (s), tl = (l - x)/c what is left of it
behind x, F_I and F_II reflections, gamma first strain over incident strain, eps_i incident strain, Z impedance.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq
from scipy.special import i0, i1, j0, j1

from strikewave.papers.li_ma_2019.examples import FarEnd, Watched, WaveExample, incident_of, pulse_of, step_of, watch
from strikewave.papers.li_ma_2019.values import Values
from strikewave.waves import Layer
from strikewave.waves.dispersion import phase_speed
from strikewave.waves.li_ma import Sandwich, acceleration, arrivals, mean_acceleration, strain, velocity

Array = NDArray[np.float64]

LOW_FREQUENCY = 2.0 * math.pi * 100.0
"""rad/s: a wave over a thousand times as long as the example's bar is thick, where c = sqrt(E/rho) must hold."""
INTO_WINDOW = 0.3
"""How far into its window, over t0, an equation with several waves is read: away from its ends, where waves arrive."""
BEHIND_FRONT = 0.01
"""How far behind a front, over t0, its height is read: past the jump, long before the next one."""
PASSED = 6.0
"""Transits after the pulse for which a wave is followed: until the echoes that count have passed."""
NOTHING = 1e-30
"""Share of an area that stands for a free end; its inverse for a rigid wall: below rounding, and no division by 0."""
SETTLED = 60.0
"""Transits after which a step has settled to rounding in all but extreme examples."""


class Arrivals(NamedTuple):
    """When the waves of a step come to x after the first, over t0."""

    printed: tuple[float, ...]
    corrected: tuple[float, ...]
    exact: tuple[float, ...]


def arrival_times(example: WaveExample, count: int = 5) -> Arrivals:
    """Return when the first waves come to x: by (36), corrected, and by delay lines; over t0.

    Examples
    --------
    >>> times = arrival_times(WaveExample())
    >>> times.printed, times.exact
    ((0.0, 0.5, 1.5, 2.5, 3.5), (0.0, 1.0, 2.0, 3.0, 4.0))
    """
    sums = (arrivals(example.sandwich, example.position, count, route) for route in ("as printed", "corrected"))
    printed, corrected = (tuple(sorted(wave.transits for wave in waves)) for waves in sums)
    seen = watch(example, step_of(example), float(count)).arrivals() / example.specimen.transit
    return Arrivals(printed, corrected, tuple(round(float(time), 9) for time in seen[:count]))


def wave_values(example: WaveExample) -> dict[str, Values]:
    """Return the numbers of (26) to (40).

    Examples
    --------
    >>> values = wave_values(WaveExample())
    >>> round(values["(30)"].printed / values["(30)"].exact, 9)
    0.5
    """
    seen = watch(example, step_of(example), PASSED)
    return {**_first(example, seen), **_echoes(example, seen), **_any_number(example), **_motion(example)}


def _first(example: WaveExample, seen: Watched) -> dict[str, Values]:
    """Return (26) to (29): the first wave."""
    upper, specimen, sandwich = example.upper, example.specimen, example.sandwich
    now = float(seen.strain[seen.at(0.5 * example.rest * specimen.transit)])
    entry = 2.0 / (1.0 + upper.impedance / specimen.impedance)
    incident = example.force / upper.area
    return {
        "(26)": Values(entry * upper.area / specimen.area * incident, exact=specimen.modulus * now),
        "(27)": Values(entry, exact=specimen.modulus * specimen.area * now / example.force),
        "(28)": Values(sandwich.gamma * incident, sandwich.gamma * example.incident, now),
        "(29)": Values(sandwich.gamma, exact=now / example.incident),
    }


def _echoes(example: WaveExample, seen: Watched) -> dict[str, Values]:
    """Return (30) to the second (35): echoes one by one, under a step."""
    sandwich, rest, transit = example.sandwich, example.rest, example.specimen.transit
    gamma, one, two = sandwich.gamma, sandwich.first_reflection, sandwich.second_reflection
    came = seen.arrivals()
    first, second = (float(seen.strain[seen.at(came[k] + BEHIND_FRONT * transit)]) for k in (0, 1))
    terms = (gamma, gamma * two, -one * two, -one * two**2, one**2 * two**2)  # brackets as printed
    values = {
        "(30)": Values(rest * transit, 2.0 * rest * transit, float(came[1])),
        "(31)": Values(two, exact=second / first - 1.0),
        "(33)": Values((1.0 + rest) * transit, 2.0 * transit, float(came[2])),
    }
    for number, count in (("(32)", 2), ("(34)", 3), ("(35)", 4), ("second (35)", 5)):
        time = (rest + count - 2 + INTO_WINDOW) * transit
        whole, corrected = (
            float(strain(sandwich, incident_of(example, step_of(example)), example.position, [time], route, taken)[0])
            for route, taken in (("as printed", count), ("corrected", None))
        )
        words = {"bracket": whole} if count > 2 else {}
        values[number] = Values(
            example.incident * sum(terms[:count]), corrected, float(seen.strain[seen.at(time)]), words
        )
    return values


def _any_number(example: WaveExample) -> dict[str, Values]:
    """Return (36) and (37): any number of waves."""
    sandwich, place, transit = example.sandwich, example.position, example.specimen.transit
    pulse = pulse_of(example, example.short)
    seen = watch(example, pulse, example.short / transit + PASSED)
    routes = ("as printed", "corrected")
    printed, corrected = (
        float(strain(sandwich, incident_of(example, pulse), place, seen.time, route).max()) for route in routes
    )
    late = [SETTLED * transit]
    settled = float(strain(sandwich, incident_of(example, step_of(example)), place, late, "as printed")[0])
    times = arrival_times(example)
    places = ", ".join(f"{t:g}" for t in times.printed) + " t₀ instead of " + ", ".join(f"{t:g}" for t in times.exact)
    words: dict[str, float | str] = {"short_us": example.short * 1e6, "settled": settled, "places": f"{places} t₀"}
    early = sum(time < 2.0 for time in times.exact)
    return {
        "(36)": Values(printed, corrected, float(seen.strain.max()), words),
        "(37)": Values(float(len(arrivals(sandwich, place, 2, "as printed"))), exact=float(early)),
    }


def _motion(example: WaveExample) -> dict[str, Values]:
    """Return (38) to (40): velocity, speed and acceleration."""
    specimen = example.specimen
    free, wall = (end_speeds(example, end) for end in ("free", "rigid"))
    pulse = pulse_of(example, example.slow)
    seen = watch(example, pulse, example.slow / specimen.transit + PASSED)
    printed, corrected = (
        float(acceleration(example.sandwich, incident_of(example, pulse), example.position, seen.time, route).max())
        for route in ("as printed", "corrected")
    )
    words = {"slow_us": example.slow * 1e6, "impedances": example.lower.impedance / specimen.impedance}
    return {
        "(38)": Values(*free, {"rigid_printed": wall[0], "rigid_exact": wall[2]}),
        "(39)": Values(
            specimen.bar_speed,
            exact=solid_bar_speed(specimen) if specimen.poissons_ratio else None,
            words={"short_wave": float(phase_speed(1.0, specimen.poissons_ratio or 0.0))},
        ),
        "(40)": Values(printed, corrected, float(seen.acceleration.max()), words),
    }


def solid_bar_speed(bar: Layer, angular_frequency: float = LOW_FREQUENCY) -> float:
    """Return the speed of a long wave in a round bar as an elastic solid, m/s: it knows no sqrt(E/rho).

    First root c = w/k of Pochhammer's and Chree's equation (Graff 1975, section 8.2), with lambda and mu of Lame,
    c1^2 = (lambda + 2 mu)/rho, c2^2 = mu/rho, s^2 = k^2 - (w/c1)^2, q^2 = (w/c2)^2 - k^2 and a the radius:

        (2/a) (q^2 + k^2) s I1(s a) J1(q a) + (q^2 - k^2)^2 I0(s a) J1(q a) - 4 k^2 q s I1(s a) J0(q a) = 0.

    Raises
    ------
    ValueError
        If the bar has no Poisson's ratio above 0, where c lies between c2 and c1.

    Examples
    --------
    >>> bar = WaveExample().specimen
    >>> round(solid_bar_speed(bar), 2), round(bar.bar_speed, 2)
    (5089.13, 5089.13)
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

    Examples
    --------
    >>> printed, corrected, exact = end_speeds(WaveExample(), "free")
    >>> bool(abs(printed) < 1e-9 * exact), round(corrected / exact, 9)
    (True, 1.0)
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
    seen = watch(example, pulse, 2.0, end, position=1.0)
    return printed, corrected, float(seen.velocity[seen.at(time)])


def mean_over_rigid(example: WaveExample) -> float:
    """Return the largest mean of the wave acceleration over the specimen, over its largest net force per mass.

    The mean is that of the corrected route, the force that of delay lines: 1, so that a rigid-body acceleration has no
    place beside it.

    Examples
    --------
    >>> round(mean_over_rigid(WaveExample()), 6)
    1.0
    """
    pulse, specimen = pulse_of(example, example.slow), example.specimen
    transits = example.slow / specimen.transit + PASSED
    first, last = (watch(example, pulse, transits, position=place) for place in (0.0, 1.0))
    times = first.time
    leaving = np.interp(times, last.time + specimen.transit, last.strain)
    net = specimen.modulus * specimen.area * (first.strain - leaving) / specimen.mass
    mean = mean_acceleration(example.sandwich, incident_of(example, pulse), times, "corrected")
    return float(mean.max() / net.max())
