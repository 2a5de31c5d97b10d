"""Designs: optima and conflicts of a falling ball in closed form, goals as typed, verification, draws, going on."""

import math
from concurrent.futures import Future, ThreadPoolExecutor
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import strikewave
from strikewave import load_case
from strikewave.base.errors import InputError, InputErrors
from strikewave.studies.engine.pools import ProcessPool
from strikewave.studies.engine.runner import Workers
from strikewave.studies.engine.store import RunStore
from strikewave.studies.search import design_report as report
from strikewave.studies.search.design import design
from strikewave.studies.search.design_report import design_words
from strikewave.studies.search.evolution import DesignRuns, margin_merit
from strikewave.studies.search.goals import Goal, Objective, evaluation_of, read_aim
from strikewave.studies.search.plan import plan_of
from strikewave.studies.search.ranking import Robustness, _beaten, front, sensitivities
from strikewave.studies.sweep.study import sweep

G = 9.80665
HEIGHT = ["machine.height=0.1..2 m"]


def elastic(*changes):
    """A steel ball on an anvil whose contact is Hertz's and takes no energy."""
    case = load_case("iso-16063-22-dropball", ["contact.damping=exact", "contact.restitution=0.999", *changes])
    return case.model_copy(update={"contact": case.contact.model_copy(update={"yield_pressure": None})})


BALL = elastic()
LAST = 1e-3 / 0.8
"""Share of a height of 0.8 m between which no heights are tried, a thousandth of the range, rounded to 1 mm."""


def force_at(speed):
    """Hertz: the peak force goes with v^(6/5); the constant by one impact from a height of its own."""
    one = sweep(BALL, ["machine.height=0.3 m"], keep=["peak_force", "approach_speed"], analysis="impact")
    return one.number("peak_force")[0] * (speed / one.number("approach_speed")[0]) ** 1.2


def test_the_best_height_is_that_of_free_fall():
    """v^2 = 2 g h; the largest margin lies in the middle of the band, found to the resolution of the range."""
    study = design(BALL, HEIGHT, ["approach_speed = 4 m/s +- 1 %"], analysis="impact", runs=160)
    best = study.best
    assert best.meets
    assert best.row[0] == pytest.approx(4.0**2 / (2.0 * G), rel=2.0 * LAST)
    assert best.margin > 0.85
    assert study.conflict is None
    assert not study.notices
    assert study.met == np.sum(np.abs(study.numbers[:, 0] / 4.0 - 1.0) <= 0.01)


def test_an_objective_goes_to_the_limit_of_a_goal():
    study = design(BALL, HEIGHT, ["approach_speed < 4 m/s", "peak_force largest"], analysis="impact", runs=160)
    speed, force = study.candidates[0].numbers
    assert speed <= 4.0
    assert force == pytest.approx(force_at(4.0), rel=3.0 * 0.6 * LAST)  # F goes with h^(3/5)


def test_objectives_alone_go_to_the_end_of_the_range():
    """Nothing has to be met, so that every run does: the fall from the top is the fastest one."""
    study = design(BALL, HEIGHT, ["approach_speed largest"], analysis="impact", runs=32)
    assert study.candidates[0].numbers[0] == pytest.approx(math.sqrt(2.0 * G * 2.0), rel=0.01)
    assert study.met == len(study.rows)
    assert "least margin" not in dict(study.highlights())


@pytest.mark.verify
def test_goals_that_exclude_each_other_are_named_with_what_each_comes_to():
    """With v >= 4 m/s, F is F(4 m/s) at least; with F <= 15 kN, v is v(15 kN) at most; a third goal stays out."""
    goals = ["approach_speed > 4 m/s", "peak_force < 15 kN", "duration < 1 s"]
    study = design(BALL, HEIGHT, goals, analysis="impact", runs=96)
    assert study.broken
    assert study.best is None
    speed, force = study.conflict.reaches
    assert [goal.number for goal in study.conflict.goals] == ["approach_speed", "peak_force"]
    assert force.value == pytest.approx(force_at(4.0), rel=6.0 * 0.6 * LAST)
    assert force_at(speed.value) == pytest.approx(15e3, rel=6.0 * 0.6 * LAST)
    assert speed.lacks == 4.0 - speed.value
    assert force.lacks == force.value - 15e3
    (notice,) = study.notices
    assert notice.broken
    assert "exclude each other" in notice.message
    assert "duration" not in notice.message
    # at the nearest setting both are missed by the same share: (4 - v)/4 = (F - 15 kN)/15 kN
    shares = study.candidates[0].shares
    assert shares[0] == pytest.approx(shares[1], abs=0.01)
    assert "exclude each other" in report.page(study)


