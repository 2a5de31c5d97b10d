"""A run on a device: its elements, boundaries and contacts, each step, and the sums of each instant; SI."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Generic, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from strikewave.fem import _contact_kernels as contact_kernels
from strikewave.fem import _history_kernels as history_kernels
from strikewave.fem import _layout as layout
from strikewave.fem import _node_kernels as node_kernels
from strikewave.fem import _surface_kernels as surface_kernels
from strikewave.fem._contact_kernels import ContactState, Step, WallState, wall_node
from strikewave.fem._history_kernels import TOUCHED, shares_of
from strikewave.fem._node_kernels import TieState, move_tied_node
from strikewave.fem.bodies import SHARES, RigidBody
from strikewave.fem.boundary import Acting, Dashpots, Held, Now, Pressed, Weight, value_at
from strikewave.fem.contact import REACH
from strikewave.fem.device import _bodies as bodies
from strikewave.fem.device.devices import Device
from strikewave.fem.engine import Engine
from strikewave.fem.hexahedron import FullyIntegrated, Hexahedra, OnePoint
from strikewave.fem.mesh import Array, Index
from strikewave.fem.model import Model
from strikewave.fem.recorder import Noted, SectionStress
from strikewave.fem.run import FemRun, FieldFrame


def lists(keys: NDArray[np.integer[Any]], values: NDArray[np.integer[Any]], count: int) -> tuple[Index, Index]:
    """Return where the values of each key begin, (count + 1,), and the values, ascending for each."""
    order = np.lexsort((values, keys))
    start = np.concatenate([[0], np.cumsum(np.bincount(keys, minlength=count))])
    return start.astype(np.int32), values[order].astype(np.int32)


GROUP = 32  # a node looks at a thirty-second of all boxes, and at those of the few groups it lies in
"""Faces of a group."""


class FaceSearch:
    """Groups of the faces of two surfaces, and what a search writes."""

    def __init__(self, device: Device, here: ContactState) -> None:
        self.device, self.nodes, self.faces = device, len(here.touch.nodes), len(here.faces)
        split = here.first_faces
        edges = np.array([*range(0, split, GROUP), *range(split, self.faces, GROUP), self.faces], np.int32)
        corners = here.faces.ravel()
        self.corners = tuple(device.put(each) for each in lists(corners, np.arange(len(corners)), self.nodes))
        self.area, self.count = device.put(np.zeros(self.faces)), device.put(np.zeros(self.nodes, np.int64))
        self.groups = bodies.FaceGroups(
            device.put(edges),
            device.put(np.zeros((self.faces, 6))),
            device.put(np.zeros((len(edges) - 1, 6))),
            int(np.searchsorted(edges, split)),
        )

    def near(self, there: ContactState, x: Any) -> tuple[Index, Any, Any]:
        """Renew areas and boxes; return where each node's faces begin, here and there, and the faces."""
        each, groups = self.device.each, self.groups
        each(node_kernels.take_row, self.nodes, there.touch.nodes, x, there.place)
        each(bodies.survey_face, self.faces, there, REACH, groups.boxes, self.area)
        each(bodies.survey_node, self.nodes, there, *self.corners, self.area)
        each(bodies.bound_group, len(groups.bounds), groups)
        each(bodies.count_near, self.nodes, there, groups, self.count)
        start = np.append(0, np.cumsum(self.device.get(self.count)))
        begin, candidates = self.device.put(start), self.device.put(np.zeros(start[-1], np.int32))
        each(bodies.fill_near, self.nodes, there, groups, begin, candidates)
        return start, begin, candidates


S = TypeVar("S", ContactState, WallState)
BODIES: dict[type[Hexahedra], Callable[..., None]] = {
    OnePoint: bodies.one_point_element,
    FullyIntegrated: bodies.full_element,
}
"""Function that brings an element to the end of a step, by kind of element."""
DONE = 4
"""Sums of each node of a boundary or contact: work and impulse."""


def put_fields(device: Device, state: Any) -> Any:
    """Return a named tuple with its arrays on a device."""
    if isinstance(state, np.ndarray):
        return device.put(state)
    return type(state)(*(put_fields(device, each) for each in state)) if isinstance(state, tuple) else state


