"""A search goes to the end of its valley, at the end of a range as well; a failed check is no best, and is named."""

import itertools
import math

import numpy as np
import pytest

from strikewave import load_case
from strikewave.cases.files import read_case_text
from strikewave.studies.engine.pools import ProcessPool
from strikewave.studies.engine.store import RunStore
from strikewave.studies.search.design import design
from strikewave.studies.search.evolution import BROKEN, FAR, DesignRuns, margin_merit, objective_merit, search
from strikewave.studies.search.goals import Goal, checks_of
from strikewave.studies.search.plan import RESOLUTION, plan_of

VARIED = ["machine.height=0.1..1.5 m", "contact.cushion.thickness=1..10 mm"]
PAD = ("stress=15 MPa", "exponent=2.4", "diameter=200 mm", "thickness=5 mm")


@pytest.fixture
def table(tmp_path):
    """A carriage on a thin pad of a power law, which a fall from 0.93 m presses solid at 1 mm."""
    text, _ = read_case_text("iec-60068-2-27-rubber")
    path = tmp_path / "table.toml"
    path.write_text(text.replace('material = "natural rubber 65 IRHD"', 'law = "power"'))
    return load_case(str(path), [f"contact.cushion.{one}" for one in PAD])


@pytest.mark.parametrize("seed", [1, *(pytest.param(seed, marks=pytest.mark.verify) for seed in (2, 3))])
def test_a_search_of_few_runs_ends_where_no_step_beside_is_better(table, seed):
    """The shortest pulse of at most 1575 g lies at the end of a range, in an edge that the goal cuts into the valley.

    Generations alone stopped 0.3 to 5 % above it.
    """
    aims = ["first.rigid_peak < 1575 g", "first.width smallest"]
    plan = plan_of(table, VARIED, aims, runs=150, seed=seed)
    with ProcessPool(1) as pool, RunStore(None) as store:
        runs = DesignRuns(plan, store, pool)
        merit = objective_merit(plan.objectives[0], plan.goals, plan.evaluation.names)
        best = search(runs, merit)
        assert len(runs.rows) <= plan.runs
        place, found = plan.place_of(runs.rows[best]), merit(runs.numbers)[best]
        assert place[1] == 0.0
        steps = [np.array(step) / RESOLUTION for step in itertools.product((-1, 0, 1), repeat=2)]
        beside = runs.of([plan.row_at(np.clip(place + step, 0.0, 1.0)) for step in steps])
        # rows are rounded to a thousandth of a decade at most: two steps of one setting may be one of the other
        assert merit(beside).min() >= found * (1.0 - 1e-3)


@pytest.mark.verify
def test_what_a_goal_comes_to_passes_the_checks_and_names_the_one_that_limits_it(table):
    """The heavier the fall the shorter the pulse, until the pad is pressed solid: 1 mm is the thinnest allowed."""
    study = design(table, VARIED, ["first.width = 0.45 ms +- 2 %"], runs=150)
    assert study.broken
    message = study.notices[0].message
    assert "check cushion-solid" in message
    nearest = study.candidates[0]
    pressed = study.value(nearest.run, "pressed")
    assert 0.99 < pressed < 1.0
    passing = study.numbers[study.numbers[:, study.plan.evaluation.names.index("pressed")] < 1.0]
    width = study.plan.evaluation.names.index("first.width")
    assert study.value(nearest.run, "first.width") == pytest.approx(passing[:, width].min(), rel=1e-3)


def test_a_setting_that_fails_a_check_is_worse_than_any_that_passes():
    goals = [Goal("w", "w", 1.0, 2.0), Goal("check", "p", -math.inf, 1.0, is_check=True)]
    numbers = np.array([[1.5, 0.5], [9.0, 0.999], [1.5, 1.0], [1.5, 1.2], [1.5, math.nan]])
    merits = margin_merit(goals, ["w", "p"])(numbers)
    assert merits.tolist() == sorted(merits.tolist())
    assert merits[0] == -1.0
    assert merits[1] < BROKEN <= merits[2] < merits[3] < merits[4] == FAR


@pytest.mark.parametrize(("name", "analysis"), [("jesd22-b111-b", "run"), ("iec-60068-2-27-rubber", "impact")])
def test_what_presses_no_pad_has_no_check_beside_its_goals(name, analysis):
    assert checks_of(load_case(name), analysis) == ()
