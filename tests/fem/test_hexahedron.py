"""The hexahedron: gradient (Flanagan & Belytschko 1981), patch test (MacNeal & Harder 1985), rotation, hourglass, step."""

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.linalg import eigh
from scipy.sparse import diags
from scipy.sparse.linalg import splu
from scipy.spatial.transform import Rotation

from strikewave.fem import _history_kernels as history_kernels
from strikewave.fem._contact_kernels import contact_force, contact_work
from strikewave.fem.contact import two_surfaces
from strikewave.fem.engine import build_elements
from strikewave.fem.hexahedron import MODES, critical_steps, cut_slabs, element_masses, mode_slopes, shapes
from strikewave.fem.hexahedron import full_critical_steps as full_critical_steps
from strikewave.fem.mesh import Mesh, joined, volumes
from strikewave.fem.model import Controls, Model, SurfaceContact
from strikewave.fem.recorder import felt_by, pressed
from strikewave.fem.solids import Bilinear, Elastic, von_mises

from .blocks import block
from .driven import CUBE, SORTS, elements, mesh_of, moved, nodal_mass, random_hexahedra, stiffness

SOLID = Elastic(7800.0, 200e9, 0.3)
INNER = np.array(
    [
        [0.249, 0.342, 0.192], [0.826, 0.288, 0.288], [0.850, 0.649, 0.263], [0.273, 0.750, 0.230],
        [0.320, 0.186, 0.643], [0.677, 0.305, 0.683], [0.788, 0.693, 0.644], [0.165, 0.745, 0.702],
    ]
)  # fmt: skip
"""Inner nodes of the solid patch test of MacNeal & Harder 1985, figure 1; the outer ones are a unit cube's."""
FACES = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]


def macneal_harder():
    """Seven elements: one within, one on each of its faces."""
    around = [[*face, *(8 + n for n in face)] for face in FACES]
    return mesh_of(np.concatenate([INNER, CUBE]), np.array([list(range(8)), *around]))


def distorted(rng, counts=(3, 3, 3), share=0.25):
    """A block whose inner nodes are moved by up to a share of the side."""
    mesh = block("body", counts, tuple(map(float, counts)))
    inner = np.all((mesh.points > 0.01) & (mesh.points < np.array(counts) - 0.01), axis=1)
    points = mesh.points + share * inner[:, None] * rng.uniform(-1.0, 1.0, mesh.points.shape)
    return mesh_of(points, mesh.hexahedra)


def inner_nodes(mesh):
    low, high = mesh.points.min(axis=0), mesh.points.max(axis=0)
    return np.all((mesh.points > low + 1e-9) & (mesh.points < high - 1e-9), axis=1)


# Gradient


def nodal_gradients(mesh):
    """Gradient of the volume with respect to the positions of the nodes, (elements, 8, 3)."""
    return np.einsum("mk,emd->ekd", MODES[:6], shapes(mesh.points, mesh.hexahedra).gradients) / 8.0


def test_mean_gradient_of_the_position_is_the_volume(rng):
    """Sum over the modes of g x^T = V I (Euler), at the rounding error."""
    mesh = random_hexahedra(rng, 200)
    found = shapes(mesh.points, mesh.hexahedra)
    product = np.einsum("emi,emj->eij", found.amplitudes[:, :6], found.gradients)
    expected = volumes(mesh.points, mesh.hexahedra)[:, None, None] * np.eye(3)
    np.testing.assert_allclose(product, expected, atol=1e-14)


def test_gradient_is_the_derivative_of_the_exact_volume(rng):
    """The volume is linear in each coordinate of one node, so that a difference is exact; volumes come from the faces."""
    mesh = random_hexahedra(rng, 50)
    found = nodal_gradients(mesh)
    for k, d in itertools.product(range(8), range(3)):
        shifted = mesh.points.reshape(-1, 8, 3).copy()
        shifted[:, k, d] += 1.0
        change = volumes(shifted.reshape(-1, 3), mesh.hexahedra) - volumes(mesh.points, mesh.hexahedra)
        np.testing.assert_allclose(found[:, k, d], change, atol=1e-14)


def test_gradient_is_that_of_flanagan_and_belytschko(rng):
    """Their equation for B_x1, and by the proper rotations of the cube that of the seven other nodes."""

    def first(x, y, z):
        return (
            y[1] * ((z[5] - z[2]) - (z[3] - z[4])) + y[2] * (z[1] - z[3])
            + y[3] * ((z[2] - z[7]) - (z[4] - z[1])) + y[4] * ((z[7] - z[5]) - (z[1] - z[3]))
            + y[5] * (z[4] - z[1]) + y[7] * (z[3] - z[4])
        ) / 12.0  # fmt: skip

    mesh = random_hexahedra(rng, 20)
    found = nodal_gradients(mesh)
    corner = mesh.points.reshape(-1, 8, 3).transpose(2, 1, 0)
    for turn in Rotation.create_group("O"):
        order = [int(np.argmin(np.abs(CUBE - 0.5 - turn.apply(c - 0.5)).sum(axis=1))) for c in CUBE]
        np.testing.assert_allclose(found[:, order[0], 0], first(*corner[:, order]), atol=1e-14)


