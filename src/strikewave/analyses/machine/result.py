"""The solution of a case: histories with units as an xarray Dataset, and tables.

The dataset holds the whole train (dimension ``time``, from the valve signal or the start), each blow in detail
(``blow`` by ``pulse_time``, from first touch), what an ideal recorder would have stored
(``record_time``), and the table of blows.
"""

from __future__ import annotations

import dataclasses
import functools
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path
from statistics import median
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from strikewave._version import __version__
from strikewave.analyses.machine.columns import BLOW_SI, BLOW_UNITS, HIDDEN, shown_in
from strikewave.analyses.machine.contact_answers import ANSWER_UNITS, ContactAnswer, ContactAnswers
from strikewave.analyses.machine.figures_of import figures_of, sensor_figures
from strikewave.analyses.machine.sensor_readings import BlowReading
from strikewave.base.errors import InputError
from strikewave.base.first_few import first_few
from strikewave.base.result import SCHEMA, Band, BandMethod, Comparison, Notice, Source, comparison_document
from strikewave.base.variables import LabelledArrays, open_result
from strikewave.cases.case import Case, parse_case
from strikewave.cases.comparisons import stale_fits_document
from strikewave.cases.tables.published import PUBLISHED_QUANTITIES
from strikewave.cases.written_case import dump_case
from strikewave.machines import Blow
from strikewave.machines.blows import KINDS
from strikewave.reporting.banded_numbers import with_band
from strikewave.reporting.columns import Column, csv_table
from strikewave.reporting.shown_result import Curve, ShownResult, history_curve
from strikewave.sensors.channel import SensorPulse
from strikewave.waves.setup import LayerUsed, WaveSetup

if TYPE_CHECKING:
    import xarray

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


@dataclass(frozen=True)
class RigidReference:
    """What the printed contact law would give on a rigid object, SI: see `strikewave.analyses.machine.run`."""

    approach_speed: float
    peak_force: float
    peak_acceleration: float
    duration: float


@dataclass(frozen=True)
class LineCollision:
    """A collision of two bodies of an amplifier, SI: time after the lowest met the floor, speeds upwards."""

    time: float
    lower: str
    upper: str
    lower_before: float
    upper_before: float
    lower_after: float
    upper_after: float
    impulse: float
    energy_lost: float


LAUNCH_UNITS = {"approach_speed": "m/s", "energy_released": "J", "energy_at_touch": "J", "gain": "1"}
"""What is said of a machine without a drive, and its SI unit."""


