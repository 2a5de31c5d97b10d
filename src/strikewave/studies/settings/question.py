"""Settings asked for in plain values: quantities as texts with their units, or numbers in SI."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from pathlib import Path

from strikewave.base.compile_progress import compiling_shown
from strikewave.base.materials import material
from strikewave.base.units import si_value
from strikewave.cases.case import Case, load_case
from strikewave.studies.engine.runner import pool_of, share_reporter
from strikewave.studies.engine.store import store_in
from strikewave.studies.settings.defaults import DISC, REFERENCE, STIFFNESS
from strikewave.studies.settings.goal import SettingsChoices, blow_goal
from strikewave.studies.settings.result import SettingsStudy
from strikewave.studies.settings.study import design_settings


@compiling_shown()
def settings(
    interval: str | float | None = None,
    peak: str | float | None = None,
    width: str | float | None = None,
    case: Case | None = None,
    *,
    spec: str | None = None,
    strikers: Sequence[int] = (),
    striker_masses: Sequence[str | float] = (),
    vary: str = STIFFNESS,
    disc: str = DISC,
    stop_limit: str | float | None = None,
    workers: int | None = None,
    executor: Executor | None = None,
    cluster: str | None = None,
    store: Path | str | None = None,
    progress: Callable[[float], None] | None = None,
) -> SettingsStudy:
    """Find settings of the rotary machine for blows of a wanted peak and width at a wanted interval.

    Every candidate is checked by a full run of all its blows, about a second each.

    Parameters
    ----------
    interval, peak, width : str or float
        Of the blows: with a unit, such as ``"20 ms"``, or in SI. The width is that at 10 % of the peak.
        Peak and width are left out with ``spec``.
    case : Case, optional
        Gives what is not chosen: geometry, materials, stop; li-ma-2019 by default.
    spec : str, optional
        Specification of a half-sine, which has peak and width and judges every blow.
    strikers : sequence of int, optional
        Numbers of strikers to try; several about that of the case by default.
    striker_masses : sequence of str or float, optional
        Masses of one striker to try; half, once and twice that of the case by default.
    vary : str, optional
        Stiffness that sets the width: of the ``frame``, or of the striker's ``mount``.
    disc : str, optional
        Material assumed for the turntable.
    stop_limit : str or float, optional
        Largest allowed force of the object's stop; no limit by default.
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
    SettingsStudy
        Candidates, the best first, each with its full run.

    Raises
    ------
    InputError
        If no setting can give it, or none could be run: with the reasons.

    Examples
    --------
    >>> import strikewave
    >>> study = strikewave.settings("20 ms", "4000 g", "200 us")  # doctest: +SKIP
    >>> study.best.case.machine.speed.typed  # doctest: +SKIP
    '625.6 rpm'
    >>> strikewave.settings("20 ms", "4000 g", "5 ms")
    Traceback (most recent call last):
        ...
    strikewave.base.errors.InputError: --width: got "5000 us"; allowed: at most 2000 us, a tenth of the interval; \
longer pulses run into the next blow
    """

    def read(value: str | float | None, si: str, name: str) -> float | None:
        return None if value is None else si_value(value, si, name)

    goal = blow_goal(
        read(interval, "s", "interval"),
        read(peak, "m/s^2", "peak"),
        read(width, "s", "width"),
        material(disc, "disc"),
        read(stop_limit, "N", "stop_limit"),
        spec,
    )
    masses = tuple(si_value(mass, "kg", "striker_masses") for mass in striker_masses)
    choice = SettingsChoices(tuple(strikers), masses, vary)
    chosen = load_case(REFERENCE) if case is None else case
    with store_in(store) as finished:
        return design_settings(
            chosen, goal, choice, finished, pool_of(executor, workers, cluster), share_reporter(progress)
        )
