"""The judge against a second one that shares nothing with it; uncertainty, health, filter, strictness."""

import functools
import math
from dataclasses import replace

import numpy as np
import pytest

from strikewave.signal.filters import Filter
from strikewave.specifications.ideal_pulses import IdealPulse, PulseBand
from strikewave.specifications.judging import (
    Clause,
    DecibelBand,
    Limits,
    MeasuredFigure,
    PulseLimits,
    Shock,
    ShockVerdict,
    SpectrumLimits,
    area_between,
    decide,
    judge_shock,
    judge_spectrum,
    judged,
    not_judged,
    refused,
    weakest,
    worst_clauses,
)
from strikewave.specifications.reading import load_specification


@functools.cache
def second_band(peak, duration):
    """The band as smallest and largest values of a comb of moved half-sines."""
    fine = np.linspace(-0.4 * duration, 2.0 * duration, 601)
    near = (fine[:, None] + np.linspace(-0.1, 0.1, 101) * duration) / duration
    hull = np.where((near >= 0.0) & (near <= 1.0), peak * np.sin(np.pi * near), 0.0)
    return fine, hull.min(axis=1) - 0.2 * peak, hull.max(axis=1) + 0.2 * peak


def second_judge(values, step, peak, duration):
    """MIL-STD-810H half-sine, written apart: peak, T10, velocity change and band; each with its margin as a share."""
    time = [k * step for k in range(len(values))]
    top = max(range(len(values)), key=lambda k: values[k])
    a, b, c = values[top - 1 : top + 2]
    height = b - (a - c) ** 2 / (8.0 * (a - 2.0 * b + c))
    level = 0.1 * height
    left = next(k for k in range(top, -1, -1) if values[k] <= level)
    right = next(k for k in range(top, len(values)) if values[k] <= level)
    first = time[left] + step * (level - values[left]) / (values[left + 1] - values[left])
    last = time[right] - step * (level - values[right]) / (values[right - 1] - values[right])

    fine, lower, upper = second_band(peak, duration)
    middle = 0.5 * (first + last) - 0.5 * duration

    def inside(start):
        record = np.interp(fine + start, time, values)
        return min((upper - record).min(), (record - lower).min())

    rough = max((middle + x * duration for x in np.linspace(-0.5, 0.5, 201)), key=inside)
    distance = max(inside(rough + x * duration) for x in np.linspace(-5e-3, 5e-3, 41))
    figures = {
        "peak": (height / peak - 1.0) / 0.2,
        "pulse width at 10 %": ((last - first) / (0.93623 * duration) - 1.0) / 0.1,
    }
    margins = {name: 1.0 - abs(share) for name, share in figures.items()}
    margins["band"] = distance / (0.2 * peak)
    return margins


def random_pulse(random):
    """Return samples of a pulse near the limits: another peak, duration and power, a ringing, an undershoot."""
    step = 1.0e-5
    time = np.arange(800) * step
    duration = 1e-3 * random.uniform(0.85, 1.15)
    share = (time - 3e-3 - random.uniform(0.0, step)) / duration
    power = random.uniform(0.8, 1.3)
    pulse = np.where((share > 0) & (share < 1), np.sin(np.pi * np.clip(share, 0, 1)) ** power, 0.0)
    swing = (
        random.uniform(0.0, 0.25) * np.sin(2 * np.pi * share * random.uniform(0.7, 3.0)) * np.exp(-share) * (share > 1)
    )
    return 1000.0 * random.uniform(0.75, 1.25) * (pulse + swing), step


def test_a_width_at_another_share_than_a_tenth_has_no_known_uncertainty():
    """It is known at 10 % alone: a guarded decision at half the peak states nothing, simple acceptance does."""
    limits = PulseLimits(PULSE, "quoted", level=0.5, width=Limits(0.0, 1.0, "quoted"))
    shock = shock_of(1000.0, figures={"peak": MeasuredFigure(1000.0, 1.0), "width": MeasuredFigure(1e-3, 1e-6)})
    assert only(shock, limits).verdict == "pass"
    guarded = only(shock, limits, rule="guarded")
    assert (guarded.verdict, guarded.reason) == ("cannot-tell", "its uncertainty is not known")


@pytest.mark.verify
def test_500_random_pulses_have_the_verdicts_of_a_second_judge():
    """Margins within rounding of a limit are left out: the second judge compares 600 times, to 2.5e-4 D."""
    random = np.random.default_rng(20261124)
    pulse = IdealPulse("half-sine", 1000.0, 1e-3)
    limits = load_specification("mil-std-810h:ground").pulse_limits()
    scale = 1000.0 / limits.pulse.peak
    limits = PulseLimits(
        pulse,
        "quoted",
        peak=Limits(limits.peak.low * scale, limits.peak.high * scale, "quoted"),
        width=Limits(0.9 * pulse.width(0.1), 1.1 * pulse.width(0.1), "quoted"),
        band=type(limits.band)(pulse, limits.band.time, limits.band.amplitude),
        band_status="quoted",
    )
    counted = {"pass": 0, "fail": 0}
    close = 0
    for _ in range(500):
        values, step = random_pulse(random)
        found = judge_shock(Shock(values, step, 0.0, int(np.argmax(values))), limits)
        other = second_judge(values, step, 1000.0, 1e-3)
        for clause in found.clauses:
            if abs(other[clause.clause]) < 0.01:
                close += 1
                continue
            assert clause.verdict == ("pass" if other[clause.clause] > 0.0 else "fail"), (clause, other)
            counted[clause.verdict] += 1
    assert min(counted.values()) > 200
    assert close < 60


PULSE = IdealPulse("half-sine", 1000.0, 1e-3)
PEAK = PulseLimits(PULSE, "quoted", peak=Limits(800.0, 1200.0, "quoted"))


