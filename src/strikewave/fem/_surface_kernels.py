"""Compiled geometry of surfaces: closest points of bilinear faces, nodal areas, the search of faces near nodes."""

import math

import numpy as np

from strikewave.base.compiled import called_kernel, kernel, leaf_kernel

_INSIDE = 1e-9
"""Distance beyond 1 of a natural coordinate of a point that is over the face: far above the rounding of coordinates,
1e-16, far below anything that a force could show."""
_NEWTON = 12
"""Most steps of Newton's method; two or three are usual, and on a folded face there may be no root."""
_CONVERGED = 1e-11
"""Square of the last step times the warp of the face: the error that Newton's method leaves in xi and eta after it,
well below `_INSIDE`."""
_CONVEX = 1e-3
"""Share of the determinant without curvature below which the curvature of the face is left out.

There Newton's matrix is close to singular, as for a point near a centre of curvature; without the curvature the step is
that of Gauss and Newton, which always goes downhill."""
_AT_CORNER = 0.01
"""Square of the distance from a corner over that from the middle below which Newton's method begins at the corner.

It then takes one step in place of three, where meshes meet corner on corner; farther away the middle finds the root of
warped faces more surely."""
_FARTHEST = 2.0
"""Largest xi and eta that a step may reach: beyond 1 the rim decides anyway, and a warped face folds far outside."""
_MOST_CELLS = 1000.0
"""Cells along the longest axis at first; they are widened then, so that tiny faces of a long body cost no loop."""
_CELLS_PER_NODE, _FEWEST_CELLS = 4, 64
"""Bounds of the cells of a search, which keep their memory that of the nodes; a few more for tiny surfaces."""
_WIDER = 1.3
"""Factor by which cells widen until they are few enough: about half the cells a step, so that a few steps do."""
_TINY = 1e-300
"""Keeps a division by zero out where edges or faces have no extent; no length of a mesh squares to as little."""


@leaf_kernel
def row(table, i):
    """Return a row of three as a tuple."""
    return table[i, 0], table[i, 1], table[i, 2]


@leaf_kernel
def as_tuple(a):
    """Return an array of three as a tuple."""
    return a[0], a[1], a[2]


@leaf_kernel
def store(table, i, a):
    """Write a tuple of three to a row."""
    table[i, 0], table[i, 1], table[i, 2] = a[0], a[1], a[2]


@leaf_kernel
def add_scaled(a, s, b):
    """Return a + s b."""
    return a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]


@leaf_kernel
def dot(a, b):
    """Return a . b."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@leaf_kernel
def cross(a, b):
    """Return a x b."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@leaf_kernel
def scaled(a, s):
    """Return s a."""
    return s * a[0], s * a[1], s * a[2]


@leaf_kernel
def shape_functions(xi, eta):
    """Return N_i = (1 + xi_i xi)(1 + eta_i eta)/4 of the corners of a face."""
    a, b, c, d = 1.0 - xi, 1.0 + xi, 1.0 - eta, 1.0 + eta
    return 0.25 * a * c, 0.25 * b * c, 0.25 * b * d, 0.25 * a * d


@leaf_kernel
def patch(a, b, c, d):
    """Return m, e, g, h of the face m + xi e + eta g + xi eta h with the corners a, b, c, d."""
    ac, bd = add_scaled(a, 1.0, c), add_scaled(b, 1.0, d)
    ca, db = add_scaled(c, -1.0, a), add_scaled(d, -1.0, b)
    return (
        scaled(add_scaled(ac, 1.0, bd), 0.25),
        scaled(add_scaled(ca, -1.0, db), 0.25),
        scaled(add_scaled(ca, 1.0, db), 0.25),
        scaled(add_scaled(ac, -1.0, bd), 0.25),
    )


@leaf_kernel
def along(x, a, b):
    """Return the place t from -1 at a to 1 at b of the point of a straight edge closest to x, and their distance^2."""
    edge = add_scaled(b, -1.0, a)
    t = dot(add_scaled(x, -1.0, a), edge) / max(dot(edge, edge), _TINY)
    t = min(max(t, 0.0), 1.0)
    off = add_scaled(add_scaled(x, -1.0, a), -t, edge)
    return 2.0 * t - 1.0, dot(off, off)


