"""[mesh] and [fem]: round trips, what is built of them, and what wrong input is told, one line each."""

import math

import numpy as np
import pytest

from strikewave.analyses.by_tables import check_case
from strikewave.analyses.fem.build import LARGEST, build_model, built_parts, estimated_elements, exact_volume
from strikewave.analyses.fem.notices import model_notices
from strikewave.analyses.fem.screen import say_faceted
from strikewave.base.errors import InputError, InputErrors
from strikewave.cases.case import dump_case, load_case, origin_notices, parse_case
from strikewave.cases.files import bundled_cases
from strikewave.fem.mesh import volumes
from strikewave.fem.model import Driven, Fixed, Guided, NonReflecting, Pressure, Symmetry
from strikewave.fem.quality import quality_report
from strikewave.fem.solids import Bilinear, Elastic, JohnsonCook, ZerilliArmstrong

CASE = """
schema = 1
title = "A ball on a block"

[[mesh.part]]
name = "ball"
shape = "ball"
material = "65Mn"
radius = "10 mm"
size = "2.5 mm"
sector = "quarter"
at = { z = { value = "14.01 mm", provenance = "measured", note = "gauge block" } }
velocity = { z = "-1 m/s" }
solid = { law = "bilinear", tangent_modulus = "21 GPa" }

[[mesh.part]]
name = "block"
shape = "block"
material = "2A12"
width = "10 mm"
depth = "8 mm"
height = "4 mm"
size = "2 mm"
elements = "full"

[fem]
duration = "80 us"
gravity = { z = "-1 g" }

[[fem.contact]]
first = "ball.round"
second = "block"
friction = 0.1

[[fem.boundary]]
kind = "symmetry"
side = "ball.x-"

[[fem.boundary]]
kind = "pressure"
side = "block.x+"
time = ["0 us", { value = "10 us", provenance = "measured" }]
pressure = ["0 MPa", "10 MPa"]
"""


def edited(*changes):
    """The case above with pieces of its text replaced."""
    text = CASE
    for old, new in changes:
        assert text.count(old) >= 1, old
        text = text.replace(old, new, 1)
    return text


def with_fem(text):
    """The case above with more tables behind."""
    return CASE + text


@pytest.mark.verify
@pytest.mark.parametrize("name", [name for name in bundled_cases() if load_case(name).command == "fem"])
def test_bundled_cases_of_hexahedra_build(name):
    model = build_model(load_case(name))
    assert set(model.solids) == set(model.mesh.names)


def test_a_case_of_hexahedra_is_written_and_read_back_the_same():
    case = parse_case(CASE)
    again = parse_case(dump_case(case))
    assert again == case
    assert case.command == "fem"
    assert "[solver]" not in dump_case(case)
    assert case.values()["mesh.part.ball.at.z"].provenance == "measured"
    assert case.values()["fem.boundary.1.time.1"].si == 10e-6


@pytest.mark.parametrize(
    ("change", "path", "value"),
    [
        ("mesh.part.ball.radius=5 mm", "mesh.part.ball.radius", 5e-3),
        ("mesh.part.ball.velocity.z=-2", "mesh.part.ball.velocity.z", -2.0),
        ("mesh.part.ball.velocity.x=3 m/s", "mesh.part.ball.velocity.x", 3.0),  # a component that was not there
        ("mesh.part.ball.solid.kinematic=1", "mesh.part.ball.solid.kinematic", 1.0),
        ("mesh.part.0.size=3 mm", "mesh.part.ball.size", 3e-3),
        ("fem.contact.0.friction=0.2", "fem.contact.0.friction", 0.2),
        ("fem.frames=7", "fem.frames", 7.0),
    ],
)
def test_a_value_can_be_changed_from_the_command_line(tmp_path, change, path, value):
    (tmp_path / "case.toml").write_text(CASE)
    case = load_case(str(tmp_path / "case.toml"), [change])
    assert case.values()[path].si == value
    assert case.values()[path].provenance == "user"


