"""The band that dispersion turns, what an alignment moves, and parts of a step in the geometry."""

import dataclasses
import math
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.interpolate import CubicSpline
from scipy.signal.windows import hann

from strikewave.hopkinson import Bar, Carrier, GaugeTrace, align, carried, find_pulses
from strikewave.hopkinson.alignment import (
    _averaged,
    _late_by_balance,
    _late_by_onset,
    _running,
    _spline,
    _wave_numbers,
    _within,
    highest_frequency,
)
from strikewave.hopkinson.pulses import Pulses
from strikewave.waves.dispersion import Rod, wave_number

from .bench import STEP, bench, travelled


def test_dispersion_turns_up_to_its_highest_frequency_and_moves_nothing_above():
    """A burst at 150 kHz in steel 20 mm thick comes late by x (1/cg - 1/c0); above ``highest`` it stays, to a sample."""
    rod, t = Rod(0.01, 5000.0, 0.29), 1e-7 * np.arange(6000)
    burst = np.exp(-(((t - 2e-4) / 3e-5) ** 2)) * np.cos(2.0 * np.pi * 150e3 * t)

    def late(highest):
        moved = carried(burst, 1e-7, 0.5, Carrier(rod, highest=highest))
        return float(t @ moved**2 / (moved @ moved) - t @ burst**2 / (burst @ burst))

    w = 2.0 * np.pi * np.array([149e3, 151e3])
    group = np.diff(w) / np.diff(np.asarray(wave_number(w, rod)).real)
    assert late(math.inf) == pytest.approx(0.5 * float(1.0 / group[0] - 1.0 / 5000.0), rel=0.05)
    assert abs(late(60e3)) < 1e-7


def test_a_wave_cut_at_its_plateau_is_carried_back_without_ringing():
    """What lies beyond the window is unknown; led to zero over the window's length it leaves 1 % at most of it."""
    t = 1e-7 * np.arange(2000)
    rise = 0.5 - 0.5 * np.cos(np.pi * np.clip((t - 3e-5) / 3e-5, 0.0, 1.0))
    moved = carried(rise, 1e-7, -1.0, Carrier(Rod(0.01, 5000.0, 0.29)))
    assert np.abs(moved - 1.0)[1200:].max() < 0.01


def test_the_band_ends_where_a_gaussian_sinks_in_white_noise():
    """A w sqrt(pi)/step exp(-(pi f w)^2) = 4 sigma sqrt(N): found to the two bins of 1/width that the envelope adds."""
    step, size, w, noise = 1e-7, 8000, 4e-6, 1e-3
    t = step * np.arange(size)
    pulse = np.exp(-(((t - 4e-4) / w) ** 2))
    expected = math.sqrt(math.log(w * math.sqrt(math.pi) / step / (4.0 * noise * math.sqrt(size)))) / (math.pi * w)
    found = highest_frequency(pulse, step, noise, 1e-4)
    assert expected <= found <= expected + 3.0 / 1e-4


@pytest.fixture(scope="module")
def odd_shot():
    """A shot whose gauges stand 0.4 and 0.7 of a step off whole ones and 1 us of way off what is said; noise of 1e-3."""
    bars, specimen, traces, _ = bench()
    speed, rng = bars[0].speed, np.random.default_rng(5)
    wrong = (
        dataclasses.replace(bars[0], gauge_distance=bars[0].gauge_distance - 0.5e-6 * speed + 0.2 * STEP * speed),
        dataclasses.replace(bars[1], gauge_distance=bars[1].gauge_distance - 0.5e-6 * speed + 0.5 * STEP * speed),
    )
    noisy = [
        GaugeTrace(t.strain + 1e-3 * traces[0].strain.max() * rng.standard_normal(t.strain.size), t.step, t.start)
        for t in traces
    ]
    return wrong, specimen, find_pulses(*noisy, wrong)


@pytest.mark.parametrize("method", ["onset", "balance"])
def test_an_alignment_moves_each_wave_by_what_it_says(odd_shot, method):
    """The moved wave at t is the geometric one at t + applied: shifts in frequency to the noise between samples."""
    bars, _, pulses = odd_shot
    plain, moved = align(pulses, bars, "none"), align(pulses, bars, "none", method)
    late = getattr(plain, f"late_{method}")
    assert moved.applied == late
    assert min(map(abs, late)) > 0.3e-6
    for name, by in zip(("reflected", "transmitted"), late, strict=True):
        before, after = getattr(plain, name), getattr(moved, name)
        again = np.interp(plain.time + by, plain.time, before)
        inside = slice(50, -50)
        assert np.abs(after - again)[inside].max() < 8e-3 * np.abs(before).max()
        assert np.abs(after - before)[inside].max() > 0.04 * np.abs(before).max()


