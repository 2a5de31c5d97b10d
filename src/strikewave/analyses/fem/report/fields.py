"""The pictures of an explicit run in its report: bodies cut open, where they touch, the wave through them."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from strikewave.analyses.fem.figures.cut import (
    COVERED,
    Zone,
    close_up_figure,
    cut_figure,
    pressed_most,
    seen_close_up,
    wave_figure,
)
from strikewave.analyses.fem.report.largest import instant_words, largest_words, place_words
from strikewave.base.shock_quantities import MICROSECONDS, STRESS
from strikewave.fem.invariants import von_mises
from strikewave.fem.measures import contact_measure
from strikewave.fem.skin import blow_contact, faces_on
from strikewave.fem.snapshots import Snapshot, SnapshotRecorder, recorder_from_frames
from strikewave.reporting.faces import amount
from strikewave.reporting.numbers import listed
from strikewave.reporting.parts import Part, Picture, Section, written

if TYPE_CHECKING:
    from strikewave.analyses.fem.result import FemSolution
    from strikewave.fem.mesh import Mesh
    from strikewave.fem.model import Model

FEWEST_OF_WAVE = 3
"""Instants after first touch without which there is no row of them (chosen: two show no motion of a front)."""
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


class PeakContact(NamedTuple):
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


def _pressed(solution: FemSolution, film: SnapshotRecorder) -> PeakContact | None:
    """Return when and where the contact of the blow presses, nearest to its largest force; None where it does not."""
    model: Model = solution.model
    meeting = blow_contact(model)
    measure = contact_measure(solution.run, meeting.name) if meeting and meeting.name in solution.run.force else None
    if meeting is None or measure is None:
        return None
    own = faces_on(film.skin, model.mesh, model.touching[meeting.name])
    pressed = pressed_most(film.skin, film.snapshots, measure.at, own)
    instant = f"the stored instant nearest to the force peak of {meeting.name}, at {instant_words(measure.at)}"
    return None if pressed is None else PeakContact(*pressed, instant)


def _opened(film: SnapshotRecorder) -> str:
    """Say where the bodies are cut open."""
    cut = film.skin.cut
    if not cut.symmetric:
        return "The bodies, which are modelled whole, are cut open along the blow."
    if cut.mirror is None:
        return "The bodies are seen from their plane of symmetry: the half that is modelled."
    return "The bodies are seen from a plane of symmetry; the quarter that is modelled is mirrored at the other plane."


def _whole(film: SnapshotRecorder, pressed: PeakContact | None) -> Picture:
    """Return the bodies cut open when the force of the blow is largest, or else the stress, and at the end."""
    stills = film.snapshots
    still, when = (film.worst or stills[-1], "when the stress is largest")
    if pressed is not None:
        still, when = pressed.still, pressed.words
    shown = [still] if still.time == stills[-1].time else [still, stills[-1]]
    largest = float(von_mises(still.stress.astype(float)).max(initial=0.0))
    caption = f"Von Mises stress in the bodies cut open at {_instant(still)}, {when}"
    caption += f", and at {_instant(stills[-1])}, the last instant." if len(shown) > 1 else "."
    caption += f" The largest value in view at {_instant(still)} is {amount(STRESS, largest)}."
    return Picture(cut_figure(film.skin, shown), f"{caption} {_END_OF_SCALE}")


def _close_up(film: SnapshotRecorder, pressed: PeakContact | None, mesh: Mesh) -> list[Part]:
    """Return where bodies press each other, and what yielded there; nothing where nothing is pressed."""
    if pressed is None:
        return []
    (still, zone, when), last = pressed, film.snapshots[-1]
    pictures = [(still, "von_mises")]
    caption = (
        f"Where bodies touch, straight onto the cut, within about {zone.reach * 1e3:.2g} mm: von Mises stress at "
        f"{_instant(still)}, {when}"
    )
    spot, elsewhere = film.largest.get("plastic_strain"), ""
    if spot is not None:
        pictures.append((last, "plastic_strain"))
        caption += f", and equivalent plastic strain at {_instant(last)}, the last instant"
        largest_seen = float(seen_close_up(film.skin, zone, last, "plastic_strain").max(initial=0.0))
        if largest_seen < 0.999 * spot.value:
            elsewhere = f" The largest plastic strain of all, {written(spot.value)}, is not in this view: it is in "
            elsewhere += f"{place_words(mesh, spot.element)}."
    caption += f". The scales reach the largest value that is seen.{elsewhere}"
    return [Picture(close_up_figure(film.skin, zone, pictures), caption)]


def _wave(film: SnapshotRecorder) -> list[Part]:
    """Return the row of instants after first touch; nothing where nothing touches, or the run went on later."""
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
