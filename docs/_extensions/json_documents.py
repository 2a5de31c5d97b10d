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
from strikewave.cli.examples import copy_examples

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
