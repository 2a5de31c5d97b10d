"""The pictures of an explicit run in its report: bodies cut open, where they touch, the wave through them."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from strikewave.analyses.fem.figures.cut import (
    COVERED,
    Zone,
    close_up_figure,
    cut_figure,
    pressed_most,
    seen_close_up,
    wave_figure,
)
from strikewave.fem.invariants import von_mises
from strikewave.fem.measures import contact_measure
from strikewave.fem.skin import blow_contact, faces_on
from strikewave.fem.snapshots import Snapshot, SnapshotRecorder, recorder_from_frames
from strikewave.reporting.numbers import listed, with_unit
from strikewave.reporting.parts import Part, Picture, Section, written

if TYPE_CHECKING:
    from strikewave.analyses.fem.result import FemSolution
    from strikewave.fem.mesh import Mesh
    from strikewave.fem.model import Model

FEWEST_OF_WAVE = 3
"""Instants after first touch without which there is no row of them."""
_HOW = (
    "Each element is shown in the colour of its one value, where it is at that instant: displacements are as they are, "
    "not enlarged. Dark lines are the outlines of bodies; thin ones are the mesh, where its elements are large enough "
    "to be told apart. Faces that look aside are a little darker."
)
_BEFORE = " Elements before the plane of the cut are left out whole."
_END_OF_SCALE = (
    f"The scale of colours covers {100.0 * COVERED:.0f} % of the loaded surface over these instants; where its bar "
    "ends in a tip, a few elements lie beyond it."
)


class Pressed(NamedTuple):
    """The instant nearest to the largest force of the contact of the blow, where it presses, and that in words."""

    still: Snapshot
    zone: Zone
    words: str


def fields_section(solution: FemSolution) -> Section:
    """Return the pictures of the fields, with what is seen in them."""
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
    opened = f" {_opened(film)}" + (_BEFORE if not cut.symmetric else "")
    return Section("Fields", f"{_HOW}{opened} {largest_words(film, mesh)}".rstrip(), parts)


def largest_words(film: SnapshotRecorder, mesh: Mesh) -> str:
    """Say where von Mises stress and plastic strain are largest of all elements, seen or not; nothing where none is."""
    names, words = {"von_mises": "von Mises stress", "plastic_strain": "plastic strain"}, []
    for name, spot in film.largest.items():
        value = with_unit(spot.value, "Pa", "MPa") if name == "von_mises" else written(spot.value)
        words.append(f"{names[name]} {value} in {place_words(mesh, spot.element)} at {_instant_words(spot.time)}")
    if not words:
        return ""
    return (
        f"Largest of all elements at the instants kept for pictures: {listed(words)} (middle of the element at first)."
    )


def place_words(mesh: Mesh, element: int) -> str:
    """Name the part of an element and its middle before the blow."""
    middle = mesh.points[mesh.hexahedra[element]].mean(axis=0) * 1e3
    place = ", ".join(f"{x:.4g}" for x in np.where(np.abs(middle) < 1e-9, 0.0, middle))
    return f"{mesh.names[int(mesh.part[element])]} at ({place}) mm"


def _pressed(solution: FemSolution, film: SnapshotRecorder) -> Pressed | None:
    """Return when and where the contact of the blow presses, nearest to its largest force; None where it does not."""
    model: Model = solution.model
    meeting = blow_contact(model)
    found = contact_measure(solution.run, meeting.name) if meeting and meeting.name in solution.run.force else None
    if meeting is None or found is None:
        return None
    own = faces_on(film.skin, model.mesh, model.touching[meeting.name])
    pressed = pressed_most(film.skin, film.snapshots, found.at, own)
    words = f"the kept instant nearest to the peak of the force of {meeting.name}, at {_instant_words(found.at)}"
    return None if pressed is None else Pressed(*pressed, words)


def _opened(film: SnapshotRecorder) -> str:
    """Say where the bodies are cut open."""
    cut = film.skin.cut
    if not cut.symmetric:
        return "The bodies, which are modelled whole, are cut open along the blow."
    if cut.mirror is None:
        return "The bodies are seen from their plane of symmetry: the half that is modelled."
    return "The bodies are seen from a plane of symmetry; the quarter that is modelled is mirrored at the other plane."


def _whole(film: SnapshotRecorder, pressed: Pressed | None) -> Picture:
    """Return the bodies cut open when the force of the blow is largest, or else the stress, and at the end."""
    stills = film.snapshots
    still, when = (film.worst or stills[-1], "when the stress is largest")
    if pressed is not None:
        still, when = pressed.still, pressed.words
    shown = [still] if still.time == stills[-1].time else [still, stills[-1]]
    largest = float(von_mises(still.stress.astype(float)).max(initial=0.0))
    words = f"Von Mises stress in the bodies cut open at {_instant(still)}, {when}"
    words += f", and at {_instant(stills[-1])}, the last instant." if len(shown) > 1 else "."
    words += f" The largest that can be seen at {_instant(still)} is {with_unit(largest, 'Pa', 'MPa')}."
    return Picture(cut_figure(film.skin, shown), f"{words} {_END_OF_SCALE}")


def _close_up(film: SnapshotRecorder, pressed: Pressed | None, mesh: Mesh) -> list[Part]:
    """Return where bodies press each other, and what yielded there; nothing where nothing is pressed."""
    if pressed is None:
        return []
    (still, zone, when), last = pressed, film.snapshots[-1]
    pictures = [(still, "von_mises")]
    words = (
        f"Where bodies touch, straight onto the cut, within about {zone.reach * 1e3:.2g} mm: von Mises stress at "
        f"{_instant(still)}, {when}"
    )
    spot, elsewhere = film.largest.get("plastic_strain"), ""
    if spot is not None:
        pictures.append((last, "plastic_strain"))
        words += f", and equivalent plastic strain at {_instant(last)}, the last instant"
        seen = float(seen_close_up(film.skin, zone, last, "plastic_strain").max(initial=0.0))
        if seen < 0.999 * spot.value:
            elsewhere = f" The largest plastic strain of all, {written(spot.value)}, is not in this view: it is in "
            elsewhere += f"{place_words(mesh, spot.element)}."
    words += f". The scales reach the largest value that is seen.{elsewhere}"
    return [Picture(close_up_figure(film.skin, zone, pictures), words)]


def _wave(film: SnapshotRecorder) -> list[Part]:
    """Return the row of instants after first touch; nothing where nothing touches, or the run went on later."""
    if len(film.wave) < FEWEST_OF_WAVE or film.touched is None:
        return []
    words = (
        f"The first wave through the bodies, {len(film.wave)} instants from first touch on, which is at "
        f"{_instant_words(film.touched)}: the stress along the blow, blue where it presses and red where it "
        f"pulls, at {listed([_instant(still) for still in film.wave])}. A wave takes "
        f"{with_unit(film.transit, 's', 'us')} from there to the far end, at the speed sqrt(E/rho) of the body there. "
        f"One scale for all instants. {_END_OF_SCALE}"
    )
    return [Picture(wave_figure(film.skin, film.wave), words)]


def _instant(still: Snapshot) -> str:
    return _instant_words(still.time)


def _instant_words(time: float) -> str:
    return with_unit(time, "s", "us") if time > 0.0 else "the start"
