"""Responses of oscillators over time, their root mean square, vector sums, and how a record may begin."""

import math

import numpy as np
import pytest
from scipy.linalg import expm

from strikewave.signal import srs as module
from strikewave.signal.oscillators import (
    FEW,
    KINDS,
    NODES,
    PLACES,
    WEIGHTS,
    _polished,
    acceleration,
    at_rest,
    bank,
    bend,
    displacement,
    framed,
    free_extremes,
    groups,
    interpolate,
    largest_sum,
    legendre,
    velocity,
)
from strikewave.signal.srs import Scope, all_srs, response_history, resultant_srs, rms_spectrum, srs

READS = {
    "absolute": lambda w, a2: [w * w, a2],
    "displacement": lambda w, a2: [1.0, 0.0],
    "relative-velocity": lambda w, a2: [0.0, 1.0],
    "pseudo-velocity": lambda w, a2: [w, 0.0],
    "equivalent-static": lambda w, a2: [w * w, 0.0],
}


def exponentials(values, step, fn, q, kind, start=None):
    """Responses at the samples by matrix exponentials, the base running straight between them."""
    w = 2 * math.pi * fn
    a2 = 0.0 if math.isinf(q) else w / q
    move = expm(np.array([[0, 1, 0, 0], [-w * w, -a2, 1, 0], [0, 0, 0, 1], [0, 0, 0, 0.0]]) * step)
    z, v, last = start if start else (0.0, 0.0, 0.0)
    seen = []
    for value in values:
        x = move @ np.array([z, v, last, (value - last) / step])
        z, v, last = x[0], x[1], value
        seen.append(float(np.dot(READS[kind](w, a2), x[:2])))
    return np.array(seen)


def noise(count, seed=3):
    return np.random.default_rng(seed).normal(size=count)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("q", [0.5, 10.0, math.inf])
def test_response_history_is_that_of_matrix_exponentials(kind, q):
    values, step, fn = noise(400), 2e-5, 900.0  # 55 samples a period: no interpolation
    wanted = exponentials(values, step, fn, q, kind)
    got = response_history(values, step, fn, q, kind)
    assert got == pytest.approx(wanted, rel=1e-9, abs=1e-10 * np.max(np.abs(wanted)))


def test_history_of_an_interpolated_record_holds_the_spectrum():
    """Above a twentieth of the sampling rate the response between samples is followed, and only its samples are given."""
    t = np.arange(2000) * 1e-5
    values = np.sin(2 * math.pi * 3000.0 * t) * np.exp(-((t - 0.01) ** 2) / 1e-5)
    history = response_history(values, 1e-5, 12e3)  # 8 samples a period, of a base of 33
    top = srs(values, 1e-5, [12e3], scope=Scope("primary")).maximax[0]
    # the base is smooth over 33 samples a swing: the largest sample misses at most 1 - cos(pi/33) = 0.45 %
    assert 0.995 * top < np.max(np.abs(history)) <= top * (1 + 1e-9)


def test_spectra_of_one_record_are_those_of_each_alone_and_interpolate_it_once(monkeypatch):
    """Equal to the bit, of all kinds and two dampings, with all factors, which 10 Hz to nearly half the sampling rate need."""
    values, step, frequencies, scope = noise(3000), 1e-5, np.geomspace(10.0, 4.9e4, 40), Scope("total", 0.02)
    asked = [(kind, q) for kind in KINDS for q in (5.0, 50.0)]
    alone = [srs(values, step, frequencies, q, kind, scope) for kind, q in asked]
    factors = []
    monkeypatch.setattr(module, "interpolate", lambda body, factor: factors.append(factor) or interpolate(body, factor))
    for (kind, q), one, other in zip(asked, all_srs(values, step, frequencies, asked, scope), alone, strict=True):
        assert (one.kind, one.q, one.part) == (kind, q, "total")
        assert np.array_equal(one.positive, other.positive)
        assert np.array_equal(one.negative, other.negative)
    assert factors == [1, 2, 4, 8, 10]


