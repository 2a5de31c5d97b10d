"""``strikewave fem``: run a model of hexahedra."""

from __future__ import annotations

import contextlib
import dataclasses
import math
import os
import re
import shlex
import shutil
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple

import typer

from strikewave.base.json_document import head, plain, without
from strikewave.reporting.run_and_write import BROKEN
from strikewave.reporting.terminal import (
    CaseName,
    Changes,
    Force,
    Json,
    Out,
    most_memory,
    number,
    own_mark,
    print_json,
    print_published,
    progress_bar,
    say,
    say_compiling,
    table,
)

if TYPE_CHECKING:
    from strikewave.analyses.fem.result import FemSolution
    from strikewave.analyses.fem.sectors import WholeForce
    from strikewave.cases.case import Case
    from strikewave.fem.measures import ContactMeasure
    from strikewave.fem.mesh import Mesh
    from strikewave.fem.model import Model
    from strikewave.fem.quality import PartQuality
    from strikewave.fem.run import Frame
    from strikewave.fem.solve import Keep, Progress
    from strikewave.fem.vtkhdf import FieldWriter

NAMES = {2: "half", 4: "quarter"}
SHARES = {1: "", 2: " (half of it)", 4: " (quarter of it)"}
"""Said of a part that is a sector, by how many make the whole."""
LEAST_OFF = 1e-4
"""Share of a part's volume that its flat faces take, and is worth a word."""
MOST_REST, REST_WORDS = 3.5, "1 to 3.5 times"
"""How many times the steps of a blow the bodies take to come to rest after it, at most as a rule."""
FLAT = 1e-9
"""Warpage below which faces are flat but for rounding, rad."""
USUAL_RATE = 5e6
"""Element-steps a second of one thread, for the estimate before a run."""
INTERRUPTED = 130
"""Exit code after Ctrl-C."""
OWN = re.compile(r"(case|state|field)(-\d+)?(\.|$)")
"""Names of what a run under way writes."""
STATE, STATES = "state.h5", 20
"""Where a run keeps its state to go on from, and how often in the run."""


class Choice(NamedTuple):
    """What was asked for besides the case."""

    report: bool
    restart: bool
    anew: bool
    animate: bool = False


def command(
    case: CaseName,
    threads: Annotated[int, typer.Option("--threads", help="Threads, one a core at most; they change no number.")] = 1,
    frames: Annotated[
        int | None,
        typer.Option("--frames", help="Pictures in field.vtkhdf, instead of fem.frames.", show_default=False),
    ] = None,
    blows: Annotated[
        int | None,
        typer.Option("--blows", help="Blows one after another, instead of fem.blows.", show_default=False),
    ] = None,
    check: Annotated[
        bool, typer.Option("--check", help="Build the model, say what it would take; run nothing.")
    ] = False,
    restart: Annotated[bool, typer.Option("--restart", help="Go on where an interrupted run stopped.")] = False,
    no_report: Annotated[bool, typer.Option("--no-report", help="Write no report.html.")] = False,
    animate: Annotated[bool, typer.Option("--animate", help="Write animation.html and animation.gif too.")] = False,
    changes: Changes = None,
    out: Out = None,
    force: Force = False,
    json: Json = False,
) -> int:
    """Run a model of hexahedra: contact forces, rigid-body accelerations, sections, fields, and their ledgers.

    With --json, files are written only where --out says. The exit code is 3 where energy is off by more than 1 %, or
    hourglass modes hold more than 5 % of the internal energy.
    """
    from strikewave.analyses.fem.build import build_model
    from strikewave.analyses.fem.notices import model_notices
    from strikewave.analyses.fem.run import check_model
    from strikewave.base.errors import InputError
    from strikewave.cases.case import dump_case, load_case
    from strikewave.fem.quality import quality_report

    begun = time.perf_counter()
    if threads < 1:
        raise InputError("--threads", threads, "at least 1")
    anew = force
    read = load_case(case, changes or ())
    if frames is not None and (read.fem is None or frames != read.fem.frames.si):
        changes = [*(changes or ()), f"fem.frames={frames}"]
        read = load_case(case, changes)
    if blows is not None and (read.fem is None or blows != read.fem.blows.si):
        changes = [*(changes or ()), f"fem.blows={blows}"]
        read = load_case(case, changes)
    text, folder = dump_case(read), out
    if out is None and not json and not check:
        folder, force = Path("out") / f"{read.name or 'case'}{own_mark(text, changes)}", True
    if animate and folder is None and not check:
        raise InputError("--animate", "--json without --out", "a folder for the animation", "add --out DIR")
    if restart and folder is None:
        raise InputError("--restart", "no folder", "a run that writes its files", "add --out DIR")
    model = build_model(read, min(threads, os.cpu_count() or 1))
    quality = quality_report(model.mesh)
    say_model(read, model, quality)
    say_faceted(read, quality)
    if check:
        check_model(model)
        for notice in model_notices(read, model):
            say(f"warning [{notice.code}]: {notice.message}")
        print_json(_check_document(read, model, quality)) if json else _show_quality(model, quality)
        return 0
    solution = _carried_out(read, model, folder, force, Choice(not no_report, restart, anew, animate))
    if json:
        print_json(solution.document())
    else:
        show(solution)
    say(f"done in {time.perf_counter() - begun:.2f} s{most_memory()}")
    return BROKEN if solution.broken else 0


