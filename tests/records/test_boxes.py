"""The search for blows: lines and noise against scipy, boxes and humps worked by hand, each bound from both sides."""

import itertools
import math

import numpy as np
import pytest
from scipy.stats import norm, siegelslopes

from strikewave.records import contacts
from strikewave.records._pulse_kernels import strongest_boxes
from strikewave.records.contacts import Baseline, Box, BoxGrid, find_boxes, robust_line, sample_noise

FLAT = Baseline(0.0, 0.0)


def with_values(size, *parts):
    """Return zeros with values put in: first, one past the last, value."""
    values = np.zeros(size)
    for first, last, value in parts:
        values[first:last] = value
    return values


def test_the_robust_line_is_that_of_siegel_over_medians_of_blocks(rng):
    values = np.cumsum(rng.normal(size=323))
    middles = np.median(values[:320].reshape(64, 5), axis=1)
    slope, level = siegelslopes(middles, 2.0 + 5.0 * np.arange(64))
    assert robust_line(values) == pytest.approx((level, slope), rel=1e-12)


def test_long_blocks_are_thinned_and_two_blocks_give_a_level(monkeypatch):
    assert robust_line(np.array([1.0, 1.0, 2.0, 2.0]), 2) == (1.5, 0.0)
    assert robust_line(np.array([1.0, 2.0, 3.0]), 3) == pytest.approx((1.0, 1.0))
    monkeypatch.setattr(contacts, "LINE_SAMPLES", 4)
    values = np.zeros(24)
    values[1::2] = 9.0  # no median of every second sample sees them
    assert robust_line(values, 3) == (0.0, 0.0)
    monkeypatch.setattr(contacts, "LINE_SAMPLES", 8)
    assert robust_line(values, 3) == (4.5, 0.0)


def test_noise_is_that_of_normal_jumps_or_of_a_rounding_step(monkeypatch):
    assert sample_noise(np.tile([0.0, 2.0], 20)) == pytest.approx(2.0 / norm.ppf(0.75) / math.sqrt(2.0), rel=1e-4)
    assert sample_noise(np.repeat([0.0, 0.5, 2.0, 1.0], 5)) == pytest.approx(0.5 / math.sqrt(12.0))
    assert sample_noise(np.zeros(9)) == 0.0
    monkeypatch.setattr(contacts, "NOISE_SAMPLES", 8)
    values = np.repeat(np.arange(8.0), 3)
    values[0::3] += 2.0  # jumps of 2 within each three, of which the first is taken
    values[2::3] += 50.0
    assert sample_noise(values) == pytest.approx(2.0 / norm.ppf(0.75) / math.sqrt(2.0), rel=1e-4)


def test_the_strongest_boxes_of_rectangles_on_a_line():
    values = with_values(60, (10, 15, 2.0), (30, 35, -3.0), (40, 45, 1.0), (55, 60, 1.5)) + 3.0 + 0.5 * np.arange(60)
    room = np.zeros((9, 2))

    def found(sign, least, rows=room):
        return rows[: strongest_boxes(values, 3.0, 0.5, 5, sign, least, rows)].tolist()

    assert found(1, 0.5) == [[10.0, 2.0], [40.0, 1.0], [55.0, 1.5]]
    assert found(1, 1.0) == [[10.0, 2.0], [55.0, 1.5]]  # above, not at
    assert found(1, 1.5) == [[10.0, 2.0]]
    assert found(-1, 0.5) == [[30.0, 3.0]]
    assert found(1, 0.5, np.zeros((1, 2))) == [[10.0, 2.0]]
    assert found(1, 0.5, np.zeros((2, 2))) == [[10.0, 2.0], [40.0, 1.0]]


@pytest.mark.parametrize(("apart", "count"), [(5, 2), (4, 1)])
def test_maxima_closer_than_a_box_are_one(apart, count):
    values = with_values(40, (10, 11, 5.0), (10 + apart, 11 + apart, 5.0))
    assert strongest_boxes(values, 0.0, 0.0, 3, 1, 0.1, np.empty((9, 2))) == (2 if apart >= 3 else 1)
    assert strongest_boxes(values, 0.0, 0.0, 5, 1, 0.1, np.empty((9, 2))) == count


def test_widths_are_half_an_octave_apart_up_to_a_third():
    assert contacts._widths(30) == [3, 4, 6, 8]
    assert contacts._widths(36) == [3, 4, 6, 8, 12]
    assert contacts._widths(4) == [3]
    for size in (100, 1000, 8901, 8911, 50_001):
        widths = contacts._widths(size)
        assert widths[-1] <= size // 3 < math.sqrt(2.0) * widths[-1] + 1.0
        assert all(abs(wide / narrow - math.sqrt(2.0)) < 0.7 / narrow for narrow, wide in itertools.pairwise(widths))


