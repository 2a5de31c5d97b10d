"""What is measured, and its residuals: numbers; which pulse of a record, its samples and noise, and a run laid on it."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from strikewave.analyses.compare.agreement import BESIDE, ComparedCurve
from strikewave.base.errors import InputError
from strikewave.signal.alignment import EvenHistory
from strikewave.signal.pulse import FOOT, Pulse
from strikewave.studies.fit.covariance import autocorrelation
from strikewave.studies.fit.measured import MeasuredNumber, MeasuredPulse, _finer, _window, measured_pulse

SAMPLES = 100
"""Of a half wave."""


def ringing(halves, growth):
    """Return half waves of alternating sign, each larger than the one before by a factor."""
    phase = np.arange(int(halves * SAMPLES) + 1) / SAMPLES
    values = np.sin(np.pi * phase) * growth ** np.floor(phase)
    return ComparedCurve("bar.csv", "record", EvenHistory(np.concatenate([np.zeros(SAMPLES), values]), 1e-6, 0.0), "N")


@given(st.integers(2, 8), st.floats(0.2, 0.8), st.floats(1.01, 1.2))
def test_of_growing_echoes_the_last_whole_one_is_taken(whole, cut, growth):
    """At 10 % of its peak a half wave is 2 asin(0.1)/pi of itself narrower; a straight line between samples is as good."""
    curve = ringing(whole + cut, growth)
    begin, end, edge = _window(curve)
    middle, width = (whole + 0.5) * SAMPLES * 1e-6, (1.0 - 2.0 * np.arcsin(0.1) / np.pi) * SAMPLES * 1e-6
    assert begin == pytest.approx(max(middle - (0.5 + BESIDE) * width, 0.0), abs=1e-8)
    assert end == pytest.approx(min(middle + (0.5 + BESIDE) * width, curve.history.end), abs=1e-8)
    assert edge < SAMPLES * 1e-6


def test_a_single_pulse_that_the_end_cuts_is_refused():
    with pytest.raises(InputError, match="no whole pulse"):
        _window(ringing(0.7, 1.0))


def bump(time, middle, width=20e-6):
    """Return a pulse without anything beyond a tenth of 1 MHz, which both a record and a run of 1 us hold to 1e-9."""
    return 900.0 * np.exp(-0.5 * ((time - middle) / width) ** 2)


def curve(values, step=1e-6, start=0.0, **more):
    return ComparedCurve("a.csv", "record", EvenHistory(np.asarray(values, dtype=float), step, start), "m/s^2", **more)


class Played:
    """A run that gives one history whatever its part, and numbers by name."""

    def __init__(self, history, **numbers):
        self.curve, self.numbers = replace(history, name="case:board@1"), numbers

    def history(self, part, blow=0, unit=""):
        return self.curve

    def number(self, name, sensor=""):
        return self.numbers.get(name)


@pytest.mark.parametrize("step", [1e-6, 0.25e-6, 0.1e-6])
@pytest.mark.parametrize("start", [-300e-6, 0.0])
def test_a_run_is_laid_on_a_record_to_a_ten_thousandth_of_a_sample(step, start):
    """A pulse without noise at 123.4 us of the record and 211.7 us of the run: shifted by -88.3 us, nothing is left.

    A spline of a pulse of 20 us through samples of 0.25 us errs by 3e-9 of the peak at most; the filter of a finer run
    by 1e-4.
    """
    record = curve(bump(np.arange(400) * 1e-6, 123.4e-6))
    time = start + np.arange(round(700e-6 / step)) * step
    run = Played(curve(bump(time, start + 411.7e-6), step, start))
    pulse = measured_pulse(record, run, "", 0, None)
    laid = pulse.laid(run)
    exact = step == 1e-6 or step == 0.25e-6
    assert laid.shift == pytest.approx(123.4e-6 - (start + 411.7e-6), abs=1e-10 if exact else 1e-9)
    assert laid.computed == pytest.approx(laid.measured, abs=900.0 * (1e-6 if exact else 1e-3))
    width = 2.0 * 20e-6 * np.sqrt(2.0 * np.log(10.0))  # at a tenth of the peak
    assert laid.time[0] == pytest.approx(123.4e-6 - width, abs=1.01e-6)
    assert laid.time[-1] == pytest.approx(123.4e-6 + width, abs=1.01e-6)
    assert laid.measured == pytest.approx(bump(laid.time, 123.4e-6), abs=1e-9)
    assert pulse.step == pytest.approx(1e-6)


def test_a_record_that_is_finer_than_the_run_is_taken_at_the_samples_of_the_run():
    """At 0.2 us and 1 us: from the first sample of the record on, with the filter's 1e-3 at most."""
    record = curve(bump(np.arange(2000) * 0.2e-6 + 5e-6, 123.4e-6), 0.2e-6, 5e-6)
    run = Played(curve(bump(np.arange(500) * 1e-6, 250e-6)))
    pulse = measured_pulse(record, run, "", 0, None)
    assert pulse.step == pytest.approx(1e-6)
    assert pulse.values == pytest.approx(bump(pulse.time, 123.4e-6), abs=0.9)
    assert np.remainder((pulse.time - 5e-6) / 1e-6 + 0.5, 1.0) == pytest.approx(np.full(pulse.time.size, 0.5), abs=1e-6)
    assert pulse.time[-1] == pytest.approx(123.4e-6 + 2.0 * 20e-6 * np.sqrt(2.0 * np.log(10.0)), abs=1.01e-6)


