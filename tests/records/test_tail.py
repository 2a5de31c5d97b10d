"""Tails after blows: levels that step, exact decays and coupling in closed form, each bound from both sides."""

import math

import numpy as np
import pytest

from strikewave.records import tail
from strikewave.records.baseline import LocalBaseline
from strikewave.records.measuring import RecordedPulse
from strikewave.records.pulse_shape import SmoothPulse
from strikewave.records.tail import Tail, TailModel, comes_to_rest, model_of, tail_of

STEP, START = 1e-3, 7.0
SMOOTH = SmoothPulse(3.0, START, 20.0 * STEP, 0.5, 1.0)


def blow(first, last, offset=0.0, slope=0.0, width=20.0):
    """Return a blow between two samples, its peak in the middle."""
    begin, end = START + STEP * first, START + STEP * last
    return RecordedPulse(
        *(0.5 * (begin + end), 3.0, math.nan, width * STEP, 0.06, math.nan, offset, 0.0, SMOOTH, "record", begin, end),
        LocalBaseline(offset, slope),
    )


def record(size, level, *blows):
    values = np.zeros(size)
    for one in blows:
        first, last = (round((time - START) / STEP) for time in (one.begin, one.end))
        values[first:last] = 3.0
        values[last:] = level
    return values


@pytest.mark.parametrize("tilt", [0.0, 0.01])
def test_a_level_after_a_blow_is_that_of_every_stretch(tilt):
    """Stretches of 20 samples and 1.15 times as long each, from 0.15 widths on: over a level c the velocity is that of
    the blow and c t, and Hann's weights are symmetric about the middle of each. A line under all changes nothing."""
    one = blow(100, 120, 5.0 + tilt * 110, tilt)
    values = record(344, 0.5, one) + 5.0 + tilt * np.arange(344)
    found = tail_of(values, STEP, START, [one])
    edges = np.array([123, 143, 166, 192, 222, 257, 297, 343])
    middles = 0.5 * (edges[:-2] + edges[2:] - 1)
    assert found.time == pytest.approx(STEP * (middles - 120), rel=1e-9)
    assert found.level == pytest.approx(np.full(6, 0.5), rel=1e-9)
    # the trapezoid of the steps at both ends adds half a step of what is beside them
    area = 3.0 * 20 - 0.5 * (3.0 - 0.5) + 0.5 * 3.0
    expected = STEP * (area + 0.5 * (middles - 120))
    assert found.velocity == pytest.approx(expected, rel=0.02)  # whichever rule the integral takes
    assert np.diff(found.velocity) == pytest.approx(STEP * 0.5 * np.diff(middles), rel=1e-9)
    assert found.one_side == 1.0
    earlier = values.copy()
    earlier[[30, 79]] += 50.0  # more than a width before the blow
    assert tail_of(earlier, STEP, START, [one]).velocity == pytest.approx(found.velocity)
    assert tail_of(earlier, STEP, START, [one]).moved == pytest.approx(found.moved)
    earlier[85] += 50.0
    assert tail_of(earlier, STEP, START, [one]).velocity == pytest.approx(found.velocity + 0.05)
    if not tilt:
        assert found.moved == pytest.approx(found.velocity, rel=1e-9)
    assert tail_of(values[:343], STEP, START, [one]) is None
    assert tail_of(values, STEP, START, []) is None


def test_the_longest_tail_is_taken_until_a_width_before_the_next_blow():
    blows = [blow(100, 120), blow(364, 384), blow(460, 480)]
    values = record(500, 0.5, *blows)
    found = tail_of(values, STEP, START, blows)
    assert found.time.size == 6  # 344 is a width before the second
    assert found.level == pytest.approx(np.full(6, 0.5))
    assert tail_of(values, STEP, START, [blow(100, 120), *([blow(363, 383), *blows[2:]])]) is None
    later = [blow(100, 120), blow(130, 150)]
    shifted = record(374, 0.5, *later)
    again = tail_of(shifted, STEP, START, later)
    assert again.time == pytest.approx(found.time)
    assert again.velocity - again.moved == pytest.approx(np.full(6, again.velocity[0] - again.moved[0]))
    assert again.velocity[0] > again.moved[0] + 0.03


def test_a_blow_that_is_cut_has_the_width_of_its_smooth_pulse():
    one = blow(100, 120, width=math.nan)
    wide = SMOOTH.width() / STEP
    found = tail_of(record(600, 0.5, one), STEP, START, [one])
    first, second = round(0.15 * wide), round(wide) + round(1.15 * wide)
    assert found.time[0] == pytest.approx(STEP * (first + 0.5 * (second - 1)))


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_side_of_a_tail_is_that_of_its_first_stretch(sign):
    """Of 43 samples from 123 on; ten of them lie on the other side, and what comes after does not count."""
    one = blow(100, 120)
    values = record(344, 0.5, one)
    values[123:133], values[166:192] = -0.1, -0.4
    found = tail_of(sign * values, STEP, START, [one])
    assert found.one_side == pytest.approx(33.0 / 43.0)