@dataclass(frozen=True)
class Solution(ShownResult):
    """What a run gave; see `Result` for what it shares with others.

    Attributes
    ----------
    case : Case
        What ran.
    blows : sequence of Blow
        The table of blows.
    masses : dict
        Of striker, object and assembly, kg.
    balance : dict
        ``energy_error`` and ``momentum_error``: what the balances miss, as shares of what flowed.
    phases : tuple of (str, float)
        Name and time (s) from the valve signal.
    reference : RigidReference
        The printed law on a rigid object.
    readings : tuple of (BlowReading or None)
        What taps and sensors show, one a blow; None where it missed.
    waves : WaveSetup or None
        How the waves were followed; None where the object is no stack.
    sampled : LabelledArrays
        Histories and the table of blows, with units; `histories` and `data` are the xarray Dataset of them.
    launch : dict
        Of a machine without a drive, SI: see `LAUNCH_UNITS`.
    collisions : tuple of LineCollision
        Of the bodies of an amplifier, that of striker and object among them, by restitution alone.
    contact : ContactAnswers or None
        The first blow with its contact elastic and yielding; None where none struck.
    """

    command: ClassVar[str] = "run"
    table_name: ClassVar[str] = "blows"

    case: Case
    blows: Sequence[Blow]
    masses: dict[str, float]
    phases: tuple[tuple[str, float], ...]
    balance: dict[str, float]
    reference: RigidReference
    readings: tuple[BlowReading | None, ...]
    waves: WaveSetup | None
    sampled: LabelledArrays = field(repr=False, compare=False)
    launch: dict[str, float] = field(default_factory=dict)
    collisions: tuple[LineCollision, ...] = ()
    contact: ContactAnswers | None = None

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
    def slides(self) -> bool:
        """Whether friction across the face acted in a blow."""
        return any(blow.friction_heat > 0.0 for blow in self.blows)

    @property
    def test(self) -> Mapping[str, str]:
        """What the case says of the test."""
        return self.case.test.stated()

    @functools.cached_property
    def source(self) -> Source:
        """The case."""
        return Source("case", self.case.name, dump_case(self.case))

    @property
    def arrays(self) -> LabelledArrays:
        """Histories and the table of blows, with units."""
        return self.sampled

    @property
    def histories(self) -> xarray.Dataset:
        """Histories and the table of blows, with units in their attributes."""
        return self.data

    def units(self) -> dict[str, str]:
        """Return the unit of each key of the JSON document."""
        units = {k: u for k, u in BLOW_UNITS.items() if k not in HIDDEN}
        units |= {"wave_peak": "m/s^2", "total_peak": "m/s^2", "bandwidth": "Hz", "peak": "m/s^2", "masses": "kg"}
        units |= {"step": "s", "mismatch": "1", "length_asked": "m", "length_used": "m"}
        units |= ANSWER_UNITS | LAUNCH_UNITS | {"lower_before": "m/s", "upper_before": "m/s"}
        units |= {"lower_after": "m/s", "upper_after": "m/s", "energy_lost": "J"}
        return units | {"balance": "1", "difference": "1"} | {k: u or "1" for k, u in PUBLISHED_QUANTITIES.items()}

    def content(self) -> dict[str, Any]:
        """Return what the JSON document holds beside its head."""
        rows = []
        nothing = BlowReading(None, None, None, {})
        for blow, reading in zip(self.blows, self.readings, strict=True):
            row = {k: v for k, v in dataclasses.asdict(blow).items() if k not in HIDDEN}
            rows.append({**row, **dataclasses.asdict(reading or nothing)})
        return {
            "case": self.case.name,
            "route": self.case.solver.route,
            "blows": rows,
            "masses": self.masses,
            "phases": [{"name": name, "time": time} for name, time in self.phases],
            "balance": self.balance,
            "contact": None if self.contact is None else self.contact.document(),
            **self._launched(),
            "waves": dataclasses.asdict(self.waves) if self.waves else None,
            "published": [comparison_document(c, "note", "sensor") for c in self.comparisons],
            "fitted_fields": self.case.fitted_fields(),
            "stale_fits": stale_fits_document(self.case),
            **self.band_content(),
        }

    @property
    def figures(self) -> dict[str, float]:
        """The results that may have a band, by name, SI."""
        return {**figures_of(self.blows), **sensor_figures(self.readings)}

    def _launched(self) -> dict[str, Any]:
        """Return what the JSON document says of a machine without a drive; nothing of one with a drive."""
        rows = [dataclasses.asdict(collision) for collision in self.collisions]
        return {"launch": self.launch, "collisions": rows} if self.launch else {}

    @property
    def struck(self) -> list[Blow]:
        """The blows that touched the object."""
        return [blow for blow in self.blows if blow.kind != "missed"]

    def highlights(self) -> list[tuple[str, str]]:
        """Return the number of blows, peak, width and velocity change of the first one, and the interval."""
        struck, band = self.struck, self.band
        counted = [("blows", str(len(struck)))]
        if not struck:
            return counted
        first, times = struck[0], [blow.time for blow in struck]
        numbers = [
            ("first peak", with_band(first.rigid_peak, band.get("first.rigid_peak"), "m/s^2", "g")),
            ("width", with_band(first.width, band.get("first.width"), "s", "us")),
            ("velocity change", with_band(first.velocity_change, band.get("first.velocity_change"), "m/s", "m/s", 3)),
        ]
        if len(times) > 1:
            interval = median(later - earlier for earlier, later in pairwise(times))
            numbers.append(("interval", with_band(interval, band.get("interval"), "s", "ms")))
        return [*counted, *numbers]

    def preview(self) -> Curve | None:
        """Return the rigid-body acceleration of the first blow over twice its width."""
        place = next((k for k, blow in enumerate(self.blows) if blow.kind != "missed"), None)
        if place is None:
            return None
        blow = self.blows[place]
        time, values = blow_history(self.arrays, place, "pulse_acceleration")
        kept = time <= (SHOWN_WIDTHS * blow.width if blow.width > 0.0 else time[-1])
        return history_curve(time[kept], values[kept], "m/s^2", "g", f"rigid-body acceleration, blow {blow.index}")

    def tables(self) -> dict[str, str]:
        """Return the table of blows as CSV text, every column with its unit."""
        return {"blows.csv": csv_table(self.columns())}

    def columns(self) -> list[Column]:
        """Return the table of blows, with what taps and sensors show of each."""
        columns = [
            Column(name, [getattr(blow, name) for blow in self.blows], BLOW_SI.get(name, ""))
            for name in (one.name for one in dataclasses.fields(Blow))
        ]
        if self.waves:
            for name, si in (("total_peak", "m/s^2"), ("wave_peak", "m/s^2"), ("bandwidth", "Hz")):
                columns.append(Column(name, [getattr(reading, name, None) for reading in self.readings], si))
            columns.append(Column("route", [self.case.solver.route] * len(self.blows)))
        for name in dict.fromkeys(name for r in self.readings if r is not None for name in r.sensors):
            pulses = [None if reading is None else reading.sensors[name] for reading in self.readings]
            for key, si in (("peak", "m/s^2"), ("width", "s"), ("clipped", "")):
                columns.append(Column(f"{name} {key}", [getattr(pulse, key, None) for pulse in pulses], si))
        return columns

    def brief(self) -> dict[str, str]:
        """Return the columns of the table of blows on the screen, and the peaks of the sensors."""
        usual = {"index": "", "kind": "", **{name: unit for name, _, unit, _ in shown_in("blows")}}
        return usual | {f"{name} peak": "g" for reading in self.readings if reading for name in reading.sensors}

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
        raise InputError("solution", str(path), allowed)
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
        if not {blow.kind for blow in blows} <= set(KINDS) or not histories_of(case) <= set(data.variables):
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
            launch=state["launch"],
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
