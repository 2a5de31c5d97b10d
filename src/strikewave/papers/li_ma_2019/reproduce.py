"""Effort in, reproduction out: run everything and set it beside what Li & Ma 2019 publish."""

from __future__ import annotations

from strikewave.base.result import Verdicts
from strikewave.papers.li_ma_2019.answers import number_rows
from strikewave.papers.li_ma_2019.element_pulses import element_numbers
from strikewave.papers.li_ma_2019.equations import equation_rows
from strikewave.papers.li_ma_2019.execution import Report, executing, silent
from strikewave.papers.li_ma_2019.findings import ELASTIC, QUIET, REFLECTING, WAVE, findings
from strikewave.papers.li_ma_2019.further import Further, run_further
from strikewave.papers.li_ma_2019.machine_findings import machine_findings
from strikewave.papers.li_ma_2019.published import consistency_checks, published_number, published_numbers
from strikewave.papers.li_ma_2019.result import PAPER, Reproduction, notices_of
from strikewave.papers.li_ma_2019.runs import (
    QUIET_ELEMENTS,
    QUIET_WAVE_ELEMENTS,
    RIGID_ELEMENTS,
    Effort,
    run_all,
)
from strikewave.papers.li_ma_2019.unknowns import run_unknowns
from strikewave.studies.engine.pools import Pool
from strikewave.studies.engine.store import RunStore

RUNS, MAPS = 0.45, 0.05
"""About what share of the time the runs of the figures take, and the maps over what is not published; the studies take
the rest. For the progress bar alone."""


def reproduce(
    effort: Effort, report: Report = silent, store: RunStore | None = None, pool: Pool | None = None
) -> Reproduction:
    """Reproduce Li & Ma 2019.

    Parameters
    ----------
    effort : Effort
        How much is run.
    report : callable, optional
        Called with the share done, 0 to 1, and what runs now.
    store : RunStore, optional
        Finished runs, and the states of those that were stopped.
    pool : Pool, optional
        Who makes the runs of maps and studies; this process where it is left out.
    """
    report(0.0, "equations")
    equations = equation_rows()
    studied = effort.studies and effort.elements and not effort.quick
    mapped = effort.studies and not effort.quick
    ends = (RUNS, RUNS + MAPS) if studied else (0.9, 1.0) if effort.elements else (0.1, 1.0)
    with executing(store, pool, effort.threads, report) as execution:
        runs = run_all(effort, execution.within(0.0, ends[0]))
        unknowns = run_unknowns(not mapped, execution.within(*ends))
        further = run_further(execution.within(ends[1], 1.0)) if studied else Further()
    checks = consistency_checks()
    named = {QUIET: QUIET_ELEMENTS, REFLECTING: RIGID_ELEMENTS, WAVE: QUIET_WAVE_ELEMENTS}
    solutions = {name: runs.element_solution(case) for name, case in named.items()}
    solutions[ELASTIC] = further.elastic
    measured = {name: None if table is None else element_numbers(table) for name, table in solutions.items()}
    numbers = number_rows(published_numbers(), runs, unknowns.ranges())
    low, high, _ = unknowns.direct_peak
    buffered = published_number("buffered peak").value
    rows = findings(equations, checks, measured, (low / buffered, high / buffered))
    rows += machine_findings(runs, unknowns.joints)
    sources = notices_of(runs)
    verdicts = Verdicts(text for _, text in runs.checked)
    found = runs, equations, numbers, checks, rows, unknowns, further, effort
    return Reproduction(*found, notices=sources, citations=(PAPER,), verdicts=verdicts)
