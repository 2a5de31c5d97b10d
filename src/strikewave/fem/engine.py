"""The state of a run and one step of it; `strikewave.fem.solve` drives it; SI."""

from __future__ import annotations

import hashlib
import itertools
from collections.abc import Iterable, Mapping
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np

from strikewave._version import __version__
from strikewave.base.texts import percent
from strikewave.fem import _history_kernels as history_kernels
from strikewave.fem import _node_kernels as node_kernels
from strikewave.fem._contact_kernels import add_wall, contact_force, contact_work
from strikewave.fem._node_kernels import gather_mass, gather_tied_forces, move_tied
from strikewave.fem.bodies import joined_parts, rigid_bodies, surface_inverse_mass
from strikewave.fem.boundary import Acting, Now, Weight, build_boundaries
from strikewave.fem.contact import (
    add_contact,
    initial_overlaps,
    note_held,
    prepare_all,
    prepare_ties,
    prepare_wall,
    searched,
)
from strikewave.fem.hexahedron import (
    FullyIntegrated,
    Hexahedra,
    Mixed,
    OnePoint,
    build_blocks,
    fitting,
    nodal_sums,
    one_point_constants,
    part_masses,
    scaled_masses,
)
from strikewave.fem.mesh import Array
from strikewave.fem.model import Model
from strikewave.fem.quality import scaled_jacobians
from strikewave.fem.recorder import HistoryRecorder, NodeMotion, Noted, assembly, felt_by, pressed, section_stresses
from strikewave.fem.run import KEPT, FemRun, FieldFrame, Rest, energy_at_rest
from strikewave.fem.threads import on_all, spans

NODES = 20_000  # fewer take less time than handing the work to a thread
"""Fewest nodes that a thread moves."""
BROKEN = 0.1  # ten times the `ENERGY_LIMIT` of a warning: such a run is lost and would only go on to blow up
"""Energy missing or too much, as a share of the largest in play, at which a run stops."""
COLLAPSED = 1e-3  # it would take a thousand times as long; an element so squeezed is about to turn inside out
"""Share of the first critical step below which a run stops."""
WORKS = ("contact", "external")
"""Kinds of work summed over the steps here; the elements sum theirs."""