def test_geometry_counts_parts_of_a_step():
    """Gauges said to be 0.2 and 0.25 of a step of way farther off: the waves seem early by 2 x 0.2 and 0.2 + 0.25 steps.

    To a twentieth of a step: the level is crossed on a straight rise of a hundred samples.
    """
    bars, _, traces, _ = bench()
    part = tuple(
        dataclasses.replace(bar, gauge_distance=bar.gauge_distance + share * STEP * bar.speed)
        for bar, share in zip(bars, (0.2, 0.25), strict=True)
    )
    whole, moved = (align(find_pulses(*traces, said), said, "none").late_onset for said in (bars, part))
    assert np.subtract(moved, whole) / STEP == pytest.approx([-0.4, -0.45], abs=0.05)


def test_the_transit_of_the_specimen_is_not_counted_as_late():
    bars, _, traces, _ = bench()
    pulses = find_pulses(*traces, bars)
    without, counted = (align(pulses, bars, "none", transit=t).late_onset for t in (0.0, 2e-6))
    assert without[0] == counted[0]
    assert without[1] - counted[1] == pytest.approx(2e-6, abs=1e-12)


def test_alignment_keeps_the_part_of_a_step_of_the_geometry():
    """Transmitted gauge half a step of way nearer, distances 0.5 us off: moved by late, to 2e-3 of the wave.

    Half a step is 5e-3 of a rise of a hundred steps; corners between samples cost an eighth of their bend, 1.3e-3.
    """
    bars, _, traces, _ = bench()
    far = dataclasses.replace(bars[1], gauge_distance=bars[1].gauge_distance + (0.5e-6 + 0.5 * STEP) * bars[1].speed)
    pulses = find_pulses(*traces, (bars[0], far))
    plain, moved = (align(pulses, (bars[0], far), "none", method) for method in ("geometric", "balance"))
    again = np.interp(plain.time + moved.applied[1], plain.time, plain.transmitted)[50:-50]
    assert np.abs(moved.transmitted[50:-50] - again).max() < 2e-3 * plain.transmitted.max()


def test_dispersion_of_a_noisy_shot_ends_with_its_pulse():
    """A rise of 10 us in noise of 1 %: the spectrum of a trapezoid falls as 1/(pi^2 f^2 rise), into noise below 1 MHz."""
    bars, _, traces, _ = bench()
    rng = np.random.default_rng(5)
    noise = 0.01 * traces[0].strain.max()
    noisy = [GaugeTrace(t.strain + noise * rng.standard_normal(t.strain.size), t.step, t.start) for t in traces]
    pulses = find_pulses(*noisy, bars)
    step, size = pulses.step, pulses.incident.size
    corner = math.sqrt(2.0 * 100.0 / (math.pi**2 * 10e-6 * step * 4.0 * math.sqrt(size)))
    assert 0.3 * corner < align(pulses, bars).band < 1.5 * corner


def test_the_echo_from_the_far_end_bounds_the_window():
    """The transmitted gauge 80 us before the free end: its echo comes 160 us later, and the windows last that long."""
    bars, _, traces, _ = bench()
    short = dataclasses.replace(bars[1], length=bars[1].gauge_distance + 80e-6 * bars[1].speed)
    assert find_pulses(*traces, (bars[0], short)).duration == pytest.approx(160e-6, abs=STEP)


