"""Closest points, nodal areas, search, and the gap of nodes that cross edges, against closed forms and brute force."""

from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import minimize

from strikewave.base.errors import InputError
from strikewave.fem import _contact_kernels as contact_kernels
from strikewave.fem import _contact_kernels as touch_kernels
from strikewave.fem import _surface_kernels as kernels
from strikewave.fem.contact import (
    add_contact,
    extents,
    neighbours,
    prepare,
    searched,
    surface_of,
    thickness,
    two_surfaces,
)
from strikewave.fem.mesh import Mesh, joined
from strikewave.fem.model import SurfaceContact

from .blocks import block
from .driven import as_written

SQUARE = np.array([[-1.0, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]])
coordinate = st.floats(-3.0, 3.0)


def closest(x, face):
    given = tuple(map(float, x)), *(tuple(map(float, corner)) for corner in face)
    return kernels.closest_point(*given, *kernels.first_guess(*given))


def on_face(face, xi, eta):
    return np.array(kernels.shape_functions(xi, eta)) @ face


@given(coordinate, coordinate, coordinate)
def test_closest_point_of_a_square_is_the_clipped_one(x, y, z):
    xi, eta, square, rim = closest((x, y, z), SQUARE)
    assert (xi, eta) == pytest.approx((np.clip(x, -1, 1), np.clip(y, -1, 1)), abs=1e-9)
    assert square == pytest.approx((x - np.clip(x, -1, 1)) ** 2 + (y - np.clip(y, -1, 1)) ** 2 + z**2, abs=1e-12)
    assert rim == (max(abs(x), abs(y)) > 1.0 + 1e-9)


@given(st.lists(st.floats(-0.25, 0.25), min_size=12, max_size=12), coordinate, coordinate, st.floats(-0.5, 0.5))
def test_closest_point_of_a_warped_face_is_that_of_a_bounded_minimum(shift, x, y, z):
    face = SQUARE + np.array(shift).reshape(4, 3)
    point = np.array([x, y, z])
    xi, eta, square, _ = closest(point, face)
    starts = [(a, b) for a in (-0.7, 0.0, 0.7) for b in (-0.7, 0.0, 0.7)]
    best = min(
        minimize(lambda s: np.sum((on_face(face, *s) - point) ** 2), s, bounds=[(-1, 1)] * 2, tol=1e-12).fun
        for s in starts
    )
    # the bounded search finds the value within about 1e-9; a local minimum would be off by far more
    assert square <= best + 1e-7
    assert np.sum((on_face(face, xi, eta) - point) ** 2) == pytest.approx(square, abs=1e-12)


@given(st.floats(-0.9, 0.9), st.floats(-0.9, 0.9), st.floats(-0.3, 0.3), st.floats(-0.4, 0.4))
def test_a_point_lifted_along_the_normal_of_a_warped_face_comes_back(xi, eta, lift, warp):
    face = SQUARE + warp * np.array([[0, 0, 1], [0, 0, -1], [0, 0, 1], [0, 0, -1.0]])
    along = [on_face(face, 1, eta) - on_face(face, -1, eta), on_face(face, xi, 1) - on_face(face, xi, -1)]
    normal = np.cross(*along)
    point = on_face(face, xi, eta) + lift * normal / np.linalg.norm(normal)
    found_xi, found_eta, square, rim = closest(point, face)
    # the radius of curvature is above 1/(2 warp) > lift, so that the foot is unique
    assert (found_xi, found_eta, not rim) == (pytest.approx(xi, abs=1e-8), pytest.approx(eta, abs=1e-8), True)
    assert np.sqrt(square) == pytest.approx(abs(lift), abs=1e-9)


@given(st.floats(-1, 1), st.floats(-1, 1))
def test_shape_functions_are_a_partition_of_unity_and_reproduce_the_corners(xi, eta):
    shape = np.array(kernels.shape_functions(xi, eta))
    assert shape.sum() == pytest.approx(1.0, abs=1e-15)
    assert shape.min() >= 0.0
    assert shape @ SQUARE == pytest.approx([xi, eta, 0.0], abs=1e-15)


