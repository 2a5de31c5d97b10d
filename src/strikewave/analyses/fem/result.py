"""The result of an explicit finite-element run: parts, contacts, balances; histories, tables, documents."""

from __future__ import annotations

import dataclasses
import functools
import math
from collections.abc import Iterator
from dataclasses import field
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from strikewave._version import __version__
from strikewave.analyses.fem.sectors import Sector, blow_of_bodies, sectors
from strikewave.base import declare
from strikewave.base.datasets import LabelledArrays, quantity
from strikewave.base.declare import KEY, MAIN, Quantity
from strikewave.base.result import BALANCE_LIMIT, ELEMENTS_SCHEMA, BalanceCheck, Comparison
from strikewave.base.shock_quantities import (
    ENERGY,
    FORCE,
    MEASURED_IMPULSE,
    MICROSECONDS,
    RATIO,
    RESTITUTION,
    STEP,
    STRESS,
)
from strikewave.cases.case import comparisons
from strikewave.fem.model import Model
from strikewave.fem.run import (
    BALANCE_ERROR,
    BODY_MASS,
    CONTACT_FORCE,
    ENERGIES,
    ENERGY_LIMIT,
    HOURGLASS_LIMIT,
    BalanceMeasure,
    ContactMeasure,
    FemRun,
    FieldFrame,
    PartMeasure,
    Rest,
    balance_measure,
    blow_measure,
    contact_measure,
    mean_acceleration,
    mean_force,
    middles,
    part_measure,
)
from strikewave.fem.snapshots import SnapshotRecorder
from strikewave.reporting.case_result import CaseResult
from strikewave.reporting.columns import HISTORY_DIGITS, Column, csv_table
from strikewave.reporting.faces import amount
from strikewave.reporting.numbers import listed
from strikewave.reporting.parts import written
from strikewave.reporting.shown_result import Curve, history_curve

if TYPE_CHECKING:
    from strikewave.fem.mesh import Mesh

Array = NDArray[np.float64]

STRESS_COMPONENTS = ("xx", "yy", "zz", "xy", "yz", "zx")
"""Components of a stress."""
SECONDS = Quantity("s", "s")


@declare.dataclass
class BodyBlow:
    """The blow that a part or a group took, of its whole body and of the sector that is meshed."""

    measure: PartMeasure = declare.part(PartMeasure, "what it measures", inline=True)
    sectors: int = declare.number(RATIO, "how many of what is meshed make the whole body")
    whole_mass: float = declare.number(BODY_MASS, "equal to mass, which was that of the meshed sector before")
    model_mass: float = declare.number(BODY_MASS, "of what is meshed")


@declare.dataclass
class TouchedBodies:
    """Measure of a contact on whole bodies and on the mesh."""

    measure: ContactMeasure = declare.part(ContactMeasure, "what it measures", inline=True)
    whole_peak: float = declare.number(CONTACT_FORCE, "equal to peak")
    whole_impulse: float = declare.number(MEASURED_IMPULSE, "equal to impulse")
    model_peak: float | None = declare.number(CONTACT_FORCE, "peak on what is meshed", optional=True)
    model_impulse: float | None = declare.number(MEASURED_IMPULSE, "impulse on what is meshed", optional=True)


@declare.dataclass
class Energies:
    """Energies of a run."""

    initial: float = declare.number(ENERGY, "energy at the start", column=MAIN)
    kinetic: float = declare.number(ENERGY, "kinetic energy at the end, as the following ones", column=MAIN)
    internal: float = declare.number(ENERGY, "elastic energy and plastic work", column=MAIN)
    plastic: float = declare.number(ENERGY, "plastic work, a part of the internal energy", column=MAIN)
    hourglass: float = declare.number(ENERGY, "energy in the hourglass modes", column=MAIN)
    contact: float = declare.number(ENERGY, "stored in contacts, and lost to friction", column=MAIN)
    viscous: float = declare.number(ENERGY, "lost to bulk viscosity", column=MAIN)
    external: float = declare.number(
        ENERGY,
        "work of gravity and of driven and pressed sides, less what left through non-reflecting ones",
        column=MAIN,
    )