# Patch test


def strain_and_stress(slope, solid):
    """Strain increment of x -> (I + slope) x, its middle turned by half the rotation, as stress xx yy zz xy yz zx."""
    middle = slope @ np.linalg.inv(np.eye(3) + 0.5 * slope)
    strain, spin = 0.5 * (middle + middle.T), 0.5 * (middle - middle.T)
    strain += 0.5 * (spin @ strain - strain @ spin)
    stress = 2.0 * solid.shear_modulus * strain
    stress += (solid.wave_modulus - 2.0 * solid.shear_modulus) * np.trace(strain) * np.eye(3)
    return stress[[0, 1, 2, 0, 1, 2], [0, 1, 2, 1, 2, 0]]


@pytest.mark.parametrize("sort", SORTS)
def test_patch_of_macneal_and_harder_gives_2000_and_400(sort):
    """Outer nodes follow the published displacement; the inner ones, found by Newton's method, do too.

    E = 1e6, nu = 0.25: normal stresses 2000, shear stresses 400; the finite step of 1e-3 changes them by 1e-3.
    """
    solid, mesh = Elastic(1.0, 1e6, 0.25), macneal_harder()
    slope = 5e-4 * (np.ones((3, 3)) + np.eye(3))
    inner, wanted = inner_nodes(mesh), mesh.points @ slope.T
    free = np.repeat(inner, 3)
    stiff = stiffness(mesh, solid, sort)[free][:, free].toarray()
    assert np.linalg.eigvalsh(stiff)[0] > 1e-3 * np.linalg.eigvalsh(stiff)[-1]
    shift = np.where(inner[:, None], 0.0, wanted)
    for _ in range(30):
        found = elements(mesh, solid, sort)
        force = moved(found, mesh.points, mesh.points + shift)
        shift[inner] += np.linalg.solve(stiff, force[inner].ravel()).reshape(-1, 3)
    np.testing.assert_allclose(shift, wanted, atol=1e-14)
    stress = found.cell_values(7)[0]
    np.testing.assert_allclose(stress, np.tile(strain_and_stress(slope, solid), (7, 1)), rtol=1e-11)
    np.testing.assert_allclose(stress, np.tile([2e3, 2e3, 2e3, 400.0, 400.0, 400.0], (7, 1)), rtol=1.5e-3)


@pytest.mark.parametrize("sort", SORTS)
@pytest.mark.parametrize("size", [1e-2, 0.2])
def test_linear_displacement_of_a_distorted_mesh_gives_constant_stress_and_no_inner_force(rng, sort, size):
    """1e-12: positions of 3 are known to 4e-16, their differences of 1e-2 and more to 1e-13."""
    mesh = distorted(rng)
    slope = size * rng.uniform(-1.0, 1.0, (3, 3))
    found = elements(mesh, SOLID, sort)
    force = moved(found, mesh.points, mesh.points @ (np.eye(3) + slope).T)
    expected = strain_and_stress(slope, SOLID)
    np.testing.assert_allclose(
        found.cell_values(27)[0], np.tile(expected, (27, 1)), atol=1e-12 * np.abs(expected).max()
    )
    assert np.abs(force[inner_nodes(mesh)]).max() < 1e-12 * np.abs(force).max()
    assert found.work()[3] <= 1e-24 * found.work()[0]


def test_the_gradient_at_the_centre_fails_the_patch_test(rng):
    """Why the mean gradient is needed: with that of the centre constant stress leaves forces at the inner nodes."""
    mesh = distorted(rng)
    stress = np.array([[2.0, 0.4, 0.4], [0.4, 2.0, 0.4], [0.4, 0.4, 2.0]])
    found = shapes(mesh.points, mesh.hexahedra)
    jacobian = np.einsum("km,emd->ekd", mode_slopes(np.zeros(3)), found.amplitudes)
    nodal = np.einsum("edk,kn->end", np.linalg.inv(jacobian), mode_slopes(np.zeros(3)) @ MODES / 8.0)
    inner = inner_nodes(mesh)
    for weight in (8.0 * np.linalg.det(jacobian), found.volume):
        force = np.zeros_like(mesh.points)
        np.add.at(force, mesh.hexahedra, np.einsum("ij,enj->eni", stress, nodal) * weight[:, None, None])
        assert np.abs(force[inner]).max() > 1e-3 * np.abs(force).max()