def test_a_goal_that_cannot_be_reached_alone_says_what_it_comes_to():
    study = design(BALL, HEIGHT, ["approach_speed > 8 m/s", "duration < 1 s"], analysis="impact", runs=32)
    assert [goal.typed for goal in study.conflict.goals] == ["approach_speed > 8 m/s"]
    assert study.conflict.reaches[0].value == pytest.approx(math.sqrt(2.0 * G * 2.0), rel=1e-3)
    assert "cannot be reached alone" in study.notices[0].message


@pytest.mark.parametrize("goal", ["3.0 m/s +- 0.6 %", "2.8 m/s +- 0.6 %", "3.8 m/s +- 1 %"])
def test_what_any_run_meets_is_no_goal_that_cannot_be_reached(goal):
    """All runs of the search miss the narrow band; one that says why, or tells the slope of the nearest, meets it."""
    study = design(BALL, HEIGHT, [f"approach_speed = {goal}"], analysis="impact", runs=16)
    assert np.all(study.margins[:16] < 0.0)
    assert study.met > 0
    assert study.best is not None
    assert study.best.margin == np.nanmax(study.margins[: study.best.run + 1])
    assert study.conflict is None
    assert not study.notices


def test_a_goal_on_a_number_that_no_run_has_says_so():
    """One blow has no coefficient of variation."""
    case = load_case("li-ma-2019", ["feed.blows=1"])
    study = design(case, ["machine.speed=400..900 rpm"], ["cv < 3 %"], analysis="fast", runs=16)
    assert "no run has cv" in study.notices[0].message
    assert study.broken


def test_words_lists_and_whole_numbers_are_chosen():
    """With a restitution near 1 the laws of damping all but agree, so that the height decides."""
    study = design(
        BALL,
        {"machine.height": "0.4, 0.8, 1.6 m", "contact.damping": ["exact", "hunt-crossley"]},
        ["approach_speed = 4 m/s +- 2 %"],
        analysis="impact",
        runs=32,
    )
    assert study.candidates[0].row[0] == 0.8
    assert {one.row[1] for one in study.candidates} == {0.0, 1.0}
    assert study.sensitivities == ()
    assert study.columns()[2].values[0] in ("exact", "hunt-crossley")
    assert len(set(study.rows)) == len(study.rows) <= 6


def test_sensitivity_and_room_are_those_of_free_fall():
    """dv/dh = v/(2 h), central differences of a root of a step s are exact to (s/h)^2/8; the room is band over slope."""
    with RunStore(None) as store, ProcessPool(1) as pool:
        plan = plan_of(BALL, HEIGHT, ["approach_speed = 4 m/s +- 2 %"], "impact", 16)
        runs = DesignRuns(plan, store, pool)
        runs.of([(0.8157,)])
        (found,) = sensitivities(runs, 0)
    step = 0.019
    assert found.changes["approach_speed"] == pytest.approx(step * 4.0 / (2.0 * 0.8157), rel=1e-3)
    assert found.room[0] == pytest.approx(0.04 * 0.8157, rel=0.02)
    assert found.room[1] == pytest.approx(0.04 * 0.8157, rel=0.02)


