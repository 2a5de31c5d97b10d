"""Snapshots of a run for its pictures, chosen while it goes on, on the visible skin of the model; SI.

Snapshots are kept evenly over the run and, more densely, while the bodies of the blow touch; some follow the first
wave; one is that of the largest stress. Their number is bounded: where too many come, every other one goes.

The skin shows the bodies cut open along a plane, sectors mirrored to halves.

A quarter is mirrored at one of its planes of symmetry and looked at through the other; a half shows its cut as it is;
of bodies that are there as a whole, the elements before a plane along the blow are left out. Planes of symmetry that
count hold the axis of the blow, so that what is along it, and every invariant, is the same in a mirror image.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from strikewave.fem.mesh import TINY, Array, Index, Mesh, exterior, volumes
from strikewave.fem.model import Driven, Model, RigidWall, SurfaceContact, Symmetry
from strikewave.fem.run import FieldFrame
from strikewave.fem.solids import von_mises

if TYPE_CHECKING:
    from strikewave.fem.engine import Engine

Mask = NDArray[np.bool_]

ALONG = 0.1  # within 6 degrees
"""Cosine of the angle of a normal with the axis of the blow below which its plane holds that axis."""
ON_PLANE = 1e-6  # files of meshes keep six digits or more
"""Share of the extent of a model within which a node lies on a plane."""
SHARP = float(np.cos(np.radians(40.0)))  # a circle of 12 edges bends by 30 degrees and looks round; a block by 90
"""Cosine of the angle between neighbouring faces above which their edge is no outline."""
ALONG_Y = 0.9  # a plane across y would cut across the blow
"""Cosine of the angle of a blow with y from which on bodies are cut across x."""


class Plane(NamedTuple):
    """A plane by a point, m, and a unit normal; bodies are behind it, where the normal does not point to."""

    point: Array
    normal: Array

    def height(self, places: Array) -> Array:
        """Return the height of places (..., 3) before the plane, m."""
        return np.asarray((places - self.point) @ self.normal)

    def mirrored(self, vectors: Array) -> Array:
        """Return vectors (..., 3) reflected at the plane; those of places are to be taken from its point."""
        return np.asarray(vectors - 2.0 * (vectors @ self.normal)[..., None] * self.normal)


class Cut(NamedTuple):
    """Plane along which a model is cut open, plane that mirrors it before, and whether the first is a symmetry."""

    plane: Plane
    mirror: Plane | None = None
    symmetric: bool = False


class Edges(NamedTuple):
    """Edges between faces: nodes (edges, 2), their faces (edges, 2), and which are sharp or between parts."""

    nodes: Index
    faces: Index
    sharp: Mask


@dataclass(frozen=True)
class Skin:
    """Faces of a model that is cut open and mirrored."""

    points: Array
    """Points before the blow, m, (points, 3), images behind the others."""
    node: Index
    """Row of each point in ``nodes``."""
    image: Mask
    """Mask of the points that are images."""
    faces: Index
    """Points of each face, (faces, 4), normals outward."""
    element: Index
    """Row of the element of each face in ``elements``."""
    part: Index
    """Index of the part of each face."""
    touching: Index
    """Index of the side of each face among those of all contacts and walls; -1 for none, and for images."""
    nodes: Index
    """Nodes of the mesh at the points."""
    elements: Index
    """Elements of the mesh behind the faces."""
    cut: Cut
    """Cut of the model."""
    axis: Array
    """Unit vector along the blow, (3,)."""
    edges: Edges
    """Edges between the faces."""

    def moved(self, displacement: NDArray[np.floating]) -> Array:
        """Return the places of the points, (points, 3), by the displacement of ``nodes``, m."""
        by = np.asarray(displacement, float)[self.node]
        if self.cut.mirror is not None:
            by[self.image] = self.cut.mirror.mirrored(by[self.image])
        return self.points + by


def skin_of(model: Model, cut: Cut | None = None) -> Skin:
    """Return the visible faces of a model, cut open where it shows most; see `cut_of`."""
    mesh, cut = model.mesh, cut or cut_of(model)
    behind_plane = np.flatnonzero(cut.plane.height(mesh.points[mesh.hexahedra].mean(axis=1)) <= 0.0)
    faces, element = exterior(mesh.hexahedra[behind_plane])
    element = behind_plane[element].astype(np.int32)
    touching = _sides(model, faces)
    node, points = np.arange(len(mesh.points)), mesh.points
    images = np.zeros(len(faces), bool)
    if cut.mirror is not None:
        height = cut.mirror.height(points)
        apart = np.flatnonzero(np.abs(height) > ON_PLANE * _extent(mesh))
        twin = node.copy()
        twin[apart] = len(points) + np.arange(len(apart))
        off_plane = ~np.all(twin[faces] == faces, axis=1)
        faces, element, touching = faces[off_plane], element[off_plane], touching[off_plane]
        points = np.concatenate([points, cut.mirror.point + cut.mirror.mirrored(points[apart] - cut.mirror.point)])
        node = np.concatenate([node, apart])
        images = np.repeat([False, True], len(faces))
        faces = np.concatenate([faces, twin[faces][:, ::-1].astype(np.int32)])
        element, touching = np.tile(element, 2), np.tile(touching, 2)
    part = mesh.part[element]
    touching[images] = -1
    used, renamed = np.unique(faces, return_inverse=True)
    nodes, own = np.unique(node[used], return_inverse=True)
    elements, row = np.unique(element, return_inverse=True)
    faces = renamed.reshape(-1, 4).astype(np.int32)
    return Skin(
        points=points[used],
        node=own.astype(np.int32),
        image=used >= len(mesh.points),
        faces=faces,
        element=row.astype(np.int32),
        part=part.astype(np.int32),
        touching=touching,
        nodes=nodes.astype(np.int32),
        elements=elements.astype(np.int32),
        cut=cut,
        axis=blow_axis(model),
        edges=_edges(points[used], faces, part),
    )


def cut_of(model: Model) -> Cut:
    """Return the cut of a model: at its plane of symmetry of the largest face, mirrored at the one across it.

    Without a plane of symmetry it is cut through the middle of its first contact, or of all, by a plane along the
    blow across y, or x where the blow goes along y.
    """
    planes = symmetry_planes(model)
    if planes:
        across = (plane for plane in planes[1:] if abs(float(plane.normal @ planes[0].normal)) < ALONG)
        return Cut(planes[0], next(across, None), symmetric=True)
    axis, points = blow_axis(model), model.mesh.points
    place = meeting_place(model)
    middle = 0.5 * (points.min(axis=0) + points.max(axis=0)) if place is None else place
    normal = np.array([0.0, -1.0, 0.0]) if abs(axis[1]) < ALONG_Y else np.array([-1.0, 0.0, 0.0])
    return Cut(Plane(middle, normal))


def symmetry_planes(model: Model) -> list[Plane]:
    """Return the planes of symmetry along the blow that all bodies lie behind, that of the largest cut face first."""
    axis, mesh = blow_axis(model), model.mesh
    tiny = ON_PLANE * _extent(mesh)
    planes: list[Plane] = []
    areas: list[float] = []
    for side in (b.side for b in model.boundaries if isinstance(b, Symmetry)):
        corners = mesh.points[mesh.side(side)]
        normals = 0.5 * np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
        total = normals.sum(axis=0)
        plane = Plane(corners.mean(axis=(0, 1)), total / np.linalg.norm(total))
        if abs(float(plane.normal @ axis)) > ALONG or plane.height(mesh.points).max() > tiny:
            continue
        same = [k for k, other in enumerate(planes) if float(other.normal @ plane.normal) > 1.0 - ON_PLANE]
        if same:
            areas[same[0]] += float(np.linalg.norm(total))
        else:
            planes.append(plane)
            areas.append(float(np.linalg.norm(total)))
    between = [any(float(p.normal @ q.normal) < ON_PLANE - 1.0 for q in planes) for p in planes]
    largest = max(areas, default=1.0)
    order = sorted(range(len(planes)), key=lambda k: (-round(areas[k] / largest, 2), -abs(planes[k].normal[1])))
    return [planes[k] for k in order if not between[k]]


def blow_axis(model: Model) -> Array:
    """Return a unit vector along the greatest initial momentum, or what is driven, or z."""
    volume = volumes(model.mesh.points, model.mesh.hexahedra)
    pushes = [
        float(volume[model.mesh.elements_of(name)].sum()) * model.solids[name].density * np.asarray(velocity)
        for name, velocity in model.velocity.items()
    ]
    pushes = [p for p in pushes if np.linalg.norm(p) > 0.0]
    pushes = pushes or [np.asarray(b.direction, float) for b in model.boundaries if isinstance(b, Driven)]
    axis = max(pushes, key=lambda p: float(np.linalg.norm(p)), default=np.array([0.0, 0.0, 1.0]))
    return np.asarray(axis / np.linalg.norm(axis))


def blow_contact(model: Model) -> SurfaceContact | RigidWall | None:
    """Return the contact or wall of the blow: the first whose bodies begin at different velocities, or else the first.

    None where the model has no contact and no wall.
    """
    rest = (0.0, 0.0, 0.0)
    meetings: list[SurfaceContact | RigidWall] = [*model.contacts, *model.walls]
    for meeting in meetings:
        sides = model.touching[meeting.name]
        parts = [side if side in model.mesh.names else side.rpartition(".")[0] for side in sides]
        speeds = {tuple(model.velocity.get(part, rest)) for part in parts}
        if len(speeds | ({rest} if isinstance(meeting, RigidWall) else set())) > 1:
            return meeting
    return next(iter(meetings), None)


def meeting_place(model: Model) -> Array | None:
    """Return the place where the bodies of the blow are nearest before it, (3,), m; None without contact or wall."""
    from scipy.spatial import cKDTree

    mesh, meeting = model.mesh, blow_contact(model)
    if meeting is None:
        return None
    if isinstance(meeting, SurfaceContact):
        first, second = (mesh.points[np.unique(mesh.side(side))] for side in (meeting.first, meeting.second))
        distance, partner = cKDTree(second).query(first)
    else:
        first = mesh.points[np.unique(mesh.side(meeting.side))]
        normal = np.asarray(meeting.normal) / np.linalg.norm(meeting.normal)
        distance = (first - np.asarray(meeting.point)) @ normal
        second, partner = first - distance[:, None] * normal, np.arange(len(first))
    nearest = distance <= distance.min() + ON_PLANE * float(np.ptp(first, axis=0).max())
    return np.asarray(0.5 * (first[nearest] + second[partner[nearest]]).mean(axis=0))


def outward(mesh: Mesh, side: str) -> Array:
    """Return the mean outward normal of a side, a unit vector."""
    a, b, c, d = (mesh.points[mesh.side(side)[:, k]] for k in range(4))
    normal = np.cross(c - a, d - b).sum(axis=0)
    return np.asarray(normal / np.linalg.norm(normal))


def _extent(mesh: Mesh) -> float:
    return float(np.ptp(mesh.points, axis=0).max())


def _sides(model: Model, faces: Index) -> Index:
    """Return the index of each face's side among those of all contacts and walls, or -1."""
    numbers = np.full(len(faces), -1, np.int32)
    own = _keys(faces)
    for k, side in enumerate(side for sides in model.touching.values() for side in sides):
        numbers[np.isin(own, _keys(model.mesh.side(side)))] = k
    return numbers


