"""The map of a machine's settings: how even its blows are, what its trains settle to, and the nearest even setting."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Iterator, Mapping
from functools import cached_property
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from strikewave.analyses.machine.notices import fast_not_judged, run_verdict
from strikewave.base import declare
from strikewave.base.compiling import compiling_shown
from strikewave.base.datasets import LabelledArrays, quantity
from strikewave.base.declare import NO_UNIT, Quantity
from strikewave.base.errors import InputError, IntegrationError, StrikewaveError, nearest
from strikewave.base.quantities import Value
from strikewave.base.result import RUN_PASSED, RUN_STATUSES, Notice
from strikewave.base.shock_quantities import VARIATION
from strikewave.cases.case import Case, dump_case
from strikewave.machines import blows
from strikewave.machines.run import run_machine
from strikewave.reporting.columns import HISTORY_DIGITS, Column, csv_table
from strikewave.studies.axes import HALF_TO_TWICE, Axis, axis_of, case_at, units_of
from strikewave.studies.engine.plan import AxisVariation, StudyVariable, grid, read_ends, read_list
from strikewave.studies.engine.pools import Pool
from strikewave.studies.engine.runner import Advance, Workers, as_workers, at_work, finished_runs, share_reporter
from strikewave.studies.engine.store import RunStore
from strikewave.studies.map import EQUAL, POINTS, TRAIN, X, Y
from strikewave.studies.map.cells import (
    FIELDS,
    MEAN_PEAK,
    NAMES,
    NOTE,
    PLACE,
    REASONS,
    CellEvaluation,
    EvenSetting,
    FullRun,
    MapCell,
    MapPlan,
    NearestSetting,
    Present,
    Refusal,
    SettingOfCase,
    cell_of,
    machine_of,
)
from strikewave.studies.simulation import RUN_TOLERANCE
from strikewave.studies.study import Study, key_number
from strikewave.uncertainty.statistics import variation

Array = NDArray[np.float64]

LEAST_TRAIN = 12
"""Fewest blows of a longer train: its second half then shows a period of two `CYCLES` times."""
MOST_TRAIN = 1000
"""Most blows of a train. Chosen: what has not settled in a thousand blows is no setting for a test."""
LEAST_BLOWS = 2
"""Fewest blows of the machine's own: one alone does not scatter."""
LEAST_SIDE, MOST_SIDE = 2, 1000
"""Fewest and most points along x and y: an axis has two ends, and a screen shows no more."""
MOST_CELLS = 1_000_000
"""Most cells: they take 104 MB with their 13 fields, and the map's files more."""
MOST_SECONDS = 12 * 3600.0
"""Longest estimated time of a map, s: a night."""
SECONDS_A_BLOW = 0.4e-3
"""About what a blow takes on one core, s: for the estimate only (measured: 0.3 ms, li-ma-2019)."""
SHARE = Quantity(NO_UNIT, "%", decimals=1, digits=0)
LOG = " log"
"""End of the text of an axis with logarithmic spacing, as of a range of a sweep."""
MOST_PANELS = 6
"""Most values of a third setting."""
CONFIRMED = 5
"""Even settings nearest to the case that are tried by full runs until one keeps the limit: each takes some 0.1 s
(measured, li-ma-2019). Where the nearest five all disagree, the fast run is not to be trusted there."""


