"""CalculiX beside the explicit elements: writes a model as its deck, runs ccx, reads back what it printed.

CalculiX 2.20 steps explicitly with the alpha method (Miranda, Ferencz & Hughes 1989) and lumped masses; contact is a
linear penalty of nodes on faces. All of it but the equations of motion is other than ours.
"""

import os
import re
import shutil
import subprocess
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from strikewave.fem.mesh import FACES, Mesh
from strikewave.fem.model import Fixed, Model, Pressure
from strikewave.fem.solids import Bilinear, Elastic

CCX = shutil.which("ccx")
HOW_TO_GET = "ccx (CalculiX) is not installed; Debian, Ubuntu: apt-get install calculix-ccx; else www.calculix.de"
LIMIT = 300.0
"""Seconds after which a run is given up."""
OURS = [0, 1, 2, 3, 5, 4]
"""Where xx yy zz xy yz zx stand among CalculiX's xx yy zz xy xz yz."""
BLOCK = re.compile(rb"^ *(displacements|velocities|stresses) \([^)]*\) for set \w+ and time +(\S+)\s*$", re.MULTILINE)


def version():
    """Return the version of CalculiX; None where it is not installed."""
    if CCX is None:
        return None
    said = subprocess.run([CCX, "-v"], stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False).stdout
    found = re.search(r"Version +(\S+)", said)
    return found[1] if found else "of unknown version"


@dataclass(frozen=True)
class Deck:
    """A model for CalculiX, and what CalculiX needs besides.

    Parameters
    ----------
    model : Model
        Parts, solids (elastic or bilinear, isotropic), velocities, fixed sides, pressures, and contact of nodes of the
        first surface with faces of the second, without friction.
    element : str
        C3D8 (2 x 2 x 2 points) or C3D8R (one point, with its own hourglass control).
    penalty : float
        Pressure over overlap, Pa/m.
    every : int
        Increments from one output to the next.
    stressed : array of int or None
        Elements whose stress is written; None: all.
    """

    model: Model
    element: str = "C3D8R"
    penalty: float = 1e14
    every: int = 4
    stressed: np.ndarray | None = None

    @property
    def printed(self):
        """Elements whose stress is written, in ascending order."""
        return np.arange(len(self.model.mesh.hexahedra)) if self.stressed is None else np.unique(self.stressed)

    def text(self):
        """Return the deck."""
        lines = [*_nodes_and_elements(self.model.mesh, self.element), *_solids(self.model)]
        lines += [*_contacts(self.model, self.penalty), *_velocities(self.model)]
        amplitudes, pressures = _held_and_pressed(self.model)
        lines += [*_listed("*ELSET, ELSET=PRINTED", self.printed + 1), *amplitudes]
        lines += ["*STEP, NLGEOM, INC=10000000", "*DYNAMIC, EXPLICIT", f"1e-6, {self.model.controls.duration:.9g}"]
        lines += pressures
        lines += [f"*NODE PRINT, NSET=EVERY, FREQUENCY={self.every}", "U, V"]
        lines += [f"*EL PRINT, ELSET=PRINTED, FREQUENCY={self.every}", "S", "*END STEP"]
        return "\n".join(lines) + "\n"


@dataclass(frozen=True)
class Answer:
    """What CalculiX found.

    Attributes
    ----------
    time : array (instants,)
        s.
    displacement, velocity : array (instants, nodes, 3)
        m, m/s.
    stress : array (instants, elements, 6)
        Mean over the points of an element, Pa, xx yy zz xy yz zx.
    step : float
        Its time step before anything touches, s.
    seconds : float
        Wall time.
    """

    time: np.ndarray
    displacement: np.ndarray
    velocity: np.ndarray
    stress: np.ndarray
    step: float
    seconds: float

    def at(self, field, instant):
        """Return a field between two of its instants, as a straight line."""
        k = int(np.clip(np.searchsorted(self.time, instant), 1, len(self.time) - 1))
        share = (instant - self.time[k - 1]) / (self.time[k] - self.time[k - 1])
        return (1.0 - share) * field[k - 1] + share * field[k]


def run(deck, folder, threads=1):
    """Run CalculiX in a folder and return its `Answer`."""
    Path(folder, "deck.inp").write_text(deck.text(), "ascii")
    begun = time.perf_counter()
    done = subprocess.run(
        [CCX, "deck"],
        cwd=folder,
        env={**os.environ, "OMP_NUM_THREADS": str(threads)},
        stdin=subprocess.DEVNULL,
        capture_output=True,
        timeout=LIMIT,
        check=False,
    )
    seconds = time.perf_counter() - begun
    if done.returncode or b"Job finished" not in done.stdout:
        raise RuntimeError(f"ccx ended with {done.returncode}:\n{done.stdout[-2000:].decode(errors='replace')}")
    step = float(re.search(rb"SELECTED time increment: *(\S+)", done.stdout)[1])
    return _read(Path(folder, "deck.dat").read_bytes(), deck, (step, seconds))