def _carried_out(case: Case, model: Model, folder: Path | None, force: bool, choice: Choice) -> FemSolution:
    """Run a model and write its files where there is a folder for them."""
    from strikewave.analyses.fem.run import run_model
    from strikewave.base.output_folder import check_place, whole_folder
    from strikewave.cases.case import dump_case
    from strikewave.fem.solve import Asked

    say_compiling()
    if folder is None:
        with progress() as report:
            return run_model(case, model, Asked(report=report))
    text = dump_case(case)
    check_place(folder, text, force)
    with unfinished(folder, text, choice) as home, FieldFiles(home, model.mesh, choice.restart) as fields:
        asked = Asked(keep=_keep(home, model), resume=home / STATE if choice.restart else None)
        asked = asked._replace(writer=fields.of_blow(1), later=fields.of_blow)
        with progress() as report:
            solution = run_model(case, model, asked._replace(report=report), _stills(choice))
        with whole_folder(folder, text, force) as place:
            written = [*write_result(solution, place, text, choice.report), *fields.hand_over(place)]
            written += animate_run(solution, place) if choice.animate else []
    say(f"written: {folder}/ ({', '.join(written)})")
    return solution


def _stills(choice: Choice) -> int:
    """Return how many instants a run keeps for its pictures."""
    from strikewave.analyses.fem.figures import animation as fem_animation
    from strikewave.fem.film import STILLS

    return fem_animation.STILLS if choice.animate else STILLS


def animate_run(solution: FemSolution, place: Path) -> list[str]:
    """Write the animation as a page and as a GIF, which takes some seconds, and return their names."""
    from strikewave.analyses.fem.figures.animation import fem_page, movie_of, write_fem_gif

    with progress_bar("animation", clocks=("left",)) as report:
        movie = movie_of(solution, progress=lambda share: report(0.5 * share))
        if movie is None:
            return []
        page = fem_page(movie, solution.title, solution.case.name)
        (place / "animation.html").write_text(page, "utf-8", newline="\n")
        write_fem_gif(movie, solution.title, place / "animation.gif", lambda share: report(0.5 + 0.5 * share))
    return ["animation.html", "animation.gif"]


def _keep(home: Path, model: Model) -> Keep:
    """Return where a run keeps its state, and how often."""
    from strikewave.fem.solve import Keep

    return Keep(home / STATE, max(1, round(model.controls.intervals / STATES)))


@contextlib.contextmanager
def unfinished(folder: Path, text: str, choice: Choice) -> Iterator[Path]:
    """Give a folder for a run that is under way, ``FOLDER.unfinished``; it stays where there is a state to go on from.

    Raises
    ------
    InputError
        If there is nothing to go on from, it belongs to another case, or unfinished work would be lost unasked.
    """
    from strikewave.base.errors import InputError

    home = folder.with_name(f"{folder.name}.unfinished")
    case = home / "case.toml"
    begun = (home / STATE).is_file() and case.is_file()
    same = begun and case.read_text("utf-8", errors="replace") == text
    if choice.restart and not begun:
        raise InputError("--restart", str(home), "a run that was interrupted", "leave it out to begin anew")
    if choice.restart and not same:
        hint = f"it holds a run with other values, {case}; to begin anew: {_command('--force')}"
        raise InputError("--restart", str(home), "the same case, its frames and other changes included", hint)
    if begun and not choice.restart and not choice.anew:
        hint = (f"to go on: {_command('--restart')}; " if same else "") + f"to begin anew: {_command('--force')}"
        raise InputError("--out", str(home), "no unfinished run" + ("" if same else " of another case"), hint)
    try:
        if not choice.restart:
            _clear(home)
            home.mkdir(parents=True)
            case.write_text(text, "utf-8")
        yield home
    except OSError as error:
        raise InputError("--out", str(home), "a place that can be written", error.strerror or str(error)) from error
    except BaseException as stop:
        if not (home / STATE).is_file():
            _clear(home)
            raise
        say(f"stopped; kept: {home}/; to go on from there: {_command('--restart')}")
        if isinstance(stop, KeyboardInterrupt):
            raise SystemExit(INTERRUPTED) from None
        raise
    _clear(home)


