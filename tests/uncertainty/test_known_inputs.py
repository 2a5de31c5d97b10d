"""What is known of each input of a case, by hand: by its tolerance, its field, its provenance, its fit, its material."""

import math

import numpy as np
import pytest

from strikewave.base.quantities import ToleranceBand, Value
from strikewave.cases.case import FitTable, dump_case, load_case, parse_case
from strikewave.uncertainty.draws import STATED
from strikewave.uncertainty.input_ranges import (
    FITTED_BASIS,
    NAMED_BASIS,
    PLAUSIBLE_BASIS,
    UNSTATED,
    _fitted_inputs,
    default_share,
    field_of,
    half_a_digit,
    known_input,
    known_inputs,
)


@pytest.fixture(scope="module")
def machine():
    return load_case("li-ma-2019")


@pytest.mark.parametrize(
    ("typed", "share"),
    [
        ("1.25 kg", 0.004),
        ("8 mm", 0.0625),
        ("-8 mm", 0.0625),
        ("+0.250", 0.002),
        (0.5, 0.1),
        (730, 0.5 / 730.0),
        ("2e3 N", 0.25),
        ("1.50E-3 m", 0.005 / 1.5),
        ("0.00 mm", 0.0),
        ("auto", 0.0),
    ],
)
def test_half_a_unit_of_the_last_digit_typed(typed, share):
    """Powers of ten count for nothing: 2e3 is 2 and a half."""
    assert half_a_digit(typed) == pytest.approx(share, rel=1e-14)


@pytest.mark.parametrize(
    ("provenance", "typed", "share"),
    [
        ("measured", "730 rpm", 0.01),
        ("published", "40 mm", 0.0125),
        ("user", "8 mm", 0.0625),
        ("measured", "3 kg", 0.10),
        ("inferred", "3 kg", 0.05),
        ("fitted", "3 kg", 0.05),
        ("assumed", "8 mm", 0.10),
    ],
)
def test_a_value_without_tolerance_is_known_by_its_digits_or_its_provenance(provenance, typed, share):
    """Digits from one to ten per cent, and of what somebody read off or typed alone."""
    assert default_share(Value(si=1.0, typed=typed, provenance=provenance))[0] == pytest.approx(share, rel=1e-14)


def tolerance(size, distribution="uniform"):
    return ToleranceBand(size=size, typed=f"{size}", relative=False, distribution=distribution)


KNOWN = [
    # path, value, provenance, tolerance, ends, shape, basis, strikers
    ("machine.radius", 0.2, "assumed", None, (0.18, 0.22), "uniform", UNSTATED, ()),
    ("machine.radius", 0.2, "inferred", None, (0.19, 0.21), "uniform", UNSTATED, ()),
    ("machine.radius", 0.2, "assumed", tolerance(0.003), (0.197, 0.203), "uniform", STATED, ()),
    ("machine.radius", 0.2, "assumed", tolerance(0.04, "normal"), (0.14, 0.26), "normal", STATED, ()),
    ("striker.mass", 1.0, "inferred", None, (0.95, 1.05), "uniform", UNSTATED, ()),
    ("striker.mass", 1.0, "inferred", tolerance(0.02), (0.98, 1.02), "uniform", STATED, (1, 2, 3, 4)),
    ("striker.angle_error", -0.02, "inferred", None, (-0.021, -0.019), "uniform", UNSTATED, ()),
    # fields that nobody can weigh or read off: half of it, a factor of two or three, a width
    ("machine.engagement", 0.01, "assumed", None, (0.005, 0.015), "uniform", PLAUSIBLE_BASIS, ()),
    ("machine.engagement", 0.01, "user", None, (0.005, 0.015), "uniform", PLAUSIBLE_BASIS, ()),
    ("machine.engagement", 0.01, "inferred", None, (0.0095, 0.0105), "uniform", UNSTATED, ()),
    ("machine.engagement", 0.01, "assumed", tolerance(0.001), (0.005, 0.015), "uniform", PLAUSIBLE_BASIS, ()),
    ("machine.engagement", 0.01, "assumed", tolerance(0.006), (0.004, 0.016), "uniform", STATED, ()),
    ("machine.engagement", 0.01, "inferred", tolerance(0.001), (0.009, 0.011), "uniform", STATED, ()),
    ("striker.mount_stiffness", 3e8, "assumed", None, (1.5e8, 6e8), "log-uniform", PLAUSIBLE_BASIS, ()),
    ("machine.drag", 0.003, "assumed", None, (0.001, 0.009), "log-uniform", PLAUSIBLE_BASIS, ()),
    ("machine.drag", 0.0, "assumed", None, (0.0, 0.0), "uniform", PLAUSIBLE_BASIS, ()),
    ("contact.restitution", 0.05, "assumed", None, (0.01, 0.15), "uniform", PLAUSIBLE_BASIS, ()),
    ("contact.restitution", 0.95, "assumed", None, (0.85, 1.0), "uniform", PLAUSIBLE_BASIS, ()),
    # what strikers differ by is drawn for each, and its tolerance says how they do
    ("striker.reach_error", 0.0, "assumed", None, (-2e-5, 2e-5), "uniform", PLAUSIBLE_BASIS, (1, 2, 3, 4)),
    ("striker.reach_error", 0.0, "assumed", tolerance(5e-6), (-5e-6, 5e-6), "uniform", STATED, (1, 2, 3, 4)),
]


