"""What swings after a blow, or without one."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator

import numpy as np

from strikewave.records.health.sampled_record import FEWEST_OF_PART, BlowRecord, with_unit
from strikewave.records.health_notice import Fault
from strikewave.records.measuring import RecordedPulse, one_sided, stretch_of
from strikewave.records.ringing import RINGS_WITHIN, ringing_of
from strikewave.records.thresholds import HARMED, OfRinging, OfRingingSought

COMPARED = ("peak", "width", "velocity_change")  # figures that are compared with those of the pulse without ringing
WIDTH_BY_LEVEL = 0.68  # width of a half-sine at 10 % over a level under it: 2 / (pi sqrt(1 - 0.1^2)) / 0.936


# Message on ringing that no model tells from the blow
SLOW = (
    "after the blow the record swings by {value:%0} of the peak, about as slowly as the blow itself, and no single "
    "mode explains it: peak, rise and width may hold such ringing too; a smooth pulse misses the blow by {misfit:%0}"
)
# Message on ringing that is distinct from the blow, though of no single mode
NO_MODE = (
    "the blow rings at about {frequency}, by {of_peak:%0} of the peak, and no single mode explains it; against the "
    "smooth pulse"
)
# Message on ringing that has died out when the blow ends
WITHIN = (
    "on its way up to the peak and down from it the record goes back, and a contact pushes once: the blow rings, too "
    "fast for this rate or too briefly to be taken off, which may make"
)


def ringing(record: BlowRecord) -> Iterator[Fault]:
    """Find the blow that rings most, and what that does to its figures: against the pulse fitted together with it."""
    faults = [fault for pulse in record.pulses if (fault := _ringing_of(record, pulse)) is not None]
    yield from sorted(faults, key=_size)[-1:]


def _size(fault: Fault) -> tuple[bool, float]:
    """Return whether it harms a figure, and what it does at most."""
    effects, doubt = fault.effects or {}, fault.doubt or {}
    harms = any(abs(effect) + doubt.get(name, 0.0) > HARMED for name, effect in effects.items())
    return harms or fault.severity == "suspect", max(map(abs, effects.values()), default=0.0)


def _ringing_of(record: BlowRecord, pulse: RecordedPulse) -> Fault | None:
    rigid, smooth = pulse.rigid, pulse.smooth
    share = _swing_after(record, pulse) / abs(pulse.peak)
    if rigid is not None:
        pairs = [(name, getattr(pulse, name) / getattr(rigid, name) - 1.0) for name in COMPARED]
        effects = {name: effect for name, effect in pairs if math.isfinite(effect)}
        if max(map(abs, effects.values())) < OfRinging.NOTED_EFFECT and share < OfRinging.NOTED:
            return None
        frequency = pulse.ringing_frequency if pulse.ringing_frequency > 0.0 else rigid.frequency
        details = {
            "time": pulse.time,
            "frequency": with_unit(frequency, "Hz"),
            "peak": rigid.peak,
            "width": with_unit(rigid.width, "s"),
        }
        doubt = {name: getattr(rigid, f"{name}_uncertainty") / abs(getattr(rigid, name)) for name in effects}
        return Fault(share, details, start=pulse.begin, effects=effects, doubt=doubt)
    within = smooth.misfit > OfRinging.STRAYS and pulse.method == "record"
    if share < OfRinging.NOTED and not within:
        return _dead_within(record, pulse)
    frequency = ringing_of(stretch_of(record.values, record.step, record.start, pulse))
    if share < OfRinging.NOTED and math.isnan(frequency):
        return _dead_within(record, pulse)
    if not frequency * smooth.width() > OfRinging.SEPARATE:
        strong = share > OfRinging.STRONG or (within and smooth.misfit > OfRingingSought.POOR)
        severity, harms = ("suspect", ("peak", "rise", "width")) if strong else ("good", ())
        return Fault(share, {"misfit": smooth.misfit}, severity, harms, pulse.end, message=SLOW)
    figures = {"peak": smooth.peak, "width": smooth.width(), "velocity_change": smooth.area()}
    effects = {name: getattr(pulse, name) / value - 1.0 for name, value in figures.items() if value}
    details = {"frequency": with_unit(frequency, "Hz"), "of_peak": max(share, smooth.misfit)}
    doubt = _doubt_of_smooth(pulse, frequency)
    return Fault(share, details, start=pulse.end, effects=effects, doubt=doubt, message=NO_MODE)


def _dead_within(record: BlowRecord, pulse: RecordedPulse) -> Fault | None:
    """Find ringing that has died out when the blow ends: the record goes back on its way up, or down.

    Peak and feet may be off by as much as it does, the velocity change by twice what lies between it and a record that
    never goes back: a swing lifts as much as it takes.
    """
    share, area = goes_back(record, pulse)
    if pulse.method != "record" or not share > HARMED:
        return None
    effects = {"peak": share, "width": share, "velocity_change": 2.0 * area / abs(pulse.velocity_change)}
    return Fault(share, start=pulse.begin, end=pulse.end, effects=effects, signed=False, message=WITHIN)


def goes_back(record: BlowRecord, pulse: RecordedPulse) -> tuple[float, float]:
    """Return by how much a record falls on the way up to a peak, or rises on the way down, over it, and over what area.

    What noise does is none.

    Examples
    --------
    >>> from strikewave.records.measuring import find_pulses
    >>> u = np.clip(np.arange(900.0) / 80.0 - 5.0, 0.0, 1.0)
    >>> for swing in (0.0, 0.3):
    ...     values = np.sin(np.pi * u) - swing * np.exp(-8.0 * u) * np.sin(40.0 * u)
    ...     [pulse] = find_pulses(values, 1e-6)
    ...     print(goes_back(BlowRecord(values, 1e-6, pulses=(pulse,)), pulse)[0] > HARMED)
    False
    True
    """
    sign = math.copysign(1.0, pulse.peak)
    width = pulse.width if pulse.width > 0.0 else 0.0
    places = [record.place(time) for time in (pulse.begin - OfRinging.FOOT * width, pulse.time, pulse.end)]
    up, down = (sign * record.values[a : b + 1] for a, b in itertools.pairwise(places))
    back = np.concatenate([np.maximum.accumulate(side) - side for side in (up, down[::-1])])
    noise = OfRinging.SPANS * record.scatter
    share = max(float(np.max(back)) - noise, 0.0) / abs(pulse.peak)
    return share, record.step * float(np.sum(back[back > noise]))


def _doubt_of_smooth(pulse: RecordedPulse, frequency: float) -> dict[str, float]:
    """Return by how much of itself a swing that the smooth pulse misses may falsify each of its figures.

    It has sqrt(2) of the misfit as amplitude A. It lifts or lowers the peak by that, the feet as any level does, and
    what it adds to the area is half a swing at most, A / (pi f).
    """
    amplitude = math.sqrt(2.0) * pulse.smooth.misfit
    smooth = pulse.smooth
    area = amplitude * abs(smooth.peak) / (math.pi * frequency) / abs(smooth.area())
    return {"peak": amplitude, "width": amplitude * WIDTH_BY_LEVEL, "velocity_change": area}


def _swing_after(record: BlowRecord, pulse: RecordedPulse) -> float:
    """Return by how much a record swings after a blow; 0 where it does not, or another blow is near."""
    width = pulse.width if pulse.width > 0.0 else pulse.smooth.width()
    until = pulse.end + RINGS_WITHIN * width
    begin = record.place(pulse.end + OfRinging.AFTER_BLOW * width)
    after = record.values[begin : record.place(until)] - pulse.offset
    rebounds = one_sided(record.values, record.step, record.start, pulse)
    contacts = [record.next_begin(pulse), *(rebound.time - width for rebound in rebounds)]
    if after.size < FEWEST_OF_PART or min(contacts) < until:
        return 0.0
    swing = 0.5 * float(np.ptp(after))
    return swing if swing >= OfRinging.NOISES * pulse.noise else 0.0


def larger_elsewhere(record: BlowRecord) -> Iterator[Fault]:
    """Find a record that goes higher outside the blows than in them: it swings rather than being struck."""
    pulse = record.largest
    if pulse is None:
        return
    away = np.ones(record.values.size, dtype=bool)
    for blow in record.pulses:
        away[record.place(blow.begin) : record.place(blow.end) + 1] = False
    highest = float(np.max(np.abs(record.values[away] - pulse.offset), initial=0.0))
    if highest > abs(pulse.peak) + OfRinging.HIGHER * pulse.noise:
        yield Fault(highest, {"peak": abs(pulse.peak)})