class Engine:
    """State of a run and its steps.

    ``x`` and ``f`` are positions and forces at t_n (``time``), ``v`` velocities half a step before, (nodes, 3);
    ``instant`` is the instant of the histories that is now or comes next, ``dt_previous`` and ``dt_next`` are the steps
    before and after t_n, s, ``critical`` is the critical step there. ``acting`` puts forces on nodes besides elements,
    contacts and walls; ``touching`` are the nodes of contacts and walls by name; ``blow`` counts from 1, and ``rest``
    is how the bodies came to rest before it.
    """

    def __init__(self, model: Model, pool: ThreadPoolExecutor | None = None) -> None:
        mesh, controls = model.mesh, model.controls
        self.model, self.pool, self.interval = model, pool, controls.interval
        self.elements = len(mesh.hexahedra)
        rigid = {each.part for each in model.rigid}
        stiff = [name for name in mesh.names if name not in rigid]
        element_mass, self.added_mass, self.critical = scaled_masses(model, stiff)
        self.own_mass = nodal_sums(mesh.hexahedra, element_mass / 8.0, len(mesh.points))
        self.ties = prepare_ties(model.ties, mesh)
        self.mass = self.own_mass.copy()
        gather_mass(self.ties, self.mass)
        free = self.mass > 0.0
        self.inverse_mass = np.divide(1.0, self.mass, out=np.zeros_like(self.mass), where=free)
        self.solid = build_elements(model, stiff, element_mass, pool)
        self.x, self.v, self.f = mesh.points.copy(), np.zeros_like(mesh.points), np.zeros_like(mesh.points)
        for name, velocity in model.velocity.items():
            self.v[mesh.nodes_of(name)] = velocity
        # Tied nodes give their momentum to the corners that carry them, so that the first step changes none.
        momentum = self.own_mass[:, None] * self.v
        gather_tied_forces(self.ties, momentum)
        self.v = momentum * self.inverse_mass[:, None]
        move_tied(self.ties, self.v)
        self.weight = [Weight(self.own_mass, model.gravity)] if any(model.gravity) else []
        self.loads, self.holds = build_boundaries(model, self.ties)
        self.bodies = rigid_bodies(model, self.mass, self.ties, [hold.nodes for hold in self.holds])
        self.acting: list[Acting] = [*self.weight, *self.loads, *self.holds, *self.bodies]
        self.detect_contacts()
        self.yielding = self._movable()
        shares = {name: part_masses(model.mesh, element_mass, name) for name in mesh.names}
        self.recorder = HistoryRecorder(model, shares)
        self.section_stresses = section_stresses(self.solid.kinds, self.recorder.sections)
        self.velocity = np.zeros_like(self.x)
        self.moved = np.zeros((len(self.recorder.watched.begin) - 1, 6))
        self.kinetic = np.zeros(history_kernels.shares_of(len(self.x)))
        self.time, self.instant, self.steps, self.dt_previous = 0.0, 0, 0, 0.0
        self.collapse = COLLAPSED * self.critical
        self.smallest = np.inf
        self.done = dict.fromkeys(WORKS, 0.0)
        self.impulse_given = np.zeros(3)
        self.impulse = {name: np.zeros(3) for name in self.touching}
        self.initial_energy = 0.5 * float(self.mass @ np.einsum("ni,ni->n", self.v, self.v))
        self.spans = spans(len(self.x), controls.threads, NODES)
        self.kick, self.dt_next = 0.0, self._fitting(self.interval)
        self.blow = 1
        self.rest: Rest | None = None

    def detect_contacts(self, points: Array | None = None) -> None:
        """Prepare contacts and walls for bodies whose nodes are at the points of the mesh, or at others."""
        model, tied = self.model, self.ties.nodes
        self.contacts = prepare_all(model.contacts, model.mesh, tied, points)
        self.walls = {w.name: prepare_wall(w, model.mesh, tied, points) for w in model.walls}
        self.touching = {name: contact.touch for name, contact in self.contacts.items()}
        self.touching |= {name: wall.touch for name, wall in self.walls.items()}
        for touch, hold in itertools.product(self.touching.values(), self.holds):
            note_held(touch, hold.nodes, hold.directions)
        places = model.mesh.points if points is None else points
        self.overlaps = initial_overlaps([*self.contacts.items(), *self.walls.items()], places)

    def initialize(self) -> None:
        """Find forces and step of the elements as they are, and begin the energy balance with what they hold."""
        self.f.fill(0.0)
        self.critical = self.solid.add_forces(self.x, np.zeros_like(self.v), self.f, self.dt_next)
        internal, _, _, hourglass = self.solid.work()
        moving = 0.5 * float(self.mass @ np.einsum("ni,ni->n", self.v, self.v))
        self.initial_energy = moving + float(internal) + float(hourglass)
        self.begin_interval()
        self.send()

    @property
    def fingerprint(self) -> str:
        """Digest of all that must be equal where a run goes on from the state of another."""
        model, digest = self.model, hashlib.sha256()
        for array in (model.mesh.points, model.mesh.hexahedra, model.mesh.part):
            digest.update(np.ascontiguousarray(array).tobytes())
        rest = (model.mesh.names, sorted(model.solids.items()), sorted(model.velocity.items()), model.gravity)
        parts = (model.boundaries, model.contacts, model.ties, model.walls, model.rigid, model.sections, model.points)
        free = ("threads", "duration", "blows")
        controls = {key: value for key, value in vars(model.controls).items() if key not in free}
        digest.update(repr((__version__, rest, parts, controls)).encode())
        return digest.hexdigest()

    def _movable(self) -> Array:
        """Return inverse masses as contact meets the nodes: tied ones alone, rigid ones as parts of a body."""
        inverse_mass = self.inverse_mass.copy()
        inverse_mass[self.ties.nodes] = 1.0 / self.own_mass[self.ties.nodes]
        for rigid, body in zip(self.model.rigid, self.bodies, strict=True):
            inverse_mass[body.nodes] = surface_inverse_mass(body, self.model.mesh, rigid.part)
        return inverse_mass

    def assemble_forces(self) -> None:
        """Add to the forces of the elements at t_n all others."""
        # v goes from t_(n-1/2) to t_(n+1/2): half of either step where the step changes.
        self.kick = 0.5 * (self.dt_previous + self.dt_next)
        now = Now(self.time, self.kick, self.dt_next, self.x, self.v, self.f, self.mass)
        for weight in self.weight:
            weight.add(now)
        gather_tied_forces(self.ties, self.f)  # dashpots and holds need all that pulls on their nodes
        for load in self.loads:
            load.add(now)
        for hold in self.holds:
            hold.add(now)
        # Contact predicts where nodes go without it: all other forces stand in f by now, also those that hold.
        for name, state in self.contacts.items():
            moving = self.x, self.v, self.f, self.yielding, self.dt_next, self.kick
            if add_contact(state, *moving, self.pool, self.model.controls.threads):
                self.contacts[name] = searched(state, self.x)
        for wall in self.walls.values():
            add_wall(wall, self.x, self.v, self.f, self.yielding, self.dt_next, self.kick)
        gather_tied_forces(self.ties, self.f)  # what contact pressed onto tied nodes
        for hold in self.holds:
            hold.add_rest(now)
        for body in self.bodies:  # last: a rigid part follows the sum of everything on its nodes
            body.add(now)

    def step(self) -> None:
        """Move the nodes to t_(n+1), book what the forces did, and find the forces of the elements there."""
        moving = self.x, self.v, self.f, self.inverse_mass, self.kick, self.dt_next
        on_all(self.pool, node_kernels.advance, [(*moving, *span) for span in self.spans])
        if len(self.ties.nodes):
            move_tied(self.ties, self.v)  # they have no mass of their own: `advance` left them where they were
            self.x[self.ties.nodes] += self.dt_next * self.v[self.ties.nodes]
        self._book()  # works need the velocity after the step, and the forces before the elements write new ones
        self.note_step()
        self.critical = self.solid.add_forces(self.x, self.v, self.f, self.dt_next)

    def note_step(self) -> None:
        """Count a step, once the nodes are at its end."""
        self.time, self.steps, self.dt_previous = self.time + self.dt_next, self.steps + 1, self.dt_next
        self.smallest = min(self.smallest, self.dt_next)

    def send(self) -> None:
        """Bring a changed state to where the steps are taken: here."""

    def fetch(self) -> None:
        """Bring the state back from where the steps are taken."""

    def begun_anew(self) -> Engine:
        """Return an engine of the same model that has not begun."""
        return Engine(self.model, self.pool)

    def _book(self) -> None:
        """Add the works and impulses of the step that led to the velocity now."""
        for each in self.acting:
            work, *given_impulse = each.done(self.v, self.kick)
            self.done["external"] += work
            self.impulse_given += given_impulse
        for name, touch in self.touching.items():
            self.done["contact"] += sum(contact_work(touch, self.v, self.kick))
            impulse = self.kick * np.array(contact_force(touch))
            self.impulse[name] += impulse
            if name in self.walls:
                self.impulse_given += impulse

    @property
    def goes_on(self) -> bool:
        """True if the elements allow another step."""
        return self.critical >= self.collapse

    def to_next_instant(self) -> None:
        """Take steps up to the next instant of the histories; call `assemble_forces` for the forces there.

        Where no further step is possible, what came so far is the next instant.
        """
        self.instant += 1
        while True:
            self.step()
            left = self.instant * self.interval - self.time
            if left < 0.5 * self.dt_next:  # sums of steps round: less than half a step is none
                self.begin_interval()
                return
            if not self.goes_on:
                return
            if self.dt_next > self.model.controls.safety * self.critical:
                self.dt_next = self._fitting(left)
            self.assemble_forces()

    def begin_interval(self) -> None:
        """Stand exactly at the instant, and choose the step from there on."""
        self.time = self.instant * self.interval
        if self.goes_on:
            self.dt_next = self._fitting(self.interval)

    def _fitting(self, span: float) -> float:
        """Return the largest step that is safe and goes into a span a whole number of times, s."""
        return fitting(span, self.model.controls.safety * self.critical)

    def motion(self) -> NodeMotion:
        """Return displacement and velocity of the nodes at t_n, once `assemble_forces` was called."""
        self._find_velocities()
        return NodeMotion(self.x - self.model.mesh.points, self.velocity.copy())

    def _find_velocities(self) -> None:
        """Fill ``velocity`` with those of the nodes at t_n."""
        history_kernels.velocities(self.v, self.f, self.inverse_mass, 0.5 * self.dt_previous, self.velocity)
        move_tied(self.ties, self.velocity)

    def noted(self) -> Noted:
        """Sum what the histories note of t_n, once `assemble_forces` was called."""
        self._find_velocities()
        history_kernels.watch(self.recorder.watched, self.model.mesh.points, self.x, self.velocity, self.moved)
        steps = self.dt_previous, self.dt_next
        history_kernels.kinetic(self.v, self.f, self.mass, self.inverse_mass, *steps, self.kinetic)
        return Noted(
            self.moved,
            float(self.kinetic.sum()),
            [kind.peaks() for kind in self.solid.kinds],
            {
                section.name: section.mean(self.solid.kinds[section.kind].blocks.state[section.rows])
                for section in self.section_stresses
            },
            sum((each.now() for each in self.acting), np.zeros(4)),
            {name: felt_by(touch) for name, touch in self.touching.items()},
        )

    @np.errstate(invalid="ignore", over="ignore")
    def record(self) -> str:
        """Note the instant; return the reason why the run cannot go on, or nothing."""
        # Works and impulses are booked up to t_(n-1/2): half a step of the forces now brings them to t_n.
        noted, half = self.noted(), 0.5 * self.dt_previous
        internal, plastic, viscous, hourglass = self.solid.work()
        kinetic = 0.5 * noted.kinetic
        external = self.done["external"] + half * float(noted.acting[0])
        felt = {name: shares.sum(axis=0) for name, shares in noted.touching.items()}
        force = {name: each[:3] for name, each in felt.items()}
        contact = self.done["contact"] - half * sum(float(each[3]) for each in felt.values())
        impulse_given = self.impulse_given + half * noted.acting[1:]
        impulse_given = impulse_given + half * sum((force[name] for name in self.walls), np.zeros(3))
        energies = {
            "kinetic": kinetic,
            "internal": internal,
            "plastic": plastic,
            "hourglass": hourglass,
            "contact": contact,
            "viscous": viscous,
            "external": external,
        }
        sums: dict[str, Any] = {**energies, "impulse_given": impulse_given}
        for name in force:
            sums[f"force/{name}"] = force[name]
            sums[f"impulse/{name}"] = self.impulse[name] + half * force[name]
            sums[f"pressed/{name}"] = pressed(noted.touching[name], 1 if name in self.walls else 2)
        self.recorder.note(self.time, noted, [kind.blocks.part for kind in self.solid.kinds], sums)
        return self._broken(energies)

    def _broken(self, energies: Mapping[str, float]) -> str:
        accounted = sum(energies[name] for name in KEPT)
        supplied = self.initial_energy + energies["external"]
        largest = max(abs(supplied), self.initial_energy, *(abs(e) for e in self.recorder.column("external")))
        largest = max(largest, energy_at_rest(float(self.mass.sum())))  # where nothing moves, all energy is rounding
        where = f"at {self.time:.4g} s"
        if not np.isfinite(accounted):
            return f"the numbers end {where}: {self.worst_element()}"
        if abs(accounted - supplied) > BROKEN * largest and self.steps:
            off = (accounted - supplied) / largest
            most = max((abs(energies[n]), n) for n in ("internal", "hourglass", "contact", "viscous"))[1]
            return (
                f"the energy is off by {percent(off, 0, '+')} {where}, and {most} energy is largest; "
                f"{self.worst_element()}"
            )
        if self.critical < self.collapse:
            return f"the critical step fell to {self.critical:.3g} s {where}: {self.worst_element()}"
        return ""

    def worst_element(self) -> str:
        """Name the element whose corners are bent most."""
        mesh = self.model.mesh
        with np.errstate(all="ignore"):
            bent = scaled_jacobians(self.x, mesh.hexahedra).min(axis=1)
        worst = int(np.argmin(np.where(np.isfinite(bent), bent, -np.inf)))
        place = mesh.points[mesh.hexahedra[worst]].mean(axis=0)
        part = mesh.names[mesh.part[worst]]
        return (
            f"look at element {worst - mesh.elements_of(part).start} of {part}, at first around "
            f"({', '.join(f'{c:.4g}' for c in place)}) m, whose scaled Jacobian is {bent[worst]:.3g} now"
        )

    def frame(self) -> FieldFrame:
        """Return the whole field at t_n, once `assemble_forces` was called."""
        motion = self.motion()
        stress, strain = self.solid.cell_values(self.elements)
        return FieldFrame(self.time, motion.displacement, motion.velocity, stress, strain)

    def result(self, seconds: float, stopped: str, frames: tuple[FieldFrame, ...]) -> FemRun:
        """Return the run with all that was noted."""
        noted, names = self.recorder, self.touching
        return FemRun(
            time=noted.column("time"),
            force={name: noted.column(f"force/{name}") for name in names},
            impulse={name: noted.column(f"impulse/{name}") for name in names},
            energy=noted.energy(),
            initial_energy=self.initial_energy,
            parts=noted.part_histories(),
            groups={name: assembly(noted.part_histories(), parts) for name, parts in self.model.groups.items()},
            points=noted.point_histories(),
            sections=noted.section_histories(),
            momentum=noted.column("momentum"),
            impulse_given=noted.column("impulse_given"),
            steps=self.steps,
            step=self.smallest,
            added_mass=self.added_mass,
            seconds=seconds,
            elements=self.elements,
            stopped=stopped,
            frames=frames,
            von_mises=noted.largest("von_mises"),
            plastic_strain=noted.largest("plastic_strain"),
            overlaps=tuple(self.overlaps),
            pressed={name: noted.column(f"pressed/{name}") for name in names},
            blow=self.blow,
            rest=self.rest,
            plastic_work=self.solid.plastic_work(self.model.mesh.names),
            bodies=joined_parts(self.model.mesh, self.ties),
        )


def build_elements(model: Model, parts: Iterable[str], mass: Array, pool: ThreadPoolExecutor | None) -> Mixed:
    """Return the elements of some parts, at rest and without stress; ``mass`` (elements,) is theirs, kg."""
    mesh, solids, controls = model.mesh, model.solids, model.controls
    viscous = controls.linear_viscosity, controls.quadratic_viscosity
    full = {n: mass[mesh.elements_of(n), None] for n in parts if n in controls.full}
    one_point = {n: one_point_constants(mesh, solids, n, mass, controls.hourglass) for n in parts if n not in full}
    sorts: list[tuple[type[Hexahedra], dict[str, Array]]] = [(OnePoint, one_point), (FullyIntegrated, full)]
    return Mixed(
        [
            sort(*build_blocks(mesh, solids, constants, sort.points), viscous, pool, controls.threads)
            for sort, constants in sorts
            if constants
        ]
    )