def get_fields(device: Device, there: Any, here: Any) -> None:
    """Copy the arrays of a named tuple on a device to those here."""
    if isinstance(here, np.ndarray):
        here[...] = device.get(there)
    elif isinstance(here, tuple):
        for each, own in zip(there, here, strict=True):
            get_fields(device, each, own)


class Nodes(NamedTuple):
    """Arrays of the nodes on a device, as those of `strikewave.fem.engine.Engine`."""

    x: Any
    v: Any
    f: Any
    mass: Any
    inverse_mass: Any
    yielding: Any


class DeviceElements:
    """Elements of one kind."""

    def __init__(self, device: Device, elements: Hexahedra, nodes: int) -> None:
        self.device, self.here, self.body, self.nodes = device, elements, BODIES[type(elements)], nodes
        blocks = elements.blocks
        self.chunks = len(blocks.filled)
        self.lanes = self.chunks * layout.LANES
        corners = blocks.nodes.reshape(-1, 8, layout.LANES)
        filled = np.arange(layout.LANES) < blocks.filled[:, None, None]
        places = np.flatnonzero(np.broadcast_to(filled, corners.shape)).astype(np.int32)
        self.start, self.places = (device.put(each) for each in lists(blocks.nodes[places], places, nodes))
        put, self.stepped, stored = device.put, False, device.stored
        kept = blocks._replace(constants=blocks.constants.astype(stored), state=blocks.state.astype(stored))
        self.blocks = put_fields(device, kept)
        self.results = bodies.ElementResults(
            put(np.zeros((3, 8 * self.lanes), stored)),
            put(np.zeros((layout.SUMS, self.lanes))),
            put(np.full(self.lanes, np.inf)),
        )
        self.sums, self.largest = put(np.zeros((self.chunks, layout.SUMS))), put(np.zeros((self.chunks, 2)))

    def fetch(self) -> None:
        """Bring the state here."""
        self.here.blocks.state[:] = self.device.get(self.blocks.state)

    def collect(self) -> None:
        """Add what was summed since the last time to the sums here."""
        if not self.stepped:
            return  # the hourglass energy, which is no sum, is still that of the last time
        self.stepped = False
        # By slab, as the processor keeps its sums: plastic work is told by part from them.
        self.device.each(bodies.drain_chunk, self.chunks, self.results.works, self.sums)
        by_slab = np.add.reduceat(self.device.get(self.sums), self.here.slabs[:, 0])
        self.here.sums[:, :3] += by_slab[:, :3]
        self.here.sums[:, 3] = by_slab[:, 3]

    def peaks(self) -> Array:
        """Return the largest stress and strain of each chunk, as `Hexahedra.peaks` does."""
        rest = self.blocks.state, self.blocks.filled, self.here.points, self.largest
        self.device.each(history_kernels.peak_of_chunk, self.chunks, *rest)
        return self.device.get(self.largest)

    def add_forces(self, nodes: Nodes, dt: float) -> float:
        """Bring the elements to the end of a step and add their forces; return their critical step, s."""
        self.stepped = True
        each, viscous = self.device.each, tuple(float(c) for c in self.here.viscous)
        self.device.each_with_scratch(self.body, self.lanes, self.blocks, nodes.x, nodes.v, dt, viscous, self.results)
        each(bodies.gather_node, self.nodes, self.start, self.places, self.results.corner, nodes.f)
        return self.device.least(self.results.step)


