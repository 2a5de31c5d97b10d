"""Tables of a specification file: each number with its unit, its status and its source.

A number is ``"1500 g"``, or a table ``{ value = "1500 g", status = "quoted", source = "who quotes it" }``. What a
number does not say of itself its table says, and else the file. A share has its sign, ``"20 %"``: a bare 5 would be
500 %, which judges nothing, and a bare 0.15 may be meant either way.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import pairwise
from typing import Annotated, Any, Literal, Self

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, model_validator

from strikewave.base.errors import MISSING, InputError, nearest
from strikewave.base.quantities import Range
from strikewave.base.texts import sign_needed
from strikewave.base.units import DIMENSIONS, typed_number
from strikewave.cases.tables.common import CaseTable, Line, line_text, notes_text
from strikewave.specifications.ideal_pulses import TRAPEZOID
from strikewave.specifications.judging import INDICATIVE, STATUSES

Status = Literal["normative", "quoted", "indicative"]
KEYS = ("value", "status", "source", "note")  # keys that the table of a number may hold
FROM_MEMORY = "from memory"  # source of an indicative number that names none
# Conditions of a file and breakpoints of a spectrum, at most: no standard comes near
MOST_CONDITIONS, MOST_POINTS = 200, 1000


class StatedNumber(BaseModel):
    """A number of a specification."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    si: float  # in SI; a share, or dB
    typed: str | int | float  # as it stands in the file
    status: str = ""  # status of the number itself; empty where its table or the file says it
    source: str = ""  # who has it; what is to be known of it
    note: str = ""


class NumberReader:
    """Reader of a number: a quantity with its unit, a share such as "20 %", or a level such as "-6 dB"."""

    def __init__(self, unit: str, low: float = -math.inf, high: float = math.inf, open_low: bool = False) -> None:
        self.unit, self.low, self.high = unit, low, high
        self.range = Range("" if unit in ("%", "dB") else unit, low, high, open_low)

    def example(self) -> str:
        """Return a number as a file has it: ``"20 %"``."""
        typed = {"%": "20 %", "dB": "-6 dB"}.get(self.unit) or DIMENSIONS.get(self.unit, ("", ""))[1]
        return f'"{typed}"' if typed else f"{max(self.low, 1.0):g}"

    def read(self, raw: Any) -> Any:
        """Turn what a file holds into a number.

        Examples
        --------
        >>> NumberReader("m/s^2").read("1 g").si, NumberReader("%").read("20 %").si, NumberReader("dB").read("-6 dB").si
        (9.80665, 0.2, -6.0)
        """
        if isinstance(raw, StatedNumber):
            return raw
        if not isinstance(raw, dict):
            return StatedNumber(si=self._si(raw), typed=raw)
        unknown = [key for key in raw if key not in KEYS]
        if unknown:
            raise InputError(str(unknown[0]), raw[unknown[0]], ", ".join(KEYS), nearest(str(unknown[0]), KEYS))
        if "value" not in raw:
            raise InputError("value", MISSING, "the number itself")
        status = raw.get("status", "")
        if status != "" and status not in STATUSES:
            raise InputError("status", status, "one of " + ", ".join(STATUSES), nearest(str(status), STATUSES))
        texts = {key: line_text(raw[key]) for key in ("source", "note") if key in raw}
        if status not in ("", INDICATIVE) and not texts.get("source"):
            raise InputError("source", MISSING, f"who has it: it is {status}")
        return StatedNumber(si=self._si(raw["value"]), typed=raw["value"], status=status, **texts)

    def _si(self, typed: Any) -> float:
        if self.unit not in ("%", "dB"):
            return self.range.read(typed).si
        sign, scale, example = ("%", 0.01, "20 %") if self.unit == "%" else ("dB", 1.0, "-6 dB")
        words = f'a {"number" if self.unit == "dB" else "share"} with its sign, such as "{example}"'
        limits = "" if math.isinf(self.high) else f", from {self.low / scale:g} to {self.high / scale:g} {sign}"
        read = typed_number(typed, sign) if isinstance(typed, str) else None
        number = math.nan if read is None else read * scale
        if not self.low <= number <= self.high:
            bare = isinstance(typed, int | float) and not isinstance(typed, bool) and self.unit == "%"
            raise InputError("", typed, words + limits, sign_needed(typed) if bare else "")
        return number


def _number(unit: str, low: float = -math.inf, high: float = math.inf, open_low: bool = False) -> Any:
    return BeforeValidator(NumberReader(unit, low, high, open_low).read)


