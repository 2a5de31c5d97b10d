"""A sample of the study of planted fits: intervals that hold the truth, and twins that are named."""

import importlib.util
import sys
from pathlib import Path

import numpy as np
import pytest

from strikewave import fit

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


@pytest.mark.verify
@pytest.mark.parametrize("seed", [3, 4])
def test_a_louder_or_softer_shot_moves_its_values_by_as_much_as_its_stated_scatter_says(tmp_path, study, seed):
    """A drop whose table rings: fits to its record 4 % louder and softer lie two standard errors off, root mean square.

    By the slopes at the best place alone the errors were 0.6 of that. Noise of the record adds a twentieth at most.
    """
    kind, rng = study.KINDS["drop tables"], np.random.default_rng([9000, seed])
    case = study.opened(kind.case, kind.settings)
    truth = study.moved(case, kind.free, study.OFF, rng)
    path = Path(study.write_record(tmp_path / "as-it-is.csv", truth, kind.part, kind.rate, rng, study.SCATTER))
    rows = np.loadtxt(path, delimiter=",", skiprows=1)
    head = path.read_text("utf-8").splitlines()[0]

    def fitted(factor, told=""):
        other = tmp_path / f"{factor}.csv"
        np.savetxt(other, rows * [1.0, factor], delimiter=",", header=head, comments="")
        return fit(case, [f"{other}{told}"], kind.free).parameters

    middle, *sides = fitted(1.0, " +- 2 %"), fitted(0.96), fitted(1.04)
    for k, one in enumerate(middle):
        off = [side[k].value / one.value - 1.0 for side in sides]
        by_scatter = np.sqrt(np.mean(np.square(off))) / 2.0
        assert one.standard_error / one.value == pytest.approx(by_scatter, rel=0.1)