@pytest.mark.parametrize(("path", "si", "provenance", "band", "ends", "shape", "basis", "strikers"), KNOWN)
def test_what_is_known_of_a_quantity_by_hand(machine, path, si, provenance, band, ends, shape, basis, strikers):
    one = known_input(machine, path, Value(si=si, typed="100 mm", provenance=provenance, tolerance=band))
    assert (one.low, one.high) == pytest.approx(ends, rel=1e-12)
    assert (one.path, one.shape, one.basis, one.strikers) == (path, shape, basis, strikers)
    if basis == UNSTATED:
        assert one.reason.startswith(f"±{'10' if provenance == 'assumed' else '5'} %, {provenance}: ")


@pytest.mark.parametrize(
    ("path", "si", "provenance"),
    [
        ("machine.strikers", 4.0, "assumed"),  # a whole number
        ("machine.brake", 30.0, "assumed"),  # left alone
        ("striker.reach_error", 0.0, "measured"),  # a share of nothing
        ("feed.wait", 1.0, "measured"),
    ],
)
def test_what_is_a_choice_or_nothing_does_not_move(machine, path, si, provenance):
    assert known_input(machine, path, Value(si=si, typed="1", provenance=provenance)) is None


def with_rows(*rows):
    """Return the machine with tables of single strikers."""
    text = dump_case(load_case("li-ma-2019"))
    return parse_case(text + "".join(f"[[striker.each]]\n{row}\n" for row in rows))


def test_what_each_striker_has_for_itself_is_drawn_for_none():
    own = with_rows(*(f'number = {number}\nmass = "1.{number} kg"' for number in (1, 2, 3, 4)))
    value = Value(si=1.0, typed="1 kg", provenance="inferred", tolerance=tolerance(0.02))
    assert known_input(own, "striker.mass", value) is None
    assert known_input(own, "striker.nose_radius", value).strikers == (1, 2, 3, 4)
    some = with_rows('number = 2\nmass = "1.2 kg"')
    assert known_input(some, "striker.mass", value).strikers == (1, 3, 4)
    paths = {one.path for one in known_inputs(own)}
    assert {f"striker.each.{number}.mass" for number in (1, 2, 3, 4)} <= paths
    assert "striker.mass" not in paths


def test_inputs_stand_by_path_and_of_the_tables_asked_for_alone(machine):
    whole = known_inputs(machine)
    paths = [one.path for one in whole]
    assert paths == sorted(paths)
    assert {path.partition(".")[0] for path in paths} == {"machine", "striker", "feed", "object", "contact"}
    assert known_inputs(machine, ("feed", "object")) == tuple(
        one for one in whole if one.path.startswith(("feed.", "object."))
    )
    assert all(one.high > one.low for one in whole)
    # of 0, a factor of it is nothing
    still = known_inputs(load_case("li-ma-2019", ["machine.drag=0 N m s/rad"]))
    assert {one.path for one in whole} - {one.path for one in still} >= {"machine.drag"}


@pytest.mark.parametrize(
    ("case", "path", "field"),
    [
        ("li-ma-2019", "machine.radius", "machine.radius"),
        ("li-ma-2019-fig5", "sensor.buffered.gasket.0.modulus", "sensor.gasket.modulus"),
        ("li-ma-2019-fig13", "stack.joint.nose.stiffness", "stack.joint.stiffness"),
        ("iec-60068-2-27-rubber", "contact.cushion.thickness", "contact.cushion.thickness"),
        ("own", "striker.each.2.mass", "striker.mass"),
        ("own", "striker.each.2.restitution", "contact.restitution"),
        ("own", "striker.each.2.number", "striker.each.number"),
    ],
)
def test_the_field_of_a_path_leaves_out_the_names_of_rows(case, path, field):
    """What a striker has for itself is of the field that the others share."""
    of = (
        with_rows('number = 3\nmass = "1 kg"', 'number = 2\nmass = "2 kg"\nrestitution = 0.5')
        if case == "own"
        else None
    )
    assert field_of(of or load_case(case), path) == field


ERRORS = {"machine.engagement": "0.2 mm", "object.frame_stiffness": "3 MN/m", "object.mass": "10 gram"}
CORRELATION = ((1.0, 0.6, -0.3), (0.6, 1.0, 0.2), (-0.3, 0.2, 1.0))


def fitted(case, correlation=CORRELATION, to="a pulse", errors=ERRORS):
    table = FitTable(
        fields=tuple(errors), to=to, under={"machine.speed": "730 rpm"}, standard_error=errors, correlation=correlation
    )
    return case.model_copy(update={"fit": (table,)})


