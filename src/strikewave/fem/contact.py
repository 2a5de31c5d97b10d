"""Contact between deformable bodies and with rigid walls, by a penalty on the gap to come, and tied nodes; SI.

A node is pressed out of a face of the other surface by a force that acts on the **predicted gap** g*, the gap that
there would be at the end of the step dt if there were no contact (theory: :eq:`fem-contact`):

    F = s w m* / dt^2 (-g*)  where g* < 0,    g* = (x* - p*) . n,    x* = x + dt (v + dt f/m),

s share of the stiffness that closes the gap within the step (``Contact.stiffness``), w = 1/2 as both surfaces are
checked against each other, p* the closest point of the face, n its normal there, and m* the mass that has to be moved:

    1/m* = 1/m_node + max(1/(mu A), sum N_i^2/m_i),

A the node's share of the area of its surface, mu the mass of the face's nodes per area, N_i the shape functions at p*.
The mass of a node is ``m/(1 - |H n|^2)`` where boundaries hold it along directions H: what counts is how easily it
moves along n (for friction: along the sliding, where that is easier). They hold it before contact is found, so that f
holds their forces, and take afterwards what contact presses onto them. The nodes of a rigid part share the mass of the
body: `strikewave.fem.bodies.surface_inverse_mass`. Tied nodes count by their own mass.

The node pushes the corners of the face back by N_i F: the sum of the forces is zero, and as F runs along x* - p* their
moment is too, within F dt times the velocity that they have beside each other.

Where two surfaces press evenly on each other both passes together close the share s of the gap within a step, whatever
their meshes are: with s = 1 this is contact as a kinematic constraint. Because g* contains dt times the velocity the
force is a spring and a damper in one, and takes energy when surfaces meet: their nodes' share of it, which goes to zero
with the size of the elements. Held by a steady force F the surfaces overlap by (1 - s)/s F dt^2/m*.

Friction is Coulomb's: the force ``s w m*/dt |v_t*|`` that would stop the predicted sliding within the step, at most mu
F, against the sliding. It remembers nothing and can only take energy; what sticks creeps (1 - s)/s dt T/m* a second
under a steady force T.

A node meets one face only, the closest. Behind a valley between two faces it is pressed towards the edge; beyond the
rim of a surface its force fades away between 1/40 and 1/20 of the size of the face. Nodes deeper than half the element
behind a face are not inside it. A node that came inside by another way than through the face, such as beside the rim,
is only kept from going deeper: pressed out of a depth that it never was pressed into it would gain energy. So is one
whose closest face is another at once, and much deeper: the far side of a squashed element.

Where the step gets shorter the stiffness grows, and depths are made to shrink with dt so that they hold no more energy.

Nodes meet faces: two edges that cross where neither has a node inside a face pass through each other, and a surface
does not meet itself.

Linearly, with all nodes touching, the step x' = (1 - s)((2 - Omega^2) x - x_before) is stable for any vibration with
Omega = omega dt <= 2 when 0 < s <= 4/3; above 1 contact overshoots and can give energy as it opens. Bars of lattices at
0.9 of the critical step, with equal and unequal meshes and masses, gained none for any s up to 1.

Before a blow, surfaces that are round but made of flat faces may overlap. Overlaps of less than 1/10 of a face are kept
as the place from which the gap of that node is measured, until the node has moved out of them; deeper ones are refused.

Sources: Hallquist, Goudreau & Benson 1985, Computer Methods in Applied Mechanics and Engineering 51, 107-137 (both
surfaces checked against each other); Taylor & Flanagan 1989, PRONTO 3D, SAND87-1912 (contact found in the motion that
there would be without it).

Nodes of a side tied to faces of another, whose mesh need not match; SI.

A tied node keeps its place p on a face and moves as the face does there: v_s = sum N_i v_i, with the shape functions
N_i of the four corners at p. The corners carry its mass and its force in turn, m_i += N_i m_s and f_i += N_i f_s, so
that momentum is kept exactly, and the work too: f_s . v_s = sum N_i f_s . v_i. Angular momentum is kept as well where
the node lies on the face; one that lies the vector d off it feels the moment d x f_s of a force that is handed on.

A run calls `gather_mass` once, `gather_tied_forces` in each step when all other forces are known (contact too), and
`move_tied` when the new velocities are. A tied node has no mass of its own then: its inverse mass is to be set to 0.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np

from strikewave.base.errors import InputError
from strikewave.fem import _contact_kernels as kernels
from strikewave.fem import _surface_kernels as surface_kernels
from strikewave.fem._contact_kernels import ContactState, NodeContacts, NodeTouch, Step, WallState
from strikewave.fem._history_kernels import shares_of
from strikewave.fem._node_kernels import TieState
from strikewave.fem.mesh import FACES, TINY, Array, Index, Mesh, volumes
from strikewave.fem.model import STIFFNESS, RigidWall, SurfaceContact, Tie
from strikewave.fem.threads import on_all, spans


@dataclass(frozen=True)
class Surface:
    """Faces of a mesh by the place of their corners in ``nodes``."""

    nodes: Index
    """Nodes of the mesh, ascending, (nodes,)."""
    faces: Index
    """Rows of the corners in ``nodes``, (faces, 4)."""


@dataclass(frozen=True)
class Extents:
    """Areas of a surface as it lies."""

    area: Array
    """Share of each node in the area of its faces, m^2, (nodes,)."""
    size: Array
    """Root of the area of each face, m, (faces,)."""
    radius: Array
    """Radius of the sphere about the mean of a face's corners that holds the face, m, (faces,)."""