@pytest.mark.verify
def test_tolerances_leave_the_share_of_the_draws_that_the_normal_law_says():
    """A height of 2 % tolerance, two deviations, makes v scatter by 0.5 %: within 0.5 % lie 68 % of a normal law cut
    off at three deviations; 400 draws agree within four standard errors."""
    case = elastic("machine.height.tolerance=2 %")
    study = design(
        case,
        ["machine.height=0.81, 0.8157 m"],
        ["approach_speed = 4 m/s +- 0.5 %"],
        analysis="impact",
        runs=16,
        robust=400,
    )
    first = next(one for one in study.candidates if one.row[0] == 0.8157).robustness
    assert first.share == pytest.approx(0.6827 / 0.9973, abs=4.0 * math.sqrt(0.68 * 0.32 / 400))
    assert first.low < first.share < first.high
    assert study.candidates[0].robustness == max(
        (one.robustness for one in study.candidates), key=lambda one: one.share
    )


def test_a_stopped_design_goes_on_and_any_number_of_workers_gives_the_same(tmp_path):
    asked = {"analysis": "impact", "runs": 48}
    goals = ["approach_speed = 4 m/s +- 1 %"]
    with ThreadPoolExecutor(2) as executor:
        first = design(BALL, HEIGHT, goals, workers=Workers(executor=executor), store=tmp_path / "s", **asked)

    class Refusing:
        """An executor that must not be asked."""

        def submit(self, *_):
            future = Future()
            future.set_exception(AssertionError("a finished run is made again"))
            return future

    again = design(BALL, HEIGHT, goals, workers=Workers(executor=Refusing()), store=tmp_path / "s", **asked)
    alone = design(BALL, HEIGHT, goals, **asked)
    for other in (again, alone):
        assert other.rows == first.rows
        np.testing.assert_array_equal(other.numbers, first.numbers)
        assert other.document_text() == first.document_text()


def test_runs_that_fail_are_told_and_passed_by():
    """Below 23 rpm or so the machine turns too slowly for a run."""
    case = load_case("li-ma-2019", ["feed.blows=1"])
    study = design(case, ["machine.speed=5..400 rpm"], ["peak_force < 20 kN"], analysis="impact", runs=32)
    failed = sum(map(bool, study.failures))
    assert study.best.meets
    assert failed > 0
    (notice,) = study.notices
    assert notice.code == "runs-failed"
    assert notice.value == failed


def test_the_fast_run_of_a_machine_is_verified_by_the_full_one():
    case = load_case("li-ma-2019", ["feed.blows=1"])
    study = strikewave.design(
        case,
        ["machine.speed=600..800 rpm"],
        ["first.rigid_peak = 4000 g +- 10 %", "first.width < 1 ms", "stop_force < 100 kN"],
        analysis="fast",
        runs=16,
    )
    first = study.best
    assert first.holds
    full = strikewave.run_case(study.case_of()).blows[0]
    share = study.plan.goals[0].share(np.array([full.rigid_peak]))[0]
    assert first.verified[0] == pytest.approx(share, abs=1e-6)
    assert math.isnan(first.verified[2])  # the full run names no force of the stop
    assert len(report.picture(study).axes) == 3


