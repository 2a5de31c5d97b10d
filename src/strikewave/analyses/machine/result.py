"""The solution of a case: histories with units as an xarray Dataset, and tables.

The dataset holds the whole train (dimension ``time``, from the valve signal or the start), each blow in detail
(``blow`` by ``pulse_time``, from first touch), what an ideal recorder would have stored
(``record_time``), and the table of blows.
"""

from __future__ import annotations

import dataclasses
import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import field
from itertools import pairwise
from pathlib import Path
from statistics import median
from typing import TYPE_CHECKING, Any, ClassVar, Protocol

import numpy as np
from numpy.typing import NDArray

from strikewave._version import __version__
from strikewave.analyses.machine.kind import MachineKind, kind_of
from strikewave.analyses.machine.readings import BlowReading
from strikewave.base import declare
from strikewave.base.datasets import LabelledArrays, open_result
from strikewave.base.declare import KEY, MAIN, MORE, NO_UNIT, Quantity
from strikewave.base.errors import InputError
from strikewave.base.result import SCHEMA, Band, BandMethod, Comparison, Notice
from strikewave.base.shock_quantities import (
    ACCELERATION,
    KILOGRAMS,
    MASS,
    MICROSECONDS,
    PEAK_FORCE,
    PUBLISHED_QUANTITIES,
    PULSE_WIDTH,
    RATIO,
    RESTITUTION,
    RIGID_PEAK,
    VELOCITY,
    VELOCITY_CHANGE,
)
from strikewave.base.texts import first_few
from strikewave.cases.case import Case, parse_case
from strikewave.cases.contact_parts import ELASTIC, HIGH, LOW, WORTH_SHOWING, YIELDING
from strikewave.cases.tables.machine_kinds import KINDS
from strikewave.machines import Blow
from strikewave.machines.blows import KINDS as BLOW_KINDS
from strikewave.reporting.case_result import CaseResult
from strikewave.reporting.columns import Column, csv_table, page_table
from strikewave.reporting.faces import amount, bands_below, columns_of, part_tables, text_of
from strikewave.reporting.numbers import listed, shown, shown_unit, spelled
from strikewave.reporting.parts import NONE, Table, written
from strikewave.reporting.shown_result import Curve, history_curve
from strikewave.sensors.trial import SensorPulse
from strikewave.waves.transit import LayerUsed, WaveSetup

if TYPE_CHECKING:
    import xarray


@declare.dataclass
class ContactAnswer:
    """The first blow with its contact elastic, or yielding at a largest pressure (None where elastic), SI."""

    name: str = declare.word("answer of the contact: elastic, or yielding at a largest pressure", column=KEY)
    yield_pressure: float | None = declare.number(
        Quantity("Pa", "GPa", "largest pressure", 3, 0), "that pressure; null where elastic", column=MORE
    )
    rigid_peak: float = declare.number(
        ACCELERATION, "peak of the rigid-body acceleration of the first blow then", band="rigid_peak", column=MAIN
    )
    peak_force: float = declare.number(PEAK_FORCE, "its largest contact force", column=MAIN)
    width: float = declare.number(PULSE_WIDTH, "its width at 10 % of the peak", band="width", column=MAIN)
    restitution: float = declare.number(
        Quantity(NO_UNIT, NO_UNIT, "coefficient of restitution", 3, 0), "its coefficient of restitution", column=MORE
    )


