"""A specification as a result: what it asks, and its numbers with status and source."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable
from typing import ClassVar

from strikewave.analyses.clauses import limit_words
from strikewave.base import declare
from strikewave.base.declare import KEY, MAIN, MORE, NOT_MEASURED, Quantity
from strikewave.base.shock_quantities import ACCELERATION, MICROSECONDS, MILLISECONDS
from strikewave.reporting import measured_files as measured
from strikewave.reporting.faces import amount
from strikewave.reporting.numbers import listed
from strikewave.specifications.judging import STATUSES, Limits, judged
from strikewave.specifications.reading import Specification
from strikewave.specifications.tables import SpecificationFile, numbers_of


@declare.dataclass
class StatedOfAll:
    """Status and source of the numbers of a specification."""

    status: str = declare.word("of numbers that say nothing else: normative, quoted or indicative")
    source: str = declare.word("where they come from")
    note: str = declare.word("what is said of them")


@declare.dataclass
class SpecificationNumber:
    """A number of a specification."""

    path: str = declare.word("place of a number in the file", label="number", column=KEY)
    typed: str = declare.number(NOT_MEASURED, "as typed", label="value", column=MAIN)
    si: float = declare.number(Quantity.of_data("that of each number"), "SI")
    status: str = declare.word("how it is known", column=MAIN, is_tag=True)
    source: str = declare.word("from whom", column=MORE)
    note: str = declare.word("what is said of it")
    said = declare.phrase("note", column=MORE + 1)(lambda one: one.note or None)


@declare.dataclass
class DemandRow:
    """Demand of a standard that no record is judged by."""

    text: str = declare.word("what the standard demands, in words", label="what", column=KEY)
    status: str = declare.word("how it is known", column=MAIN, is_tag=True)


@declare.dataclass
class AskedRow:
    """Demand on a shock."""

    clause: str = declare.word("what is asked", column=KEY)
    limit: str = declare.number(NOT_MEASURED, "its nominal value, or its limits", column=MAIN)
    status: str = declare.word("how it is known", column=MAIN, is_tag=True)


@declare.dataclass
class StatusCount:
    """Count of numbers of a status."""

    name: str = declare.word("the status")
    count: int = declare.count("how many numbers", headline="{name} numbers")


@declare.dataclass
class SpecificationResult(measured.AskedResult):
    """One specification with its numbers; see `Result` for what it shares with others."""

    command: ClassVar[str] = "spec"
    main_rows: ClassVar[str] = "numbers"

    specification: Specification = declare.part(Specification, "the specification", inline=True)

    @property
    def title(self) -> str:
        """Title of the specification."""
        return self.specification.title

    @declare.computed(declare.part(StatedOfAll, "of its numbers", inline=True))
    def stated(self) -> StatedOfAll:
        """Statements of its file on all numbers."""
        file = self.specification.file
        return StatedOfAll(file.status, file.source, file.note)

    @declare.computed(declare.rows(SpecificationNumber, "its numbers"))
    def numbers(self) -> list[SpecificationNumber]:
        """Numbers, without those of other conditions than the one asked for."""
        condition = self.specification.condition
        return number_rows(self.specification.file, None if condition is None else condition.name)

    @declare.computed(declare.rows(DemandRow, "what the standard demands in words, with its status"))
    def demands(self) -> list[DemandRow]:
        """Demands that are not judged by a record."""
        return [DemandRow(one.text, one.status or self.stated.status) for one in self.specification.file.demand]

    asked = declare.computed(declare.rows(AskedRow, "what it asks of a shock", in_document=False))(
        lambda result: asked_rows(result.specification)
    )

    @declare.computed(declare.rows(StatusCount, "numbers by status", in_document=False, headline="each"))
    def counts(self) -> list[StatusCount]:
        """Counts of numbers by status."""
        counts = Counter(row.status for row in self.numbers)
        return [StatusCount(status, counts[status]) for status in STATUSES if counts[status]]

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


def asked_rows(specification: Specification, named: Callable[[str], str] = str) -> list[AskedRow]:
    """Return what a specification asks of a shock, of a spectrum nothing; ``named`` is what clauses are called."""
    if specification.file.pulse is None:
        return []
    limits, count = specification.pulse_limits(), specification.count()
    pulse, status = limits.pulse, limits.status
    duration = amount(MILLISECONDS if pulse.duration >= 1e-3 else MICROSECONDS, pulse.duration)
    asked = [
        ("peak", limits.peak, "m/s^2"),
        (f"pulse width at {100.0 * limits.level:g} %", limits.width, "s"),
        ("velocity change", limits.velocity_change, "m/s"),
        ("cross-axis", limits.cross_axis, "m/s^2"),
        ("sampling rate", limits.rate, "Hz"),
        ("filter", limits.cutoff, "Hz"),
        ("shocks a second", specification.repetition(), "Hz"),
    ]
    if count is not None:
        each = f"shocks in each of {count.directions} directions"
        asked.append((each, Limits(count.low, count.high, count.status), "1"))
    return [
        AskedRow("nominal peak", amount(ACCELERATION, pulse.peak), status),
        AskedRow("nominal duration", duration, status),
        *(
            AskedRow(named(name), limit_words(judged(name, math.nan, one, unit)), one.status)
            for name, one, unit in asked
            if one is not None
        ),
    ]


def specification_words(result: SpecificationResult) -> str:
    """Say what a specification is, and how well its numbers are known."""
    file = result.specification.file
    many = listed([f"{one.count} {one.name}" for one in result.counts])
    words = [f"{result.title} ({file.edition}). Its numbers: {many}. Source: {file.source}."]
    if file.note:
        words.append(" ".join(file.note.split()))
    others = [f"{result.specification.name}:{one.name}" for one in file.condition]
    if len(others) > 1:
        words.append(f"Conditions: {', '.join(one.name for one in file.condition)}.")
    return " ".join(words)
