"""Report of an element run: its chapters and tables, and page and pictures as files."""

from __future__ import annotations

import dataclasses
import math
import re
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from strikewave.analyses.fem.figures import histories
from strikewave.analyses.fem.figures.animation import fem_page, movie_of, write_fem_gif
from strikewave.analyses.fem.figures.cut import (
    COVERED,
    Zone,
    close_up_figure,
    cut_figure,
    pressed_most,
    seen_close_up,
    wave_figure,
)
from strikewave.analyses.fem.figures.histories import blows_figure, summary_sheet
from strikewave.analyses.fem.figures.pictures import contact_zone, mesh_picture, view_of
from strikewave.analyses.fem.result import FemSolution, instant_words, largest_words, place_words
from strikewave.analyses.fem.sectors import unlike_sectors
from strikewave.base.shock_quantities import DENSITY, LENGTH, MASS, MICROSECONDS, MODULUS, STEP, STRESS, VELOCITY
from strikewave.base.texts import percent
from strikewave.fem.quality import PartQuality, quality_report
from strikewave.fem.run import ALIGNED, ENERGIES, EnergyExtent, FemRun, contact_measure, still_presses
from strikewave.fem.snapshots import Snapshot, SnapshotRecorder, blow_contact, faces_on, recorder_from_frames
from strikewave.fem.solids import AnySolid, Bilinear, JohnsonCook, ZerilliArmstrong, von_mises
from strikewave.reporting import chapters
from strikewave.reporting.bands import NO_BAND_OF_ELEMENTS
from strikewave.reporting.columns import Column, page_table
from strikewave.reporting.faces import FaceRow, amount, columns_of, face_columns, face_rows, face_table, text_of
from strikewave.reporting.numbers import headed, listed, shown
from strikewave.reporting.parts import NONE, Cell, Part, Picture, Section, Table, Tag, written
from strikewave.reporting.run_and_write import drawing
from strikewave.reporting.style import save
from strikewave.reporting.terminal import progress_bar
from strikewave.signal.pulse import WIDTH_FRACTION

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from strikewave.fem.mesh import Mesh
    from strikewave.fem.model import Model

_SOLIDS = {
    "Elastic": "elastic",
    "Bilinear": "bilinear plastic",
    "JohnsonCook": "Johnson-Cook",
    "ZerilliArmstrong": "Zerilli-Armstrong",
}
_BOUNDARIES = {"NonReflecting": "non-reflecting", "Symmetry": "plane of symmetry"}
_SHARES = {2: "half", 4: "quarter"}
MOST_BODIES = 4  # chosen: it stays a paragraph; the table of parts has them all
"""Most bodies whose pulses the summary names."""
_OF_BLOW = re.compile(r"blow (\d+): ")
_GROUPS_FIRST = (
    " Groups, drawn thicker, set the scale; a part that reaches far beyond it is cut off, and its legend says how far "
    "it goes."
)
_METHOD = (
    "Explicit finite elements: 8-node hexahedra with one integration point each (parts under full integration have "
    "eight) and hourglass stiffness; central differences in time. Rigid-body acceleration is the rate "
    "of momentum of a part over its mass; forces of contact are those on the first of the two surfaces. g is standard "
    "gravity, 9.80665 m/s²."
)
_CONTACT = (
    "Forces and rigid-body accelerations are means over the intervals of the histories: where flat faces meet, the "
    "force of a single time step grows as the step gets shorter; that of an interval does not. The impulse is that of "
    "the whole run; the duration counts from when the force first passes a tenth of its peak to when it last does, "
    "gaps included."
)
_PARTS = (
    f"Peak, pulse width (at {percent(WIDTH_FRACTION, 0)} of the peak) and change of velocity are those along the "
    "direction in which the velocity of the part changes most, or the axis within "
    f"{math.degrees(math.acos(ALIGNED)):.0f} degrees of it. Stress and plastic strain are the largest of any element "
    "at the instants of the histories."
)


