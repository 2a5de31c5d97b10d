"""Measured records and spectra against a specification: each blow, then shocks by direction and their rate."""

from __future__ import annotations

import fnmatch
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from collections.abc import Set as AbstractSet
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from strikewave.base import declare
from strikewave.base.constants import COVERAGE
from strikewave.base.errors import InputError, nearest
from strikewave.base.shock_quantities import MICROSECONDS
from strikewave.base.texts import first_few
from strikewave.records.budget import RECORD, SAMPLING, Budget
from strikewave.records.health_notice import HealthNotice
from strikewave.records.measured_uncertainty import BlowUncertainty
from strikewave.records.measuring import RecordedPulse
from strikewave.records.pulse_shape import PulseUncertainty, SmoothPulse
from strikewave.records.reading import ChannelReading, FileReading
from strikewave.signal.filters import Filter
from strikewave.specifications.ideal_pulses import REACH, IdealPulse
from strikewave.specifications.judging import (
    CANNOT_TELL,
    FAIL,
    INDICATIVE,
    PASS,
    Clause,
    Limits,
    MeasuredFigure,
    PulseLimits,
    Rule,
    Shock,
    ShockVerdict,
    SpectrumLimits,
    judge_shock,
    judged,
    not_judged,
    refused,
    together,
    worst_clauses,
)
from strikewave.specifications.reading import ShockCount, Specification

DIRECTIONS = ("+x", "-x", "+y", "-y", "+z", "-z")  # directions of a shock: axes of the specimen, both senses
MOST_NAMED = 3  # files without a direction that a line names; the others are counted


class StatedDirection(NamedTuple):
    """A direction, of the shocks of which files and channels."""

    # ``FILES``, ``#CHANNEL`` or ``FILES#CHANNEL``: a pattern of file names, and name or number of a channel; empty for
    # all
    place: str
    direction: str  # one of `DIRECTIONS`
    option: str  # where it was typed, and how
    word: str


class CountedShock(NamedTuple):
    """A shock as it is counted: file, number and name of the channel (empty where all have one), direction, verdict."""

    file: str
    channel: int
    name: str
    direction: str
    verdict: str


def read_direction(word: str, field: str = "--direction") -> StatedDirection:
    """Return what ``[FILES][#CHANNEL]=DIRECTION``, or a direction alone, states."""
    place, equals, direction = word.rpartition("=")
    place, direction = place.strip(), direction.strip().lower()
    if direction not in DIRECTIONS or (equals and not place):
        allowed = f"a direction of {', '.join(DIRECTIONS)}, or FILES=DIRECTION, or FILES#CHANNEL=DIRECTION"
        raise InputError(field, word, allowed, nearest(direction, DIRECTIONS))
    return StatedDirection(place, direction, field, word)


def direction_fits(place: str, path: str, keys: AbstractSet[str]) -> bool:
    """Tell whether a place means a channel of a file; a name may hold a ``#`` too."""
    return _file_fits(place, path) or any(_file_fits(files, path) and name in keys for files, name in _split(place))


def cross_axis_fits(word: str, path: str, keys: AbstractSet[str]) -> bool:
    """Tell whether ``[FILES#]CHANNEL`` means a channel of a file."""
    return word in keys or any(_file_fits(files, path) and name in keys for files, name in _split(word))


def _split(word: str) -> Iterator[tuple[str, str]]:
    """Yield all ways to read a word as files and channel."""
    return ((word[:k], word[k + 1 :]) for k, letter in enumerate(word) if letter == "#")


def _file_fits(pattern: str, path: str) -> bool:
    names = {path, path.rpartition(": ")[0]} - {""}  # a measurement of a file is called as the file with its number
    return not pattern or any(
        pattern == name or fnmatch.fnmatch(Path(name).name, pattern) or fnmatch.fnmatch(name, pattern) for name in names
    )