def test_steady_base_has_had_its_first_acceleration_for_ever():
    values, step = 5.0 + np.concatenate([[0.0], noise(300)]), 1e-5
    for kind, q in (("absolute", 10.0), ("displacement", 3.0), ("relative-velocity", 3.0)):
        long = np.concatenate([np.full(60_000, values[0]), values])  # 300 periods of rest: exp(-94) of it is left
        padded = response_history(long, step, 500.0, q, kind)[60_000:]
        got = response_history(values, step, 500.0, q, kind, initial="steady")
        assert got == pytest.approx(padded, rel=1e-8, abs=1e-9 * np.max(np.abs(padded)))
        spectrum = srs(values, step, [500.0], q, kind, Scope("primary", initial="steady"))
        assert max(np.max(got), 0.0) <= spectrum.positive[0] * (1 + 1e-9)


def test_steady_and_undamped_stays_where_it_is():
    assert response_history(np.full(50, 7.0), 1e-4, 80.0, math.inf, initial="steady") == pytest.approx(np.full(50, 7.0))


def test_shifted_record_is_the_record_without_its_first_value():
    values, fn = 3.0 + noise(200), [50.0, 700.0]
    one = srs(values, 1e-5, fn, scope=Scope(initial="shifted"))
    two = srs(values - values[0], 1e-5, fn)
    assert np.array_equal(one.positive, two.positive)
    assert np.array_equal(one.negative, two.negative)


def test_rms_of_a_sine_at_resonance_is_that_of_its_closed_form():
    """Base cos(w t) at resonance: |H| = sqrt(1 + Q^2) in absolute acceleration, rms 1/sqrt(2) of that once it is steady."""
    step, fn, q = 1e-5, 100.0, 5.0
    t = np.arange(2_000_000) * step  # 2000 periods; the first Q/pi periods' rise is 2e-3 of them
    got = rms_spectrum(np.cos(2 * math.pi * fn * t), step, [fn], q)[0]
    assert got == pytest.approx(math.sqrt((1 + q**2) / 2), rel=1e-3)


def test_rms_is_that_of_the_history():
    values = noise(5000)  # more than one block
    got = rms_spectrum(values, 1e-5, [300.0, 2000.0], kind="pseudo-velocity")
    wanted = [np.sqrt(np.mean(response_history(values, 1e-5, f, kind="pseudo-velocity") ** 2)) for f in (300.0, 2000.0)]
    assert got == pytest.approx(wanted, rel=1e-12)


@pytest.mark.parametrize("kind", ["absolute", "displacement"])
def test_resultant_is_the_largest_vector_sum_of_the_histories(kind):
    step, axes = 1e-6, [noise(300, k) * np.hanning(300) for k in (1, 2, 3)]
    for fn in (200.0, 5000.0):  # 200 Hz swings on after the record
        after = np.zeros(round(1.2 / (fn * step)))
        histories = [exponentials(np.concatenate([a, after]), step, fn, 10.0, kind) for a in axes]
        wanted = math.sqrt(np.max(np.sum(np.square(histories), axis=0)))
        # 200 samples a period: what picking samples misses, (pi/200)^2/2
        assert resultant_srs(axes, step, [fn], kind=kind)[0] == pytest.approx(wanted, rel=1.3e-4)


def test_resultant_lies_between_the_largest_axis_and_the_root_of_squares():
    axes, fn = [noise(4000, k) for k in (5, 6)], [100.0, 1000.0, 4000.0]
    single = np.array([srs(a, 1e-5, fn).maximax for a in axes])
    got = resultant_srs(axes, 1e-5, fn)
    assert np.all(got >= single.max(axis=0) * (1 - 1e-3))
    assert np.all(got <= np.sqrt(np.sum(single**2, axis=0)) * (1 + 1e-9))


def test_axes_of_different_length_are_refused():
    with pytest.raises(ValueError, match=r"axes need as many samples each, got \[10, 11\]"):
        resultant_srs([np.ones(10), np.ones(11)], 1e-5, [100.0])


def test_a_start_that_is_none_is_refused():
    with pytest.raises(
        ValueError, match="initial state of a spectrum must be one of rest, shifted, steady, got 'zero'"
    ):
        srs(np.ones(10), 1e-5, [100.0], scope=Scope(initial="zero"))


