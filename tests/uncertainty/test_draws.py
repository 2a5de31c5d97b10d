"""What is drawn of an input: quantiles of scipy's distributions, and what goes with it, by hand."""

import math

import numpy as np
import pytest
from scipy.stats import loguniform, norm, truncnorm, uniform

from strikewave.base.quantities import Range, ToleranceBand, Value
from strikewave.uncertainty.draws import UncertainInput, drawn, nominal, normal_quantile, quantiles, stated, within

QUANTILES = np.array([1e-6, 0.025, 0.3, 0.5, 0.8, 0.999])
ANY = Range("")


def value(si, **more):
    return Value(si=si, typed=si, **more)


def one_of(path, si=2.0, low=1.0, high=4.0, shape="uniform", **more):
    return UncertainInput(path, value(si), ANY, low, high, shape, **more)


@pytest.mark.parametrize(
    ("one", "distribution"),
    [
        (one_of("x"), uniform(1.0, 3.0)),
        (one_of("x", shape="log-uniform"), loguniform(1.0, 4.0)),
        (one_of("x", shape="normal", deviation=0.8), truncnorm(-1.25, 2.5, 2.0, 0.8)),
        (one_of("x", si=3.5, shape="normal", deviation=0.5), truncnorm(-5.0, 1.0, 3.5, 0.5)),
    ],
)
def test_quantiles_are_those_of_scipy(one, distribution):
    """To 1e-9: both quantiles of a normal distribution are good to some 1e-13 in the probability."""
    assert one.at(QUANTILES) == pytest.approx(distribution.ppf(QUANTILES), rel=1e-9)


def test_normal_quantiles_keep_their_shape():
    assert normal_quantile(QUANTILES.reshape(2, 3)) == pytest.approx(norm.ppf(QUANTILES).reshape(2, 3), rel=1e-12)


@pytest.mark.parametrize(
    ("shape", "allowed", "ends", "deviation", "width"),
    [
        ("uniform", ANY, (9.0, 11.0), math.nan, 1.0),
        ("normal", ANY, (8.5, 11.5), 0.5, 1.0),
        ("uniform", Range("", 9.5, 10.25), (9.5, 10.25), math.nan, 0.375),
        ("normal", Range("", 9.5, 10.25), (9.5, 10.25), 0.5, 1.0),
        ("normal", Range("", 9.5, open_low=True), (float(np.nextafter(9.5, 11.0)), 11.5), 0.5, 1.0),
    ],
)
def test_a_stated_tolerance_by_hand(shape, allowed, ends, deviation, width):
    """10 with 10 %: half a width of 1, two deviations of a normal distribution that is cut off at three."""
    band = ToleranceBand(size=0.1, typed="10 %", relative=True, distribution=shape)
    one = stated("x", value(10.0, tolerance=band), allowed)
    assert (one.low, one.high) == pytest.approx(ends, rel=1e-15)
    assert (one.deviation, one.width) == pytest.approx((deviation, width), rel=1e-15, nan_ok=True)
    assert (one.shape, one.reason, one.count, one.names) == (shape, f"10 %, {shape}", 1, ["x"])
    assert one.fields == ("x",)


def test_an_end_that_is_open_is_left_out_only_where_it_cuts():
    opened = Range("", 0.0, 5.0, open_low=True)
    assert within(opened, 1.0, 9.0) == (1.0, 5.0)
    assert within(opened, -1.0, 4.0) == (5e-324, 4.0)
    assert within(Range("", 0.0), -1.0, 4.0) == (0.0, 4.0)


def test_columns_stand_in_the_order_of_inputs_and_strikers():
    inputs = [one_of("a", strikers=(1, 3)), one_of("b", si=3.0)]
    assert (inputs[0].count, inputs[0].names) == (2, ["a of 1", "a of 3"])
    assert nominal(inputs).tolist() == [[2.0, 2.0, 3.0]]
    assert drawn(inputs, np.array([[0.0, 0.5, 1.0], [1.0, 0.0, 0.5]])).tolist() == [[1.0, 2.5, 4.0], [4.0, 1.0, 2.5]]


def test_what_goes_with_others_is_scaled_by_powers_of_theirs():
    """b (nominal 3, drawn 2.5) goes with the square of a (nominal 2, drawn 4), and with nothing that is not drawn."""
    inputs = [one_of("a"), one_of("b", si=3.0, goes_with=(("a", 2.0), ("c", 5.0)))]
    assert drawn(inputs, np.array([[1.0, 0.5]])).tolist() == [[4.0, 10.0]]


def test_inputs_fitted_together_are_correlated_as_their_weights_say():
    """The score of b is 0.6 of that of a and 0.8 of its own; weights whose squares pass 1 leave nothing of its own."""
    a, b = (one_of(name, shape="normal", low=-98.0, high=102.0, deviation=1.0) for name in "ab")
    u = np.array([[norm.cdf(1.5), norm.cdf(-0.5)]])
    scores = {weight: drawn([a, one_with(b, weight)], u)[0] - 2.0 for weight in (0.6, 1.0, 1.25)}
    assert scores[0.6] == pytest.approx([1.5, 0.5], abs=1e-9)
    assert scores[1.0] == pytest.approx([1.5, 1.5], abs=1e-9)
    assert scores[1.25] == pytest.approx([1.5, 1.875], abs=1e-9)
    alone = drawn([one_with(b, 0.6)], u[:, 1:])[0, 0] - 2.0
    assert alone == pytest.approx(-0.5, abs=1e-9)


def one_with(one, weight):
    return one_of(one.path, shape="normal", low=one.low, high=one.high, deviation=1.0, fitted_with=(("a", weight),))


def test_a_random_number_depends_on_seed_run_and_path_and_striker_alone():
    a, b = one_of("a", strikers=(1, 2, 3)), one_of("b")
    both = quantiles([a, b], 3, 5)
    assert both.shape == (3, 4)
    assert np.array_equal(quantiles([b, a], 5, 5)[:3], both[:, [3, 0, 1, 2]])
    assert np.array_equal(quantiles([one_of("a", strikers=(1, 3))], 3, 5), both[:, [0, 2]])
    assert not np.intersect1d(both, quantiles([a, b], 3, 6)).size
    assert np.unique(both).size == both.size