@declare.dataclass(eq=False)
class MapStudy(Study):
    """A map; see `Result` for what it shares with others.

    Attributes
    ----------
    values : ndarray
        Shape (panels, rows, columns, fields); see `strikewave.studies.map.cells.FIELDS`.
    wanted : float
        Coefficient of variation below which blows count as even.
    present : dict
        The case itself, as a cell.
    setting : EvenSetting or None
        The nearest even setting that a full run confirms; the case itself, at distance 0, where it is even already.
    refusals : tuple of Refusal
        Nearer ones whose full runs disagree.
    colour : str
        Quantity that the colours of the picture show: one of `strikewave.studies.map.figures.COLOURS`.
    """

    command: ClassVar[str] = "map"
    data_file: ClassVar[str] = "map.nc"

    main_rows: ClassVar[str] = "cell_table"

    plan: MapPlan
    blows = declare.computed(declare.count("blows of the machine in each cell"))(lambda study: study.plan.blows)
    train = declare.computed(declare.count("blows of the longer train that names the regime"))(
        lambda study: study.plan.train
    )
    values: Array
    wanted: float
    present: dict[str, float]
    setting: EvenSetting | None = None
    refusals: tuple[Refusal, ...] = ()
    colour: str = "cv"

    @cached_property
    def case(self) -> Case:
        """The case that is mapped."""
        return self.plan.case

    @property
    def marked_text(self) -> str:
        """The case as text, and above it what was asked."""
        return self.plan.marked_text(self.wanted)

    @property
    def paths(self) -> tuple[str, ...]:
        """The paths of the axes."""
        return tuple(axis.path for axis in self.plan.axes)

    @property
    def broken(self) -> bool:
        """True if no setting of the map has equal blows, or none that a full run confirms."""
        return self.setting is None

    @property
    def here(self) -> tuple[float, ...]:
        """The place of the case on each axis, SI."""
        values = self.case.values()
        return tuple(values[axis.path].si for axis in self.plan.axes)

    def field(self, name: str) -> Array:
        """Return one field, shape (panels, rows, columns)."""
        return np.asarray(self.values[..., PLACE[name]])

    def over_range(self, path: str) -> tuple[float, float] | None:
        """Return the ends of the range over which an assumed value of the case is in doubt; None where it is known."""
        value = self.case.values()[path]
        low, high = HALF_TO_TWICE
        return (low * value.si, high * value.si) if value.provenance == "assumed" else None

    cell_count = declare.computed(declare.count("how many cells", headline="cells", in_document=False))(
        lambda study: math.prod(study.plan.shape)
    )
    axes = declare.computed(declare.rows(Axis, "what the axes are of"))(lambda study: study.plan.axes)
    regimes = declare.computed(declare.word("names of the regimes, by their codes from 0"))(lambda study: NAMES)
    reasons = declare.computed(declare.word("reasons for no result, by their codes from 0"))(lambda study: REASONS)
    wanted_cv = declare.computed(declare.number(VARIATION, "largest coefficient of variation of equal blows"))(
        lambda study: study.wanted
    )

    @declare.computed(declare.part(Present, "the case itself", key="present"))
    def present_setting(self) -> Present:
        """The place of the case, and the result of its blows."""
        values = self.case.values()
        pairs = zip(self.paths, self.here, strict=True)
        return Present({path: SettingOfCase(at, values[path].provenance) for path, at in pairs}, self.present)

    present_cv = key_number(VARIATION, "CV of the peaks of the case")(lambda study: study.present["cv"])
    present_peak = key_number(MEAN_PEAK, "mean peak of the case")(lambda study: study.present["peak"])

    @declare.computed(declare.number(SHARE, "share of the cells in each regime"))
    def shares(self) -> dict[str, float]:
        """Share of the cells in each regime that occurs."""
        codes = self.field("regime")
        shares = {name: float(np.mean(codes == code)) for code, name in enumerate(NAMES)}
        return {name: share for name, share in shares.items() if share > 0.0}

    @declare.computed(declare.count("cells without a result, by reason"))
    def failures(self) -> dict[str, int]:
        """The number of cells without a result, by reason."""
        codes = self.field("reason").astype(int)
        return {text: int((codes == k).sum()) for k, text in enumerate(REASONS) if k and (codes == k).any()}

    nearest = declare.computed(declare.part(EvenSetting, "nearest setting with equal blows; null where there is none"))(
        lambda study: study.setting
    )
    nothing_even = declare.computed(
        declare.word(
            "what is said where there is none",
            headline="settings with equal blows that a full run confirms",
            in_document=False,
        )
    )(lambda study: "none" if study.setting is None else None)

    @declare.computed(declare.rows(NearestSetting, "the nearest setting", headline="each", in_document=False))
    def shown_setting(self) -> list[NearestSetting]:
        """The nearest even setting in words; none where there is none."""
        pairs = zip(self.plan.axes, self.setting.values, strict=True) if self.setting else ()
        return [NearestSetting(axis.path, axis.words(value)) for axis, value in pairs]

    nearest_cv = key_number(VARIATION, "CV there, by a full run")(
        lambda study: study.setting.full_run.cv if study.setting else None
    )
    nearest_peak = key_number(MEAN_PEAK, "mean peak there")(
        lambda study: study.setting.full_run.peak if study.setting else None
    )
    refused = declare.computed(declare.rows(Refusal, "nearer settings that a full run did not confirm, and why"))(
        lambda study: study.refusals
    )
    cells = declare.computed(declare.part(MapCell, "each of them as an array"))(
        lambda study: {name: study.field(name) for name in FIELDS}
    )

    @declare.computed(declare.word("what the checks of each cell came to, by code"))
    def verdict(self) -> Array:
        """The verdict of each cell by its place in `RUN_STATUSES`; NaN where none is known."""
        codes = [
            RUN_STATUSES.index(status) if status in RUN_STATUSES else math.nan for status in self.verdicts.statuses
        ]
        return np.array(codes, dtype=float).reshape(self.plan.shape)

    verdict_codes = declare.computed(declare.word("what the verdict of a cell is, by its code"))(
        lambda study: RUN_STATUSES
    )
    variables = declare.computed(declare.rows(StudyVariable, "what was varied", in_document=False))(
        lambda study: study.plan.variation.variables
    )

    @declare.computed(declare.table("all cells"))
    def cell_table(self) -> list[Column]:
        """All cells, a file has settings in the units asked for; regimes by name."""
        settings = zip(*self.plan.rows, strict=True)
        columns = [declared.column(values) for declared, values in zip(self.variables, settings, strict=True)]
        for name, declared in declare.declarations(MapCell).items():
            values = [_named(name, value) for value in self.field(name).flat]
            si, usual, label, *_ = ("", "", *declared.quantity[2:]) if name in COUNTED else declared.quantity
            columns.append(Column(name, values, si, "", usual if name in SHOWN else None, label))
        return [*columns, Column("verdict", self.verdicts.texts, shown="")]

    @property
    def named_units(self) -> Mapping[str, str]:
        """SI units of the settings."""
        return {axis.path: axis.si_unit for axis in self.plan.axes}

    @property
    def arrays(self) -> LabelledArrays:
        """The map with its units; attributes carry the case and the meaning of the codes."""
        axes = self.plan.axes
        dimensions = ("panel", "y", "x")
        named = (axes[2] if len(axes) > 2 else None, axes[1], axes[0])
        coordinates = {
            dimension: quantity(dimension, np.array(axis.values), axis.si_unit or "1", axis.path)
            for dimension, axis in zip(dimensions, named, strict=True)
            if axis is not None
        }
        variables = {
            name: quantity(dimensions, self.field(name), declared.quantity.si, declared.meaning)
            for name, declared in declare.declarations(MapCell).items()
        }
        variables["verdict"] = quantity(
            dimensions, self.verdict, "1", f"what the checks came to, by code: {' | '.join(RUN_STATUSES)}"
        )
        attributes = {"case": dump_case(self.plan.case), "regimes": " | ".join(NAMES), "reasons": " | ".join(REASONS)}
        return LabelledArrays.of(
            variables, coordinates, {**attributes, "blows": self.plan.blows, "train": self.plan.train}
        )

    def texts(self) -> dict[str, str]:
        """Return the JSON document, and the case of the nearest even setting, as files."""
        even = {} if self.setting is None else {"equal-blows.toml": dump_case(self.nearest_case())}
        return super().texts() | even

    def tables(self) -> dict[str, str]:
        """Return the table of cells."""
        return {"map.csv": csv_table(self.cell_table, HISTORY_DIGITS)}

    @property
    def scales(self) -> tuple[float, ...]:
        """The scale of a step along each axis: the value of the case, or the axis's range where that is 0."""
        pairs = zip(self.here, self.plan.axes, strict=True)
        return tuple(abs(at) or axis.values[-1] - axis.values[0] or 1.0 for at, axis in pairs)

    def even_settings(self) -> list[tuple[float, tuple[float, ...], dict[str, float]]]:
        """Return distance, values and cell of the settings whose blows all come and are even, nearest first.

        The case itself is the first of them where it is even.
        """
        even = (self.field("cv") <= self.wanted) & (self.field("missed") == 0)
        settings = [(0.0, self.here, self.present)] if self.even else []
        for place in np.flatnonzero(even).tolist():
            values = self.plan.rows[place]
            steps = [(v - at) / scale for v, at, scale in zip(values, self.here, self.scales, strict=True)]
            cell = self.values.reshape(-1, len(FIELDS))[place].tolist()
            settings.append((math.hypot(*steps), values, dict(zip(FIELDS, cell, strict=True))))
        return sorted(settings, key=lambda setting: setting[:2])

    @property
    def even(self) -> bool:
        """True if the blows of the case itself all come and are even, by the fast run."""
        return self.present["cv"] <= self.wanted and self.present["missed"] == 0

    def at(self, values: tuple[float, ...]) -> str:
        """Return a setting in words."""
        return ", ".join(f"{axis.path} = {axis.typed(value)}" for axis, value in zip(self.axes, values, strict=True))

    def case_of(self, values: tuple[float, ...]) -> Case:
        """Return the case with other settings; their tolerances stay. The case itself where nothing is other."""
        if values == self.here:
            return self.case
        return case_at(self.case, self.plan.axes, values, NOTE, keep_tolerances=True)

    def nearest_case(self) -> Case:
        """Return the case with the nearest even setting; the case itself where there is none."""
        return self.case if self.setting is None else self.case_of(self.setting.values)


