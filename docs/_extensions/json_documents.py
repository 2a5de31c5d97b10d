"""Run commands in an empty folder and print their JSON documents: `python json_documents.py < lines`."""

import contextlib
import io
import json
import shlex
import sys
import tempfile
from pathlib import Path

import numpy as np

from strikewave.cli import app
from strikewave.cli.program_commands import copy_examples

STEP, SAMPLES = 1e-6, 6000
START, DURATION = 2e-3, 0.5e-3
"""Of the records: sampling, and where the half-sine lies, s."""
PEAKS = {"a": 1480.0, "b": 1510.0}
"""Of two shots by JESD22-B110, condition B, g."""


def write_records() -> None:
    """Write what the commands read: two shots with noise, the force of a blow, examples, a set-up of bars."""
    time = STEP * np.arange(SAMPLES)
    pulse = np.sin(np.pi * np.clip((time - START) / DURATION, 0.0, 1.0))
    noise = np.random.default_rng(1).normal(size=SAMPLES)
    for name, peak in PEAKS.items():
        _write(f"{name}.csv", "frame (g)", time, peak * pulse + noise)
    _write("force.csv", "force (N)", time, 2e4 * pulse**1.5)
    copy_examples(Path("examples"))
    document_of("new shot --from hopkinson")
    _write_bars()
    _write_dyna()


BAR = """schema = 1
[bar.incident]
density = "8000 kg/m^3"
speed = "5000 m/s"
diameter = "11.28 mm"
gauge_distance = "500 mm"
[bar.incident.gauge]
file = "{name}.csv"
channel = "gauge"
[solver]
dispersion = "none"
"""
SENSOR = """[accelerometer]
file = "sensor.csv"
channel = "sensor"
mass = "30 gram"
"""


def _write_bars() -> None:
    """Write set-ups and records of a free bar of 1 m, by delay: of its echoes, and of an accelerometer on its end."""
    time, speed = 2e-7 * np.arange(7500), 5000.0
    pulse = lambda at: 3e-4 * np.sin(np.pi * np.clip((time - at) / 1e-4, 0.0, 1.0)) ** 2  # noqa: E731
    strain = sum((-1.0) ** k * pulse(6e-5 + 2e-4 * k) for k in range(7))
    end = 2.0 * speed * np.gradient(pulse(1.6e-4), time) / 9.80665
    _write("echo.csv", "gauge (strain)", time, strain)
    _write("sensor.csv", "gauge (strain),sensor (mV)", time, strain, 1.2 * end)
    Path("echo.toml").write_text(BAR.format(name="echo"))
    Path("sensor.toml").write_text(BAR.format(name="sensor") + SENSOR)


def _write_dyna() -> None:
    """Write a run of elements, and the force of its contact as LS-DYNA does."""
    document_of('fem two-bars-fem --set fem.duration="40 us" --no-report --out bars')
    side = "  {word}{number:{room}d} time{time:12.5E}  x {x:12.5E}  y {y:12.5E}  z {z:12.5E} mass{mass:13.5E}"
    lines = [" A run", "                    ls-dyna smp d R16 R16.1_180_d50332d date 07/09/2025", ""]
    for time in np.linspace(0.0, 40e-6, 81):
        force = 2e3 * np.sin(np.pi * time / 40e-6)
        for word, sign in (("SURFA", 1.0), ("SURFB", -1.0)):
            values = {"time": time, "x": 0.0, "y": 0.0, "z": sign * force, "mass": 0.0}
            lines.append(side.format(word=word, number=1, room=12, **values))
    Path("dyna").mkdir()
    Path("dyna/rcforc").write_text("\n".join(lines) + "\n")


def _write(name: str, head: str, *columns: np.ndarray) -> None:
    np.savetxt(name, np.column_stack(columns), delimiter=",", header=f"time (s),{head}", comments="")


def document_of(line: str) -> str:
    """Return what a command prints.

    Raises
    ------
    RuntimeError
        If it fails.
    """
    sys.argv = ["strikewave", *shlex.split(line)]
    printed = io.TextIOWrapper(io.BytesIO(), "utf-8", write_through=True)
    said = io.StringIO()
    with contextlib.redirect_stdout(printed), contextlib.redirect_stderr(said):
        try:
            app.main()
        except SystemExit as end:
            if end.code not in (None, 0, 3):
                raise RuntimeError(f"strikewave {line}: {said.getvalue()}") from None
    printed.seek(0)
    return printed.read()


if __name__ == "__main__":
    lines = sys.stdin.read().splitlines()
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
        write_records()
        found = {line: json.loads(document_of(f"{line} --json")) for line in lines}
    json.dump(found, sys.stdout)