def _command(option: str) -> str:
    """Return the command that runs now, with --restart or --force."""
    words = [word for word in sys.argv[1:] if word not in ("--restart", "--force")]
    return shlex.join(["strikewave", *words, option])


def _clear(home: Path) -> None:
    """Remove what a run that was under way left; a folder with other files stays, and is refused."""
    from strikewave.base.errors import InputError

    if not home.exists():
        return
    foreign = [entry.name for entry in home.iterdir() if not OWN.match(entry.name)]
    if home.is_symlink() or foreign:
        raise InputError("--out", str(home), "a name that is free", "it holds other files; move them")
    shutil.rmtree(home)


class FieldFile:
    """The fields of a blow: begun with the first frame, or taken up with it where a run goes on."""

    def __init__(self, path: Path, mesh: Mesh, resumed: bool) -> None:
        self.path, self.mesh, self.resumed = path, mesh, resumed
        self.writer: FieldWriter | None = None

    def add(self, frame: Frame) -> None:
        """Write a frame; what an interrupted run wrote beyond the state that it goes on from is dropped."""
        from strikewave.fem.vtkhdf import FieldWriter

        if self.writer is None:
            begun = self.resumed and self.path.with_name(self.path.name + ".part").is_file()
            again = FieldWriter.restored(self.path, self.mesh, frame.time) if begun else None
            self.writer = again or FieldWriter(self.path, self.mesh)
        self.writer.add(frame)

    def hand_over(self, place: Path) -> list[str]:
        """Close the file, move it into a folder and return its name; nothing where no frame came."""
        if self.writer is None:
            return []
        self.writer.close()
        shutil.move(self.path, place)
        return [self.path.name]

    def abandon(self) -> None:
        """Leave the file as it is, to be taken up again."""
        if self.writer is not None:
            self.writer.abandon()


class FieldFiles:
    """field.vtkhdf of the first blow, field-2.vtkhdf of the second, and so on."""

    def __init__(self, home: Path, mesh: Mesh, resumed: bool) -> None:
        self.home, self.mesh, self.resumed = home, mesh, resumed
        self.files: list[FieldFile] = []

    def of_blow(self, blow: int) -> FieldFile:
        """Return the file of a blow, which is not there before."""
        path = self.home / of_blow("field.vtkhdf", blow)
        self.files.append(FieldFile(path, self.mesh, self.resumed))
        return self.files[-1]

    def hand_over(self, place: Path) -> list[str]:
        """Close all files, move them into a folder and return their names."""
        return [name for file in self.files for name in file.hand_over(place)]

    def __enter__(self) -> FieldFiles:
        return self

    def __exit__(self, *error: object) -> None:
        for file in self.files:
            file.abandon()


def of_blow(name: str, blow: int) -> str:
    """Return the name of a file of a blow: the first blow's has no number.

    Examples
    --------
    >>> of_blow("histories.csv", 1), of_blow("histories.csv", 3)
    ('histories.csv', 'histories-3.csv')
    """
    stem, _, ending = name.partition(".")
    return name if blow == 1 else f"{stem}-{blow}.{ending}"


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
    from strikewave.analyses.fem.run import first_step
    from strikewave.analyses.fem.sectors import sectors

    mesh, controls, found = model.mesh, model.controls, sectors(case, model)
    say(f"{len(mesh.hexahedra)} elements, {len(mesh.points)} nodes")
    masses = {row.part: row.volume * model.solids[row.part].density for row in quality}
    say("mass: " + ", ".join(f"{name} {_mass_words(mass, found[name].pieces)}" for name, mass in masses.items()))
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
        f"step about {step * 1e9:.3g} ns: {count:.0f} steps for {controls.duration * 1e6:.4g} us{many}, "
        f"{work / 1e6:.3g} M element-steps, about {brief(seconds * least)}{rest} "
        "or more: compiling, files and elements that are squeezed come on top"
    )