# Rotation


@pytest.mark.verify
@pytest.mark.parametrize("sort", SORTS)
@pytest.mark.parametrize("steps", [3, 12, 400])
def test_a_whole_turn_brings_stress_and_forces_back(rng, sort, steps):
    """Steps of 120, 30 and 0.9 degrees: Hughes & Winget's rotation is exact for any; no work, hourglass energy kept."""
    mesh, solid = distorted(rng), Bilinear(7800.0, 200e9, 0.3, 400e6, 10e9, 0.5)
    found = elements(mesh, solid, sort)
    x = mesh.points + 5e-3 * rng.uniform(-1.0, 1.0, mesh.points.shape)
    force, first = moved(found, mesh.points, x), found.cell_values(27)
    work = found.work()
    assert first[1].max() > 0.0
    turn = Rotation.from_rotvec(2.0 * np.pi / steps * np.array([2.0, 3.0, 6.0]) / 7.0)
    for k in range(steps):
        before, x = x, turn.apply(x)
        now = moved(found, before, x)
        if k == steps // 3:
            turned = Rotation.from_rotvec((k + 1) * turn.as_rotvec())
            np.testing.assert_allclose(turned.inv().apply(now), force, atol=1e-10 * np.abs(force).max())
    stress, strain = found.cell_values(27)
    np.testing.assert_allclose(stress, first[0], atol=1e-10 * np.abs(first[0]).max())
    np.testing.assert_allclose(strain, first[1], rtol=1e-9)
    np.testing.assert_allclose(found.work(), work, atol=1e-10 * work[0])
    assert found.work()[3] == pytest.approx(work[3], rel=1e-12)


@pytest.mark.parametrize("sort", SORTS)
def test_forces_have_no_sum_and_no_moment(rng, sort):
    mesh = random_hexahedra(rng, 40)
    x = mesh.points + 0.1 * rng.uniform(-1.0, 1.0, mesh.points.shape)
    force = moved(elements(mesh, SOLID, sort, viscous=(0.06, 1.5)), mesh.points, x, 1e-4).reshape(-1, 8, 3)
    moment = np.cross(x.reshape(-1, 8, 3), force)
    scale = np.abs(force).max()
    assert np.abs(force.sum(axis=1)).max() < 1e-13 * scale
    assert np.abs(moment.sum(axis=1)).max() < 1e-13 * scale


@pytest.mark.parametrize("sort", SORTS)
def test_back_stress_turns_with_the_solid(rng, sort):
    """Prestrained beyond yield, turned by a right angle and strained back: as without the turn, only turned."""
    mesh, solid = random_hexahedra(rng, 8), Bilinear(7800.0, 200e9, 0.3, 400e6, 20e9, 1.0)
    stretched = mesh.points * [1.02, 0.99, 0.99]
    turn = Rotation.from_rotvec([0.0, 0.0, 0.5 * np.pi])
    still, turned = elements(mesh, solid, sort), elements(mesh, solid, sort)
    for found in (still, turned):
        moved(found, mesh.points, stretched)
    moved(turned, stretched, turn.apply(stretched))
    force = moved(still, stretched, mesh.points)
    found = moved(turned, turn.apply(stretched), turn.apply(mesh.points))
    np.testing.assert_allclose(turn.inv().apply(found), force, atol=1e-10 * np.abs(force).max())
    np.testing.assert_allclose(turned.cell_values(8)[1], still.cell_values(8)[1], rtol=1e-10)
    assert still.cell_values(8)[1].min() > 0.02


# Work


@pytest.mark.parametrize("sort", SORTS)
@pytest.mark.parametrize("viscous", [(0.0, 0.0), (0.06, 1.5)], ids=["", "viscous"])
@pytest.mark.parametrize("shear", [0.0, 0.3], ids=["", "spinning"])
def test_works_are_what_the_forces_do_by_the_second_order(rng, sort, viscous, shear):
    """Distorted elements stretched by 0.2 along three axes, some sheared too: half the forces before and after each step.

    Elastic and plastic work and that of the bulk viscosity; the error falls by four as the step halves.
    """
    mesh, solid = random_hexahedra(rng, 20), Bilinear(1.0, 1.0, 0.3, 0.05, 0.1, 0.5)
    reach, duration = mesh.points @ (np.diag([0.2, -0.14, 0.08]) + shear * np.eye(3, k=1)), 2.0
    errors = []
    for steps in (50, 100, 200):
        found, x, force, done = elements(mesh, solid, sort, viscous=viscous), mesh.points, 0.0, 0.0
        for k in range(steps):
            after = mesh.points + reach * np.sin(2.5 * (k + 1) / steps)
            now = moved(found, x, after, duration / steps)
            done -= 0.5 * np.sum((force + now) * (after - x))
            x, force = after, now
        internal, plastic, viscosity, _ = found.work()
        assert (viscosity > 0.01 * internal) == (viscous[0] > 0.0)
        assert plastic > 0.1 * internal
        errors.append(abs(internal + viscosity - done) / done)
    assert errors[-1] < 1e-5
    np.testing.assert_allclose(np.log2(np.divide(errors[:-1], errors[1:])), 2.0, atol=0.04)


