"""Specifications read: the built-in ones by name, one's own by file, a condition of several by ``NAME:CONDITION``."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from functools import cache
from importlib import resources
from pathlib import Path
from typing import Any, NamedTuple

from strikewave.base import declare
from strikewave.base.documents import read_toml
from strikewave.base.errors import EXISTING_FILE, InputError, nearest, show
from strikewave.cases.paths import Form
from strikewave.specifications.ideal_pulses import IdealPulse, PulseBand, from_width
from strikewave.specifications.judging import DecibelBand, Limits, PulseLimits, SpectrumLimits, weakest
from strikewave.specifications.tables import (
    ConditionTable,
    PeakTable,
    SpecificationFile,
    SpecificationTable,
    StatedNumber,
    VelocityChangeTable,
    WidthTable,
    standing,
)

FORM = Form(SpecificationFile, "specification", 'pulse.peak="50 g"')
LARGEST_FILE = 200_000  # bytes of a file
_FILE = re.compile(r"(?P<file>.*\.toml)(?::(?P<condition>[^:/\\]*))?", re.IGNORECASE | re.DOTALL)


class ShockCount(NamedTuple):
    """Number of shocks asked for: in each direction, at least and at most, and the number of directions."""

    low: float
    high: float
    directions: int
    status: str


@declare.dataclass
class Specification:
    """A specification, with one of its conditions where it has several."""

    name: str = declare.word("name of the specification")
    file: SpecificationFile  # its tables
    condition: ConditionTable | None  # the condition; None where there is one severity
    text: str  # the file
    path: str = ""  # path of a file of one's own; empty for a built-in one
    condition_name = declare.computed(declare.word("its condition; null where it has one severity", key="condition"))(
        lambda one: one.condition and one.condition.name
    )

    @property
    def asked(self) -> str:
        """Name and condition."""
        return self.name if self.condition is None else f"{self.name}:{self.condition.name}"

    @property
    def _typed(self) -> str:
        """Name that asks for it: of a file of one's own its path."""
        return self.path or self.asked

    @property
    def file_name(self) -> str:
        """Name and condition as a part of the name of a file."""
        return self.asked.replace(":", "-").lower()

    @declare.computed(declare.word("its title"))
    def title(self) -> str:
        """Title, with that of the condition; of a file of one's own with its name and what it was made from."""
        title = _title_of_own(self.path, self.file) if self.path else self.file.title
        if self.condition is None:
            return title
        return f"{title}, {self.condition.title or f'condition {self.condition.name}'}"

    def _status(self, number: StatedNumber, table: SpecificationTable) -> str:
        return standing(number, table, self.file)[0]

    def _nominal(self, key: str) -> tuple[StatedNumber, str]:
        """Return peak or duration with its status."""
        pulse = self.file.pulse
        assert pulse is not None
        for table in (self.condition, pulse):
            number = getattr(table, key, None)
            if table is not None and number is not None:
                return number, self._status(number, table)
        raise AssertionError("a file has peak and duration")

    @property
    def pulse(self) -> IdealPulse:
        """Ideal pulse of the specification."""
        table = self.file.pulse
        if table is None:
            hint = f"this one is of a spectrum: strikewave srs FILES --spec {self._typed}"
            raise InputError("--spec", self._typed, "a specification of a pulse", hint)
        peak, duration = (self._nominal(key)[0].si for key in ("peak", "duration"))
        shape = (self.condition and self.condition.shape) or table.shape
        slopes = [0.1 if one is None else one.si for one in (table.rise, table.fall)]
        return from_width(shape, peak, duration, table.duration_level.si, *slopes)

    @property
    def status(self) -> str:
        """Status of its peak and duration."""
        return weakest(*(self._nominal(key)[1] for key in ("peak", "duration")))

    def pulse_limits(self) -> PulseLimits:
        """Return its limits for a shock."""
        file, pulse, status = self.file, self.pulse, self.status
        level = 0.1 if file.width is None else file.width.level.si
        peak = None if file.peak is None else self._about(pulse.peak, file.peak, status)
        width = None
        if file.width is not None:
            nominal, least = pulse.width(level), file.width.least
            width = self._about(nominal, file.width, status)
            if least is not None:
                low, high = min(width.low, nominal - least.si), max(width.high, nominal + least.si)
                width = Limits(max(low, 0.0), high, weakest(width.status, self._status(least, file.width)))
        change, window = None, (0.1, 0.1)
        if (table := file.velocity_change) is not None:
            nominal, known, window = pulse.velocity_change, status, (table.before.si, table.after.si)
            if self.condition is not None and self.condition.velocity_change is not None:
                nominal = self.condition.velocity_change.si
                known = self._status(self.condition.velocity_change, self.condition)
            change = self._about(nominal, table, known)
        cross = None
        if file.cross_axis is not None:
            limit = file.cross_axis.limit
            cross = Limits(-math.inf, limit.si * pulse.peak, weakest(status, self._status(limit, file.cross_axis)))
        band, band_status = None, str(file.status)
        if (drawn := file.band) is not None:
            early, late = (math.nan if x is None else x.si for x in (drawn.amplitude_before, drawn.amplitude_after))
            band = PulseBand(pulse, drawn.time.si, drawn.amplitude.si, early, late, drawn.before.si, drawn.after.si)
            stated = [getattr(drawn, key) for key in drawn.model_fields_set]
            band_status = weakest(*(self._status(one, drawn) for one in stated if isinstance(one, StatedNumber)))
        demands: list[Limits | None] = [None, None]
        if (sampling := file.sampling) is not None:
            demands = [
                None if number is None else Limits(number.si, math.inf, self._status(number, sampling))
                for number in (sampling.rate, sampling.cutoff)
            ]
        return PulseLimits(pulse, status, level, peak, width, change, window, cross, band, band_status, *demands)

    def _about(self, nominal: float, table: PeakTable | WidthTable | VelocityChangeTable, status: str) -> Limits:
        """Return the tolerance of a table about a nominal value that has a status."""
        low, high = table.tolerance
        status = weakest(status, self._status(low, table), self._status(high, table))
        return Limits(nominal * (1.0 + low.si), nominal * (1.0 + high.si), status)

    def count(self) -> ShockCount | None:
        """Return how many shocks are asked for; None where nothing is."""
        table = self.file.count
        if table is None:
            return None
        own = self.condition
        holder = table if own is None or own.per_direction is None else own
        number = holder.per_direction
        if number is None:
            return None
        status = weakest(self._status(number, holder), self._status(table.directions, table))
        if table.tolerance is None:
            return ShockCount(number.si, math.inf, int(table.directions.si), status)
        spread = number.si * table.tolerance.si
        status = weakest(status, self._status(table.tolerance, table))
        return ShockCount(number.si - spread, number.si + spread, int(table.directions.si), status)

    def repetition(self) -> Limits | None:
        """Return the shocks a second that are allowed; None where nothing is stated."""
        table = self.file.repetition
        stated = [] if table is None else [one for one in (table.low, table.high) if one is not None]
        if table is None or not stated:
            return None
        low, high = 0.0 if table.low is None else table.low.si, math.inf if table.high is None else table.high.si
        return Limits(low, high, weakest(*(self._status(one, table) for one in stated)))

    def spectrum_limits(self) -> SpectrumLimits:
        """Return its limits for a spectrum."""
        table = self.file.srs
        if table is None:
            known = [name for name in specification_names() if read_built_in(name)[0].srs is not None]
            raise InputError("--spec", self._typed, "a specification of a spectrum", "choose from: " + ", ".join(known))
        if not table.points:
            copied = "" if self.path else f"strikewave spec new FILE.toml --from {self.name}, and "
            raise InputError(
                "--spec",
                self._typed,
                "a specification with breakpoints: here they are the project's",
                copied + 'add them under [srs], such as points = [["20 Hz", "50 g"], ["10 kHz", "5000 g"]]',
            )
        bands = []
        for row in table.tolerance:
            status = weakest(self._status(row.low, row), self._status(row.high, row))
            bands.append(DecibelBand(row.first.si, row.last.si, row.low.si, row.high.si, status))
        status = weakest(*(self._status(one, table) for point in table.points for one in point))
        least = table.share_above
        above = None if least is None else Limits(least.si, math.inf, self._status(least, table))
        share = Limits(table.share.si, math.inf, self._status(table.share, table))
        frequency, level = (tuple(point[k].si for point in table.points) for k in (0, 1))
        return SpectrumLimits(
            frequency,
            level,
            status,
            table.q.si,
            table.kind,
            table.side,
            table.per_octave.si,
            tuple(bands),
            share,
            above,
        )

    edition = declare.computed(declare.word("which edition of the standard"))(lambda one: one.file.edition)


