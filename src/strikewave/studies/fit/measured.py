"""Measurements and their residuals against a run: stated numbers, and whole pulses of records.

A pulse is compared over its whole width and half of it on either side, on samples that both histories can have: those
of the coarser one. What the finer one holds beyond is taken off it. The run is laid on the record where the sum of
squares is least, anew at each run, so that no value is fitted to when somebody pressed a button.
"""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strikewave.analyses.compare.agreement import BESIDE, ComparedCurve
from strikewave.base.errors import InputError
from strikewave.records.baseline import MEDIAN
from strikewave.signal.alignment import EvenHistory
from strikewave.signal.filters import Filter
from strikewave.signal.interpolation import REACH, resampled
from strikewave.signal.pulse import FOOT, RISE_LOW, crossing
from strikewave.studies.fit.covariance import NONE, autocorrelation
from strikewave.studies.simulation import Simulation

Array = NDArray[np.float64]

QUIETEST = 1e-4
"""Noise of a record over its peak, at least: half a step of a 13-bit recorder, and more than any run errs by. A record
without noise, such as one that was simulated, would else be believed beyond what the sampling of a run gives."""
FEWEST_QUIET = 32
"""Samples before the pulse from which its noise is known, at least: its deviation is then good to 12 %."""
FINER = 4
"""Points of a run between two samples of the record: a cubic spline between them then errs by 6e-4 of what lies at 0.42
of the sampling rate, and by 3e-5 at half of that."""
MOST_SAMPLES = 4000
"""Most samples of a pulse: one of more is taken at a coarser step, which still has some hundred to a width."""
TURNED = 0.25
"""Sum of squares of a record turned round, over that of the record, below which it has the other sign: a pulse fits a
run of the other sign nowhere, echoes of both signs about as well."""
ROUNDS, CLOSE = 20, 1e-6  # steps at most for the best shift, and the samples within which it has ended


@dataclass(frozen=True)
class MeasuredNumber:
    """A number that was measured.

    Attributes
    ----------
    name, sensor : str
        Name of a number of the run, and of its sensor where it is of one; or the path of a free field that is known
        from elsewhere.
    unit : str
        SI unit.
    value, uncertainty : float
        With its standard uncertainty, SI.
    typed : str
        As it was typed.
    setting : str
        Changes of the case at which it was measured, in words.
    of_field : bool
        True if it is of a free field.
    left : float
        Factor by which its uncertainty is raised: see `strikewave.studies.fit.covariance.Excess.weight`.
    """

    name: str
    sensor: str
    unit: str
    value: float
    uncertainty: float
    typed: str
    setting: str = ""
    of_field: bool = False
    left: float = 1.0

    @property
    def called(self) -> str:
        """Name in tables and sentences."""
        return f"{self.name} {self.sensor}".strip() + (f" ({self.setting})" if self.setting else "")

    def computed(self, run: Simulation) -> float:
        """Return the number of a run, SI, with the measured sign; NaN where it has none."""
        if self.of_field:
            return run.case.values()[self.name].si
        found = run.number(self.name, self.sensor)
        return math.nan if found is None else math.copysign(found, self.value)

    def residuals(self, run: Simulation) -> Array:
        """Return by how much a run is above it, in standard uncertainties times `left`."""
        computed = self.computed(run)
        if not math.isfinite(computed):
            raise ValueError(f"the run has no {self.called}")
        side = 1.0 if self.of_field else math.copysign(1.0, self.value)
        return np.array([side * (computed - self.value) / (self.uncertainty * self.left)])


@dataclass(frozen=True, eq=False)
class LaidPulse:
    """A run laid on a record, in SI: times of the record, both there, and what was added to the times of the run."""

    time: Array
    measured: Array
    computed: Array
    shift: float


