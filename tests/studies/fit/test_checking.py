"""What was kept out of a fit and predicted: figures of records and numbers, their doubts, and what bands hold."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import t

from strikewave.analyses.compare.agreement import ComparedCurve
from strikewave.signal.alignment import EvenHistory
from strikewave.signal.filters import Filter
from strikewave.studies.fit.checking import (
    Checks,
    PredictedFigure,
    _as_sampled,
    _computed,
    _figures,
    _left_over,
    check,
    names_of,
)
from strikewave.studies.fit.covariance import Excess
from strikewave.studies.fit.free_fields import free_fields
from strikewave.studies.fit.problem import Experiment, Problem, solve

from .closed_runs import CASE, FORCE, Closed, number, problem, pulse

AREA = 14000.0 * 20e-6 * math.sqrt(2.0 * math.pi) * math.erf(math.sqrt(math.log(50.0)))
"""Of the pulse of the case as it stands, between its feet at 2 %, m/s."""


def of_record(one, **more):
    return replace(one, record=replace(one.record, **more))


def test_a_record_tells_peak_width_and_area_with_its_doubts_and_the_scatter_of_its_amplitude():
    """30 m/s2 and 2 % of 14700, 2 us, and 2 % of an area whose own doubt is not known; a force has an impulse."""
    one = of_record(
        pulse(1.05, scatter=0.02), uncertainty={"peak": 30.0, "width": 2e-6, "integral": np.nan}, unit="m/s^2"
    )
    peak, width, change = _figures(one)
    assert peak == ("peak", "m/s^2", 14700.0, pytest.approx(np.hypot(30.0, 294.0)))
    assert width == ("width", "s", 8.5e-5, 2e-6)
    assert change == ("velocity change", "m/s", pytest.approx(0.735), pytest.approx(0.0147))
    low = of_record(one, measured=one.record.measured._replace(peak=-14700.0), unit="N")
    assert [row[:2] for row in _figures(low)] == [("peak", "N"), ("width", "s"), ("impulse", "N s")]
    assert _figures(low)[0][2:] == (-14700.0, peak[3])
    assert [row[:2] for row in _figures(of_record(one, unit="m"))] == [("peak", "m"), ("width", "s")]
    assert names_of("N") == [("peak", "peak"), ("width", "width"), ("impulse", "area")]
    assert _figures(number("first.width", setting="x")) == [("first.width (x)", "s", 5e-4, 5e-6)]


def test_a_run_gives_the_figures_of_a_record_as_its_samples_and_its_filter_would():
    """A pulse of 20 us: 2 sqrt(2 ln 10) of that wide at a tenth, its area that above its foot; none is finer than the record."""
    run, one = Closed(CASE), pulse()
    wanted = [14000.0, 2.0 * 20e-6 * np.sqrt(2.0 * np.log(10.0)), AREA]
    assert _computed(one, run) == pytest.approx(wanted, rel=2e-3)
    lower = _computed(replace(one, low_pass=Filter(10e3)), run)
    assert lower[0] < 0.9 * wanted[0]
    assert lower[2] == pytest.approx(wanted[2], rel=5e-2)  # a low-pass leaves the area, and swings below it
    curve = run.history("")
    assert _as_sampled(curve, one) is curve
    coarse = replace(one, record=ComparedCurve("a", "record", EvenHistory(np.zeros(9), 4e-6, 0.0), "m/s^2"))
    limited = _as_sampled(curve, coarse)
    assert limited is not curve
    assert limited.history.step == pytest.approx(1e-6)
    assert limited.history.values.max() == pytest.approx(14000.0, rel=1e-3)
    assert _computed(number("first.width"), run) == [5e-4]


def test_figures_of_records_and_numbers_that_were_kept_out_stand_in_their_order():
    """The area of the pulse does not go with the force: its band has the scatter of the record alone, 1.96 times 3 %."""
    solved = solve(problem(number("first.rigid_peak")))
    kept = [
        Experiment(CASE, (), (number("first.width", 0.25, 0.005), pulse(1.05, scatter=0.03))),
        Experiment(CASE, ("x",), (number("first.rigid_peak", -0.2, 0.005, setting="x"),)),
    ]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("strikewave.studies.fit.checking.Problem", lambda tests, fields: Problem(tests, fields, Closed))
        found = check(solved, kept)
    names = ["first.width", "peak", "width", "velocity change", "first.rigid_peak (x)"]
    assert [one.figure for one in found.figures] == names
    assert [one.record for one in found.figures] == ["first.width", "a.csv", "a.csv", "a.csv", "first.rigid_peak (x)"]
    measured = [6.25e-4, 14700.0, 8.5e-5, 0.735, 11200.0]
    assert [one.measured for one in found.figures] == pytest.approx(measured)
    predicted = [5e-4, 14000.0, 8.584e-5, AREA, 14000.0]
    assert [one.predicted for one in found.figures] == pytest.approx(predicted, rel=2e-3)
    change = found.figures[3]
    assert (change.high - change.low) / 2.0 == pytest.approx(1.96 * 0.03 * change.predicted, rel=1e-3)
    peak = found.figures[1]
    assert (peak.high - peak.low) / 2.0 == pytest.approx(14000.0 * 1.96 * np.hypot(0.01, 0.03), rel=0.05)
    ((name, agreed),) = found.agreements
    assert name == "a.csv"
    assert agreed.rms == pytest.approx(0.05 / 1.05, rel=0.5)


def test_what_figures_of_a_fit_were_off_is_their_root_mean_square_by_student_s_t():
    """Two records 3 % below and above the run, two numbers 10 % off: t of two degrees; of other numbers what they lack."""
    measured = (
        pulse(0.97),
        pulse(1.03, name="b.csv"),
        number("first.rigid_peak", 0.1, 0.1),
        number("first.rigid_peak", -0.1, 0.1, setting="x"),
        number("first.width", 0.5, 0.2),
    )
    fields = free_fields(CASE, [FORCE])
    reach = {count: t.ppf(0.975, count) for count in (1, 2, 5)}

    def off(*shares):
        return np.sqrt(np.mean([(1.0 / one - 1.0) ** 2 for one in shares]))

    for excess, peak, width in (
        (Excess(), reach[2] * off(1.1, 0.9), reach[1] * off(1.5)),
        (Excess(3.0, 4.0, 5.0), reach[5] * 0.5, reach[1] * off(1.5)),  # five times a tenth; a fifth is less here
        (Excess(3.0, 0.0, 5.0), reach[2] * off(1.1, 0.9), reach[1] * off(1.5)),  # repeats alone
    ):
        one = Problem([Experiment(CASE, (), measured)], fields, Closed, excess)
        found = _left_over(one, one.start)
        assert found["peak"] == pytest.approx(reach[2] * off(0.97, 1.03), rel=1e-3)
        assert found["first.rigid_peak "] == pytest.approx(peak, rel=1e-9)
        assert found["first.width "] == pytest.approx(width, rel=1e-9)
        assert set(found) == {"peak", "width", "velocity change", "first.rigid_peak ", "first.width "}


def test_bands_hold_what_lies_at_their_ends_and_biases_are_means_by_figure():
    def one(name, measured, predicted):
        return PredictedFigure("a", name, "s", measured, predicted, 2.0, 3.0)

    figures = (one("peak", 2.0, 3.0), one("width", 3.0, 2.4), one("peak", 4.0, 3.0), one("peak", 1.9, 1.9))
    found = Checks(figures, ())
    assert [each.inside for each in figures] == [True, True, False, False]
    assert found.inside == 2
    assert found.biases == {"peak": pytest.approx((0.5 - 0.25 + 0.0) / 3.0), "width": pytest.approx(-0.2)}