def faces_on(skin: Skin, mesh: Mesh, sides: Sequence[str]) -> Mask:
    """Return the mask of the faces of a skin that lie on sides of a mesh, (faces,); images do not."""
    own = _keys(skin.nodes[skin.node[skin.faces]])
    on = np.isin(own, np.concatenate([_keys(mesh.side(side)) for side in sides]))
    return np.asarray(on & ~skin.image[skin.faces].any(axis=1))


def _keys(faces: Index) -> NDArray[np.void]:
    """Return one value for each face, whatever node it begins with."""
    return np.ascontiguousarray(np.sort(faces.astype(np.int32), axis=1)).view(np.dtype((np.void, 16))).ravel()


def _edges(points: Array, faces: Index, part: Index) -> Edges:
    """Return the edges between two faces each; where more than two meet, those of the order in which they come."""
    ends = np.sort(np.stack([faces, np.roll(faces, -1, axis=1)], axis=2).reshape(-1, 2), axis=1)
    order = np.lexsort(ends.T[::-1])
    same = np.flatnonzero(np.all(ends[order[1:]] == ends[order[:-1]], axis=1))
    pair = np.stack([order[same], order[same + 1]], axis=1) // 4
    corners = points[faces]
    normal = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), TINY)
    bent = np.einsum("ij,ij->i", normal[pair[:, 0]], normal[pair[:, 1]]) < SHARP
    sharp = bent | (part[pair[:, 0]] != part[pair[:, 1]])
    return Edges(ends[order[same]].astype(np.int32), pair.astype(np.int32), sharp)


