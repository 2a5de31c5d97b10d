"""What a fit is asked, in which order it is done, and what comes of its values."""

import dataclasses
import math
from concurrent.futures import ThreadPoolExecutor
from types import SimpleNamespace

import numpy as np
import pytest

from strikewave import load_case
from strikewave.analyses.compare.sources import SourceOptions
from strikewave.base.errors import InputError
from strikewave.base.quantities import Value
from strikewave.studies.engine.runner import Workers
from strikewave.studies.fit import estimation, report, study
from strikewave.studies.fit.checking import TriedChoice
from strikewave.studies.fit.covariance import Estimate
from strikewave.studies.fit.estimation import KeptResults, ProfileEnds, _read, _text
from strikewave.studies.fit.fit_file import FitFile, FreeTable, RecordTable, is_fit_file
from strikewave.studies.fit.free_fields import FreeField, free_fields
from strikewave.studies.fit.problem import FastRun, runs_fast
from strikewave.studies.fit.study import FittedTo, fitted_case
from strikewave.studies.fit.targets import FitRequest, Target, published_targets

from .closed_runs import CASE, FORCE, HEIGHT, LOSS


def field_of(low, high, log):
    return FreeField("machine.height", Value(si=4.0, typed="4 m"), None, low, high, log)


def solved_of(place, error, reach=1.96, stopped=False, undetermined=None, stated=None):
    size = len(place)
    lost = np.zeros((size, 0)) if undetermined is None else undetermined
    reaches = np.array([9.0] * (size - 1) + [reach])
    covariance = np.diag([1e-6] * (size - 1) + [error**2])
    found = Estimate(np.array(place), np.zeros(1), np.zeros((1, size)), covariance, lost, reaches, stated)
    stairs = np.array([0.5] * (size - 1) + [0.02])
    return SimpleNamespace(estimate=found, stopped=stopped, search="search", problem=SimpleNamespace(stairs=stairs))


def test_an_interval_is_so_many_errors_to_either_side_within_the_bounds(monkeypatch):
    """Of the second of two values, on 0 to 10: 4 with 0.3, 2.5 errors wide; at a bound it ends there; on a logarithm."""
    asked = []
    monkeypatch.setattr(study, "is_quadratic", lambda *words: not asked.append(words))
    field = field_of(0.0, 10.0, False)
    solved = solved_of([0.9, 0.4], 0.03, 2.5)
    one = study._parameter(solved, 1, field)
    assert (one.value, one.standard_error, one.stair) == pytest.approx((4.0, 0.3, 0.2))
    assert (one.low, one.high, one.profile) == (pytest.approx(3.25), pytest.approx(4.75), None)
    assert asked == [("search", solved.estimate, 1)]
    for place, low, high in ((0.01, 0.0, 0.688), (0.99, 9.312, 10.0)):
        one = study._parameter(solved_of([0.5, place], 0.03), 1, field)
        assert (one.low, one.high) == (pytest.approx(low, abs=1e-9), pytest.approx(high))
    scale = study._parameter(solved_of([0.9, 0.25], 0.03, 2.5), 1, field_of(2.0, 32.0, True))
    assert scale.value == pytest.approx(4.0)
    assert scale.standard_error == pytest.approx(4.0 * 0.03 * math.log(16.0))
    assert (scale.low, scale.high) == pytest.approx((2.0 * 16.0**0.175, 2.0 * 16.0**0.325))