@declare.dataclass
class BalancedEnergies(Energies):
    """Energies of whole bodies, and how well they balance."""

    error: float = declare.number(
        BALANCE_ERROR,
        "energy that the balance misses, as a share of the energy in play",
        headline="energy balance error",
    )


@declare.dataclass
class ElementsBlow:
    """One of several blows."""

    blow: int = declare.count("number of the blow, from 1", column=KEY)
    contacts: dict[str, TouchedBodies | None] = declare.named(TouchedBodies, "its contacts and walls")
    parts: dict[str, BodyBlow] = declare.named(BodyBlow, "the blow that each part took")
    groups: dict[str, BodyBlow] = declare.named(BodyBlow, "the blow that each group of parts took as one body")
    restitution: dict[str, float | None] = declare.number(RATIO, "coefficient of restitution of each contact")
    plastic_strain: dict[str, float] = declare.number(
        RATIO, "largest plastic strain of each part that deforms, of all blows so far"
    )
    plastic_energy: dict[str, float] = declare.number(ENERGY, "plastic work of this blow in each part that deforms")
    model_plastic_energy: dict[str, float] = declare.number(ENERGY, "the same of what is meshed")
    energy_error: float = declare.number(RATIO, "energy that the balance of this blow misses, as a share")
    rest: Rest | None = declare.part(Rest, "how the bodies came to rest before it; null before the first")
    stopped: str | None = declare.word("why it ended early; null where it did not")


@declare.dataclass
class ContactOfBlow:
    """A contact in one of several blows, and the body whose rigid peak stands for it."""

    blow: int = declare.count("number of the blow, from 1", column=KEY, tables="blow")
    contact: str = declare.word("contact or wall", column=KEY, tables="blow")
    measure: ContactMeasure | None = declare.part(ContactMeasure, "what it measures; None where nothing touched")
    restitution: float | None = declare.number(
        RESTITUTION, "speed of separation over approach", column=MAIN, tables="blow"
    )
    body: str = declare.word("group or part that moves first", column=MAIN, tables="blow")
    pulse: PartMeasure = declare.part(PartMeasure, "the blow that this body took")


@declare.dataclass
class YieldOfBlow:
    """Yield in one of several blows, and the relaxation before it."""

    blow: int = declare.count("number of the blow, from 1", column=KEY, tables="yield")
    plastic_strain: float = declare.number(
        RATIO, "largest so far; NaN where nothing deforms", label="plastic strain, largest", column=MAIN, tables="yield"
    )
    taken: float = declare.number(
        ENERGY, "plastic work of this blow", label="taken by yield", column=MAIN, tables="yield"
    )
    initial: float = declare.number(
        ENERGY, "energy of everything", label="energy at the start", column=MAIN, tables="yield"
    )
    error: float = declare.number(
        BALANCE_ERROR, "energy that the balance misses, as a share", column=MAIN, tables="yield"
    )
    rest: Rest | None = declare.part(Rest, "how the bodies came to rest before it; None before the first")


@declare.dataclass
class BodyComparison(Comparison):
    """Comparison of a number of a part or a group with the published one."""

    sensor: str = declare.word("which part or group it is of, where it is of one", default="")