def test_noise_passes_the_threshold_in_one_record_of_a_hundred():
    assert norm.sf(contacts._threshold(500.0)) * 40 * 500 == pytest.approx(0.01, rel=1e-9)
    assert contacts._threshold(0.2) == contacts._threshold(1.0)


def test_means_over_boxes_lose_the_line(monkeypatch):
    values = 3.0 + 0.5 * np.arange(23) + np.repeat([1.0, 2.0, 3.0, 4.0, 9.0], 5)[:23]
    assert contacts._box_means(values, Baseline(3.0, 0.5), 5).tolist() == [1.0, 2.0, 3.0, 4.0]
    monkeypatch.setattr(contacts, "MEAN_SAMPLES", 10)
    assert contacts._box_means(values, Baseline(3.0, 0.5), 5).tolist() == [1.0, 3.0]


def test_the_deepest_box_below_a_line():
    line = Baseline(3.0, 0.5)
    values = with_values(40, (12, 16, -4.0), (30, 31, 6.0)) + line.at(np.arange(40))
    assert contacts._deepest(values, line, 1, 10, 20, 2) == 4.0
    assert contacts._deepest(values, line, 1, 14, 20, 4) == 2.0
    assert contacts._deepest(values, line, -1, 20, 40, 2) == 3.0
    assert contacts._deepest(values, line, 1, 12, 14, 2) == 4.0
    assert contacts._deepest(values, line, 1, 12, 14, 3) == 0.0


def test_boxes_touch_within_three_tenths_of_a_width():
    grid = BoxGrid(10)
    grid.add(Box(10, 10, 1.0))
    beside = {22: True, 23: False}, {3: True, 2: False}  # last of these are 8 and 7
    for first, touches in (*beside[0].items(), *beside[1].items()):
        assert contacts._touches(Box(first, 5, 1.0), grid) is touches, first


def test_all_boxes_within_reach_are_near_and_few_others(rng):
    grid = BoxGrid(10)
    boxes = [
        Box(int(first), int(width), 1.0)
        for first, width in zip(rng.integers(0, 500, 80), rng.integers(1, 11, 80), strict=False)
    ]
    for box in boxes:
        grid.add(box)
    for first, reach in ((0, 3.5), (95, 0.0), (250, 12.5), (490, 1.0)):
        seen = list(grid.near(Box(first, 7, 1.0), reach))
        assert all(first - reach - 20 <= b.first <= first + 7 + reach + 10 for b in seen)
        assert {b for b in boxes if b.first <= first + 7 + reach and b.last >= first - reach} <= set(seen)


def test_the_second_hump_stands_highest_over_the_valley_between():
    part = np.array([9.0, 0.0, 5.0, 1.0, 3.0, 2.0, 4.5, 0.0, 9.0])
    assert contacts._second_hump(part, slice(1, 8), 2, 1) == (6, 3)
    assert contacts._second_hump(part[::-1], slice(1, 8), 6, -1) == (2, 5)


def test_a_hump_ends_at_half_its_height_or_in_the_valley():
    part = np.array([0.0, 1.0, 2.0, 4.0, 2.0, 1.0, 0.0, 3.0, 6.0, 3.0, 0.0])
    assert contacts._hump_box(part, part, 3, 6) == (2, 3, pytest.approx(8.0 / 3.0))
    assert contacts._hump_box(part, 2.0 * part, 8, 6) == (7, 3, 8.0)
    even = np.array([4.0, 3.0, 3.0, 4.0])
    assert contacts._hump_box(even, even, 0, 2) == (0, 2, 3.5)
    assert contacts._hump_box(even, even, 3, 1) == (2, 2, 3.5)
    assert contacts._hump_box(with_values(9, (4, 5, 6.0)), np.arange(9.0), 4, 7) == (4, 1, 4.0)