@called_kernel
def on_rim(x, a, b, c, d):
    """Return xi, eta of the point of the four edges of a face closest to x, and their distance^2."""
    t, least = along(x, a, b)
    xi, eta = t, -1.0
    t, distance = along(x, b, c)
    if distance < least:
        xi, eta, least = 1.0, t, distance
    t, distance = along(x, c, d)
    if distance < least:
        xi, eta, least = -t, 1.0, distance
    t, distance = along(x, d, a)
    if distance < least:
        xi, eta, least = -1.0, -t, distance
    return xi, eta, least


@leaf_kernel
def apart(x, a):
    """Return the square of the distance of two points."""
    off = add_scaled(x, -1.0, a)
    return dot(off, off)


@leaf_kernel
def middle_of(a, b, c, d):
    """Return the mean of the corners of a face."""
    return scaled(add_scaled(add_scaled(a, 1.0, b), 1.0, add_scaled(c, 1.0, d)), 0.25)


@leaf_kernel
def first_guess(x, a, b, c, d):
    """Return xi, eta of the corner of a face that x is at, or of its middle where it is at none."""
    at_a, at_b, at_c, at_d = apart(x, a), apart(x, b), apart(x, c), apart(x, d)
    near = _AT_CORNER * apart(x, middle_of(a, b, c, d))
    if min(at_a, at_b, at_c, at_d) > near:
        return 0.0, 0.0
    xi = 1.0 if min(at_b, at_c) <= near else -1.0
    eta = 1.0 if min(at_c, at_d) <= near else -1.0
    return xi, eta


@leaf_kernel
def foot_of(x, a, b, c, d, xi, eta):
    """Return xi, eta of the foot of x on a bilinear face that goes on beyond its edges, and their distance^2.

    Newton's method for r . p_xi = r . p_eta = 0, r = p - x, from a first guess. The error after a step is about its
    square times the warp h / e.
    """
    m, e, g, h = patch(a, b, c, d)
    warp = math.sqrt(dot(h, h) / max(min(dot(e, e), dot(g, g)), _TINY))
    for _ in range(_NEWTON):
        r = add_scaled(add_scaled(add_scaled(add_scaled(m, -1.0, x), xi, e), eta, g), xi * eta, h)
        t, s = add_scaled(e, eta, h), add_scaled(g, xi, h)
        tt, ss, ts, rh = dot(t, t), dot(s, s), dot(t, s), dot(r, h)
        full = tt * ss - (ts + rh) ** 2  # with the curvature of the face; not positive beyond its centre of curvature
        mixed = ts + rh if full > _CONVEX * tt * ss else ts
        per_det = 1.0 / max(tt * ss - mixed * mixed, _TINY)
        rt, rs = dot(r, t), dot(r, s)
        step, step2 = (rs * mixed - rt * ss) * per_det, (rt * mixed - rs * tt) * per_det
        xi = min(max(xi + step, -_FARTHEST), _FARTHEST)
        eta = min(max(eta + step2, -_FARTHEST), _FARTHEST)
        moved = abs(step) + abs(step2)
        if moved * moved * warp < _CONVERGED:
            break
    r = add_scaled(add_scaled(add_scaled(add_scaled(m, -1.0, x), xi, e), eta, g), xi * eta, h)
    return xi, eta, dot(r, r)


@leaf_kernel
def is_beyond(xi, eta):
    """Return whether a foot lies outside its face."""
    return abs(xi) > 1.0 + _INSIDE or abs(eta) > 1.0 + _INSIDE


@leaf_kernel
def closest_point(x, a, b, c, d, xi, eta):
    """Return xi, eta of the point of a bilinear face closest to x, their distance^2, and whether it lies on the rim.

    It is the foot of x; where that lies outside the face, or Newton's method finds none, the closest point of the four
    straight edges. ``xi`` and ``eta`` are a first guess.
    """
    xi, eta, square = foot_of(x, a, b, c, d, xi, eta)
    if is_beyond(xi, eta):
        xi, eta, square = on_rim(x, a, b, c, d)
        return xi, eta, square, True
    return min(max(xi, -1.0), 1.0), min(max(eta, -1.0), 1.0), square, False