def test_a_long_pulse_is_taken_at_4000_samples():
    """Of 12 000 samples from begin to end the third of each, and a few less for the filter."""
    time = np.arange(30000) * 1e-7
    record = curve(bump(time, 1.5e-3, 300e-6), 1e-7)
    pulse = measured_pulse(record, Played(curve(bump(time, 1.5e-3, 300e-6), 1e-7)), "", 0, None)
    assert 3998 <= pulse.values.size <= 4001
    assert pulse.values == pytest.approx(bump(pulse.time, 1.5e-3, 300e-6), abs=1e-2)


def test_the_noise_of_a_record_is_that_of_the_quiet_before_its_pulse():
    """Its standard deviation over the samples a width before the pulse; white of so few; below 1e-4 of the peak it is that."""
    time, rng = np.arange(500) * 1e-6, np.random.default_rng(4)
    run = Played(curve(bump(time, 250e-6)))
    quiet = rng.standard_normal(500)
    width = 2.0 * 20e-6 * np.sqrt(2.0 * np.log(10.0))
    for size, known in ((9.0, True), (0.05, False)):
        pulse = measured_pulse(curve(bump(time, 250e-6) + size * quiet), run, "", 0, None, "shot", 0.03)
        count = np.count_nonzero(time < 250e-6 - 1.5 * width)
        if known:
            assert abs(pulse.quiet - count) <= 1
            assert pulse.deviation == pytest.approx(np.std(size * quiet[: pulse.quiet]), rel=1e-3)
            assert pulse.correlation.tolist() == autocorrelation(quiet[: pulse.quiet]).tolist()
        else:
            assert (pulse.quiet, pulse.correlation.tolist()) == (0, [1.0])
            assert pulse.deviation == pytest.approx(1e-4 * np.abs(pulse.values).max(), rel=1e-12)
        assert (pulse.shot, pulse.scatter, pulse.left) == ("shot", 0.03, 1.0)
        assert pulse.residuals(run) == pytest.approx((pulse.laid(run).computed - pulse.values) / pulse.deviation)
    early = np.arange(500) * 1e-6 + 1.5 * width + 31.5e-6 - 250e-6  # 31 samples before: too few
    pulse = measured_pulse(curve(bump(early, 0.0) + 9.0 * quiet), Played(curve(bump(early, 0.0))), "", 0, None)
    assert pulse.quiet == 0 or pulse.quiet >= 32