def test_nodal_areas_add_up_to_the_area():
    mesh = block("a", (4, 3, 2), (2.0, 1.5, 1.0))
    surface = surface_of(mesh.side("a.all"))
    found = extents(mesh.points[surface.nodes], surface.faces)
    assert found.area.sum() == pytest.approx(2 * (2 * 1.5 + 2 * 1 + 1.5 * 1), rel=1e-14)
    assert found.size == pytest.approx(0.5, rel=1e-14)
    assert found.radius == pytest.approx(0.5 / np.sqrt(2), rel=1e-14)


def test_every_edge_of_a_closed_surface_has_a_neighbour_and_each_is_mutual():
    faces = block("a", (3, 2, 4)).side("a.all")
    across = neighbours(faces)
    assert across.min() >= 0
    for face, edges in enumerate(across):
        for edge, other in enumerate(edges):
            ends = {faces[face, edge], faces[face, (edge + 1) % 4]}
            assert ends <= set(faces[other])
            assert face in across[other]


def test_thickness_is_the_height_of_the_element_behind():
    mesh = block("a", (3, 3, 4), (3.0, 3.0, 1.0))
    assert thickness(mesh, mesh.side("a.top")) == pytest.approx(0.25, rel=1e-14)
    far = joined([mesh, block("b", (3, 3, 1), (3.0, 3.0, 2.0), (0, 0, 9.0))])
    assert thickness(far, far.side("b.bottom")) == pytest.approx(2.0, rel=1e-14)


@given(st.integers(0, 10**6), st.integers(1, 60), st.integers(1, 40), st.floats(0.01, 2.0), st.sampled_from([1e-3, 1]))
def test_search_finds_what_every_box_and_every_node_give(seed, count, number, size, flat):
    rng = np.random.default_rng(seed)
    place = rng.uniform(-1, 1, (2 * count, 3)) * [1.0, 1.0, flat]
    half = rng.integers(0, count, (number, 4))
    faces = np.concatenate([half, count + rng.integers(0, count, (number, 4))]).astype(np.int32)
    reach = rng.uniform(0, size, 2 * number)
    checked = rng.random(2 * count) < 0.9
    start, candidates = kernels.search(place, checked, faces, reach, count, number)
    low = place[faces].min(1) - reach[:, None]
    high = place[faces].max(1) + reach[:, None]
    for n in range(2 * count):
        others = range(number, 2 * number) if n < count else range(number)
        wanted = [m for m in others if np.all(low[m] <= place[n]) and np.all(place[n] <= high[m])] if checked[n] else []
        assert candidates[start[n] : start[n + 1]].tolist() == wanted


@given(st.integers(0, 10**6), st.floats(-0.04, 0.04))
def test_the_face_of_a_node_is_the_closest_of_all(seed, lift):
    rng = np.random.default_rng(seed)
    a, b = block("a", (5, 4, 1)), block("b", (3, 6, 1), origin=(0.05, 0.03, 1.0))
    mesh = joined([a, b])
    mesh.points[:, 2] += 0.02 * np.sin(7 * mesh.points[:, 0] + 3 * mesh.points[:, 1])
    mesh.points[len(a.points) :, 2] += lift
    mesh.points[:] += rng.uniform(-0.01, 0.01, mesh.points.shape)
    state = searched(two_surfaces(SurfaceContact("a.top", "b.bottom"), mesh), mesh.points)
    count = len(state.touch.nodes)
    state.place[:] = mesh.points[state.touch.nodes]
    face, shape, distance = np.zeros(count, np.int32), np.zeros((count, 4)), np.full(count, np.inf)
    contact_kernels.nearest_faces(state, face, shape, distance)
    for i in np.flatnonzero(np.isfinite(distance)):
        others = range(state.first_faces, len(state.faces)) if i < state.touch.first else range(state.first_faces)
        all_squares = [closest(state.place[i], state.place[state.faces[m]])[2] for m in others]
        assert distance[i] == pytest.approx(np.sqrt(min(all_squares)), rel=1e-8, abs=1e-12)
        assert shape[i] @ state.place[state.faces[face[i]]] == pytest.approx(
            state.place[i], abs=distance[i] * (1 + 1e-9) + 1e-12
        )


