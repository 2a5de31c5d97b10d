"""Effort in, reproduction out: run everything and set it beside what Li & Ma 2019 publish."""

from __future__ import annotations

from collections.abc import Sequence

from strikewave.papers.li_ma_2019.answers import BUFFERED_PEAK, DIRECT_PEAK, number_rows
from strikewave.papers.li_ma_2019.element_pulses import element_numbers
from strikewave.papers.li_ma_2019.equations import equation_rows
from strikewave.papers.li_ma_2019.findings import ELASTIC, QUIET, REFLECTING, WAVE, findings
from strikewave.papers.li_ma_2019.further import Further, run_further
from strikewave.papers.li_ma_2019.published import consistency_checks, published_numbers
from strikewave.papers.li_ma_2019.result import PAPER, NumberRow, Reproduction, notices_of
from strikewave.papers.li_ma_2019.runs import (
    QUIET_ELEMENTS,
    QUIET_WAVE_ELEMENTS,
    RIGID_ELEMENTS,
    Effort,
    Report,
    run_all,
    within,
)

RUNS = 0.5
"""About what share of the time the runs of the figures take, the studies the rest: for the progress bar alone."""


def reproduce(effort: Effort, report: Report = lambda share, words: None) -> Reproduction:
    """Reproduce Li & Ma 2019.

    Parameters
    ----------
    effort : Effort
        How much is run.
    report : callable, optional
        Called with the share done, 0 to 1, and what runs now.
    """
    report(0.0, "equations")
    equations = equation_rows()
    studied = effort.studies and effort.elements and not effort.quick
    runs = run_all(effort, within(report, 0.0, RUNS if studied else 1.0))
    further = run_further(effort.threads, within(report, RUNS, 1.0)) if studied else Further()
    checks = consistency_checks()
    named = {QUIET: QUIET_ELEMENTS, REFLECTING: RIGID_ELEMENTS, WAVE: QUIET_WAVE_ELEMENTS}
    solutions = {name: runs.element_solution(case) for name, case in named.items()}
    solutions[ELASTIC] = further.elastic
    measured = {name: None if table is None else element_numbers(table) for name, table in solutions.items()}
    numbers = number_rows(published_numbers(), runs)
    finding_rows = findings(equations, checks, measured, _read_ratio(numbers))
    return Reproduction(
        runs, equations, numbers, checks, finding_rows, further, effort, notices=notices_of(runs), citations=(PAPER,)
    )


def _read_ratio(numbers: Sequence[NumberRow]) -> float | None:
    """Return the first peak of the direct sensor over that of the buffered one, as the machine's model gives them."""
    peaks = {row.number.name: row.best.value for row in numbers if row.best is not None}
    direct, buffered = peaks.get(DIRECT_PEAK), peaks.get(BUFFERED_PEAK)
    return None if direct is None or buffered is None else direct / buffered
