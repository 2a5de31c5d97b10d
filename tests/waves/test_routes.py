"""The paper's route in a stack, beside the exact solution; how many waves a sum counts, by hand."""

import dataclasses

import numpy as np
import pytest

from strikewave.waves import BONDED, Layer, LoadPulse, Stack, Tap, WantedError, li_ma, run_bar
from strikewave.waves.li_ma import (
    Sandwich,
    mean_acceleration,
    route_history,
    specimen_of,
    strain,
    too_many,
    too_thin,
    waves_that_count,
)

STEP = 0.125


def bar(name, transit, impedance, speed=1.0):
    return Layer(name, impedance / speed, impedance * speed, 1.0, transit * speed)


STACK = Stack(
    (bar("a", 9.0, 2.0), bar("b", 4.0, 2.0, 3.0), bar("specimen", 2.0, 1.0, 0.5), bar("c", 9.0, 3.0, 2.0)),
    (BONDED,) * 3,
)
"""Before the specimen nothing is thrown back: what comes is the force on the first face, after 13 s."""


@pytest.mark.parametrize("position", [0.0, 0.25, 1.0])
def test_the_corrected_route_is_the_stack_until_an_echo_comes_from_beyond(position):
    """Waves of whole steps are exact; a cubic through samples of 1/160 of a smooth load is off by some 1e-6 of it."""
    run = run_bar(STACK, LoadPulse("sine-squared", 7.0, 20.0), [Tap(2, position)], 20.9, WantedError(step=STEP))
    found = route_history(STACK, 2, position, run.time, run.face_force, "corrected")
    assert run.time[np.flatnonzero(run.force[:, 0] > 1e-12)[0]] == pytest.approx(13.0 + 2.0 * position, abs=2 * STEP)
    assert found.force == pytest.approx(run.force[:, 0], abs=1e-5 * 7.0)
    assert found.velocity == pytest.approx(run.velocity[:, 0], abs=1e-5 * 7.0)
    # at its foot the acceleration has a corner, which averages and cubics round within a step: 1/50 of the largest
    assert found.acceleration == pytest.approx(run.acceleration[:, 0], abs=8e-3)
    assert np.abs(found.acceleration).max() > 0.3
    printed = route_history(STACK, 2, position, run.time, run.face_force, "as printed")
    assert np.abs(printed.velocity - run.velocity[:, 0]).max() > 0.01


def test_the_first_and_the_last_layer_are_no_specimens():
    assert specimen_of(STACK, 0) is None
    assert specimen_of(STACK, 3) is None
    for k in (1, 2):
        assert specimen_of(STACK, k) == Sandwich(*STACK.layers[k - 1 : k + 2])
    for layer in (0, 3):
        with pytest.raises(ValueError, match=f"two fixtures; layer {layer} has one"):
            route_history(STACK, layer, 0.5, np.arange(3.0), np.ones(3), "corrected")


def test_layers_that_no_route_follows_are_named():
    """100 000 waves of 2e-5 s go by in 2 s, where echoes stay: behind an edge and before a wall."""
    films = [dataclasses.replace(bar("film", 2e-5, 1.0), name=name) for name in ("one", "two", "three", "four")]
    stack = Stack(
        (films[0], bar("x", 1.0, 1e-30), films[1], bar("y", 1.0, 1e-30), films[2], bar("z", 1.0, 2.0), films[3]),
        (BONDED,) * 6,
    )
    assert too_thin(stack, np.array([1.9])) == []
    assert too_thin(stack, np.array([2.1])) == ["two"]


@pytest.mark.parametrize(
    ("upper", "lower", "last", "count"),
    [
        (2.0, 3.0, 7.5, 9),  # the k-th comes (k - 2) t0 after the first at the earliest
        (2.0, 3.0, -1.0, 2),
        (2.0, 3.0, 0.5, 2),
        # |q| = 1/3 1/2: (1/6)^n falls below 1e-18 at n = 23.1; two waves each, and four more
        (2.0, 3.0, 1e4, 52),
        (1e-30, 1e-30, 1e4, 10_002),  # between free ends none dies
        (1.0, 3.0, 1e4, 6),  # none comes back
    ],
)
def test_waves_count_until_the_last_time_or_until_echoes_have_died(upper, lower, last, count):
    sandwich = Sandwich(bar("u", 1.0, upper), bar("s", 1.0, 1.0), bar("l", 1.0, lower))
    assert waves_that_count(sandwich, [0.2, last, 0.1]) == count if last > 0.2 else True
    assert waves_that_count(sandwich, [last]) == count


