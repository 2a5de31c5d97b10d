"""Ties of meshes that do not match: linear fields pass exactly; mass, momentum and work are kept."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from strikewave.base.errors import InputError
from strikewave.fem._node_kernels import gather_mass, gather_tied_forces, move_tied
from strikewave.fem.contact import prepare_ties
from strikewave.fem.mesh import joined
from strikewave.fem.model import Tie

from .blocks import Lattice, block, nodal_mass

TIE = Tie("b.bottom", "a.top")


def tied_blocks(fine=(3, 5), lift=0.0, shift=(0.1, 0.07)):
    """A finer block on a coarser one, inside its outline."""
    mesh = joined(
        [block("a", (2, 3, 1), (1.0, 1.0, 0.4)), block("b", (*fine, 1), (0.8, 0.7, 0.3), (*shift, 0.4 + lift))]
    )
    return mesh, prepare_ties([TIE], mesh)


@given(st.lists(st.floats(-5, 5), min_size=12, max_size=12), st.integers(1, 6), st.integers(1, 6))
def test_linear_velocity_fields_pass_exactly(numbers, nx, ny):
    """v = a + B x on the nodes of the coarse side is found at the tied nodes: bilinear faces hold linear fields."""
    mesh, ties = tied_blocks((nx, ny))
    a, b = np.array(numbers[:3]), np.array(numbers[3:]).reshape(3, 3)
    field = a + mesh.points @ b.T
    v = field.copy()
    v[ties.nodes] = np.nan
    move_tied(ties, v)
    assert v == pytest.approx(field, abs=1e-13 * (1.0 + np.abs(numbers).sum()))


@given(st.integers(0, 1000))
def test_force_moment_mass_and_work_are_kept(seed):
    rng = np.random.default_rng(seed)
    mesh, ties = tied_blocks()
    f, v = rng.normal(size=(2, *mesh.points.shape))
    move_tied(ties, v)
    before = f.copy()
    gather_tied_forces(ties, f)
    assert np.all(f[ties.nodes] == 0.0)
    assert f.sum(axis=0) == pytest.approx(before.sum(axis=0), abs=1e-12)
    assert np.cross(mesh.points, f).sum(axis=0) == pytest.approx(np.cross(mesh.points, before).sum(axis=0), abs=1e-12)
    assert np.sum(f * v) == pytest.approx(np.sum(before * v), abs=1e-11)
    mass = nodal_mass(mesh)
    momentum, whole = mass @ v, mass.sum()
    gather_mass(ties, mass)
    assert np.all(mass[ties.nodes] == 0.0)
    assert mass.sum() == pytest.approx(whole, rel=1e-14)
    assert mass @ v == pytest.approx(momentum, abs=1e-13)


def test_nodes_on_nodes_are_tied_to_them_alone():
    mesh = joined([block("a", (3, 2, 1)), block("b", (3, 2, 1), origin=(0, 0, 1.0))])
    ties = prepare_ties([TIE], mesh)
    heaviest = ties.corners[np.arange(len(ties.nodes)), ties.shape.argmax(axis=1)]
    assert ties.shape.max(axis=1) == pytest.approx(1.0, abs=1e-12)
    assert mesh.points[heaviest] == pytest.approx(mesh.points[ties.nodes], abs=1e-14)


def test_a_node_off_the_face_keeps_its_distance_while_the_face_moves_along():
    mesh, ties = tied_blocks(lift=0.02)
    v = np.zeros_like(mesh.points)
    v[:] = [1.0, 2.0, 3.0]
    v[ties.nodes] = 0.0
    move_tied(ties, v)
    assert v[ties.nodes] == pytest.approx(np.array([[1.0, 2.0, 3.0]] * len(ties.nodes)), rel=1e-14)


def test_tied_lattices_keep_energy_and_momentum_of_a_wave_that_crosses():
    """A bar of two meshes that do not match: nothing is lost where they are tied, however often waves cross it.

    The scheme keeps sum m v_(n-1/2) v_(n+1/2)/2 + U for springs that do not turn: what is left is the turning, about
    the strain, 1e-4.
    """
    mesh = joined([block("a", (2, 2, 6), (1, 1, 3.0)), block("b", (3, 3, 9), (1, 1, 3.0), (0, 0, 3.0))])
    lattice = Lattice(mesh)
    ties = prepare_ties([TIE], mesh)
    dt, mass = 0.7 * lattice.critical_step(), lattice.mass.copy()
    gather_mass(ties, mass)
    light = np.divide(1.0, mass, out=np.zeros_like(mass), where=mass > 0.0)
    x, v = mesh.points.copy(), np.zeros_like(mesh.points)
    v[len(block("a", (2, 2, 6)).points) :, 2] = -1e-4
    move_tied(ties, v)
    begin, momentum = 0.5 * np.sum(mass[:, None] * v**2), mass @ v
    total = []
    for _ in range(1500):
        f = lattice.force(x)
        gather_tied_forces(ties, f)
        old = v.copy()
        v += dt * light[:, None] * f
        move_tied(ties, v)
        total.append(0.5 * np.sum(mass[:, None] * v * old) + lattice.energy(x))
        x += dt * v
    assert np.array(total) == pytest.approx(begin, rel=2e-3)
    assert mass @ v == pytest.approx(momentum, abs=1e-12 * np.abs(momentum).max())
    assert np.ptp(x[ties.nodes, 2]) < 1e-3


def test_sides_that_do_not_meet_are_refused_with_how_many_and_how_far():
    with pytest.raises(InputError, match=r"24 of 24 nodes off a\.top.*tie the smaller side onto the larger"):
        tied_blocks(lift=0.1)
    with pytest.raises(InputError, match=r"6 of 24 nodes off a\.top, the furthest 0\.08 m"):
        tied_blocks(shift=(0.28, 0.07))


def test_nodes_tied_twice_and_chains_of_ties_are_refused():
    mesh, _ = tied_blocks()
    with pytest.raises(InputError, match="24 nodes of two ties"):
        prepare_ties([TIE, TIE], mesh)
    mesh = joined([block("a", (2, 2, 1)), block("b", (2, 2, 1), origin=(0, 0, 1.0))])
    with pytest.raises(InputError, match="not tied themselves"):
        prepare_ties([TIE, Tie("a.top", "b.bottom")], mesh)


def test_sides_with_common_nodes_are_refused():
    with pytest.raises(InputError, match="common nodes"):
        prepare_ties([Tie("a.top", "a.all")], block("a", (2, 2, 2)))


def test_no_ties_are_no_ties():
    mesh = block("a", (1, 1, 1))
    ties = prepare_ties([], mesh)
    f = np.ones((8, 3))
    gather_tied_forces(ties, f)
    move_tied(ties, f)
    assert np.all(f == 1.0)