@declare.dataclass
class ContactAnswers:
    """The first blow by each answer of its contact.

    Beside what documents have:

    Attributes
    ----------
    rows : tuple of ContactAnswer
        From elastic to the highest pressure; the others stand beside the one taken where the contact yields.
    """

    asked_restitution: float = declare.number(RESTITUTION, "coefficient of restitution asked of the damping")
    first_yield: float | None = declare.number(
        Quantity("N", "N", digits=3),
        "load at which the weaker material first yields inside; null where it is not known",
    )
    taken: str = declare.word("name of the answer that the run took")
    rows: tuple[ContactAnswer, ...] = declare.rows(
        ContactAnswer, "the answers, from elastic to the highest pressure", key="answers"
    )

    def row(self, name: str) -> ContactAnswer | None:
        """Return an answer by its name; None where it was not found."""
        return next((row for row in self.rows if row.name == name), None)

    @declare.computed(declare.number(RATIO, "elastic peak force over that load"))
    def times_first_yield(self) -> float | None:
        """Elastic peak force over the load of first yield."""
        elastic = self.row(ELASTIC)
        return None if elastic is None or self.first_yield is None else elastic.peak_force / self.first_yield

    @property
    def spread(self) -> float:
        """Largest over smallest answer less 1, of the peak of acceleration or of force, whichever is more."""
        peaks = ([getattr(row, name) for row in self.rows] for name in ("rigid_peak", "peak_force"))
        return max(max(values) / min(values) - 1.0 if min(values) > 0.0 else 0.0 for values in peaks)

    @declare.computed(declare.number(RESTITUTION, "what came out of the first blow"))
    def restitution(self) -> float | None:
        """Coefficient of restitution of the answer that was taken."""
        taken = self.row(self.taken)
        return None if taken is None else taken.restitution

    @declare.computed(declare.word("whether the answers differ so much that all are shown"))
    def differ(self) -> bool:
        """Whether the answers differ by so much that all are shown."""
        return self.spread > WORTH_SHOWING

    @property
    def band(self) -> tuple[float, float] | None:
        """Least and largest rigid peak over what is known of the pressure, m/s^2; None where it was given."""
        if self.row(LOW) is None and self.row(HIGH) is None:
            return None
        peaks = [row.rigid_peak for row in self.rows if row.name != ELASTIC]
        return min(peaks), max(peaks)


INTERVAL = Quantity("s", "ms")
LINE_SPEED = Quantity("m/s", "m/s", decimals=4, digits=0)
SHOWN_WIDTHS = 2.2
"""Widths of the first blow that its curve lasts: the pulse, and as long again in which the object flies."""

HISTORIES = (
    "contact_force",
    "rigid_acceleration",
    "nose_position",
    "assembly_position",
    "assembly_speed",
    "turntable_speed",
    "pulse_force",
    "pulse_acceleration",
    "record_acceleration",
)
"""The histories of a solution."""


def histories_of(case: Case) -> set[str]:
    """Return the histories of a solution: without a turntable there is no speed of one."""
    return set(HISTORIES) - (set() if case.launched() is None else {"turntable_speed"})


@declare.dataclass
class RigidReference:
    """What the printed contact law would give on a rigid object, SI: see `strikewave.analyses.machine.run`."""

    approach_speed: float = declare.number(VELOCITY._replace(digits=3), "nominal speed of approach")
    peak_force: float = declare.number(PEAK_FORCE, "largest contact force")
    peak_acceleration: float = declare.number(ACCELERATION._replace(digits=3), "that over the mass of the object")
    duration: float = declare.number(MICROSECONDS._replace(digits=3), "how long both touch")

    @property
    def words(self) -> str:
        """The pulse in words."""
        return ", ".join(text_of(self, name) for name in ("duration", "peak_force", "peak_acceleration"))


@declare.dataclass
class LineCollision:
    """A collision of two bodies of an amplifier, SI."""

    time: float = declare.number(
        Quantity("s", "ms", decimals=4, digits=0), "time after the lowest met the floor", column=KEY
    )
    lower: str = declare.word("the lower body", column=KEY)
    upper: str = declare.word("the upper body", column=KEY)
    lower_before: float = declare.number(LINE_SPEED, "its speed before, upwards", column=MAIN)
    upper_before: float = declare.number(LINE_SPEED, "that of the upper one", column=MAIN)
    lower_after: float = declare.number(LINE_SPEED, "its speed after", column=MAIN)
    upper_after: float = declare.number(LINE_SPEED, "that of the upper one", column=MAIN)
    impulse: float = declare.number(Quantity("N s", "N s", digits=5), "impulse between them", column=MAIN)
    energy_lost: float = declare.number(Quantity("J", "J", digits=5), "energy that is lost", column=MAIN)