# Vibration


def lame_frequency(count, sort, hourglass):
    """Frequency of a free square plate of count by count by one cubes in Lame's mode, over the exact one.

    Inverse iteration from the exact mode; the next mode of its kind lies a fifth above.
    """
    mesh = block("body", (count, count, 1), (1.0, 1.0, 1.0 / count))
    a, b = np.pi * mesh.points[:, 0], np.pi * mesh.points[:, 1]
    mode = np.stack([np.cos(a) * np.sin(b), -np.sin(a) * np.cos(b), 0.0 * a], axis=1).ravel()
    square = 2.0 * np.pi**2 * SOLID.shear_modulus / SOLID.density
    stiff, mass = stiffness(mesh, SOLID, sort, hourglass), diags(np.repeat(nodal_mass(mesh, SOLID), 3))
    inverse = splu((stiff - 0.98 * square * mass).tocsc())
    for _ in range(8):
        mode = inverse.solve(mass @ mode)
    return np.sqrt((mode @ stiff @ mode) / (mode @ mass @ mode) / square)


@pytest.mark.verify
@pytest.mark.parametrize(("sort", "hourglass"), [("one point", 0.05), ("one point", 0.17), ("full", 0.0)])
def test_free_plate_vibrates_in_lames_mode_by_the_second_order(sort, hourglass):
    """u = (cos a sin b, -sin a cos b, 0), a = pi x / L, b = pi y / L, leaves all sides free, of a cube or a plate.

    omega = sqrt(2) pi c_s / L for any Poisson's ratio.
    """
    errors = np.array([lame_frequency(count, sort, hourglass) - 1.0 for count in (12, 24, 48)])
    assert abs(errors[-1]) < 1e-3
    np.testing.assert_allclose(np.log2(errors[:-1] / errors[1:]), 2.0, atol=0.25)


# Hourglass


@pytest.mark.parametrize("solid", [SOLID, Bilinear(7800.0, 200e9, 0.3, 5e9)], ids=["elastic", "yielding"])
def test_hourglass_force_is_the_derivative_of_its_energy(rng, solid):
    """Forces with less those without; 1e-7 is the error of the central difference where the force is bounded."""
    mesh = random_hexahedra(rng, 6)
    x = mesh.points + 0.05 * rng.uniform(-1.0, 1.0, mesh.points.shape)

    def energy(points):
        found = elements(mesh, solid, hourglass=0.1)
        moved(found, mesh.points, points)
        return found.work()[3]

    force = moved(elements(mesh, solid, hourglass=0.1), mesh.points, x)
    force -= moved(elements(mesh, solid, hourglass=0.0), mesh.points, x)
    scale = np.abs(force).max()
    assert energy(x) > 0.0
    for node, d in itertools.product(range(48), range(3)):
        shift = np.zeros_like(x)
        shift[node, d] = 1e-5
        slope = (energy(x + shift) - energy(x - shift)) / 2e-5
        assert force[node, d] == pytest.approx(-slope, abs=1e-7 * scale)


def test_hourglass_force_of_a_yielding_cube_is_that_of_a_plastic_hinge():
    """Full plastic moment sigma_y h^3 / 4 by the rate of curvature of the mode, 2 / h^2 each side: sigma_y h^2 at most.

    Far beyond yield the mode's force is that; far below it is 8 k q with k = E h / 6.
    """
    solid, side = Bilinear(7800.0, 200e9, 0.0, 400e6), 2e-3
    mesh = mesh_of(side * CUBE, np.arange(8)[None])
    mode = (2.0 * CUBE[:, 0] - 1.0) * (2.0 * CUBE[:, 2] - 1.0)
    reach = 0.75 * solid.yield_strength / solid.youngs_modulus * side
    for share, expected in ((1e-3, 8.0 * 200e9 * side / 6.0 * 1e-3 * reach), (30.0, 400e6 * side**2)):
        shift = np.zeros((8, 3))
        shift[:, 0] = share * reach * mode
        force = moved(elements(mesh, solid, hourglass=2.0 / 9.0), mesh.points, mesh.points + shift)
        assert -(force[:, 0] @ mode) == pytest.approx(expected, rel=1e-3)


