"""Commands on cases and materials: ``new``, ``validate``, ``diff``, ``cases``, ``materials``."""

from __future__ import annotations

import functools
import os
from collections import Counter
from collections.abc import Mapping, Sequence
from importlib import resources
from pathlib import Path
from typing import Annotated, Any

import typer

from strikewave.base import declare
from strikewave.base.constants import Material, materials
from strikewave.base.declare import KEY, MAIN, MORE
from strikewave.base.documents import head
from strikewave.base.errors import InputError
from strikewave.base.output_folder import write_atomically
from strikewave.base.quantities import PROVENANCES, StatedValue, Value
from strikewave.base.result import Notice
from strikewave.base.texts import command_line, file_word
from strikewave.cases.case import comment_lines, document_of, dump_case, load_case, own_case, parse_case
from strikewave.cases.files import bundled_cases, read_case_text
from strikewave.cases.performed_test import example_file
from strikewave.cases.tables.common import EXAMPLE as TEST_EXAMPLE
from strikewave.reporting.layout import keys, texts
from strikewave.reporting.numbers import showing
from strikewave.reporting.options import CaseName, Changes, case_name, complete_case
from strikewave.reporting.output_options import Show, Shown
from strikewave.reporting.terminal import print_json, print_rows, say, show_notices, table, tell
from strikewave.specifications.budget_file import example_budget

HOPKINSON = "hopkinson"
"""Word for the example of a set-up of split bars, and the command that runs it."""
TEST = "test"
"""Word for a file of a test to fill in, which ``--test`` takes."""
FELT = "felt"
"""Word for a drop table on a felt pad, none of whose values is published: it is no built-in case."""
BUDGET = "budget"
"""Word for an uncertainty budget to fill in, which ``--uncertainty`` takes."""
HEADER = """\
# A case of your own, begun from {origin}. Replace what you know of your machine: a value that you type alone, such as
# mass = "1.2 kg", is yours (provenance user); {{ value = "1.2 kg", provenance = "measured", tolerance = "5 gram",
# note = "weighed" }} also says how, and how well it is known. compare = true adds the comparison with published
# values of {origin}, where it has any.

"""
"""Begin of a new case file."""


def _complete(incomplete: str) -> list[str]:
    """Return the names that a case may begin from."""
    others = [name for name in (FELT, HOPKINSON, TEST, BUDGET) if name.startswith(incomplete)]
    return [*complete_case(incomplete), *others]


def new_case(
    file: Annotated[
        Path, typer.Argument(help="The case file to write; .toml is added where it lacks.", show_default=False)
    ],
    *,
    origin: Annotated[
        str,
        typer.Option(
            "--from",
            metavar="CASE",
            help="The case to begin from; felt for a drop table on felt, hopkinson for a set-up of split Hopkinson "
            "bars, test for a test report, budget for an uncertainty budget.",
            autocompletion=_complete,
        ),
    ] = "li-ma-2019",
    force: Annotated[bool, typer.Option("--force", help="Replace the file.")] = False,
    shown: Shown,
) -> int:
    """Write a new case file to edit.

    Every value has its provenance, and a comment: what it is, how to get it on a real machine, why this default.
    """
    if not file.name or file.suffix not in ("", ".toml"):
        raise InputError("FILE", file, "the name of a case file, such as my-machine.toml")
    path = file.with_name(file.stem + ".toml")
    if path.exists() and not force:
        raise InputError("FILE", path, "a free name", "add --force to replace it")
    if not path.absolute().parent.is_dir():
        raise InputError("FILE", path, "a file in a folder that exists")
    if origin == TEST:
        write_atomically(path, example_file())
        line = ["record", "FILES", "--spec", "NAME", "--test", str(path)]
        _tell(shown, [path], "record", "fill in what you have", line)
        return 0
    if origin == BUDGET:
        write_atomically(path, example_budget())
        _tell(shown, [path], "record", "type your numbers", ["record", "FILES", "--uncertainty", str(path)])
        return 0
    if origin == HOPKINSON:
        record = _write_example(path)
        _tell(shown, [path, record], HOPKINSON, "a measured shot; name your bars and files")
        return 0
    felt = resources.files("strikewave.cases") / "felt_start.toml"
    begun = parse_case(felt.read_text("utf-8")) if origin == FELT else load_case(origin)
    case = own_case(begun, path.stem, origin)
    comments = functools.partial(comment_lines, kind=case.machine.kind if case.machine else "")
    text = HEADER.format(origin=origin) + dump_case(case, comments)
    parse_case(text)  # refuses a name that no result folder may have
    write_atomically(path, text if case.test.stated() else text + TEST_EXAMPLE)
    _tell(shown, [path], case.command, "change a value")
    return 0