@declare.dataclass
class MachineLaunch:
    """How a machine without a drive came to first touch."""

    approach_speed: float = declare.number(
        Quantity("m/s", "m/s", digits=6), "speed at first touch", label="approach speed at first touch", column=MAIN
    )
    energy_released: float = declare.number(
        Quantity("J", "J", digits=6),
        "energy that was released",
        label="energy given on the way to first touch",
        column=MAIN,
    )
    energy_at_touch: float = declare.number(
        Quantity("J", "J", digits=6),
        "kinetic energy at first touch",
        label="kinetic energy of what meets, at first touch",
        column=MAIN,
    )
    gain: float = declare.number(
        RATIO,
        "of an amplifier: largest speed of the top body over the first approach speed",
        label="gain of the line: fastest speed of the object over that at the floor",
        column=MAIN,
    )


@declare.dataclass
class Phase:
    """A phase of a test."""

    name: str = declare.word("phase of the test, such as feed", label="phase", column=KEY)
    time: float = declare.number(Quantity("s", "s", "begins", 6, 0), "when it begins", column=MAIN)


@declare.dataclass
class ReadBlow:
    """A blow, and what taps and sensors show of it."""

    blow: Blow = declare.part(Blow, "the blow", inline=True)
    reading: BlowReading = declare.part(BlowReading, "what taps and sensors show", inline=True)
    route: str = declare.word("by which route the waves were followed", in_document=False)


@declare.dataclass
class SensedBlow:
    """A blow of an object without waves, and what sensors read of it."""

    blow: Blow = declare.part(Blow, "the blow", inline=True)
    sensors: dict[str, SensorPulse] = declare.named(SensorPulse, "what each sensor reads, by its name")


@declare.dataclass
class SensorOfBlow:
    """What a sensor reads of a blow."""

    blow: int = declare.count("number of the blow, from 1", column=KEY)
    name: str = declare.word("the sensor", label="sensor", column=KEY)
    pulse: SensorPulse = declare.part(SensorPulse, "what it reads")


