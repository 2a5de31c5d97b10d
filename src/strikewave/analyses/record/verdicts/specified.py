"""Specifications as a command: list them, show one, begin a file of one's own."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar, NamedTuple

from strikewave.analyses.record.verdicts.words import limit_words
from strikewave.base.errors import InputError
from strikewave.base.json_document import head
from strikewave.base.output_folder import write_atomically
from strikewave.base.result import Source
from strikewave.reporting import measured_files as measured
from strikewave.reporting.columns import Column
from strikewave.reporting.layout import MORE, keys, numerals, texts
from strikewave.reporting.numbers import listed, with_unit
from strikewave.reporting.options import Output
from strikewave.reporting.parts import NONE, Tag
from strikewave.reporting.run_and_write import Command, run_and_write
from strikewave.reporting.shown_result import columns_of
from strikewave.reporting.terminal import print_json, say, table, tell
from strikewave.specifications.judging import QUOTED, STATUSES, Clause, Limits, judged
from strikewave.specifications.reading import (
    Specification,
    load_specification,
    read_built_in,
    read_specification_file,
    specification_names,
)
from strikewave.specifications.tables import SpecificationFile, numbers_of

STATUS_LOOKS = {"normative": "good", QUOTED: "", "indicative": "warned"}
HEADER = """\
# A specification of your own, begun from {origin}. Type the numbers of your document, and say at the head what they
# are: status = "normative" where you read them in the standard itself, "quoted" where another text has them,
# "indicative" from memory. A number may say it for itself:
# peak = {{ value = "50 g", status = "normative", source = "clause 4.1" }}.
# strikewave spec show {name} draws it; strikewave record FILES --spec {name} judges by it.

"""
"""Begin of a new file."""


class NumberRow(NamedTuple):
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
    def numbers(self) -> list[NumberRow]:
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


def number_rows(file: SpecificationFile, condition: str | None = None) -> list[NumberRow]:
    """Return the numbers of a file, of one condition alone where that is named."""
    rows = [
        NumberRow(path, str(number.typed), number.si, status, source, number.note)
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


def list_specifications(output: Output) -> int:
    """Print the built-in specifications, and return the exit code."""
    rows, entries = [], []
    for name in specification_names():
        file, _ = read_built_in(name)
        counts = Counter(status for _, _, status, _ in numbers_of(file))
        conditions = [one.name for one in file.condition]
        kind = NONE if file.pulse is None else file.pulse.shape
        kind = "spectrum" if file.srs is not None else kind
        statuses = {status: counts[status] for status in STATUSES if counts[status]}
        entries.append(
            {
                "name": name,
                "title": file.title,
                "edition": file.edition,
                "kind": kind,
                "conditions": conditions,
                "numbers": statuses,
            }
        )
        many = ", ".join(f"{number} {status}" for status, number in statuses.items())
        rows.append([name, kind, ", ".join(conditions) or NONE, many, file.title])
    if output.json:
        print_json({**head({}), "specifications": entries})
        return 0
    tell(f"{len(rows)} built-in specifications; NAME:CONDITION asks for one condition.")
    columns = [*keys("name"), *texts("kind"), *texts("conditions"), *texts("numbers"), *texts("title", priority=MORE)]
    table("Built-in specifications", columns, rows)
    return 0


def show_specification(name: str, output: Output) -> int:
    """Show a specification, draw it, and return the exit code.

    Raises
    ------
    InputError, InputErrors
        If it cannot be read.
    """
    asked = _first_condition(name)
    specification = load_specification(asked, "NAME")
    usual = "spec-" + specification.asked.replace(":", "-").lower()
    origin = measured.source_of("command", usual)
    return run_and_write(SpecificationCommand(specification, origin), output, usual, origin.text)


def _first_condition(name: str) -> str:
    """Return a name with the first of its conditions, where it has several and none is asked for."""
    (_, file, _), condition = read_specification_file(name, "NAME")
    return name if condition or len(file.condition) < 2 else f"{name.rstrip(':')}:{file.condition[0].name}"


@dataclass(frozen=True)
class SpecificationCommand(Command[SpecificationResult]):
    """A specification that is shown."""

    of_test: ClassVar[bool] = False

    specification: Specification
    origin: Source

    def solve(self) -> SpecificationResult:
        """Return it."""
        return SpecificationResult(self.specification, origin=self.origin)

    def summary(self, result: SpecificationResult) -> str:
        """Say what it is, and how well its numbers are known."""
        return specification_words(result)

    def show(self, result: SpecificationResult) -> None:
        """Print what it asks, and its numbers."""
        rows = [[clause.clause, asked_words(clause), clause.status] for clause in result.clauses]
        if rows:
            table("What it asks of a shock", [*keys("clause"), *numerals("limit"), *texts("status")], rows)
        numbers = [[row.path, row.typed, row.status, row.source] for row in result.numbers]
        columns = [*keys("number"), *numerals("value"), *texts("status"), *texts("source", priority=MORE)]
        table("Numbers", columns, numbers)
        for one in result.specification.file.demand:
            tell(f"asked too, and not judged: {one.text}")

    def draw(self, result: SpecificationResult, folder: Path) -> list[str]:
        """Write page and picture."""
        from strikewave.analyses.record.verdicts.drawn import draw_specification

        return draw_specification(result, folder)


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


def new_specification(file: Path, origin: str, output: Output) -> int:
    """Write a file that begins from a specification, and return the exit code.

    Raises
    ------
    InputError
        If the name is no free one of a file, or there is nothing to begin from.
    """
    if not file.name or file.suffix not in ("", ".toml"):
        raise InputError("FILE", str(file), "the name of a specification, such as my-shock.toml")
    path = file.with_name(file.stem + ".toml")
    if path.exists() and not output.force:
        raise InputError("FILE", str(path), "a name that is not taken", "add --force to replace it")
    if not path.absolute().parent.is_dir():
        raise InputError("FILE", str(path), "a file in a folder that exists")
    (_, _, text), _ = read_specification_file(origin, "--from")
    write_atomically(path, HEADER.format(origin=origin.partition(":")[0], name=path) + text)
    if output.json:
        print_json({**head({}), "written": [str(path)]})
    else:
        say(f"written: {path}; change a number and its status, then: strikewave spec show {path}")
    return 0