COUNTED = ("missed", "regime", "period", "reason")
"""Fields of a cell that are counts or codes: their heads have no unit."""
SHOWN = ("cv", "peak", "missed", "regime")
"""Fields of a cell that screens and notebooks show."""


def _named(name: str, value: float) -> str | float:
    """Return a value of the table; a code by its name."""
    if name in ("regime", "reason") and not math.isnan(value):
        return (NAMES if name == "regime" else REASONS)[int(value)]
    return float(value)


def check_plan(plan: MapPlan, workers: int) -> float:
    """Return about how long a map takes, s, and refuse one that takes too long."""
    panels, rows, columns = plan.shape
    if not (plan.train == 0 or LEAST_TRAIN <= plan.train <= MOST_TRAIN):
        raise InputError("--train", plan.train, f"0, or {LEAST_TRAIN} to {MOST_TRAIN} blows")
    if not LEAST_BLOWS <= plan.blows <= MOST_TRAIN:
        raise InputError("--blows", plan.blows, f"{LEAST_BLOWS} to {MOST_TRAIN} blows")
    seconds = panels * rows * columns * max(plan.blows, plan.train) * SECONDS_A_BLOW / workers
    if seconds > MOST_SECONDS:
        allowed = f"a map of {MOST_SECONDS / 3600:g} hours at most (this one: about {seconds / 3600:.0f})"
        raise InputError("--points", f"{columns}x{rows}", allowed, "fewer points, blows or a shorter train")
    return seconds


