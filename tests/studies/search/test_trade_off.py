"""The search for a whole front by optuna: a front known in closed form, the same bits again, what it is refused."""

import runpy
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from strikewave.base.errors import InputError
from strikewave.studies.search import plan as plans
from strikewave.studies.search.design import design
from strikewave.studies.search.ranking import trade_off_search

from .test_design import BALL, HEIGHT

PROGRAM = Path(__file__).parents[3] / "scripts" / "validate" / "fronts.py"
GOALS = ["approach_speed > 2 m/s", "peak_force smallest", "approach_speed largest"]


@pytest.mark.verify
def test_the_front_of_zitzler_deb_and_thiele_is_found(monkeypatch):
    """The whole front, b = 1 - sqrt(a), dominates 1.21 - 1/3 = 0.8767; as many random ones a third."""
    monkeypatch.syspath_prepend(str(PROGRAM.parent))
    program = SimpleNamespace(**runpy.run_path(str(PROGRAM)))
    problem, dominated = "ZDT1, convex", program.dominated
    runs = program.ClosedForm(problem, 256, seed=1)
    trade_off_search(runs, 0)
    assert len(runs.rows) <= 256
    whole = 1.21 - 1.0 / 3.0
    assert dominated(runs.numbers) > 0.85 * whole
    random = program.values_of(problem, np.random.default_rng(1).random((256, 3)))
    assert dominated(random) < 0.5 * whole


@pytest.mark.verify
def test_a_front_of_impacts_is_searched_for_again_to_the_bit(tmp_path):
    studies = [
        design(BALL, HEIGHT, GOALS, analysis="impact", runs=32, search="optuna", workers=workers, store=tmp_path / name)
        for workers, name in ((1, "one"), (2, "two"), (1, "one"))
    ]
    for study in studies:
        assert np.array_equal(study.numbers, studies[0].numbers)
        assert study.front == studies[0].front
        assert len(study.front) > 8


def test_a_search_for_a_front_wants_two_objectives_and_optuna(monkeypatch):
    with pytest.raises(
        InputError, match=r'^search: got "optuna"; allowed: two objectives or more; evolution or surrogate'
    ):
        design(BALL, HEIGHT, GOALS[:2], analysis="impact", search="optuna")
    monkeypatch.setattr(plans.importlib.util, "find_spec", lambda name: None)
    with pytest.raises(InputError, match=r"pip install 'strikewave\[optuna\]'$"):
        design(BALL, HEIGHT, GOALS, analysis="impact", search="optuna")