class DeviceTies:
    """Tied nodes, and the corners that carry them."""

    def __init__(self, device: Device, ties: TieState) -> None:
        self.device, self.count = device, len(ties.nodes)
        corners, keys = np.unique(ties.corners.ravel(), return_inverse=True)
        self.carrying = len(corners)
        self.there, self.corners = put_fields(device, ties), device.put(corners.astype(np.int32))
        self.start, self.places = (
            device.put(each) for each in lists(keys.ravel(), np.arange(4 * self.count), self.carrying)
        )

    def gather(self, f: Any) -> None:
        """Hand the forces on tied nodes on, as `gather_tied_forces` does, in its order."""
        self.device.each(bodies.tied_corner, self.carrying, self.corners, self.start, self.places, self.there, f)
        self.device.each(bodies.clear_row, self.count, self.there.nodes, f)

    def move(self, field: Any) -> None:
        """Give tied nodes the vectors of their places on the faces, as `move_tied` does."""
        self.device.each(move_tied_node, self.count, self.there, field)

    def follow(self, nodes: Nodes, dt: float) -> None:
        """Bring tied nodes to the end of a step with their faces."""
        self.device.each(bodies.follow_node, self.count, self.there, nodes.x, nodes.v, dt)


class DeviceActing:
    """Weight, held or driven nodes, or dashpots."""

    def __init__(self, device: Device, acting: Acting, mass: Array) -> None:
        self.device, self.here, self.mass, self.count = device, acting, mass, len(acting.nodes)
        self.nodes = device.put(acting.nodes)
        self.table = device.put(acting.directions) if isinstance(acting, Held) else None
        self.kick = 0.0
        self.force, self.before, self.first = (device.put(each) for each in (acting.force, acting.before, acting.force))
        self.done = device.put(np.zeros((self.count, DONE)))
        self.totals = device.put(np.zeros((shares_of(self.count), DONE)))

    def add(self, now: Now) -> None:
        """Find the forces of this instant and add them to those of the nodes."""
        self.device.each(node_kernels.take_row, self.count, self.nodes, now.v, self.before)
        self._apply(now)

    def add_rest(self, now: Now) -> None:
        """Add the force that it takes to hold the nodes against contact too."""
        self.device.each(bodies.copy_row, self.count, self.force, self.first)
        self._apply(now)
        self.device.each(bodies.join_row, self.count, self.force, self.first)

    def _apply(self, now: Now) -> None:
        each, here = self.device.each, self.here
        if isinstance(here, Weight):
            each(node_kernels.add_row, self.count, self.nodes, self.force, now.f)
            return
        rest = now.kick, now.v, now.f, now.mass, self.force
        if isinstance(here, Held):
            speed = 0.0 if here.speed is None else value_at(here.speed, now.time + 0.5 * now.step)
            each(node_kernels.hold_node, self.count, self.nodes, self.table, speed, *rest)
        elif isinstance(here, Dashpots):
            if now.kick != self.kick:
                self.kick = now.kick
                self.table = self.device.put(here.ready_for(now.kick, self.mass))
            each(node_kernels.absorb_node, self.count, self.nodes, self.table, *rest)

    def book(self, nodes: Nodes, kick: float) -> None:
        """Add work and impulse of the step that led to the velocity now."""
        rest = self.nodes, self.force, self.before, nodes.v, kick, self.done
        self.device.each(bodies.book_row, self.count, *rest)

    def fetch(self) -> None:
        """Bring force and velocity before here."""
        self.here.force[:], self.here.before[:] = self.device.get(self.force), self.device.get(self.before)

    def collect(self) -> Array:
        """Return work and impulse since the last time."""
        self.device.each(bodies.drain_share, len(self.totals), self.done, self.totals)
        return np.asarray(self.device.get(self.totals).sum(axis=0))

    def now(self) -> Array:
        """Return power and sum of the forces, as `Acting.now` does."""
        self.device.each(bodies.acting_share, len(self.totals), self.force, self.before, self.totals)
        return np.asarray(self.device.get(self.totals).sum(axis=0))


class DevicePressed(DeviceActing):
    """Faces under a pressure: each node sums what its faces give it, in ascending order of these."""

    here: Pressed

    def __init__(self, device: Device, acting: Pressed, mass: Array) -> None:
        super().__init__(device, acting, mass)
        corners = acting.faces.ravel()
        self.faces = device.put(acting.nodes[acting.faces])
        self.lists = tuple(device.put(each) for each in lists(corners, np.arange(len(corners)), self.count))

    def _apply(self, now: Now) -> None:
        pressed = *self.lists, self.faces, value_at(self.here.pressure, now.time), now.x, self.force, now.f
        self.device.each(bodies.pressed_node, self.count, self.nodes, *pressed)


