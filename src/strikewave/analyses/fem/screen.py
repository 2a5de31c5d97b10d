"""A run of explicit finite elements as a command: check, solve, print, draw."""

from __future__ import annotations

import contextlib
import dataclasses
import math
import os
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from strikewave.analyses.fem.build import build_model
from strikewave.analyses.fem.notices import model_notices
from strikewave.analyses.fem.parts import exact_volume
from strikewave.analyses.fem.report import largest_words
from strikewave.analyses.fem.result import Energies, FemSolution
from strikewave.analyses.fem.run import check_model, first_step, run_model
from strikewave.analyses.fem.sectors import sectors
from strikewave.analyses.fem.unfinished import STATE, FieldFiles, unfinished
from strikewave.base import declare
from strikewave.base.declare import MORE, declarations
from strikewave.base.errors import InputError
from strikewave.base.json_document import head, plain
from strikewave.base.percents import percent
from strikewave.base.shock_quantities import ENERGY, MASS, MICROSECONDS, STEP
from strikewave.cases.case import Case
from strikewave.cases.written_case import dump_case
from strikewave.fem.device.devices import Device, device_named
from strikewave.fem.model import Model
from strikewave.fem.quality import PartQuality, quality_report
from strikewave.fem.snapshots import SNAPSHOTS
from strikewave.fem.solve import Checkpoint, Progress, RunOptions, frame_instants
from strikewave.reporting.bands import NO_BAND_OF_ELEMENTS
from strikewave.reporting.faces import amount, columns_of, text_of
from strikewave.reporting.options.output import Output
from strikewave.reporting.run_and_write import Command, case_folder, run_and_write
from strikewave.reporting.terminal import (
    print_face,
    print_json,
    print_published,
    print_rows,
    progress_bar,
    say,
    show_notices,
    tell,
)

NAMES = {2: "half", 4: "quarter"}
LEAST_OFF = 1e-4
"""Share of a part's volume that its flat faces take, and is reported: chosen, a tenth of what a mesh errs by."""
MOST_REST, REST_WORDS = 3.5, "1 to 3.5 times"
"""How many times the steps of a blow the bodies take to come to rest after it, at most as a rule."""
USUAL_RATE = 5e6
"""Element-steps a second of one thread, for the estimate before a run: half of what two cores of 2023 reach."""
STATES = 20
"""How often in a run its state is kept: a stopped run loses at most a twentieth, and writing costs below a per cent."""


@dataclass(frozen=True)
class FemOptions:
    """What was asked for besides the case."""

    threads: int = 1
    report: bool = True
    restart: bool = False
    animate: bool = False
    device: str | None = None


def run_element_case(case: Case, changes: Sequence[str], output: Output, choice: FemOptions | None = None) -> int:
    """Run an element case, write and print its result, and return the exit code.

    Raises
    ------
    InputError
        If there is no folder for an animation or to go on from, no such device, or what the run raises.
    """
    choice = choice or FemOptions()
    output.check_animation(choice.animate)
    if choice.restart and output.json and output.out is None:
        raise InputError("--restart", "no folder", "a run that writes its files", "add --out DIR")
    device = device_named(choice.device) if choice.device else None
    model, _ = _reported_model(case, choice.threads)
    case = output.tested(case)
    text = dump_case(case)
    command = FemCommand(case, model, choice, output.force, device)
    return run_and_write(command, output, case_folder(case.name, text, changes), text)


def check_element_case(case: Case, json: bool, threads: int = 1) -> int:
    """Build the model of an element case and print what it would take; run nothing."""
    model, quality = _reported_model(case, threads)
    check_model(model)
    show_notices(tuple(model_notices(case, model)))
    masses = _masses(case, model, quality)
    parts = [CheckedPart(row, math.prod(masses[row.part]), masses[row.part][0]) for row in quality]
    if json:
        print_json(_check_document(case, model, parts))
    else:
        print_rows("Mesh", columns_of(CheckedPart, parts))
    return 0


def _reported_model(case: Case, threads: int) -> tuple[Model, Sequence[PartQuality]]:
    """Build the model of a case, print what will be run, and return the model with the quality of its mesh."""
    model = build_model(case, min(threads, os.cpu_count() or 1))
    quality = quality_report(model.mesh)
    say_model(case, model, quality)
    say_faceted(case, quality)
    return model, quality


