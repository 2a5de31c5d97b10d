"""A specification as a result: what it asks, and its numbers with status and source."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from typing import Any, ClassVar, NamedTuple

from strikewave.reporting import measured_files as measured
from strikewave.reporting.clause_words import limit_words
from strikewave.reporting.columns import Column
from strikewave.reporting.numbers import listed, with_unit
from strikewave.reporting.parts import Tag
from strikewave.reporting.shown_result import columns_of
from strikewave.specifications.judging import QUOTED, STATUSES, Clause, Limits, judged
from strikewave.specifications.reading import (
    Specification,
)
from strikewave.specifications.tables import SpecificationFile, numbers_of

STATUS_LOOKS = {"normative": "good", QUOTED: "", "indicative": "warned"}


class SpecificationNumber(NamedTuple):
    """A number of a specification: path in its file, as typed, in SI, status, source, note."""

    path: str
    typed: str
    si: float
    status: str
    source: str
    note: str


@dataclass(frozen=True)
class SpecificationResult(measured.AskedResult):
    """One specification with its numbers; see `Result` for what it shares with others.

    Attributes
    ----------
    specification : Specification
        The specification.
    """

    command: ClassVar[str] = "spec"

    specification: Specification

    @property
    def title(self) -> str:
        """Its title."""
        return self.specification.title

    @property
    def numbers(self) -> list[SpecificationNumber]:
        """Its numbers; of other conditions than the one asked for, none."""
        condition = self.specification.condition
        return number_rows(self.specification.file, None if condition is None else condition.name)

    @property
    def clauses(self) -> list[Clause]:
        """What it asks, as clauses without a value."""
        return asked_clauses(self.specification)

    def units(self) -> dict[str, str]:
        """Return the unit of each key of the JSON document."""
        return {"si": "that of each number"}

    def content(self) -> dict[str, Any]:
        """Return what the JSON document holds beside its head."""
        file = self.specification.file
        return {
            **self.specification.document(),
            "status": file.status,
            "source": file.source,
            "note": file.note,
            "numbers": [row._asdict() for row in self.numbers],
            "demands": [{"text": one.text, "status": one.status or file.status} for one in file.demand],
        }

    def highlights(self) -> list[tuple[str, str]]:
        """Return how many numbers there are of each status."""
        counts = Counter(row.status for row in self.numbers)
        return [(f"{status} numbers", str(counts[status])) for status in STATUSES if counts[status]]

    def columns(self) -> list[Column]:
        """Return its numbers."""
        return columns_of([row._asdict() for row in self.numbers], {})

    def brief(self) -> dict[str, str]:
        """Return path, number, status and source."""
        return dict.fromkeys(("path", "typed", "status", "source"), "")

    def texts(self) -> dict[str, str]:
        """Return the JSON document and the specification itself as files."""
        return {"spec.json": self.document_text(2), "specification.toml": self.specification.text}


def number_rows(file: SpecificationFile, condition: str | None = None) -> list[SpecificationNumber]:
    """Return the numbers of a file, of one condition alone where that is named."""
    rows = [
        SpecificationNumber(path, str(number.typed), number.si, status, source, number.note)
        for path, number, status, source in numbers_of(file)
    ]
    return [row for row in rows if condition is None or not _of_another(row.path, condition)]


def _of_another(path: str, condition: str) -> bool:
    return path.startswith("condition.") and not path.startswith(f"condition.{condition}.")


def asked_clauses(specification: Specification) -> list[Clause]:
    """Return what a specification asks, as clauses; of a spectrum there are none."""
    if specification.file.pulse is None:
        return []
    limits = specification.pulse_limits()
    nan = float("nan")
    found = [
        judged("nominal peak", limits.pulse.peak, Limits(nan, nan, limits.status), "m/s^2"),
        judged("nominal duration", limits.pulse.duration, Limits(nan, nan, limits.status), "s"),
    ]
    asked = (
        ("peak", limits.peak, "m/s^2"),
        (f"pulse width at {100.0 * limits.level:g} %", limits.width, "s"),
        ("velocity change", limits.velocity_change, "m/s"),
        ("cross-axis", limits.cross_axis, "m/s^2"),
        ("sampling rate", limits.rate, "Hz"),
        ("filter", limits.cutoff, "Hz"),
        ("shocks a second", specification.repetition(), "Hz"),
    )
    found += [judged(name, nan, one, unit) for name, one, unit in asked if one is not None]
    count = specification.count()
    if count is not None:
        each = f"shocks in each of {count.directions} directions"
        found.append(judged(each, nan, Limits(count.low, count.high, count.status), "1"))
    return found


def asked_words(clause: Clause) -> str:
    """Write what a clause asks: its nominal value, or its limits."""
    if clause.clause.startswith("nominal"):
        usual = "g" if clause.unit == "m/s^2" else "ms" if clause.value >= 1e-3 else "us"
        return with_unit(clause.value, clause.unit, usual)
    return limit_words(clause)


def specification_words(result: SpecificationResult) -> str:
    """Say what a specification is, and how well its numbers are known."""
    file = result.specification.file
    counts = Counter(row.status for row in result.numbers)
    many = listed([f"{counts[status]} {status}" for status in STATUSES if counts[status]])
    words = [f"{result.title} ({file.edition}). Its numbers: {many}. Source: {file.source}."]
    if file.note:
        words.append(" ".join(file.note.split()))
    others = [f"{result.specification.name}:{one.name}" for one in file.condition]
    if len(others) > 1:
        words.append(f"Conditions: {', '.join(one.name for one in file.condition)}.")
    return " ".join(words)


def status_cell(status: str) -> Tag:
    """Return a status as a tag."""
    return Tag(status, STATUS_LOOKS[status])
