"""The file of a whole fit: the case, what is free, and records and numbers, each with its settings.

What it states is what the options of the command say, and comes to the same result. Its files lie beside it, or else
where we work.
"""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any, Literal, NamedTuple, Self

from pydantic import BeforeValidator, Field, model_validator

from strikewave.analyses.compare.sources import SourceOptions
from strikewave.base.documents import read_toml
from strikewave.base.errors import MISSING, InputError, InputErrors, StrikewaveError
from strikewave.cases.case import Case, load_case
from strikewave.cases.files import LARGEST_SMALL_FILE, bundled_cases
from strikewave.cases.paths import Form
from strikewave.cases.tables.common import CaseTable, Line
from strikewave.reporting.measured_files import MeasurementOptions
from strikewave.reporting.options import low_pass_of, read_share
from strikewave.studies.fit.targets import FitRequest, Target
from strikewave.studies.study_file import (
    Quantity,
    Settings,
    beside,
    case_place,
    quantity,
    read_study,
    stated_at,
    states_a_study,
)

ALLOWED = "a TOML file with the case, and [[record]] or [[number]]"
MOST_TARGETS = 1000  # records and numbers of a file: no test has as many
OF_FIT = ("free", "record", "number", "try", "reading")  # tables that a case has not
OF_CALIBRATION = ("unit", "sensitivity", "gain", "excitation", "rated_excitation", "count", "polarity")


def _words(raw: Any) -> list[str]:
    """Return a value of the calibration as options have it: for all channels, or channel by channel."""
    if isinstance(raw, Mapping):
        return [f"{channel}={quantity(value)}" for channel, value in raw.items()]
    return [str(quantity(raw))]


Share = Annotated[float, BeforeValidator(lambda raw: read_share(str(quantity(raw)), ""))]
Calibration = Annotated[list[str] | None, BeforeValidator(_words)]


class FreeTable(CaseTable):
    """[[free]]: a field that is fitted, with bounds or without."""

    path: Line
    low: Quantity | None = None
    high: Quantity | None = None

    @model_validator(mode="after")
    def _whole(self) -> Self:
        for name in ("low", "high"):
            if getattr(self, name) is None and (self.low, self.high) != (None, None):
                raise InputError(name, MISSING, "both bounds, or none")
        return self

    @property
    def word(self) -> str:
        """As the option has it."""
        return self.path if self.low is None else f"{self.path}={self.low}..{self.high}"


class MeasuredTable(CaseTable):
    """Measured record or number: ``set`` are its settings; ``kept_out`` predicts it and does not fit to it."""

    set: Settings = ()
    kept_out: bool = False


class RecordTable(MeasuredTable):
    """[[record]]: a measured file, or several by a pattern.

    ``channel`` and ``blow`` are those of the file, ``part`` and ``of_blow`` those of the run; ``scatter`` is by which
    share the amplitude scatters from shot to shot.
    """

    file: Line
    channel: Line | int = ""
    blow: Annotated[int, Field(ge=1, le=999_999)] | Literal["all"] | None = None
    part: Line = ""
    of_blow: Annotated[int | None, Field(ge=1, le=999_999)] = None
    scatter: Share = 0.0

    def target(self, folder: Path, stated: str) -> Target:
        """Return it as a target."""
        place = beside(self.file, folder)
        channel = f"#{self.channel}" if self.channel != "" else ""
        blow = f"@{self.blow}" if self.blow is not None else ""
        part = self.part + (f"@{self.of_blow}" if self.of_blow is not None else "")
        return Target(part, f"{place}{channel}{blow}", self.set, scatter=self.scatter, stated=stated)


class NumberTable(MeasuredTable):
    """[[number]]: a stated number, with its standard uncertainty; ``sensor`` where it is that of one."""

    name: Line
    sensor: Line = ""
    value: Quantity
    uncertainty: Quantity | None = None

    def target(self, folder: Path, stated: str) -> Target:
        """Return it as a target."""
        uncertain = f" +- {self.uncertainty}" if self.uncertainty is not None else ""
        left = f"{self.name} {self.sensor}".strip()
        return Target(left, f"{self.value}{uncertain}", self.set, is_number=True, stated=stated)


