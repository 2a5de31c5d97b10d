"""Command of explicit finite elements: check, solve, print, draw.

A run under way keeps its state and its fields in a folder beside the result, to go on from after a stop.
"""

from __future__ import annotations

import contextlib
import dataclasses
import math
import os
import re
import shutil
import sys
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from strikewave.analyses.fem.build import build_model, exact_volume
from strikewave.analyses.fem.notices import model_notices
from strikewave.analyses.fem.result import Energies, FemSolution, largest_words, of_blow
from strikewave.analyses.fem.run import check_model, first_step, run_model
from strikewave.analyses.fem.sectors import sectors
from strikewave.base import declare
from strikewave.base.declare import MORE, declarations
from strikewave.base.documents import head, plain
from strikewave.base.errors import InputError, refusal
from strikewave.base.processes import exit_code
from strikewave.base.result import Notice
from strikewave.base.shock_quantities import ENERGY, MASS, MICROSECONDS, STEP
from strikewave.base.texts import command_line, percent
from strikewave.cases.case import Case, dump_case
from strikewave.fem.device.devices import Device, device_named
from strikewave.fem.mesh import Mesh
from strikewave.fem.model import Model
from strikewave.fem.quality import PartQuality, quality_report
from strikewave.fem.run import FieldFrame
from strikewave.fem.snapshots import SNAPSHOTS
from strikewave.fem.solve import Checkpoint, Progress, RunOptions, frame_instants
from strikewave.fem.vtkhdf import FieldWriter
from strikewave.reporting.bands import NO_BAND_OF_ELEMENTS
from strikewave.reporting.faces import amount, columns_of, text_of
from strikewave.reporting.options import FemOptions
from strikewave.reporting.output_options import Output
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
LEAST_OFF = 1e-4  # chosen: a tenth of a mesh's error
"""Smallest share of a part's volume lost to flat faces that is reported."""
MOST_REST, REST_WORDS = 3.5, "1 to 3.5 times"
"""Steps that relaxation takes after a blow over those of the blow, at most as a rule."""
USUAL_RATE = 5e6  # half of what two cores of 2023 reach
"""Element-steps a second of one thread, for the estimate before a run."""
STATES = 20  # a stopped run loses at most a twentieth, and writing costs below a per cent
"""States kept in a run."""


def run_element_case(case: Case, changes: Sequence[str], output: Output, options: FemOptions | None = None) -> int:
    """Run an element case, write and print its result, and return the exit code."""
    options = options or FemOptions()
    output.check_animation(options.animate)
    if options.restart and output.json and output.out is None:
        raise InputError("--restart", "no folder", "a run that writes its files", "add --out DIR")
    device = device_named(options.device) if options.device else None
    model, _ = _reported_model(case, options.threads)
    case = output.tested(case)
    text = dump_case(case)
    command = FemCommand(case, model, options, output.force, device)
    return run_and_write(command, output, case_folder(case.name, text, changes), text)


