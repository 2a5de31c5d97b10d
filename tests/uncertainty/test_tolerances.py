"""Tolerances of a case: what may be written, that it is kept, and what is told of a wrong one."""

import json

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from strikewave.analyses.machine.build import build_machine
from strikewave.base.errors import InputErrors
from strikewave.base.quantities import Range, Value
from strikewave.cases.case import document_of, dump_case, load_case, parse_case
from strikewave.cases.files import bundled_cases

MASS = Range("kg", 0.0, 1e6, open_low=True)


def edited(table, key, value):
    """The published case as TOML text with one key changed."""
    import tomlkit

    document = document_of(load_case("li-ma-2019"))
    document[table][key] = value
    return tomlkit.dumps(document)


@pytest.mark.parametrize(
    ("typed", "half"), [("2 %", 0.02), ("2%", 0.02), ("0.5 gram", 0.0005), ("100 %", 1.0), ("1 kg", 1.0)]
)
def test_a_tolerance_is_a_share_or_has_the_unit(typed, half):
    value = MASS.read({"value": "1 kg", "tolerance": typed})
    assert (value.half_width, value.tolerance.distribution) == (pytest.approx(half, rel=1e-15), "normal")


def test_a_relative_tolerance_follows_the_value():
    value = MASS.read({"value": "1 kg", "tolerance": "2 %"}).model_copy(update={"si": 3.0})
    assert value.half_width == 0.06
    assert Value(si=3.0, typed="3 kg").half_width == 0.0


def test_a_number_without_unit_takes_a_bare_tolerance():
    value = Range("", 0.01, 1.0).read({"value": 0.7, "tolerance": 0.05, "distribution": "uniform"})
    assert (value.half_width, value.tolerance.distribution) == (0.05, "uniform")


BAD = [
    ("machine", "strikers", {"value": 4, "tolerance": "10 %"}, "machine.strikers.tolerance: .* no tolerance on a whole"),
    ("feed", "blows", {"value": 11, "tolerance": 1}, "feed.blows.tolerance: .* no tolerance on a whole"),
    ("striker", "mass", {"value": "1 kg", "tolerance": "2 mm"}, 'striker.mass.tolerance: got "2 mm".* "mm" is not a mass'),
    ("striker", "mass", {"value": "1 kg", "tolerance": "20 g"}, "standard gravity"),
    ("striker", "mass", {"value": "1 kg", "tolerance": 0.02}, r"a share such as \"2 %\".*a bare number has no unit"),
    ("striker", "mass", {"value": "1 kg", "tolerance": "150 %"}, "at most 100 %"),
    ("striker", "mass", {"value": "1 kg", "tolerance": "1.5 kg"}, "at most the value itself"),
    ("striker", "mass", {"value": "1 kg", "tolerance": "-2 %"}, "above 0"),
    ("striker", "mass", {"value": "1 kg", "tolerance": "-20 gram"}, "above 0"),
    ("striker", "mass", {"value": "1 kg", "tolerance": "0 %"}, "above 0"),
    ("striker", "mass", {"value": "1 kg", "tolerance": "nan %"}, "one number, then its unit"),
    ("striker", "mass", {"value": "1 kg", "tolerance": ["2 %"]}, "tolerance"),
    ("striker", "mass", {"value": "1 kg", "tolerance": True}, "tolerance"),
    ("striker", "mass", {"value": "1 kg", "tolerence": "2 %"}, 'did you mean "tolerance"'),
    ("striker", "mass", {"value": "1 kg", "distribution": "uniform"}, "only beside a tolerance"),
    ("striker", "mass", {"value": "1 kg", "tolerance": "2 %", "distribution": "unifrom"}, 'did you mean "uniform"'),
    ("striker", "angle_error", {"value": "0 deg", "tolerance": "2 %"}, "the value is 0: give the tolerance with its unit"),
]  # fmt: skip


@pytest.mark.parametrize(("table", "key", "value", "told"), BAD)
def test_a_wrong_tolerance_is_told_in_one_line(table, key, value, told):
    with pytest.raises(InputErrors, match=told) as raised:
        parse_case(edited(table, key, value))
    assert len(raised.value.lines) == 1


