"""The solution of a case: histories with units as an xarray Dataset, and tables.

The dataset holds the whole train (dimension ``time``, from the valve signal or the start), each blow in detail
(``blow`` by ``pulse_time``, from first touch), what an ideal recorder would have stored
(``record_time``), and the table of blows.
"""

from __future__ import annotations

import dataclasses
import json
import math
import operator
from collections.abc import Mapping, Sequence
from dataclasses import field
from pathlib import Path
from statistics import median
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from strikewave._version import __version__
from strikewave.analyses.machine.blow_histories import BlowReading, TimedBlow, first_struck, struck_blows, typical_blows
from strikewave.analyses.machine.kind import kind_of
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
from strikewave.cases.case import parse_case
from strikewave.cases.contact_parts import ELASTIC, HIGH, LOW, WORTH_SHOWING, YIELDING
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
    """The first blow by each answer of its contact."""

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
        peaks = zip(*[(row.rigid_peak, row.peak_force) for row in self.rows], strict=True)
        return max([max(values) / min(values) - 1.0 if min(values) > 0.0 else 0.0 for values in peaks])

    @declare.computed(declare.number(RESTITUTION, "what came out of the first blow"))
    def restitution(self) -> float | None:
        """Coefficient of restitution of the answer that was taken."""
        taken = self.row(self.taken)
        return None if taken is None else taken.restitution

    @declare.computed(declare.word("whether the answers differ so much that all are shown"))
    def differ(self) -> bool:
        """True if the answers differ so much that all are shown."""
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
SHOWN_WIDTHS = 2.2  # widths of the first blow that its curve lasts: the pulse, and the begin of the flight after it

HISTORIES = frozenset(
    [
        "contact_force",
        "rigid_acceleration",
        "nose_position",
        "assembly_position",
        "assembly_speed",
        "pulse_force",
        "pulse_acceleration",
        "record_acceleration",
    ]
)
"""Histories of every solution; one of a machine with a drive has the turntable's speed too."""


@declare.dataclass
class RigidReference:
    """Blow on a rigid object by the printed contact law, SI: see `strikewave.analyses.machine.run`."""

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
    """A collision of two bodies of an amplifier."""

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
    """Approach of a machine without a drive to first touch."""

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
    """Reading of a blow by a sensor."""

    blow: int = declare.count("number of the blow, from 1", column=KEY)
    name: str = declare.word("the sensor", label="sensor", column=KEY)
    pulse: SensorPulse = declare.part(SensorPulse, "what it reads")