@pytest.mark.parametrize(
    ("text", "number", "low", "high"),
    [
        ("first.rigid_peak = 4000 g +- 5 %", "first.rigid_peak", 3800 * G, 4200 * G),
        ("first.rigid_peak=4000 g ± 100 g", "first.rigid_peak", 3900 * G, 4100 * G),
        ("first.width = 180..220 us", "first.width", 180e-6, 220e-6),
        ("first.width = 0.18 ms .. 220 us", "first.width", 180e-6, 220e-6),
        ("cv < 3 %", "cv", -math.inf, 0.03),
        ("cv <= 0.03", "cv", -math.inf, 0.03),
        ("count = 11", "count", 10.5, 11.5),
        ("missed < 1", "missed", -math.inf, 1.0),
        ("first.velocity_change >= 3 m/s", "first.velocity_change", 3.0, math.inf),
        ("first.peak_force < 0.8 yield", "first.peak_force / yield", -math.inf, 0.8),
        ("spec:jesd22-b110:B passes", "spec:jesd22-b110:B", 0.0, math.inf),
    ],
)  # fmt: skip
def test_goals_are_read_as_typed(text, number, low, high):
    goal = read_aim(load_case("li-ma-2019"), "run", text)
    assert goal.number == number
    assert (goal.low, goal.high) == (pytest.approx(low, rel=1e-12), pytest.approx(high, rel=1e-12))
    assert goal.typed == " ".join(text.split())


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("first.rigid_peek = 4000 g +- 5 %", "first.rigid_peak"),
        ("first.rigid_peak = 4000 g", "tolerance"),
        ("first.rigid_peak < 4000 ms", "acceleration"),
        ("first.rigid_peak < 0 g", "other than 0"),
        ("first.width = 220..180 us", "end lies above"),
        ("cv < 3 g", "per cent"),
        ("cv", "such as"),
        ("cv = 3 % +- 0 %", "above 0"),
        ("spec:jesd22-b111:Z passes", "goals"),
        ("spec:mil-std-810h-srs passes", "goals|spectr"),
        ("nobody clips never", "sensor"),
        ("stress < 0.8 yield", "stresses"),
        ("cv < 0.8 yield", "yield"),
        ("first.peak_force > 0.8 yield", "no goal"),
    ],
)
def test_wrong_goals_are_refused_in_words(text, said):
    with pytest.raises(InputError, match=said):
        read_aim(load_case("li-ma-2019"), "run", text)


@given(st.text(max_size=60))
def test_any_text_is_a_goal_or_refused(text):
    case = load_case("li-ma-2019")
    try:
        aim = read_aim(case, "fast", text)
    except (InputError, InputErrors):
        return
    assert isinstance(aim, Goal | Objective)


def test_what_follows_no_history_is_not_asked_of_the_fast_run():
    with pytest.raises(InputError, match='"fast" follows no history'):
        read_aim(load_case("li-ma-2019"), "fast", "spec:jesd22-b110:B passes")


@pytest.mark.parametrize(
    ("asked", "said"),
    [
        ({"aims": []}, "at least one goal"),
        ({"vary": []}, "a setting"),
        ({"runs": 3}, "16 to"),
        ({"robust": -1}, "robust"),
        ({"seed": -1}, "seed"),
        ({"vary": ["machine.hight=0.1..2 m"]}, "machine.height"),
    ],
)
def test_what_cannot_be_asked_is_refused(asked, said):
    asked = {"vary": HEIGHT, "aims": ["approach_speed < 4 m/s"], "analysis": "impact"} | asked
    with pytest.raises(InputError, match=said):
        plan_of(BALL, **asked)


def test_draws_without_a_tolerance_are_refused():
    with pytest.raises(InputError, match="tolerance"):
        design(BALL, HEIGHT, ["approach_speed < 4 m/s"], analysis="impact", runs=16, robust=8)


@given(st.lists(st.floats(-10.0, 10.0), min_size=1, max_size=20), st.floats(-5.0, 5.0), st.floats(0.1, 5.0))
def test_a_margin_is_above_zero_within_the_limits_and_one_in_the_middle(values, low, width):
    goal = Goal("", "x", low, low + width)
    shares = goal.share(np.array([*values, low + 0.5 * width]))
    assert shares[-1] == pytest.approx(1.0)
    assert (shares <= 1.0 + 1e-12).all()
    inside = [low <= value <= low + width for value in values]
    np.testing.assert_array_equal(shares[:-1] >= 0.0, inside)


def test_a_run_without_a_number_is_worse_than_any_with_it():
    merit = margin_merit([Goal("", "x", -math.inf, 1.0), Goal("", "y", -math.inf, 1.0)], ["x", "y"])
    found = merit(np.array([[math.nan, 0.5], [1e6, 1e6], [0.5, 0.9]]))
    assert found[0] > found[1] > 0.0 > found[2]


@given(st.lists(st.tuples(st.integers(0, 5), st.integers(0, 5)), min_size=1, max_size=30))
def test_the_front_is_what_no_other_beats(points):
    values = np.array(points, dtype=float)
    for value in values:
        beaten = any(
            all(a <= b for a, b in zip(other, value, strict=True)) and tuple(other) != tuple(value) for other in values
        )
        assert _beaten(value, values) == beaten


