"""Sources of a comparison, by name: measured files, campaigns, cases, and results that were kept.

A name is ``PLACE``, ``PLACE#CHANNEL`` for a measured file, or ``PLACE:PART`` for what is simulated, and may end with
``@BLOW``, the number of a blow, or ``@all`` for all of a record, which make a campaign. A place is a measured file, a
pattern or a folder of several (a campaign), a built-in case or a case file, which is run, or the folder (or the NetCDF
file) of a result of run, wave or fem.
"""

from __future__ import annotations

import math
import os
import re
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from strikewave.analyses.compare.agreement import ComparedCurve, checked_curve, mean_curve
from strikewave.base.errors import InputError, StrikewaveError, nearest, show
from strikewave.base.result import Notice
from strikewave.cases.files import bundled_cases
from strikewave.records import Options, Request
from strikewave.records.budget import Budget
from strikewave.records.measured_uncertainty import blow_uncertainty
from strikewave.records.reading import ChannelReading, check_amounts
from strikewave.reporting import measured_files as measured
from strikewave.reporting.terminal import say
from strikewave.signal.alignment import EvenHistory, Shift, by_correlation
from strikewave.signal.filters import Filter
from strikewave.signal.pulse import Pulse
from strikewave.specifications.judged_records import measured_figure, troubles_of

KEPT = ("solution.nc", "waves.nc", "histories.nc")  # files of results of run, wave and fem, one of which a folder holds
ALL = -1  # stands for all blows of a record
BEFORE = 10  # samples before a pulse from which its noise is taken, at least
_BLOW = re.compile(r"(.*)@([1-9]\d{0,5}|all)", re.DOTALL)


class SourceName(NamedTuple):
    """A name taken apart: place, channel or part, blow (0 for none, or `ALL`); ``measured`` where it says a channel."""

    place: str
    part: str = ""
    blow: int = 0
    measured: bool = False


@dataclass(frozen=True)
class SourceOptions:
    """Reading of sources: calibration and options of measured files, low-pass, bands, uncertainty budget."""

    stated: dict[str, dict[str, Any]] = field(default_factory=dict)
    options: Options = field(default_factory=Options)
    low_pass: Filter | None = None
    band: bool = True
    budget: Budget | None = None


def parse_name(word: str) -> SourceName:
    """Take a name apart; what exists under the whole of it is that."""
    if _is_place(word):
        return SourceName(word)
    match = _BLOW.fullmatch(word)
    rest, blow = (match[1], ALL if match[2] == "all" else int(match[2])) if match else (word, 0)
    if _is_place(rest):
        return SourceName(rest, "", blow)
    for mark in ("#", ":"):
        place, separator, part = rest.rpartition(mark)
        if separator and place and (mark == "#" or _is_place(place) or not os.path.dirname(part)):
            return SourceName(place, part.strip(), blow, mark == "#")
    return SourceName(rest, "", blow)


def _is_place(name: str) -> bool:
    return name in bundled_cases() or os.path.lexists(name)


def paths_of(name: SourceName) -> list[Path]:
    """Return the files that a name stands for; none of a built-in case."""
    if name.place in bundled_cases() and not os.path.lexists(name.place):
        return []
    path = Path(name.place)
    if not name.place:
        return []
    if os.path.isdir(path):
        results = [path / file for file in (*KEPT, "case.toml") if (path / file).is_file()]
        listed = [file for file in sorted(_listed(path)) if not file.endswith(".toml")]  # calibrations beside the files
        return results[:1] or [path / file for file in listed if (path / file).is_file()]
    if not os.path.lexists(name.place) and any(mark in name.place for mark in "*?["):
        return [Path(file) for file in measured.ordered([name.place]) if os.path.lexists(file)]
    return [path] if os.path.isfile(path) else []