@dataclass(frozen=True, eq=False)
class MeasuredPulse:
    """The pulse of a record.

    Attributes
    ----------
    record : ComparedCurve
        The record about it.
    part : str
        History of the run that it is compared with.
    blow : int
        Number of the blow; 0 for the first that struck.
    time, values : ndarray
        Times and values that are compared, on the common samples, SI.
    deviation : float
        Standard deviation of its noise there, SI.
    quiet : int
        Samples from which it is known; 0 where it is `QUIETEST`.
    correlation : ndarray
        Autocorrelation of the noise by lag.
    low_pass : Filter or None
        Low-pass filter of both histories.
    shot : str
        File and blow that it is of: other channels of the same are no other shot.
    scatter : float
        Standard deviation of its amplitude from shot to shot, as a share; 0 where it is not stated.
    left : float
        Weight of residuals: root mean square of the remainder over the noise; 1 for the noise alone.
    """

    record: ComparedCurve
    part: str
    blow: int
    time: Array
    values: Array
    deviation: float
    quiet: int
    correlation: Array
    low_pass: Filter | None = None
    shot: str = ""
    scatter: float = 0.0
    left: float = 1.0

    @property
    def called(self) -> str:
        """Name in tables and sentences."""
        return self.record.name

    @property
    def shared(self) -> Array:
        """Common error of all residuals by the baseline, a median of the quiet part."""
        memory = 1.0 + 2.0 * float(np.sum(self.correlation[1:]))
        baseline = math.sqrt(MEDIAN * max(memory, 0.0) / self.quiet) if self.quiet else 0.0
        return np.full((self.values.size, 1), baseline / self.left)

    @property
    def stated(self) -> Array:
        """Common error of all residuals by the stated scatter of the amplitude; none where it is not stated."""
        amplitude = self.scatter * self.values / (self.deviation * self.left)
        return amplitude[:, None] if self.scatter else NONE

    @property
    def unit(self) -> str:
        """SI unit."""
        return self.record.unit

    @property
    def step(self) -> float:
        """Time between samples, s."""
        return float(self.time[1] - self.time[0])

    def laid(self, run: Simulation) -> LaidPulse:
        """Return a run laid on the record."""
        from scipy.interpolate import CubicSpline

        curve = run.history(self.part, self.blow, self.record.unit).filtered(self.low_pass)
        fine, step = _finer(curve.history, self.step)
        if abs(fine[0]) <= FOOT * np.max(
            np.abs(fine)
        ):  # the zero of a record is what it reads before, in free fall too
            fine = fine - fine[0]
        at, computed = _laid(self.values, CubicSpline(np.arange(fine.size), fine), fine.size - 1.0, self.step / step)
        return LaidPulse(self.time, self.values, computed, float(self.time[0]) - (curve.history.start + at * step))

    def residuals(self, run: Simulation) -> Array:
        """Return by how much a run is above it, sample by sample, in standard deviations of the noise times `left`."""
        laid = self.laid(run)
        return (laid.computed - laid.measured) / (self.deviation * self.left)

    def band_limited(self, curve: ComparedCurve) -> ComparedCurve:
        """Return a history of a run without what samples of the record cannot hold."""
        fine, step = _finer(curve.history, self.record.history.step)
        return replace(curve, history=curve.history._replace(values=fine, step=step))


Measured = MeasuredNumber | MeasuredPulse


def measured_pulse(
    record: ComparedCurve,
    run: Simulation,
    part: str,
    blow: int,
    low_pass: Filter | None,
    shot: str = "",
    scatter: float = 0.0,
) -> MeasuredPulse:
    """Return the pulse of a record as it is compared with runs such as this one."""
    curve = run.history(part, blow, record.unit)
    part = curve.name.partition(":")[2].rpartition("@")[0] or curve.name.partition(":")[2]
    if not record.unit:
        hint = f"the run is in {curve.unit}: state --unit, such as {'g' if curve.unit == 'm/s^2' else curve.unit}"
        raise InputError("--unit", f"{record.name}, in an unknown unit", "the unit of the record", hint)
    if record.unit != curve.unit:
        hint = "name another part, PART=RECORD, or another channel, RECORD#CHANNEL"
        raise InputError("--to", f"{record.name}, in {record.unit}", f"a record in {curve.unit}, as {curve.name}", hint)
    begin, end, edge = _window(record)
    history = record.history
    step = max(history.step, curve.history.step, (end - begin) / MOST_SAMPLES)
    if step > history.step * (1.0 + 1e-9):
        places = np.arange(math.floor((history.values.size - 1) * history.step / step) + 1) * step / history.step
        values, time = resampled(history.values, places, step / history.step), history.start + places * history.step
    else:
        values, time = history.values, history.time
    kept = (time >= begin) & (time <= end)
    before = values[time < edge]
    noise, peak = (float(np.std(before)) if before.size >= FEWEST_QUIET else 0.0), float(np.max(np.abs(values[kept])))
    known = noise > QUIETEST * peak
    found = MeasuredPulse(
        record,
        part,
        blow,
        np.asarray(time[kept], dtype=float),
        np.asarray(values[kept], dtype=float),
        max(noise, QUIETEST * peak),
        before.size if known else 0,
        autocorrelation(before) if known else np.ones(1),
        low_pass,
        shot,
        scatter,
    )
    turned = replace(found, values=-found.values)
    misfits = [float(np.sum(one.residuals(run) ** 2)) for one in (found, turned)]
    if misfits[1] < TURNED * misfits[0]:
        raise InputError("--to", f"{record.name}, whose pulse has the other sign", "that of the run", "--polarity -1")
    return found