def test_what_residuals_share_is_the_error_of_a_median_and_the_scatter_of_the_amplitude():
    """A median of n quiet samples errs by sqrt(pi/2 memory/n) deviations; amplitude by its share of each value."""
    values = np.array([1.0, 4.0, 2.0])
    pulse = MeasuredPulse(
        curve(values), "", 0, np.arange(3.0), values, 0.4, 50, np.array([1.0, 0.4, 0.1]), None, "", 0.02, 3.0
    )
    assert pulse.shared == pytest.approx(np.full((3, 1), np.sqrt(np.pi / 2.0 * 2.0 / 50.0) / 3.0), rel=1e-12)
    assert pulse.stated[:, 0] == pytest.approx(0.02 * values / 1.2, rel=1e-12)
    assert replace(pulse, quiet=0).shared.tolist() == [[0.0]] * 3
    assert replace(pulse, scatter=0.0).stated.size == 0
    assert (
        replace(pulse, correlation=np.array([1.0, -0.9])).shared.tolist() == [[0.0]] * 3
    )  # a memory of less than none


def test_a_number_is_held_to_the_sign_that_was_measured():
    """-4 measured to 0.5, of a run that gives 5 of either sign: its size is above by 1, two uncertainties."""
    number = MeasuredNumber("first.peak", "", "N", -4.0, 0.5, "-4 N")
    for size in (5.0, -5.0):
        run = Played(curve(np.ones(3)), **{"first.peak": size})
        assert number.computed(run) == -5.0
        assert number.residuals(run).tolist() == [2.0]
        assert replace(number, left=4.0).residuals(run).tolist() == [0.5]
        assert replace(number, value=4.0).residuals(run).tolist() == [2.0]
    with pytest.raises(ValueError, match="has no first"):
        number.residuals(Played(curve(np.ones(3))))
    assert replace(number, sensor="top", setting="a=1").called == "first.peak top (a=1)"


def test_a_record_turned_round_is_refused_below_a_quarter_of_the_misfit():
    """A pulse of the other sign, whose misfit turned round is none."""
    time = np.arange(500) * 1e-6
    run = Played(curve(bump(time, 250e-6)))
    with pytest.raises(InputError, match="the other sign"):
        measured_pulse(curve(-bump(time, 250e-6)), run, "", 0, None)


