"""Inputs at the edge of what a computer holds end in one line that names them: never in an internal error."""

import json
import os
import subprocess
import sys

import h5py
import numpy as np
import pytest

from strikewave.base.citations import FROM_MEMORY
from strikewave.base.errors import InputError, StrikewaveError
from strikewave.contact import registry
from strikewave.contact.damping import damping_law
from strikewave.records import Channel, Record
from strikewave.records.readers import LONGEST_STEP, SHORTEST_STEP, Options, _check_steps, read_record

LONG = "n" * 5000


@pytest.mark.parametrize(
    "words", [("record",), ("srs",), ("new",), ("ls-dyna", "--units", "mm-t-s"), ("run",), ("nothing",), ("cases",)]
)
def test_a_name_that_no_system_takes_is_refused_in_one_line(strikewave, words):
    code, out, err = strikewave(words[0] if words[0] != "nothing" else LONG, LONG, *words[1:])
    assert (code, out) == (2, "")
    assert "nnn..." in err
    assert len("".join(err.split())) < 900


@pytest.mark.parametrize("attribute", ["dt", "fs"])
@pytest.mark.parametrize("value", [5e-324, 1e-308, 1e308])
def test_steps_of_no_recorder_are_refused_with_their_channel(tmp_path, attribute, value):
    with h5py.File(tmp_path / "edge.h5", "w") as file:
        file["board"] = np.arange(100.0)
        file["board"].attrs[attribute] = value
    with pytest.raises(InputError, match=r"a time of 1e-15 to 1e\+06 s between two samples; channel \"board\" has"):
        read_record(tmp_path / "edge.h5")


@pytest.mark.parametrize("step", [5e-324, 0.99 * SHORTEST_STEP, 1.01 * LONGEST_STEP, 1e304, np.inf])
def test_stamps_of_no_recorder_are_refused_too(step):
    with np.errstate(invalid="ignore"):
        stamps = step * np.arange(10)
    stamps[0] = 0.0
    with pytest.raises(InputError, match="between two samples"):
        _check_steps(Record("a", "text", (Channel("board", np.zeros(10), stamps=stamps),)))


@pytest.mark.parametrize("step", [SHORTEST_STEP, 1e-6, LONGEST_STEP])
def test_steps_of_all_recorders_are_taken(step):
    stamps = step * np.arange(10)
    _check_steps(Record("a", "text", (Channel("a", np.zeros(10), step), Channel("b", np.zeros(10), stamps=stamps))))


@pytest.mark.parametrize("rate", [5e-324, 1e-308, 1e308, 0.0, -1.0, float("nan"), float("inf")])
def test_rates_of_no_recorder_are_refused(rate):
    with pytest.raises(InputError, match="--rate: got"):
        read_record("any", Options(rate=rate))


PRINTS = """
import sys
sys.argv = ["strikewave", *sys.argv[1:]]
from strikewave.cli.app import main
main()
"""
NAME = "5 µm – 衝撃 🔨"


@pytest.mark.verify
@pytest.mark.parametrize("more", [("--json",), pytest.param((), marks=pytest.mark.verify)], ids=["json", "words"])
@pytest.mark.parametrize(
    "encoding",
    ["cp932", pytest.param("ascii", marks=pytest.mark.verify), pytest.param("cp437", marks=pytest.mark.verify)],
)
def test_results_are_printed_in_any_encoding(tmp_path, encoding, more):
    """The JSON document keeps every letter, as an escape."""
    rows = [f"{k * 1e-6:.6f},{1000.0 * max(0.0, np.sin((k - 200) / 100)) if k < 514 else 0.0:.3f}" for k in range(900)]
    (tmp_path / "blow.csv").write_text("\n".join([f"time [s],{NAME} [g]", *rows]), "utf-8")
    command = [sys.executable, "-c", PRINTS, "record", "blow.csv", *more]
    environment = {**os.environ, "PYTHONIOENCODING": encoding}
    done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, check=False)
    assert done.returncode in (0, 3), done.stderr
    shown = done.stdout.decode(encoding)
    assert "peak" in shown
    assert (json.loads(shown)["files"][0]["channels"][0]["name"] if more else NAME) == NAME


def test_a_law_of_a_package_that_raises_is_named(monkeypatch):
    def fails(restitution):
        raise ZeroDivisionError("division by zero")

    class Point:
        name = "foreign"

        def load(self):
            return registry.DampingLaw("foreign", fails, "chi = 1/0", "none", FROM_MEMORY, "nobody")

    monkeypatch.setattr(registry, "entry_points", lambda group: [Point()])
    registry._added.cache_clear()
    try:
        law = damping_law("foreign")
    finally:
        monkeypatch.undo()
        registry._added.cache_clear()
    with pytest.raises(
        StrikewaveError, match=r"the contact law 'foreign' .* failed \(ZeroDivisionError: division by zero\)"
    ):
        law.function(0.5)
