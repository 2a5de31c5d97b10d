"""Which shocks are in which direction, as only the user knows, and how many a specification asks for in each."""

from __future__ import annotations

import fnmatch
import math
from collections.abc import Iterator, Sequence
from collections.abc import Set as AbstractSet
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

from strikewave.base.errors import InputError, nearest
from strikewave.base.texts import first_few
from strikewave.specifications.judging import CANNOT_TELL, FAIL, PASS, Clause, Limits, judged, not_judged
from strikewave.specifications.reading import ShockCount

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
    for one in stated:
        if any(direction_fits(one.place, path, keys) for path, channels in files for keys in channels or [set()]):
            continue
        of_files = [channels for path, channels in files for part, _ in _split(one.place) if _file_fits(part, path)]
        if of_files:
            names = {key for channels in of_files for keys in channels for key in keys}
            channel = one.place.rpartition("#")[2]
            raise InputError(
                one.option, one.word, "name or number of a channel of these files", nearest(channel, names)
            )
        part = one.place.partition("#")[0] or one.place
        names = {Path(path).name for path, _ in files}
        raise InputError(one.option, one.word, "a pattern that fits one of the files", nearest(part, names))


def direction_clauses(shocks: Sequence[CountedShock], directions: Sequence[str], count: ShockCount) -> list[Clause]:
    """Return the clauses of the shocks in each direction: those that pass count.

    A shock that can not be judged, or whose direction is not stated, may be one of those that lack: it fails no count.
    """
    limits = Limits(count.low, count.high, count.status)
    if not directions:
        return [not_judged("shocks by direction", limits, "1", "no direction is stated (--direction)")]
    found: list[Clause] = []
    stated = [one for one in DIRECTIONS if one in directions]
    loose = [one for one in shocks if not one.direction]
    for direction in stated:
        here = [one for one in shocks if one.direction == direction]
        passed, possible = _blows(here, (PASS,)), _blows(here, (PASS, CANNOT_TELL))
        possible += _blows(loose, (PASS, CANNOT_TELL))
        clause = judged(f"shocks in {direction}", float(passed), limits, "1")
        if clause.verdict == FAIL:
            every = _blows(here, (PASS, CANNOT_TELL, FAIL))
            verdict = CANNOT_TELL if passed < limits.low <= possible else FAIL
            without = f", and {_of_files(loose)} no direction" if loose and verdict == CANNOT_TELL else ""
            reason = f"{passed} of {every} shocks pass{without}; {_asked_for(limits)}"
            clause = replace(clause, verdict=verdict, reason=reason)
        found.append(clause)
    if loose:
        reason = f"{_of_files(loose)} no direction, and count in none (--direction, or --cross-axis for what is across)"
        found.append(not_judged("shocks without a direction", Limits(0.0, 0.0, count.status), "1", reason))
    across = judged("directions", float(len(stated)), Limits(count.directions, math.inf, count.status), "1")
    if across.verdict == FAIL:
        lacking = [one for one in DIRECTIONS if one not in stated]
        across = replace(across, verdict=CANNOT_TELL if loose else FAIL, reason=f"not stated: {', '.join(lacking)}")
    return [*found, across]


def _of_files(shocks: Sequence[CountedShock]) -> str:
    """Say which files shocks are of."""
    names = list(dict.fromkeys(", ".join(filter(None, (Path(one.file).name, one.name))) for one in shocks))
    return f"{first_few(names, MOST_NAMED, '; ')} ha{'ve' if len(names) > 1 else 's'}"


def _blows(shocks: Sequence[CountedShock], verdicts: Sequence[str]) -> int:
    """Return how many blows have one of the verdicts: of channels that recorded the same blows, the fewest."""
    counts: dict[str, dict[int, int]] = {}
    for one in shocks:
        channels = counts.setdefault(one.file, {})
        channels[one.channel] = channels.get(one.channel, 0) + (one.verdict in verdicts)
    return sum(min(channels.values()) for channels in counts.values())


def _asked_for(limits: Limits) -> str:
    return f"{limits.low:g} are asked for" if math.isinf(limits.high) else f"{limits.low:g} to {limits.high:g} are"
