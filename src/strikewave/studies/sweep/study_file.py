"""A sweep as a file: case, what is set and varied, what is kept; what is typed beside it takes the place of its own."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from pydantic import Field

from strikewave.base.errors import MISSING, InputError
from strikewave.base.toml_text import read_toml
from strikewave.cases.case import SCHEMA, Case, load_case
from strikewave.cases.case_files import bundled_cases, read_case_text
from strikewave.cases.paths import Form
from strikewave.cases.tables.base import CaseTable
from strikewave.studies.engine.plan import GRID
from strikewave.studies.study_file import Settings, case_place, states_a_study
from strikewave.studies.sweep.question import plan_of
from strikewave.studies.sweep.study import SweepPlan


class SweepFile(CaseTable):
    """A study file; ``[vary]`` has settings as keys, dotted or as tables, and their values as they are typed."""

    schema_version: int = Field(alias="schema")
    case: str
    set: Settings = ()
    vary: dict[str, Any] = Field(default_factory=dict)
    keep: tuple[str, ...] = ()
    analysis: str = ""
    design: str = ""
    runs: int | None = None
    seed: int | None = None


FORM = Form(SweepFile, "study", 'machine.speed="500 rpm"')
"""A study file."""


@dataclass(frozen=True)
class SweepRequest:
    """What is asked for; what is empty is left to the file, or to the usual.

    Attributes
    ----------
    vary, keep, analysis, design, runs, seed
        As of `strikewave.studies.sweep.question.sweep`.
    changes : tuple of str
        What is set in the case.
    case : Case or None
        What is varied, once it is read.
    """

    vary: tuple[str, ...] = ()
    keep: tuple[str, ...] = ()
    analysis: str = ""
    design: str = ""
    runs: int | None = None
    seed: int | None = None
    changes: tuple[str, ...] = ()
    case: Case | None = field(default=None, repr=False)

    @property
    def loaded(self) -> Case:
        """The case."""
        assert self.case is not None
        return self.case

    def plan(self, case: Case) -> SweepPlan:
        """Return the plan of the sweep of a case."""
        keep = [name for words in self.keep for name in words.split(",")]
        seed = 1 if self.seed is None else self.seed
        return plan_of(case, self.vary, keep, self.analysis, self.design or GRID, self.runs, seed)


def read_request(name: str, changes: Sequence[str], typed: SweepRequest) -> SweepRequest:
    """Return what is asked for of a case, or of a study file with what was typed beside it.

    Parameters
    ----------
    name : str
        Case file, built-in case, or study file.
    changes : sequence of str
        What is set in the case, after what the file sets.
    typed : SweepRequest
        What was typed.

    Raises
    ------
    InputError
        If the file is neither.
    """
    text, _ = read_case_text(name)
    document = _document(text)
    if name in bundled_cases() or not states_a_study(document, ("vary",)):
        return replace(typed, changes=tuple(changes), case=load_case(name, changes))
    file = FORM.read(document)
    if file.schema_version != SCHEMA:
        raise InputError("schema", file.schema_version, f"schema = {SCHEMA}")
    whole = (*file.set, *changes)
    case = load_case(case_place(file.case, Path(name).parent), whole)
    return SweepRequest(
        vary=typed.vary or tuple(varied_texts(file.vary)),
        keep=typed.keep or file.keep,
        analysis=typed.analysis or file.analysis,
        design=typed.design or file.design,
        runs=file.runs if typed.runs is None else typed.runs,
        seed=file.seed if typed.seed is None else typed.seed,
        changes=whole,
        case=case,
    )


def _document(text: str) -> Mapping[str, Any]:
    """Return the tables of a file; none where it is no TOML, which the reader of cases then says."""
    try:
        return read_toml(text)
    except ValueError:
        return {}


def varied_texts(table: Mapping[str, Any]) -> list[str]:
    """Return the settings of [vary] with their values as they are typed on the command line.

    Raises
    ------
    InputError
        If one has no values.

    Examples
    --------
    >>> varied_texts({"machine": {"speed": "400..900 rpm"}, "feed.blows": [1, 3]})
    ['machine.speed=400..900 rpm', 'feed.blows=1, 3']
    """
    return [f"{path}={values}" for path, values in _flat(table)]


def _flat(table: Mapping[str, Any], path: str = "") -> Iterator[tuple[str, str]]:
    """Yield settings and their values: keys with dots are tables within tables in TOML."""
    for key, value in table.items():
        if isinstance(value, Mapping):
            yield from _flat(value, f"{path}{key}.")
        elif isinstance(value, list):
            yield f"{path}{key}", ", ".join(map(str, value))
        elif isinstance(value, str | int | float) and value != "":
            yield f"{path}{key}", str(value)
        else:
            raise InputError(f"vary.{path}{key}", MISSING, 'values, such as "400..900 rpm:11"')
