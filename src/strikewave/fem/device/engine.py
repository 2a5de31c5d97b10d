"""A run whose steps are taken on a device. What is noted at an instant is brought here, where all else is done."""

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
    Nodes,
    acting_there,
)
from strikewave.fem.engine import Engine
from strikewave.fem.model import Model

NODES = ("x", "v", "f", "mass", "inverse_mass", "yielding")
"""Arrays of the nodes that a step needs."""


class DeviceEngine(Engine):
    """An `Engine` on a device.

    Its arrays here are those of the last instant that was recorded; `fetch` brings them up to date.
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

    def fetch(self) -> None:
        """Bring everything that changes here, with what was summed since the last time."""
        for name in ("x", "v", "f"):
            getattr(self, name)[:] = self.device.get(getattr(self.nodes, name))
        for elements in self.there:
            elements.fetch()
        for acts in self.acts.values():
            work, *given_impulse = acts.fetch()
            self.done["external"] += work
            self.impulse_given += given_impulse
        touching: dict[str, DeviceContact | DeviceWall] = {**self.met, **self.stood}
        for name, touch in touching.items():
            work, *impulse = touch.fetch()
            self.done["contact"] += work
            self.impulse[name] += impulse
            if name in self.stood:
                self.impulse_given += impulse
        self.contacts = {name: contact.here for name, contact in self.met.items()}

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
        booked: list[DeviceActing | DeviceContact | DeviceWall] = [*self.acts.values()]
        for each in [*booked, *self.met.values(), *self.stood.values()]:
            each.book(nodes, self.kick)
        self.note_step()
        self.critical = min((kind.add_forces(nodes, dt) for kind in self.there), default=np.inf)

    def record(self) -> str:
        """Note the instant; return why the run cannot go on, or nothing."""
        self.fetch()
        return super().record()