def _mass_words(mass: float, pieces: int) -> str:
    """Write the mass of a part, and that of the whole body where it is a sector.

    Examples
    --------
    >>> _mass_words(0.1655, 4), _mass_words(0.1655, 1)
    ('0.1655 kg (quarter; 0.662 kg whole)', '0.1655 kg')
    """
    whole = f" ({NAMES[pieces]}; {pieces * mass:.4g} kg whole)" if pieces > 1 else ""
    return f"{mass:.4g} kg{whole}"


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
    from strikewave.analyses.fem.parts import exact_volume

    exact = {part.name: exact_volume(part) for part in (case.mesh.part if case.mesh else ())}
    off = {row.part: row.volume / whole - 1.0 for row in quality if (whole := exact.get(row.part))}
    words = [f"{part} {share:+.2%}" for part, share in off.items() if abs(share) >= LEAST_OFF]
    if words:
        say(f"mass against that of the shape, whose round sides have flat faces here: {', '.join(words)}")


def write_result(solution: FemSolution, place: Path, text: str, report: bool = True) -> list[str]:
    """Write the files of a result into a folder, and return their names."""
    from strikewave.analyses.fem.figures.histories import summary_sheet
    from strikewave.reporting.style import save

    histories = []
    for blow in solution.blows:
        csv, nc = (of_blow(f"histories.{ending}", blow.run.blow) for ending in ("csv", "nc"))
        blow.save(place / nc)
        (place / csv).write_text(blow.table(), "utf-8")
        histories += [csv, nc]
    (place / "case.toml").write_text(text, "utf-8")
    save(summary_sheet(solution.run, solution.title), place / "summary.svg")
    if report:
        from strikewave.analyses.fem.report.page import fem_report

        (place / "report.html").write_text(fem_report(solution), "utf-8", newline="\n")
    return [*(["report.html"] if report else []), "summary.svg", *histories, "case.toml"]


def show(solution: FemSolution) -> None:
    """Print parts, contacts, ledger and warnings."""
    from strikewave.analyses.fem.report.fields import largest_words

    found = solution.sectors
    rows = [
        [
            name + SHARES[found[name].pieces],
            number(part.mass, "kg", "kg"),
            number(part.rigid_peak, "m/s^2", "g", 5),
            number(part.width, "s", "us"),
            number(part.velocity_change, "m/s", "m/s"),
            " ".join(f"{x:+.2f}" for x in part.direction),
        ]
        for name, part in {**solution.parts, **solution.groups}.items()
    ]
    heads = ["part", "mass (kg)", "rigid peak (g)", "width (us)", "velocity change (m/s)", "along"]
    table(f"{solution.title}: parts as rigid bodies", heads, rows)
    rows = [
        [name, number(part.von_mises, "Pa", "MPa"), number(part.plastic_strain, "1", "1", 3)]
        for name, part in solution.parts.items()
    ]
    table("Largest in the elements", ["part", "von Mises stress (MPa)", "plastic strain"], rows)
    if solution.film is not None and (words := largest_words(solution.film, solution.model.mesh)):
        say(words)
    wholes = solution.wholes
    rows = [
        [name, *([*"-----"] if one is None else _contact_cells(one)), *_whole_cells(wholes[name] if one else None)]
        for name, one in solution.contacts.items()
    ]
    if rows:
        heads = ["contact", "peak (kN)", "at (us)", "impulse (N s)", "begins (us)", "lasts (us)"]
        heads += ["peak, whole bodies (kN)", "impulse, whole bodies (N s)"]
        many = len(heads) if any(wholes.values()) else len(heads) - 2
        table("Contacts", heads[:many], [row[:many] for row in rows])
    print_published(solution.published)
    _show_ledger(solution)
    if solution.later:
        _show_blows(solution)
    for notice in solution.warnings:
        say(f"warning [{notice.code}]: {notice.message}")


def _contact_cells(found: Any) -> list[str]:
    times = [number(x, "s", "us") for x in (found.at, found.begin, found.duration)]
    return [number(found.peak, "N", "kN", 5), times[0], number(found.impulse, "N s", "N s"), *times[1:]]


def _whole_cells(whole: WholeForce | None) -> list[str]:
    return ["-", "-"] if whole is None else [number(whole.peak, "N", "kN", 5), number(whole.impulse, "N s", "N s")]