def check_element_case(case: Case, json: bool, threads: int = 1) -> int:
    """Build the model of an element case and print what it would take; run nothing."""
    model, quality = _reported_model(case, threads)
    check_model(model)
    show_notices(tuple(model_notices(case, model)))
    masses = _masses(case, model, quality)
    parts = [CheckedPart(row, math.prod(masses[row.part]), masses[row.part][0]) for row in quality]
    if not json:
        print_rows("Mesh", columns_of(CheckedPart, parts))
        return 0
    counted = {"elements": len(model.mesh.hexahedra), "nodes": len(model.mesh.points), "step": first_step(model)}
    rows = {part.quality.part: declare.content(part) for part in parts}
    notices = [notice.document() for notice in model_notices(case, model)]
    units = {**declare.units(CheckedPart), "step": "s"}
    print_json(plain({**head(units, notices), "case": case.name, **counted, "parts": rows}))
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
    options: FemOptions
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
            unfinished_run(folder, dump_case(self.case), self.options.restart, self.anew) as self.home,
            FieldFiles(self.home, self.model.mesh, instants) as self.fields,
        ):
            yield

    def solve(self) -> FemSolution:
        """Return the solution, with a bar on stderr."""
        with progress() as report:
            options, snapshots = self._run_options()._replace(report=report), SNAPSHOTS
            if self.options.animate:
                from strikewave.analyses.fem.figures import animation

                snapshots = animation.SNAPSHOTS
            solution = run_model(self.case, self.model, options, snapshots)
        lost = self.fields.notices if self.fields else ()
        return dataclasses.replace(solution, notices=(*solution.notices, *lost))

    def _run_options(self) -> RunOptions:
        """Return the options of the run; one that writes no files keeps no state."""
        if self.home is None or self.fields is None:
            return RunOptions(device=self.device)
        state = self.home / STATE_FILE
        return RunOptions(
            checkpoint=Checkpoint(state, max(1, round(self.model.controls.intervals / STATES))),
            resume=state if self.options.restart else None,
            device=self.device,
            writer=self.fields.of_blow(1),
            later=self.fields.of_blow,
        )

    def summary(self, result: FemSolution) -> str:
        """Return the events of the run in sentences."""
        from strikewave.analyses.fem.report import fem_words

        return fem_words(result)

    def show(self, result: FemSolution) -> None:
        """Print the tables of a run."""
        show(result)

    def draw(self, result: FemSolution, folder: Path) -> list[str]:
        """Write page and pictures, and the animation, which takes some seconds."""
        from strikewave.analyses.fem.report import draw_result

        return draw_result(result, folder, not self.options.no_report, self.options.animate)

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
    """Print elements, nodes, masses, the worst element, and about how many steps a run takes."""
    mesh, controls = model.mesh, model.controls
    say(f"{len(mesh.hexahedra)} elements, {len(mesh.points)} nodes")
    say("mass: " + ", ".join(f"{name} {_mass_words(*mass)}" for name, mass in _masses(case, model, quality).items()))
    worst = min(quality, key=lambda row: row.scaled_jacobian)
    place = ", ".join(f"{x * 1e3:.4g}" for x in worst.worst_at)
    say(f"worst element: scaled Jacobian {worst.scaled_jacobian:.2f} in {worst.part} at ({place}) mm")
    step = first_step(model)
    count = controls.duration / step
    work = len(mesh.hexahedra) * count * controls.blows
    seconds = work / (USUAL_RATE * controls.threads)  # threads share the elements evenly: contact and files come on top
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
    """Return the mass of a body, and that of its meshed sector."""
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
    """Print the share of mass that flat faces take from round parts."""
    exact = {part.name: exact_volume(part) for part in (case.mesh.part if case.mesh else ())}
    off = {row.part: row.volume / whole - 1.0 for row in quality if (whole := exact.get(row.part))}
    shares = [f"{part} {percent(share, 2, '+')}" for part, share in off.items() if abs(share) >= LEAST_OFF]
    if shares:
        say(f"mass against that of the shape, whose round sides have flat faces here: {', '.join(shares)}")


def show(solution: FemSolution) -> None:
    """Print parts, contacts and balance."""
    print_face(solution, "bodies", f"{solution.title}: parts as rigid bodies", "parts")
    print_face(solution, "blow_of_parts", "Largest in the elements", "elements")
    if solution.film is not None and (words := largest_words(solution.film, solution.model.mesh)):
        tell(words)
    print_face(solution, "touched", "Contacts")
    print_published(solution.comparisons)
    run, columns = solution.run, zip(declarations(Energies), columns_of(Energies, [solution.energy]), strict=True)
    print_rows("Energy at the end", [column for name, column in columns if name == "initial" or run.energy[name].any()])
    tell("balance: " + ", ".join(check.words for check in solution.balance_checks))
    tell(f"{run.steps} steps of {amount(STEP, run.step, digits=3)} or more, {run.speed / 1e6:.3g} M element-steps/s")
    tell(NO_BAND_OF_ELEMENTS[0].lower() + NO_BAND_OF_ELEMENTS[1:])
    if solution.later:
        _show_blows(solution)


def _show_blows(solution: FemSolution) -> None:
    """Print the contacts and the yield of each blow, and the relaxation before it."""
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
    """Quality of the mesh of a part, and its masses."""

    quality: PartQuality = declare.part(PartQuality, "how good its mesh is", inline=True)
    mass: float = declare.number(MASS, "of the whole body", column=MORE)
    model_mass: float = declare.number(MASS, "of what is meshed")


UNFINISHED_NAMES = re.compile(r"(case|state|field)(-\d+)?(\.|$)")
"""Names of the files of a run under way."""
STATE_FILE = "state.h5"
"""File of the state that a run goes on from."""


