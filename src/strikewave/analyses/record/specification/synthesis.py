"""A base motion that is to meet a specification of a spectrum: how it is found and judged."""

from __future__ import annotations

import dataclasses
import math
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from strikewave.analyses.record.verdicts import spectra_sentence, verdict_notices
from strikewave.base import declare
from strikewave.base.declare import declarations
from strikewave.base.errors import InputError
from strikewave.base.result import Notice
from strikewave.base.shock_quantities import FREQUENCY
from strikewave.base.units import si_value
from strikewave.reporting import measured_files as measured
from strikewave.reporting.columns import HISTORY_DIGITS, Column, csv_table
from strikewave.reporting.faces import text_of
from strikewave.reporting.numbers import listed
from strikewave.reporting.options import wrong_choice
from strikewave.signal.motion import motion
from strikewave.signal.oscillators import SMOOTH
from strikewave.signal.srs import srs
from strikewave.signal.synthesis import (
    BASES,
    CLOSE,
    DAMPED_SINES,
    WAVELETS,
    Component,
    HalfSine,
    MotionPeaks,
    SynthesizedMotion,
    matching_half_sine,
    synthesized,
)
from strikewave.specifications.judged_records import JudgedSpectrum, SpectraVerdict, asked_of_spectra
from strikewave.specifications.judging import SpectrumLimits, judge_spectrum
from strikewave.specifications.reading import Specification, load_specification

Array = NDArray[np.float64]

HALF_SINE = "half-sine"
WAYS = (*BASES, HALF_SINE)  # components that a motion can be made of
# Wavelets an octave at most: where they stand nearer they drown one another, and the iteration ends 2 to 3 dB off
WAVELETS_AN_OCTAVE = 6.0
# Keys of the sources
SOURCES = {
    DAMPED_SINES: ("smallwood-nord-1974", "smallwood-1981"),
    WAVELETS: ("irvine-wavelets", "smallwood-1981"),
    HALF_SINE: ("smallwood-1981",),
}
# Samples a period of the highest frequency at least: at 8 interpolation leaves 1 %; samples of a motion at most: ten
# times those of the widest spectrum of pyroshock, 10 Hz to 10 kHz
LEAST_RATE, MOST_SAMPLES = 8.0, 2_000_000
# Share of a motion that the file holds of rest before it: where a record begins, `strikewave srs` looks for rest
LEAD = 0.1
# Level that a half-sine is raised beyond the share at or above nominal, dB: more than rounding and sampling take
RAISED = 0.01
HALF_SINE_SAMPLES = 200  # samples of a half-sine at least: its peak then lies 3e-5 above the samples at most
# Share of the upper tolerance that is aimed at where its middle lies lower: half of a spectrum must often be above
UPPER_SHARE = 1.0 / 6.0


@declare.dataclass
class MotionSpectrum:
    """Spectrum of a motion, and the one asked for."""

    frequency: Array = declare.history(FREQUENCY, "natural frequencies")
    values: Array = declare.history("m/s^2", "spectrum of the motion")
    nominal: Array = declare.history("m/s^2", "spectrum that was asked for")