def test_onsets_are_crossings_of_one_level_between_samples():
    """Rises of 10, -20 and 5 a sample from samples 10, 30 and 50 on; 5 % of a plateau of 100, or the noise above it."""
    k = np.arange(100.0)
    rises = [slope * np.maximum(k - begin, 0.0) for slope, begin in ((10.0, 10), (-20.0, 30), (5.0, 50))]
    waves = SimpleNamespace(
        incident=rises[0], reflected=rises[1], transmitted=rises[2], noise=(0.0, 0.0), time=k, step=2.0
    )
    # at 10.5, 30.25 and 51
    assert _late_by_onset(waves, 100.0, 3.0) == pytest.approx((39.5, 78.0), rel=1e-13)
    # the larger noise: sqrt(2 ln(100/0.01)) of it = 4.292 x 2
    waves.noise = (1.0, 2.0)
    level = 2.0 * math.sqrt(2.0 * math.log(1e4))
    expected = 2.0 * (20.0 + level / 20 - level / 10), 2.0 * (40.0 + level / 5 - level / 10)
    assert _late_by_onset(waves, 100.0, 0.0) == pytest.approx(expected, rel=1e-12)
    waves.noise = (0.0, 0.0)
    waves.reflected, waves.transmitted = np.zeros(100), 9.0 + k
    assert all(math.isnan(late) for late in _late_by_onset(waves, 100.0, 0.0))


def test_moves_that_balance_forces_are_those_by_which_the_waves_came_late():
    """e_r = -e_i/2, F2 = F1, late by 0.2 and -0.3 of the window between bars of stiffness 2 and 1."""
    t = np.arange(-200.0, 2000.0)

    def pulse(at):
        return np.exp(-(((at - 700.0) / 250.0) ** 2))

    waves = SimpleNamespace(
        time=t, incident=pulse(t), reflected=-0.5 * pulse(t - 80.0), transmitted=pulse(t + 120.0),
        step=1.0, window=400.0, loaded=1400.0,
    )  # fmt: skip
    # half a thousandth of the window: means of ten samples are a little lower than the waves
    assert _late_by_balance(waves, (2.0, 1.0)) == pytest.approx((80.0, -120.0), abs=0.2)
    # only while the incident wave lasts: the pulse is cut at 0.73 of its height
    waves.loaded = 840.0
    assert _late_by_balance(waves, (2.0, 1.0)) == pytest.approx((80.0, -120.0), abs=0.4)
    # 25 samples of load are three means of ten
    waves.loaded = 25.0
    assert _late_by_balance(waves, (2.0, 1.0)) == (0.0, 0.0)
    waves.loaded = 55.0
    assert _late_by_balance(waves, (2.0, 1.0)) != (0.0, 0.0)
    nothing = SimpleNamespace(**{**vars(waves), **dict.fromkeys(("incident", "reflected", "transmitted"), 0.0 * t)})
    assert np.all(np.isfinite(_late_by_balance(nothing, (2.0, 1.0))))


def made_of(waves, late=(0.0, 0.0, 0.0), step=1e-7, size=4096, lead=100e-6, noise=1e-9):
    """Pulses whose windows begin so late after the geometric arrival, of waves over the time from then on."""
    t = step * np.arange(size) - lead
    incident, reflected, transmitted = (wave(t + one) for wave, one in zip(waves, late, strict=True))
    quiet = SimpleNamespace(noise=noise)
    return Pulses(
        incident, reflected, transmitted, step, late, onset=7e-6 + lead, end=7e-6 + lead + 130e-6, rise=20e-6,
        plateau=1e-3, width=90e-6, starts=(7e-6, 0.0, 0.0), traces=(quiet, SimpleNamespace(noise=3e-9)),
    )  # fmt: skip


def gaussian(height, at=60e-6, width=18e-6):
    return lambda t: height * np.exp(-(((t - at) / width) ** 2))


BARS = Bar(8000.0, 2e11, 0.02, 0.9), Bar(2700.0, 7e10, 0.03, 0.4)


def test_waves_at_the_specimen_lie_on_the_clock_of_the_arrival():
    """Windows that begin 0.2, 0.7 and 0.45 of a step early: each wave is again that of its time."""
    waves = gaussian(1e-3), gaussian(-4e-4, 63e-6), gaussian(7e-4, 58e-6)
    pulses = made_of(waves, (-0.2e-7, -0.7e-7, -0.45e-7))
    found = align(pulses, BARS, "none")
    assert found.time == pytest.approx(1e-7 * np.arange(4096) - 100e-6, abs=1e-18)
    for wave, made in zip((found.incident, found.reflected, found.transmitted), waves, strict=True):
        assert wave == pytest.approx(made(found.time), abs=1e-12)
    assert found.loaded == pytest.approx(130e-6, rel=1e-12)
    assert (found.window, found.step, found.noise) == (20e-6, 1e-7, (1e-9, 3e-9))
    assert (found.method, found.theory, found.applied, found.beyond) == ("geometric", "none", (0.0, 0.0), False)
    assert align(dataclasses.replace(pulses, rise=0.3e-7), BARS, "none").window == 1e-7


