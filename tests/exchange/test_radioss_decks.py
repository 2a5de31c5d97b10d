"""OpenRadioss decks, read back by their columns in the format of 2023, are the models that they were written from."""

import dataclasses

import numpy as np
import pytest

from strikewave import load_case
from strikewave.analyses.fem.build import build_model
from strikewave.exchange.deck import Heading
from strikewave.exchange.radioss import radioss_deck
from strikewave.exchange.units import SYSTEMS
from strikewave.fem.bodies import RigidBody
from strikewave.fem.hexahedron import element_masses, first_steps
from strikewave.fem.mesh import Mesh
from strikewave.fem.model import Model
from strikewave.fem.solids import Bilinear, Elastic, JohnsonCook

from .decks import TILT, Radioss, everything, fields, outward, reals, tens, unit_of

BUNDLED = ("hertz-ball-fem", "two-bars-fem", "taylor-bar-fem")


def texts_of(model, system, **more):
    deck = radioss_deck(model, SYSTEMS[system], Heading("a title", "case", "1.0", **more))
    return ["".join(pieces) for pieces in deck.files.values()]


@pytest.fixture(scope="module")
def model():
    return everything()


@pytest.fixture(scope="module", params=SYSTEMS)
def read(request, model):
    return Radioss(texts_of(model, request.param)[0], request.param)


def solid_of(deck, number):
    """The solid of a material number, in SI; b of LAW2 is E E_t / (E - E_t)."""
    (found,) = [b for b in deck.all("MAT") if int(b.words[2]) == number]
    stress = unit_of(deck.system, -1, 1, -2)
    (density,), (E, nu) = reals(found.lines[0]), reals(found.lines[1][:40])
    base = (density * unit_of(deck.system, -3, 1), E * stress, nu)
    if found.words[1] == "ELAST":
        return Elastic(*base)
    a, b, n, *_ = reals(found.lines[2])
    c, rate, _, _, _, kinematic = fields(found.lines[3], 20, 20, 10, 10, 20, 20)
    m, melting, capacity, room = reals(found.lines[4])
    if not capacity:
        hardening = b * stress
        return Bilinear(*base, a * stress, base[1] * hardening / (base[1] + hardening), kinematic)
    heat = 0.9 * capacity * unit_of(deck.system, -1, 1, -2) / base[0]
    rate *= unit_of(deck.system, 0, 0, -1)
    warmth = {"reference_rate": rate, "room_temperature": room, "specific_heat": heat, "heat_fraction": 0.9}
    return JohnsonCook(*base, a * stress, b * stress, n, c, m, melting, **warmth)


def assert_same(first, second, rel):
    for one, other in zip(dataclasses.astuple(first), dataclasses.astuple(second), strict=True):
        assert one == pytest.approx(other, rel=rel, abs=0.0)


@pytest.mark.verify
@pytest.mark.parametrize("system", SYSTEMS)
@pytest.mark.parametrize("name", BUNDLED)
def test_masses_and_critical_steps_of_bundled_cases_come_back(name, system):
    ours = build_model(load_case(name))
    deck = Radioss(texts_of(ours, system)[0], system)
    assert np.array_equal(deck.hexahedra, ours.mesh.hexahedra)
    assert np.array_equal(deck.part, ours.mesh.part)
    solids = {part: solid_of(deck, k) for k, part in enumerate(deck.names, start=1)}
    mesh = Mesh(deck.points, deck.hexahedra.astype(np.int32), deck.part.astype(np.int32), tuple(deck.names))
    theirs = Model(mesh, solids, ours.controls)
    for part in ours.mesh.names:
        chosen = ours.mesh.elements_of(part)
        mass = [element_masses(m.mesh, m.solids)[chosen] for m in (ours, theirs)]
        # coordinates have 14 digits, of a body up to 1000 times as large as its smallest element
        np.testing.assert_allclose(mass[1], mass[0], rtol=1e-10)
        steps = [first_steps(m, part, one) for m, one in zip((ours, theirs), mass, strict=True)]
        np.testing.assert_allclose(steps[1], steps[0], rtol=1e-10)
        assert_same(solids[part], ours.solids[part], 1e-12)


