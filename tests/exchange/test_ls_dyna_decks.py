"""LS-DYNA decks, read back by ansys-dyna-core, are the models that they were written from."""

import dataclasses

import numpy as np
import pytest

from strikewave import load_case
from strikewave.analyses.fem.build import build_model
from strikewave.exchange.deck import Heading
from strikewave.exchange.ls_dyna.deck import ls_dyna_deck
from strikewave.exchange.units import SYSTEMS
from strikewave.fem.boundary import area_vectors
from strikewave.fem.hexahedron import element_masses, first_steps
from strikewave.fem.mesh import Mesh, volumes
from strikewave.fem.model import Model, RigidWall
from strikewave.fem.solids import Bilinear, Elastic, JohnsonCook

from .decks import TILT, LsDyna, everything, outward, unit_of


@pytest.fixture(scope="module", autouse=True)
def reader():
    """Skip what cannot be read back; imported for tests that run, as it takes two seconds."""
    pytest.importorskip("ansys.dyna.core")


BUNDLED = ("hertz-ball-fem", "two-bars-fem", "taylor-bar-fem")


def text_of(model, system, **more):
    return "".join(ls_dyna_deck(model, SYSTEMS[system], Heading("a title", "case", "1.0", **more)).files[".k"])


@pytest.fixture(scope="module")
def model():
    return everything()


@pytest.fixture(scope="module", params=SYSTEMS)
def read(request, model):
    return LsDyna(text_of(model, request.param), request.param)


def solid_of(deck, number):
    """The solid of a material number, in SI."""
    per = {"density": unit_of(deck.system, -3, 1), "stress": unit_of(deck.system, -1, 1, -2)}
    kinds = ("MatElastic", "MatPlasticKinematic", "MatJohnsonCook", "MatRigid")
    (found,) = [k for kind in kinds for k in deck.all(kind) if k.mid == number]
    base = (found.ro * per["density"], found.e * per["stress"], found.pr)
    if type(found).__name__ == "MatPlasticKinematic":
        return Bilinear(*base, found.sigy * per["stress"], found.etan * per["stress"], 1.0 - found.beta)
    if type(found).__name__ == "MatJohnsonCook":
        heat, rate = found.cp * unit_of(deck.system, 2, 0, -2) * 0.9, found.epso * unit_of(deck.system, 0, 0, -1)
        warmth = {"reference_rate": rate, "room_temperature": found.tr, "specific_heat": heat, "heat_fraction": 0.9}
        constants = (found.a * per["stress"], found.b * per["stress"], found.n, found.c, found.m, found.tm)
        return JohnsonCook(*base, *constants, **warmth)
    return Elastic(*base)


def model_of(deck, controls):
    """The model of a deck as far as masses and steps go."""
    solids = {name: solid_of(deck, k) for k, name in enumerate(deck.names, start=1)}
    mesh = Mesh(deck.points, deck.hexahedra.astype(np.int32), deck.part.astype(np.int32), tuple(deck.names))
    return Model(mesh, solids, controls)


def assert_same(first, second, rel):
    for one, other in zip(dataclasses.astuple(first), dataclasses.astuple(second), strict=True):
        assert one == pytest.approx(other, rel=rel, abs=0.0)


@pytest.mark.verify
@pytest.mark.parametrize("system", SYSTEMS)
@pytest.mark.parametrize("name", BUNDLED)
def test_masses_and_critical_steps_of_bundled_cases_come_back(name, system):
    ours = build_model(load_case(name))
    deck = LsDyna(text_of(ours, system), system)
    theirs = model_of(deck, ours.controls)
    assert not deck.deck.string_keywords
    assert np.array_equal(deck.hexahedra, ours.mesh.hexahedra)
    assert deck.names == list(ours.mesh.names)
    for part in ours.mesh.names:
        chosen = ours.mesh.elements_of(part)
        mass = [element_masses(m.mesh, m.solids)[chosen] for m in (ours, theirs)]
        # coordinates have ten digits, of a body up to 1000 times as large as its smallest element
        assert mass[1].sum() == pytest.approx(mass[0].sum(), rel=1e-8)
        steps = [first_steps(m, part, one) for m, one in zip((ours, theirs), mass, strict=True)]
        np.testing.assert_allclose(steps[1], steps[0], rtol=1e-6)
        assert_same(theirs.solids[part], ours.solids[part], 1e-7)


def test_every_keyword_is_known(read):
    assert not read.deck.string_keywords