def test_a_profile_is_followed_where_the_misfit_is_no_parabola_and_shapes_the_interval(monkeypatch):
    ends = ProfileEnds(-0.1, 0.7, np.array([0.4]), np.array([0.0]))
    monkeypatch.setattr(study, "is_quadratic", lambda *words: False)
    monkeypatch.setattr(study, "profile", lambda *words: ends)
    field, lost = field_of(0.0, 10.0, False), np.array([[1.0], [0.0]])
    one = study._parameter(solved_of([0.9, 0.4], 0.03), 1, field)
    assert (one.low, one.high, one.profile) == (0.0, pytest.approx(7.0), ends)
    for solved in (
        solved_of([0.9, 0.4], 0.03, stopped=True),
        solved_of([0.9, 0.4], 0.03, undetermined=lost),
        solved_of([0.9, 0.4], 0.03, stated=np.array([0.0, 0.03**2])),
    ):
        one = study._parameter(solved, 1, field)
        assert (one.profile, one.high) == (None, pytest.approx(4.588))
    unknown = study._parameter(solved_of([0.9, 0.4], 0.03, undetermined=lost[::-1]), 1, field)
    assert (unknown.standard_error, unknown.low, unknown.high) == (math.inf, 0.0, 10.0)
    assert unknown.stair == pytest.approx(0.2)


ASKED = {"to": ["a"], "free": ["a"], "tries": "a", "check_on": ["a"], "bayes": True, "reading": SourceOptions()}


@pytest.mark.parametrize("name", ASKED)
def test_a_case_is_asked_as_typed_and_beside_a_file_nothing_is(monkeypatch, name):
    kept = []
    monkeypatch.setattr(study, "requested", lambda case, request, progress, pool: kept.append((request, pool)))
    study.fit(CASE, **{name: ASKED[name]})
    ((request, pool),) = kept
    wanted = tuple(ASKED[name]) if isinstance(ASKED[name], list) else ASKED[name]
    assert getattr(request, name) == wanted
    assert pool is None
    assert request == dataclasses.replace(FitRequest(), **{name: wanted})
    with pytest.raises(InputError, match="the path of a file alone"):
        study.fit("a.toml", **{name: ASKED[name]})


def test_how_records_are_read_is_handed_on(monkeypatch):
    monkeypatch.setattr(study, "requested", lambda case, request, progress, pool: request)
    reading = SourceOptions(band=False)
    assert study.fit(CASE, reading=reading).reading is reading


@pytest.mark.parametrize("workers", [1, Workers(executor=ThreadPoolExecutor(1)), None])
def test_a_pool_is_made_where_one_is_asked_for(monkeypatch, workers):
    monkeypatch.setattr(study, "requested", lambda case, request, progress, pool: pool)
    assert (study.fit(CASE, workers=workers) is None) == (workers is None)


@dataclasses.dataclass(frozen=True)
class Fitted:
    """Stands for the study of a fit."""

    solved: object = None
    notices: tuple = ()
    tries: tuple = ()
    checks: object = None
    posterior: object = None
    bands: tuple = ()
    citations: tuple = ()
    case: str = ""


@pytest.mark.parametrize(("bayes", "stopped", "sampled"), [(1, 0, True), (1, 1, False), (0, 0, False)])
def test_a_posterior_is_sampled_where_it_is_asked_for_and_nothing_was_stopped(monkeypatch, bayes, stopped, sampled):
    monkeypatch.setattr(study, "_fit", lambda *words: Fitted(SimpleNamespace(stopped=bool(stopped))))
    monkeypatch.setattr(study, "with_posterior", lambda found, progress: "sampled")
    monkeypatch.setattr(study, "check_sampler", lambda: None)
    assert (study.requested(CASE, FitRequest(bayes=bool(bayes))) == "sampled") == sampled


def test_runs_of_the_posterior_are_counted_after_those_of_the_fit(monkeypatch):
    told = []

    def sample(residuals, found, advance):
        advance(30, 2.5)
        return SimpleNamespace(too_short=False)

    monkeypatch.setattr(study, "sample", sample)
    monkeypatch.setattr(study, "predictive_bands", lambda solved, posterior, most: [most])
    solved = SimpleNamespace(runs=400, estimate=None, problem=SimpleNamespace(residuals=None))
    found = study.with_posterior(Fitted(solved), lambda *words: told.append(words))
    assert told == [(430, 2.5)]
    assert found.bands == (6,)
    study.with_posterior(Fitted(solved))
    monkeypatch.setattr(study, "sample", lambda *words: None)
    assert [one.code for one in study.with_posterior(Fitted(solved)).notices] == ["not-sampled"]