def surface_of(faces: Index) -> Surface:
    """Return the surface that faces of a mesh make."""
    nodes, places = np.unique(faces, return_inverse=True)
    return Surface(nodes.astype(np.int32), places.reshape(-1, 4).astype(np.int32))


def extents(points: Array, faces: Index) -> Extents:
    """Return nodal areas, sizes and radii of faces whose corners are rows of ``points``.

    The area of a face is half the cross product of its diagonals (of a warped face, that of its projection along the
    mean normal).
    """
    area, size, radius = np.zeros(len(points)), np.zeros(len(faces)), np.zeros(len(faces))
    surface_kernels.add_areas(points, faces, area, size, radius)
    return Extents(area, size, radius)


def have_common(some: Index, others: Index) -> bool:
    """Return whether two lists of faces have one in common."""
    rows = np.concatenate([np.unique(np.sort(faces, axis=1), axis=0) for faces in (some, others)])
    return len(np.unique(rows, axis=0)) < len(rows)


def neighbours(faces: Index) -> Index:
    """Return the face across each edge (corners 0-1, 1-2, 2-3, 3-0) of each face, -1 at the rim, (faces, 4).

    An edge of more than two faces counts as rim.
    """
    edges = np.sort(np.stack([faces, np.roll(faces, -1, axis=1)], axis=2).reshape(-1, 2), axis=1)
    order = np.lexsort((edges[:, 1], edges[:, 0]))
    same = np.all(edges[order[1:]] == edges[order[:-1]], axis=1)
    pair = same & ~np.append(same[1:], False) & ~np.insert(same[:-1], 0, False)
    across = np.full(len(edges), -1, np.int32)
    first, second = order[:-1][pair], order[1:][pair]
    across[first], across[second] = second // 4, first // 4
    return across.reshape(-1, 4)


