"""The map of a machine's settings: how even its blows are, what its trains settle to, and the nearest even setting."""

from __future__ import annotations

import csv
import dataclasses
import io
import math
import multiprocessing
import os
from collections.abc import Callable, Iterator
from concurrent.futures import FIRST_COMPLETED, ProcessPoolExecutor, wait
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from strikewave.case import Case, dump_case, parse_case
from strikewave.dataset import quantity
from strikewave.documents import head, plain
from strikewave.errors import InputError, IntegrationError, StrikewaveError, nearest
from strikewave.machines import blows
from strikewave.machines.rotary import run_rotary
from strikewave.quantities import Value
from strikewave.studies.map_cells import (
    FIELDS,
    PLACE,
    REASONS,
    Axis,
    Plan,
    case_at,
    cell_of,
    machine_of,
    row_of,
    spread,
    start_worker,
)
from strikewave.studies.map_regimes import NAMES
from strikewave.studies.map_store import Store

if TYPE_CHECKING:
    import xarray

Array = NDArray[np.float64]

TRAIN = 60
"""Blows of the longer train unless said otherwise; the first half is left out."""
MOST_CELLS, MOST_SIDE, MOST_TRAIN, MOST_SECONDS = 1_000_000, 1000, 1000, 12 * 3600.0
"""More cells, cells along an axis, blows of a train, or estimated seconds than this are refused."""
SECONDS_A_BLOW = 0.4e-3
"""About what a blow takes on one core, s: for the estimate only."""
CONFIRMED = 5
"""Even settings nearest to the case that are tried by full runs until one keeps the limit."""
TESTED = 1e-7
"""Tolerance of these full runs."""


@dataclass(frozen=True)
class Setting:
    """A setting of the map with even blows, and what it costs.

    Attributes
    ----------
    values : tuple of float
        Of each axis, SI.
    distance : float
        From the case: root of the summed squares of the relative changes.
    cell : dict
        What the map has of it, by the names of `FIELDS`.
    cv : float
        Of the same blows in a full run.
    peak : float
        Their mean rigid peak there, m/s^2.
    """

    values: tuple[float, ...]
    distance: float
    cell: dict[str, float]
    cv: float
    peak: float


