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
from strikewave.records.pulses import MAD_TO_SIGMA, Baseline, robust_line, sample_noise
from strikewave.signal.pulse import HALF_SINE_WIDTH

Array = NDArray[np.float64]

BLOW = ("peak", "rise", "width", "velocity_change")
"""Figures of a single blow."""
SPANS_NOISE = 30.0
"""Standard deviations beyond which a record without a blow holds something: noise spans ten in a million samples."""
BEGINNING, FEWEST_OF_PART = 20, 8
"""The first twentieth of a record is its beginning, and the last its end, of eight samples at least.

Chosen: short beside what a pre-trigger lasts, so that a blow that is cut fills much of it."""
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
SMOOTH_TOP = 8.0
"""Steps of a width that has samples enough in its top to tell whether it is flat."""
TOP, NOISES_OF_TOP, DEEPEST_TOP = 0.02, 4.0, 0.5
"""What counts as top: 2 % of the peak below it and four standard deviations of noise, at most half of the peak."""
LENGTH_OVER_WIDTH = 1.07
"""Length of a half-sine over its width at 10 % of the peak, 1 / `HALF_SINE_WIDTH` = 1.068, rounded up."""
FLATTER = 0.15
"""Share of the width by which a top is flatter than that of a half-sine before it is suspect.

No usual smooth pulse comes near: a haversine is more pointed, a saw-tooth too."""
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
FEW, TOO_FEW, NONE_LEFT = 20.0, 10.0, 5.0
"""Samples of a half-sine at which 0.3, 1.2 and 4.9 % of its peak may be missed, 1 - cos(pi / (2 n))."""
AROUND, FEWEST_AROUND = 4.0, 64
"""Widths around the largest blow whose spectrum is looked at, in 64 samples to either side at least."""
TOP_OF_SPECTRUM = 0.85
"""Share of half the sampling rate from which on a spectrum should have fallen off: where anti-alias filters pass
least."""
FOLDED, NOISES_OF_SPECTRUM = 0.02, 4.0
"""Share of the largest value that is too much there, and how many times that of the noise it must be.

2 % that is folded down may shift a peak by as much."""
NOISY = 15.0
"""Ratio of peak to noise, dB, below which a fitted pulse is suspect too: noise of a fifth of the peak."""
HIGHER = 5.0
"""Standard deviations that a record goes higher outside the blows than in them: noise alone does not in any record."""
MISSED_FALL = 0.9
"""Share of the speed of a fall that is the least change of velocity: 10 % is left to friction of guides and the
height."""
AFTER_BLOW, RINGS_WITHIN = 0.25, 5.0
"""Widths after the feet of a blow from which on, and up to which, its ringing is taken: beside the foot, before it
dies."""
NOTED_RINGING, STRONG_RINGING, NOISES_OF_RINGING = 0.15, 0.6, 5.0
"""Shares of the peak by which a ringing record swings: noted, and so much that the peak may be ringing; it
swings by five standard deviations of noise at least."""
FEWEST_AT_RAIL = 3
"""Samples at the largest value, and times those beside it, that make a rail; see `_rail`."""
LEVELS_LOOKED_AT = 4096
"""Samples in which at least three different values stand, or the record is a switch or a count, and has no rail."""
NEAR_TOP = 0.05
"""Share of the span below the largest value in which the steps of the converter are looked for."""
OFF_ZERO = 0.01
"""Share of the span, or three steps of the converter, that a rail lies off the zero: the quiet zero is no rail."""
BESIDE_RAIL = 2.5
"""Steps of the converter below the largest value that count as beside it: the next two."""
STEP_OF_SPAN, STEP_OF_STRAY = 0.08, 10.0
"""Share of the span, and times what either level strays, that a step of the zero is: more than a drift or hum makes."""
STRAY_QUANTILE = 0.8
"""Share of the samples of a level that lie within what it strays: blows fill less than the rest."""