@compiling_shown()
def make_map(
    plan: MapPlan,
    wanted: float,
    store: RunStore | None = None,
    pool: Pool | None = None,
    advance: Advance | None = None,
) -> MapStudy:
    """Make a map: every cell run fast, the nearest even setting tried in full; the pool is ended here."""
    check_plan(plan, 1 if pool is None else pool.width)
    case = plan.case
    machine_of(case)
    present = dict(zip(FIELDS, cell_of(case, plan.blows, plan.train).tolist(), strict=True))
    with at_work(store, pool) as (open_store, open_pool):
        not_judged = fast_not_judged(case)
        runs = finished_runs(plan.job, plan.rows, open_store, open_pool, advance, "cells", not_judged)
    cells = runs.numbers.reshape(*plan.shape, len(FIELDS))
    study = MapStudy(plan, cells, wanted, present, verdicts=runs.verdicts)
    setting, refused = confirmed(study)
    study = dataclasses.replace(study, setting=setting, refusals=refused)
    return dataclasses.replace(study, notices=(*runs.verdicts.notices(), *range_notices(study)))


def range_notices(study: MapStudy) -> Iterator[Notice]:
    """Warn where the nearest even setting is nearest only because the map ends there, on the side of the case."""
    if study.setting is None:
        return
    for axis, here, at in zip(study.plan.axes[:2], study.here, study.setting.values, strict=False):
        low, high = axis.values[0], axis.values[-1]
        if not low <= here <= high and at == (low if here < low else high):
            end, way = ("low", "lower") if here < low else ("high", "higher")
            message = (
                f"the nearest setting with equal blows stands at the {end} end of {axis.path}, {axis.typed(at)}, and "
                f"the case beyond it, at {axis.typed(here)}: nearer settings may lie between them; take a {way} end"
            )
            yield Notice("range-end", message, at, here)


