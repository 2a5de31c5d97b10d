"""A design as a file: the case, what may be chosen, and what shall be reached; options take the place of its keys."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any, Literal, NamedTuple

from pydantic import Field

from strikewave.cases.case import Case, load_case
from strikewave.cases.paths import Form
from strikewave.cases.tables.base import CaseTable
from strikewave.studies.design.plan import DesignPlan, plan_of
from strikewave.studies.engine.variables import read_variable
from strikewave.studies.study_file import Settings, case_place, read_study, stated_at
from strikewave.studies.sweep.plan import varied_texts

ALLOWED = "a TOML file with the case, goals and [vary]"


class DesignFile(CaseTable):
    """The file of a design; ``[vary]`` has settings as keys, dotted or as tables, and values as they are typed."""

    schema_: Annotated[Literal[1], Field(alias="schema")]
    case: str
    changes: Settings = Field(default=(), alias="set")
    goals: tuple[str, ...]
    vary: dict[str, Any]
    analysis: str = ""
    runs: int | None = None
    seed: int = 1
    robust: int = 0
    search: str = ""


FORM = Form(DesignFile, "design", 'goals="cv < 3 %"')


class DesignRequest(NamedTuple):
    """A file of a design that was read: its case, what is set in it, and the file; options have replaced its keys."""

    case: Case
    changes: tuple[str, ...]
    file: DesignFile
    name: str

    def plan(self, case: Case) -> DesignPlan:
        """Return the plan of the design of a case."""
        file = self.file
        with stated_at(f"{self.name}: vary"):
            vary = varied_texts(file.vary)
            for text in vary:
                read_variable(case, text)
        with stated_at(self.name):
            return plan_of(case, vary, file.goals, file.analysis, file.runs, file.seed, file.robust, file.search)


def load_design(path: str | Path, changes: Sequence[str] = (), **options: int | None) -> DesignRequest:
    """Read a file of a design.

    Parameters
    ----------
    path : str or Path
        The file; its case lies beside it, or is a built-in one.
    changes : sequence of str, optional
        What is set in the case, after what the file sets.
    **options
        ``runs``, ``seed`` and ``robust``, which take the place of those of the file where they are not None.

    Raises
    ------
    InputError
        With one line for each thing that is wrong: file, table and key, and what is allowed.
    """
    path = Path(path)
    file = read_study(path, FORM, ALLOWED)
    place = case_place(file.case, path.parent)
    whole = (*file.changes, *changes)
    with stated_at(f"{path.name}: case"):
        load_case(place)
    with stated_at(f"{path.name}: set"):
        case = load_case(place, whole)
    given = {name: value for name, value in options.items() if value is not None}
    return DesignRequest(case, whole, file.model_copy(update=given), path.name)