def shock_of(peak, **more):
    values = PULSE.at(np.arange(6000) * 1e-6 - 2e-3) * peak / 1000.0
    return Shock(values, 1e-6, 0.0, int(np.argmax(values)), **more)


def only(shock, limits, **how):
    [clause] = judge_shock(shock, limits, **how).clauses
    return clause


def test_guarded_decisions_leave_the_expanded_uncertainty_on_both_sides_of_a_limit():
    """JCGM 106, 8.3: with U = 5 % of 1150, 57.5, the guard band reaches from 1142.5 to 1257.5."""
    verdicts = {
        peak: only(shock_of(peak, uncertainty=0.05), PEAK, rule="guarded").verdict for peak in (1140, 1150, 1250, 1270)
    }
    assert verdicts == {1140: "pass", 1150: "cannot-tell", 1250: "cannot-tell", 1270: "fail"}
    assert only(shock_of(1150, uncertainty=0.05), PEAK).verdict == "pass"  # simple acceptance
    assert decide(math.nan, 1.0, "guarded") == "cannot-tell"


def test_standard_uncertainty_of_a_figure_counts_twice():
    figures = {"peak": MeasuredFigure(1180.0, 15.0)}
    clause = only(shock_of(1180.0, figures=figures), PEAK, rule="guarded")
    assert (clause.uncertainty, clause.verdict) == (pytest.approx(30.0), "cannot-tell")


def test_a_filter_that_may_have_taken_the_difference_leaves_the_peak_open():
    """1150 behind a filter that leaves 95 % was up to 1211; 1000 was up to 1053, and 700 up to 737."""
    found = {peak: only(shock_of(peak, filter_left=0.95), PEAK).verdict for peak in (1000.0, 1150.0, 700.0, 790.0)}
    assert found == {1000.0: "pass", 1150.0: "cannot-tell", 700.0: "fail", 790.0: "cannot-tell"}


def test_what_harms_a_figure_leaves_its_clause_open():
    shock = shock_of(1000.0, troubles={"peak": "clipped at 1000 m/s2"})
    assert only(shock, PEAK).reason == "clipped at 1000 m/s2"
    assert only(shock, PEAK).verdict == "cannot-tell"


def test_demands_on_sampling_and_filter_qualify_nothing_where_they_are_not_met():
    limits = PulseLimits(PULSE, "quoted", rate=Limits(2e6, math.inf, "quoted"), cutoff=Limits(1e4, math.inf, "quoted"))
    clauses = judge_shock(shock_of(1000.0, filter_cutoff=5e3), limits).clauses
    assert [(c.clause, c.verdict) for c in clauses] == [("sampling rate", "cannot-tell"), ("filter", "cannot-tell")]
    few = PulseLimits(PULSE, "quoted", peak=PEAK.peak)
    coarse = Shock(PULSE.at(np.arange(60) * 1.2e-4 - 2e-3), 1.2e-4, 0.0, 20)
    assert only(coarse, few).reason == "8.3 samples a pulse; it takes 10"
    area = PulseLimits(PULSE, "quoted", velocity_change=Limits(0.0, 1.0, "quoted"))
    assert only(coarse, area).verdict == "cannot-tell"


def test_cross_axis_is_the_largest_value_to_either_side_while_the_pulse_lasts():
    limits = PulseLimits(PULSE, "quoted", cross_axis=Limits(-math.inf, 300.0, "quoted"))
    assert only(shock_of(1000.0), limits).verdict == "not-judged"
    across = np.zeros(6000)
    across[2500], across[5000] = -310.0, 900.0  # the second one after the pulse
    clause = only(shock_of(1000.0, cross_axis={"y": across}), limits)
    assert (clause.value, clause.verdict) == (310.0, "fail")


def test_strict_states_nothing_by_indicative_limits():
    limits = PulseLimits(PULSE, "quoted", peak=Limits(800.0, 900.0, "indicative"))
    assert only(shock_of(1000.0), limits).verdict == "fail"
    refused = only(shock_of(1000.0), limits, strict=True)
    assert (refused.verdict, refused.reason) == ("cannot-tell", "its limit is indicative (--strict)")
    assert only(shock_of(1000.0), PEAK, strict=True).verdict == "pass"


def test_the_worst_of_several_shocks_is_the_failed_one_then_the_least_margin():
    verdicts = [judge_shock(shock_of(peak), PEAK) for peak in (1000.0, 1190.0, 1100.0)]
    assert [(c.clause, place) for c, place in worst_clauses(verdicts)] == [("peak", 1)]
    verdicts.append(judge_shock(shock_of(700.0), PEAK))
    assert worst_clauses(verdicts)[0][1] == 3


def test_the_sawtooth_is_placed_by_its_tip_and_its_own_band_contains_it():
    pulse = IdealPulse("sawtooth", 400.0, 11e-3)
    values = pulse.at(np.arange(6000) * 1e-5 - 20e-3)
    shock = Shock(values, 1e-5, 0.0, int(np.argmax(values)))
    limits = PulseLimits(pulse, "quoted", band=PulseBand(pulse, 0.05, 0.15, 0.05, 0.3), band_status="quoted")
    found = judge_shock(shock, limits)
    assert found.start == pytest.approx(20e-3, abs=0.05 * 11e-3)
    assert found.verdict == "pass"


SPECTRUM = SpectrumLimits(
    (10.0, 100.0, 1000.0),
    (10.0, 100.0, 100.0),
    "quoted",
    10.0,
    "absolute",
    "maximax",
    12.0,
    (DecibelBand(10.0, 100.0, -6.0, 6.0, "quoted"), DecibelBand(100.0, 1000.0, -6.0, 9.0, "quoted")),
    Limits(0.9, math.inf, "quoted"),
    Limits(0.5, math.inf, "quoted"),
)


