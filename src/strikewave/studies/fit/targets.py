"""Targets of a fit as typed: records and numbers with their settings, and the request.

``shot.csv`` is a record of the usual part, ``PART=shot.csv`` of another one; ``first.rigid_peak=4151 g`` a number, and
so is ``striker.mass=0.459 kg``: what is known of a free field from elsewhere. Behind ``±`` or ``+-`` stands the
standard uncertainty of a number, or by which share the amplitude of such records scatters from shot to shot. Settings
follow after semicolons: ``shot.csv; machine.speed=500 rpm``. ``@FILE`` stands for the lines of a text file.
"""

from __future__ import annotations

import contextlib
import os
import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from strikewave.analyses.compare.agreement import ComparedCurve
from strikewave.analyses.compare.sources import SourceOptions, parse_name, paths_of, read_shots
from strikewave.base.errors import InputError
from strikewave.base.quantities import Range, Value
from strikewave.base.result import Notice
from strikewave.cases.case import Case
from strikewave.cases.files import bundled_cases
from strikewave.reporting.options import read_share
from strikewave.studies.fit.free_fields import FreeField, changed_case, smooth_case
from strikewave.studies.fit.measured import MeasuredNumber, MeasuredPulse, measured_pulse
from strikewave.studies.fit.problem import Experiment
from strikewave.studies.simulation import Simulation, checked_number, number_units, quick_case
from strikewave.studies.study_file import stated_at
from strikewave.uncertainty.draws import range_of
from strikewave.uncertainty.input_ranges import LEAST, MOST, half_a_digit

MOST_RECORDS = 200  # most records of a fit: each of them is read, and aligned at each run
LARGEST_LIST = 1_000_000  # characters of a list of targets that are read: far more than the records of a fit need
PLUS_MINUS = re.compile(r"\s*(?:±|\+-|\+/-)\s*")  # signs between a value and its uncertainty
_BLOW = re.compile(r"(.*)@([1-9]\d{0,5})", re.DOTALL)
_SETTING = re.compile(r"\s*([A-Za-z_][\w.+ -]*)=(.+)", re.DOTALL)


@dataclass(frozen=True)
class Target:
    """Measured record or number, as typed.

    Attributes
    ----------
    left : str
        Name of a number, path of a field, or name of a part; empty for the usual part.
    right : str
        Value of a number, or the name of records.
    changes : tuple of str
        Settings, ``path=value`` each.
    is_number : bool
        True if it is a number.
    scatter : float
        Standard deviation of the amplitude of records from shot to shot, as a share; 0 where it is not stated.
    stated : str
        Table of a file that states it; empty where it was typed.
    """

    left: str
    right: str
    changes: tuple[str, ...] = ()
    is_number: bool = False
    scatter: float = 0.0
    stated: str = field(default="", repr=False, compare=False)


def parse_targets(words: Sequence[str | Target], case: Case) -> list[Target]:
    """Return targets taken apart, with those of the lines of ``@FILE``; see `target_words` and `parse_target`."""
    parsed = []
    for word in words:
        parsed += [word] if isinstance(word, Target) else [parse_target(one, case) for one in target_words([word])]
    return parsed


def target_words(words: Sequence[str]) -> list[str]:
    """Return targets as typed, ``@FILE`` replaced by its lines; empty lines and comments are left out."""
    found = list[str]()
    for word in words:
        if not word.startswith("@"):
            found.append(word)
            continue
        try:
            with open(word[1:], encoding="utf-8") as file:
                lines = file.read(LARGEST_LIST).splitlines()
        except (OSError, ValueError):
            raise InputError("--to", word, "@FILE, a text file with a target a line") from None
        found += [line.strip() for line in lines if line.strip() and not line.strip().startswith("#")]
    return found