def test_every_solid_comes_back(read, model):
    theirs = model_of(read, model.controls)
    for part in ("copper", "plate", "striker", "tilted"):
        assert_same(theirs.solids[part], model.solids[part], 1e-7)


def test_mass_of_an_odd_density_is_kept_to_1e_8(read, model):
    theirs = model_of(read, model.controls)
    part = model.mesh.elements_of("striker")
    mass = [element_masses(m.mesh, m.solids)[part].sum() for m in (model, theirs)]
    assert mass[1] == pytest.approx(mass[0], rel=1e-8)


def test_johnson_cook_has_the_bulk_modulus_no_cutoff_and_no_failure(read, model):
    solid, state = read.one("MatJohnsonCook"), read.one("EosLinearPolynomial")
    stress = unit_of(read.system, -1, 1, -2)
    assert state.c1 * stress == pytest.approx(model.solids["copper"].bulk_modulus, rel=1e-6)
    assert solid.g * stress == pytest.approx(model.solids["copper"].shear_modulus, rel=1e-6)
    assert (state.c0, state.c2, state.c3, state.c4, state.c5, state.c6, state.v0) == (0, 0, 0, 0, 0, 0, 1)
    assert solid.pc * stress < -1e12
    assert solid.d1 > 1e3
    assert solid.vp == 1.0
    assert [row.eosid for row in map(read.row, read.all("Part"))] == [1, 0, 0, 0, 0]


def test_full_integration_is_elform_2_and_one_point_elform_1(read):
    forms = {section.secid: section.elform for section in read.all("SectionSolid")}
    assert [forms[read.row(part).secid] for part in read.all("Part")] == [1, 2, 1, 1, 1]


def test_hourglass_is_the_stiffness_form_with_our_coefficients(read):
    found = read.one("Hourglass")
    assert (found.hgid, found.ihq, found.qm, found.q1, found.q2) == (1, 5, 0.07, 1.4, 0.05)
    viscous = read.one("ControlBulkViscosity")
    assert (viscous.q1, viscous.q2) == (1.4, 0.05)


def test_coefficients_of_0_are_not_read_as_defaults(model):
    controls = dataclasses.replace(model.controls, hourglass=0.0, linear_viscosity=0.0, quadratic_viscosity=0.0)
    deck = LsDyna(text_of(dataclasses.replace(model, controls=controls), "SI"), "SI")
    found = deck.one("Hourglass")
    assert all(0.0 < value < 1e-15 for value in (found.qm, found.q1, found.q2))


def test_rigid_part_keeps_its_freedoms_mass_and_velocity(read, model):
    found = read.one("MatRigid")
    assert found.ro * unit_of(read.system, -3, 1) == pytest.approx(7820.0, rel=1e-7)
    assert (found.cmo, found.con1, found.con2) == (1.0, 2, 6)  # y held; x and z do not turn
    moving = read.one("InitialVelocityRigidBody")
    speed = unit_of(read.system, 1, 0, -1)
    assert (moving.pid, moving.vx * speed, moving.vy, moving.vz * speed) == pytest.approx(
        (5, 1.0, 0.0, 2.0)
    )  # y is held


def test_velocity_goes_to_the_part_that_flies(read):
    found = read.one("InitialVelocityGeneration")
    assert (found.id, found.styp) == (3, 2)
    assert found.vz * unit_of(read.system, 1, 0, -1) == pytest.approx(-3.0)


def test_gravity_is_the_acceleration_of_the_base_against_it(read):
    found = read.one("LoadBodyZ")
    assert found.sf * unit_of(read.system, 1, 0, -2) == pytest.approx(9.81)
    assert np.all(read.curve(found.lcid)[1] == 1.0)


def test_each_node_is_held_once_and_as_its_sides_say(read, model):
    wanted = {}
    for side, axes in (("copper.x-", [0]), ("copper.y-", [1]), ("tilted.x-", [0, 1, 2])):
        for node in np.unique(model.mesh.side(side)):
            wanted.setdefault(int(node), set()).update(axes)
    tied = set(np.unique(model.mesh.side("plate.z-")).tolist())
    inclined = set(np.unique(model.mesh.side("tilted.z-")).tolist()) - wanted.keys()
    found, local = {}, set()
    for spc in read.all("BoundarySpcSet"):
        nodes = set(read.nodes_of(spc.nsid).tolist())
        assert not nodes & (found.keys() | local)
        ways = {k for k, held in enumerate((spc.dofx, spc.dofy, spc.dofz)) if held}
        if spc.cid:
            (axes,) = [a for a in read.all("DefineCoordinateVector") if a.cid == spc.cid]
            x, y = np.array([axes.xx, axes.yx, axes.zx]), np.array([axes.xv, axes.yv, axes.zv])
            held = np.stack([x, y, np.cross(x, y)])[sorted(ways)]
            normal = np.array([0.0, -np.sin(TILT), np.cos(TILT)])
            np.testing.assert_allclose(held.T @ held, np.outer(normal, normal), atol=1e-7)
            local |= nodes
        else:
            found |= dict.fromkeys(nodes, ways)
    assert found == {node: ways for node, ways in wanted.items() if node not in tied}
    assert local == inclined