def test_spectrum_touches_its_tolerance_from_inside_and_outside():
    f = SPECTRUM.grid()
    nominal = SPECTRUM.nominal(f)
    assert f[0] == 10.0
    assert f[-1] == pytest.approx(1000.0)
    for decibels, passes in ((5.99, True), (-5.99, True), (-6.01, False)):
        share = judge_spectrum(f, nominal * 10 ** (decibels / 20), SPECTRUM)[0]
        assert share.verdict == ("pass" if passes else "fail")
    between = judge_spectrum(f, nominal * 10 ** (7.5 / 20), SPECTRUM)[0]  # above 6 dB below 100 Hz, below 9 dB above it
    assert between.value == pytest.approx(np.mean(f >= 100.0 * (1 - 1e-9)))
    assert "1.5 dB above the tolerance" in between.reason


def test_half_of_the_spectrum_must_reach_nominal_and_uncertainty_may_hide_it():
    f = SPECTRUM.grid()
    nominal = SPECTRUM.nominal(f)
    assert [c.verdict for c in judge_spectrum(f, 0.98 * nominal, SPECTRUM)] == ["pass", "fail"]
    guarded = judge_spectrum(f, 0.98 * nominal, SPECTRUM, 0.05, "guarded")
    assert [c.verdict for c in guarded] == ["pass", "cannot-tell"]
    assert [c.verdict for c in judge_spectrum(f, nominal, SPECTRUM, trouble="clipped")] == ["cannot-tell"] * 2


def test_a_spectrum_that_its_uncertainty_may_move_into_its_tolerance_has_not_failed():
    """Within 1 dB of nominal, 20 % too low: moved up by half it is too high, but by a quarter it is nominal."""
    bands = (DecibelBand(10.0, 1000.0, -1.0, 1.0, "quoted"),)
    limits = SPECTRUM.__class__(
        SPECTRUM.frequency, SPECTRUM.level, "quoted", 10.0, "absolute", "maximax", 12.0, bands, SPECTRUM.share
    )
    f = limits.grid()
    low = 0.8 * limits.nominal(f)
    found = [judge_spectrum(f, low, limits, doubt, "guarded")[0].verdict for doubt in (0.0, 0.05, 0.5)]
    assert found == ["fail", "fail", "cannot-tell"]


def test_a_spectrum_that_fails_somewhere_within_its_uncertainty_has_not_passed():
    """A tenth may lie outside. At 1.02 two tenths do; as measured, and 5 % up and down, it is one."""
    bands = (DecibelBand(10.0, 1000.0, -6.0, 6.0, "quoted"),)
    limits = SPECTRUM.__class__(
        SPECTRUM.frequency, SPECTRUM.level, "quoted", 10.0, "absolute", "maximax", 12.0, bands, SPECTRUM.share
    )
    f, edge = limits.grid(), 10.0 ** (6.0 / 20.0)
    share = np.ones(f.size)
    few = f.size // 10
    share[:few], share[few : 2 * few] = edge / 1.01, 1.0 / (1.03 * edge)  # within up to 1.01, and from 1.03 on
    values = share * limits.nominal(f)
    assert [judge_spectrum(f, x * values, limits)[0].verdict for x in (1.0, 1.05, 1.02)] == ["pass", "pass", "fail"]
    assert judge_spectrum(f, values, limits, 0.05, "guarded")[0].verdict == "cannot-tell"


def test_a_spectrum_without_tolerance_or_without_values_is_not_told():
    bands = (DecibelBand(2000.0, 9000.0, -6.0, 6.0, "quoted"),)
    limits = SPECTRUM.__class__(
        SPECTRUM.frequency, SPECTRUM.level, "quoted", 10.0, "absolute", "maximax", 12.0, bands, SPECTRUM.share
    )
    f = limits.grid()
    assert judge_spectrum(f, limits.nominal(f), limits)[0].verdict == "cannot-tell"
    assert {c.verdict for c in judge_spectrum(f, np.full(f.size, math.nan), SPECTRUM)} == {"cannot-tell"}


def test_an_ideal_pulse_behind_a_filter_does_not_fail_its_band():
    limits = PulseLimits(PULSE, "quoted", band=PulseBand(PULSE, 0.1, 0.2), band_status="quoted")
    filter_ = Filter(500.0)
    values = filter_.apply(PULSE.at(np.arange(6000) * 1e-6 - 2e-3), 1e-6)
    left = float(values.max()) / 1000.0
    assert left < 0.7
    shock = Shock(values, 1e-6, 0.0, int(np.argmax(values)))
    assert only(shock, limits).verdict == "fail"
    behind = only(Shock(values, 1e-6, 0.0, int(np.argmax(values)), filter_left=left), limits)
    assert (behind.verdict, "the filter leaves" in behind.reason) == ("cannot-tell", True)


def test_guarded_decisions_state_nothing_where_the_uncertainty_is_not_known():
    shock = shock_of(1000.0, figures={"peak": MeasuredFigure(1000.0, math.nan)})
    clause = only(shock, PEAK, rule="guarded")
    assert (clause.verdict, clause.reason) == ("cannot-tell", "its uncertainty is not known")
    stated = shock_of(1000.0, figures=shock.figures, uncertainty=0.05)
    assert only(stated, PEAK, rule="guarded").verdict == "pass"
    assert only(shock, PEAK).verdict == "pass"