def fem_report(solution: FemSolution) -> str:
    """Return the report of an explicit run as one HTML page: no script, nothing fetched."""
    tables = [_contact_table(solution), face_table(solution, "bodies", caption="Parts, each as one rigid body")]
    sections = [
        _histories(solution.run),
        fields_section(solution),
        Section("Contacts and parts", f"{_CONTACT} {_PARTS}", tables),
        *([blows_section(solution)] if solution.later else []),
        _balances(solution),
        *chapters.published(solution.comparisons),
        chapters.warnings(solution.notices),
        _what_ran(solution),
        chapters.inputs(solution.case, unused="solver"),
    ]
    summary = chapters.Summary(
        kicker="Report of an explicit finite-element run",
        words=f"{fem_words(solution)} {NO_BAND_OF_ELEMENTS}",
        numbers=solution.highlights(),
        status=_status(solution),
    )
    return chapters.result_page(solution, summary, sections)


def _status(solution: FemSolution) -> Tag:
    failed = _failed(solution)
    if solution.run.stopped:
        return Tag("stopped early" + (f"; {chapters.failed_checks(failed).text}" if failed else ""), "bad")
    return chapters.failed_checks(failed) if failed else chapters.status(solution)


def _failed(solution: FemSolution) -> list[str]:
    """Return the codes of failed checks, each once, with their blows if the run has several."""
    blows_of: dict[str, list[str]] = {}
    for notice in solution.notices:
        if notice.broken:
            later = _OF_BLOW.match(notice.message)
            blows_of.setdefault(notice.code, []).append(later[1] if later else "1")
    if not solution.later:
        return list(blows_of)
    return [
        f"{code} (blow{'s' if len(set(blows)) > 1 else ''} {listed(list(dict.fromkeys(blows)))})"
        for code, blows in blows_of.items()
    ]


def fem_words(solution: FemSolution) -> str:
    """Return the events of a run in sentences, for the screen and the head of the report."""
    run = solution.run
    sentences = [f"The run ended early: {run.stopped}."] if run.stopped else []
    for name, strongest in solution.strongest.items():
        peak, duration, impulse = (text_of(strongest.measure, what) for what in ("peak", "duration", "impulse"))
        sentences.append(f"The contact {name} reaches {peak}, lasts {duration} and carries {impulse}.")
    if not solution.strongest:
        sentences.append("Nothing touched." if run.force else "No contact is in the model.")
    moved = [
        f"{name} {text_of(pulse, 'rigid_peak')} and {text_of(pulse, 'velocity_change')}"
        for name, pulse in solution.moved.items()
    ]
    if moved:
        sentences.append(f"Rigid-body peak and change of velocity: {listed(moved[:MOST_BODIES])}.")
    sentences.append(_energy_words(solution))
    return " ".join(sentences) + _sector_words(solution)


def _sector_words(solution: FemSolution) -> str:
    """Return which parts are meshed as sectors, and that numbers are those of whole bodies."""
    pieces = {name: solution.sectors[name].pieces for name in solution.run.parts}
    meshed = [
        f"a {share} of {listed(names)}"
        for many, share in _SHARES.items()
        if (names := [name for name in pieces if pieces[name] == many])
    ]
    unlike = unlike_sectors(solution.model, solution.sectors)
    whole = "masses" if unlike else "masses, forces and energies"
    return f" Meshed is {listed(meshed)}; {whole} are those of whole bodies." if meshed else ""


def _histories(run: FemRun) -> Section:
    """Return the pictures of forces, accelerations, energies, sections and watched points."""
    accelerations = "Rigid-body acceleration of the parts along the blow." + (_GROUPS_FIRST if run.groups else "")
    pictures = (
        (
            bool(run.force),
            histories.force_figure,
            "Magnitude of the contact force, mean of each interval, with its peak; dotted: its impulse.",
        ),
        (True, histories.acceleration_figure, accelerations),
        (
            True,
            histories.energy_figure,
            "Energy balance: the energies, and below them the balance error over the energy in play.",
        ),
        (
            bool(run.sections),
            histories.section_figure,
            "Mean stress of the sections along the blow; tension is positive.",
        ),
        (bool(run.points), histories.point_figure, "Velocity of the watched points along the blow."),
    )
    return Section("Histories", "", [Picture(draw(run), caption) for there, draw, caption in pictures if there])


