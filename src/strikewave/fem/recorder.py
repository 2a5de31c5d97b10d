"""Histories of a run, recorded as it goes on; SI."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from strikewave.base.errors import InputError
from strikewave.fem import _history_kernels as history_kernels
from strikewave.fem._contact_kernels import NodeTouch
from strikewave.fem._history_kernels import ROWS, WatchedNodes, shares_of
from strikewave.fem.boundary import unit
from strikewave.fem.hexahedron import Hexahedra
from strikewave.fem.mesh import TINY, Array, Index, Mesh, volumes
from strikewave.fem.model import CutSection, Model
from strikewave.fem.run import ENERGIES, PartHistory, PointHistory, SectionHistory
from strikewave.fem.sections import ON_SURFACE


class NodeMotion(NamedTuple):
    """Displacement and velocity of the nodes at an instant, each (nodes, 3)."""

    displacement: Array
    velocity: Array


class Noted(NamedTuple):
    """Sums of an instant, made where the steps are taken; see `strikewave.fem._history_kernels`."""

    moved: Array
    """Weighted sums of displacement, m, and velocity, m/s, of the nodes that are watched, (shares, 6)."""
    kinetic: float
    """Twice the kinetic energy, J."""
    peaks: Sequence[Array]
    """Largest squared von Mises stress, Pa^2, and plastic strain of chunks, (chunks, 2), for each kind of elements."""
    stress: Mapping[str, Array]
    """Mean stress of each section but those of rigid parts, Pa, (6,)."""
    acting: Array
    """Power of all forces but those of contact on the velocities before, W, and their sum, N, (4,)."""
    touching: Mapping[str, Array]
    """Forces, powers and areas of each contact and wall, (shares, TOUCHED); see `touch_share`."""


class HistoryRecorder:
    """Record of each instant: rows of named columns.

    ``shares`` are the masses of each part at its nodes, kg, before ties hand any on.
    """

    def __init__(self, model: Model, shares: Mapping[str, Array]) -> None:
        mesh = model.mesh
        self.names = mesh.names
        self.masses = {name: float(share.sum()) for name, share in shares.items()}
        rigid = {each.part for each in model.rigid}
        self.bearing = [name for name in mesh.names if name not in rigid]
        self.points = {p.name: mesh.nearest_node(p.part, p.place) for p in model.points}
        self.sections = {s.name: section_elements(mesh, s) for s in model.sections}
        groups = {f"part/{name}": (mesh.nodes_of(name), share / self.masses[name]) for name, share in shares.items()}
        groups |= {f"point/{name}": (np.array([node]), np.ones(1)) for name, node in self.points.items()}
        for name, (elements, volume) in self.sections.items():
            groups[f"section/{name}"] = mesh.hexahedra[elements].ravel(), np.repeat(volume / 8.0, 8)
        self.groups, self.first_shares, self.watched = list(groups), *watched(list(groups.values()))
        self.rows: dict[str, list[Array]] = {}

    def note(self, time: float, noted: Noted, owners: Sequence[Index], sums: Mapping[str, object]) -> None:
        """Add a row: the sums (energies, forces, impulses) as they are, the motion of what is watched, the largest.

        ``owners`` are the parts of the chunks of each kind of elements, (chunks,).
        """
        moved = np.add.reduceat(noted.moved, self.first_shares).reshape(-1, 2, 3)
        row: dict[str, object] = {"time": time, **sums, **dict(zip(self.groups, moved, strict=True))}
        row |= {f"stress/{name}": noted.stress.get(name, np.zeros(6)) for name in self.sections}
        momentum = np.zeros(3)
        for name, motion in zip(self.masses, moved, strict=False):
            momentum += self.masses[name] * motion[1]
        row["momentum"] = momentum
        for owner, peaks in zip(owners, noted.peaks, strict=True):
            for part in np.unique(owner):
                square, strain = peaks[owner == part].max(axis=0)
                row[f"von_mises/{self.names[part]}"] = np.sqrt(square)
                row[f"plastic_strain/{self.names[part]}"] = strain
        for key, value in row.items():
            self.rows.setdefault(key, []).append(np.asarray(value, float))

    def column(self, key: str) -> Array:
        """Return a column as one array, first axis the instants."""
        return np.array(self.rows[key])

    def _motion(self, key: str) -> tuple[Array, Array, Array]:
        """Return displacement, velocity and average acceleration about the instants of what is watched."""
        moved, speed = np.moveaxis(self.column(key), 1, 0)
        return moved, speed, average_acceleration(self.column("time"), moved, speed)

    def energy(self) -> dict[str, Array]:
        """Return the columns of the energy balance."""
        return {name: self.column(name) for name in ENERGIES}

    def largest(self, what: str) -> dict[str, Array]:
        """Return the largest ``von_mises`` stress or ``plastic_strain`` of the elements of each part that deforms."""
        return {name: self.column(f"{what}/{name}") for name in self.bearing}

    def part_histories(self) -> dict[str, PartHistory]:
        """Return the motion of the parts."""
        histories = {}
        for name, mass in self.masses.items():
            moved, speed, rate = self._motion(f"part/{name}")
            histories[name] = PartHistory(mass, speed, rate, moved)
        return histories

    def point_histories(self) -> dict[str, PointHistory]:
        """Return the motion of the points."""
        return {name: PointHistory(node, *self._motion(f"point/{name}")) for name, node in self.points.items()}

    def section_histories(self) -> dict[str, SectionHistory]:
        """Return stress and motion of the sections."""
        histories = {}
        for name, (elements, _) in self.sections.items():
            _, speed, rate = self._motion(f"section/{name}")
            histories[name] = SectionHistory(len(elements), self.column(f"stress/{name}"), speed, rate)
        return histories


def average_acceleration(time: Array, displacement: Array, velocity: Array) -> Array:
    """Return the average acceleration about each instant, m/s^2, (instants, ...).

    The weight is the hat function of the instant, one there and zero at its neighbours: the difference of the mean
    velocities of the two intervals beside it over half their sum, and of that of one interval and the velocity at the
    first and last instant. Its integral by the trapezoidal rule is the change of velocity, whatever happens within a
    step: where flat faces meet, the acceleration of a step is a velocity over that step.
    """
    if len(time) < 2:
        return np.zeros_like(velocity)
    spans = np.diff(time).reshape(-1, *[1] * (velocity.ndim - 1))
    mean = np.diff(displacement, axis=0) / spans
    change = np.diff(np.concatenate([velocity[:1], mean, velocity[-1:]]), axis=0)
    halves = 0.5 * spans
    return np.asarray(change / np.concatenate([halves[:1], halves[1:] + halves[:-1], halves[-1:]]))


def assembly(parts: Mapping[str, PartHistory], names: Sequence[str]) -> PartHistory:
    """Return the motion of some parts as one body: sums of momentum over the sum of their masses."""
    mass = np.array([parts[name].mass for name in names])
    velocity, rate, moved = (
        np.tensordot(mass / mass.sum(), np.array([getattr(parts[name], what) for name in names]), axes=1)
        for what in ("velocity", "acceleration", "displacement")
    )
    return PartHistory(float(mass.sum()), velocity, rate, moved)


def pressed(felt: Array, surfaces: int) -> Array:
    """Return the pressed part of each surface: its share by area, and the area over that of a face, (surfaces, 2).

    ``felt`` (shares, TOUCHED) is what the shares of the nodes feel. A wall has one surface, a contact two.
    """
    area, under = felt[:, [4, 7]].sum(axis=0), felt[:, [5, 8]].sum(axis=0)
    largest = np.maximum(felt[:, [6, 9]].max(axis=0), TINY)
    return np.column_stack([under / np.maximum(area, TINY), under / largest])[:surfaces]


def watched(groups: Sequence[tuple[Index, Array]]) -> tuple[Index, WatchedNodes]:
    """Return the first share of each group of nodes, and all shares; groups are nodes and weights."""
    sizes = np.array([len(nodes) for nodes, _ in groups])
    ends = np.cumsum(sizes)
    begins = [np.arange(end - size, end, ROWS) for size, end in zip(sizes, ends, strict=True)]
    first = np.cumsum([0, *(len(each) for each in begins[:-1])])
    return first, WatchedNodes(
        np.concatenate([*begins, ends[-1:]]).astype(np.int64),
        np.concatenate([nodes for nodes, _ in groups]).astype(np.int32),
        np.concatenate([weights for _, weights in groups]),
    )


def section_elements(mesh: Mesh, section: CutSection) -> tuple[Index, Array]:
    """Return the elements that a section cuts, and their shares of its volume."""
    chosen = mesh.elements_of(section.part)
    corners = mesh.points[mesh.hexahedra[chosen]]
    height = (corners - np.array(section.point)) @ unit(section.normal, f"section.{section.name}.normal")
    small = ON_SURFACE * float(np.abs(height).max())
    cut = (height.min(axis=1) <= small) & (height.max(axis=1) > small)
    if not cut.any():
        places = mesh.points[mesh.nodes_of(section.part)]
        low, high = (ends.round(6).tolist() for ends in (places.min(axis=0), places.max(axis=0)))
        raise InputError(
            f"section.{section.name}.point",
            list(section.point),
            f"a plane that cuts {section.part}, which reaches from {low} to {high} m",
        )
    elements = (np.flatnonzero(cut) + chosen.start).astype(np.int32)
    volume = volumes(mesh.points, mesh.hexahedra[elements])
    return elements, volume / volume.sum()


def felt_by(touch: NodeTouch) -> Array:
    """Return forces, powers and areas of the shares of a contact or wall, (shares, TOUCHED): see `touch_share`."""
    felt = np.zeros((shares_of(len(touch.nodes)), history_kernels.TOUCHED))
    history_kernels.touches(touch, felt)
    return felt


class SectionStress(NamedTuple):
    """Places of the stress of a section: rows (points, 6) of the state of a kind of elements, and their weights."""

    name: str
    kind: int
    rows: Index
    weights: Array

    def mean(self, stress: Array) -> Array:
        """Return the mean of the stress of the points, (points, 6), by volume."""
        return np.asarray(self.weights @ stress)


def section_stresses(kinds: Sequence[Hexahedra], sections: Mapping[str, tuple[Index, Array]]) -> list[SectionStress]:
    """Return the places of the stress of each section but those of rigid parts, which have none."""
    stresses = []
    for (name, (elements, volume)), kind in itertools.product(sections.items(), range(len(kinds))):
        places = kinds[kind].stress_places(elements)
        if len(places):
            rows = places.reshape(-1, 1) + np.array(history_kernels.STRESS)
            shares = np.repeat(volume / kinds[kind].points, kinds[kind].points)
            stresses.append(SectionStress(name, kind, rows, shares))
    return stresses
