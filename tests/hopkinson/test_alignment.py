"""The band that dispersion turns, what an alignment moves, and parts of a step in the geometry."""

import dataclasses
import math

import numpy as np
import pytest

from strikewave.hopkinson import (
    Carrier,
    GaugeTrace,
    align,
    carried,
    find_pulses,
)
from strikewave.hopkinson.shifting import highest_frequency
from strikewave.waves.dispersion import Rod, wave_number

from .bench import STEP, bench


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