def thickness(mesh: Mesh, faces: Index) -> Array:
    """Return the volume of the element behind each face over the area of the face, m, (faces,).

    A face that belongs to no element is taken to be as thick as it is wide.
    """
    size = extents(mesh.points, faces).size
    marked = np.zeros(len(mesh.points), bool)
    marked[faces] = True
    behind = np.flatnonzero(marked[mesh.hexahedra].sum(axis=1) >= 4)
    sides = mesh.hexahedra[behind][:, FACES].reshape(-1, 4)
    on_surface = marked[sides].all(axis=1)
    owners = np.append(np.repeat(behind, 6)[on_surface], np.full(len(faces), -1))
    rows = np.sort(np.concatenate([sides[on_surface], faces]), axis=1)
    order = np.lexsort((-owners, *rows.T))  # an owner comes before the -1 of the face itself, which takes it over
    new = np.any(rows[order[1:]] != rows[order[:-1]], axis=1)
    group = np.append(0, np.cumsum(new))
    first = np.flatnonzero(np.append(True, new))
    element = np.empty(len(rows), int)
    element[order] = owners[order[first]][group]
    element = element[len(rows) - len(faces) :]
    depth = np.abs(volumes(mesh.points, mesh.hexahedra[element])) / np.maximum(size, TINY) ** 2
    return np.where(element >= 0, depth, size)


SHALLOW = 0.1  # what a circle of 8 edges cuts off
"""Share of a face's size by which surfaces may overlap before the blow."""
MARGIN = 0.1  # chosen: larger gives every node more faces to look at in each step, smaller more searches
"""Share of a face's size by which surfaces may move before faces are searched again."""
_DEEPEST = 0.5  # beyond the middle the far side is nearer
"""Share of an element behind a face within which a node is inside it."""
_FIRST_REACH = 1.1  # no overlap is missed by rounding
"""Factor on `_DEEPEST` within which faces are looked for before the first step."""
REACH = 0.25  # a node that is deeper keeps the face it has
"""Share of a face's size within which nodes are candidates in a run."""

NODES = 500  # fewer take less time than handing the work to a thread
"""Fewest nodes whose contact a thread finds."""


@dataclass(frozen=True)
class Overlap:
    """Nodes that are inside a face before the blow."""

    contact: str
    """Name of the contact or wall."""
    nodes: int
    """Number of nodes."""
    deepest: float
    """Deepest overlap, m."""
    node: int
    """Node of the deepest overlap."""
    place: tuple[float, float, float]
    """Place of that node, m."""
    size: float
    """Size of the face that it is inside of, m."""


def prepare(
    contact: SurfaceContact, mesh: Mesh, unchecked: Sequence[int] | Index = (), points: Array | None = None
) -> ContactState:
    """Return a contact ready for the first step of a run that starts from the points of the mesh.

    Nodes that are ``unchecked`` (tied ones) are met by the other surface but not checked against it. Where a blow has
    moved the nodes to other ``points`` (nodes, 3), overlaps of any depth are let out.
    """
    _check(contact)
    state = two_surfaces(contact, mesh)
    state.checked[:] = ~np.isin(state.touch.nodes, np.asarray(unchecked, np.int32))
    places = mesh.points if points is None else points
    state = searched(state, places, _FIRST_REACH * _DEEPEST)
    gaps = _gaps_now(state, places)
    overlap = _overlap(contact.name, state.touch.nodes, gaps, places, state.size[state.nodal.face])
    if points is None and overlap is not None and overlap.deepest > SHALLOW * overlap.size:
        raise _too_deep(overlap, mesh)
    state.nodal.offset[:] = gaps
    state.touch.step[0] = 0.0  # the trial of `_gaps_now` was no step: depths must not shrink with it
    return state


def prepare_all(
    contacts: Sequence[SurfaceContact], mesh: Mesh, unchecked: Sequence[int] | Index = (), points: Array | None = None
) -> dict[str, ContactState]:
    """Return all contacts of a run by name, as `prepare` does."""
    for earlier, later in itertools.combinations(contacts, 2):
        for pair in ((later.first, later.second), (later.second, later.first)):
            if all(
                have_common(mesh.side(a), mesh.side(b))
                for a, b in zip((earlier.first, earlier.second), pair, strict=True)
            ):
                raise InputError(
                    f"contact {later.name}",
                    f"faces that meet already in {earlier.name}",
                    "each two faces in one contact",
                    "together they would be twice as stiff: leave one of them out",
                )
    return {contact.name: prepare(contact, mesh, unchecked, points) for contact in contacts}


