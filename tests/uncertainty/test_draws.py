"""What is drawn of an input: quantiles of scipy's distributions, and what goes with it, by hand."""

import math

import numpy as np
import pytest
from scipy.stats import loguniform, norm, truncnorm, uniform

from strikewave.base.errors import InputError
from strikewave.base.quantities import Range, ToleranceBand, Value
from strikewave.cases.case import dump_case, load_case, parse_case
from strikewave.uncertainty.draws import (
    UncertainInput,
    allowed_at,
    drawn,
    drawn_case,
    drawn_strikers,
    nominal,
    normal_quantile,
    random_points,
    stated,
    tolerances_of,
    unfelt,
    within,
)

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
        (one_of("x", low=0.3, high=6.0, shape="log-uniform"), loguniform(0.3, 6.0)),
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
    """b (nominal 3, drawn 2.5) goes with the cube of a (nominal 2, drawn 4), and with nothing that is not drawn."""
    inputs = [one_of("a"), one_of("b", si=3.0, goes_with=(("a", 3.0), ("c", 5.0)))]
    assert drawn(inputs, np.array([[1.0, 0.5]])).tolist() == [[4.0, 20.0]]


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
    both = random_points([a, b], 3, 5)
    assert both.shape == (3, 4)
    assert np.array_equal(random_points([b, a], 5, 5)[:3], both[:, [3, 0, 1, 2]])
    assert np.array_equal(random_points([one_of("a", strikers=(1, 3))], 3, 5), both[:, [0, 2]])
    assert np.array_equal(random_points([one_of("a", strikers=(1, 2))], 3, 5), both[:, [0, 1]])
    assert not np.intersect1d(both, random_points([a, b], 3, 6)).size
    assert np.unique(both).size == both.size


def rotary(*rows, **changes):
    """Return the machine with tables of single strikers."""
    case = load_case("li-ma-2019", [f"{path.replace('__', '.')}={text}" for path, text in changes.items()])
    return parse_case(dump_case(case) + "".join(f"[[striker.each]]\n{row}\n" for row in rows))


OWN = 'number = 3\nmass = "1.3 kg"\nreach_error = "7 um"', "number = 1\nrestitution = 0.61"


def test_strikers_that_have_no_value_of_their_own_are_drawn_separately():
    case = rotary(*OWN)
    assert drawn_strikers(case, "striker.mass") == (1, 2, 4)
    assert drawn_strikers(case, "contact.restitution") == (2, 3, 4)
    assert drawn_strikers(case, "striker.nose_radius") == (1, 2, 3, 4)
    assert drawn_strikers(case, "machine.radius") is None
    assert drawn_strikers(load_case("mil-s-901d-hammer"), "striker.mass") is None


def test_tolerances_of_what_a_run_feels_stand_by_path_and_the_others_are_told():
    case = rotary(*OWN, recorder__sampling_rate__tolerance="1 %")
    inputs = tolerances_of(case)
    paths = [one.path for one in inputs]
    assert paths == sorted(paths)
    counts = {one.path: one.count for one in inputs}
    assert (counts["striker.mass"], counts["striker.reach_error"], counts["object.spring"]) == (3, 3, 1)
    assert all(case.values()[path].tolerance is not None for path in paths)
    assert unfelt(case, inputs) == ["recorder.sampling_rate"]
    every = rotary(*(f'number = {number}\nmass = "1 kg"' for number in (1, 2, 3, 4)))
    assert unfelt(every, tolerances_of(every)) == ["striker.mass"]
    with pytest.raises(InputError, match="a tolerance on at least one quantity that the run feels"):
        tolerances_of(load_case("mil-s-901d-hammer"))


def test_a_drawn_case_has_what_was_drawn_and_keeps_what_single_strikers_have():
    """One number an input, one a striker, one for all fields of a material; none has a tolerance any more."""
    case = rotary(*OWN)
    two = [one for one in tolerances_of(case) if one.path in ("object.spring", "striker.mass", "contact.restitution")]
    assert [one.path for one in two] == ["contact.restitution", "object.spring", "striker.mass"]
    changed = drawn_case(case, two, [0.72, 0.73, 0.74, 41e3, 1.01, 1.02, 1.04])
    assert changed.object.spring.si == 41e3
    assert changed.object.spring.tolerance is None
    assert changed.object.spring.provenance == case.object.spring.provenance
    rows = {int(row.number.si): row for row in changed.striker.each}
    assert list(rows) == [1, 2, 3, 4]
    assert {number: row.mass.si for number, row in rows.items()} == {1: 1.01, 2: 1.02, 3: 1.3, 4: 1.04}
    assert {number: row.restitution.si for number, row in rows.items()} == {1: 0.61, 2: 0.72, 3: 0.73, 4: 0.74}
    assert rows[3].reach_error.si == pytest.approx(7e-6, rel=1e-15)
    assert rows[1].mass.typed == "1.01 kg"
    assert drawn_case(case, two[1:2], [39e3]).striker == case.striker


@pytest.mark.parametrize(
    ("path", "unit"),
    [
        ("machine.radius", "m"),
        ("striker.mass", "kg"),
        ("contact.restitution", ""),
        ("contact.yield_pressure", "Pa"),  # not stated
        ("machine", None),
        ("machine.kind", None),
        ("nothing.at.all", None),
    ],
)
def test_what_a_quantity_may_be_is_known_whether_it_is_stated_or_not(path, unit):
    allowed = allowed_at(load_case("li-ma-2019"), path)
    assert (None if allowed is None else allowed.unit) == unit
