"""What is said of a fit: combinations of values, notices with their limits, sentences, and what the screen lists."""

from types import SimpleNamespace

import numpy as np
import pytest
from matplotlib.figure import Figure

from strikewave.base.quantities import Value
from strikewave.base.result import Verdicts
from strikewave.reporting.faces import columns_of
from strikewave.reporting.numbers import ShownUnits, showing
from strikewave.studies.fit import report
from strikewave.studies.fit.checking import Checks, PredictedFigure, TriedChoice
from strikewave.studies.fit.covariance import Excess
from strikewave.studies.fit.free_fields import free_fields
from strikewave.studies.fit.posterior import Posterior
from strikewave.studies.fit.problem import Misfit, SeparatingNumber
from strikewave.studies.fit.report import check_words, correlation_table, fit_words, residual_rows
from strikewave.studies.fit.result import (
    FittedParameter,
    MisfitOfRun,
    combination_words,
    fit_notices,
    held_notices,
    posterior_notices,
    separating_words,
)

from .closed_runs import CASE, FORCE, HEIGHT, LOSS, number

LOW = "machine.height=0.2 m..0.4 m"
MASS = "striker.mass"


def study_of(words=(FORCE, LOW), errors=None, **more):
    """What words take of a study: values in the middle of their bounds, with so many errors of 1 % of these."""
    fields = free_fields(CASE, list(words))
    parameters = []
    for k, field in enumerate(fields):
        error = 0.01 if errors is None else errors[k]
        parameters.append(
            FittedParameter(field, field.si(0.5), field.error(field.si(0.5), error), field.low, field.high)
        )
    size = len(fields)
    estimate = SimpleNamespace(
        place=np.full(size, 0.5),
        covariance=np.eye(size),
        undetermined=np.zeros((size, 0)),
        groups=lambda: [],
        misfit=3.25,
        residuals=np.zeros(7),
    )
    solved = SimpleNamespace(
        estimate=estimate,
        misfits=[misfit("a", 1.0, 0.01)],
        others=(),
        stopped=False,
        runs=44,
        problem=SimpleNamespace(excess=Excess(), shot_count=1),
    )
    found = {
        "parameters": parameters,
        "solved": solved,
        "correlation": np.eye(size),
        "numbers": [],
        "pulses": (),
        "separating": (),
        "bands": (),
        "tries": (),
        "checks": None,
        "posterior": None,
        "verdicts": Verdicts((), "fitted runs"),
    }
    return SimpleNamespace(**found | more)


def misfit(called, size, share, more=False, number=False, known=True, scatters=False):
    return Misfit(called, size, share, 9.0, more, number, known, scatters)


@pytest.mark.parametrize(
    ("power", "words"),
    [
        (3.0, f"{FORCE} × {HEIGHT}^3 (to 2.00 %)"),
        (-2.0, f"{FORCE} / {HEIGHT}^2 (to 2.00 %)"),
        (1.004, f"{FORCE} × {HEIGHT} (to 2.00 %)"),
        (0.994, f"{FORCE} × {HEIGHT}^0.994 (to 2.00 %)"),
        (1.006, f"{FORCE} × {HEIGHT}^1.01 (to 2.00 %)"),
    ],
)
def test_a_product_of_powers_is_known_as_well_as_the_data_know_it(power, words):
    """ln F + p ln h to 2 %: of bounds 2 decades and an octave wide, along which nothing else is known."""
    study = study_of()
    gains = np.array([np.log(100.0), power * np.log(2.0)])
    study.solved.estimate.covariance = 4e-4 * np.outer(gains, gains) / (gains @ gains) ** 2
    study.solved.estimate.undetermined = (np.array([[-gains[1]], [gains[0]]])) / np.linalg.norm(gains)
    assert combination_words(study, [0, 1]) == f"the data fix {words}, not {FORCE} and {HEIGHT}"
    assert combination_words(study, [1]) == f"the data do not determine {HEIGHT}"


