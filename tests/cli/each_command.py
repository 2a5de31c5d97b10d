"""A few words for each command, so that it does its work, and the files that these name."""

from pathlib import Path

import numpy as np
import pytest

GOAL = ("--interval", "20 ms", "--peak", "4000 g", "--width", "200 us", "--strikers", "4", "--striker-mass", "1 kg")
GASKETS = ("--material", "PTFE", "--thickness", "1 mm", "--layers", "1")
TWO = ("--set", "feed.blows=2")
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
"""A block on a wall."""
DESIGN = """
schema = 1
case = "jesd22-b111-b"
analysis = "impact"
goals = ["peak_acceleration = 1500 g +- 10 %"]
runs = 16
[vary]
machine.height = "0.2..2 m"
"""
CHEAP = {
    "run": ("jesd22-b111-b", "--no-band"),
    "wave": ("li-ma-2019-fig13-bar", "--no-band"),
    "fem": ("block.toml", "--no-report"),
    "impact": ("--m1", "0.2", "--m2", "0.4", "--speed", "3", "--stiffness", "4.7e9", "-n", "1.1", "-e", "0.5"),
    "laws": (),
    "record": ("pulse.csv",),
    "srs": ("pulse.csv", "--per-octave", "1"),
    "spec": ("show", "jesd22-b110:B"),
    "hopkinson": ("shot.toml",),
    "identify": ("pulse.csv", "--m1", "0.2", "--m2", "0.4"),
    "compare": ("pulse.csv", "pulse.csv", "--limit", "iso18571 > 0.8"),
    "fit": ("jesd22-b111-b", "--to", "first.rigid_peak=1500 g", "--free", "contact.reference_force"),
    "design": ("design.toml", "--workers", "1"),
    "sweep": ("jesd22-b111-b", "--vary", "machine.height=0.2..0.3 m:2", "--workers", "1"),
    "map": ("li-ma-2019", "--points", "3x2", "--workers", "1", "--train", "0", *TWO),
    "buffer": ("li-ma-2019-fig5", "--sensor", "buffered", "--limit", "7000 g", *GASKETS),
    "deck": ("block.toml",),
    "ls-dyna": (Path(__file__).parents[1] / "exchange/data", "--units", "mm-t-s"),
    "new": ("mine", "--force"),
    "validate": ("li-ma-2019-fig5",),
    "diff": ("li-ma-2019", "li-ma-2019-equal-blows"),
    "cases": (),
    "materials": (),
    "doctor": ("--no-speed",),
}
DEAR = {
    "examples": ("mine",),
    "run": ("li-ma-2019-fig5", *TWO),  # with bands of a stack and its sensors
    "wave": ("togami-1996-bar",),
    "reproduce": ("li-ma-2019", "--without", "elements", "--without", "studies"),
    "settings": (*GOAL, "--blows", "3"),
    "scatter": ("li-ma-2019-equal-blows", "--runs", "10", "--workers", "1", "--shares", "none", *TWO),
}
SERVED = {"app"}
"""What serves until it is stopped, and prints no result; `tests/web` has it."""
COMMANDS = [
    *(pytest.param(name, words, id=name) for name, words in CHEAP.items()),
    *(pytest.param(name, words, id=f"{name}-dear", marks=pytest.mark.verify) for name, words in DEAR.items()),
]


def write_inputs(strikewave):
    """Write the files that the commands take into the folder: a half sine of 3000 g, a block, a measured shot."""
    time = np.arange(0.0, 1e-3, 2e-6)
    pulse = 3000.0 * np.clip(np.sin(np.pi * (time - 2e-4) / 2e-4), 0.0, None) * ((time > 2e-4) & (time < 4e-4))
    lines = [f"{t:.6f},{a:.4f}" for t, a in zip(time, pulse, strict=True)]
    Path("pulse.csv").write_text("\n".join(["time [s],acceleration [g]", *lines]) + "\n")
    Path("block.toml").write_text(BLOCK)
    Path("design.toml").write_text(DESIGN)
    assert strikewave("new", "shot", "--from", "hopkinson")[0] == 0
