"""Buffer design: gasket stacks under a sensor, ranked by what it then reads of a given blow.

The motion of the surface is given, and drives each stack of gaskets with the sensor on it; as everywhere in
`strikewave.sensors` the sensor does not load the surface back. Each candidate is run in time through the whole
chain: gaskets with mass and causal loss, resonance of the element, its range, the recorder. What it costs is
bandwidth: see `strikewave.sensors.bandwidth`.
"""

from __future__ import annotations

import csv
import dataclasses
import io
import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby, product
from typing import Any

from strikewave.base.citations import citation
from strikewave.base.errors import MISSING, InputError
from strikewave.base.json_document import head, plain, without
from strikewave.base.materials import material
from strikewave.base.quantities import Value
from strikewave.base.result import Notice
from strikewave.sensors import Mounting, Reading
from strikewave.sensors.channel import Channel, sensor_sources
from strikewave.sensors.mounting import mounting_system
from strikewave.studies.buffer.candidate import (
    Candidate,
    Goal,
    Leading,
    alike,
    assess,
    assess_mounting,
    distinct,
    look_closer,
    ranked,
    with_front,
    withstands,
)
from strikewave.studies.buffer.moduli import spread
from strikewave.studies.buffer.notices import study_notices
from strikewave.studies.buffer.seat import Blows, Motion, Seat, Sheet, Sheets, reading_of

MOST_CANDIDATES = 20_000
"""More stacks than this are refused before one is tried."""
MOST_STATES = 800
"""A stack with more states is left out of the search: each would take seconds."""
LEADING = 10
"""First distinct ones of the ranking that are also tried with other moduli, as is the front where it keeps the limit.
"""


@dataclass(frozen=True)
class Choice:
    """What stacks may be made of: materials, thicknesses, and the most layers."""

    materials: tuple[str, ...]
    thicknesses: tuple[Value, ...]
    layers: int = 3


@dataclass(frozen=True, eq=False)
class BufferStudy:
    """Ranked stacks for one sensor and one blow, beside the buffer that the case has now; see `design_buffer`."""

    seat: Seat
    blows: Blows
    goal: Goal
    candidates: tuple[Candidate, ...]
    warnings: tuple[Notice, ...]
    present: Candidate | None = None

    @property
    def motion(self) -> Motion:
        """The blow that the stacks are designed for."""
        return self.blows.motion

    @property
    def best(self) -> Candidate | None:
        """First of the ranking that keeps the limit; None where none does."""
        return self.candidates[0] if self.candidates[0].keeps else None

    @property
    def broken(self) -> bool:
        """Whether no stack keeps the limit."""
        return self.best is None

    @property
    def robust(self) -> Candidate | None:
        """First of the ranking that is known to keep the limit whatever the moduli; None where none is."""
        return next((candidate for candidate in self.candidates if candidate.robust), None)

    @property
    def held(self) -> Channel:
        """The sensor on the first stack, and its recorder."""
        mounting = self.seat.mounting(self.candidates[0].sheets)
        return self.seat.channel._replace(sensor=self.seat.sensor(mounting))

    @property
    def direct(self) -> Candidate:
        """The sensor without gaskets."""
        return next(candidate for candidate in self.candidates if not candidate.sheets)

    def reading(self, candidate: Candidate) -> Reading:
        """Return what the recorder keeps with a stack."""
        return reading_of(self.seat, candidate.sheets, self.motion)

    def document(self) -> dict[str, Any]:
        """Return the JSON document."""
        motion, sensor = self.motion, self.seat.channel.sensor
        blow = {
            "name": motion.name,
            "surface_peak": motion.peak,
            "surface_velocity_change": motion.velocity_change,
            "rigid_peak": motion.rigid_peak,
            "pulse_width": motion.width,
            "duration": motion.step * (motion.acceleration.size - 1),
        }
        held = {
            "name": self.seat.table.name,
            "mass": self.seat.mass,
            "area": self.seat.area,
            **{key: getattr(sensor, key) for key in ("resonance", "quality", "range")},
            "sampling_rate": self.seat.channel.recorder.sampling_rate,
        }
        rows = [_row(place, candidate) for place, candidate in enumerate(self.candidates, 1)]
        used = {sheet.material: material(sheet.material) for c in self.candidates for sheet in c.sheets}
        origin = {
            name: {"status": row.status, "source": row.source, "note": row.note, "moduli": spread(row)}
            for name, row in used.items()
        }
        warnings = [{k: v for k, v in dataclasses.asdict(n).items() if k != "broken"} for n in self.warnings]
        return dict(
            plain(
                {
                    **head(UNITS, warnings),
                    "limit": self.goal.limit,
                    "rank": self.goal.rank,
                    "kept": not self.broken,
                    "robust": None if self.robust is None else self.robust.name,
                    "back_effect": "none: the motion of the surface is given, the sensor does not load it back",
                    "sources": [citation(key) for key in (*sensor_sources([self.held]), "gent-lindley-1959")],
                    "materials": origin,
                    "sensor": held,
                    "blow": blow,
                    "present": None if self.present is None else without(_row(None, self.present), "place", "gaskets"),
                    "candidates": rows,
                }
            )
        )

    def table(self) -> str:
        """Return all candidates as CSV text, every column with its unit; last, without a place, the present buffer."""
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        rows = [_row(place, candidate) for place, candidate in enumerate(self.candidates, 1)]
        rows += [] if self.present is None else [_row(None, self.present)]
        columns = [key for key in rows[0] if key not in ("gaskets", "stress", "strain")]
        writer.writerow([f"{key} [{UNITS[key]}]" if key in UNITS else key for key in columns])
        for row in rows:
            writer.writerow(["" if row[key] in (None, math.inf) else _cell(row[key]) for key in columns])
        return text.getvalue()