@declare.dataclass
class Solution(CaseResult):
    """What a run gave; see `Result` for what it shares with others.

    Beside what documents have:

    Attributes
    ----------
    blows : sequence of Blow
        The table of blows.
    reference : RigidReference
        The printed law on a rigid object.
    readings : tuple of (BlowReading or None)
        Readings of taps and sensors, one a blow; None where it missed.
    phases : tuple of (str, float)
        Name and time (s) from the valve signal.
    sampled : LabelledArrays
        Histories and the table of blows, with units; `histories` and `data` are the xarray Dataset of them.
    collisions : tuple of LineCollision
        Collisions of the bodies of an amplifier, that of striker and object among them, by restitution alone.
    """

    command: ClassVar[str] = "run"
    table_name: ClassVar[str] = "blows"
    main_rows: ClassVar[str] = "read_blows"
    main_table: ClassVar[str] = "blows"
    may_have_bands: ClassVar[bool] = True

    blows: Sequence[Blow]
    masses: dict[str, float] = declare.number(MASS, "masses of striker, object and assembly, by these names")
    phases: tuple[tuple[str, float], ...]
    balance: dict[str, float] = declare.number(
        RATIO, "energy_error and momentum_error: what the balances miss, as shares of what flowed"
    )
    reference: RigidReference
    readings: tuple[BlowReading | None, ...]
    waves: WaveSetup | None = declare.part(
        WaveSetup, "how the waves of a struck stack were followed; null where the object is none"
    )
    sampled: LabelledArrays = field(repr=False, compare=False)
    launch: dict[str, float] | None = declare.part(
        MachineLaunch, "of a machine without a drive: how it came to first touch", default=None, optional=True
    )
    collisions: tuple[LineCollision, ...] = ()
    contact: ContactAnswers | None = declare.part(
        ContactAnswers, "the first blow with its contact elastic and yielding; null where none struck", default=None
    )

    @property
    def title(self) -> str:
        """The title of the case, with the fields in which it differs from the published one."""
        changed = self.case.changed_fields()
        values, words = self.case.values(), self.case.entries()
        now = {path: values[path].typed if path in values else words.get(path, "left out") for path in changed}
        shown = first_few([f"{path} = {now[path]}" for path in changed], 3)
        route = "" if self.case.solver.route == "exact" else f"; route {self.case.solver.route}"
        return (self.case.title or self.case.name) + (f"; here {shown}" if changed else "") + route

    @property
    def named_units(self) -> Mapping[str, str]:
        """Those of published numbers."""
        return {name: quantity.si for name, quantity in PUBLISHED_QUANTITIES.items()}

    @property
    def data_rows(self) -> str:
        """The blows with what sensors read of each, and with what taps show where waves were followed."""
        return "read_blows" if self.waves else "sensed_blows"

    @property
    def slides(self) -> bool:
        """Whether friction across the face acted in a blow."""
        return any(blow.friction_heat > 0.0 for blow in self.blows)

    @property
    def arrays(self) -> LabelledArrays:
        """Histories and the table of blows, with units."""
        return self.sampled

    @property
    def histories(self) -> xarray.Dataset:
        """Histories and the table of blows, with units in their attributes."""
        return self.data

    @declare.computed(declare.word("exact, or as printed: the paper's own"))
    def route(self) -> str:
        """By which route the waves were followed."""
        return self.case.solver.route

    @declare.computed(declare.rows(ReadBlow, "the blows", key="blows", band="first typical"))
    def read_blows(self) -> list[ReadBlow]:
        """The blows, with what taps and sensors show of each."""
        nothing = BlowReading(None, None, None, {})
        pairs = zip(self.blows, self.readings, strict=True)
        return [ReadBlow(blow, reading or nothing, self.route) for blow, reading in pairs]

    @declare.computed(declare.rows(SensedBlow, "the blows without what taps show", in_document=False))
    def sensed_blows(self) -> list[SensedBlow]:
        """The blows, with what sensors read of each."""
        return [SensedBlow(row.blow, row.reading.sensors) for row in self.read_blows]

    @declare.computed(
        declare.rows(ReadBlow, "blows that waves were followed of", band="first typical", in_document=False)
    )
    def wave_blows(self) -> list[ReadBlow]:
        """The blows with what taps show; none where the object is no stack."""
        return [row for row, seen in zip(self.read_blows, self.readings, strict=True) if seen and self.waves]

    @declare.computed(declare.rows(SensorOfBlow, "sensor readings", band="sensor.{name}", in_document=False))
    def sensor_rows(self) -> list[SensorOfBlow]:
        """What each sensor reads of each blow."""
        return [
            SensorOfBlow(row.blow.index, name, pulse)
            for row in self.read_blows
            for name, pulse in row.reading.sensors.items()
        ]

    @declare.computed(declare.rows(Phase, "phases of the test", key="phases"))
    def phase_rows(self) -> list[Phase]:
        """The phases, as rows."""
        return [Phase(*phase) for phase in self.phases]

    @declare.computed(
        declare.rows(LineCollision, "collisions of two bodies of an amplifier", key="collisions", optional=True)
    )
    def line(self) -> tuple[LineCollision, ...] | None:
        """The collisions of a machine without a drive; None of one with a drive."""
        return self.collisions if self.launch else None

    @declare.computed(declare.rows(Comparison, "comparison with published values"))
    def published(self) -> tuple[Comparison, ...]:
        """The comparisons, by the key of the JSON document."""
        return self.comparisons

    @property
    def figures(self) -> dict[str, float]:
        """The results that may have a band, by name, SI."""
        return {**figures_of(self.blows), **sensor_figures(self.readings)}

    @declare.computed(declare.rows(Blow, "blows that struck", label="blows", headline="count", in_document=False))
    def struck(self) -> list[Blow]:
        """The blows that touched the object."""
        return [blow for blow in self.blows if blow.kind != "missed"]

    @declare.computed(
        declare.part(Blow, "the first blow that struck", band="first", headline="first", in_document=False)
    )
    def first_blow(self) -> Blow | None:
        """The first blow that touched the object; None where none did."""
        return next(iter(self.struck), None)

    @declare.computed(
        declare.number(PEAK_FORCE, "its largest contact force", headline="first contact force", in_document=False)
    )
    def first_force(self) -> float | None:
        """The largest contact force of the first blow."""
        return None if self.first_blow is None else self.first_blow.peak_force

    @declare.phrase("range of a yielding contact", headline="first rigid peak, range of a yielding contact")
    def yielding_range(self) -> str | None:
        """Return between which peaks of the first blow the contact may yield; None where it does not matter."""
        if self.contact is None or not self.contact.differ or self.contact.band is None:
            return None
        low, high = (written(shown(peak, *ACCELERATION.units)) for peak in self.contact.band)
        return f"{low} to {high}\N{NO-BREAK SPACE}{spelled(shown_unit(*ACCELERATION.units))}"

    @declare.computed(
        declare.number(
            INTERVAL, "median time between blows", band="interval", headline="median interval", in_document=False
        )
    )
    def interval(self) -> float | None:
        """Median time between blows; None for fewer than two."""
        pairs = list(pairwise(self.struck))
        return median(later.time - earlier.time for earlier, later in pairs) if pairs else None

    @declare.computed(declare.count("how many blows were wanted", headline="blows wanted", in_document=False))
    def wanted(self) -> int | None:
        """How many blows were wanted; None of a machine without a feed."""
        return int(self.case.feed.blows.si) if self.case.feed else None

    def preview(self) -> Curve | None:
        """Return the rigid-body acceleration of the first blow over twice its width."""
        place = next((k for k, blow in enumerate(self.blows) if blow.kind != "missed"), None)
        if place is None:
            return None
        blow = self.blows[place]
        time, values = blow_history(self.arrays, place, "pulse_acceleration")
        kept = time <= (SHOWN_WIDTHS * blow.width if blow.width > 0.0 else time[-1])
        return history_curve(
            time[kept], values[kept], *ACCELERATION.units, f"rigid-body acceleration, blow {blow.index}"
        )

    def tables(self) -> dict[str, str]:
        """Return the table of blows as CSV text, every column with its unit."""
        return {"blows.csv": csv_table(self.columns())}

    def save(self, path: Path) -> None:
        """Write the whole solution as NetCDF; `load_solution` reads it back."""
        self._stored().write(path)

    def datasets(self) -> dict[str, LabelledArrays]:
        """Return the histories and, in its attributes, everything else that `load_solution` reads back."""
        return {"solution.nc": self._stored()}

    def _stored(self) -> LabelledArrays:
        state = {
            "masses": self.masses,
            "phases": self.phases,
            "balance": self.balance,
            "published": [dataclasses.asdict(c) for c in self.comparisons],
            "warnings": [dataclasses.asdict(n) for n in self.notices],
            "reference": dataclasses.asdict(self.reference),
            "readings": [dataclasses.asdict(r) if r else None for r in self.readings],
            "waves": dataclasses.asdict(self.waves) if self.waves else None,
            "citations": self.citations,
            "launch": self.launch,
            "collisions": [dataclasses.asdict(collision) for collision in self.collisions],
            "contact": dataclasses.asdict(self.contact) if self.contact else None,
            **self.band_content(),
        }
        attributes = {
            "strikewave_schema": SCHEMA,
            "strikewave_version": __version__,
            "case": self.source.text,
            "tables": json.dumps(state),
        }
        return self.arrays.with_attributes(attributes)