class ToleranceReader(NumberReader):
    """Reader of a tolerance to both sides: ``"20 %"``, as much down as up, or two shares."""

    def read(self, raw: Any) -> Any:
        """Turn what a file holds into two numbers, see `NumberReader.read`."""
        if isinstance(raw, list | tuple):
            if len(raw) != 2:
                raise InputError("", raw, 'one share, such as "20 %", or two, such as ["-10 %", "20 %"]')
            return NumberReader("%", -1.0, 0.0).read(raw[0]), super().read(raw[1])
        both = super().read(raw)
        return both.model_copy(update={"si": -min(both.si, 1.0)}), both


# Limits refuse a wrong unit or a slip of the exponent: no shock has a million g, lasts a minute, or ends within 1 us.
Acceleration = Annotated[StatedNumber, _number("m/s^2", 0.0, 1e7, open_low=True)]
MaybePeak = Annotated[StatedNumber | None, _number("m/s^2", 0.0, 1e7, open_low=True)]
MaybeDuration = Annotated[StatedNumber | None, _number("s", 1e-6, 60.0)]
MaybeVelocityChange = Annotated[StatedNumber | None, _number("m/s", 0.0, 1e4, open_low=True)]
MaybeHeight = Annotated[StatedNumber | None, _number("m", 0.0, 1e4, open_low=True)]
MaybeLeast = Annotated[StatedNumber | None, _number("s", 0.0, 60.0)]
MaybeRate = Annotated[StatedNumber | None, _number("Hz", 0.0, 1e9, open_low=True)]
NaturalFrequency = Annotated[StatedNumber, _number("Hz", 0.0, 1e9, open_low=True)]
Level = Annotated[StatedNumber, _number("%", 0.0, 0.9)]
Wide = Annotated[StatedNumber, _number("%", 0.0, 10.0)]
MaybeWide = Annotated[StatedNumber | None, _number("%", 0.0, 10.0)]
Part = Annotated[StatedNumber, _number("%", 0.0, 1.0)]
MaybePart = Annotated[StatedNumber | None, _number("%", 0.0, 1.0)]
Tolerance = Annotated[tuple[StatedNumber, StatedNumber], BeforeValidator(ToleranceReader("%", 0.0, 10.0).read)]
Decibels = Annotated[StatedNumber, _number("dB", -60.0, 60.0)]
MaybeCountOfShocks = Annotated[StatedNumber | None, _number("count", 1, 1_000_000)]
CountOfDirections = Annotated[StatedNumber, _number("count", 1, 6)]
Quality = Annotated[StatedNumber, _number("", 0.5, 1e6)]
PerOctave = Annotated[StatedNumber, _number("", 0.5, 1000.0)]
Words = Annotated[str, BeforeValidator(notes_text)]


def _of(value: float) -> StatedNumber:
    """Return a default, which has no status of its own."""
    return StatedNumber(si=value, typed=value)


class SpecificationTable(CaseTable):
    """A table of a specification; its status and source are those of its numbers that have none."""

    status: Status | Literal[""] = ""
    source: Line = ""

    @model_validator(mode="after")
    def _with_source(self) -> Self:
        if self.status not in ("", INDICATIVE) and not self.source:
            raise InputError("source", MISSING, f"who has it: it is {self.status}")
        return self


class PulseTable(SpecificationTable):
    """[pulse]: the ideal pulse.

    ``duration_level`` is the share of the peak between which the duration is stated: 0 from foot to foot. ``rise`` and
    ``fall`` are shares of the duration of a trapezoid.
    """

    shape: Literal["half-sine", "sawtooth", "trapezoid"]
    peak: MaybePeak = None
    duration: MaybeDuration = None
    duration_level: Level = _of(0.0)
    rise: MaybePart = None
    fall: MaybePart = None

    @model_validator(mode="after")
    def _fits_shape(self) -> Self:
        slopes = [name for name in ("rise", "fall") if getattr(self, name) is not None]
        if self.shape == TRAPEZOID and len(slopes) < 2:
            raise InputError("rise" if "rise" not in slopes else "fall", MISSING, 'a share of the duration, "10 %"')
        if self.shape != TRAPEZOID and slopes:
            raise InputError(slopes[0], getattr(self, slopes[0]).typed, "a trapezoid only", "leave it out")
        if self.rise is not None and self.fall is not None and self.rise.si + self.fall.si > 1.0:
            raise InputError("fall", self.fall.typed, "rise and fall of at most 100 % together")
        return self