@leaf_kernel
def face_extent(face, place, faces, size, radius):
    """Write the root of the area and the radius of a face; return its area."""
    a, b = row(place, faces[face, 0]), row(place, faces[face, 1])
    c, d = row(place, faces[face, 2]), row(place, faces[face, 3])
    across = cross(add_scaled(c, -1.0, a), add_scaled(d, -1.0, b))
    whole = 0.5 * math.sqrt(dot(across, across))
    size[face] = math.sqrt(whole)
    m, _, _, _ = patch(a, b, c, d)
    furthest = 0.0
    for corner in (a, b, c, d):
        off = add_scaled(corner, -1.0, m)
        furthest = max(furthest, dot(off, off))
    radius[face] = math.sqrt(furthest)
    return whole


@kernel
def add_areas(place, faces, area, size, radius):
    """Add a quarter of each face's area to its corners; fill the root of the area and the radius of each face."""
    for face in range(faces.shape[0]):
        whole = face_extent(face, place, faces, size, radius)
        for c in range(4):
            area[faces[face, c]] += 0.25 * whole


@leaf_kernel
def face_box(face, place, faces, reach, boxes):
    """Write the least and the greatest coordinates of a face, widened by a reach."""
    for c in range(3):
        low, high = np.inf, -np.inf
        for k in range(4):
            value = place[faces[face, k], c]
            low, high = min(low, value), max(high, value)
        boxes[face, c], boxes[face, 3 + c] = low - reach, high + reach


@leaf_kernel
def in_box(place, n, boxes, k):
    """Return whether a node lies in a box."""
    inside = True
    for c in range(3):
        inside = inside and boxes[k, c] <= place[n, c] <= boxes[k, 3 + c]
    return inside


@kernel
def face_boxes(place, faces, reach):
    """Return the boxes of faces, each widened by its reach, (faces, 6): see `face_box`."""
    boxes = np.empty((faces.shape[0], 6))
    for face in range(faces.shape[0]):
        face_box(face, place, faces, reach[face], boxes)
    return boxes


@kernel
def cells_of(low, high, count, wanted):
    """Return the number of cells by axis and their widths: about as wide as wanted, few beside the nodes."""
    cells = np.ones(3, np.int64)
    length = np.maximum(high - low, _TINY)  # flat surfaces have no extent across
    width = max(wanted, length.max() / _MOST_CELLS, _TINY)
    while True:
        for c in range(3):
            cells[c] = int(length[c] / width) + 1
        if cells[0] * cells[1] * cells[2] <= _CELLS_PER_NODE * count + _FEWEST_CELLS:
            return cells, length / cells
        width *= _WIDER


@leaf_kernel
def cell_of(value, low, width, cells):
    """Return the cell that a coordinate lies in, or the nearest."""
    return min(max(int((value - low) / width), 0), cells - 1)


@kernel
def buckets(place, inside, low, width, cells):
    """Return the nodes in the order of their cells, and where those of each cell begin."""
    number = np.empty(inside.shape[0], np.int64)
    begin = np.zeros(cells[0] * cells[1] * cells[2] + 1, np.int64)
    for j in range(inside.shape[0]):
        n = inside[j]
        i0 = cell_of(place[n, 0], low[0], width[0], cells[0])
        i1 = cell_of(place[n, 1], low[1], width[1], cells[1])
        i2 = cell_of(place[n, 2], low[2], width[2], cells[2])
        number[j] = (i0 * cells[1] + i1) * cells[2] + i2
        begin[number[j] + 1] += 1
    begin = np.cumsum(begin)
    order = np.empty_like(inside)
    fill = begin[:-1].copy()
    for j in range(inside.shape[0]):
        order[fill[number[j]]] = inside[j]
        fill[number[j]] += 1
    return order, begin


@called_kernel
def count_candidates(place, boxes, face, grid, count, candidates, filling):
    """Count, or fill in, the nodes that lie in the box of a face; count[n] is then where the next face of n goes."""
    order, begin, low, high, width, cells = grid
    box = boxes[face]
    if (box[0] > high[0] or box[1] > high[1] or box[2] > high[2]) or (
        box[3] < low[0] or box[4] < low[1] or box[5] < low[2]
    ):
        return
    a0, b0 = cell_of(box[0], low[0], width[0], cells[0]), cell_of(box[3], low[0], width[0], cells[0])
    a1, b1 = cell_of(box[1], low[1], width[1], cells[1]), cell_of(box[4], low[1], width[1], cells[1])
    a2, b2 = cell_of(box[2], low[2], width[2], cells[2]), cell_of(box[5], low[2], width[2], cells[2])
    for i0 in range(a0, b0 + 1):
        for i1 in range(a1, b1 + 1):
            line = (i0 * cells[1] + i1) * cells[2]
            for j in range(begin[line + a2], begin[line + b2 + 1]):
                n = order[j]
                if not in_box(place, n, boxes, face):
                    continue
                if filling:
                    candidates[count[n]] = face
                count[n] += 1