def _contact_table(solution: FemSolution) -> Table:
    def note(row: FaceRow) -> str | None:
        if row.value is None:
            return "never touched"
        return "touches at the end" if still_presses(solution.run, row.name) else None

    notes = Column("note", [note(row) for row in face_rows(solution, "touched")])
    return page_table("Contacts and walls", [*face_columns(solution, "touched"), notes], "No contact is in the model.")


def _what_ran(solution: FemSolution) -> Section:
    model, run, view = solution.model, solution.run, view_of(solution.model)
    cut = ", cut along the blow." if view.cut is not None else "."
    pictures = [Picture(mesh_picture(model.mesh, view), f"The mesh before the blow{cut}")]
    zone = contact_zone(model, view)
    if zone is not None:
        near = dataclasses.replace(view, near=zone)
        name = getattr(blow_contact(model), "name", "")
        caption = f"The mesh within {amount(LENGTH, zone[1], digits=3)} of where {name} is nearest."
        pictures.append(Picture(mesh_picture(model.mesh, near), caption))
    pace = f"{run.steps} steps, the smallest {amount(STEP, run.step)}, took {run.seconds:.3g} s."
    added = f" Mass scaling added {amount(MASS, run.added_mass, digits=3)}." if run.added_mass > 0.0 else ""
    caption = "Quality of the mesh, worst values; the scaled Jacobian is 1 for right angles and 0 for a flat corner"
    quality = page_table(caption, columns_of(PartQuality, quality_report(model.mesh)))
    parts: list[Part] = [_solid_table(solution), _condition_table(model), quality, *pictures]
    return Section("Model and method", f"{_METHOD}\n\n{pace}{added}", parts)


def _solid_table(solution: FemSolution) -> Table:
    model, rows = solution.model, list[list[Cell]]()
    for name in model.mesh.names:
        solid = model.solids[name]
        kind = _SOLIDS.get(type(solid).__name__, type(solid).__name__)
        velocity = ", ".join(f"{shown(v, *VELOCITY.units):g}" for v in model.velocity.get(name, (0.0, 0.0, 0.0)))
        rigid = any(r.part == name for r in model.rigid)
        elements = len(model.mesh.hexahedra[model.mesh.elements_of(name)])
        rows.append(
            [
                name,
                _SHARES.get(solution.sectors[name].pieces, "whole"),
                "rigid" if rigid else kind + _yield_words(solid),
                NONE if rigid else "full" if name in model.controls.full else "one point",
                f"{shown(solid.density, *DENSITY.units):g}",
                f"{shown(solid.youngs_modulus, *MODULUS.units):g}",
                f"{solid.poissons_ratio:g}",
                str(elements),
                velocity,
            ]
        )
    heads = [
        "part",
        "meshed",
        "solid",
        "integration",
        headed("density", *DENSITY.units),
        headed("E", *MODULUS.units),
        "Poisson's ratio",
        "elements",
        headed("initial velocity", *VELOCITY.units),
    ]
    return Table("Parts and their solids", heads, rows)


def _yield_words(solid: AnySolid) -> str:
    """Return the law of yield of a solid with its constants."""
    if isinstance(solid, Bilinear):
        text = f", yields at {_stress(solid.yield_strength)}, then {_stress(solid.tangent_modulus)}"
        return text + (f", {percent(solid.kinematic, 0)} kinematic" if solid.kinematic else "")
    if isinstance(solid, JohnsonCook):
        return f", A {_stress(solid.A)}, B {_stress(solid.B)}, n {solid.n:g}, C {solid.C:g}, m {solid.m:g}"
    if isinstance(solid, ZerilliArmstrong):
        stresses = (f"{name} {_stress(getattr(solid, name))}" for name in ("C0", "C1", "C2", "C5"))
        return f", {', '.join(stresses)}, n {solid.n:g}, C3 {solid.C3:g} /K, C4 {solid.C4:g} /K"
    return ""