def test_of_choices_the_best_is_kept_with_all_of_them(monkeypatch):
    """Ranked by what they predict, the failed last, with one line; a choice that is stopped is the last one tried."""
    misfits = {"1": 3.0, "2": 1.0, "3": 2.0, "4": 0.5}
    done = []

    def fit(case, request, progress):
        done.append(case)
        if case == "bad":
            raise InputError("x", "1", "2\nmore")
        return Fitted(SimpleNamespace(stopped=case == "3", misfit=misfits[case]), case=case)

    monkeypatch.setattr(study, "read_tries", lambda case, word: word.split(","))
    monkeypatch.setattr(study, "changed_case", lambda case, changes: changes[0])
    monkeypatch.setattr(study, "tried", lambda change, solved: TriedChoice(change, solved.misfit))
    monkeypatch.setattr(study, "_fit", fit)
    found = study._tried(CASE, FitRequest(tries="1,bad,2,3,4"), None)
    assert done == ["1", "bad", "2", "3"]
    assert found.case == "2"
    assert [one.choice for one in found.tries] == ["2", "3", "1", "bad"]
    assert "\n" not in found.tries[-1].failure.strip()
    assert found.tries[-1].failure.startswith("x: got")
    with pytest.raises(InputError, match="a choice that can be fitted"):
        study._tried(CASE, FitRequest(tries="bad"), None)


@pytest.mark.parametrize(("to", "free", "check_on"), [((), (), ()), (("first.width=1 ms",), (), ("first.width=2 ms",))])
def test_a_case_is_fitted_to_its_published_numbers_unless_others_are_typed(monkeypatch, to, free, check_on):
    case = load_case("li-ma-2019")
    kept = []
    read = SimpleNamespace(experiments=(), notices=("left out",))
    monkeypatch.setattr(study, "read_targets", lambda option, case, targets, fields, reading: read)
    monkeypatch.setattr(
        study, "fitted_study", lambda case, fields, read, targets, progress: kept.append(targets) or Fitted()
    )
    monkeypatch.setattr(study, "held_notices", lambda case: ["held"])
    monkeypatch.setattr(study, "check", lambda solved, experiments: "checks")
    found = study._fit(case, FitRequest(to, free, check_on=check_on), None)
    assert kept == [[Target("first.width", "1 ms", is_number=True)] if to else published_targets(case)]
    assert (found.checks, found.notices) == (("checks", ("held", "left out")) if check_on else (None, ("held",)))
    assert study._fit(case, FitRequest(to, ("machine.radius",)), None).notices == ()
    monkeypatch.setattr(study, "published_targets", lambda case: [])
    with pytest.raises(InputError, match="a record or a number"):
        study._fit(CASE, FitRequest((), (LOSS,)), None)


class Stop(Exception):  # noqa: N818
    """Holds what was come to."""


@pytest.mark.parametrize(
    ("names", "parts", "felt"),
    [
        (("first.width", "first.sensor_peak x"), (), True),
        (("first.width",), ("board", "frame"), True),
        (("first.width",), ("frame.force", "other"), False),
        (("first.width",), ("board.force",), True),
    ],
)
def test_a_fit_holds_under_all_but_what_differed_and_under_sensors_where_they_read(monkeypatch, names, parts, felt):
    def stop(case, fields, found, to):
        raise Stop(to)

    problem = SimpleNamespace(runs=lambda place: [], with_runs=lambda runs: [], fields=())
    solved = SimpleNamespace(estimate=SimpleNamespace(place=None), problem=problem, stopped=False)
    for name, value in (("Problem", lambda *words: problem), ("solve", lambda *words: solved), ("fitted_case", stop)):
        monkeypatch.setattr(study, name, value)
    monkeypatch.setattr(study, "separating", lambda solved: [])
    targets = [Target(name, "1", ("machine.height = 1 m", "a=2"), is_number=True) for name in names]
    read = SimpleNamespace(experiments=(), paths=(), pulses=[SimpleNamespace(part=part) for part in parts])
    with pytest.raises(Stop) as stopped:
        study.fitted_study(SimpleNamespace(sensor=[SimpleNamespace(name="board")]), (), read, targets)
    (to,) = stopped.value.args
    assert (tuple(to.aside), to.sensors) == (("machine.height", "a"), felt)