def ridge(slope, faces=((0, 1, 3, 2), (2, 3, 5, 4))):
    """Two faces, wide 1 across, that meet along the y axis, rising by ``slope`` from it; a lone element far above."""
    x, y = np.meshgrid([-1.0, 0.0, 1.0], [-1.0, 1.0], indexing="ij")
    top = np.stack([x.ravel(), y.ravel(), slope * np.abs(x.ravel())], 1)
    points = np.concatenate([top, top - [0, 0, 2.0]])
    hexahedra = np.array([[0, 2, 3, 1], [2, 4, 5, 3]])
    hexahedra = np.concatenate([hexahedra + 6, hexahedra], 1).astype(np.int32)
    part = np.zeros(2, np.int32)
    roof = Mesh(points, hexahedra, part, ("roof",), {"roof.top": hexahedra[:, 4:]})
    tip = block("tip", (1, 1, 1), (0.02, 0.02, 0.02), (0.0, 0.0, 5.0))
    return joined([tip, roof])


def forces_along(mesh, places, stiffness=0.8):
    """The force on the first node of the tip at places (n, 3), the rest of the tip far above."""
    state = prepare(SurfaceContact("tip.bottom", "roof.top", stiffness=stiffness), mesh)
    state.nodal.known[:] = 1  # as if the node had been pressed in
    area = state.touch.area.copy()
    v, light = np.zeros_like(mesh.points), np.ones(len(mesh.points))
    forces = []
    for place in places:
        x = mesh.points.copy()
        x[0] = place
        state = searched(state, x)
        state.touch.area[:] = area  # the one node has stretched the tip
        f = np.zeros_like(x)
        add_contact(state, x, v, f, light, 1.0)
        assert f.sum(axis=0) == pytest.approx(0.0, abs=1e-12)
        forces.append(f[0])
    return np.array(forces)


@pytest.mark.parametrize("slope", [-0.5, -0.05, 0.0, 0.05, 0.5, 1.0])
def test_force_changes_steadily_as_a_node_slides_over_an_edge(slope):
    """Along a path parallel to the roof at a depth of 0.02 the force jumps neither for ridges nor for valleys.

    The inverse mass of the face changes continuously, and so does the depth: the steps along the path are 1/1000 wide,
    and the size of the force 0.5 s m* depth changes by far less than a tenth; only over a ridge the direction turns
    within one step, by twice the angle of the slope.
    """
    x = np.linspace(-0.5, 0.5, 1001)
    path = np.stack([x, np.zeros_like(x), slope * np.abs(x) - 0.02], 1)
    forces = forces_along(ridge(slope), path)
    size = np.linalg.norm(forces, axis=1)
    assert size.min() > 0.0
    assert np.abs(np.diff(size)).max() < 0.05 * size.max()
    if slope >= 0.0:
        assert np.linalg.norm(np.diff(forces, axis=0), axis=1).max() < 0.1 * size.max()


@pytest.mark.parametrize("slope", [-0.5, 0.0, 0.5, 1.0])
def test_gap_is_the_distance_from_the_roof(slope):
    x = np.linspace(-0.5, 0.5, 41)
    mesh = ridge(slope)
    state = prepare(SurfaceContact("tip.bottom", "roof.top"), mesh)
    v, light = np.zeros_like(mesh.points), np.ones(len(mesh.points))
    for place in x:
        points = mesh.points.copy()
        points[0] = [place, 0.1, slope * abs(place) - 0.02]
        state = searched(state, points)
        add_contact(state, points, v, np.zeros_like(points), light, 1.0)
        off = np.array([abs(place), 0.02])
        normal = np.array([-slope, 1.0]) / np.hypot(1.0, slope)
        foot = abs(place) - 0.02 * slope / (1 + slope**2)  # where the perpendicular to the nearer face meets it
        plane = 0.02 * normal[1]
        wanted = plane if foot >= 0.0 else np.hypot(off[0], slope * off[0] - 0.02)
        assert state.nodal.gap[0] == pytest.approx(-wanted, rel=1e-12)


