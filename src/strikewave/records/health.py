"""What is wrong with a record: each check is one short function that finds one fault.

Every check takes an `Examined` and returns findings; `examine` asks them all.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from strikewave.base.constants import STANDARD_GRAVITY
from strikewave.base.units import in_unit
from strikewave.records.health_notice import FIGURES, HealthNotice, worst_first
from strikewave.records.measuring import LOOK_BACK, RecordedPulse
from strikewave.records.pulses import Line, robust_line, sample_noise
from strikewave.signal.pulse import HALF_SINE_WIDTH

Array = NDArray[np.float64]

BLOW = ("peak", "rise", "width", "velocity_change")
"""Figures of a single blow."""


@dataclass(frozen=True, eq=False)
class Examined:
    """A record on an even clock, with the blows found in it.

    Attributes
    ----------
    values : ndarray
        Finite samples.
    step, start : float
        Time between samples, and of the first, s.
    unit : str
        SI unit of the values; empty where it is not known.
    pulses : sequence of RecordedPulse
        As `find_pulses` gives them.
    drop_height : float
        What the fall before the blow was stated to be, m; NaN where it was not.
    """

    values: Array
    step: float
    start: float = 0.0
    unit: str = ""
    pulses: tuple[RecordedPulse, ...] = ()
    drop_height: float = math.nan

    @property
    def largest(self) -> RecordedPulse | None:
        """The blow with the highest peak."""
        return max(self.pulses, key=lambda pulse: abs(pulse.peak), default=None)

    @cached_property
    def line(self) -> Line:
        """The zero line of the whole record."""
        return robust_line(self.values)

    @cached_property
    def noise(self) -> float:
        """Standard deviation of the white noise of a sample."""
        return sample_noise(self.values)

    def said(self, value: float) -> str:
        """Write a value with its unit: accelerations in g."""
        if self.unit == "m/s^2":
            return f"{in_unit(value, 'm/s^2', 'g'):.5g} g"
        if self.unit == "1":
            return f"{1e6 * value:.5g} ustrain"
        return f"{value:.5g} {self.unit}".strip()

    def time(self, place: float) -> float:
        """Return the time of a sample, s."""
        return self.start + self.step * place

    def place(self, time: float) -> int:
        """Return the sample nearest to a time, inside the record."""
        return min(max(round((time - self.start) / self.step), 0), self.values.size - 1)


def examine(record: Examined) -> list[HealthNotice]:
    """Return everything that is wrong with a record, the worst first.

    Examples
    --------
    >>> [finding.code for finding in examine(Examined(np.full(1000, 3.0), 1e-5))]
    ['dead']
    """
    if float(np.ptp(record.values)) == 0.0:
        words = f"every sample is {record.said(record.values[0])}: the channel is dead or not connected"
        return [HealthNotice("dead", words, float(record.values[0]), severity="bad", harms=FIGURES)]
    return worst_first(finding for check in CHECKS for finding in check(record))


def no_pulse(record: Examined) -> list[HealthNotice]:
    """Find that nothing in the record is a blow."""
    if record.pulses:
        return []
    reach = float(np.ptp(record.values))
    if reach > 30.0 * record.noise:
        words = f"the record spans {record.said(reach)}, but no one-sided blow stands out: it drifts, or swings"
    else:
        words = "no blow stands out of the noise"
    return [HealthNotice("no-pulse", words, 0.0, severity="bad", harms=(*BLOW, "interval"))]


def not_settled(record: Examined) -> list[HealthNotice]:
    """Find a zero that is far off or drifts, or a record that begins while something still swings."""
    line = record.line
    noise = record.noise
    spread = 1.4826 * float(np.median(np.abs(record.values - line.at(np.arange(record.values.size)))))
    drift = line.slope * (record.values.size - 1)
    middle = line.at(0.5 * record.values.size)
    pulse = record.largest
    if pulse is None:
        findings = []
        part = max(record.values.size // 20, 8)
        begin, end = (float(np.ptp(piece)) for piece in (record.values[:part], record.values[-part:]))
        above, below = (float(np.max(sign * (record.values[:part] - middle))) for sign in (1.0, -1.0))
        over = float(np.ptp(record.values[part : 2 * part])) < 0.1 * begin
        if begin > 20.0 * max(noise, 0.25 * end) and over and min(above, below) < 0.1 * max(above, below):
            peak = above if above > below else -below
            words = f"the record begins in a blow, at {record.said(peak)}: it is cut; record some time before the blow"
            findings.append(HealthNotice("cut", words, record.start, severity="bad", harms=FIGURES, start=record.start))
        elif begin > 5.0 * end and begin > 20.0 * noise:
            words = (
                f"the record begins while something still swings ({record.said(begin)} from top to bottom, at its end "
                f"{record.said(end)})"
            )
            findings.append(
                HealthNotice("not-settled", words, begin, severity="bad", harms=FIGURES, start=record.start)
            )
        elif abs(drift) > 20.0 * max(noise, spread) or abs(middle) > 100.0 * max(spread, noise):
            words = f"the zero stands at {record.said(middle)} and drifts by {record.said(drift)}: it has not settled"
            findings.append(HealthNotice("not-settled", words, middle, severity="bad", harms=FIGURES))
        return findings
    share = max(abs(drift), abs(pulse.offset)) / abs(pulse.peak)
    missed = 0.5 * LOOK_BACK * abs(line.slope) * max(pulse.width, record.step) / record.step / abs(pulse.peak)
    if missed > 0.02:
        words = (
            f"the zero drifts by {record.said(drift)} over the record, so that the peak above it may be wrong by "
            f"{missed:.1%}: let the sensor settle"
        )
        return [HealthNotice("not-settled", words, pulse.offset, severity="suspect", harms=(*BLOW, "spectrum"))]
    if not share > 0.05:
        return []
    words = (
        f"the zero stands at {record.said(pulse.offset)}, {abs(pulse.offset / pulse.peak):.1%} of the peak, and "
        f"drifts by {record.said(drift)} over the record; it is taken off"
    )
    severity = "suspect" if share > 0.5 else "good"
    return [
        HealthNotice("not-settled", words, pulse.offset, severity=severity, harms=("spectrum",) if share > 0.5 else ())
    ]


def clipped(record: Examined) -> list[HealthNotice]:
    """Find where the record stops at one value again and again: the recorder's range ended there.

    A plateau of a rounded top in a coarse recorder is no clipping: there the steps beside it are long too. Neither is
    the quiet zero of a record that goes to one side of it only.
    """
    findings = []
    pulse = record.largest
    zero = float(np.median(record.values)) if pulse is None else pulse.offset
    for sign in (1.0, -1.0):
        at = _rail(sign * record.values, sign * zero)
        if not at.size:
            continue
        level = float(record.values[at[0]])
        struck = [p for p in record.pulses if np.any((at >= record.place(p.begin)) & (at <= record.place(p.end)))]
        where = f"in {len(struck)} of {len(record.pulses)} blows" if struck else "outside the blows"
        words = (
            f"clipped at {record.said(level)} for {at.size * record.step * 1e6:.4g} us {where}: the true peak is larger"
        )
        severity, harms = ("bad", BLOW) if struck else ("suspect", ("ringing_frequency", "spectrum"))
        begin, end = record.time(int(at[0])), record.time(int(at[-1]))
        findings.append(HealthNotice("clipped", words, level, severity=severity, harms=harms, start=begin, end=end))
    return findings


def saturated(record: Examined) -> list[HealthNotice]:
    """Find a top flatter than that of any smooth pulse: an amplifier at its limit, or a pulse meant to be flat."""
    findings = []
    for pulse in record.pulses:
        if pulse.method != "record" or not pulse.width > 8.0 * record.step:
            continue
        inside = np.abs(record.values[record.place(pulse.begin) : record.place(pulse.end) + 1] - pulse.offset)
        depth = min(0.02 + 4.0 * pulse.noise / abs(pulse.peak), 0.5)
        first, last = _longest(inside >= (1.0 - depth) * abs(pulse.peak))
        flat = (last - first + 1) * record.step / pulse.width
        usual = (1.0 - 2.0 / math.pi * math.asin(1.0 - depth)) * 1.07
        if flat > usual + 0.15:
            words = (
                f"the top is flat for {flat:.0%} of the width (a half-sine's for {usual:.0%}): the sensor or an "
                "amplifier may have saturated, unless the pulse is meant to be flat"
            )
            findings.append(
                HealthNotice(
                    "flat-top", words, flat, severity="suspect", harms=("peak",), start=pulse.begin, end=pulse.end
                )
            )
    return findings[:1]


def zero_shift(record: Examined) -> list[HealthNotice]:
    """Find a zero after the blows that is not that before them."""
    step = level_step(record.values)
    if step is not None:
        place, shift = step
        words = (
            f"at {record.time(place):.6g} s the zero shifts by {record.said(shift)} and stays there: the sensor was "
            "overloaded or came loose"
        )
        return [HealthNotice("zero-shift", words, shift, severity="bad", harms=FIGURES, start=record.time(place))]
    if not record.pulses:
        return []
    last = record.pulses[-1]
    tail = record.values[max(record.place(last.end) + 1, record.values.size - record.values.size // 8) :]
    if (
        tail.size < 16
        or not last.width > 0.0
        or record.place(last.end) + 20 * last.width / record.step > record.values.size
    ):
        return []
    line = record.line
    before = record.pulses[0]
    shift = float(np.median(tail)) - before.offset
    drift = line.slope * (record.values.size - record.place(before.begin))
    unsure = 1.25 * float(np.std(tail)) / math.sqrt(min(tail.size, 100)) + abs(drift)
    share = abs(shift) / abs(before.peak)
    if abs(shift) < 3.0 * unsure or share < 0.01:
        return []
    severity = "suspect" if share > 0.03 else "good"
    words = f"after the blows the zero has shifted by {record.said(shift)}, {share:.1%} of the peak: velocities drift"
    return [
        HealthNotice(
            "zero-shift", words, shift, severity=severity, harms=("velocity_change", "spectrum"), start=last.end
        )
    ]


def velocity_drift(record: Examined) -> list[HealthNotice]:
    """Find an integrated velocity that still wanders off long after the last blow, when nothing moves any more."""
    if not record.pulses:
        return []
    pulse = record.pulses[-1]
    after = record.values[record.place(pulse.end) :] - pulse.offset
    total = abs(pulse.velocity_change)
    tail = after[-(after.size // 4) :]
    if tail.size < 16 or not total > 0.0 or after.size * record.step < 40.0 * pulse.width:
        return []
    drift = float(np.mean(tail)) * after.size * record.step
    unsure = 3.0 * float(np.std(tail)) / math.sqrt(tail.size) * after.size * record.step
    share = abs(drift) / total
    if share < 0.5 or abs(drift) < unsure:
        return []
    words = (
        f"long after the last blow the record stands {record.said(float(np.mean(tail)))} off its zero: the integrated "
        f"velocity drifts by {share:.0%} of the velocity change until the record ends"
    )
    return [
        HealthNotice(
            "velocity-drift",
            words,
            drift,
            severity="suspect" if share > 2.0 else "good",
            harms=("spectrum",),
            start=pulse.end,
        )
    ]


def few_samples(record: Examined) -> list[HealthNotice]:
    """Find blows of few samples: a half-sine that lasts n of them may lose 1 - cos(pi / (2 n)) of its peak."""
    widths = [p.width for p in record.pulses if p.width > 0.0]
    if not widths:
        return []
    count = min(widths) / HALF_SINE_WIDTH / record.step
    if count >= 20.0:
        return []
    loss = 1.0 - math.cos(math.pi / (2.0 * max(count, 1.0)))
    severity = "bad" if count < 5.0 else "suspect" if count < 10.0 else "good"
    words = f"a blow has {count:.1f} samples: its peak may be missed by {loss:.1%}; sample faster"
    return [
        HealthNotice(
            "few-samples", words, count, severity=severity, harms=("peak", "rise", "width") if count < 10.0 else ()
        )
    ]


def aliased(record: Examined) -> list[HealthNotice]:
    """Find a spectrum that has not fallen off at half the sampling rate: what lies above is folded into it."""
    pulse = record.largest
    if pulse is None or not pulse.width > 0.0:
        return []
    reach = max(round(4.0 * pulse.width / record.step), 64)
    centre = record.place(pulse.time)
    part = record.values[max(centre - reach, 0) : centre + reach] - pulse.offset
    spectrum = np.abs(np.fft.rfft(part * np.hanning(part.size)))
    top = spectrum[int(0.85 * spectrum.size) :]
    highest = float(np.max(spectrum))
    if not highest > 0.0:
        return []
    level = math.sqrt(float(np.mean(top**2))) / highest
    noise = pulse.noise * math.sqrt(0.375 * part.size) / highest
    if level < 0.02 or level < 4.0 * noise:
        return []
    words = (
        f"at half the sampling rate the spectrum still has {level:.1%} of its largest value: what lies above was "
        "folded into the record; sample faster or filter before"
    )
    return [HealthNotice("alias", words, level, severity="suspect", harms=("peak", "rise", "spectrum"))]


def polarity(record: Examined) -> list[HealthNotice]:
    """Find blows that are negative."""
    if not record.pulses or record.pulses[0].peak > 0.0:
        return []
    words = "the blows are negative: is the sensor mounted the other way? --polarity -1 turns it"
    return [HealthNotice("polarity", words, -1.0, severity="suspect")]


def cut(record: Examined) -> list[HealthNotice]:
    """Find a blow that runs into the begin or the end of the record."""
    findings = []
    for pulse in record.pulses:
        at_end = record.place(pulse.end) >= record.values.size - 2
        if at_end or math.isnan(pulse.width):
            where = "end" if at_end else "begin"
            words = f"the blow at {pulse.time:.6g} s is cut by the {where} of the record"
            findings.append(
                HealthNotice("cut", words, pulse.time, severity="suspect", harms=BLOW, start=pulse.begin, end=pulse.end)
            )
    return findings


def no_foot(record: Examined) -> list[HealthNotice]:
    """Find blows after or before which the record does not come back to 2 % of the peak."""
    open_ = [p for p in record.pulses if p.method == "record" and p.begin == p.smooth.begin and p.width > 0.0]
    if not open_:
        return []
    words = (
        f"the record does not come back to 2 % of the peak beside the blow at {open_[0].time:.6g} s: the velocity "
        "change is that of the smooth pulse"
    )
    return [
        HealthNotice(
            "no-foot",
            words,
            len(open_),
            severity="suspect",
            harms=("velocity_change",),
            start=open_[0].begin,
            end=open_[0].end,
        )
    ]


def noisy(record: Examined) -> list[HealthNotice]:
    """Find noise that hides a tenth of the peak: the figures are then those of a fitted smooth pulse."""
    fitted = [p for p in record.pulses if p.method == "fit"]
    if not fitted:
        return []
    ratio = min(20.0 * math.log10(abs(p.peak) / p.noise) for p in fitted if p.noise > 0.0)
    severity = "suspect" if ratio < 15.0 else "good"
    words = f"the noise is only {ratio:.0f} dB below the peak: figures are those of a fitted smooth pulse"
    return [HealthNotice("noisy", words, ratio, severity=severity, harms=("rise",))]


def larger_elsewhere(record: Examined) -> list[HealthNotice]:
    """Find a record that goes higher outside the blows than in them: it swings rather than being struck."""
    pulse = record.largest
    if pulse is None:
        return []
    away = np.ones(record.values.size, dtype=bool)
    for one in record.pulses:
        away[record.place(one.begin) : record.place(one.end) + 1] = False
    if not away.any():
        return []
    highest = float(np.max(np.abs(record.values[away] - pulse.offset)))
    if highest <= abs(pulse.peak) + 5.0 * pulse.noise:
        return []
    words = (
        f"outside the blows the record reaches {record.said(highest)}, more than their peak "
        f"{record.said(abs(pulse.peak))}: it swings; take the shock response spectrum rather than the pulse"
    )
    return [HealthNotice("swings", words, highest, severity="suspect", harms=BLOW)]


def beyond_drop_height(record: Examined) -> list[HealthNotice]:
    """Find a velocity change that a fall from the stated height cannot give: sqrt(2 g h) to twice that."""
    if not (record.drop_height > 0.0 and record.unit == "m/s^2" and record.pulses):
        return []
    speed = math.sqrt(2.0 * STANDARD_GRAVITY * record.drop_height)
    change = max(abs(p.velocity_change) for p in record.pulses)
    if change > 2.0 * speed:
        words = f"the velocity change, {change:.3g} m/s, is above twice the speed of the fall, {2.0 * speed:.3g} m/s"
        return [
            HealthNotice("drop-height", words, change, severity="bad", harms=("peak", "velocity_change", "spectrum"))
        ]
    if change < 0.9 * speed:
        words = f"the velocity change, {change:.3g} m/s, is below the speed of the fall, {speed:.3g} m/s"
        return [
            HealthNotice(
                "drop-height", words, change, severity="suspect", harms=("peak", "velocity_change", "spectrum")
            )
        ]
    return []


def ringing(record: Examined) -> list[HealthNotice]:
    """Find a blow after which the record swings by much of its peak: its peak and width hold that ringing too."""
    pulse = record.largest
    if pulse is None or not pulse.width > 0.0:
        return []
    begin = record.place(pulse.end + 0.25 * pulse.width)
    after = record.values[begin : record.place(pulse.end + 5.0 * pulse.width)] - pulse.offset
    others = [
        p for p in record.pulses if p is not pulse and p.begin < pulse.end + 5.0 * pulse.width and p.end > pulse.end
    ]
    if after.size < 8 or others:
        return []
    swing = 0.5 * float(np.ptp(after))
    share = swing / abs(pulse.peak)
    if share < 0.15 or swing < 5.0 * pulse.noise:
        return []
    words = (
        f"after the blow the record swings by {share:.0%} of the peak: peak, rise and width hold such ringing too; "
        "see the smooth pulse, or filter"
    )
    severity, harms = ("suspect", ("peak", "rise", "width")) if share > 0.6 else ("good", ())
    return [HealthNotice("ringing", words, share, severity=severity, harms=harms, start=pulse.end)]


CHECKS = (
    no_pulse,
    not_settled,
    clipped,
    saturated,
    zero_shift,
    velocity_drift,
    few_samples,
    aliased,
    polarity,
    cut,
    no_foot,
    noisy,
    ringing,
    larger_elsewhere,
    beyond_drop_height,
)
"""Every check, in the order of their findings."""


def _rail(values: Array, zero: float) -> NDArray[np.intp]:
    """Return the samples at the largest value where a recorder stopped there; none where the record turned there.

    A round top at k steps of the converter has about 1 : 0.7 samples in its highest and the next two; a rail has
    three times as many at it as beside it, and at least three.
    """
    level, none = float(np.max(values)), np.empty(0, dtype=np.intp)
    span = level - float(np.min(values))
    at = np.flatnonzero(values == level)
    if at.size < 3 or np.unique(values[:: max(values.size // 4096, 1)]).size < 3:
        return none
    near = values[values >= level - 0.05 * span]
    steps = np.diff(np.unique(near))
    resolution = float(np.min(steps)) if steps.size else 0.05 * span
    if level - zero <= max(3.0 * resolution, 0.01 * span):
        return none
    beside = int(np.count_nonzero(near >= level - 2.5 * resolution)) - at.size
    return at if at.size >= 3 * max(beside, 1) else none


def _longest(flags: NDArray[np.bool_]) -> tuple[int, int]:
    """Return first and last place of the longest run of true; (0, -1) where there is none."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], flags, [False]]).astype(np.int8)))
    if not edges.size:
        return 0, -1
    k = int(np.argmax(edges[1::2] - edges[::2]))
    return int(edges[2 * k]), int(edges[2 * k + 1]) - 1


def level_step(values: Array) -> tuple[int, float] | None:
    """Return where a record steps from one quiet level to another, and by how much; None where it does not.

    The step is at least 8 % of what the record spans, and ten times what either level strays.
    """
    sums = np.cumsum(values - np.mean(values))
    place = int(np.argmax(np.abs(sums))) + 1
    parts = values[:place], values[place:]
    if min(part.size for part in parts) < max(16, values.size // 20):
        return None
    before, after = (float(np.median(part)) for part in parts)
    stray = max(float(np.quantile(np.abs(part - np.median(part)), 0.8)) for part in parts)
    shift = after - before
    return (place, shift) if abs(shift) > max(10.0 * stray, 0.08 * float(np.ptp(values))) else None
