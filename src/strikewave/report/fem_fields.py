"""The pictures of an explicit run in its report: bodies cut open, where they touch, the wave through them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from strikewave.fem.film import Film, Still, film_from
from strikewave.fem.invariants import von_mises
from strikewave.figures.fem_cut import COVERED, Zone, close_up_figure, cut_figure, pressed_most, wave_figure
from strikewave.report.numbers import listed, with_unit
from strikewave.report.parts import Part, Picture, Section

if TYPE_CHECKING:
    from strikewave.fem_solution import FemSolution

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


def fields_section(solution: FemSolution) -> Section:
    """Return the pictures of the fields, with what is seen in them."""
    film = getattr(solution, "film", None)
    frames = solution.frames or solution.run.frames
    if film is None or not film.stills:
        film = film_from(solution.model, frames) if frames else None
    if film is None or not film.stills:
        return Section("Fields", "No frame of the fields was kept for pictures.")
    pressed = pressed_most(film.skin, film.stills)
    parts: list[Part] = [_whole(film, pressed), *_close_up(film, pressed), *_wave(film)]
    cut = film.skin.cut
    opened = f" {_opened(film)}" + (_BEFORE if not cut.symmetric else "")
    return Section("Fields", _HOW + opened, parts)


def _opened(film: Film) -> str:
    """Say where the bodies are cut open."""
    cut = film.skin.cut
    if not cut.symmetric:
        return "The bodies, which are modelled whole, are cut open along the blow."
    if cut.mirror is None:
        return "The bodies are seen from their plane of symmetry: the half that is modelled."
    return "The bodies are seen from a plane of symmetry; the quarter that is modelled is mirrored at the other plane."


def _whole(film: Film, pressed: tuple[Still, Zone] | None) -> Picture:
    """Return the bodies cut open when they press each other most, or bear the largest stress, and at the end."""
    stills = film.stills
    still, when = (film.worst or stills[-1], "the stress is largest")
    if pressed is not None:
        still, when = pressed[0], "they press each other most"
    shown = [still] if still.time == stills[-1].time else [still, stills[-1]]
    largest = float(von_mises(still.stress.astype(float)).max(initial=0.0))
    words = f"Von Mises stress in the bodies cut open at {_instant(still)}, when {when}"
    words += f", and at {_instant(stills[-1])}, the last instant." if len(shown) > 1 else "."
    words += f" The largest that can be seen at {_instant(still)} is {with_unit(largest, 'Pa', 'MPa')}."
    return Picture(cut_figure(film.skin, shown), f"{words} {_END_OF_SCALE}")


def _close_up(film: Film, pressed: tuple[Still, Zone] | None) -> list[Part]:
    """Return where bodies press each other most, and what yielded there; nothing where nothing is pressed."""
    if pressed is None:
        return []
    (still, zone), last = pressed, film.stills[-1]
    pictures = [(still, "von_mises")]
    words = (
        f"Where bodies touch, straight onto the cut, within about {zone.reach * 1e3:.2g} mm: von Mises stress at "
        f"{_instant(still)}, when they press each other most"
    )
    if float(last.plastic_strain.max(initial=0.0)) > 0.0:
        pictures.append((last, "plastic_strain"))
        words += f", and equivalent plastic strain at {_instant(last)}, the last instant"
    words += ". The scales reach the largest value that is seen."
    return [Picture(close_up_figure(film.skin, zone, pictures), words)]


def _wave(film: Film) -> list[Part]:
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


def _instant(still: Still) -> str:
    return _instant_words(still.time)


def _instant_words(time: float) -> str:
    return with_unit(time, "s", "us") if time > 0.0 else "the start"
