"""What a buffer design found: candidates in their order, tables, documents."""

from __future__ import annotations

import csv
import dataclasses
import io
import math
from dataclasses import dataclass
from typing import Any

from strikewave.base.citations import citation
from strikewave.base.json_document import head, plain, without
from strikewave.base.materials import material
from strikewave.base.result import Notice
from strikewave.sensors import Reading
from strikewave.sensors.channel import Channel, sensor_sources
from strikewave.studies.buffer.candidate import (
    Candidate,
    Goal,
    Leading,
)
from strikewave.studies.buffer.moduli import spread
from strikewave.studies.buffer.seat import Blows, Motion, Seat, reading_of

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
_OWN = (
    "height", "peak", "width", "clipped", "element_peak", "true_peak", "keeps", "margin", "pareto", "rigid_ratio",
    "velocity_error", "ringing", "loss_error", "sag", "whole",
)  # fmt: skip


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


def _cell(value: Any) -> Any:
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return "" if math.isnan(value) else f"{value:.9g}"
    return value