@declare.dataclass
class Solution(CaseResult):
    """Results of a run of a machine; see `Result` for what it shares with others.

    Attributes
    ----------
    blows : sequence of Blow
        Table of the blows.
    reference : RigidReference
        Blow of the printed law on a rigid object.
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
        now = {**self.case.entries(), **{path: value.typed for path, value in self.case.values().items()}}
        shown = first_few([f"{path} = {now.get(path, 'left out')}" for path in changed], 3)
        route = "" if self.case.solver.route == "exact" else f"; route {self.case.solver.route}"
        return (self.case.title or self.case.name) + (f"; here {shown}" if changed else "") + route

    @property
    def named_units(self) -> Mapping[str, str]:
        """Units of published numbers, by their names."""
        return {name: quantity.si for name, quantity in PUBLISHED_QUANTITIES.items()}

    @property
    def data_rows(self) -> str:
        """Name of the rows of blows: with what sensors read of each, and what taps show where waves were followed."""
        return "read_blows" if self.waves else "sensed_blows"

    @property
    def slides(self) -> bool:
        """True if friction across the face acted in a blow."""
        return max([blow.friction_heat for blow in self.blows], default=0.0) > 0.0

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
        """Route by which the waves were followed."""
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
        """Readings of each blow by each sensor."""
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
        return {**blow_results(self.blows), **sensor_results(self.readings)}

    @declare.computed(declare.rows(Blow, "blows that struck", label="blows", headline="count", in_document=False))
    def struck(self) -> list[Blow]:
        """The blows that touched the object."""
        return struck_blows(self.blows)

    @declare.computed(
        declare.part(Blow, "the first blow that struck", band="first", headline="first", in_document=False)
    )
    def first_blow(self) -> Blow | None:
        """The first blow that touched the object; None where none did."""
        return first_struck(self.blows)

    @declare.computed(
        declare.number(PEAK_FORCE, "its largest contact force", headline="first contact force", in_document=False)
    )
    def first_force(self) -> float | None:
        """The largest contact force of the first blow."""
        return None if self.first_blow is None else self.first_blow.peak_force

    @declare.phrase("range of a yielding contact", headline="first rigid peak, range of a yielding contact")
    def yielding_range(self) -> str | None:
        """Return the peaks of the first blow between which the contact may yield; None where it does not matter."""
        if self.contact is None or not self.contact.differ or self.contact.band is None:
            return None
        low, high = [written(shown(peak, *ACCELERATION.units)) for peak in self.contact.band]
        return f"{low} to {high}\N{NO-BREAK SPACE}{spelled(shown_unit(*ACCELERATION.units))}"

    @declare.computed(
        declare.number(
            INTERVAL, "median time between blows", band="interval", headline="median interval", in_document=False
        )
    )
    def interval(self) -> float | None:
        """Median time between blows; None for fewer than two."""
        times = [blow.time for blow in self.struck]
        return median(map(operator.sub, times[1:], times)) if len(times) > 1 else None

    @declare.computed(declare.count("how many blows were wanted", headline="blows wanted", in_document=False))
    def wanted(self) -> int | None:
        """Number of blows that were wanted; None of a machine without a feed."""
        return int(self.case.feed.blows.si) if self.case.feed else None

    def preview(self) -> Curve | None:
        """Return the rigid-body acceleration of the first blow over twice its width."""
        blow = self.first_blow
        if blow is None:
            return None
        time, values = blow_history(self.arrays, self.blows.index(blow), "pulse_acceleration")
        inside = time <= (SHOWN_WIDTHS * blow.width if blow.width > 0.0 else time[-1])
        label = f"rigid-body acceleration, blow {blow.index}"
        return history_curve(time[inside], values[inside], *ACCELERATION.units, label)

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
            "published": list(map(dataclasses.asdict, self.comparisons)),
            "warnings": list(map(dataclasses.asdict, self.notices)),
            "reference": dataclasses.asdict(self.reference),
            "readings": [reading and dataclasses.asdict(reading) for reading in self.readings],
            "waves": self.waves and dataclasses.asdict(self.waves),
            "citations": self.citations,
            "launch": self.launch,
            "collisions": list(map(dataclasses.asdict, self.collisions)),
            "contact": self.contact and dataclasses.asdict(self.contact),
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
        needed = HISTORIES if case.launched() else HISTORIES | {"turntable_speed"}
        if not {blow.kind for blow in blows} <= set(BLOW_KINDS) or not needed <= set(data.variables):
            raise ValueError("a blow of unknown kind, or a history is missing")
        waves, contact = state["waves"], state["contact"]
        if waves:
            waves = WaveSetup(waves["step"], waves["mismatch"], tuple(LayerUsed(**row) for row in waves["layers"]))
        if contact:
            contact = ContactAnswers(**{**contact, "rows": tuple(ContactAnswer(**row) for row in contact["rows"])})
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
            waves=waves,
            citations=tuple(state["citations"]),
            sampled=LabelledArrays.of_xarray(data.drop_attrs(deep=False)),
            launch=state["launch"] or None,
            collisions=tuple(LineCollision(**row) for row in state["collisions"]),
            contact=contact,
            band={name: Band.read(row) for name, row in state["band"].items()},
            band_method=None if state["band_method"] is None else BandMethod.read(state["band_method"]),
        )


def _reading(row: dict[str, Any] | None) -> BlowReading | None:
    if row is None:
        return None
    sensors = {name: SensorPulse(**pulse) for name, pulse in row["sensors"].items()}
    return BlowReading(row["total_peak"], row["wave_peak"], row["bandwidth"], sensors)


OF_A_BLOW = ("rigid_peak", "width", "velocity_change")
"""Results of each blow that have a band."""
SENSOR = "sensor.{}.peak"
"""Name of the peak of a sensor."""


def blow_results(run_blows: Sequence[TimedBlow]) -> dict[str, float]:
    """Return the results of a run that have a band, by name: those that there are.

    Examples
    --------
    >>> from strikewave import load_case, run_case
    >>> list(blow_results(run_case(load_case("jesd22-b111-b")).blows))
    ['first.rigid_peak', 'first.width', 'first.velocity_change']
    """
    struck, results = struck_blows(run_blows), dict[str, float]()
    later = typical_blows(struck)
    for group, blows in (("first", struck[:1]), ("typical", later)):
        for name in OF_A_BLOW if blows else ():
            results[f"{group}.{name}"] = median([float(getattr(blow, name)) for blow in blows])
    if len(struck) > 1:
        times = [blow.time for blow in struck]
        results["interval"] = median(map(operator.sub, times[1:], times))
    return {name: value for name, value in results.items() if math.isfinite(value)}


def sensor_results(readings: Sequence[BlowReading | None]) -> dict[str, float]:
    """Return the size of the peak of each sensor in the first blow, which may be of either sign; not of one cut off."""
    first = next(filter(None, readings), None)
    pulses = first.sensors.items() if first else ()
    peaks = {SENSOR.format(name): abs(pulse.peak) for name, pulse in pulses if not pulse.cut}
    return {name: peak for name, peak in peaks.items() if math.isfinite(peak)}


ANSWERS_CALLED = "First blow with its contact elastic and yielding"


def settings(solution: Solution) -> list[str]:
    """Return the main settings of a machine, each with its unit."""
    case, phrases = solution.case, list[str]()
    for key, kind in kind_of(case).settings.items():
        value = getattr(case.machine, key)
        if value is not None:
            is_count = kind.si == NO_UNIT
            number = f"{value.si:.0f} {kind.label}" if is_count else f"{kind.label} {amount(kind, value.si)}"
            phrases.append(number.strip())
    approach = (solution.launch or {}).get("approach_speed", solution.reference.approach_speed)
    phrases.append(f"nominal approach {amount(VELOCITY, approach)}")
    phrases.append(f"object {amount(KILOGRAMS, solution.masses['object'])}")
    return phrases + ([f"{case.feed.blows.si:.0f} blows wanted"] if case.feed else [])


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
    """Return the restitution asked of the damping, and the one that comes out of the contact, as a sentence."""
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
    """Return the summary of a run: its blows, the first and the later ones, each number with its band if it has one.

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
    among = "all full" if not odd else f"among {len(kinds)} passes {listed(odd)}"
    many = "One blow, full" if len(struck) == 1 and not odd else f"{len(struck)} blows, {among}"
    interval = amount(INTERVAL, solution.interval, band.get("interval"))
    apart = "" if solution.interval is None else f", {interval} apart (median)"
    width = amount(PULSE_WIDTH, first.width, band.get("first.width"))
    wide = f"is {width} wide at 10 % of its peak" if width != NONE else "has no width"
    sentences = [
        f"{many}{apart}.",
        f"The first reaches a rigid-body acceleration of "
        f"{amount(RIGID_PEAK, first.rigid_peak, band.get('first.rigid_peak'))}, {wide} and has a velocity change of "
        f"{amount(VELOCITY_CHANGE, first.velocity_change, band.get('first.velocity_change'))}; the contact force peaks "
        f"at {text_of(first, 'peak_force')}.",
    ]
    later = typical_blows(struck)
    if later:
        peak, span = median([blow.rigid_peak for blow in later]), median([blow.width for blow in later])
        sentences.append(
            f"Later blows: {amount(RIGID_PEAK, peak, band.get('typical.rigid_peak'))} and "
            f"{amount(PULSE_WIDTH, span, band.get('typical.width'))} (medians)."
        )
    reading = next(filter(None, solution.readings), None)
    if reading and reading.total_peak is not None and reading.bandwidth is not None and "tap" in solution.arrays:
        bandwidth, tap = text_of(reading, "bandwidth"), solution.arrays["tap"].values[0]
        sentences.append(f"At the tap {tap} it reaches {text_of(reading, 'total_peak')} in all, at {bandwidth}.")
    if reading and reading.sensors:
        read = listed([f"{name} {text_of(pulse, 'peak')}" for name, pulse in reading.sensors.items()])
        sentences.append(f"Sensors read, with resonance and all they pass beyond that bandwidth: {read}.")
    return " ".join(sentences)
