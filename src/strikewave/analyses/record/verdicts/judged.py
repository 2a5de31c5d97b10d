"""The result of records with its verdict."""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING

from strikewave.base.result import FAILED, WARNING, Notice
from strikewave.reporting.clause_words import verdict_words
from strikewave.reporting.numbers import listed
from strikewave.specifications.judged_records import Asked, judge_records
from strikewave.specifications.judging import CANNOT_TELL, FAIL, Clause
from strikewave.specifications.reading import Specification

if TYPE_CHECKING:
    from strikewave.analyses.record.result import RecordResult


def with_verdict(result: RecordResult, specification: Specification, asked: Asked) -> RecordResult:
    """Return the result of records with the verdict by a specification; a fail is a failed check.

    Raises
    ------
    InputError
        If the records cannot be judged by it.
    """
    found = judge_records(result.readings, specification, asked, result.filter)
    notices = verdict_notices(
        specification.title, found.verdict, found.by_indicative, [one for one, _ in found.clauses]
    )
    citations = ("jcgm-106", "iso-14253-1") if asked.rule == "guarded" else ()
    return dataclasses.replace(
        result,
        verdict=found,
        notices=(*result.notices, *notices),
        citations=(*result.citations, *citations),
    )


def verdict_notices(title: str, verdict: str, by_indicative: bool, clauses: list[Clause]) -> list[Notice]:
    """Return the notice of a verdict that is no pass."""
    if verdict not in (FAIL, CANNOT_TELL):
        return []
    names = listed(list(dict.fromkeys(clause.clause for clause in clauses if clause.verdict == verdict)))
    message = f"{verdict_words(verdict, by_indicative)} by {title}: {names or 'nothing could be judged'}"
    return [Notice("specification", message, severity=FAILED if verdict == FAIL else WARNING)]
