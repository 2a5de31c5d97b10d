"""The few numbers that a run is judged by: of its contacts and its ledgers, and the axis of its blow; SI."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from strikewave.fem.run import FemRun
from strikewave.signal.pulse import crossing, refine_peak

Array = NDArray[np.float64]

ENERGY_LIMIT = 0.01
"""Share of the energy in play that may be missing or too much."""
HOURGLASS_LIMIT = 0.05
"""Share of the largest internal energy that may stand in hourglass modes."""
WIDTH_SHARE = 0.1
"""Share of the peak at which a duration begins and ends."""
ALIGNED = math.cos(math.radians(5.0))
"""Cosine of the angle to x, y or z below which the axis of a blow is taken as that one."""


@dataclass(frozen=True)
class ContactMeasure:
    """A contact over the whole run.

    Attributes
    ----------
    peak, at : float
        Largest force, N, between samples by a parabola, and its time, s.
    impulse : float
        Size of the impulse over the run, N s.
    begin, end : float
        s: when the force first rises above a tenth of its peak, and when it last falls below.
    """

    peak: float
    at: float
    impulse: float
    begin: float
    end: float

    @property
    def duration(self) -> float:
        """From first to last tenth of the peak, all contacts and gaps between them, s."""
        return self.end - self.begin


@dataclass(frozen=True)
class LedgerMeasure:
    """How well a run keeps its books.

    Attributes
    ----------
    energy : float
        Largest energy error in size, with its sign: below 0 energy is missing; a share of the energy in play.
    hourglass : float
        Largest hourglass energy over the largest internal energy.
    momentum : float
        As `FemRun.momentum_error`.
    """

    energy: float
    hourglass: float
    momentum: float


def contact_measure(run: FemRun, name: str) -> ContactMeasure | None:
    """Measure a contact or wall by the size of its force; None where nothing touched.

    Examples
    --------
    >>> from types import SimpleNamespace
    >>> t = np.linspace(0.0, 1e-3, 1001)
    >>> force = np.outer(1e3 * np.sin(np.pi * np.clip(t, 2e-4, 8e-4) / 6e-4 - np.pi / 3), [0, 0, 1])
    >>> run = SimpleNamespace(time=t, force={"a-b": force}, impulse={"a-b": force.cumsum(axis=0) * t[1]})
    >>> found = contact_measure(run, "a-b")
    >>> round(found.peak, 2), round(found.at * 1e6), round(found.duration * 1e6), round(found.impulse, 4)
    (1000.0, 500, 562, 0.382)
    """
    size = np.linalg.norm(run.force[name], axis=1)
    index = int(np.argmax(size))
    if not size[index] > 0.0:
        return None
    place, peak = refine_peak(size, index)
    above = np.flatnonzero(size > WIDTH_SHARE * peak)
    begin = crossing(size, int(above[0]), WIDTH_SHARE * peak, -1)
    end = crossing(size, int(above[-1]), WIDTH_SHARE * peak, 1)
    places = [place, 0.0 if np.isnan(begin) else begin, size.size - 1.0 if np.isnan(end) else end]
    at, first, last = (float(t) for t in np.interp(places, np.arange(size.size), run.time))
    return ContactMeasure(float(peak), at, float(np.linalg.norm(run.impulse[name][-1])), first, last)


def ledger_measure(run: FemRun) -> LedgerMeasure:
    """Measure the energy error, the hourglass energy and the momentum error of a run."""
    error = run.energy_error
    internal = float(np.max(run.energy["internal"]))
    glass = float(np.max(np.abs(run.energy["hourglass"])))
    share = glass / internal if internal > 0.0 else (0.0 if glass == 0.0 else np.inf)
    return LedgerMeasure(float(error[int(np.argmax(np.abs(error)))]), share, run.momentum_error)


def blow_axis(run: FemRun) -> Array:
    """Return the axis along which a run is told: a unit vector along the greatest change of momentum of a part.

    Its largest component is positive; an axis within 5 degrees of x, y or z is taken as that one. Where nothing
    changes, it is z.
    """
    changes = [part.mass * (part.velocity - part.velocity[0]) for part in run.parts.values()]
    peaks = [change[int(np.argmax(np.linalg.norm(change, axis=1)))] for change in changes]
    best = max(peaks, key=lambda change: float(np.linalg.norm(change)), default=np.zeros(3))
    size = float(np.linalg.norm(best))
    if not size > 0.0:
        return np.array([0.0, 0.0, 1.0])
    axis = best / size
    largest = int(np.argmax(np.abs(axis)))
    if abs(axis[largest]) > ALIGNED:
        axis = np.eye(3)[largest]
    return np.asarray(axis * np.sign(axis[largest]))