class PeakTable(SpecificationTable):
    """[peak]: the tolerance of the peak."""

    tolerance: Tolerance


class WidthTable(SpecificationTable):
    """[width]: at which share of the measured peak the pulse width is taken, and its tolerance, or the least one."""

    level: Level = _of(0.1)
    tolerance: Tolerance
    least: MaybeLeast = None


class VelocityChangeTable(SpecificationTable):
    """[velocity_change]: its tolerance, and over what it is integrated: shares of the duration about the pulse."""

    tolerance: Tolerance
    before: Wide = _of(0.1)
    after: Wide = _of(0.1)


class BandTable(SpecificationTable):
    """[band]: the ideal pulse widened by shares of duration and peak; how long it is watched before and after."""

    time: Part
    amplitude: Wide
    amplitude_before: MaybeWide = None
    amplitude_after: MaybeWide = None
    before: Wide
    after: Wide


class CrossAxisTable(SpecificationTable):
    """[cross_axis]: the largest acceleration across, as a share of the nominal peak."""

    limit: Wide


class CountTable(SpecificationTable):
    """[count]: shocks in each direction, how many more or fewer are allowed, and in how many directions."""

    per_direction: MaybeCountOfShocks = None
    tolerance: MaybeWide = None
    directions: CountOfDirections = _of(6.0)


class RepetitionTable(SpecificationTable):
    """[repetition]: shocks a second."""

    low: MaybeRate = None
    high: MaybeRate = None


class SamplingTable(SpecificationTable):
    """[sampling]: what record and filter must allow."""

    rate: MaybeRate = None
    cutoff: MaybeRate = None


class SpectrumToleranceTable(SpecificationTable):
    """[[srs.tolerance]]: dB about the nominal spectrum within frequencies."""

    model_config = ConfigDict(frozen=True, extra="forbid", populate_by_name=True)

    first: Annotated[NaturalFrequency, Field(alias="from")]
    last: Annotated[NaturalFrequency, Field(alias="to")]
    low: Decibels
    high: Decibels


def _points(raw: Any) -> Any:
    """Return breakpoints: pairs of frequency and level."""
    if not isinstance(raw, list | tuple) or not all(isinstance(one, list | tuple) and len(one) == 2 for one in raw):
        raise InputError("", raw, 'pairs of frequency and level, such as [["100 Hz", "50 g"], ["2 kHz", "1000 g"]]')
    if len(raw) > MOST_POINTS:
        raise InputError("", f"{len(raw)} pairs", f"at most {MOST_POINTS}")
    return tuple(tuple(one) for one in raw)


class SpectrumTable(SpecificationTable):
    """[srs]: the nominal spectrum, what spectrum is meant, and its tolerance.

    ``share`` of the natural frequencies must lie within the tolerance, ``share_above`` at or above nominal.
    """

    points: Annotated[tuple[tuple[NaturalFrequency, Acceleration], ...], BeforeValidator(_points)] = ()
    q: Quality = _of(10.0)
    kind: Literal["absolute"] = "absolute"
    side: Literal["maximax", "positive", "negative"] = "maximax"
    per_octave: PerOctave = _of(12.0)
    share: Part = _of(1.0)
    share_above: MaybePart = None
    tolerance: tuple[SpectrumToleranceTable, ...] = ()

    @model_validator(mode="after")
    def _in_order(self) -> Self:
        frequencies = [point[0].si for point in self.points]
        if len(frequencies) == 1 or any(b <= a for a, b in pairwise(frequencies)):
            raise InputError("points", [point[0].typed for point in self.points], "two breakpoints or more, upwards")
        if not self.tolerance:
            raise InputError("tolerance", MISSING, "one table [[srs.tolerance]] or more")
        for one in self.tolerance:
            if one.last.si <= one.first.si:
                raise InputError("tolerance.to", one.last.typed, "a frequency above from")
            if one.high.si <= one.low.si:
                raise InputError("tolerance.high", one.high.typed, "a level above low")
        return self