def test_every_solid_comes_back(read, model):
    for number, part in enumerate(("copper", "plate", "striker", "tilted"), start=1):
        # E_t through b and back loses what E / E_t, 64, magnifies
        assert_same(solid_of(read, number), model.solids[part], 1e-11)


def test_rate_of_hardening_is_that_of_the_plastic_strain(read):
    for number in (1, 2):  # copper and plate, the solids that yield
        (found,) = [b for b in read.all("MAT", "PLAS_JOHNS") if int(b.words[2]) == number]
        *_, iflag, plastic_rate = fields(found.lines[1], 20, 20, 10, 10)
        assert (iflag, plastic_rate) == (0, 1)


def test_units_are_said_twice_and_make_the_system(read):
    name, version, *units = read.one("BEGIN").lines
    words = {"kg": 1.0, "Mg": 1e3, "g": 1e-3, "m": 1.0, "mm": 1e-3, "s": 1.0, "ms": 1e-3, "mus": 1e-6}
    assert name == "case"
    assert tens(version) == [2023, 0]
    assert units[0] == units[1]
    mass, length, time = (words[word] for word in units[0].split())
    assert (mass, length, time) == tuple(unit_of(read.system, *power) for power in ((0, 1), (1,), (0, 0, 1)))


def test_elements_are_stabilized_or_selectively_reduced(read):
    kinds = [tens(read.one("PROP", "SOLID", k).lines[0][:80]) for k in range(1, 6)]
    assert [kind[0] for kind in kinds] == [24, 17, 24, 24, 24]
    assert [kind[3] for kind in kinds] == [0, 1, 0, 0, 0]
    assert reals(read.one("PROP", "SOLID", 1).lines[1])[:2] == [1.4, 0.05]


def test_parts_have_their_own_property_and_material(read):
    for k in range(1, 6):
        assert tens(read.one("PART", k).lines[0]) == [k, k, 0]


def test_each_node_is_held_once_and_as_its_sides_say(read, model):
    wanted = {}
    for side, axes in (("copper.x-", [0]), ("copper.y-", [1]), ("tilted.x-", [0, 1, 2])):
        for node in np.unique(model.mesh.side(side)):
            wanted.setdefault(int(node), set()).update(axes)
    tied = set(np.unique(model.mesh.side("plate.z-")).tolist())
    inclined = set(np.unique(model.mesh.side("tilted.z-")).tolist()) - wanted.keys()
    found, local = {}, set()
    for bcs in read.all("BCS"):
        ways, skew, group = bcs.lines[0][:10], *tens(bcs.lines[0][10:])
        if bcs.title == "anvil":
            continue
        assert ways[6] == " "
        assert ways[7:] == "000"
        nodes = set(read.nodes_of(group).tolist())
        assert not nodes & (found.keys() | local)
        held = {k for k in range(3) if ways[3 + k] == "1"}
        if skew:
            _, second, third = map(np.array, map(reals, read.one("SKEW", "FIX", skew).lines))
            kept = np.stack([np.cross(second, third), second, third])[sorted(held)]
            normal = np.array([0.0, -np.sin(TILT), np.cos(TILT)])
            np.testing.assert_allclose(kept.T @ kept, np.outer(normal, normal), atol=1e-12)
            local |= nodes
        else:
            found |= dict.fromkeys(nodes, held)
    assert found == {node: ways for node, ways in wanted.items() if node not in tied}
    assert local == inclined


def test_contacts_have_all_faces_of_their_sides_outward_and_their_friction(read, model):
    for number, ours in enumerate(model.contacts, start=1):
        found = read.one("INTER", "TYPE24", number)
        assert found.title == ours.name
        for surface, side in zip(tens(found.lines[0][:20]), (ours.first, ours.second), strict=True):
            faces = read.faces_of(surface)
            assert np.array_equal(faces, model.mesh.side(side))
            assert outward(read.points, faces, read.hexahedra).all()
        assert float(found.lines[3][20:40]) == ours.friction
        assert found.lines[4][7:10] == "000"
        assert int(found.lines[4][30:40]) == 5
        assert len(found.lines) == 6
        assert max(map(len, found.lines)) <= 100


