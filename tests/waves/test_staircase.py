"""The staircase of a layer between two others: printed steps, its limit, and the waves themselves."""

import numpy as np
import pytest

from strikewave.base.constants import material
from strikewave.waves import BONDED, End, Layer, LoadPulse, Stack, Tap, WantedError, run_bar
from strikewave.waves.layers import round_bar
from strikewave.waves.li_ma import Sandwich, endless_force, first_echoes, staircase


def steel(length):
    return round_bar("steel", material("65Mn"), length, 0.03)


def alloy(length):
    return round_bar("alloy", material("2A12"), length, 0.03)


def test_steps_behind_2a12_between_65mn():
    """Worked out by hand from T1 = .51664, T2 = 1.48336, q = .233638; given to six digits."""
    steps = staircase(Sandwich(steel(0.1), alloy(0.02), steel(0.1)), 4)
    assert steps.second == pytest.approx([0.766365, 0.945415, 0.987247, 0.997020], abs=5e-7)
    assert steps.first[0] == pytest.approx(0.51664, abs=5e-6)  # what 2A12 lets in from 65Mn


def test_matched_layers_pass_the_whole_jump_at_once():
    steps = staircase(Sandwich(steel(0.1), steel(0.02), steel(0.1)), 3)
    assert steps.first.tolist() == steps.second.tolist() == [1.0, 1.0, 1.0]


def test_both_end_at_what_passes_without_the_layer(rng):
    """2 Z2/(Z1 + Z2); after 4000 steps nothing is left of |q| <= 0.99 in double precision."""
    for ratio in rng.uniform(0.06, 16.0, (20, 2)):
        bars = [Layer("bar", 1.0, z * z, 1.0, 1.0) for z in (1.0, ratio[0], ratio[1])]
        ends = [levels[-1] for levels in staircase(Sandwich(*bars), 4000)]
        assert ends == pytest.approx([2.0 * ratio[1] / (1.0 + ratio[1])] * 2, rel=1e-12)


def test_one_step_is_what_passes_both_interfaces_at_once():
    """T1 = 2 Z/(Z1 + Z) and T2 of 2, 3 and 5 kg/s: 6/5 and 10/8 of the jump."""
    bars = [Layer("bar", 1.0, z * z, 1.0, 1.0) for z in (2.0, 3.0, 5.0)]
    steps = staircase(Sandwich(*bars), 1)
    assert steps.first == pytest.approx([1.2], rel=1e-15)
    assert steps.second == pytest.approx([1.5], rel=1e-15)


def test_no_step_is_refused():
    with pytest.raises(ValueError, match="at least one step"):
        staircase(Sandwich(steel(0.1), alloy(0.02), steel(0.1)), 0)


def test_the_waves_climb_the_staircase_until_the_first_echo():
    """A jump on three different bars whose transits are whole steps: the delay lines are exact to rounding."""
    step = 50e-9
    lower = Layer("lower", 8500.0, 100e9, 5e-4, 0.1)
    bars = (steel(0.1), alloy(0.02), lower)
    counts = (400, 60, 380)
    bars = tuple(
        Layer(b.name, b.density, b.modulus, b.area, n * step * b.bar_speed) for b, n in zip(bars, counts, strict=True)
    )
    stack = Stack(bars, (BONDED, BONDED))
    jump = LoadPulse("rectangle", 2e4, 1.0)
    run = run_bar(stack, jump, [Tap(1, 0.0), Tap(1, 1.0)], 80e-6, WantedError(step=step))
    assert run.grid.counts == counts
    levels = staircase(Sandwich(*bars), 6)
    assert np.diff(levels.second).min() > 1e-6  # they do stand apart
    for k, (steps, heard) in enumerate(zip(levels, first_echoes(stack, 1), strict=True)):
        assert heard == pytest.approx((60 * k + min(800, 120 * (1 - k) + 760)) * step, rel=1e-12)
        for n, level in enumerate(steps):
            first, last = 400 + 60 * (2 * n + k), 400 + 60 * (2 * n + 2 + k) - 1
            last = min(last, 400 + round(heard / step) - 1)
            seen = run.force[first : last + 1, k] / 2e4
            assert seen == pytest.approx(level, abs=1e-12)


@pytest.mark.parametrize("end", ["free", "matched"])
def test_a_smooth_load_through_several_layers_until_the_first_echo(end):
    """Four bonded layers under a half-sine: closed form and waves agree until `first_echoes`, and no longer.

    The load is sampled every step of 10 ns, some 1/2000 of its duration, and joined by cubics: 1e-6 of its peak.
    """
    step, counts = 10e-9, (3000, 2500, 400, 1800)
    makers = (steel(0.1), round_bar("thin", material("45 steel"), 0.1, 0.02), alloy(0.1), steel(0.1))
    bars = tuple(
        Layer(b.name, b.density, b.modulus, b.area, n * step * b.bar_speed) for b, n in zip(makers, counts, strict=True)
    )
    stack = Stack(bars, (BONDED,) * 3, End(end))
    run = run_bar(stack, LoadPulse("half-sine", 1e4, 20e-6), [Tap(2, 0.0), Tap(2, 1.0)], 150e-6, WantedError(step=step))
    closed = endless_force(stack, 2, run.time, run.time, run.face_force)
    arrival = sum(counts[:2])
    for k, heard in enumerate(first_echoes(stack, 2)):
        last = arrival + round(heard / step)
        miss = np.abs(run.force[:, k] - closed[k]) / 1e4
        assert np.abs(run.force[:last, k]).max() > 2e3
        assert miss[:last].max() < 1e-6
        assert miss[last : last + 500].max() > 1e-3


def test_a_matched_end_sends_no_echo():
    bars = (steel(0.2), alloy(0.02), steel(0.05))
    free = first_echoes(Stack(bars, (BONDED, BONDED)), 1)
    matched = first_echoes(Stack(bars, (BONDED, BONDED), End("matched")), 1)
    assert free[1] == pytest.approx(bars[1].transit + 2.0 * bars[2].transit, rel=1e-15)
    assert matched == pytest.approx((2.0 * bars[0].transit, bars[1].transit + 2.0 * bars[0].transit), rel=1e-15)


@pytest.mark.parametrize("layer", [0, 2])
def test_an_outer_layer_has_no_staircase(layer):
    stack = Stack((steel(0.1), alloy(0.02), steel(0.1)), (BONDED, BONDED))
    with pytest.raises(ValueError, match="one neighbour"):
        endless_force(stack, layer, np.zeros(2), np.arange(2.0), np.ones(2))