def _read(printed, deck, cost):
    """Return what a .dat file holds, with time step and seconds; a line of stress begins with element and point, one of motion with a node."""
    found = {"displacements": [], "velocities": [], "stresses": []}
    times = {name: [] for name in found}
    heads = list(BLOCK.finditer(printed))
    ends = [*(head.start() for head in heads[1:]), len(printed)]
    for head, end in zip(heads, ends, strict=True):
        name = head[1].decode()
        columns = 8 if name == "stresses" else 4
        rows = np.array(printed[head.end() : end].split(), dtype=float).reshape(-1, columns)
        times[name].append(float(head[2]))
        found[name].append(rows)
    if not times["velocities"] or times["displacements"] != times["velocities"]:
        raise RuntimeError("ccx printed displacements and velocities of other instants")
    stress = [_element_means(rows, deck.printed) for rows in found["stresses"]]
    motion = [np.array([rows[:, 1:] for rows in found[name]]) for name in ("displacements", "velocities")]
    return Answer(np.array(times["velocities"]), *motion, np.array(stress), *cost)


def _element_means(rows, elements):
    """Return the mean stress of each element over its points, all of which weigh the same in a parallelepiped."""
    place = np.searchsorted(elements, rows[:, 0].astype(int) - 1)
    total = np.zeros((len(elements), 6))
    np.add.at(total, place, rows[:, 2:][:, OURS])
    return total / np.bincount(place, minlength=len(elements))[:, None]


def _listed(heading, numbers):
    """Lines of a set, one number each."""
    return [heading, *(f"{n}," for n in np.asarray(numbers).tolist())]


def _nodes_and_elements(mesh: Mesh, element):
    lines = [
        "*NODE, NSET=EVERY",
        *(f"{n + 1}, {x:.12g}, {y:.12g}, {z:.12g}" for n, (x, y, z) in enumerate(mesh.points)),
    ]
    for name in mesh.names:
        chosen = mesh.elements_of(name)
        lines.append(f"*ELEMENT, TYPE={element}, ELSET={name}")
        rows = (mesh.hexahedra[chosen] + 1).tolist()
        lines += [f"{chosen.start + e + 1}, " + ", ".join(map(str, row)) for e, row in enumerate(rows)]
        lines += _listed(f"*NSET, NSET=OF{name}", mesh.nodes_of(name) + 1)
    return lines


def _solids(model):
    lines = []
    for name in model.mesh.names:
        solid = model.solids[name]
        assert type(solid) in (Elastic, Bilinear), "only elastic and bilinear solids are written"
        lines += [f"*MATERIAL, NAME=M{name}", "*ELASTIC", f"{solid.youngs_modulus:.9g}, {solid.poissons_ratio:.9g}"]
        lines += ["*DENSITY", f"{solid.density:.9g}"]
        if isinstance(solid, Bilinear):
            assert solid.kinematic == 0.0, "only isotropic hardening is written"
            lines += ["*PLASTIC", f"{solid.yield_strength:.9g}, 0.0"]
            lines += [f"{solid.yield_strength + 10.0 * solid.plastic_modulus:.9g}, 10.0"]
        lines += [f"*SOLID SECTION, ELSET={name}, MATERIAL=M{name}"]
    return lines


def _owners(mesh):
    """Element and side by CalculiX's numbers of each face, by its nodes in ascending order."""
    return {
        tuple(sorted(face)): (element + 1, side + 1)
        for element, faces in enumerate(mesh.hexahedra[:, FACES].tolist())
        for side, face in enumerate(faces)
    }


def _faces(mesh, owners, side):
    """Element and side of the faces of a side."""
    return [owners[tuple(sorted(face))] for face in mesh.side(side).tolist()]


def _contacts(model, penalty):
    mesh, lines = model.mesh, []
    owners = _owners(mesh)
    for k, contact in enumerate(model.contacts):
        assert contact.friction == 0.0, "only contact without friction is written"
        lines += _listed(f"*SURFACE, NAME=SLAVE{k}, TYPE=NODE", np.unique(mesh.side(contact.first)) + 1)
        faces = _faces(mesh, owners, contact.second)
        lines += [f"*SURFACE, NAME=MASTER{k}", *(f"{element}, S{side}" for element, side in faces)]
        lines += [f"*SURFACE INTERACTION, NAME=TOUCH{k}", "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR"]
        lines += [
            f"{penalty:.9g}",
            f"*CONTACT PAIR, INTERACTION=TOUCH{k}, TYPE=NODE TO SURFACE",
            f"SLAVE{k}, MASTER{k}",
        ]
    return lines


def _velocities(model):
    lines = ["*INITIAL CONDITIONS, TYPE=VELOCITY"]
    for name in model.mesh.names:
        velocity = model.velocity.get(name, (0.0, 0.0, 0.0))
        lines += [f"OF{name}, {axis + 1}, {v:.9g}" for axis, v in enumerate(velocity)]
    return lines


def _held_and_pressed(model):
    """Lines before the step and within it."""
    before, within, owners = [], [], _owners(model.mesh)
    for k, boundary in enumerate(model.boundaries):
        assert isinstance(boundary, Fixed | Pressure), "only fixed sides and pressures are written"
        if isinstance(boundary, Fixed):
            before += ["*BOUNDARY", *(f"{n + 1}, 1, 3" for n in np.unique(model.mesh.side(boundary.side)).tolist())]
            continue
        curve = zip(boundary.pressure.time, boundary.pressure.value, strict=True)
        before += [f"*AMPLITUDE, NAME=PRESSURE{k}", *(f"{t:.12g}, {p:.12g}" for t, p in curve)]
        pressed = _faces(model.mesh, owners, boundary.side)
        within += [f"*DLOAD, AMPLITUDE=PRESSURE{k}", *(f"{element}, P{side}, 1.0" for element, side in pressed)]
    return before, within