def test_a_blow_of_a_sample_has_stretches_of_two():
    """Two samples, and 1.15 times as many each, rounded."""
    one = blow(100, 101, width=1.0)
    found = tail_of(record(160, 0.5, one), STEP, START, [one])
    sizes = [round(2.0 * 1.15**k) for k in range(40)]
    edges = 101 + np.cumsum([0, *sizes])
    edges = edges[edges <= 160]
    assert found.time == pytest.approx(STEP * (0.5 * (edges[:-2] + edges[2:] - 1) - 101))


def test_the_slope_is_carried_on_where_later_baselines_lie_on_it():
    first = blow(100, 120, -6.0, 0.1)
    at = [(blow(300, 320, 6.0 * later - 6.0), 0.1 if later > 1.7 else 0.0) for later in (3.4, 1.75, 1.65, 0.0)]
    for later, slope in at:
        assert tail._carried_slope([first, later], STEP) == slope
    assert tail._carried_slope([first], STEP) == 0.1


TIME = STEP * np.arange(1.0, 31.0)


def exact(constant, share=1.0):
    """Return a tail that a high-pass makes, y = -v / tau, times a share."""
    decay = np.exp(-TIME / constant)
    return Tail(TIME, -2.0 * share * decay, 2.0 * constant * decay)


@pytest.mark.parametrize("constant", [2e-3, 8e-3, 25e-3])
def test_coupling_is_known_exactly_where_nothing_else_is(constant):
    found = model_of(exact(constant))
    assert found.kind == "ac-coupling"
    assert found.constant == pytest.approx(constant, rel=1e-9)
    assert found.level == pytest.approx(-2.0 * math.exp(-TIME[0] / constant), rel=1e-9)
    assert found.constant_error == pytest.approx(0.0, abs=1e-9 * constant)
    assert found.explained == pytest.approx(1.0)
    assert math.isnan(found.level_error)


def test_the_error_of_a_time_constant_is_that_of_a_slope(rng):
    """Level over velocity is a regression through the origin: rate and its standard error, carried to 1 / rate."""
    noisy = exact(8e-3)
    rest = 0.02 * (-1.0) ** np.arange(30)
    noisy = noisy._replace(level=noisy.level + rest)
    found = model_of(noisy)
    v, y = noisy.velocity, noisy.level
    rate = -np.sum(v * y) / np.sum(v**2)
    left = np.sum((y + rate * v) ** 2)
    assert found.kind == "ac-coupling"
    assert found.constant == pytest.approx(1.0 / rate, rel=1e-9)
    assert found.constant_error == pytest.approx(math.sqrt(left / 29 / np.sum(v**2)) / rate**2, rel=1e-6)
    assert found.explained == pytest.approx(1.0 - left / np.sum(y**2), rel=1e-9)


@pytest.mark.parametrize(("constant", "coupled"), [(61e-3, False), (59e-3, True)])
def test_half_a_time_constant_must_be_seen(constant, coupled):
    assert (tail._coupled(exact(constant)) is not None) is coupled


@pytest.mark.parametrize(("late", "seen"), [(4.9, True), (5.1, False)])
def test_coupling_is_looked_at_over_five_time_constants(late, seen):
    """What comes after that, where the velocity is back at zero, is not explained and need not be."""
    constant = 3.01e-3
    decay = np.where(late * constant > TIME, np.exp(-TIME / constant), 0.0)
    level = -2.0 * decay
    level[int(late * constant / STEP)] += 0.3 * seen  # one within
    level[18:24] = 0.4
    found = model_of(Tail(TIME, level, 2.0 * constant * decay))
    assert found.kind == "ac-coupling"
    assert (found.explained < 1.0 - 1e-6) is seen


@pytest.mark.parametrize(("share", "coupled"), [(0.69, False), (0.71, True), (1.38, True), (1.42, False)])
def test_the_amplitude_of_a_free_decay_is_tied_to_its_velocity(share, coupled):
    """0.7 to 1.4 of what it demands, where it is not seen whole: the decay is one of those that are tried."""
    constant = np.geomspace(0.5 * TIME[1], 3.0 * TIME[-1], 120)[82]
    assert 0.5 / share < TIME[-1] / constant < 3.0 / share
    decay = np.exp(-TIME / constant)
    found = tail._coupled(Tail(TIME, -2.0 * share * decay, 2.0 * constant * decay))
    assert (found is not None) is coupled


