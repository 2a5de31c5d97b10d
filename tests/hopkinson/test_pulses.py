"""Pulses are found or refused in words: short, cut, overlapping, swapped, noisy, empty records."""

import dataclasses
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from strikewave.base.errors import InputError
from strikewave.hopkinson import Bar, GaugeTrace, align, find_pulses, reduce
from strikewave.hopkinson.pulses import (
    _check_strain,
    _first,
    _place,
    _shape,
    drift,
    ending,
    first_above,
    largest,
    noise_ceiling,
    onset,
    quieten,
    split,
)

from .bench import STEP, bench


@pytest.fixture(scope="module")
def shot():
    return bench()


def cut(trace, begin, end):
    return GaugeTrace(trace.strain[begin:end], trace.step, trace.start + begin * trace.step)


@pytest.mark.parametrize("signs", [(1, 1), (-1, 1), (1, -1), (-1, -1)])
def test_signs_and_offsets_of_channels_do_not_matter(shot, signs):
    bars, _, traces, _ = shot
    plain = find_pulses(*traces, bars)
    turned = [GaugeTrace(s * t.strain + 7e-5, t.step, t.start) for s, t in zip(signs, traces, strict=True)]
    found = find_pulses(*turned, bars)
    assert [q.polarity for q in found.traces] == list(signs)
    for name in ("incident", "reflected", "transmitted"):
        assert getattr(found, name) == pytest.approx(getattr(plain, name), abs=1e-15)


def test_traces_on_clocks_with_different_begin_are_brought_together(shot):
    """The transmitted record begins 30 us later: windows of the same instants."""
    bars, _, traces, _ = shot
    later = cut(traces[1], 300, None)
    plain, found = find_pulses(*traces, bars), find_pulses(traces[0], later, bars)
    assert found.starts == pytest.approx(plain.starts, abs=1e-12)
    assert found.transmitted == pytest.approx(plain.transmitted, abs=1e-18)


def test_records_half_a_step_apart_are_moved_together(shot):
    """Samples taken half a step later, straight between: corners of the trapezoid are off by an eighth of their bend.

    5 N a step of rise, 500 N in all: 5/8 N and what the transform makes of it, below 1 N on the face.
    """
    bars, specimen, traces, _ = shot
    other = traces[1]
    between = 0.5 * (other.strain[1:] + other.strain[:-1])
    shifted = GaugeTrace(between, STEP, other.start + 0.5 * STEP)
    forces = []
    for transmitted in (other, shifted):
        pulses = find_pulses(traces[0], transmitted, bars)
        forces.append(reduce(align(pulses, bars, "none"), bars, specimen).second_force[:1500])
    assert np.abs(forces[1] - forces[0]).max() < 1.0


def test_swapped_channels_are_told(shot):
    bars, _, traces, _ = shot
    with pytest.raises(InputError, match="swapped"):
        find_pulses(traces[1], traces[0], bars)


def test_overlapping_pulses_are_told(shot):
    """A gauge 45 us of way before the specimen sees incident and reflected pulse of 100 us at once."""
    bars, _, traces, _ = shot
    near = dataclasses.replace(bars[0], gauge_distance=45e-6 * bars[0].speed)
    with pytest.raises(InputError, match="overlap"):
        find_pulses(*traces, (near, bars[1]))


@pytest.mark.parametrize("end", [5500, 6000, 7000, 7400])
def test_a_record_that_ends_within_a_pulse_is_told(shot, end):
    bars, _, traces, _ = shot
    with pytest.raises(InputError, match=r"record|pulse"):
        find_pulses(cut(traces[0], 0, end), cut(traces[1], 0, end), bars)


@pytest.mark.parametrize("begin", [3550, 3600, 3800])
def test_a_record_that_begins_within_the_pulse_is_told(shot, begin):
    bars, _, traces, _ = shot
    with pytest.raises(InputError, match="quiet"):
        find_pulses(cut(traces[0], begin, None), cut(traces[1], begin, None), bars)