@declare.dataclass
class SynthesisResult(measured.AskedResult):
    """A base motion for a specification of a spectrum; see `Result` for what it shares with others."""

    command: ClassVar[str] = "spec"
    drawing: ClassVar[str] = "synthesis_report"
    main_rows: ClassVar[str] = "components"

    by: str = declare.word("damped-sines, wavelets or half-sine")
    motion: SynthesizedMotion = declare.part(SynthesizedMotion, "the motion", inline=True, headline="first")
    half_sine: HalfSine | None = declare.part(HalfSine, "the half-sine, where it is one")

    @declare.computed(declare.rows(Component, "what the motion is the sum of"))
    def components(self) -> list[Component]:
        """Components, and the compensating pulses."""
        return [*self.motion.components, *self.motion.compensation]

    @declare.computed(declare.part(MotionSpectrum, "the spectrum of the motion"))
    def spectrum(self) -> MotionSpectrum:
        """Spectrum of the motion beside the one asked for."""
        (judged,) = self.verdict.spectra
        return MotionSpectrum(judged.frequency, judged.values, self.verdict.limits.nominal(judged.frequency))

    verdict: SpectraVerdict = declare.part(SpectraVerdict, "the verdict on its spectrum", key="spec")

    @property
    def title(self) -> str:
        """Kind of the motion, and its specification."""
        what = {DAMPED_SINES: "Damped sines", WAVELETS: "Wavelets"}.get(self.by, "Half-sine")
        return f"{what} for {self.verdict.specification.title}"

    def texts(self) -> dict[str, str]:
        """Return the JSON document and the history as files."""
        lead = np.zeros(math.ceil(LEAD * self.motion.acceleration.size))
        values = np.concatenate([lead, self.motion.acceleration])
        time = self.motion.step * (np.arange(values.size) - lead.size)
        history = [Column("time", time, "s"), Column("acceleration", values, "m/s^2")]
        return {"synthesis.json": self.document_text(), "acceleration.csv": csv_table(history, HISTORY_DIGITS)}


def synthesize(
    specification: Specification | str,
    by: str = DAMPED_SINES,
    rate: str | float | None = None,
    origin: measured.Source = measured.UNKNOWN,
) -> SynthesisResult:
    """Return a base motion whose spectrum is to meet a specification, with the verdict of that.

    Parameters
    ----------
    specification : Specification or str
        Specification of a spectrum, with breakpoints; or its name or file.
    by : str, optional
        ``damped-sines``, ``wavelets`` or ``half-sine``.
    rate : str or float, optional
        Samples a second, such as ``"200 kHz"``; 20 a period of the highest natural frequency by default.
    origin : Source, optional
        Command or call that asked for it.

    Returns
    -------
    SynthesisResult
        The motion, its spectrum over the one asked for, and the verdict.

    Raises
    ------
    InputError
        If it states no spectrum, there is no such way, or the sampling rate is too low or too high.

    Examples
    --------
    >>> import strikewave
    >>> found = strikewave.synthesize("nasa-gevs")
    >>> found.verdict.verdict, round(found.motion.peak.displacement * 1e3)
    ('pass', 77)
    """
    if by not in WAYS:
        raise wrong_choice(by, "by", WAYS)
    specification = load_specification(specification, "spec") if isinstance(specification, str) else specification
    limits = specification.spectrum_limits()
    frequency = limits.grid()
    rate = SMOOTH * float(frequency[-1]) if rate is None else si_value(rate, "Hz", "rate")
    highest, most = limits.frequency[-1], MOST_SAMPLES * limits.frequency[0] / 15.0
    if rate < LEAST_RATE * highest:
        allowed = f"at least {LEAST_RATE * highest:g} Hz: 8 samples a period of {highest:g} Hz"
        raise InputError("--rate", f"{rate:g} Hz", allowed)
    if rate > most:
        raise InputError("--rate", f"{rate:g} Hz", f"at most {most:g} Hz: {MOST_SAMPLES} samples of this motion")
    half_sine = None
    if by == HALF_SINE:
        half_sine = best_half_sine(limits, frequency)
        found = _as_motion(half_sine, rate)
    else:
        count = min(limits.per_octave, WAVELETS_AN_OCTAVE) if by == WAVELETS else limits.per_octave
        basis = dataclasses.replace(limits, per_octave=count).grid()
        found = synthesized(basis, aim(limits, basis), limits.q, by, limits.side, rate)
    values = srs(found.acceleration, found.step, frequency, limits.q).side(limits.side)
    clauses = judge_spectrum(frequency, values, limits)
    judged = JudgedSpectrum(by, "", "", frequency, values, clauses)
    verdict = SpectraVerdict(specification, limits, asked_of_spectra(), (judged,))
    result = SynthesisResult(
        by=by,
        motion=found,
        verdict=verdict,
        half_sine=half_sine,
        origin=origin,
        citations=SOURCES[by],
        notices=tuple(verdict_notices(specification.title, verdict.verdict, verdict.by_indicative, verdict.clauses)),
    )
    return dataclasses.replace(result, notices=(*result.notices, *_notices(result)))


