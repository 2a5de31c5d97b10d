"""A folder of LS-DYNA: contact forces, energies and fields of a run; SI."""

from __future__ import annotations

import dataclasses
import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strikewave.base import declare
from strikewave.base.declare import KEY, MAIN, MORE, Quantity
from strikewave.base.errors import InputError, show
from strikewave.base.shock_quantities import LENGTH, MICROSECONDS, RATIO
from strikewave.exchange.ls_dyna.d3plot import D3plot, read_d3plot
from strikewave.exchange.ls_dyna.histories import (
    Array,
    ContactForce,
    GlobalEnergies,
    read_binout,
    read_glstat,
    read_rcforc,
)
from strikewave.exchange.units import UnitSystem
from strikewave.fem.run import MEASURED_IMPULSE, MEASURED_STRESS, MEASURED_WIDTH, FieldFrame
from strikewave.fem.solids import von_mises
from strikewave.signal.pulse import WIDTH_FRACTION, crossing

NAMES = re.compile(r"(?P<job>(.+\.)?)(?P<name>rcforc|glstat|d3plot|binout\d*)", re.DOTALL)
"""Names of the files that are read; with ``jobid=JOB`` LS-DYNA puts the job before all."""
ENERGIES = {
    "kinetic": ("kinetic energy",),
    "internal": ("internal energy",),
    "hourglass": ("hourglass energy",),
    "contact": ("sliding interface energy", "stonewall energy"),
    "external": ("external work",),
    "total": ("total energy",),
}
"""Our words for energies, and the names that LS-DYNA has for them; where there are several they are added up."""


@dataclass(frozen=True)
class Force:
    """A contact force over time.

    Attributes
    ----------
    time : array (instants,)
        s, rising.
    force : array (instants, 3)
        N.
    impulse : array (3,) or None
        N s, where it is known better than by the trapezia between the instants.
    """

    time: Array
    force: Array
    impulse: Array | None = None

    @property
    def size(self) -> Array:
        """Size of the force, N, (instants,)."""
        return np.asarray(np.linalg.norm(self.force, axis=1))

    @property
    def gathered(self) -> Array:
        """Impulse of the whole curve, N s, (3,)."""
        return np.asarray(np.trapezoid(self.force, self.time, axis=0)) if self.impulse is None else self.impulse


@declare.dataclass
class ContactPulse:
    """Peak, impulse and times of a contact force."""

    peak: float = declare.number(
        Quantity("N", "kN"),
        "largest size of the force",
        column=MAIN,
        tables="contacts",
        headline="peak of contact {name}",
    )
    at: float = declare.number(MICROSECONDS, "its instant", label="peak at", column=MORE + 1, tables="contacts")
    impulse: float = declare.number(MEASURED_IMPULSE, "size of the impulse", column=MAIN, tables="contacts")
    begin: float = declare.number(
        MICROSECONDS, "when the size first passes a tenth of the peak", label="onset", column=MORE + 1
    )
    end: float = declare.number(MICROSECONDS, "when it last does, all gaps between included", column=MORE + 1)

    @declare.computed(
        declare.number(MEASURED_WIDTH, "from first to last tenth of the peak", column=MAIN, tables="contacts")
    )
    def width(self) -> float:
        """From first to last tenth of the peak."""
        return self.end - self.begin


@declare.dataclass
class Extreme:
    """The most that a part came to at the instants of its fields."""

    displacement: float = declare.number(LENGTH, "largest displacement", column=MAIN)
    von_mises: float = declare.number(MEASURED_STRESS, "largest von Mises stress", label="von Mises", column=MAIN)
    plastic_strain: float = declare.number(RATIO, "largest plastic strain", column=MAIN)


@dataclass(frozen=True)
class EnergyHistory:
    """Energies over time: s and J, (instants,), by the words of `ENERGIES`."""

    time: Array
    energy: Mapping[str, Array] = field(default_factory=dict)


