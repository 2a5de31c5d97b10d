"""The zero that a sensor takes before a blow."""

import math

import pytest

from strikewave.signal.motion import zero_before


@pytest.mark.parametrize(
    ("touch", "values", "zero"),
    [
        (0.0, [-9.8, -9.7, 40.0], -9.7),  # the instant of the touch is before the blow
        (0.5, [-9.8, -9.7, 40.0], -9.7),
        (1.0, [-9.8, -9.7, 40.0], 40.0),
        (-1.0, [-9.8, -9.7, 40.0], -9.8),
        (-1.5, [-9.8, -9.7, 40.0], 0.0),  # nothing is known
        (0.0, [-9.8, math.nan, 40.0], 0.0),
    ],
)
def test_the_last_value_not_after_the_touch_is_zero(touch, values, zero):
    assert zero_before([-1.0, 0.0, 1.0], values, touch) == zero
