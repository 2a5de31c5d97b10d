"""What is read off a run: peaks that do not hang on the time step, the largest stresses, overlaps before the blow.

Then the same on histories short enough to be worked by hand.
"""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from strikewave.fem.mesh import joined
from strikewave.fem.model import Controls, Model, Rigid, RigidWall, SurfaceContact
from strikewave.fem.recorder import assembly, average_acceleration
from strikewave.fem.run import (
    FemRun,
    PartHistory,
    balance_measure,
    blow_axis,
    blow_measure,
    contact_measure,
    interval_means,
    mean_acceleration,
    mean_force,
    middles,
    near_axis,
    part_measure,
    pressing_at_end,
    restitution,
    still_presses,
    top_duration,
)
from strikewave.fem.shapes import TubeSize, block, tube
from strikewave.fem.solids import Bilinear, von_mises
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


# Histories by hand

WAY = np.array([0.0, 0.6, -0.8])
TIME = 2.0 * np.arange(9.0)


def gathered(means, way=WAY):
    """What mean rates over intervals of 2 s add up to, along a direction."""
    return np.outer(2.0 * np.append(0.0, np.cumsum(means)), way)


def part(mass, velocity):
    velocity = np.asarray(velocity, float)
    return PartHistory(mass, velocity, 0.0 * velocity, 0.0 * velocity)


def bare(**given):
    """A run of nothing but what is given."""
    nothing = {name: {} for name in ("force", "impulse", "energy", "parts", "points", "sections")}
    numbers = {"initial_energy": 0.0, "steps": 0, "step": 1.0, "added_mass": 0.0, "seconds": 1.0, "elements": 0}
    arrays = {"time": TIME, "momentum": np.zeros((9, 3)), "impulse_given": np.zeros((9, 3))}
    return FemRun(**{**nothing, **numbers, **arrays, **given})


def test_means_over_unequal_intervals_are_changes_over_their_lengths():
    time, impulse = np.array([0.0, 0.5, 2.0, 3.0]), np.array([[0.0, 1.0], [2.0, 1.0], [-1.0, 4.0], [-1.0, 4.5]])
    assert interval_means(impulse, time).tolist() == [[4.0, 0.0], [-2.0, 2.0], [0.0, 0.5]]
    assert interval_means(impulse[:, 0], time).tolist() == [4.0, -2.0, 0.0]
    assert middles(time).tolist() == [0.25, 1.25, 2.5]
    run = bare(impulse={"a": gathered([1, 2, 3, 4, 5, 6, 7, 8])}, parts={"p": part(3.0, gathered(range(8)))})
    np.testing.assert_allclose(mean_force(run, "a"), np.outer(range(1, 9), WAY), atol=1e-14)
    np.testing.assert_allclose(mean_acceleration(run, "p"), np.outer(range(8), WAY), atol=1e-14)


def test_a_contact_lasts_from_a_tenth_of_its_peak_to_a_tenth():
    """Means of 0.4 and 4 N at 3 and 5 s reach 1 N after a sixth of 2 s; 2 and 0.5 N at 11 and 13 s after two thirds."""
    run = bare(impulse={"a": gathered([0.0, 0.4, 4.0, 10.0, 7.6, 2.0, 0.5, 0.0])})
    found = contact_measure(run, "a")
    assert (found.peak, found.at) == (pytest.approx(10.0, rel=1e-14), 7.0)
    assert found.impulse == pytest.approx(2.0 * 24.5, rel=1e-14)
    assert (found.begin, found.end) == (pytest.approx(3.0 + 2.0 / 6.0, rel=1e-13), pytest.approx(11.0 + 4.0 / 3.0))
    assert found.duration == pytest.approx(9.0, rel=1e-13)
    assert top_duration(run, "a") == 4.0  # of 10 and 7.6 N; 4 N is below three quarters
    assert contact_measure(bare(impulse={"a": np.zeros((9, 3))}), "a") is None


def test_a_contact_that_presses_at_both_ends_lasts_the_whole_run():
    run = bare(impulse={"a": gathered([9.0, 10.0, 8.0, 7.6, 8.0, 9.9, 8.0, 9.0])})
    found = contact_measure(run, "a")
    assert (found.begin, found.end) == (0.0, 16.0)
    assert top_duration(run, "a") == 16.0
    late = bare(impulse={"a": gathered([0.0, 7.4, 10.0, 7.4, 10.0, 0.0, 0.0, 0.0])})
    assert top_duration(late, "a") == 2.0  # about the first of two equal peaks