def test_coupling_of_the_wrong_sign_or_none_is_no_coupling():
    assert tail._coupled(exact(8e-3, -1.0)) is None
    assert tail._coupled(Tail(TIME, 0.0 * TIME, 0.0 * TIME)) is None
    assert tail._coupled(Tail(TIME, np.full(30, -1.0), np.full(30, 8e-3))) is None


@pytest.mark.parametrize("constant", [2e-3, 10e-3])
def test_a_decay_of_its_own_is_found_between_the_constants_that_are_tried(constant):
    """120 of them from half the second time to three times the last, 4.4 % apart."""
    fitted, found = tail._decay(TIME, 5.0 * np.exp(-TIME / constant))
    assert np.min(np.abs(np.geomspace(0.5 * TIME[1], 3.0 * TIME[-1], 120) / found - 1.0)) < 1e-12
    assert found == pytest.approx(constant, rel=0.023)
    assert fitted == pytest.approx(5.0 * np.exp(-TIME / constant), abs=0.06)
    model = model_of(Tail(TIME, 5.0 * np.exp(-TIME / constant), 0.02 + 0.0 * TIME))
    assert model.kind == "decay"
    assert model.constant == found
    assert model.level == fitted[0]
    assert model.explained > 0.99
    for end, value in ((0, 0.5 * TIME[1]), (-1, 3.0 * TIME[-1])):
        assert tail._decay(TIME, np.exp(-TIME / (1e-9 if end == 0 else 1e9)))[1] == pytest.approx(value)


def test_a_quick_decay_on_both_sides_is_motion():
    level = 5.0 * np.exp(-TIME / 2.5e-3)
    for one_side, constant, kind in ((0.84, 2.5e-3, "motion"), (0.86, 2.5e-3, "decay"), (0.84, 3.5e-3, "decay")):
        level = 5.0 * np.exp(-TIME / constant)
        assert model_of(Tail(TIME, level, 0.02 + 0.0 * TIME, one_side)).kind == kind


@pytest.mark.parametrize("kind", ["shift", "line"])
def test_a_shift_and_a_line_with_their_standard_errors(kind):
    column = np.ones(30) if kind == "shift" else TIME / TIME[-1]
    rest = 0.05 * (-1.0) ** np.arange(30)
    level = 2.0 * column + rest
    found = model_of(Tail(TIME, level, 0.02 + 0.0 * TIME))
    fitted = np.sum(level * column) / np.sum(column**2)
    left = np.sum((level - fitted * column) ** 2)
    assert found.kind == kind
    assert found.level == pytest.approx(fitted, rel=1e-9)
    assert found.level_error == pytest.approx(math.sqrt(left / 28 / 30), rel=1e-9)
    assert found.explained == pytest.approx(1.0 - left / np.sum(level**2), rel=1e-9)


def test_a_shift_beside_values_that_resemble_the_next_is_known_less_well():
    """Of neighbours that are alike by r the mean is as uncertain as of (1 - r) / (1 + r) as many."""
    level = 2.0 + 0.05 * np.array([1.0, 1.0, 1.0, -1.0, -1.0, -1.0] * 5)
    found = model_of(Tail(TIME, level, 0.02 + 0.0 * TIME))
    rest = level - level.mean()
    alike = np.sum(rest[1:] * rest[:-1]) / np.sum(rest**2)
    assert alike == pytest.approx(11.0 / 30.0)
    assert found.kind == "shift"
    assert found.level_error == pytest.approx(
        math.sqrt(np.sum(rest**2) / 28 / 30 * (1.0 + alike) / (1.0 - alike)), rel=1e-9
    )


def test_a_decay_costs_two_parameters_and_one_of_the_zero():
    """Beside values that alternate about it: 27 of 30 are left for its standard error."""
    level = 5.0 * np.exp(-TIME / 4e-3) + 0.05 * (-1.0) ** np.arange(30)
    found = model_of(Tail(TIME, level, 0.02 + 0.0 * TIME))
    column = np.exp(-TIME / found.constant)
    fitted = np.sum(level * column) / np.sum(column**2) * column
    left = np.sum((level - fitted) ** 2)
    assert (found.kind, found.level) == ("decay", pytest.approx(fitted[0], rel=1e-9))
    assert found.level_error == pytest.approx(math.sqrt(left / 27 / 30), rel=1e-9)
    assert found.explained == pytest.approx(1.0 - left / np.sum(level**2), rel=1e-9)


def test_a_shift_is_there_at_once_to_half():
    for begin, kind in ((1.1, "shift"), (0.8, "motion")):
        level = np.r_[np.full(3, begin), np.full(27, 2.0)]  # the mean of all is near 1.9
        assert model_of(Tail(TIME, level, 0.02 + 0.0 * TIME)).kind == kind