def check_directions(stated: Sequence[StatedDirection], files: Sequence[tuple[str, Sequence[set[str]]]]) -> None:
    """Refuse a direction whose pattern means no channel of any file; of a file without channels it may mean any."""
    for direction in stated:
        if any(direction_fits(direction.place, path, keys) for path, channels in files for keys in channels or [set()]):
            continue
        of_files = [
            channels for path, channels in files for part, _ in _split(direction.place) if _file_fits(part, path)
        ]
        if of_files:
            names = {key for channels in of_files for keys in channels for key in keys}
            channel = direction.place.rpartition("#")[2]
            raise InputError(
                direction.option, direction.word, "name or number of a channel of these files", nearest(channel, names)
            )
        part = direction.place.partition("#")[0] or direction.place
        names = {Path(path).name for path, _ in files}
        raise InputError(direction.option, direction.word, "a pattern that fits one of the files", nearest(part, names))


def direction_clauses(shocks: Sequence[CountedShock], directions: Sequence[str], count: ShockCount) -> list[Clause]:
    """Return the clauses of the shocks in each direction: those that pass count.

    A shock that can not be judged, or whose direction is not stated, may be one of those that lack: it fails no count.
    """
    limits = Limits(count.low, count.high, count.status)
    asked = f"{count.low:g} are asked for" if math.isinf(count.high) else f"{count.low:g} to {count.high:g} are"
    if not directions:
        return [not_judged("shocks by direction", limits, "1", "no direction is stated (--direction)")]
    clauses: list[Clause] = []
    stated = [shock for shock in DIRECTIONS if shock in directions]
    loose = [shock for shock in shocks if not shock.direction]
    for direction in stated:
        here = [shock for shock in shocks if shock.direction == direction]
        passed, possible = _blows(here, (PASS,)), _blows(here, (PASS, CANNOT_TELL))
        possible += _blows(loose, (PASS, CANNOT_TELL))
        clause = judged(f"shocks in {direction}", float(passed), limits, "1")
        if clause.verdict == FAIL:
            every = _blows(here, (PASS, CANNOT_TELL, FAIL))
            verdict = CANNOT_TELL if passed < limits.low <= possible else FAIL
            without = f", and {_of_files(loose)} no direction" if loose and verdict == CANNOT_TELL else ""
            reason = f"{passed} of {every} shocks pass{without}; {asked}"
            clause = replace(clause, verdict=verdict, reason=reason)
        clauses.append(clause)
    if loose:
        reason = f"{_of_files(loose)} no direction, and count in none (--direction, or --cross-axis for what is across)"
        clauses.append(not_judged("shocks without a direction", Limits(0.0, 0.0, count.status), "1", reason))
    across = judged("directions", float(len(stated)), Limits(count.directions, math.inf, count.status), "1")
    if across.verdict == FAIL:
        lacking = [shock for shock in DIRECTIONS if shock not in stated]
        across = replace(across, verdict=CANNOT_TELL if loose else FAIL, reason=f"not stated: {', '.join(lacking)}")
    return [*clauses, across]


def _of_files(shocks: Sequence[CountedShock]) -> str:
    """Say which files shocks are of."""
    names = list(dict.fromkeys(", ".join(filter(None, (Path(shock.file).name, shock.name))) for shock in shocks))
    return f"{first_few(names, MOST_NAMED, '; ')} ha{'ve' if len(names) > 1 else 's'}"


def _blows(shocks: Sequence[CountedShock], verdicts: Sequence[str]) -> int:
    """Return how many blows have one of the verdicts: of channels that recorded the same blows, the fewest."""
    counts: dict[str, dict[int, int]] = {}
    for shock in shocks:
        channels = counts.setdefault(shock.file, {})
        channels[shock.channel] = channels.get(shock.channel, 0) + (shock.verdict in verdicts)
    return sum(min(channels.values()) for channels in counts.values())


Array = NDArray[np.float64]

# Findings on what machine, specimen or direction do: a specification judges it, it is no fault of the record
JUDGED_AS_IT_IS = (
    "polarity",
    "polarity-differs",
    "ringing",
    "rebound",
    "double-hit",
    "missing-blow",
    "outlier",
    "response",
    "no-foot",
)
# Findings on a cross-axis channel by which its true values may be larger
HIDES_PEAKS = ("clipped", "flat-top", "slew-rate")
# Samples before a shock that tell the noise of a cross-axis channel, at least: it is then good to a fifth
FEWEST_QUIET = 16
LEFT_BEFORE = 0.25  # lengths of a blow before it that are left out of them: what crosses over may begin earlier
# Share of the duration between samples on which a filter is tried on the ideal pulse, where the record is coarser
FINEST_FILTERED = 1.0 / 200.0


