"""Plates of free masses, lattices of springs and blocks that meet: momentum, energy, friction, overlaps, walls."""

import itertools
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from strikewave.base.errors import InputError
from strikewave.fem._contact_kernels import add_wall, contact_force, contact_work
from strikewave.fem.contact import (
    add_contact,
    initial_overlaps,
    prepare,
    prepare_ties,
    prepare_wall,
    searched,
    two_surfaces,
)
from strikewave.fem.mesh import joined
from strikewave.fem.model import Controls, Model, RigidWall, SurfaceContact, Tie
from strikewave.fem.solids import Elastic
from strikewave.fem.solve import solve
from strikewave.fem.threads import on_all, spans

from .blocks import Lattice, block, nodal_mass


@dataclass
class Run:
    """What a run by the leapfrog scheme leaves: the last state, and by step the energies and the force on the first."""

    x: np.ndarray
    v: np.ndarray
    kinetic: list
    total: list
    taken: list
    force: list
    gap: list


def run(mesh, mass, contact, v, dt, steps, inner=None, gravity=(0.0, 0.0, 0.0), inverse_mass=None):
    """Advance masses under a contact, inner forces (a lattice) and gravity, as the solver does."""
    light = 1.0 / mass if inverse_mass is None else inverse_mass
    state = prepare(contact, mesh)
    x, v = mesh.points.copy(), np.array(v, float)
    done = Run(x, v, [], [], [], [], [])
    for _ in range(steps):
        f = mass[:, None] * np.array(gravity) + (0.0 if inner is None else inner.force(x))
        again = add_contact(state, x, v, f, light, dt)
        old = v.copy()
        v += dt * light[:, None] * f
        done.taken.append(contact_work(state.touch, v, dt))
        done.force.append(contact_force(state.touch))
        done.gap.append(state.nodal.gap.min())
        done.kinetic.append(0.5 * np.sum(mass[:, None] * v**2))
        done.total.append(0.5 * np.sum(mass[:, None] * v * old) + (0.0 if inner is None else inner.energy(x)))
        x += dt * v
        if again:
            state = searched(state, x)
    return done


def two_plates(first, second, gap=1e-3, shift=(0.0, 0.0)):
    """Two blocks one element high whose nodes are free masses; only the faces that meet count."""
    below = block("a", (*first, 1), (1.0, 1.0, 0.5))
    above = block("b", (*second, 1), (1.0, 1.0, 0.5), (*shift, 0.5 + gap))
    return joined([below, above]), len(below.points)


def test_masses_that_meet_node_on_node_follow_the_recurrence_of_the_predicted_gap():
    """Each pair is one equation: g* = 2 g_n - g_(n-1), and g_(n+1) = (1 - s) g* where g* < 0."""
    s, dt = 0.7, 0.01
    mesh, count = two_plates((3, 2), (3, 2))
    v = np.zeros_like(mesh.points)
    v[count:, 2] = -1.0
    state = prepare(SurfaceContact("a.top", "b.bottom", stiffness=s), mesh)
    mass = nodal_mass(mesh)
    x, light = mesh.points.copy(), 1.0 / mass
    low, high = state.touch.nodes[: state.touch.first], state.touch.nodes[state.touch.first :]
    gap, before = 1e-3, 1e-3 + dt
    for _ in range(12):
        f = np.zeros_like(x)
        if add_contact(state, x, v, f, light, dt):
            state = searched(state, x)
        v += dt * light[:, None] * f
        x += dt * v
        coming = 2.0 * gap - before
        gap, before = (1.0 - s) * coming if coming < 0.0 else coming, gap
        # m* of corner nodes and others alike: equal shares of mass and area (rounding only)
        assert x[high, 2] - x[low, 2] == pytest.approx(gap, abs=1e-14)
        assert v[low, 2] + v[high, 2] == pytest.approx(-1.0, abs=1e-12)


def test_a_kinematic_contact_is_the_limit_of_full_stiffness():
    """With s = 1 the plates have the velocity of their common momentum after one step, and touch exactly."""
    mesh, count = two_plates((2, 2), (2, 2), gap=0.5e-3)
    mass = nodal_mass(mesh)
    mass[count:] *= 3.0
    v = np.zeros_like(mesh.points)
    v[count:, 2] = -1.0
    done = run(mesh, mass, SurfaceContact("a.top", "b.bottom", stiffness=1.0), v, 1e-3, 2)
    gap = done.x[count:, 2].min() - done.x[:count, 2].max()
    assert gap == pytest.approx(0.0, abs=1e-15)
    top = np.isclose(mesh.points[:count, 2], 0.5)
    # the gap of 0.5e-3 is used up within the step of 1e-3: half the approach is left to stop in it
    assert done.v[:count][top, 2] == pytest.approx(-0.75, rel=1e-12)


@pytest.mark.verify
@settings(max_examples=60)
@given(
    st.tuples(st.integers(1, 5), st.integers(1, 5)),
    st.tuples(st.integers(1, 5), st.integers(1, 5)),
    st.floats(0.1, 1.0),
    st.floats(0.0, 1.0),
    st.tuples(st.floats(-0.4, 0.4), st.floats(-0.4, 0.4)),
    st.floats(-2.0, 2.0),
    st.integers(0, 1000),
)
def test_free_masses_never_gain_energy_and_keep_their_momentum(first, second, s, mu, shift, ratio, seed):
    rng = np.random.default_rng(seed)
    mesh, count = two_plates(first, second, shift=shift)
    mass = nodal_mass(mesh)
    mass[count:] *= 10.0**ratio
    v = rng.normal(0.0, 0.3, mesh.points.shape)
    v[count:, 2] -= 1.0
    begin = 0.5 * np.sum(mass[:, None] * v**2)
    done = run(mesh, mass, SurfaceContact("a.top", "b.bottom", mu, s), v, 1e-3, 100)
    # a penalty may hand back in one step what it took in another, never more in all
    assert max(done.kinetic) <= begin * (1.0 + 1e-12)
    assert mass @ done.v == pytest.approx(mass @ v, abs=1e-12 * np.sum(mass[:, None] * np.abs(v)))
    assert begin - done.kinetic[-1] == pytest.approx(np.sum(done.taken), abs=1e-12 * begin)