def test_a_published_number_takes_no_tolerance():
    text = dump_case(load_case("li-ma-2019"))
    text += '[[published]]\nquantity = "count"\norigin = "measured"\nrole = "shown"\nvalue = { value = 11, tolerance = 1 }\n'
    with pytest.raises(InputErrors, match="no tolerance on a published number"):
        parse_case(text)


@settings(max_examples=8)
@given(
    share=st.floats(1e-6, 100.0), absolute=st.floats(1e-9, 0.75), distribution=st.sampled_from(["normal", "uniform"])
)
def test_what_is_written_reads_back(share, absolute, distribution):
    given = {"value": "1 kg", "tolerance": f"{share!r} %", "distribution": distribution}
    case = parse_case(edited("striker", "mass", given))
    assert case.striker.mass.half_width == share / 100.0
    case = case.with_values({"feed.arrival": Range("", 0.0, 1.0).read({"value": 0.75, "tolerance": absolute})})
    again = parse_case(dump_case(case))
    assert again == case
    assert again.values()["striker.mass"].tolerance.distribution == distribution


def test_a_set_value_keeps_its_tolerance_and_a_set_tolerance_its_value():
    case = load_case("li-ma-2019", ["striker.mass.tolerance=2 %", "striker.mass=1.5 kg"])
    assert (case.striker.mass.si, case.striker.mass.half_width) == (1.5, 0.03)
    case = load_case("li-ma-2019", ["striker.mass.tolerance=2 %", "striker.mass.distribution=uniform"])
    assert (case.striker.mass.si, case.striker.mass.tolerance.distribution) == (1.0, "uniform")
    assert case.striker.mass.provenance == "assumed"
    case = load_case("li-ma-2019", ["feed.arrival.tolerance=0.05"])
    assert case.feed.arrival.half_width == 0.05


def test_a_value_set_to_nothing_goes_without_a_share_of_it():
    case = load_case("li-ma-2019", ["object.damper=0 N s/m", "striker.mount_damping=0"])
    assert case.object.damper.tolerance is case.striker.mount_damping.tolerance is None
    assert case.object.spring.half_width == 4e3
    with pytest.raises(InputErrors, match="the value is 0"):
        load_case("li-ma-2019", ["object.damper=0 N s/m", "object.damper.tolerance=10 %"])


def test_a_plain_value_becomes_a_table_where_a_tolerance_is_set(tmp_path):
    file = tmp_path / "plain.toml"
    file.write_text(edited("striker", "mass", "1 kg"))
    assert load_case(str(file), ["striker.mass.tolerance=10 gram"]).striker.mass.half_width == 0.01


def test_a_tolerance_changes_no_published_case():
    """Only what the machine is counts as a difference from the published case, not how well it is known."""
    assert load_case("li-ma-2019", ["feed.arrival.tolerance=0.05"]).changed_fields() == []


def test_validate_lists_tolerances(strikewave):
    change = ("--set", "striker.mass.tolerance=2 %", "--set", "striker.mass.distribution=uniform")
    _, out, _ = strikewave("validate", "li-ma-2019", *change)
    assert "1 kg ± 2 %" in out
    assert "(uniform)" in out
    _, out, _ = strikewave("validate", "li-ma-2019", *change, "--json")
    row = json.loads(out)["values"]["striker.mass"]
    assert (row["tolerance"], row["distribution"]) == (0.02, "uniform")


def test_errors_and_restitution_of_strikers_reach_the_machine():
    """Common errors hold for each striker; a row of its own stands for them."""
    text = dump_case(load_case("li-ma-2019", ["striker.angle_error=0.1 deg", "striker.reach_error=20 um"]))
    text += '[[striker.each]]\nnumber = 2\nreach_error = "5 um"\nrestitution = 0.5\n'
    machine = build_machine(parse_case(text))
    assert [round(one.reach_error * 1e6, 9) for one in machine.strikers.each] == [20.0, 5.0, 20.0, 20.0]
    assert len({one.angle_error for one in machine.strikers.each}) == 1
    first, second = (one.contact for one in machine.strikers.each[:2])
    assert first != second
    assert machine.strikers.each[2].contact == first


def test_cases_without_tolerances_are_written_as_before():
    for name in bundled_cases():
        case = load_case(name)
        assert (", tolerance = {" in dump_case(case)) is False
        has = any(value.tolerance is not None for value in case.values().values())
        assert ("tolerance" in dump_case(case).replace("\ntolerance", "")) is has