def test_one_element_across_bends_as_a_beam_with_hourglass_2_9():
    """k = E h / 6, for a cube and nu = 0 kappa = 2/9, gives the moment E I / curvature of each element its exact value.

    Tip deflection of a cantilever of cubes: sum of P (L - x)^2 h / (E I) over the middles x, and P L / (G A).
    """
    solid, n = Elastic(1.0, 1e6, 0.0), 12
    mesh = block("body", (n, 1, 1), (float(n), 1.0, 1.0))
    free = np.repeat(mesh.points[:, 0] > 0.5, 3)
    tip = mesh.points[:, 0] > n - 0.5
    load = np.zeros_like(mesh.points)
    load[tip, 2] = 0.25
    stiff = stiffness(mesh, solid, hourglass=2.0 / 9.0)[free][:, free].toarray()
    shift = np.zeros(3 * len(mesh.points))
    shift[free] = np.linalg.solve(stiff, load.ravel()[free])
    middle = np.arange(n) + 0.5
    expected = np.sum((n - middle) ** 2) / (1e6 / 12.0) + n / 0.5e6
    np.testing.assert_allclose(shift.reshape(-1, 3)[tip, 2], expected, rtol=1e-6)


# Viscosity and time step


@pytest.mark.parametrize("sort", SORTS)
@pytest.mark.parametrize("rate", [-2e3, 2e3])
def test_bulk_viscosity_of_a_cube_is_its_closed_form(sort, rate):
    """A cube of 2 mm at a rate of strain: pressure -rho l (q1 c - q2 l min(r, 0)) r, at 1e-9.

    Its work is that of the mean of the pressures before and after: from rest half of the last one's.
    """
    side, step = 2e-3, 1e-8
    mesh = mesh_of(side * CUBE, np.arange(8)[None])
    after = (1.0 + rate * step) * mesh.points
    forces = [
        moved(elements(mesh, SOLID, sort, viscous=v), mesh.points, after, step) for v in ((0.06, 1.5), (0.0, 0.0))
    ]
    found = elements(mesh, SOLID, sort, viscous=(0.06, 1.5))
    moved(found, mesh.points, after, step)
    now = side * (1.0 + rate * step)
    r = 3.0 * rate / (1.0 + 0.5 * rate * step)
    density = 7800.0 * (side / now) ** 3
    pressure = -density * now * (0.06 * SOLID.wave_speed - 1.5 * now * min(r, 0.0)) * r
    swept = r * step * now**3 * (1.0 - 0.5 * r * step)
    np.testing.assert_allclose(forces[0] - forces[1], 0.25 * now**2 * pressure * (2.0 * CUBE - 1.0), rtol=1e-9)
    assert found.work()[2] == pytest.approx(-0.5 * pressure * swept, rel=1e-9)
    assert found.work()[2] > 0.0


def fastest(mesh, solid, sort, hourglass=0.0):
    mass = np.repeat(nodal_mass(mesh, solid), 3)
    stiff = stiffness(mesh, solid, sort, hourglass).toarray()
    return float(np.sqrt(eigh(0.5 * (stiff + stiff.T), np.diag(mass), eigvals_only=True)[-1]))


def bound(mesh, solid, sort, viscosity=0.0):
    mass = element_masses(mesh, {"body": solid})
    if sort == "full":
        return full_critical_steps(mesh.points, mesh.hexahedra, mass, solid, viscosity).min()
    return critical_steps(shapes(mesh.points, mesh.hexahedra), mass, solid, viscosity).min()


@pytest.mark.parametrize("sort", SORTS)
def test_critical_step_of_a_cube_is_side_over_wave_speed(sort):
    """nu = 0: the bound 2/omega is met by the lone cube, whose fastest vibration is 2 c / h."""
    solid, mesh = Elastic(7800.0, 200e9, 0.0), mesh_of(2e-3 * CUBE, np.arange(8)[None])
    assert bound(mesh, solid, sort) == pytest.approx(2e-3 / solid.wave_speed, rel=1e-12)
    assert fastest(mesh, solid, sort) == pytest.approx(2.0 * solid.wave_speed / 2e-3, rel=1e-8)


@pytest.mark.verify
@pytest.mark.parametrize("sort", SORTS)
@given(seed=st.integers(0, 10**6), share=st.floats(0.0, 0.3), ratio=st.floats(0.0, 0.49), flat=st.floats(0.1, 1.0))
def test_no_mesh_vibrates_faster_than_the_bound(sort, seed, share, ratio, flat):
    """Meshes of eight distorted, flattened elements; the largest hourglass stiffness that is allowed stays below it."""
    rng = np.random.default_rng(seed)
    mesh = distorted(rng, (2, 2, 2), share)
    mesh = mesh_of(
        mesh.points * [1.0, 1.0, flat] + 0.3 * share * rng.uniform(-flat, flat, mesh.points.shape), mesh.hexahedra
    )
    solid = Elastic(1.0, 1.0, ratio)
    found = fastest(mesh, solid, sort, 0.5) * bound(mesh, solid, sort) / 2.0
    assert 0.3 < found <= 1.0 + 1e-7