def aim(limits: SpectrumLimits, frequency: Array) -> Array:
    """Return the spectrum that is aimed at: the middle of the tolerance in dB, at least a sixth of the upper one up.

    Where no tolerance is stated it is the nominal spectrum.
    """
    nominal = limits.nominal(frequency)
    low, high = (20.0 * np.log10(curve / nominal) for curve in limits.curves(frequency))
    above = np.minimum(np.maximum(0.5 * (low + high), UPPER_SHARE * high), high)
    return np.asarray(nominal * 10.0 ** (np.where(np.isfinite(above), above, 0.0) / 20.0), dtype=np.float64)


def best_half_sine(limits: SpectrumLimits, frequency: Array) -> HalfSine:
    """Return the half-sine whose spectrum lies best within the tolerance.

    Within it, it is raised as far as a share at or above nominal asks and its margin allows.
    """
    low, high = limits.curves(frequency)
    if not np.any(np.isfinite(low)):
        raise InputError("--by", HALF_SINE, "a specification with a tolerance at its natural frequencies")
    best = matching_half_sine(frequency, low, high, limits.q, limits.side)
    if limits.share_above is None or best.outside > 0.0:
        return best
    moved = _as_motion(best, SMOOTH * float(frequency[-1]))
    spectrum = srs(moved.acceleration, moved.step, frequency, limits.q).side(limits.side)
    lacks = 20.0 * np.log10(limits.nominal(frequency) / spectrum)
    needed = float(np.quantile(lacks, limits.share_above.low, method="inverted_cdf"))
    raised = min(max(needed + RAISED, 0.0), -best.outside)
    return HalfSine(best.peak * 10.0 ** (raised / 20.0), best.duration, best.outside + raised)


def _as_motion(pulse: HalfSine, rate: float) -> SynthesizedMotion:
    """Return a half-sine as a motion, sampled so that it begins and ends with a sample."""
    count = max(math.ceil(pulse.duration * rate), HALF_SINE_SAMPLES)
    values = pulse.peak * np.sin(math.pi * np.arange(count + 1) / count)
    values[-1] = 0.0
    step = pulse.duration / count
    moved = motion(values, step)
    nothing = np.empty(0)
    return SynthesizedMotion(
        values, moved.velocity, moved.displacement, step, (), (), nothing, nothing, max(pulse.outside, 0.0), 1
    )


def _notices(result: SynthesisResult) -> list[Notice]:
    """Return what the user should know of a motion."""
    found, notices = result.motion, []
    if result.by == HALF_SINE:
        message = f"a half-sine ends with {text_of(found.end, 'velocity')}: a drop table gives it, a shaker does not"
        notices.append(Notice("velocity-at-end", message, found.end.velocity, severity="info"))
    elif found.distance > CLOSE:
        off = np.abs(20.0 * np.log10(found.spectrum / aim(result.verdict.limits, found.frequency)))
        place = int(np.argmax(off))
        message = (
            f"the spectrum came within {found.distance:.2g} dB of its aim in {found.steps} steps, farthest at "
            f"{found.frequency[place]:.4g} Hz: at high frequencies no spectrum lies below the peak of its motion"
            + ("; one that rises by more than 9 dB an octave takes --by wavelets" if result.by == DAMPED_SINES else "")
        )
        notices.append(Notice("aim-not-reached", message, found.distance, CLOSE))
    return notices


def synthesis_words(result: SynthesisResult) -> str:
    """Say what came out."""
    found = result.motion
    what = {
        DAMPED_SINES: f"{len(found.components)} damped sines and two compensating pulses",
        WAVELETS: f"{len(found.components)} wavelets",
    }.get(result.by, "A half-sine")
    if result.half_sine is not None:
        what += f" of {text_of(result.half_sine, 'peak')} and {text_of(result.half_sine, 'duration')}"
    most = listed([text_of(found.peak, name) for name in declarations(MotionPeaks)])
    return f"{spectra_sentence(result.verdict)} {what}: at most {most}."