def correlation_of(found):
    """Return the correlation of the scores that inputs are made of."""
    paths = list(found)
    factor = np.zeros((len(paths), len(paths)))
    for place, path in enumerate(paths):
        for other, weight in found[path].fitted_with:
            factor[place, paths.index(other)] = weight
        factor[place, place] = math.sqrt(1.0 - np.sum(factor[place] ** 2))
    return factor @ factor.T


def test_fitted_values_have_the_errors_and_the_correlation_of_their_fit(machine):
    """Within three standard errors, and no lower than the quantity may be."""
    found = _fitted_inputs(fitted(machine))
    assert list(found) == list(ERRORS)
    assert correlation_of(found) == pytest.approx(np.array(CORRELATION), abs=1e-8)
    for (path, one), error in zip(found.items(), (2e-4, 3e6, 0.01), strict=True):
        value = machine.values()[path]
        assert (one.low, one.high) == pytest.approx((value.si - 3.0 * error, value.si + 3.0 * error), rel=1e-12)
        assert (one.shape, one.basis, one.reason) == ("normal", FITTED_BASIS, "fitted to a pulse")
        assert one.deviation == pytest.approx(error, rel=1e-12)
    assert found["machine.engagement"].fitted_with == ()
    wide = _fitted_inputs(fitted(machine, (), "", {"object.mass": "300 gram"}))["object.mass"]
    assert 0.0 < wide.low < 1e-300
    assert (wide.high, wide.reason, wide.fitted_with) == (pytest.approx(0.459 + 0.9), "fitted", ())


def test_fitted_values_without_a_correlation_are_drawn_apart(machine):
    assert all(one.fitted_with == () for one in _fitted_inputs(fitted(machine, ())).values())


def test_values_that_always_go_together_in_a_fit_are_drawn_together_to_1_in_20_000(machine):
    one, other = list(ERRORS)[:2]
    found = _fitted_inputs(fitted(machine, ((1.0, 1.0), (1.0, 1.0)), errors={one: ERRORS[one], other: ERRORS[other]}))
    [(path, weight)] = found[other].fitted_with
    assert path == one
    assert 0.0 < math.sqrt(1.0 - weight**2) < 5e-5


def test_a_fit_tells_what_is_known_of_fitted_values_without_a_tolerance_of_their_own(machine):
    """The mass of the object is inferred, whatever a fit says."""
    inputs = {one.path: one for one in known_inputs(fitted(machine))}
    assert {path: inputs[path].basis for path in ERRORS} == {
        "machine.engagement": FITTED_BASIS,
        "object.frame_stiffness": FITTED_BASIS,
        "object.mass": UNSTATED,
    }
    value = machine.values()["machine.engagement"].model_copy(update={"tolerance": tolerance(1e-4)})
    own = machine.with_values({"machine.engagement": value}, keep_tolerances=False)
    inputs = {one.path: one for one in known_inputs(fitted(own))}
    assert inputs["machine.engagement"].basis == STATED


def test_numbers_of_named_materials_by_hand():
    """A pad's modulus within a fifth, its loss factor within a factor of 1.5, a metal's numbers within 1 %."""
    case = load_case("li-ma-2019-fig5")
    inputs = {one.path: one for one in known_inputs(case, ("sensor",)) if one.basis == NAMED_BASIS}
    for path, low, high, shape in (
        ("material.PTFE.modulus", 0.8, 1.2, "uniform"),
        ("material.PTFE.loss_factor", 1.0 / 1.5, 1.5, "log-uniform"),
        ("material.2A12.modulus", 0.99, 1.01, "uniform"),
        ("material.2A12.density", 0.99, 1.01, "uniform"),
    ):
        one = inputs[path]
        assert (one.low, one.high) == pytest.approx((low * one.value.si, high * one.value.si), rel=1e-12)
        assert one.shape == shape
        assert {field.partition(".")[0] for field in one.sets} == {"sensor"}
    assert "±1 %, published" in inputs["material.2A12.modulus"].reason
    assert not [one for one in known_inputs(case, ("object",)) if one.basis == NAMED_BASIS]


def test_what_is_computed_from_a_drawing_is_no_less_than_its_least_and_goes_with_its_others():
    """The pendulum of 400 lb and 5 ft: a point mass has 421.406 kg m^2, of which nothing is taken away."""
    case = load_case("mil-s-901d-hammer")
    one = next(one for one in known_inputs(case) if one.path == "machine.inertia")
    point = case.machine.mass.si * case.machine.centre.si**2
    assert one.low == pytest.approx(point, rel=1e-6)
    assert one.high == pytest.approx(1.1 * 421.4059, rel=1e-12)
    assert dict(one.goes_with) == {"machine.mass": 1.0, "machine.centre": 2.0}
    assert one.reason.endswith("; at the values of mass, centre in the case, with which it changes")


def test_an_automatic_yield_pressure_is_of_the_contacts_of_the_tables_asked_for():
    case = load_case("iso-16063-22-dropball")
    paths = [one.path for one in known_inputs(case, ("contact",)) if one.shape == "log-uniform" and one.sets]
    assert paths == ["contact.yield_pressure"]
    assert not [one for one in known_inputs(case, ("object",)) if one.path == "contact.yield_pressure"]
