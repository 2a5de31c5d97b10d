"""What swings after a blow, or without one."""

from __future__ import annotations

import itertools
import math

import numpy as np

from strikewave.base.percents import percent
from strikewave.records.health.examined import BLOW, FEWEST_OF_PART, Examined, with_unit
from strikewave.records.health_notice import HARMED, HealthNotice, by_effect
from strikewave.records.measuring import RecordedPulse, one_sided, stretch_of
from strikewave.records.rigid_pulse import POOR
from strikewave.records.ringing import RINGS_WITHIN, ringing_of

AFTER_BLOW = 0.25
"""Widths after the feet of a blow from which on its ringing is taken, up to `RINGS_WITHIN`: beside the foot, before it
dies."""
NOTED_RINGING, STRONG_RINGING, NOISES_OF_RINGING = 0.15, 0.6, 5.0
"""Shares of the peak by which a ringing record swings: noted, and so much that the peak may be ringing; it
swings by five standard deviations of noise at least."""
NOTED_EFFECT = 0.02
"""Effect of ringing on a figure from which on it is worth a word."""
SEPARATE = 1.5
"""Swings in a width from which on ringing is distinct from the blow without a model: the smooth pulse averages it."""
STRAYS = 0.06
"""Misfit of the smooth pulse that is no usual shape: then the blow itself rings, though it has died out after it."""
SPANS = 6.0
"""Standard deviations by which noise makes a record fall on the way up to a peak, in the thousand samples of a side."""
FOOT = 0.25
"""Widths before a blow that belong to the way up: a contact pushes only, and what begins to the other side swings."""
COMPARED = ("peak", "width", "velocity_change")
"""Figures that are compared with those of the pulse without ringing."""
WIDTH_BY_LEVEL = 0.68
"""Share by which the width of a half-sine at 10 % changes with a level under it, over its peak,
2 / (pi sqrt(1 - 0.1^2)) over 0.936; the smooth pulse is no measure of it where it misses the feet."""
HIGHER = 5.0
"""Standard deviations that a record goes higher outside the blows than in them: noise alone does not in any record."""


def ringing(record: Examined) -> list[HealthNotice]:
    """Find blows that ring, and what the ringing does to their figures: against the pulse fitted together with it."""
    found = [notice for pulse in record.pulses if (notice := _ringing_of(record, pulse)) is not None]
    return sorted(found, key=_severity)[-1:]


def _severity(notice: HealthNotice) -> tuple[bool, float]:
    return notice.severity != "good", max((abs(effect) for _, effect in notice.effects), default=0.0)


def _ringing_of(record: Examined, pulse: RecordedPulse) -> HealthNotice | None:
    rigid = pulse.rigid
    share = _swing_after(record, pulse) / abs(pulse.peak)
    if rigid is not None:
        pairs = [(name, getattr(pulse, name) / getattr(rigid, name) - 1.0) for name in COMPARED]
        effects = {name: effect for name, effect in pairs if math.isfinite(effect)}
        if max(map(abs, effects.values())) < NOTED_EFFECT and share < NOTED_RINGING:
            return None
        frequency = pulse.ringing_frequency if pulse.ringing_frequency > 0.0 else rigid.frequency
        message = (
            f"the blow at {pulse.time:.6g}\xa0s rings at {with_unit(frequency, 'Hz')}; without it the peak is "
            f"{record.text(rigid.peak)}, the width {with_unit(rigid.width, 's')}; with it"
        )
        doubt = {name: getattr(rigid, f"{name}_uncertainty") / abs(getattr(rigid, name)) for name in effects}
        return by_effect("ringing", message, share, effects, doubt=doubt, start=pulse.begin)
    within = pulse.smooth.misfit > STRAYS and pulse.method == "record"
    if share < NOTED_RINGING and not within:
        return _dead_within(record, pulse)
    frequency = ringing_of(stretch_of(record.values, record.step, record.start, pulse))
    if share < NOTED_RINGING and math.isnan(frequency):
        return _dead_within(record, pulse)
    if not frequency * pulse.smooth.width() > SEPARATE:
        message = (
            f"after the blow the record swings by {percent(share, 0)} of the peak, about as slowly as the blow itself, "
            "and no single mode explains it: peak, rise and width may hold such ringing too; a smooth pulse misses the "
            f"blow by {percent(pulse.smooth.misfit, 0)}"
        )
        strong = share > STRONG_RINGING or (within and pulse.smooth.misfit > POOR)
        severity, harms = ("suspect", ("peak", "rise", "width")) if strong else ("good", ())
        return HealthNotice("ringing", message, share, severity=severity, harms=harms, start=pulse.end)
    smooth = {"peak": pulse.smooth.peak, "width": pulse.smooth.width(), "velocity_change": pulse.smooth.area()}
    effects = {name: getattr(pulse, name) / value - 1.0 for name, value in smooth.items() if value}
    of_peak = percent(max(share, pulse.smooth.misfit), 0)
    message = (
        f"the blow rings at about {with_unit(frequency, 'Hz')}, by {of_peak} of the peak, "
        "and no single mode explains it; against the smooth pulse"
    )
    return by_effect("ringing", message, share, effects, doubt=_doubt_of_smooth(pulse, frequency), start=pulse.end)