def test_an_echo_from_the_far_end_that_comes_too_soon_is_told(shot):
    bars, _, traces, _ = shot
    short = dataclasses.replace(bars[1], length=bars[1].gauge_distance + 40e-6 * bars[1].speed)
    with pytest.raises(InputError, match="far end"):
        find_pulses(*traces, (bars[0], short))


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_samples_that_are_no_numbers_are_counted(shot, bad):
    bars, _, traces, _ = shot
    strain = traces[0].strain.copy()
    strain[[5, 4000]] = bad
    with pytest.raises(InputError, match="2 samples"):
        find_pulses(GaugeTrace(strain, STEP), traces[1], bars)


def test_noise_alone_is_no_pulse(shot, rng):
    """In noise no five samples in a row reach half the largest value of five in a row by chance above the ceiling."""
    bars, _, traces, _ = shot
    for _ in range(20):
        with pytest.raises(InputError, match=r"noise alone|quiet"):
            find_pulses(GaugeTrace(rng.standard_normal(9000), STEP), traces[1], bars)


@given(
    st.lists(st.floats(-1e300, 1e300), max_size=60),
    st.floats(allow_nan=True, allow_infinity=True),
    st.floats(1e-6, 10.0),
)
def test_anything_is_reduced_or_refused_in_words(values, step, distance):
    bar = Bar(7800.0, 210e9, 0.02, distance)
    trace = GaugeTrace(np.array(values), step)
    with np.errstate(all="ignore"), pytest.raises(InputError):
        find_pulses(trace, trace, (bar, bar))


@given(st.integers(20, 400), st.integers(10, 200), st.floats(2e-3, 0.05), st.integers(0, 2**31))
def test_onset_of_a_ramp_in_noise(quiet, rise, noise, seed):
    """A ramp to 1 stands three standard deviations above its noise after 3 noise x rise samples: found about there."""
    x = noise * np.random.default_rng(seed).standard_normal(quiet + 3 * rise)
    x[quiet:] += np.minimum(np.arange(2.0 * rise + rise) / rise, 1.0)
    found = onset(x)
    assert found is not None
    assert abs(found - quiet) <= 6 + 8.0 * noise * rise


def test_split_of_two_white_noises(rng):
    """A tenfold standard deviation begins at 500 of 1000: within 5 samples in 50 draws."""
    for _ in range(50):
        x = np.concatenate([rng.standard_normal(500), 10.0 * rng.standard_normal(500)])
        assert abs(split(x) - 500) <= 5


@pytest.mark.parametrize("offset", [0.0, 3e-4])
def test_a_slow_foot_does_not_move_the_zero_line(shot, offset, rng):
    """A foot that grows to 2 % of the pulse over the last 8 us in noise of 1 %, before a quiet head of 27 us.

    The mean zero line of 40 draws is off by less than four of its standard errors, 4 x 1 %/sqrt(40 x 250); taken up to the
    onset it would be off by a foot's mean of 1 % over a fourth of the head, 0.2 %.
    """
    traces = shot[2]
    peak, record = traces[0].strain.max(), cut(traces[0], 3150, None)
    foot = 0.02 * np.clip((np.arange(record.strain.size) - 270) / 80.0, 0.0, 1.0)
    foot[350:] = 0.0
    found = []
    for _ in range(40):
        strain = record.strain + peak * (foot + 0.01 * rng.standard_normal(foot.size)) + offset
        found.append(quieten(GaugeTrace(strain, STEP), "trace"))
    assert np.mean([q.baseline for q in found]) == pytest.approx(offset, abs=4.0 * 0.01 * peak / np.sqrt(40 * 250.0))
    assert np.mean([q.noise for q in found]) == pytest.approx(0.01 * peak, rel=0.05)


def test_a_zero_line_that_drifts_is_told_from_noise_and_from_noise_that_remembers(rng):
    """4 standard errors of a difference of two of eight means: white noise beyond it once in a few hundred heads.

    So does noise whose neighbours are alike by 0.9; a drift by a standard deviation over 4000 samples always shows.
    """
    from scipy.signal import lfilter

    for noise in (lambda: rng.standard_normal(4000), lambda: lfilter([1.0], [1.0, -0.9], rng.standard_normal(4000))):
        still = [drift(noise()) for _ in range(100)]
        assert sum(found.difference > 4.0 * found.error for found in still) <= 4
    moving = [drift(rng.standard_normal(4000) + np.linspace(0.0, 1.0, 4000)) for _ in range(100)]
    assert all(found.difference > 4.0 * found.error for found in moving)