class DeviceRigid(DeviceActing):
    """A part that does not deform. Its nodes are summed and moved there, and the body here, by `RigidBody`."""

    here: RigidBody

    def __init__(self, device: Device, acting: RigidBody, mass: Array) -> None:
        super().__init__(device, acting, mass)
        self.arms, self.sums = device.put(acting.arms), device.put(acting.sums)

    def _apply(self, now: Now) -> None:
        each, centre = self.device.each, tuple(self.here.centre.tolist())
        each(node_kernels.sum_share, SHARES, self.nodes, now.x, now.f, centre, self.sums)
        pose = self.device.put(self.here.move(self.device.get(self.sums), now.kick, now.step))
        rest = (now.kick, now.step), now.x, self.before, now.f, now.mass, self.force
        each(node_kernels.bring_node, self.count, self.nodes, self.arms, pose, *rest)


ACTING: dict[type[Acting], type[DeviceActing]] = {Pressed: DevicePressed, RigidBody: DeviceRigid}
"""Device classes of what acts on nodes in another way than `DeviceActing`."""


def acting_there(device: Device, acting: Acting, mass: Array) -> DeviceActing:
    """Return the twin of what acts on some nodes."""
    return ACTING.get(type(acting), DeviceActing)(device, acting, mass)


class DeviceTouch(Generic[S]):
    """Nodes of a contact or wall, and their sums."""

    def __init__(self, device: Device, here: S) -> None:
        self.here: S = here
        self.device, self.count = device, len(here.touch.nodes)
        self.there, self.done = put_fields(device, here), device.put(np.zeros((self.count, DONE)))
        self.totals, self.feeling = (device.put(np.zeros((shares_of(self.count), n))) for n in (DONE, TOUCHED))

    def fetch(self) -> None:
        """Bring the state here."""
        before = self.here.touch.step[0]
        get_fields(self.device, self.there, self.here)
        self.here.touch.step[0] = before

    def collect(self) -> Array:
        """Return work, and impulse on the first surface, since the last time."""
        self.device.each(bodies.drain_share, len(self.totals), self.done, self.totals)
        return np.asarray(self.device.get(self.totals).sum(axis=0))

    def felt(self) -> Array:
        """Return forces, powers and areas of the shares of the nodes: see `_history_kernels.touch_share`."""
        self.device.each(history_kernels.touch_share, len(self.feeling), self.there.touch, self.feeling)
        return self.device.get(self.feeling)

    def book(self, nodes: Nodes, kick: float) -> None:
        """Add work and impulse of the step that led to the velocity now."""
        self.device.each(bodies.book_touch, self.count, self.there.touch, nodes.v, kick, self.done)

    def step(self, now: Now, travel: float = 0.0) -> Step:
        """Return the step, with the share of depths that is kept; note it."""
        before, self.here.touch.step[0] = float(self.here.touch.step[0]), now.step
        return Step(now.step, now.kick, travel, now.step / before if now.step < before else 1.0)


class DeviceWall(DeviceTouch[WallState]):
    """A rigid plane."""

    def add(self, now: Now, nodes: Nodes) -> None:
        """Add its forces to those of the nodes."""
        rest = self.there, nodes.x, nodes.v, nodes.f, nodes.yielding, self.step(now)
        self.device.each(wall_node, self.count, *rest)


