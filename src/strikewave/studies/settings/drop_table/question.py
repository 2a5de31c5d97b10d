"""A drop table asked for in plain values: quantities as texts with their units, or numbers in SI."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from pathlib import Path

from strikewave.base.compile_progress import compiling_shown
from strikewave.base.units import si_value
from strikewave.cases.case import Case, load_case
from strikewave.specifications.reading import load_specification
from strikewave.studies.engine.runner import pool_of, share_reporter
from strikewave.studies.engine.store import store_in
from strikewave.studies.settings.defaults import DROP_TABLE
from strikewave.studies.settings.drop_table.candidate import DropGoal
from strikewave.studies.settings.drop_table.programmers import read_programmer
from strikewave.studies.settings.drop_table.study import STROKE, DropChoices, DropStudy, design_drop_table


@compiling_shown()
def drop_table(
    spec: str,
    case: Case | None = None,
    *,
    programmers: Sequence[str] = (),
    diameters: Sequence[str | float] = (),
    masses: Sequence[str | float] = (),
    stroke: str | float = STROKE,
    workers: int | None = None,
    executor: Executor | None = None,
    cluster: str | None = None,
    store: Path | str | None = None,
    progress: Callable[[float], None] | None = None,
) -> DropStudy:
    """Find drop height and programmer of a drop table that give the pulse of a specification.

    Every design is checked by full runs, about a tenth of a second each.

    Parameters
    ----------
    spec : str
        Specification of a half-sine: a built-in one with its condition, or a file.
    case : Case, optional
        Gives what is not chosen; jesd22-b111-b by default.
    programmers : sequence of str, optional
        To try, such as ``"felt, stress=20 MPa, exponent=2.5, retardation=20 us"``; several by default.
    diameters, masses : sequence of str or float, optional
        Of pads, and of the table with its load.
    stroke : str or float, optional
        Largest drop height.
    workers : int, optional
        Processes; threads of this one where it is left out. With several, call it below
        ``if __name__ == "__main__":``.
    executor : Executor, optional
        Who runs instead: any executor of `concurrent.futures`, or one that acts as these do.
    cluster : str, optional
        Address of a Dask scheduler that shares the runs among machines, such as ``tcp://host:8786``.
    store : path, optional
        Folder that keeps finished runs: what it holds is not run again.
    progress : callable, optional
        Called with the share done, 0 to 1.

    Returns
    -------
    DropStudy
        Designs, the best first, each with its full run.

    Raises
    ------
    InputError
        If no design can give it, or none could be run: with the reasons.

    Examples
    --------
    >>> import strikewave
    >>> study = strikewave.drop_table("jesd22-b110:A", programmers=["linear"])
    >>> study.best.case.machine.height.typed, round(study.best.reading.peak / 9.80665)
    ('126.1 mm', 500)
    """
    specification = load_specification(spec, "spec")
    goal = DropGoal(specification, specification.pulse_limits(), si_value(stroke, "m", "stroke"))
    choice = DropChoices(
        tuple(read_programmer(word, field="programmers") for word in programmers),
        tuple(si_value(one, "m", "diameters") for one in diameters),
        tuple(si_value(one, "kg", "masses") for one in masses),
    )
    chosen = load_case(DROP_TABLE) if case is None else case
    with store_in(store) as finished:
        return design_drop_table(
            chosen, goal, choice, finished, pool_of(executor, workers, cluster), share_reporter(progress)
        )