@dataclass(frozen=True, eq=False)
class Examined:
    """A uniformly sampled record, with the blows found in it.

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
    def line(self) -> Baseline:
        """The baseline of the whole record."""
        return robust_line(self.values)

    @cached_property
    def noise(self) -> float:
        """Standard deviation of the white noise of a sample."""
        return sample_noise(self.values)

    def text(self, value: float) -> str:
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
        message = f"every sample is {record.text(record.values[0])}: the channel is dead or not connected"
        return [HealthNotice("dead", message, float(record.values[0]), severity="bad", harms=FIGURES)]
    return worst_first(finding for check in CHECKS for finding in check(record))


def no_pulse(record: Examined) -> list[HealthNotice]:
    """Find that nothing in the record is a blow."""
    if record.pulses:
        return []
    reach = float(np.ptp(record.values))
    if reach > SPANS_NOISE * record.noise:
        message = f"the record spans {record.text(reach)}, but no one-sided blow stands out: it drifts, or swings"
    else:
        message = "no blow stands out of the noise"
    return [HealthNotice("no-pulse", message, 0.0, severity="bad", harms=(*BLOW, "interval"))]


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
    share = max(abs(drift), abs(pulse.offset)) / abs(pulse.peak)
    missed = 0.5 * LOOK_BACK * abs(line.slope) * max(pulse.width, record.step) / record.step / abs(pulse.peak)
    if missed > WRONG_PEAK:
        message = (
            f"the zero drifts by {record.text(drift)} over the record, so that the peak above it may be wrong by "
            f"{missed:.1%}: let the sensor settle"
        )
        return [HealthNotice("not-settled", message, pulse.offset, severity="suspect", harms=(*BLOW, "spectrum"))]
    if not share > NOTED_ZERO:
        return []
    message = (
        f"the zero stands at {record.text(pulse.offset)}, {abs(pulse.offset / pulse.peak):.1%} of the peak, and "
        f"drifts by {record.text(drift)} over the record; it is taken off"
    )
    severity, harms = ("suspect", ("spectrum",)) if share > LARGE_ZERO else ("good", ())
    return [HealthNotice("not-settled", message, pulse.offset, severity=severity, harms=harms)]


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
        message = (
            f"clipped at {record.text(level)} for {at.size * record.step * 1e6:.4g} us {where}: the true peak is larger"
        )
        severity, harms = ("bad", BLOW) if struck else ("suspect", ("ringing_frequency", "spectrum"))
        begin, end = record.time(int(at[0])), record.time(int(at[-1]))
        findings.append(HealthNotice("clipped", message, level, severity=severity, harms=harms, start=begin, end=end))
    return findings


def saturated(record: Examined) -> list[HealthNotice]:
    """Find a top flatter than that of any smooth pulse: an amplifier at its limit, or a pulse meant to be flat."""
    findings = []
    for pulse in record.pulses:
        if pulse.method != "record" or not pulse.width > SMOOTH_TOP * record.step:
            continue
        inside = np.abs(record.values[record.place(pulse.begin) : record.place(pulse.end) + 1] - pulse.offset)
        depth = min(TOP + NOISES_OF_TOP * pulse.noise / abs(pulse.peak), DEEPEST_TOP)
        first, last = _longest(inside >= (1.0 - depth) * abs(pulse.peak))
        flat = (last - first + 1) * record.step / pulse.width
        usual = (1.0 - 2.0 / math.pi * math.asin(1.0 - depth)) * LENGTH_OVER_WIDTH
        if flat > usual + FLATTER:
            message = (
                f"the top is flat for {flat:.0%} of the width (a half-sine's for {usual:.0%}): the sensor or an "
                "amplifier may have saturated, unless the pulse is meant to be flat"
            )
            findings.append(
                HealthNotice(
                    "flat-top", message, flat, severity="suspect", harms=("peak",), start=pulse.begin, end=pulse.end
                )
            )
    return findings[:1]


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


def few_samples(record: Examined) -> list[HealthNotice]:
    """Find blows of few samples: a half-sine that lasts n of them may lose 1 - cos(pi / (2 n)) of its peak."""
    widths = [p.width for p in record.pulses if p.width > 0.0]
    if not widths:
        return []
    count = min(widths) / HALF_SINE_WIDTH / record.step
    if count >= FEW:
        return []
    loss = 1.0 - math.cos(math.pi / (2.0 * max(count, 1.0)))
    severity = "bad" if count < NONE_LEFT else "suspect" if count < TOO_FEW else "good"
    message = f"a blow has {count:.1f} samples: its peak may be missed by {loss:.1%}; sample faster"
    return [
        HealthNotice(
            "few-samples", message, count, severity=severity, harms=("peak", "rise", "width") if count < TOO_FEW else ()
        )
    ]


def aliased(record: Examined) -> list[HealthNotice]:
    """Find a spectrum that has not fallen off at half the sampling rate: what lies above is folded into it."""
    pulse = record.largest
    if pulse is None or not pulse.width > 0.0:
        return []
    reach = max(round(AROUND * pulse.width / record.step), FEWEST_AROUND)
    centre = record.place(pulse.time)
    part = record.values[max(centre - reach, 0) : centre + reach] - pulse.offset
    spectrum = np.abs(np.fft.rfft(part * np.hanning(part.size)))
    top = spectrum[int(TOP_OF_SPECTRUM * spectrum.size) :]
    highest = float(np.max(spectrum))
    if not highest > 0.0:
        return []
    level = math.sqrt(float(np.mean(top**2))) / highest
    noise = pulse.noise * math.sqrt(0.375 * part.size) / highest  # a Hann window has the mean square 3/8
    if level < FOLDED or level < NOISES_OF_SPECTRUM * noise:
        return []
    message = (
        f"at half the sampling rate the spectrum still has {level:.1%} of its largest value: what lies above was "
        "folded into the record; sample faster or filter before"
    )
    return [HealthNotice("alias", message, level, severity="suspect", harms=("peak", "rise", "spectrum"))]


def polarity(record: Examined) -> list[HealthNotice]:
    """Find blows that are negative."""
    if not record.pulses or record.pulses[0].peak > 0.0:
        return []
    message = "the blows are negative: is the sensor mounted the other way? --polarity -1 turns it"
    return [HealthNotice("polarity", message, -1.0, severity="suspect")]


def cut(record: Examined) -> list[HealthNotice]:
    """Find a blow that runs into the begin or the end of the record."""
    findings = []
    for pulse in record.pulses:
        at_end = record.place(pulse.end) >= record.values.size - 2
        if at_end or math.isnan(pulse.width):
            where = "end" if at_end else "begin"
            message = f"the blow at {pulse.time:.6g} s is cut by the {where} of the record"
            findings.append(
                HealthNotice(
                    "cut", message, pulse.time, severity="suspect", harms=BLOW, start=pulse.begin, end=pulse.end
                )
            )
    return findings


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


def noisy(record: Examined) -> list[HealthNotice]:
    """Find noise that hides a tenth of the peak: the figures are then those of a fitted smooth pulse."""
    fitted = [p for p in record.pulses if p.method == "fit"]
    if not fitted:
        return []
    ratio = min(20.0 * math.log10(abs(p.peak) / p.noise) for p in fitted if p.noise > 0.0)
    severity = "suspect" if ratio < NOISY else "good"
    message = f"the noise is only {ratio:.0f} dB below the peak: figures are those of a fitted smooth pulse"
    return [HealthNotice("noisy", message, ratio, severity=severity, harms=("rise",))]


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


def beyond_drop_height(record: Examined) -> list[HealthNotice]:
    """Find a velocity change that a fall from the stated height cannot give: sqrt(2 g h) to twice that."""
    if not (record.drop_height > 0.0 and record.unit == "m/s^2" and record.pulses):
        return []
    speed = math.sqrt(2.0 * STANDARD_GRAVITY * record.drop_height)
    change = max(abs(p.velocity_change) for p in record.pulses)
    if change > 2.0 * speed:
        message = f"the velocity change, {change:.3g} m/s, is above twice the speed of the fall, {2.0 * speed:.3g} m/s"
        return [
            HealthNotice("drop-height", message, change, severity="bad", harms=("peak", "velocity_change", "spectrum"))
        ]
    if change < MISSED_FALL * speed:
        message = f"the velocity change, {change:.3g} m/s, is below the speed of the fall, {speed:.3g} m/s"
        return [
            HealthNotice(
                "drop-height", message, change, severity="suspect", harms=("peak", "velocity_change", "spectrum")
            )
        ]
    return []


def ringing(record: Examined) -> list[HealthNotice]:
    """Find a blow after which the record swings by much of its peak: its peak and width hold that ringing too."""
    pulse = record.largest
    if pulse is None or not pulse.width > 0.0:
        return []
    until = pulse.end + RINGS_WITHIN * pulse.width
    begin = record.place(pulse.end + AFTER_BLOW * pulse.width)
    after = record.values[begin : record.place(until)] - pulse.offset
    others = [p for p in record.pulses if p is not pulse and p.begin < until and p.end > pulse.end]
    if after.size < FEWEST_OF_PART or others:
        return []
    swing = 0.5 * float(np.ptp(after))
    share = swing / abs(pulse.peak)
    if share < NOTED_RINGING or swing < NOISES_OF_RINGING * pulse.noise:
        return []
    message = (
        f"after the blow the record swings by {share:.0%} of the peak: peak, rise and width hold such ringing too; "
        "see the smooth pulse, or filter"
    )
    severity, harms = ("suspect", ("peak", "rise", "width")) if share > STRONG_RINGING else ("good", ())
    return [HealthNotice("ringing", message, share, severity=severity, harms=harms, start=pulse.end)]


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
    if at.size < FEWEST_AT_RAIL or np.unique(values[:: max(values.size // LEVELS_LOOKED_AT, 1)]).size < 3:
        return none
    near = values[values >= level - NEAR_TOP * span]
    steps = np.diff(np.unique(near))
    resolution = float(np.min(steps)) if steps.size else NEAR_TOP * span
    if level - zero <= max(3.0 * resolution, OFF_ZERO * span):
        return none
    beside = int(np.count_nonzero(near >= level - BESIDE_RAIL * resolution)) - at.size
    return at if at.size >= FEWEST_AT_RAIL * max(beside, 1) else none


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
    if min(part.size for part in parts) < max(FEWEST_OF_TAIL, values.size // BEGINNING):
        return None
    before, after = (float(np.median(part)) for part in parts)
    stray = max(float(np.quantile(np.abs(part - np.median(part)), STRAY_QUANTILE)) for part in parts)
    shift = after - before
    return (place, shift) if abs(shift) > max(STEP_OF_STRAY * stray, STEP_OF_SPAN * float(np.ptp(values))) else None