@given(st.integers(0, 1000), st.floats(0.2, 1.0), st.floats(0.0, 0.5))
def test_free_masses_never_gain_energy_while_the_step_changes(seed, s, mu):
    """Steps that jump by up to a factor of 2, forces acting on velocities for the mean of the two steps beside them."""
    rng = np.random.default_rng(seed)
    mesh, count = two_plates((3, 3), (4, 4), shift=(0.03, 0.05))
    mass, x = nodal_mass(mesh), mesh.points.copy()
    light, state = 1.0 / mass, prepare(SurfaceContact("a.top", "b.bottom", mu, s), mesh)
    v = rng.normal(0.0, 0.1, x.shape)
    v[count:, 2] -= 1.0
    begin = most = 0.5 * np.sum(mass[:, None] * v**2)
    steps = 1e-3 * 2.0 ** rng.uniform(-1.0, 0.0, 101)
    for behind, ahead in itertools.pairwise(steps):
        kick, f = 0.5 * (behind + ahead), np.zeros_like(x)
        again = add_contact(state, x, v, f, light, ahead, kick)
        v += kick * light[:, None] * f
        x += ahead * v
        most = max(most, 0.5 * np.sum(mass[:, None] * v**2))
        state = searched(state, x) if again else state
    assert most <= begin * (1.0 + 1e-12)


@pytest.mark.parametrize(("ratio", "wanted"), [(0.5, 2.0), (1.0, 1.0), (2.0, 0.25)])
def test_shorter_steps_keep_the_energy_of_a_depth(ratio, wanted):
    """k ~ 1/dt^2 and the energy k d^2/2: as dt falls to a half d does, and F = k d doubles; longer steps keep d."""
    forces = []
    for dt in (1e-3, ratio * 1e-3):
        mesh, _ = two_plates((2, 2), (2, 2), gap=0.0)
        state = prepare(SurfaceContact("a.top", "b.bottom"), mesh)
        x, v, f = mesh.points.copy(), np.zeros_like(mesh.points), np.zeros_like(mesh.points)
        x[np.unique(mesh.side("b.bottom")), 2] -= 0.002
        state.touch.step[0] = 1e-3
        add_contact(state, x, v, f, 1.0 / nodal_mass(mesh), dt)
        forces.append(contact_force(state.touch)[2])
    assert forces[1] / forces[0] == pytest.approx(wanted, rel=1e-12)


@given(st.integers(0, 1000), st.floats(0.0, 0.5))
def test_moment_of_the_contact_forces_is_zero_within_the_motion_of_a_step(seed, mu):
    """The normal force runs through both points at the end of the step, so its moment is at most F |dt v| a node."""
    rng = np.random.default_rng(seed)
    mesh, count = two_plates((3, 4), (4, 3), gap=1e-6, shift=(0.1, 0.05))
    x, v = mesh.points, rng.normal(0.0, 1.0, mesh.points.shape)
    v[count:, 2] -= 1.0
    state = prepare(SurfaceContact("a.top", "b.bottom", mu), mesh)
    dt, f = 1e-5, np.zeros_like(x)
    add_contact(state, x, v, f, 1.0 / nodal_mass(mesh), dt)
    pressed = np.linalg.norm(state.nodal.normal_force, axis=1) + np.linalg.norm(state.nodal.friction_force, axis=1)
    fastest = 2.0 * np.linalg.norm(v, axis=1).max()
    assert f.sum(axis=0) == pytest.approx(0.0, abs=1e-13 * pressed.sum())
    # friction acts across the gap, which is within the same bound
    assert np.linalg.norm(np.cross(x, f).sum(axis=0)) <= 2.0 * pressed.sum() * (dt * fastest + 1e-6)
    assert np.linalg.norm(f) > 0.0


def bars(first, second, shift=(0.0, 0.0), gap=1e-5):
    below = block("a", first, (1.0, 1.0, first[2] / first[0]))
    above = block("b", second, (1.0, 1.0, second[2] / second[0]), (*shift, first[2] / first[0] + gap))
    return joined([below, above]), len(below.points)