class DeviceContact(DeviceTouch[ContactState]):
    """Two surfaces. Their faces are searched there, as seldom as on a processor."""

    def __init__(self, device: Device, here: ContactState) -> None:
        super().__init__(device, here)
        self.faces, self.travel = FaceSearch(device, here), float(here.travel[0])
        self._list_sources(here.nodal.face)

    def _list_sources(self, last: Index) -> None:
        """List which nodes may meet a face that a node is a corner of; ``last`` are the faces that each met last."""
        met = surface_kernels.nodes_by_corner(self.here.faces, self.here.start, self.here.candidates, last)
        self.start, self.sources = (self.device.put(each) for each in met)

    def add(self, now: Now, nodes: Nodes) -> None:
        """Add its forces to those of the nodes, and search the faces for the next step where that is due."""
        each, there = self.device.each, self.there
        step = self.step(now)
        each(contact_kernels.predict_node, self.count, there, nodes.x, nodes.v, nodes.f, nodes.yielding, step)
        travel = self._travel(now.step)
        self.travel += travel
        each(bodies.note_travel, 1, there, self.travel)
        each(contact_kernels.press_node, self.count, there, step._replace(travel=travel))
        each(bodies.collect_node, self.count, there, self.start, self.sources, nodes.f)
        if self.travel + 2.0 * travel > self.here.margin:
            self.search(nodes.x)

    def _travel(self, dt: float) -> float:
        """Return how much closer any two nodes may come in a step, m."""
        self._find_speeds(contact_kernels.STANDING)
        self._find_speeds(contact_kernels.mean_speed(self.here))
        return float(contact_kernels.travel_of(self.here, dt))

    def _find_speeds(self, middle: tuple[float, float, float]) -> None:
        """Bring the speeds of the shares of the nodes here, as offsets from a velocity."""
        self.device.each(contact_kernels.speed_share, len(self.here.speeds), self.there, middle)
        self.here.speeds[:] = self.device.get(self.there.speeds)

    def search(self, x: Any) -> None:
        """Search the faces anew for where the nodes (nodes, 3) are there."""
        start, begin, candidates = self.faces.near(self.there, x)
        self.there = self.there._replace(start=begin, candidates=candidates)
        self.here = self.here._replace(start=start, candidates=self.device.get(candidates))
        self.travel = 0.0
        self.device.each(bodies.note_travel, 1, self.there, self.travel)
        self._list_sources(self.device.get(self.there.nodal.face))


class DeviceWatch:
    """Nodes and sections that are watched, and their sums."""

    def __init__(self, device: Device, engine: Engine) -> None:
        watched = engine.recorder.watched
        self.device, self.watched = device, put_fields(device, watched)
        self.points, self.velocity = device.put(engine.model.mesh.points), device.put(engine.velocity)
        self.moved, self.kinetic = device.put(engine.moved), device.put(engine.kinetic)
        self.rows = {section.name: device.put(section.rows) for section in engine.section_stresses}
        self.stresses = {section.name: device.put(np.zeros(section.rows.shape)) for section in engine.section_stresses}

    def sums(self, nodes: Nodes, tied: DeviceTies, dt_previous: float, dt_next: float) -> tuple[Array, float]:
        """Return the sums of the shares that are watched, (shares, 6), and twice the kinetic energy, J."""
        each, velocity, half = self.device.each, self.velocity, 0.5 * dt_previous
        each(history_kernels.velocity_of, len(nodes.mass), nodes.v, nodes.f, nodes.inverse_mass, half, velocity)
        tied.move(velocity)
        watched = self.watched, self.points, nodes.x, velocity, self.moved
        each(history_kernels.watch_share, len(self.moved), *watched)
        steps = dt_previous, dt_next
        moving = nodes.v, nodes.f, nodes.mass, nodes.inverse_mass
        each(history_kernels.kinetic_share, len(self.kinetic), *moving, *steps, self.kinetic)
        return self.device.get(self.moved), float(self.device.get(self.kinetic).sum())

    def stress(self, section: SectionStress, elements: DeviceElements) -> Array:
        """Return the stress of the points of a section, (points, 6)."""
        rows, stress = self.rows[section.name], self.stresses[section.name]
        self.device.each(bodies.take_stress, len(section.rows), rows, elements.blocks.state, stress)
        return self.device.get(stress)


NODES = ("x", "v", "f", "mass", "inverse_mass", "yielding")
"""Arrays of the nodes that a step needs."""