def _dead_within(record: Examined, pulse: RecordedPulse) -> HealthNotice | None:
    """Find ringing that has died out when the blow ends: the record goes back on its way up, or down.

    Peak and feet may be off by as much as it does, the velocity change by twice what lies between it and a record that
    never goes back: a swing lifts as much as it takes.
    """
    share, area = goes_back(record, pulse)
    if pulse.method != "record" or not share > HARMED:
        return None
    message = (
        "on its way up to the peak and down from it the record goes back, and a contact pushes once: the blow rings, "
        "too fast for this rate or too briefly to be taken off, which may make"
    )
    effects = {"peak": share, "width": share, "velocity_change": 2.0 * area / abs(pulse.velocity_change)}
    return by_effect("ringing", message, share, effects, signed=False, start=pulse.begin, end=pulse.end)


def goes_back(record: Examined, pulse: RecordedPulse) -> tuple[float, float]:
    """Return by how much a record falls on the way up to a peak, or rises on the way down, over it, and over what area.

    What noise does is none.

    Examples
    --------
    >>> from strikewave.records.measuring import find_pulses
    >>> u = np.clip(np.arange(900.0) / 80.0 - 5.0, 0.0, 1.0)
    >>> for swing in (0.0, 0.3):
    ...     values = np.sin(np.pi * u) - swing * np.exp(-8.0 * u) * np.sin(40.0 * u)
    ...     [pulse] = find_pulses(values, 1e-6)
    ...     print(goes_back(Examined(values, 1e-6, pulses=(pulse,)), pulse)[0] > HARMED)
    False
    True
    """
    sign = math.copysign(1.0, pulse.peak)
    width = pulse.width if pulse.width > 0.0 else 0.0
    places = [record.place(time) for time in (pulse.begin - FOOT * width, pulse.time, pulse.end)]
    up, down = (sign * record.values[a : b + 1] for a, b in itertools.pairwise(places))
    back = np.concatenate([np.maximum.accumulate(side) - side for side in (up, down[::-1])])
    noise = SPANS * record.scatter
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


def _swing_after(record: Examined, pulse: RecordedPulse) -> float:
    """Return by how much a record swings after a blow; 0 where it does not, or another blow is near."""
    width = pulse.width if pulse.width > 0.0 else pulse.smooth.width()
    until = pulse.end + RINGS_WITHIN * width
    begin = record.place(pulse.end + AFTER_BLOW * width)
    after = record.values[begin : record.place(until)] - pulse.offset
    rebounds = one_sided(record.values, record.step, record.start, pulse)
    contacts = [record.next_begin(pulse), *(rebound.time - width for rebound in rebounds)]
    if after.size < FEWEST_OF_PART or min(contacts) < until:
        return 0.0
    swing = 0.5 * float(np.ptp(after))
    return swing if swing >= NOISES_OF_RINGING * pulse.noise else 0.0


def larger_elsewhere(record: Examined) -> list[HealthNotice]:
    """Find a record that goes higher outside the blows than in them: it swings rather than being struck."""
    pulse = record.largest
    if pulse is None:
        return []
    away = np.ones(record.values.size, dtype=bool)
    for blow in record.pulses:
        away[record.place(blow.begin) : record.place(blow.end) + 1] = False
    if not away.any():
        return []
    highest = float(np.max(np.abs(record.values[away] - pulse.offset)))
    if highest <= abs(pulse.peak) + HIGHER * pulse.noise:
        return []
    message = (
        f"outside the blows the record reaches {record.text(highest)}, more than their peak "
        f"{record.text(abs(pulse.peak))}: it swings; take the shock response spectrum rather than the pulse"
    )
    return [HealthNotice("swings", message, highest, severity="suspect", harms=BLOW)]
