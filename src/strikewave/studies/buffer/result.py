"""Result of a buffer design: ranked stacks, their tables and documents, and what there is to know of them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any, ClassVar

import tomlkit

from strikewave.base import declare
from strikewave.base.citations import FROM_MEMORY, citation
from strikewave.base.constants import STANDARD_GRAVITY, material
from strikewave.base.declare import KEY, MAIN, NO_UNIT, Quantity
from strikewave.base.errors import IntegrationError
from strikewave.base.quantities import Value
from strikewave.base.result import FAILED, INFO, Notice, Source
from strikewave.base.shock_quantities import BANDWIDTH, MASS, RATIO
from strikewave.base.texts import percent, plain
from strikewave.cases.case import Case, dump_case
from strikewave.cases.stack_of_case import memory_notices
from strikewave.contact import AnyContact
from strikewave.contact.cushions import Pad, carried, elastomer, retardation_of, retarded
from strikewave.reporting.columns import HISTORY_DIGITS, Column, csv_table
from strikewave.reporting.faces import columns_of
from strikewave.reporting.measured_files import UNKNOWN
from strikewave.reporting.numbers import hertz
from strikewave.reporting.shown_result import Curve, ShownResult, history_curve
from strikewave.sensors import SensorReading
from strikewave.sensors.mounting import RESOLVED
from strikewave.sensors.trial import SensorChannel, channel_notices, sensor_pulse, sensor_sources
from strikewave.studies.buffer.mounting_site import (
    BaseMotion,
    Blows,
    MountingSite,
    case_with,
    confined,
    reading_of,
    spread,
    table_with,
)
from strikewave.studies.buffer.stacks import (
    CUT_OFF,
    READING,
    SHOWN_PERIODS,
    BufferCandidate,
    BufferGoal,
    carries,
    slowest_shown,
    true_peak,
)

MARKED = "*: Pareto-optimal in peak and bandwidth"
"""Meaning of the mark of a place."""


@declare.dataclass
class GasketMaterial:
    """The material of a gasket, and how well its moduli are known."""

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
        Mounting site of the sensor.
    blows : Blows
        The motion of the surface below it.
    goal : BufferGoal
        Goal that the reading must keep.
    case : Case or None
        Case of sensor and blow.
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
        """The number of stacks that keep the limit, of all."""
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
        used = {layer.material: material(layer.material) for candidate in self.candidates for layer in candidate.stack}
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
        """The statements about the test: those of the case, or those asked for."""
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
        """True if no stack keeps the limit."""
        return self.best is None

    @property
    def order(self) -> str:
        """The order of the ranking in words, with a note where nothing is robust, or carries the pulse."""
        if not any(candidate.keeps for candidate in self.candidates):
            return "first by peak"
        order = f"first by {self.goal.rank}"
        if self.goal.rank == "robust":
            none = "none is known to be robust: first by bandwidth"
            order = none if self.robust is None else "the robust first, then by bandwidth"
        return order if carries(self.candidates[0], self.motion.width) else f"{order}; none carries the pulse"

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

    def reading(self, candidate: BufferCandidate) -> SensorReading:
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
        yes_or_no = {True: "yes", False: "no"}
        columns = [
            column._replace(values=[yes_or_no[v] if isinstance(v, bool) else v for v in column.values])
            for column in self.columns()
        ]
        return {"buffers.csv": csv_table(columns, HISTORY_DIGITS)}


def stack_columns(table: str, stacks: Sequence[BufferCandidate]) -> list[Column]:
    """Return the columns of a table of stacks, on the "screen", the "page", or of other "moduli".

    That readings are cut off is said only where one is.
    """
    cut = any(stack.clipped for stack in stacks)
    return [column for column in columns_of(BufferCandidate, stacks, table) if cut or column.name != CUT_OFF]


LARGE_STRAIN = 0.1
"""Compression of a gasket over its thickness beyond which the modulus of small strain is outside its range: a
neo-Hookean rubber, s = E/3 (l - 1/l^2), is 12 % stiffer there."""
FITTED_LOSS = 0.05
"""Deviation of the loss factor over its band beyond which it is warned of: the height of the resonance errs by as
much. Chosen: 5 %, as `strikewave.studies.buffer.stacks.ALIKE`, within which stacks count as the same."""
COARSE = 0.02
"""Share of the limit beyond which a step of the recorder's bits is warned of: rounding then moves a peak at the limit
by up to 1 %."""


def _g(acceleration: float) -> str:
    """Write an acceleration in g."""
    return f"{acceleration / STANDARD_GRAVITY:.0f}\xa0g"


def study_notices(study: BufferStudy, skipped: int) -> Iterator[Notice]:
    """Yield what to know of the search, of the first stack, and of its materials."""
    if skipped:
        message = f"{skipped} stacks are left out: too many wavelengths thick, each would take seconds to try"
        yield Notice("stack-left-out", message, float(skipped), 0.0, severity=INFO)
    first, limit = study.candidates[0], study.goal.limit
    if study.broken:
        yield _why_none(study)
    if first.stack:
        yield from _pulse_lost(study, first)
        yield from _gasket_notices(study, first)
    yield from _other_blows(study, first)
    reading = study.reading(first)
    pulses = [{study.first_channel.sensor.name: sensor_pulse(reading)}]
    yield from channel_notices([study.first_channel], pulses, study.blows.assembly_mass)
    yield from memory_notices(study.site.table)
    if not first.whole:
        message = (
            f"the history ends {plain(study.motion.after_peak * 1e6, 4)}\xa0us after the surface's largest value, "
            "before "
            f"{first.name} has swung to one side at {plain(first.band.resonance, 4)}\xa0Hz: its largest reading "
            "may come later"
        )
        yield Notice("short-history", message, study.motion.after_peak, SHOWN_PERIODS / first.band.resonance)
    if reading.quantum > COARSE * limit:
        message = f"a step of the recorder is {_g(reading.quantum)} for a limit of {_g(limit)}: take a smaller range"
        yield Notice("coarse-steps", message, reading.quantum, COARSE * limit)
    yield from _not_robust(study, first)


def _pulse_lost(study: BufferStudy, first: BufferCandidate) -> Iterator[Notice]:
    """Yield whether the first stack passes too little of the pulse to show it."""
    width, passed = study.motion.width, first.band.within_10
    if not carries(first, width):
        message = (
            f"{first.name} passes within 10 % only up to {plain(passed)}\xa0Hz, and a pulse of "
            f"{plain(width * 1e6, 4)}\xa0us "
            f"needs about {plain(1.0 / width, 4)}\xa0Hz, one over its width: the reading is the buffer's own "
            "swing; it tells that the sensor survives, not what the pulse was"
        )
        yield Notice("pulse-lost", message, passed, 1.0 / width)


def _not_robust(study: BufferStudy, first: BufferCandidate) -> Iterator[Notice]:
    """Yield whether the first stack keeps the limit with the moduli of the table only."""
    leading, limit = first.leading, study.goal.limit
    if leading is None or not first.keeps or leading.robust:
        return
    most = max(leading.softer, leading.stiffer, leading.confined or 0.0)
    if most <= limit:
        what = "a modulus between, or no slip at other moduli, breaks the limit, or the history is too short to tell"
    else:
        what = f"the sensor reads up to {_g(most)}"
    ends = {name: spread(material(name)) for name in dict.fromkeys(layer.material for layer in first.stack)}
    tried = ", ".join(f"{name} {low:g} to {high:g} times" for name, (low, high) in ends.items())
    message = f"{first.name} is not sure to keep the limit ({tried} the modulus of the table, slip or none): {what}; "
    if study.robust is not None:
        message += f"measure the gaskets, or take {study.robust.name}, which is robust (--rank robust)"
    elif study.goal.rank == "robust":
        slowest = slowest_shown(first.stack, study.motion)
        message += (
            "measure the gaskets, or try thicker ones; no stack is known to be robust, which takes a history of half a "
            "period of the softest: this one is long enough for stacks like this that ring above "
            f"{plain(slowest)}\xa0Hz"
        )
    else:
        message += "measure the gaskets, or look for a robust stack with --rank robust"
    yield Notice("not-robust", message, most, limit)


def _why_none(study: BufferStudy) -> Notice:
    """Return the notice that no stack keeps the limit: which comes nearest, and what stands against it."""
    first, motion, limit = study.candidates[0], study.motion, study.goal.limit
    value = first.true_peak
    bound = study.site.range if first.clipped else limit
    message = (
        f"no stack keeps {_g(limit)}: the nearest, {first.name}, gives {_g(value)} at the "
        f"{'element' if first.clipped else 'reading'}"
    )
    if first.clipped and value > bound:
        message += f", beyond the range of {_g(bound)}"
    if motion.rigid_peak is not None and abs(motion.rigid_peak) > limit:
        message += (
            f"; the rigid-body pulse itself has {_g(abs(motion.rigid_peak))}, so that a buffer "
            "that keeps the limit no longer reads it"
        )
    return Notice("limit-not-kept", message + "; try softer or thicker gaskets, or more layers", value, bound, FAILED)


def _gasket_notices(study: BufferStudy, first: BufferCandidate) -> Iterator[Notice]:
    """Yield limits that the gaskets of the first stack exceed, and materials whose numbers are from memory."""
    assert first.leading is not None
    for layer, stress, strain in zip(first.stack, first.leading.stress, first.leading.strain, strict=True):
        strength = material(layer.material).yield_strength
        if strength is not None and stress > strength:
            message = (
                f"{layer} carries {plain(stress / 1e6)}\xa0MPa, beyond its yield strength of "
                f"{plain(strength / 1e6)}\xa0MPa"
            )
            yield Notice("gasket-yield", message, stress, strength)
        if strain > LARGE_STRAIN:
            message = f"{layer} is compressed by {percent(strain, 0)}: its modulus is that of small strain; it stiffens"
            message += _hardened(study, first)
            yield Notice("gasket-strain", message, strain, LARGE_STRAIN)
    if first.loss_error > FITTED_LOSS:
        message = f"the loss factor of {first.name} deviates by up to {percent(first.loss_error, 0)} over its band"
        yield Notice("loss-fit", message, first.loss_error, FITTED_LOSS)
    elastic = [spread(material(layer.material))[1] for layer in first.stack]
    factors = confined(first.stack, study.site.area)
    stiffer, usual = max(zip(factors, elastic, strict=True), key=lambda pair: pair[0] / pair[1])
    if stiffer > usual:
        message = (
            f"the elastomer is thin for its width: where its faces cannot slip it is up to {plain(stiffer)} times as "
            "stiff as computed (Gent & Lindley); the column no slip shows what is then read"
        )
        yield Notice("elastomer-confined", message, stiffer, usual)
    for name in dict.fromkeys(layer.material for layer in first.stack):
        row = material(name)
        if row.status == FROM_MEMORY:
            yield Notice("material-from-memory", f"{name}: {row.note}", 1.0, 0.0, severity=INFO)


def _hardened(study: BufferStudy, first: BufferCandidate) -> str:
    """Return in words what the mass of the sensor would reach on a neo-Hookean pad instead of a single elastomer."""
    row = material(first.stack[0].material)
    if len(first.stack) > 1 or row.kind != "elastomer":
        return ""
    site, (layer,) = study.site, study.site.mounting(first.stack).gaskets
    free: AnyContact = elastomer(Pad(layer.area, layer.thickness), layer.modulus, shape_factor=0.0)
    if layer.loss_factor > 0.0:
        free = retarded(free, retardation_of(layer.loss_factor, first.band.resonance))
    try:
        mass = carried(free, site.mass + 0.5 * layer.mass, study.motion.acceleration, study.motion.step)
    except IntegrationError:
        return "; as a neo-Hookean pad it would bottom out"
    return f"; on a neo-Hookean pad that lies loose, the sensor's mass would reach {_g(float(mass.acceleration.max()))}"


def _other_blows(study: BufferStudy, first: BufferCandidate) -> Iterator[Notice]:
    """Yield whether the first stack breaks the limit in another blow of the run."""
    others = [motion for motion in study.blows.motions if motion is not study.motion]
    readings = [(reading_of(study.site, first.stack, motion), motion.name) for motion in others]
    peaks = [(true_peak(reading), reading.clipped, name) for reading, name in readings]
    worst, clipped, name = max((p for p in peaks if p[1] or p[0] > study.goal.limit), default=(0.0, False, ""))
    if first.keeps and worst > 0.0:
        message = f"in {name} the sensor reads {_g(worst)} with {first.name}: try --blow"
        if clipped:
            message = f"in {name} the element reaches {_g(worst)} with {first.name}, and is cut off: try --blow"
        yield Notice("other-blow", message, worst, min(study.goal.limit, study.site.range))
