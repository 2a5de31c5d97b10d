"""The case files of the answers to a question for settings: that of the first is the source of the result."""

from __future__ import annotations

from collections.abc import Callable

from strikewave.cases.case import Case
from strikewave.cases.written_case import dump_case


def name_at(name: str, place: int) -> str:
    """Return the name of the case at a place of a ranking, from 0.

    Examples
    --------
    >>> name_at("drop-a", 0), name_at("drop-a", 1)
    ('drop-a', 'drop-a-2')
    """
    return f"{name}-{place + 1}" if place else name


def other_cases(count: int, case_at: Callable[[int], Case]) -> dict[str, str]:
    """Return the case files of the answers after the first, as many as there are: ``case-2.toml`` and so on."""
    return {f"{name_at('case', place)}.toml": dump_case(case_at(place)) for place in range(1, count)}