@pytest.mark.verify
@pytest.mark.parametrize("s", [0.1, 0.5, 0.8])
@pytest.mark.parametrize(
    ("first", "second", "shift", "denser"),
    [
        ((2, 2, 6), (2, 2, 6), (0.0, 0.0), 1.0),
        ((2, 2, 6), (3, 3, 9), (0.13, 0.21), 1.0),
        ((1, 1, 3), (8, 8, 3), (0.0, 0.0), 1.0),
        ((2, 2, 4), (3, 3, 4), (0.1, 0.2), 10.0),
    ],
)
def test_lattices_at_nine_tenths_of_the_critical_step_never_gain_energy(first, second, shift, denser, s):
    mesh, count = bars(first, second, shift)
    lattice = Lattice(mesh)
    lattice.mass[count:] *= denser
    v = np.zeros_like(mesh.points)
    v[count:, 2] = -1e-3
    begin = 0.5 * np.sum(lattice.mass[:, None] * v**2)
    dt = 0.9 * lattice.critical_step()
    done = run(mesh, lattice.mass, SurfaceContact("a.top", "b.bottom", 0.2, s), v, dt, 800, lattice)
    assert max(done.total) <= begin * (1.0 + 1e-9)
    # the springs turn, so that their energy is kept only to the order of the strain, about 1e-3
    assert begin - done.total[-1] == pytest.approx(np.sum(done.taken), abs=2e-3 * begin)
    assert lattice.mass @ done.v == pytest.approx(lattice.mass @ v, abs=1e-12 * np.abs(lattice.mass @ v).max())
    assert done.v[:count, 2].mean() < 0.0
    assert min(done.gap) > -2e-3


@pytest.mark.verify
@pytest.mark.parametrize("s", [0.5, 0.8, 1.0])
def test_pressed_lattices_stay_pressed_without_gaining_energy(s):
    """Two bars under a steady force on each end; the contact may only take energy from them."""
    mesh, count = bars((2, 2, 5), (3, 3, 8), (0.0, 0.0))
    lattice = Lattice(mesh)
    dt = 0.9 * lattice.critical_step()
    load = np.zeros_like(mesh.points)
    load[count:, 2] = -1e-3 * lattice.mass[count:] / lattice.mass[count:].sum()
    load[:count, 2] = 1e-3 * lattice.mass[:count] / lattice.mass[:count].sum()
    pressed = replace_force(lattice, load)
    done = run(mesh, lattice.mass, SurfaceContact("a.top", "b.bottom", 0.0, s), np.zeros_like(load), dt, 1500, pressed)
    assert max(done.total) <= 1e-12
    late = np.array(done.force)[1000:, 2].mean()
    # the contact carries the whole load: what is left is the mean rate of momentum of the vibration over 500 steps
    assert late == pytest.approx(-1e-3, rel=0.02)


def replace_force(lattice, load):
    """The lattice with a steady load, whose potential counts as its energy."""

    class Loaded:
        def force(self, x):
            return lattice.force(x) + load

        def energy(self, x):
            return lattice.energy(x) - np.sum(load * (x - lattice.mesh.points))

    return Loaded()


def lost_share(elements, s=0.8):
    """Energy that equal bars lose to contact when one strikes the other."""
    mesh, count = bars((1, 1, elements), (1, 1, elements))
    mesh.points[:, 2] *= 10.0 / elements
    lattice = Lattice(mesh)
    v = np.zeros_like(mesh.points)
    v[count:, 2] = -1e-4
    dt = 0.9 * lattice.critical_step()
    done = run(mesh, lattice.mass, SurfaceContact("a.top", "b.bottom", 0.0, s), v, dt, int(60 / dt), lattice)
    return np.sum(done.taken) / (0.5 * np.sum(lattice.mass[:, None] * v**2))


@pytest.mark.verify
def test_energy_that_contact_takes_goes_to_zero_with_the_size_of_the_elements():
    """Only the nodes at the surface meet inelastically, with 1/(2 n) of the mass: first order in the element size."""
    lost = np.array([lost_share(n) for n in (16, 32, 64)])
    assert np.all(lost > 0.0)
    assert lost[0] < 1.5 / (2 * 16)
    assert np.log2(lost[:-1] / lost[1:]) == pytest.approx(1.0, abs=0.25)


FLOOR = {"gravity": 9.81, "dt": 1e-4}


def slider(mu, tilt=0.0, speed=0.0, steps=3000, s=0.8):
    """A plate of free masses on a held floor that is tilted about y; x points down the slope."""
    floor, plate = block("a", (8, 2, 1), (4.0, 1.0, 0.5)), block("b", (2, 1, 1), (0.5, 0.4, 0.5), (0.3, 0.05, 0.5))
    mesh, count = joined([floor, plate]), len(floor.points)
    mass = nodal_mass(mesh)
    light = 1.0 / mass
    light[:count] = 0.0
    light[count:][plate.points[:, 2] > 0.6] = 0.0  # only the nodes on the floor are free
    v = np.zeros_like(mesh.points)
    free = light > 0.0
    v[free, 0] = speed
    gravity = 9.81 * np.array([np.sin(tilt), 0.0, -np.cos(tilt)])
    done = run(mesh, mass, SurfaceContact("a.top", "b.bottom", mu, s), v, 1e-4, steps, None, gravity, light)
    return done.x[free] - mesh.points[free], done.v[free], done


def test_a_slider_comes_to_rest_after_v2_over_2_mu_g():
    mu, speed = 0.3, 1.0
    moved, v, _ = slider(mu, speed=speed, steps=5000)
    # the plate settles into the floor within the first steps and stops within one: both shift it by about speed dt
    assert moved[:, 0] == pytest.approx(speed**2 / (2 * mu * 9.81), abs=3 * speed * 1e-4)
    assert v == pytest.approx(0.0, abs=1e-9)
    assert moved[:, 1] == pytest.approx(0.0, abs=1e-12)


def test_friction_takes_what_the_slider_had():
    _, _, done = slider(0.3, speed=1.0, steps=5000)
    taken = np.array(done.taken)
    # the rest, about (g dt)^2 of v^2, is the fall into the floor in the first steps
    assert done.kinetic[0] - done.kinetic[-1] == pytest.approx(taken[1:, 1].sum(), rel=1e-5)
    assert np.all(taken[:, 1] >= 0.0)


