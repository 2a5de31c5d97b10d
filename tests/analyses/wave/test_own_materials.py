"""Layers whose density, modulus and Poisson's ratio stand in the case: as one that names them, in contacts too."""

import re

import pytest

from strikewave import load_case
from strikewave.analyses.wave.build import build_load
from strikewave.analyses.wave.run import bar_figures, run_wave
from strikewave.base.constants import material
from strikewave.base.errors import InputErrors, StrikewaveError
from strikewave.cases.case import parse_case
from strikewave.cases.stack_of_case import build_stack

NAMED = 'material = "2A12"'
ALLOY = material("2A12")
OWN = f"""density = "{ALLOY.density} kg/m^3"
modulus = "{ALLOY.youngs_modulus} Pa"
poissons_ratio = {ALLOY.poissons_ratio}"""
LAYERS = """
schema = 1
[[stack.layer]]
name = "first"
material = "2A12"
length = "40 mm"
diameter = "20 mm"
[[stack.layer]]
name = "second"
material = "65Mn"
length = "60 mm"
area = "3 cm^2"
"""
CONTACT = """
[[stack.joint]]
after = "first"
kind = "contact"
radius = "50 mm"
"""
FORCE = """
[load]
shape = "half-sine"
peak = "2 kN"
duration = "40 us"
[solver]
duration = "150 us"
"""
STRUCK = """
[load]
shape = "contact"
speed = "2 m/s"
[striker]
mass = "0.1 kg"
material = "65Mn"
nose_radius = "10 mm"
contact_length = "10 mm"
mount_stiffness = "1 N/m"
mount_damping = "0 N s/m"
[contact]
law = "hertz"
restitution = 1.0
slowest_approach = "1 mm/s"
[solver]
duration = "150 us"
"""
CASES = {"bonded": LAYERS + FORCE, "contact": LAYERS + CONTACT + FORCE, "struck": LAYERS + STRUCK}


def own(text, numbers=OWN):
    return text.replace(NAMED, numbers)


@pytest.mark.parametrize("name", CASES)
def test_numbers_of_ones_own_are_those_of_the_material_that_has_them(name):
    assert bar_figures(parse_case(own(CASES[name]), "own")) == bar_figures(parse_case(CASES[name], "named"))


@pytest.mark.parametrize("name", ["contact", "struck"])
def test_a_contact_has_the_modulus_of_the_layer_and_not_of_the_material_that_it_also_names(name):
    """Of half the modulus, written beside the name or for all of the layer's own."""
    half = f"{ALLOY.youngs_modulus / 2} Pa"
    beside = parse_case(CASES[name], "beside", [f"stack.layer.first.modulus={half}"])
    alone = parse_case(own(CASES[name]), "alone", [f"stack.layer.first.modulus={half}"])
    assert bar_figures(beside) == bar_figures(alone)
    contacts = [
        build_stack(case).joints[0].contact if name == "contact" else build_load(case, build_stack(case)).contact
        for case in (beside, parse_case(CASES[name], "named"))
    ]
    assert contacts[0].stiffness < contacts[1].stiffness


@pytest.mark.parametrize(
    ("name", "numbers", "line"),
    [
        (
            "contact",
            'density = "2780 kg/m^3"\nmodulus = "72 GPa"',
            "stack.layer.first.poissons_ratio: missing; needed: a number of its own, for the contact, where it names no "
            'material; add poissons_ratio = 0.3, or material = "65Mn"',
        ),
        ("struck", 'density = "2780 kg/m^3"\nmodulus = "72 GPa"', "stack.layer.first.poissons_ratio: missing"),
        ("bonded", 'density = "2780 kg/m^3"', "stack.layer.first.material: missing"),
        ("bonded", 'density = "2780"\nmodulus = "72 GPa"', "density with its unit"),
        ("bonded", 'density = "0.001 kg/m^3"\nmodulus = "72 GPa"', "at least 0.1 kg/m^3"),
        ("bonded", 'density = "2780 kg/m^3"\nmodulus = "72 Pa"', "at least 1000 Pa"),
        ("bonded", 'density = "nan kg/m^3"\nmodulus = "72 GPa"', "density with its unit"),
        ("contact", f"{OWN}\nyield_strength = 3", "yield_strength: unknown key"),
        ("contact", OWN.replace("poissons_ratio = 0.33", "poissons_ratio = 0.6"), "at most 0.5"),
    ],
)
def test_what_a_layer_of_its_own_lacks_is_named_with_what_to_add(name, numbers, line):
    with pytest.raises((StrikewaveError, InputErrors), match=re.escape(line)) as error:
        run_wave(parse_case(own(CASES[name], numbers), "own"))
    assert "\n" not in str(error.value)


def test_an_area_no_wider_than_an_atom_is_refused():
    with pytest.raises(InputErrors, match=r"stack\.layer\.second\.area: .*at least 1e-12 m\^2"):
        parse_case(LAYERS.replace("3 cm^2", "1e-30 m^2") + FORCE, "thin")


def test_a_pressure_of_its_own_is_asked_for_where_no_table_has_a_hardness():
    text = own(CASES["contact"]).replace('radius = "50 mm"', 'radius = "50 mm"\nyield_pressure = "auto"')
    with pytest.raises(StrikewaveError, match="first has neither hardness nor yield strength"):
        build_stack(parse_case(text, "own"))
    given = parse_case(text.replace('"auto"', '"1 GPa"'), "own")
    assert build_stack(given).joints[0].contact.cap is not None


def test_poissons_ratio_of_a_named_material_stays_where_its_modulus_is_replaced():
    changes = ["stack.layer.upper.modulus=200 GPa", "solver.dispersion=love-rayleigh"]
    layers = build_stack(load_case("li-ma-2019-fig13-bar", changes)).layers
    assert layers[0].poissons_ratio == material("65Mn").poissons_ratio


def test_none_takes_a_quantity_out_and_what_is_needed_is_then_missing():
    """A diameter gives way to an area; without either, and without a length, that is said."""
    changes = ["stack.layer.first.diameter=none", "stack.layer.first.area=3 cm^2"]
    assert build_stack(parse_case(CASES["bonded"], "area", changes)).layers[0].area == pytest.approx(3e-4)
    with pytest.raises(StrikewaveError, match=re.escape('or --set "stack.layer.first.diameter=none"')):
        build_stack(parse_case(CASES["bonded"], "both", changes[1:]))
    with pytest.raises(StrikewaveError, match="a diameter or an area"):
        build_stack(parse_case(CASES["bonded"], "neither", changes[:1]))
    with pytest.raises(InputErrors, match=r"stack\.layer\.first\.length: missing"):
        parse_case(CASES["bonded"], "short", ["stack.layer.first.length=none"])
    kept = parse_case(CASES["bonded"], "kept", ["solver.error=none"])
    assert kept == parse_case(CASES["bonded"], "kept")