def test_nodes_above_and_beside_a_ridge_feel_nothing_and_beyond_the_rim_the_force_fades():
    mesh = ridge(0.0)
    above = forces_along(mesh, [[0.0, 0.0, 1e-9], [0.5, 0.0, 0.1], [0.0, 0.0, -1.5]])
    assert np.all(above == 0.0)  # the last lies deeper than half the element
    share = np.array([0.0, 1 / 80, 1 / 40, 1 / 20, 1 / 5])  # of the size sqrt(2) of the faces, 1 by 2
    beyond = forces_along(mesh, [[1.0 + d, 0.0, -0.01] for d in share * 2**0.5])
    assert beyond[:, 2] / beyond[0, 2] == pytest.approx([1.0, 1.0, 1.0, 0.0, 0.0], abs=1e-12)


@pytest.mark.parametrize(("share", "felt"), [(0.9 / 40, 1.0), (1.2 / 40, 0.8), (1.7 / 40, 0.3), (2.1 / 40, 0.0)])
def test_from_a_fortieth_to_a_twentieth_beyond_the_rim_the_felt_share_falls_evenly(share, felt):
    """A node 0.01 below a roof whose faces have the size sqrt(2); its overlap of before the step counts for nothing."""
    mesh = ridge(0.0)
    state = prepare(SurfaceContact("tip.bottom", "roof.top"), mesh)
    x = mesh.points.copy()
    x[0] = [0.3, 1.0 + share * 2**0.5, -0.01]
    state = searched(state, x)
    state.place[:] = x[state.touch.nodes]
    face, xi, eta, distance, rim = as_written(contact_kernels.nearest_face, {})(state, 0)
    assert distance == pytest.approx(np.hypot(0.01, share * 2**0.5), rel=1e-12)
    gap, normal, found = as_written(contact_kernels.gap_at, {})(state, 0, face, xi, eta, rim)
    assert (gap, found) == (pytest.approx(-0.01, rel=1e-12), pytest.approx(felt, abs=1e-12))
    assert normal == pytest.approx((0.0, 0.0, 1.0), abs=1e-15)
    assert rim


def test_nodes_that_both_sides_share_are_refused():
    mesh = block("a", (2, 2, 2))
    with pytest.raises(InputError, match="common nodes"):
        prepare(SurfaceContact("a.top", "a.all"), mesh)
    with pytest.raises(InputError, match="two different sides"):
        prepare(SurfaceContact("a.top", "a.top"), mesh)


@pytest.mark.parametrize(("change", "field"), [({"stiffness": 1.5}, "stiffness"), ({"friction": -0.1}, "friction")])
def test_numbers_out_of_range_are_refused(change, field):
    mesh = joined([block("a", (1, 1, 1)), block("b", (1, 1, 1), origin=(0, 0, 1))])
    with pytest.raises(InputError, match=field):
        prepare(SurfaceContact("a.top", "b.bottom", **change), mesh)


@pytest.mark.verify
def test_search_of_300_000_faces_finds_what_lies_on_what():
    """A search of all pairs would take minutes and gigabytes; how long it takes stands in the benchmarks."""
    counts = (387, 387, 1)
    mesh = joined([block("a", counts), block("b", counts, origin=(1e-4, 1e-4, 1.0))])
    state = two_surfaces(SurfaceContact("a.top", "b.bottom"), mesh)
    state = searched(state, mesh.points)
    assert len(state.faces) == 2 * 387**2
    count = len(state.touch.nodes)
    assert len(state.candidates) < 20 * count  # of 1e11 pairs
    state.place[:] = mesh.points[state.touch.nodes]
    face, shape, distance = np.zeros(count, np.int32), np.zeros((count, 4)), np.full(count, np.inf)
    contact_kernels.nearest_faces(state, face, shape, distance)
    # the sides lie in one plane, shifted by 1e-4 both ways: two rims look beyond the other side by that much
    assert distance.max() == pytest.approx(1e-4 * 2**0.5, rel=1e-6)
    assert np.count_nonzero(distance > 1e-9) == 2 * (2 * 388 - 1)