def test_what_a_case_says_is_what_the_model_has():
    model = build_model(parse_case(CASE), threads=2)
    mesh = model.mesh
    ball, block = (mesh.points[mesh.nodes_of(name)] for name in ("ball", "block"))
    assert ball[:, 2].min() == pytest.approx(4.01e-3, abs=1e-15)  # moved up by 14.01 mm, its radius is 10 mm
    assert block.min(axis=0) == pytest.approx([-5e-3, -4e-3, 0.0], abs=1e-18)
    assert block.max(axis=0) == pytest.approx([5e-3, 4e-3, 4e-3], abs=1e-18)
    assert volumes(mesh.points, mesh.hexahedra[mesh.elements_of("block")]).sum() == pytest.approx(3.2e-7, rel=1e-12)
    # yield: that of 65Mn in the table of materials, since the case gives none
    assert model.solids["ball"] == Bilinear(7820.0, 211e9, 0.288, 430e6, 21e9)
    assert type(model.solids["block"]) is Elastic
    assert model.velocity == {"ball": (0.0, 0.0, -1.0)}
    assert model.gravity == (0.0, 0.0, -9.80665)
    assert model.controls.full == ("block",)
    assert (model.controls.duration, model.controls.threads) == (80e-6, 2)
    (contact,) = model.contacts
    assert (contact.first, contact.second, contact.friction) == ("ball.round", "block.all", 0.1)
    symmetry, pressure = model.boundaries
    assert symmetry == Symmetry("ball.x-")
    assert isinstance(pressure, Pressure)
    assert (pressure.pressure.time, pressure.pressure.value) == ((0.0, 10e-6), (0.0, 10e6))


MORE = """
[[fem.boundary]]
kind = "fixed"
side = "block.z-"
[[fem.boundary]]
kind = "guided"
side = "ball"
axis = { x = 3, z = -4 }
[[fem.boundary]]
kind = "driven"
side = "block.x-"
direction = "-y"
time = ["0 us"]
velocity = ["2 m/s"]
[[fem.boundary]]
kind = "non-reflecting"
side = "block.y+"
[[fem.tie]]
side = "ball.y-"
onto = "block.z+"
[[fem.wall]]
side = "block.z-"
point = { z = "-1 mm" }
normal = "z"
friction = 0.3
[[fem.section]]
name = "middle"
part = "block"
point = { z = "2.1 mm" }
normal = { z = 2 }
[[fem.point]]
name = "corner"
part = "block"
place = { x = "5 mm", y = "4 mm", z = "4 mm" }
"""


def test_every_table_of_fem_becomes_its_part_of_the_model():
    model = build_model(parse_case(with_fem(MORE)))
    fixed, guided, driven, open_side = model.boundaries[2:]
    assert fixed == Fixed("block.z-")
    assert guided == Guided("ball", (0.6, 0.0, -0.8))  # a unit vector
    assert isinstance(driven, Driven)
    assert driven.direction == (0.0, -1.0, 0.0)
    assert open_side == NonReflecting("block.y+")
    assert (model.ties[0].side, model.ties[0].onto) == ("ball.y-", "block.z+")
    assert (model.walls[0].point, model.walls[0].normal, model.walls[0].friction) == ((0, 0, -1e-3), (0, 0, 1), 0.3)
    assert (model.sections[0].normal, model.points[0].place) == ((0, 0, 1), (5e-3, 4e-3, 4e-3))
    assert parse_case(dump_case(parse_case(with_fem(MORE)))) == parse_case(with_fem(MORE))


@pytest.mark.parametrize(
    ("rigid", "translations", "turns"),
    [
        ("free", (True, True, True), True),
        ("translation", (True, True, True), False),
        ("y", (False, True, False), False),
    ],
)
def test_a_rigid_part_has_the_freedoms_it_is_given(rigid, translations, turns):
    model = build_model(parse_case(edited(('elements = "full"', f'rigid = "{rigid}"'))))
    (found,) = model.rigid
    assert (found.part, found.translations, found.rotations) == ("block", translations, (turns,) * 3)


def test_a_johnson_cook_solid_takes_what_it_is_given_in_units():
    solid = (
        'solid = { law = "johnson-cook", A = "792 MPa", B = "510 MPa", n = 0.26, C = 0.014, m = 1.03, '
        'melting_temperature = "1793 K", specific_heat = "477 J/kg/K", reference_rate = "1 1/s" }'
    )
    model = build_model(parse_case(edited(('solid = { law = "bilinear", tangent_modulus = "21 GPa" }', solid))))
    found = model.solids["ball"]
    assert isinstance(found, JohnsonCook)
    assert (found.A, found.B, found.n, found.C, found.m) == (792e6, 510e6, 0.26, 0.014, 1.03)
    assert (found.melting_temperature, found.specific_heat, found.room_temperature) == (1793.0, 477.0, 293.0)


def test_a_zerilli_armstrong_solid_takes_what_it_is_given_in_units():
    solid = (
        'solid = { law = "zerilli-armstrong", C0 = "65 MPa", C2 = "890 MPa", C3 = "0.0028 1/K", C4 = "0.000115 1/K", '
        'specific_heat = "383 J/kg/K", preheat = "400 K" }'
    )
    model = build_model(parse_case(edited(('solid = { law = "bilinear", tangent_modulus = "21 GPa" }', solid))))
    found = model.solids["ball"]
    assert isinstance(found, ZerilliArmstrong)
    assert (found.C0, found.C1, found.C2, found.C3, found.C4, found.C5) == (65e6, 0.0, 890e6, 0.0028, 0.000115, 0.0)
    assert (found.specific_heat, found.preheat, found.room_temperature) == (383.0, 400.0, 293.0)