@declare.dataclass
class LsDynaContact:
    """A contact of LS-DYNA.

    Beside what documents have:

    Attributes
    ----------
    sides : mapping of str to Force
        Forces by ``A`` (slave) and ``B`` (master).
    """

    number: int = declare.count("number of the contact", column=KEY, tables="contacts")
    title: str = declare.word("its title; empty where it has none", column=KEY, tables="contacts")
    sides: Mapping[str, Force] = field(repr=False)

    @declare.computed(declare.named(ContactPulse, "what the force on each side comes to", key="sides"))
    def pulses(self) -> dict[str, ContactPulse | None]:
        """The pulse of the force on each side; None where nothing touched."""
        return {side: pulse_of(force) for side, force in sorted(self.sides.items())}

    @property
    def name(self) -> str:
        """Number and title."""
        return f"{self.number} {self.title}".strip()

    @property
    def first(self) -> Force:
        """The side that is there, A before B."""
        return self.sides[min(self.sides)]


@dataclass(frozen=True)
class LsDynaRun:
    """The run that a folder holds.

    Attributes
    ----------
    folder : Path
    files : tuple of Path
        Files that were read.
    contacts : tuple of LsDynaContact
        Contacts by number; empty where no file of forces is there.
    energies : EnergyHistory or None
    fields : D3plot or None
    extremes : mapping of str to Extreme
        Extremes by part of the d3plot.
    frames : int
        Instants of the fields.
    span : tuple of float
        First and last instant of anything, s.
    """

    folder: Path
    files: tuple[Path, ...]
    contacts: tuple[LsDynaContact, ...]
    energies: EnergyHistory | None
    fields: D3plot | None
    extremes: Mapping[str, Extreme]
    frames: int
    span: tuple[float, float]

    @property
    def parts(self) -> dict[str, int]:
        """Numbers of the parts of the d3plot by their names."""
        return dict(zip(self.fields.mesh.names, self.fields.numbers, strict=True)) if self.fields else {}


def read_folder(folder: Path, units: UnitSystem) -> LsDynaRun:
    """Return what a folder of LS-DYNA holds: ``rcforc``, ``glstat``, ``binout...`` and ``d3plot...``.

    The text files count where both they and a binout are there. All may begin with the name of a job, ``JOB.rcforc``.
    """
    if not folder.is_dir():
        raise InputError("FOLDER", folder, "a folder with rcforc, glstat, binout or d3plot")
    by_name = _held(folder)
    text = {name: by_name[name] for name in ("rcforc", "glstat") if name in by_name}
    archives = [by_name[name] for name in sorted(by_name) if name.startswith("binout")]
    forces, energies = read_binout(archives) if archives and len(text) < 2 else ((), None)
    forces = read_rcforc(text["rcforc"]) if "rcforc" in text else forces
    energies = read_glstat(text["glstat"]) if "glstat" in text else energies
    contacts, history = _contacts(forces, units), _history(energies, units) if energies else None
    fields = read_d3plot(by_name["d3plot"], units) if "d3plot" in by_name else None
    extremes, times = _extremes(fields) if fields else ({}, [])
    spans = [side.time for contact in contacts for side in contact.sides.values()]
    spans += ([history.time] if history else []) + ([np.array(times)] if times else [])
    files = (*text.values(), *(archives if len(text) < 2 else ()), *((by_name["d3plot"],) if fields else ()))
    first = min((float(time[0]) for time in spans if len(time)), default=math.nan)
    last = max((float(time[-1]) for time in spans if len(time)), default=math.nan)
    return LsDynaRun(folder, files, contacts, history, fields, extremes, len(times), (first, last))


def _held(folder: Path) -> dict[str, Path]:
    """Return the files of a run by their names, without that of the job; those without one before all others."""
    try:
        matches = [
            (match, path) for path in folder.iterdir() if (match := NAMES.fullmatch(path.name)) and path.is_file()
        ]
    except OSError as error:
        raise InputError("FOLDER", folder, "a folder that can be read", error.strerror or str(error)) from None
    jobs = sorted({match["job"] for match, _ in matches})
    if not matches or (len(jobs) > 1 and jobs[0]):
        hint = f"it holds those of several jobs: {show(', '.join(jobs))}" if matches else "none of them is there"
        raise InputError("FOLDER", folder, "a folder with rcforc, glstat, binout or d3plot", hint)
    return {match["name"]: path for match, path in matches if match["job"] == jobs[0]}


