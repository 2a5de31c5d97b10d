"""Closed forms and published constants against what is computed: impacts, waves, spectra, launches, elements.

    python scripts/validate/closed_forms.py [--only impact ...]

Nothing is fitted. Each reference is a formula of the field, worked out here, or a number that is printed in the source
named; what is computed knows neither. The elements are the models of `tests/fem`. Two minutes of one core.
"""

from __future__ import annotations

import argparse
import dataclasses
import math
import sys
from collections.abc import Iterator

import numpy as np
from kit import ROOT, Comparison, keep
from scipy import optimize

sys.path.insert(0, str(ROOT / "tests"))
sys.path.insert(0, str(ROOT / "benchmarks"))

from fem.bodies import BAR_SPEED, WIDTH, Ball, Roller, ball_on_base, rod_on_wall, two_bars
from fem.test_bars import contact_time, mean_between
from fem.test_hertz import ALUMINIUM, peak_of, pressed
from fem.test_hexahedron import lame_frequency
from fem.test_taylor import taylor
from strikewave.base.constants import material
from strikewave.contact import Contact, exact, hertz, palmgren, point_cap, solve_impact
from strikewave.fem.solve import solve
from strikewave.hopkinson import stress_difference
from strikewave.machines.launch import RigidPendulum, pendulum_speed
from strikewave.signal.srs import srs
from strikewave.specifications.reading import load_specification, read_built_in
from strikewave.waves import BONDED, End, Impactor, Layer, LoadPulse, Stack, Tap, WantedError, run_bar
from strikewave.waves.dispersion import phase_speed

CLOSED, PRINTED, CODES = "closed form", "published", "other codes"
RADIUS, SPEED = 0.01, 1.0
"""Of a ball on a half-space, m and m/s."""
DAMPED = 0.7
"""Coefficient of restitution that a damping is asked for."""


def compare(what: str, quantity: str, reference: float, computed: float, unit: str, against: str = CLOSED, note=""):
    """Return a comparison to which nothing was fitted."""
    return Comparison(what, quantity, against, "predicted", float(reference), float(computed), unit, note=note)


def impacts() -> Iterator[Comparison]:
    """Yield a steel ball on a half-space: Hertz's impact (Johnson 1985, 11.4), its yield (Thornton 1997), its loss."""
    steel, mass = material("65Mn"), material("65Mn").density * 4.0 / 3.0 * math.pi * RADIUS**3
    modulus = steel.youngs_modulus / (2.0 * (1.0 - steel.poissons_ratio**2))
    stiffness = 4.0 / 3.0 * modulus * math.sqrt(RADIUS)
    deepest = (1.25 * mass * SPEED**2 / stiffness) ** 0.4
    what = f"steel ball of {1e3 * RADIUS:.0f} mm radius on a half-space, {SPEED:.0f} m/s"
    law = hertz(steel, steel, RADIUS)
    blow = solve_impact(law.contact(), mass, math.inf, SPEED)
    yield compare(what, "largest force", stiffness * deepest**1.5, blow.peak_force, "N")
    yield compare(what, "indentation", deepest, blow.max_indentation, "m")
    yield compare(what, "contact time", 2.943275 * deepest / SPEED, blow.duration, "s")
    damped = solve_impact(Contact(law.stiffness, law.exponent, float(exact(DAMPED))), mass, math.inf, SPEED)
    yield compare(f"{what}, damped", "coefficient of restitution", DAMPED, damped.restitution, "1")
    pressure = 1.2e9
    yields = 3.194 * math.sqrt(pressure**5 * RADIUS**3 / (modulus**4 * mass))
    faster = 5.0 * yields
    cap = point_cap(steel, steel, RADIUS, math.inf, pressure)
    yielded = solve_impact(law.contact(cap=cap), mass, math.inf, faster)
    share = yields / faster
    e = math.sqrt(6.0 * math.sqrt(3.0) / 5.0) * math.sqrt(1.0 - share**2 / 6.0)
    e *= (share / (share + 2.0 * math.sqrt(1.2 - 0.2 * share**2))) ** 0.25
    yield compare(
        f"the same, yielding at 1.2 GPa, {faster:.3g} m/s", "coefficient of restitution", e, yielded.restitution, "1"
    )
    bearing = dataclasses.replace(steel, youngs_modulus=206e9, poissons_ratio=0.3)
    line = palmgren(bearing, bearing, 0.01)
    depth = 1e3 * (1e4 / line.stiffness) ** (1.0 / line.exponent)
    printed = 3.84e-5 * 1e4**0.9 / 10.0**0.8
    yield compare(
        "roller of bearing steel, 10 mm, 10 kN (Palmgren, as handbooks print)",
        "indentation",
        printed,
        depth,
        "mm",
        PRINTED,
    )