JOHNSON_COOK = 'solid = { law = "johnson-cook", A = "90 MPa", B = "292 MPa", n = 0.31, C = 0.025, m = 1.09 }'
BILINEAR = 'solid = { law = "bilinear", tangent_modulus = "21 GPa" }'


@pytest.mark.parametrize("lacking", ['B = "292 MPa", ', "n = 0.31, ", "C = 0.025, ", ", m = 1.09"])
def test_johnson_cook_asks_for_all_five_constants(lacking):
    key = lacking.strip(", ")[0]
    with pytest.raises(InputErrors, match=rf"^mesh\.part\.ball\.solid\.{key}: missing; add {key}[^\n]*$"):
        parse_case(edited((BILINEAR, JOHNSON_COOK.replace(lacking, ""))))


@pytest.mark.parametrize(
    ("given", "lacking"),
    [('melting_temperature = "1356 K"', "specific_heat"), ('specific_heat = "383 J/kg/K"', "melting_temperature")],
)
def test_heat_needs_both_of_its_constants(given, lacking):
    with pytest.raises(InputError, match=f"solid.{lacking}: missing"):
        build_model(parse_case(edited((BILINEAR, JOHNSON_COOK.replace(" }", f", {given} }}")))))


OWN = (
    'solid = { law = "elastic", density = { value = "8500 kg/m^3", provenance = "measured", note = "weighed" }, '
    'modulus = "100 GPa", poissons_ratio = 0.35 }'
)


def test_a_material_of_ones_own_needs_no_row_of_the_table_and_keeps_its_provenance():
    case = parse_case(edited((BILINEAR, OWN), ('material = "65Mn"\n', "")))
    assert build_model(case).solids["ball"] == Elastic(8500.0, 100e9, 0.35)
    assert case.values()["mesh.part.ball.solid.density"].provenance == "measured"
    assert parse_case(dump_case(case)) == case


def test_a_solid_may_replace_some_constants_of_its_material():
    solid = 'solid = { law = "bilinear", modulus = "200 GPa" }'
    model = build_model(parse_case(edited((BILINEAR, solid))))
    assert model.solids["ball"] == Bilinear(7820.0, 200e9, 0.288, 430e6)


def test_a_modulus_by_its_older_name_is_read_with_a_notice():
    case = parse_case(edited((BILINEAR, OWN.replace("modulus", "youngs_modulus")), ('material = "65Mn"\n', "")))
    today = parse_case(edited((BILINEAR, OWN), ('material = "65Mn"\n', "")))
    assert dump_case(case) == dump_case(today)
    assert build_model(case).solids["ball"].youngs_modulus == 100e9
    codes = [notice.code for notice in origin_notices(case)]
    assert (codes, list(origin_notices(today))) == (["field-renamed"], [])
    (notice,) = origin_notices(case)
    assert notice.message.startswith("mesh.part.ball.solid.youngs_modulus is called modulus now")


def test_a_change_and_a_fit_may_name_the_modulus_by_its_older_name_but_a_solid_has_one():
    path = "mesh.part.ball.solid.youngs_modulus"
    changed = parse_case(edited((BILINEAR, OWN)), changes=[f"{path}=90 GPa", f"{path}.tolerance=2 %"])
    assert changed.values()["mesh.part.ball.solid.modulus"].document()["tolerance"] == "2 %"
    fit = f'[[fit]]\nfields = ["{path}"]\nunder = {{ "{path}" = "100 GPa" }}\n'
    fitted = parse_case(edited((BILINEAR, OWN)) + fit)
    assert (*fitted.fit[0].fields, *fitted.fit[0].under) == ("mesh.part.ball.solid.modulus",) * 2
    with pytest.raises(InputError, match="youngs_modulus: unknown key"):
        parse_case(edited((BILINEAR, OWN.replace("poissons", 'youngs_modulus = "1 GPa", poissons'))))


def test_a_part_alone_is_told_of_its_fault_in_one_line():
    alone = CASE[: CASE.index("[[mesh.part]]", CASE.index("[[mesh.part]]") + 1)] + '[fem]\nduration = "80 us"\n'
    with pytest.raises(InputErrors) as caught:
        parse_case(alone.replace('radius = "10 mm"', 'radius = "0 mm"'))
    assert len(caught.value.lines) == 1


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ("fem.contact.friction=0.2", "name its row: fem.contact.0.friction"),
        ("mesh.part.size=1 mm", "name its row: mesh.part.ball.size"),
        ("mesh.part.bal.size=1 mm", 'did you mean "ball"'),
        ("mesh.part.bal.at.z=1 mm", 'did you mean "ball"'),
        ("fem.contact.3.friction=0.2", "choose from: 0"),
    ],
)
def test_a_change_that_names_no_row_is_told_which_there_are(change, words):
    with pytest.raises(InputError) as caught:
        parse_case(CASE, "case", [change])
    assert words in str(caught.value)


