"""What the pages of all kinds of cases have in common, as plain values; it runs in processes of the app."""

from __future__ import annotations

import functools
import tempfile
from pathlib import Path
from typing import Any, NamedTuple

from strikewave.base.errors import InputError
from strikewave.base.result import Result
from strikewave.cases.case import load_case
from strikewave.cases.case_files import bundled_cases
from strikewave.cases.written_case import dump_case
from strikewave.reporting.shown_result import ShownResult
from strikewave.web.case.fields import edited_fields
from strikewave.web.case.layers import listed_stack
from strikewave.web.case.loading import loaded
from strikewave.web.case.state import CaseSource


class PageOfCases(NamedTuple):
    """A page of cases: its address, and its name."""

    place: str
    name: str


PAGES_OF = {
    "run": PageOfCases("/", "Machine"),
    "wave": PageOfCases("/target", "Target"),
    "fem": PageOfCases("/elements", "Elements"),
}
"""The page of each command that runs cases."""


def opened(source: CaseSource, program: str) -> dict[str, Any]:
    """Return what a page needs to be built: the built-in cases with their titles, and the fields of this one."""
    plain = loaded(source._replace(changes=()))
    if plain.command != program:
        page = PAGES_OF[plain.command].name if plain.command in PAGES_OF else "Fit and study"
        raise InputError(
            "case", source.name, f"a case that `strikewave {program}` runs", f"the page {page} shows this one"
        )
    return {
        "titles": titles(program),
        "fields": edited_fields(plain),
        "values": values(source),
        "stack": listed_stack(source) if program == "wave" else None,
    }


@functools.cache
def titles(program: str) -> dict[str, str]:
    """Return the built-in cases that a command runs, with their titles.

    Examples
    --------
    >>> "li-ma-2019" in titles("run"), "togami-1996-bar" in titles("wave")
    (True, True)
    """
    cases = {name: load_case(name) for name in bundled_cases()}
    return {name: f"{name}: {case.title}" for name, case in cases.items() if case.command == program}


def values(source: CaseSource) -> dict[str, float]:
    """Return every quantity of a case, SI, by path: what a change would make of it."""
    return {path: value.si for path, value in loaded(source).values().items()}


def saved(source: CaseSource) -> str:
    """Return a case as a file, which gives the same numbers."""
    return dump_case(loaded(source))


def told(result: Result) -> dict[str, Any]:
    """Return what a page says of every result: notices, and the errors of its balances with their limits."""
    return {
        "notices": [(one.severity, one.code, one.message) for one in result.notices],
        "balance": [check.words for check in result.balance_checks],
    }


def by_full_run(result: Result) -> str:
    """Return in words that a full run is shown, and what its checks came to, and those of the runs it is made of."""
    words = [f"a full run; {result.state}", *([result.verdicts.words] if result.verdicts.words else [])]
    return "; ".join(words)


def result_file(result: ShownResult, wanted: str) -> bytes:
    """Return a file of a result: its report, as HTML or PDF, or its histories."""
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder) / wanted
        if wanted.endswith(".nc"):
            result.datasets()[wanted].write(place)
            return place.read_bytes()
        page = result.report(Path(folder) / "report.html").read_text("utf-8")
    if wanted != "report.pdf":
        return page.encode()
    from strikewave.reporting.pdf import check_pdf, pdf_of

    check_pdf("report.pdf", "PDF")
    return pdf_of(page, "A4")
