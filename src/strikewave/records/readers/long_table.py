"""Long tables: a column says of which channel, or of which measurement, each line is."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from strikewave.base.errors import InputError
from strikewave.base.texts import first_few
from strikewave.records.health_notice import HealthNotice
from strikewave.records.readers import FEWEST_SAMPLES, Options, joined_pieces
from strikewave.records.readers.headings import step_of
from strikewave.records.record import Array, Channel, Record

Lines = NDArray[Any]
"""Places of lines, or whether each is one."""
# More different words are no names of channels: recorders have fewer, and a column of remarks has more
MOST_LABELS = 64
_NUMBERED = r"(?:[ _-]?(?:no\.?|nr\.?|num(?:ber)?|nummer|name|id|index))?"
_OF_CHANNEL = re.compile(
    rf"(?:channel|chan|ch|kanal|sensor|signal|probe|gauge|variable|series|voie|canal|messstelle|position|quantity|"
    rf"measurand){_NUMBERED}|name|id",
    re.IGNORECASE,
)
_SURELY_OF_CHANNEL = re.compile(
    rf"(?:channel|kanal|voie|canal){_NUMBERED}|(?:sensor|signal)[ _-]?(?:no\.?|nr\.?|name|id)", re.IGNORECASE
)
_OF_MEASUREMENT = re.compile(
    rf"(?:shot|run|test|measurement|event|trial|blow|repeat|record|segment|versuch|messung|schuss|schlag|stoss){_NUMBERED}",
    re.IGNORECASE,
)
# Headings of columns that name a channel, surely so, a measurement, or the unit of the line
_OF_UNIT = re.compile(r"units?|einheit(?:en)?|unit(?:e|é)s?|dimension", re.IGNORECASE)


class Labels(NamedTuple):
    """A column of names: its heading, the code of each line (NaN for none), and the word of each code.

    ``are_numbers`` marks whole numbers, which may be samples too.
    """

    heading: str
    codes: Array
    words: Sequence[str]
    are_numbers: bool = False

    @property
    def is_unit(self) -> bool:
        """True if the column gives the unit of each line."""
        return _OF_UNIT.fullmatch(self.heading) is not None

    @property
    def is_channel(self) -> bool:
        """True if the heading says that the column names channels."""
        return _SURELY_OF_CHANNEL.fullmatch(self.heading) is not None

    @property
    def is_measurement(self) -> bool:
        """True if the column counts measurements."""
        return _OF_MEASUREMENT.fullmatch(self.heading) is not None

    def of(self, lines: Lines) -> Labels:
        """Return those of some lines."""
        return self._replace(codes=self.codes[lines])

    def present(self) -> list[int]:
        """Return the codes that lines have, in the order in which they first come."""
        codes, first = np.unique(self.codes[np.isfinite(self.codes)], return_index=True)
        return [int(code) for code in codes[np.argsort(first)]]


def may_count(heading: str, cell: str) -> bool:
    """Tell whether a column of numbers may name channels, by its heading and one cell: most are refused at once."""
    known = any(pattern.fullmatch(heading) for pattern in (_OF_CHANNEL, _OF_MEASUREMENT)) if heading else True
    return known and re.fullmatch(r"[+-]?\d{1,6}(?:\.0*)?", cell) is not None


def may_be_labels(heading: str, cells: Sequence[str], are_numbers: bool) -> bool:
    """Tell whether cells of some lines may name channels: few different ones, each many times."""
    filled = [cell for cell in cells if cell]
    if not are_numbers and filled and _SURELY_OF_CHANNEL.fullmatch(heading):
        return True
    known = any(pattern.fullmatch(heading) for pattern in (_OF_CHANNEL, _OF_MEASUREMENT, _OF_UNIT))
    if 10 * len(filled) < 9 * len(cells) or not filled or (are_numbers and heading and not known):
        return False
    if are_numbers and not all(re.fullmatch(r"[+-]?\d{1,6}(?:\.0*)?", cell) for cell in filled):
        return False
    different = len(set(filled))
    return different <= MOST_LABELS and (known or 4 * different <= len(filled))


def labels_of(heading: str, values: Array) -> Labels:
    """Return a column of whole numbers as labels."""
    numbers = np.unique(values[np.isfinite(values)])
    codes = np.where(np.isfinite(values), np.searchsorted(numbers, values).astype(np.float64), np.nan)
    named = [f"{heading or 'channel'} {number:g}" for number in numbers[: MOST_LABELS + 1]]
    return Labels(heading, codes, named, are_numbers=True)


def as_long_table(record: Record, columns: Sequence[Labels]) -> Record | None:
    """Return the channels, and the measurements, of a long table; None for a table that is none.

    The channels hold the lines of all, over stamps that all share, or over none.
    """
    if not record.channels:
        return None
    stamps, size = record.channels[0].stamps, record.channels[0].values.size
    of_unit = next((column for column in columns if column.is_unit), None)
    rest = [column for column in columns if not column.is_unit]
    shots = next((column for column in rest if column.is_measurement and _part(column, stamps)), None)
    channels = [column for column in rest if not column.is_measurement]
    lines = [np.arange(size)] if shots is None else [np.flatnonzero(shots.codes == code) for code in shots.present()]
    pieces = []
    parted, missing = shots is not None, size - sum(map(len, lines))
    for chosen in lines:
        times = None if stamps is None else stamps[chosen]
        names = next((own for column in channels if _part(own := column.of(chosen), times)), None)
        parted = parted or names is not None
        missing += 0 if names is None else int(np.count_nonzero(np.isnan(names.codes)))
        pieces.append(tuple(_channels(record, chosen, names, None if of_unit is None else of_unit.of(chosen))))
    if not parted:
        return None
    if missing:
        notice = HealthNotice("label-missing", f"{missing} lines name no channel: they are left out", float(missing))
        record = replace(record, findings=(*record.findings, notice))
    return joined_pieces([replace(record, channels=piece) for piece in pieces])


def as_asked(table: Record, options: Options) -> Record:
    """Return the wanted channels of a long table, over the rate that is stated."""
    pieces = []
    for piece in (table, *table.further):
        channels = piece.channels
        if options.rate is not None:
            channels = tuple(replace(one, step=1.0 / options.rate, start=0.0, stamps=None) for one in channels)
        wanted = {channel.name for channel in piece.only(options.channels).channels}
        channels = tuple(
            one if one.name in wanted else replace(one, values=np.broadcast_to(np.float64(np.nan), one.values.shape))
            for one in channels
        )
        message = f"a long table: each line is of one of {first_few([one.name for one in channels], 4)}"
        found = HealthNotice("long-table", message, float(len(channels)), severity="good")
        pieces.append(replace(piece, channels=channels, findings=(*piece.findings, found), further=()))
    return joined_pieces(pieces)


def _part(labels: Labels, stamps: Array | None) -> bool:
    """Tell whether lines are those of different channels, or measurements, by a column of names.

    They are where times stand twice, or begin anew, in all of them and not in those of each name; where they rise in
    all of them, by a heading such as channel, or names that take turns.
    """
    codes = labels.present()
    if not 2 <= len(codes) <= MOST_LABELS:
        return False
    counts = [int(np.count_nonzero(labels.codes == code)) for code in codes]
    if min(counts) < FEWEST_SAMPLES:
        return False
    if stamps is None:
        return labels.is_measurement or labels.is_channel
    rises = [bool(np.all(np.diff(stamps[labels.codes == code]) > 0.0)) for code in codes]
    if not np.all(np.diff(stamps) > 0.0):
        return all(rises) or (labels.is_channel and not labels.are_numbers)
    turns = max(counts) - min(counts) <= 1 and int(np.count_nonzero(np.diff(labels.codes))) >= labels.codes.size - 1
    return not labels.is_measurement and (turns or (labels.is_channel and not labels.are_numbers))


def _channels(record: Record, lines: Lines, names: Labels | None, units: Labels | None) -> Iterator[Channel]:
    """Yield each value of each name as a channel."""
    chosen = [("", lines)]
    if names is not None:
        chosen = [(str(names.words[code]), lines[names.codes == code]) for code in names.present()]
    for word, own in chosen:
        unit = None if units is None else _unit(record, word, units, np.isin(lines, own))
        for channel in record.channels:
            stamps = None if channel.stamps is None else channel.stamps[own]
            step = channel.step if stamps is None else step_of(stamps, 0.0)
            start = channel.start if stamps is None or not stamps.size else float(stamps[0])
            name = word if word and len(record.channels) == 1 else f"{word} {channel.name}".strip()
            values = channel.values[own]
            yield Channel(name, values, step, start, channel.unit if unit is None else unit, stamps)


def _unit(record: Record, word: str, units: Labels, own: Lines) -> str:
    """Return the unit of the lines of one name."""
    present = units.of(own).present()
    if len(present) > 1:
        several = ", ".join(str(units.words[code]) for code in present[:4])
        raise InputError("FILE", Path(record.path), f"one unit for all lines of {word or 'a channel'}", several)
    return str(units.words[present[0]]) if present else ""