@pytest.mark.parametrize(
    ("place", "value", "goes_on"),
    [
        (14, 4.6, True),
        (14, 4.4, False),
        (15, 4.6, False),
        (5, 4.6, True),
        (4, 4.6, False),
        (35, 4.6, True),
        (34, 4.6, False),
        (44, 4.6, True),
        (45, 4.6, False),
        (10, -2.1, True),
        (10, -1.9, False),
        (9, -2.1, False),
        (49, -2.1, True),
        (50, -2.1, False),
    ],
)
def test_a_ringing_goes_on_beside_two_humps(place, value, goes_on):
    """Humps of 10 at 20 and 30: 45 % of it as far apart, or 20 % to the other side, within one and two distances."""
    part = with_values(80, (20, 21, 10.0), (30, 31, 10.0), (place, place + 1, value))
    assert contacts._goes_on(part, 20, 30, 10.0, 0.0) is goes_on
    assert not contacts._goes_on(part, 20, 30, 10.0, 0.2)


@pytest.mark.parametrize(
    ("place", "value", "left"),
    [
        (75, -1.7, 1),
        (74, -1.7, 2),
        (75, -1.5, 2),
        (194, -1.7, 1),
        (195, -1.7, 2),
        (60, 3.7, 1),
        (60, 3.5, 2),
        (59, 3.7, 2),
        (89, 3.7, 1),
        (90, 3.7, 2),
        (150, 3.7, 1),
        (149, 3.7, 2),
        (179, 3.7, 1),
        (180, 3.7, 2),
    ],
)
def test_of_two_lobes_the_higher_is_left(place, value, left):
    """Boxes of means 10 and 8, 30 apart: a fifth of 8 to the other side, or 45 % of it on their own, beside them."""
    boxes = [Box(100, 10, 10.0), Box(130, 10, 8.0)]
    line = Baseline(5.0, 0.25)
    values = with_values(300, (100, 110, 10.0), (130, 140, 8.0), (place, place + 1, value))
    for sign in (1, -1):
        found = contacts._without_lobes(sign * values + line.at(np.arange(300)), line, sign, boxes, 0.0)
        assert found == boxes[:left]
    assert contacts._without_lobes(values, FLAT, 1, boxes, 0.2) == boxes  # three of it in both bounds


def test_lobes_near_the_ends_of_a_record():
    """Fifty samples before two boxes 30 apart there may be none, and fifty after them."""
    for later in (10, 0):
        boxes = [Box(later, 10, 10.0), Box(later + 30, 10, 8.0)]
        for place, value, left in (
            (later + 94, -1.7, 1),
            (later + 95, -1.7, 2),
            (later + 79, 3.7, 1),
            (later + 80, 3.7, 2),
        ):
            values = with_values(
                later + 200, (later, later + 10, 10.0), (later + 30, later + 40, 8.0), (place, place + 1, value)
            )
            assert len(contacts._without_lobes(values, FLAT, 1, boxes, 0.0)) == left
            if place < later + 80:
                assert len(contacts._without_lobes(values[: place + 1], FLAT, 1, boxes, 0.0)) == left


def test_boxes_four_widths_apart_are_no_lobes_of_one_another():
    values = np.where(np.arange(400) % 2, -9.0, 9.0)
    for first, left in ((149, 1), (150, 2)):
        assert len(contacts._without_lobes(values, FLAT, 1, [Box(100, 10, 8.0), Box(first, 10, 9.0)], 0.0)) == left
    assert contacts._without_lobes(values, FLAT, 1, [Box(100, 10, 8.0), Box(130, 10, 9.0)], 0.0) == [Box(130, 10, 9.0)]


def test_a_small_box_rises_again_where_half_of_it_falls_between():
    line = Baseline(1.0, 0.5)
    other = BoxGrid(10)
    other.add(Box(100, 10, 10.0))
    for small, between in ((Box(130, 4, 2.0), (110, 130)), (Box(76, 4, 2.0), (80, 100))):
        for height, rises in ((1.004, False), (0.996, True)):
            values = with_values(200, (*between, height)) + line.at(np.arange(200))
            assert contacts._rises_again(values, line, 1, small, other) is rises
    for first, rises in ((139, False), (140, True)):  # three widths of the hit
        values = with_values(200, (100, 150, 5.0))
        assert contacts._rises_again(values, FLAT, 1, Box(first, 4, 2.0), other) is rises


@pytest.mark.parametrize(
    ("first", "value", "swings"),
    [
        (80, -3.1, True),
        (80, -2.9, False),
        (70, -3.1, True),
        (69, -3.1, False),
        (110, -6.1, True),
        (110, -5.9, False),
        (135, -6.1, True),
        (136, -6.1, False),
        (95, -3.1, True),
        (96, -3.1, False),
    ],
)
def test_a_box_swings_with_half_of_it_before_or_all_of_it_after(first, value, swings):
    line = Baseline(2.0, -0.5)
    values = with_values(200, (first, first + 5, value), (100, 110, 6.0)) + line.at(np.arange(200))
    assert contacts._swings(values, line, 1, Box(100, 10, 6.0), BoxGrid(30), 0.0) is swings
    assert not contacts._swings(values, line, 1, Box(100, 10, 6.0), BoxGrid(30), 0.2)  # 0.27 is what noise may be