@pytest.mark.parametrize("factor", [1.0, 3.0])
def test_what_a_coarser_record_cannot_hold_is_taken_off_a_run(factor):
    """A wave at 0.8 of the half rate of the samples is kept to 1 % or, at 1.25 of it, gone to 1 %."""
    own = 1e-6 / factor
    time = np.arange(round(600 * factor)) * own
    for share, kept in ((0.5, 1.0), (1.6, 0.0)):
        wave = np.cos(2.0 * np.pi * share * time / (2.0 * 4e-6))
        fine, step = _finer(EvenHistory(wave, own, 0.0), 4e-6)
        middle = slice(fine.size // 4, -fine.size // 4)
        assert step <= 1.0001e-6
        along = np.arange(fine.size) * step
        assert fine[middle] == pytest.approx(kept * np.cos(2.0 * np.pi * share * along / 8e-6)[middle], abs=0.02)


def test_a_run_is_made_finer_by_a_whole_number_up_to_a_quarter_of_a_sample():
    history = EvenHistory(bump(np.arange(200) * 1e-6, 100e-6), 1e-6, 0.0)
    for step, times in ((1e-6, 4), (2e-6, 2), (1.3e-6, 4), (4e-6, 1), (9e-6, 1)):
        fine, own = _finer(history, step)
        assert own == pytest.approx(1e-6 / times, rel=1e-12)
        assert fine.size == 199 * times + 1
        if step <= 2e-6:
            assert fine == pytest.approx(bump(np.arange(fine.size) * own, 100e-6), abs=1.0)


def test_of_a_record_that_begins_within_its_largest_pulse_the_next_is_taken():
    """A record cut at both ends within larger pulses: the whole one of 5 between them, down to a tenth of it."""
    wave = np.concatenate(
        [9.0 * np.sin(np.linspace(1.0, np.pi, 30)), np.zeros(11), 5.0 * np.sin(np.linspace(0.0, np.pi, 41))]
    )
    record = curve(np.concatenate([wave, np.zeros(11), -8.0 * np.sin(np.linspace(0.0, 2.0, 30))]))
    middle, width = 61.0, 40.0 * (1.0 - 2.0 * np.arcsin(0.1) / np.pi)
    begin, end, _ = _window(record)
    assert begin == pytest.approx((middle - (0.5 + BESIDE) * width) * 1e-6, abs=3e-9)
    assert end == pytest.approx((middle + (0.5 + BESIDE) * width) * 1e-6, abs=3e-9)
    small = replace(record, history=record.history._replace(values=1e-6 * record.history.values, start=0.7))
    assert _window(small)[:2] == pytest.approx((begin + 0.7, end + 0.7), abs=1e-12)  # whatever its unit and its clock
    with pytest.raises(InputError, match="no whole pulse"):
        _window(curve(9.0 * np.sin(np.linspace(1.0, 2.0, 30))))


def test_the_window_of_a_blow_is_its_width_and_half_of_it_and_its_quiet_ends_a_width_before():
    """Of a record whose pulse was measured at 60.4 us; another, larger but elsewhere, is not looked at."""
    time = np.arange(300) * 1e-6
    values = bump(time, 60e-6, 8e-6) + 3.0 * bump(time, 200e-6, 8e-6)
    found = Pulse(60.4e-6, 900.0, 0.0, 0.0, 0.0)
    width = 16e-6 * np.sqrt(2.0 * np.log(10.0))
    later = curve(values, start=7e-3, measured=found._replace(time=7e-3 + found.time))
    assert _window(later) == pytest.approx([7e-3 + one for one in _window(curve(values, measured=found))], abs=1e-12)
    begin, end, edge = _window(curve(values, measured=found))
    assert [begin, end, edge] == pytest.approx(
        [60e-6 - (0.5 + BESIDE) * width, 60e-6 + (0.5 + BESIDE) * width, 60e-6 - 1.5 * width], abs=1e-7
    )
    begin, end, edge = _window(curve(values))  # simulated: the largest, and what is quiet ends before the first
    assert begin == pytest.approx(200e-6 - (0.5 + BESIDE) * width, abs=1e-7)
    first = 60e-6 - 8e-6 * np.sqrt(2.0 * np.log(10.0 / 3.0))
    assert edge == pytest.approx(first - width, abs=1e-6)


def test_the_residual_of_a_field_has_its_sign_whatever_the_value():
    """Known as -4 to 0.5: at -5 it lies two below, a number of the run of that size two above."""
    field = MeasuredNumber("x", "", "N", -4.0, 0.5, "-4 N", of_field=True)
    run = Played(curve(np.ones(3)))
    run.case = SimpleNamespace(values=lambda: {"x": SimpleNamespace(si=-5.0)})
    assert field.residuals(run).tolist() == [-2.0]
    assert replace(field, left=4.0).residuals(run).tolist() == [-0.5]


@pytest.mark.parametrize(("before", "known"), [(31, False), (32, True)])
def test_the_noise_is_known_from_32_quiet_samples_on(before, known):
    """The quiet ends a width before the pulse begins, 1.5 widths before its middle."""
    width = 2.0 * 20e-6 * np.sqrt(2.0 * np.log(10.0))
    time = np.arange(500) * 1e-6
    middle = (before - 0.5) * 1e-6 + 1.5 * width
    values = 0.01 * bump(time, middle)
    noisy = values + 0.005 * (-1.0) ** np.arange(500)
    record = curve(noisy, measured=Pulse(middle, 9.0, 0.0, 0.0, 0.0))
    pulse = measured_pulse(record, Played(curve(values)), "", 0, None)
    assert pulse.quiet == (before if known else 0)
    assert pulse.deviation == pytest.approx(0.005 if known else 1e-4 * np.abs(pulse.values).max(), rel=1e-3)


@pytest.mark.parametrize(("share", "refused"), [(0.64, True), (0.68, False)])
def test_a_record_of_both_signs_has_the_other_one_where_that_leaves_less_than_a_quarter(share, refused):
    """A pulse downwards and a smaller one upwards after it: what is left of either sign at the best of 4400 shifts."""
    time = np.arange(600) * 1e-6
    record = curve(share * bump(time, 370e-6) - bump(time, 300e-6), measured=Pulse(300e-6, -900.0, 0.0, 0.0, 0.0))
    begin, end, _ = _window(record)
    kept = (time >= begin) & (time <= end)
    moved = bump(time[kept], np.arange(-200e-6, 900e-6, 0.25e-6)[:, None])
    own, turned = (np.min(np.sum((moved - sign * record.history.values[kept]) ** 2, axis=1)) for sign in (1.0, -1.0))
    assert turned / own == pytest.approx(0.25, abs=0.02)
    assert (turned < 0.25 * own) == refused
    run = Played(curve(bump(time, 400e-6)))
    if refused:
        with pytest.raises(InputError, match="the other sign"):
            measured_pulse(record, run, "", 0, None)
    else:
        assert measured_pulse(record, run, "", 0, None).values.size == np.count_nonzero(kept)


@pytest.mark.parametrize(("share", "taken_off"), [(0.9, True), (1.1, False)])
def test_a_run_begins_at_zero_where_what_it_begins_with_is_small(share, taken_off):
    """What it reads first, up to the foot of a pulse, is taken off it; what dies out in 10 us then stands below zero."""
    time = np.arange(500) * 1e-6
    first = share * FOOT * 900.0 * (1.0 + share * FOOT)
    run = Played(curve(bump(time, 250e-6) + first * np.exp(-time / 10e-6)))
    pulse = measured_pulse(curve(bump(time, 250e-6)), Played(curve(bump(time, 250e-6))), "", 0, None)
    assert pulse.laid(run).computed == pytest.approx(pulse.values - first * taken_off, abs=0.15)
    assert pulse.part == "board"
    run.curve = replace(run.curve, name="case:rigid")
    assert measured_pulse(curve(bump(time, 250e-6)), run, "", 0, None).part == "rigid"


def test_a_run_that_ends_early_is_held_as_it_ended():
    time = np.arange(500) * 1e-6
    pulse = measured_pulse(curve(bump(time, 250e-6)), Played(curve(bump(time, 250e-6))), "", 0, None)
    short = curve(bump(time[:271], 250e-6))  # at 0.61 of its peak
    laid = pulse.laid(Played(short))
    fine, _ = _finer(short.history, 1e-6)
    held = laid.computed[laid.time > 280e-6]
    assert held == pytest.approx(np.full(held.size, fine[-1]), rel=1e-12)
    assert replace(pulse, left=2.5).residuals(Played(short)) * 2.5 == pytest.approx(pulse.residuals(Played(short)))


def test_a_record_that_is_taken_more_coarsely_has_nothing_that_its_samples_cannot_hold():
    """At 0.2 us and 1 us: 1.3 MHz is gone, and of 1303 samples every fifth up to the last is taken; a little coarser too."""
    time = np.arange(1303) * 0.2e-6
    record = curve(bump(time, 200e-6) + 90.0 * np.cos(2.0 * np.pi * 1.3e6 * time), 0.2e-6)
    run = Played(curve(bump(np.arange(500) * 1e-6, 250e-6)))
    pulse = measured_pulse(record, run, "", 0, None)
    assert pulse.values[:-30] == pytest.approx(bump(pulse.time, 200e-6)[:-30], abs=2.0)
    assert pulse.time[-1] == pytest.approx(260e-6, abs=1e-12)
    step = 1.005e-6
    slow = Played(curve(bump(np.arange(500) * step, 250e-6), step))
    pulse = measured_pulse(curve(bump(np.arange(500) * 1e-6, 250e-6)), slow, "", 0, None)
    assert pulse.step == pytest.approx(step, rel=1e-9)


@pytest.mark.parametrize(
    ("first", "second", "taken"), [(1.03, 0.98, 1), (0.98, 1.03, 0), (1.02, 0.97, 0), (0.97, 1.02, 1)]
)
def test_of_two_pulses_of_a_run_the_one_that_leaves_less_is_laid_on_the_record(first, second, taken):
    """2 or 3 % too high or too low: the sum of squares goes with the square of that; middles at 150.4 and 550.4 us."""
    time = np.arange(700) * 1e-6
    record = curve(bump(time, 300e-6))
    pulse = measured_pulse(record, Played(record), "", 0, None)
    run = Played(curve(first * bump(time, 150.4e-6) + second * bump(time, 550.4e-6)))
    laid = pulse.laid(run)
    assert laid.shift == pytest.approx(300e-6 - (150.4e-6, 550.4e-6)[taken], abs=1e-9)
    assert laid.computed == pytest.approx((first, second)[taken] * laid.measured, abs=0.5)
