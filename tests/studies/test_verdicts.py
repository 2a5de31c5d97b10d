"""A run's verdict is made where the run is, kept with its numbers, and shown by every study on every face."""

import functools
import json
import sqlite3

import pytest

import strikewave
from strikewave import load_case
from strikewave.analyses.machine.notices import run_verdict
from strikewave.analyses.machine.observe import observe
from strikewave.analyses.machine.run import run_case
from strikewave.analyses.wave.run import run_wave
from strikewave.base.result import FAILED, RUN_STATUSES, Notice, Verdict, Verdicts, status_of
from strikewave.cases.case import parse_case
from strikewave.reporting.shown_result import shown_table
from strikewave.specifications.reading import load_specification
from strikewave.studies.engine.case_evaluation import CaseEvaluation
from strikewave.studies.engine.evaluation import RunOutcome
from strikewave.studies.engine.store import INDEX, RunStore
from strikewave.studies.map.cells import judged_cell
from strikewave.studies.search.drop_table import DropChoices, DropGoal, design_drop_table
from strikewave.studies.search.programmers import read_programmer
from strikewave.studies.simulation import Simulation

EARLY = "machine.speed=950 rpm"
"""The first striker meets the object while it is still fed: twelve blows come for the eleven wanted."""
ONE = ("feed.blows=1", "machine.speed.tolerance=1 %")
BAR = """
schema = 1
name = "bar"
[[stack.layer]]
name = "bar"
material = "65Mn"
length = "200 mm"
diameter = "30 mm"
[load]
shape = "sine-squared"
peak = "40 kN"
duration = "60 us"
[[tap]]
name = "end"
layer = "bar"
position = 1.0
[solver]
duration = "400 us"
[[sensor]]
name = "acc"
tap = "end"
resonance = "100 kHz"
range = "60000 g"
mass = "5 gram"
[[sensor.gasket]]
material = "PTFE"
thickness = "1 mm"
diameter = "15 mm"
"""
PLANTED = "planted-check"


def planted(*_):
    """Return the failed check that no code but the one place of the checks can know of."""
    return [Notice(PLANTED, "a planted check", 1.0, 0.0, FAILED)]


@pytest.fixture
def broken_runs(monkeypatch):
    """Let every run fail a check, at the one place where the checks of machines and of bars are made."""
    plant(monkeypatch)


def plant(patch):
    """Put the planted check in the place of those of machines and of bars."""
    patch.setattr("strikewave.analyses.machine.notices.count_notices", planted)
    patch.setattr("strikewave.analyses.wave.notices.momentum_notices", planted)


@pytest.fixture(scope="module")
def broken():
    """Return what makes a study whose runs all fail the planted check; each is made once for all tests."""

    @functools.cache
    def made(make):
        with pytest.MonkeyPatch.context() as patch:
            plant(patch)
            return make()

    return made


def a_sweep():
    return strikewave.sweep(load_case("li-ma-2019", ONE), ["machine.speed=500,700 rpm"], keep=["first.rigid_peak"])


def a_sweep_of_two():
    case = load_case("jesd22-b111-b")
    return strikewave.sweep(case, ["machine.height=1 m, 1.5 m", "contact.restitution=0.4, 0.5"], analysis="run")


def a_sweep_of_three():
    vary = ["machine.height=1 m..1.5 m", "contact.restitution=0.4..0.5", "contact.reference_force=700..900 kN"]
    return strikewave.sweep(load_case("jesd22-b111-b"), vary, design="latin-hypercube", runs=12, analysis="run")


def a_fast_sweep():
    return strikewave.sweep(load_case("li-ma-2019", ONE), ["machine.speed=500,700 rpm"], analysis="fast")


def a_sweep_of_a_bar():
    return strikewave.sweep(parse_case(BAR), ["load.peak=30,40 kN"])


def a_map():
    case = load_case("li-ma-2019", ["feed.blows=3"])
    return strikewave.map(case, "machine.speed=600..700 rpm", "machine.engagement=4..6 mm", points=(3, 3), train=0)


def a_scatter():
    return strikewave.scatter(load_case("li-ma-2019", ["feed.blows=2", ONE[1]]), runs=10, shares="none")


def a_design():
    case = load_case("jesd22-b111-b")
    return strikewave.design(case, ["machine.height=1 m..2 m"], ["first.rigid_peak > 1 g"], analysis="run", runs=16)


def a_drop_table():
    specification = load_specification("jesd22-b110:A")
    goal = DropGoal(specification, specification.pulse_limits(), 2.0)
    return design_drop_table(load_case("jesd22-b111-b"), goal, DropChoices((read_programmer("linear"),), (0.1,)))


