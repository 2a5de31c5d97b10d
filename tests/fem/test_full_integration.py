"""The fully integrated hexahedron: mean dilatation, no locking, waves, energy; patch test etc. in test_hexahedron."""

import numpy as np
import pytest
from scipy import sparse
from scipy.linalg import eigh
from scipy.sparse.linalg import spsolve

from strikewave.fem.hexahedron import MODES, POINTS, mode_slopes, shapes
from strikewave.fem.mesh import joined
from strikewave.fem.model import Controls, CutSection, Model, Pressure, RigidWall, Tie, TimeCurve
from strikewave.fem.shapes import block as box
from strikewave.fem.shapes import moved as shifted
from strikewave.fem.solids import Bilinear, Elastic, JohnsonCook, pressure
from strikewave.fem.solve import Checkpoint, RunOptions, solve

from .blocks import block
from .driven import SORTS, elements, mesh_of, moved, nodal_mass, random_hexahedra, stiffness

SOLID = Elastic(7800.0, 200e9, 0.3)


def points_of(mesh):
    """Jacobian (elements, 8) and gradients of the nodes (elements, 8, 3, 8) at the Gauss points, by inversion."""
    found = shapes(mesh.points, mesh.hexahedra).amplitudes
    slopes = np.array([mode_slopes(place) for place in POINTS])
    jacobian = np.einsum("pkm,emd->epkd", slopes, found)
    nodal = np.einsum("epdk,pkm,mn->epdn", np.linalg.inv(jacobian), slopes, MODES / 8.0)
    return np.linalg.det(jacobian), nodal


def test_mean_of_the_points_gradients_is_that_of_the_one_point_element(rng):
    """Two points a direction integrate Jacobian and cofactors exactly."""
    mesh = random_hexahedra(rng, 50)
    weight, nodal = points_of(mesh)
    found = shapes(mesh.points, mesh.hexahedra)
    np.testing.assert_allclose(weight.sum(axis=1), found.volume, rtol=1e-13)
    mean = np.einsum("ep,epdn->end", weight, nodal)
    np.testing.assert_allclose(mean, np.einsum("mk,emd->ekd", MODES[:6], found.gradients) / 8.0, atol=1e-14)


def test_pressure_is_that_of_the_one_point_element_for_any_motion(rng):
    mesh = random_hexahedra(rng, 40)
    after = mesh.points + 0.1 * rng.uniform(-1.0, 1.0, mesh.points.shape)
    stress = []
    for sort in SORTS:
        found = elements(mesh, SOLID, sort)
        moved(found, mesh.points, after)
        stress.append(found.cell_values(40)[0])
    np.testing.assert_allclose(pressure(stress[1]), pressure(stress[0]), rtol=1e-12, atol=1e-3)
    assert np.abs(stress[1] - stress[0]).max() > 1e-2 * np.abs(stress[0]).max()


def test_stiffness_is_that_of_mean_dilatation_by_numpy(rng):
    """K = sum of w B^T C B, B with the mean volume change (Hughes 1980); differences of forces are exact to 1e-8."""
    mesh = random_hexahedra(rng, 5)
    for own, expected in zip(
        per_element(stiffness(mesh, SOLID, "full")), assembled(mesh, SOLID, mean=True), strict=True
    ):
        np.testing.assert_allclose(own, expected, atol=1e-7 * np.abs(expected).max())


def per_element(matrix):
    return [matrix[k : k + 24, k : k + 24].toarray() for k in range(0, matrix.shape[0], 24)]


def assembled(mesh, solid, mean):
    """Stiffness of each element by plain Gauss integration, or with mean dilatation, (elements, 24, 24)."""
    weight, nodal = points_of(mesh)
    share = np.einsum("ep,epdn->edn", weight, nodal) / weight.sum(axis=1)[:, None, None]
    strain = np.zeros((*nodal.shape[:2], 6, 8, 3))
    for row, (a, b) in enumerate(((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0))):
        strain[:, :, row, :, a] += 0.5 * nodal[:, :, b]
        strain[:, :, row, :, b] += 0.5 * nodal[:, :, a]
    if mean:
        off = (share[:, None] - nodal).transpose(0, 1, 3, 2) / 3.0
        strain[:, :, :3] += off[:, :, None]
    strain = strain.reshape(*nodal.shape[:2], 6, 24)
    law = 2.0 * solid.shear_modulus * np.diag([1.0, 1, 1, 2, 2, 2])
    law[:3, :3] += solid.wave_modulus - 2.0 * solid.shear_modulus
    return np.einsum("ep,epai,ab,epbj->eij", weight, strain, law, strain)


# Bending