def test_waves_that_are_left_out_are_lost_in_rounding():
    """A long time after a jump all echoes are there: 2 Z2/(Z1 + Z2) of it, in force; sums over ten times as many agree."""
    sandwich = Sandwich(bar("u", 1.0, 9.0), bar("s", 1.0, 1.0), bar("l", 1.0, 7.0))  # q = 0.6
    jump = li_ma.Incident(np.ones_like, np.zeros_like)
    for route in li_ma.ROUTES:
        found = strain(sandwich, jump, 0.25, [1e4], route)[0]
        assert found == pytest.approx(9.0 * 2.0 * 7.0 / 16.0, rel=1e-15)


@pytest.mark.parametrize(
    ("waves", "added", "refused"), [(51, 1e9, True), (52, 1e9, False), (99, 155, True), (99, 156, False)]
)
def test_a_sum_of_too_many_waves_is_refused_before_it_begins(monkeypatch, waves, added, refused):
    """52 waves at three instants."""
    sandwich = Sandwich(bar("u", 1.0, 2.0), bar("film", 1.0, 1.0), bar("l", 1.0, 3.0))
    jump = li_ma.Incident(np.ones_like, np.zeros_like)
    monkeypatch.setattr(li_ma, "MOST_TRANSFERS", waves)
    monkeypatch.setattr(li_ma, "MOST_ADDED", added)
    times = np.array([1.0, 1e4, 2.0])
    assert too_many(sandwich, times) is refused
    if refused:
        with pytest.raises(ValueError, match=r"film is too thin.*52 waves would count, at 3 instants"):
            mean_acceleration(sandwich, jump, times, "corrected")


def test_a_sum_counts_a_hundred_thousand_waves_and_twenty_million_values():
    free = Sandwich(bar("u", 1.0, 1e-30), bar("s", 1.0, 1.0), bar("l", 1.0, 1e-30))
    assert [too_many(free, [last]) for last in (99_998.5, 99_999.5)] == [False, True]
    assert [too_many(free, np.full(size, 1998.5)) for size in (10_000, 10_001)] == [False, True]


def test_a_wave_smaller_than_the_last_bit_is_not_added():
    """1e-17 of the largest: its history is not even asked for."""
    asked = []

    def history(t):
        asked.append(t.tolist())
        return np.ones_like(t)

    sandwich = Sandwich(*(bar(name, 2.0, 1.0) for name in "usl"))
    waves = [(0.0, -3.0), (1.0, 2.9e-17), (2.0, 3.1e-17), (0.5, 4.0e-1)]
    found = li_ma._added(sandwich, history, np.array([0.0, 1.0, 4.5, 0.5]), waves)
    assert asked == [[1.0, 4.5, 0.5], [0.5], [3.5]]
    assert found == pytest.approx([0.0, -3.0, -2.6, -3.0], rel=1e-15)
    assert li_ma._added(sandwich, history, np.array([1.0]), []).tolist() == [0.0]


def test_fixtures_are_endless_until_the_nearer_far_end_is_heard():
    """Twice 5 s above, or twice the rest of 3 s and 1.5 s below."""
    sandwich = Sandwich(bar("u", 5.0, 2.0), bar("s", 3.0, 1.0), bar("l", 1.5, 3.0))
    assert [sandwich.valid_until(x) for x in (0.0, 0.25, 1.0)] == [9.0, 7.5, 3.0]
    assert Sandwich(bar("u", 1.0, 2.0), bar("s", 3.0, 1.0), bar("l", 1.5, 3.0)).valid_until(0.5) == 2.0