def _stress(value: float) -> str:
    return amount(STRESS, value, digits=6)


def _condition_table(model: Model) -> Table:
    rows: list[list[Cell]] = []
    for boundary in model.boundaries:
        name = type(boundary).__name__
        kind = _BOUNDARIES.get(name, name.lower())
        rows.append([kind, boundary.side, _boundary_words(boundary)])
    rows += [["contact", c.name, f"friction {c.friction:g}"] for c in model.contacts]
    rows += [["rigid wall", w.side, f"through {_metres(w.point)}, normal {_plain(w.normal)}"] for w in model.walls]
    rows += [["tie", t.side, f"onto {t.onto}"] for t in model.ties]
    rows += [["rigid part", r.part, "does not deform"] for r in model.rigid]
    if any(model.gravity):
        rows.append(["gravity", "all", f"{_plain(model.gravity)} m/s²"])
    c = model.controls
    rows.append(
        [
            "controls",
            "all",
            f"safety {c.safety:g}, hourglass {c.hourglass:g}, bulk viscosity "
            f"{c.linear_viscosity:g} and {c.quadratic_viscosity:g}",
        ]
    )
    return Table("Boundary conditions, loads and contacts", ["kind", "side", "values"], rows)


def _boundary_words(boundary: Any) -> str:
    """Return the values of a boundary."""
    if hasattr(boundary, "axis"):
        return f"along {_plain(boundary.axis)}"
    curve = getattr(boundary, "velocity", None) or getattr(boundary, "pressure", None)
    if curve is None:
        return NONE
    most = max(curve.value, key=abs)
    unit, scale = ("m/s", 1.0) if hasattr(boundary, "velocity") else ("MPa", 1e6)
    along = f" along {_plain(boundary.direction)}" if hasattr(boundary, "direction") else ""
    return f"up to {most / scale:.4g} {unit}{along}, {len(curve.value)} points over time"


def _plain(vector: Sequence[float]) -> str:
    return "(" + ", ".join(f"{v:.3g}" for v in vector) + ")"


def _metres(place: Sequence[float]) -> str:
    return "(" + ", ".join(f"{v * 1e3:.4g}" for v in place) + ") mm"


def _energy_words(solution: FemSolution) -> str:
    """Return whether the energy balance holds, and whether hourglass modes are small."""
    energy, hourglass, _ = solution.balance_checks
    error = f"{100.0 * energy.error:+.3g} %" if math.isfinite(energy.error) else "no bound"
    text = f"The energy balance error is {error}, "
    if energy.holds:
        text += f"within its limit of {percent(energy.limit, 0)}."
    else:
        text += (
            f"beyond its limit of {percent(energy.limit, 0)}: take a smaller fem.safety, or a finer mesh where parts "
            "touch; do not trust these numbers."
        )
    if not hourglass.holds:
        text += (
            f" Hourglass modes hold {100.0 * hourglass.error:.3g} % of the internal energy, beyond "
            f"{percent(hourglass.limit, 0)}: refine the mesh where it bends or is touched, or integrate that part "
            "fully."
        )
    return text


def _balances(solution: FemSolution) -> Section:
    run = solution.run
    labels = [name + (" (within internal)" if name == "plastic" else "") for name in ENERGIES]
    rows = [EnergyExtent(math.nan, run.initial_energy), *(EnergyExtent.of(run.energy[name]) for name in ENERGIES)]
    columns = [Column("energy", ["at the start, all", *labels]), *columns_of(EnergyExtent, rows)]
    tables = [chapters.balance_table(solution.balance_checks), page_table("Energies", columns)]
    return Section("Energy and momentum balance", _energy_words(solution), tables)