def test_of_more_values_it_is_said_how_they_go_together():
    """1 % of force, -2 % of height and half a per cent of mass, in shares of the largest; of two ways nothing is said."""
    study = study_of([LOSS, FORCE, LOW, MASS])
    moves = np.array([1.0, -2.0, 0.5]) / [one.field.width for one in study.parameters[1:]]
    lost = np.zeros((4, 1))
    lost[1:, 0] = moves / np.linalg.norm(moves)
    study.solved.estimate.undetermined = lost
    names = f"{FORCE}, {HEIGHT} and {MASS}"
    told = f"{FORCE} by -0.5 %, {HEIGHT} by +1 %, {MASS} by -0.25 %"
    assert combination_words(study, [1, 2, 3]).startswith("the data do not determine ")
    assert told in combination_words(study, [1, 2, 3])
    vague = "each of which makes good for others"
    study.solved.estimate.undetermined = np.eye(4)[:, 1:3]
    assert vague in combination_words(study, [1, 2, 3])
    study.solved.estimate.undetermined = lost
    assert vague in combination_words(study, [0, 1])  # differences of a share are no powers
    assert names.split(", ")[0] in combination_words(study, [1, 2, 3])


def test_what_would_tell_values_apart_is_told_with_what_is_then_known_of_them():
    """Of bounds 2 decades wide 0.01 is 4.6 %; a share has no such per cent."""
    study = study_of([LOSS, FORCE, LOW])
    study.separating = (
        SeparatingNumber((FORCE, HEIGHT), "x", (0.3, 0.4)),
        SeparatingNumber((LOSS, FORCE), "y", (0.02, 0.01)),
    )
    assert separating_words(study, [0, 1]) == f"y measured to 1 % would ({FORCE} to 4.6 %)"
    assert separating_words(study, [0, 2]) == "no other number of the blow would tell them apart"
    assert separating_words(study, [2]) == "no other number of the blow would"


@pytest.mark.parametrize(
    ("error", "words"),
    [(20.2e3, "790 ± 20 kN"), (5.0, "789.640 ± 0.005 kN"), (1e-12, "789.64000000000 ± 0.00000000000 kN")],
)
def test_a_value_has_twelve_decimals_at_most_and_no_noughts_that_both_have(error, words):
    field = free_fields(CASE, [FORCE])[0]
    assert FittedParameter(field, 789.64e3, error, 0.0, 1.0).words == words


def codes(study):
    return [(one.code, one.value, one.limit) for one in fit_notices(study)]


def test_records_that_are_no_noise_or_scatter_are_named_by_the_worst():
    study = study_of(pulses=(1, 2, 3))
    study.solved.misfits = [
        misfit("a", 3.0, 0.04, True),
        misfit("b", 1.0, 0.5),
        misfit("c", 4.0, 0.03, True, known=False),
    ]
    assert codes(study) == [("residual-not-noise", 4.0, 1.0)]
    (notice,) = fit_notices(study)
    assert "of c is not noise (the worst of 2 records): its RMS is 3.0 % of the peak, 4 times 1e-4" in notice.message
    study.solved.misfits = [misfit("a", 3.0, 0.04, True), misfit("b", 2.0, 0.2, True, scatters=True)]
    study.solved.misfits += [misfit("c", 5.0, 0.01, True, scatters=True)]
    left, apart = fit_notices(study)
    assert (left.code, left.value, apart.code, apart.value, apart.limit) == (
        "residual-not-noise",
        3.0,
        "shots-scatter",
        5.0,
        1.0,
    )
    assert "worst" not in left.message
    assert "3 times its noise" in left.message
    assert apart.message.startswith("2 of 3 records differ by more than noise, c by 1.0 % of the peak")
    assert (left.severity, apart.severity) == ("warning", "info")


def test_what_a_model_lacks_of_numbers_is_the_median_of_their_shares():
    """Off by 3 uncertainties of 1, 2 and 4 %: 6 %; what is known of a field does not count. Beyond 2 they are missed."""
    some = [number("first.rigid_peak", 0.1, share, setting="abc"[k]) for k, share in enumerate((0.01, 0.02, 0.04))]
    some.append(number("first.width", 0.0, 0.5, of_field=True))
    study = study_of(numbers=some)
    study.solved.problem.excess = Excess(1.0, 3.0, 2.0)
    study.solved.misfits = [misfit("a", 2.0, 0.1, number=True), misfit("b", 2.1, 0.2, number=True)]
    lack, missed = fit_notices(study)
    assert (lack.code, lack.value, lack.limit) == ("lack-of-fit", 3.0, 0.0)
    assert "off by 6.0 % (standard deviation)" in lack.message
    assert "uncertainties explain" in lack.message
    assert (missed.code, missed.value, missed.limit) == ("not-met", 2.1, 2.0)
    assert missed.message == "b is missed by 2.1 times its uncertainty, 20.0 %"
    study.numbers = [*some, some[0]]
    study.solved.misfits += [misfit("c", 5.5, 0.3, number=True), misfit("record", 9.0, 0.4)]
    lack, missed = fit_notices(study)
    assert "uncertainties and repeats explain" in lack.message
    assert missed.message == "c is missed by 5.5 times its uncertainty, 30.0 % (the worst of 2 of 5 numbers)"