class DeviceEngine(Engine):
    """An `Engine` on a device.

    What an instant notes is summed there. The arrays here are those of the last `fetch`.
    """

    def __init__(self, model: Model, device: Device) -> None:
        super().__init__(model)
        self.device = device
        self.send()

    def send(self) -> None:
        """Bring everything that changes there."""
        device = self.device
        self.nodes = Nodes(*(device.put(getattr(self, name)) for name in NODES))
        self.there = [DeviceElements(device, kind, len(self.x)) for kind in self.solid.kinds]
        self.tied = DeviceTies(device, self.ties)
        self.acts: dict[Acting, DeviceActing] = {each: acting_there(device, each, self.mass) for each in self.acting}
        self.met = {name: DeviceContact(device, state) for name, state in self.contacts.items()}
        self.stood = {name: DeviceWall(device, state) for name, state in self.walls.items()}
        self.touch: dict[str, DeviceContact | DeviceWall] = {**self.met, **self.stood}
        self.watching = DeviceWatch(device, self)

    def fetch(self) -> None:
        """Bring everything that changes here, with what was summed since the last time."""
        self.collect()
        for name in ("x", "v", "f"):
            getattr(self, name)[:] = self.device.get(getattr(self.nodes, name))
        for each in (*self.there, *self.acts.values(), *self.touch.values()):
            each.fetch()
        self.contacts = {name: contact.here for name, contact in self.met.items()}

    def collect(self) -> None:
        """Add what was summed there since the last time to the sums here."""
        for elements in self.there:
            elements.collect()
        for acts in self.acts.values():
            work, *given_impulse = acts.collect()
            self.done["external"] += work
            self.impulse_given += given_impulse
        for name, touch in self.touch.items():
            work, *impulse = touch.collect()
            self.done["contact"] += work
            self.impulse[name] += impulse
            if name in self.stood:
                self.impulse_given += impulse

    def begun_anew(self) -> Engine:
        """Return an engine of the same model, on the same device, that has not begun."""
        return DeviceEngine(self.model, self.device)

    def assemble_forces(self) -> None:
        """Add to the forces of the elements at t_n all others, as `Engine.assemble_forces` does."""
        self.kick = 0.5 * (self.dt_previous + self.dt_next)
        nodes = self.nodes
        now = Now(self.time, self.kick, self.dt_next, nodes.x, nodes.v, nodes.f, nodes.mass)
        for weight in self.weight:
            self.acts[weight].add(now)
        self.tied.gather(nodes.f)
        for acting in (*self.loads, *self.holds):
            self.acts[acting].add(now)
        for contact in self.met.values():
            contact.add(now, nodes)
        for wall in self.stood.values():
            wall.add(now, nodes)
        self.tied.gather(nodes.f)
        for hold in self.holds:
            self.acts[hold].add_rest(now)
        for body in self.bodies:
            self.acts[body].add(now)

    def step(self) -> None:
        """Move the nodes to t_(n+1), book what the forces did, and find the forces of the elements there."""
        nodes, dt = self.nodes, self.dt_next
        moving = nodes.x, nodes.v, nodes.f, nodes.inverse_mass, self.kick, dt
        self.device.each(node_kernels.move_node, len(self.x), *moving)
        self.tied.follow(nodes, dt)
        for each in (*self.acts.values(), *self.touch.values()):
            each.book(nodes, self.kick)
        self.note_step()
        self.critical = min((kind.add_forces(nodes, dt) for kind in self.there), default=np.inf)

    def noted(self) -> Noted:
        """Sum what the histories note of t_n there."""
        self.collect()
        moved, kinetic = self.watching.sums(self.nodes, self.tied, self.dt_previous, self.dt_next)
        return Noted(
            moved,
            kinetic,
            [elements.peaks() for elements in self.there],
            {
                section.name: section.mean(self.watching.stress(section, self.there[section.kind]))
                for section in self.section_stresses
            },
            sum((acts.now() for acts in self.acts.values()), np.zeros(4)),
            {name: touch.felt() for name, touch in self.touch.items()},
        )

    def frame(self) -> FieldFrame:
        """Return the whole field at t_n, once it was noted."""
        self.fetch()
        return super().frame()

    def result(self, seconds: float, stopped: str, frames: tuple[FieldFrame, ...]) -> FemRun:
        """Return what was noted, and bring the state here for what comes next."""
        self.fetch()
        return super().result(seconds, stopped, frames)

    def worst_element(self) -> str:
        """Name the element whose corners are bent most."""
        self.fetch()
        return super().worst_element()