def parse_target(word: str, case: Case) -> Target:
    """Take a target apart; a file that is called so is a record."""
    first, *rest = (part.strip() for part in word.split(";")) if not os.path.lexists(word) else (word,)
    for change in rest:
        if not _SETTING.fullmatch(change):
            raise InputError("--to", change, "path=value behind a semicolon", "such as machine.speed=500 rpm")
    left, equals, right = (part.strip() for part in first.partition("="))
    if not equals or _is_place(first):
        return _records("", first, tuple(rest))
    if left.split(" ")[0] in number_units(case) or left in case.values():
        return Target(left, right, tuple(rest), is_number=True)
    if not _is_place(PLUS_MINUS.split(right)[0]) and re.match(r"[-+.\d]", right):
        checked_number(case, left)
    return _records(left, right, tuple(rest))


def _records(part: str, word: str, changes: tuple[str, ...]) -> Target:
    """Return a target of records, with the scatter of their amplitude where it is stated."""
    name, *scatter = PLUS_MINUS.split(word, maxsplit=1) if not os.path.lexists(word) else [word]
    share = read_share(scatter[0].strip(), f"--to {name}") if scatter else 0.0
    return Target(part, name, changes, scatter=share)


def _is_place(word: str) -> bool:
    place = parse_name(word).place
    return place in bundled_cases() or os.path.lexists(place)


def published_targets(case: Case) -> list[Target]:
    """Return the published numbers of a case to which its fitted values were fitted, with which a fit begins again."""
    wanted = [entry for entry in case.published if entry.role == "fitted"]
    return [
        Target(f"{entry.quantity} {entry.sensor}".strip(), str(entry.value.typed), is_number=True) for entry in wanted
    ]


def read_number(case: Case, target: Target) -> MeasuredNumber:
    """Return a number with its standard uncertainty; without one, half its last digit, 1 % at least, 10 % at most."""
    name, sensor, allowed, of_field = _named(case, target)
    typed, *uncertain = PLUS_MINUS.split(target.right, maxsplit=1)
    option = f"--to {target.left}"
    value = _read(typed, allowed, option)
    if value.si == 0.0:
        raise InputError(option, typed, "a number that is not 0", "its uncertainty is a share of it")
    if value.si < 0.0 and allowed.unit == "s":
        raise InputError(option, typed, "a time above 0")
    share = min(max(LEAST, half_a_digit(value.typed)), MOST)
    size = share * abs(value.si)
    if uncertain:
        word = uncertain[0].strip()
        size = (
            read_share(word, option) * abs(value.si)
            if word.endswith("%")
            else _read(word, Range(allowed.unit), option).si
        )
        if not size > 0.0:
            raise InputError(option, word, "a standard uncertainty above 0, such as 2 %")
    return MeasuredNumber(name, sensor, allowed.unit, value.si, size, typed, ", ".join(target.changes), of_field)


def _named(case: Case, target: Target) -> tuple[str, str, Range, bool]:
    """Return name and sensor of a number, what it may be, and whether it is that of a field."""
    if target.left not in case.values():
        name, sensor, unit = checked_number(case, target.left)
        return name, sensor, Range(unit), False
    if target.changes:
        words = f"{target.left} without settings: a value of the case holds at all of them"
        raise InputError("--to", "; ".join(target.changes), words)
    return target.left, "", range_of(case, target.left), True


def _read(word: str, allowed: Range, field: str) -> Value:
    try:
        return allowed.read(word)
    except InputError as error:
        raise error.at(field) from None


@dataclass(frozen=True, eq=False)
class ReadTargets:
    """Targets that were read: experiments, what was left out, and the files."""

    experiments: tuple[Experiment, ...]
    notices: tuple[Notice, ...]
    paths: tuple[Path, ...]

    @property
    def pulses(self) -> list[MeasuredPulse]:
        """The records."""
        return [datum for test in self.experiments for datum in test.measured if isinstance(datum, MeasuredPulse)]


def read_targets(
    option: str, case: Case, targets: Sequence[Target], fields: Sequence[FreeField], reading: SourceOptions
) -> ReadTargets:
    """Read what was measured; targets of the same settings make one experiment."""
    grouped: dict[tuple[str, ...], list[Target]] = {}
    for target in targets:
        grouped.setdefault(target.changes, []).append(target)
    read = [_read_setting(option, case, members, fields, reading) for members in grouped.values()]
    notices = dict.fromkeys(notice for one in read for notice in one.notices)
    paths = dict.fromkeys(path for one in read for path in one.paths)
    return ReadTargets(tuple(test for one in read for test in one.experiments), tuple(notices), tuple(paths))