class TryTable(CaseTable):
    """[try]: choices of a field that are fitted each."""

    path: Line
    choices: tuple[Quantity, ...]

    @property
    def word(self) -> str:
        """As the option has it."""
        return f"{self.path}={','.join(map(str, self.choices))}"


class ReadingTable(CaseTable):
    """[reading]: how the records are read, as the options of `strikewave record` say it."""

    channel: Line | int = ""
    unit: Calibration = None
    sensitivity: Calibration = None
    gain: Calibration = None
    excitation: Calibration = None
    rated_excitation: Calibration = None
    count: Calibration = None
    polarity: Calibration = None
    rate: Quantity | None = None
    time: Line | int = ""
    time_unit: Line = ""
    filter: Quantity | None = None

    def options(self) -> SourceOptions:
        """Return it as commands have it."""
        calibration = {name: getattr(self, name) for name in OF_CALIBRATION}
        channels = None if self.channel == "" else [self.channel]
        time = None if self.time == "" else str(self.time)
        measurement = MeasurementOptions(
            channels, rate=self.rate, time=time, time_unit=self.time_unit or None, **calibration
        )
        return SourceOptions(measurement.calibration(), measurement.reading(), low_pass_of(self.filter), band=False)


class FitFile(CaseTable):
    """The file of a whole fit."""

    schema_: Annotated[Literal[1], Field(alias="schema")]
    title: Line = ""
    case: Line
    set: Settings = ()
    free: tuple[FreeTable, ...] = ()
    record: tuple[RecordTable, ...] = ()
    number: tuple[NumberTable, ...] = ()
    try_: Annotated[TryTable | None, Field(alias="try")] = None
    reading: ReadingTable = ReadingTable()
    bayes: bool = False

    @model_validator(mode="after")
    def _counted(self) -> Self:
        count = len(self.record) + len(self.number)
        if count > MOST_TARGETS:
            raise InputError("record", f"{count} records and numbers", f"at most {MOST_TARGETS}")
        return self


FORM = Form(FitFile, "fit", 'record.0.file="shot.csv"')


class ReadFit(NamedTuple):
    """A file of a fit that was read: the case, what is asked, and the file itself."""

    case: Case
    request: FitRequest
    path: Path


def is_fit_file(name: str) -> bool:
    """Tell whether a name is that of a file of a whole fit: one with a case, or with what only a fit has."""
    if name in bundled_cases() or not name.lower().endswith(".toml") or not os.path.isfile(name):
        return False
    try:
        with open(name, "rb") as file:
            document = read_toml(file.read(LARGEST_SMALL_FILE + 1).decode("utf-8-sig"))
    except (OSError, ValueError):
        return False
    return states_a_study(document, OF_FIT)


def load_fit(path: str | Path, changes: Sequence[str] = ()) -> ReadFit:
    """Read a file of a whole fit; ``changes`` of its case go before those that it states."""
    path = Path(path)
    file = read_study(path, FORM, ALLOWED)
    place = case_place(file.case, path.parent)
    with stated_at(path.name):
        case = load_case(place)
    with stated_at(f"{path.name}: set"):
        case = load_case(place, (*file.set, *changes))
    with stated_at(f"{path.name}: reading"):
        try:
            reading = file.reading.options()
        except StrikewaveError:
            raise
        except ValueError as error:
            raise InputErrors([str(error)]) from None
    measured: dict[str, tuple[RecordTable | NumberTable, ...]] = {"record": file.record, "number": file.number}
    targets = [
        (row.kept_out, row.target(path.parent, f"{path.name}: {table}.{k}"))
        for table, rows in measured.items()
        for k, row in enumerate(rows)
    ]
    request = FitRequest(
        to=tuple(target for kept_out, target in targets if not kept_out),
        free=tuple(one.word for one in file.free),
        tries=file.try_.word if file.try_ is not None else "",
        check_on=tuple(target for kept_out, target in targets if kept_out),
        reading=reading,
        bayes=file.bayes,
        file=path.name,
    )
    return ReadFit(case, request, path)