def bending(across, ratio, plain=False):
    """Deflection of a beam of length 4 and height 1 in plane strain under a moment at its end, over M L^2 / (2 E' I)."""
    solid, side = Elastic(1.0, 1e6, ratio), 1.0 / across
    mesh = block("body", (4 * across, 1, across), (4.0, side, 1.0), (0.0, 0.0, -0.5))
    if plain:
        own = assembled(mesh, solid, mean=False)
        freedom = (3 * mesh.hexahedra[:, :, None] + np.arange(3)).reshape(-1, 24)
        rows, columns = np.repeat(freedom, 24, axis=1).ravel(), np.tile(freedom, (1, 24)).ravel()
        stiff = sparse.csr_matrix((own.ravel(), (rows, columns)), 2 * (3 * len(mesh.points),))
    else:
        stiff = stiffness(mesh, solid, "full")
    x, z = mesh.points[:, 0], mesh.points[:, 2]
    root, tip = x < 1e-9, x > 4.0 - 1e-9
    free = np.stack([~root, np.zeros(len(x), bool), ~root | (abs(z) > 1e-9)], axis=1).ravel()
    load = np.zeros_like(mesh.points)
    edge = abs(z) > 0.5 - 1e-9
    load[tip, 0] = (0.5 * side**2 * np.where(edge, 0.5 * z - np.sign(z) * side / 6.0, z))[tip]
    shift = np.zeros(3 * len(x))
    shift[free] = spsolve(stiff[free][:, free].tocsc(), load.ravel()[free])
    moment = np.sum(load[:, 0] * z)
    assert moment == pytest.approx(side / 12.0, rel=1e-12)
    return -shift.reshape(-1, 3)[tip & (abs(z) < 1e-9), 2].mean() / (4.0**2 / 2.0 / (1e6 / (1.0 - ratio**2)))


@pytest.mark.parametrize("ratio", [0.0, 0.3, 0.49, 0.4999])
def test_beam_in_pure_bending_converges_by_the_second_order_and_does_not_lock(ratio):
    """A moment at the end has an exact solution; the error falls by four as the element is halved, for any nu."""
    errors = np.array([bending(across, ratio) - 1.0 for across in (2, 4, 8)])
    assert abs(errors[-1]) < 0.012
    np.testing.assert_allclose(np.log2(errors[:-1] / errors[1:]), 2.0, atol=0.25)


def test_the_plain_element_locks():
    """What the mean volume change is for: at nu = 0.4999 plain integration bends by less than a tenth."""
    assert bending(4, 0.4999, plain=True) < 0.1


# Motion


def test_column_vibrates_as_the_chain_of_its_planes():
    """Sides held: omega_1 = 2 c / h sin(pi / (2 n)), c the speed of a plane pressure wave."""
    n, side = 10, 2e-3
    mesh = block("body", (1, 1, n), (side, side, n * side))
    along = np.zeros((len(mesh.points), 3, n + 1))
    plane = np.rint(mesh.points[:, 2] / side).astype(int)
    along[np.arange(len(plane)), 2, plane] = 1.0
    along = along.reshape(-1, n + 1)
    stiff = along.T @ (stiffness(mesh, SOLID, "full") @ along)
    mass = along.T @ (np.repeat(nodal_mass(mesh, SOLID), 3)[:, None] * along)
    squares = eigh(0.5 * (stiff + stiff.T), mass, eigvals_only=True)
    expected = 2.0 * SOLID.wave_speed / side * np.sin(np.pi * np.arange(1, n + 1) / (2 * n))
    np.testing.assert_allclose(np.sqrt(squares[1:]), expected, rtol=1e-6)


@pytest.mark.parametrize("sort", SORTS)
def test_free_block_keeps_momentum_and_its_energy_by_the_second_order(rng, sort):
    """A distorted block with random velocities, no viscosity: energy error falls by four as the step halves."""
    mesh = block("body", (2, 2, 2), (2.0, 2.0, 2.0))
    mesh = mesh_of(mesh.points + 0.1 * rng.uniform(-1, 1, mesh.points.shape), mesh.hexahedra)
    solid = Elastic(1.0, 1.0, 0.3)
    mass, begin = nodal_mass(mesh, solid)[:, None], 1e-3 * rng.standard_normal(mesh.points.shape)
    errors = []
    for steps in (200, 400, 800):
        found, x, v, f = elements(mesh, solid, sort), mesh.points.copy(), begin.copy(), np.zeros_like(mesh.points)
        step, spins, energies = 10.0 / steps, [], []
        for _ in range(steps):
            half = v + 0.5 * step * f / mass
            after = x + step * half
            f = moved(found, x, after, step)
            x, v = after, half + 0.5 * step * f / mass
            internal, _, _, hourglass = found.work()
            energies.append(0.5 * np.sum(mass * v * v) + internal + hourglass)
            spins.append(np.sum(mass * np.cross(x, v), axis=0))
        errors.append(np.ptp(energies) / energies[0])
        np.testing.assert_allclose((mass * v).sum(axis=0), (mass * begin).sum(axis=0), atol=1e-16)
        np.testing.assert_allclose(spins[-1], spins[0], atol=1e-15)
    assert errors[-1] < 2e-3
    np.testing.assert_allclose(np.log2(np.divide(errors[:-1], errors[1:])), 2.0, atol=0.3)


SOLIDS = (
    SOLID,
    Bilinear(7800.0, 200e9, 0.3, 300e6, 5e9, 0.5),
    JohnsonCook(7800.0, 200e9, 0.3, A=300e6, B=500e6, n=0.3, C=0.02, specific_heat=450.0, melting_temperature=1800.0),
)