def note_held(touch: NodeTouch, nodes: Index, directions: Array) -> None:
    """Note that boundaries hold nodes along directions, up to three orthonormal ones (nodes, 3, 3), others zeros."""
    _, here, there = np.intersect1d(touch.nodes, nodes, assume_unique=True, return_indices=True)
    touch.held[here] += np.einsum("nki,nkj->nij", directions[there], directions[there])


def two_surfaces(contact: SurfaceContact, mesh: Mesh) -> ContactState:
    """Return the state of a contact that has searched nothing yet."""
    first, second = (surface_of(mesh.side(name)) for name in (contact.first, contact.second))
    shared = np.intersect1d(first.nodes, second.nodes).size
    if shared:
        raise InputError(
            f"{contact.first} and {contact.second}", f"{shared} common nodes", "sides without common nodes"
        )
    nodes = np.concatenate([first.nodes, second.nodes])
    faces = np.concatenate([first.faces, second.faces + np.int32(len(first.nodes))])
    across = neighbours(faces)
    now = extents(mesh.points[nodes], faces)
    split, sizes = len(first.faces), now.size
    count = len(nodes)
    nodal = NodeContacts(
        face=np.full(count, -1, np.int32),
        shape=np.zeros((count, 4)),
        gap=np.full(count, np.inf),
        normal_force=np.zeros((count, 3)),
        friction_force=np.zeros((count, 3)),
        touches=np.zeros(count, np.uint8),
        clear=np.zeros(count),
        offset=np.zeros(count),
        known=np.zeros(count, np.uint8),
    )
    return ContactState(
        touch=_touch(nodes, len(first.nodes), now.area),
        nodal=nodal,
        faces=faces,
        neighbours=across,
        size=sizes,
        radius=now.radius,
        limit=_DEEPEST * np.minimum(thickness(mesh, nodes[faces]), sizes),
        checked=np.ones(count, np.bool_),
        start=np.zeros(count + 1, np.int64),
        candidates=np.zeros(0, np.int32),
        place=np.zeros((count, 3)),
        moving=np.zeros((count, 3)),
        inverse_mass=np.zeros(count),
        travel=np.zeros(1),
        speeds=np.zeros((shares_of(count), kernels.SPEEDS)),
        first_faces=split,
        margin=MARGIN * float(min(np.median(sizes[:split]), np.median(sizes[split:]))),
        stiffness=float(contact.stiffness),
        coefficient=float(contact.friction),
    )


def searched(state: ContactState, points: Array, reach: float = REACH) -> ContactState:
    """Return the contact with nodal areas and candidate faces for where the nodes, (nodes, 3), are now.

    ``reach`` is the share of a face's size within which nodes are candidates; `MARGIN` comes on top.
    """
    place = points[state.touch.nodes]
    now = extents(place, state.faces)
    state.touch.area[:], state.size[:] = now.area, now.size
    state.radius[:] = now.radius + state.margin
    widening = reach * now.size + state.margin
    start, candidates = surface_kernels.search(
        place, state.checked, state.faces, widening, state.touch.first, state.first_faces
    )
    state.nodal.clear[:] = 0.0
    state.travel[0] = 0.0
    return state._replace(start=start, candidates=candidates)