@dataclass
class FemCommand(Command[FemSolution]):
    """A run of an element case; one that is stopped may go on where it was."""

    case: Case
    model: Model
    choice: FemOptions
    anew: bool
    device: Device | None = None
    home: Path | None = field(default=None, init=False)
    fields: FieldFiles | None = field(default=None, init=False)

    @contextlib.contextmanager
    def under_way(self, folder: Path) -> Iterator[None]:
        """Checkpoint state and fields beside the folder until all is written."""
        controls, frames = self.model.controls, int(self.case.fem.frames.si) if self.case.fem else 0
        instants = [instant * controls.interval for instant in frame_instants(controls, frames)]
        with (
            unfinished(folder, dump_case(self.case), self.choice.restart, self.anew) as self.home,
            FieldFiles(self.home, self.model.mesh, instants) as self.fields,
        ):
            yield

    def solve(self) -> FemSolution:
        """Return the solution, with a bar on stderr."""
        with progress() as report:
            solution = run_model(self.case, self.model, self._asked()._replace(report=report), self._stills())
        lost = self.fields.notices if self.fields else ()
        return dataclasses.replace(solution, notices=(*solution.notices, *lost))

    def _asked(self) -> RunOptions:
        """Return what is asked of the run besides its histories."""
        if self.home is None or self.fields is None:
            return RunOptions(device=self.device)
        state = self.home / STATE
        keep = Checkpoint(state, max(1, round(self.model.controls.intervals / STATES)))
        asked = RunOptions(checkpoint=keep, resume=state if self.choice.restart else None, device=self.device)
        return asked._replace(writer=self.fields.of_blow(1), later=self.fields.of_blow)

    def _stills(self) -> int:
        """Return how many instants the run keeps for its pictures."""
        if not self.choice.animate:
            return SNAPSHOTS
        from strikewave.analyses.fem.figures import animation

        return animation.SNAPSHOTS

    def summary(self, result: FemSolution) -> str:
        """Say what happened."""
        from strikewave.analyses.fem.report import fem_words

        return fem_words(result)

    def show(self, result: FemSolution) -> None:
        """Print the tables of a run."""
        show(result)

    def draw(self, result: FemSolution, folder: Path) -> list[str]:
        """Write page and pictures, and the animation, which takes some seconds."""
        from strikewave.analyses.fem.report import draw_result

        return draw_result(result, folder, self.choice.report, self.choice.animate)

    def hand_over(self, result: FemSolution, folder: Path) -> list[str]:
        """Put the fields into the folder."""
        return self.fields.hand_over(folder) if self.fields else []


@contextlib.contextmanager
def progress() -> Iterator[Callable[[Progress], None]]:
    """Show a bar with rate and time left on stderr where that is a terminal."""
    with progress_bar("", clocks=()) as report:

        def show(seen: Progress) -> None:
            words = f"{seen.speed / 1e6:.2f} M element-steps/s, {seen.left:.0f} s left" if seen.time > 0.0 else ""
            report(seen.time / seen.duration, words)

        yield show


def say_model(case: Case, model: Model, quality: Sequence[PartQuality]) -> None:
    """Say what will be run: elements, nodes, masses, the worst element, about how many steps."""
    mesh, controls = model.mesh, model.controls
    say(f"{len(mesh.hexahedra)} elements, {len(mesh.points)} nodes")
    say("mass: " + ", ".join(f"{name} {_mass_words(*mass)}" for name, mass in _masses(case, model, quality).items()))
    worst = min(quality, key=lambda row: row.scaled_jacobian)
    place = ", ".join(f"{x * 1e3:.4g}" for x in worst.worst_at)
    say(f"worst element: scaled Jacobian {worst.scaled_jacobian:.2f} in {worst.part} at ({place}) mm")
    step = first_step(model)
    count = controls.duration / step
    work = len(mesh.hexahedra) * count * controls.blows
    seconds = work / (USUAL_RATE * controls.threads)
    least, most = 1.0 + (controls.blows - 1) / controls.blows, 1.0 + MOST_REST * (controls.blows - 1) / controls.blows
    many = f", in {controls.blows} blows {controls.blows * count:.0f}" if controls.blows > 1 else ""
    rest = (
        f" to {brief(seconds * most)} s, the steps to rest between blows included ({REST_WORDS} those of a blow),"
        if controls.blows > 1
        else " s"
    )
    say(
        f"step about {amount(STEP, step, digits=3)}: {count:.0f} steps for "
        f"{amount(MICROSECONDS, controls.duration)}{many}, {work / 1e6:.3g} M element-steps, about "
        f"{brief(seconds * least)}{rest} or more: compiling, files and elements that are squeezed come on top"
    )


