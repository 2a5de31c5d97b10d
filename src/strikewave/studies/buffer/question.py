"""Gaskets asked for in plain values: quantities as texts with their units, or numbers in SI."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from pathlib import Path

from strikewave.base.compiling import compiling_shown
from strikewave.base.quantities import Value
from strikewave.base.units import si_value
from strikewave.cases.case import Case
from strikewave.reporting.options import read_value
from strikewave.studies.buffer.candidate import BufferGoal
from strikewave.studies.buffer.choice import StackChoices, stacks
from strikewave.studies.buffer.defaults import LAYERS, THICKEST, THICKNESSES, WORST
from strikewave.studies.buffer.mounting_site import blows_of, choose_sensor, mounting_site_of, usual_materials
from strikewave.studies.buffer.result import BufferStudy
from strikewave.studies.buffer.study import design_buffer
from strikewave.studies.engine.runner import pool_of, share_reporter
from strikewave.studies.engine.store import store_in


@compiling_shown()
def buffer(
    case: Case,
    limit: str | float,
    *,
    sensor: str | None = None,
    blow: str | int = WORST,
    materials: Sequence[str] = (),
    thicknesses: Sequence[str] = (),
    layers: int = LAYERS,
    rank: str = "bandwidth",
    workers: int | None = None,
    executor: Executor | None = None,
    cluster: str | None = None,
    store: Path | str | None = None,
    progress: Callable[[float], None] | None = None,
) -> BufferStudy:
    """Rank stacks of gaskets under a sensor of a case, by what it then reads of a blow and what they pass.

    Parameters
    ----------
    case : Case
        A machine or a bar with the sensor.
    limit : str or float
        Largest allowed reading: with a unit, such as ``"5000 g"``, or in m/s^2.
    sensor : str, optional
        Its name, where the case has several.
    blow : str or int, optional
        Blow that the stacks are compared at: ``worst``, ``first`` or its number.
    materials : sequence of str, optional
        Of the gaskets; all polymers and elastomers by default.
    thicknesses : sequence of str, optional
        Of the gaskets, with units; 0.5, 1 and 2 mm by default.
    layers : int, optional
        Largest number of gaskets in a stack.
    rank : str, optional
        What ranks the stacks that keep the limit: ``bandwidth``, ``peak`` or ``robust``.
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
    BufferStudy
        Stacks that keep the reading below the limit, the best first.

    Raises
    ------
    InputError
        If the blow cannot be had, or no stack fits the sensor.

    Examples
    --------
    >>> import strikewave
    >>> case = strikewave.load_case("li-ma-2019-fig5")
    >>> study = strikewave.buffer(case, "7000 g", sensor="buffered", materials=["PTFE"], thicknesses=["1 mm"], layers=1)
    >>> [candidate.name for candidate in study.candidates]
    ['direct', 'PTFE 1 mm']
    """
    goal = BufferGoal(si_value(limit, "m/s^2", "limit"), rank)
    sizes = [read_value(text, "thicknesses", "m", THICKEST) for text in thicknesses]
    choice = choices_of(materials, sizes, layers)
    site = mounting_site_of(choose_sensor(case, sensor), case)
    blows = blows_of(case, site.table, str(blow))
    pool = pool_of(executor, workers, cluster)
    with store_in(store) as finished:
        study = design_buffer(site, blows, choice, goal, finished, pool, share_reporter(progress))
    return dataclasses.replace(study, case=case)


def choices_of(names: Sequence[str] | None, sizes: Sequence[Value] | None, layers: int) -> StackChoices:
    """Return what stacks may be made of: the usual materials and thicknesses where none are named.

    Raises
    ------
    InputError
        If there is nothing to choose from, or far too much.
    """
    usual = (read_value(text, "--thickness", "m", THICKEST) for text in THICKNESSES)
    choice = StackChoices(tuple(names or usual_materials()), tuple(chosen(size) for size in sizes or usual), layers)
    stacks(choice)
    return choice


def chosen(value: Value) -> Value:
    """Return a value that says in the case where it comes from."""
    return value.model_copy(update={"note": "chosen by strikewave buffer"})