@pytest.mark.parametrize(
    ("length", "count", "wanted", "cells"),
    [
        ((10.0, 5.0, 1.0), 3, 1.5, (7, 4, 1)),
        # 21 11 5 are more than 68, and so are those of 1.3, 1.69 and 2.197 times the width; 8 4 2 of 2.8561 times are not
        ((10.0, 5.0, 2.0), 1, 0.5, (8, 4, 2)),
        # as many as 4 21 and 64 more: 6 5 5 are 150, 6 5 4 are 120
        ((5.9, 4.9, 3.9), 21, 1.0, (6, 5, 4)),
        # at most a thousand along the longest axis at first, and one more that begins at its end
        ((0.0, 16.0, 0.25), 10**6, 1e-9, (1, 1001, 16)),
        ((0.0, 0.0, 0.0), 5, 0.3, (1, 1, 1)),
    ],
)
def test_cells_are_about_as_wide_as_wanted_and_few_beside_the_nodes(length, count, wanted, cells):
    low = np.array([1.0, -2.0, 3.0])
    found, width = as_written(kernels.cells_of, {})(low, low + length, count, wanted)
    assert tuple(found) == cells
    np.testing.assert_allclose(width, np.array(length) / cells, rtol=1e-12, atol=1e-299)


def test_nodes_are_sorted_into_the_cells_of_their_own_box():
    """Those to be checked within the bounds of all boxes; cells span these nodes, as wide as a box in the mean."""
    place = np.array(
        [[9.0, 9, 9], [0.0, 0, 0], [6.0, 0, 0], [3.0, 2, 1], [6.0, 4, 2], [0.0, 4, 2], [7.5, 0, 0], [1.0, 1, 1]]
    )
    checked = np.array([True, True, True, True, True, False, True, True])
    boxes = np.array([[-1.0, -1, -1, 3, 1, 2], [4.0, 0, -3, 7, 5, 4]])
    inside, wide = as_written(kernels.nodes_within, {})(place, checked, (1, 7), boxes)
    assert inside.tolist() == [1, 2, 3, 4]
    assert wide == pytest.approx((4 + 2 + 3 + 3 + 5 + 7) / 6.0, rel=1e-14)
    order, begin, low, high, width, cells = as_written(kernels.grid, {})(place, checked, (1, 7), boxes)
    assert (low.tolist(), high.tolist()) == ([0.0, 0.0, 0.0], [6.0, 4.0, 2.0])
    assert (cells.tolist(), width.tolist()) == ([2, 2, 1], [3.0, 2.0, 2.0])
    assert [order[begin[k] : begin[k + 1]].tolist() for k in range(4)] == [[1], [], [2], [3, 4]]
    nobody = as_written(kernels.grid, {})(place, checked, (5, 6), boxes)
    assert (nobody[0].size, nobody[1].tolist()) == (0, [0, 0])
    assert as_written(kernels.cell_of, {})(4.9, 1.0, 2.0, 9) == 1
    assert as_written(kernels.cell_of, {})(-4.9, 1.0, 2.0, 9) == 0
    assert as_written(kernels.cell_of, {})(40.9, 1.0, 2.0, 9) == 8


def test_a_box_holds_its_face_and_its_reach():
    place = np.array([[0.0, 5, 2], [3.0, 5, 1], [3.0, 7, 2], [1.0, 6, 9], [2.5, 7.25, 0.6], [2.5, 7.35, 0.6]])
    faces = np.array([[1, 2, 3, 0], [0, 1, 2, 3]], np.int32)
    boxes = as_written(kernels.face_boxes, {})(place, faces, np.array([0.5, 0.3]))
    np.testing.assert_allclose(boxes, [[-0.5, 4.5, 0.5, 3.5, 7.5, 9.5], [-0.3, 4.7, 0.7, 3.3, 7.3, 9.3]], atol=1e-15)
    assert [as_written(kernels.in_box, {})(place, n, boxes, 0) for n in (4, 5)] == [True, True]
    assert [as_written(kernels.in_box, {})(place, n, boxes, 1) for n in (4, 5)] == [False, False]
    boxes[1, 2] = 0.6
    assert [as_written(kernels.in_box, {})(place, n, boxes, 1) for n in (4, 5)] == [True, False]