def test_a_guarded_width_at_another_level_is_not_stated_for_a_record_whose_width_there_has_no_uncertainty():
    width = PULSE.width(0.5)
    limits = PulseLimits(PULSE, "quoted", level=0.5, width=Limits(0.9 * width, 1.1 * width, "quoted"))
    shock = shock_of(1000.0, figures={"width": MeasuredFigure(PULSE.width(0.1), 1e-9)})
    clause = only(shock, limits, rule="guarded")
    assert (clause.verdict, clause.reason) == ("cannot-tell", "its uncertainty is not known")
    assert only(shock, limits).verdict == "pass"
    assert only(shock_of(1000.0), limits, rule="guarded").verdict == "pass"  # simulated: nothing was measured


def test_a_guarded_cross_axis_clause_leaves_twice_the_noise_of_its_channels():
    limits = PulseLimits(PULSE, "quoted", cross_axis=Limits(-math.inf, 200.0, "quoted"))
    shock = replace(shock_of(1000.0), cross_axis_noise=5.0)
    across = {size: {"y": size / 1000.0 * shock.values} for size in (185.0, 195.0, 205.0, 215.0)}
    verdicts = [only(replace(shock, cross_axis=one), limits, rule="guarded").verdict for one in across.values()]
    assert verdicts == ["pass", "cannot-tell", "cannot-tell", "fail"]


def test_a_guarded_band_needs_room_for_what_the_filter_takes_and_for_the_uncertainty():
    """200 of room: the filter takes 190 at most, the guard band is 100."""
    limits = PulseLimits(PULSE, "quoted", band=PulseBand(PULSE, 0.1, 0.2), band_status="quoted")
    shock = shock_of(1000.0, filter_left=1.0 / 1.19, uncertainty=0.1)
    assert only(shock, limits).verdict == "pass"
    assert only(shock, limits, rule="guarded").verdict == "cannot-tell"
    assert only(shock_of(1000.0, uncertainty=0.1), limits, rule="guarded").verdict == "pass"


def test_a_cross_axis_channel_without_numbers_or_of_some_shocks_alone_is_no_pass():
    limits = PulseLimits(PULSE, "quoted", cross_axis=Limits(-math.inf, 300.0, "quoted"))
    quiet = shock_of(1000.0, cross_axis={"y": np.zeros(6000)})
    lacking = shock_of(1000.0, cross_axis={"y": np.zeros(6000), "z": np.full(6000, math.nan)})
    assert [only(shock, limits).verdict for shock in (quiet, lacking)] == ["pass", "cannot-tell"]
    verdicts = [judge_shock(shock, limits) for shock in (quiet, shock_of(1000.0))]
    assert [(clause.verdict, place) for clause, place in worst_clauses(verdicts)] == [("not-judged", 1)]


@pytest.mark.parametrize(
    ("low", "high", "value", "share"),
    [
        (2.0, 6.0, 3.0, 0.5),
        (2.0, 6.0, 7.0, -0.5),
        (-math.inf, 4.0, 3.0, 0.25),
        (4.0, math.inf, 5.0, 0.25),
        (0.0, math.inf, 5.0, math.nan),
        (0.0, 0.002, 0.0005, 0.5),
    ],
)
def test_the_share_of_a_margin_is_of_half_the_tolerance_or_of_the_one_limit(low, high, value, share):
    assert judged("x", value, Limits(low, high, "quoted"), "1").share == pytest.approx(share, nan_ok=True)


@pytest.mark.parametrize(
    ("value", "low", "high", "verdict"),
    [
        (1.0 + 0.9e-9, 0.0, 1.0, "pass"),
        (1.0 + 1.1e-9, 0.0, 1.0, "fail"),
        (1.0 - 0.9e-9, 1.0, 2.0, "pass"),
        (1.0 - 1.1e-9, 1.0, 2.0, "fail"),
        (0.9e-9, -1.0, 0.0, "pass"),  # of the larger of value and lower limit
        (1e-13, -math.inf, 0.0, "fail"),
    ],
)
def test_a_value_may_miss_its_limit_by_1e_9_of_itself_for_rounding(value, low, high, verdict):
    assert judged("x", value, Limits(low, high, "quoted"), "1").verdict == verdict


def test_rounding_gives_nothing_inside_a_guard_band():
    assert (
        judged("x", 1000.0, Limits(999.995, math.inf, "quoted"), "1", 0.005 + 1e-9, "guarded").verdict == "cannot-tell"
    )


def test_a_clause_says_why_nothing_is_stated():
    limits = Limits(0.0, 1.0, "quoted")
    reasons = [
        judged("x", 0.9, limits, "1", 0.2, "guarded"),
        judged("x", math.nan, limits, "1", 0.2, "guarded"),
        judged("x", 0.9, limits, "1", math.nan, "guarded"),
        judged("x", math.nan, limits, "1", math.nan, "guarded"),
        judged("x", 2.0, limits, "1", 0.0, "simple", "clipped"),
        judged("x", 0.9, limits, "1"),
        judged("x", 1.9, limits, "1"),
    ]
    assert [one.reason for one in reasons] == [
        "the uncertainty reaches over the limit",
        "it could not be measured",
        "its uncertainty is not known",
        "it could not be measured",
        "clipped",
        "",
        "",
    ]


def test_the_weakest_status_is_the_one_that_is_known_least():
    assert [weakest("normative", "quoted"), weakest("quoted", "indicative", "normative")] == ["quoted", "indicative"]


def test_clauses_of_nothing_are_neither_refused_nor_judged():
    one = not_judged("directions", Limits(1.0, 2.0, "indicative"), "1", "not stated")
    assert refused(one) is one
    assert (one.low, one.high, one.verdict) == (1.0, 2.0, "not-judged")