def test_values_at_a_bound_on_steps_and_elsewhere_are_named():
    """Within 1e-4 of either bound; where a step is more than half a standard error of what is determined."""
    study = study_of([FORCE, LOW])
    for place, named in ((1.1e-4, 0), (0.9e-4, 1), (1.0 - 1.1e-4, 0), (1.0 - 0.9e-4, 1)):
        study.solved.estimate.place = np.array([0.5, place])
        assert [one.code for one in fit_notices(study)] == ["at-bound"] * named
    study.solved.estimate.place = np.full(2, 0.5)
    values = study.parameters
    height = values[1]
    for share, error, named in ((0.49, 3e-3, False), (0.51, 3e-3, True), (0.99, 3e-3, True), (0.6, np.inf, False)):
        stepped = FittedParameter(height.field, height.value, error, 0.2, 0.4, stair=share * 3e-3)
        study.parameters = [values[0], stepped]
        assert codes(study) == [("on-stairs", pytest.approx(share * 3e-3), pytest.approx(1.5e-3))] * named
        assert not named or f"in steps of {share * 3e-3:.2g} m," in fit_notices(study)[0].message
    study.parameters = values
    study.solved.others = (np.array([0.25, 0.75]),)
    (other,) = fit_notices(study)
    force, height = (one.field.shown(one.field.si(at), 4) for one, at in zip(values, (0.25, 0.75), strict=True))
    assert f"{FORCE} = {force}, {HEIGHT} = {height}" in other.message
    study.solved.stopped = True
    assert [one.code for one in fit_notices(study)] == ["stopped", "another-solution"]


@pytest.mark.parametrize(("share", "named"), [(0.979, False), (0.981, True), (-0.981, True)])
def test_pairs_of_a_correlation_beyond_0_98_are_named_once(share, named):
    study = study_of([LOSS, FORCE, LOW])
    study.correlation = np.eye(3)
    study.correlation[2, 1] = share
    found = fit_notices(study)
    assert len(found) == named
    if named:
        assert found[0].message.startswith(f"{FORCE} and {HEIGHT} are known")
        assert (found[0].value, found[0].limit, found[0].severity) == (0.981, 0.98, "info")
        study.parameters[1] = study_of([FORCE], [np.inf]).parameters[0]
        assert not fit_notices(study)


def test_chains_that_are_too_short_and_values_that_are_held_are_told():
    (short,) = posterior_notices(Posterior(np.zeros((1, 1)), 100, 4.0, 0.5, 1))
    assert (short.value, short.limit) == (25.0, 50.0)
    assert "chains of 100 steps" in short.message
    assert "about 800 independent draws, 2000 and 50 times" in short.message
    assert not short.message.startswith("stopped")
    (stopped,) = posterior_notices(Posterior(np.zeros((1, 1)), 100, 4.0, 0.5, 1, True))
    assert stopped.message.startswith("stopped: chains")
    assert not posterior_notices(Posterior(np.zeros((1, 1)), 4000, 4.0, 0.5, 1))
    from strikewave import load_case

    case = load_case("li-ma-2019")
    assert held_notices(case) == []
    changed = {"machine.engagement": Value(si=6e-3, typed="6 mm")}
    (one,) = held_notices(case.with_values(changed))
    assert (one.value, one.limit) == (1.0, 0.0)
    assert one.message.startswith("machine.engagement is held as it was set")
    (two,) = held_notices(case.with_values({**changed, "object.frame_stiffness": Value(si=9e7, typed="90 MN/m")}))
    assert two.value == 2.0
    assert "machine.engagement and object.frame_stiffness are held" in two.message