def test_frequencies_take_the_least_factor_that_leaves_20_samples_a_period():
    """10 up to half the sampling rate; at an edge rounding does not count."""
    fn = np.array([0.3, 0.05, 0.0501, 0.1, 0.101, 0.2, 0.201, 0.4, 0.401, 0.499, 0.01])
    found = {group.factor: group.members.tolist() for group in groups(1.0, fn)}
    assert found == {1: [1, 10], 2: [2, 3], 4: [4, 5], 8: [0, 6, 7], 10: [8, 9]}
    [plain] = groups(1.0, fn, upsample=False)
    assert (plain.factor, plain.step) == (1, 1.0)


@pytest.mark.parametrize("split", [1, 2, 3, 6, 7, 8, 9, 12, 13])
@pytest.mark.parametrize("top", [6.0, 6.5, 7.3, 7.9])
def test_the_largest_sum_of_squares_is_found_between_samples_and_blocks(split, top):
    """Squares on a parabola, shared by two axes, beside a column that is largest at its beginning."""
    places = np.arange(14.0)
    squares = np.column_stack([9.0 - 0.125 * (places - top) ** 2, 4.0 - 0.25 * places])
    axes = np.sqrt(0.36 * squares), np.sqrt(0.64 * squares)
    blocks = [tuple(axis[part] for axis in axes) for part in (slice(0, split), slice(split, None))]
    assert largest_sum(blocks) == pytest.approx([3.0, 2.0], rel=1e-12)
    every = [tuple(axis[begin : begin + split] for axis in axes) for begin in range(0, 14, split)]
    assert largest_sum(every) == pytest.approx([3.0, 2.0], rel=1e-12)
    assert largest_sum([tuple(axis[:2] for axis in axes)]) == pytest.approx([np.sqrt(squares[1, 0]), 2.0], rel=1e-12)
    assert largest_sum([tuple(axis[7::-1] for axis in axes)]) == pytest.approx(
        [3.0 if top < 7.0 else np.sqrt(squares[7, 0]), 2.0], rel=1e-12
    )


@pytest.mark.parametrize(("count", "rule"), [(24, (NODES, WEIGHTS)), (8, FEW), (3, None)])
def test_a_rule_integrates_powers_up_to_twice_its_places_less_one(count, rule):
    """From 0 to 1: 1/(n + 1)."""
    places, weights = rule or legendre(count)
    assert places.size == count
    for n in range(2 * count):
        assert np.dot(weights, places**n) == pytest.approx(1.0 / (n + 1.0), rel=1e-12)


def test_what_is_looked_at_of_an_oscillator_by_hand():
    """w = 3, zeta = 0.2: a = 0.6. The mass has w^2 z + 2 a z', of which the impulse response begins at 2 a."""
    w = np.array([3.0])
    z, v, a = (of(w, 0.2) for of in (displacement, velocity, acceleration))
    assert [float(row[0]) for row in (z.even, z.odd, z.level, z.slope, z.static)] == pytest.approx([0, 1, 1, 0, 1 / 9])
    assert [float(row[0]) for row in (v.even, v.odd, v.level, v.slope, v.static)] == pytest.approx([1, -0.6, 0, 1, 0])
    assert [float(row[0]) for row in (a.even, a.odd, a.level, a.slope, a.static)] == pytest.approx(
        [1.2, 8.28, 9, 1.2, 1]
    )
    p = np.array([-0.6 + 2.0j])
    assert [complex(of.mode(p)[0]) for of in (z, v, a)] == [1.0, p[0], -(p[0] ** 2)]