@pytest.mark.parametrize("shape", ["half-sine", "sawtooth", "trapezoid"])
@pytest.mark.parametrize("level", [0.1, 0.5])
def test_the_ideal_pulse_begins_where_it_was_put_and_has_its_width(shape, level):
    """Crossings lie within a step, 5e-4 of the duration, of those of the ideal pulse."""
    pulse = IdealPulse(shape, 300.0, 2e-3, 0.15, 0.35)
    step, begin = 1e-6, 0.7
    values = pulse.at(np.arange(5000) * step - 1.2e-3)
    limits = PulseLimits(pulse, "quoted", level=level, width=Limits(0.0, 1.0, "quoted"))
    figures = {"peak": MeasuredFigure(300.0)}
    found = judge_shock(Shock(values, step, begin, int(values.argmax()), figures), limits)
    assert found.start == pytest.approx(begin + 1.2e-3, abs=step)
    assert found.clauses[0].value == pytest.approx(pulse.width(level), abs=step)


@pytest.mark.parametrize(("kept", "at"), [(slice(1900, None), 60), (slice(None, 2100), 1900)])
def test_a_pulse_that_is_cut_begins_by_its_peak(kept, at):
    """The middle of the top of a trapezoid is at (rise + 1 - fall) / 2 = 0.4 durations."""
    pulse = IdealPulse("trapezoid", 300.0, 2e-3, 0.15, 0.35)
    values = pulse.at(np.arange(5000) * 1e-6 - 1.2e-3)[kept]
    found = judge_shock(Shock(values, 1e-6, 0.5, at), PulseLimits(pulse, "quoted", width=Limits(0.0, 1.0, "quoted")))
    assert found.start == pytest.approx(0.5 + at * 1e-6 - 0.8e-3, abs=1e-12)
    assert found.clauses[0].reason == "it could not be measured"


def test_a_measured_width_at_a_tenth_stands_in_place_of_that_of_the_samples():
    limits = PulseLimits(PULSE, "quoted", width=Limits(0.0, 1.0, "quoted"))
    clause = only(shock_of(1000.0, figures={"width": MeasuredFigure(5e-4, 1e-5)}), limits)
    assert (clause.clause, clause.value, clause.uncertainty) == ("pulse width at 10 %", 5e-4, 2e-5)


def test_ten_samples_a_pulse_are_enough_and_a_tenth_of_the_peak_may_be_filtered_away():
    pulse = IdealPulse("half-sine", 1000.0, 1.0)
    limits = PulseLimits(pulse, "quoted", width=Limits(0.0, 9.0, "quoted"))
    shock = Shock(pulse.at(np.arange(40) * 0.1 - 1.0), 0.1, 0.0, 15)
    assert only(shock, limits).verdict == "pass"
    assert only(replace(shock, filter_left=0.9), limits).verdict == "pass"
    assert (
        only(replace(shock, filter_left=0.895), limits).reason
        == "the filter leaves 90 % of the peak of the ideal pulse"
    )


@pytest.mark.parametrize(
    ("figure", "share", "expanded"),
    [
        (MeasuredFigure(1000.0, 15.0), 0.04, 50.0),  # 2 * 15 and 40: 3, 4, 5
        (MeasuredFigure(1000.0, 15.0), 0.0, 30.0),
        (MeasuredFigure(1000.0, 15.0, whole=True), 0.04, 30.0),
        (MeasuredFigure(1000.0, math.nan), 0.04, 40.0),
        (MeasuredFigure(1000.0, math.nan), 0.005, 5.0),
        (MeasuredFigure(1000.0, math.nan), 0.0, math.nan),
    ],
)
def test_noise_and_share_of_the_acceleration_add_as_squares_unless_a_budget_holds_both(figure, share, expanded):
    clause = only(shock_of(1000.0, figures={"peak": figure}, uncertainty=share), PEAK)
    assert clause.uncertainty == pytest.approx(expanded, rel=1e-14, nan_ok=True)


def test_a_filter_that_leaves_nothing_leaves_the_peak_open():
    assert only(shock_of(1000.0, filter_left=0.0), PEAK).verdict == "cannot-tell"


def test_a_width_that_the_filter_may_have_made_is_left_open():
    """1 ms behind a filter that widens by a tenth was 0.909 ms: it lies with it inside 0.9 to 1.1, not in 0.95 to 1.1."""
    figures = {"width": MeasuredFigure(1e-3)}
    verdicts = [
        only(
            shock_of(1000.0, figures=figures, filter_width=1.1),
            PulseLimits(PULSE, "quoted", width=Limits(low, 1.1e-3, "quoted")),
        ).verdict
        for low in (0.9e-3, 0.95e-3)
    ]
    assert verdicts == ["pass", "cannot-tell"]


def test_the_velocity_change_of_a_straight_line_is_the_integral_over_window_and_pulse():
    """2 (t - 10) from 11 to 18 s: a sawtooth of 4 s that begins at 12 s, its window a quarter before and a half after."""
    pulse = IdealPulse("sawtooth", 8.0, 4.0)
    change = PulseLimits(pulse, "quoted", velocity_change=Limits(0.0, 99.0, "quoted"), window=(0.25, 0.5))
    line = Shock(np.linspace(0.0, 20.0, 201), 0.05, 10.0, 120)  # it never falls: placed by its "peak" at 16 s
    assert only(line, change).value == pytest.approx(8.0**2 - 1.0, rel=1e-12)
    for first, last, reason in (
        (0, 150, "the record does not hold all of it"),
        (30, 201, "the record does not hold all of it"),
        (20, 161, ""),
    ):
        cut = replace(line, values=line.values[first:last], begin=10.0 + 0.05 * first, peak_index=120 - first)
        assert (only(cut, change).reason, math.isnan(only(cut, change).value)) == (reason, bool(reason))