Single = NDArray[np.float32]

LARGEST = 256_000_000  # little beside the elements of a mesh that has so many faces
"""Most bytes that snapshots take, about."""
SNAPSHOTS = 24  # an instant within 2 % of any that a picture asks for
"""Snapshots over the run, and as many again while bodies touch."""
FEWEST = 8  # below, the peak of a blow falls between them
"""Fewest snapshots over the run, whatever the memory."""
WAVE_INSTANTS, PER_TRANSIT = 8, 6  # those after the first transit show the wave's return
"""Snapshots after first touch that follow the wave, and their number in a transit."""
LARGER = 1.02  # stress that grows throughout would have a snapshot at every instant; 2 % is not seen in a picture
"""Ratio of the largest stress to that of the snapshot before from which on there is a new one."""
EARLY = 1e-6  # rounding does not skip one
"""Share of the time between snapshots of the wave by which one may come early."""


FIELDS = ("von_mises", "plastic_strain")
"""Fields whose largest value in any element is noted."""


class Snapshot(NamedTuple):
    """An instant: time, s; displacement of the nodes of a skin, m; stress and plastic strain of its elements."""

    time: float
    displacement: Single
    stress: Single
    plastic_strain: Single


class FieldPeak(NamedTuple):
    """The largest of a field in any element: its value, when, s, and the index of the element."""

    value: float
    time: float
    element: int