@declare.dataclass
class FemSolution(CaseResult):
    """Result of an explicit finite-element run; `Result` has the attributes of every result."""

    command: ClassVar[str] = "fem"
    table_name: ClassVar[str] = "parts"
    main_rows: ClassVar[str] = "bodies"
    data_file: ClassVar[str] = "histories.nc"

    model: Model = field(repr=False)
    """Mesh and solids with their boundaries and loads."""
    run: FemRun = field(repr=False)
    """Histories of the first blow, of whole bodies also where sectors are meshed."""
    frames: tuple[FieldFrame, ...] = field(repr=False)
    """Fields to be shown."""
    film: SnapshotRecorder | None = field(default=None, repr=False)
    """Instants for pictures."""
    later: tuple[FemRun, ...] = field(default=(), repr=False)
    """Blows after the first."""
    modelled: tuple[FemRun, ...] = field(default=(), repr=False)
    """All blows as meshed, of the sectors alone; empty where whole bodies are meshed."""

    @declare.computed(declare.named(TouchedBodies, "strongest contact", in_document=False, headline="first"))
    def strongest(self) -> dict[str, TouchedBodies]:
        """The contact of the largest force; none where nothing touched."""
        touched = {name: bodies for name, bodies in self.touched.items() if bodies is not None}
        most = max(touched, key=lambda name: touched[name].measure.peak, default="")
        return {most: touched[most]} if touched else {}

    @declare.computed(declare.named(PartMeasure, "what moves", in_document=False, headline="first"))
    def moved(self) -> dict[str, PartMeasure]:
        """The groups and parts that moved, in the order of `blow_of_bodies`."""
        bodies = blow_of_bodies(self.model, self.run)
        return {name: pulse for name, pulse in bodies.items() if pulse.velocity_change > 0.0}

    @declare.computed(declare.count("how many elements", headline="elements"))
    def elements(self) -> int:
        """Number of elements."""
        return self.run.elements

    @declare.computed(declare.count("how many nodes"))
    def nodes(self) -> int:
        """Number of nodes."""
        return len(self.model.mesh.points)

    @declare.computed(declare.count("how many time steps", headline="steps"))
    def steps(self) -> int:
        """Number of time steps."""
        return self.run.steps

    @declare.computed(declare.number(STEP, "smallest time step"))
    def step(self) -> float:
        """Smallest time step, s."""
        return self.run.step

    @declare.computed(declare.number(BODY_MASS, "by mass scaling on request, of whole bodies"))
    def added_mass(self) -> float:
        """Mass that mass scaling added, kg."""
        return self.run.added_mass

    @declare.computed(declare.number(BODY_MASS, "the same of what is meshed"))
    def model_added_mass(self) -> float:
        """Mass that mass scaling added to what is meshed, kg."""
        return self.model_run.added_mass

    @declare.computed(declare.number(SECONDS, "wall time of the steps"))
    def seconds(self) -> float:
        """Wall time of the steps, s."""
        return self.run.seconds

    @declare.computed(declare.number(Quantity("1/s", "1/s"), "elements times steps over that time"))
    def element_steps_per_second(self) -> float:
        """Pace of the run."""
        return self.run.speed

    @declare.computed(
        declare.number(
            CONTACT_FORCE,
            "largest mean force of any contact over an interval, of whole bodies (before, of the meshed sector)",
        )
    )
    def contact_force_peak(self) -> float:
        """Largest mean force of any contact of the whole bodies over an interval of the histories, N."""
        return max((contact.peak for contact in self.contacts.values() if contact is not None), default=0.0)

    @declare.computed(declare.number(CONTACT_FORCE, "the same of what is meshed"))
    def model_contact_force_peak(self) -> float:
        """Largest mean force of any contact as meshed, of the sectors alone, N."""
        return max((contact.peak for contact in self.model_contacts.values() if contact is not None), default=0.0)

    @declare.computed(declare.named(TouchedBodies, "contacts and walls", key="contacts", label="contact"))
    def touched(self) -> dict[str, TouchedBodies | None]:
        """Measures of each contact and wall in the first blow; None where nothing touched."""
        return self.first_blow.contacts

    @declare.computed(declare.named(BodyBlow, "the blow that each part took", key="parts", label="part"))
    def blow_of_parts(self) -> dict[str, BodyBlow]:
        """The first blow that each part took."""
        return self.first_blow.parts

    @declare.computed(declare.named(BodyBlow, "the blow of each group of parts", key="groups", label="group"))
    def blow_of_groups(self) -> dict[str, BodyBlow]:
        """The first blow that each group of parts took as one body."""
        return self.first_blow.groups

    @declare.computed(declare.named(BodyBlow, "parts as rigid bodies", label="part", in_document=False))
    def bodies(self) -> dict[str, BodyBlow]:
        """The first blow that each part and group took."""
        return {**self.blow_of_parts, **self.blow_of_groups}

    @declare.computed(declare.part(BalancedEnergies, "energies of whole bodies", headline="first"))
    def energy(self) -> BalancedEnergies:
        """Energies of whole bodies."""
        return BalancedEnergies(**_energy(self.run), error=self.measured_balance.energy)

    @declare.computed(declare.part(Energies, "as of energy, of what is meshed"))
    def model_energy(self) -> Energies:
        """Energies of what is meshed."""
        return Energies(**_energy(self.model_run))

    @declare.computed(declare.number(RATIO, "largest hourglass energy over the largest internal energy"))
    def hourglass_share(self) -> float:
        """Largest hourglass energy over the largest internal energy."""
        return self.measured_balance.hourglass

    @declare.computed(declare.number(RATIO, "momentum that the balance misses, as a share"))
    def momentum_error(self) -> float:
        """Momentum that the balance misses."""
        return self.measured_balance.momentum

    @declare.computed(declare.rows(BodyComparison, "comparison with published values"))
    def published(self) -> tuple[BodyComparison, ...]:
        """The comparisons, by the key of the JSON document."""
        return tuple(BodyComparison(**vars(comparison)) for comparison in self.comparisons)

    @declare.computed(declare.word("why the run ended early; null where it did not"))
    def stopped(self) -> str | None:
        """Reason why the run ended early."""
        return self.run.stopped or None

    @declare.computed(declare.rows(ElementsBlow, "each blow", key="blows"))
    def blow_rows(self) -> list[ElementsBlow]:
        """Numbers of each blow."""
        return [self.first_blow, *(each.first_blow for each in self.blows[1:])]

    @declare.computed(declare.rows(ContactOfBlow, "forces of each blow", in_document=False))
    def contacts_of_blows(self) -> list[ContactOfBlow]:
        """The contacts of each blow."""
        rows = []
        for each in self.blows:
            restitution = blow_measure(each.run, each.model.touching).restitution
            body = next(iter(blow_of_bodies(each.model, each.run).items()))
            rows += [
                ContactOfBlow(each.run.blow, name, measure, restitution[name], *body)
                for name, measure in each.contacts.items()
            ]
        return rows

    @declare.computed(declare.rows(YieldOfBlow, "yield in each blow, and relaxation before it", in_document=False))
    def yield_of_blows(self) -> list[YieldOfBlow]:
        """Yield in each blow."""
        rows = []
        for each in self.blows:
            blow, error = blow_measure(each.run, each.model.touching), each.measured_balance.energy
            strain, taken = max(blow.plastic_strain.values(), default=math.nan), sum(blow.plastic_energy.values())
            rows.append(YieldOfBlow(blow.blow, strain, taken, each.run.initial_energy, error, blow.rest))
        return rows

    @functools.cached_property
    def first_blow(self) -> ElementsBlow:
        """Numbers of the first blow."""
        blow, meshed, twins = blow_measure(self.run, self.model.touching), self.model_run, self.model_contacts
        sector, masses = self.sectors, {name: part.mass for name, part in {**meshed.parts, **meshed.groups}.items()}

        def body(name: str, measure: PartMeasure) -> BodyBlow:
            return BodyBlow(measure, sector[name].pieces, measure.mass, masses[name])

        contacts: dict[str, TouchedBodies | None] = {}
        for name, whole in self.contacts.items():
            twin = twins[name]
            of_mesh = (None, None) if twin is None else (twin.peak, twin.impulse)
            contacts[name] = None if whole is None else TouchedBodies(whole, whole.peak, whole.impulse, *of_mesh)
        return ElementsBlow(
            blow=blow.blow,
            contacts=contacts,
            parts={name: body(name, part) for name, part in self.parts.items()},
            groups={name: body(name, part) for name, part in self.groups.items()},
            restitution=dict(blow.restitution),
            plastic_strain=dict(blow.plastic_strain),
            plastic_energy=dict(blow.plastic_energy),
            model_plastic_energy=dict(meshed.plastic_work),
            energy_error=self.measured_balance.energy,
            rest=blow.rest,
            stopped=self.stopped,
        )

    @property
    def blows(self) -> tuple[FemSolution, ...]:
        """Each blow by itself, the first one first."""
        runs = (self.run, *self.later)
        return tuple(
            dataclasses.replace(self, run=run, later=(), modelled=self.modelled[k : k + 1])
            for k, run in enumerate(runs)
        )

    @property
    def model_run(self) -> FemRun:
        """The first blow as meshed: of the sectors, where sectors are meshed."""
        return self.modelled[0] if self.modelled else self.run

    @functools.cached_property
    def measured_balance(self) -> BalanceMeasure:
        """Errors of the balances of the first blow as meshed: momentum across cuts counts too."""
        return balance_measure(self.model_run)

    @property
    def balance_checks(self) -> tuple[BalanceCheck, ...]:
        """The largest errors of the first blow beside their limits."""
        balance = self.measured_balance
        return (
            BalanceCheck("energy", balance.energy, ENERGY_LIMIT, "energy in play"),
            BalanceCheck("hourglass energy", balance.hourglass, HOURGLASS_LIMIT, "largest internal energy"),
            BalanceCheck("momentum", balance.momentum, BALANCE_LIMIT, "momentum in play"),
        )

    @property
    def title(self) -> str:
        """The title of the case."""
        return self.case.title or self.case.name

    @property
    def parts(self) -> dict[str, PartMeasure]:
        """The blow that each part took."""
        return {name: part_measure(self.run, name) for name in self.run.parts}

    @property
    def groups(self) -> dict[str, PartMeasure]:
        """The blow that each group of parts took as one body."""
        return {name: part_measure(self.run, name) for name in self.run.groups}

    @property
    def sectors(self) -> dict[str, Sector]:
        """Sector of its body that each part and group is."""
        return sectors(self.case, self.model)

    @property
    def contacts(self) -> dict[str, ContactMeasure | None]:
        """Measure of each contact and wall on whole bodies; None where nothing touched."""
        return {name: contact_measure(self.run, name) for name in self.run.force}

    @property
    def model_contacts(self) -> dict[str, ContactMeasure | None]:
        """Measure of each contact and wall as meshed, of the sectors alone; None where nothing touched."""
        return {name: contact_measure(self.model_run, name) for name in self.model_run.force}

    def compared(self) -> tuple[Comparison, ...]:
        """Return the published numbers of the case with those of the first blow."""
        return comparisons(self.case, lambda entry: self.number(entry.quantity, entry.sensor))

    def number(self, name: str, body: str = "") -> float | None:
        """Return a published quantity of the first blow: a force of the first contact, or a number of a part or group.

        None where the model has no such quantity.
        """
        which, _, quantity = name.partition(".")
        touched = next(iter(self.contacts.values()), None)
        part = {**self.parts, **self.groups}.get(body)
        if which != "first" or touched is None:
            return None
        numbers = {"peak_force": touched.peak, "force_width": touched.duration}
        if part is not None:
            numbers |= {"force_over_mass": touched.peak / part.mass, "rigid_peak": part.rigid_peak, "width": part.width}
        value = numbers.get(quantity)
        return None if value is None or math.isnan(value) else value

    def preview(self) -> Curve | None:
        """Return the mean force of the strongest contact; None where nothing touched."""
        touched = {name: contact.peak for name, contact in self.contacts.items() if contact is not None}
        if not touched:
            return None
        name = max(touched, key=touched.__getitem__)
        force = np.linalg.norm(mean_force(self.run, name), axis=1)
        return history_curve(middles(self.run.time), force, *FORCE.units, f"contact force, {name}")

    def _columns(self) -> Iterator[tuple[str, str, Array]]:
        """Yield name, unit and values of every history but the time; means are those of the interval before."""
        run = self.run
        for name, force in run.force.items():
            yield from _components(f"{name} force", "N", force)
            yield from _components(f"{name} mean force", "N", _after(mean_force(run, name)))
        for name, part in {**run.parts, **run.groups}.items():
            yield from _components(f"{name} displacement", "m", part.displacement)
            yield from _components(f"{name} velocity", "m/s", part.velocity)
            yield from _components(f"{name} rigid acceleration", "m/s^2", part.acceleration)
            yield from _components(f"{name} mean rigid acceleration", "m/s^2", _after(mean_acceleration(run, name)))
        for name, values in run.von_mises.items():
            yield f"{name} largest von Mises stress", "Pa", values
            yield f"{name} largest plastic strain", "1", run.plastic_strain[name]
        for name, point in run.points.items():
            yield from _components(f"{name} displacement", "m", point.displacement)
            yield from _components(f"{name} velocity", "m/s", point.velocity)
            yield from _components(f"{name} acceleration", "m/s^2", point.acceleration)
        for name, section in run.sections.items():
            yield from _components(f"{name} stress", "Pa", section.stress, STRESS_COMPONENTS)
            yield from _components(f"{name} velocity", "m/s", section.velocity)
            yield from _components(f"{name} acceleration", "m/s^2", section.acceleration)
        for name in ENERGIES:
            yield f"{name} energy", "J", run.energy[name]
        yield "energy error", "1", run.energy_error

    def tables(self) -> dict[str, str]:
        """Return all histories of each blow as CSV text, every column with its unit."""
        return {of_blow("histories.csv", blow.run.blow): blow.history_table() for blow in self.blows}

    def history_table(self) -> str:
        """Return all histories of the first blow as CSV text, every column with its unit."""
        columns = [Column(name, values, si) for name, si, values in self._columns()]
        return csv_table([Column("time", self.run.time, "s"), *columns], HISTORY_DIGITS)

    def datasets(self) -> dict[str, LabelledArrays]:
        """Return the histories of each blow, by the names of the files."""
        return {of_blow(self.data_file, blow.run.blow): blow.arrays for blow in self.blows}

    @functools.cached_property
    def arrays(self) -> LabelledArrays:
        """Histories of the first blow by the names of the case; ``model_`` marks those of the sectors alone."""
        run, vector, means = self.run, ("time", "axis"), ("interval", "axis")
        variables = {}

        def add(kind: str, name: str, what: str, values: Array, unit: str, where: tuple[str, ...] = vector) -> None:
            words = f"{what.replace('_', ' ')} of {kind.replace('model_', 'the meshed sectors at ')} {name}"
            variables[f"{kind}.{name}.{what}"] = quantity(where, values, unit, words)

        bases = {"": run, **({"model_": self.model_run} if self.modelled else {})}
        for base, of in bases.items():
            for name, force in of.force.items():
                add(f"{base}contact", name, "force", force, "N")
                add(f"{base}contact", name, "impulse", of.impulse[name], "N s")
                add(f"{base}contact", name, "mean_force", mean_force(of, name), "N", means)
            for name in ENERGIES:
                words = f"{name} energy{' of the meshed sectors' if base else ''}"
                variables[f"{base}energy.{name}"] = quantity("time", of.energy[name], "J", words)
        for kind, named in (("part", run.parts), ("group", run.groups)):
            for name in named:
                add(kind, name, "mean_acceleration", mean_acceleration(run, name), "m/s^2", means)
        for what, unit, most in (("von_mises", "Pa", run.von_mises), ("plastic_strain", "1", run.plastic_strain)):
            for name, values in most.items():
                add("part", name, what, values, unit, ("time",))
        bodies = (("part", run.parts), ("group", run.groups))
        for kind, histories in (*bodies, ("point", run.points), ("section", run.sections)):
            for name, history in histories.items():
                for what, unit in MOTION.items():
                    if hasattr(history, what):
                        add(kind, name, what, getattr(history, what), unit)
        for name, section in run.sections.items():
            add("section", name, "stress", section.stress, "Pa", ("time", "component"))
        variables["energy.error"] = quantity("time", run.energy_error, "1", "energy missing (-) or too much")
        variables["momentum"] = quantity(vector, run.momentum, "kg m/s", "momentum of everything")
        variables["impulse_given"] = quantity(vector, run.impulse_given, "N s", "impulse from outside")
        coordinates = {
            "time": quantity("time", run.time, "s", "time after the start"),
            "interval": quantity("interval", middles(run.time), "s", "middle of the interval between two times"),
            "axis": ("axis", np.array(["x", "y", "z"], dtype=object)),
            "component": ("component", np.array(STRESS_COMPONENTS, dtype=object)),
        }
        attributes = {"strikewave_schema": ELEMENTS_SCHEMA, "strikewave_version": __version__, "case": self.source.text}
        return LabelledArrays.of(variables, coordinates, attributes)


