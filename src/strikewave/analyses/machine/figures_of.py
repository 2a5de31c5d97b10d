"""The results of a machine's run that may have a band, by name."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from statistics import median
from typing import Protocol

from strikewave.analyses.machine.sensor_readings import BlowReading

OF_A_BLOW = ("rigid_peak", "width", "velocity_change")
"""What has a band of each blow."""
SENSOR = "sensor.{}.peak"
"""Name of the peak of a sensor."""


class TimedBlow(Protocol):
    """A blow as far as its results go, of a full or a fast run."""

    @property
    def kind(self) -> str:
        """full, glancing, double or missed."""

    @property
    def time(self) -> float:
        """First touch, s."""


def figures_of(found: Sequence[TimedBlow]) -> dict[str, float]:
    """Return the results of a run that have a band, by name: those that there are.

    Examples
    --------
    >>> from strikewave import load_case, run_case
    >>> list(figures_of(run_case(load_case("jesd22-b111-b")).blows))
    ['first.rigid_peak', 'first.width', 'first.velocity_change']
    """
    struck = [blow for blow in found if blow.kind != "missed"]
    if not struck:
        return {}
    later = [blow for blow in struck[1:] if blow.kind in ("full", "double")]
    figures = {f"first.{name}": float(getattr(struck[0], name)) for name in OF_A_BLOW}
    if later:
        figures |= {f"typical.{name}": median(float(getattr(blow, name)) for blow in later) for name in OF_A_BLOW}
    if len(struck) > 1:
        figures["interval"] = median(b.time - a.time for a, b in pairwise(struck))
    return {name: value for name, value in figures.items() if math.isfinite(value)}


def sensor_figures(readings: Sequence[BlowReading | None]) -> dict[str, float]:
    """Return the size of the peak of each sensor in the first blow, which may be of either sign; not of one cut off."""
    first = next((reading for reading in readings if reading is not None), None)
    kept = {} if first is None else {name: pulse for name, pulse in first.sensors.items() if not pulse.cut}
    peaks = {SENSOR.format(name): abs(pulse.peak) for name, pulse in kept.items()}
    return {name: peak for name, peak in peaks.items() if math.isfinite(peak)}