def blow_history(data: LabelledArrays, row: int, name: str) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return times after first touch, s, and values of a blow."""
    return data["pulse_time"].values, data[name].values[row]


def load_solution(path: Path | str) -> Solution:
    """Read a solution that `Solution.save` wrote, or the folder that holds ``solution.nc``.

    Parameters
    ----------
    path : Path or str
        The file, or the folder of a result.

    Returns
    -------
    Solution
        As it was saved.

    Raises
    ------
    InputError
        If the file is absent, not a solution of this version, damaged, or larger than 4 GB in memory.
    """
    path = Path(path)
    path = path / "solution.nc" if path.is_dir() else path
    allowed = "a solution.nc that `strikewave run` wrote"
    if not path.is_file():
        raise InputError("solution", path, allowed)
    with open_result(path, allowed) as opened:
        schema = opened.attrs["strikewave_schema"]
        if schema != SCHEMA:
            older = "an older strikewave wrote it: run the case.toml beside it again"
            raise InputError(
                "solution",
                str(path),
                f"a file of schema {SCHEMA}",
                f"it has schema {schema}; {older if schema < SCHEMA else 'update strikewave'}",
            )
        data = opened.load()
        case = parse_case(str(data.attrs.pop("case")))
        state = json.loads(data.attrs.pop("tables"))
        columns = [f.name for f in dataclasses.fields(Blow)]
        rows = zip(*(data["blow" if c == "index" else f"blow_{c}"].values.tolist() for c in columns), strict=True)
        blows = tuple(Blow(*row) for row in rows)
        if not {blow.kind for blow in blows} <= set(BLOW_KINDS) or not histories_of(case) <= set(data.variables):
            raise ValueError("a blow of unknown kind, or a history is missing")
        return Solution(
            case=case,
            blows=blows,
            masses=state["masses"],
            phases=tuple((name, time) for name, time in state["phases"]),
            balance=state["balance"],
            comparisons=tuple(Comparison(**row) for row in state["published"]),
            notices=tuple(Notice(**row) for row in state["warnings"]),
            reference=RigidReference(**state["reference"]),
            readings=tuple(_reading(row) for row in state["readings"]),
            waves=_waves(state["waves"]),
            citations=tuple(state["citations"]),
            sampled=LabelledArrays.of_xarray(data.drop_attrs(deep=False)),
            launch=state["launch"] or None,
            collisions=tuple(LineCollision(**row) for row in state["collisions"]),
            contact=_contact(state["contact"]),
            band={name: Band.read(row) for name, row in state["band"].items()},
            band_method=None if state["band_method"] is None else BandMethod.read(state["band_method"]),
        )


def _reading(row: dict[str, Any] | None) -> BlowReading | None:
    if row is None:
        return None
    sensors = {name: SensorPulse(**pulse) for name, pulse in row["sensors"].items()}
    return BlowReading(row["total_peak"], row["wave_peak"], row["bandwidth"], sensors)


def _contact(row: dict[str, Any] | None) -> ContactAnswers | None:
    if row is None:
        return None
    return ContactAnswers(**{**row, "rows": tuple(ContactAnswer(**answer) for answer in row["rows"])})


def _waves(row: dict[str, Any] | None) -> WaveSetup | None:
    if row is None:
        return None
    return WaveSetup(row["step"], row["mismatch"], tuple(LayerUsed(**layer) for layer in row["layers"]))


OF_A_BLOW = ("rigid_peak", "width", "velocity_change")
"""Results of each blow that have a band."""
SENSOR = "sensor.{}.peak"
"""Name of the peak of a sensor."""


class TimedBlow(Protocol):
    """A blow as far as its results go, of a full or a fast run."""

    @property
    def kind(self) -> str:
        """full, glancing, double or missed."""

    @property
    def time(self) -> float:
        """First touch, s."""


def figures_of(found: Sequence[TimedBlow]) -> dict[str, float]:
    """Return the results of a run that have a band, by name: those that there are.

    Examples
    --------
    >>> from strikewave import load_case, run_case
    >>> list(figures_of(run_case(load_case("jesd22-b111-b")).blows))
    ['first.rigid_peak', 'first.width', 'first.velocity_change']
    """
    struck = [blow for blow in found if blow.kind != "missed"]
    if not struck:
        return {}
    later = [blow for blow in struck[1:] if blow.kind in ("full", "double")]
    figures = {f"first.{name}": float(getattr(struck[0], name)) for name in OF_A_BLOW}
    if later:
        figures |= {f"typical.{name}": median(float(getattr(blow, name)) for blow in later) for name in OF_A_BLOW}
    if len(struck) > 1:
        figures["interval"] = median(b.time - a.time for a, b in pairwise(struck))
    return {name: value for name, value in figures.items() if math.isfinite(value)}


def sensor_figures(readings: Sequence[BlowReading | None]) -> dict[str, float]:
    """Return the size of the peak of each sensor in the first blow, which may be of either sign; not of one cut off."""
    first = next((reading for reading in readings if reading is not None), None)
    kept = {} if first is None else {name: pulse for name, pulse in first.sensors.items() if not pulse.cut}
    peaks = {SENSOR.format(name): abs(pulse.peak) for name, pulse in kept.items()}
    return {name: peak for name, peak in peaks.items() if math.isfinite(peak)}


MACHINES = {kind: (table.description, table.chain) for kind, table in KINDS.items() if issubclass(table, MachineKind)}
"""Kind of machine: its description, and its bodies and links in the order in which a blow runs through them."""
ANSWERS_CALLED = "First blow with its contact elastic and yielding"


def settings(solution: Solution) -> list[str]:
    """Return the main settings of a machine, each with its unit."""
    case = solution.case
    words = []
    for key, one in kind_of(case).settings.items():
        value = getattr(case.machine, key)
        if value is not None:
            is_count = one.si == NO_UNIT
            words.append(f"{value.si:.0f} {one.label}" if is_count else f"{one.label} {amount(one, value.si)}".strip())
    approach = (solution.launch or {}).get("approach_speed", solution.reference.approach_speed)
    words += [f"nominal approach {amount(VELOCITY, approach)}"]
    words += [f"object {amount(KILOGRAMS, solution.masses['object'])}"]
    return words + ([f"{case.feed.blows.si:.0f} blows wanted"] if case.feed else [])


def reference_law(case: Case) -> str:
    """Return in words which law stands beside the blows for comparison."""
    return kind_of(case).reference_law


def answer_columns(answers: ContactAnswers, bands: Mapping[str, Band] | None = None) -> list[Column]:
    """Return the columns of the answers of a contact, with the digits that the bands leave."""
    called = [row.name + (" (this run)" if row.name == answers.taken else "") for row in answers.rows]
    _, *rest = columns_of(ContactAnswer, answers.rows, bands=blow_bands(bands or {}))
    return [Column("contact", called, priority=KEY, words=True), *rest]


def blow_bands(bands: Mapping[str, Band]) -> dict[str, list[Band]]:
    """Return the bands of the first blow and of later ones by what they are of."""
    return bands_below(bands, ("first", "typical"))


def blow_columns(table: str, blows: Sequence[Blow], bands: Mapping[str, Band] | None = None) -> list[Column]:
    """Return the columns of a table of blows, ``blows``, ``contact`` or ``sliding``, for screen, page and app.

    Examples
    --------
    >>> [column.head for column in blow_columns("contact", [])][:4]
    ['#', 'approach speed (m/s)', 'rebound speed (m/s)', 'contact time (µs)']
    """
    return columns_of(Blow, blows, table, blow_bands(bands or {}))


def restitution_words(answers: ContactAnswers) -> str:
    """Say which restitution was asked of the damping, and which comes out of the contact."""
    taken = answers.row(answers.taken)
    came = "" if taken is None else f", {taken.restitution:.4g} comes out of the first blow"
    yields = " (damping and yield together)" if answers.taken == YIELDING else ""
    return f"coefficient of restitution: {answers.asked_restitution:g} asked of the damping{came}{yields}"


def launch_tables(solution: Solution) -> list[Table]:
    """Return how a machine without a drive came to first touch; nothing for one with a drive."""
    if not solution.launch:
        return []
    tables = part_tables(solution, "launch", "Up to first touch")
    if solution.collisions:
        caption = "Collisions in the line, by restitution alone; speeds upwards, time after the lowest met the floor"
        tables.append(page_table(caption, columns_of(LineCollision, solution.collisions)))
    return tables


def summary_words(solution: Solution) -> str:
    """Say in words what happened: blows, the first and the later ones, each number with its band where it has one.

    Examples
    --------
    >>> from strikewave import load_case, run_case
    >>> summary_words(run_case(load_case("li-ma-2019", ["feed.blows=1"]))).partition(".")[0]
    'One blow, full'
    """
    struck, first, band = solution.struck, solution.first_blow, solution.band
    if first is None:
        missed = len(solution.blows)
        passes = f" {missed} {'striker' if missed == 1 else 'strikers'} passed without touching it." if missed else ""
        return f"No blow: no striker touched the object.{passes} There is no pulse to measure."
    kinds = [blow.kind for blow in solution.blows]
    odd = [f"{kinds.count(kind)} {kind}" for kind in dict.fromkeys(kinds) if kind != "full"]
    whole = "all full" if not odd else f"among {len(kinds)} passes {listed(odd)}"
    many = "One blow, full" if len(struck) == 1 and not odd else f"{len(struck)} blows, {whole}"
    interval = amount(INTERVAL, solution.interval, band.get("interval"))
    apart = "" if solution.interval is None else f", {interval} apart (median)"
    width = amount(PULSE_WIDTH, first.width, band.get("first.width"))
    wide = f"is {width} wide at 10 % of its peak" if width != NONE else "has no width"
    words = [
        f"{many}{apart}.",
        f"The first reaches a rigid-body acceleration of "
        f"{amount(RIGID_PEAK, first.rigid_peak, band.get('first.rigid_peak'))}, {wide} and has a velocity change of "
        f"{amount(VELOCITY_CHANGE, first.velocity_change, band.get('first.velocity_change'))}; the contact force peaks "
        f"at {text_of(first, 'peak_force')}.",
    ]
    later = _later(struck)
    if later:
        peak, span = (median(getattr(blow, name) for blow in later) for name in ("rigid_peak", "width"))
        words.append(
            f"Later blows: {amount(RIGID_PEAK, peak, band.get('typical.rigid_peak'))} and "
            f"{amount(PULSE_WIDTH, span, band.get('typical.width'))} (medians)."
        )
    return " ".join([*words, *_felt_words(solution)])


def _later(struck: Sequence[Blow]) -> list[Blow]:
    """Return the blows after the first that count as typical."""
    return [blow for blow in struck[1:] if blow.kind in ("full", "double")]


def _felt_words(solution: Solution) -> list[str]:
    """Say in words what taps and sensors felt of the first blow; nothing without a stack or sensors."""
    reading = next((r for r in solution.readings if r is not None), None)
    if reading is None:
        return []
    words = []
    if reading.total_peak is not None and reading.bandwidth is not None and "tap" in solution.arrays:
        band, tap = text_of(reading, "bandwidth"), solution.arrays["tap"].values[0]
        words.append(f"At the tap {tap} it reaches {text_of(reading, 'total_peak')} in all, at {band}.")
    read = [f"{name} {text_of(pulse, 'peak')}" for name, pulse in reading.sensors.items()]
    if read:
        words.append(f"Sensors read, with resonance and all they pass beyond that bandwidth: {listed(read)}.")
    return words