def layer(name: str, steel: str, length: float, diameter: float) -> Layer:
    """Return a round bar."""
    solid = material(steel)
    return Layer(name, solid.density, solid.youngs_modulus, 0.25 * math.pi * diameter**2, length)


def waves() -> Iterator[Comparison]:
    """Yield one-dimensional waves (Kolsky 1963), the limits of Pochhammer and Chree, a specimen between bars."""
    bar = layer("bar", "65Mn", 0.07, 0.03)
    transit, impedance = bar.length / bar.bar_speed, math.sqrt(bar.density * bar.modulus) * bar.area
    push = LoadPulse("rectangle", 19685.0, 1.0)
    free = run_bar(Stack((bar,)), push, [Tap(0, 1.0)], 4.5 * transit, WantedError(step=transit / 100.0))
    yield compare(
        "free steel bar under a step of 19.7 kN",
        "speed of the far end after 2 passes",
        4.0 * 19685.0 / impedance,
        free.velocity[-1, 0],
        "m/s",
    )
    end = Stack((layer("bar", "65Mn", 0.1, 0.02),), end=End("matched"))
    decay = 0.2 / end.layers[0].impedance
    struck = run_bar(end, Impactor(0.2, 5.0), [Tap(0, 0.0)], 2.0 * decay, WantedError(step=decay / 500.0))
    later = 5.0 * end.layers[0].impedance * math.exp(-struck.time[-1] / decay)
    yield compare(
        "rigid mass of 0.2 kg on a long steel bar, 5 m/s",
        "force after two decay times",
        later,
        struck.face_force[-1],
        "N",
    )
    z = 0.5
    step = 1e-8
    layers = [
        Layer(name, 1.0, 1.0, area, count * step)
        for name, area, count in (("in", 1.0, 200), ("specimen", z, 20), ("out", 1.0, 10))
    ]
    shot = run_bar(
        Stack(tuple(layers), (BONDED,) * 2, End("matched")),
        LoadPulse("rectangle", 1.0, 1.0),
        [Tap(1, 0.0), Tap(1, 1.0)],
        262 * step,
        WantedError(step=step),
    )
    first, second = shot.force[np.argmin(np.abs(shot.time - 250 * step))]  # the middle of the third transit
    alpha = abs(2.0 * (first - second) / (first + second))
    formula = 2.0 * z * (1.0 - z) ** 2 / ((1.0 + z) ** 3 - (1.0 - z) ** 2)
    yield compare(
        "elastic specimen between bars, half their impedance (Yang & Shim 2005)",
        "force difference in the third transit",
        formula,
        stress_difference(z, 3),
        "1",
    )
    yield compare("the same by delay lines", "force difference in the third transit", formula, alpha, "1")
    nu, ratio = 0.29, 0.02
    yield compare(
        "long waves in a round bar, d/Λ 0.02 (Rayleigh 1894)",
        "phase speed over bar speed",
        1.0 - (math.pi * nu * ratio / 2.0) ** 2,
        phase_speed(ratio, nu),
        "1",
    )
    k = (1.0 - 2.0 * nu) / (2.0 * (1.0 - nu))
    x = optimize.brentq(lambda x: (2.0 - x) ** 2 - 4.0 * math.sqrt(1.0 - x) * math.sqrt(1.0 - x * k), 0.5, 0.999)
    yield compare(
        "short waves in a round bar, d/Λ 200: Rayleigh's surface wave",
        "phase speed over bar speed",
        math.sqrt(x / (2.0 * (1.0 + nu))),
        phase_speed(200.0, nu),
        "1",
    )


def spectra() -> Iterator[Comparison]:
    """Yield the shock spectrum of a half-sine without damping, at and around resonance (Ayre, Shock and Vibration)."""
    width, count = 10e-3, 4000
    step = width / count
    record = np.concatenate([np.sin(math.pi * np.arange(count + 1) / count), np.zeros(4 * count)])
    ratios = np.array([0.25, 0.5, 1.0])
    found = srs(record, step, ratios / width, math.inf).maximax
    for ratio, value in zip(ratios, found, strict=True):
        r = 2.0 * ratio  # natural over pulse frequency
        after = 0.5 * math.pi if r == 1.0 else abs(2.0 * r * math.cos(0.5 * math.pi * r) / (1.0 - r**2))
        t = np.linspace(0.0, math.pi, 200_001)  # angle of the pulse
        inside = 0.5 * (np.sin(t) - t * np.cos(t)) if r == 1.0 else r * (r * np.sin(t) - np.sin(r * t)) / (r**2 - 1.0)
        yield compare(
            f"half-sine of 10 ms, oscillator of {ratio / width:.0f} Hz",
            "largest response over peak",
            max(after, float(inside.max())),
            value,
            "1",
        )


