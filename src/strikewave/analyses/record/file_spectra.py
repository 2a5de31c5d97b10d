"""Shock response spectra of measured files: of one channel, or of several together, and the verdict on them."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from strikewave.analyses.clauses import budget_notices
from strikewave.analyses.record.options import SpecificationOptions, filtered
from strikewave.analyses.record.rolling_window import ALLOWED_Q, Rolling, read_rolling
from strikewave.analyses.record.rows import name_of
from strikewave.analyses.record.sentences import named
from strikewave.analyses.record.spectrum import (
    KINDS,
    LEFT_OUT,
    ChannelRolling,
    ChannelSpectra,
    ShockSpectra,
    SpectrumOptions,
    SpectrumRequest,
    SpectrumResult,
    harm_of,
    response_of,
    rms_of,
    spectra_of_kinds,
    spectrum_findings,
    status_of,
    uncertainties_of,
)
from strikewave.base.errors import InputError, StrikewaveError
from strikewave.base.result import FAILED, Notice, Source
from strikewave.base.shock_quantities import KILOHERTZ
from strikewave.base.units import si_value
from strikewave.records import ChannelReading, FileReading, Options, Request, SampleStore, compare
from strikewave.records.reading import check_amounts
from strikewave.reporting import measured_files as measured
from strikewave.reporting.faces import amount
from strikewave.reporting.options import Typed, wrong_choice
from strikewave.reporting.terminal import say
from strikewave.signal.filters import Filter
from strikewave.signal.srs import INITIAL, PARTS, SIDES, Scope, Spectrum, octaves, resultant_srs, rolling_srs
from strikewave.specifications.judging import Rule

if TYPE_CHECKING:
    from strikewave.analyses.record.verdicts import SpectraJudge

HIGHEST = 100e3
"""Highest natural frequency by default, Hz. Chosen: ten times that of usual spectra of pyroshock (10 kHz in Irvine, An
Introduction to the Shock Response Spectrum, 2012, figure 2), so that blows of 10 us are shown."""
OF_SAMPLING = 0.4
"""Highest natural frequency by default, over the sampling rate: nearer to half of it a record holds little, and its
filter has taken some."""
MOST_FREQUENCIES = 1e5
"""More frequencies are refused. Chosen: no screen shows finer steps, and each takes a pass over the record."""
MOST_WINDOWS = 20_000
"""Windows of rolling spectra, of all channels together, at most. Chosen: more than the pixels of any screen, and a few
GB in JSON."""
CITED = ("smallwood-1981", "iso-18431-4")
"""Sources that a spectrum follows."""
CITED_OF_SEVERAL = (*CITED, "piersol-2009", "nist-handbook")
"""Sources that several spectra and their limit follow."""
SAME_STEP = 1e-9
"""Relative difference of steps that are one."""
SAME_START = 0.05
"""Difference of two begins, over a step, up to which channels were sampled together."""


class FilesAsked(NamedTuple):
    """Files, what is stated of their channels, how they are read, and the filters that are taken."""

    files: Sequence[str]
    stated: dict[str, dict[str, Any]]
    options: Options
    filters: Request


def judged_spectra_of(
    asked: FilesAsked, wanted: SpectrumRequest, origin: Source, judge: SpectraJudge | None
) -> SpectrumResult:
    """Return the spectra of measured files, and the verdict on those that a specification means where one judges."""
    found = spectra_of(asked, wanted if judge is None else judge.wanted(wanted), origin)
    if found.budget is not None and found.budget.contributions:
        notices = (*found.notices, *budget_notices(found.budget))
        found = dataclasses.replace(found, notices=notices, citations=(*found.citations, "jcgm-100"))
    return found if judge is None else judge.judged(found)


def spectra_of(asked: FilesAsked, wanted: SpectrumRequest, origin: Source) -> SpectrumResult:
    """Return the spectra of measured files."""
    if len(asked.files) == 1 and len(asked.options.channels) < 2 and not wanted.options.resultant:
        return _one(asked, wanted, origin)
    unread: list[Notice] = []
    with SampleStore() as store:
        readings = _readings(asked, store, unread)
        axes = [reading for _, reading in readings] if wanted.options.resultant else []
        _check_axes(asked, wanted, axes)
        found = _several(wanted, readings, store)
        sums = _sums(wanted, axes, found.spectra[0].frequency)
    return dataclasses.replace(found, resultant=sums, origin=origin, notices=(*found.notices, *unread))


def _one(asked: FilesAsked, wanted: SpectrumRequest, origin: Source) -> SpectrumResult:
    file, stated, options, filters = asked.files[0], asked.stated, asked.options, asked.filters
    reading = measured.examined_channel(file, stated, options, "spectrum", "the spectrum", filters)
    frequencies = _frequencies(wanted, reading.channel.sampling_rate)
    scope = _scope(wanted, reading)
    if wanted.part != "total" and wanted.end is None and reading.pulses:
        say(f"the shock is taken to end with its last blow, at {reading.pulses[-1].end:.6g}\xa0s (--end)")
    shock = _shock(file, reading, wanted, (frequencies, scope), MOST_WINDOWS, several=False)
    return SpectrumResult(
        shock, reading, scope, budget=wanted.options.budget, origin=origin, notices=_notices(reading), citations=CITED
    )


def _readings(asked: FilesAsked, store: SampleStore, unread: list[Notice]) -> list[tuple[str, ChannelReading]]:
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


def _several(
    wanted: SpectrumRequest, readings: Sequence[tuple[str, ChannelReading]], store: SampleStore
) -> SpectrumResult:
    """Return the spectra of all channels and what they come to; one that is bad enters no envelope."""
    first = readings[0][1].channel
    for file, reading in readings:
        if reading.channel.unit != first.unit:
            got = f"{reading.channel.name} of {file}, in {reading.channel.unit or 'no unit that is known'}"
            allowed = f"channels in the unit of the first, {first.unit or 'which is not known'}"
            hint = "" if reading.channel.unit and first.unit else "state it, such as --unit g"
            raise InputError("FILE", got, allowed, hint)
    slowest, fastest = (end(readings, key=lambda pair: pair[1].channel.sampling_rate) for end in (min, max))
    rate = slowest[1].channel.sampling_rate
    frequencies = _frequencies(wanted, rate, f" of {slowest[0]}")
    asked_for = wanted.frequencies or wanted.grid[1] is not None or rate == fastest[1].channel.sampling_rate
    if wanted.part != "total" and wanted.end is None:
        say("each shock is taken to end with its last blow (--end)")
    shocks, notices = [], []
    found: dict[tuple[str, str], tuple[Notice, list[str]]] = {}
    windows = MOST_WINDOWS // len(readings)
    for file, reading in readings:
        shock = _shock(file, reading, wanted, (frequencies, _scope(wanted, reading, file)), windows)
        shocks.append(shock)
        store.forget()
        does = "is bad, and still in the resultant" if wanted.options.resultant else "enters no envelope"
        if shock.left_out:
            notices.append(Notice("left-out", f"{shock.name} {does}: {shock.left_out}"))
            continue
        for one in _notices(reading):
            found.setdefault((one.code, one.message), (one, []))[1].append(shock.name)
    for one, where in found.values():
        of = "" if len(where) == len(shocks) - len(notices) else f"{named(where)}: "
        notices.append(dataclasses.replace(one, message=f"{of}{one.message}"))
    place = next((k for k, shock in enumerate(shocks) if not shock.left_out), 0)
    _, reading = readings[place]
    return SpectrumResult(
        shocks[place],
        reading,
        _scope(wanted, reading),
        shocks,
        budget=wanted.options.budget,
        bounded_by="" if asked_for else f"{amount(KILOHERTZ, rate)} of {Path(slowest[0]).name}",
        notices=tuple(notices),
        citations=CITED_OF_SEVERAL,
    )


def _shock(
    file: str,
    reading: ChannelReading,
    wanted: SpectrumRequest,
    over: tuple[Any, Scope],
    most_windows: int,
    several: bool = True,
) -> ShockSpectra:
    """Return all that is asked of a channel, over natural frequencies and of a part of the shock.

    Of several, one that is left out has no response over time and no rolling spectrum.
    """
    more, kinds, channel = wanted.options, wanted.kinds, reading.channel
    frequencies, scope = over
    left_out = next((f.message for f in spectrum_findings(reading) if f.severity == "bad" or f.code in LEFT_OUT), None)
    response, rolling = None, None
    if more.response is not None and not (left_out and several):
        natural = _below(more.response, "--response", channel.sampling_rate)
        response = response_of(reading, kinds, natural, wanted.q, more.initial)
    if more.rolling is not None and not (left_out and several):
        rolling = _rolling(reading, wanted, frequencies, most_windows, file)
    own = _frequencies(wanted, channel.sampling_rate) if wanted.own_range else frequencies
    spectra = spectra_of_kinds(reading, kinds, own, wanted.q, scope)
    budget = more.budget
    if budget is not None:
        check_amounts(budget, reading)
    known = () if budget is None else uncertainties_of(reading, spectra, wanted.side, scope, budget)
    common = [_lowest(one, len(frequencies)) for one in spectra]
    rms = {kind: rms_of(reading, kind, frequencies, wanted.q, more.initial) for kind in kinds if more.rms}
    found = ChannelSpectra(common, wanted.side, rms or None, response, rolling, known)
    record = (file, channel.name, status_of(reading), left_out, reading.baseline, found)
    return ShockSpectra(*record, spectra[0] if wanted.own_range else None, harm_of(reading))


def _lowest(one: Spectrum, count: int) -> Spectrum:
    """Return a spectrum of the lowest natural frequencies alone: its steps are the same from the lowest one on."""
    if len(one.frequency) == count:
        return one
    first = slice(count)
    return dataclasses.replace(
        one, frequency=one.frequency[first], positive=one.positive[first], negative=one.negative[first]
    )


def _check_axes(asked: FilesAsked, wanted: SpectrumRequest, axes: Sequence[ChannelReading]) -> None:
    """Refuse a resultant of what are no axes of one shock."""
    if not wanted.options.resultant:
        return
    if len(asked.files) > 1:
        raise InputError("--resultant", f"{len(asked.files)} files", "the channels of one file")
    if wanted.part != "total" or wanted.side != "maximax":
        option, got = ("--part", wanted.part) if wanted.part != "total" else ("--side", wanted.side)
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


def _sums(wanted: SpectrumRequest, axes: Sequence[ChannelReading], frequencies: Any) -> dict[str, Any]:
    """Return the vector sums of axes by kind; nothing without axes."""
    values, initial = [reading.channel.values - reading.baseline for reading in axes], wanted.options.initial
    kinds = wanted.kinds if axes else ()
    return {kind: resultant_srs(values, axes[0].channel.step, frequencies, wanted.q, kind, initial) for kind in kinds}


def _rolling(
    reading: ChannelReading, wanted: SpectrumRequest, frequencies: Any, most: int, file: str
) -> ChannelRolling:
    """Return the rolling spectrum of the first kind, its times in those of the file."""
    channel, rolling = reading.channel, wanted.options.rolling
    assert rolling is not None
    if wanted.part != "total" or wanted.options.initial != "rest":
        option = "--part" if wanted.part != "total" else "--initial"
        got = wanted.part if wanted.part != "total" else wanted.options.initial
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
    found = rolling_srs(values, channel.step, frequencies, (rolling.window, rolling.hop), wanted.q, wanted.kinds[0])
    return ChannelRolling(wanted.kinds[0], found.time + channel.start, getattr(found, wanted.side), found.frequency)


def _notices(reading: ChannelReading) -> tuple[Notice, ...]:
    """Return what harms the spectrum, leaves its unit open, or tells it from the others."""
    always = ("unit-unknown", "unit-overrules", "not-calibrated", "outlier")
    return tuple(found.notice for found in reading.findings if "spectrum" in found.harms or found.code in always)


def _frequencies(wanted: SpectrumRequest, rate: float, of: str = "") -> Any:
    """Return the natural frequencies, which the lowest sampling rate, that ``of`` a file, can carry."""
    if wanted.frequencies:
        return [_below(frequency, "--frequency", rate, of) for frequency in wanted.frequencies]
    low, asked, per_octave = wanted.grid
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


def _scope(wanted: SpectrumRequest, reading: ChannelReading, file: str = "") -> Scope:
    """Return the part of the shock, its end after the first sample."""
    channel, end = reading.channel, wanted.end
    if end is None and wanted.part != "total" and reading.pulses:
        after = max(reading.pulses[-1].end - channel.start, 2.0 * channel.step)
        return Scope(wanted.part, after, initial=wanted.options.initial)
    if end is None:
        return Scope(wanted.part, initial=wanted.options.initial)
    after = end - channel.start
    if not channel.step < after <= channel.duration:
        last = channel.start + channel.duration
        of = f" of {file}" if file else ""
        raise InputError("--end", end.word, f"a time{of} from {channel.start:g} s to {last:g} s")
    return Scope(wanted.part, after, initial=wanted.options.initial)


LOWEST = 10.0
"""Lowest natural frequency where none is stated, Hz."""


def shock_spectra(
    paths: str | Path | Sequence[str | Path],
    *,
    channels: Sequence[str | int] = (),
    unit: measured.Stated | None = None,
    sensitivity: measured.Stated | None = None,
    gain: measured.Stated | None = None,
    excitation: measured.Stated | None = None,
    rated_excitation: measured.Stated | None = None,
    count: measured.Stated | None = None,
    polarity: measured.Stated | None = None,
    rate: str | float | None = None,
    time: str | int | None = None,
    time_unit: str | None = None,
    measurement: int | None = None,
    filter: str | float | Filter | None = None,
    ac_coupling: str | float | None = None,
    high_pass: str | float | None = None,
    q: float = 10.0,
    frequencies: Sequence[str | float] = (),
    low: str | float = LOWEST,
    high: str | float | None = None,
    per_octave: float = 12.0,
    kinds: Sequence[str] = ("absolute",),
    side: str = "maximax",
    part: str = "total",
    end: str | float | None = None,
    resultant: bool = False,
    rolling: str | float | tuple[float, float] | None = None,
    initial: str = "rest",
    rms: bool = False,
    response: str | float | None = None,
    spec: str | None = None,
    decision: Rule = "simple",
    uncertainty: str | float | Path | None = None,
    strict: bool = False,
    test: str | Path | None = None,
) -> SpectrumResult:
    """Compute the shock response spectra of measured files, their baselines taken off.

    It is what ``strikewave srs`` does; `strikewave.srs` takes arrays. Of several files, or channels, the envelope is
    given and, from three on, the limit P95/50.

    Parameters
    ----------
    paths, channels, unit, sensitivity, gain, excitation, rated_excitation, count, polarity, rate, time
        As for `strikewave.record`; the first channel of each file by default.
    time_unit, measurement
        As for `strikewave.record`.
    filter, ac_coupling, high_pass, test
        As for `strikewave.record`.
    q : float, optional
        Quality factor 1 / (2 damping ratio), or `math.inf`.
    frequencies : sequence of str or float, optional
        Natural frequencies, with a unit or in Hz, instead of a range.
    low, high : str or float, optional
        Lowest and highest natural frequency; the highest is 100 kHz, or 2/5 of the lowest sampling rate, by default.
    per_octave : float, optional
        Number of natural frequencies in an octave.
    kinds : sequence of str, optional
        ``absolute``, ``displacement``, ``relative-velocity``, ``pseudo-velocity``, ``equivalent-static``.
    side : str, optional
        ``maximax``, ``positive`` or ``negative``.
    part : str, optional
        ``total``, ``primary`` (while the shock lasts) or ``residual`` (after it).
    end : str or float, optional
        End of the shock in the time of the files, with a unit or in s; the end of the last blow by default.
    resultant : bool, optional
        True to give the vector sum of 2 or 3 perpendicular channels of a file.
    rolling : str, float or (float, float), optional
        Window, or window and hop, of spectra that slide over the records: ``"20 ms,5 ms"``, or in s.
    initial : str, optional
        How the records begin: ``rest``, ``shifted`` or ``steady``.
    rms : bool, optional
        True to give root mean squares of the responses.
    response : str or float, optional
        Natural frequency of an oscillator whose response is given, with a unit or in Hz.
    spec, decision, uncertainty, strict
        As for `strikewave.record`; a specification states frequencies, quality factor and side.

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
    ...     found = strikewave.shock_spectra(file, q=math.inf, frequencies=["810 Hz", "8 kHz"])
    >>> found.highlights()
    [('largest absolute response, at 810 Hz', '884.2 g'), ('quality factor', 'undamped')]
    """
    calibration = {
        "unit": unit,
        "sensitivity": sensitivity,
        "gain": gain,
        "excitation": excitation,
        "rated_excitation": rated_excitation,
        "count": count,
        "polarity": polarity,
    }
    with measured.named_for_python():
        files = measured.files_of(paths)
        stated = measured.MeasurementOptions.in_python(channels, calibration, rate, time, time_unit, measurement)
        for field, word, choices in (
            *(("kinds", kind, tuple(KINDS)) for kind in kinds),
            *(("side", side, SIDES), ("part", part, PARTS), ("initial", initial, INITIAL)),
        ):
            if word not in choices:
                raise wrong_choice(word, field, choices)
        for field, number, allowed in (
            ("q", q, ALLOWED_Q),
            ("per_octave", per_octave, "a number of frequencies above zero, at most 100 000"),
        ):
            if not number > 0.0:
                raise InputError(field, number, allowed)
        named = [_typed(one, "Hz", "frequencies") for one in frequencies]
        lowest = low if low == LOWEST else _typed(low, "Hz", "low")  # the default is nothing that was asked for
        ends = (lowest, None if high is None else _typed(high, "Hz", "high"), per_octave)
        options = SpectrumOptions(
            initial,
            rms,
            resultant,
            None if response is None else _typed(response, "Hz", "response"),
            None if rolling is None else _rolling_of(rolling),
        )
        judging = SpecificationOptions.in_python(spec, decision, uncertainty, strict)
        options = options._replace(budget=judging.uncertainty)
        last = None if end is None else _typed(end, "s", "end")
        wanted = SpectrumRequest(q, named, ends, tuple(dict.fromkeys(kinds)), side, part, last, options)
        asked = FilesAsked(
            files, stated.calibration(), stated.reading(), filtered(Request(), filter, ac_coupling, high_pass)
        )
        origin = measured.source_in_python(name_of([Path(file) for file in files]), test)
        return judged_spectra_of(asked, wanted, origin, judging.spectra_judge())


def _typed(value: str | float, si: str, field: str) -> Typed:
    """Return a quantity that knows how it was written; only a time may be zero or below."""
    found = si_value(value, si, field)
    if not math.isfinite(found) or (si == "Hz" and not found > 0.0):
        raise InputError(field, value, "a frequency above zero" if si == "Hz" else "a time")
    return Typed(found, str(value))


def _rolling_of(value: str | float | tuple[float, float]) -> Rolling:
    """Return window and hop."""
    if isinstance(value, str):
        return read_rolling(value, "rolling")
    times = value if isinstance(value, tuple | list) else (value,)
    return read_rolling(",".join(f"{time} s" for time in times), "rolling")
