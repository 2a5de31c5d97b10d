"""Pulses are found or refused in words: short, cut, overlapping, swapped, noisy, empty records."""

import dataclasses

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from strikewave.base.errors import InputError
from strikewave.hopkinson import Bar, GaugeTrace, align, find_pulses, reduce
from strikewave.hopkinson.onset import drift, onset, split
from strikewave.hopkinson.pulses import quieten

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