def a_buffer():
    return strikewave.buffer(parse_case(BAR), "20000 g", stacks=strikewave.StackChoices(["rubber"], ["1 mm"], 1))


def a_fit():
    case = load_case("jesd22-b111-b", ["contact.reference_force=700 kN"])
    return strikewave.fit(case, ["first.rigid_peak=1500 g +- 1 %"], ["contact.reference_force"])


def a_comparison():
    case = parse_case(BAR)
    return strikewave.compare(run_wave(case), run_wave(case))


def settings_of_a_machine():
    return strikewave.settings("40 ms", "4000 g", "200 us", choices=strikewave.SettingsChoices([4], ["0.2 kg"]))


def a_reproduction():
    from strikewave.papers.li_ma_2019.reproduce import reproduce
    from strikewave.papers.li_ma_2019.runs import Effort

    return reproduce(Effort(elements=False, studies=False))


def dear(make, *more):
    """Return a parameter of `make verify` alone: other studies check the same at less cost."""
    return pytest.param(make, *more, marks=pytest.mark.verify)


STUDIES = (
    a_sweep, a_map, a_scatter, a_drop_table, a_buffer, a_fit,
    *map(dear, (a_sweep_of_two, a_sweep_of_three, a_fast_sweep, a_sweep_of_a_bar, a_design, a_comparison)),
    *map(dear, (settings_of_a_machine, a_reproduction)),
)  # fmt: skip
WITHOUT_COLUMN = ("buffer", "fit", "compare", "reproduce")
"""Whose main table has no row a run: stacks, values, samples, equations. Of a fit the residuals have the column."""


def first_words(study):
    """Return what the command prints first."""
    from strikewave.analyses.compare.report import compare_words
    from strikewave.papers.li_ma_2019.report import reproduction_words
    from strikewave.studies.buffer.report import buffer_words
    from strikewave.studies.fit.report import fit_words
    from strikewave.studies.map.report import map_words
    from strikewave.studies.scatter.report import scatter_words
    from strikewave.studies.search.design_report import design_words
    from strikewave.studies.sweep.report import sweep_words

    words = {
        "SweepStudy": sweep_words, "MapStudy": map_words, "ScatterStudy": scatter_words, "DesignStudy": design_words,
        "BufferStudy": buffer_words, "FitStudy": fit_words,
        "CompareResult": compare_words, "Reproduction": reproduction_words,
    }  # fmt: skip
    return words[type(study).__name__](study) if type(study).__name__ in words else study.words


@pytest.mark.parametrize("make", STUDIES)
def test_a_planted_broken_run_is_marked_on_every_face(make, broken):
    """What is planted is known nowhere but where the checks are made: a face that judged by itself would miss it."""
    study = broken(make)
    verdicts = study.verdicts
    assert verdicts.count("broken") > 0
    assert set(verdicts.codes) == {PLANTED}
    assert f"failed a check ({PLANTED})" in first_words(study)
    document = study.document()
    assert document["verdicts"] == {status: verdicts.count(status) for status in RUN_STATUSES}
    assert [study.exit_code(fail_on) for fail_on in ("broken", "never", "failed")] == [3, 0, 0]
    html = study._repr_html_()
    assert "check failed" in html or "checks failed" in html
    assert "all checks passed" not in html
    if study.command not in WITHOUT_COLUMN:
        name = "run_verdict" if study.command == "settings" else "verdict"
        (column,) = (one for one in study.columns() if one.name == name)
        assert f"broken: {PLANTED}" in list(column.values)
        assert name.replace("_", " ") in shown_table(study)[0]
        for file, text in study.tables().items():
            assert name in text.splitlines()[0], file
    if study.command == "fit":
        assert document["misfit"]["measured"][0]["verdict"] == f"broken: {PLANTED}"


@pytest.mark.parametrize("make", [a_sweep, *(dear(getattr(one, "values", (one,))[0]) for one in STUDIES[1:])])
def test_a_planted_broken_run_stands_on_the_page(make, broken, tmp_path):
    assert PLANTED in broken(make).report(tmp_path / "report.html").read_text("utf-8")


@pytest.mark.parametrize(
    ("make", "points"),
    [
        (a_sweep, 2), (a_map, 9), (a_scatter, 10), (a_fit, 1),
        (a_drop_table, lambda study: len(study.candidates)),
        (a_buffer, lambda study: sum(bool(one.stack) for one in study.candidates) + (study.present is not None)),
        dear(a_sweep_of_two, 8), dear(a_design, lambda study: 2 * len(study.rows)), dear(settings_of_a_machine, lambda study: 2 * len(study.candidates)),
    ],
)  # fmt: skip
def test_broken_runs_have_a_mark_of_their_own_in_the_picture(make, points, broken):
    """Each point of a run or candidate is marked, once on each of the axes that show it; a fit marks its values."""
    study = broken(make)
    figure = study.plot()
    lines = [line for axes in figure.axes for line in axes.get_lines()]
    marks = [line for line in lines if str(line.get_label()).endswith("failed a check")]
    assert {line.get_marker() for line in marks} == {"D"}
    assert sum(len(line.get_xdata()) for line in marks) == (points(study) if callable(points) else points)
    texts = [text.get_text() for legend in [*figure.legends] for text in legend.get_texts()]
    texts += [text.get_text() for axes in figure.axes if axes.get_legend() for text in axes.get_legend().get_texts()]
    assert any(text.endswith("failed a check") for text in texts)