def confirmed(study: MapStudy) -> tuple[EvenSetting | None, tuple[Refusal, ...]]:
    """Return the nearest even setting that a full run confirms, and those nearer that it does not."""
    refused: list[Refusal] = []
    # the fast run knows the object as two bodies: a full run decides
    for distance, values, cell in study.even_settings()[:CONFIRMED]:
        settings = dict(zip(study.paths, values, strict=True))
        try:
            full_run = FullRun(*in_full(study.case_of(values), study.plan.blows))
        except (StrikewaveError, IntegrationError) as error:
            refused.append(Refusal(study.at(values), settings, f"the full run failed: {error}"))
            continue
        if full_run.cv <= study.wanted:
            return EvenSetting(settings, distance, cell, full_run), tuple(refused)
        refused.append(Refusal(study.at(values), settings, f"the full run has a CV of {100.0 * full_run.cv:.3g} %"))
    return None, tuple(refused)


def in_full(case: Case, count: int) -> tuple[float, float]:
    """Return variation and mean of the rigid peaks of a full run with the case's own feed."""
    machine = machine_of(case)
    own = count == round(case.rotary_tables().feed.blows.si)
    run = run_machine(machine.with_feed(blows=count), RUN_TOLERANCE)
    train = blows(run)
    peaks = np.array([blow.rigid_peak for blow in train[:count] if blow.kind != "missed"])
    if peaks.size < count:
        raise StrikewaveError(f"{peaks.size} of {count} blows came")
    wanted = case.with_values({"feed.blows": Value(si=float(count), typed=count)})
    verdict = run_verdict(wanted, run, train if own else train[:count])
    if verdict.status != RUN_PASSED:
        raise StrikewaveError(f"it failed a check ({', '.join(verdict.codes)})")
    return variation(peaks), float(peaks.mean())


def plan_of(case: Case, axes: tuple[Axis, ...], own: int | None = None, train: int = TRAIN) -> MapPlan:
    """Return the plan of a map of a case over two or three of its quantities."""
    paths = [axis.path for axis in axes]
    if len(set(paths)) < len(paths):
        raise InputError("--y", paths[-1], "another quantity than the other axes")
    sizes = [len(axis.values) for axis in axes]
    sides = all(LEAST_SIDE <= side <= MOST_SIDE for side in sizes[:2])
    if not sides or math.prod(sizes) > MOST_CELLS:
        panels = f" x {sizes[2]} panels" if len(sizes) > 2 and sizes[2] > 1 else ""
        allowed = f"{LEAST_SIDE} to {MOST_SIDE} points along each axis, and {MOST_CELLS} cells at most"
        raise InputError("--points", f"{sizes[0]}x{sizes[1]}{panels}", allowed)
    count = int(case.rotary_tables().feed.blows.si) if own is None else own
    variables = tuple(StudyVariable(axis, is_range=place < 2) for place, axis in enumerate(axes))
    variation = AxisVariation(variables, NOTE, {(): case})
    return MapPlan(
        case=case, variation=variation, evaluation=CellEvaluation(count, train), rows=grid(variables), axes=axes
    )