def test_a_strain_of_a_forgotten_unit_is_refused(shot):
    """Microstrain taken for strain: 7.6 instead of 7.6e-6; on one channel alone too."""
    bars, _, traces, _ = shot
    wrong = [GaugeTrace(1e6 * t.strain, t.step, t.start) for t in traces]
    with pytest.raises(InputError, match=r"incident trace: .*ustrain"):
        find_pulses(*wrong, bars)
    with pytest.raises(InputError, match=r"transmitted trace: .*ustrain"):
        find_pulses(traces[0], wrong[1], bars)


def test_the_split_is_the_least_of_the_criterion_of_maeda_1985(rng):
    """n ln var(x[:n]) + (N - n - 1) ln var(x[n:]) by numpy's own variances, n from 3 to N - 3; whatever the zero line."""
    for size, change in ((8, 4), (9, 5), (30, 20), (60, 9)):
        x = rng.standard_normal(size)
        x[change:] *= 7.0
        whole = [n * np.log(np.var(x[:n])) + (size - n - 1) * np.log(np.var(x[n:])) for n in range(3, size - 2)]
        assert split(x) == split(x + 5.0) == split(1e-3 * x) == 3 + int(np.argmin(whole))
    assert split(np.arange(7.0)) == 0
    # noise alone: the least of many that are nearly alike
    for x in rng.standard_normal((150, 14)):
        whole = [n * np.log(np.var(x[:n])) + (13 - n) * np.log(np.var(x[n:])) for n in range(3, 12)]
        assert split(x) == 3 + int(np.argmin(whole))
    # a head of zeros has no variance: rounding stands for it
    assert split(np.concatenate([np.zeros(20), [1.0, -1.0, 1.0, -1.0]])) == 20


def test_levels_that_last_for_five_samples_worked_by_hand():
    x = np.array([0.0, 2.0, -2.0, 2.0, 2.0, 0.5, 3.0, -2.5, 2.2, 4.0, 2.1, 2.0])
    assert first_above(x, 1.0) == 6
    assert first_above(x, 1.99) == 6
    assert first_above(x, 2.05) == 6
    assert first_above(x, 2.15) is None
    assert first_above(x[:4], -1.0) is None
    assert first_above(x[:5], -1.0) == 0
    assert largest(x) == 2.1
    assert largest(x[:4]) == math.inf
    assert largest(x[6:11]) == 2.1
    # sqrt(2 ln(N/0.01)), two samples at least
    assert noise_ceiling(2.0, 100) == pytest.approx(2.0 * math.sqrt(2.0 * math.log(1e4)), rel=1e-14)
    assert noise_ceiling(1.0, 0) == noise_ceiling(1.0, 2) == pytest.approx(math.sqrt(2.0 * math.log(200.0)), rel=1e-14)


def test_a_pulse_begins_and_ends_where_it_does_read_either_way():
    pulse = np.concatenate([np.zeros(100), np.ones(40), np.zeros(70)])
    assert onset(pulse) == split(pulse[:101])
    assert abs(onset(pulse) - 100) <= 2
    assert ending(pulse) == pulse.size - onset(pulse[::-1])
    assert abs(ending(pulse) - 140) <= 2
    assert onset(np.zeros(4)) is None
    assert ending(np.zeros(4)) == 4


def test_the_drift_of_eight_means_worked_by_hand():
    """Parts of m +- 1: variance 1 and neighbours unlike; of m + (1, 1, -1, -1): alike by 1/3; still parts; short ones."""
    means = np.array([0.0, 0.5, 3.0, 1.0, 0.0, -1.0, 0.0, 2.0])
    unlike = drift((means[:, None] + [1.0, -1.0]).ravel())
    assert unlike == pytest.approx((4.0, 1.0), rel=1e-14)
    # sqrt(2/4 (4/3)/(2/3)); what is over after eight equal parts does not count
    alike = drift(np.append((means[:, None] + [1.0, 1.0, -1.0, -1.0]).ravel(), [99.0] * 7))
    assert alike == pytest.approx((4.0, 1.0), rel=1e-14)
    assert drift(np.repeat(means, 3)) == (4.0, 0.0)
    assert drift(np.arange(15.0)) == (0.0, math.inf)
    # neighbours alike to 0.999 at most
    long = np.tile(np.repeat([1.0, -1.0], 5000), 8)
    assert drift(long).error == pytest.approx(math.sqrt(2.0 / 10_000 * 1.999 / 0.001), rel=0.2)


