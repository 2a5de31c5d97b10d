"""Specifications as commands: list them, show one, begin a file of one's own, synthesize a base motion."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

from strikewave.analyses.record.specification.result import SpecificationResult, specification_words
from strikewave.base import declare
from strikewave.base.declare import KEY, MAIN, MORE
from strikewave.base.documents import head
from strikewave.base.errors import InputError
from strikewave.base.output_folder import write_atomically
from strikewave.base.result import Source
from strikewave.reporting import measured_files as measured
from strikewave.reporting.faces import columns_of, face_columns
from strikewave.reporting.layout import keys, numerals
from strikewave.reporting.output_options import Output
from strikewave.reporting.parts import NONE
from strikewave.reporting.run_and_write import Command, drawing, run_and_write
from strikewave.reporting.terminal import print_face, print_json, print_rows, say, table, tell
from strikewave.specifications.judging import STATUSES
from strikewave.specifications.reading import (
    Specification,
    load_specification,
    read_built_in,
    read_specification_file,
    specification_names,
)
from strikewave.specifications.tables import numbers_of

if TYPE_CHECKING:
    from strikewave.analyses.record.specification.synthesis import SynthesisResult

# Begin of a new file
HEADER = """\
# A specification of your own, begun from {origin}. Type the numbers of your document, and say at the head what they
# are: status = "normative" where you read them in the standard itself, "quoted" where another text has them,
# "indicative" from memory. A number may say it for itself:
# peak = {{ value = "50 g", status = "normative", source = "clause 4.1" }}.
# strikewave spec show {name} draws it; strikewave {command} FILES --spec {name} judges by it.

"""


@declare.dataclass
class ListedSpecification:
    """A built-in specification in their list."""

    name: str = declare.word("name", column=KEY)
    title: str = declare.word("title", column=MORE, order=1)
    edition: str = declare.word("which edition of the standard")
    kind: str = declare.word("what it asks of, such as half-sine, spectrum", column=MAIN)
    conditions: list[str] = declare.word("names of its conditions", column=MAIN)
    numbers: dict[str, int] = declare.word("how many numbers of each status")
    counted = declare.phrase("numbers", column=MAIN)(
        lambda one: ", ".join(f"{number} {status}" for status, number in one.numbers.items())
    )


@declare.dataclass
class SpecificationList:
    """List of the built-in specifications."""

    specifications: list[ListedSpecification] = declare.rows(ListedSpecification, "the built-in specifications")


def list_specifications(output: Output) -> int:
    """Print the built-in specifications, and return the exit code."""
    rows = []
    for name in specification_names():
        file, _ = read_built_in(name)
        counts = Counter(status for _, _, status, _ in numbers_of(file))
        kind = NONE if file.pulse is None else file.pulse.shape
        kind = "spectrum" if file.srs is not None else kind
        statuses = {status: counts[status] for status in STATUSES if counts[status]}
        conditions = [one.name for one in file.condition]
        rows.append(ListedSpecification(name, file.title, file.edition, kind, conditions, statuses))
    if output.json:
        print_json({**head({}), **declare.content(SpecificationList(rows))})
        return 0
    tell(f"{len(rows)} built-in specifications; NAME:CONDITION asks for one condition.")
    print_rows("Built-in specifications", columns_of(ListedSpecification, rows))
    return 0


def show_specification(name: str, output: Output) -> int:
    """Show a specification, draw it, and return the exit code."""
    asked = _first_condition(name)
    specification = load_specification(asked, "NAME")
    usual = f"spec-{specification.file_name}"
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
        print_face(result, "asked", "What it asks of a shock")
        print_rows("Numbers", face_columns(result, "numbers", least=MORE))
        for one in result.specification.file.demand:
            tell(f"asked too, and not judged: {one.text}")

    def draw(self, result: SpecificationResult, folder: Path) -> list[str]:
        """Write page and picture."""
        from strikewave.analyses.record.specification.report import draw_specification

        return draw_specification(result, folder)


def of_one_condition(text: str, name: str) -> str:
    r"""Return the text of a specification with one of its conditions alone, comments and all.

    Examples
    --------
    >>> text = '[[condition]]\nname = "A"\n[[condition]]\nname = "B"\n'
    >>> of_one_condition(text, "B")
    '[[condition]]\nname = "B"\n'
    """
    import tomlkit

    document = tomlkit.parse(text)
    rows = document["condition"]
    for place in reversed(range(len(rows))):
        if rows[place]["name"] != name:
            del rows[place]
    return tomlkit.dumps(document)


def new_specification(file: Path, origin: str, output: Output) -> int:
    """Write a file that begins from a specification, and return the exit code."""
    if not file.name or file.suffix not in ("", ".toml"):
        raise InputError("FILE", file, "the name of a specification, such as my-shock.toml")
    path = file.with_name(file.stem + ".toml")
    if path.exists() and not output.force:
        raise InputError("FILE", path, "a free name", "add --force to replace it")
    if not path.absolute().parent.is_dir():
        raise InputError("FILE", path, "a file in a folder that exists")
    (_, tables, text), condition = read_specification_file(origin, "--from")
    if condition:
        asked = load_specification(origin, "--from").condition
        text = text if asked is None else of_one_condition(text, asked.name)
    write_atomically(
        path, HEADER.format(origin=origin, name=path, command="record" if tables.srs is None else "srs") + text
    )
    if output.json:
        print_json({**head({}), "written": [str(path)]})
    else:
        say(f"written: {path}; change a number and its status, then: strikewave spec show {path}")
    return 0


def synthesize_specification(name: str, by: str, rate: float | None, output: Output) -> int:
    """Make a base motion that meets a specification of a spectrum, write and print it, and return the exit code."""
    specification = load_specification(name, "NAME")
    specification.spectrum_limits()
    usual = f"synthesis-{specification.file_name}-{by}"
    origin = measured.source_of("command", usual)
    return run_and_write(SynthesisCommand(specification, by, rate, origin), output, usual, origin.text)


@dataclass(frozen=True)
class SynthesisCommand(Command["SynthesisResult"]):
    """A synthesis that is asked for; its parts are imported late, since to show a specification needs none of them."""

    indent: ClassVar[int | None] = None
    of_test: ClassVar[bool] = False

    specification: Specification
    by: str
    rate: float | None
    origin: Source

    def solve(self) -> SynthesisResult:
        """Return the motion with its verdict."""
        from strikewave.analyses.record.specification.synthesis import synthesize

        return synthesize(self.specification, self.by, self.rate, self.origin)

    def summary(self, result: SynthesisResult) -> str:
        """Say the verdict, and what a shaker must reach."""
        from strikewave.analyses.record.specification.synthesis import synthesis_words

        return synthesis_words(result)

    def show(self, result: SynthesisResult) -> None:
        """Print the key numbers and the clauses."""
        from strikewave.analyses.record.verdicts import print_spectra_verdict

        table("The motion", [*keys("quantity"), *numerals("value")], [list(row) for row in result.highlights()])
        print_spectra_verdict(result.verdict)

    def draw(self, result: SynthesisResult, folder: Path) -> list[str]:
        """Write page and picture."""
        from strikewave.analyses.record.specification.synthesis_report import page, picture
        from strikewave.reporting.style import save

        with drawing(folder / "report.html") as path:
            path.write_text(page(result), "utf-8", newline="\n")
        with drawing(folder / "summary.svg") as path:
            save(picture(result), path)
        return ["report.html", "summary.svg"]