SHAPES = [
    ('shape = "block"\nwidth = "9 mm"\ndepth = "8 mm"\nheight = "20 mm"', 9e-3 * 8e-3 * 20e-3, 1e-12),
    ('shape = "block"\nsector = "quarter"\nwidth = "9 mm"\ndepth = "8 mm"\nheight = "20 mm"', 360e-9, 1e-12),
    ('shape = "cylinder"\ndiameter = "10 mm"\nlength = "30 mm"', math.pi * 25e-6 * 30e-3, 0.02),
    (
        'shape = "tube"\ninner_diameter = "8 mm"\nouter_diameter = "12 mm"\nlength = "30 mm"\nbottom = "3 mm"',
        math.pi * (20e-6 * 30e-3 + 16e-6 * 3e-3),
        0.02,
    ),
    ('shape = "half-cylinder"\nradius = "10 mm"\nlength = "20 mm"', 0.5 * math.pi * 1e-4 * 20e-3, 0.02),
    ('shape = "half-cylinder"\nsector = "half"\nradius = "10 mm"\nlength = "20 mm"', math.pi * 5e-7, 0.02),
    ('shape = "half-cylinder"\nsector = "quarter"\nradius = "10 mm"\nlength = "20 mm"', math.pi * 2.5e-7, 0.02),
    (
        'shape = "frame"\nwidth = "60 mm"\ndepth = "20 mm"\nheight = "80 mm"\nleft = "10 mm"\nright = "11 mm"\n'
        'bottom = "12 mm"\ntop = "8 mm"',
        (60 * 80 - 39 * 60) * 20 * 1e-9,
        1e-12,
    ),
    (
        'shape = "frame"\nsector = "quarter"\nwidth = "60 mm"\ndepth = "20 mm"\nheight = "80 mm"\nleft = "10 mm"\n'
        'right = "10 mm"\nbottom = "12 mm"\ntop = "8 mm"',
        (60 * 80 - 40 * 60) * 5 * 1e-9,
        1e-12,
    ),
    ('shape = "half-space"\nradius = "20 mm"\nsector = "quarter"', math.pi / 6 * 8e-6, 0.02),
    ('shape = "ball"\nradius = "10 mm"\nsector = "half"', 2 * math.pi / 3 * 1e-6, 0.02),
    ('shape = "ball"\nradius = "10 mm"\npart_of = "lower half"', 2 * math.pi / 3 * 1e-6, 0.02),
]


@pytest.mark.parametrize("finer", ["", 'finest = "0.5 mm"\nextent = "1 mm"\n'])
@pytest.mark.parametrize(("shape", "volume", "error"), SHAPES)
def test_every_shape_has_its_volume_and_the_estimate_of_its_elements_holds(shape, volume, error, finer):
    """Flat faces stand inside round bodies: 2 % at this size. The estimate only guards memory: within a factor of 3."""
    head = "schema = 1\n[fem]\nduration = '10 us'\n[[mesh.part]]\nname = 'p'\nmaterial = '65Mn'\nsize = '1.5 mm'\n"
    table = parse_case(head + finer + shape).mesh
    (mesh,) = built_parts(table)
    made = volumes(mesh.points, mesh.hexahedra)
    assert made.sum() == pytest.approx(volume, rel=error)
    assert made.min() > 0.0
    assert exact_volume(table.part[0]) == pytest.approx(volume, rel=1e-12)
    assert 1 / 3 < estimated_elements(table) / len(mesh.hexahedra) < 3
    if finer:
        assert len(mesh.hexahedra) > len(built_parts(parse_case(head + shape).mesh)[0].hexahedra)


def test_it_is_said_how_much_flat_faces_take_from_round_parts(capsys):
    """The quarter ball of 10 mm radius: that of its mesh over pi / 3 * 1e-6 m^3; the block loses nothing."""
    case = parse_case(CASE)
    quality = quality_report(build_model(case).mesh)
    say_faceted(case, quality)
    (line,) = capsys.readouterr().err.splitlines()
    share = next(row.volume for row in quality if row.part == "ball") / (math.pi / 3.0 * 1e-6) - 1.0
    assert -0.05 < share < -0.01
    assert line.endswith(f": ball {100.0 * share:+.2f} %")