@pytest.mark.parametrize("s", [0.5, 0.8, 1.0])
def test_what_sticks_on_a_slope_creeps_as_told(s):
    """Below the angle of friction the speed is (1 - s)/s dt T/m, T/m = g sin(tilt); with s = 1 it is none.

    No node of the floor lies below the plate, so that one pass alone holds it, with s/2 in place of s.
    """
    tilt = np.arctan(0.3) * 0.9
    _, v, _ = slider(0.3, tilt, steps=2000, s=s)
    share = 0.5 * s
    assert v[:, 0] == pytest.approx((1 - share) / share * 1e-4 * 9.81 * np.sin(tilt), rel=1e-6)


def test_beyond_the_angle_of_friction_it_slides_with_g_sin_minus_mu_cos():
    mu, tilt, steps = 0.3, 0.5, 3000
    _, v, _ = slider(mu, tilt, steps=steps)
    wanted = 9.81 * (np.sin(tilt) - mu * np.cos(tilt)) * steps * 1e-4
    assert v[:, 0] == pytest.approx(wanted, rel=2e-3)  # the normal force needs a few steps to settle


@pytest.mark.parametrize("s", [0.3, 0.8])
def test_steady_force_overlaps_by_one_minus_s_over_s(s):
    """A plate at rest on an equal grid of held nodes: both passes act, and the depth is (1 - s)/s g dt^2."""
    mesh, count = two_plates((2, 2), (2, 2), gap=0.0)
    mass = nodal_mass(mesh)
    light = 1.0 / mass
    light[:count] = 0.0
    light[count:][mesh.points[count:, 2] > 0.6] = 0.0
    v = np.zeros_like(mesh.points)
    done = run(mesh, mass, SurfaceContact("a.top", "b.bottom", stiffness=s), v, 1e-3, 400, None, (0, 0, -9.81), light)
    free = light > 0.0
    assert 0.5 - done.x[free, 2] == pytest.approx((1 - s) / s * 9.81e-6, rel=1e-9)
    assert done.force[-1][2] == pytest.approx(-9.81 * mass[free].sum(), rel=1e-9)


def test_an_uneven_mesh_passes_an_even_pressure():
    """Free plates of 2 x 2 on 5 x 5 elements, moved at one speed: after the first step all nodes have moved alike.

    Both passes close the share s of the gap where the pressure is even; at single nodes the pressure is even only in the
    mean, so that the mean is compared.
    """
    mesh, count = two_plates((2, 2), (5, 5), gap=0.0)
    mass = nodal_mass(mesh)
    v = np.zeros_like(mesh.points)
    v[count:, 2] = -1.0
    done = run(mesh, mass, SurfaceContact("a.top", "b.bottom", stiffness=1.0), v, 1e-3, 1)
    low = np.isclose(mesh.points[:count, 2], 0.5)
    # m*/dt per area 1/8 kg of each plate's surface: the impulse of a kinematic contact would be 1/8
    impulse = mass[:count][low] @ done.v[:count][low, 2]
    assert -impulse == pytest.approx(0.125, rel=0.3)
    assert -impulse <= 0.125 * (1 + 1e-12)


def test_shallow_overlaps_give_no_force_and_are_forgotten_once_left():
    mesh, count = two_plates((3, 3), (4, 4), gap=-0.01)
    contact = SurfaceContact("a.top", "b.bottom")
    state = prepare(contact, mesh)
    (overlap,) = initial_overlaps([(contact.name, state)], mesh.points)
    assert (overlap.contact, overlap.nodes) == ("a.top-b.bottom", 16 + 25)
    assert overlap.deepest == pytest.approx(0.01, rel=1e-12)
    light = 1.0 / nodal_mass(mesh)
    x, v, f = mesh.points.copy(), np.zeros_like(mesh.points), np.zeros_like(mesh.points)
    add_contact(state, x, v, f, light, 1e-3)
    assert np.all(f == 0.0)
    v[count:, 2] = -1e-3
    add_contact(state, x, v, f, light, 1e-3)
    assert contact_force(state.touch)[2] < 0.0
    x[count:, 2] += 0.02
    state, v[:], f[:] = searched(state, x), 0.0, 0.0
    add_contact(state, x, v, f, light, 1e-3)
    assert np.all(f == 0.0)
    x[count:, 2] -= 0.02
    state = searched(state, x)
    add_contact(state, x, v, f, light, 1e-3)
    assert contact_force(state.touch)[2] < 0.0


def test_deep_overlaps_are_refused_with_part_place_and_depth():
    mesh, _ = two_plates((3, 3), (4, 4), gap=-0.1)
    with pytest.raises(InputError, match=r"0\.1 m at \(.*\) m in [ab].*move the parts apart"):
        prepare(SurfaceContact("a.top", "b.bottom"), mesh)