@dataclass(frozen=True, eq=False)
class MapStudy:
    """A map.

    Attributes
    ----------
    plan : Plan
        What it is of.
    data : ndarray
        Shape (panels, rows, columns, fields); see `strikewave.studies.map_cells.FIELDS`.
    wanted : float
        Coefficient of variation below which blows count as even.
    present : dict
        The case itself, as a cell.
    setting : Setting or None
        The nearest even setting that a full run confirms.
    """

    plan: Plan
    data: Array
    wanted: float
    present: dict[str, float]
    setting: Setting | None = None

    @cached_property
    def case(self) -> Case:
        """The case that is mapped."""
        return parse_case(self.plan.case)

    @property
    def broken(self) -> bool:
        """Whether no setting of the map has even blows."""
        return self.setting is None

    @property
    def here(self) -> tuple[float, ...]:
        """Where the case stands on each axis, SI."""
        values = self.case.values()
        return tuple(values[axis.path].si for axis in self.plan.axes)

    def field(self, name: str) -> Array:
        """Return one field, shape (panels, rows, columns)."""
        return np.asarray(self.data[..., PLACE[name]])

    @property
    def shares(self) -> dict[str, float]:
        """Share of the cells in each regime that occurs."""
        codes = self.field("regime")
        found = {name: float(np.mean(codes == code)) for code, name in enumerate(NAMES)}
        return {name: share for name, share in found.items() if share > 0.0}

    @property
    def failures(self) -> dict[str, int]:
        """How many cells have no result, by reason."""
        codes = self.field("reason").astype(int)
        return {text: int((codes == k).sum()) for k, text in enumerate(REASONS) if k and (codes == k).any()}

    def over_range(self, path: str, low: float = 0.5, high: float = 2.0) -> tuple[float, float] | None:
        """Return the ends of the range over which an assumed value of the case is in doubt; None where it is known."""
        value = self.case.values()[path]
        return (low * value.si, high * value.si) if value.provenance == "assumed" else None

    def document(self) -> dict[str, Any]:
        """Return the JSON document."""
        units = {name: unit for name, (unit, _) in FIELDS.items()} | {
            axis.path: axis.si_unit for axis in self.plan.axes
        }
        axes = [{"path": axis.path, "values": list(axis.values), "log": axis.log} for axis in self.plan.axes]
        values = self.case.values()
        published = {
            axis.path: {"value": at, "provenance": values[axis.path].provenance}
            for axis, at in zip(self.plan.axes, self.here, strict=True)
        }
        made = {
            **head(units | {"wanted_cv": "1", "distance": "1"}),
            "case": self.case.name,
            "blows": self.plan.blows,
            "train": self.plan.train,
            "axes": axes,
            "regimes": list(NAMES),
            "reasons": list(REASONS),
            "wanted_cv": self.wanted,
            "present": {**published, "result": self.present},
            "shares": self.shares,
            "failures": self.failures,
            "nearest": self._nearest(),
            "cells": {name: self.field(name) for name in FIELDS},
        }
        return dict(plain(made))

    def _nearest(self) -> dict[str, Any] | None:
        if self.setting is None:
            return None
        paths = [axis.path for axis in self.plan.axes]
        found = self.setting
        full = {"cv": found.cv, "peak": found.peak, "tolerance": TESTED}
        settings = dict(zip(paths, found.values, strict=True))
        return {"settings": settings, "distance": found.distance, "result": found.cell, "full_run": full}

    def dataset(self) -> xarray.Dataset:
        """Return the map with its units; attributes carry the case and the meaning of the codes."""
        import xarray

        axes = self.plan.axes
        dimensions = ("panel", "y", "x")
        named = (axes[2] if len(axes) > 2 else None, axes[1], axes[0])
        coordinates = {
            dimension: quantity(dimension, np.array(axis.values), axis.si_unit or "1", axis.path)
            for dimension, axis in zip(dimensions, named, strict=True)
            if axis is not None
        }
        variables = {
            name: quantity(dimensions, self.field(name), unit, meaning) for name, (unit, meaning) in FIELDS.items()
        }
        words = {"case": self.plan.case, "regimes": " | ".join(NAMES), "reasons": " | ".join(REASONS)}
        return xarray.Dataset(variables, coordinates, {**words, "blows": self.plan.blows, "train": self.plan.train})

    def table(self) -> str:
        """Return all cells as CSV text, settings in the units asked for, results in SI; regimes by name."""
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        axes = self.plan.axes
        units = [f"{name} [{unit}]" if unit != "1" else name for name, (unit, _) in FIELDS.items()]
        writer.writerow([f"{axis.path} [{axis.unit or '1'}]" for axis in axes] + units)
        for place in np.ndindex(*self.plan.shape):
            cell = self.data[place]
            at = [f"{axis.shown(v):.9g}" for axis, v in zip(axes, self._values(place), strict=True)]
            row = [_cell(name, value) for name, value in zip(FIELDS, cell, strict=True)]
            writer.writerow(at + row)
        return text.getvalue()

    def _values(self, place: tuple[int, ...]) -> tuple[float, ...]:
        """Return the settings of a cell (panel, row, column)."""
        axes = self.plan.axes
        found = (axes[0].values[place[2]], axes[1].values[place[1]])
        return (*found, axes[2].values[place[0]]) if len(axes) > 2 else found

    def even_settings(self) -> list[tuple[float, tuple[int, int, int]]]:
        """Return distance and place of the cells whose blows all come and are even, nearest first."""
        even = (self.field("cv") <= self.wanted) & (self.field("missed") == 0)
        found = []
        for place in zip(*np.nonzero(even), strict=True):
            steps = [v / at - 1.0 for v, at in zip(self._values(place), self.here, strict=True) if at]
            found.append((math.hypot(*steps), (int(place[0]), int(place[1]), int(place[2]))))
        return sorted(found)

    def nearest_case(self) -> Case:
        """Return the case with the nearest even setting; the case itself where there is none."""
        return self.case if self.setting is None else case_at(self.case, self.plan.axes, self.setting.values)


def _cell(name: str, value: float) -> str:
    """Write a value of the table."""
    if name in ("regime", "reason") and not math.isnan(value):
        return (NAMES if name == "regime" else REASONS)[int(value)]
    return "" if math.isnan(value) else f"{value:.9g}"


def axis_of(case: Case, path: str, ends: tuple[Value, Value] | None, points: int, log: bool) -> Axis:
    """Return an axis of a map: a quantity of the case from one value to another, half to twice where none are given.

    Raises
    ------
    InputError
        If the case has no such quantity, or the range is none.
    """
    values = case.values()
    if path not in values:
        raise InputError(path, path, "a quantity of the case", nearest(path, values))
    unit, si_unit = _units(case, path, ends[0] if ends else values[path])
    low, high = (ends[0].si, ends[1].si) if ends else (0.5 * values[path].si, 2.0 * values[path].si)
    if not low < high:
        raise InputError(
            path, f"{low:g} to {high:g}", "a range whose end lies above its begin, SI", "such as 400 rpm:1000 rpm"
        )
    if log and low <= 0.0:
        raise InputError(path, low, "a range above zero on a logarithmic axis")
    steps = np.geomspace(low, high, points) if log else np.linspace(low, high, points)
    return Axis(path, unit, si_unit, tuple(float(v) for v in steps), log)


def _units(case: Case, path: str, value: Value) -> tuple[str, str]:
    """Return the unit in which a quantity of a case was typed, and its SI unit."""
    from strikewave.case import FORM

    allowed = FORM.range_at(path.split("."))
    si_unit = "" if allowed is None or allowed.unit == "count" else allowed.unit
    typed = str(value.typed).strip().lstrip("+-0123456789.eE").strip() if isinstance(value.typed, str) else ""
    return typed or si_unit, si_unit


