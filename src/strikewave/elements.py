"""A model of hexahedra: case in, solution out."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from strikewave.build.elements import build_model
from strikewave.build.engine_fields import fields_of_case
from strikewave.build.sectors import open_cuts, sectors
from strikewave.case import Case
from strikewave.fem.invariants import von_mises
from strikewave.fem.measures import ENERGY_LIMIT, HOURGLASS_LIMIT, ledger_measure
from strikewave.fem.model import Model, NonReflecting
from strikewave.fem.run import FemRun, Frame
from strikewave.fem.solids import Bilinear, JohnsonCook
from strikewave.fem_solution import FemSolution
from strikewave.materials import material
from strikewave.notices import FEWEST_INTERVALS, LEDGER_LIMIT
from strikewave.solution import Notice

if TYPE_CHECKING:
    from strikewave.fem.solve import Asked, Writer

FEWEST_FACES = 16.0
"""Pressed faces of a whole contact below which its force hangs on the mesh: 9 are 5 % off Hertz's peak, 21 are 1 %."""
ALL_PRESSED = 0.9
"""Share of a surface that is pressed, above which its ends, not its faces, bound the contact."""
ROUNDING = 1e-9
"""Overlaps of less than this share of the whole are rounding."""


@dataclass
class Watch:
    """Hands frames on to a writer; keeps that of the largest stress and the last.

    Parameters
    ----------
    writer : Writer, optional
        Such as `strikewave.fem.vtkhdf.FieldWriter`.
    """

    writer: Writer | None = None
    worst: Frame | None = None
    last: Frame | None = None
    _largest: float = field(default=0.0, init=False)

    def add(self, frame: Frame) -> None:
        """Take a frame."""
        if self.writer is not None:
            self.writer.add(frame)
        largest = float(von_mises(frame.stress).max())
        if largest > self._largest:
            self._largest, self.worst = largest, frame
        self.last = frame

    @property
    def shown(self) -> tuple[Frame, ...]:
        """The frames to be shown, in the order of time."""
        found = {frame.time: frame for frame in (self.worst, self.last) if frame is not None}
        return tuple(found[time] for time in sorted(found))


def run_fem(case: Case, threads: int = 1) -> FemSolution:
    """Run the model of hexahedra of a case.

    Raises
    ------
    InputError, InputErrors
        If the case has no mesh, or parts of it do not fit together.

    Examples
    --------
    >>> from strikewave import load_case
    >>> solution = run_fem(load_case("two-bars-fem", ["fem.duration=20 us"]))
    >>> solution.run.momentum_error < 1e-9
    True
    """
    return run_model(case, build_model(case, threads))


def run_model(case: Case, model: Model, asked: Asked | None = None) -> FemSolution:
    """Run the model of a case; see `run_fem`.

    Parameters
    ----------
    case : Case
        What the model was built from.
    model : Model
        Of the case.
    asked : Asked, optional
        What is asked of the run besides its histories; the case says how many frames.
    """
    from strikewave.fem.solve import Asked, solve

    asked = asked or Asked()
    watch = Watch(asked.writer)
    with fields_of_case(model):
        run = solve(model, asked._replace(writer=watch, frames=int(case.fem.frames.si) if case.fem else 0))
    return FemSolution(
        case=case,
        model=model,
        run=run,
        frames=watch.shown,
        warnings=tuple(notices(case, model, run)),
        citations=sources(model),
    )


def check_model(model: Model) -> None:
    """Prepare a model as a run would, up to its first step: contacts that overlap, ties that reach nothing, sections.

    Raises
    ------
    InputError, InputErrors
        If it could not be run.
    """
    from strikewave.fem.engine import Engine
    from strikewave.fem.solve import check_controls

    with fields_of_case(model):
        check_controls(model)
        Engine(model)


def first_step(model: Model) -> float:
    """Return the time step that a run begins with, s."""
    from strikewave.fem.engine import fitting, scaled_masses

    controls, rigid = model.controls, {one.part for one in model.rigid}
    with fields_of_case(model):
        _, _, critical = scaled_masses(model, [name for name in model.mesh.names if name not in rigid])
    return fitting(controls.interval, controls.safety * critical)


def sources(model: Model) -> tuple[str, ...]:
    """Return the keys of the sources that a model rests on."""
    listed = ["flanagan-belytschko-1981", "hughes-winget-1980"]
    if any(isinstance(solid, JohnsonCook) for solid in model.solids.values()):
        listed.append("johnson-cook-1983")
    if any(isinstance(boundary, NonReflecting) for boundary in model.boundaries):
        listed.append("lysmer-kuhlemeyer-1969")
    return tuple(listed)


def notices(case: Case, model: Model, run: FemRun) -> Iterator[Notice]:
    """Yield what a user should know about a run."""
    if run.stopped:
        message = f"the run ended early: {run.stopped}"
        yield Notice("stopped", message, float(run.time[-1]), model.controls.duration, broken=True)
    yield from _ledgers(run)
    yield from model_notices(case, model)
    if run.added_mass > 0.0:
        share = run.added_mass / sum(part.mass for part in run.parts.values())
        message = f"fem.least_step added {run.added_mass:.3g} kg to small elements, {share:.2%} of all mass"
        yield Notice("added-mass", message, share, 0.0)
    yield from _overlaps(model, run)
    yield from _contacts(run)
    yield from _coarse_contacts(case, model, run)
    yield from _strength(case, model, run)