def test_a_quarter_of_a_block_has_its_planes_of_symmetry_and_is_fine_at_the_axis():
    text = edited(('size = "2 mm"', 'size = "2 mm"\nfinest = "0.5 mm"\nextent = "1 mm"\nsector = "quarter"'))
    mesh = build_model(parse_case(text)).mesh
    block = mesh.points[mesh.nodes_of("block")]
    assert block.min(axis=0) == pytest.approx([0.0, 0.0, 0.0], abs=1e-18)
    assert block.max(axis=0) == pytest.approx([5e-3, 4e-3, 4e-3], abs=1e-18)
    assert np.all(mesh.points[mesh.side("block.x-"), 0] == 0.0)
    top = mesh.points[np.unique(mesh.side("block.z+"))]
    nearest = np.sort(np.linalg.norm(top - [0.0, 0.0, 4e-3], axis=1))[:2]
    assert nearest[0] == 0.0
    assert 0.8 * 0.5e-3 < nearest[1] <= 0.5e-3  # the count of elements, here 5 or more, is rounded up


def test_a_part_is_turned_before_it_is_moved():
    text = edited(('size = "2 mm"', 'size = "2 mm"\nturn = { axis = "y", angle = "90 deg" }\nat = { x = "1 mm" }'))
    mesh = build_model(parse_case(text)).mesh
    block = mesh.points[mesh.nodes_of("block")]
    # 90 degrees about y take z to x: the height now runs along x from 0, then 1 mm further
    assert block.min(axis=0) == pytest.approx([1e-3, -4e-3, -5e-3], abs=1e-17)
    assert block.max(axis=0) == pytest.approx([5e-3, 4e-3, 5e-3], abs=1e-17)


