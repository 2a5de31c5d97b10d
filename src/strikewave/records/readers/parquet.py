"""Parquet: the flat numeric columns of a table."""

from __future__ import annotations

import importlib
from pathlib import Path
from typing import Any

import numpy as np

from strikewave.records.readers import Options
from strikewave.records.readers.common import ArrayColumn, assemble, check_count, floats, grid_of, left_out, text
from strikewave.records.readers.long_table import MOST_LABELS
from strikewave.records.record import Record

_BATCH = 2**18
"""Rows loaded at a time: 2 MB a column."""
_LONGEST_VALUE = 200
"""Bytes of metadata that are read: units are short, and pandas keeps its whole schema there."""


def sniff(head: bytes) -> bool:
    """Return whether a file begins like Parquet."""
    return head[:4] == b"PAR1"


def read(path: Path, options: Options) -> Record:
    """Read the numeric columns of a Parquet file, one at a time."""
    arrow, parquet = importlib.import_module("pyarrow"), importlib.import_module("pyarrow.parquet")
    with parquet.ParquetFile(path, memory_map=True) as file:
        check_count(path, file.metadata.num_columns)
        rows, schema = file.metadata.num_rows, file.schema_arrow
        columns, skipped = [], []
        for field in schema:
            if _numeric(arrow.types, field.type):
                named = _decoded(field.metadata)
                unit = named.get("units", named.get("unit", ""))
                columns.append(ArrayColumn(field.name, rows, _loader(file, field.name, rows), unit))
            elif _words(arrow.types, field.type) and (words := _words_of(file, field.name)):
                columns.append(ArrayColumn(field.name, rows, _coded(file, field.name, words), words=tuple(words)))
            else:
                skipped.append(field.name)
        grid = grid_of(_decoded(schema.metadata).items())
        return assemble(path, "parquet", columns, options, grid, left_out(skipped))


def _numeric(types: Any, kind: Any) -> bool:
    tests = (types.is_integer, types.is_floating, types.is_boolean, types.is_timestamp, types.is_duration)
    return any(test(kind) for test in tests)


def _words(types: Any, kind: Any) -> bool:
    kind = kind.value_type if types.is_dictionary(kind) else kind
    return bool(types.is_string(kind) or types.is_large_string(kind))


def _words_of(file: Any, name: str) -> dict[str, int]:
    """Return the different words of a column; none where there are more than names of channels."""
    words: dict[str, int] = {}
    for batch in file.iter_batches(_BATCH, columns=[name], use_threads=False):
        for word in batch.column(0).unique().to_pylist():
            if word and word not in words:
                words[word] = len(words)
        if len(words) > MOST_LABELS:
            return {}
    return words


def _coded(file: Any, name: str, words: dict[str, int]) -> Any:
    """Return the function that loads the places of the words of a column."""

    def load() -> Any:
        parts = [np.empty(0)]
        for batch in file.iter_batches(_BATCH, columns=[name], use_threads=False):
            parts.append(np.array([words.get(word, np.nan) for word in batch.column(0).to_pylist()], dtype=np.float64))
        return np.concatenate(parts)

    return load


def _decoded(metadata: dict[bytes, bytes] | None) -> dict[str, str]:
    return {text(name).lower(): text(value) for name, value in (metadata or {}).items() if len(value) < _LONGEST_VALUE}


def _loader(file: Any, name: str, rows: int) -> Any:
    """Return the function that loads one column, part by part."""

    def load() -> Any:
        out, at = np.empty(rows), 0
        parts = []
        for batch in file.iter_batches(_BATCH, columns=[name], use_threads=False):
            values = batch.column(0).to_numpy(zero_copy_only=False)
            if values.dtype.kind in "mM":
                parts.append(values)
                continue
            out[at : at + len(values)] = values
            at += len(values)
        if parts:
            return floats(np.concatenate(parts))
        return out[:at]

    return load