@pytest.mark.parametrize("of", [acceleration, displacement, velocity])
@pytest.mark.parametrize("damping", [0.0, 0.05, 0.3, 1.0, 2.5])
def test_what_lies_between_samples_keeps_the_bounds_of_its_bank(of, damping):
    """Of random states and loads: how far a step bends off its chord, and how far its peak lies above the samples, here
    of a record whose largest response and load are known. The bounds of the bend are no more than a tenth too large."""
    oscillators = bank(np.array([0.02, 0.3, 0.9, 2.0]), damping, of)
    u, source = np.linspace(0.0, 1.0, 300) ** 2, np.random.default_rng(9)
    P, R = bend(oscillators.frequency[:, None], damping, u)
    square, double, on_level, on_slope, flat, rising, *between = oscillators.shapes
    assert square == pytest.approx(oscillators.frequency**2, rel=1e-15)
    assert double == pytest.approx(2.0 * damping * oscillators.frequency, rel=1e-15)
    for bound, bent in ((flat, P), (rising, R)):
        most = np.abs(bent).max(axis=1)
        assert np.all((most < bound) & (bound < 1.105 * most))
    for _ in range(40):
        y, d, level, slope = source.normal(size=(4, 4, 1))
        constant = square[:, None] * y + double[:, None] * d - on_level[:, None] * level - on_slope[:, None] * slope
        linear = square[:, None] * d - on_level[:, None] * slope
        response = y + u * d + constant * P + linear * R
        ends = np.abs(response[:, [0, -1]]).max(axis=1)
        load = np.maximum(np.abs(level), np.abs(level + slope)).ravel(), np.abs(slope).ravel()
        above = np.abs(response).max(axis=1) - ends
        assert np.all(above <= between[0] * ends + between[1] * load[0] + between[2] * load[1])


def test_bounds_of_a_calm_and_of_a_lively_bank_by_hand():
    """w = 0.4, zeta = 0.1: 1 - 0.08 - 0.16/8 = 0.9, and 1/(8 x 0.9) of w^2, of level and of slope. w = 2, zeta = 0.1 is
    lively: the largest P and R stand for them, of w^2 + 4 a = 4.8 and of 2 w^2 = 8."""
    calm, lively = (bank(np.array([w]), 0.1, acceleration) for w in (0.4, 2.0))
    _, _, level, slope, _, _, *between = calm.shapes[:, 0]
    assert (level, slope) == pytest.approx((0.16 / calm.weight[0], 0.08 / calm.weight[0]), rel=1e-14)
    assert between == pytest.approx([0.16 / 7.2, level / 7.2, slope / 7.2], rel=1e-14)
    _, _, level, slope, flat, rising, *between = lively.shapes[:, 0]
    assert between == pytest.approx([4.8 * flat + 8.0 * rising, flat * level, flat * slope + rising * level], rel=1e-14)
    largest = [1.1 * np.max(part) for part in bend(np.array([[2.0]]), 0.1, PLACES)]
    assert (flat, rising) == pytest.approx(largest, rel=1e-14)


@pytest.mark.parametrize("damping", [0.0, 0.1, 1.3])
def test_a_peak_in_a_step_is_sharpened_to_its_height(damping):
    """From a place a twentieth of a step off at most; against 20 000 places, which leave 1e-9."""
    oscillators = bank(np.array([0.1, 0.9, 1.8]), damping, acceleration)
    u = np.linspace(0.0, 1.0, 20_001)
    P, R = bend(oscillators.frequency[:, None], damping, u)
    source = np.random.default_rng(2)
    for ends in (False, True):
        start, change = source.normal(size=(2, 2, 3, 1))
        change = change if ends else 0.1 * change
        flat, rising = (0.1 if ends else 4.0) * source.normal(size=(2, 2, 3, 1))
        values = np.array([[1.0], [-1.0]])[..., None] * (start + u * change + flat * P + rising * R)
        place = np.clip(u[values.argmax(axis=2)] + source.uniform(-0.05, 0.05, (2, 3)), 0.0, 1.0)
        peaks = np.stack([place, *(part[..., 0] for part in (start, change, flat, rising))])
        assert _polished(peaks, oscillators) == pytest.approx(values.max(axis=2), abs=2e-8)


def test_a_record_rises_from_a_level_and_falls_to_zero_within_a_step():
    body = np.array([3.0, 5.0, 8.0])
    rising, fall = framed(body, 4, 1.0)
    assert rising.tolist() == [1.5, 2.0, 2.5, 3.0, 5.0, 8.0]
    assert fall.tolist() == [6.0, 4.0, 2.0, 0.0]
    assert framed(body, 2, 1.0)[0].tolist() == [2.0, 3.0, 5.0, 8.0]
    rising, fall = framed(body, 1, 1.0)
    assert (rising.tolist(), fall.tolist()) == ([3.0, 5.0, 8.0], [0.0])