def launches() -> Iterator[Comparison]:
    """Yield speeds and velocity changes that standards print."""
    for length, printed in ((0.225, 2.9), (0.390, 3.8)):
        speed = pendulum_speed(RigidPendulum(1.0, length, length**2, length), math.radians(160.0))
        yield compare(
            f"Charpy pendulum of {1e3 * length:.0f} mm from 160° (ISO 13802)", "speed", printed, speed, "m/s", PRINTED
        )
    for row in read_built_in("jesd22-b110")[0].condition:
        pulse = load_specification(f"jesd22-b110:{row.name}").pulse
        what = f"JESD22-B110, condition {row.name}"
        yield compare(what, "velocity change", row.velocity_change.si, pulse.velocity_change, "m/s", PRINTED)


def elements() -> Iterator[Comparison]:
    """Yield explicit elements: rod, bars, balls, a line contact, a free plate, a Taylor bar."""
    model, area = rod_on_wall(200)
    run = solve(model)
    stress = 7820.0 * BAR_SPEED * 5.0
    force = run.force["rod.z--wall"][:, 2] / area
    what = "elements: rod of 200 mm on a rigid wall, 5 m/s, 200 along"
    yield compare(what, "stress", stress, mean_between(run, force, 15e-6, 65e-6), "Pa")
    yield compare(what, "contact time", 0.4 / BAR_SPEED, contact_time(run, force, stress), "s")
    yield compare(what, "rebound speed", 5.0, run.parts["rod"].velocity[-1, 2], "m/s")
    run = solve(two_bars())
    force = run.force["striking.z--struck.z+"][:, 2] / WIDTH**2
    what = "elements: two equal steel bars of 100 mm, 5 m/s"
    yield compare(what, "stress", 0.5 * stress, mean_between(run, force, 5e-6, 0.2 / BAR_SPEED - 5e-6), "Pa")
    for name, case in (("steel on steel", Ball()), ("steel on aluminium", Ball(base=ALUMINIUM, size=3e-4))):
        run = solve(ball_on_base(case))
        force = peak_of(run.time, 4.0 * run.force["ball.round-base.top"][:, 2])
        deepest = -float(run.parts["ball"].displacement[:, 2].min())
        what = f"elements: ball of 10 mm radius at 1 m/s (Hertz), {name}, {1e3 * case.size:.1f} mm"
        yield compare(what, "largest force", case.hertz[0], force, "N")
        yield compare(what, "indentation", case.hertz[1], deepest, "m")
    error = pressed(Roller())
    yield Comparison(
        "elements: half-cylinder on a block, 0.1 mm",
        "stress below the contact (McEwen 1949), over p₀",
        CLOSED,
        "predicted",
        None,
        None,
        miss=error,
    )
    for sort, hourglass in (("one point", 0.05), ("full", 0.0)):
        what = f"elements: free square plate, Lamé's mode, 24 along, {sort}"
        yield compare(what, "frequency over √2 π c_s/L", 1.0, lame_frequency(24, sort, hourglass), "1")
    _, length, foot = taylor(0.53e-3, 0.05)
    what = "elements: copper Taylor bar of 32.4 mm at 227 m/s (Kamoulakos 1990), 0.53 mm"
    yield compare(what, "final length, middle of 21.4 to 21.6", 21.5, length, "mm", CODES)
    yield compare(what, "radius of the foot, middle of 7.0 to 7.5", 7.25, foot, "mm", CODES)


PARTS = {"impacts": impacts, "waves": waves, "spectra": spectra, "launches": launches, "elements": elements}


def main() -> None:
    """Compute all of them, print and keep them."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", choices=PARTS, action="append", help="a part, printed and not kept; may be repeated")
    only = parser.parse_args().only
    rows = []
    for row in (row for name in only or PARTS for row in PARTS[name]()):
        rows.append(row)
        print(f"{row.what}, {row.quantity}: {row.reference} {row.computed} {row.miss:.2e}", flush=True)
    if not only:
        keep("closed forms", rows)


if __name__ == "__main__":
    main()