def read_source(option: str, word: str, reading: SourceOptions, unit: str = "") -> ComparedCurve:
    """Return the history that a name stands for."""
    name = parse_name(word)
    built_in = name.place in bundled_cases() and not os.path.lexists(name.place)
    paths = paths_of(name)
    mark = Path(name.place) / "record.toml"
    if os.path.isfile(mark):
        hint = f"{mark} names the files that it is of: name one of those"
        raise InputError(option, name.place, "a folder of measured files, or of a result of run, wave or fem", hint)
    if not built_in and not paths:
        raise _unknown(option, name)
    if is_simulated(word):
        from strikewave.analyses.compare.simulated import simulated_curve

        if name.measured:
            raise InputError(option, word, "PLACE:PART for what is simulated", f'write "{name.place}:{name.part}"')
        if name.blow == ALL:
            raise InputError(option, word, "@all for a record alone", "name one blow of the simulation, such as @1")
        place = name.place if built_in else str(paths[0])
        curve = simulated_curve(option, place, name.part, name.blow, unit, reading.band)
        return checked_curve(option, curve).filtered(reading.low_pass)
    if name.part and not name.measured:
        raise InputError(option, word, "FILE#CHANNEL for a measured file", f'write "{name.place}#{name.part}"')
    if len(paths) == 1 and name.blow != ALL:
        return _record(option, str(paths[0]), name, reading)[0]
    return _campaign(option, paths, name, reading)


def _unknown(option: str, name: SourceName) -> InputError:
    """Return the error of a name that stands for nothing."""
    if any(mark in name.place for mark in "*?["):
        return InputError(option, name.place, "a pattern that finds files")
    folder = os.path.dirname(name.place)
    beside = [os.path.join(folder, one) for one in _listed(folder or ".")]
    near = nearest(name.place, [*bundled_cases(), *beside])
    if os.path.isdir(name.place):
        return InputError(option, name.place, "a folder that holds a result, or measured files", "it is empty")
    allowed = "a measured file, several by a pattern or a folder, a case, or the folder of its result"
    return InputError(option, name.place, allowed, near if near.startswith("did you mean") else "")


def _listed(folder: str | Path) -> list[str]:
    try:
        return [one for one in os.listdir(folder) if not one.startswith(".")]
    except OSError:
        return []


def _record(
    option: str, file: str, name: SourceName, reading: SourceOptions, of_campaign: bool = False
) -> list[ComparedCurve]:
    """Return one channel of a measured file: one of its blows, or all; one that is bad is refused in a campaign."""
    options = reading.options._replace(channels=(name.part,) if name.part else reading.options.channels[:1])
    try:
        record, found = measured.read_channels(file, reading.stated, options, Request(filter=reading.low_pass))
    except InputError as error:
        if error.field != "--channel" or not name.part:
            raise
        raise InputError(option, f"{Path(file).name}#{name.part}", error.allowed, error.hint) from None
    one = found.channels[0]
    if not options.channels and len(record.channels) > 1 and not of_campaign:
        say(f"{option} is {one.channel.name} of {Path(file).name}; {Path(file).name}#CHANNEL takes another")
    if of_campaign and one.status == "bad":
        raise StrikewaveError("it is bad: " + next(found.message for found in one.findings if found.severity == "bad"))
    blows = range(1, len(one.pulses) + 1) if name.blow == ALL else [name.blow]
    called = f"{Path(file).name}#{one.channel.name}"
    return [_of_channel(option, called, one, blow, reading.budget) for blow in blows or [0]]


def _of_channel(
    option: str, name: str, reading: ChannelReading, blow: int, budget: Budget | None = None
) -> ComparedCurve:
    """Return a channel as a curve."""
    channel = reading.channel
    offset = reading.baseline if reading.pulses else 0.0
    if channel.values.size and not math.isfinite(channel.step):
        raise InputError(option, name, "a file with a time column", "state --rate")
    history = EvenHistory(channel.values - offset, channel.step, channel.start)
    history_curve = checked_curve(option, ComparedCurve(name, "record", history, channel.unit))
    notices = [
        Notice(finding.code, f"{name}: {finding.message}", finding.value)
        for finding in reading.findings
        if finding.severity != "good" and {"peak", "width", "velocity_change"} & set(finding.harms)
    ]
    if not reading.pulses:
        if blow > 1:
            raise InputError(option, f"{name}@{blow}", "a blow that was found", "none was found")
        notices.append(Notice("no-pulse", f"{name}: no blow was found, so no baseline is taken off"))
        return replace(history_curve, notices=tuple(notices))
    if blow > len(reading.pulses):
        raise InputError(option, f"{name}@{blow}", f"a blow from 1 to {len(reading.pulses)}")
    place = blow - 1 if blow else max(range(len(reading.pulses)), key=lambda k: abs(reading.pulses[k].peak))
    pulse, values, time = reading.pulses[place], history_curve.history.values, history_curve.history.time
    begin = 0.5 * (reading.pulses[place - 1].end + pulse.begin) if place else -math.inf
    end = 0.5 * (pulse.end + reading.pulses[place + 1].begin) if place + 1 < len(reading.pulses) else math.inf
    around = (time >= begin) & (time <= end)
    before = values[(time < pulse.begin - pulse.width) & around]
    noise = float(np.std(before)) if before.size >= BEFORE else float(pulse.noise)
    if len(reading.pulses) > 1:
        if not blow:
            say(f"{option} is the largest of {len(reading.pulses)} blows of {name}, @{place + 1}; @N takes another")
        name = f"{name}@{place + 1}"
    shown = EvenHistory(values[around], channel.step, float(time[around][0]), noise)
    figures = Pulse(pulse.time, pulse.peak, pulse.width, pulse.rise, pulse.velocity_change)
    known = None
    if budget is not None:
        check_amounts(budget, reading)
        known = blow_uncertainty(channel, pulse, budget, trials=True)
    keys = {"peak": "peak", "width": "width", "integral": "velocity_change"}
    uncertainty = {key: measured_figure(of, 0.0, pulse.uncertainty, known).uncertainty for key, of in keys.items()}
    curve = ComparedCurve(
        name,
        "record",
        shown,
        channel.unit,
        measured=figures,
        uncertainty=uncertainty,
        budgeted=known is not None,
        troubles=troubles_of(reading.findings),
        notices=tuple(notices),
    )
    return checked_curve(option, curve)


