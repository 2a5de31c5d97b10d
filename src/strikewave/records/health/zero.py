"""Where the zero of a record lies: whether it is settled, drifts, or shifts."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from strikewave.records.baseline import LOOK_BACK
from strikewave.records.health.examined import BEGINNING, BLOW, FEWEST_OF_PART, Examined
from strikewave.records.health_notice import FIGURES, HealthNotice
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
TAIL, FEWEST_OF_TAIL = 8, 16
"""The last eighth of a record tells the zero after the blows, where it has 16 samples or more: half of a quiet head."""
QUIET_AFTER = 20.0
"""Widths after a blow before which its zero is not judged: what rings and rocks has died out by then."""
MEDIAN_ERROR, INDEPENDENT = 1.25, 100
"""Standard error of a median over that of a mean, sqrt(pi/2); samples that count as independent at most: hum and slow
noise make more of them worth no more."""
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
                f"stood: the peak may be wrong by {missed:.1%}"
            )
            findings += [HealthNotice("drift", message, drift, severity="suspect", harms=(*BLOW, "spectrum"))]
    elif abs(pulse.baseline.slope) * (record.values.size - 1) > NOTED_ZERO * abs(pulse.peak):
        drift = pulse.baseline.slope * (record.values.size - 1)
        message = (
            f"before the blow the zero drifts, by {record.text(drift)} over a length of the record, "
            f"{abs(drift / pulse.peak):.1%} of the peak: it is carried on under the blow; the spectrum still holds it"
        )
        findings += [HealthNotice("drift", message, drift, severity="good", harms=("spectrum",))]
    share = abs(pulse.offset) / abs(pulse.peak)
    if share > NOTED_ZERO:
        message = f"the zero stands at {record.text(pulse.offset)}, {share:.1%} of the peak; it is taken off"
        severity, harms = ("suspect", ("spectrum",)) if share > LARGE_ZERO else ("good", ())
        findings += [HealthNotice("not-settled", message, pulse.offset, severity=severity, harms=harms)]
    return findings


def zero_shift(record: Examined) -> list[HealthNotice]:
    """Find a zero after the blows that is not that before them."""
    step = level_step(record.values)
    if step is not None:
        place, shift = step
        message = (
            f"at {record.time(place):.6g} s the zero shifts by {record.text(shift)} and stays there: the sensor was "
            "overloaded or came loose"
        )
        return [HealthNotice("zero-shift", message, shift, severity="bad", harms=FIGURES, start=record.time(place))]
    if not record.pulses:
        return []
    last = record.pulses[-1]
    tail = record.values[max(record.place(last.end) + 1, record.values.size - record.values.size // TAIL) :]
    if (
        tail.size < FEWEST_OF_TAIL
        or not last.width > 0.0
        or record.place(last.end) + QUIET_AFTER * last.width / record.step > record.values.size
    ):
        return []
    line = record.line
    before = record.pulses[0]
    shift = float(np.median(tail)) - before.offset
    drift = line.slope * (record.values.size - record.place(before.begin))
    unsure = MEDIAN_ERROR * float(np.std(tail)) / math.sqrt(min(tail.size, INDEPENDENT)) + abs(drift)
    share = abs(shift) / abs(before.peak)
    if abs(shift) < SHIFTED * unsure or share < NOTED_SHIFT:
        return []
    severity = "suspect" if share > LARGE_SHIFT else "good"
    message = f"after the blows the zero has shifted by {record.text(shift)}, {share:.1%} of the peak: velocities drift"
    return [
        HealthNotice(
            "zero-shift", message, shift, severity=severity, harms=("velocity_change", "spectrum"), start=last.end
        )
    ]


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
    if share < NOTED_DRIFT or abs(drift) < unsure:
        return []
    message = (
        f"long after the last blow the record stands {record.text(float(np.mean(tail)))} off its zero: the integrated "
        f"velocity drifts by {share:.0%} of the velocity change until the record ends"
    )
    severity = "suspect" if share > LARGE_DRIFT else "good"
    return [HealthNotice("velocity-drift", message, drift, severity=severity, harms=("spectrum",), start=pulse.end)]


def no_foot(record: Examined) -> list[HealthNotice]:
    """Find blows after or before which the record does not come back to 2 % of the peak."""
    open_ = [p for p in record.pulses if p.method == "record" and p.begin == p.smooth.begin and p.width > 0.0]
    if not open_:
        return []
    message = (
        f"the record does not come back to 2 % of the peak beside the blow at {open_[0].time:.6g} s: the velocity "
        "change is that of the smooth pulse"
    )
    return [
        HealthNotice(
            "no-foot",
            message,
            len(open_),
            severity="suspect",
            harms=("velocity_change",),
            start=open_[0].begin,
            end=open_[0].end,
        )
    ]


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