class Thinned:
    """Evenly chosen items of a row of unknown length: when there are twice as many as wanted, every other one goes."""

    def __init__(self, wanted: int) -> None:
        self.wanted, self.every, self.offered = wanted, 1, 0
        self.kept: list[Snapshot] = []

    def wants(self) -> bool:
        """Count an item that is offered, and return whether it is to be kept."""
        self.offered += 1
        return (self.offered - 1) % self.every == 0

    def add(self, still: Snapshot) -> None:
        """Keep an item."""
        self.kept.append(still)
        if len(self.kept) >= 2 * self.wanted:
            self.kept, self.every = self.kept[::2], 2 * self.every


@dataclass
class SnapshotRecorder:
    """Recorder of snapshots for the pictures of a run: ``whole`` over the run, ``contact`` while the bodies touch."""

    skin: Skin
    """Faces that are shown."""
    transit: float
    """Time that the first wave takes through the bodies, s; see `transit_time`."""
    contact_name: str = ""
    """Contact or wall of the blow; empty without one."""
    wanted: int = SNAPSHOTS
    """Instants over the whole run, and as many again while the bodies of the blow touch."""
    worst: Snapshot | None = field(default=None, init=False)
    """Instant of the largest stress."""
    last: Snapshot | None = field(default=None, init=False)
    """Instant of the end."""
    touched: float | None = field(default=None, init=False)
    """Time of first touch, s."""
    wave: list[Snapshot] = field(default_factory=list, init=False)
    """Snapshots of the first wave."""
    missed: bool = field(default=False, init=False)
    """True if first touch was before the first instant seen, as where an interrupted run goes on."""
    largest: dict[str, FieldPeak] = field(default_factory=dict, init=False)
    """Peak of each of `FIELDS` in all elements, seen or not, at the instants that were kept."""
    _largest: float = field(default=0.0, init=False)

    def __post_init__(self) -> None:
        each = 4 * (3 * len(self.skin.nodes) + 7 * len(self.skin.elements))
        self.wanted = max(FEWEST, min(self.wanted, LARGEST // (4 * each)))
        self.whole, self.contact = Thinned(self.wanted), Thinned(self.wanted)

    def observe(self, engine: Engine, last: bool) -> None:
        """Offer an instant of the histories of a run, the last one or not."""
        rows = engine.recorder.rows
        forces = rows[f"force/{self.contact_name}"] if self.contact_name else [np.zeros(3)]
        if not self.whole.offered:  # of a run that went on later, what came before is not known
            self.missed = bool(np.any(forces[:-1]))
        stresses = [float(rows[f"von_mises/{name}"][-1]) for name in engine.recorder.bearing]
        self.offer(engine.time, bool(np.any(forces[-1])), max(stresses, default=0.0), engine.frame)
        if last:
            self.last = self._still(engine.frame())

    def offer(self, time: float, touching: bool, largest: float, frame: Callable[[], FieldFrame]) -> None:
        """Keep an instant where it is wanted, by touch and the largest stress; ``frame`` gives its fields."""
        keepers = [
            rows for rows in (self.whole, self.contact if touching else None) if rows is not None and rows.wants()
        ]
        if self.touched is None and touching:
            self.touched = time
        followed = self.touched is not None and not self.missed and len(self.wave) < WAVE_INSTANTS
        due = followed and time >= self._next_wave()
        worse = largest > LARGER * self._largest
        if not (keepers or due or worse):
            return
        still = self._still(frame())
        for keeper in keepers:
            keeper.add(still)
        if due:
            self.wave.append(still)
        if worse:
            self._largest, self.worst = largest, still

    def state(self) -> dict[str, np.ndarray]:
        """Return all snapshots and counts as arrays, each snapshot once."""
        rows = self.snapshots
        place = {snapshot.time: k for k, snapshot in enumerate(rows)}
        lists = {"whole": self.whole.kept, "contact": self.contact.kept, "wave": self.wave}
        ends = {name: [end] if end is not None else [] for name, end in (("worst", self.worst), ("last", self.last))}
        state: dict[str, np.ndarray] = {
            name: np.array([place[still.time] for still in stills], np.int64) for name, stills in (lists | ends).items()
        }
        state["thinned"] = np.array([(row.every, row.offered) for row in (self.whole, self.contact)], np.int64)
        state["touch"] = np.array([np.nan if self.touched is None else self.touched, self.missed, self._largest])
        peaks = [self.largest.get(name, FieldPeak(0.0, 0.0, -1)) for name in FIELDS]
        state["largest"] = np.array(peaks, float)
        state["time"] = np.array([still.time for still in rows], float)
        for k, (name, columns) in enumerate(self._columns().items(), start=1):
            state[name] = np.array([still[k] for still in rows], np.float32).reshape(len(rows), *columns)
        return state

    def restore(self, state: Mapping[str, np.ndarray]) -> None:
        """Take up the `state` of a run that goes on; raise ValueError for that of another skin."""
        rows = len(state["time"])
        for name, columns in self._columns().items():
            if state[name].shape != (rows, *columns):
                raise ValueError(f"{name} is not of this mesh")
        named = zip(state["time"].tolist(), *(state[name] for name in self._columns()), strict=True)
        stills = [Snapshot(*row) for row in named]
        self.whole.kept, self.contact.kept, self.wave, worst, last = (
            [stills[k] for k in state[name]] for name in ("whole", "contact", "wave", "worst", "last")
        )
        self.worst, self.last = (end[0] if end else None for end in (worst, last))
        for thinned, (every, offered) in zip((self.whole, self.contact), state["thinned"].tolist(), strict=True):
            thinned.every, thinned.offered = every, offered
        touched, missed, self._largest = state["touch"].tolist()
        self.touched, self.missed = None if np.isnan(touched) else touched, bool(missed)
        peaks = zip(FIELDS, state["largest"].tolist(), strict=True)
        self.largest = {name: FieldPeak(value, time, int(k)) for name, (value, time, k) in peaks if k >= 0}

    def _columns(self) -> dict[str, tuple[int, ...]]:
        """Return the shapes of the fields of a snapshot, in their order there."""
        nodes, elements = len(self.skin.nodes), len(self.skin.elements)
        return {"displacement": (nodes, 3), "stress": (elements, 6), "plastic_strain": (elements,)}

    def _next_wave(self) -> float:
        """Return the time at which the next snapshot of the wave is due, s."""
        return (self.touched or 0.0) + (len(self.wave) + 1 - EARLY) * self.transit / PER_TRANSIT

    def _still(self, frame: FieldFrame) -> Snapshot:
        skin = self.skin
        for name, values in zip(FIELDS, (von_mises(frame.stress), frame.plastic_strain), strict=True):
            element = int(np.argmax(values))
            if float(values[element]) > (self.largest[name].value if name in self.largest else 0.0):
                self.largest[name] = FieldPeak(float(values[element]), frame.time, element)
        cells = (frame.displacement[skin.nodes], frame.stress[skin.elements], frame.plastic_strain[skin.elements])
        displacement, stress, strain = (np.asarray(values, np.float32) for values in cells)
        return Snapshot(frame.time, displacement, stress, strain)

    @property
    def snapshots(self) -> list[Snapshot]:
        """All instants, in the order of time."""
        ends = [snapshot for snapshot in (self.worst, self.last) if snapshot is not None]
        by_time = {snapshot.time: snapshot for snapshot in (*self.whole.kept, *self.contact.kept, *self.wave, *ends)}
        return [by_time[time] for time in sorted(by_time)]


def snapshot_recorder(model: Model, wanted: int = SNAPSHOTS) -> SnapshotRecorder:
    """Return a recorder for a model that is to be run."""
    meeting = blow_contact(model)
    return SnapshotRecorder(skin_of(model), transit_time(model), "" if meeting is None else meeting.name, wanted)


def recorder_from_frames(model: Model, frames: Sequence[FieldFrame]) -> SnapshotRecorder:
    """Return a recorder that has seen some whole fields, and knows nothing of contacts."""
    recorder = snapshot_recorder(model, max(len(frames), 1))
    for frame in frames:
        largest = float(von_mises(frame.stress).max(initial=0.0))
        recorder.offer(frame.time, False, largest, itertools.repeat(frame).__next__)
    return recorder


def transit_time(model: Model) -> float:
    """Return the time that a wave takes from where bodies meet to the far end along the blow, s.

    The way is the longest along the axis of the blow from where the bodies of the blow are nearest to any node, or
    the length of everything where nothing meets; the speed sqrt(E/rho) is that of the part of the far node.
    """
    mesh, place = model.mesh, meeting_place(model)
    along = mesh.points @ blow_axis(model)
    start = float(along.min() if place is None else place @ blow_axis(model))
    ways = {name: float(np.abs(along[mesh.nodes_of(name)] - start).max()) for name in mesh.names}
    name = max(ways, key=lambda part: ways[part])
    solid = model.solids[name]
    return float(ways[name] / np.sqrt(solid.youngs_modulus / solid.density))