def test_a_box_near_either_end_is_held_against_what_there_is():
    """Up to the first sample and the last."""
    for dip, swings in ((0, True), (1, True)):
        values = with_values(100, (dip, dip + 5, -3.1), (20, 30, 6.0))
        assert contacts._swings(values, FLAT, 1, Box(20, 10, 6.0), BoxGrid(30), 0.0) is swings
        values = with_values(50, (50 - 5 - dip, 50 - dip, -6.1), (20, 30, 6.0))
        assert contacts._swings(values, FLAT, 1, Box(20, 10, 6.0), BoxGrid(30), 0.0) is swings


def test_what_swings_behind_another_box_is_not_looked_at():
    for hidden, other, dip in ((True, 85, 80), (False, 120, 80), (True, 120, 125), (False, 85, 125)):
        one = BoxGrid(30)
        one.add(Box(other, 5, 9.0))
        values = with_values(200, (dip, dip + 5, -9.0), (100, 110, 6.0))
        assert contacts._swings(values, FLAT, 1, Box(100, 10, 6.0), one, 0.0) is not hidden
    near = BoxGrid(30)
    near.add(Box(85, 5, 9.0))
    near.add(Box(120, 5, 9.0))
    for first in (80, 125):
        values = with_values(200, (first, first + 5, -9.0), (100, 110, 6.0))
        assert contacts._swings(values, FLAT, 1, Box(100, 10, 6.0), BoxGrid(30), 0.0)
        assert not contacts._swings(values, FLAT, 1, Box(100, 10, 6.0), near, 0.0)


@pytest.mark.parametrize(("share", "counts"), [(0.22, (2, 0)), (0.17, (1, 1)), (0.06, (1, 1)), (0.04, (1, 0))])
@pytest.mark.parametrize("sign", [1, -1])
def test_a_fifth_of_the_largest_area_is_a_blow_and_a_twentieth_a_small_contact(share, counts, sign, rng):
    values = sign * with_values(4000, (1000, 1096, 200.0), (2500, 2596, 200.0 * share)) + rng.normal(size=4000)
    found, large, small = find_boxes(values, robust_line(values), 1.0)
    assert found == sign
    assert (len(large), len(small)) == counts
    assert large[0] == (1000, 96, pytest.approx(200.0, rel=0.01))


@pytest.mark.parametrize("begin", [0, 40, 47, 48, 60])
def test_a_blow_needs_half_its_width_before_it(begin):
    values = with_values(4000, (begin, begin + 96, 200.0)) + 0.01 * (-1.0) ** np.arange(4000)
    assert len(find_boxes(values, robust_line(values), 0.0)[1]) == (1 if begin >= 48 else 0)


def test_where_nothing_stands_out_there_is_no_box(rng):
    assert find_boxes(np.zeros(300), FLAT, 0.0) == find_boxes(rng.normal(size=300), FLAT, 1.0) == (1, [], [])


def half_sines(apart, length=64, size=1200):
    u = (np.arange(size) - 500.0) / length
    return sum(100.0 * np.sin(np.pi * np.clip(u - k, 0.0, 1.0)) for k in (0.0, apart))


@pytest.mark.parametrize(("apart", "hits"), [(1.0, 2), (0.75, 1)])
def test_two_hits_foot_to_foot_are_mark_responses(apart, hits):
    """At foot to foot each box lies between the halves of its half-sine, 500 + 64 / 6 and 500 + 64 5 / 6."""
    values = half_sines(apart)
    found = contacts._hits_of(values, FLAT, 1, Box(495, 140, 60.0), 0.01)
    assert len(found) == hits
    if hits == 2:
        for k, hit in enumerate(found):
            assert hit.first == pytest.approx(
                500.0 + 64.0 * (k + 1.0 / 6.0), abs=2.0
            )  # means over eight, to a quarter of it
            assert hit.width == pytest.approx(64.0 * 2.0 / 3.0, abs=4.0)
            assert hit.mean == pytest.approx(100.0 * 3.0 * math.sqrt(3.0) / (2.0 * math.pi), rel=0.03)
        assert contacts._hits_of(-values, FLAT, -1, Box(495, 140, 60.0), 0.01) == found
        near = contacts._hits_of(values[400:], FLAT, 1, Box(95, 140, 60.0), 0.01)
        assert near == [hit._replace(first=hit.first - 400) for hit in found]
        line = Baseline(7.0, 0.5)
        tilted = contacts._hits_of(values + line.at(np.arange(1200)), line, 1, Box(495, 140, 60.0), 0.01)
        assert np.array(tilted) == pytest.approx(np.array(found), rel=1e-9)


