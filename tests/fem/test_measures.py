"""What is read off a run: peaks that do not hang on the time step, the largest stresses, overlaps before the blow."""

from dataclasses import replace

import numpy as np
import pytest

from strikewave.fem.invariants import von_mises
from strikewave.fem.measures import contact_measure, part_measure
from strikewave.fem.mesh import joined
from strikewave.fem.model import Controls, Model, Rigid, RigidWall, SurfaceContact
from strikewave.fem.round_shapes import TubeSize, tube
from strikewave.fem.shapes import block
from strikewave.fem.solids import Bilinear
from strikewave.fem.solve import RunOptions, solve

from .bodies import BAR_SPEED, STEEL, THIN_STEEL, WIDTH, Bar, two_bars

SPEED = 5.0


@pytest.mark.parametrize("across", [2, 3])
def test_peaks_of_flat_bars_that_meet_are_rho_c_v_a_over_2_whatever_the_step(across):
    """Kolsky 1963: bars of one steel, nu = 0, meshes that match and that do not; means over 1 us, seven steps or more.

    1 %: the overshoot of the front that bulk viscosity leaves. 0.5 % between steps that differ sixfold, while the force
    of the first step itself grows as 1/dt.
    """
    plateau = 7820.0 * BAR_SPEED * SPEED / 2.0 * WIDTH**2
    peaks, single = [], []
    for safety in (0.9, 0.15):
        model = two_bars(Bar(along=100), Bar(along=100, across=across), SPEED, 30e-6)
        run = solve(replace(model, controls=Controls(30e-6, interval=1e-6, safety=safety)))
        (name,) = run.force
        found = contact_measure(run, name)
        peaks.append(found.peak)
        single.append(float(np.abs(run.force[name]).max()))
        for part in ("striking", "struck"):
            measured = part_measure(run, part)
            assert measured.rigid_peak * measured.mass == pytest.approx(found.peak, rel=1e-9)
            assert abs(measured.direction[2]) == 1.0
        assert found.begin == 0.0
    assert peaks == pytest.approx([plateau] * 2, rel=0.01)
    assert peaks[0] == pytest.approx(peaks[1], rel=0.005)
    assert single[1] > 5.0 * single[0]


def test_largest_stress_and_plastic_strain_are_those_of_the_fields_at_every_instant():
    model = two_bars(Bar(along=20), Bar(along=20, solid=Bilinear(7820.0, 211e9, 0.3, 60e6, 2e9)), SPEED, 20e-6)
    model = replace(model, controls=Controls(20e-6, interval=1e-6))
    run = solve(model, RunOptions(frames=21))
    assert [frame.time for frame in run.frames] == pytest.approx(run.time, abs=1e-15)
    for k, frame in enumerate(run.frames):
        for name in model.mesh.names:
            own = model.mesh.elements_of(name)
            # the same sum of squares, rounded once less where products and sums are fused
            assert run.von_mises[name][k] == pytest.approx(von_mises(frame.stress[own]).max(), rel=1e-14)
            assert run.plastic_strain[name][k] == frame.plastic_strain[own].max()
    assert part_measure(run, "struck").plastic_strain > 0.0
    assert part_measure(run, "striking").plastic_strain == 0.0
    rigid = replace(model, rigid=(Rigid("striking"),))
    measured = part_measure(solve(rigid), "striking")
    assert np.isnan([measured.von_mises, measured.plastic_strain]).all()
    assert measured.rigid_peak > 0.0


def test_a_pin_in_a_bore_tells_how_deep_its_flat_faces_stand_in_each_other():
    """Two rings of one radius with unequal chords: at most what the longer one cuts off, R (1 - cos(pi/n))."""
    radius, length = 6e-3, 4e-3
    bore = tube("bore", TubeSize(2.0 * radius, 20e-3, length), 2e-3, 1e-3)
    pin = tube("pin", TubeSize(2e-3, 2.0 * radius, length), 1.2e-3, 1e-3)
    mesh = joined([pin, bore])
    model = Model(
        mesh,
        dict.fromkeys(mesh.names, STEEL),
        Controls(1e-6, interval=0.5e-6),
        velocity={"pin": (0.0, 0.0, 1.0)},
        contacts=(SurfaceContact("pin.round", "bore.inner_round"),),
    )
    (overlap,) = solve(model).overlaps
    sides = [mesh.points[np.unique(mesh.side(name))] for name in ("pin.round", "bore.inner_round")]
    around = min(len(np.unique(places[:, :2].round(9), axis=0)) for places in sides)
    assert 0.0 < overlap.deepest <= radius * (1.0 - np.cos(np.pi / around)) * (1.0 + 1e-9)
    assert overlap.contact == "pin.round-bore.inner_round"


def test_a_wall_tells_its_overlap_and_bodies_apart_have_none():
    plate = block("plate", (4e-3, 4e-3, 2e-3), 1e-3, 1e-3, 1e-3)
    foot = float(plate.points[:, 2].min())
    model = Model(
        plate,
        {"plate": THIN_STEEL},
        Controls(1e-6, interval=0.5e-6),
        walls=(RigidWall("plate.z-", (0.0, 0.0, foot + 5e-5), (0.0, 0.0, 1.0)),),
    )
    (overlap,) = solve(model).overlaps
    assert (overlap.nodes, overlap.deepest) == (25, pytest.approx(5e-5, rel=1e-9))
    below = replace(model, walls=(RigidWall("plate.z-", (0.0, 0.0, foot - 5e-5), (0.0, 0.0, 1.0)),))
    assert solve(below).overlaps == ()