class ConditionTable(SpecificationTable):
    """[[condition]]: one severity of several, with what it states of itself."""

    name: Line
    title: Line = ""
    peak: MaybePeak = None
    duration: MaybeDuration = None
    shape: Literal["", "half-sine", "sawtooth", "trapezoid"] = ""
    velocity_change: MaybeVelocityChange = None
    drop_height: MaybeHeight = None
    per_direction: MaybeCountOfShocks = None

    @model_validator(mode="after")
    def _named(self) -> Self:
        odd = [letter for letter in self.name if not (letter.isalnum() or letter in "-._")]
        if not self.name or odd:
            raise InputError("name", self.name, "letters, digits, -, . and _, such as B or 50g-11ms")
        return self


class DemandTable(SpecificationTable):
    """[[demand]]: what is asked in words, and is not judged by a record."""

    text: Line


class SpecificationFile(SpecificationTable):
    """A specification file."""

    schema_: Annotated[Literal[1], Field(alias="schema")]
    title: Line
    edition: Line
    status: Status
    source: Line
    note: Words = ""
    pulse: PulseTable | None = None
    peak: PeakTable | None = None
    width: WidthTable | None = None
    velocity_change: VelocityChangeTable | None = None
    band: BandTable | None = None
    cross_axis: CrossAxisTable | None = None
    count: CountTable | None = None
    repetition: RepetitionTable | None = None
    sampling: SamplingTable | None = None
    srs: SpectrumTable | None = None
    condition: tuple[ConditionTable, ...] = ()
    demand: tuple[DemandTable, ...] = ()

    @model_validator(mode="after")
    def _whole(self) -> Self:
        if self.pulse is None and self.srs is None:
            raise InputError("pulse", MISSING, "a table [pulse], or [srs]")
        if self.pulse is None:
            of_pulse = ("peak", "width", "velocity_change", "band", "cross_axis", "condition")
            needy = [name for name in of_pulse if getattr(self, name)]
            if needy:
                raise InputError("pulse", MISSING, f"a table [pulse], which [{needy[0]}] is about")
            return self
        if len(self.condition) > MOST_CONDITIONS:
            raise InputError("condition", f"{len(self.condition)} tables", f"at most {MOST_CONDITIONS}")
        names = [one.name.lower() for one in self.condition]
        twice = next((one for one in names if names.count(one) > 1), "")
        if twice:
            raise InputError("condition", twice, "a name for each condition", "the case of letters does not matter")
        for key in ("peak", "duration"):
            lacking = [one.name for one in self.condition if getattr(one, key) is None] if self.condition else ["pulse"]
            if getattr(self.pulse, key) is None and lacking:
                where = f"condition {lacking[0]}" if self.condition else "pulse"
                raise InputError(f"{where}: {key}", MISSING, "here, or in [pulse]")
        return self


def numbers_of(file: SpecificationFile) -> Iterator[tuple[str, StatedNumber, str, str]]:
    """Yield every number that a file states, by its path, with its status and source.

    Defaults are not stated, and left out.
    """
    for path, table in tables_of(file):
        for key in type(table).model_fields:
            if key not in table.model_fields_set:
                continue
            name = f"{path}.{type(table).model_fields[key].alias or key}".lstrip(".")
            for place, number in enumerate(_numbers(getattr(table, key))):
                status, source = standing(number, table, file)
                yield (f"{name}.{place}" if place else name), number, status, source


def standing(number: StatedNumber, table: SpecificationTable, file: SpecificationTable) -> tuple[str, str]:
    """Return the status and the source of a number: its own, else those of its table, else those of the file."""
    source = ""
    for level in (number, table, file):
        source = source or level.source
        if level.status:
            return level.status, source or FROM_MEMORY
    raise AssertionError("a file has a status")


def tables_of(file: SpecificationFile) -> Iterator[tuple[str, SpecificationTable]]:
    """Yield the tables of a file with their paths, in their order."""
    for name in type(file).model_fields:
        entry = getattr(file, name)
        if isinstance(entry, SpectrumTable):
            yield name, entry
            for place, row in enumerate(entry.tolerance):
                yield f"{name}.tolerance.{place}", row
        elif isinstance(entry, SpecificationTable):
            yield name, entry
        elif name == "condition":
            yield from ((f"condition.{row.name}", row) for row in entry)


def _numbers(entry: Any) -> Iterator[StatedNumber]:
    if isinstance(entry, StatedNumber):
        yield entry
    elif isinstance(entry, tuple):
        both = len(entry) == 2 and all(isinstance(one, StatedNumber) for one in entry)
        same = both and entry[0].typed == entry[1].typed  # one tolerance, as much down as up
        for one in entry[1:] if same else entry:
            yield from _numbers(one)