def pulse_of(force: Force) -> ContactPulse | None:
    """Measure a contact force by its size; None where nothing touched.

    Examples
    --------
    >>> t = np.linspace(0.0, 1e-3, 1001)
    >>> half_sine = 1e3 * np.sin(np.pi * np.clip((t - 2e-4) / 6e-4, 0.0, 1.0))
    >>> pulse = pulse_of(Force(t, np.outer(half_sine, [0.0, 0.6, -0.8])))
    >>> round(pulse.peak, 6), round(pulse.at * 1e6), round(pulse.width * 1e6, 1), round(pulse.impulse, 4)
    (1000.0, 500, 561.7, 0.382)
    """
    size = force.size
    peak = float(size.max(initial=0.0))
    if not peak > 0.0:
        return None
    above = np.flatnonzero(size > WIDTH_FRACTION * peak)
    places = [
        crossing(size, int(above[0]), WIDTH_FRACTION * peak, -1),
        crossing(size, int(above[-1]), WIDTH_FRACTION * peak, 1),
    ]
    count = np.arange(size.size)
    begin, end = (float(t) for t in np.interp(places, count, force.time))
    return ContactPulse(
        peak=peak,
        at=float(force.time[int(np.argmax(size))]),
        impulse=float(np.linalg.norm(force.gathered)),
        begin=float(force.time[0]) if math.isnan(places[0]) else begin,
        end=float(force.time[-1]) if math.isnan(places[1]) else end,
    )


def widened(
    so_far: Mapping[str, Extreme], frame: FieldFrame, parts: Mapping[str, tuple[NDArray[Any], slice]]
) -> dict[str, Extreme]:
    """Return the extremes of parts with those of a further frame; ``parts`` are nodes and elements of each."""
    size, stress = np.linalg.norm(frame.displacement, axis=1), von_mises(frame.stress)
    extremes = {}
    for name, (nodes, elements) in parts.items():
        now = (size[nodes].max(), stress[elements].max(), frame.plastic_strain[elements].max())
        before = so_far.get(name, Extreme(0.0, 0.0, 0.0))
        most = map(max, (before.displacement, before.von_mises, before.plastic_strain), map(float, now))
        extremes[name] = Extreme(*most)
    return extremes


def _contacts(forces: tuple[ContactForce, ...], units: UnitSystem) -> tuple[LsDynaContact, ...]:
    contacts: dict[int, LsDynaContact] = {}
    for series in forces:
        force = Force(series.time * units.time, series.force / units.force)
        sides = contacts[series.number].sides if series.number in contacts else {}
        if series.side in sides:
            raise InputError(f"contact {series.number}, side {series.side}", "two forces", "one force on each side")
        contacts[series.number] = LsDynaContact(series.number, series.title, {**sides, series.side: force})
    return tuple(contacts[number] for number in sorted(contacts))


def _history(energies: GlobalEnergies, units: UnitSystem) -> EnergyHistory:
    energy = {}
    for word, names in ENERGIES.items():
        columns = [energies.values[name] for name in names if name in energies.values]
        if columns:
            energy[word] = np.sum(columns, axis=0) / units.energy
    return EnergyHistory(energies.time * units.time, energy)


def _extremes(fields: D3plot) -> tuple[dict[str, Extreme], list[float]]:
    """Return the extremes of the parts, without stress and strain of deleted elements, and the instants."""
    mesh = fields.mesh
    parts = {name: (mesh.nodes_of(name), mesh.elements_of(name)) for name in mesh.names}
    extremes: dict[str, Extreme] = {}
    times = []
    for state in fields.states():
        stress = np.where(state.alive[:, None], state.frame.stress, 0.0)
        strain = np.where(state.alive, state.frame.plastic_strain, 0.0)
        extremes = widened(extremes, dataclasses.replace(state.frame, stress=stress, plastic_strain=strain), parts)
        times.append(state.frame.time)
    return extremes, times
