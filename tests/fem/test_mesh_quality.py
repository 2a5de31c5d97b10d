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


def squeezed(share):
    """A unit cube pressed to a share of its height."""
    cube = block("a", (1.0, 1.0, 1.0), 1.0, 1.0, 1.0)
    return replace(cube, points=cube.points * [1.0, 1.0, share])


@pytest.mark.parametrize(("make", "share", "words"), [
    (squeezed, 0.7e-6, "mesh.a element 0"), (squeezed, 1.5e-6, ""), (lambda far: moved(squeezed(1.0), (far, 0, 0)), 0.9e6, ""),
    (lambda far: moved(squeezed(1.0), (0, far, 0)), 1.5e6, "within 1e+06 m"),
    (lambda far: moved(squeezed(1.0), (0, 0, far)), -1.5e6, "within 1e+06 m"),
])  # fmt: skip
def test_flat_and_far_have_limits(make, share, words):
    if words:
        with pytest.raises(InputErrors) as error:
            check_mesh(make(share))
        assert words in str(error.value)
    else:
        check_mesh(make(share))


@pytest.mark.parametrize(("jacobian", "refused"), [(0.7e-6, True), (1.5e-6, False)])
def test_a_corner_is_flat_at_a_millionth(jacobian, refused):
    """A cube sheared by an angle of cosine 1e-6: its edges are then a million long, and it is as high as they are."""
    cube = block("a", (1.0, 1.0, 1.0), 1.0, 1.0, 1.0)
    points = cube.points * [1.0, 1.0, jacobian]
    points[:, 0] += math.sqrt(1.0 - jacobian**2) * cube.points[:, 2]
    assert scaled_jacobians(points, cube.hexahedra).min() == pytest.approx(jacobian, rel=1e-6)
    if refused:
        with pytest.raises(InputErrors, match=r"mesh\.a element 0"):
            check_mesh(replace(cube, points=points))
    else:
        check_mesh(replace(cube, points=points))


def test_of_many_points_beside_elements_five_are_named(pair):
    with pytest.raises(InputErrors) as error:
        check_mesh(replace(pair, points=np.concatenate([pair.points, np.zeros((7, 3))])))
    assert 'got "7 that belong to no element, such as 54, 55, 56, 57, 58"' in str(error.value)


def test_corners_warps_and_edges_of_an_element_without_symmetry(rng):
    """Each corner by the determinant of its unit edges, each face by the normals of its triangles, one by one."""
    cube = block("a", (1.0, 1.0, 1.0), 1.0, 1.0, 1.0)
    points = cube.points + rng.uniform(-0.3, 0.3, (8, 3)) * [1.0, 0.8, 0.6]
    nodes = points[cube.hexahedra[0]]
    around = {
        0: (1, 3, 4),
        1: (2, 0, 5),
        2: (3, 1, 6),
        3: (0, 2, 7),
        4: (7, 5, 0),
        5: (4, 6, 1),
        6: (5, 7, 2),
        7: (6, 4, 3),
    }
    for corner, ends in around.items():
        ways = np.array([nodes[end] - nodes[corner] for end in ends])
        expected = np.linalg.det(ways / np.linalg.norm(ways, axis=1, keepdims=True))
        assert scaled_jacobians(points, cube.hexahedra)[0, corner] == pytest.approx(expected, rel=1e-12)
    faces = [(0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)]

    def normal(*three):
        a, b, c = nodes[list(three)]
        way = np.cross(b - a, c - a)
        return way / np.linalg.norm(way)

    for face, (a, b, c, d) in enumerate(faces):
        cosines = normal(a, b, c) @ normal(a, c, d), normal(b, c, d) @ normal(b, d, a)
        assert warpages(points, cube.hexahedra)[0, face] == pytest.approx(math.acos(min(cosines)), abs=1e-7)
    (row,) = quality_report(replace(cube, points=points), {"a": 2.0})
    lengths = [np.linalg.norm(nodes[i] - nodes[j]) for i, ends in around.items() for j in ends]
    assert (row.shortest_edge, row.longest_edge) == (pytest.approx(min(lengths)), pytest.approx(max(lengths)))
    assert row.aspect_ratio == pytest.approx(max(lengths) / min(lengths), rel=1e-12)
    assert row.step == pytest.approx(0.5 * min(lengths), rel=1e-12)
    assert row.worst_at == pytest.approx(tuple(nodes.mean(axis=0)), rel=1e-12)