@pytest.mark.parametrize("warp", [0.0, 1.0, 3.0])
def test_saddle_is_faster_than_the_cube_by_the_root_of_one_and_a_ninth_of_its_warp(warp):
    """z = zeta + w xi eta, nu = 0: sum g g^T = 64 diag(1 + w^2 / 9, 1 + w^2 / 9, 1), and the bound 1 + 2 w^2 / 9."""
    solid = Elastic(1.0, 1.0, 0.0)
    points = 2.0 * CUBE - 1.0
    points[:, 2] += warp * points[:, 0] * points[:, 1]
    mesh = mesh_of(points, np.arange(8)[None])
    assert fastest(mesh, solid, "one point") == pytest.approx(np.sqrt(1.0 + warp**2 / 9.0), rel=1e-6)
    assert bound(mesh, solid, "one point") == pytest.approx(2.0 / np.sqrt(1.0 + 2.0 * warp**2 / 9.0), rel=1e-12)


@pytest.mark.verify
@pytest.mark.parametrize("sort", SORTS)
@given(seed=st.integers(0, 10**6))
def test_kernels_and_numpy_have_one_critical_step_for_any_order_of_the_nodes(sort, seed):
    """Strongly distorted elements, numbered in the 24 ways of the cube."""
    points = random_hexahedra(np.random.default_rng(seed), 1, 0.3).points
    expected = bound(mesh_of(points, np.arange(8)[None]), SOLID, sort, 0.06)
    for turn in Rotation.create_group("O"):
        order = [int(np.argmin(np.abs(CUBE - 0.5 - turn.apply(c - 0.5)).sum(axis=1))) for c in CUBE]
        mesh = mesh_of(points, np.array([order]))
        step = elements(mesh, SOLID, sort, viscous=(0.06, 0.0)).add_forces(
            points, np.zeros_like(points), np.zeros_like(points), 1.0
        )
        assert step == pytest.approx(expected, rel=1e-12)
        assert bound(mesh, SOLID, sort, 0.06) == pytest.approx(expected, rel=1e-12)


def pushed_in(points):
    points[6] = 0.2, 0.2, 0.1


def mirrored(points):
    points[4:, 2] *= -0.3


def unknown(points):
    points[6, 1] = np.nan


@pytest.mark.parametrize(
    ("spoil", "sorts"),
    [(mirrored, SORTS), (unknown, SORTS), (pushed_in, ["full"])],
    ids=lambda each: getattr(each, "__name__", ""),
)
@pytest.mark.parametrize("place", [0, 35])
def test_critical_step_is_zero_where_an_element_is_inside_out_or_not_finite(spoil, sorts, place):
    """One of 40 cubes, in its first chunk or its second; full integration sees a single point with J <= 0.

    At rest, and so fast that the bulk viscosity alone would set the step.
    """
    points = np.tile(CUBE, (40, 1))
    mesh = mesh_of(points, np.arange(320).reshape(40, 8))
    after = points.copy()
    spoil(after[8 * place : 8 * place + 8])
    for sort in sorts:
        for viscous, rate in (((0.0, 0.0), 0.0), ((0.06, 1.5), -1e6)):
            found = elements(mesh, SOLID, sort, viscous=viscous)
            assert found.add_forces(after, rate * after, np.zeros_like(points), 1e-9) == 0.0


@pytest.mark.parametrize("sort", SORTS)
@pytest.mark.parametrize("ratio", [0.0, 0.3])
@pytest.mark.parametrize("linear", [0.0, 0.06, 0.5])
def test_step_with_viscosity_is_stable_and_for_a_cube_without_lateral_strain_the_largest(sort, ratio, linear):
    """A breathing cube by central differences with lagged viscosity: it stays small at 0.999 of the step, not at 1.001.

    What grows there comes back, as the step of a stretched cube is another: the largest motion tells.
    """
    solid, mesh = Elastic(1.0, 1.0, ratio), mesh_of(CUBE, np.arange(8)[None])
    step, mass = bound(mesh, solid, sort, linear), 1.0 / 8.0

    def largest_in(count, share):
        found = elements(mesh, solid, sort, viscous=(linear, 0.0))
        x, v, largest = mesh.points.copy(), 1e-9 * (CUBE - 0.5), 0.0
        for _ in range(count):
            after = x + share * step * v
            v = v + share * step * moved(found, x, after, share * step) / mass
            x, largest = after, max(largest, float(np.abs(v).max()))
        return largest

    assert largest_in(4000, 0.999) < 3e-8
    if ratio == 0.0:
        assert largest_in(4000, 1.001) > 1e-7