def test_the_band_clause_says_where_it_fails_and_what_is_lacking():
    limits = PulseLimits(PULSE, "quoted", band=PulseBand(PULSE, 0.1, 0.2), band_status="indicative")
    shock = shock_of(1000.0)
    high, low = shock.values.copy(), 0.5 * shock.values
    high[3400] = 500.0  # the band begins at 2 ms
    reasons = [only(replace(shock, values=values), limits).reason for values in (high, low)]
    assert "above the upper curve 1.40 durations after the begin of the ideal pulse" in reasons[0]
    assert "below the lower curve 0.50 durations after the begin of the ideal pulse" in reasons[1]
    assert only(shock, limits).status == "indicative"
    cut = replace(shock, values=shock.values[1900:3300], begin=1.9e-3, peak_index=600)
    assert (
        only(cut, limits).reason == "the record lacks 0.3 durations before the pulse and 0.7 durations after the pulse"
    )
    found = judge_shock(replace(shock, values=1.1 * shock.values), limits)
    assert math.isnan(found.least_margin(PulseLimits(PULSE, "quoted")))
    assert found.least_margin(limits) == pytest.approx(0.5, rel=1e-9)  # 100 of 200
    with_peak = replace(limits, peak=Limits(0.0, 1200.0, "quoted"), rate=Limits(0.0, 1.01e6, "quoted"))
    assert judge_shock(replace(shock, values=1.15 * shock.values), with_peak).least_margin(with_peak) == pytest.approx(
        1 / 12
    )
    assert math.isnan(judge_shock(shock, PulseLimits(PULSE, "quoted")).least_margin(limits.__class__(PULSE, "quoted")))


@pytest.mark.parametrize(
    ("at", "counts"), [(-0.101, False), (-0.099, True), (1.099, True), (1.101, False), (1.105, False)]
)
def test_across_is_watched_from_a_tenth_before_the_pulse_to_a_tenth_after_it(at, counts):
    limits = PulseLimits(PULSE, "quoted", cross_axis=Limits(-math.inf, 300.0, "quoted"))
    across = np.zeros(6000)
    across[round(2000 + 1000 * at)] = -250.0
    shock = shock_of(1000.0, cross_axis={"y": across}, troubles={"cross_axis": "clipped"})
    clause = only(shock, limits)
    assert (clause.value, clause.verdict, clause.reason) == (250.0 * counts, "cannot-tell", "clipped")
    assert only(replace(shock, cross_axis={"y": 2.0 * across}), limits).verdict == ("fail" if counts else "cannot-tell")


def test_demands_name_rate_and_cutoff_in_hertz():
    limits = PulseLimits(PULSE, "quoted", rate=Limits(1e6, math.inf, "quoted"), cutoff=Limits(1e4, math.inf, "quoted"))
    clauses = judge_shock(shock_of(1000.0, filter_cutoff=2e4), limits).clauses
    assert [(one.value, one.verdict) for one in clauses] == [(pytest.approx(1e6), "pass"), (2e4, "pass")]
    assert len(judge_shock(shock_of(1000.0), limits).clauses) == 1  # no filter


def test_the_worst_clause_is_a_fail_then_an_open_one_then_one_not_judged():
    def one(verdict, margin=1.0, high=2.0):
        return ShockVerdict((Clause("c", "quoted", "1", 0.0, 0.0, high, margin, 0.0, verdict),), 0.0, None)

    order = [one("pass"), one("not-judged"), one("cannot-tell"), one("fail")]
    assert [worst_clauses(order[: k + 1])[0][1] for k in range(4)] == [0, 1, 2, 3]
    assert [worst_clauses(order[::-1][k:])[0][1] for k in range(4)] == [0, 0, 0, 0]
    assert worst_clauses([one("pass", 1.0, 2.0), one("pass", 1.5, 100.0), one("pass", 0.5, 0.5)])[0][1] == 1


@pytest.mark.parametrize(("octaves", "count"), [(1.0, 13), (2.51, 32), (0.01, 2)])
def test_the_grid_of_a_spectrum_has_a_point_an_interval_and_both_ends(octaves, count):
    grid = replace(SPECTRUM, frequency=(10.0, 10.0 * 2.0**octaves), level=(1.0, 2.0)).grid()
    assert grid.size == count
    assert grid[[0, -1]] == pytest.approx([10.0, 10.0 * 2.0**octaves], rel=1e-12)


def test_the_curves_of_a_spectrum_are_decibels_about_nominal_and_end_with_their_bands():
    limits = replace(SPECTRUM, bands=(DecibelBand(20.0, 50.0, -20.0, 40.0, "quoted"),))
    f = np.array([19.999, 20.0 * (1 - 5e-10), 30.0, 50.0 * (1 + 5e-10), 50.001])
    low, high = limits.curves(f)
    assert np.isnan(low[[0, 4]]).all()
    assert np.isnan(high[[0, 4]]).all()
    assert low[1:4] == pytest.approx(f[1:4] / 10.0, rel=1e-12)  # nominal is f up to 100 Hz
    assert high[1:4] == pytest.approx(100.0 * f[1:4], rel=1e-12)


def test_a_spectrum_says_where_it_is_farthest_outside():
    f, nominal = np.array([20.0, 200.0, 400.0]), np.array([20.0, 100.0, 100.0])
    for k, decibels, words in (
        (1, 99.0, "90 dB above the tolerance at 200"),
        (2, -96.0, "90 dB below the tolerance at 400"),
    ):
        gain = np.zeros(3)
        gain[k] = decibels
        [within, above] = judge_spectrum(f, nominal * 10.0 ** (gain / 20.0), SPECTRUM)
        assert within.reason == words + "\xa0Hz"
        assert (within.value, within.margin) == (pytest.approx(2 / 3), pytest.approx(2 / 3 - 0.9))
        assert above.reason == ""
    [within, _] = judge_spectrum(f, np.array([20.0, math.nan, 100.0]), SPECTRUM)
    assert math.isnan(within.value)
    assert within.verdict == "cannot-tell"