SHARE = declare.word("stated expanded uncertainty (k = 2), as a share", key="uncertainty")
HOLDS = declare.word("what the stated uncertainty holds of, such as noise, calibration", key="uncertainty_holds")
NOT_STATED = declare.word("what nobody stated an uncertainty of", key="uncertainty_not_stated")
VERDICT = declare.word("pass, fail or cannot-tell")
# Declarations that verdicts on records, spectra and histories share
BY_INDICATIVE = declare.word("whether it rests on a limit from memory", key="by_indicative_limits")


@declare.dataclass
class Asked:
    """Settings of a verdict on records."""

    rule: Rule = declare.word("simple, or guarded by the expanded uncertainty", key="decision", default="simple")
    strict: bool = declare.word("whether limits from memory count as none", default=False)
    # By which the uncertainties of the blows were found; None where only noise and baseline are known
    budget: Budget | None = None
    directions: Sequence[StatedDirection] = ()  # directions of the shocks, with their files and channels
    # Names or numbers of channels that measure across, with the files in which they do, see `cross_axis_fits`
    cross_axis: Sequence[str] = ()
    # Names of what the record itself tells where no budget is stated; none where uncertainty plays no part
    from_record: tuple[str, ...] = (RECORD,)
    share = declare.computed(SHARE)(lambda one: 0.0 if one.budget is None else one.budget.share)
    holds = declare.computed(HOLDS)(lambda one: one.from_record if one.budget is None else one.budget.names)
    not_stated = declare.computed(NOT_STATED)(lambda one: (one.budget or Budget(())).not_stated if one.holds else ())

    def direction_of(self, path: str, channel: Iterable[str]) -> str:
        """Return the direction of the shocks of a channel; empty where none is stated. The last that fits counts."""
        keys = set(channel)
        fitting = [one.direction for one in self.directions if direction_fits(one.place, path, keys)]
        return fitting[-1] if fitting else ""


class JudgedShock(NamedTuple):
    """One blow with its verdict."""

    file: str
    reading: ChannelReading
    number: int
    pulse: RecordedPulse
    direction: str
    shock: Shock
    found: ShockVerdict


@declare.dataclass
class ShockRow:
    """A shock as a document has it."""

    file: str = declare.word("measured file")
    channel: str = declare.word("channel")
    blow: int = declare.count("number of the blow in the record, from 1")
    direction: str | None = declare.word("stated direction")
    start: float = declare.number(MICROSECONDS, "where the ideal pulse begins")
    verdict: str = declare.word("verdict on this shock")
    clauses: tuple[Clause, ...] = declare.rows(Clause, "its clauses")


@declare.dataclass
class RecordsVerdict:
    """Verdict on records."""

    specification: Specification = declare.part(Specification, "what they are judged by", inline=True)
    limits: PulseLimits  # limits that it sets for a shock
    asked: Asked = declare.part(Asked, "how", inline=True)
    shocks: tuple[JudgedShock, ...]  # in the order of the files
    campaign: tuple[Clause, ...] = ()  # shocks by direction, their rate, files without a shock

    @declare.computed(VERDICT)
    def verdict(self) -> str:
        """Verdict on all shocks and clauses together."""
        return together([*(one.found.verdict for one in self.shocks), *(clause.verdict for clause in self.campaign)])

    @declare.computed(BY_INDICATIVE)
    def by_indicative(self) -> bool:
        """True if the verdict rests on a limit that is from memory."""
        return rests_on_indicative([clause for clause, _ in self.clauses], self.verdict)

    @property
    def clauses(self) -> list[tuple[Clause, JudgedShock | None]]:
        """Each clause where it came out worst, with its shock; those of the campaign last."""
        worst = worst_clauses([one.found for one in self.shocks])
        return [(clause, self.shocks[place]) for clause, place in worst] + [(clause, None) for clause in self.campaign]

    @declare.computed(declare.rows(Clause, "each clause where it came out worst", key="clauses"))
    def placed_clauses(self) -> list[Clause]:
        """Clauses with file, channel and blow."""
        return [
            clause if one is None else replace(clause, file=one.file, channel=one.reading.channel.name, blow=one.number)
            for clause, one in self.clauses
        ]

    @declare.computed(declare.rows(ShockRow, "verdict on each shock", key="shocks"))
    def shock_rows(self) -> list[ShockRow]:
        """Shocks as the document has them."""
        return [
            ShockRow(
                one.file,
                one.reading.channel.name,
                one.number,
                one.direction or None,
                one.found.start,
                one.found.verdict,
                one.found.clauses,
            )
            for one in self.shocks
        ]