def test_a_base_that_has_always_had_an_acceleration_leaves_oscillators_bent_and_still():
    oscillators = bank(np.array([0.1, 0.7]), 0.2, displacement)
    response, change = at_rest(oscillators, 3.0)
    assert response * oscillators.weight == pytest.approx([300.0, 3.0 / 0.49], rel=1e-12)
    assert change.tolist() == [0.0, 0.0]


@pytest.mark.parametrize(
    ("w", "zeta"), [(0.3, 0.0), (0.3, 0.2), (1.1, 0.7), (0.5, 1.0), (0.5, 1.005), (0.4, 1.8), (1.5, 6.0)]
)
def test_free_vibrations_reach_as_far_as_they_are_followed(w, zeta):
    """In 2000 places each of a period, of ten times the slowest decay and of the fastest one."""
    rates = np.array([[0.0, 1.0], [-w * w, -2.0 * zeta * w]])
    slow = w * (zeta - math.sqrt(zeta**2 - 1.0)) if zeta > 1.0 else w
    states = [(1.0, 0.0), (0.0, 1.0), (1.0, -2.0), (-1.0, 0.3), (-0.5, 4.0), (2.0, 1.0), (1.0, -20.0), (-1.0, 30.0)]
    changes = [(expm(rates) @ state)[0] - state[0] for state in states]
    ones = np.full(len(states), w)
    found = free_extremes(ones, zeta, np.array([z for z, _ in states]), np.array(changes))
    seen = []
    for span in (1.02 * 2.0 * math.pi / w, 10.0 / slow, 1.0 / (w + 2.0 * zeta * w)):
        move, x = expm(rates * (span / 2000)), np.array(states).T
        for _ in range(2001):
            seen.append(x[0])
            x = move @ x
    high, low = np.maximum(np.max(seen, axis=0), 0.0), np.minimum(np.min(seen, axis=0), 0.0)
    for reached, wanted in ((found[0], high), (-found[1], -low)):
        assert np.all(reached >= wanted * (1.0 - 1e-9))
        assert np.all(reached <= wanted + 1e-5 * np.maximum(high, -low))  # a parabola between places


@pytest.mark.parametrize("factor", [1, 2, 8])
def test_interpolation_keeps_both_ends(factor):
    assert interpolate(np.arange(40.0), factor).size == 39 * factor + 1


@pytest.mark.parametrize("part", ["primary", "residual", "total"])
@pytest.mark.parametrize("values", [[3.0, 1.0], [-2.0, 5.0, 1.0], [1.0, -4.0, 2.0, 3.0]])
def test_zeros_before_a_record_change_nothing_however_short_it_is(values, part):
    for q, kind in ((5.0, "absolute"), (0.4, "relative-velocity")):
        short, long = (
            srs(record, 1.0, [0.02, 0.2], q, kind, Scope(part, upsample=False))
            for record in (values, [0.0] * 9 + values)
        )
        assert short.positive == pytest.approx(long.positive, rel=1e-9)
        assert short.negative == pytest.approx(long.negative, rel=1e-9)


def test_responses_go_on_from_block_to_block():
    """Of 4096 samples; 700 zeros before move the blocks."""
    values = noise(9000)
    late = response_history(np.concatenate([np.zeros(700), values]), 1e-5, 700.0)[700:]
    assert response_history(values, 1e-5, 700.0) == pytest.approx(late, rel=1e-9, abs=1e-9)


def test_vector_sums_of_several_frequencies_are_those_of_each():
    """The slowest swings on for the longest after a short record."""
    axes, fn = [noise(12, k) for k in (1, 2)], [30.0, 300.0, 3000.0]
    alone = [resultant_srs(axes, 1e-5, [one])[0] for one in fn]
    assert resultant_srs(axes, 1e-5, fn) == pytest.approx(alone, rel=1e-9)