def test_what_a_case_is_fitted_to_is_said_in_six_words_or_so():
    targets = [Target("first.rigid_peak", f"{k} g", is_number=True) for k in range(9)]
    assert study._words(targets[:2]) == "first rigid peak 0 g, first rigid peak 1 g"
    words = study._words([*targets[:6], targets[0], *targets])
    assert "5 g" in words
    assert "7 g" not in words
    assert study._words([Target("", "folder/a.csv")]) == "a.csv"


@pytest.mark.parametrize(
    ("stated", "asked", "sampled"), [(True, False, True), (False, True, True), (False, False, False)]
)
def test_a_posterior_is_asked_for_in_the_file_or_beside_it(monkeypatch, tmp_path, stated, asked, sampled):
    path = tmp_path / "a.toml"
    path.write_text("")
    read = SimpleNamespace(path=path, request=FitRequest(bayes=stated), case=CASE)
    monkeypatch.setattr(report, "load_fit", lambda path, changes: read)
    monkeypatch.setattr(report, "_run", lambda case, request, *words: request.bayes)
    output = SimpleNamespace(tested=lambda case: case)
    assert report.run_fit_file(str(path), (), output, None, None, asked) == sampled


def test_records_are_named_as_sources_and_numbers_are_not(monkeypatch, tmp_path):
    kept = []
    (tmp_path / "a.csv").write_text("")
    monkeypatch.setattr(
        report.measured, "source_of", lambda name, case, paths, test: kept.append(paths) or SimpleNamespace(text="")
    )
    monkeypatch.setattr(report, "run_and_write", lambda command, output, usual, text: usual)
    output = SimpleNamespace(writes=lambda usual: True, stated_test=lambda: None)
    request = FitRequest((f"{tmp_path}/a.csv", "first.width=1 ms"), check_on=(f"{tmp_path}/a.csv",))
    running = SimpleNamespace(store=None, fresh=False)
    assert report._run(CASE, request, output, "usual", None, running, [tmp_path / "b"]) == "usual"
    assert kept == [[tmp_path / "b", tmp_path / "a.csv"]]


def test_a_fast_run_has_its_numbers_and_no_others():
    run = FastRun.__new__(FastRun)
    run.__dict__["_found"] = ({"first.width": 2, "none": None}, "verdict")
    assert (run.number("first.width"), run.verdict) == (2.0, "verdict")
    assert math.isnan(run.number("none"))
    assert math.isnan(run.number("other"))
    assert not runs_fast(load_case("two-bars-fem"))
    assert not runs_fast(load_case("li-ma-2019-fig13-bar"))


class Store:
    """Stands for a store of finished runs."""

    def __init__(self):
        self.held, self.kept = {}, []

    def known(self):
        return set(self.held)

    def documents(self, keys):
        return [(self.held[key], None) for key in keys]

    def keep(self, started, finished):
        self.kept.append(len(finished))
        self.held |= {key: outcome.document for key, outcome in finished}


calls = []


def halved(number):
    calls.append(number)
    if number > 90.0:
        raise ValueError("cannot be run")
    return np.array([number / 2.0, 7.0])


