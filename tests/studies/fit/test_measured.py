"""Which pulse of a record is held against runs: the largest that no end of the record cuts."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from strikewave.analyses.compare.agreement import BESIDE
from strikewave.analyses.compare.curve import ComparedCurve
from strikewave.base.errors import InputError
from strikewave.signal.alignment import EvenHistory
from strikewave.studies.fit.measured import _window

SAMPLES = 100
"""Of a half wave."""


def ringing(halves, growth):
    """Return half waves of alternating sign, each larger than the one before by a factor."""
    phase = np.arange(int(halves * SAMPLES) + 1) / SAMPLES
    values = np.sin(np.pi * phase) * growth ** np.floor(phase)
    return ComparedCurve("bar.csv", "record", EvenHistory(np.concatenate([np.zeros(SAMPLES), values]), 1e-6, 0.0), "N")


@given(st.integers(2, 8), st.floats(0.2, 0.8), st.floats(1.01, 1.2))
def test_of_growing_echoes_the_last_whole_one_is_taken(whole, cut, growth):
    """At 10 % of its peak a half wave is 2 asin(0.1)/pi of itself narrower; a straight line between samples is as good."""
    curve = ringing(whole + cut, growth)
    begin, end, edge = _window(curve)
    middle, width = (whole + 0.5) * SAMPLES * 1e-6, (1.0 - 2.0 * np.arcsin(0.1) / np.pi) * SAMPLES * 1e-6
    assert begin == pytest.approx(max(middle - (0.5 + BESIDE) * width, 0.0), abs=1e-8)
    assert end == pytest.approx(min(middle + (0.5 + BESIDE) * width, curve.history.end), abs=1e-8)
    assert edge < SAMPLES * 1e-6


def test_a_single_pulse_that_the_end_cuts_is_refused():
    with pytest.raises(InputError, match="no whole pulse"):
        _window(ringing(0.7, 1.0))
