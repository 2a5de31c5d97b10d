"""Layers and joints of a bar on its page: put in another order, added, removed."""

import pytest

from strikewave.base.errors import StrikewaveError
from strikewave.cases.case import parse_case
from strikewave.cases.stack_of_case import build_stack
from strikewave.web.case_state import JOINTS, CaseSource
from strikewave.web.case_values import listed_stack, rearranged, with_joint, with_layer, without_joint, without_layer

JOINED = """
schema = 1
name = "joined"
[[stack.layer]]
name = "a"
material = "65Mn"
length = "10 mm"
diameter = "20 mm"
[[stack.layer]]
name = "b"
material = "45 steel"
length = "20 mm"
diameter = "20 mm"
[[stack.layer]]
name = "c"
material = "65Mn"
length = "30 mm"
diameter = "20 mm"
[[stack.joint]]
after = "a"
kind = "compliant"
stiffness = "1 GN/m"
[load]
shape = "half-sine"
peak = "1 kN"
duration = "20 us"
[[tap]]
name = "end"
layer = "c"
position = 1.0
[solver]
duration = "50 us"
"""


def stack_of(text):
    """Return names of layers, and joints as (layer before, kind), of a case file."""
    stack = parse_case(text, "joined").stack
    return [layer.name for layer in stack.layer], [(joint.after, joint.kind) for joint in stack.joint]


def of_joined(text=JOINED):
    return CaseSource("joined", text, (), "")


D = {"name": "d", "material": "45 steel", "length": "5 mm", "diameter": "20 mm"}


def test_layers_change_places_and_a_joint_stays_behind_the_place_that_it_is_given():
    source = of_joined()
    assert [(row.layer, row.joint) for row in listed_stack(source).rows] == [("a", "a"), ("b", ""), ("c", "")]
    text = rearranged(source, ["c", "a", "b"], ["", "a", ""])
    stack = parse_case(text, "joined").stack
    assert [layer.name for layer in stack.layer] == ["c", "a", "b"]
    assert [layer.length.si for layer in stack.layer] == pytest.approx([0.03, 0.01, 0.02])
    assert [(joint.after, joint.kind) for joint in stack.joint] == [("a", "compliant")]


@pytest.mark.parametrize(
    ("layers", "joints"),
    [
        (["a", "b"], ["a", ""]),
        (["a", "b", "b"], ["a", "", ""]),
        (["a", "b", "c"], ["", "", ""]),
        (["a", "b", "c"], ["a"]),
    ],
)
def test_an_order_that_loses_a_layer_or_a_joint_is_refused(layers, joints):
    with pytest.raises(StrikewaveError, match="each of a, b, c once"):
        rearranged(of_joined(), layers, joints)


@pytest.mark.parametrize(("behind", "names"), [("", "dabc"), ("a", "adbc"), ("c", "abcd")])
def test_a_layer_is_added_behind_another_whose_joint_stays_before_it(behind, names):
    text = with_layer(of_joined(), behind, D)
    assert stack_of(text) == (list(names), [("a", "compliant")])
    added = next(layer for layer in parse_case(text, "joined").stack.layer if layer.name == "d")
    assert (added.length.si, added.length.provenance) == (pytest.approx(5e-3, rel=1e-15), "user")
    assert stack_of(without_layer(of_joined(text), "d")) == stack_of(JOINED)


def test_a_layer_of_numbers_of_its_own_is_added_and_listed_with_them():
    own = {
        "name": "d",
        "length": "5 mm",
        "diameter": "",
        "area": "3 cm^2",
        "density": "1850 kg/m^3",
        "modulus": "24 GPa",
    }
    text = with_layer(of_joined(), "a", own | {"material": "", "poissons_ratio": "0.3"})
    row = listed_stack(of_joined(text)).rows[1]
    assert row.layer_label == "1850 kg/m^3, 24 GPa, 5 mm"
    layer = build_stack(parse_case(text, "joined")).layers[1]
    assert (layer.density, layer.modulus, layer.poissons_ratio) == (1850.0, 24e9, 0.3)
    assert layer.area == pytest.approx(3e-4, rel=1e-12)


def test_a_layer_that_goes_takes_its_joint_its_taps_and_their_sensors_along():
    sensed = JOINED + '[[sensor]]\nname = "s"\ntap = "end"\nmodel = "PCB 350C02"\n'
    assert stack_of(without_layer(of_joined(sensed), "a")) == (["b", "c"], [])
    ended = parse_case(without_layer(of_joined(sensed), "c"), "joined")
    assert ended.tap == ended.sensor == ()
    alone = without_layer(of_joined(without_layer(of_joined(), "c")), "b")  # no joint behind the last layer
    assert stack_of(alone) == (["a"], [])
    with pytest.raises(StrikewaveError, match="a bar has one at least"):
        without_layer(of_joined(alone), "a")


@pytest.mark.parametrize("kind", JOINTS)
def test_each_kind_of_joint_is_added_with_the_properties_that_its_form_begins_from(kind):
    text = with_joint(of_joined(), "b", kind, JOINTS[kind].splitlines())
    assert stack_of(text)[1] == [("a", "compliant"), ("b", kind)]
    assert stack_of(without_joint(of_joined(text), "b")) == stack_of(JOINED)


@pytest.mark.parametrize(
    ("change", "why"),
    [
        (lambda source: with_layer(source, "x", D), "a layer of this bar"),
        (lambda source: with_layer(source, "c", D | {"name": "a"}), "a name that no other layer has"),
        (lambda source: with_layer(source, "c", D | {"length": ""}), "stack.layer.d.length: missing"),
        (lambda source: with_layer(source, "c", D | {"material": "stele"}), "a material of the table"),
        (lambda source: with_layer(source, "c", D | {"material": ""}), "a material, or density and modulus"),
        (lambda source: with_layer(source, "c", D | {"area": "3 cm^2"}), "diameter or area, not both"),
        (lambda source: with_layer(source, "c", D | {"density": "1850"}), "a density with its unit"),
        (lambda source: with_joint(source, "a", "mass", ["mass = 5 gram"]), "without a joint behind it"),
        (lambda source: with_joint(source, "c", "mass", ["mass = 5 gram"]), "a layer that another one follows"),
        (lambda source: with_joint(source, "b", "mass", []), "stack.joint.b.mass"),
        (lambda source: with_joint(source, "b", "mass", ["5 gram"]), "path=value"),
        (lambda source: without_joint(source, "x"), "a layer of this bar"),
    ],
)
def test_a_bar_that_cannot_be_is_refused_in_words(change, why):
    with pytest.raises(StrikewaveError, match=why):
        change(of_joined())