@pytest.mark.parametrize("sort", SORTS)
def test_kernels_and_numpy_have_one_critical_step_of_an_element_numbered_in_any_way(sort):
    """A strongly distorted one, at rest and with linear viscosity: the bound is written twice, in kernels and numpy."""
    points, turns = random_hexahedra(np.random.default_rng(11), 1, 0.3).points, Rotation.create_group("O")
    for turn in [turns[k] for k in (0, 5, 10, 17)]:
        order = [int(np.argmin(np.abs(CUBE - 0.5 - turn.apply(c - 0.5)).sum(axis=1))) for c in CUBE]
        mesh, still = mesh_of(points, np.array([order])), np.zeros_like(points)
        for viscosity in (0.0, 0.06, 0.5):
            found = elements(mesh, SOLID, sort, viscous=(viscosity, 0.0))
            step = found.add_forces(points, still, still.copy(), 1.0)
            assert step == pytest.approx(bound(mesh, SOLID, sort, viscosity), rel=1e-12)


# Where elements stand, and what is summed of them


def test_chunks_are_cut_into_slabs_by_part_and_slabs_without_common_nodes_go_side_by_side():
    """16 chunks a slab at least, 32 slabs at most; each chunk shares a node with the next."""
    nodes = np.arange(640)[:, None] + np.arange(2)
    slabs, groups = cut_slabs(nodes[:40], np.repeat([0, 1], [25, 15]))
    assert slabs.tolist() == [[0, 16], [16, 25], [25, 32], [32, 40]]
    assert [group.tolist() for group in groups] == [[0, 2], [1, 3]]
    slabs, groups = cut_slabs(nodes, np.zeros(640, int))
    assert (np.diff(slabs) == 20).all()
    assert len(slabs) == 32
    assert [group.tolist() for group in groups] == [list(range(0, 32, 2)), list(range(1, 32, 2))]


def strained(rng, sort):
    """30 elements, more than a chunk, each strained beyond yield by itself."""
    mesh, solid = random_hexahedra(rng, 30), Bilinear(7800.0, 200e9, 0.3, 300e6, 20e9, 0.5)
    found = elements(mesh, solid, sort, viscous=(0.06, 1.5))
    moved(found, mesh.points, mesh.points + 0.02 * rng.uniform(-1.0, 1.0, mesh.points.shape), 1e-5)
    return found


@pytest.mark.parametrize("sort", SORTS)
def test_stress_of_chosen_elements_stands_where_it_is_said(rng, sort):
    found = strained(rng, sort)
    chosen = np.array([3, 25, 7, 29, 0])
    places = found.stress_places(np.append(chosen, 31))  # the last is of another kind
    assert places.shape == (5, found.points)
    stress = found.blocks.state[places[:, :, None] + np.array(history_kernels.STRESS)].mean(axis=1)
    np.testing.assert_array_equal(stress, found.cell_values(32)[0][chosen])
    assert (found.cell_values(32)[0][30:] == 0.0).all()


@pytest.mark.parametrize("sort", SORTS)
def test_the_largest_of_a_chunk_are_those_of_its_elements(rng, sort):
    found = strained(rng, sort)
    stress, strain = found.cell_values(30)
    for chunk, own in enumerate((slice(0, 24), slice(24, 30))):
        # the same sums, rounded once less where products and sums are fused
        expected = [von_mises(stress[own]).max() ** 2, strain[own].max()]
        np.testing.assert_allclose(found.peaks()[chunk], expected, rtol=1e-14)


@pytest.mark.parametrize("sort", SORTS)
def test_stress_and_back_stress_of_each_element_turn_by_its_own_rotation(rng, sort):
    found = strained(rng, sort)
    turns = Rotation.random(30, random_state=5).as_matrix()

    def tensors(first):
        rows = found.blocks.state.reshape(-1, found.points, 15, 24)[:, :, first : first + 6]
        by_lane = np.moveaxis(rows, 3, 1)[found.blocks.filled[:, None] > np.arange(24)]
        return by_lane[..., [[0, 3, 5], [3, 1, 4], [5, 4, 2]]]

    before, strain = [tensors(0), tensors(9)], found.cell_values(30)[1]
    found.turn(turns)
    for old, first in zip(before, (0, 9), strict=True):
        for element, turn in enumerate(turns):
            for tensor, now in zip(old[element], tensors(first)[element], strict=True):
                np.testing.assert_allclose(now, turn @ tensor @ turn.T, atol=1e-13 * np.abs(old).max())
        assert np.abs(old).max() > 1e6
    np.testing.assert_array_equal(found.cell_values(30)[1], strain)