TRAPEZOID = np.concatenate([np.arange(10.0), np.full(20, 10.0), np.arange(9.0, -1.0, -1.0), np.zeros(5)])
"""Up over ten samples, 10 from sample 10 on, down from sample 30 on."""


def test_the_shape_of_a_trapezoid_worked_by_hand():
    """Below a tenth at 39, 1 to 9 from sample 1 to 9, half heights at 5 and 34."""
    assert _shape(TRAPEZOID, 0.5) == pytest.approx((19.5, 4.0, 10.0, 14.5), rel=1e-14)
    overshot = TRAPEZOID.copy()
    overshot[12] = 16.0
    assert _shape(overshot, 0.5) == pytest.approx((19.5, 4.0, 10.0, 14.5), rel=1e-14)
    # the median of 6 and 10, both ends taken and no more
    assert _shape(np.array([0.0, 6.0, 10.0, 2.0, 0.0, 0.0]), 0.5)[2] == 8.0
    # it has not fallen by the end of its body
    assert _shape(TRAPEZOID[:37], 0.5)[0] == 18.5
    assert [_first(np.array([0.0, 4.0, 8.0]), level) for level in (6.0, 4.0, 0.0)] == [1.5, 1.0, 0.0]
    assert _first(np.array([3.0, 3.0, 9.0]), 2.0) == 1.0


def test_places_of_times_and_what_is_late_of_them():
    trace = GaugeTrace(np.zeros(8), 0.5, 1.0)
    assert np.array_equal(trace.time, 1.0 + 0.5 * np.arange(8))
    assert _place(trace, 2.2) == (2, pytest.approx(-0.2))
    assert _place(trace, 2.0) == (2, 0.0)
    assert _place(trace, 2.0 - 1e-11)[0] == 2
    assert (_place(trace, 1.0)[0], _place(trace, 4.9)[0]) == (0, 7)
    for outside in (0.9, 5.0):
        with pytest.raises(InputError, match="no sample at"):
            _place(trace, outside)
    _check_strain(0.02, "incident")
    with pytest.raises(InputError, match=r"incident trace: .*0\.0201"):
        _check_strain(0.0201, "incident")


@pytest.mark.parametrize("sign", [1, -1])
def test_a_trace_is_taken_from_three_quarters_of_its_quiet_head(sign):
    """40 samples of +-0.001 about 5, a pulse of a trapezoid of 10: its line, noise, polarity and drift."""
    head = 5.0 + 1e-3 * (-1.0) ** np.arange(40)
    found = quieten(GaugeTrace(np.concatenate([head, 5.0 + sign * TRAPEZOID, np.full(60, 5.0)]), 0.5, 7.0), "trace")
    assert abs(found.onset - 40) <= 2
    own = head[: int(0.75 * found.onset)]
    assert found.baseline == pytest.approx(own.mean(), rel=1e-14)
    assert found.noise == pytest.approx(own.std(), rel=1e-9)
    assert found.polarity == sign
    assert (found.trace.step, found.trace.start) == (0.5, 7.0)
    assert found.trace.strain[40:85] == pytest.approx(TRAPEZOID, abs=1e-4)
    assert found.drift == pytest.approx(drift(sign * own), abs=1e-12)


def test_the_line_is_the_mean_of_the_head_and_not_the_median_of_the_trace():
    """One sample in three at 5.5, the others at 5: a line of 5.17 or so, from which the pulse is counted."""
    head = 5.0 + np.tile([0.0, 0.0, 0.5], 16)
    after = np.concatenate([5.0 + 10.0 * TRAPEZOID, np.tile([5.0, 5.0, 5.5], 20)])
    found = quieten(GaugeTrace(np.concatenate([head, after]), 0.5), "trace")
    own = head[: int(0.75 * found.onset)]
    assert 5.1 < own.mean() < 5.25
    assert found.baseline == pytest.approx(own.mean(), rel=1e-13)
    assert found.trace.strain[48:] == pytest.approx(after - own.mean(), abs=1e-12)