UNITS = {
    "limit": "m/s^2", "mass": "kg", "area": "m^2", "resonance": "Hz", "quality": "1", "range": "m/s^2",
    "sampling_rate": "Hz", "surface_peak": "m/s^2", "surface_velocity_change": "m/s", "rigid_peak": "m/s^2",
    "pulse_width": "s", "moduli": "1", "duration": "s", "thickness": "m", "height": "m", "peak": "m/s^2", "width": "s",
    "element_peak": "m/s^2",    "true_peak": "m/s^2", "ringing": "1",
    "margin": "1", "within_5": "Hz", "within_10": "Hz", "half_power": "Hz", "largest": "1", "largest_at": "Hz",
    "rigid_ratio": "1", "velocity_error": "1", "loss_error": "1", "sag": "m", "softer": "m/s^2",
    "stiffer": "m/s^2", "confined": "m/s^2", "stress": "Pa", "strain": "1",
}  # fmt: skip
"""SI unit of each quantity of the document."""


def _row(place: int | None, candidate: Candidate) -> dict[str, Any]:
    """Return a candidate as one flat row."""
    found = candidate.leading
    own = {key: getattr(candidate, key) for key in _OWN}
    leading = {f.name: getattr(found, f.name, None) for f in dataclasses.fields(Leading)}
    gaskets = [{"material": sheet.material, "thickness": sheet.thickness.si} for sheet in candidate.sheets]
    return {
        "place": place,
        "name": candidate.name,
        "gaskets": gaskets,
        **own,
        **candidate.band._asdict(),
        **leading,
    }


_OWN = (
    "height", "peak", "width", "clipped", "element_peak", "true_peak", "keeps", "margin", "pareto", "rigid_ratio",
    "velocity_error", "ringing", "loss_error", "sag", "whole",
)  # fmt: skip


def _cell(value: Any) -> Any:
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return "" if math.isnan(value) else f"{value:.9g}"
    return value


def stacks(choice: Choice) -> list[Sheets]:
    """Return all stacks of a choice, none first; those that another one equals are left out.

    Neighbours of one material are bonded and are as one gasket of both thicknesses: 0.5 + 1 mm is 1 + 0.5 mm.

    Raises
    ------
    InputError
        If there is nothing to choose from, or far too much.

    Examples
    --------
    >>> thin, thick = Value(si=1e-3, typed="1 mm"), Value(si=2e-3, typed="2 mm")
    >>> [" | ".join(map(str, found)) for found in stacks(Choice(("PTFE",), (thin, thick), 2))]
    ['', 'PTFE 1 mm', 'PTFE 2 mm', 'PTFE 1 mm | PTFE 2 mm', 'PTFE 2 mm | PTFE 2 mm']
    """
    names = tuple(dict.fromkeys(material(name, "--material").name for name in choice.materials))
    sizes = {value.si: value for value in choice.thicknesses}
    _check_count(len(names) * len(sizes), choice.layers)
    sheets = [Sheet(name, value) for name in names for value in sizes.values()]
    found: dict[tuple[tuple[str, float], ...], Sheets] = {}
    for layers in range(choice.layers + 1):
        for stack in product(sheets, repeat=layers):
            merged = tuple((name, round(size, 12)) for name, size in _runs(stack))
            found.setdefault(merged, stack)
    return list(found.values())