def test_nodes_that_may_meet_a_face_of_a_corner_ascend_and_count_once():
    """By candidates or by the face met last, which may be one of them; -1 is none."""
    faces = np.array([[0, 1, 2, 3], [2, 1, 4, 5]], np.int32)
    start, candidates = np.array([0, 2, 2, 3, 3, 3, 3]), np.array([0, 1, 1], np.int32)
    last = np.array([1, -1, 0, -1, 1, -1], np.int32)
    begin, met = as_written(kernels.nodes_by_corner, {})(faces, start, candidates, last)
    expected = [[0, 2], [0, 2, 4], [0, 2, 4], [0, 2], [0, 2, 4], [0, 2, 4]]
    assert [met[begin[k] : begin[k + 1]].tolist() for k in range(6)] == expected


def test_the_closest_of_four_edges_and_the_corner_that_a_point_is_at():
    """A trapezium in a plane aslant: places along its edges by hand, and the share of the middle's distance, a tenth."""
    a, b, c, d = (0.0, 0.0, 0.0), (4.0, 0.0, 2.0), (4.0, 2.0, 2.0), (0.0, 4.0, 0.0)
    assert as_written(kernels.along, {})((1.0, 3.0, 0.5), a, b) == (pytest.approx(-0.5), pytest.approx(9.0))
    assert as_written(kernels.along, {})((9.0, 3.0, 2.0), a, b) == (1.0, pytest.approx(25.0 + 9.0))
    assert as_written(kernels.along, {})((-1.0, 3.0, -2.0), a, b) == (-1.0, pytest.approx(14.0))
    rims = {
        (1.0, -1.0, 0.5): (-0.5, -1.0, 1.0), (4.0, 0.5, 3.0): (1.0, -0.5, 1.0),
        (1.0, 5.5, 0.5): (-0.5, 1.0, 4.0 * 21.0 / 21.0), (-2.0, 1.0, 0.0): (-1.0, -0.5, 4.0),
    }  # fmt: skip
    for x, (xi, eta, square) in rims.items():
        found = as_written(kernels.on_rim, {})(x, a, b, c, d)
        if x[1] < 5.0:
            assert found == (pytest.approx(xi), pytest.approx(eta), pytest.approx(square))
        else:  # the edge c-d: the foot by its own projection
            edge, off = np.subtract(d, c), np.subtract(x, c)
            share = off @ edge / (edge @ edge)
            assert found == (pytest.approx(1.0 - 2.0 * share), 1.0, pytest.approx(off @ off - share**2 * (edge @ edge)))
    middle = np.mean([a, b, c, d], axis=0)
    for corner, place in zip((a, b, c, d), ((-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)), strict=True):
        for share, wanted in ((0.08, place), (0.095, (0.0, 0.0))):
            x = tuple(np.array(corner) + share * (middle - corner))  # as far from it as 0.087 or 0.105 of the way
            assert as_written(kernels.first_guess, {})(x, a, b, c, d) == wanted


# Single nodes and faces, by hand


def three_squares(place, last=-1, candidates=(0, 1, 2), radius=9.0):
    """Squares of 2 m in a row along x in the plane z = 0, and one node."""
    corners = [[2.0 * i, 2.0 * j, 0.0] for i in range(4) for j in (0, 1)]
    faces = np.array([[2 * k, 2 * k + 2, 2 * k + 3, 2 * k + 1] for k in range(3)])
    nodal = SimpleNamespace(face=[-1] * 8 + [last], touches=[0] * 9, shape=np.zeros((9, 4)))
    start = [0] * 9 + [len(candidates)]
    return SimpleNamespace(
        place=np.array([*corners, place]), faces=faces, size=[2.0] * 3, radius=[radius] * 3, nodal=nodal,
        start=start, candidates=candidates, neighbours=[[-1, 1, -1, -1], [-1, 2, -1, 0], [-1, -1, -1, 1]],
    )  # fmt: skip


