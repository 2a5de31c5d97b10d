"""What a thread of a device does in a search of faces: one face, node or group of faces each.

Faces of the same surface stand in groups of consecutive ones, which in a mesh are neighbours, and a group has a box
about those of its faces: a node that is not in it is in none of them.
"""

from typing import NamedTuple

import numpy as np

from strikewave.base.compiled import leaf_kernel
from strikewave.fem._surface_kernels import face_box, face_extent, in_box


class FaceGroups(NamedTuple):
    """Boxes of faces (faces, 6) and of groups (groups, 6), least before greatest coordinates.

    Group g holds the faces ``edges[g]`` to ``edges[g + 1]``, exclusive; the ``first`` so many are of the first surface.
    """

    edges: np.ndarray
    boxes: np.ndarray
    bounds: np.ndarray
    first: int


@leaf_kernel
def survey_face(face, state, share, boxes, area):
    """Write area, size, radius and box of a face as it lies; the box is wider by a share of the size and the margin."""
    area[face] = face_extent(face, state.place, state.faces, state.size, state.radius)
    state.radius[face] += state.margin
    face_box(face, state.place, state.faces, share * state.size[face] + state.margin, boxes)


@leaf_kernel
def survey_node(n, state, start, places, area):
    """Write the area of a node, a corner of faces at places = 4 face + corner, ascending; forget that it is clear."""
    total = 0.0
    for k in range(start[n], start[n + 1]):
        total += 0.25 * area[places[k] // 4]
    state.touch.area[n] = total
    state.nodal.clear[n] = 0.0


@leaf_kernel
def bound_group(g, groups):
    """Write the box of a group."""
    for c in range(3):
        low, high = np.inf, -np.inf
        for face in range(groups.edges[g], groups.edges[g + 1]):
            low, high = min(low, groups.boxes[face, c]), max(high, groups.boxes[face, 3 + c])
        groups.bounds[g, c], groups.bounds[g, 3 + c] = low, high


@leaf_kernel
def count_near(n, state, groups, count):
    """Write how many faces of the other surface have a node in their boxes."""
    count[n] = list_near(n, state, groups, 0, False, state.candidates)


@leaf_kernel
def fill_near(n, state, groups, start, candidates):
    """Write these faces, ascending, from start[n] on."""
    list_near(n, state, groups, start[n], True, candidates)


@leaf_kernel
def list_near(n, state, groups, at, filling, candidates):
    """Count, or fill in from a place on, the faces near a node; return the place after the last."""
    if not state.checked[n]:
        return at
    first, last = (groups.first, groups.bounds.shape[0]) if n < state.touch.first else (0, groups.first)
    for g in range(first, last):
        if not in_box(state.place, n, groups.bounds, g):
            continue
        for face in range(groups.edges[g], groups.edges[g + 1]):
            if in_box(state.place, n, groups.boxes, face):
                if filling:
                    candidates[at] = face
                at += 1
    return at