def _tell(shown: Shown, paths: Sequence[Path], command: str, words: str, line: Sequence[str] = ()) -> None:
    """Name the files that were written, and the next command."""
    if shown.json:
        print_json({**head({}), "written": [str(path) for path in paths], "command": command})
    else:
        then = command_line(line or [command, file_word(str(paths[0]))])
        say(f"written: {' and '.join(map(str, paths))}; {words}, then: {then}")


def _write_example(path: Path) -> Path:
    """Write a set-up of split bars, and beside it the record that it names; return the path of the record."""
    from strikewave.analyses.hopkinson.build import example_record, example_setup

    name, record = example_record(path.stem)
    beside = path.with_name(name)
    if os.path.lexists(beside) and not (beside.is_file() and beside.read_bytes() == record.encode()):
        hint = "move it, or give the set-up another name: no file of yours is replaced by the example's record"
        raise InputError("FILE", beside, "a free name", hint)
    write_atomically(beside, record)
    write_atomically(path, example_setup(name) + TEST_EXAMPLE)
    return beside


@declare.dataclass
class CheckedCase:
    """A case that was checked, and its values."""

    case: str = declare.word("name of the case")
    provenance: dict[str, int] = declare.word("how many values of each provenance")
    values: dict[str, StatedValue] = declare.named(StatedValue, "values by their paths")


def validate_case(case: CaseName, *, changes: Changes = None, shown: Shown) -> int:
    """Check a case without running it.

    Lists every value and where it comes from, and names densities and moduli far from those of any known material.
    """
    from strikewave.analyses.by_tables import check_case, holds_setup
    from strikewave.analyses.fem.build import build_model
    from strikewave.analyses.hopkinson.build import check_setup, load_setup, values_of
    from strikewave.cases.materials_of_case import far_numbers, material_notices

    if holds_setup(read_case_text(case)[0]):
        setup_case = load_setup(case, changes or ())
        missing, setup = check_setup(setup_case), setup_case.setup
        _show(setup.name, setup.title, dict(values_of(setup)), tuple(far_numbers(setup)), shown.json)
        if missing:
            say("not there yet: " + ", ".join(missing))
        return 0
    read = load_case(case, changes or ())
    check_case(read)
    if read.fem is not None:
        build_model(read)
    _show(read.name, read.title, read.values(), tuple(material_notices(read)), shown.json)
    if read.fem is not None:
        say(f"the mesh fits together; not checked: what boundaries and ties hold (strikewave fem {case} --check)")
    return 0


def _show(name: str, title: str, values: Mapping[str, Value], notices: Sequence[Notice], json: bool) -> None:
    """Print the values of a case with their provenance, and notices on them."""
    counted = Counter[str]([value.provenance for value in values.values()])
    if json:
        stated = {}
        for path, value in values.items():
            band = value.tolerance
            width = (None, None) if band is None else (value.half_width, band.distribution)
            stated[path] = StatedValue(value.si, value.typed, value.provenance, value.note, *width)
        checked = CheckedCase(name, dict(counted), stated)
        warnings = [notice.document() for notice in notices]
        print_json({**head({"value": "SI"}, warnings), **declare.content(checked)})
        return
    counts = ", ".join(f"{counted[provenance]} {provenance}" for provenance in PROVENANCES if counted[provenance])
    tell(f"valid: {counts}")
    shown = [[path, _typed(v), v.provenance, v.note] for path, v in values.items()]
    table(title or name, [*keys("field"), *texts("value"), *texts("provenance"), *texts("note", priority=MORE)], shown)
    show_notices(notices)


def _typed(value: Value) -> str:
    """Return a value as it was typed, with its tolerance."""
    band = value.tolerance
    if band is None:
        return str(value.typed)
    return f"{value.typed} ± {band.typed}" + (f" ({band.distribution})" if band.distribution != "normal" else "")