def _read_setting(
    option: str, case: Case, targets: Sequence[Target], fields: Sequence[FreeField], reading: SourceOptions
) -> ReadTargets:
    """Read what was measured at one setting."""
    changes = targets[0].changes
    with stated_at(targets[0].stated):
        changed = changed_case(case, changes)
        for free in fields:
            if changed.values().get(free.path) != case.values()[free.path]:
                raise InputError(option, "; ".join(changes), f"settings that leave {free.path} free: it is fitted")
    numbers, records = list[MeasuredNumber](), list[tuple[Target, ComparedCurve]]()
    notices, paths = list[Notice](), list[Path]()
    for target in targets:
        with stated_at(target.stated):
            if target.is_number:
                numbers.append(read_number(changed, target))
                _check_free(option, numbers[-1], fields)
                continue
            curves, left = read_shots(option, target.right, reading)
        records += [(target, curve) for curve in curves]
        notices += [*left, *(notice for curve in curves for notice in curve.notices)]
        paths += paths_of(parse_name(target.right))
    if len(records) > MOST_RECORDS:
        raise InputError(option, f"{len(records)} records", f"at most {MOST_RECORDS}")
    quick = quick_case(changed, _blows(numbers, [_part(one.left)[1] for one, _ in records]))
    quick = smooth_case(quick, [free.path for free in fields])
    run, pulses = Simulation(quick), list[MeasuredPulse]()
    for one, curve in records:
        with stated_at(one.stated):
            shot, low_pass = _shot(one, curve), reading.low_pass
            pulses.append(measured_pulse(curve, run, *_part(one.left), low_pass, shot, one.scatter))
    return ReadTargets((Experiment(quick, changes, (*numbers, *pulses)),), tuple(notices), tuple(paths))


def _check_free(option: str, number: MeasuredNumber, fields: Sequence[FreeField]) -> None:
    """Refuse a number of a field that is not free: nothing would change it."""
    if number.of_field and number.name not in [field.path for field in fields]:
        raise InputError(option, number.name, "a number of the run, or a free field", f"--free {number.name}")


def _shot(target: Target, curve: ComparedCurve) -> str:
    """Return the file and blow that a record is of, whatever its channel."""
    channel, blow = _part(curve.name)
    return f"{os.path.dirname(parse_name(target.right).place)}/{channel.rpartition('#')[0]}@{blow}"


def _part(left: str) -> tuple[str, int]:
    """Return part and blow of the run."""
    found = _BLOW.fullmatch(left)
    return (found[1], int(found[2])) if found else (left, 0)


def _blows(numbers: Sequence[MeasuredNumber], blows: Sequence[int]) -> int:
    """Return after how many blows a run may end; 0 where all of them count."""
    if any(not number.name.startswith("first.") for number in numbers if not number.of_field):
        return 0
    return max([*blows, 1])


@dataclass(frozen=True)
class FitRequest:
    """Request of a fit.

    Attributes
    ----------
    to, check_on : tuple of (str or Target)
        Records and numbers that are fitted to, and that are kept out, as typed or taken apart.
    free : tuple of str
        Free fields, ``path`` or ``path=low..high``.
    tries : str
        Choices that are fitted each.
    reading : SourceOptions
        Options for reading records.
    bayes : bool
        True if the posterior is sampled.
    file : str
        The file that states all this; empty where it was typed.
    """

    to: tuple[str | Target, ...] = ()
    free: tuple[str, ...] = ()
    tries: str = ""
    check_on: tuple[str | Target, ...] = ()
    reading: SourceOptions = field(default_factory=SourceOptions)
    bayes: bool = False
    file: str = ""

    def stated(self, table: str) -> contextlib.AbstractContextManager[None]:
        """Return the context in which an error names a table of the file, if there is one."""
        return stated_at(f"{self.file}: {table}" if self.file else "")
