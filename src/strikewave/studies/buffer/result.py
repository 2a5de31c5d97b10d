"""Result of a buffer design: candidates in their order, tables, documents."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import tomlkit

from strikewave.base.citations import citation
from strikewave.base.json_document import without
from strikewave.base.materials import material
from strikewave.base.quantities import Value
from strikewave.base.result import Source
from strikewave.cases.case import Case
from strikewave.cases.written_case import dump_case
from strikewave.reporting.columns import HISTORY_DIGITS, Column, csv_table
from strikewave.reporting.measured_files import UNKNOWN
from strikewave.reporting.numbers import with_unit
from strikewave.reporting.shown_result import Curve, ShownResult, history_curve
from strikewave.sensors import Reading
from strikewave.sensors.channel import SensorChannel, sensor_sources
from strikewave.studies.buffer.candidate import (
    BufferCandidate,
    BufferGoal,
    Leading,
    carries,
)
from strikewave.studies.buffer.moduli import spread
from strikewave.studies.buffer.mounting_site import BaseMotion, Blows, MountingSite, case_with, reading_of, table_with

UNITS = {
    "limit": "m/s^2", "mass": "kg", "area": "m^2", "resonance": "Hz", "quality": "1", "range": "m/s^2",
    "sampling_rate": "Hz", "surface_peak": "m/s^2", "surface_velocity_change": "m/s", "rigid_peak": "m/s^2",
    "largest_sample": "m/s^2",
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
"""Attributes of a `BufferCandidate` that a row of the document and of the table holds under their own names."""


@dataclass(frozen=True, eq=False)
class BufferStudy(ShownResult):
    """Ranked stacks for one sensor and one blow, beside the buffer that the case has now; see `design_buffer`.

    See `Result` for what it shares with others.

    Attributes
    ----------
    site : MountingSite
        Where the sensor sits.
    blows : Blows
        The motion of the surface below it.
    goal : BufferGoal
        What the reading must keep.
    candidates : tuple of BufferCandidate
        The stacks, the best first.
    present : BufferCandidate or None
        The buffer that the case has now.
    case : Case or None
        Where sensor and blow come from.
    origin : Source or None
        The command line and the record, where the blow is no case's.
    asked : str
        Command line that gives it again, where one does.
    """

    command: ClassVar[str] = "buffer"

    site: MountingSite
    blows: Blows
    goal: BufferGoal
    candidates: tuple[BufferCandidate, ...]
    present: BufferCandidate | None = None
    case: Case | None = None
    origin: Source | None = None
    asked: str = ""

    @property
    def title(self) -> str:
        """Sensor and blow."""
        return f"{self.site.table.name}: {self.motion.name}"

    @property
    def test(self) -> Mapping[str, str]:
        """What the case says of the test, or what was asked."""
        return self.case.test.stated() if self.case else (self.origin or UNKNOWN).test

    @property
    def source(self) -> Source:
        """The case with the first stack under its sensor; of a measured blow, what was asked of which file."""
        if self.case is not None:
            case = case_with(self.case, self.site, self.candidates[0].stack)
            return Source("case", self.case.name, dump_case(case), asked=self.asked)
        return self.origin or UNKNOWN

    @property
    def motion(self) -> BaseMotion:
        """The blow that the stacks are designed for."""
        return self.blows.motion

    @property
    def best(self) -> BufferCandidate | None:
        """First of the ranking that keeps the limit; None where none does."""
        return self.candidates[0] if self.candidates[0].keeps else None

    @property
    def broken(self) -> bool:
        """Whether no stack keeps the limit."""
        return self.best is None

    @property
    def order(self) -> str:
        """What the ranking goes by, in words; that nothing is robust, or carries the pulse, is said here too."""
        if not any(candidate.keeps for candidate in self.candidates):
            return "first by peak"
        words = f"first by {self.goal.rank}"
        if self.goal.rank == "robust":
            none = "none is known to be robust: first by bandwidth"
            words = none if self.robust is None else "the robust first, then by bandwidth"
        return words if carries(self.candidates[0], self.motion.width) else f"{words}; none carries the pulse"

    @property
    def robust(self) -> BufferCandidate | None:
        """First of the ranking that is known to keep the limit whatever the moduli; None where none is."""
        return next((candidate for candidate in self.candidates if candidate.robust), None)

    @property
    def first_channel(self) -> SensorChannel:
        """The sensor on the first stack, and its recorder."""
        mounting = self.site.mounting(self.candidates[0].stack)
        return self.site.channel._replace(sensor=self.site.sensor(mounting))

    @property
    def direct(self) -> BufferCandidate:
        """The sensor without gaskets."""
        return next(candidate for candidate in self.candidates if not candidate.stack)

    def reading(self, candidate: BufferCandidate) -> Reading:
        """Return what the recorder keeps with a stack."""
        return reading_of(self.site, candidate.stack, self.motion)

    @property
    def label(self) -> str:
        """The title: sensor and blow."""
        return self.title

    def highlights(self) -> list[tuple[str, str]]:
        """Return how many stacks keep the limit, and the first one with its reading and bandwidth."""
        first, kept = self.candidates[0], sum(candidate.keeps for candidate in self.candidates)
        limit = with_unit(self.goal.limit, "m/s^2", "g")
        return [
            (f"stacks that keep {limit}", f"{kept} of {len(self.candidates)}"),
            ("first", first.name),
            ("its peak", with_unit(first.true_peak, "m/s^2", "g")),
            ("bandwidth within 10 %", with_unit(first.band.within_10, "Hz", "kHz", 3)),
        ]

    def preview(self) -> Curve:
        """Return what the sensor reads on the first stack."""
        reading = self.reading(self.candidates[0])
        return history_curve(reading.time, reading.values, "m/s^2", "g", f"reading on {self.candidates[0].name}")

    def units(self) -> dict[str, str]:
        """Return the unit of each key of the JSON document."""
        return UNITS

    def content(self) -> dict[str, Any]:
        """Return what the JSON document holds beside its head."""
        motion, sensor = self.motion, self.site.channel.sensor
        blow = {
            "name": motion.name,
            "surface_peak": motion.peak,
            "largest_sample": motion.largest_sample,
            "surface_velocity_change": motion.surface_change,
            "rigid_peak": motion.rigid_peak,
            "pulse_width": motion.width,
            "duration": motion.step * (motion.acceleration.size - 1),
        }
        sensor_row = {
            "name": self.site.table.name,
            "mass": self.site.mass,
            "area": self.site.area,
            **{key: getattr(sensor, key) for key in ("resonance", "quality", "range")},
            "sampling_rate": self.site.channel.recorder.sampling_rate,
        }
        rows = [_row(place, candidate) for place, candidate in enumerate(self.candidates, 1)]
        used = {layer.material: material(layer.material) for c in self.candidates for layer in c.stack}
        origin = {
            name: {"status": row.status, "source": row.source, "note": row.note, "moduli": spread(row)}
            for name, row in used.items()
        }
        return {
            "limit": self.goal.limit,
            "rank": self.goal.rank,
            "kept": not self.broken,
            "robust": None if self.robust is None else self.robust.name,
            "back_effect": "none: the motion of the surface is given, the sensor does not load it back",
            "sources": [citation(key) for key in (*sensor_sources([self.first_channel]), "gent-lindley-1959")],
            "materials": origin,
            "sensor": sensor_row,
            "blow": blow,
            "present": None if self.present is None else without(_row(None, self.present), "place", "gaskets"),
            "candidates": rows,
        }

    def texts(self) -> dict[str, str]:
        """Return the JSON document and, where there is no case, the sensor with the first stack under it, as files."""
        sensor = {} if self.case is not None else {"sensor.toml": self._sensor_text()}
        return {**sensor, "buffer.json": self.document_text()}

    def _sensor_text(self) -> str:
        """Return the [[sensor]] of a case with the first stack under it."""

        def typed(fields: Iterable[tuple[str, Any]]) -> dict[str, Any]:
            return {key: value.typed if isinstance(value, Value) else value for key, value in fields if value}

        table = table_with(self.site, self.candidates[0].stack)
        row = {**typed(table), "gasket": [typed(layer) for layer in table.gasket]}
        return tomlkit.dumps({"sensor": [row]})

    def tables(self) -> dict[str, str]:
        """Return all candidates as CSV text; yes or no of what is true or not."""
        words = {True: "yes", False: "no"}
        columns = [
            column._replace(values=[words[v] if isinstance(v, bool) else v for v in column.values])
            for column in self.columns()
        ]
        return {"buffers.csv": csv_table(columns, HISTORY_DIGITS)}

    def columns(self) -> list[Column]:
        """Return all candidates, the best first; last, without a place, the present buffer."""
        rows = [_row(place, candidate) for place, candidate in enumerate(self.candidates, 1)]
        rows += [] if self.present is None else [_row(None, self.present)]
        keys = [key for key in rows[0] if key not in ("gaskets", "stress", "strain")]
        return [Column(key, [row[key] for row in rows], UNITS.get(key, "")) for key in keys]

    def brief(self) -> dict[str, str]:
        """Return place, gaskets, reading, whether it keeps the limit, bandwidth and resonance."""
        bands = dict.fromkeys(("within_10", "resonance"), "kHz")
        return {"place": "", "name": "", "true_peak": "g", "keeps": "", **bands, "robust": ""}


def _row(place: int | None, candidate: BufferCandidate) -> dict[str, Any]:
    """Return a candidate as one flat row."""
    own = {key: getattr(candidate, key) for key in _OWN}
    leading = {f.name: getattr(candidate.leading, f.name, None) for f in dataclasses.fields(Leading)}
    gaskets = [{"material": layer.material, "thickness": layer.thickness.si} for layer in candidate.stack]
    return {
        "place": place,
        "name": candidate.name,
        "gaskets": gaskets,
        **own,
        **candidate.band._asdict(),
        **leading,
    }