NEAREST = [
    # over a common edge the first of the candidates is taken, or what was met last is kept
    ((2.0, 0.5, 0.4), {}, (0, 1.0, -0.5, 0.4, False)),
    ((2.0, 0.5, 0.4), {"candidates": (1, 0)}, (1, -1.0, -0.5, 0.4, False)),
    ((2.0, 0.5, 0.4), {"last": 1}, (1, -1.0, -0.5, 0.4, False)),
    # another takes the place of the last where it is closer, and only there
    ((0.5, 1.5, -0.4), {"last": 2}, (0, -0.5, 0.5, 0.4, False)),
    ((4.5, 1.5, 0.4), {"last": 2}, (2, -0.5, 0.5, 0.4, False)),
    # of equally close ones that which the node is over, not one whose rim it is beyond by a hair
    ((2.0 - 1e-7, 0.5, 0.4), {"last": 1}, (0, 1.0 - 1e-7, -0.5, 0.4, False)),
    # beyond all rims: the closest point of the edges
    ((-0.3, 0.5, 0.4), {}, (0, -1.0, -0.5, 0.5, True)),
    ((3.0, 2.3, -0.4), {"last": 0}, (1, 0.0, 1.0, 0.5, True)),
    ((6.3, 2.0, 0.4), {"last": 2, "candidates": (1,)}, (2, 1.0, 1.0, 0.5, True)),
    # what was met last needs no candidate; without either there is none
    ((5.0, 1.0, 0.1), {"last": 2, "candidates": ()}, (2, 0.0, 0.0, 0.1, False)),
]


@pytest.mark.parametrize(("place", "given", "found"), NEAREST)
def test_the_nearest_face_of_a_node_over_a_row_of_squares(place, given, found):
    face, xi, eta, distance, rim = as_written(contact_kernels.nearest_face, {})(three_squares(place, **given), 8)
    assert (face, rim) == (found[0], found[4])
    assert (xi, eta, distance) == pytest.approx(found[1:4], abs=1e-9)


def test_a_face_whose_sphere_is_farther_than_the_closest_one_is_not_looked_at():
    """Its middle is 3 m away: closer than 1.2 and 1.9 m together, farther than 1 and 1.9 m."""
    far = as_written(contact_kernels.is_far, {})
    square = [(x - 4.0, y + 1.0, 5.0) for x, y in ((-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0))]
    assert not far(*square, 1.9, (-2.0, 2.0, 7.0), 1.2)
    assert far(*square, 1.9, (-2.0, 2.0, 7.0), 1.0)
    late = three_squares((4.2, 1.0, 0.5), last=0, radius=2.1)
    assert as_written(contact_kernels.nearest_face, {})(late, 8)[0] == 2


def test_where_a_node_touched_is_where_its_next_foot_is_sought():
    shape = np.array([kernels.shape_functions(0.3, -0.6)] * 2)
    met = as_written(contact_kernels.met_last, {})
    nodal = SimpleNamespace(touches=[0, 1], shape=shape)
    assert met(nodal, 0) == (0.0, 0.0)
    assert met(nodal, 1) == pytest.approx((0.3, -0.6), abs=1e-15)


def test_a_vector_points_inward_of_a_face_against_its_normal():
    state, behind = three_squares((0.0, 0.0, 9.0)), as_written(contact_kernels.is_behind, {})
    state.place[:, 2] = 0.5 * state.place[:, 0]  # the normal is (-1, 0, 2) / sqrt(5)
    assert behind(state, 1, (1.0, 7.0, 0.4))
    assert not behind(state, 1, (1.0, 7.0, 0.6))
    assert not behind(state, 1, (2.0, -3.0, 1.0))  # within its plane
    assert behind(state, 0, (0.0, 0.0, -0.004))
    assert not behind(state, -1, (0.0, 0.0, -1.0))


@pytest.mark.parametrize(
    ("xi", "eta", "edges"),
    [
        (0.3, -0.2, ()),
        (0.3, -1.0, (0,)),
        (1.0, 0.4, (1,)),
        (-0.9, 1.0, (2,)),
        (-1.0, 0.0, (3,)),
        (1.0, 1.0, (1, 2)),
        (-1.0, -1.0, (0, 3)),
    ],
)
def test_behind_an_edge_is_in_a_valley_where_it_is_behind_the_face_across(xi, eta, edges):
    """For each way of having the faces across the four edges before or behind the vector."""
    state, valley = three_squares((0.0, 0.0, 0.0)), as_written(contact_kernels.in_valley, {})
    off = (-1.0, 0.0, -0.1)
    for behind in range(16):
        state.neighbours[1] = [0 if behind >> k & 1 else 2 for k in range(4)]
        state.place[:8, 2] = [0.0, 0.0, -4.0, -4.0, 0.0, 0.0, 4.0, 4.0]
        # the first falls along x, its normal is (2, 0, 1): behind; the third rises, its normal (-2, 0, 1): before
        assert valley(state, 1, xi, eta, off) == all(behind >> k & 1 for k in edges)