@pytest.mark.parametrize("solid", SOLIDS, ids=["elastic", "bilinear", "johnson-cook"])
def test_uniform_motion_gives_the_same_in_both_elements(rng, solid):
    """Where all points see the same, stress, plastic strain, works and forces are those of one point."""
    mesh = random_hexahedra(rng, 40)
    found, forces = [elements(mesh, solid, sort, hourglass=0.0) for sort in SORTS], []
    for each in found:
        x = mesh.points
        for slope in 4e-3 * np.random.default_rng(1).standard_normal((10, 3, 3)):
            before, x = x, x @ (np.eye(3) + slope).T
            force = moved(each, before, x, 1e-6)
        forces.append(force)
    (stress, strain), (expected, expected_strain) = (each.cell_values(40) for each in found)
    assert isinstance(solid, Bilinear | JohnsonCook) == (strain.max() > 1e-3)
    np.testing.assert_allclose(stress, expected, atol=1e-9 * np.abs(expected).max())
    np.testing.assert_allclose(strain, expected_strain, rtol=1e-9)
    np.testing.assert_allclose(forces[0], forces[1], atol=1e-9 * np.abs(forces[0]).max())
    np.testing.assert_allclose(found[0].work(), found[1].work(), rtol=1e-9)


def test_both_kinds_in_one_run_carry_a_wave_across_a_tie():
    """Two tied bars, one of each kind, nu = 0, pushed by 10 MPa: the same wave, 1e-9 apart.

    Behind the tie its momentum is p A (t - L / c). Bulk viscosity, which would push the sides too, is left out: the
    motion is that of a chain of planes.
    """
    solid, width = Elastic(7800.0, 200e9, 0.0), 2e-3
    bars = [box(name, (width, width, 0.03), 1e-3, 1e-3, 1e-3) for name in ("low", "high")]
    runs = [
        solve(
            Model(
                joined([shifted(bar, (0.0, 0.0, z)) for bar, z in zip(bars, (0.0, 0.03), strict=True)]),
                {"low": solid, "high": solid},
                Controls(11.5e-6, interval=0.1e-6, full=full, linear_viscosity=0.0, quadratic_viscosity=0.0),
                boundaries=(Pressure("low.z-", TimeCurve((0.0,), (1e7,))),),
                ties=(Tie("low.z+", "high.z-"),),
                sections=(CutSection("middle", "high", (0.0, 0.0, 0.045), (0.0, 0.0, 1.0)),),
            )
        )
        for full in ((), ("high",), ("low", "high"))
    ]
    for run in runs:
        assert not run.stopped
        assert abs(run.energy_error).max() < 1e-9
        assert run.momentum_error < 1e-9
        stress, expected = run.sections["middle"].stress[:, 2], runs[0].sections["middle"].stress[:, 2]
        high = run.parts["high"]
        assert high.mass * high.velocity[-1, 2] == pytest.approx(
            1e7 * width**2 * (11.5e-6 - 0.03 / solid.wave_speed), rel=0.01
        )
        np.testing.assert_allclose(stress, expected, atol=1e-2)
        np.testing.assert_allclose(run.parts["high"].velocity, runs[0].parts["high"].velocity, atol=1e-9)


def flying_bars(duration, **controls):
    """A fully integrated Johnson-Cook bar tied upon a one-point bilinear one, on a wall at 100 m/s."""
    bars = [box(name, (2e-3, 2e-3, 4e-3), 5e-4, 5e-4, 5e-4) for name in ("low", "high")]
    return Model(
        joined([shifted(bar, (0.0, 0.0, z)) for bar, z in zip(bars, (0.0, 4e-3), strict=True)]),
        {"low": SOLIDS[1], "high": SOLIDS[2]},
        Controls(duration, interval=0.5e-6, full=("high",), **controls),
        velocity={"low": (0.0, 0.0, -100.0), "high": (0.0, 0.0, -100.0)},
        ties=(Tie("low.z+", "high.z-"),),
        walls=(RigidWall("low.z-", (0.0, 0.0, 0.0), (0.0, 0.0, 1.0)),),
    )


def test_threads_and_a_restart_change_no_bit_of_a_run_with_both_kinds(tmp_path):
    path = tmp_path / "restart.h5"
    whole = solve(flying_bars(8e-6), RunOptions(frames=2))
    solve(flying_bars(4e-6), RunOptions(checkpoint=Checkpoint(path, 4)))
    others = [
        solve(flying_bars(8e-6), RunOptions(frames=2, resume=path)),
        solve(flying_bars(8e-6, threads=2), RunOptions(frames=2)),
    ]
    assert whole.energy["plastic"][-1] > 0.5 * whole.initial_energy
    assert abs(whole.energy_error).max() < 1e-4
    for other in others:
        for name, values in whole.energy.items():
            np.testing.assert_array_equal(other.energy[name], values)
        np.testing.assert_array_equal(other.frames[-1].stress, whole.frames[-1].stress)
        np.testing.assert_array_equal(other.frames[-1].plastic_strain, whole.frames[-1].plastic_strain)