def _check_count(kinds: int, layers: int) -> None:
    """Refuse nothing to choose from, and more stacks than may be tried."""
    if not kinds:
        raise InputError("--thickness", MISSING, "at least one material and one thickness")
    if not 0 <= layers <= 10:
        raise InputError("--layers", layers, "a whole number from 0 to 10")
    count = sum(kinds**k for k in range(layers + 1))
    if count > MOST_CANDIDATES:
        hint = "take fewer materials, thicknesses or layers"
        raise InputError("--layers", f"{layers} of {kinds} gaskets: {count} stacks", f"at most {MOST_CANDIDATES}", hint)


def _runs(sheets: Sheets) -> Iterator[tuple[str, float]]:
    """Yield material and whole thickness of neighbours of one material."""
    for name, group in groupby(sheets, key=lambda sheet: sheet.material):
        yield name, sum(sheet.thickness.si for sheet in group)


def design_buffer(
    seat: Seat, blows: Blows, choice: Choice, goal: Goal, progress: Callable[[float], None] | None = None
) -> BufferStudy:
    """Rank all stacks of a choice for a sensor, a blow, and a limit on what it may read.

    Parameters
    ----------
    seat : Seat
        The sensor.
    blows : Blows
        The blow, and the others of its run, which the best stack is tried on too.
    choice : Choice
        What stacks may be made of.
    goal : Goal
        The limit, and what decides among those that keep it.
    progress : callable, optional
        Called with the share done, 0 to 1.

    Raises
    ------
    InputError, InputErrors
        If there are too many stacks, or the sensor's recorder does not fit the history.
    """
    found, skipped, every = [], 0, stacks(choice)
    for k, sheets in enumerate(every):
        if _too_large(seat.mounting(sheets)):
            skipped += 1
        else:
            found.append(assess(seat, sheets, blows.motion, goal))
        if progress is not None:
            progress((k + 1) / len(every))
    study = BufferStudy(seat, blows, goal, _looked_at(found, seat, blows.motion, goal), (), _present(seat, blows, goal))
    return dataclasses.replace(study, warnings=(*blows.warnings, *study_notices(study, skipped)))


def _present(seat: Seat, blows: Blows, goal: Goal) -> Candidate | None:
    """Return what the sensor reads on the buffer that the case has now."""
    if seat.present is None or _too_large(seat.present.mounting):
        return None
    return assess_mounting(seat, seat.present.mounting, blows.motion, goal, seat.present.name)


def _looked_at(found: Sequence[Candidate], seat: Seat, motion: Motion, goal: Goal) -> tuple[Candidate, ...]:
    """Return candidates ranked, the first distinct ones and the front with what is found only of them."""
    order = ranked(with_front(found), goal)
    chosen = distinct(order, LEADING) + [one for one in order if one.pareto and one.keeps]
    if goal.rank == "robust":
        chosen += _withstanding(order, seat, motion, goal)
    closer = {id(one): look_closer(seat, one, motion, goal) for one in dict.fromkeys(chosen)}
    return tuple(ranked([closer.get(id(one), one) for one in order], goal))


def _withstanding(order: Sequence[Candidate], seat: Seat, motion: Motion, goal: Goal) -> list[Candidate]:
    """Return the first distinct ones of a ranking that keep the limit with all moduli, `LEADING` at most."""
    found: list[Candidate] = []
    for one in order:
        if len(found) == LEADING:
            break
        if not any(alike(one, other) for other in found) and withstands(seat, one, motion, goal):
            found.append(one)
    return found


def _too_large(mounting: Mounting) -> bool:
    try:
        return mounting_system(mounting).b.size > MOST_STATES
    except ValueError:
        return True