def add_contact(
    state: ContactState,
    x: Array,
    v: Array,
    f: Array,
    inverse_mass: Array,
    dt: float,
    kick: float = 0.0,
    pool: ThreadPoolExecutor | None = None,
    threads: int = 1,
) -> bool:
    """Add the contact's forces to the nodal forces f; return whether the faces must be searched before the next step.

    x is at t_n, v at t_(n-1/2), f holds every other force at t_n, inverse_mass (nodes,) is 0 where nodes move as if
    nothing touched them. The forces act on v for the time ``kick``, which is dt (0: the same) but where the step
    changes; then x moves for dt. The number of threads changes no bit: each node's force is found by itself, and those
    on either surface are summed by one thread.
    """
    count, split = len(state.touch.nodes), state.touch.first
    shares = spans(
        count, threads, NODES
    )  # the step's travel needs all predictions, the scatter all forces: three calls
    step = Step(dt, kick if kick > 0.0 else dt, 0.0, 1.0)
    on_all(pool, kernels.predict_positions, [(state, x, v, f, inverse_mass, step, *span) for span in shares])
    step = kernels.begin_step(state, step)
    on_all(pool, kernels.press_nodes, [(state, step, *span) for span in shares])
    sides = ((0, split), (split, count))
    on_all(pool if len(shares) > 1 else None, kernels.scatter_forces, [(state, f, *side) for side in sides])
    return bool(state.travel[0] + 2.0 * step.travel > state.margin)  # allows the next step twice this travel


def prepare_wall(
    wall: RigidWall, mesh: Mesh, unchecked: Sequence[int] | Index = (), points: Array | None = None
) -> WallState:
    """Return a wall ready for the first step of a run that starts from the points of the mesh.

    It is not there for nodes that are ``unchecked`` (tied ones). Other ``points`` (nodes, 3) are as for `prepare`.
    """
    length = float(np.linalg.norm(wall.normal))
    if not 0.0 < length < np.inf:
        raise InputError(f"wall {wall.name}.normal", wall.normal, "a vector other than zero")
    if not 0.0 <= wall.friction < np.inf:
        raise InputError(f"wall {wall.name}.friction", wall.friction, "at least 0")
    surface = surface_of(mesh.side(wall.side))
    nodes = np.setdiff1d(surface.nodes, unchecked)
    direction = np.array(wall.normal) / length
    places = mesh.points if points is None else points
    gaps = (places[nodes] - np.array(wall.point)) @ direction
    now = extents(places[surface.nodes], surface.faces)
    overlap = _overlap(wall.name, nodes, gaps, places, np.full(len(gaps), float(np.median(now.size))))
    if points is None and overlap is not None and overlap.deepest > SHALLOW * overlap.size:
        raise _too_deep(overlap, mesh)
    return WallState(
        _touch(nodes.astype(np.int32), len(nodes), now.area[np.isin(surface.nodes, nodes)]),
        np.minimum(gaps, 0.0),
        np.array(wall.point, float),
        direction,
        STIFFNESS,
        float(wall.friction),
    )


def initial_overlaps(states: Sequence[tuple[str, ContactState | WallState]], points: Array) -> list[Overlap]:
    """Return where prepared contacts and walls, each with its name, overlap before the blow."""
    overlaps = []
    for name, state in states:
        if isinstance(state, ContactState):
            overlap = _overlap(name, state.touch.nodes, state.nodal.offset, points, state.size[state.nodal.face])
        else:
            overlap = _overlap(name, state.touch.nodes, state.offset, points, np.zeros(len(state.offset)))
        if overlap is not None:
            overlaps.append(overlap)
    return overlaps


def _check(contact: SurfaceContact) -> None:
    where = f"contact {contact.name}"
    if contact.first == contact.second:
        raise InputError(where, contact.second, "two different sides")
    if not 0.0 <= contact.friction < np.inf:
        raise InputError(f"{where}.friction", contact.friction, "at least 0")
    if not 0.0 < contact.stiffness <= 1.0:
        raise InputError(f"{where}.stiffness", contact.stiffness, "above 0 to 1")


def _touch(nodes: Index, first: int, area: Array) -> NodeTouch:
    velocity, normal, friction = np.zeros((3, len(nodes), 3))
    return NodeTouch(nodes, first, area, np.zeros((len(nodes), 3, 3)), velocity, normal, friction, np.zeros(1))