def test_a_part_is_measured_along_its_largest_change_of_velocity():
    """A rate of 0.4, 4, 10, 7.6, 2, -0.5 m/s^2 along (0, 0.6, -0.8), from a velocity of (5, 0, 0)."""
    velocity = np.array([5.0, 0.0, 0.0]) + gathered([0.0, 0.4, 4.0, 10.0, 7.6, 2.0, -0.5, 0.0])
    run = bare(
        parts={"a": part(3.0, velocity)},
        groups={"both": part(7.0, velocity[::-1])},
        von_mises={"a": np.array([1.0, 9.0, 2.0])},
        plastic_strain={"a": np.array([0.0, 0.25, 0.5])},
    )
    found = part_measure(run, "a")
    assert (found.mass, found.von_mises, found.plastic_strain) == (3.0, 9.0, 0.5)
    np.testing.assert_allclose(found.direction, WAY, atol=1e-15)
    assert found.rigid_peak == pytest.approx(10.0, rel=1e-13)
    assert found.velocity_change == pytest.approx(2.0 * 24.0, rel=1e-13)
    assert found.width == pytest.approx(11.0 + 0.8 - 10.0 / 3.0, rel=1e-13)  # 2 to -0.5 at 11 and 13 s reach 1 at 11.8
    group = part_measure(run, "both")
    np.testing.assert_allclose(group.direction, -WAY, atol=1e-15)
    assert np.isnan([group.von_mises, group.plastic_strain]).all()


@pytest.mark.parametrize(("share", "moves"), [(0.7, False), (1.5, True)])
def test_a_part_that_moves_by_rounding_alone_does_not_move(share, moves):
    """Rounding is 1e-12 of the fastest part, of any."""
    drift = np.outer(np.linspace(0.0, share * 4e-12, 9), [1.0, 0.0, 0.0])
    run = bare(parts={"a": part(2.0, drift), "b": part(1.0, np.tile([0.0, -4.0, 3.0], (9, 1)))})
    found = part_measure(run, "a")
    assert (found.velocity_change > 0.0) == moves
    if not moves:
        assert (found.direction, found.rigid_peak, found.velocity_change) == ((0.0, 0.0, 0.0), 0.0, 0.0)
        assert np.isnan(found.width)


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(("degrees", "taken"), [(4.9, True), (5.1, False)])
def test_a_direction_within_five_degrees_of_an_axis_is_that_axis(degrees, taken, sign):
    angle = np.radians(degrees)
    way = np.array([np.sin(angle), sign * np.cos(angle), 0.0])
    np.testing.assert_allclose(near_axis(7.0 * way), [0.0, sign, 0.0] if taken else way, atol=1e-15)


def test_a_run_is_shown_along_the_greatest_change_of_momentum_upward():
    """3 kg m/s along y are less than 5 along (0, 0.6, -0.8), though faster, and a steady motion is no change."""
    light, heavy = np.zeros((9, 3)), np.zeros((9, 3))
    light[4], heavy[5] = [0.0, 6.0, 0.0], 0.5 * WAY
    steady = np.tile([90.0, 0.0, 0.0], (9, 1))
    run = bare(parts={"l": part(0.5, light), "h": part(10.0, heavy), "s": part(5.0, steady)})
    np.testing.assert_allclose(blow_axis(run), -WAY, atol=1e-15)
    assert blow_axis(bare(parts={"s": part(5.0, steady)})).tolist() == [0.0, 0.0, 1.0]
    assert blow_axis(bare(parts={"l": part(0.5, -light)})).tolist() == [0.0, 1.0, 0.0]


def energies(**columns):
    names = ("kinetic", "internal", "plastic", "hourglass", "contact", "viscous", "external")
    return {name: np.array(columns.get(name, (0.0, 0.0, 0.0))) for name in names}


def test_the_energy_balance_by_hand():
    """10 J at first; 2 J come from outside, then 7 go: 12 J in play from then on. Plastic work is in the internal."""
    run = bare(
        initial_energy=10.0,
        energy=energies(
            kinetic=(10.0, 5.0, 1.0),
            internal=(0.0, 4.0, 2.0),
            plastic=(0.0, 3.0, 3.0),
            hourglass=(0.0, 1.0, -0.4),
            contact=(0.0, -0.6, 0.3),
            viscous=(0.0, 2.0, 2.5),
            external=(0.0, 2.0, -5.0),
        ),
        parts={"a": part(2.0, np.zeros((9, 3)))},
    )
    np.testing.assert_allclose(run.energy_error, [0.0, -0.6 / 12.0, 0.4 / 12.0], rtol=1e-14)
    assert run.energy_in_play == 12.0
    assert run.contact_gain == pytest.approx(0.6 / 12.0, rel=1e-14)
    assert run.rounding_energy == pytest.approx(0.5 * 2.0 * 1e-16, rel=1e-14, abs=0.0)
    found = balance_measure(run)
    assert (found.energy, found.hourglass) == (pytest.approx(-0.05, rel=1e-14), pytest.approx(0.25, rel=1e-14))
    before = SimpleNamespace(plastic_before=6.0)
    assert balance_measure(replace(run, rest=before)).hourglass == pytest.approx(0.1, rel=1e-14)
    idle = replace(run, energy=energies(hourglass=(0.0, 3e-9, 0.0)))
    assert balance_measure(idle).hourglass == pytest.approx(0.3, rel=1e-12)  # over a billionth of the 10 J in play
    resting = replace(idle, initial_energy=0.0)
    assert resting.energy_in_play == pytest.approx(1e-16, rel=1e-14, abs=0.0)
    assert balance_measure(resting).hourglass == pytest.approx(3e-9 / 1e-16, rel=1e-12)
    empty = replace(resting, parts={})
    assert balance_measure(replace(empty, energy=energies())).hourglass == 0.0
    gained = replace(run, energy=energies(contact=(0.0, 0.2, 0.1)), initial_energy=1.0)
    assert gained.contact_gain == 0.0


