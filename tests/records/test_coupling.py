"""AC coupling taken off a record: exactly what a high-pass made of a known one, to rounding."""

import math

import numpy as np
import pytest

from strikewave.records.baseline import LocalBaseline
from strikewave.records.measuring import RecordedPulse
from strikewave.records.pulse_shape import SmoothPulse
from strikewave.records.tail import resting, uncoupled
from strikewave.signal.filters import ac_coupled

STEP, START, CONSTANT = 1e-3, 3.0, 0.15


def bumps(size, *firsts):
    """Return half-sines of 20 samples."""
    values = np.zeros(size)
    for first in firsts:
        values[first : first + 20] = 5.0 * np.sin(np.pi * np.arange(20) / 20.0)
    return values


@pytest.mark.parametrize(("size", "taken"), [(251, True), (249, False)])
def test_a_wrong_zero_is_taken_off_where_the_rest_lasts_a_time_constant(size, taken):
    """An error e of the zero is integrated to e (1 + t / tau): whole where the record rests, or left as it is."""
    clean = bumps(size, 30)
    found = resting(ac_coupled(clean, STEP, CONSTANT) + 0.02, STEP, CONSTANT, 100)
    grown = 0.02 * (1.0 + STEP / CONSTANT * np.arange(size))
    assert found == pytest.approx(clean + (0.0 if taken else grown), abs=1e-12)


def blow(first, offset, slope):
    begin = START + STEP * first
    smooth = SmoothPulse(5.0, begin, 20 * STEP, 0.5, 1.0)
    return RecordedPulse(
        *(smooth.time, 5.0, math.nan, smooth.width(), smooth.area(), math.nan, offset, 0.0, smooth, "record", begin),
        *(begin + 20 * STEP, LocalBaseline(offset, slope)),
    )


@pytest.mark.parametrize(("late", "exact"), [(249, True), (252, False)])
def test_a_record_rests_five_lengths_after_its_last_blow(late, exact):
    """What comes before is kept whole; the zero is the line before the first blow, through it at its peak."""
    slope, size = 0.004, 400
    line = 0.7 + slope * (np.arange(size) - 40.0)
    clean = bumps(size, 30, 130) + np.where(np.arange(size) == late, 3.0, 0.0)
    values = line + ac_coupled(clean, STEP, 0.14) + 0.02
    pulses = [blow(30, 0.7, slope), blow(130, 99.0, 0.0)]
    found = uncoupled(values, STEP, START, pulses, 0.14)
    assert np.allclose(found, line + clean, rtol=0.0, atol=1e-12) is exact
    assert found == pytest.approx(line + clean, abs=0.1)
