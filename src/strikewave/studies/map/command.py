"""``strikewave map``: how even a machine's blows are over two of its settings, and where they are even nearest."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Annotated, Literal

import typer

from strikewave.reporting.options import CaseName, Changes, RunningInProcesses, Size, grid_size, one_of, share
from strikewave.reporting.output_options import StudyOutput
from strikewave.studies.map import EQUAL, POINTS, TRAIN, X, Y

SIZE = Size(*POINTS)
"""Points along the axes."""


@dataclass(frozen=True)
class MapAxes:
    """Axes of a map, as options.

    Attributes
    ----------
    x, y : str
        Setting along each axis, with a range or without.
    panels : str or None
        Third setting with the value of each panel; None for one panel.
    points : Size
        Points along x and y.
    log : list of str or None
        Axes with logarithmic spacing.
    """

    x: Annotated[
        str,
        typer.Option(
            "--x",
            metavar="SETTING[=LOW..HIGH]",
            help='Setting along x with its range, such as machine.speed="400..1000 rpm".',
        ),
    ] = X
    y: Annotated[
        str,
        typer.Option(
            "--y",
            metavar="SETTING[=LOW..HIGH]",
            help="Setting along y with its range; without one, half to twice the value of the case.",
        ),
    ] = Y
    panels: Annotated[
        str | None,
        typer.Option(
            "--panels",
            metavar="SETTING=VALUE,...",
            help='Third setting, a panel for each value, such as object.damper="10 N s/m, 40 N s/m"; none by default.',
            show_default=False,
        ),
    ] = None
    points: Annotated[Size, grid_size("--points", help="Number of points along x and y; 60x60 by default.")] = SIZE
    log: Annotated[
        list[str] | None,
        one_of(
            "--log", choices=("x", "y"), help="Logarithmic spacing along x or y; linear by default; may be repeated."
        ),
    ] = None

    def typed(self) -> tuple[str, str, str | None]:
        """Return the axes as `strikewave.map` takes them."""
        x, y = (f"{text} log" if axis in (self.log or ()) else text for axis, text in (("x", self.x), ("y", self.y)))
        return x, y, self.panels


def command(
    case: CaseName,
    *,
    axes: MapAxes,
    blows: Annotated[
        int | None,
        typer.Option(
            "--blows", metavar="COUNT", help="Number of blows; that of the case by default.", show_default=False
        ),
    ] = None,
    train: Annotated[
        int,
        typer.Option(
            "--train", metavar="COUNT", help="Number of blows of the longer train that names the regime; 0 for none."
        ),
    ] = TRAIN,
    colour: Annotated[
        Literal["cv", "cv_later", "peak", "first_peak", "largest_displacement", "stop_force", "train_time", "missed"],
        typer.Option("--colour", help="Quantity that the picture shows."),
    ] = "cv",
    want_cv: Annotated[
        float, share("--want-cv", help="Largest coefficient of variation of equal blows; 2 % by default.")
    ] = EQUAL,
    running: RunningInProcesses,
    changes: Changes = None,
    output: StudyOutput,
) -> int:
    """Map a machine over two of its settings.

    Shows the scatter of the peaks of its blows, and the regime that a longer train settles to. A map that is stopped
    is continued by the same command. The nearest setting with equal blows is tried in a full run; the exit code is 3
    where there is none. With --json, no files are written unless --out is given.
    """
    from strikewave.cases.case import load_case
    from strikewave.studies.engine.runner import Workers
    from strikewave.studies.map.report import MapCommand
    from strikewave.studies.map.study import axes_of, check_plan, plan_of

    loaded = output.tested(load_case(case, changes or ()))
    plan = plan_of(loaded, axes_of(loaded, axes.typed(), axes.points), blows, train)
    count = min(running.workers, os.cpu_count() or 1)
    seconds = check_plan(plan, count)
    workers = Workers(count, cluster=running.cluster)
    making = MapCommand(
        loaded, plan, workers.pool(), want_cv, seconds, colour, place=running.store, fresh=running.fresh
    )
    return making.run(changes or (), output)
