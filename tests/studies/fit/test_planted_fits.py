"""A sample of the study of planted fits: intervals that hold the truth, and twins that are named."""

import importlib.util
import sys
from pathlib import Path

import pytest

PROGRAM = Path(__file__).parents[3] / "scripts" / "validate" / "fit.py"


@pytest.fixture
def study(monkeypatch):
    """Return the program of the study."""
    monkeypatch.syspath_prepend(str(PROGRAM.parent))
    spec = importlib.util.spec_from_file_location("planted_fits", PROGRAM)
    module = importlib.util.module_from_spec(spec)
    monkeypatch.setitem(sys.modules, "planted_fits", module)  # its dataclasses look themselves up there
    spec.loader.exec_module(module)
    return module


@pytest.mark.verify
def test_intervals_of_planted_machines_stacks_and_impacts_hold_the_truth_and_twins_are_named(tmp_path, study):
    """Of each kind two fits and one of twins: of 20 intervals of 95 %, 17 or more hold but once in 400 samples."""
    found = [study.coverage(name, seed, tmp_path) for name in study.KINDS for seed in (100, 101)]
    assert sum(one["intervals"] for one in found) == 20
    assert sum(one["held"] for one in found) >= 17
    for name in study.KINDS:
        assert study.named(name, 100, tmp_path) == {"alone": True, "false": 0}