WRONG = [
    # tables
    ([('shape = "ball"', 'shape = "bal"')], "mesh.part.ball.shape", 'did you mean "ball"'),
    ([('shape = "ball"\n', "")], "mesh.part.ball.shape", "needed: one of 'block'"),
    ([('radius = "10 mm"\n', "")], "mesh.part.ball.radius", "add radius"),
    ([('size = "2 mm"', 'size = "2 mm"\nfinst = "1 mm"')], "mesh.part.block.finst", 'did you mean "finest"'),
    ([('radius = "10 mm"', 'radius = "0 mm"')], "mesh.part.ball.radius", "above 0"),
    ([('size = "2.5 mm"', 'size = "0 mm"')], "mesh.part.ball.size", "above 0"),
    ([('size = "2.5 mm"', "size = 2.5")], "mesh.part.ball.size", "bare number"),
    ([('sector = "quarter"', 'sector = "third"')], "mesh.part.ball.sector", "'whole', 'half' or 'quarter'"),
    ([('z = "-1 m/s"', 'z = "-1 mm"')], "mesh.part.ball.velocity.z", "is not a speed"),
    ([('velocity = { z = "-1 m/s" }', 'velocity = "-1 m/s"')], "mesh.part.ball.velocity", 'such as { z = "-1 m/s" }'),
    ([("at = { z = {", 'at = "z" #')], "mesh.part.ball.at", 'such as { z = "15 mm" }'),
    ([('gravity = { z = "-1 g" }', 'gravity = "-z"')], "fem.gravity", 'such as { z = "-9.81 m/s^2" }'),
    ([('law = "bilinear"', 'law = "plastic"')], "mesh.part.ball.solid.law", 'did you mean "bilinear"'),
    ([('shape = "ball"', 'shape = "sphere"')], "mesh.part.ball.shape", 'did you mean "ball"'),
    ([('size = "2 mm"', 'size = "11 mm"')], "mesh.part.block.size", "largest length, 10 mm"),
    ([('size = "2.5 mm"', 'size = "1 m"')], "mesh.part.ball.size", "largest length, 20 mm"),
    ([('material = "65Mn"\n', "")], "mesh.part.ball.solid.density", "the part names no material"),
    ([('material = "2A12"\n', "")], "mesh.part.block.material", "or one of your own"),
    (
        [('law = "bilinear"', 'law = "bilinear", poissons_ratio = 0.5')],
        "mesh.part.ball.solid.poissons_ratio",
        "below 0.5",
    ),
    (
        [('law = "bilinear"', 'law = "bilinear", density = "0 kg/m^3"')],
        "mesh.part.ball.solid.density",
        "at least 0.1 kg/m^3",
    ),
    ([('law = "bilinear"', 'law = "bilinar"')], "mesh.part.ball.solid.law", 'did you mean "bilinear"'),
    ([('elements = "full"', 'elements = "two"')], "mesh.part.block.elements", "'one-point' or 'full'"),
    ([('elements = "full"', 'rigid = "w"')], "mesh.part.block.rigid", "'free'"),
    ([('name = "ball"', 'name = "a.b"')], "mesh.part.0.name", "letter or digit"),
    ([('duration = "80 us"', "")], "fem.duration", "add duration"),
    ([('kind = "symmetry"', 'kind = "symetry"')], "fem.boundary.0.kind", 'did you mean "symmetry"'),
    ([('kind = "symmetry"\n', "")], "fem.boundary.0.kind", "needed: one of 'fixed'"),
    ([('time = ["0 us"', 'time = ["0 mm"')], "fem.boundary.1.time.0", "is not a time"),
    ([('pressure = ["0 MPa", "10 MPa"]', 'pressure = "10 MPa"')], "fem.boundary.1.pressure", "a list of quantities"),
    ([("[[fem.contact]]", "[fem.contact]")], "fem.contact", "write [[fem.contact]]"),
    ([("friction = 0.1", "friction = -0.1")], "fem.contact.0.friction", "at least 0"),
    ([("friction = 0.1", "fricton = 0.1")], "fem.contact.0.fricton", 'did you mean "friction"'),
    ([("[fem]", "[solver]\nerror = 1e-4\n[fem]")], "solver", "controls of [fem]"),
    # the whole
    ([('name = "block"', 'name = "ball"')], "mesh.part", "each name once"),
    ([('material = "65Mn"', 'material = "65Nm"')], "mesh.part.ball.material", 'did you mean "65Mn"'),
    ([('"21 GPa"', '"300 GPa"')], "mesh.part.ball.solid.tangent_modulus", "below Young's modulus"),
    ([('second = "block"', 'second = "blck"')], "fem.contact.0.second", 'did you mean "block"'),
    ([('second = "block"', 'second = "block.tp"')], "fem.contact.0.second", "block."),
    ([('second = "block"', 'second = "ball.round"')], "fem.contact.0.second", "shares no nodes"),
    ([('second = "block"', 'second = "ball"')], "fem.contact.0.second", "shares no nodes"),
    ([('first = "ball.round"', 'first = "ball.rond"')], "fem.contact.0.first", 'did you mean "ball.round"'),
    ([('side = "block.x+"', 'side = "block.right"')], "fem.boundary.1.side", "a side of block: x-, x+"),
    ([('"0 us", { value = "10 us"', '"10 us", { value = "10 us"')], "fem.boundary.1.time.1", "later than"),
    ([('pressure = ["0 MPa", "10 MPa"]', 'pressure = ["0 MPa"]')], "fem.boundary.1.time", "one for each of the 1"),
    ([('duration = "80 us"', 'duration = "80 us"\ninterval = "60 us"')], "fem.interval", "third of the duration"),
    ([('duration = "80 us"', 'duration = "1 s"\ninterval = "1 us"')], "fem.interval", "200000th"),
    ([('duration = "80 us"', 'duration = "80 us"\nhourglass = 0.6')], "fem.hourglass", "from 0 to 0.5"),
    ([('size = "2 mm"', 'size = "20 um"')], "mesh", "elements"),  # 40 million: refused before any is made
    ([('size = "2 mm"', 'size = "1 nm"')], "mesh.part.block.size", "at most 20000 elements"),
    ([('size = "2 mm"', 'size = "2 mm"\nfinest = "3 mm"')], "mesh.part.block.finest", "at most the coarse size"),
    (
        [('size = "2 mm"', 'size = "2 mm"\nturn = { axis = { x = 0 }, angle = "1 deg" }')],
        "mesh.part.block.turn",
        "not 0",
    ),
]


@pytest.mark.parametrize(("changes", "field", "words"), WRONG)
def test_wrong_input_is_refused_in_one_line(changes, field, words):
    with pytest.raises(InputError) as caught:
        build_model(parse_case(edited(*changes)))
    text = str(caught.value)
    assert text.startswith(field)
    assert words in text
    assert len(text.splitlines()) == 1


@pytest.mark.parametrize(
    ("text", "field", "words"),
    [
        ('[[fem.section]]\nname = "s"\npart = "blok"\npoint = {}\nnormal = "z"\n', "fem.section.s.part", '"block"'),
        ('[[fem.point]]\nname = "p"\npart = "bal"\nplace = {}\n', "fem.point.p.part", 'did you mean "ball"'),
        ('[[fem.point]]\nname = "p"\npart = "ball"\nplace = {}\n' * 2, "fem.point", "each name once"),
        ('[[fem.tie]]\nside = "ball.round"\nonto = "ball.x-"\n', "fem.contact.0.onto", "shares no nodes"),
        ('[[fem.wall]]\nside = "block.z-"\nnormal = {}\n', "fem.wall.0.normal", "a vector that is not 0"),
        ('[[fem.wall]]\nside = "block.z-"\nnormal = "up"\n', "fem.wall.0.normal", '"z"'),
        ('[[fem.boundary]]\nkind = "guided"\nside = "ball"\naxis = {}\n', "fem.boundary.2.axis", "not 0"),
    ],
)
def test_wrong_tables_behind_are_refused_in_one_line(text, field, words):
    with pytest.raises(InputError) as caught:
        build_model(parse_case(with_fem(text)))
    assert str(caught.value).startswith(field)
    assert words in str(caught.value)