def test_offsets_of_gaps_by_hand():
    """An overlap counts from where it was let out; of a depth below that a share is kept; who moves out takes it along."""
    moved = as_written(touch_kernels.moved_offset, {})
    assert moved(-0.1, -0.5, -0.3, 0.25) == pytest.approx(-0.25)
    assert moved(-0.1, -0.5, -0.05, 0.25) == -0.1
    assert moved(-0.3, -0.1, -0.3, 0.25) == -0.1
    assert moved(-0.3, 0.2, -0.2, 0.25) == 0.0
    depth = as_written(contact_kernels.depth_of, {})
    for known, share, expected in ((1, 1.0, 0.4), (0, 1.0, 0.1), (1, 0.5, 0.1)):
        nodal = SimpleNamespace(offset=[9.0, -0.1], known=[1 - known, known])
        assert depth(nodal, 1, -0.5, -0.4, share, 1.0) == pytest.approx(expected)
        assert nodal.offset == [9.0, pytest.approx(expected - 0.5)]


def test_what_boundaries_leave_and_what_rubs_by_hand():
    free = as_written(touch_kernels.free_fraction, {})
    held = np.array([np.zeros((3, 3)), np.outer([0.6, 0.0, 0.8], [0.6, 0.0, 0.8]), 1.001 * np.eye(3)])
    touch = SimpleNamespace(held=held)
    assert free(touch, 0, (0.0, 1.0, 0.0)) == 1.0
    assert free(touch, 1, (0.0, 0.6, 0.8)) == pytest.approx(1.0 - 0.64**2)
    assert free(touch, 2, (1.0, 0.0, 0.0)) == 0.0
    rub = as_written(touch_kernels.coulomb_force, {})
    assert rub((3.0, 0.0, -4.0), 2.0, 20.0) == pytest.approx((-6.0, 0.0, 8.0))
    assert rub((3.0, 0.0, -4.0), 2.0, 5.0) == pytest.approx((-3.0, 0.0, 4.0))
    assert rub((0.003, 0.0, -0.004), 2.0, 5.0) == pytest.approx((-0.006, 0.0, 0.008))
    assert rub((0.0, 0.0, 0.0), 2.0, 5.0) == (0.0, 0.0, 0.0)
    assert as_written(touch_kernels.along, {})((0.0, -6.0, 8.0)) == pytest.approx((0.0, -0.6, 0.8))
    assert as_written(touch_kernels.along, {})((0.0, 0.0, 0.0)) == (0.0, 0.0, 0.0)
    kept = as_written(touch_kernels.kept_depth, {})
    steps = SimpleNamespace(step=[0.0])
    assert [kept(steps, dt) for dt in (4.0, 3.0, 3.0, 5.0)] == [1.0, 0.75, 1.0, 1.0]


@pytest.mark.parametrize(("area", "expected"), [(0.5, 1.0 + 20.0), (100.0, 1.0 + 0.5)])
def test_the_inverse_mass_of_a_node_against_a_face_by_hand(area, expected):
    """Corners of 1/m = 5, 10, 20, 0 with shares 0.2, 0.1, 0.1, 0.6 and areas 6, 2, 1, 7; the node has a quarter of 4.

    By area (0.2 5 6 + 0.1 10 2 + 0.1 20 1) / A, and at least 0.2^2 5 + 0.1^2 10 + 0.1^2 20.
    """
    held = np.zeros((5, 3, 3))
    held[4] = np.outer([0.0, 0.0, 1.0], [0.0, 0.0, 1.0]) * 0.75
    touch = SimpleNamespace(held=held, area=[6.0, 2.0, 1.0, 7.0, area])
    state = SimpleNamespace(faces=[[0, 1, 2, 3]], inverse_mass=[5.0, 10.0, 20.0, 0.0, 4.0], touch=touch)
    inverse = as_written(contact_kernels.relative_inverse_mass, {})(state, 4, 0, (0.2, 0.1, 0.1, 0.6), (0.0, 0.0, 1.0))
    assert inverse == pytest.approx(expected)