def test_nothing_is_rest():
    assert model_of(Tail(TIME, 0.0 * TIME, 0.02 + 0.0 * TIME)) == TailModel("rest")
    assert model_of(Tail(TIME, 0.1 * (-1.0) ** np.arange(30), 0.02 + 0.0 * TIME)).kind == "rest"
    # a shift s of noise 1 gains n log(1 + s^2) for 4 log n: s^2 = 0.574 of 30
    for share, kind in ((0.70, "rest"), (0.82, "shift")):
        level = 0.1 * (-1.0) ** np.arange(30) + 0.1 * share
        assert model_of(Tail(TIME, level, 0.02 + 0.0 * TIME)).kind in (kind, "motion" if kind == "shift" else kind)


def bounced(depth, back, last=0.0):
    """Return a tail whose velocity goes from 1 through -depth to -back in the middle, and on with a slope."""
    velocity = np.r_[np.linspace(1.0, -depth, 10), np.linspace(-depth, -back, 11)[1:], np.full(10, -back)]
    velocity[20:] += last * np.arange(10)
    return Tail(TIME, 0.0 * TIME, velocity)


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(("depth", "back", "rests"), [(0.3, 0.05, True), (0.24, 0.0, False), (0.26, 0.0, True)])
def test_what_is_stopped_comes_to_rest(depth, back, rests, sign):
    for share in (1.0, 0.19, 0.21):
        found = bounced(depth, depth * share if share != 1.0 else back)
        found = found._replace(velocity=sign * found.velocity)
        assert comes_to_rest(found) is (rests and share != 0.21)


def test_of_six_stretches_the_last_two_show_where_a_record_stands():
    """It is pushed back by 1.9 a stretch; over the last three it would stand 0.4 off its zero, over two not at all."""
    time, velocity = np.arange(1.0, 7.0), np.array([5.0, -3.0, -4.0, -1.0, -0.2, -0.2])
    assert tail.comes_to_rest(Tail(time, 0.0 * time, velocity))
    assert tail.comes_to_rest(Tail(time, 0.0 * time, -velocity))
    velocity[-1] = 0.3
    assert not tail.comes_to_rest(Tail(time, 0.0 * time, velocity))


def test_a_push_is_five_times_what_the_record_stands_off():
    """Back from -1 to -0.2 in eight steps of 0.1, and 0.019 or 0.021 a step at last."""
    for slope, rests in ((0.0195, True), (0.0205, False)):
        for sign in (1.0, -1.0):
            assert comes_to_rest(bounced(1.0, 0.0, sign * slope)) is rests


def test_the_last_third_of_a_tail():
    level = np.r_[np.full(20, 9.0), np.tile([1.0, 3.0], 5)]
    mean, error = tail._at_last(Tail(TIME, level, level))
    assert mean == 2.0
    assert error == pytest.approx(math.sqrt(10.0 / 9.0) / math.sqrt(10.0))
    few = np.array([9.0, 9.0, 9.0, 9.0, 3.0, 5.0])  # two at least
    assert tail._at_last(Tail(TIME[:6], few, few)) == (4.0, pytest.approx(1.0))
    assert tail._at_last(Tail(TIME[:5], few[1:], few[1:])) == (4.0, pytest.approx(1.0))
    at_rest = model_of(bounced(1.0, 0.0)._replace(level=level))
    assert (at_rest.kind, at_rest.level, at_rest.level_error) == ("motion", mean, error)  # six errors are 2.0
    assert model_of(bounced(1.0, 0.0)._replace(level=level + 0.1)).kind == "shift"


@pytest.mark.parametrize("constant", [2e-3, 10e-3])
def test_what_a_tail_does_is_the_same_in_any_unit(constant):
    rest = 0.02 * np.cos(7.0 * np.arange(30))
    for level, velocity in (
        (-2.0 * np.exp(-TIME / constant) + rest, 2.0 * constant * np.exp(-TIME / constant)),
        (2.0 + rest, 0.02 + 0.0 * TIME),
        (TIME / TIME[-1] + rest, 0.02 + 0.0 * TIME),
        (5.0 * np.exp(-TIME / constant) + rest, 0.02 + 0.0 * TIME),
        (rest, 0.02 + 0.0 * TIME),
    ):
        one, small = model_of(Tail(TIME, level, velocity)), model_of(Tail(TIME, 1e-9 * level, 1e-9 * velocity))
        assert (small.kind, small.explained) == (one.kind, pytest.approx(one.explained))
        assert small.level == pytest.approx(1e-9 * one.level, rel=1e-9, abs=0.0)
        assert small.level_error == pytest.approx(1e-9 * one.level_error, rel=1e-9, abs=0.0, nan_ok=True)
        assert (small.constant, small.constant_error) == pytest.approx((one.constant, one.constant_error), nan_ok=True)