def test_results_are_kept_and_read_by_what_made_them(monkeypatch):
    """Each is made once, in its order, though asked for twice; failures are kept too, and nothing beyond the room."""
    store = Store()
    kept = KeptResults(store)
    calls.clear()
    found = kept.each_or_none(halved, [4.0, 6.0, 4.0, 91.0])
    assert sorted(calls) == [4.0, 6.0, 91.0]
    assert [one if one is None else one.tolist() for one in found] == [[2.0, 7.0], [3.0, 7.0], [2.0, 7.0], None]
    assert store.kept == [3]
    again = KeptResults(store)
    calls.clear()
    found = again.each_or_none(halved, [6.0, 8.0, 4.0, 91.0])
    assert calls == [8.0]
    assert [one if one is None else one.tolist() for one in found] == [[3.0, 7.0], [4.0, 7.0], [2.0, 7.0], None]
    assert [one.tolist() for one in again.each_or_none(halved, [4.0])] == [[2.0, 7.0]]
    assert calls == [8.0]
    monkeypatch.setattr(estimation, "MOST_KEPT", 2 * len(_text(np.zeros(2))))
    small = KeptResults(Store())
    for k, count in ((1.0, [1]), (2.0, [1, 1]), (3.0, [1, 1])):
        small.each_or_none(halved, [k])
        assert small._store.kept == count
    with estimation.keeping_in(Store()):
        calls.clear()
        assert estimation.result_of(halved, 4.0).tolist() == estimation.result_of(halved, 4.0).tolist() == [2.0, 7.0]
        assert calls == [4.0]
        with pytest.raises(ValueError, match="cannot be run"):
            estimation.result_of(halved, 99.0)


def test_results_are_written_to_the_bit_or_not_at_all():
    numbers = np.array([1.0 / 3.0, -0.0, np.inf])
    assert _read(_text(numbers)).tobytes() == numbers.tobytes()
    for whole in ([0.1, 2.5], 0.1, None, []):
        assert _read(_text(whole)) == whole
    for other in (numbers.astype(np.float32), numbers[None, :], [0.1, "a"], "a", [1], np.arange(3)):
        assert _text(other) == ""


def test_one_run_is_made_here_and_several_where_the_pool_is(monkeypatch):
    asked = []
    monkeypatch.setattr(
        estimation, "on_threads", lambda function, items: asked.append(len(items)) or [None] * len(items)
    )
    assert estimation.each_or_none(halved, [4.0])[0].tolist() == [2.0, 7.0]
    assert estimation.each_or_none(halved, [4.0, 6.0]) == [None, None]
    assert asked == [2]


@pytest.mark.parametrize(("low", "high"), [(None, 1.0), (1.0, None)])
def test_a_field_of_a_file_has_both_bounds_or_none(low, high):
    with pytest.raises(ValueError, match="both bounds, or none"):
        FreeTable(path="a", low=low, high=high)
    assert FreeTable(path="a").word == "a"
    assert FreeTable(path="a", low="1 m", high="2 m").word == "a=1 m..2 m"


def test_a_record_of_a_file_is_named_with_channel_and_blow(tmp_path):
    row = RecordTable(file="a.csv", channel=2, blow=3, part="board", of_blow=4, scatter="2 %")
    found = row.target(tmp_path, "x")
    assert (found.left, found.right.rpartition("a.csv")[2], found.scatter) == ("board@4", "#2@3", 0.02)
    plain = RecordTable(file="a.csv", part="board").target(tmp_path, "x")
    assert (plain.left, plain.right.rpartition("a.csv")[2]) == ("board", "")


def test_a_file_holds_a_thousand_targets_and_a_reading():
    row = {"name": "first.width", "value": "1 ms"}
    head = {"schema": 1, "case": "a", "record": [{"file": "a.csv"}] * 400}
    assert len(FitFile.model_validate({**head, "number": [row] * 600}).number) == 600
    with pytest.raises(ValueError, match="1001 records and numbers"):
        FitFile.model_validate({**head, "number": [row] * 601})
    reading = FitFile.model_validate({**head, "reading": {"channel": 2, "time": 1, "time_unit": "ms"}}).reading
    read = reading.options().options
    assert (read.channels, read.time, read.time_unit) == (("2",), "1", 1e-3)
    bare = FitFile.model_validate(head).reading.options().options
    assert (bare.channels, bare.time, bare.time_unit) == ((), None, None)


