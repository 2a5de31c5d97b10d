"""The study of a fit of a run in closed form: its pictures, words, tables and notices."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from strikewave import load_case
from strikewave.base.result import Verdicts
from strikewave.studies.fit import figures
from strikewave.studies.fit.measured import MeasuredNumber, MeasuredPulse
from strikewave.studies.fit.posterior import Posterior, predictive_bands
from strikewave.studies.fit.problem import Experiment
from strikewave.studies.fit.report import fit_words, page, residual_rows
from strikewave.studies.fit.study import speed_notices

from .closed_runs import CASE, FORCE, HEIGHT, LOSS, number, problem, pulse


def test_a_study_of_a_record_has_its_pictures(studied):
    """Lines of the record and the run in g over microseconds, residuals of both, values at their places, their sheet."""
    study = studied(pulse(1.02, 0.01))
    ((record, laid),) = study.pulses
    sheet = figures.fit_figure(study)
    above, below, values = sheet.axes
    assert sheet.get_size_inches()[1] == pytest.approx(2.3 * (1.6 + 1.0 + 0.62))
    time = (laid.time - laid.time[0]) * 1e6
    for line, wanted in zip(above.lines, (laid.measured, laid.computed), strict=True):
        assert line.get_xdata() == pytest.approx(time)
        assert line.get_ydata() == pytest.approx(wanted / 9.80665)
    assert [line.get_label() for line in above.lines] == ["a.csv", "fitted run"]
    assert below.lines[0].get_ydata() == pytest.approx((laid.computed - laid.measured) / 9.80665)
    noise = np.std(record.record.history.values[:40]) / 9.80665
    band = below.patches[0].get_extents().transformed(below.transData.inverted())
    assert [band.y0, band.y1] == pytest.approx([-2.0 * noise, 2.0 * noise], rel=1e-9)
    (one,) = study.parameters
    bounds, interval, value, start = values.lines[:4]
    assert list(bounds.get_xdata()) == [0.0, 1.0]
    assert interval.get_xdata() == pytest.approx([one.field.place(one.low), one.field.place(one.high)])
    assert value.get_xdata()[0] == pytest.approx(one.field.place(one.value))
    assert start.get_xdata()[0] == pytest.approx(0.5)
    assert [text.get_text() for text in values.get_yticklabels()] == ["reference force"]
    assert values.get_ylim() == pytest.approx((-0.6, 0.6))
    upper, lower = figures.overlay(replace(study, bands=((laid.computed - 98.0665, laid.computed + 196.133),))).axes
    assert len(upper.lines) == 2
    assert len(lower.lines) == 2
    filled = upper.collections[0].get_paths()[0].vertices
    peak = laid.computed.max() / 9.80665
    assert [filled[:, 1].min(), filled[:, 1].max()] == pytest.approx(
        [laid.computed.min() / 9.80665 - 10.0, peak + 20.0]
    )
    assert upper.collections[0].get_label() == "95 % of the posterior and the noise"
    assert figures.values_figure(study).get_size_inches() == pytest.approx([9.8, 1.65])
    assert study.highlights()[-1] == ("largest RMS residual", f"{100.0 * study.solved.misfits[0].share:.2f} %")
    assert study.preview() is not None
    words = fit_words(study)
    assert (
        f"What is left is within noise or uncertainty: at most {100.0 * study.solved.misfits[0].share:.2f} % (RMS)."
        in words
    )


def test_a_study_that_knows_only_a_product_says_so(studied):
    """Height and force of one peak: neither, their product; what would tell them apart; no picture of a record."""
    study = studied(number("first.rigid_peak"), free=(FORCE, HEIGHT))
    (found,) = [one for one in study.notices if one.code == "not-determined"]
    assert (found.value, found.limit) == (2.0, 0.0)
    assert found.message.startswith(f"the data fix {FORCE} × {HEIGHT} (to 2.00 %)")
    assert "first.width measured to 1 % would" in found.message
    assert [one.determined for one in study.parameters] == [False, False]
    assert [(one.low, one.high) for one in study.parameters] == [
        (one.field.low, one.field.high) for one in study.parameters
    ]
    assert np.isnan(study.correlation).all()
    assert study.computed == pytest.approx((14000.0,), rel=1e-6)
    sheet = figures.fit_figure(study)
    assert len(sheet.axes) == 1
    assert sheet.get_size_inches()[1] == pytest.approx(2.3 * 0.84)
    document = study.content()
    assert document["undetermined"] == [[FORCE, HEIGHT]]
    assert [one["interval"] for one in document["parameters"]] == ["bounds", "bounds"]
    assert study.columns()[3].values == [None, None]


def test_numbers_that_are_missed_and_values_at_a_bound_are_named(studied):
    """A width no force between its bounds gives, 5 % of it to 1 %: the bound, and by how much it is missed."""
    study = studied(number("first.width", -0.9), free=(f"{FORCE}=700 kN..900 kN",))
    codes = [one.code for one in study.notices]
    assert "at-bound" in codes
    missed = next(one for one in study.notices if one.code == "not-met")
    share = (900.0 / 789.6) ** -0.5 / 0.1 - 1.0
    assert missed.value == pytest.approx(share * 100.0, rel=1e-4)
    assert missed.limit == 2.0
    assert study.parameters[0].high == 900e3
    (row,) = residual_rows(study)
    assert row.misfit.share == pytest.approx(share, rel=1e-4)
    assert study.tables()["parameters.csv"].splitlines()[0] == "field,unit,value,standard_error,low,high"
    assert "1 of 1 numbers are missed by more than 2 times their uncertainty" in fit_words(study)


def test_values_that_are_known_together_are_named(studied):
    """Peak and width of force and height, one 100 times as sure: a correlation near -1, in closed form."""
    study = studied(number("first.rigid_peak", 0.0, 1e-4), number("first.width"), free=(FORCE, HEIGHT))
    rows = np.array([[0.5, 0.5], [-0.5, 0.0]]) / np.array([[1e-4], [1e-2]])
    covariance = np.linalg.inv(rows.T @ rows)
    wanted = covariance[0, 1] / np.sqrt(np.prod(np.diag(covariance)))
    assert study.correlation[0, 1] == pytest.approx(wanted, rel=1e-3)
    (notice,) = [one for one in study.notices if one.code == "correlated"]
    assert notice.message == f"{FORCE} and {HEIGHT} are known together only (correlation {wanted:+.3f})"
    force, height = study.parameters
    assert force.standard_error / force.value == pytest.approx(np.sqrt(covariance[0, 0]), rel=1e-3)
    assert height.high == pytest.approx(height.value * np.exp(1.96 * np.sqrt(covariance[1, 1])), rel=1e-3)
    assert height.low == pytest.approx(height.value * np.exp(-1.96 * np.sqrt(covariance[1, 1])), rel=1e-3)
    (table,) = study.case.fit[-1:]
    assert table.correlation[0][1] == pytest.approx(wanted, rel=1e-3)


def test_a_corner_shows_shares_of_the_draws_and_the_fitted_values(studied):
    """2000 draws of two values: medians and ends of 95 %, limits a tenth beyond all but 0.4 %, contours of 68 and 95 %."""
    study = studied(number("first.rigid_peak"), number("first.width"), free=(FORCE, HEIGHT))
    draws = 0.5 + 0.02 * np.random.default_rng(5).standard_normal((2000, 2))
    posterior = Posterior(draws, 100, 1.0, 0.5, 3200)
    drawn = replace(study, posterior=posterior)
    figure = figures.corner_figure(drawn)
    assert figure.get_size_inches() == pytest.approx([9.8, 6.0])
    first, _, pair, second = figure.axes
    assert [one.get_visible() for one in figure.axes] == [True, False, True, True]
    shown = [
        np.array([one.field.si(at) for at in draws[:, k]]) / (1e3, 1.0)[k] for k, one in enumerate(study.parameters)
    ]
    for axes, values in ((first, shown[0]), (second, shown[1])):
        low, middle, high = np.quantile(values, [0.025, 0.5, 0.975])
        assert axes.lines[0].get_xdata()[0] == pytest.approx(middle, rel=1e-9)
        ends = axes.patches[-1].get_extents().transformed(axes.transData.inverted())
        assert [ends.x0, ends.x1] == pytest.approx([low, high], rel=1e-6)
        left, right = np.quantile(values, [0.002, 0.998])
        assert axes.get_xlim() == pytest.approx((left - 0.1 * (right - left), right + 0.1 * (right - left)))
        assert len(axes.patches) == 31
    fitted = [one.value / scale for one, scale in zip(study.parameters, (1e3, 1.0), strict=True)]
    assert [first.lines[1].get_xdata()[0], second.lines[1].get_xdata()[0]] == pytest.approx(fitted)
    assert [pair.lines[-1].get_xdata()[0], pair.lines[-1].get_ydata()[0]] == pytest.approx(fitted)
    contours = pair.collections[-1]
    inside = [np.mean(_within(one, shown)) for one in contours.get_paths()]
    assert inside == pytest.approx([0.95, 0.68], abs=0.05)  # smoothed over 1.2 bins of 24
    assert (pair.get_xlabel(), pair.get_ylabel(), first.get_ylabel()) == ("reference force (kN)", "height (m)", "")
    values = drawn.posterior_values()
    assert values[0].median == pytest.approx(study.parameters[0].field.si(float(np.median(draws[:, 0]))))
    assert len(drawn.tables()["posterior.csv"].splitlines()) >= 2001
    assert "Posterior" in page(drawn)


def _within(path, columns):
    return path.contains_points(np.column_stack(columns))


def test_predictive_bands_hold_the_draws_and_the_noise():
    """Of an amplitude known to 1 %: 1.96 times that at the peak with the noise in squares, the noise alone far from it."""
    begun = problem(pulse(1.0, 0.005), free=(HEIGHT,))
    width = begun.fields[0].width
    draws = 0.5 + 0.02 / width * np.random.default_rng(6).standard_normal((3000, 1))
    ((low, high),) = predictive_bands(SimpleNamespace(problem=begun), Posterior(draws, 100, 1.0, 0.5, 1), 6)
    at = int(np.argmax(high))
    half = (high - low) / 2.0
    noise = 1.96 * 0.005 * 14000.0
    assert half[at] == pytest.approx(np.hypot(1.96 * 0.01 * 14000.0, noise), rel=0.15)
    assert half[[0, -1]] == pytest.approx([noise, noise], rel=1e-2)
    assert (high + low)[at] / 2.0 == pytest.approx(14000.0, rel=0.01)


@pytest.mark.parametrize(("loss", "named"), [(0.02, False), (0.04, True)])
def test_a_velocity_change_may_lack_three_percent_of_that_without_rebound(loss, named):
    """Masses 3 and 1 that meet at 2 m/s: 1.5 m/s is the least; a bound machine or a blow that missed says nothing."""
    time = np.linspace(0.0, 1e-3, 101)
    values = -np.full(101, 1.5 * (1.0 - loss) / 1e-3)
    record = MeasuredPulse(SimpleNamespace(name="a.csv", unit="m/s^2"), "", 0, time, values, 1.0, 0, np.ones(1))
    blows = [SimpleNamespace(kind="missed"), SimpleNamespace(kind="hit", approach_speed=2.0)]
    machine = SimpleNamespace(
        strikers=SimpleNamespace(first=SimpleNamespace(mount_stiffness=0.0, mass=3.0)),
        launch=SimpleNamespace(arm=None),
        struck=SimpleNamespace(mass=1.0),
    )
    run = SimpleNamespace(case=CASE, observed=SimpleNamespace(machine=machine, blows=blows))
    tests = SimpleNamespace(experiments=[Experiment(CASE, (), (number("first.width"), record))])
    found = list(speed_notices(tests, [run]))
    assert [one.limit for one in found] == ([1.5] if named else [])
    if named:
        assert found[0].value == pytest.approx(1.44)
    for other in (
        SimpleNamespace(machine=machine, blows=blows[:1]),
        SimpleNamespace(machine=SimpleNamespace(**{**vars(machine), "launch": SimpleNamespace(arm=1.0)}), blows=blows),
    ):
        assert not list(speed_notices(tests, [SimpleNamespace(case=CASE, observed=other)]))
    assert not list(speed_notices(tests, [SimpleNamespace(case=load_case("li-ma-2019"), observed=run.observed)]))


def test_numbers_without_a_unit_have_one_in_documents_and_2000_draws_are_written(studied):
    """A restitution, known from a share; verdicts of runs by an older version are not known."""
    known = MeasuredNumber(LOSS, "", "", 0.7, 0.01, "0.7", of_field=True)
    study = studied(known, number("first.width"), free=(LOSS,))
    document = study.content()
    assert [one["unit"] for one in document["parameters"]] == ["1"]
    assert [one["unit"] for one in document["numbers"]] == ["1", "s"]
    assert study.columns()[1].values == ["1"]
    some = [replace(study.solved.misfits[0], share=share) for share in (0.01, 0.2, 0.1)]
    assert replace(study, solved=replace(study.solved, misfits=some)).highlights()[-1][1] == "20.00 %"
    indented = study.texts()["fit.json"].splitlines()[1]
    assert len(indented) - len(indented.lstrip()) == 2
    assert replace(study, verdicts=Verdicts((), "runs")).verdicts_of_measured() == ["", ""]
    assert replace(study, verdicts=Verdicts(["passed"], "runs")).verdicts_of_measured() == ["passed"] * 2
    drawn = replace(study, posterior=Posterior(np.linspace(0.0, 1.0, 2500)[:, None], 100, 1.0, 0.5, 1))
    (value,) = drawn.posterior_values()
    field = study.parameters[0].field
    assert (value.median, value.low, value.high) == pytest.approx((field.si(0.5), field.si(0.025), field.si(0.975)))
    told = drawn.content()["posterior"]
    assert (told["walkers"], told["steps"], told["independent_draws"], told["seed"]) == (32, 100, 3200.0, 20)
    assert (told["accepted"], told["autocorrelation_time"], told["too_short"]) == (0.5, 1.0, False)
    text = drawn.tables()["posterior.csv"]
    rows = [line for line in text.splitlines() if line[:1].isdigit()]
    assert len(rows) == 2000
    assert (float(rows[0].split(",")[0]), float(rows[-1].split(",")[0])) == (0.01, 1.0)


def test_residuals_are_written_in_the_unit_of_all_records_if_they_have_one(studied):
    study = studied(pulse(1.02, 0.01))
    (pair,) = study.pulses
    force = replace(pair[0], record=replace(pair[0].record, unit="N"))
    for pulses, unit in (((pair, pair), "m/s^2"), ((pair, (force, pair[1])), "")):
        text = replace(study, pulses=pulses).tables()["residuals.csv"]
        assert ("measured [m/s^2]" in text or "measured (m/s^2)" in text) == bool(unit)
    curve = study.preview()
    assert curve.y == pytest.approx((pair[1].computed - pair[1].measured) / 9.80665)


def test_a_band_ends_where_a_fortieth_of_the_draws_lies_beyond():
    """100 of 991 draws of the height, evenly apart, whose peaks are 14000 times the root of it; hardly any noise."""
    begun = problem(pulse(), free=(HEIGHT,))
    draws = np.linspace(0.49, 0.52, 991)[:, None]
    ((low, high),) = predictive_bands(SimpleNamespace(problem=begun), Posterior(draws, 100, 1.0, 0.5, 1), 6)
    at, width = int(np.argmax(high)), begun.fields[0].width
    ends = [14000.0 * np.exp(0.5 * width * (0.49 + 0.03 * share - 0.5)) for share in (0.025, 0.5, 0.975)]
    noise = 1.96 * 1.4
    assert low[at] == pytest.approx(ends[1] - np.hypot(ends[1] - ends[0], noise), abs=0.05)
    assert high[at] == pytest.approx(ends[1] + np.hypot(ends[2] - ends[1], noise), abs=0.05)
