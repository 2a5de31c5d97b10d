"""Densities and moduli far from those of any known material are named, wherever a case or a set-up states them."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import BaseModel

from strikewave.base.constants import materials
from strikewave.base.quantities import MaybeDensity, MaybeModulus
from strikewave.cases.case import Case, parse_case
from strikewave.cases.materials_of_case import _LIMITED_COLUMNS, far_numbers
from strikewave.cases.tables.hopkinson import HopkinsonSetup, SpecimenTable
from strikewave.cases.tables.stack import LayerTable

SIZES = {"name": "bar", "length": "60 mm", "diameter": "30 mm"}


def far(**fields):
    """Return the notices on a layer."""
    return list(far_numbers([("stack.layer.bar", LayerTable(**SIZES, **fields))]))


@pytest.mark.parametrize(
    ("fields", "words"),
    [
        ({"density": "7.82 kg/m^3", "modulus": "211 GPa"}, ["density = 7.82 kg/m^3", "rubber", "1120 kg/m^3"]),
        ({"density": "200000 kg/m^3", "modulus": "211 GPa"}, ["density = 200000 kg/m^3", "10.4 times", "tungsten"]),
        ({"density": "7820 kg/m^3", "modulus": "0.05 MPa"}, ["modulus = 0.05 MPa", "softest", "5.72 MPa"]),
        ({"density": "7820 kg/m^3", "modulus": "40000 GPa"}, ["modulus = 40000 GPa", "100 times", "400 GPa"]),
        ({"density": "78.2 kg/m^3", "modulus": "211 GPa"}, ["78.2 kg/m^3", "211 GPa", "51944\xa0m/s", "65Mn"]),
        ({"material": "65Mn", "modulus": "211 MPa"}, ["modulus = 211 MPa", "1/1000 of that of 65Mn", "211 GPa"]),
        ({"material": "65Mn", "density": "7820000 gram/m^3", "modulus": "5000 GPa"}, ["23.7 times that of 65Mn"]),
    ],
)
def test_a_number_of_no_material_is_named_with_what_it_was_compared_with(fields, words):
    (notice,) = far(**fields)
    assert notice.code == "material-far"
    assert notice.message.startswith("stack.layer.bar.")
    assert [word for word in words if word not in notice.message] == []


@pytest.mark.parametrize(
    ("density", "modulus"),
    [(22590, 560e9), (3515, 1.22e12), (1848, 287e9), (15, 2.5e6), (1000, 60e3), (160, 3.4e9)],
    ids=["osmium", "diamond", "beryllium", "EPS foam", "silicone gel", "balsa"],
)
def test_real_materials_outside_of_the_table_are_not_named(density, modulus):
    """Handbook numbers of the densest, the stiffest, the fastest solids, and of light and soft ones."""
    assert far(density=f"{density} kg/m^3", modulus=f"{modulus} Pa") == []


def test_no_material_of_the_table_is_named():
    for row in materials().values():
        assert far(density=f"{row.density} kg/m^3", modulus=f"{row.youngs_modulus} Pa") == []


@given(st.floats(math.log(1e3), math.log(1e15)))
def test_a_modulus_a_factor_of_a_hundred_from_all_materials_is_named(logarithm):
    modulus = min(max(math.exp(logarithm), 1e3), 1e15)
    ratios = [modulus / row.youngs_modulus for row in materials().values()]
    if all(ratio >= 100.0 or ratio <= 0.01 for ratio in ratios):
        assert far(density="19300 kg/m^3", modulus=f"{modulus!r} Pa")


def fields_of(model, seen):
    """Yield the names of all densities and moduli of a table and those in it."""
    if model in seen:
        return
    seen.add(model)
    for key, field in model.model_fields.items():
        if field.metadata[:1] and field.metadata[0] in (*MaybeDensity.__metadata__, *MaybeModulus.__metadata__):
            yield key
        for inner in tables_in(field.annotation):
            yield from fields_of(inner, seen)


def tables_in(annotation):
    """Yield the tables that an annotation is made of."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation
        yield from annotation.__subclasses__()
    for inner in getattr(annotation, "__args__", ()):
        yield from tables_in(inner)


@pytest.mark.parametrize(("model", "names"), [(Case, {"density", "modulus"}), (HopkinsonSetup, {"density", "modulus"})])
def test_every_density_and_modulus_that_a_table_can_state_is_looked_at(model, names):
    """A new field of that kind under another name is found here."""
    assert set(fields_of(model, set())) == names
    assert names <= set(_LIMITED_COLUMNS)


def test_a_specimen_of_split_bars_is_looked_at_too():
    specimen = SpecimenTable(length="5 mm", diameter="8 mm", density="8.9 kg/m^3")
    (notice,) = far_numbers([("specimen", specimen)])
    assert notice.message.startswith("specimen.density = 8.9 kg/m^3")


def test_the_solid_of_an_element_part_is_looked_at():
    """The part of elements names its material one table above the modulus of its solid."""
    case = parse_case(
        """
        schema = 1
        [[mesh.part]]
        name = "block"
        shape = "block"
        width = "10 mm"
        depth = "10 mm"
        height = "10 mm"
        size = "5 mm"
        material = "2A12"
        solid = { law = "elastic", modulus = "72 MPa" }
        [fem]
        duration = "10 us"
        """
    )
    (notice,) = far_numbers([("mesh", case.mesh)])
    assert "mesh.part.block.solid.modulus = 72 MPa is 1/1000 of that of 2A12" in notice.message