def read_shots(option: str, word: str, reading: SourceOptions) -> tuple[list[ComparedCurve], list[Notice]]:
    """Return every record, or every blow (@all), that a name of measured files stands for, and what was left out."""
    name = parse_name(word)
    paths = paths_of(name)
    if is_simulated(word) or (len(paths) < 2 and name.blow != ALL):
        curve = read_source(option, word, reading)
        if curve.kind == "simulation":
            raise InputError(option, word, "a measured record: this is simulated")
        return [curve], []
    if name.part and not name.measured:
        raise InputError(option, word, "FILE#CHANNEL for a measured file", f'write "{name.place}#{name.part}"')
    return _shots(option, paths, name, reading)


def _shots(
    option: str, paths: Sequence[Path], name: SourceName, reading: SourceOptions
) -> tuple[list[ComparedCurve], list[Notice]]:
    """Return the records of several files, and what was left out."""
    curves: list[ComparedCurve] = []
    left: list[Notice] = []
    for path in paths:
        try:
            curves += _record(option, str(path), name, reading, of_campaign=True)
        except StrikewaveError as error:
            left.append(Notice("left-out", f"{path.name} is left out: {error}"))
    return curves, left


def _campaign(option: str, paths: Sequence[Path], name: SourceName, reading: SourceOptions) -> ComparedCurve:
    """Return the mean of several files, each aligned with that of median peak by correlation, and their deviations."""
    curves, left = _shots(option, paths, name, reading)
    several = "two blows or more" if name.blow == ALL else "two measured files or more"
    if len(curves) < 2:
        raise InputError(option, name.place, f"{several} for a campaign", left[0].message if left else "")
    units = dict.fromkeys(curve.unit for curve in curves)
    if len(units) > 1:
        raise InputError(option, ", ".join(show(unit) for unit in units), "records in one unit")
    curves.sort(key=lambda curve: abs(curve.pulse.peak))
    middle = curves.pop(len(curves) // 2)
    curves.insert(0, middle)
    shifts = [Shift(0.0, 0.0, "")] + [by_correlation(middle.history, each.history) for each in curves[1:]]
    what = "blows" if name.blow == ALL else "records"
    mean = mean_curve(option, f"{len(curves)} {what} of {name.place}", curves, [each.shift for each in shifts])
    return replace(mean, notices=(*mean.notices, *left))


def is_simulated(word: str) -> bool:
    """Tell whether a name stands for a case or for the result of one.

    Examples
    --------
    >>> is_simulated("li-ma-2019:rigid@2"), is_simulated("shot.csv#board")
    (True, False)
    """
    name = parse_name(word)
    if name.place in bundled_cases() and not os.path.lexists(name.place):
        return True
    paths = paths_of(name)
    if len(paths) == 1 and paths[0].suffix.lower() == ".nc" and paths[0].name not in KEPT:
        from strikewave.analyses.compare.simulated import is_solution

        return is_solution(paths[0])
    return bool(paths) and (paths[0].name in KEPT or paths[0].suffix.lower() == ".toml")
