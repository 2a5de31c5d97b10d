"""Where the values of a file of one's own come from: what was typed or changed there is the user's.

A built-in case states the provenance of every value. A file that begins from one, by its ``source``, is held against
it: a badge or a note that came along with a value is no longer true of another value.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, TypeVar

from pydantic import BaseModel

from strikewave.base.quantities import Value
from strikewave.cases.paths import row_name

T = TypeVar("T")

SAME = 1e-12
"""Relative difference up to which two values are the same: another unit may cost a few bits."""


def with_provenance(part: T, raw: Any, origin: Any = None) -> T:
    """Return a part of a case as read from a file, with the provenance that its values have in truth.

    - A value typed without a provenance is the user's; where it is that of the source, it has the provenance there.
    - A value that differs from the source is the user's, unless the file gives it another provenance or note than the
      source does: then the file speaks of the new value, and is believed. Of a value that became the user's the note of
      the source goes.

    Parameters
    ----------
    part : model, tuple or value
        As validated.
    raw : mapping, list or scalar
        What the file holds there.
    origin : model, tuple or value, optional
        The same part of the built-in case named as source; rows are found by name, else by place.

    Examples
    --------
    >>> from strikewave.cases.tables.sensor import RecorderTable
    >>> text = {"sampling_rate": "200 kHz", "delay": "0 s", "pre_trigger": "10 ms", "memory": 40000}
    >>> with_provenance(RecorderTable.model_validate(text), text).memory.provenance
    'user'
    """
    new: Any = part
    if isinstance(part, Value):
        new = _of_value(part, raw, origin)
    elif isinstance(part, BaseModel) and isinstance(raw, Mapping):
        fields = type(part).model_fields
        found = {key: (entry, fields[key].alias or key) for key, entry in part}
        update = {
            key: with_provenance(entry, raw[name], getattr(origin, key, None))
            for key, (entry, name) in found.items()
            if name in raw
        }
        update = {key: entry for key, entry in update.items() if entry is not found[key][0]}
        new = part.model_copy(update=update) if update else part
    elif isinstance(part, tuple) and isinstance(raw, list) and len(raw) == len(part):
        rows = tuple(map(with_provenance, part, raw, _partners(part, origin)))
        new = part if all(a is b for a, b in zip(rows, part, strict=True)) else rows
    return new


def _of_value(value: Value, raw: Any, origin: Any) -> Value:
    known = isinstance(origin, Value)
    same = known and math.isclose(value.si, origin.si, rel_tol=SAME)
    if not (isinstance(raw, Mapping) and "provenance" in raw):
        return value.model_copy(update={"provenance": origin.provenance if same else "user"})
    if known and not same and (value.provenance, value.note) == (origin.provenance, origin.note):
        return value.model_copy(update={"provenance": "user", "note": ""})
    return value


def _partners(rows: tuple[Any, ...], origin: Any) -> list[Any]:
    """Return for each row of an array that of the source: by its name, else the one at its place that none has."""
    theirs = {row_name(row, place): row for place, row in enumerate(origin)} if isinstance(origin, tuple) else {}
    names = [row_name(row, place) for place, row in enumerate(rows)]
    places = dict(enumerate(theirs))
    free = {place: theirs[name] for place, name in places.items() if name not in names}
    return [theirs.get(name, free.get(place)) for place, name in enumerate(names)]
