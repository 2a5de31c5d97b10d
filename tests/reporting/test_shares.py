"""A share with its standard error, which is never written as nothing, the same in bands, sweeps and scatter."""

import math
import re

from hypothesis import given
from hypothesis import strategies as st

from strikewave.base.result import Band, InputShare
from strikewave.reporting.bands import band_words
from strikewave.reporting.faces import columns_of
from strikewave.reporting.numbers import LEAST_SHARE, share_with_error
from strikewave.uncertainty.shares import Share


@given(st.floats(0.0, 1.0), st.floats(2.0 * LEAST_SHARE, 1.0))
def test_an_error_keeps_a_digit_and_the_share_goes_as_far(share, error):
    text = share_with_error(share, error)
    value, doubt = re.fullmatch(r"(\d+(?:\.\d+)?) ± (\d+(?:\.\d+)?) %", text).groups()
    assert len(value.partition(".")[2]) == len(doubt.partition(".")[2])
    last = 10.0 ** -len(doubt.partition(".")[2])
    assert abs(float(doubt) - 100.0 * error) <= 0.5 * last * (1 + 1e-9)
    assert abs(float(value) - 100.0 * share) <= 0.5 * last * (1 + 1e-9)
    assert float(doubt) >= 0.5 * 100.0 * error
    assert len(doubt.replace(".", "").lstrip("0")) == 1 or last == 1.0


def test_bands_and_scatter_write_a_share_alike():
    band = Band(1.0, 2.0, 0.95, (InputShare("machine.speed", 0.591, 0.002),))
    assert "machine.speed (59.1 ± 0.2 %)" in band_words({"first.width": band})[0]
    rows = [Share("a", share, 0.0, 1.0, standard_error=error) for share, error in ((0.591, 0.002), (1e-9, 1e-9))]
    (column, *_) = columns_of(Share, rows, "alone")
    assert column.texts() == ["59.1 ± 0.2", "< 1e-4"]
    assert share_with_error(0.591, math.inf) == "59 %"