@pytest.mark.parametrize("method", ["onset", "balance"])
def test_a_wave_that_is_moved_keeps_its_bar_its_way_and_its_dispersion(method):
    """Unequal bars: what is moved is the geometric wave so much earlier, to the rounding of a cubic between samples."""
    stiff, soft = (bar.stiffness for bar in BARS)
    share = stiff / soft
    waves = gaussian(1e-3), gaussian(-4e-4, 60e-6 + 3e-6), gaussian(6e-4 * share, 60e-6 - 2e-6)
    pulses = made_of(waves, (-0.2e-7, -0.7e-7, -0.45e-7))
    plain, moved = (align(pulses, BARS, "pochhammer-chree", one) for one in ("geometric", method))
    assert not moved.beyond
    late = getattr(plain, f"late_{method}")
    assert moved.applied == getattr(moved, f"late_{method}") == late
    assert moved.method == method
    # e_i of 1e-3 - 4e-4 balances: as late as they were made but for dispersion, which takes up to 0.7 us
    if method == "balance":
        assert late == pytest.approx((3e-6, -2e-6), abs=0.8e-6)
    assert np.array_equal(moved.incident, plain.incident)
    for name, by in zip(("reflected", "transmitted"), late, strict=True):
        earlier = CubicSpline(plain.time, getattr(plain, name))(plain.time + by)
        assert getattr(moved, name)[200:-200] == pytest.approx(earlier[200:-200], abs=1e-9)
        # back over the way of its own bar, as the transform of the whole record says
        bar, wave = BARS[name == "transmitted"], waves[1 + (name == "transmitted")]
        whole = np.concatenate([wave(plain.time), np.zeros(4096)])
        carried_back = travelled(whole, 1e-7, -bar.gauge_distance, bar)
        again = np.roll(carried_back, round(bar.delay / 1e-7))[:4096]
        part = bar.delay / 1e-7 - round(bar.delay / 1e-7)
        expected = CubicSpline(plain.time, again)(plain.time + part * -1e-7)
        assert getattr(plain, name)[200:-200] == pytest.approx(expected[200:-200], abs=2e-8)


def test_moves_at_the_edge_of_the_window_are_not_made():
    """30 us late in a window of 20 us: geometry stays, and it is said."""
    waves = gaussian(1e-3), gaussian(-4e-4, 90e-6), gaussian(6e-4 * BARS[0].stiffness / BARS[1].stiffness)
    for method in ("onset", "balance"):
        found = align(made_of(waves), BARS, "none", method)
        assert found.beyond
        assert found.applied == (0.0, 0.0)
        assert found.reflected == pytest.approx(waves[1](found.time), abs=1e-12)
    # a fit ends at the window on either side
    assert found.late_balance[0] == pytest.approx(20e-6, rel=1e-3)
    early = align(made_of((waves[0], gaussian(-4e-4, 30e-6), waves[2])), BARS, "none", "balance")
    assert early.beyond
    assert early.late_balance[0] == pytest.approx(-20e-6, rel=1e-3)


@pytest.mark.parametrize("distance", [0.6, -0.6])
def test_a_wave_that_is_cut_is_led_to_zero_by_half_a_cosine(distance):
    """Hann's window of twice the length beyond the last sample, and nothing after it."""
    t = 1e-7 * np.arange(3000)
    rise = 0.5 - 0.5 * np.cos(np.pi * np.clip((t - 3e-5) / 3e-5, 0.0, 1.0))
    pulse = rise * (1.0 - 0.3 * t / t[-1])
    whole = np.concatenate([pulse, pulse[-1] * hann(6001)[3001:], np.zeros(10_000)])
    bar = SimpleNamespace(rod=Rod(0.01, 5000.0, 0.29))
    far = np.roll(travelled(whole, 1e-7, distance, bar), -round(distance / 5000.0 / 1e-7))[:3000]
    # records of other lengths, whose ends meet
    assert carried(pulse, 1e-7, distance, Carrier(bar.rod)) == pytest.approx(far, abs=2e-6)