def _window(record: ComparedCurve) -> tuple[float, float, float]:
    """Return begin and end of the compared part, and the end of the quiet part before it, s."""
    history, pulse = record.history, record.pulse
    index = int(np.clip(round((pulse.time - history.start) / history.step), 0, history.values.size - 1))
    whole = _whole_pulse(record.name, record.sign * history.values, index, abs(pulse.peak), record.measured is None)
    first, last = (history.start + edge * history.step for edge in whole)
    width = last - first
    begin, end = max(first - BESIDE * width, history.start), min(last + BESIDE * width, history.end)
    if record.measured is None:  # no blow was found: an echo may be the largest pulse, and others lie before it
        moving = int(np.argmax(np.abs(history.values) >= RISE_LOW * abs(pulse.peak)))
        return begin, end, min(first, history.start + moving * history.step) - width
    return begin, end, first - width


def _whole_pulse(name: str, values: Array, index: int, peak: float, others: bool) -> tuple[float, float]:
    """Return where the pulse at an index begins and ends, in samples; of others the largest that no end cuts.

    A record of a bar that rings may end within an echo that is as large as the pulse itself.
    """
    low, high = 0, values.size
    while peak > 0.0 and low < high:
        begin, end = (crossing(values, index, RISE_LOW * peak, side) for side in (-1, 1))
        if math.isfinite(begin) and math.isfinite(end):
            return begin, end
        if not others or (math.isnan(begin) and math.isnan(end)):
            break
        low, high = (math.ceil(end), high) if math.isnan(begin) else (low, math.floor(begin) + 1)
        index = low + int(np.argmax(np.abs(values[low:high])))
        values, peak = math.copysign(1.0, values[index]) * values, float(abs(values[index]))
    raise InputError("--to", f"{name}, which holds no whole pulse", "a record with all of its pulse")


def _finer(history: EvenHistory, step: float) -> tuple[Array, float]:
    """Return a history without what samples at a step cannot hold, `FINER` times as fine as that at least; its step."""
    from scipy.signal import oaconvolve

    values, own = history.values, history.step
    times = math.ceil(FINER * own / step * (1.0 - 1e-9))
    if times > 1:
        values, own = resampled(values, np.arange((values.size - 1) * times + 1) / times), own / times
    if step > own * (1.0 + 1e-9):
        kernel = _kernel(step / own)
        reach = kernel.size // 2
        values = oaconvolve(np.pad(values, reach, mode="edge"), kernel, "valid")
    return np.asarray(values), own


@functools.lru_cache(maxsize=16)
def _kernel(factor: float) -> Array:
    """Return the filter that `resampled` applies where the new step is the old one times a factor."""
    reach = math.ceil(REACH * factor)
    one = np.zeros(2 * reach + 1)
    one[reach] = 1.0
    return resampled(one, np.arange(one.size), factor)


def _laid(values: Array, spline: Any, last: float, per: float) -> tuple[float, Array]:
    """Return where a run lies best on evenly sampled values, and the run there.

    Parameters
    ----------
    values : ndarray
        Samples of a record.
    spline : CubicSpline
        Spline of the run, over its own samples, of which ``last`` is the last.
    last : float
        Last sample of the run, in samples; the ends are held before and after.
    per : float
        Samples of the run between two of the record.

    Returns
    -------
    at : float
        Sample of the run on which the first one of the record lies.
    computed : ndarray
        The run there.
    """
    from scipy.signal import correlate

    size = values.size
    coarse = spline(np.arange(math.floor(last / per) + 1) * per)
    held = np.concatenate([np.full(size, coarse[0]), coarse, np.full(size, coarse[-1])])
    power = np.concatenate([[0.0], np.cumsum(held**2)])
    misfit = power[size:] - power[:-size] - 2.0 * correlate(held, values, "valid", "fft")
    at, offsets, slope = per * (int(np.argmin(misfit)) - size), per * np.arange(size), spline.derivative()
    for _ in range(ROUNDS):
        places = at + offsets
        inside = np.clip(places, 0.0, last)
        along = np.where(places == inside, slope(inside), 0.0)
        bend = float(along @ along)
        move = float(along @ (values - spline(inside))) / bend if bend > 0.0 else 0.0
        at += max(-per, min(per, move))
        if abs(move) < CLOSE * per:
            break
    return at, np.asarray(spline(np.clip(at + offsets, 0.0, last)))