def hits_of(first, second, valley, single=0.0, width=24, at=100, size=200):
    """Search a box for hits of which each is given by its begin, length and height, over a level between them."""
    (a, m, low), (b, n, high) = first, second
    values = with_values(size, (a + m, b, valley), (a, a + m, low), (b, b + n, high))
    found = contacts._hits_of(values, FLAT, 1, Box(at, width, 7.0), single)
    return None if found == [Box(at, width, 7.0)] else found


@pytest.mark.parametrize(
    ("low", "high", "valley", "single", "two"),
    [
        (10.0, 5.05, 0.0, 0.0, True), (10.0, 4.95, 0.0, 0.0, False), (4.95, 10.0, 0.0, 0.0, False), (5.05, 10.0, 0.0, 0.0, True),
        (10.0, 8.0, 2.78, 0.0, True), (10.0, 8.0, 2.82, 0.0, False), (8.0, 10.0, 2.82, 0.0, False), (8.0, 10.0, 2.78, 0.0, True),
        (10.0, 8.0, 3.08, 0.1, True), (10.0, 8.0, 3.12, 0.1, False), (10.0, 8.0, 0.0, 0.931, True), (10.0, 8.0, 0.0, 0.936, False),
    ],
)  # fmt: skip
def test_two_hits_are_half_as_high_as_one_another_over_a_valley_of_a_third(low, high, valley, single, two):
    """A half of the higher; 35 % of the lower and three noises between them; three noises below that share."""
    found = hits_of((102, 4, low), (114, 4, high), valley, single)
    assert found == ([Box(102, 4, low), Box(114, 4, high)] if two else None)


def test_hits_lie_within_a_quarter_of_a_width_beside_their_box():
    """From 94 on, up to 129; of twelve samples at least, and of like widths."""
    for begin, two in ((94, True), (91, True), (90, False)):
        assert (hits_of((begin, 4, 10.0), (114, 6, 9.0), 0.0) is not None) is two
    for begin, two in ((127, True), (129, True), (130, False)):
        assert (hits_of((104, 4, 10.0), (begin, 6, 9.0), 0.0) is not None) is two
    for width, two in ((12, True), (11, False)):
        assert (hits_of((100, 3, 10.0), (107, 3, 9.0), 0.0, width=width) is not None) is two
    for length, two in ((9, True), (10, False)):
        assert (hits_of((100, 3, 10.0), (122, length, 9.0), 0.0) is not None) is two
        assert (hits_of((100, length, 10.0), (122, 3, 9.0), 0.0) is not None) is two


def test_hits_near_the_ends_of_a_record_are_found():
    assert hits_of((14, 4, 10.0), (26, 6, 9.0), 0.0, at=12) == [Box(14, 4, 10.0), Box(26, 6, 9.0)]
    assert hits_of((176, 4, 10.0), (188, 6, 9.0), 0.0, at=174) == [Box(176, 4, 10.0), Box(188, 6, 9.0)]


def test_wide_boxes_are_looked_at_in_means():
    """Over two samples of 32, and over one of 31: a spike of one sample is then half as high, noise less by root two."""
    for width, two in ((31, True), (32, False)):
        assert (hits_of((102, 6, 10.0), (116, 2, 9.9), 0.0, width=width) is not None) is True
        assert (hits_of((102, 3, 10.0), (116, 1, 9.9), 0.0, width=width) is not None) is two
    for single, two in ((0.931 * math.sqrt(2.0), True), (0.936 * math.sqrt(2.0), False)):
        assert (hits_of((102, 8, 10.0), (118, 8, 8.0), 0.0, single, width=32) is not None) is two


def test_hits_with_a_swing_beside_them_are_one():
    """A fifth of the lower to the other side; 45 % of it as far away as they lie apart, 12."""
    for place, value, one in (
        (96, -1.7, True),
        (96, -1.5, False),
        (126, 3.7, True),
        (126, 3.5, False),
        (90, 3.7, True),
    ):
        values = with_values(200, (102, 106, 10.0), (114, 120, 8.0), (place, place + 2, value))
        assert (len(contacts._hits_of(values, FLAT, 1, Box(100, 24, 7.0), 0.0)) == 1) is one, place