def test_tie_reaches_all_of_its_nodes(read, model):
    found = read.one("INTER", "TYPE2", 3)
    group, surface = tens(found.lines[0][:20])
    assert np.array_equal(read.nodes_of(group), np.unique(model.mesh.side("plate.z-")))
    assert np.array_equal(read.faces_of(surface), model.mesh.side("copper.z+"))
    reach = float(found.lines[0][80:100]) * unit_of(read.system, 1)
    assert reach == pytest.approx(1.01 * 0.1 * 2e-3, rel=1e-9)  # a tenth of the 2 mm of a face, and 1 %


def test_wall_stands_where_it_did_and_its_normal_points_to_the_side(read, model):
    found = read.one("RWALL", "PLANE", 1)
    still, slide, group, _ = tens(found.lines[0])
    assert (still, slide) == (0, 2)
    assert reals(found.lines[1][:80])[1] == 0.2
    tail, head = np.array(reals(found.lines[2])), np.array(reals(found.lines[3]))
    np.testing.assert_allclose(tail * unit_of(read.system, 1), [0.0, 3e-3, 0.0], atol=1e-15)
    np.testing.assert_allclose(head - tail, [0.0, -1.0, 0.0], atol=1e-12)
    assert np.array_equal(read.nodes_of(group), np.unique(model.mesh.side("tilted.y+")))


def test_driven_sides_have_their_direction_and_curve(read):
    for number, direction in ((1, [0.0, np.cos(TILT), np.sin(TILT)]), (2, [-1.0, 0.0, 0.0]), (3, [-1.0, 0.0, 0.0])):
        found = read.one("IMPVEL", number)
        function, way, skew, *_ = fields(found.lines[0], *[10] * 7)
        axes = np.eye(3)
        if skew:
            _, second, third = map(np.array, map(reals, read.one("SKEW", "FIX", skew).lines))
            axes = np.stack([np.cross(second, third), second, third])
        scale = reals(found.lines[1])[1]
        np.testing.assert_allclose(scale * axes["XYZ".index(way)], direction, atol=1e-12)
        time, speed = read.curve(function)
        at_end = np.interp(20e-6, time * unit_of(read.system, 0, 0, 1), speed * unit_of(read.system, 1, 0, -1))
        assert at_end == pytest.approx(2.0, rel=1e-12)
        assert speed[-1] == speed[-2]  # OpenRadioss goes on along the last piece


def test_pressure_pushes_inward_as_openradioss_pulls_along_the_normal(read, model):
    """engine/source/loads/general/force.F: the force is pressure times (x3 - x1) x (x4 - x2) / 8 on each node."""
    found = read.one("PLOAD", 1)
    surface, function, *_ = tens(found.lines[0][:60])
    scale = float(found.lines[0][80:100])
    a, b, c, d = np.moveaxis(read.points[read.faces_of(surface)], 1, 0)
    pressure = scale * read.curve(function)[1][-1] * unit_of(read.system, -1, 1, -2)
    force = (0.5 * pressure * np.cross(c - a, d - b)).sum(axis=0)
    np.testing.assert_allclose(force, [0.0, 0.0, -4e6 * 16e-6], atol=1e-9)


def test_gravity_pulls_all_nodes_down(read, model):
    found = read.one("GRAV", 3)
    function, way, _, _, group = fields(found.lines[0][:50], *[10] * 5)
    assert way == "Z"
    assert float(found.lines[0][80:100]) * unit_of(read.system, 1, 0, -2) == pytest.approx(-9.81)
    assert np.all(read.curve(function)[1] == 1.0)
    assert len(read.nodes_of(group)) == len(model.mesh.points) + 1