def test_a_name_is_that_of_a_file_of_a_fit_only_if_there_is_one(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "study.txt").write_text('case = "a"\n')
    (tmp_path / "study.toml").write_text('case = "a"\n')
    (tmp_path / "li-ma-2019").write_text('case = "a"\n')
    (tmp_path / "LARGE.TOML").write_text('case = "a"\n#' + " " * 300_000)
    assert [is_fit_file(name) for name in ("study.txt", "study.toml", "li-ma-2019", "none.toml")] == [
        False,
        True,
        False,
        False,
    ]
    assert is_fit_file("LARGE.TOML")


def fitted(errors, **more):
    """Return CASE with force and height fitted to so many errors of their bounds."""
    fields = free_fields(CASE, [FORCE, HEIGHT])
    lost = np.eye(2)[:, [k for k in range(2) if np.isinf(errors[k])]]
    deviations = np.where(np.isinf(errors), 0.0, errors)
    covariance = np.outer(deviations, deviations) * np.array([[1.0, 0.25], [0.25, 1.0]])
    found = Estimate(np.full(2, 0.25), np.zeros(1), np.zeros((1, 2)), covariance, lost, np.full(2, 1.96))
    return fitted_case(more.pop("case", CASE), fields, found, FittedTo("a.csv", {}, **more))


def test_values_of_a_fitted_case_have_their_errors_and_what_they_hold_under():
    both = fitted([0.01, 0.02])
    (table,) = both.fit[-1:]
    assert table.fields == (FORCE, HEIGHT)
    assert table.correlation == ((1.0, 0.25), (0.25, 1.0))
    values = both.values()
    force = values[FORCE].si
    assert force == pytest.approx(789.6e3 * 100.0**-0.25)
    assert table.standard_error[FORCE] == f"{float(f'{0.01 * np.log(100.0) * force:.4g}') / 1e3:g} kN"
    assert table.under["machine.height"] == values[HEIGHT].typed
    assert "striker.mass" in table.under
    assert not [path for path in table.under if path.startswith(("solver", "recorder", "sensor"))]
    one = fitted([0.01, np.inf])
    assert (one.fit[-1].fields, one.fit[-1].correlation) == ((FORCE,), ())
    assert [one.values()[path].provenance for path in (FORCE, HEIGHT)] == ["fitted", "assumed"]
    sure = fitted([0.01, 0.0])
    assert sure.fit[-1].fields == (FORCE, HEIGHT)
    assert list(sure.fit[-1].standard_error) == [FORCE]
    small = fitted([0.01, 0.005])
    assert list(small.fit[-1].standard_error) == [FORCE, HEIGHT]
    assert fitted([np.inf, np.inf]).fit == CASE.fit
    assert "striker.mass" not in fitted([0.01, 0.02], aside=("striker.mass",)).fit[-1].under


def test_an_earlier_fit_keeps_the_values_that_are_not_fitted_anew():
    first = fitted([0.01, 0.02])
    again = fitted([0.01, np.inf], case=first)
    assert [one.fields for one in again.fit] == [(FORCE,)]
    from strikewave.cases.case import FitTable

    held = CASE.model_copy(
        update={
            "fit": (
                FitTable(fields=(FORCE, LOSS), to="x", under={"striker.mass": "1 kg", "object": "none"}),
                FitTable(
                    fields=("object.mass",),
                    to="y",
                    under={"striker.mass": "1 kg"},
                    standard_error={"object.mass": "1 kg"},
                ),
            )
        }
    )
    kept = fitted([0.01, 0.02], case=held).fit
    assert [one.fields for one in kept] == [(LOSS,), ("object.mass",), (FORCE, HEIGHT)]
    assert kept[1].standard_error == {"object.mass": "1 kg"}
    one = fitted([0.01, np.inf], case=held).fit[-1]  # under what the earlier one named
    assert "object.mass" in one.under
    assert one.under["striker.mass"] == CASE.values()["striker.mass"].typed
    assert "object" not in one.under
    assert FORCE in one.under
    assert "machine.follow" not in one.under