def check_plan(plan: Plan, workers: int) -> float:
    """Return about how long a map takes, s, and refuse one that is too large.

    Raises
    ------
    InputError
        If it has too many or too few cells or blows, or would take half a day.
    """
    panels, rows, columns = plan.shape
    if not (2 <= rows <= MOST_SIDE and 2 <= columns <= MOST_SIDE) or panels * rows * columns > MOST_CELLS:
        allowed = f"2 to {MOST_SIDE} points along each axis, and {MOST_CELLS} cells at most"
        raise InputError("--points", f"{columns}x{rows}" + (f" x {panels} panels" if panels > 1 else ""), allowed)
    if not (plan.train == 0 or 12 <= plan.train <= MOST_TRAIN):
        raise InputError("--train", plan.train, f"0, or 12 to {MOST_TRAIN} blows")
    if not 2 <= plan.blows <= MOST_TRAIN:
        raise InputError("--blows", plan.blows, f"2 to {MOST_TRAIN} blows")
    seconds = panels * rows * columns * max(plan.blows, plan.train) * SECONDS_A_BLOW / workers
    if seconds > MOST_SECONDS:
        allowed = f"a map of {MOST_SECONDS / 3600:g} hours at most (this one: about {seconds / 3600:.0f})"
        raise InputError("--points", f"{columns}x{rows}", allowed, "fewer points, blows or a shorter train")
    return seconds


def make_map(
    plan: Plan,
    wanted: float,
    workers: int = 1,
    store: Store | None = None,
    progress: Callable[[float], None] | None = None,
) -> MapStudy:
    """Make a map: every cell run fast, and the nearest even setting tried in full.

    Parameters
    ----------
    plan : Plan
        What it is of.
    wanted : float
        Coefficient of variation below which blows count as even.
    workers : int, optional
        Processes.
    store : Store, optional
        Finished rows; what it holds is not run again.
    progress : callable, optional
        Called with the share done, 0 to 1.

    Raises
    ------
    InputError
        If the plan is too large, or the case makes no machine.
    """
    check_plan(plan, workers)
    case = parse_case(plan.case)
    machine_of(case)
    kept = Store(plan, None) if store is None else store
    todo = [int(row) for row in np.flatnonzero(~kept.done)]
    for row, cells in _rows(plan, todo, workers):
        kept.keep(row, cells)
        if progress is not None:
            progress(float(kept.done.mean()))
    present = dict(zip(FIELDS, cell_of(case, plan.blows, plan.train).tolist(), strict=True))
    study = MapStudy(plan, kept.data.reshape(*plan.shape, len(FIELDS)), wanted, present)
    return dataclasses.replace(study, setting=_confirmed(study))


def _rows(plan: Plan, todo: list[int], workers: int) -> Iterator[tuple[int, Array]]:
    """Yield rows of a map as they are finished."""
    if workers == 1 or len(todo) < 2:
        start_worker(plan)
        for row in todo:
            yield row, row_of(row)
        return
    context = multiprocessing.get_context("spawn")
    pool = ProcessPoolExecutor(min(workers, os.cpu_count() or 1), context, start_worker, (plan,))
    try:
        running = {pool.submit(row_of, row): row for row in todo}
        while running:
            for future in wait(running, return_when=FIRST_COMPLETED).done:
                yield running.pop(future), future.result()
    finally:
        pool.shutdown(wait=False, cancel_futures=True)


def _confirmed(study: MapStudy) -> Setting | None:
    """Return the nearest even setting that a full run confirms."""
    for distance, place in study.even_settings()[:CONFIRMED]:
        values = study._values(place)
        try:
            machine = machine_of(case_at(study.case, study.plan.axes, values))
            feed = dataclasses.replace(machine.feed, blows=study.plan.blows, hold=math.inf)
            run = run_rotary(dataclasses.replace(machine, feed=feed), TESTED)
        except (StrikewaveError, IntegrationError):
            continue
        peaks = np.array([0.0 if b.kind == "missed" else b.rigid_peak for b in blows(run)[: study.plan.blows]])
        if spread(peaks) <= study.wanted:
            cell = dict(zip(FIELDS, study.data[place].tolist(), strict=True))
            return Setting(values, distance, cell, spread(peaks), float(peaks.mean()))
    return None


def plan_of(case: Case, axes: tuple[Axis, ...], own: int | None = None, train: int = TRAIN) -> Plan:
    """Return the plan of a map of a case over two or three of its quantities."""
    paths = [axis.path for axis in axes]
    if len(set(paths)) < len(paths):
        raise InputError("--y", paths[-1], "another quantity than the other axes")
    count = int(case.rig().feed.blows.si) if own is None else own
    return Plan(dump_case(case), axes, count, train)