def test_windows_last_to_the_last_sample_of_a_record(shot):
    """The reflected pulse's window to the end of the first record, the transmitted one's to the end of the second."""
    bars, _, traces, _ = shot
    found = find_pulses(*traces, bars)
    assert found.starts[1] + found.duration == pytest.approx(traces[0].time[-1], abs=0.01 * STEP)
    short = find_pulses(traces[0], cut(traces[1], 0, 8200), bars)
    assert short.starts[2] + short.duration == pytest.approx(traces[1].time[8199], abs=0.01 * STEP)
    assert short.transmitted[-1] == short.traces[1].trace.strain[8199]
    assert short.incident.size == short.reflected.size == short.transmitted.size


def test_short_traces_and_bad_steps_are_refused_in_words():
    for strain, step, said in (
        (np.zeros(31), 1.0, "31 samples"),
        (np.zeros((6, 9)), 1.0, "samples"),
        (np.zeros(32), 1.0, "quiet samples|noise alone"),
        (np.zeros(99), 0.0, "a step of"),
        (np.zeros(99), math.inf, "a step of"),
        (np.concatenate([np.zeros(10), np.ones(8), np.zeros(60)]), 1.0, "16 quiet samples before the pulse"),
    ):
        with pytest.raises(InputError, match=said):
            quieten(GaugeTrace(strain, step), "trace")


def test_windows_of_a_shot_lie_where_its_distances_say(shot):
    """Waves 300 us apart at the first gauge and 250 us between gauges; windows to the end of the record, from 15 us before the pulses."""
    bars, _, traces, _ = shot
    found = find_pulses(*traces, bars)
    starts = np.subtract(found.starts, found.onset)
    assert starts == pytest.approx([-15e-6, 285e-6, 235e-6], abs=1.01 * STEP)
    arrivals = found.onset - 15e-6 + np.array([0.0, 300e-6, 250e-6])
    # at most zero: the sample lies at or before its time
    assert found.late == pytest.approx(found.starts - arrivals, abs=1e-12)
    # the record ends before the 300 us to the reflected wave
    left = traces[0].time[-1] - found.starts[1]
    assert (found.lead, found.duration) == pytest.approx((15e-6, left), abs=1.01 * STEP)
    assert found.end - found.onset == pytest.approx(100e-6, abs=2 * STEP)
    for name, k in (("incident", 0), ("reflected", 0), ("transmitted", 1)):
        at = round((found.starts[("incident", "reflected", "transmitted").index(name)] - traces[k].start) / STEP)
        assert np.array_equal(getattr(found, name), found.traces[k].trace.strain[at : at + found.incident.size])
    # gauges 0.3 and 0.9 of a step farther off, 1.5 of way between incident and reflected: parts of a step are told
    odd = tuple(
        dataclasses.replace(bar, gauge_distance=bar.gauge_distance + share * STEP * bar.speed)
        for bar, share in zip(bars, (0.3, 0.9), strict=True)
    )
    parts = find_pulses(*traces, odd)
    arrivals = parts.onset - 0.05 * 300.06e-6 + np.array([0.0, 300.06e-6, 250.12e-6])
    assert parts.late == pytest.approx(parts.starts - arrivals, abs=1e-12)
    assert len({round(late / STEP, 3) for late in parts.late}) == 3
    assert all(-STEP < late <= 0.0 for late in parts.late)
    # a head shorter than the lead: windows begin with the record
    late = find_pulses(*(cut(trace, 3420, None) for trace in traces), bars)
    assert late.starts[0] == pytest.approx(traces[0].start + 3420 * STEP, abs=1e-12)
    # the incident bar's far end, 260 us before its gauge, and steps that differ
    near = dataclasses.replace(bars[0], length=bars[0].gauge_distance + 130e-6 * bars[0].speed)
    assert find_pulses(*traces, (near, bars[1])).duration == pytest.approx(260e-6, abs=1.01 * STEP)
    with pytest.raises(InputError, match="that of the incident"):
        find_pulses(traces[0], GaugeTrace(traces[1].strain, STEP * (1 + 2e-6), traces[1].start), bars)
    assert find_pulses(traces[0], GaugeTrace(traces[1].strain, STEP * (1 + 5e-7), traces[1].start), bars).step == STEP
