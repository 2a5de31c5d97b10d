"""Responses of oscillators over time, their root mean square, vector sums, and how a record may begin."""

import math

import numpy as np
import pytest
from scipy.linalg import expm

from strikewave.signal import srs as module
from strikewave.signal.oscillator_groups import KINDS, groups
from strikewave.signal.responses import interpolate, largest_sum
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
    assert largest_sum([tuple(axis[:2] for axis in axes)]) == pytest.approx([np.sqrt(squares[1, 0]), 2.0], rel=1e-12)
    assert largest_sum([tuple(axis[7::-1] for axis in axes)]) == pytest.approx(
        [3.0 if top < 7.0 else np.sqrt(squares[7, 0]), 2.0], rel=1e-12
    )