def rests_on_indicative(clauses: Sequence[Clause], verdict: str) -> bool:
    """Tell whether a verdict rests on an indicative limit: a pass on any of them, a fail where all that fail are."""
    used = [clause for clause in clauses if clause.verdict == verdict]
    if verdict == PASS:
        return any(clause.status == INDICATIVE for clause in used)
    return verdict == FAIL and bool(used) and all(clause.status == INDICATIVE for clause in used)


def judge_records(
    files: Sequence[FileReading], specification: Specification, asked: Asked, filter_: Filter | None = None
) -> RecordsVerdict:
    """Judge the blows of records."""
    limits = specification.pulse_limits()
    check_directions(asked.directions, [(file.path, [_keys(reading) for reading in file.channels]) for file in files])
    for word in asked.cross_axis:
        if not any(cross_axis_fits(word, file.path, _keys(one)) for file in files for one in file.channels):
            named = {key for file in files for one in file.channels for key in _keys(one)}
            hint = nearest(word.rpartition("#")[2], named) + "; a channel that --channel leaves out is not read"
            raise InputError("--cross-axis", word, "name or number of a channel, or FILES#CHANNEL", hint)
    channels = [
        (file, reading)
        for file in files
        for reading in file.channels
        if reading.response is None and not _is_across(asked, file, reading)
    ]
    usable = [(file, reading) for file, reading in channels if reading.channel.unit == "m/s^2"]
    if not usable:
        units = sorted({reading.channel.unit or "no known unit" for _, reading in channels}) or ["no channel"]
        raise InputError("--spec", ", ".join(units), "records of an acceleration", "state the unit, such as --unit g")
    shocks: list[JudgedShock] = []
    empty: list[str] = []
    for file, reading in usable:
        if not reading.pulses:
            empty.append(file.path)
        troubles = troubles_of([*file.findings, *reading.findings])
        beside = [one for one in file.channels if _is_across(asked, file, one)]
        _check_units(beside)
        troubles |= _of_cross_axis(beside)
        direction = asked.direction_of(file.path, _keys(reading))
        for number, pulse in enumerate(reading.pulses, start=1):
            known = reading.uncertainties[number - 1] if reading.uncertainties else None
            shock = shock_of(reading, pulse, limits, beside, filter_, troubles, known)
            verdict = judge_shock(shock, limits, asked.rule, asked.strict)
            shocks.append(JudgedShock(file.path, reading, number, pulse, direction, shock, verdict))
    empty += [file.path for file in files if not file.channels]
    without = []
    if empty:
        clause = judged("files without a shock", float(len(empty)), Limits(0.0, 0.0, limits.status), "1")
        reason = f"no shock was found in {first_few([Path(path).name for path in empty], 3)}"
        without = [replace(clause, verdict=CANNOT_TELL, reason=reason)]
    campaign = [*without, *_counts(shocks, specification, asked), *_rate(usable, specification)]
    if asked.strict:
        campaign = [refused(clause) for clause in campaign]
    return RecordsVerdict(specification, limits, asked, tuple(shocks), tuple(campaign))


def _is_across(asked: Asked, file: FileReading, reading: ChannelReading) -> bool:
    return any(cross_axis_fits(word, file.path, _keys(reading)) for word in asked.cross_axis)