def test_means_curves_and_windows_of_moves():
    assert list(_averaged(np.arange(11.0), 3)) == [1.0, 4.0, 7.0]
    assert list(_averaged(np.arange(3.0), 1)) == [0.0, 1.0, 2.0]
    curve = _spline(np.arange(6.0), np.arange(6.0) ** 3)
    assert curve(np.array([-2.0, 0.0, 2.5, 5.0, 9.0])) == pytest.approx([0.0, 0.0, 15.625, 125.0, 125.0])
    assert _within((0.998, -0.998), 1.0)
    for late in ((0.9995, 0.0), (0.0, -0.9995), (math.nan, 0.0)):
        assert not _within(late, 1.0)


def test_a_pulse_is_carried_as_the_transform_of_the_whole_record_says():
    """0.5 and -0.5 m in steel of 20 mm, the delay of 1000 steps taken off, and 300.25 steps moved forward."""
    t = 1e-7 * np.arange(6000)
    pulse = np.exp(-(((t - 2e-4) / 8e-6) ** 2))
    bar = SimpleNamespace(rod=Rod(0.01, 5000.0, 0.29))
    whole = np.concatenate([pulse, np.zeros(6000)])
    for distance in (0.5, -0.5):
        far = np.roll(travelled(whole, 1e-7, distance, bar), -round(distance / 5000.0 / 1e-7))[:6000]
        # a cubic between 2000 frequencies, and the padding
        assert carried(pulse, 1e-7, distance, Carrier(bar.rod)) == pytest.approx(far, abs=1e-7)
    moved = carried(pulse, 1e-7, 2.0, Carrier(bar.rod, "none"), advance=300.25e-7)
    assert moved == pytest.approx(np.exp(-(((t + 300.25e-7 - 2e-4) / 8e-6) ** 2)), abs=1e-9)


def test_what_the_theory_of_love_and_rayleigh_lets_not_run_runs_as_in_the_plain_bar():
    rod = Rod(0.01, 5000.0, 0.3)
    w = np.linspace(1e4, 6e6, 4000)
    k, own = _running(w, rod, "love-rayleigh"), np.asarray(wave_number(w, rod, "love-rayleigh"))
    stuck = np.abs(own.imag) > 0.0
    assert stuck.any()
    assert k[stuck] == pytest.approx(w[stuck] / 5000.0, rel=1e-15)
    slow = ~stuck & (own.real > w / 2500.0)
    assert slow.any()
    assert k[slow] == pytest.approx(w[slow] / 2500.0, rel=1e-15)
    assert np.array_equal(k[~stuck & ~slow], own[~stuck & ~slow])
    assert np.array_equal(_running(w, rod, "pochhammer-chree"), wave_number(w, rod, "pochhammer-chree"))


def test_the_band_of_one_sample_and_of_one_frequency_in_closed_form():
    """One sample is as strong at all frequencies: all, or none from 4 sigma sqrt(N) on; bin 3 is widened by 2 N step/width."""
    one = np.zeros(64)
    one[0] = 1.0
    assert highest_frequency(one, 0.5, 0.0312, 32.0) == 1.0
    assert highest_frequency(one, 0.5, 0.0313, 32.0) == 0.0
    wave = np.cos(2 * np.pi * 3 * np.arange(64) / 64)
    # four bins to either side, bin 8 is the first below; one at least
    assert highest_frequency(wave, 0.5, 0.1, 16.0) == pytest.approx(8 / 32.0)
    assert highest_frequency(wave + 1.0, 0.5, 0.1, 1e9) == pytest.approx(0.0 + 5 / 32.0)


def test_wave_numbers_are_solved_up_to_two_thousand_and_interpolated_beyond():
    rod = Rod(0.01, 5000.0, 0.29)
    few, many = np.linspace(0.0, 3e6, 2000), np.linspace(0.0, 3e6, 2001)
    assert np.array_equal(_wave_numbers(few, rod, "pochhammer-chree"), wave_number(few, rod, "pochhammer-chree"))
    assert np.array_equal(_wave_numbers(many, rod, "none"), wave_number(many, rod, "none"))
    between = _wave_numbers(many, rod, "pochhammer-chree")
    assert not np.array_equal(between, wave_number(many, rod, "pochhammer-chree"))
    # far less than a phase of noise over any bar
    assert between == pytest.approx(np.asarray(wave_number(many, rod, "pochhammer-chree")), abs=1e-5)
