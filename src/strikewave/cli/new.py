"""``strikewave new``: begin a case from a built-in one or on felt, split bars, a file of a test, a budget."""

from __future__ import annotations

import functools
import os
from collections.abc import Sequence
from importlib import resources
from pathlib import Path
from typing import Annotated

import typer

from strikewave.base.command_line import command_line, file_word
from strikewave.base.errors import InputError
from strikewave.base.json_document import head
from strikewave.base.output_folder import write_atomically
from strikewave.cases.case import Case, load_case, own_case, parse_case
from strikewave.cases.explained import comment_lines
from strikewave.cases.stated_test import example_file
from strikewave.cases.tables.performed_test import EXAMPLE as TEST_EXAMPLE
from strikewave.cases.written_case import dump_case
from strikewave.reporting.options.output import Shown
from strikewave.reporting.options.shared import complete_case
from strikewave.reporting.terminal import print_json, say
from strikewave.specifications.budget_file import example_budget

HOPKINSON = "hopkinson"
"""Stands for the example of a set-up of split bars, and is the command that it is for."""
TEST = "test"
"""Stands for a file of a test to fill in, which ``--test`` takes."""
FELT = "felt"
"""Stands for a drop table on a felt pad, none of whose values is published: it is no built-in case."""
BUDGET = "budget"
"""Stands for an uncertainty budget to fill in, which ``--uncertainty`` takes."""
HEADER = """\
# A case of your own, begun from {origin}. Replace what you know of your machine: a value that you type alone, such as
# mass = "1.2 kg", is yours (provenance user); {{ value = "1.2 kg", provenance = "measured", tolerance = "5 gram",
# note = "weighed" }} also says how, and how well it is known. compare = true adds the comparison with published
# values of {origin}, where it has any.

"""
"""Begin of a new case file."""


def _complete(incomplete: str) -> list[str]:
    """Return what a case may begin from."""
    return [
        *complete_case(incomplete),
        *(name for name in (FELT, HOPKINSON, TEST, BUDGET) if name.startswith(incomplete)),
    ]


def command(
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
        raise InputError("FILE", str(file), "the name of a case file, such as my-machine.toml")
    path = file.with_name(file.stem + ".toml")
    if path.exists() and not force:
        raise InputError("FILE", str(path), "a name that is not taken", "add --force to replace it")
    if not path.absolute().parent.is_dir():
        raise InputError("FILE", str(path), "a file in a folder that exists")
    if origin == TEST:
        write_atomically(path, example_file())
        _tell(
            shown, [path], "record", "fill in what you have", ["record", "FILES", "--spec", "NAME", "--test", str(path)]
        )
        return 0
    if origin == BUDGET:
        write_atomically(path, example_budget())
        _tell(shown, [path], "record", "type your numbers", ["record", "FILES", "--uncertainty", str(path)])
        return 0
    if origin == HOPKINSON:
        record = _write_example(path)
        _tell(shown, [path, record], HOPKINSON, "a measured shot; name your bars and files")
        return 0
    case = own_case(_felt_start() if origin == FELT else load_case(origin), path.stem, origin)
    comments = functools.partial(comment_lines, kind=case.machine.kind if case.machine else "")
    text = HEADER.format(origin=origin) + dump_case(case, comments)
    parse_case(text)  # refuses a name that no result folder may have
    write_atomically(path, text if case.test.stated() else text + TEST_EXAMPLE)
    _tell(shown, [path], case.command, "change a value")
    return 0


def _felt_start() -> Case:
    """Return the drop table on felt."""
    return parse_case((resources.files("strikewave.cases") / "felt_start.toml").read_text("utf-8"))


def _tell(shown: Shown, paths: Sequence[Path], command: str, words: str, line: Sequence[str] = ()) -> None:
    """Say which files were written, and what to do next."""
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
        raise InputError("FILE", str(beside), "no other file of this name there", hint)
    write_atomically(beside, record)
    write_atomically(path, example_setup(name) + TEST_EXAMPLE)
    return beside