def test_the_page_of_the_app_says_what_the_runs_came_to(broken):
    from strikewave.web.case_state import CaseSource
    from strikewave.web.pages.study.view import result_view

    view = result_view(broken(a_sweep), "Sweep", CaseSource("li-ma-2019", "", ONE, ""))
    assert f"2 of 2 runs failed a check ({PLANTED})" in view["by"]
    assert all(f"(broken: {PLANTED})" in words for words, _ in view["found"])
    assert any(series["name"] == "failed a check" for series in view["charts"][0]["series"])
    assert "verdict" in view["tables"][0][1]


@pytest.mark.verify
def test_netcdf_of_a_map_has_the_verdict_of_each_cell(broken):
    data = broken(a_map).data
    assert (data["verdict"] == RUN_STATUSES.index("broken")).all()


def test_twelve_blows_for_eleven_are_broken_in_a_run_a_sweep_and_a_map():
    """All by one limit: the full run with its readings, the run of a sweep, the fast engine, and a cell of a map."""
    case = load_case("li-ma-2019", [EARLY])
    kept = ("first.rigid_peak",)
    texts = [CaseEvaluation(analysis, kept)(case).verdict for analysis in ("run", "fast")]
    texts += [run_case(case).own_verdict.text, judged_cell(case, 11, 0)[1].text]
    assert texts == ["broken: blow-count"] * 4


@pytest.mark.parametrize(
    ("name", "changes"),
    [
        ("li-ma-2019", ["feed.blows=2"]),
        ("li-ma-2019", ["machine.engagement=0.1 mm", "feed.blows=2", "feed.arrival=0.1"]),
        ("jesd22-b111-b", []),
        ("jesd22-b111-b", ["solver.tolerance=1e-5"]),
    ],
)
def test_the_verdict_of_studies_is_that_of_the_notices_of_a_run(name, changes):
    """A check that is added to the notices of a run alone would be missed by all studies: the two must be equal."""
    case = load_case(name, changes)
    seen = observe(case)
    assert run_verdict(case, seen.run, seen.blows) == run_case(case).own_verdict


def test_the_verdict_of_a_bar_is_that_of_its_notices():
    case = parse_case(BAR)
    assert Simulation(case).verdict == run_wave(case).own_verdict


def test_runs_that_cannot_be_made_fail_the_command_unless_it_is_told_otherwise():
    case = load_case("li-ma-2019", ["feed.blows=1"])
    study = strikewave.sweep(case, {"machine.engagement": ["1 mm", "400 mm"]}, analysis="fast")
    assert study.verdicts.texts == ("passed", "failed")
    assert [study.exit_code(fail_on) for fail_on in ("failed", "broken", "never")] == [3, 3, 0]


def test_a_search_ends_by_what_it_offers_not_by_what_it_tried():
    verdicts = Verdicts(["broken: blow-count", "failed", "passed"], deciding=["passed"])
    assert not verdicts.fails("broken")
    assert {notice.severity for notice in verdicts.notices()} == {"warning"}
    assert Verdicts(verdicts.texts, deciding=["broken: blow-count"]).fails("broken")


def test_verdicts_that_decide_otherwise_are_others():
    held = {"noun": "cells", "reason": "why", "not_judged": ("momentum-balance",), "deciding": ["passed"]}
    whole = Verdicts(["broken: blow-count", "passed"], **held)
    assert whole == Verdicts(list(whole.texts), **held)
    assert hash(whole) == hash(Verdicts(whole.texts, **held))
    assert all(whole != Verdicts(whole.texts, **{k: v for k, v in held.items() if k != left}) for left in held)


def test_the_page_of_the_app_tells_runs_that_could_not_be_made_from_failed_checks():
    from strikewave.web.pages.study.view import _marked_groups

    verdicts = Verdicts(["passed", "broken: no-blow", "failed", "broken: no-blow"])
    assert _marked_groups(verdicts) == [("failed a check", [1, 3]), ("could not be made", [2])]
    assert _marked_groups(verdicts, {1, 2, 3}) == []


