"""Files that the commands of the corpus take: made from closed forms and one seed, so that the corpus stands alone."""

from __future__ import annotations

import math
import random
from collections.abc import Callable, Iterable
from pathlib import Path

HALF_SINE = "time [s],acceleration [g]"
"""Head of a record of one channel."""
SETUP = """
schema = 1
title = "Sample shot"
[bar.incident]
density = "7800 kg/m^3"
modulus = "210 GPa"
diameter = "20 mm"
gauge_distance = "0.8 m"
[bar.incident.gauge]
file = "shot.csv"
channel = "incident"
[bar.transmitted]
gauge_distance = "0.5 m"
[bar.transmitted.gauge]
file = "shot.csv"
channel = "transmitted"
[specimen]
length = "8 mm"
diameter = "12 mm"
density = "2700 kg/m^3"
modulus = "70 GPa"
[solver]
dispersion = "none"
"""
BLOCK = """
schema = 1
[[mesh.part]]
name = "rod"
shape = "block"
material = "2A12"
width = "4 mm"
depth = "4 mm"
height = "20 mm"
size = "2 mm"
velocity = { z = "-60 m/s" }
solid = { law = "bilinear", tangent_modulus = "1 GPa" }
[fem]
duration = "30 us"
interval = "0.5 us"
[[fem.wall]]
side = "rod.z-"
normal = "z"
"""
QUARTER = (
    BLOCK.replace('width = "4 mm"', 'width = "2 mm"').replace('depth = "4 mm"', 'depth = "2 mm"')
    + """
[[fem.boundary]]
kind = "symmetry"
side = "rod.x-"
[[fem.boundary]]
kind = "symmetry"
side = "rod.y-"
"""
)
DESIGN = """
schema = 1
case = "jesd22-b111-b"
analysis = "impact"
goals = ["peak_acceleration = 1500 g +- 10 %"]
runs = 16
[vary]
machine.height = "0.2..2 m"
"""
BAR = """
schema = 1
[[stack.layer]]
name = "upper"
material = "65Mn"
length = "100 mm"
diameter = "20 mm"
[[stack.layer]]
name = "lower"
material = "2A12"
length = "80 mm"
diameter = "20 mm"
[stack.end]
kind = "free"
[load]
shape = "half-sine"
peak = "20 kN"
duration = "40 us"
[[tap]]
name = "mid"
layer = "lower"
position = 0.5
[solver]
duration = "200 us"
"""
FELT = """
schema = 1
[machine]
kind = "drop"
height = "0.3 m"
follow = "40 ms"
[striker]
mass = "2000 kg"
material = "45 steel"
[object]
mass = "20 kg"
nose_mass = "2 kg"
material = "7075-T6"
frame_stiffness = "10 GN/m"
frame_damping = "10 kN s/m"
[contact]
law = "cushion"
restitution = 1
slowest_approach = "0.3 m/s"
[contact.cushion]
law = "felt"
diameter = "100 mm"
thickness = "25 mm"
stress = "8 MPa"
exponent = 3
retardation = "0.5 ms"
[recorder]
sampling_rate = "100 kHz"
delay = "0 s"
pre_trigger = "0 s"
memory = 10000
"""
TEST = """
item = "board 7"
operator = "A. Writer"
laboratory = "Sample laboratory"
"""
BROKEN = """
schema = 1
[machine]
kind = "rotary"
speed = "fast"
sped = "700 rpm"
"""