@contextlib.contextmanager
def unfinished_run(folder: Path, text: str, restart: bool, anew: bool) -> Iterator[Path]:
    """Make a folder for an unfinished run, ``FOLDER.unfinished``; it stays where a state to resume from is kept."""
    home = folder.with_name(f"{folder.name}.unfinished")
    case = home / "case.toml"
    begun = (home / STATE_FILE).is_file() and case.is_file()
    same = begun and case.read_text("utf-8", errors="replace") == text
    if restart and not begun:
        raise InputError("--restart", home, "a run that was interrupted", "leave it out to begin anew")
    if restart and not same:
        hint = f"it holds a run with other values, {case}; to begin anew: {_command_with('--force')}"
        raise InputError("--restart", home, "the same case, its frames and other changes included", hint)
    if begun and not restart and not anew:
        hint = (
            f"to go on: {_command_with('--restart')}; " if same else ""
        ) + f"to begin anew: {_command_with('--force')}"
        raise InputError("--out", home, "no unfinished run" + ("" if same else " of another case"), hint)
    try:
        if not restart:
            _clear(home)
            home.mkdir(parents=True)
            case.write_text(text, "utf-8")
        yield home
    except BaseException as stop:
        reason = refusal(stop, home) if isinstance(stop, OSError) else ""
        if not (home / STATE_FILE).is_file():
            _clear(home)
        else:
            say(f"stopped; kept: {home}/; to go on from there: {_command_with('--restart')}")
            if isinstance(stop, KeyboardInterrupt):
                raise SystemExit(exit_code(stop)) from None
        if reason:
            raise InputError("--out", home, "a place that can be written", reason) from stop
        raise
    _clear(home)


def _command_with(option: str) -> str:
    """Return the present command with --restart or --force."""
    arguments = [argument for argument in sys.argv[1:] if argument not in ("--restart", "--force")]
    arguments[:1] = ["fem"] if arguments[:1] == ["run"] else arguments[:1]  # run has no --restart
    end = arguments.index("--") if "--" in arguments else len(arguments)  # behind it all are names
    return command_line([*arguments[:end], option, *arguments[end:]])


def _clear(home: Path) -> None:
    """Remove the folder of an unfinished run; one with other files stays, and is refused."""
    if not home.exists():
        return
    foreign = [entry.name for entry in home.iterdir() if not UNFINISHED_NAMES.match(entry.name)]
    if home.is_symlink() or foreign:
        raise InputError("--out", home, "a name that is free", "it holds other files; move them")
    shutil.rmtree(home)


class FieldFile:
    """The fields of a blow: begun with the first frame, or taken up with it where a run goes on.

    ``instants`` are the times of the frames of the whole blow, s.
    """

    def __init__(self, path: Path, mesh: Mesh, instants: Sequence[float]) -> None:
        self.path, self.mesh, self.instants = path, mesh, instants
        self.writer: FieldWriter | None = None
        self.notices: list[Notice] = []

    def add(self, frame: FieldFrame) -> None:
        """Write a frame; frames of an interrupted run after the state that it goes on from are dropped."""
        if self.writer is None:
            earlier = sum(time < frame.time for time in self.instants)
            again = self._taken_up(frame.time, earlier) if earlier else None
            self.writer = again or FieldWriter(self.path, self.mesh)
        self.writer.add(frame)

    def _taken_up(self, time: float, earlier: int) -> FieldWriter | None:
        """Return the writer of the frames before, None where none can be used; lost frames make a notice."""
        try:
            writer, reason = FieldWriter.restored(self.path, self.mesh, time), "the others are not there"
        except InputError as error:
            writer, reason = None, error.hint
        count = 0 if writer is None else writer.frames
        if count < earlier:
            message = (
                f"{self.path.name} holds {count} of the {earlier} frames before {amount(MICROSECONDS, time)}, where "
                f"the run went on ({reason}); all else is whole; run anew, with --force, for all frames"
            )
            self.notices.append(Notice("frames-lost", message, float(count), float(earlier)))
        return writer


class FieldFiles:
    """Files of fields: field.vtkhdf of the first blow, field-2.vtkhdf of the second, and so on."""

    def __init__(self, home: Path, mesh: Mesh, instants: Sequence[float]) -> None:
        self.home, self.mesh, self.instants = home, mesh, instants
        self.files: list[FieldFile] = []

    def of_blow(self, blow: int) -> FieldFile:
        """Add the file of a blow and return it."""
        path = self.home / of_blow("field.vtkhdf", blow)
        self.files.append(FieldFile(path, self.mesh, self.instants))
        return self.files[-1]

    @property
    def notices(self) -> tuple[Notice, ...]:
        """Notices of frames lost before a run went on."""
        return tuple(notice for file in self.files for notice in file.notices)

    def hand_over(self, place: Path) -> list[str]:
        """Close the files with frames, put them into a folder and return their names."""
        written = [file for file in self.files if file.writer is not None]
        for file in written:
            if file.writer is not None:
                file.writer.close()
            # a second name, no move: a run that is stopped before the whole result is in place goes on with the file
            try:
                os.link(file.path, place / file.path.name)
            except OSError:  # a file system without second names
                shutil.copyfile(file.path, place / file.path.name)
        return [file.path.name for file in written]

    def __enter__(self) -> FieldFiles:
        return self

    def __exit__(self, *error: object) -> None:
        for file in self.files:
            if file.writer is not None:
                file.writer.abandon()