def test_velocities_go_to_the_parts_that_fly(read, model):
    speed = unit_of(read.system, 1, 0, -1)
    found = {b.title: b.lines[0] for b in read.all("INIVEL", "TRA")}
    assert found.keys() == {"striker", "anvil"}
    np.testing.assert_allclose(np.array(reals(found["striker"][:60])) * speed, [0.0, 0.0, -3.0])
    np.testing.assert_allclose(np.array(reals(found["anvil"][:60])) * speed, [1.0, 0.0, 2.0])
    assert np.array_equal(read.nodes_of(tens(found["striker"][60:])[0]), model.mesh.nodes_of("striker"))


def test_rigid_part_has_a_main_node_in_its_middle_that_holds_its_freedoms(read, model):
    found = read.one("RBODY", 1)
    main, group = int(found.lines[0][:10]), int(found.lines[0][60:70])
    assert main == len(model.mesh.points) + 1
    nodes = read.nodes_of(group)
    assert np.array_equal(nodes, model.mesh.nodes_of("anvil"))
    mass = np.bincount(model.mesh.hexahedra.ravel(), np.repeat(element_masses(model.mesh, model.solids) / 8.0, 8))
    body = RigidBody(model.mesh, model.rigid[0], mass, np.zeros(3))
    np.testing.assert_allclose(read.points[main - 1], body.centre, atol=1e-14)
    (held,) = [b.lines[0] for b in read.all("BCS") if b.title == "anvil"]
    assert held[3:10] == "010 101"
    assert np.array_equal(read.nodes_of(tens(held[10:])[1]), [main - 1])


def test_histories_are_of_all_parts_contacts_walls_points_and_sections(read, model):
    assert tens(read.one("TH", "PART", 1).lines[1]) == [1, 2, 3, 4, 5]
    assert tens(read.one("TH", "INTER", 1).lines[1]) == [1, 2, 3]
    assert tens(read.one("TH", "RWALL", 1).lines[1]) == [1]
    (point,) = read.one("TH", "NODE", 1).lines[1:]
    np.testing.assert_allclose(model.mesh.points[int(point[:10]) - 1], [0.0, 0.0, 4.1e-3], atol=1e-12)
    assert point.split()[-1] == "tip"
    cut = read.hexahedra[[int(line[:10]) - 1 for line in read.one("TH", "BRIC", 1).lines[1:]]]
    heights = read.points[cut][:, :, 2]
    assert np.all((heights.min(axis=1) <= 4.6e-3) & (heights.max(axis=1) >= 4.6e-3))


@pytest.mark.parametrize("system", SYSTEMS)
def test_engine_runs_as_long_and_as_cautiously_as_ours(model, system):
    lines = texts_of(model, system, frames=10)[1].splitlines()
    time = unit_of(system, 0, 0, 1)

    def after(word):
        return lines[lines.index(word) + 1]

    assert float(after("/RUN/case/1")) * time == pytest.approx(20e-6)
    safety, least = after("/DT/NODA/CST/0").split()
    assert float(safety) == 0.8
    assert float(least) * time == pytest.approx(1e-8)
    assert float(after("/TFILE/4")) * time == pytest.approx(0.5e-6)
    start, every = map(float, after("/ANIM/DT").split())
    assert start == 0.0
    assert every * time == pytest.approx(2e-6)


def test_nothing_is_left_out_in_silence(model):
    deck = radioss_deck(model, SYSTEMS["SI"], Heading("a title"))
    text = " ".join("".join(deck.files["_0000.rad"]).replace("\n# ", " ").split())
    assert {line.split()[0] for line in deck.left_out} == {"group", "section", "non-reflecting", "hourglass"}
    for line in (*deck.left_out, *deck.differs):
        assert " ".join(line.split()) in text


def test_further_blows_are_said_to_be_left_out(model):
    again = dataclasses.replace(model, controls=dataclasses.replace(model.controls, blows=3))
    assert radioss_deck(again, SYSTEMS["SI"], Heading("a title")).left_out[0].startswith("blows 2 to 3")
