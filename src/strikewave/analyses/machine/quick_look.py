"""A first look at a machine while its settings are moved: all blows by the fast engine, the first pulse in full.

A full run of a train takes about a second, its samples the most of it. What is looked at here takes a tenth: the fast
engine for all blows, and the bodies in full only up to the first blow that strikes.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from strikewave.analyses.machine.band import TOLERANCE
from strikewave.analyses.machine.build import build_machine
from strikewave.analyses.machine.result import SHOWN_WIDTHS
from strikewave.cases.case import Case
from strikewave.machines import Blow, MachineRun, blows, run_machine
from strikewave.machines.blows import pulse_window
from strikewave.machines.fast_run import TrainBlow, fast_train, why_not

Array = NDArray[np.float64]

PULSE_TOLERANCE = 1e-6
"""Local error of a step of the first blow: the curve moves by less than its line is wide."""
SAMPLES = 400
"""Samples of the curve of a blow: as many as a diagram has pixels across."""
MOST_PASSES = 60
"""Passes of a first look: more do not stand apart in a diagram, and a train of thousands would not be a first look."""
NO_ARRAY = np.zeros(0)


@dataclass(frozen=True)
class QuickLook:
    """What a first look shows, SI.

    Attributes
    ----------
    blows : sequence of TrainBlow or Blow
        Every pass, missed ones among them.
    since, force, acceleration : ndarray
        Time after first touch, contact force and rigid-body acceleration of the first blow that struck.
    fast : bool
        Whether the table is of the fast engine; otherwise all of it is a full run of the bodies.
    bodies_only : bool
        Whether the object is a stack whose waves are left out here.
    """

    blows: Sequence[TrainBlow | Blow]
    since: Array
    force: Array
    acceleration: Array
    fast: bool
    bodies_only: bool

    @property
    def first(self) -> TrainBlow | Blow | None:
        """The first blow that struck; None where none did."""
        return next((blow for blow in self.blows if blow.kind != "missed"), None)


def quick_look(case: Case) -> QuickLook:
    """Return a first look at a machine case: a tenth of a second instead of one.

    Parameters
    ----------
    case : Case
        Of a machine.

    Raises
    ------
    InputError
        If the case is that of no machine, or parts of it do not fit together.
    IntegrationError
        If the motion cannot be followed.

    Examples
    --------
    >>> from strikewave import load_case
    >>> look = quick_look(load_case("li-ma-2019"))
    >>> len(look.blows), look.fast, round(look.first.rigid_peak / 9.80665, -1)
    (11, True, 4150.0)
    """
    case.impact()
    machine = build_machine(case)
    bodies = dataclasses.replace(machine, layered=None)
    bodies_only = machine.layered is not None
    if bodies.launch is None and not why_not(bodies):
        longer = bodies.drive.feed.blows > MOST_PASSES
        table = fast_train(bodies, MOST_PASSES if longer else None, tolerance=TOLERANCE).blows
        struck = next((place for place, blow in enumerate(table) if blow.kind != "missed"), None)
        if struck is None:
            return QuickLook(table, NO_ARRAY, NO_ARRAY, NO_ARRAY, True, bodies_only)
        run = run_machine(bodies.with_feed(blows=struck + 1), PULSE_TOLERANCE)
        return QuickLook(table, *_pulse(run, blows(run)), True, bodies_only)
    run = run_machine(bodies, PULSE_TOLERANCE)
    full = blows(run)
    return QuickLook(full, *_pulse(run, full), False, bodies_only)


def _pulse(run: MachineRun, found: Sequence[Blow]) -> tuple[Array, Array, Array]:
    """Return time after first touch, contact force and rigid-body acceleration of the first blow that struck."""
    first = next((blow for blow in found if blow.kind != "missed"), None)
    if first is None:
        return NO_ARRAY, NO_ARRAY, NO_ARRAY
    longest = run.end - first.time
    shown = min(SHOWN_WIDTHS * first.width, longest) if first.width > 0.0 else longest
    return pulse_window(run, first.time, shown, shown / SAMPLES) if math.isfinite(shown) else (NO_ARRAY,) * 3