def model_notices(case: Case, model: Model) -> Iterator[Notice]:
    """Yield what a user should know about a model before it is run."""
    cuts = list(open_cuts(model, sectors(case, model)))
    if cuts:
        message = (
            f"nothing holds the cut {' and '.join(cuts)} in its plane, so the other sectors of that body are as good "
            f'as gone: add [[fem.boundary]] kind = "symmetry", side = "{cuts[0]}"'
        )
        yield Notice("cut-without-symmetry", message, float(len(cuts)), 0.0)


def _ledgers(run: FemRun) -> Iterator[Notice]:
    ledger = ledger_measure(run)
    if not abs(ledger.energy) <= ENERGY_LIMIT:
        what = "too much" if ledger.energy > 0.0 else "missing"
        message = f"{abs(ledger.energy):.2%} of the energy is {what}: take a smaller fem.safety or smaller elements"
        yield Notice("energy-ledger", message, abs(ledger.energy), ENERGY_LIMIT, broken=True)
    if not ledger.hourglass <= HOURGLASS_LIMIT:
        message = (
            f"hourglass modes hold {ledger.hourglass:.1%} of the internal energy: take smaller elements, or "
            'elements = "full" for the part that bends'
        )
        yield Notice("hourglass-energy", message, ledger.hourglass, HOURGLASS_LIMIT, broken=True)
    if not ledger.momentum <= LEDGER_LIMIT:
        message = f"the momentum ledger misses {ledger.momentum:.1e}"
        yield Notice("momentum-ledger", message, ledger.momentum, LEDGER_LIMIT, broken=True)


def _overlaps(model: Model, run: FemRun) -> Iterator[Notice]:
    """Say which surfaces stood in each other before the blow, beyond rounding."""
    least = ROUNDING * float(np.ptp(model.mesh.points, axis=0).max())
    for overlap in run.overlaps:
        if overlap.deepest > least:
            place = ", ".join(f"{x * 1e3:.4g}" for x in overlap.place)
            message = (
                f"{overlap.nodes} nodes of the contact {overlap.contact} stand inside the other side before the blow, "
                f"the deepest by {overlap.deepest * 1e6:.3g} um at ({place}) mm: they are let out without a force; "
                "move the parts apart, or match their meshes, where that matters"
            )
            yield Notice("initial-overlap", message, overlap.deepest, least)


def _contacts(run: FemRun) -> Iterator[Notice]:
    """Say which contacts nothing touched, and which pulses the interval of the histories is too long for."""
    from strikewave.fem.measures import contact_measure

    interval = float(run.time[1] - run.time[0])
    for name in run.force:
        found = contact_measure(run, name)
        if found is None:
            message = f"nothing touched in the contact {name}: a longer fem.duration, or another place or velocity"
            yield Notice("no-contact", message, 0.0, 0.0)
        elif found.duration < FEWEST_INTERVALS * interval:
            message = (
                f"the contact {name} lasts {found.duration * 1e6:.3g} us, {found.duration / interval:.1f} intervals of "
                "the histories: take a shorter fem.interval"
            )
            yield Notice("fem-interval", message, found.duration / interval, FEWEST_INTERVALS)


def _coarse_contacts(case: Case, model: Model, run: FemRun) -> Iterator[Notice]:
    """Say which contacts press so few faces of a larger surface that their force hangs on the mesh."""
    found = sectors(case, model)
    sides = model.touching
    for name, pressed in run.pressed.items():
        for side, (share, faces) in zip(sides[name], pressed.max(axis=0), strict=False):
            pieces = found[side.partition(".")[0]].pieces
            if 0.0 < share < ALL_PRESSED and pieces * faces < FEWEST_FACES:
                message = (
                    f"only {pieces * faces:.2g} faces of {side} are ever pressed at once: their number decides the "
                    f"force; take a smaller finest size there, so that {FEWEST_FACES:.0f} or more are"
                    + (f" (a {'half' if pieces == 2 else 'quarter'} of them in the sector)" if pieces > 1 else "")
                )
                yield Notice("contact-coarse", message, pieces * float(faces), FEWEST_FACES)


def _strength(case: Case, model: Model, run: FemRun) -> Iterator[Notice]:
    """Say which elastic parts go beyond the yield strength of their material."""
    for part in case.mesh.part if case.mesh else ():
        strength = material(part.material).yield_strength if part.material else None
        stress = float(run.von_mises[part.name].max()) if part.name in run.von_mises else 0.0
        yields = isinstance(model.solids[part.name], Bilinear | JohnsonCook)
        if strength is not None and stress > strength and not yields:
            message = (
                f"the elastic part {part.name} is loaded with {stress / 1e6:.4g} MPa (von Mises), beyond the "
                f"{strength / 1e6:.4g} MPa at which {part.material} yields: give it a solid with a yield strength"
            )
            yield Notice("fem-yield", message, stress, strength)