@pytest.mark.parametrize("doubt", [0.05, 0.2, 0.5, 4.0])
def test_shares_of_a_spectrum_moved_as_a_whole(doubt):
    """Counted for 4001 factors from 1 / (1 + U) to 1 + U; no share that matters lasts shorter than one of them."""
    limits = replace(
        SPECTRUM, bands=(DecibelBand(10.0, 1000.0, -20 * math.log10(1.25), 20 * math.log10(1.25), "quoted"),)
    )
    f = np.array([20.0, 40.0, 200.0, 400.0])
    clause = judge_spectrum(f, np.array([0.9, 1.15, 0.7, 0.3]) * limits.nominal(f), limits, doubt, "guarded")[0]
    values = [0.9, 1.15, 0.7, 0.3]
    moved = [np.mean([0.8 <= x * (1 + doubt) ** t <= 1.25 for x in values]) for t in np.linspace(-1.0, 1.0, 4001)]
    assert clause.value == 0.5
    assert clause.uncertainty == pytest.approx(max(max(moved) - 0.5, 0.5 - min(moved)), abs=1e-12)


def test_no_value_of_a_guarded_spectrum_may_lack_its_uncertainty():
    f = SPECTRUM.grid()
    doubt = np.where(f < 50.0, 0.05, math.nan)
    assert (
        judge_spectrum(f, SPECTRUM.nominal(f), SPECTRUM, doubt, "guarded")[0].reason == "its uncertainty is not known"
    )
    assert judge_spectrum(f, SPECTRUM.nominal(f), SPECTRUM, doubt)[0].verdict == "pass"
    strict = replace(SPECTRUM, share=Limits(0.9, math.inf, "indicative"))
    assert [one.verdict for one in judge_spectrum(f, SPECTRUM.nominal(f), strict, strict=True)] == [
        "cannot-tell",
        "pass",
    ]


@pytest.mark.parametrize("gain", [1.2, 1.0 / 1.2])
def test_a_spectrum_that_its_uncertainty_moves_out_of_its_tolerance_as_a_whole_has_not_passed(gain):
    """3 dB are a factor 1.41: 1.2 lies within, and 1.2 times 1.5 does not; so below."""
    limits = replace(SPECTRUM, bands=(DecibelBand(10.0, 1000.0, -3.0, 3.0, "quoted"),), share_above=None)
    f = limits.grid()
    for doubt, verdict in ((0.1, "pass"), (0.5, "cannot-tell")):
        assert judge_spectrum(f, gain * limits.nominal(f), limits, doubt, "guarded")[0].verdict == verdict


@pytest.mark.parametrize(
    ("margin", "guard", "rule", "verdict"),
    [
        (0.005, 0.0, "simple", "pass"),
        (0.0, 0.3, "simple", "pass"),
        (-0.005, 0.0, "simple", "fail"),
        (-0.005, 0.0, "guarded", "fail"),
        (-0.005, 0.01, "guarded", "cannot-tell"),
        (0.005, 0.01, "guarded", "cannot-tell"),
        (0.01, 0.01, "guarded", "pass"),
        (-0.01, 0.01, "guarded", "cannot-tell"),
        (-0.011, 0.01, "guarded", "fail"),
        (1.0, math.nan, "guarded", "cannot-tell"),
        (math.nan, 0.0, "simple", "cannot-tell"),
    ],
)
def test_a_margin_is_held_against_its_guard_band(margin, guard, rule, verdict):
    assert decide(margin, guard, rule) == verdict


ONE_BAND = replace(
    SPECTRUM,
    bands=(DecibelBand(10.0, 1000.0, -20 * math.log10(1.25), 20 * math.log10(1.25), "quoted"),),
    share_above=None,
)
F = np.array([20.0, 40.0, 200.0, 400.0])


def share_of(values, doubt=0.0, rule="simple", limits=ONE_BAND):
    return judge_spectrum(F[: len(values)], np.array(values) * limits.nominal(F[: len(values)]), limits, doubt, rule)[0]


def test_a_value_of_a_spectrum_may_miss_its_limit_by_1e_9_for_rounding():
    inside, outside = 0.5e-9, 1.5e-9
    shares = [share_of([1.25 * (1.0 + by)]).value for by in (inside, outside)]
    shares += [share_of([0.8 * (1.0 - by)]).value for by in (inside, outside)]
    assert shares == [1.0, 0.0, 1.0, 0.0]
    edge = replace(ONE_BAND, bands=(ONE_BAND.bands[0]._replace(first=20.0, last=50.0),))
    f = np.array([20.0 * (1 - 1e-7), 50.0 * (1 + 1e-7)])
    assert np.isnan(edge.curves(f)).all()


def test_a_spectrum_is_moved_by_its_uncertainty_and_no_farther():
    """Edges at 0.995 and 1.005 of it, in powers of 1.1: within it the one leaves its tolerance, the other does not."""
    near, far = 1.25 / 1.1**0.995, 1.25 / 1.1**1.005
    assert share_of([far, 0.8 * 1.1**1.005], 0.1, "guarded").verdict == "pass"
    both = share_of([near, far], 0.1, "guarded")
    assert (both.value, both.uncertainty, both.verdict) == (1.0, 0.5, "cannot-tell")
    low = share_of([0.8 * 1.1**0.995, 0.8 * 1.1**1.005], 0.1, "guarded")
    assert (low.value, low.uncertainty) == (1.0, 0.5)
    assert share_of([0.995 * 1.25], 1.0, "guarded").value == 1.0  # as measured, though 1 % of the way takes it out
    assert share_of([1.005 * 0.8], 1.0, "guarded").value == 1.0


