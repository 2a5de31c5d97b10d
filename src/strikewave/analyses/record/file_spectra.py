"""Shock response spectra of measured files: of one channel, or of several together, and the verdict on them."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from strikewave.analyses.clauses import budget_notices
from strikewave.analyses.record.options import Spectra
from strikewave.analyses.record.rows import name_of
from strikewave.analyses.record.sentences import named
from strikewave.analyses.record.spectrum import (
    LEFT_OUT,
    ChannelRolling,
    ChannelSpectra,
    ShockSpectra,
    SpectraAsked,
    SpectrumResult,
    harm_of,
    response_of,
    rms_of,
    spectra_of_kinds,
    spectrum_findings,
    status_of,
    uncertainties_of,
)
from strikewave.analyses.record.verdicts import SpectraJudge, spectra_judge
from strikewave.base.errors import InputError, StrikewaveError
from strikewave.base.result import FAILED, Notice, Source
from strikewave.base.shock_quantities import KILOHERTZ
from strikewave.records import ChannelReading, FileReading, SampleStore, compare
from strikewave.records.reading import check_amounts
from strikewave.reporting import measured_files as measured
from strikewave.reporting.faces import amount
from strikewave.reporting.measured_files import Calibration, Filtering, Judging, MeasurementOptions, Reading
from strikewave.reporting.options import Typed
from strikewave.reporting.terminal import say
from strikewave.signal.filters import Filter
from strikewave.signal.srs import Scope, octaves, resultant_srs, rolling_srs

# Highest natural frequency by default, Hz. Chosen: ten times that of usual spectra of pyroshock (10 kHz in Irvine, An
# Introduction to the Shock Response Spectrum, 2012, figure 2), so that blows of 10 us are shown
HIGHEST = 100e3
# Highest natural frequency by default, over the sampling rate: nearer to half of it a record holds little, and its
# filter has taken some
OF_SAMPLING = 0.4
# More frequencies are refused. Chosen: no screen shows finer steps, and each takes a pass over the record
MOST_FREQUENCIES = 1e5
# Windows of rolling spectra, of all channels together, at most. Chosen: more than the pixels of any screen, and a few
# GB in JSON
MOST_WINDOWS = 20_000
CITED = ("smallwood-1981", "iso-18431-4")  # sources that a spectrum follows
CITED_OF_SEVERAL = (*CITED, "piersol-2009", "nist-handbook")  # sources that several spectra and their limit follow
SAME_STEP = 1e-9  # relative difference of steps that are one
SAME_START = 0.05  # difference of two begins, over a step, up to which channels were sampled together


def judged_spectra_of(asked: SpectraAsked, origin: Source, judge: SpectraJudge | None) -> SpectrumResult:
    """Return the spectra of measured files, and the verdict on those that a specification means where one judges."""
    result = spectra_of(asked if judge is None else judge.wanted(asked), origin)
    if result.budget is not None and result.budget.contributions:
        notices = (*result.notices, *budget_notices(result.budget))
        result = dataclasses.replace(result, notices=notices, citations=(*result.citations, "jcgm-100"))
    return result if judge is None else judge.judged(result)


def spectra_of(asked: SpectraAsked, origin: Source) -> SpectrumResult:
    """Return the spectra of measured files."""
    if len(asked.files) == 1 and len(asked.options.channels) < 2 and not asked.spectra.resultant:
        return _one(asked, origin)
    unread: list[Notice] = []
    with SampleStore() as store:
        readings = _readings(asked, store, unread)
        axes = [reading for _, reading in readings] if asked.spectra.resultant else []
        _check_axes(asked, axes)
        result = _several(asked, readings, store)
        values = [reading.channel.values - reading.baseline for reading in axes]
        more = (result.spectra[0].frequency, asked.spectra.q)
        sums = {
            kind: resultant_srs(values, axes[0].channel.step, *more, kind, asked.spectra.initial)
            for kind in (asked.spectra.each_kind if axes else ())
        }
    return dataclasses.replace(result, resultant=sums, origin=origin, notices=(*result.notices, *unread))


def _one(asked: SpectraAsked, origin: Source) -> SpectrumResult:
    """Return the spectra of one channel of one file."""
    file, wanted = asked.files[0], asked.spectra
    reading = measured.examined_channel(file, asked.stated, asked.options, "spectrum", "the spectrum", asked.filters)
    frequencies = _frequencies(wanted, reading.channel.sampling_rate)
    scope = _scope(wanted, reading)
    if wanted.part != "total" and wanted.end is None and reading.pulses:
        say(f"the shock is taken to end with its last blow, at {reading.pulses[-1].end:.6g}\xa0s (--end)")
    shock = _shock(file, reading, asked, (frequencies, scope), MOST_WINDOWS, several=False)
    notices = _notices(reading)
    return SpectrumResult(shock, reading, scope, budget=asked.budget, origin=origin, notices=notices, citations=CITED)


def _readings(asked: SpectraAsked, store: SampleStore, unread: list[Notice]) -> list[tuple[str, ChannelReading]]:
    """Return the wanted channels of all files; those that cannot be read are named, and added to ``unread``."""
    failed: StrikewaveError | None = None
    files: list[FileReading] = []
    for file in asked.files:
        try:
            _, found = measured.read_channels(file, asked.stated, asked.options, asked.filters)
        except StrikewaveError as error:
            if len(asked.files) == 1:
                raise
            failed = failed or error
            unread.append(
                Notice("unreadable", str(error) if file in str(error) else f"{file}: {error}", severity=FAILED)
            )
            say(f"left out: {unread[-1].message}")
            continue
        files.append(dataclasses.replace(store.kept(found), path=measured.shown(file)))
    if not any(file.channels for file in files):
        raise failed or InputError("FILE", "none", "a file with a channel")
    return [(file.path, reading) for file in compare(files) for reading in file.channels]


def _several(asked: SpectraAsked, readings: Sequence[tuple[str, ChannelReading]], store: SampleStore) -> SpectrumResult:
    """Return the spectra of all channels and what they come to; one that is bad enters no envelope."""
    wanted, first = asked.spectra, readings[0][1].channel
    for file, reading in readings:
        if reading.channel.unit != first.unit:
            got = f"{reading.channel.name} of {file}, in {reading.channel.unit or 'no unit that is known'}"
            allowed = f"channels in the unit of the first, {first.unit or 'which is not known'}"
            hint = "" if reading.channel.unit and first.unit else "state it, such as --unit g"
            raise InputError("FILE", got, allowed, hint)
    slowest, fastest = (end(readings, key=lambda pair: pair[1].channel.sampling_rate) for end in (min, max))
    rate = slowest[1].channel.sampling_rate
    frequencies = _frequencies(wanted, rate, f" of {slowest[0]}")
    asked_for = wanted.frequencies or wanted.high is not None or rate == fastest[1].channel.sampling_rate
    if wanted.part != "total" and wanted.end is None:
        say("each shock is taken to end with its last blow (--end)")
    shocks, notices = [], []
    noticed: dict[tuple[str, str], tuple[Notice, list[str]]] = {}
    windows = MOST_WINDOWS // len(readings)
    for file, reading in readings:
        shock = _shock(file, reading, asked, (frequencies, _scope(wanted, reading, file)), windows)
        shocks.append(shock)
        store.forget()
        does = "is bad, and still in the resultant" if wanted.resultant else "enters no envelope"
        if shock.left_out:
            notices.append(Notice("left-out", f"{shock.name} {does}: {shock.left_out}"))
            continue
        for notice in _notices(reading):
            noticed.setdefault((notice.code, notice.message), (notice, []))[1].append(shock.name)
    for notice, where in noticed.values():
        of = "" if len(where) == len(shocks) - len(notices) else f"{named(where)}: "
        notices.append(dataclasses.replace(notice, message=f"{of}{notice.message}"))
    place = next((k for k, shock in enumerate(shocks) if not shock.left_out), 0)
    _, reading = readings[place]
    return SpectrumResult(
        shocks[place],
        reading,
        _scope(wanted, reading),
        shocks,
        budget=asked.budget,
        bounded_by="" if asked_for else f"{amount(KILOHERTZ, rate)} of {Path(slowest[0]).name}",
        notices=tuple(notices),
        citations=CITED_OF_SEVERAL,
    )


def _shock(
    file: str,
    reading: ChannelReading,
    asked: SpectraAsked,
    over: tuple[Any, Scope],
    most_windows: int,
    several: bool = True,
) -> ShockSpectra:
    """Return all that is asked of a channel, over natural frequencies and of a part of the shock.

    Of several, one that is left out has no response over time and no rolling spectrum.
    """
    wanted, kinds, channel = asked.spectra, asked.spectra.each_kind, reading.channel
    frequencies, scope = over
    left_out = next((f.message for f in spectrum_findings(reading) if f.severity == "bad" or f.code in LEFT_OUT), None)
    response, rolling = None, None
    if wanted.response is not None and not (left_out and several):
        natural = _below(wanted.response, "--response", channel.sampling_rate)
        response = response_of(reading, kinds, natural, wanted.q, wanted.initial)
    if wanted.rolling is not None and not (left_out and several):
        rolling = _rolling(reading, wanted, frequencies, most_windows, file)
    own = _frequencies(wanted, channel.sampling_rate) if asked.own_range else frequencies
    spectra = spectra_of_kinds(reading, kinds, own, wanted.q, scope)
    budget = asked.budget
    if budget is not None:
        check_amounts(budget, reading)
    known = () if budget is None else uncertainties_of(reading, spectra, wanted.side, scope, budget)
    first = slice(len(frequencies))  # what all have in common: the steps are the same from the lowest one on
    common = [
        dataclasses.replace(
            spectrum,
            frequency=spectrum.frequency[first],
            positive=spectrum.positive[first],
            negative=spectrum.negative[first],
        )
        for spectrum in spectra
    ]
    rms = {kind: rms_of(reading, kind, frequencies, wanted.q, wanted.initial) for kind in kinds if wanted.rms}
    channel_spectra = ChannelSpectra(common, wanted.side, rms or None, response, rolling, known)
    record = (file, channel.name, status_of(reading), left_out, reading.baseline, channel_spectra)
    return ShockSpectra(*record, spectra[0] if asked.own_range else None, harm_of(reading))


def _check_axes(asked: SpectraAsked, axes: Sequence[ChannelReading]) -> None:
    """Refuse a resultant of what are no axes of one shock."""
    wanted = asked.spectra
    if not wanted.resultant:
        return
    if len(asked.files) > 1:
        raise InputError("--resultant", f"{len(asked.files)} files", "the channels of one file")
    if wanted.part != "total" or wanted.side != "maximax":
        option, got = ("--part", str(wanted.part)) if wanted.part != "total" else ("--side", str(wanted.side))
        raise InputError(option, got, "the total maximax with --resultant: a length has no sign", "leave it out")
    if len(axes) not in (2, 3):
        got = f"{len(axes)} channel{'s' if len(axes) > 1 else ''}"
        raise InputError("--resultant", got, "2 or 3 perpendicular channels", "name each with --channel")
    first = axes[0].channel
    for other in (reading.channel for reading in axes[1:]):
        if other.values.size != first.values.size or not math.isclose(other.step, first.step, rel_tol=SAME_STEP):
            sizes = [f"{r.channel.name} of {r.channel.values.size}" for r in axes]
            raise InputError("--resultant", ", ".join(sizes) + " samples", "channels sampled together")
        if not abs(other.start - first.start) <= SAME_START * first.step:
            got = f"{other.name}, which begins {other.start - first.start:.6g} s after {first.name}"
            raise InputError("--resultant", got, "channels sampled together")
        if other.unit != first.unit:
            got = f"{other.name} in {other.unit}"
            raise InputError("--resultant", got, f"channels in the unit of {first.name}, {first.unit or 'unknown'}")


def _rolling(reading: ChannelReading, wanted: Spectra, frequencies: Any, most: int, file: str) -> ChannelRolling:
    """Return the rolling spectrum of the first kind, its times in those of the file."""
    channel, rolling, kind = reading.channel, wanted.rolling, wanted.each_kind[0]
    if wanted.part != "total" or wanted.initial != "rest":
        option = "--part" if wanted.part != "total" else "--initial"
        got = wanted.part if wanted.part != "total" else wanted.initial
        raise InputError(option, got, "total and from rest with --rolling, each window by itself", "leave it out")
    longest = channel.step * (channel.values.size - 1)
    if not 2.0 * channel.step <= rolling.window <= longest:
        allowed = f"a window from two samples, {2.0 * channel.step:g} s, to the whole record, {longest:g} s"
        raise InputError("--rolling", rolling.word, f"{allowed}, of {file}")
    if not channel.step <= rolling.hop:
        raise InputError("--rolling", rolling.word, f"a hop of one sample of {file}, {channel.step:g} s, or more")
    windows = (longest - rolling.window) / rolling.hop + 1.0
    if windows > most:
        allowed = f"at most {most} windows a channel, not {windows:.0f}"
        raise InputError("--rolling", rolling.word, allowed, "hop further")
    values = channel.values - reading.baseline
    rolled = rolling_srs(values, channel.step, frequencies, (rolling.window, rolling.hop), wanted.q, kind)
    return ChannelRolling(kind, rolled.time + channel.start, getattr(rolled, wanted.side), rolled.frequency)


def _notices(reading: ChannelReading) -> tuple[Notice, ...]:
    """Return what harms the spectrum, leaves its unit open, or tells it from the others."""
    always = ("unit-unknown", "unit-overrules", "not-calibrated", "outlier")
    return tuple(found.notice for found in reading.findings if "spectrum" in found.harms or found.code in always)


def _frequencies(wanted: Spectra, rate: float, of: str = "") -> Any:
    """Return the natural frequencies, which the lowest sampling rate, that ``of`` a file, can carry."""
    if wanted.frequencies:
        stated: Any = wanted.frequencies
        return [_below(frequency, "--frequency", rate, of) for frequency in stated]
    low, asked, per_octave = wanted.low, wanted.high, wanted.per_octave
    high = min(HIGHEST, OF_SAMPLING * rate) if asked is None else _below(asked, "--to", rate, of)
    if not low < high and asked is None:
        allowed = f"a frequency below the highest, {high:g} Hz (100 kHz, or 2/5 of the sampling rate{of})"
        raise InputError("--from", getattr(low, "word", low), allowed, "a higher one is stated by --to")
    if asked is not None and not low < asked:
        raise InputError("--to", asked.word, f"a frequency above --from, {low:g} Hz")
    if per_octave * math.log2(high / low) > MOST_FREQUENCIES:
        raise InputError("--per-octave", per_octave, "at most 100 000 frequencies")
    return octaves(low, high, per_octave)


def _below(frequency: Typed, field: str, rate: float, of: str = "") -> float:
    if frequency >= 0.5 * rate:
        allowed = f"a frequency below half the sampling rate{of}, {0.5 * rate:g} Hz"
        raise InputError(field, frequency.word, allowed, "the record holds nothing above; sample faster")
    return frequency


def _scope(wanted: Spectra, reading: ChannelReading, file: str = "") -> Scope:
    """Return the part of the shock, its end after the first sample."""
    channel, end = reading.channel, wanted.end
    if end is None and wanted.part != "total" and reading.pulses:
        after = max(reading.pulses[-1].end - channel.start, 2.0 * channel.step)
        return Scope(wanted.part, after, initial=wanted.initial)
    if end is None:
        return Scope(wanted.part, initial=wanted.initial)
    after = end - channel.start
    if not channel.step < after <= channel.duration:
        last = channel.start + channel.duration
        of = f" of {file}" if file else ""
        raise InputError("--end", end.word, f"a time{of} from {channel.start:g} s to {last:g} s")
    return Scope(wanted.part, after, initial=wanted.initial)


@measured.with_groups(calibration=Calibration, reading=Reading, filter=Filtering, spectra=Spectra, judging=Judging)
def shock_spectra(
    paths: str | Path | Sequence[str | Path],
    *,
    channels: str | int | Sequence[str | int] = (),
    unit: Any = None,
    rate: str | float | None = None,
    calibration: Calibration | None = None,
    reading: Reading | None = None,
    filter: str | float | Filter | Filtering | None = None,
    spectra: Spectra | None = None,
    spec: str | None = None,
    judging: Judging | None = None,
) -> SpectrumResult:
    """Compute the shock response spectra of measured files, their baselines taken off.

    It is what ``strikewave srs`` does; `strikewave.srs` takes arrays. Of several files, or channels, the envelope is
    given and, from three on, the limit P95/50.

    Parameters
    ----------
    paths, channels, unit, rate, calibration, reading, filter
        As for `strikewave.record`; the first channel of each file by default.
    spectra : Spectra, optional
        Quality factor, natural frequencies, kinds, side and part of the response, and what is given beside them.
    spec : str, optional
        As for `strikewave.record`; a specification states frequencies, quality factor and side.
    judging : Judging, optional
        Decision rule, uncertainty, and the file of the test.

    Returns
    -------
    SpectrumResult
        A spectrum for each channel and kind, with verdicts where a specification is given.

    Raises
    ------
    InputError, StrikewaveError
        If not one file can be read, or a value is none that it can be.

    Examples
    --------
    >>> import tempfile
    >>> import numpy as np
    >>> import strikewave
    >>> time = np.arange(4000) * 1e-5
    >>> pulse = 500.0 * np.sin(np.pi * (time - 0.01) / 1e-3) * ((time > 0.01) & (time < 0.011))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = Path(folder) / "shot.csv"
    ...     np.savetxt(file, np.column_stack([time, pulse]), delimiter=",", header="time (s),frame (g)", comments="")
    ...     undamped = strikewave.Spectra(q=math.inf, frequencies=["810 Hz", "8 kHz"])
    ...     found = strikewave.shock_spectra(file, spectra=undamped)
    >>> found.highlights()
    [('largest absolute response, at 810 Hz', '884.2 g'), ('quality factor', 'undamped')]
    """
    files, judging = measured.files_of(paths), judging or Judging()
    judging.check_only(measured.SpectraJudging, "shock_spectra")
    measurement = MeasurementOptions.of(channels, unit, rate, calibration, reading)
    asked = SpectraAsked.of(files, spectra or Spectra(), measurement, Filtering.of(filter), judging.uncertainty)
    judge = spectra_judge(judging, judging.specification(spec))
    return judged_spectra_of(
        asked, measured.source_in_python(name_of([Path(file) for file in files]), judging.performed), judge
    )