def _check_units(across: Sequence[ChannelReading]) -> None:
    """Refuse cross-axis channels that hold no acceleration."""
    for one in across:
        if one.channel.unit != "m/s^2":
            wrong = f"{one.channel.name}, {one.channel.unit or 'no known unit'}"
            raise InputError("--cross-axis", wrong, "channels of an acceleration", "state the unit, such as --unit g")


def _of_cross_axis(across: Sequence[ChannelReading]) -> dict[str, str]:
    """Return why the largest value across is not to be trusted, if it is not: a limit hides what lies above it."""
    found = (
        f"{one.channel.name}: {finding.code}: {finding.message}"
        for one in across
        for finding in one.findings
        if finding.code in HIDES_PEAKS
    )
    first = next(found, "")
    return {"cross_axis": first} if first else {}


def _keys(reading: ChannelReading) -> set[str]:
    return {reading.channel.name, str(reading.number)}


def troubles_of(findings: Sequence[HealthNotice]) -> dict[str, str]:
    """Return why figures are not to be trusted, the worst finding of each."""
    troubles: dict[str, str] = {}
    for severity in ("bad", "suspect"):
        for finding in findings:
            if finding.severity != severity or finding.code in JUDGED_AS_IT_IS:
                continue
            for figure in ("peak", "width", "velocity_change"):
                if severity == "bad" or figure in finding.harms:
                    troubles.setdefault(figure, f"{finding.code}: {finding.message}")
    return troubles


def shock_of(
    reading: ChannelReading,
    pulse: RecordedPulse,
    limits: PulseLimits,
    across: Sequence[ChannelReading] = (),
    filter_: Filter | None = None,
    troubles: Mapping[str, str] | None = None,
    known: BlowUncertainty | None = None,
) -> Shock:
    """Return a blow as a shock to judge: the stretch of record about it, baseline taken off, pulse upwards."""
    channel, duration = reading.channel, limits.pulse.duration
    before, after = (1.0, 2.0) if limits.band is None else (limits.band.before, 1.0 + limits.band.after)
    room = (REACH + 1.0) * duration
    first, last = (
        round((time - channel.start) / channel.step)
        for time in (pulse.begin - before * duration - room, pulse.end + after * duration + room)
    )
    low, high = max(first, 0), min(last + 1, channel.values.size)
    sign = math.copysign(1.0, pulse.peak)
    begin = channel.start + low * channel.step
    time = begin + channel.step * np.arange(high - low)
    beside = {one.channel.name: np.interp(time, one.channel.time, one.channel.values) - one.baseline for one in across}
    values = {"peak": abs(pulse.peak), "velocity_change": abs(pulse.velocity_change), "width": pulse.width}
    window = (1.0 + sum(limits.window)) * limits.pulse.duration
    noise = replace(pulse.uncertainty, velocity_change=pulse.area_uncertainty(window))
    figures = {
        name: measured_figure(name, value, noise, known)
        for name, value in values.items()
        if name != "width" or value > 0.0
    }
    noise_across = _noise_before(beside, time < pulse.begin - LEFT_BEFORE * (pulse.end - pulse.begin))
    share = 0.0 if known is None else known.figures["peak"].expanded / abs(pulse.peak)
    return Shock(
        np.asarray(sign * (channel.values[low:high] - pulse.offset), dtype=np.float64),
        channel.step,
        begin,
        min(max(round((pulse.time - begin) / channel.step), 0), high - low - 1),
        figures,
        1.0 if filter_ is None else filter_leaves(filter_, limits.pulse, channel.step),
        math.nan if filter_ is None else filter_.half_power(channel.step),
        troubles or {},
        beside,
        math.hypot(noise_across, 0.0 if known is None else known.amount),
        share,
        1.0 if filter_ is None else before_filter(reading, pulse).through(filter_).width,
    )


def _noise_before(channels: Mapping[str, Array], quiet: NDArray[np.bool_]) -> float:
    """Return the standard deviation of the noisiest channel where it is quiet; NaN where too little is, 0 of none."""
    if channels and np.count_nonzero(quiet) < FEWEST_QUIET:
        return math.nan
    return max((float(np.std(values[quiet])) for values in channels.values()), default=0.0)