def test_a_fit_is_told_by_its_values_and_what_is_left():
    study = study_of()
    first = study.solved.misfits[0]
    study.solved.misfits = [first, misfit("b", 2.0, 0.034, number=True)]
    values = ", ".join(f"{one.field.path} = {one.words}" for one in study.parameters)
    within = "What is left is within noise or uncertainty: at most 3.40 % (RMS)."
    assert fit_words(study) == f"{values} (standard errors). {within}"
    study.solved.misfits = [first, misfit("b", 2.01, 0.034, number=True), misfit("c", 9.0, 0.01, number=True)]
    study.numbers = [1, 2, 3]
    missed = "2 of 3 numbers are missed by more than 2 times their uncertainty, by up to 3.4 %."
    assert fit_words(study) == f"{values} (standard errors). {missed}"
    study.solved.misfits = [first, misfit("b", 2.0, 0.034, True), misfit("c", 3.0, 0.02, True)]
    study.pulses = (1, 2, 3)
    broken = "What is left is more than noise in 2 of 3 records: up to 3.4 % of the peak (RMS)."
    assert fit_words(study) == f"{values} (standard errors). {broken}"
    study.tries = (TriedChoice("x=1", 1.0, 2.0), TriedChoice("x=2"))
    assert fit_words(study).startswith("Of 2 choices, x=1 predicts records that it was not fitted to best. ")
    study.tries = (TriedChoice("x=1", 1.0), TriedChoice("x=2"))
    study.verdicts = Verdicts(["broken: blow-count", "passed"], "fitted runs")
    assert fit_words(study).startswith(f"{study.verdicts.sentence} Of 2 choices, x=1 fits best. ")
    study.solved.estimate.groups = lambda: [[1]]
    assert f"The data do not determine {HEIGHT}." in fit_words(study)


def test_predictions_are_told_by_bands_biases_and_agreement():
    figures = (
        PredictedFigure("a", "peak", "m/s^2", 98.0665, 107.87315, 90.0, 110.0),
        PredictedFigure("b", "peak", "m/s^2", 100.0, 97.0, 96.0, 98.0),
        PredictedFigure("b", "width", "s", 2e-3, 1.9e-3, 1.9e-3, 2.1e-3),
    )
    ratings = [SimpleNamespace(rating=SimpleNamespace(overall=overall)) for overall in (0.8, 0.95)]
    words = check_words(Checks(figures, tuple(zip("ab", ratings, strict=True))))
    assert words.startswith("Of what was kept out, 2 of 3 bands hold what was measured; mean bias: peak +3.5 %")
    assert "width -5.0 %" in words
    assert words.endswith("Predictions agree to 0.88 of 1 by ISO/TS 18571.")
    assert check_words(Checks(figures, ())).endswith("-5.0 %.")
    bare = PredictedFigure("a", "first.restitution", "", 0.5, 0.4, 0.3, 0.45)
    columns = columns_of(PredictedFigure, [figures[0], bare])
    assert [column.texts()[0] for column in columns] == [
        "a", "peak", "10 g", "11 g", "9.177 to 11.22 g", "+10.0", "inside"
    ]  # fmt: skip
    assert [column.texts()[1] for column in columns][1:5] == ["first.restitution", "0.5", "0.4", "0.3 to 0.45"]


def test_residuals_and_correlations_have_a_row_each_the_largest_first():
    study = study_of([LOSS, FORCE])
    study.solved.misfits = [misfit("a", 1.0, 0.1), misfit("b", 3.0, 0.2), misfit("c", 2.0, 0.3)]
    study.verdicts_of_measured = lambda: ["x", "y", "z"]
    assert [(row.misfit.called, row.verdict) for row in residual_rows(study)] == [("b", "y"), ("c", "z"), ("a", "x")]
    study.correlation = np.array([[1.0, 0.12345], [-0.5, np.nan]])
    table = correlation_table(study)
    assert table.columns == ["", LOSS, FORCE]
    assert table.cells() == [[LOSS, "1", "0.123"], [FORCE, "-0.5", "–"]]


@pytest.mark.parametrize(
    ("count", "scatters", "words"),
    [
        (2, (), "the scatter of 2 shots shows it"),
        (1, (0.0, 0.02), "as stated"),
        (1, (0.0, 0.0), "nothing, for one shot"),
    ],
)
def test_a_report_says_what_is_known_of_the_scatter_of_shots(count, scatters, words):
    study = study_of(pulses=[(SimpleNamespace(scatter=one), None) for one in scatters])
    study.solved.problem.shot_count = count
    assert report._shots(study).startswith(words)