def ring(name, inner, outer, around, turned=0.0):
    """A tube of one element across and two along, with its walls as sides."""
    flat = block(name, (1, around, 2))
    r = inner + (outer - inner) * flat.points[:, 0]
    angle = 2 * np.pi * flat.points[:, 1] + turned
    keep = flat.points[:, 1] < 1.0 - 1e-9
    number = np.cumsum(keep) - 1
    count = (around + 1) * 3
    whole = np.arange(2 * count) % count
    same = np.where(whole // 3 == around, np.arange(2 * count) - 3 * around, np.arange(2 * count))
    points = np.column_stack([r * np.cos(angle), r * np.sin(angle), 0.5 * flat.points[:, 2]])[keep]
    hexahedra = number[same][flat.hexahedra].astype(np.int32)
    low, high = hexahedra[:, [0, 4, 7, 3]], hexahedra[:, [1, 2, 6, 5]]
    return replace(flat, points=points, hexahedra=hexahedra, sides={f"{name}.inner": low, f"{name}.outer": high})


@pytest.mark.parametrize("around", [(24, 20), (24, 24), (16, 30)])
def test_a_pin_in_a_bore_of_flat_faces_slides_freely(around):
    """Circles of the same radius made of unequal chords overlap by what these cut off; that gives no force."""
    bore, pin = ring("bore", 1.0, 1.5, around[0], 0.1), ring("pin", 0.6, 1.0, around[1])
    mesh = joined([bore, pin])
    contact = SurfaceContact("pin.outer", "bore.inner", friction=0.3)
    state = prepare(contact, mesh)
    (overlap,) = initial_overlaps([(contact.name, state)], mesh.points)
    assert 0.0 < overlap.deepest <= (1.0 - np.cos(np.pi / min(around))) * (1 + 1e-9)
    x, v = mesh.points.copy(), np.zeros_like(mesh.points)
    v[len(bore.points) :, 2] = 1e-3
    light = 1.0 / nodal_mass(mesh)
    for _ in range(50):
        f = np.zeros_like(x)
        if add_contact(state, x, v, f, light, 1e-2):
            state = searched(state, x)
        assert np.abs(f).max() < 1e-10
        x += 1e-2 * v
    v[len(bore.points) :, 0] = 1e-3
    add_contact(state, x, v, f, light, 1e-2)
    assert contact_force(state.touch)[0] < 0.0
    assert f.sum(axis=0) == pytest.approx(0.0, abs=1e-12 * np.abs(f).max())


def test_a_pocket_holds_a_node_flush_with_its_wall():
    """A node in the plane of the wall of a pocket and below its floor meets the floor."""
    pocket = block("a", (2, 2, 2))
    hexahedra = pocket.hexahedra[[0, 1, 2, 3, 4, 5, 6]]  # the last, at +x +y +z, is the pocket
    pocket = replace(pocket, hexahedra=hexahedra, part=np.zeros(7, np.int32), sides={})
    plug = block("b", (1, 1, 1), (0.5, 0.5, 0.5), (0.5, 0.5, 0.5))
    mesh = joined([pocket, plug])
    state = prepare(SurfaceContact("a.all", "b.bottom"), mesh)
    v = np.zeros_like(mesh.points)
    v[len(pocket.points) :, 2] = -1.0
    f = np.zeros_like(v)
    add_contact(state, mesh.points, v, f, np.ones(len(v)), 1e-4)
    bottom = mesh.side("b.bottom").ravel()
    assert np.all(f[bottom, 2] > 0.0)
    assert np.ptp(state.nodal.normal_force[state.touch.first :], axis=0) == pytest.approx(0.0, abs=1e3)


def test_nodes_that_are_not_checked_are_still_met_by_the_other_surface():
    """Tied nodes of a plate: only the nodes of the other plate press, and half the stiffness is left."""
    mesh, count = two_plates((2, 2), (2, 2), gap=0.0)
    v, light = np.zeros_like(mesh.points), 1.0 / nodal_mass(mesh)
    v[count:, 2] = -1.0
    forces = []
    for unchecked in ([], np.unique(mesh.side("a.top"))):
        state = prepare(SurfaceContact("a.top", "b.bottom"), mesh, unchecked)
        f = np.zeros_like(v)
        add_contact(state, mesh.points, v, f, light, 1e-3)
        forces.append(contact_force(state.touch)[2])
        assert f.sum(axis=0) == pytest.approx(0.0, abs=1e-12 * np.abs(f).max())
    assert not state.nodal.touches[: state.touch.first].any()
    assert forces[1] == pytest.approx(0.5 * forces[0], rel=1e-12)


def test_bodies_that_move_together_fast_are_not_searched_again():
    mesh, _ = two_plates((3, 3), (4, 4))
    state = prepare(SurfaceContact("a.top", "b.bottom"), mesh)
    v = np.full_like(mesh.points, 300.0)
    assert not add_contact(state, mesh.points, v, np.zeros_like(v), np.ones(len(v)), 1e-3)
    assert state.travel[0] == pytest.approx(0.0, abs=1e-10)


def test_a_plate_that_comes_from_afar_is_found_in_time():
    """Ten plate heights away at first, no candidates; the run searches as often as it is told to."""
    mesh, count = two_plates((3, 3), (4, 4), gap=5.0, shift=(-1.0, -0.5))
    mass = nodal_mass(mesh)
    v = np.zeros_like(mesh.points)
    v[count:] = [1.0, 0.5, -5.0]
    done = run(mesh, mass, SurfaceContact("a.top", "b.bottom", stiffness=1.0), v, 1e-3, 1200)
    first = next(i for i, force in enumerate(done.force) if force[2] < 0.0)
    assert first == 1000 or first == 999  # rounding decides whether 5 m are gone after 1000 steps
    assert min(done.gap) > -1e-2


@pytest.mark.parametrize(
    ("first", "second", "shift"),
    [
        ((3, 3, 15), (3, 3, 15), (0.0, 0.0)),
        ((3, 3, 15), (5, 5, 25), (0.0, 0.0)),
        ((2, 2, 10), (7, 7, 35), (6e-4, 4e-4)),
    ],
)
def test_bars_of_steel_press_each_other_with_half_rho_c_area_times_speed(first, second, shift):
    """Two equal bars, one at 1 m/s, without lateral strain: the force is rho c A v/2 until the waves come back (19 us).

    Source: Graff 1975, Wave Motion in Elastic Solids, sec. 2.4. The bars are made of elements and meet over
    unequal meshes; the mean over 4 to 16 us levels the ringing of the mesh behind the front.
    """
    size = (0.01, 0.01, 0.05)
    mesh = joined([block("a", first, size), block("b", second, size, (*shift, 0.05 + 1e-7))])
    steel = Elastic(7850.0, 210e9, 0.0)
    model = Model(
        mesh,
        {"a": steel, "b": steel},
        Controls(40e-6, 0.5e-6),
        velocity={"b": (0.0, 0.0, -1.0)},
        contacts=(SurfaceContact("a.top", "b.bottom"),),
    )
    done = solve(model)
    force = done.force["a.top-b.bottom"][:, 2]
    area = (0.01 - shift[0]) * (0.01 - shift[1])
    if shift == (0.0, 0.0):
        plateau = 0.5 * 7850.0 * steel.wave_speed * area
        assert -force[8:32].mean() == pytest.approx(plateau, rel=0.01)
    assert done.momentum_error < 1e-9
    assert abs(done.energy_error).max() < 1e-5
    assert done.impulse["a.top-b.bottom"][-1, 2] == pytest.approx(
        done.parts["a"].mass * done.parts["a"].velocity[-1, 2], rel=1e-9
    )
    assert np.all(force <= 1e-9)
    assert done.parts["a"].velocity[-1, 2] == pytest.approx(-1.0, abs=0.06)  # short of what contact took
    assert np.all(force[-20:] == 0.0)


def test_a_wall_stops_masses_and_turns_nothing_but_the_normal():
    mesh = block("a", (2, 2, 1))
    wall = prepare_wall(RigidWall("a.bottom", (0.0, 0.0, -0.004), (0.0, 0.0, 2.0), friction=0.5), mesh)
    mass = nodal_mass(mesh)
    x, v = mesh.points.copy(), np.zeros_like(mesh.points)
    v[:] = [0.1, 0.0, -1.0]
    taken, touched, begin = 0.0, 0, 0.5 * np.sum(mass[:, None] * v**2)
    for _ in range(60):
        f = np.zeros_like(x)
        add_wall(wall, x, v, f, 1.0 / mass, 1e-3)
        v += 1e-3 * f / mass[:, None]
        taken += sum(contact_work(wall.touch, v, 1e-3))
        touched += contact_force(wall.touch)[2] > 0.0
        x += 1e-3 * v
    bottom = np.unique(mesh.side("a.bottom"))
    assert np.all(x[bottom, 2] > -0.004 - 1e-3)
    assert np.all(v[bottom, 2] >= -1e-12)
    # what sticks loses the share s = 0.8 of its sliding in each step: mu times the force is more than that takes
    assert v[bottom, 0] == pytest.approx(0.1 * 0.2**touched, rel=1e-9)
    assert begin - 0.5 * np.sum(mass[:, None] * v**2) == pytest.approx(taken, rel=1e-12)


def test_sides_behind_a_wall_are_refused():
    with pytest.raises(InputError, match=r"overlap of 0\.5 m"):
        prepare_wall(RigidWall("a.bottom", (0.0, 0.0, 0.5), (0.0, 0.0, 1.0)), block("a", (1, 1, 1)))
    with pytest.raises(InputError, match="normal"):
        prepare_wall(RigidWall("a.bottom", (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)), block("a", (1, 1, 1)))


# Limits, at both sides


@pytest.mark.parametrize(("overlap", "refused"), [(0.049, False), (0.06, True)])
def test_overlaps_of_a_tenth_of_a_face_are_let_out_and_deeper_ones_refused(overlap, refused):
    """Faces of half a metre, of a contact and before a wall."""
    mesh, _ = two_plates((2, 2), (2, 2), gap=-overlap)
    wall = RigidWall("b.bottom", (0.0, 0.0, 0.5), (0.0, 0.0, 3.0))
    for make in (lambda: prepare(SurfaceContact("a.top", "b.bottom"), mesh), lambda: prepare_wall(wall, mesh)):
        if refused:
            with pytest.raises(
                InputError, match=rf"overlap of {overlap} m .* at most 0\.1 of the size of a face there, 0\.05 m"
            ):
                make()
        else:
            (found,) = initial_overlaps([("pair", make())], mesh.points)
            assert found.deepest == pytest.approx(overlap, rel=1e-12)
    assert prepare(SurfaceContact("a.top", "b.bottom"), mesh, points=mesh.points).touch.step[0] == 0.0
    assert prepare_wall(wall, mesh, points=mesh.points).touch.nodes.size == 9


def test_an_overlap_before_the_blow_is_told_by_its_deepest_node():
    """A plate that leans before a wall: six of nine nodes stand behind it, three of them 2 cm."""
    mesh = block("a", (2, 2, 1))
    mesh.points[:, 2] += 0.02 * mesh.points[:, 0]
    wall = prepare_wall(RigidWall("a.bottom", (7.0, 7.0, 0.02), (0.0, 0.0, 1.0)), mesh)
    (found,) = initial_overlaps([("lean", wall)], mesh.points)
    assert (found.contact, found.nodes, found.deepest) == ("lean", 6, pytest.approx(0.02, rel=1e-12))
    assert found.place == tuple(mesh.points[found.node])
    assert found.place[0] == 0.0
    np.testing.assert_allclose(np.sort(wall.offset), [-0.02] * 3 + [-0.01] * 3 + [0.0] * 3, atol=1e-15)


@pytest.mark.parametrize(
    ("first", "second", "rate", "steps"),
    # 0.1 of the smaller faces, 1/2 or 1/4 m: steps that have come and two more do not fit
    [((2, 2), (1, 1), 0.012, 3), ((2, 2), (2, 2), 0.02, 1), ((1, 1), (4, 4), 0.006, 3), ((4, 4), (2, 2), 0.009, 1)],
)
def test_faces_are_searched_again_once_the_margin_would_be_used_up(first, second, rate, steps):
    mesh, count = two_plates(first, second, gap=0.4)
    state = prepare(SurfaceContact("a.top", "b.bottom"), mesh)
    assert state.margin == pytest.approx(0.1 / max(*first, *second), rel=1e-14)
    v = np.zeros_like(mesh.points)
    v[count:, 2], v[:count, 1] = -rate / 1e-3, 0.0
    again = [add_contact(state, mesh.points, v, np.zeros_like(v), np.ones(len(v)), 1e-3) for _ in range(steps)]
    assert again == [False] * (steps - 1) + [True]
    assert state.travel[0] == pytest.approx(steps * rate, rel=1e-12)


def test_travel_is_twice_the_largest_offset_from_the_mean_velocity_of_both(rng):
    """Over more than one share of 64 nodes; the mean is that of the means of the two surfaces."""
    mesh, _ = two_plates((9, 9), (3, 3))
    state = prepare(SurfaceContact("a.top", "b.bottom"), mesh)
    v = rng.normal(0.0, 1.0, mesh.points.shape) + np.array([50.0, 0.0, 0.0])
    add_contact(state, mesh.points, v, np.zeros_like(v), np.zeros(len(v)), 1e-5)
    first, second = v[state.touch.nodes[:100]], v[state.touch.nodes[100:]]
    middle = 0.5 * (first.mean(axis=0) + second.mean(axis=0))
    largest = np.linalg.norm(np.concatenate([first, second]) - middle, axis=1).max()
    assert state.travel[0] == pytest.approx(2e-5 * largest, rel=1e-12)


@pytest.mark.parametrize(("height", "near"), [(0.174, 4), (0.176, 0)])
def test_nodes_are_candidates_within_a_quarter_of_a_face_and_the_margin(height, near):
    """Faces of half a metre: 0.125 m and the margin of 0.05 m above a face; four of nine nodes are over the other plate."""
    mesh, _ = two_plates((2, 2), (2, 2), gap=height, shift=(0.62, 0.62))
    state = searched(two_surfaces(SurfaceContact("a.top", "b.bottom"), mesh), mesh.points)
    assert np.count_nonzero(np.diff(state.start)[:9]) == near


def test_a_node_is_inside_an_element_up_to_its_middle():
    """Half of the thickness, or of the width of a face where that is less: plates of 0.3 m and of 0.8 m."""
    low, high = block("a", (2, 2, 1), (1.0, 1.0, 0.3)), block("b", (4, 4, 1), (1.0, 1.0, 0.8), (0.0, 0.0, 0.3))
    state = two_surfaces(SurfaceContact("a.top", "b.bottom"), joined([low, high]))
    np.testing.assert_allclose(state.limit, [0.15] * 4 + [0.125] * 16, rtol=1e-13)


@pytest.mark.parametrize(
    ("change", "allowed"),
    [
        ({"stiffness": 1.0}, True), ({"stiffness": 1.005}, False), ({"stiffness": 0.0}, False),
        ({"friction": 0.0}, True), ({"friction": np.inf}, False), ({"friction": 40.0}, True),
    ],
)  # fmt: skip
def test_numbers_of_a_contact_and_a_wall_have_ranges(change, allowed):
    mesh, _ = two_plates((1, 1), (1, 1))
    makes = [lambda: prepare(SurfaceContact("a.top", "b.bottom", **change), mesh)]
    if "friction" in change:
        makes.append(lambda: prepare_wall(RigidWall("b.bottom", (0.0, 0.0, 0.0), (0.0, 0.0, 1.0), **change), mesh))
    for make in makes:
        if allowed:
            make()
        else:
            with pytest.raises(InputError, match=next(iter(change))):
                make()


@pytest.mark.parametrize(("gap", "tied"), [(0.0495, True), (0.0505, False), (0.09, False)])
def test_nodes_within_a_tenth_of_a_face_can_be_tied_to_it(gap, tied):
    mesh, _ = two_plates((2, 2), (3, 3), gap=gap)
    if tied:
        state = prepare_ties([Tie("b.bottom", "a.top")], mesh)
        np.testing.assert_allclose(
            np.einsum("nk,nkc->nc", state.shape, mesh.points[state.corners]),
            mesh.points[state.nodes] - [0, 0, gap],
            atol=1e-12,
        )
    else:
        with pytest.raises(InputError, match=rf"16 of 16 nodes off a\.top, the furthest {gap:.3g} m.*within 0\.1 of"):
            prepare_ties([Tie("b.bottom", "a.top")], mesh)


def test_work_is_shared_by_threads_in_spans_that_are_not_too_small():
    assert spans(1000, 4, 100) == [(0, 250), (250, 500), (500, 750), (750, 1000)]
    assert spans(1000, 4, 400) == [(0, 500), (500, 1000)]
    assert spans(1000, 4, 501) == spans(1000, 1, 1) == [(0, 1000)]
    assert spans(0, 3, 5) == [(0, 0)]
    assert on_all(None, divmod, [(7, 2), (9, 4)]) == [(3, 1), (2, 1)]
    with ThreadPoolExecutor(2) as pool:
        assert on_all(pool, divmod, [(7, 2), (9, 4), (11, 3)]) == [(3, 1), (2, 1), (3, 2)]
        assert on_all(pool, divmod, [(7, 2)]) == [(3, 1)]


# Depths as the step changes, and friction at both sides of its limit


@pytest.mark.parametrize(("dt", "depth"), [(0.5e-3, 0.5e-3), (2e-3, 1e-3), (0.9e-3, 0.9e-3)])
def test_a_depth_shrinks_with_the_step_and_does_not_grow_with_it(dt, depth):
    """Nodes 1 mm behind a wall, and behind another plate: s m* / dt^2 times what is kept of the depth."""
    mesh, count = two_plates((2, 2), (2, 2), gap=0.0)
    mass = nodal_mass(mesh)
    x, still = mesh.points.copy(), np.zeros_like(mesh.points)
    wall = prepare_wall(RigidWall("b.bottom", (0.0, 0.0, 0.5), (0.0, 0.0, 1.0)), mesh)
    state = prepare(SurfaceContact("a.top", "b.bottom"), mesh)
    state.nodal.known[:] = 1  # as if the nodes had been pressed in
    x[count:, 2] -= 1e-3
    for step, kept in ((1e-3, 1e-3), (dt, depth)):
        f, other = np.zeros_like(x), np.zeros_like(x)
        add_wall(wall, x, still, f, 1.0 / mass, step, 0.7 * step)
        expected = 0.8 * mass[wall.touch.nodes] * kept / (0.7 * step * step)
        assert f[wall.touch.nodes, 2] == pytest.approx(expected, rel=1e-10)
        add_contact(state, x, still, other, 1.0 / mass, step, 0.7 * step)
        # both surfaces close half of it, with half the mass of a node each
        assert other[wall.touch.nodes, 2] == pytest.approx(0.5 * expected, rel=1e-10)
        np.testing.assert_allclose(other.sum(axis=0), 0.0, atol=1e-9)


@pytest.mark.parametrize(("mu", "slides"), [(0.45, True), (0.55, False)])
@pytest.mark.parametrize("axis", [0, 1, 2])
def test_friction_is_the_lesser_of_its_limit_and_of_what_stops_the_sliding(mu, slides, axis):
    """Nodes that come at 2 m/s and slide at 1 m/s along (0.6, 0.8): what stops both is in the ratio of the speeds."""
    mesh, count = two_plates((1, 1), (1, 1), gap=0.0)
    mesh = replace(mesh, points=np.roll(mesh.points, axis, axis=1))
    way, normal = np.roll([0.6, 0.8, 0.0], axis), np.roll([0.0, 0.0, 1.0], axis)
    dt, mass, v = 1e-9, nodal_mass(mesh), np.zeros_like(mesh.points)
    v[count:] = way - 2.0 * normal
    place, f = tuple(0.5 * normal), np.zeros_like(v)
    wall = prepare_wall(RigidWall("b.bottom", place, tuple(3.0 * normal), mu), mesh)
    add_wall(wall, mesh.points, v, f, 1.0 / mass, dt)
    pressing = 0.8 * mass[count:] * 2.0 / dt
    bottom = np.isin(np.arange(count, len(v)), wall.touch.nodes)
    np.testing.assert_allclose(f[count:] @ normal, np.where(bottom, pressing, 0.0), rtol=1e-7)
    rubbing = np.minimum(mu * pressing, 0.8 * mass[count:] * 1.0 / dt)
    assert (rubbing[0] < 0.8 * mass[count] / dt) == slides
    np.testing.assert_allclose(f[count:] @ way, np.where(bottom, -rubbing, 0.0), rtol=1e-7)
    np.testing.assert_allclose(f[count:] @ np.cross(way, normal), 0.0, atol=1e-6)
    state, g = prepare(SurfaceContact("b.bottom", "a.top", mu), mesh), np.zeros_like(v)
    add_contact(state, mesh.points, v, g, 1.0 / mass, dt)
    np.testing.assert_allclose(g[count:], 0.5 * f[count:], rtol=1e-7, atol=1e-6)
    np.testing.assert_allclose(g.sum(axis=0), 0.0, atol=1e-6)
    np.testing.assert_allclose(contact_force(state.touch), g[count:].sum(axis=0), rtol=1e-12, atol=1e-9)


def test_a_node_is_not_looked_at_before_what_is_left_of_its_distance_is_travelled():
    """Plates 0.1 m apart that close in by 3 mm a step: each node stays clear until its distance is used up."""
    mesh, count = two_plates((2, 2), (2, 2), gap=0.1)
    state, v = prepare(SurfaceContact("a.top", "b.bottom"), mesh), np.zeros_like(mesh.points)
    v[count:, 2] = -3.0
    np.testing.assert_allclose(state.nodal.clear, 0.1, rtol=1e-12)  # from the look at overlaps before the blow
    state.nodal.clear[:] = 0.0
    for _ in range(3):
        add_contact(state, mesh.points, v, np.zeros_like(v), np.ones(len(v)), 1e-3)
        # looked at in the first step alone: 3 mm nearer at its end, before which nothing was travelled
        np.testing.assert_allclose(state.nodal.clear, 0.1 - 3e-3, rtol=1e-12)
    assert state.travel[0] == pytest.approx(9e-3, rel=1e-12)
