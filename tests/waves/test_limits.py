"""Limits of one-dimensional theory by hand: round numbers of density, modulus and area give Z = 2, c = 2, t = l/2."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from strikewave.waves import BONDED, End, Joint, Layer, Stack, Tap, TimeGrid
from strikewave.waves.layers import Branch, LossFit
from strikewave.waves.limits import (
    arrival_time,
    bar_extremes,
    end_notices,
    field_extremes,
    grid_notices,
    honest_bandwidth,
    joint_notices,
    layer_notices,
    loss_notices,
    not_reached_notices,
    rise_in_diameters,
    rise_notices,
)
from strikewave.waves.transit import LayerUsed, wave_setup


def layer(name, length, diameter=1.0, modulus=4.0, **more):
    return Layer(name, 1.0, modulus, 1.0, length, diameter, **more)


UPPER, LOWER = layer("upper", 4.0), layer("lower", 6.0, 2.0)
STACK = Stack((UPPER, LOWER), (BONDED,))


def told(notices):
    return [(one.code, one.value, one.limit) for one in notices]


def test_the_thickest_and_slowest_layer_sets_the_rise():
    assert honest_bandwidth(STACK) == pytest.approx(0.35 * 2.0 / (5.0 * 2.0), rel=1e-15)
    ratio, which = rise_in_diameters(STACK, 3.0, 0.35 / 4.0)  # hypot(3, 4) = 5
    assert (ratio, which.name) == (pytest.approx(5.0, rel=1e-15), "lower")


@pytest.mark.parametrize(
    ("dispersion", "rise", "code", "limit"),
    [
        ("none", 1.9, "rise-too-steep", 2.0),
        ("none", 2.1, "rise-steep", 5.0),
        ("none", 4.9, "rise-steep", 5.0),
        ("none", 5.1, None, None),
        ("love-rayleigh", 1.9, "rise-too-steep", 2.0),
        ("pochhammer-chree", 0.9, "rise-too-steep", 1.0),
        ("pochhammer-chree", 1.1, "rise-steep", 2.0),
        ("pochhammer-chree", 2.1, None, None),
    ],
)
def test_a_peak_is_refused_below_two_diameters_and_warned_of_below_five(dispersion, rise, code, limit):
    stack = Stack((layer("bar", 4.0, 2.0, dispersion=dispersion, poissons_ratio=0.3),))  # t c/d = t
    found = list(rise_notices(stack, rise, math.inf))
    assert told(found) == ([] if code is None else [(code, pytest.approx(rise), limit)])


def test_the_bandwidth_that_is_named_gives_the_rise_that_is_quoted():
    """0.35/B = sqrt(2^2 - 1.2^2) = 1.6: B = 0.21875 Hz, rounded down to two digits."""
    (found,) = rise_notices(Stack((layer("bar", 4.0, 2.0),)), 1.2, math.inf, 2.0 * 9.80665)
    assert 'solver.bandwidth="0.00021 kHz"' in found.message
    assert "would say 2\xa0g" in found.message
    assert "a rise of 1200000 us is 1.2 diameters of travel in bar" in found.message


def test_layers_shorter_than_thick_beyond_yield_or_strained_by_a_tenth():
    stack = Stack(
        (layer("disc", 0.5, yield_strength=0.3), layer("coin", 0.25, yield_strength=0.3), layer("bar", 1.0)),
        (BONDED, BONDED),
    )
    found = told(layer_notices(stack, np.array([0.3, 0.31, 0.4])))
    assert found == [("short-layer", 0.25, 1.0), ("stress-yield", 0.31, 0.3)]
    assert told(layer_notices(stack, np.array([0.0, 0.0, 0.41])))[1:] == [("strain-large", 0.41, 0.4)]
    wide = Stack((Layer("wide", 1.0, 4.0, 2.0, 3.0, 1.0, 3.0),))
    (found,) = layer_notices(wide, np.array([8.0]))
    assert (found.code, found.value) == ("stress-yield", 4.0)
    assert "a wave of 1.5\xa0m/s" in found.message  # stress over rho c


@pytest.mark.parametrize(
    ("joint", "least", "greatest", "expected"),
    [
        (BONDED, -0.2, 10.0, [("joint-tension", 0.2, 0.1)]),
        (BONDED, -0.09, 10.0, []),
        (BONDED, -20.0, 10.0, [("joint-tension", 20.0, 0.2)]),
        (Joint(stiffness=1.0, yield_force=5.0), 0.0, 4.9, []),
        (Joint(stiffness=1.0, yield_force=5.0), 0.0, 5.1, [("gasket-yield", 5.1, 5.0)]),
        (Joint(stiffness=1.0, yield_force=5.0), -6.0, 1.0, [("gasket-yield", 6.0, 5.0), ("joint-tension", 6.0, 0.06)]),
        (Joint(unilateral=True), -1.0, 1.0, []),
        (Joint(unilateral=True, gap=1e-3), 0.0, 2.0, [("joint-gap", 2.0, 0.0)]),
        (Joint(unilateral=True, preload=3.0), -3.0, 2.0, [("joint-opened", -3.0, -3.0)]),
        (Joint(unilateral=True, preload=3.0), -2.9, 2.0, []),
    ],
)
def test_what_joints_could_not_do(joint, least, greatest, expected):
    stack = Stack((UPPER, LOWER), (joint,))
    found = told(joint_notices(stack, np.array([least]), np.array([greatest])))
    assert found == [(code, pytest.approx(value), pytest.approx(limit)) for code, value, limit in expected]


def test_tension_is_held_against_the_load_and_told_of_the_largest():
    stack = Stack((UPPER, LOWER, UPPER), (BONDED, BONDED))
    assert not list(joint_notices(stack, np.array([-0.9, 0.0]), np.zeros(2), 100.0))
    (found,) = joint_notices(stack, np.array([-2.0, -3.0]), np.ones(2), 100.0)
    assert (found.value, found.limit) == (3.0, 1.0)
    assert "between upper and lower (0.002\xa0kN)" in found.message
    assert "lower and upper (0.003" in found.message
    closes = Joint(unilateral=True, gap=1e-3)
    words = [
        next(iter(joint_notices(Stack((UPPER, LOWER), (closes,)), np.zeros(1), np.array([most])))).message
        for most in (0.0, 1.0)
    ]
    assert "stays open" in words[0]
    assert "closes" in words[1]
    assert "1000\xa0um" in words[0]


def test_losses_steps_and_ends_are_told_beyond_their_limits():
    row = ("bar", 0.2, 0.06, 1e3, 1e5)
    assert told(loss_notices([row, ("bar", 0.2, 0.05, 1e3, 1e5)])) == [("loss-fit", 0.06, 0.05)]
    assert "1\xa0kHz to 100\xa0kHz" in next(iter(loss_notices([row]))).message
    assert not list(grid_notices(TimeGrid(1.0, (1,), 0.01)))
    assert told(grid_notices(TimeGrid(1.0, (1,), 0.02))) == [("coarse-step", 0.02, 0.01)]
    matched = Stack((UPPER, LOWER), (BONDED,), End("matched"))
    assert told(end_notices(matched, 6.1)) == [("matched-end", 6.0, 6.1)]
    assert not list(end_notices(matched, 6.0))
    assert not list(end_notices(STACK, 9.0))


def test_a_wave_comes_from_the_nearest_face_and_loss_makes_its_front_faster():
    assert [arrival_time(STACK, *at) for at in ((0, 0.5), (1, 0.0), (1, 0.5), (1, 1.0))] == [1.0, 2.0, 3.5, 5.0]
    assert [arrival_time(STACK, 0, 0.5, faces) for faces in ((1,), (2,), (0, 1, 2), ())] == [1.0, 4.0, 1.0, math.inf]
    loss = LossFit(0.75, (Branch(1.5, 1.0), Branch(1.75, 2.0)), 0.0, (1.0, 2.0))  # together 4: twice as fast
    fast = Stack((layer("fast", 4.0, loss=loss), LOWER), (BONDED,))
    assert arrival_time(fast, 1, 0.5) == 1.0 + 1.5


def test_places_that_no_wave_reaches_are_named_with_the_longest_way():
    taps = [("near", Tap(0, 1.0)), ("far", Tap(1, 0.5))]
    (found,) = not_reached_notices(STACK, taps, 2.0, "solver.duration = 2 s")
    assert (found.code, found.value, found.limit) == ("not-reached", 2.0, 3.5)
    assert "tap far" in found.message
    assert "layer lower" in found.message
    assert "near" not in found.message
    assert "layer upper" not in found.message
    (found,) = not_reached_notices(STACK, taps, 4.0, "", begin=1.0)
    assert (found.limit, "layer" in found.message) == (4.5, False)
    assert not list(not_reached_notices(STACK, taps, 3.5, ""))
    assert not list(not_reached_notices(STACK, taps, 0.1, "", faces=()))
    (found,) = not_reached_notices(STACK, taps, 1.0, "", faces=(2,))  # from behind: far 1.5, near and upper 3
    assert found.limit == 3.0
    (found,) = not_reached_notices(STACK, [], 2.99, "", faces=(2,))  # its rear face, nearest, after 3
    assert "layer upper" in found.message
    assert not list(not_reached_notices(STACK, [], 3.01, "", faces=(2,)))
    assert not list(not_reached_notices(STACK, [], 2.01, ""))  # the lower layer begins after 2
    assert len(list(not_reached_notices(STACK, [], 1.99, ""))) == 1


def test_a_field_of_three_layers_is_read_beyond_their_ends_and_at_both_joints():
    """Layers end at 4, 10 and 14 m; a place that lies behind the last face by rounding belongs to the last layer."""
    stack = Stack((UPPER, LOWER, UPPER), (BONDED, BONDED))
    position = np.array([1.0, 4.0, 9.9, 12.0, 14.0000001])
    force = np.array([[1.0, -2.0, 3.0, -4.0, 5.0], [0.0, 6.0, -7.0, 0.0, -8.0]])
    assert [part.tolist() for part in field_extremes(stack, position, force)] == [
        [6.0, 7.0, 8.0],
        [-2.0, -7.0],
        [6.0, 3.0],
    ]


def test_small_gaps_preloads_and_forces_count_like_large_ones():
    small = [
        (Joint(unilateral=True, gap=1e-6), 0.0, 5e-3, [("joint-gap", 5e-3, 0.0)], "closes"),
        (Joint(unilateral=True, preload=5e-3), -5e-3, 0.0, [("joint-opened", -5e-3, -5e-3)], "opens"),
        (BONDED, -2e-5, 1e-3, [("joint-tension", 2e-5, 1e-5)], "tension"),
    ]
    for joint, least, greatest, expected, word in small:
        (found,) = joint_notices(Stack((UPPER, LOWER), (joint,)), np.array([least]), np.array([greatest]))
        assert told([found]) == [(code, pytest.approx(value), pytest.approx(limit)) for code, value, limit in expected]
        assert word in found.message


@pytest.mark.parametrize(("missing", "opens"), [(0.9e-9, True), (1.1e-9, False)])
def test_a_preload_is_reached_to_a_billionth(missing, opens):
    stack = Stack((UPPER, LOWER), (Joint(unilateral=True, preload=3.0),))
    assert len(list(joint_notices(stack, np.array([-3.0 * (1.0 - missing)]), np.ones(1)))) == opens


def test_a_place_on_a_face_belongs_to_the_layer_before_to_a_millionth_of_a_millionth():
    """4 m, a little more, and a little more than that."""
    for more, layers in ((0.9e-12, [7.0, 0.0]), (1.1e-12, [0.0, 7.0])):
        found = field_extremes(STACK, np.array([4.0 * (1.0 + more)]), np.array([[7.0]]))
        assert found[0].tolist() == layers


def test_names_are_five_at_most():
    stack = Stack(tuple(layer(f"disc {k}", 0.5) for k in range(7)), (BONDED,) * 6)
    (found,) = layer_notices(stack, np.zeros(7))
    assert "disc 4" in found.message
    assert "disc 5" not in found.message
    assert found.value == 0.5


def test_a_quotable_bandwidth_is_rounded_down_to_two_digits():
    """2 d/c = 2 s at 0.35/B alone: 0.175 Hz. What is two digits itself goes
    down too, lest rounding lies above what it may be."""
    (found,) = rise_notices(Stack((layer("bar", 4.0, 2.0),)), 0.0, 1e9)
    assert 'bandwidth="0.00017 kHz"' in found.message
    for more, expected in ((0.0, "0.16"), (1.5e-9 / 17.0, "0.17"), (0.05, "0.17")):
        diameter = 0.35 / (170.0 * (1.0 + more))  # d/c is half of it, and two of these are 0.35/B
        (found,) = rise_notices(Stack((layer("bar", 4.0, diameter),)), 0.0, 1e12)
        assert f'bandwidth="{expected} kHz"' in found.message


def test_extremes_of_layers_and_joints_by_hand():
    run = SimpleNamespace(
        face_least=np.array([[-1.0, -2.0], [-3.0, -9.0], [-4.0, -0.5]]),
        face_greatest=np.array([[5.0, 4.0], [7.0, 6.0], [6.5, 12.0]]),
        field_layer=np.array([0, 0, 1, 2]),
        field_least=np.array([-8.0, 0.0, -2.0, 0.0]),
        field_greatest=np.array([1.0, 6.0, 0.0, 13.0]),
    )
    assert [part.tolist() for part in bar_extremes(run)] == [[8.0, 9.0, 13.0], [-3.0, -9.0], [7.0, 6.5]]
    position = np.array([0.0, 4.0, 4.001, 10.0])
    force = np.array([[1.0, -2.0, 3.0, 0.0], [0.5, 4.0, -5.0, 6.0]])
    assert [part.tolist() for part in field_extremes(STACK, position, force)] == [[4.0, 6.0], [-2.0], [4.0]]


def test_layers_as_used_have_their_steps_lengths():
    setup = wave_setup(STACK, TimeGrid(0.5, (4, 5), 0.25))
    assert (setup.step, setup.mismatch) == (0.5, 0.25)
    assert setup.layers == (LayerUsed("upper", 4.0, 4.0, 4), LayerUsed("lower", 6.0, 5.0, 5))