@kernel
def nodes_within(place, checked, nodes, boxes):
    """Return the nodes of a range, if to be checked, that lie within the bounds of all boxes; the mean box width."""
    low, high, wide = np.full(3, np.inf), np.full(3, -np.inf), 0.0
    for face in range(boxes.shape[0]):
        for c in range(3):
            low[c], high[c] = min(low[c], boxes[face, c]), max(high[c], boxes[face, 3 + c])
            wide += (boxes[face, 3 + c] - boxes[face, c]) / (3.0 * boxes.shape[0])
    inside = np.empty(nodes[1] - nodes[0], np.int64)
    count = 0
    for n in range(nodes[0], nodes[1]):
        x, y, z = row(place, n)
        if checked[n] and low[0] <= x <= high[0] and low[1] <= y <= high[1] and low[2] <= z <= high[2]:
            inside[count] = n
            count += 1
    return inside[:count], wide


@kernel
def grid(place, checked, nodes, boxes):
    """Return nodes sorted into cells, where each cell begins, the bounds of the cells, their widths and numbers."""
    inside, wide = nodes_within(place, checked, nodes, boxes)
    low, high = np.full(3, np.inf), np.full(3, -np.inf)
    for n in inside:
        for c in range(3):
            low[c], high[c] = min(low[c], place[n, c]), max(high[c], place[n, c])
    cells, width = np.ones(3, np.int64), np.ones(3)
    if inside.shape[0] > 0:
        cells, width = cells_of(low, high, inside.shape[0], wide)
    order, begin = buckets(place, inside, low, width, cells)
    return order, begin, low, high, width, cells


@kernel
def search(place, checked, faces, reach, split, face_split):
    """Return, for each node, the faces of the other surface in whose widened boxes it lies: start, candidates.

    Nodes are sorted into cells, and each face looks into the cells that its box covers. Faces of a node ascend.
    """
    total, ends = place.shape[0], faces.shape[0]
    boxes = face_boxes(place, faces, reach)
    # nodes of a surface lie in cells that the other one's faces span
    of_first = grid(place, checked, (0, split), boxes[face_split:])
    of_second = grid(place, checked, (split, total), boxes[:face_split])
    start, candidates = np.zeros(total + 1, np.int64), np.empty(0, np.int32)
    for filling in (False, True):  # counted first, then filled in: no list grows
        place_of = start[:-1].copy()
        for face in range(ends):
            others = of_second if face < face_split else of_first
            count_candidates(place, boxes, face, others, place_of, candidates, filling)
        if not filling:
            start[1:] = np.cumsum(place_of)
            candidates = np.empty(start[-1], np.int32)
    return start, candidates


@kernel
def nodes_by_corner(faces, start, candidates, last):
    """Return, for each node, those that may meet a face of which it is a corner: start, nodes, ascending.

    They may meet their ``candidates`` and the face that each met ``last`` (-1: none).
    """
    nodes = last.size
    begin, met = np.zeros(nodes + 1, np.int64), np.empty(0, np.int32)
    for filling in (False, True):
        at, noted = begin[:-1].copy(), np.full(nodes, -1, np.int64)
        for i in range(nodes):
            for k in range(start[i], start[i + 1] + 1):
                face = candidates[k] if k < start[i + 1] else last[i]
                if face < 0:
                    continue
                for c in range(4):
                    corner = faces[face, c]
                    if noted[corner] == i:  # neighbouring faces share corners: each node counts once
                        continue
                    noted[corner] = i
                    if filling:
                        met[at[corner]] = i
                    at[corner] += 1
        if not filling:
            begin[1:] = np.cumsum(at)
            met = np.empty(begin[-1], np.int32)
    return begin, met