def test_a_yield_strength_that_the_table_lacks_is_asked_for():
    with pytest.raises(InputError, match=r"mesh\.part\.ball\.solid\.yield_strength: missing"):
        build_model(parse_case(edited(('material = "65Mn"', 'material = "rubber"'), ("21 GPa", "1 kPa"))))


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (CASE.replace("[fem]", "[fm]").partition("[fm]")[0], "fem: missing"),
        ("schema = 1\n[fem]\nduration = '1 us'\n", "mesh: missing"),
        ("schema = 1\n[mesh]\n[fem]\nduration = '1 us'\n", "mesh.part: missing"),
        ("schema = 1\n[mesh]\npart = []\n[fem]\nduration = '1 us'\n", "mesh.part"),
        ("schema = 1\n", "[mesh] with [fem]"),
    ],
)
def test_half_a_case_is_told_what_it_lacks(text, words):
    with pytest.raises(InputError) as caught:
        parse_case(text)
    assert words in str(caught.value)


def test_too_many_elements_are_refused_before_memory_is_taken():
    import tracemalloc

    case = parse_case(edited(('size = "2 mm"', 'size = "20 um"')))
    tracemalloc.start()
    with pytest.raises(InputError, match="elements"):
        check_case(case)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert estimated_elements(case.mesh) > LARGEST
    assert peak < 5e6  # a mesh of 40 million elements would take gigabytes


def test_a_machine_may_hold_a_mesh_beside_it():
    case = parse_case(dump_case(load_case("li-ma-2019")) + "\n" + CASE.partition('title = "A ball on a block"')[2])
    assert case.command == "run"
    assert np.isclose(build_model(case).controls.duration, 80e-6)


def test_a_mesh_alone_is_sent_to_its_command():
    with pytest.raises(InputError, match="this case is a mesh alone: `strikewave fem` runs it"):
        parse_case(CASE).impact()
    with pytest.raises(InputError, match="`strikewave run` runs it"):
        build_model(load_case("li-ma-2019"))


TWO_CUBES = """*NODE
1, 0, 0, 0
2, 10, 0, 0
3, 10, 10, 0
4, 0, 10, 0
5, 0, 0, 10
6, 10, 0, 10
7, 10, 10, 10
8, 0, 10, 10
9, 0, 0, 20
10, 10, 0, 20
11, 10, 10, 20
12, 0, 10, 20
*ELEMENT, TYPE=C3D8R, ELSET=LOWER
1, 1, 2, 3, 4, 5, 6, 7, 8
*ELEMENT, TYPE=C3D8R, ELSET=UPPER
2, 5, 6, 7, 8, 9, 10, 11, 12
*ELSET, ELSET=FOOT_E
1
*SURFACE, TYPE=ELEMENT, NAME=FOOT
FOOT_E, S1
*SOLID SECTION, ELSET=LOWER, MATERIAL=A
*SOLID SECTION, ELSET=UPPER, MATERIAL=A
"""
FILED = """
schema = 1
[[mesh.part]]
name = "anvil"
shape = "file"
file = "two.inp"
part = "LOWER"
unit = "1 mm"
material = "65Mn"
[[mesh.part]]
name = "UPPER"
shape = "file"
file = "two.inp"
unit = "1 mm"
material = "2A12"
[fem]
duration = "1 us"
interval = "0.1 us"
[[fem.boundary]]
kind = "fixed"
side = "anvil.FOOT"
"""


@pytest.fixture
def filed(tmp_path):
    """Build a case beside the file of two cubes that share a face."""
    (tmp_path / "two.inp").write_text(TWO_CUBES)

    def build(old="", new=""):
        assert old in FILED
        (tmp_path / "filed.toml").write_text(FILED.replace(old, new, 1) if old else FILED)
        return build_model(load_case(str(tmp_path / "filed.toml")))

    return build


def test_a_mesh_in_a_file_beside_the_case_keeps_its_shared_nodes(filed):
    model = filed()
    assert sorted(model.mesh.names) == ["UPPER", "anvil"]
    assert len(model.mesh.points) == 12  # a face of four nodes is shared: bonded, as in the file
    assert volumes(model.mesh.points, model.mesh.hexahedra) == pytest.approx([1e-6, 1e-6], rel=1e-12)
    assert np.all(model.mesh.points[model.mesh.side("anvil.FOOT"), 2] == 0.0)
    assert {name: solid.density for name, solid in model.solids.items()} == {"anvil": 7820, "UPPER": 2780}