FEWEST_OF_WAVE = 3  # chosen: two show no motion of a front
"""Fewest instants after first touch that make a row of pictures."""
_HOW = (
    "Each element has the colour of its one value, at its place at that instant: displacements are to scale. Dark "
    "lines are the outlines of bodies, thin lines the mesh, where its elements are large enough. Faces seen "
    "obliquely are darker."
)
_BEFORE = " Elements in front of the cutting plane are left out whole."
_END_OF_SCALE = (
    f"The colour scale covers {100.0 * COVERED:.0f} % of the loaded surface over these instants; a tip at its end "
    "marks that a few elements lie beyond it."
)


def fields_section(solution: FemSolution) -> Section:
    """Return the pictures of the fields with their text."""
    film = getattr(solution, "film", None)
    frames = solution.frames or solution.run.frames
    if film is None or not film.snapshots:
        film = recorder_from_frames(solution.model, frames) if frames else None
    if film is None or not film.snapshots:
        return Section("Fields", "No frame of the fields was kept for pictures.")
    pressed = _pressed(solution, film)
    mesh = solution.model.mesh
    parts: list[Part] = [_whole(film, pressed), *_close_up(film, pressed, mesh), *_wave(film)]
    cut = film.skin.cut
    if not cut.symmetric:
        opened = f"The bodies, which are modelled whole, are cut open along the blow.{_BEFORE}"
    elif cut.mirror is None:
        opened = "The bodies are seen from their plane of symmetry: the half that is modelled."
    else:
        opened = (
            "The bodies are seen from a plane of symmetry; the quarter that is modelled is mirrored at the other plane."
        )
    return Section("Fields", f"{_HOW} {opened} {largest_words(film, mesh)}".rstrip(), parts)


def _pressed(solution: FemSolution, film: SnapshotRecorder) -> tuple[Snapshot, Zone, str] | None:
    """Return instant, place and words of the largest force of the contact of the blow; None where it never presses."""
    model: Model = solution.model
    meeting = blow_contact(model)
    measure = contact_measure(solution.run, meeting.name) if meeting and meeting.name in solution.run.force else None
    if meeting is None or measure is None:
        return None
    own = faces_on(film.skin, model.mesh, model.touching[meeting.name])
    pressed = pressed_most(film.skin, film.snapshots, measure.at, own)
    instant = f"the stored instant nearest to the force peak of {meeting.name}, at {instant_words(measure.at)}"
    return None if pressed is None else (*pressed, instant)


def _whole(film: SnapshotRecorder, pressed: tuple[Snapshot, Zone, str] | None) -> Picture:
    """Return the bodies cut open when the force of the blow is largest, or else the stress, and at the end."""
    last = film.snapshots[-1]
    still, when = (film.worst or last, "when the stress is largest") if pressed is None else (pressed[0], pressed[2])
    shown = [still] if still.time == last.time else [still, last]
    largest = float(von_mises(still.stress.astype(float)).max(initial=0.0))
    caption = f"Von Mises stress in the bodies cut open at {_instant(still)}, {when}"
    caption += f", and at {_instant(last)}, the last instant." if len(shown) > 1 else "."
    caption += f" The largest value in view at {_instant(still)} is {amount(STRESS, largest)}."
    return Picture(cut_figure(film.skin, shown), f"{caption} {_END_OF_SCALE}")


