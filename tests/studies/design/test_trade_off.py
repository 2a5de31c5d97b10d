"""The search for a whole front by optuna: a front known in closed form, the same bits again, what it is refused."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from strikewave.base.errors import InputError
from strikewave.studies.design import plan as plans
from strikewave.studies.design.goals import Objective
from strikewave.studies.design.question import design
from strikewave.studies.design.runs import DesignRuns
from strikewave.studies.design.trade_off import trade_off_search

from .test_design import BALL, HEIGHT

GOALS = ["approach_speed > 2 m/s", "peak_force smallest", "approach_speed largest"]


class ClosedForm(DesignRuns):
    """Runs of a function of places from 0 to 1, without an engine."""

    def __init__(self, function, settings, runs, goals=()):
        self.function, self.rows, self.failures, self._numbers, self._places, self.most = function, [], [], [], {}, runs
        objectives = (Objective("a smallest", "a", 1.0), Objective("b smallest", "b", 1.0))
        self.plan = SimpleNamespace(
            variables=[SimpleNamespace(path=f"x{k}", is_range=True, words=()) for k in range(settings)],
            bounds=[(0.0, 1.0)] * settings,
            objectives=objectives,
            goals=goals,
            runs=runs,
            seed=1,
            evaluation=SimpleNamespace(names=["a", "b"]),
            row_at=tuple,
            place_of=np.array,
        )

    def of(self, rows):
        for row in rows:
            if row not in self._places:
                self._places[row] = len(self.rows)
                self.rows.append(row)
                self._numbers.append(self.function(np.array(row)))
        return np.array([self._numbers[self._places[row]] for row in rows])


def zdt1(x):
    """Zitzler, Deb & Thiele 2000, Evolutionary Computation 8, 173: the front is b = 1 - sqrt(a)."""
    g = 1.0 + 9.0 * x[1:].mean()
    return np.array([x[0], g * (1.0 - math.sqrt(x[0] / g))])


def dominated(points, corner=1.1):
    """Return the area that points dominate below a corner."""
    area, last = 0.0, corner
    for a, b in sorted(map(tuple, points)):
        if a < corner and b < last:
            area, last = area + (corner - a) * (last - b), b
    return area


@pytest.mark.verify
def test_the_front_of_zitzler_deb_and_thiele_is_found():
    """The whole front dominates 1.21 - 1/3 = 0.8767; as many random ones a third."""
    runs = ClosedForm(zdt1, 3, 256)
    trade_off_search(runs, 0)
    assert len(runs.rows) <= 256
    whole = 1.21 - 1.0 / 3.0
    assert dominated(runs.numbers) > 0.85 * whole
    random = np.array([zdt1(x) for x in np.random.default_rng(1).random((256, 3))])
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
