"""Snapshots of a run for its pictures, chosen while it goes on, of what can be seen alone; SI.

Kept are instants evenly over the run and, more densely, while the bodies of the blow touch; some that follow the first
wave; and that of the largest stress. Their number is bounded: where too many come, every other one goes.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from strikewave.fem.invariants import von_mises
from strikewave.fem.model import Model
from strikewave.fem.run import FieldFrame
from strikewave.fem.skin import Skin, blow_axis, blow_contact, meeting_place, skin_of

if TYPE_CHECKING:
    from strikewave.fem.engine import Engine

Single = NDArray[np.float32]

LARGEST = 256_000_000
"""Bytes that snapshots take at most, about: little beside the elements of a mesh that has so many faces."""
SNAPSHOTS = 24
"""Snapshots over the run, and as many again while bodies touch: an instant within 2 % of any that a picture asks
for."""
FEWEST = 8
"""Snapshots over the run at least, whatever the memory: below, the peak of a blow falls between them."""
WAVE_INSTANTS, PER_TRANSIT = 8, 6
"""Snapshots after first touch that follow the wave, and how many of them a transit takes: the rest show its return."""
LARGER = 1.02
"""A snapshot counts as that of the largest stress where this is so many times that of the one before.

Stress that grows throughout a run would have a snapshot at every instant; 2 % is not seen in a picture."""
EARLY = 1e-6
"""Share of the time between snapshots of the wave by which one may come early, so that rounding does not skip it."""


FIELDS = ("von_mises", "plastic_strain")
"""What the largest value in any element is noted of."""


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
        """Count an item that is offered, and tell whether it is to be kept."""
        self.offered += 1
        return (self.offered - 1) % self.every == 0

    def add(self, still: Snapshot) -> None:
        """Keep an item."""
        self.kept.append(still)
        if len(self.kept) >= 2 * self.wanted:
            self.kept, self.every = self.kept[::2], 2 * self.every


@dataclass
class SnapshotRecorder:
    """Keeps snapshots of a run for its pictures.

    Parameters
    ----------
    skin : Skin
        What is seen.
    transit : float
        How long the first wave takes through the bodies, s; see `transit_time`.
    contact_name : str
        The contact or wall of the blow; empty without one.
    wanted : int
        Instants over the whole run, and as many again while the bodies of the blow touch.

    Attributes
    ----------
    whole, contact : Thinned
        What is kept over the run, and while the bodies touch.
    wave : list of Snapshot
        What follows the first wave.
    worst, last : Snapshot or None
        The instants of the largest stress and of the end.
    touched : float or None
        First touch, s.
    missed : bool
        Whether first touch was before the first instant seen, as where an interrupted run goes on.
    largest : dict of str to FieldPeak
        "von_mises", Pa, and "plastic_strain" of all elements, seen or not, at the instants that were kept.
    """

    skin: Skin
    transit: float
    contact_name: str = ""
    wanted: int = SNAPSHOTS
    worst: Snapshot | None = field(default=None, init=False)
    last: Snapshot | None = field(default=None, init=False)
    touched: float | None = field(default=None, init=False)
    wave: list[Snapshot] = field(default_factory=list, init=False)
    missed: bool = field(default=False, init=False)
    largest: dict[str, FieldPeak] = field(default_factory=dict, init=False)
    _largest: float = field(default=0.0, init=False)

    def __post_init__(self) -> None:
        each = 4 * (3 * len(self.skin.nodes) + 7 * len(self.skin.elements))
        self.wanted = max(FEWEST, min(self.wanted, LARGEST // (4 * each)))
        self.whole, self.contact = Thinned(self.wanted), Thinned(self.wanted)

    def observe(self, engine: Engine, last: bool) -> None:
        """Look at a run at an instant of its histories, the last one or not."""
        rows = engine.recorder.rows
        forces = rows[f"force/{self.contact_name}"] if self.contact_name else [np.zeros(3)]
        if not self.whole.offered:  # of a run that went on later, what came before is not known
            self.missed = bool(np.any(forces[:-1]))
        stresses = [float(rows[f"von_mises/{name}"][-1]) for name in engine.recorder.bearing]
        self.offer(engine.time, bool(np.any(forces[-1])), max(stresses, default=0.0), engine.frame)
        if last:
            self.last = self._still(engine.frame())

    def offer(self, time: float, touching: bool, largest: float, frame: Callable[[], FieldFrame]) -> None:
        """Take an instant where it is wanted: whether bodies touch, the largest stress, and how to get the rest."""
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
        """Return all that it has seen, as arrays; each snapshot once."""
        rows = self.snapshots
        place = {snapshot.time: k for k, snapshot in enumerate(rows)}
        lists = {"whole": self.whole.kept, "contact": self.contact.kept, "wave": self.wave}
        ends = {name: [one] if one is not None else [] for name, one in (("worst", self.worst), ("last", self.last))}
        state: dict[str, np.ndarray] = {
            name: np.array([place[one.time] for one in kept], np.int64) for name, kept in (lists | ends).items()
        }
        state["thinned"] = np.array([(one.every, one.offered) for one in (self.whole, self.contact)], np.int64)
        state["touch"] = np.array([np.nan if self.touched is None else self.touched, self.missed, self._largest])
        peaks = [self.largest.get(name, FieldPeak(0.0, 0.0, -1)) for name in FIELDS]
        state["largest"] = np.array(peaks, float)
        state["time"] = np.array([one.time for one in rows], float)
        for k, (name, columns) in enumerate(self._columns().items(), start=1):
            state[name] = np.array([one[k] for one in rows], np.float32).reshape(len(rows), *columns)
        return state

    def restore(self, state: Mapping[str, np.ndarray]) -> None:
        """Take what it had seen of a run that goes on.

        Raises
        ------
        ValueError
            If that is not what `state` gives of the same skin.
        """
        rows = len(state["time"])
        for name, columns in self._columns().items():
            if state[name].shape != (rows, *columns):
                raise ValueError(f"{name} is not of this mesh")
        named = zip(state["time"].tolist(), *(state[name] for name in self._columns()), strict=True)
        stills = [Snapshot(*row) for row in named]
        self.whole.kept, self.contact.kept, self.wave, worst, last = (
            [stills[k] for k in state[name]] for name in ("whole", "contact", "wave", "worst", "last")
        )
        self.worst, self.last = (one[0] if one else None for one in (worst, last))
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
        """Return when the next instant that follows the wave is due, s."""
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
    """Return how long a wave takes from where bodies meet to the far end along the blow, s.

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