def specification_names() -> list[str]:
    """Return the names of the built-in specifications."""
    folder = resources.files(__package__) / "published"
    return sorted(entry.name.removesuffix(".toml") for entry in folder.iterdir() if entry.name.endswith(".toml"))


def asked_names() -> list[str]:
    """Return the names of the built-in specifications, with their conditions where they have some."""
    return [
        f"{name}:{condition.name}" if condition else name
        for name in specification_names()
        for condition in read_built_in(name)[0].condition or (None,)
    ]


@cache
def read_built_in(name: str) -> tuple[SpecificationFile, str]:
    """Return a built-in specification and its text."""
    text = (resources.files(__package__) / "published" / f"{name}.toml").read_text("utf-8")
    return parse_specification(text, name), text


def load_specification(asked: str, field: str = "--spec") -> Specification:
    """Read a specification."""
    file, wanted = read_specification_file(asked, field)
    name, table, text = file
    own = _FILE.fullmatch(asked)
    return Specification(name, table, _condition(asked, table, wanted, field), text, own["file"] if own else "")


def _title_of_own(path: str, file: SpecificationFile) -> str:
    """Return the title of a file of one's own: not that of the standard from which it was made."""
    for name in specification_names():
        origin = read_built_in(name)[0]
        if origin.title == file.title:
            same = all(one in origin.condition for one in file.condition)
            same = same and file.model_copy(update={"condition": ()}) == origin.model_copy(update={"condition": ()})
            return f"{Path(path).name}, made from {file.title}, {'without' if same else 'with'} changes"
    return f"{file.title} ({Path(path).name})"