@declare.dataclass
class CaseDifference:
    """A field in which two cases differ."""

    field: str = declare.word("path of a field that differs", column=KEY)
    a: str | None = declare.word("as the first has it; null where it lacks it", label="A", column=MAIN)
    b: str | None = declare.word("as the second has it", label="B", column=MAIN)


@declare.dataclass
class CaseDifferences:
    """The differences of two cases."""

    a: str = declare.word("first case")
    b: str = declare.word("second case")
    differences: list[CaseDifference] = declare.rows(CaseDifference, "fields that differ")


def flat(document: dict[str, Any], prefix: str = "") -> dict[str, str]:
    """Return a case document as path: text.

    Examples
    --------
    >>> flat({"machine": {"speed": {"value": "730 rpm", "provenance": "published"}}})
    {'machine.speed': '730 rpm (published)'}
    """
    rows: dict[str, str] = {}
    for key, value in document.items():
        path = f"{prefix}{key}"
        if isinstance(value, dict) and "value" in value and "provenance" in value:
            rows[path] = f"{value['value']} ({value['provenance']})"
        elif isinstance(value, dict):
            rows |= flat(value, f"{path}.")
        elif isinstance(value, list):
            for place, entry in enumerate(value):
                inner = f"{path}.{place}"
                rows |= flat(entry, f"{inner}.") if isinstance(entry, dict) else {inner: str(entry)}
        else:
            rows[path] = str(value)
    return rows


def diff_cases(
    a: Annotated[str, case_name("A", "A case file, or the name of a built-in case.")],
    b: Annotated[str, case_name("B", "Another case to compare with A.")],
    *,
    shown: Shown,
) -> int:
    """List the differences of two cases."""
    from strikewave.reporting.faces import columns_of

    rows = [flat(document_of(load_case(name))) for name in (a, b)]
    paths = [path for path in dict.fromkeys([*rows[0], *rows[1]]) if rows[0].get(path) != rows[1].get(path)]
    found = CaseDifferences(a, b, [CaseDifference(path, *(row.get(path) for row in rows)) for path in paths])
    if shown.json:
        print_json({**head({}), **declare.content(found)})
    elif paths:
        tell(f"{a} (A) and {b} (B) differ in {len(paths)} field{'s' if len(paths) > 1 else ''}.")
        print_rows("Differences", columns_of(CaseDifference, found.differences))
    else:
        tell("the cases are equal")
    return 0


@declare.dataclass
class ListedCase:
    """A built-in case."""

    name: str = declare.word("name of a built-in case")

    @declare.phrase("to run it", column=KEY)
    def line(self) -> str:
        """Return the command line that runs it."""
        return f"strikewave {self.command} {self.name}"

    title: str = declare.word("its title", column=MAIN)
    source: str = declare.word("its source")
    command: str = declare.word("command that runs it")


@declare.dataclass
class CaseList:
    """The built-in cases."""

    cases: list[ListedCase] = declare.rows(ListedCase, "the built-in cases")


def list_cases(shown: Shown) -> int:
    """List the built-in cases."""
    from strikewave.reporting.faces import columns_of

    read = [load_case(name) for name in bundled_cases()]
    listed = CaseList([ListedCase(one.name, one.title, one.source, one.command) for one in read])
    if shown.json:
        print_json({**head({}), **declare.content(listed)})
    else:
        tell(f"{len(read)} built-in cases.")
        print_rows("Built-in cases", columns_of(ListedCase, listed.cases))
    return 0


@declare.dataclass
class MaterialList:
    """All materials."""

    materials: list[Material] = declare.rows(Material, "the materials")


def list_materials(*, show: Show = None, shown: Shown) -> int:
    """List the materials with their sources.

    Elastic constants, yield strength, hardness, loss factor, status and source.
    """
    from strikewave.reporting.faces import columns_of

    listed = MaterialList(list(materials().values()))
    if shown.json:
        print_json({**head(declare.units(MaterialList)), **declare.content(listed)})
        return 0
    with showing(show):
        tell(f"{len(listed.materials)} materials; --json has the source of each.")
        print_rows("Materials", columns_of(Material, listed.materials))
    return 0