@pytest.mark.parametrize("sort", SORTS)
def test_a_balance_begins_with_the_energy_that_is_stored(rng, sort):
    found = strained(rng, sort)
    internal, plastic, viscous, hourglass = found.work()
    assert min(plastic, abs(viscous)) > 0.0
    found.begin_balance()
    assert found.work().tolist() == [pytest.approx(internal - plastic, rel=1e-13), 0.0, 0.0, hourglass]


@pytest.mark.parametrize("small", ["a", "b"])
def test_elements_of_both_kinds_add_up_and_the_smallest_sets_the_step(rng, small):
    """Part a of 30 elements of one point, part b of five of eight; one of them half as large."""
    mesh = random_hexahedra(rng, 35)
    owner = np.repeat([0, 1], [30, 5]).astype(np.int32)
    points = mesh.points * np.where(np.repeat(owner == "ab".index(small), 8), 0.5, 1.0)[:, None]
    mesh = Mesh(points, mesh.hexahedra, owner, ("a", "b"))
    solids = {"a": Bilinear(7800.0, 200e9, 0.3, 300e6), "b": Bilinear(8900.0, 120e9, 0.34, 90e6)}
    mass = element_masses(mesh, solids)
    np.testing.assert_allclose(mass, np.where(owner, 8900.0, 7800.0) * volumes(points, mesh.hexahedra), rtol=1e-14)
    model = Model(mesh, solids, Controls(1.0, full=("b",)))
    after = points + 0.01 * rng.uniform(-1.0, 1.0, points.shape)
    both, kinds = build_elements(model, ("a", "b"), mass, None), build_elements(model, ("a", "b"), mass, None).kinds
    force, alone = np.zeros_like(points), np.zeros_like(points)
    step = both.add_forces(after, (after - points) / 1e-5, force, 1e-5)
    steps = [kind.add_forces(after, (after - points) / 1e-5, alone, 1e-5) for kind in kinds]
    assert step == min(steps) == steps["ab".index(small)]
    np.testing.assert_array_equal(force, alone)
    np.testing.assert_allclose(both.work(), kinds[0].work() + kinds[1].work(), rtol=1e-14)
    plastic = both.plastic_work(mesh.names)
    assert plastic == {"a": pytest.approx(kinds[0].work()[1]), "b": pytest.approx(kinds[1].work()[1])}
    assert plastic["a"] != plastic["b"]
    for values, own in zip(
        both.cell_values(35), zip(*(kind.cell_values(35) for kind in kinds), strict=True), strict=True
    ):
        np.testing.assert_array_equal(values[:30], own[0][:30])
        np.testing.assert_array_equal(values[30:], own[1][30:])


def test_what_shares_of_a_contact_feel_is_summed_by_surface(rng):
    """Two surfaces of 81 and 64 nodes in three shares of 64 nodes at most, every third under pressure."""
    mesh = joined([block("a", (8, 8, 1)), block("b", (7, 7, 1), origin=(0.0, 0.0, 1.0))])
    touch = two_surfaces(SurfaceContact("a.top", "b.bottom"), mesh).touch
    for array in (touch.area, touch.velocity, touch.normal, touch.friction):
        array[:] = rng.uniform(0.5, 2.0, array.shape)
    under = np.arange(145) % 3 == 0
    touch.normal[~under] = 0.0
    felt, force, first = felt_by(touch), touch.normal + touch.friction, np.arange(145) < 81
    assert felt.shape == (3, 10)
    np.testing.assert_allclose(felt[:, :3].sum(axis=0), force[first].sum(axis=0), rtol=1e-13)
    np.testing.assert_allclose(contact_force(touch), force[first].sum(axis=0), rtol=1e-13)
    np.testing.assert_allclose(felt[:, 3].sum(), np.sum(force * touch.velocity), rtol=1e-13)
    shares = []
    for place, own in ((4, first), (7, ~first)):
        area, pressing = touch.area[own].sum(), touch.area[own & under].sum()
        np.testing.assert_allclose(felt[:, place : place + 2].sum(axis=0), [area, pressing], rtol=1e-13)
        largest = touch.area[own & under].max()
        assert felt[:, place + 2].max() == largest
        shares.append([pressing / area, pressing / largest])
    np.testing.assert_allclose(pressed(felt, 2), shares, rtol=1e-13)
    np.testing.assert_allclose(pressed(felt, 1), shares[:1], rtol=1e-13)
    after = rng.uniform(-1.0, 1.0, mesh.points.shape)
    middle = 0.25 * (touch.velocity + after[touch.nodes])  # half the mean, for a step of half a second
    expected = [-np.sum(touch.normal * middle), -np.sum(touch.friction * middle)]
    np.testing.assert_allclose(contact_work(touch, after, 0.5), expected, rtol=1e-13)