@pytest.mark.parametrize(
    ("old", "new", "field", "words"),
    [
        ('part = "LOWER"', 'part = "LOWR"', "mesh.part.anvil.part", 'did you mean "LOWER"'),
        ('part = "LOWER"', 'part = "UPPER"', "mesh.part.UPPER.part", "in one row: LOWER, UPPER"),
        ('unit = "1 mm"', 'unit = "1 m"', "mesh.part.UPPER.unit", "one unit"),
        ('file = "two.inp"', 'file = "tow.inp"', "mesh.part.anvil.file", "no such file: "),
        (
            '[[mesh.part]]\nname = "UPPER"',
            '[[mesh.part]]\nsize = "1 mm"\nname = "UPPER"',
            "mesh.part.UPPER.size",
            "unknown",
        ),
    ],
)
def test_a_mesh_in_a_file_that_is_not_as_said_is_refused(filed, old, new, field, words):
    with pytest.raises(InputError) as caught:
        filed(old, new)
    assert str(caught.value).startswith(field)
    assert words in str(caught.value)


@pytest.mark.parametrize("unit", ['"mm"', '"1 mm"', '{ value = "1 mm", provenance = "measured" }'])
def test_the_only_part_of_a_file_needs_no_name_and_a_unit_alone_is_one_of_it(tmp_path, unit):
    one = TWO_CUBES[: TWO_CUBES.index("*ELEMENT, TYPE=C3D8R, ELSET=UPPER")]
    (tmp_path / "one.inp").write_text(one + TWO_CUBES[TWO_CUBES.index("*ELSET, ELSET=FOOT_E") :].partition("*SOLID")[0])
    row = '[[mesh.part]]\nname = "rod"\nshape = "file"\nfile = "one.inp"\nmaterial = "65Mn"\n'
    (tmp_path / "one.toml").write_text(
        f"schema = 1\n{row}unit = {unit}\n[fem]\nduration = '1 us'\ninterval = '0.1 us'\n"
    )
    mesh = build_model(load_case(str(tmp_path / "one.toml"))).mesh
    assert mesh.names == ("rod",)
    assert volumes(mesh.points, mesh.hexahedra) == pytest.approx([1e-6], rel=1e-12)
    assert "rod.FOOT" in mesh.sides


def test_a_part_of_a_file_without_a_row_is_named(filed):
    row = FILED[FILED.index('[[mesh.part]]\nname = "UPPER"') : FILED.index("[fem]")]
    with pytest.raises(InputError, match="no row for UPPER"):
        filed(row, "")


@pytest.mark.parametrize(
    ("change", "code", "words"),
    [
        ("mesh.part.ball.velocity.z=-7 km/s", "faster-than-wave", "mesh.part.ball.velocity"),
        ("mesh.part.ball.solid.density=7.82 kg/m^3", "material-far", "mesh.part.ball.solid.density = 7.82 kg/m^3"),
    ],
)
def test_a_speed_above_the_wave_speed_and_a_modulus_of_no_material_are_named_before_the_run(
    tmp_path, change, code, words
):
    """By what `--check` says: no step is run."""
    (tmp_path / "case.toml").write_text(CASE)
    plain, changed = (load_case(str(tmp_path / "case.toml"), changes) for changes in ([], [change]))
    assert not {notice.code for notice in model_notices(plain, build_model(plain))} & {
        "faster-than-wave",
        "material-far",
    }
    (notice,) = [one for one in model_notices(changed, build_model(changed)) if one.code == code]
    assert words in notice.message


@pytest.mark.parametrize("height", [5.5, 4.0, 0.0, -1.0])
def test_parts_that_stand_in_each_other_are_refused_however_deep(height):
    """A ball of 10 mm radius whose lowest point is below the block's top at 4 mm by more than an element of 1 mm."""
    text = edited(('value = "14.01 mm"', f'value = "{10.0 + height - 3.0} mm"'), ('size = "2 mm"', 'size = "1 mm"'))
    with pytest.raises(InputError, match="stand beside each other"):
        build_model(parse_case(text))


def test_parts_that_touch_and_parts_that_only_share_a_box_may_stand_so():
    """The ball's box reaches over a block at its corner, the ball does not; and lowest point on top is no overlap."""
    for place in ('value = "14 mm"', 'value = "13.95 mm"'):
        build_model(parse_case(edited(('value = "14.01 mm"', place))))
    beside = edited(
        ('value = "14.01 mm"', 'value = "-3 mm"'), ('size = "2 mm"', 'size = "1 mm"\nat = { x = "14 mm", y = "12 mm" }')
    )
    build_model(parse_case(beside))
