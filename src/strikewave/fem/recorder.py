"""Histories of a run while it goes on; SI."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from strikewave.base.errors import InputError
from strikewave.fem._contact_kernels import NodeTouch
from strikewave.fem.boundary import unit
from strikewave.fem.invariants import von_mises
from strikewave.fem.mesh import TINY, Array, Index, Mesh, volumes
from strikewave.fem.model import CutSection, Model
from strikewave.fem.run import ENERGIES, PartHistory, PointHistory, SectionHistory
from strikewave.fem.sections import ON_SURFACE


class NodeMotion(NamedTuple):
    """Displacement and velocity of the nodes at an instant, each (nodes, 3)."""

    displacement: Array
    velocity: Array


class HistoryRecorder:
    """What is noted at each instant: rows of named columns.

    Parameters
    ----------
    model : Model
    mass : array (nodes,)
        Of the nodes before ties hand any on, kg.
    shares : mapping of str to array (nodes of the part,)
        The part's own mass at its nodes, kg.
    """

    def __init__(self, model: Model, mass: Array, shares: Mapping[str, Array]) -> None:
        self.mesh, self.mass, self.shares = model.mesh, mass, shares
        self.nodes = {name: model.mesh.nodes_of(name) for name in model.mesh.names}
        self.bearing = {n: self.mesh.elements_of(n) for n in model.mesh.names if n not in {r.part for r in model.rigid}}
        self.points = {p.name: model.mesh.nearest_node(p.part, p.place) for p in model.points}
        self.sections = {s.name: section_elements(model.mesh, s) for s in model.sections}
        self.rows: dict[str, list[Array]] = {}

    def note(self, time: float, motion: NodeMotion, cells: tuple[Array, Array], sums: Mapping[str, object]) -> None:
        """Add a row: the sums (energies, forces, impulses) as they are, the motion of what is watched, the largest.

        ``cells`` are stress (elements, 6) and plastic strain (elements,).
        """
        stress, strain = cells
        equivalent = von_mises(stress)
        row: dict[str, object] = {"time": time, **sums, "momentum": self.mass @ motion.velocity}
        for name, nodes in self.nodes.items():
            share = self.shares[name] / self.shares[name].sum()
            row[f"part/{name}"] = np.array([share @ field[nodes] for field in motion])
        for name, own in self.bearing.items():
            row[f"von_mises/{name}"] = equivalent[own].max()
            row[f"plastic_strain/{name}"] = strain[own].max()
        for name, node in self.points.items():
            row[f"point/{name}"] = np.array([field[node] for field in motion])
        for name, (elements, volume) in self.sections.items():
            corners = self.mesh.hexahedra[elements]
            row[f"stress/{name}"] = volume @ stress[elements]
            row[f"section/{name}"] = np.array([volume @ field[corners].mean(axis=1) for field in motion])
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
        for name, share in self.shares.items():
            moved, speed, rate = self._motion(f"part/{name}")
            histories[name] = PartHistory(float(share.sum()), speed, rate, moved)
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

    Examples
    --------
    A velocity that jumps by 4 m/s in the middle of the second of three intervals:

    >>> average_acceleration(np.arange(4.0), np.array([0.0, 0.0, 2.0, 6.0]), np.array([0.0, 0.0, 4.0, 4.0])).tolist()
    [0.0, 2.0, 2.0, 0.0]
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


def pressed(touch: NodeTouch) -> Array:
    """Return how much of each surface is pressed: its share by area, and the area over that of a face, (surfaces, 2).

    A wall has one surface, a contact two.
    """
    rows, under = [], np.any(touch.normal != 0.0, axis=1)
    for side in (slice(None, touch.first), slice(touch.first, None)):
        area, own = touch.area[side], under[side]
        if len(area):
            pressed_area = float(area[own].sum())
            rows.append([pressed_area / float(area.sum()), pressed_area / float(area[own].max(initial=TINY))])
    return np.array(rows)


def section_elements(mesh: Mesh, section: CutSection) -> tuple[Index, Array]:
    """Return the elements that a section cuts, and their shares of its volume.

    Raises
    ------
    InputError
        If the plane cuts none.
    """
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