def write_samples(folder: Path) -> None:
    """Write all samples into a folder."""
    draw = random.Random(1)

    def record(name: str, head: str, count: int, step: float, *channels: Callable[[float], float]) -> None:
        """Write a file of samples, a column a channel."""
        rows = (",".join([f"{i * step:.7f}", *(f"{value(i * step):.6g}" for value in channels)]) for i in range(count))
        (folder / name).write_text("\n".join([head, *rows]) + "\n")

    def noisy(value: Callable[[float], float], noise: float = 1.0) -> Callable[[float], float]:
        return lambda t: value(t) + draw.gauss(0.0, noise)

    def half_sine(peak: float, begin: float, width: float) -> Callable[[float], float]:
        return lambda t: peak * math.sin(math.pi * (t - begin) / width) if 0.0 <= t - begin < width else 0.0

    def total(parts: Iterable[Callable[[float], float]]) -> Callable[[float], float]:
        listed = tuple(parts)
        return lambda t: sum(part(t) for part in listed)

    blows = total(half_sine(4000.0 + 10.0 * k, begin, 2e-4) for k, begin in enumerate((0.02, 0.06, 0.10, 0.14)))
    record("blows.csv", f"{HALF_SINE},hum [g]", 40_000, 5e-6, noisy(blows, 3.0), lambda t: 5.0 * math.sin(314.159 * t))
    record(
        "train.csv", HALF_SINE, 30_000, 5e-6, noisy(total(half_sine(3000.0, 0.01 + 0.017 * k, 2e-4) for k in range(7)))
    )
    blow = half_sine(900.0, 0.03, 5e-4)
    record("drifting.csv", HALF_SINE, 20_000, 5e-6, noisy(lambda t: blow(t) + 400.0 * t))
    record("half-sine.csv", HALF_SINE, 12_000, 1e-5, noisy(half_sine(500.0, 0.05, 1e-3), 0.5))
    record("unitless.csv", "time [s],channel", 12_000, 1e-5, noisy(half_sine(500.0, 0.05, 1e-3), 0.5))
    record("volts.csv", "time [s],channel [V]", 12_000, 1e-5, noisy(half_sine(0.6, 0.05, 1e-3), 5e-4))
    plain = half_sine(1000.0, 0.03, 5e-4)
    record("clipped.csv", HALF_SINE, 12_000, 5e-6, noisy(lambda t: min(plain(t), 700.0), 0.01))
    record("shifted.csv", HALF_SINE, 12_000, 5e-6, noisy(lambda t: plain(t) + (80.0 if t > 0.0303 else 0.0)))
    record("cut.csv", HALF_SINE, 6_050, 5e-6, noisy(plain))

    def ring(t: float) -> float:
        return 300.0 * math.exp(-t * 800.0) * math.sin(6.28e4 * t) if t > 0.0 else 0.0

    record("ringing.csv", HALF_SINE, 12_000, 5e-6, noisy(lambda t: plain(t) + ring(t - 0.03)))
    record("pair.csv", "time [s],base [g],top [g]", 12_000, 5e-6, noisy(plain), noisy(lambda t: 1.2 * plain(t - 2e-5)))

    def pulse(t: float) -> float:
        return 9000.0 * math.sin(math.pi * (t - 5e-4) / 8e-4) ** 1.3 if 0.0 < t - 5e-4 < 8e-4 else 0.0

    record("force.csv", "time [s],force [N]", 4000, 1e-6, noisy(pulse, 5.0))

    def trapezoid(t: float) -> float:
        return min(max(t / 2e-5, 0.0), 1.0) * min(max((1.2e-4 - t) / 2e-5, 0.0), 1.0)

    speed = math.sqrt(210e9 / 7800.0)
    record(
        "shot.csv", "time [s],incident [ustrain],transmitted [ustrain]", 9000, 1e-7,
        noisy(lambda t: 300 * trapezoid(t - 1e-4) - 120 * trapezoid(t - 1e-4 - 1.6 / speed), 0.2),
        noisy(lambda t: 180 * trapezoid(t - 1e-4 - 1.3 / speed - 1.6e-6), 0.2),
    )  # fmt: skip
    (folder / "words.csv").write_text("this,holds\nno,numbers\n")
    texts = {"setup": SETUP, "block": BLOCK, "quarter": QUARTER, "design": DESIGN, "bar": BAR, "felt": FELT}
    texts |= {"test": TEST, "broken": BROKEN}
    for name, text in texts.items():
        (folder / f"{name}.toml").write_text(text)