def read_specification_file(asked: str, field: str = "--spec") -> tuple[tuple[str, SpecificationFile, str], str]:
    """Return name, tables and text of a specification, and the condition that is asked for, empty for none."""
    match = _FILE.fullmatch(asked)
    if match is not None:
        path = Path(match["file"])
        text = _file_text(path, field)
        return (path.stem, parse_specification(text, f"{field} {path}"), text), match["condition"] or ""
    name, _, condition = asked.partition(":")
    known = {one.lower(): one for one in specification_names()}
    if name.lower() not in known:
        raise InputError(field, asked, "a built-in specification, or a file that ends in .toml", nearest(name, known))
    table, text = read_built_in(known[name.lower()])
    return (known[name.lower()], table, text), condition


def _condition(asked: str, file: SpecificationFile, wanted: str, field: str) -> ConditionTable | None:
    """Return the condition that is asked for."""
    conditions = {one.name.lower(): one for one in file.condition}
    if not conditions:
        if wanted:
            raise InputError(field, asked, "a name without condition", "this specification has one severity")
        return None
    if not wanted and len(conditions) == 1:
        return file.condition[0]
    if wanted.lower() not in conditions:
        names = [one.name for one in file.condition]
        name = asked.rpartition(":")[0] or asked
        hint = _nearest_condition(wanted, names)
        if wanted and hint.startswith("choose"):
            hint += f"; for one of your own: strikewave spec new my-spec.toml --from {name}"
        raise InputError(field, asked, f"a condition, such as {name}:{names[0]}", hint)
    return conditions[wanted.lower()]


def _nearest_condition(wanted: str, names: Sequence[str]) -> str:
    """Return the condition that a word misspells, else all: one with other numbers is another severity, no misspelling.

    Examples
    --------
    >>> _nearest_condition("500-g1ms", ["500g-1ms", "50g-11ms"]), _nearest_condition("1000g-1ms", ["500g-1ms"])
    ('did you mean "500g-1ms"?', 'choose from: 500g-1ms')
    """
    alike = [name for name in names if wanted and re.findall(r"\d+", name) == re.findall(r"\d+", wanted)]
    hint = nearest(wanted, alike) if alike else ""
    return hint if hint.startswith("did you mean") else "choose from: " + ", ".join(names)


def _file_text(path: Path, field: str) -> str:
    try:
        with path.open("rb") as opened:
            data = opened.read(LARGEST_FILE + 1)
    except FileNotFoundError:
        raise InputError(field, path, EXISTING_FILE) from None
    except (OSError, ValueError) as error:
        raise InputError(field, path, "a file that can be read", getattr(error, "strerror", "") or "") from None
    if len(data) > LARGEST_FILE:
        raise InputError(field, path, f"a file of at most {LARGEST_FILE // 1000} kB")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise InputError(field, path, "a TOML file in UTF-8") from None


def parse_specification(text: str, where: str) -> SpecificationFile:
    """Return the tables of a specification."""
    try:
        document: Mapping[str, Any] = read_toml(text)
    except ValueError as error:
        raise InputError(where, show(str(error), 120).strip('"'), "a specification in TOML") from None
    return FORM.read(document, f"{where}: ")
