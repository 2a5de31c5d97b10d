"""Result of a buffer design: candidates in their order, tables, documents."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, ClassVar

import tomlkit

from strikewave.base import declare
from strikewave.base.citations import citation
from strikewave.base.constants import material
from strikewave.base.declare import KEY, MAIN, NO_UNIT, Quantity
from strikewave.base.quantities import Value
from strikewave.base.result import Source
from strikewave.base.shock_quantities import BANDWIDTH, MASS, RATIO
from strikewave.cases.case import Case, dump_case
from strikewave.reporting.columns import HISTORY_DIGITS, Column, csv_table
from strikewave.reporting.faces import columns_of
from strikewave.reporting.measured_files import UNKNOWN
from strikewave.reporting.numbers import hertz
from strikewave.reporting.shown_result import Curve, ShownResult, history_curve
from strikewave.sensors import Reading
from strikewave.sensors.mounting import RESOLVED
from strikewave.sensors.trial import SensorChannel, sensor_sources
from strikewave.studies.buffer.candidate import CUT_OFF, READING, BufferCandidate, BufferGoal, carries
from strikewave.studies.buffer.mounting_site import (
    BaseMotion,
    Blows,
    MountingSite,
    case_with,
    reading_of,
    spread,
    table_with,
)

MARKED = "*: Pareto-optimal in peak and bandwidth"
"""Meaning of the mark of a place."""


@declare.dataclass
class GasketMaterial:
    """What is known of the material of a gasket."""

    status: str = declare.word("how the moduli are known")
    source: str = declare.word("from whom")
    note: str = declare.word("what is said of them")
    moduli: tuple[float, float] = declare.history(
        NO_UNIT, "[lowest, highest] modulus that is tried, over that of the table"
    )


@declare.dataclass
class BufferedSensor:
    """The sensor that the stacks are under."""

    name: str = declare.word("the sensor", label="sensor", column=KEY)
    mass: float = declare.number(MASS, "its mass", column=MAIN)
    area: float = declare.number(Quantity("m^2", "mm^2", "area of the gaskets"), "area of the gaskets", column=MAIN)
    resonance: float = declare.number(BANDWIDTH, "its resonance", label="resonance of the element", column=MAIN)
    quality: float = declare.number(RATIO, "quality factor of that")
    range: float = declare.number(Quantity("m/s^2", "g"), "its range", column=MAIN)
    sampling_rate: float = declare.number(BANDWIDTH, "of its recorder", column=MAIN)


@declare.dataclass(eq=False)
class BufferStudy(ShownResult):
    """Ranked stacks for one sensor and one blow, beside the buffer that the case has now; see `design_buffer`.

    See `Result` for what it shares with others; beside what documents have:

    Attributes
    ----------
    site : MountingSite
        Where the sensor sits.
    blows : Blows
        The motion of the surface below it.
    goal : BufferGoal
        Goal that the reading must keep.
    case : Case or None
        Where sensor and blow come from.
    origin : Source or None
        The command line and the record, where the blow is no case's.
    asked : str
        Command line that gives it again, where one does.
    """

    command: ClassVar[str] = "buffer"
    main_rows: ClassVar[str] = "stacks"

    site: MountingSite
    blows: Blows
    goal: BufferGoal

    limit = declare.computed(declare.number(Quantity("m/s^2", "g"), "largest allowed reading", headline="limit"))(
        lambda one: one.goal.limit
    )
    rank = declare.computed(declare.word("what ranks the stacks that keep it: bandwidth, peak or robust"))(
        lambda one: one.goal.rank
    )

    @declare.computed(declare.word("how many stacks keep it", headline="stacks that keep the limit", in_document=False))
    def keeping(self) -> str:
        """How many of the stacks keep the limit."""
        return f"{sum(candidate.keeps for candidate in self.candidates)} of {len(self.candidates)}"

    kept = declare.computed(declare.word("whether one keeps it"))(lambda one: not one.broken)
    robust_name = declare.computed(
        declare.word("the first stack that keeps it with all moduli within their spread; null for none", key="robust")
    )(lambda one: None if one.robust is None else one.robust.name)
    back_effect = declare.computed(declare.word("what the sensor does to the motion of the surface, in words"))(
        lambda one: "none: the motion of the surface is given, the sensor does not load it back"
    )
    sources = declare.computed(declare.word("sources of the models"))(
        lambda one: [citation(key) for key in (*sensor_sources([one.first_channel]), "gent-lindley-1959")]
    )

    @declare.computed(declare.named(GasketMaterial, "materials of the gaskets"))
    def materials(self) -> dict[str, GasketMaterial]:
        """The materials, in the order in which stacks have them."""
        used = {layer.material: material(layer.material) for one in self.candidates for layer in one.stack}
        return {name: GasketMaterial(row.status, row.source, row.note, spread(row)) for name, row in used.items()}

    @declare.computed(declare.part(BufferedSensor, "the sensor"))
    def sensor(self) -> BufferedSensor:
        """The sensor, and the area below it."""
        site, sensor = self.site, self.site.channel.sensor
        held = sensor.resonance, sensor.quality, sensor.range, site.channel.recorder.sampling_rate
        return BufferedSensor(site.table.name, site.mass, site.area, *held)

    motion = declare.computed(declare.part(BaseMotion, "the blow", key="blow", label="blow"))(
        lambda one: one.blows.motion
    )

    present: BufferCandidate | None = declare.part(
        BufferCandidate, "the buffer that the case has now; null without one"
    )
    candidates: tuple[BufferCandidate, ...] = declare.rows(
        BufferCandidate, "the stacks, the best first", headline="first"
    )
    stacks = declare.computed(
        declare.rows(BufferCandidate, "all of them, and the present one last", in_document=False)
    )(lambda one: [*one.candidates, *([] if one.present is None else [one.present])])

    @declare.computed(
        declare.word(
            "up to where the first one passes amplitudes",
            headline="amplitude within 10 % up to, first",
            in_document=False,
        )
    )
    def bandwidth(self) -> str:
        """Frequency up to which the first stack passes amplitudes within 10 %; it is sought up to `RESOLVED`."""
        within_10 = self.candidates[0].band.within_10
        return hertz(within_10) if math.isfinite(within_10) else f"{hertz(RESOLVED)} and beyond"

    direct_peak = declare.computed(
        declare.number(
            Quantity("m/s^2", "g"), "without any gasket", headline="reading without gaskets", in_document=False
        )
    )(lambda one: one.direct.true_peak)

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

    def preview(self) -> Curve:
        """Return what the sensor reads on the first stack."""
        reading = self.reading(self.candidates[0])
        return history_curve(reading.time, reading.values, *READING.units, f"reading on {self.candidates[0].name}")

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


def stack_columns(table: str, stacks: Sequence[BufferCandidate]) -> list[Column]:
    """Return the columns of a table of stacks, on the "screen", the "page", or of other "moduli".

    That readings are cut off is said only where one is.
    """
    cut = any(one.clipped for one in stacks)
    return [column for column in columns_of(BufferCandidate, stacks, table) if cut or column.name != CUT_OFF]