def test_contacts_have_all_faces_of_their_sides_outward_and_their_friction(read, model):
    for found, ours in zip(read.all("ContactAutomaticSurfaceToSurface"), model.contacts, strict=True):
        assert (found.surfatyp, found.surfbtyp) == (0, 0)
        assert (found.fs, found.fd) == (ours.friction, ours.friction)
        assert (found.soft, found.ignore) == (1, 1)
        assert found.heading.strip() == ours.name
        for number, side in ((found.surfa, ours.first), (found.surfb, ours.second)):
            faces = read.faces_of(number)
            assert np.array_equal(faces, model.mesh.side(side))
            assert outward(read.points, faces, read.hexahedra).all()


def test_tie_reaches_all_of_its_nodes_and_moves_none(read, model):
    found = read.one("ContactTiedNodesToSurfaceConstrainedOffset")
    assert (found.surfatyp, found.surfbtyp) == (4, 0)
    assert np.array_equal(read.nodes_of(found.surfa), np.unique(model.mesh.side("plate.z-")))
    assert np.array_equal(read.faces_of(found.surfb), model.mesh.side("copper.z+"))
    assert found.sast < 0.0
    assert found.sbst < 0.0
    # 0.6 of both thicknesses, each a tenth of the 2 mm of a face and 1 %, to five digits
    reach = -0.6 * (found.sast + found.sbst) * unit_of(read.system, 1)
    assert reach == pytest.approx(1.2 * 1.01 * 0.1 * 2e-3, rel=1e-4)


def test_wall_stands_where_it_did_and_its_normal_points_to_the_side(read, model):
    found = read.one("RigidwallPlanar")
    length = unit_of(read.system, 1)
    tail = np.array([found.xt, found.yt, found.zt]) * length
    np.testing.assert_allclose(tail, [0.0, 3e-3, 0.0], atol=1e-12)
    normal = np.array([found.xh - found.xt, found.yh - found.yt, found.zh - found.zt])
    np.testing.assert_allclose(normal / np.linalg.norm(normal), [0.0, -1.0, 0.0], atol=1e-7)
    assert found.fric == 0.2
    assert np.array_equal(read.nodes_of(found.nsid), np.unique(model.mesh.side("tilted.y+")))


def test_driven_sides_have_their_direction_and_curve(read, model):
    tilted, along, below = read.all("BoundaryPrescribedMotionSet")
    assert (tilted.dof, tilted.vad, along.dof, along.vad, along.sf) == (4, 0, 1, 0, -1.0)
    vector = read.one("DefineVector")
    assert tilted.vid == vector.vid
    np.testing.assert_allclose([vector.xh, vector.yh, vector.zh], [0.0, np.cos(TILT), np.sin(TILT)], atol=1e-7)
    time, speed = read.curve(tilted.lcid)
    time, speed = time * unit_of(read.system, 0, 0, 1), speed * unit_of(read.system, 1, 0, -1)
    np.testing.assert_allclose(np.interp([2e-6, 7.5e-6, 20e-6], time, speed), [0.0, 1.0, 2.0], rtol=1e-12)
    assert time[0] == 0.0
    assert time[-1] > 20e-6
    # tied nodes follow the other side
    tied = np.unique(model.mesh.side("plate.z-"))
    assert np.array_equal(read.nodes_of(along.nsid), np.setdiff1d(np.unique(model.mesh.side("plate.x+")), tied))
    assert np.array_equal(read.nodes_of(below.nsid), np.unique(model.mesh.side("copper.x+")))


def test_pressure_is_positive_on_faces_that_look_outward(read, model):
    found = read.one("LoadSegmentSet")
    time, pressure = read.curve(found.lcid)
    pressure = found.sf * pressure * unit_of(read.system, -1, 1, -2)
    np.testing.assert_allclose(np.interp([0.0, 20e-6], time * unit_of(read.system, 0, 0, 1), pressure), [1e6, 4e6])
    faces = read.faces_of(found.ssid)
    assert np.all(area_vectors(read.points, faces)[:, 2] > 0.0)
    assert np.array_equal(faces, model.mesh.side("striker.z+"))