def _masses(case: Case, model: Model, quality: Sequence[PartQuality]) -> dict[str, tuple[float, int]]:
    """Return the mass of the mesh of each part, kg, and how many such sectors make its body."""
    sector_of = sectors(case, model)
    return {row.part: (row.volume * model.solids[row.part].density, sector_of[row.part].pieces) for row in quality}


def _mass_words(mass: float, pieces: int) -> str:
    """Write the mass of a body, and of it that of the mesh where that is a sector.

    Examples
    --------
    >>> _mass_words(0.1655, 4), _mass_words(0.1655, 1)
    ('0.662 kg (a quarter is meshed, 0.1655 kg)', '0.1655 kg')
    """
    meshed = f" (a {NAMES[pieces]} is meshed, {mass:.4g} kg)" if pieces > 1 else ""
    return f"{pieces * mass:.4g} kg{meshed}"


def brief(value: float) -> str:
    """Write a number to one digit without an exponent.

    Examples
    --------
    >>> brief(73.2), brief(0.042), brief(4.2e-6), brief(0.096), brief(0.0)
    ('70', '0.04', '0.000004', '0.1', '0')
    """
    rounded = float(f"{value:.1g}")
    return f"{rounded:.{max(0, -math.floor(math.log10(rounded))) if rounded > 0.0 else 0}f}"


def say_faceted(case: Case, quality: Sequence[PartQuality]) -> None:
    """Say how much the flat faces of the elements take from round parts."""
    exact = {part.name: exact_volume(part) for part in (case.mesh.part if case.mesh else ())}
    off = {row.part: row.volume / whole - 1.0 for row in quality if (whole := exact.get(row.part))}
    words = [f"{part} {percent(share, 2, '+')}" for part, share in off.items() if abs(share) >= LEAST_OFF]
    if words:
        say(f"mass against that of the shape, whose round sides have flat faces here: {', '.join(words)}")


def show(solution: FemSolution) -> None:
    """Print parts, contacts and balance."""
    print_face(solution, "bodies", f"{solution.title}: parts as rigid bodies", "parts")
    print_face(solution, "blow_of_parts", "Largest in the elements", "elements")
    if solution.film is not None and (words := largest_words(solution.film, solution.model.mesh)):
        tell(words)
    print_face(solution, "touched", "Contacts")
    print_published(solution.comparisons)
    _show_balance(solution)
    if solution.later:
        _show_blows(solution)


def _show_balance(solution: FemSolution) -> None:
    run, columns = solution.run, zip(declarations(Energies), columns_of(Energies, [solution.energy]), strict=True)
    there = [column for name, column in columns if name == "initial" or run.energy[name].any()]
    print_rows("Energy at the end", there)
    tell("balance: " + ", ".join(check.words for check in solution.balance_checks))
    tell(f"{run.steps} steps of {amount(STEP, run.step, digits=3)} or more, {run.speed / 1e6:.3g} M element-steps/s")
    tell(NO_BAND_OF_ELEMENTS[0].lower() + NO_BAND_OF_ELEMENTS[1:])


def _show_blows(solution: FemSolution) -> None:
    """Print what each blow came to, and how the bodies came to rest before it."""
    print_face(solution, "contacts_of_blows", "Blow after blow", "blow")
    print_face(solution, "yield_of_blows", "Yield in each blow", "yield")
    for run in solution.later:
        if run.rest is not None:
            away = f"; begins {text_of(run.rest, 'added_distance')} farther away" if run.rest.added_distance else ""
            tell(
                f"at rest before blow {run.blow}: {run.rest.maxima} maxima, {run.rest.steps} steps, "
                f"{run.rest.kinetic_share:.1e} of the energy left, "
                f"{amount(ENERGY, run.rest.plastic_energy, digits=3)} of yield{away}"
            )


@declare.dataclass
class CheckedPart:
    """A part whose mesh was checked, and its masses."""

    quality: PartQuality = declare.part(PartQuality, "how good its mesh is", inline=True)
    mass: float = declare.number(MASS, "of the whole body", column=MORE)
    model_mass: float = declare.number(MASS, "of what is meshed")


def _check_document(case: Case, model: Model, parts: Sequence[CheckedPart]) -> dict[str, Any]:
    """Return the JSON document of a model that was checked."""
    counted = {"elements": len(model.mesh.hexahedra), "nodes": len(model.mesh.points), "step": first_step(model)}
    rows = {one.quality.part: declare.content(one) for one in parts}
    notices = [notice.document() for notice in model_notices(case, model)]
    units = {**declare.units(CheckedPart), "step": "s"}
    return plain({**head(units, notices), "case": case.name, **counted, "parts": rows})
