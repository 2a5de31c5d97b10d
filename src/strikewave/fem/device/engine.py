"""A run whose steps are taken, and whose instants are summed, on a device."""

from __future__ import annotations

import numpy as np

from strikewave.fem import _node_kernels as node_kernels
from strikewave.fem.boundary import Acting, Now
from strikewave.fem.device.devices import Device
from strikewave.fem.device.parts import (
    DeviceActing,
    DeviceContact,
    DeviceElements,
    DeviceTies,
    DeviceWall,
    DeviceWatch,
    Nodes,
    acting_there,
)
from strikewave.fem.engine import Engine
from strikewave.fem.model import Model
from strikewave.fem.recorder import Noted
from strikewave.fem.run import FemRun, FieldFrame

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