def _close_up(film: SnapshotRecorder, pressed: tuple[Snapshot, Zone, str] | None, mesh: Mesh) -> list[Part]:
    """Return the contact from near with stress and plastic strain; nothing where nothing presses."""
    if pressed is None:
        return []
    (still, zone, when), last = pressed, film.snapshots[-1]
    pictures = [(still, "von_mises")]
    caption = (
        f"Where bodies touch, straight onto the cut, within about {amount(LENGTH, zone.reach, digits=2)}: "
        f"von Mises stress at {_instant(still)}, {when}"
    )
    spot, elsewhere = film.largest.get("plastic_strain"), ""
    if spot is not None:
        pictures.append((last, "plastic_strain"))
        caption += f", and equivalent plastic strain at {_instant(last)}, the last instant"
        largest_seen = float(seen_close_up(film.skin, zone, last, "plastic_strain").max(initial=0.0))
        if largest_seen < 0.999 * spot.value:  # values are shown to three digits: nearer ones read alike
            elsewhere = f" The largest plastic strain of all, {written(spot.value)}, is not in this view: it is in "
            elsewhere += f"{place_words(mesh, spot.element)}."
    caption += f". The scales reach the largest value that is seen.{elsewhere}"
    return [Picture(close_up_figure(film.skin, zone, pictures), caption)]


def _wave(film: SnapshotRecorder) -> list[Part]:
    """Return the row of instants after first touch; nothing without touch, or where the run went on later."""
    if len(film.wave) < FEWEST_OF_WAVE or film.touched is None:
        return []
    caption = (
        f"The first wave through the bodies, {len(film.wave)} instants from first touch on, which is at "
        f"{instant_words(film.touched)}: the stress along the blow, blue compression and red tension, "
        f"at {listed([_instant(still) for still in film.wave])}. A wave takes "
        f"{amount(MICROSECONDS, film.transit)} from there to the far end, at the speed sqrt(E/rho) of the body there. "
        f"One scale for all instants. {_END_OF_SCALE}"
    )
    return [Picture(wave_figure(film.skin, film.wave), caption)]


def _instant(still: Snapshot) -> str:
    return instant_words(still.time)


_RELAXATION = (
    "After a blow the bodies come to rest (dynamic relaxation) without their loads and contacts, go back to where "
    "they began as rigid bodies, and meet again with the velocities of the case. Plastic strain, back stress, "
    "temperature, shape and residual stress stay from the blow before. All other sections are those of the "
    "first blow. The coefficient of restitution is the speed of separation at the end over that of approach at the "
    "start, of the parts of the contact as rigid bodies."
)


def blows_section(solution: FemSolution) -> Section:
    """Return the numbers of each blow, and the dynamic relaxation before it."""
    caption = "Force of the strongest contact of each blow, means of intervals, and the share that yield takes."
    picture = Picture(blows_figure([blow.run for blow in solution.blows]), caption)
    forces = face_table(solution, "contacts_of_blows", "blow", empty="No contact is in the model.")
    return Section("Blow after blow", _RELAXATION, [forces, face_table(solution, "yield_of_blows"), picture])


page = fem_report
"""Page of a result in Python, found as `picture` is by `strikewave.reporting.shown_result`."""


def picture(solution: FemSolution) -> Figure:
    """Return the sheet of histories of a run."""
    return summary_sheet(solution.run, solution.title)


def draw_result(solution: FemSolution, folder: Path, report: bool = True, animate: bool = False) -> list[str]:
    """Write page and pictures of a run into a folder, and return their names."""
    names = ["summary.svg"]
    with drawing(folder / names[0]) as path:
        save(picture(solution), path)
    if report:
        with drawing(folder / "report.html") as path:
            path.write_text(fem_report(solution), "utf-8", newline="\n")
        names.insert(0, "report.html")
    return names + (animate_run(solution, folder) if animate else [])


def animate_run(solution: FemSolution, folder: Path) -> list[str]:
    """Write the animation as a page and as a GIF, and return their names; nothing where nothing was kept."""
    with progress_bar("animation", clocks=("left",)) as progress:
        movie = movie_of(solution, progress=lambda share: progress(0.5 * share))
        if movie is None:
            return []
        with drawing(folder / "animation.html") as path:
            page = fem_page(movie, solution.title, solution.case.name)
            path.write_text(page, "utf-8", newline="\n")
        with drawing(folder / "animation.gif") as path:
            write_fem_gif(movie, solution.title, path, lambda share: progress(0.5 + 0.5 * share))
    return ["animation.html", "animation.gif"]