def test_a_share_that_is_just_met_passes_and_a_hundredth_of_a_decibel_is_told():
    half = replace(ONE_BAND, share=Limits(0.5, math.inf, "quoted"))
    assert [share_of(values, limits=half).verdict for values in ([1.0, 2.0], [1.0, 2.0, 2.0])] == ["pass", "fail"]
    assert share_of([1.0, 2.0], 0.01, "guarded", half).verdict == "pass"
    clause = share_of([1.0, 1.25 * 10.0 ** (0.005 / 20.0)])
    assert clause.reason == "0.005 dB above the tolerance at 40\xa0Hz"
    assert share_of([1.0, 1.25 * 10.0 ** (-0.005 / 20.0)]).reason == ""
    clause = share_of([3.0, 0.8 * 10.0 ** (-20.0 / 20.0)])
    assert clause.reason == "20 dB below the tolerance at 40\xa0Hz"


def test_each_value_of_a_spectrum_has_its_own_uncertainty_and_limits():
    """1.2 of at most 1.25 is moved out by a half and not by nothing; what has no tolerance is nowhere outside."""
    for doubt, verdict in (([0.0, 0.5], "cannot-tell"), ([0.2, 0.0], "pass")):
        assert share_of([1.0, 1.2], np.array(doubt), "guarded").verdict == verdict
    upper = replace(ONE_BAND, bands=(ONE_BAND.bands[0]._replace(first=30.0),))
    clause = share_of([9.0, 1.1], limits=upper)
    assert (clause.value, clause.reason) == (1.0, "")
    assert SPECTRUM.grid().size == 81  # two decades are 6.64 octaves of twelve


def test_what_a_spectrum_loses_before_it_gains_is_seen():
    """Of two values one leaves at a tenth of the uncertainty, the other comes in at three tenths: between them none is in."""
    clause = share_of([1.25 / 1.1**0.1, 0.8 / 1.1**0.3], 0.1, "guarded")
    assert (clause.value, clause.uncertainty) == (0.5, 0.5)


BAND = PulseLimits(PULSE, "quoted", band=PulseBand(PULSE, 0.1, 0.2), band_status="quoted")
WIDE = PulseLimits(PULSE, "quoted", width=Limits(0.0, 1.0, "quoted"))


@pytest.mark.parametrize(
    ("limits", "figures"),
    [(WIDE, ("width",)), (BAND, ("peak", "width")), (PEAK, ("peak",))],
    ids=["width", "band", "peak"],
)
def test_what_harms_its_figures_or_is_sampled_too_coarsely_leaves_a_clause_open(limits, figures):
    coarse = Shock(PULSE.at(np.arange(60) * 1.2e-4 - 2e-3), 1.2e-4, 0.0, 20)
    assert only(shock_of(1000.0), limits).verdict == "pass"
    for figure in ("peak", "width"):
        clause = only(shock_of(1000.0, troubles={figure: "why"}), limits)
        assert (clause.reason, clause.verdict) == (("why", "cannot-tell") if figure in figures else ("", "pass"))
    assert only(coarse, limits).reason.startswith("8.3 samples a pulse")


def test_a_peak_of_which_a_filter_leaves_little_has_no_upper_limit_to_miss():
    limits = PulseLimits(PULSE, "quoted", peak=Limits(800.0, math.inf, "quoted"))
    assert only(shock_of(1000.0, filter_left=0.005), limits).verdict == "pass"


@pytest.mark.parametrize(
    ("left", "verdict"),
    [(1.0, "pass"), (1195.0 / 1199.8, "pass"), (1195.0 / 1199.995, "pass"), (1195.0 / 1202.2, "cannot-tell")],
)
def test_a_filter_may_take_as_much_as_there_is_room_in_a_band(left, verdict):
    """A peak of 1195 has 5 to the upper curve: 4.8 and 4.995 are less, and 7.2 is more."""
    assert only(shock_of(1195.0, filter_left=left), BAND).verdict == verdict


def test_an_area_is_that_of_all_samples_from_one_time_to_another():
    """Of a half-sine 2 A D/pi; half a microsecond that a record lacks is told."""
    whole = shock_of(1000.0)
    assert area_between(whole, 2e-3, 3e-3) == pytest.approx(2.0 / math.pi, rel=1e-6)
    assert area_between(whole, 2.2503e-3, 2.5e-3) == pytest.approx(math.cos(0.2503 * math.pi) / math.pi, rel=1e-5)
    assert math.isnan(area_between(replace(whole, begin=0.5e-6), 0.0, 1e-3))
    assert not math.isnan(area_between(whole, 0.0, 1e-3))


def test_half_a_sample_that_a_record_lacks_is_not_told():
    """It begins half a microsecond within what is watched, 0.4 durations before the pulse at 2 ms."""
    time = 1.6005e-3 + 1e-6 * np.arange(3000)
    shock = Shock(PULSE.at(time - 2e-3), 1e-6, float(time[0]), int(np.argmax(PULSE.at(time - 2e-3))))
    assert only(shock, BAND).verdict == "pass"


def test_of_several_channels_across_the_largest_counts():
    limits = PulseLimits(PULSE, "quoted", cross_axis=Limits(-math.inf, 300.0, "quoted"))
    across = {name: np.full(6000, value) for name, value in (("x", 40.0), ("y", -310.0), ("z", 20.0))}
    assert only(shock_of(1000.0, cross_axis=across), limits).value == 310.0