@pytest.fixture(scope="module")
def two_aims():
    goals = ["approach_speed > 2 m/s", "peak_force smallest", "approach_speed largest"]
    return design(BALL, HEIGHT, goals, analysis="impact", runs=32)


@pytest.mark.usefixtures("undrawn")
def test_two_objectives_give_a_front_of_runs(two_aims):
    """A larger fall gives a higher speed and a larger force: no run is better in both, and all that meet the goal are
    on the front, down to its lower end."""
    study = two_aims
    speed, force = study.numbers[list(study.front)].T
    assert len(study.front) == study.met
    assert (np.diff(force) > 0.0).all()
    assert (np.diff(speed) > 0.0).all()
    assert speed[-1] == pytest.approx(math.sqrt(2.0 * G * 2.0), rel=0.01)  # of two generations
    assert force[0] == pytest.approx(force_at(2.0), rel=0.02)
    assert "Pareto-optimal" in report.page(study)


def test_a_clipping_number_is_the_reading_over_the_range():
    case = load_case("li-ma-2019")
    name = case.sensor[0].name if case.sensor else None
    case = case if name else load_case("endevco-tp-321")
    number = evaluation_of(case, case.command, ["clips"])(case).numbers[0]
    solution = strikewave.run_case(case)
    assert (number > 1.0) == any(notice.code == "sensor-clipped" for notice in solution.notices)


@pytest.mark.verify
def test_a_specification_is_judged_as_a_comparison_judges_it():
    case = load_case("iec-60068-2-27-rubber")
    asked = "spec:iec-60068-2-27:100g-6ms"
    margin = evaluation_of(case, "run", [asked])(case).numbers[0]
    judged = strikewave.compare("iec-60068-2-27-rubber", asked).specified
    assert (margin >= 0.0) == (judged.verdict == "pass")


def test_a_share_of_draws():
    assert Robustness(30, 40, 0.6, 0.9).share == 0.75


def test_where_only_runs_that_fail_a_check_meet_the_goals_it_is_said_and_the_nearest_that_passes_is_named():
    """From 944 rpm on a second blow comes where one is wanted, after a first that only grazes the object."""
    case = load_case("li-ma-2019", ["feed.blows=1"])
    study = design(case, ["machine.speed=930..960 rpm"], ["first.rigid_peak < 2000 g"], analysis="fast", runs=16)
    margins = study.margins
    broken = np.array([status == "broken" for status in study.verdicts.statuses])
    assert (margins[~broken] < 0.0).all()
    assert (study.met, study.met_broken) == (0, np.sum(margins >= 0.0))
    assert study.met_broken > 1
    assert study.document()["meeting_all_goals"] == 0
    nearest = study.nearest_sound
    assert margins[nearest] == margins[~broken].max()
    first, words = study.candidates[0], design_words(study)
    assert first.confirmed
    assert not first.holds
    none = f"o setting whose run passes its checks meets all goals; {study.met_broken} runs that fail one do"
    assert words.startswith(f"N{none}; the nearest that passes is {study.plan.at(study.rows[nearest])}")
    assert "Best" not in words
    assert "not held" not in words
    assert [notice.code for notice in study.notices if notice.broken] == ["not-met", "runs-broken"]
    assert study.notices[0].message.startswith(f"n{none}")


def test_a_broken_run_is_ahead_of_no_other_on_a_front(two_aims):
    """One run of a front is taken as broken: it leaves the front to the others."""
    study = two_aims
    best = study.front[0]
    verdicts = ["broken: blow-count" if run == best else "passed" for run in range(len(study.rows))]
    runs = SimpleNamespace(plan=study.plan, rows=study.rows, numbers=study.numbers, verdicts=verdicts)
    assert best not in front(runs, study.plan.objectives)
    assert set(study.front) - {best} <= set(front(runs, study.plan.objectives))
