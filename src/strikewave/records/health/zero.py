"""Where the zero of a record lies: whether it is settled, drifts, or shifts."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
from numpy.typing import NDArray

from strikewave.base.percents import percent
from strikewave.records.baseline import LOOK_BACK
from strikewave.records.health.examined import BEGINNING, BLOW, FEWEST_OF_PART, Examined, effects_of_level
from strikewave.records.health_notice import FIGURES, HealthNotice, by_effect
from strikewave.records.measuring import FOOT
from strikewave.records.pulses import MAD_TO_SIGMA

Array = NDArray[np.float64]


IN_MOTION = 20.0
"""Standard deviations that a beginning spans, or a zero drifts, before it is called unsettled: twice what noise
spans."""
FALLS_OFF = 5.0
"""A beginning that spans this many times the end of the record swings; noise, drift and hum span both alike."""
CUT_BLOW = 4.0
"""`IN_MOTION` is taken over a quarter of what the end spans where a blow is thought to be cut: it rings on until
then."""
ONE_SIDED = 0.1
"""A cut blow falls below this share within its part, and swings to the other side by less than this share of itself."""
FAR_OFF = 100.0
"""Scatters that the zero lies off 0 before it is called unsettled without a blow: offsets of tens of them are usual."""
WRONG_PEAK = 0.02
"""Share of a peak by which a drifting baseline may falsify it before that is suspect: below the usual 5 % of a
sensor."""
NOTED_ZERO, LARGE_ZERO = 0.05, 0.5
"""Shares of the peak at which a zero is noted, and at which it swamps the low frequencies of a spectrum."""
FEWEST_OF_TAIL = 16
"""Samples after the blows, or of a level, without which their zero is not judged."""
SHIFTED = 3.0
"""Standard errors by which a zero must have shifted, so that chance does it in one record of 400."""
NOTED_SHIFT, LARGE_SHIFT = 0.01, 0.03
"""Shares of the peak at which a shift is noted, and at which a velocity integrated over ten widths is off
by nearly half."""
LAST_QUARTER, LONG_AFTER = 4, 40.0
"""A drift of the velocity is that of the last quarter, where 40 widths or more follow the blow: nothing moves then."""
NOTED_DRIFT, LARGE_DRIFT = 0.5, 2.0
"""Drifts of the velocity to the end, over the change of velocity: half of it is noted, twice it is suspect."""
STEP_OF_SPAN, STEP_OF_STRAY = 0.08, 10.0
"""Share of the span, and times what either level strays, that a step of the zero is: more than a drift or hum makes."""
STRAY_QUANTILE = 0.8
"""Share of the samples of a level that lie within what it strays: blows fill less than the rest."""


def not_settled(record: Examined) -> list[HealthNotice]:
    """Find a zero that is far off or drifts, or a record that begins while something still swings."""
    line = record.line
    noise = record.noise
    spread = MAD_TO_SIGMA * float(np.median(np.abs(record.values - line.at(np.arange(record.values.size)))))
    drift = line.slope * (record.values.size - 1)
    middle = line.at(0.5 * record.values.size)
    pulse = record.largest
    if pulse is None:
        findings = []
        part = max(record.values.size // BEGINNING, FEWEST_OF_PART)
        begin, end = (float(np.ptp(piece)) for piece in (record.values[:part], record.values[-part:]))
        above, below = (float(np.max(sign * (record.values[:part] - middle))) for sign in (1.0, -1.0))
        over = float(np.ptp(record.values[part : 2 * part])) < ONE_SIDED * begin
        one_sided = min(above, below) < ONE_SIDED * max(above, below)
        if begin > IN_MOTION * max(noise, end / CUT_BLOW) and over and one_sided:
            peak = above if above > below else -below
            message = (
                f"the record begins in a blow, at {record.text(peak)}: it is cut; record some time before the blow"
            )
            findings.append(
                HealthNotice("cut", message, record.start, severity="bad", harms=FIGURES, start=record.start)
            )
        elif begin > FALLS_OFF * end and begin > IN_MOTION * noise:
            message = (
                f"the record begins while something still swings ({record.text(begin)} from top to bottom, at its end "
                f"{record.text(end)})"
            )
            findings.append(
                HealthNotice("not-settled", message, begin, severity="bad", harms=FIGURES, start=record.start)
            )
        elif abs(drift) > IN_MOTION * max(noise, spread) or abs(middle) > FAR_OFF * max(spread, noise):
            message = f"the zero stands at {record.text(middle)} and drifts by {record.text(drift)}: it has not settled"
            findings.append(HealthNotice("not-settled", message, middle, severity="bad", harms=FIGURES))
        return findings
    findings = []
    if not pulse.baseline.widths:  # nothing lies before it: the line of the whole record is all there is
        missed = 0.5 * LOOK_BACK * abs(line.slope) * max(pulse.width, record.step) / record.step / abs(pulse.peak)
        if missed > WRONG_PEAK:
            message = (
                f"the zero drifts by {record.text(drift)} over the record, and nothing before the blow tells where it "
                f"stood: the peak may be wrong by {percent(missed)}"
            )
            findings += [HealthNotice("drift", message, drift, severity="suspect", harms=(*BLOW, "spectrum"))]
    elif abs(pulse.baseline.slope) * (record.values.size - 1) > NOTED_ZERO * abs(pulse.peak):
        drift = pulse.baseline.slope * (record.values.size - 1)
        message = (
            f"before the blow the zero drifts, by {record.text(drift)} over a length of the record, "
            f"{percent(abs(drift / pulse.peak))} of the peak: it is carried on under the blow; the spectrum still "
            "holds it"
        )
        findings += [HealthNotice("drift", message, drift, severity="good", harms=("spectrum",))]
    share = abs(pulse.offset) / abs(pulse.peak)
    if share > NOTED_ZERO:
        message = f"the zero stands at {record.text(pulse.offset)}, {percent(share)} of the peak; it is taken off"
        severity, harms = ("suspect", ("spectrum",)) if share > LARGE_ZERO else ("good", ())
        findings += [HealthNotice("not-settled", message, pulse.offset, severity=severity, harms=harms)]
    return findings


def zero_shift(record: Examined) -> list[HealthNotice]:
    """Find a zero that steps, or one after the blows that is not that before them: shifted, decaying, drifting."""
    step = level_step(record.values)
    if step is not None:
        place, shift = step
        code = "zero-shift" if _near_a_blow(record, record.time(place)) else "zero-step"
        message = (
            f"at {record.time(place):.6g}\xa0s the zero shifts by {record.text(shift)} and stays there: the sensor was "
            "overloaded or came loose"
        )
        return [HealthNotice(code, message, shift, severity="bad", harms=FIGURES, start=record.time(place))]
    model = record.tail
    if model is None or model.kind in ("rest", "motion", "ac-coupling"):
        return []
    last = record.pulses[-1]
    share = abs(model.level) / min(abs(pulse.peak) for pulse in record.pulses)
    if share < NOTED_SHIFT or abs(model.level) < SHIFTED * model.level_error:
        return []
    if model.kind == "line":
        if share < NOTED_ZERO:
            return []
        level = record.text(model.level)
        message = f"after the blows the zero drifts on by {level}, {percent(share)} of the peak: velocities drift"
        return [HealthNotice("drift", message, model.level, severity="good", harms=("spectrum",), start=last.end)]
    effects = {name: abs(e) for name, e in effects_of_level(last, model.level, after_peak=True).items()}
    message = f"after the blows the zero has shifted by {record.text(model.level)}, {percent(share)} of the peak"
    if model.kind == "decay":
        message += f", and comes back with a time constant of {1e3 * model.constant:.3g}\xa0ms"
    found = by_effect(
        "zero-shift",
        f"{message}: velocities drift, and if it did so in the blow",
        model.level,
        effects,
        signed=False,
        start=last.end,
    )
    severity = "suspect" if share > LARGE_SHIFT else found.severity
    return [dataclasses.replace(found, severity=severity, harms=(*found.harms, "spectrum"))]


def _near_a_blow(record: Examined, time: float) -> bool:
    """Tell whether a time lies within a width of a blow: then the blow did it."""
    return any(pulse.begin - pulse.smooth.length < time < pulse.end + pulse.smooth.length for pulse in record.pulses)


def ac_coupling(record: Examined) -> list[HealthNotice]:
    """Find AC coupling, and what it does to the figures: the blows are measured again without it."""
    model = record.tail
    if model is None or model.kind != "ac-coupling":
        return []
    effects: dict[str, float] = {}
    for pulse, other in zip(record.pulses, record.uncoupled_pulses, strict=False):
        for name in ("peak", "width", "velocity_change"):
            effect = getattr(pulse, name) / getattr(other, name) - 1.0
            if math.isfinite(effect):  # a blow that is cut has no width
                effects[name] = max(effects.get(name, 0.0), effect, key=abs)
    if not effects:  # nothing can be measured without it: half of a length over tau is what it takes off at least
        length = max(pulse.smooth.length for pulse in record.pulses)
        effects = {name: -min(0.5 * length / model.constant, 1.0) for name in ("peak", "width", "velocity_change")}
    message = (
        f"after the blows the record decays from {record.text(model.level)} as a high-pass of "
        f"{1.0 / (2.0 * math.pi * model.constant):.4g}\xa0Hz makes it (AC coupling, tau = "
        f"{1e3 * model.constant:.4g}\xa0ms +- {2e3 * model.constant_error:.2g}\xa0ms; --ac-coupling auto takes it off)"
    )
    found = by_effect("ac-coupling", message, model.constant, effects, start=record.pulses[0].begin)
    return [dataclasses.replace(found, harms=(*found.harms, "spectrum"))]


def velocity_drift(record: Examined) -> list[HealthNotice]:
    """Find an integrated velocity that still wanders off long after the last blow, when nothing moves any more."""
    if not record.pulses:
        return []
    pulse = record.pulses[-1]
    after = record.values[record.place(pulse.end) :] - pulse.offset
    total = abs(pulse.velocity_change)
    tail = after[-(after.size // LAST_QUARTER) :]
    if tail.size < FEWEST_OF_TAIL or not total > 0.0 or after.size * record.step < LONG_AFTER * pulse.width:
        return []
    drift = float(np.mean(tail)) * after.size * record.step
    unsure = SHIFTED * float(np.std(tail)) / math.sqrt(tail.size) * after.size * record.step
    share = abs(drift) / total
    if share < NOTED_DRIFT or abs(drift) < unsure or _as_at_first(record, float(np.mean(tail)) + pulse.offset, drift):
        return []
    message = (
        f"long after the last blow the record stands {record.text(float(np.mean(tail)))} off its zero: the integrated "
        f"velocity drifts by {percent(share, 0)} of the velocity change until the record ends"
    )
    severity = "suspect" if share > LARGE_DRIFT else "good"
    return [HealthNotice("velocity-drift", message, drift, severity=severity, harms=("spectrum",), start=pulse.end)]


def _as_at_first(record: Examined, level: float, drift: float) -> bool:
    """Tell whether a record ends where it began, long before the first blow, much nearer than its drift says.

    Then its zero stands, and what it stood at before a later blow was motion: of a feed, or what the blow before left.
    """
    first = record.values[: record.values.size // BEGINNING]
    if first.size < FEWEST_OF_PART or record.time(2 * first.size) > record.pulses[0].begin:
        return False
    after = (record.values.size - record.place(record.pulses[-1].end)) * record.step
    return abs(level - float(np.median(first))) * after < NOTED_DRIFT * min(
        abs(drift), abs(record.pulses[-1].velocity_change)
    )


def no_foot(record: Examined) -> list[HealthNotice]:
    """Find blows after or before which the record does not come back to 2 % of the peak.

    The smooth pulse, whose area is then the velocity change, and the record over its length are two measures of it.
    """
    open_ = [p for p in record.pulses if p.method == "record" and p.begin == p.smooth.begin and p.width > 0.0]
    if not open_:
        return []
    worst = 0.0
    for pulse in open_:
        part = record.values[record.place(pulse.begin) : record.place(pulse.end) + 1]
        area = record.step * float(np.sum(part - pulse.offset))
        effect = pulse.velocity_change / area - 1.0 if area * pulse.peak > 0.0 else math.inf
        worst = max(worst, effect, key=abs)
    message = (
        f"the record does not come back to {percent(FOOT, 0)} of the peak beside the blow at {open_[0].time:.6g}\xa0s: "
        "the velocity change is that of the smooth pulse; against the record over its length"
    )
    effects = {"velocity_change": worst}
    return [by_effect("no-foot", message, len(open_), effects, start=open_[0].begin, end=open_[0].end)]


def level_step(values: Array) -> tuple[int, float] | None:
    """Return where a record steps from one quiet level to another, and by how much; None where it does not.

    The step is at least 8 % of what the record spans, and ten times what either level strays.
    """
    sums = np.cumsum(values - np.mean(values))
    place = int(np.argmax(np.abs(sums))) + 1
    parts = values[:place], values[place:]
    if min(part.size for part in parts) < max(FEWEST_OF_TAIL, values.size // BEGINNING):
        return None
    before, after = (float(np.median(part)) for part in parts)
    stray = max(float(np.quantile(np.abs(part - np.median(part)), STRAY_QUANTILE)) for part in parts)
    shift = after - before
    return (place, shift) if abs(shift) > max(STEP_OF_STRAY * stray, STEP_OF_SPAN * float(np.ptp(values))) else None