def test_non_reflecting_side_has_both_dashpots(read, model):
    found = read.one("BoundaryNonReflecting")
    assert (found.ad, found.as_) == (0.0, 0.0)
    assert np.array_equal(read.faces_of(found.ssid), model.mesh.side("copper.z-"))


def test_run_is_as_long_and_as_cautious_as_ours(read):
    time = unit_of(read.system, 0, 0, 1)
    assert read.one("ControlTermination").endtim * time == pytest.approx(20e-6)
    step = read.one("ControlTimestep")
    assert (step.tssfac, step.ms1st) == (0.8, 1)  # mass is scaled before the first step alone
    assert step.tssfac * step.dt2ms * time == pytest.approx(
        -1e-8
    )  # LS-DYNA: TSSFAC |DT2MS|, negative: where it is short


def test_no_mass_is_scaled_where_no_least_step_is_asked_for(model):
    controls = dataclasses.replace(model.controls, least_step=0.0)
    step = LsDyna(text_of(dataclasses.replace(model, controls=controls), "SI"), "SI").one("ControlTimestep")
    assert step.dt2ms == 0.0


def test_stress_is_updated_in_the_middle_of_the_step_and_all_energies_are_added_up(read):
    assert read.one("ControlAccuracy").osu == 1
    energies = read.one("ControlEnergy")  # 1 would leave one out of the sum
    assert (energies.hgen, energies.rwen, energies.slnten, energies.rylen) == (2, 2, 2, 2)


def test_histories_come_at_each_interval_and_fields_as_often_as_asked(model):
    deck = LsDyna(text_of(model, "SI", frames=10), "SI")
    for kind in ("Glstat", "Matsum", "Rcforc", "Rwforc", "Secforc", "Elout", "Nodout"):
        assert deck.one(f"Database{kind}").dt == 0.5e-6
    assert deck.one("DatabaseBinaryD3Plot").dt == pytest.approx(2e-6)


def test_points_and_sections_are_told_of(read, model):
    text = read.one("DatabaseHistoryNodeId").write()
    node = int(text.splitlines()[-1][:10]) - 1
    np.testing.assert_allclose(model.mesh.points[node], [0.0, 0.0, 4.1e-3], atol=1e-12)
    section = read.one("DatabaseCrossSectionPlane")
    assert section.zct * unit_of(read.system, 1) == pytest.approx(4.6e-3)
    assert section.zch - section.zct == pytest.approx(1.0)
    numbers = [int(x) for line in read.one("DatabaseHistorySolid").write().splitlines()[2:] for x in line.split()]
    heights = read.points[read.hexahedra[np.array(numbers) - 1]][:, :, 2]
    assert np.all((heights.min(axis=1) <= 4.6e-3) & (heights.max(axis=1) >= 4.6e-3))
    assert len(numbers) == 4


def test_nothing_is_left_out_in_silence(model):
    deck = ls_dyna_deck(model, SYSTEMS["SI"], Heading("a title"))
    text = " ".join("".join(deck.files[".k"]).replace("\n$ ", " ").split())
    assert len(deck.left_out) == 2
    assert {line.split()[0] for line in deck.left_out} == {"group", "section"}
    for line in (*deck.left_out, *deck.differs):
        assert " ".join(line.split()) in text


def test_friction_of_1_at_a_wall_is_said_to_be_another_thing(model):
    walls = (RigidWall("tilted.y+", (0.0, 3e-3, 0.0), (0.0, -1.0, 0.0), 1.5),)
    deck = ls_dyna_deck(dataclasses.replace(model, walls=walls), SYSTEMS["SI"], Heading("a title"))
    assert any("no sliding" in line for line in deck.differs)
    assert LsDyna("".join(deck.files[".k"]), "SI").one("RigidwallPlanar").fric == 1.0


def test_volumes_are_those_of_the_mesh(read, model):
    np.testing.assert_allclose(
        volumes(read.points, read.hexahedra.astype(np.int32)),
        volumes(model.mesh.points, model.mesh.hexahedra),
        rtol=1e-7,
    )


def test_further_blows_are_said_to_be_left_out(model):
    again = dataclasses.replace(model, controls=dataclasses.replace(model.controls, blows=3))
    assert ls_dyna_deck(again, SYSTEMS["SI"], Heading("a title")).left_out[0].startswith("blows 2 to 3")