def _show_ledger(solution: FemSolution) -> None:
    from strikewave.fem.measures import ENERGY_LIMIT, HOURGLASS_LIMIT, ledger_measure
    from strikewave.fem.run import ENERGIES

    run, ledger = solution.run, ledger_measure(solution.run)
    kinds = [name for name in ENERGIES if run.energy[name].any()]
    cells = [number(run.initial_energy, "J", "J"), *(number(float(run.energy[name][-1]), "J", "J") for name in kinds)]
    table("Energy at the end (J)", ["initial", *kinds], [cells], left=0)
    say(
        f"ledger: energy {ledger.energy:+.1e} (limit {ENERGY_LIMIT:g}), hourglass {ledger.hourglass:.1e} of internal "
        f"(limit {HOURGLASS_LIMIT:g}), momentum {ledger.momentum:.1e}"
    )
    say(f"{run.steps} steps of {run.step * 1e9:.3g} ns or more, {run.speed / 1e6:.3g} M element-steps/s")


def _show_blows(solution: FemSolution) -> None:
    """Print what each blow came to, and how the bodies came to rest before it."""
    from strikewave.analyses.fem.sectors import blow_of_bodies
    from strikewave.fem.blow_measures import blow_measure
    from strikewave.fem.measures import ledger_measure

    rows = []
    for each in solution.blows:
        found, touched = blow_measure(each.run, each.model.touching), [x for x in each.contacts.values() if x]
        most = max(touched, key=lambda x: x.peak, default=None)
        body, pulse = next(iter(blow_of_bodies(each.model, each.run, each.sectors).items()))
        back = [x for x in found.restitution.values() if x is not None]
        rows.append(
            [
                str(found.blow),
                *(["-"] * 3 if most is None else _pulse_cells(most)),
                f"{back[0]:.4f}" if len(back) == 1 else "-",
                f"{body}: {number(pulse.rigid_peak, 'm/s^2', 'g', 5)}",
                number(max(found.plastic_strain.values(), default=math.nan), "1", "1", 3),
                number(sum(found.plastic_energy.values()), "J", "J", 3),
                f"{ledger_measure(each.run).energy:+.1e}",
            ]
        )
    heads = ["blow", "peak (kN)", "impulse (N s)", "lasts (us)", "restitution", "rigid peak (g)"]
    table("Blow after blow", [*heads, "plastic strain", "yields with (J)", "energy error"], rows, left=0)
    for run in solution.later:
        if run.rest is not None:
            away = f"; begins {run.rest.retreat * 1e6:.3g} um farther away" if run.rest.retreat else ""
            say(
                f"at rest before blow {run.blow}: {run.rest.maxima} maxima, {run.rest.steps} steps, "
                f"{run.rest.kinetic_share:.1e} of the energy left, {run.rest.plastic_energy:.3g} J of yield{away}"
            )


def _pulse_cells(found: ContactMeasure) -> list[str]:
    return [number(found.peak, "N", "kN", 5), number(found.impulse, "N s", "N s"), number(found.duration, "s", "us")]


def _show_quality(model: Model, quality: Sequence[PartQuality]) -> None:
    """Print the quality of the mesh by part."""
    rows = [
        [
            row.part,
            str(row.elements),
            str(row.nodes),
            number(row.volume * model.solids[row.part].density, "kg", "kg"),
            number(row.shortest_edge, "m", "mm"),
            number(row.longest_edge, "m", "mm"),
            f"{row.aspect_ratio:.2f}",
            f"{row.scaled_jacobian:.3f}",
            number(row.warpage if row.warpage >= FLAT else 0.0, "rad", "deg", 3),
        ]
        for row in quality
    ]
    heads = ["part", "elements", "nodes", "mass (kg)", "shortest edge (mm)", "longest (mm)", "aspect ratio"]
    table("Mesh", [*heads, "scaled Jacobian", "warpage (deg)"], rows)


def _check_document(case: Case, model: Model, quality: Sequence[PartQuality]) -> dict[str, Any]:
    """Return the JSON document of a model that was checked."""
    from strikewave.analyses.fem.notices import model_notices
    from strikewave.analyses.fem.run import first_step

    units = {"volume": "m^3", "shortest_edge": "m", "longest_edge": "m", "warpage": "rad", "worst_at": "m", "step": "s"}
    counted = {"elements": len(model.mesh.hexahedra), "nodes": len(model.mesh.points), "step": first_step(model)}
    rows = {row.part: without(dataclasses.asdict(row), "part", "step") for row in quality}
    found = [without(dataclasses.asdict(notice), "broken") for notice in model_notices(case, model)]
    return plain({**head(units, found), "case": case.name, **counted, "parts": rows})