def test_a_design_does_not_offer_a_run_that_fails_a_check_where_another_meets_the_goals(monkeypatch):
    """Every fast run at more than 700 rpm is made to fail: the largest speed that passes is offered."""

    def above(case, *_):
        return planted() if case.machine.speed.si > 700 * 3.14159265 / 30 else []

    monkeypatch.setattr("strikewave.analyses.machine.notices.count_notices", above)
    case = load_case("li-ma-2019", ["feed.blows=1"])
    study = strikewave.design(
        case, ["machine.speed=500, 600, 700, 800, 900 rpm"], ["first.rigid_peak > 1 g"], analysis="fast", runs=16
    )
    assert study.verdicts.count("broken") > 0
    assert all(status_of(one.verdict) == "passed" for one in study.candidates)
    assert study.exit_code() == 0


def test_a_store_of_before_verdicts_is_read_and_its_runs_are_not_judged(tmp_path):
    with RunStore(tmp_path / "runs") as store:
        store.keep(("peak",), [(b"a", RunOutcome((1.0,))), (b"b", RunOutcome(failure="no machine"))])
    base = sqlite3.connect(tmp_path / "runs" / INDEX)
    base.execute("ALTER TABLE runs DROP COLUMN verdict")
    base.execute("PRAGMA user_version = 3")
    base.commit()
    base.close()
    with RunStore(tmp_path / "runs") as store:
        verdicts = store.verdicts([b"a", b"b"])
        store.keep(("peak",), [(b"c", RunOutcome((1.0,), verdict="passed"))])
        assert store.verdicts([b"c"]).texts == ("passed",)
    assert verdicts.texts == ("", "failed")
    assert [notice.code for notice in verdicts.notices()] == ["runs-failed", "runs-not-judged"]


def test_a_kept_simulation_keeps_its_verdict(broken_runs, tmp_path):
    solution = run_wave(parse_case(BAR))
    solution.datasets()["waves.nc"].write(tmp_path / "waves.nc")
    result = strikewave.compare(str(tmp_path / "waves.nc"), str(tmp_path / "waves.nc"))
    assert result.verdicts.texts == (f"broken: {PLANTED}",) * 2
    assert result.exit_code() == 3


def test_bands_count_the_runs_that_fail_a_check(monkeypatch):
    monkeypatch.setattr("strikewave.analyses.machine.notices.count_notices", planted)
    solution = run_case(load_case("jesd22-b111-b"), band=True)
    method = solution.band_method
    assert method.broken == method.runs
    assert method.broken_words() == [f"Of the {method.runs} runs of these ranges {method.runs} failed a check."]


def test_the_notebook_says_suspect_where_the_screen_does(tmp_path):
    """A half-sine that is cut off at its top, and so suspect or bad: no notice of the result, but a status."""
    rows = [f"{k * 1e-6:.6f},{min(max(1000.0 * (1.0 - ((k - 500) / 100.0) ** 2), 0.0), 600.0)}" for k in range(1000)]
    (tmp_path / "shot.csv").write_text("time (s),acceleration (g)\n" + "\n".join(rows))
    result = strikewave.record(str(tmp_path / "shot.csv"))
    status = result.readings[0].status
    assert status != "good"
    assert f"1 {status}" in result._repr_html_()


def test_command_ends_by_fail_on_and_json_counts(strikewave):
    ask = "sweep", "li-ma-2019", "--vary", "machine.speed=940,950 rpm", "--analysis", "fast", "--json"
    ask += "--workers", "1"
    for fail_on, code in (((), 3), (("--fail-on", "failed"), 0), (("--fail-on", "never"), 0)):
        ended, out, err = strikewave(*ask, *fail_on)
        assert ended == code, err
        document = json.loads(out)
        assert document["verdicts"] == {"passed": 1, "broken": 1, "failed": 0}
        assert document["verdict"] == ["passed", "broken: blow-count"]


def test_the_verdict_of_notices_is_of_failed_checks_alone():
    assert Verdict.of([Notice("odd", "a warning")]).text == "passed"
    assert Verdict.of([Notice("odd", "a warning"), *planted(), *planted()]).text == f"broken: {PLANTED}"


def test_of_a_single_run_no_count_is_given():
    """ "1 of 1 fitted runs" is a riddle; of two each is counted."""
    single = Verdicts(["broken: blow-count"], "fitted runs")
    assert single.words == "the fitted run failed a check (blow-count)"
    assert single.sentence == "The fitted run failed a check (blow-count)."
    assert single.notices()[0].message == "the fitted run failed a check: blow-count"
    assert Verdicts(["failed"], "simulations").words == "the simulation could not be made"
    assert Verdicts(["failed", "passed"]).sentence == "1 of 2 runs could not be made."
    assert Verdicts(["passed"]).sentence == ""