def map(
    case: Case,
    x: str = X,
    y: str = Y,
    *,
    panels: str | None = None,
    points: tuple[int, int] = POINTS,
    blows: int | None = None,
    train: int = TRAIN,
    want_cv: float = EQUAL,
    workers: int | Workers = 1,
    progress: Callable[[float], None] | None = None,
) -> MapStudy:
    """Map a machine over two of its settings: how even its blows are, and the nearest setting with equal blows.

    Parameters
    ----------
    case : Case
        Case of a rotary machine.
    x, y : str, optional
        Setting along each axis, with a range or without: ``machine.speed=400..1000 rpm``. Without one it goes from
        half to twice the value of the case; ``log`` behind it for logarithmic spacing.
    panels : str, optional
        Third setting, with the value of each panel: ``object.damper=10 N s/m, 40 N s/m``.
    points : (int, int), optional
        Along x and y.
    blows : int, optional
        Number of blows; that of the case by default.
    train : int, optional
        Blows of the longer train that names the regime; 0 for none.
    want_cv : float, optional
        Largest coefficient of variation of equal blows.
    workers : int or Workers, optional
        Processes, or who runs instead, such as ``strikewave.Workers(cluster="tcp://host:8786")``.
    progress : callable, optional
        Called with the share done, 0 to 1.

    Returns
    -------
    MapStudy
        Fields over both settings, and the nearest setting with equal blows, if there is one.

    Raises
    ------
    InputError
        If the case has no such setting, a range is none, or the map is too large.

    Examples
    --------
    >>> import strikewave
    >>> case = strikewave.load_case("li-ma-2019")
    >>> study = strikewave.map(case, "machine.speed=700..730 rpm", points=(2, 2), blows=3, train=0)
    >>> study.field("cv").shape
    (1, 2, 2)
    """
    plan = plan_of(case, axes_of(case, (x, y, panels), points), blows, train)
    return make_map(plan, want_cv, pool=as_workers(workers).pool(), advance=share_reporter(progress))


def axes_of(case: Case, typed_axes: tuple[str, str, str | None], points: tuple[int, int]) -> tuple[Axis, ...]:
    """Return the axes of a map from what was typed; one with ``log`` at its end has logarithmic spacing."""
    axes = []
    for option, spaced, size in zip(("x", "y"), typed_axes[:2], points, strict=True):
        text = spaced.removesuffix(LOG)
        path, equals, typed = (part.strip() for part in str(text).partition("="))
        _check_path(case, path)
        ends = read_ends(case, path, typed)
        if equals and ends is None:
            raise InputError(f"--{option}", text, "setting=low..high", f'such as --{option} {X}="400..1000 rpm"')
        axes.append(axis_of(case, path, ends, size, text != spaced))
    if typed_axes[2] is None:
        return tuple(axes)
    path, _, listed = (part.strip() for part in typed_axes[2].partition("="))
    _check_path(case, path)
    values = read_list(case, path, listed)
    if not 1 <= len(values) <= MOST_PANELS:
        allowed = f"setting=value,value, with 1 to {MOST_PANELS} values"
        raise InputError("--panels", typed_axes[2], allowed, 'such as object.damper="10 N s/m, 40 N s/m"')
    return (*axes, Axis(path, *units_of(path, values[0]), tuple(sorted(v.si for v in values))))


def _check_path(case: Case, path: str) -> None:
    if path not in case.values():
        raise InputError(path, path, "a quantity of the case", nearest(path, case.values()))
