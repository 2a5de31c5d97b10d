"""The time loop of spectra, sample by sample: against scipy's filter, and the highest step against all of them."""

import numpy as np
import pytest
from scipy.signal import lfilter, lfiltic

from strikewave.signal import _srs_kernels as kernels
from strikewave.signal.oscillators import PLACES, acceleration, bank, bend, displacement, velocity

SIZES = [1, 2, 3, 4, 5, 7, 8, 511, 512, 513, 517, 1023, 1026]
BANK = bank(np.array([0.05, 0.4, 1.9]), 0.06, acceleration)
BEFORE, STATE = np.array([0.7, -1.3]), np.array([[2.0, -3.0, 0.5], [0.1, 1.0, -0.9]])


def noise(size, seed=1):
    return np.random.default_rng(seed).normal(size=size)


def responses(x):
    """Return responses and their changes by scipy's filter in its usual form, a column an oscillator."""
    columns = []
    for (decay, stiffness, first, second), y, d in zip(BANK.filters.T, *STATE, strict=True):
        numerator, denominator = [1.0, first, second], [1.0, stiffness - 1.0 - decay, decay]
        zi = lfiltic(numerator, denominator, [y, y - d], BEFORE[::-1])
        columns.append(lfilter(numerator, denominator, x, zi=zi)[0])
    found = np.array(columns).T
    return found, np.diff(found, axis=0, prepend=STATE[:1])


@pytest.mark.parametrize("size", SIZES)
def test_samples_are_taken_as_by_scipy_and_each_segment_keeps_its_extremes(size):
    """Of 512 samples, and of where it begins; four at a time, and what is left over one by one."""
    x, state = noise(size), STATE.copy()
    record = np.empty((4, -(-size // 512), 3))
    kernels.march(x, BEFORE, BANK.filters, state, record)
    found, change = responses(x)
    assert state == pytest.approx(np.array([found[-1], change[-1]]), rel=1e-9, abs=1e-9)
    found, change = (np.concatenate([STATE[k : k + 1], rows]) for k, rows in enumerate((found, change)))
    for segment in range(record.shape[1]):
        begin, end = 512 * segment, min(512 * (segment + 1), size)
        part = found[begin : end + 1]
        wanted = [part.max(axis=0), part.min(axis=0), part[0], change[begin]]
        assert record[:, segment] == pytest.approx(np.array(wanted), rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("size", [1, 2, 3, 40])
def test_every_response_is_written(size):
    x, state, history = noise(size), STATE.copy(), np.empty((size, 3))
    kernels.follow(x, BEFORE, BANK.filters, state, history)
    found, change = responses(x)
    assert history == pytest.approx(found, rel=1e-10, abs=1e-12)
    assert state == pytest.approx(np.array([found[-1], change[-1]]), rel=1e-9, abs=1e-12)


@pytest.mark.parametrize(
    ("response", "change", "kept"), [(6e-281, 5e-281, True), (-8e-281, 7e-281, True), (5e-281, -4e-281, False)]
)
def test_responses_of_less_than_1e_minus_280_are_nothing(response, change, kept):
    """Of each oscillator by itself."""
    state = np.array([[1.0, response, 2.0], [0.1, change, -0.3]])
    record = np.empty((4, 1, 3))
    kernels.march(np.zeros(1), np.zeros(2), BANK.filters, state, record)
    assert record[2:, 0].tolist() == [[1.0, response * kept, 2.0], [0.1, change * kept, -0.3]]
    assert (state[0, 1] != 0.0) == kept


@pytest.mark.parametrize("size", SIZES)
def test_the_load_of_a_segment_is_its_largest_sample_and_step(size):
    """From the sample before it on."""
    x, record = noise(size, 2), np.empty((2, -(-size // 512)))
    kernels.loads(x, BEFORE, record)
    whole = np.concatenate([BEFORE[1:], x])
    parts = [whole[begin : begin + 513] for begin in range(0, size, 512)]
    assert record[0].tolist() == [np.abs(part).max() for part in parts]
    assert record[1].tolist() == [np.abs(np.diff(part)).max() for part in parts]


@pytest.mark.parametrize("response", [acceleration, displacement, velocity])
@pytest.mark.parametrize("damping", [0.0, 0.06, 1.7])
@pytest.mark.parametrize(("size", "seed"), [(6, 1), (6, 2), (9, 3), (513, 4), (1300, 5)])
def test_the_step_with_the_largest_response_is_found(response, damping, size, seed):
    """Against all steps at 140 places each, on both sides: the highest of them, to what lies between the places."""
    oscillators = bank(np.array([0.02, 0.31, 1.3, 2.9]), damping, response)
    x, before = noise(size, seed) ** 3, noise(2, seed + 50)
    state = np.zeros((2, 4))
    record, load = np.empty((4, -(-size // 512), 4)), np.empty((2, -(-size // 512)))
    followed = np.empty((size, 4))
    kernels.follow(x, before, oscillators.filters, np.zeros((2, 4)), followed)
    kernels.march(x, before, oscillators.filters, state, record)
    kernels.loads(x, before, load)
    peaks = np.zeros((5, 2, 4))
    for side, sign in enumerate((1.0, -1.0)):
        shape = (oscillators.shapes, oscillators.bends, PLACES)
        kernels.sharpen(sign, x, before, oscillators.filters, *shape, record, load, peaks[:, side])
    u = np.linspace(0.0, 1.0, 141) ** 2  # dense where fast modes die
    y = np.concatenate([np.zeros((1, 4)), followed])
    b = np.concatenate([before[1:], x])
    for j, w in enumerate(oscillators.frequency):
        P, R = bend(np.array([w]), damping, u)
        d, rise = np.diff(y[:, j]), np.diff(b)
        of = response(np.array([w]), damping)
        level, slope = float(of.level[0] / oscillators.weight[j]), float(of.slope[0] / oscillators.weight[j])
        flat = w**2 * y[:-1, j] + 2 * damping * w * d - level * b[:-1] - slope * rise
        rising = w**2 * d - level * rise
        every = y[:-1, j, None] + u * d[:, None] + flat[:, None] * P + rising[:, None] * R
        for side, sign in enumerate((1.0, -1.0)):
            place, start, change, *bent = peaks[:, side, j]
            best = np.max(sign * every)
            if best <= 0.0:  # the state from which it starts
                continue
            P1, R1 = bend(np.array([w]), damping, np.array([place]))
            height = sign * (start + place * change + bent[0] * P1[0] + bent[1] * R1[0])
            k = int(np.argmin(np.abs(y[:-1, j] - start) + np.abs(d - change)))
            top = sign * every[k]
            assert top.max() > best * (1.0 - 1e-3)
            assert height == pytest.approx(top.max(), rel=2e-3)  # a parabola through places 1/16 to 1/8 apart
            assert abs(place - u[int(np.argmax(top))]) < 0.03
            assert (start, change) == pytest.approx((y[k, j], d[k]), rel=1e-9, abs=1e-12)
            assert bent == pytest.approx([flat[k], rising[k]], rel=1e-6, abs=1e-9 * np.abs(flat).max())