MOTION = {"displacement": "m", "velocity": "m/s", "acceleration": "m/s^2"}
"""Histories of parts, points and sections, and their units."""


def of_blow(name: str, blow: int) -> str:
    """Return the name of a file of a blow, such as histories-3.csv; that of the first blow has no number."""
    stem, _, ending = name.partition(".")
    return name if blow == 1 else f"{stem}-{blow}.{ending}"


def _energy(run: FemRun) -> dict[str, float]:
    """Return the energies at the start, all, and at the end."""
    return {"initial": run.initial_energy, **{name: float(run.energy[name][-1]) for name in ENERGIES}}


def _components(name: str, unit: str, values: Array, axes: tuple[str, ...] = ("x", "y", "z")) -> Iterator[Any]:
    """Yield a column for each component of a history."""
    for axis, column in zip(axes, values.T, strict=True):
        yield f"{name} {axis}", unit, column


def _after(means: Array) -> Array:
    """Return means of intervals as a column beside the instants that end them; nothing is known at the first."""
    return np.concatenate([np.full((1, means.shape[1]), np.nan), means])


def largest_words(film: SnapshotRecorder, mesh: Mesh) -> str:
    """Return places and sizes of the largest von Mises stress and plastic strain of all elements, seen or not."""
    names, places = {"von_mises": "von Mises stress", "plastic_strain": "plastic strain"}, []
    for name, spot in film.largest.items():
        value = amount(STRESS, spot.value) if name == "von_mises" else written(spot.value)
        places.append(f"{names[name]} {value} in {place_words(mesh, spot.element)} at {instant_words(spot.time)}")
    if not places:
        return ""
    where = "centre of the element before the blow"
    return f"Largest values of all elements at the stored instants: {listed(places)} ({where})."


def place_words(mesh: Mesh, element: int) -> str:
    """Return the part of an element and its middle before the blow."""
    middle = mesh.points[mesh.hexahedra[element]].mean(axis=0) * 1e3
    # a picometre, in mm: rounding, which would show as -0
    place = ", ".join(f"{x:.4g}" for x in np.where(np.abs(middle) < 1e-9, 0.0, middle))
    return f"{mesh.names[int(mesh.part[element])]} at ({place}) mm"


def instant_words(time: float) -> str:
    """Return a time with its unit; the time 0 as the start."""
    return amount(MICROSECONDS, time) if time > 0.0 else "the start"