def _gaps_now(state: ContactState, points: Array) -> Array:
    """Return the gap of each node as it lies, zero or negative: minus its depth inside a face."""
    state.nodal.offset[:] = -np.inf  # a trial step of a second without motion then writes the gap that it finds
    still, forces, fixed = np.zeros_like(points), np.zeros_like(points), np.zeros(len(points))
    add_contact(state, points, still, forces, fixed, 1.0)
    return np.where(np.isfinite(state.nodal.offset), state.nodal.offset, 0.0)


def _overlap(name: str, nodes: Index, gaps: Array, points: Array, size: Array) -> Overlap | None:
    if not np.any(gaps < 0.0):
        return None
    worst = int(np.argmin(gaps))
    node = int(nodes[worst])
    x, y, z = (float(c) for c in points[node])
    return Overlap(name, int(np.sum(gaps < 0.0)), -float(gaps[worst]), node, (x, y, z), float(size[worst]))


def _too_deep(overlap: Overlap, mesh: Mesh) -> InputError:
    part = next((name for name in mesh.names if overlap.node in mesh.nodes_of(name)), "no part")
    place = ", ".join(f"{c:.6g}" for c in overlap.place)
    return InputError(
        f"contact {overlap.contact}",
        f"overlap of {overlap.deepest:.3g} m at ({place}) m in {part}",
        f"at most {SHALLOW:g} of the size of a face there, {SHALLOW * overlap.size:.3g} m",
        f"{overlap.nodes} nodes overlap: move the parts apart, or match their meshes",
    )


NEAR = 0.1  # what a circle of 8 edges cuts off, as `SHALLOW`; farther off, the moment of forces handed on would count
"""Share of a face's size by which a node may lie off the face it is tied to."""
TIE_REACH = 2.0  # a node just too far off is reported with its distance
"""Factor on `NEAR` within which faces are looked for."""


def prepare_ties(ties: Sequence[Tie], mesh: Mesh) -> TieState:
    """Return the tied nodes of all ties, each with the face that is closest to it.

    Raises
    ------
    InputError
        If a side is not there, nodes lie further off than `NEAR`, are on both sides, tied twice, or tied to faces with
        tied corners.
    """
    states = [_tied(tie, mesh) for tie in ties]
    if not states:
        return TieState(np.zeros(0, np.int32), np.zeros((0, 4), np.int32), np.zeros((0, 4)))
    state = TieState(*(np.concatenate(column) for column in zip(*states, strict=True)))
    nodes, times = np.unique(state.nodes, return_counts=True)
    if np.any(times > 1):
        raise InputError("tie", f"{int(np.sum(times > 1))} nodes of two ties", "each node tied once")
    chained = np.intersect1d(nodes, state.corners).size
    if chained:
        raise InputError(
            "tie", f"{chained} tied nodes at corners of faces tied to", "faces whose corners are not tied themselves"
        )
    return state


def _tied(tie: Tie, mesh: Mesh) -> TieState:
    state = searched(two_surfaces(SurfaceContact(tie.side, tie.onto), mesh), mesh.points, TIE_REACH * NEAR)
    count = state.touch.first
    face, shape, distance = np.zeros(count, np.int32), np.zeros((count, 4)), np.full(count, np.inf)
    state.place[:] = mesh.points[state.touch.nodes]
    kernels.nearest_faces(state, face, shape, distance)
    off = distance > NEAR * state.size[face]
    if np.any(off):
        close = distance[np.isfinite(distance)]
        furthest = f"the furthest {close.max():.3g} m" if len(close) == count else "some nowhere near"
        raise InputError(
            f"tie of {tie.side}",
            f"{int(off.sum())} of {count} nodes off {tie.onto}, {furthest}",
            f"nodes within {NEAR:g} of the size of a face of {tie.onto}",
            "move the parts together, or tie the smaller side onto the larger one",
        )
    return TieState(state.touch.nodes[:count], state.touch.nodes[state.faces[face]], shape)
