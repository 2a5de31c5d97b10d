"""Cases of the pages, read in the processes that run them: no page opens a file that was not dropped on it."""

from __future__ import annotations

from pathlib import Path

from strikewave.base.errors import InputError, nearest
from strikewave.cases.case import Case, load_case, parse_case
from strikewave.cases.case_files import bundled_cases
from strikewave.cases.tables.mesh import FilePart
from strikewave.web.case.state import CaseSource


def loaded(source: CaseSource) -> Case:
    """Return the case.

    Raises
    ------
    InputError
        If it is none, or names a file that lies elsewhere.
    """
    if source.text:
        case = parse_case(source.text, source.name, source.changes)
    elif source.name in bundled_cases():
        case = load_case(source.name, source.changes)
    else:
        hint = nearest(source.name, bundled_cases())
        raise InputError("case", source.name, "a built-in case, or a file dropped here", hint)
    return _with_own_files(case, Path(source.folder))


def _with_own_files(case: Case, folder: Path) -> Case:
    """Return a case whose files are those that were dropped: a page opens no other file of the machine it runs on."""
    if case.load is not None and case.load.file:
        own = str(_own_file("load.file", case.load.file, folder))
        case = case.model_copy(update={"load": case.load.model_copy(update={"file": own})})
    if case.mesh is not None and any(isinstance(part, FilePart) for part in case.mesh.part):
        parts = tuple(
            part.model_copy(update={"file": str(_own_file("mesh.part.file", part.file, folder))})
            if isinstance(part, FilePart)
            else part
            for part in case.mesh.part
        )
        case = case.model_copy(update={"mesh": case.mesh.model_copy(update={"part": parts})})
    return case


def _own_file(path: str, name: str, folder: Path) -> Path:
    place = folder / Path(name).name
    if not place.is_file():
        raise InputError(path, name, "a file dropped here", "drop it beside the case; other files are not opened")
    return place
