"""What the page of studies shows of one, as plain values; it runs in processes of the app."""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import Any

import strikewave
from strikewave.base.errors import InputError
from strikewave.cases.case_files import bundled_cases
from strikewave.reporting.shown_result import ShownResult
from strikewave.specifications.reading import asked_names
from strikewave.studies.map import X, Y
from strikewave.studies.scatter.study import ScatterPlan
from strikewave.web.case.loading import loaded
from strikewave.web.jobs import Say
from strikewave.web.pages.study.request import KINDS, StudyRequest
from strikewave.web.pages.study.result_view import result_view

MOST_RUNS = 2000
MOST_CELLS = 3600
"""Runs and cells of one study on a page: an hour's work. The command line takes more."""
MAP_POINTS = "20x20"
OTHER_FILE = re.compile(
    r"^@|(?:^|[\s:=@,;\"'])(?:[~/\\]|[A-Za-z]:[\\/])|(?:^|[:=@,;\"'])\s*\.\.|\.\.[\\/]|[\\/]\.\.|\.file\b"
)
"""What begins as the path of another folder does, leads upwards, or is read for more lines. The two dots of a range
stand behind its first number."""


def study(request: StudyRequest, say: Say) -> dict[str, Any]:
    """Return a study of a case; one that was stopped goes on where it was, where its kind can."""
    refuse_other_files(request)
    case = loaded(request.source)
    os.chdir(request.source.folder)
    runs = _count(request, "runs", MOST_RUNS)
    store = Path(request.source.folder) / f"{request.kind}-{request.mark}"

    def progress(share: float) -> None:
        say(share, request.kind)

    result: ShownResult
    if request.kind == "fit":
        result = strikewave.fit(
            case,
            request.lines("to"),
            request.lines("free"),
            progress=lambda n, misfit: say(None, f"{n} runs, misfit {misfit:.3g}"),
        )
    elif request.kind == "sweep":
        result = strikewave.sweep(
            case, request.lines("vary"), keep=request.lines("keep"), runs=runs, store=store, progress=progress
        )
    elif request.kind == "design":
        result = strikewave.design(
            case,
            request.lines("vary"),
            request.lines("goals"),
            analysis=request.one("analysis"),
            runs=runs,
            store=store,
            progress=progress,
        )
    elif request.kind == "settings":
        interval, peak, width = (request.one(key) or None for key in ("interval", "peak", "width"))
        result = strikewave.settings(interval, peak, width, case, progress=progress)
    elif request.kind == "map":
        result = strikewave.map(
            case, request.one("x", X), request.one("y", Y), points=_points(request), progress=progress
        )
    elif request.kind == "scatter":
        result = strikewave.scatter(case, ScatterPlan() if runs is None else ScatterPlan(runs=runs), progress=progress)
    else:
        raise InputError("study", request.kind, ", ".join(KINDS))
    say(None, "pictures and report")
    return result_view(result, request.kind.capitalize(), request.source)


def refuse_other_files(request: StudyRequest) -> None:
    """Refuse what names a file beside those that were dropped: relative names mean these alone.

    Examples
    --------
    >>> from strikewave.web.case.state import CaseSource
    >>> source = CaseSource("li-ma-2019", "", (), "")
    >>> refuse_other_files(StudyRequest("sweep", source, (("vary", ("machine.speed=1 m/s..2 m/s:3",)),)))
    >>> refuse_other_files(StudyRequest("fit", source, (("to", ("/etc/passwd",)),)))
    Traceback (most recent call last):
    strikewave.base.errors.InputError: to: got "/etc/passwd"; allowed: numbers, and files dropped on this page by name
    """
    for key, lines in request.texts:
        for line in lines:
            if OTHER_FILE.search(line):
                raise InputError(key, line, "numbers, and files dropped on this page by name")


def _count(request: StudyRequest, key: str, most: int) -> int | None:
    text = request.one(key)
    if not text:
        return None
    count = _whole(text)
    if not 1 <= count <= most:
        raise InputError(key, text, f"a whole number from 1 to {most}", "the command line takes more")
    return count


def _whole(text: str) -> int:
    """Return the whole number that a text is, of few digits; 0 where it is none."""
    return int(text) if text.isdecimal() and len(text) < 8 else 0


def _points(request: StudyRequest) -> tuple[int, int]:
    text = request.one("points", MAP_POINTS)
    first, second = (_whole(part.strip()) for part in (text.partition("x")[::2]))
    if not 4 <= first * second <= MOST_CELLS:
        raise InputError("points", text, f"two numbers such as {MAP_POINTS}, at most {MOST_CELLS} cells together")
    return first, second


def study_cases() -> list[str]:
    """Return the built-in cases, which studies begin from."""
    return bundled_cases()


def specifications() -> list[str]:
    """Return the names of the built-in specifications."""
    return asked_names()
