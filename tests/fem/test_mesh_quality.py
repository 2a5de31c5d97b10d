"""Quality of meshes against closed forms, and faults that are put into a sound mesh."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from strikewave.base.errors import InputErrors
from strikewave.fem.mesh import joined
from strikewave.fem.quality import FLAT, check_mesh, quality_report, scaled_jacobians, warpages
from strikewave.fem.sections import FLIPPED
from strikewave.fem.shapes import block, moved


@pytest.fixture
def pair():
    """Two blocks of eight elements each."""
    cube = (0.02, 0.02, 0.02)
    return joined([block("low", cube, 0.01, 0.01, 0.01), moved(block("high", cube, 0.01, 0.01, 0.01), (0.0, 0.0, 1.0))])


def sheared(angle):
    """A unit cube sheared along x by an angle."""
    cube = block("a", (1.0, 1.0, 1.0), 1.0, 1.0, 1.0)
    points = cube.points.copy()
    points[:, 0] += math.tan(angle) * points[:, 2]
    return replace(cube, points=points)


@given(st.floats(-1.3, 1.3))
def test_a_cube_sheared_by_an_angle_has_its_cosine_as_scaled_jacobian(angle):
    cube = sheared(angle)
    np.testing.assert_allclose(scaled_jacobians(cube.points, cube.hexahedra), math.cos(angle), rtol=1e-12)
    (row,) = quality_report(cube)
    assert row.volume == pytest.approx(1.0, rel=1e-13)
    assert row.warpage == pytest.approx(0.0, abs=1e-14)
    assert row.longest_edge == pytest.approx(1.0 / math.cos(angle), rel=1e-13)
    assert row.aspect_ratio == pytest.approx(1.0 / math.cos(angle), rel=1e-13)


@given(st.floats(0.0, 3.0))
def test_a_saddle_is_warped_by_the_angle_of_its_triangles(slope):
    cube = block("a", (1.0, 1.0, 1.0), 1.0, 1.0, 1.0)
    points = cube.points.copy()
    points[:, 2] += slope * points[:, 0] * points[:, 1]
    # over a diagonal the gradients are (-s/2, s/2) and (s/2, -s/2)
    exact = math.acos((1.0 - 0.5 * slope**2) / (1.0 + 0.5 * slope**2))
    # arccos loses half its digits near 0
    assert warpages(points, cube.hexahedra).max() == pytest.approx(exact, abs=3e-8)


def test_the_worst_element_is_named_by_its_number_in_the_part_and_its_place(pair):
    points = pair.points.copy()
    corner = np.argmin(np.linalg.norm(points - [0.01, 0.01, 1.02], axis=1))
    points[corner] -= [0.004, 0.0, 0.0]
    low, high = quality_report(replace(pair, points=points), {"high": 5000.0})
    assert (low.part, low.elements, low.nodes, low.step) == ("low", 8, 27, None)
    assert low.scaled_jacobian == pytest.approx(1.0, abs=1e-12)
    assert high.scaled_jacobian < 0.95
    np.testing.assert_allclose(high.worst_at, [0.0045, 0.005, 1.015], atol=1e-12)
    assert high.step == pytest.approx(0.006 / 5000.0, rel=1e-12)


def faulty(pair, fault):
    hexahedra, points, names = pair.hexahedra.copy(), pair.points.copy(), pair.names
    if fault == "inverted":
        hexahedra[11] = hexahedra[11][FLIPPED]
    elif fault == "flat":
        points[hexahedra[11][4:]] = points[hexahedra[11][:4]] + [0.0, 0.0, 1e-12]
    elif fault == "twice":
        hexahedra[11][5] = hexahedra[11][4]
    elif fault == "not finite":
        points[3, 1] = np.nan
    elif fault == "too far":
        points[3, 1] = 1e300
    elif fault == "loose":
        points = np.concatenate([points, [[0.0, 0.0, 0.0]]])
    elif fault == "empty":
        names = (*names, "ghost")
    elif fault == "no such node":
        hexahedra[0, 0] = 1000
    return replace(pair, hexahedra=hexahedra, points=points, names=names)


@pytest.mark.parametrize(
    ("fault", "words"),
    [
        ("inverted", ["mesh.high element 3 at", "scaled Jacobian -1", "volume -1e-06"]),
        ("flat", ["mesh.high element 3 at", f"above {FLAT:g}"]),
        ("twice", ["mesh.high element 3 at", "a node twice"]),
        ("not finite", ["mesh.point 3", "nan"]),
        ("too far", ["mesh.point 3", "1e+300"]),
        ("loose", ["mesh.points", "1 that belong to no element, such as 54"]),
        ("empty", ["mesh.ghost", "no elements"]),
        ("no such node", ["mesh.hexahedra", "nodes from 0 to 53"]),
    ],
)
def test_each_fault_is_named_with_part_and_element(pair, fault, words):
    check_mesh(pair)
    with pytest.raises(InputErrors) as error:
        check_mesh(faulty(pair, fault))
    assert all(word in str(error.value) for word in words), str(error.value)


def test_of_many_bad_elements_the_first_are_named_and_the_rest_counted(pair):
    with pytest.raises(InputErrors) as error:
        check_mesh(replace(pair, hexahedra=pair.hexahedra[:, FLIPPED]))
    assert len(error.value.lines) == 6
    assert error.value.lines[-1] == "mesh: 11 more such elements"


def test_the_aspect_of_a_part_is_that_of_its_longest_element():
    """Two layers of unit bricks, of which the upper is drawn to three times its height: 3, and edges from 1 to 3."""
    bricks = block("a", (1.0, 1.0, 2.0), 1.0, 1.0, 1.0)
    points = bricks.points.copy()
    points[points[:, 2] > 1.5, 2] = 4.0
    (row,) = quality_report(replace(bricks, points=points))
    assert row.aspect_ratio == pytest.approx(3.0, rel=1e-13)
    assert (row.shortest_edge, row.longest_edge) == pytest.approx((1.0, 3.0), rel=1e-13)
    assert row.volume == pytest.approx(4.0, rel=1e-13)
