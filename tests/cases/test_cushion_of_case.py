"""A cushion in a case: all that its law lacks is said at once, and the name of a law is no material."""

import json

import pytest

from strikewave.base.errors import InputError
from strikewave.cases.case import parse_case
from strikewave.cases.contact_of_case import cushion_contact
from strikewave.cases.files import read_case_text

RUBBER = read_case_text("iec-60068-2-27-rubber")[0].replace("source = ", "# source = ")
MATERIAL = 'material = "natural rubber 65 IRHD"'
FELT = RUBBER.replace(MATERIAL, 'law = "felt"')


def refusal(text, *changes):
    with pytest.raises(InputError) as error:
        cushion_contact(parse_case(text, changes=changes).contact)
    return str(error.value).splitlines()


def test_all_that_a_felt_lacks_is_said_at_once():
    """A rubber pad made a felt one: its law needs three numbers, and forbids the restitution of the rubber."""
    lines = refusal(FELT)
    assert [line.split(":")[0] for line in lines] == [
        *(f"contact.cushion.{key}" for key in ("stress", "exponent", "retardation")), "contact.restitution",
    ]  # fmt: skip
    assert all("add " in line for line in lines[:3])
    assert "write restitution = 1" in lines[3]


def test_what_the_lines_say_makes_the_case_run():
    said = {line.split(":")[0]: line.rsplit(" = ", 1)[1].strip('"') for line in refusal(FELT)}
    case = parse_case(FELT, changes=[f"{path}={value}" for path, value in said.items()])
    assert cushion_contact(case.contact).damper.style == "retarded"


@pytest.mark.parametrize(("law", "needed"), [("felt", "stress = "), ("Crush", "plateau = ")])
def test_a_law_named_as_material_is_said_to_be_one(law, needed):
    (line,) = refusal(RUBBER.replace(MATERIAL, f'material = "{law}"'), "contact.restitution=1")
    assert f'got "{law}"' in line
    assert f'write law = "{law.lower()}" in its place' in line
    assert needed in line


def test_a_misspelt_material_names_the_nearest():
    (line,) = refusal(RUBBER, "contact.cushion.material=EPS-22", "contact.restitution=1")
    assert 'did you mean "EPS 22"' in line


@pytest.mark.parametrize("loss", [["retardation=20 us"], ["loss_factor=0.1", "loss_frequency=100 Hz"]])
def test_a_pad_loses_energy_in_one_way(loss):
    changes = [f"contact.cushion.{one}" for one in loss]
    (line,) = refusal(RUBBER, *changes)
    assert line.startswith("contact.restitution: got 0.75")
    cushion_contact(parse_case(RUBBER, changes=[*changes, "contact.restitution=1"]).contact)


@pytest.mark.verify
def test_the_felt_start_runs_as_it_stands(strikewave):
    """Its pad is pressed by six tenths at its own height: far from solid, where a felt says no more."""
    assert strikewave("new", "mine", "--from", "felt")[0] == 0
    text = open("mine.toml").read()
    assert "# carriage with all that falls on it" in text
    assert "# base of the machine" in text
    code, out, err = strikewave("run", "mine.toml", "--no-band", "--json")
    assert code == 0, err
    warnings = {one["code"]: one for one in json.loads(out)["warnings"] if one["severity"] != "info"}
    assert not warnings
