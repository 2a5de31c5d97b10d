"""Elements that spin while they strain, against Jaumann's rate in closed form: second order in the step."""

import itertools

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from strikewave.fem.hexahedron import TENSOR
from strikewave.fem.solids import Elastic

from .driven import CUBE, SORTS, elements, mesh_of, moved

SOLID = Elastic(7800.0, 200e9, 0.3)
STEPS = (25, 50, 100, 200)


def sheared(angle):
    """A cube in simple shear by an angle gamma: x = X + gamma Y."""
    return CUBE + angle * np.outer(CUBE[:, 1], [1.0, 0.0, 0.0])


def jaumann(angle):
    """Stress of simple shear with Jaumann's rate, G (1 - cos), G (cos - 1), G sin gamma (Dienes 1979; Lee et al. 1983)."""
    normal, shear = 1.0 - np.cos(angle), np.sin(angle)
    return SOLID.shear_modulus * np.array([[normal, shear, 0.0], [shear, -normal, 0.0], [0.0, 0.0, 0.0]])


def stress_after(sort, places):
    """Drive a cube through places; return its stress as a matrix."""
    found = elements(mesh_of(CUBE, np.arange(8)[None]), SOLID, sort)
    for before, after in itertools.pairwise(places):
        moved(found, before, after)
    return found.cell_values(1)[0][0][TENSOR]


@pytest.mark.parametrize("sort", SORTS)
@pytest.mark.parametrize("turn", [(0.0, 0.0, 0.0), (0.0, 0.0, 1.5), (0.7, -1.1, 0.4)], ids=["still", "about z", "skew"])
def test_shear_of_two_with_rotation_on_it_converges_by_the_second_order(sort, turn):
    """The frame turns evenly by ``turn`` (rad) meanwhile: the stress is that of simple shear, turned with it.

    The strain increment of the middle of a step, added as it is to the stress at its end, would give order one.
    """
    axis = np.array(turn)
    expected = Rotation.from_rotvec(axis).apply(Rotation.from_rotvec(axis).apply(jaumann(2.0)).T)
    errors = []
    for steps in STEPS:
        shares = np.arange(steps + 1) / steps
        places = [Rotation.from_rotvec(share * axis).apply(sheared(2.0 * share)) for share in shares]
        errors.append(np.abs(stress_after(sort, places) - expected).max() / SOLID.shear_modulus)
    orders = np.log2(np.divide(errors[:-1], errors[1:]))
    assert errors[-1] < 1e-4
    np.testing.assert_allclose(orders, 2.0, atol=0.1)


@pytest.mark.parametrize("sort", SORTS)
@pytest.mark.parametrize("degrees", [1.0, 40.0, 170.0])
def test_stress_turns_with_a_rigid_step_of_any_angle(sort, degrees):
    """Incremental objectivity: one step, stress to rounding."""
    turn = Rotation.from_rotvec(np.radians(degrees) * np.array([2.0, 3.0, 6.0]) / 7.0)
    strained = sheared(0.01)
    before = stress_after(sort, [CUBE, strained])
    after = stress_after(sort, [CUBE, strained, turn.apply(strained)])
    expected = turn.as_matrix() @ before @ turn.as_matrix().T
    np.testing.assert_allclose(after, expected, atol=1e-11 * np.abs(before).max())
