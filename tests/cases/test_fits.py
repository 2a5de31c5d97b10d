"""A fit applies as long as the fields that it was made under are as they were, and the case says so where they are not."""

import math
import tomllib
from importlib import resources

import pytest

from strikewave.analyses.machine.run import observe
from strikewave.base.errors import InputErrors
from strikewave.base.quantities import Value
from strikewave.cases.case import comparisons, dump_case, load_case, origin_notices, own_case, parse_case
from strikewave.cases.files import bundled_cases
from strikewave.uncertainty.input_ranges import known_inputs

FITTED = ["machine.engagement", "object.frame_stiffness"]
NUDGES = {"rad": 1.75e-3, "m": 20e-6}
"""What a value of 0 is changed by: a tenth of it is nothing."""
FELT = 5e-4
"""Change of the first pulse that counts: half a per mille, a fifth of what a peak is read to."""


def stale(*changes):
    return {one.field: [change.path for change in one.changed] for one in load_case("li-ma-2019", changes).stale_fits()}


def test_every_fitted_value_of_a_built_in_case_has_a_fit_that_applies(published):
    assert {path for fit in published.fit for path in fit.fields} == set(published.fitted_fields())
    assert published.stale_fits() == []
    for fit in published.fit:
        assert set(fit.fields) <= set(fit.under)


@pytest.mark.parametrize("path", ["machine.speed", "striker.mass", "machine.strikers", "contact.restitution"])
def test_a_field_that_a_fit_was_made_under_ends_it(path):
    old = load_case("li-ma-2019").values()[path]
    new = 5 if path == "machine.strikers" else 0.9 * old.si
    assert stale(f"{path}={new}") == {field: [path] for field in FITTED}


def test_what_a_fit_does_not_feel_leaves_it_in_force():
    assert stale("machine.brake=10 N m", "feed.blows=3", "recorder.memory=1000", "title=mine") == {}
    assert stale("striker.mass=1000 gram", "machine.speed=730 rpm") == {}


def test_a_law_and_a_field_that_was_left_out_count_too():
    assert stale("contact.yield_pressure=auto") == {field: ["contact.yield_pressure"] for field in FITTED}
    assert stale("striker.material=45 steel") == {field: ["striker.material"] for field in FITTED}


def test_of_two_values_fitted_together_the_one_that_is_kept_no_longer_applies():
    assert stale("machine.engagement=4 mm") == {"object.frame_stiffness": ["machine.engagement"]}


def test_a_value_whose_fit_no_longer_applies_is_assumed_and_says_what_changed():
    case = load_case("li-ma-2019", ["machine.speed=500 rpm"])
    assert case.fitted_fields() == FITTED
    value = case.with_stale_fits_assumed().values()["machine.engagement"]
    assert value.provenance == "assumed"
    assert value.note == "fit no longer applies: machine.speed (500 rpm, then 730 rpm) changed"
    assert [notice.code for notice in origin_notices(case)] == ["not-compared", "fit-stale"]


def test_the_band_knows_no_more_of_a_value_whose_fit_no_longer_applies_than_of_an_assumed_one():
    fitted, loose = (
        {one.path: one for one in known_inputs(load_case("li-ma-2019", changes))}["machine.engagement"]
        for changes in ([], ["striker.mass=1.2 kg"])
    )
    assert loose.width > 5.0 * fitted.width


def test_a_file_keeps_its_fits_without_its_source():
    own = own_case(load_case("li-ma-2019"), "mine", "li-ma-2019").model_copy(update={"source": ""})
    text = dump_case(own).replace('value = "1 kg"', 'value = "1.2 kg"')
    assert [one.field for one in parse_case(text).stale_fits()] == FITTED


@pytest.mark.verify
def test_the_fields_of_the_fit_are_those_that_move_the_first_pulse():
    """A tenth of any other quantity, or a nudge where it is 0, moves neither peak nor width by half a per mille."""
    case = load_case("li-ma-2019", ["feed.blows=1"])

    def pulse(changed):
        blow = observe(changed).blows[0]
        return blow.rigid_peak, blow.width

    first, (fit,) = pulse(case), load_case("li-ma-2019").fit
    felt = set()
    for path, value in case.values().items():
        if path.startswith(("recorder.", "solver.")) or path == "feed.blows":
            continue
        unit = "rad" if path == "striker.angle_error" else "m"
        si = value.si + 1 if path == "machine.strikers" else 1.1 * value.si or NUDGES[unit]
        moved = pulse(case.with_values({path: Value(si=si, typed=si)}, keep_tolerances=False))
        if any(abs(a / b - 1.0) >= FELT for a, b in zip(moved, first, strict=True)):
            felt.add(path)
    assert felt == {path for path in fit.under if path in case.values()}


def text_with(old, new):
    text = (resources.files("strikewave.cases") / "published" / "li-ma-2019.toml").read_text("utf-8")
    assert text.count(old) == 1
    return text.replace(old, new)


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ('"striker.mass" = "1 kg"', '"striker.mas" = "1 kg"', 'fit.0.under: got "striker.mas"'),
        ('"striker.mass" = "1 kg"', '"striker.mass" = "1 m"', "fit.0.under.striker.mass"),
        ('fields = ["machine.engagement", ', 'fields = ["machine.engagment", ', 'did you mean "engagement"'),
    ],
)
def test_a_fit_that_names_no_field_is_refused(old, new, told):
    with pytest.raises(InputErrors, match=r"fit\.0") as caught:
        parse_case(text_with(old, new))
    assert told in str(caught.value)


def compared(*changes, case=None):
    case = load_case("li-ma-2019", changes) if case is None else case
    return comparisons(case, lambda entry: 2.0 * entry.value.si), [notice.code for notice in origin_notices(case)]


def test_a_changed_case_is_compared_only_where_it_asks():
    rows, codes = compared()
    assert (len(rows), {row.role for row in rows}, codes) == (8, {"fitted", "predicted", "shown"}, [])
    rows, codes = compared("machine.brake=10 N m")
    assert (rows, codes) == ((), ["not-compared"])
    rows, codes = compared("machine.brake=10 N m", "compare=true")
    assert (len(rows), {row.role for row in rows}, codes) == (8, {"shown"}, ["changed-case"])
    assert {row.note for row in rows} == {"the case differs in machine.brake"}
    assert compared("compare=false") == ((), [])


def test_a_case_of_ones_own_asks_for_the_numbers_of_its_source_and_always_has_its_own():
    text = dump_case(own_case(load_case("li-ma-2019"), "mine", "li-ma-2019"))
    assert compared(case=parse_case(text, changes=["machine.speed=500 rpm"])) == ((), ["fit-stale"])
    rows, codes = compared(case=parse_case(text, changes=["machine.speed=500 rpm", "compare=true"]))
    assert (len(rows), codes) == (8, ["changed-case", "fit-stale"])
    own = '\n[[published]]\nquantity = "first.rigid_peak"\nvalue = "1000 g"\norigin = "measured"\nrole = "predicted"\n'
    rows, codes = compared(case=parse_case(text + own, changes=["machine.speed=500 rpm"]))
    assert [(row.role, math.isclose(row.published, 9806.65)) for row in rows] == [("predicted", True)]
    assert codes == ["fit-stale"]


def test_no_built_in_case_warns_of_itself():
    assert [notice for name in bundled_cases() for notice in origin_notices(load_case(name))] == []
    assert tomllib.loads(dump_case(load_case("li-ma-2019")))["fit"][0]["under"]["machine.strikers"] == 4