def before_filter(reading: ChannelReading, pulse: RecordedPulse) -> SmoothPulse:
    """Return the smooth pulse of a blow as it was before the filter, where it was found then."""
    near = min(reading.unfiltered, key=lambda one: abs(one.time - pulse.time), default=pulse)
    return near.smooth if abs(near.time - pulse.time) <= pulse.end - pulse.begin else pulse.smooth


def measured_figure(
    name: str, value: float, noise: PulseUncertainty, known: BlowUncertainty | None = None
) -> MeasuredFigure:
    """Return a figure with its uncertainty by a budget; without one, with that of noise and baseline alone."""
    if known is None:
        return MeasuredFigure(value, float(getattr(noise, name)))
    return MeasuredFigure(value, known.figures[name].expanded / COVERAGE, whole=True)


def filter_leaves(filter_: Filter, pulse: IdealPulse, step: float) -> float:
    """Return the share of the peak of an ideal pulse that a filter leaves."""
    fine = min(step, FINEST_FILTERED * pulse.duration)
    time = np.arange(-round(pulse.duration / fine), round(2.0 * pulse.duration / fine)) * fine
    return float(np.max(filter_.apply(pulse.at(time), fine))) / pulse.peak


def _counts(shocks: Sequence[JudgedShock], specification: Specification, asked: Asked) -> list[Clause]:
    """Return the clauses of the shocks in each direction; those that pass count."""
    count = specification.count()
    if count is None:
        return []
    several = len({one.reading.channel.name for one in shocks}) > 1
    counted = [
        CountedShock(one.file, one.reading.number, one.reading.channel.name * several, one.direction, one.found.verdict)
        for one in shocks
    ]
    return direction_clauses(counted, [one.direction for one in asked.directions], count)


def _rate(usable: Sequence[tuple[FileReading, ChannelReading]], specification: Specification) -> list[Clause]:
    """Return the clause of the shocks a second: by the median interval within the records."""
    limits = specification.repetition()
    if limits is None:
        return []
    intervals = [gap for _, reading in usable for gap in reading.intervals]
    if not intervals:
        return [not_judged("shocks a second", limits, "Hz", "no record holds two shocks")]
    return [judged("shocks a second", 1.0 / float(np.median(intervals)), limits, "Hz")]


class JudgedSpectrum(NamedTuple):
    """A spectrum with its verdict."""

    name: str
    file: str
    channel: str
    frequency: Array
    values: Array
    clauses: tuple[Clause, ...]

    @property
    def verdict(self) -> str:
        """Verdict of its clauses together."""
        return together(clause.verdict for clause in self.clauses)


def asked_of_spectra(rule: Rule = "simple", strict: bool = False, budget: Budget | None = None) -> Asked:
    """Return how spectra are judged: without a budget uncertainty plays a part in a guarded decision alone."""
    return Asked(rule, strict, budget, from_record=(RECORD, SAMPLING) if rule == "guarded" else ())


@declare.dataclass
class SpectraVerdict:
    """Verdict on spectra, each judged by itself."""

    specification: Specification = declare.part(Specification, "what they are judged by", inline=True)
    limits: SpectrumLimits  # limits that it sets for a spectrum
    asked: Asked = declare.part(Asked, "how", inline=True)
    spectra: tuple[JudgedSpectrum, ...]  # in the order of the files

    @declare.computed(VERDICT)
    def verdict(self) -> str:
        """Verdict on all spectra together."""
        return together(one.verdict for one in self.spectra)

    @declare.computed(BY_INDICATIVE)
    def by_indicative(self) -> bool:
        """True if the verdict rests on a limit that is from memory."""
        return rests_on_indicative(self.clauses, self.verdict)

    @declare.computed(declare.rows(Clause, "clauses of all spectra"))
    def clauses(self) -> list[Clause]:
        """Clauses of all spectra, with file and channel."""
        return [replace(clause, file=one.file, channel=one.channel) for one in self.spectra for clause in one.clauses]