def test_the_momentum_balance_by_hand():
    """0.3 N s are missing where parts carry 2 * 3 + 5 * 0.6 kg m/s at most, whatever their signs."""
    run = bare(
        momentum=np.array([[1.0, 0.0, 2.0], [1.0, 0.0, 0.7]]),
        impulse_given=np.array([[0.0, 0.0, 0.0], [0.0, 0.1, -1.0]]),
        parts={"a": part(2.0, [[0, 0, 0], [0, 0, 3.0]]), "b": part(5.0, [[0, 0, 0], [1.0, 0, -0.6]])},
        steps=600,
        elements=70,
        seconds=3.5,
    )
    assert run.momentum_error == pytest.approx(0.3 / 9.0, rel=1e-13)
    assert run.speed == 12_000.0
    assert balance_measure(replace(run, energy=energies())).momentum == run.momentum_error


def test_restitution_is_that_of_the_bodies_along_the_impulse():
    """a and b are one body of 5 kg that comes at 4 m/s and goes at 1 m/s; the other, of 2 kg, goes at 2 m/s from -1."""
    across = np.array([50.0, 0.0, 0.0])
    speeds = {"a": (-4.0, 4.0), "b": (-4.0, -1.0), "c": (1.0, -2.0)}
    parts = {
        name: part({"a": 2.0, "b": 3.0, "c": 2.0}[name], [first * WAY + across, 9.0 * WAY, last * WAY - across])
        for name, (first, last) in speeds.items()
    }
    time, impulse = np.array([0.0, 1.0, 4.0]), np.array([0.0 * WAY, 5.0 * WAY, 5.1 * WAY])
    run = bare(parts=parts, time=time, impulse={"x": impulse}, bodies=(("a", "b"), ("c",)))
    assert pressing_at_end(run, "x") == pytest.approx(0.1 / 3.0, rel=1e-12)
    assert not still_presses(run, "x")  # below a hundredth of 5 N
    assert restitution(run, "x", ("b.top", "c")) == pytest.approx((1.0 + 2.0) / (4.0 + 1.0), rel=1e-13)
    assert restitution(run, "x", ("a.top",)) == pytest.approx(1.0 / 4.0, rel=1e-13)  # before a wall
    assert restitution(run, "x", ("c.top",)) is None  # which goes away at first
    late = replace(run, impulse={"x": np.array([0.0 * WAY, 5.0 * WAY, 5.2 * WAY])})
    assert still_presses(late, "x")
    assert restitution(late, "x", ("a.top",)) is None
    measured = blow_measure(
        replace(run, blow=3, plastic_strain={"a": np.array([0.0, 0.3, 0.2])}, plastic_work={"a": 1.5}),
        {"x": ("b.top", "c")},
    )
    assert (measured.blow, measured.plastic_strain, measured.plastic_energy) == (3, {"a": 0.2}, {"a": 1.5})
    assert measured.restitution == {"x": pytest.approx(0.6, rel=1e-13)}


def test_the_average_acceleration_about_instants_weighs_with_hats():
    """Hats over unequal intervals of 1, 2, 5 s: mean velocities 3, 1, -0.2, and 2 and 0 m/s at the ends."""
    time, moved = np.array([0.0, 1.0, 3.0, 8.0]), np.array([0.0, 3.0, 5.0, 4.0])
    velocity = np.array([2.0, 9.0, 9.0, 0.0])
    expected = [1.0 / 0.5, -2.0 / 1.5, -1.2 / 3.5, 0.2 / 2.5]
    np.testing.assert_allclose(average_acceleration(time, moved, velocity), expected, rtol=1e-14)
    rows = average_acceleration(time, np.outer(moved, WAY), np.outer(velocity, WAY))
    np.testing.assert_allclose(rows, np.outer(expected, WAY), rtol=1e-14)
    assert average_acceleration(time[:1], moved[:1], velocity[:1]).tolist() == [0.0]


def test_parts_of_a_group_move_as_their_masses_say():
    one = PartHistory(3.0, np.array([[1.0, 0, 0]]), np.array([[0, 4.0, 0]]), np.array([[0, 0, 8.0]]))
    other = PartHistory(5.0, np.array([[9.0, 0, 0]]), np.array([[0, -4.0, 0]]), np.array([[8.0, 0, 0]]))
    both = assembly({"a": one, "b": other, "c": one}, ("a", "b"))
    assert both.mass == 8.0
    assert both.velocity.tolist() == [[6.0, 0.0, 0.0]]
    assert both.acceleration.tolist() == [[0.0, -1.0, 0.0]]
    assert both.displacement.tolist() == [[5.0, 0.0, 3.0]]