def test_a_report_has_a_correlation_of_two_values_and_says_of_which_records_pictures_are(monkeypatch):
    monkeypatch.setattr(report, "values_figure", lambda study: Figure())
    monkeypatch.setattr(report, "overlay", lambda study: Figure())
    monkeypatch.setattr(report, "profile_figures", lambda study: [(Figure(), "profile")] * 2)
    for words, count in (((FORCE,), 5), ((FORCE, LOW), 6)):
        assert len(report._values(study_of(words)).parts) == count
    pulses = [(SimpleNamespace(scatter=0.0), None)] * 7
    for some, named in ((pulses[:6], False), (pulses, True)):
        ((picture,),) = [report._records(study_of(pulses=some)).parts]
        assert ("The first 6 of 7 are drawn." in picture.caption) == named


@pytest.mark.parametrize(("count", "told"), [(20, 0), (21, 1)])
def test_the_screen_lists_twenty_residuals_and_the_correlation_of_several_values(monkeypatch, count, told):
    printed, said = {}, []
    monkeypatch.setattr(report, "print_rows", lambda title, columns: printed.update({title: columns[0].values}))
    monkeypatch.setattr(report, "report_table", lambda table: printed.update({table.caption: table.rows}))
    monkeypatch.setattr(report, "tell", said.append)
    study = study_of((FORCE,))
    study.solved.misfits = [misfit(str(k), float(k), 0.1) for k in range(count)]
    study.verdicts_of_measured = lambda: [""] * count
    command = report.FitCommand(CASE, None, None, None, place=None, fresh=False)
    command.show(study)
    assert list(printed) == ["Fitted values", "Residuals"]
    assert list(printed["Residuals"]) == [str(k) for k in range(count)][::-1][:20]
    assert len(said) == told
    two = study_of()
    two.verdicts_of_measured = lambda: [""]
    command.show(two)
    assert len(printed["Correlation of the values"]) == 2


@pytest.mark.parametrize(
    ("free", "bayes", "whole"), [((), False, 120.0), ((1, 2, 3), False, 180.0), ((1, 2, 3), True, 5180.0)]
)
def test_the_bar_of_a_fit_is_full_after_sixty_runs_a_value_and_five_thousand_of_a_posterior(
    monkeypatch, free, bayes, whole
):
    reported = []

    class Bar:
        def __enter__(self):
            return lambda share, words: reported.append((share, words))

        def __exit__(self, *_):
            return False

    def asked(case, request, advance, pool, store):
        advance(30, 12.3456)
        advance(10**6, 1.0)
        return report.FitRequest()  # any dataclass with an origin would do

    monkeypatch.setattr(report, "progress_bar", lambda title: Bar())
    monkeypatch.setattr(report, "requested", asked)
    monkeypatch.setattr(report.dataclasses, "replace", lambda study, **more: study)
    request = SimpleNamespace(free=free, bayes=bayes)
    report.FitCommand(CASE, request, None, None, place=None, fresh=False).solved(None)
    assert reported[0] == (pytest.approx(30.0 / whole), "30 runs, sum of squares 12.35")
    assert reported[1][0] == 0.99


def test_an_interval_says_from_what_it_is():
    """Of a profile, a parabola, or the bounds; a correlation has its own column."""
    study = study_of((FORCE, LOW), [0.01, np.inf])
    force, height = study.parameters
    followed = FittedParameter(force.field, force.value, force.standard_error, 1.0, 2.0, profile=())
    columns = columns_of(FittedParameter, [followed, force, height])
    assert columns[3].texts() == ["profile", "parabola", "not determined"]
    assert columns[2].texts()[1:] == ["78.96 to 7896 kN", "0.2 to 0.4 m (bounds)"]
    row = MisfitOfRun(Misfit("a", 1.0, 0.034, 9.9, False), "")
    assert [column.texts() for column in columns_of(MisfitOfRun, [row])[1:4]] == [["3.4"], ["1"], ["9"]]


def test_values_stand_in_the_unit_that_was_chosen_with_its_name():
    """789.64 kN is 789640 N: number and name change together."""
    field = free_fields(CASE, [FORCE])[0]
    value = FittedParameter(field, 789.64e3, 20.2e3, 700e3, 800e3)
    assert value.words == "790 ± 20 kN"
    with showing(ShownUnits.read("N")):
        assert value.words == "789640 ± 20200 N"
        assert [column.texts() for column in columns_of(FittedParameter, [value])[2:]] == [
            ["7e+05 to 8e+05 N"], ["parabola"], ["789600 N"]
        ]  # fmt: skip
