"""Envelopes and tolerance limits of several spectra: published factors, coverage, refusals."""

import numpy as np
import pytest
from scipy.special import ndtri
from scipy.stats import nct

from strikewave.signal.srs import envelope, tolerance_factor, tolerance_limit


def test_factor_of_the_nist_handbook():
    """43 values, 90 % of all with 99 % confidence: 1.8740, as the handbook gives it from the non-central t."""
    assert tolerance_factor(43, 0.90, 0.99) == pytest.approx(1.8740, abs=5e-5)


@pytest.mark.parametrize("count", [2, 3, 7, 30, 300])
@pytest.mark.parametrize("share", [(0.95, 0.5), (0.99, 0.9), (0.5, 0.005), (0.995, 0.5)])
def test_factor_is_that_of_the_other_implementation_of_non_central_t(count, share):
    wanted = nct.ppf(share[1], count - 1, ndtri(share[0]) * count**0.5) / count**0.5
    assert tolerance_factor(count, *share) == pytest.approx(wanted, rel=1e-7)


@pytest.mark.parametrize("count", [3, 5, 20])
def test_limit_lies_above_95_percent_of_all_shocks_in_half_of_the_campaigns(count):
    """Log-normal spectra at 4000 frequencies, each a campaign of its own; true P95 is known."""
    rows = 100.0 * 10.0 ** (0.15 * np.random.default_rng(11).normal(size=(count, 4000)))
    true = 100.0 * 10.0 ** (0.15 * ndtri(0.95))
    above = np.mean(tolerance_limit(rows) >= true)
    assert above == pytest.approx(0.5, abs=3.5 * (0.25 / 4000) ** 0.5)  # 3.5 binomial deviations


def test_limit_of_equal_shocks_is_the_shock_and_silence_has_none():
    limit = tolerance_limit([[5.0, 0.0]] * 3)
    assert limit[0] == pytest.approx(5.0, rel=1e-12)
    assert np.isnan(limit[1])


def test_envelope_is_nowhere_below_any():
    rows = np.random.default_rng(2).random((6, 50))
    assert np.array_equal(envelope(rows), rows.max(axis=0))


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: tolerance_limit([[1.0], [2.0]]), "needs 3 of them or more, got 2"),
        (lambda: tolerance_factor(1), "two values or more, got 1"),
        (lambda: tolerance_factor(5, 1.0), "share of values of a tolerance limit lies between 0 and 1, got 1.0"),
        (
            lambda: envelope([[1.0], [1.0, 2.0]]),
            r"one row each, all at the same frequencies, got shapes \[\(1,\), \(2,\)\]",
        ),
        (lambda: envelope([]), "one row each"),
        (lambda: envelope([[1.0, 2.0], [[1.0, 2.0]]]), "one row each"),
    ],
)
def test_what_makes_no_sense_is_refused(call, words):
    with pytest.raises(ValueError, match=words):
        call()


def test_three_spectra_a_decade_apart_have_the_limit_of_their_logarithms_in_any_unit():
    """Logarithms 1, 2 and 3: mean 2, deviation 1; the factor is scipy's."""
    factor = nct.ppf(0.5, 2, ndtri(0.95) * 3**0.5) / 3**0.5
    rows = np.array([[10.0], [1000.0], [100.0]])
    for unit in (1.0, 1e-6):
        assert tolerance_limit(unit * rows) == pytest.approx([unit * 10.0 ** (2.0 + factor)], rel=1e-9)
