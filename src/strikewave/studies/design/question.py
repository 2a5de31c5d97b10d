"""A design asked for in plain values: settings with their ranges and goals as texts, as its file has them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from pathlib import Path

from strikewave.cases.case import Case
from strikewave.studies.design.plan import plan_of
from strikewave.studies.design.study import DesignStudy, make_design
from strikewave.studies.engine.runner import pool_of, share_reporter
from strikewave.studies.engine.store import store_in
from strikewave.studies.sweep.plan import Vary, vary_texts


def design(
    case: Case,
    vary: Vary,
    goals: Sequence[str],
    *,
    analysis: str = "",
    runs: int | None = None,
    seed: int = 1,
    robust: int = 0,
    search: str = "",
    workers: int = 1,
    executor: Executor | None = None,
    cluster: str | None = None,
    device: str | None = None,
    store: Path | str | None = None,
    progress: Callable[[float], None] | None = None,
) -> DesignStudy:
    """Find settings of a case for goals on its numbers, or which goals exclude each other.

    Equal arguments give equal settings, bit for bit, whatever the number of processes.

    Parameters
    ----------
    case : Case
        What is designed.
    vary : sequence of str, or mapping
        What may be chosen: ``machine.speed=400..900 rpm``, ``object.spring=10..160 kN/m log``,
        ``contact.damping=LAW, LAW``; or the values by the settings.
    goals : sequence of str
        ``first.rigid_peak = 4000 g +- 5 %``, ``cv < 3 %``, ``spec:mil-std-810h passes``, ``sensor clips never``; and
        objectives, such as ``stop_force smallest``.
    analysis : str, optional
        ``run``, ``fast``, ``wave``, ``fem`` or ``impact``; that of the case where it is left out.
    runs : int, optional
        Most runs of a search; 600 where it is left out, 40 by surrogate.
    seed : int, optional
        Of the search and of draws.
    robust : int, optional
        Draws within the tolerances of the case for each ranked setting; none where it is left out.
    search : str, optional
        ``evolution``, or ``surrogate`` for few runs; that of elements where it is left out. ``optuna``, of two
        objectives or more, searches for their whole front at once; needs ``pip install 'strikewave[optuna]'``.
    workers : int, optional
        Processes. With more than one, call it below ``if __name__ == "__main__":``.
    executor : Executor, optional
        Who runs instead: any executor of `concurrent.futures`, or one that acts as these do.
    cluster : str, optional
        Address of a Dask scheduler that shares the runs among machines, such as ``tcp://host:8786``.
    device : str, optional
        ``cuda`` or ``cuda-mixed``: the steps of elements are taken on the GPU, which the processes share.
    store : path, optional
        Folder that keeps finished runs: what it holds is not run again.
    progress : callable, optional
        Called with the share done, 0 to 1.

    Returns
    -------
    DesignStudy
        The best settings, every run that was made, and where no setting meets all goals, those that exclude
        each other.

    Raises
    ------
    InputError
        If the case has no such setting or number, a goal is none, or the store cannot be used.

    Examples
    --------
    >>> import strikewave
    >>> case = strikewave.load_case("li-ma-2019", ["feed.blows=1"])
    >>> goals = ["peak_force = 30 kN +- 2 %"]
    >>> study = strikewave.design(case, ["machine.speed=200..900 rpm"], goals, analysis="impact", runs=48)
    >>> study.best.meets, study.conflict
    (True, None)
    """
    plan = plan_of(case, vary_texts(vary), goals, analysis, runs, seed, robust, search).on(device, cluster)
    with store_in(store) as finished:
        return make_design(plan, finished, pool_of(executor, workers, cluster), share_reporter(progress))
