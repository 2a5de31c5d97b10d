"""Tables with named columns: the sheets of an Excel workbook, and the flat numeric columns of Parquet."""

from __future__ import annotations

import importlib
import itertools
import math
import warnings
import zipfile
from array import array
from collections.abc import Container, Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

from strikewave.records.readers import Options, common
from strikewave.records.readers.columns import MOST_WORDS, Marks
from strikewave.records.readers.headings import is_unit, name_and_unit, names_a_setting, settings_of
from strikewave.records.readers.long_table import MOST_LABELS
from strikewave.records.record import Record

MOST_ROWS = 2**20  # rows that Excel itself can hold
MOST_CELLS = 20_000_000  # a workbook with more cells is refused; reading them would take minutes
# A column with fewer numbers, beside columns of twice as many and more, holds settings: no blow has so few samples
FEWEST_NUMBERS = 16
MOST_SHEETS = 100  # sheets of a workbook that are read: a hundred blows, one a sheet
LONGEST_CELL = 100  # characters of a cell of the head in which a setting is looked for
# Rows before the first row of numbers that are kept: names and units stand in the last two, settings above them
LONGEST_HEAD = 200


def sniff_excel(head: bytes) -> bool:
    """Return whether a file begins like an Office document."""
    return head[:4] == b"PK\x03\x04" and any(
        word in head for word in (b"[Content_Types].xml", b"_rels/", b"docProps/", b"xl/")
    )


def read_excel(path: Path, options: Options) -> Record:
    """Read the columns of numbers of a workbook; names and units come from the rows above them."""
    openpyxl = common.extra("openpyxl", path)
    try:
        with zipfile.ZipFile(path) as packed:
            common.guard(path, float(sum(entry.file_size for entry in packed.infolist())))
    except zipfile.BadZipFile as error:
        raise common.damaged(path, str(error)) from None
    with path.open("rb") as opened, warnings.catch_warnings():
        warnings.filterwarnings("ignore", module="openpyxl")
        book = openpyxl.load_workbook(opened, read_only=True, data_only=True, keep_links=False)
        try:
            columns: list[common.ArrayColumn] = []
            left = MOST_CELLS
            sheets = book.worksheets[:MOST_SHEETS]
            for sheet in sheets:
                sheet.reset_dimensions()
                sheet_columns, cells = _columns(path, sheet.iter_rows(values_only=True), left)
                left -= cells
                place = f"{sheet.title}/" if len(sheets) > 1 else ""
                columns += [entry._replace(name=place + entry.name, folder=place) for entry in sheet_columns]
            skipped = [entry.name for entry in columns if entry.size == 0]
            columns, settings = _without_settings(columns)
            skipped += settings
            return common.assemble(path, "excel", columns, options, findings=common.left_out(skipped))
        finally:
            book.close()


def _columns(path: Path, rows: Iterable[tuple[Any, ...]], left: int) -> tuple[list[common.ArrayColumn], int]:
    """Return the columns of a sheet and how many cells it has; those of words behind those of numbers."""
    numbers_at: dict[int, array[float]] = {}
    codes_at: dict[int, array[float]] = {}
    words_at: dict[int, dict[str, int]] = {}
    counted = _Counted(path, rows, left)
    above, lines = _begin(counted)
    for count, row in enumerate(lines):
        for place in {*numbers_at, *codes_at}.union(range(len(row))):
            cell = row[place] if place < len(row) else None
            code = math.nan
            if isinstance(cell, str) and cell.strip():
                codes_of = words_at.setdefault(place, {})
                if cell.strip() in codes_of or len(codes_of) < MOST_WORDS:
                    code = float(codes_of.setdefault(cell.strip(), len(codes_of)))
            for known, value in ((numbers_at, _number(cell)), (codes_at, code)):
                if place not in known:
                    if math.isnan(value):
                        continue
                    known[place] = array("d", [math.nan]) * count
                known[place].append(value)
    names = _names(above, max(*numbers_at, *codes_at, -1, -1) + 1, numbers_at)
    texts = ["\t".join("" if cell is None else str(cell)[:LONGEST_CELL] for cell in row) for row in above]
    own = settings_of(texts, Marks("\t"), len(names), sorted(numbers_at))
    columns = []
    for place, numbers in sorted(numbers_at.items()):
        values = np.frombuffer(numbers, np.float64)
        (name, unit) = names[place]
        step, start, origin = own.steps.get(place, math.nan), own.starts.get(place, math.nan), own.origins.get(place)
        name = own.names.get(place) or name or f"column {place + 1}"
        unit = unit or own.units.get(place, "")
        columns.append(common.ArrayColumn(name, values.size, _loader(values), unit, step, start, origin=origin))
    columns = _trimmed(columns)
    last = max((column.size for column in columns), default=0)
    for place, coded in codes_at.items():
        codes = np.frombuffer(coded, np.float64)[:last]
        if place not in numbers_at and codes.size == last and 2 * np.count_nonzero(~np.isnan(codes)) > last:
            columns.append(common.ArrayColumn(names[place][0], last, _loader(codes), words=tuple(words_at[place])))
    return columns, counted.cells


class _Counted:
    """The rows of a sheet, counted and refused where they are too many."""

    def __init__(self, path: Path, rows: Iterable[tuple[Any, ...]], left: int) -> None:
        self.path, self.rows, self.left, self.cells = path, rows, left, 0

    def __iter__(self) -> Iterator[tuple[Any, ...]]:
        for k, row in enumerate(self.rows):
            self.cells += len(row) + 1
            if k >= MOST_ROWS or self.cells > self.left:
                raise common.damaged(self.path, f"a sheet has more than {k} rows", "a workbook of fewer cells")
            yield row


def _begin(rows: Iterable[tuple[Any, ...]]) -> tuple[list[tuple[Any, ...]], Iterator[tuple[Any, ...]]]:
    """Part the head of a sheet from its lines.

    A row of numbers behind a name, such as ``delta t``, is one of the head, unless the name comes again: then it names
    the channel of each line.
    """
    above: list[tuple[Any, ...]] = []
    waiting: list[tuple[Any, ...]] = []
    left = iter(rows)
    for row in left:
        is_named = bool(row) and isinstance(row[0], str) and row[0].strip()[:1].isalpha()
        if not _numeric(row):
            above, waiting = [*above, *waiting, row][-LONGEST_HEAD:], []
        elif not is_named:
            return [*above, *waiting], itertools.chain([row], left)
        else:
            names = [other[0] for other in waiting]
            waiting.append(row)
            if row[0] in names or len(waiting) > LONGEST_HEAD:
                first = names.index(row[0]) if row[0] in names else 0
                return [*above, *waiting[:first]], itertools.chain(waiting[first:], left)
    return above, iter(waiting)


def _without_settings(columns: list[common.ArrayColumn]) -> tuple[list[common.ArrayColumn], list[str]]:
    """Part columns of samples from those with fewer numbers than a blow needs samples, beside long ones."""
    counts = [int(np.count_nonzero(~np.isnan(column.load()))) for column in columns]
    long = {column.folder for column, count in zip(columns, counts, strict=True) if count >= 2 * FEWEST_NUMBERS}
    few = [count < FEWEST_NUMBERS and c.folder in long for c, count in zip(columns, counts, strict=True)]
    settings = [column.name for column, is_few in zip(columns, few, strict=True) if is_few and column.size]
    return [column for column, is_few in zip(columns, few, strict=True) if not is_few], settings


def _loader(values: Any) -> Any:
    return lambda: values


def _trimmed(columns: list[common.ArrayColumn]) -> list[common.ArrayColumn]:
    """Leave out the rows below the last number of any column."""
    last = max((int(np.flatnonzero(~np.isnan(column.load()))[-1]) + 1 for column in columns), default=0)
    return [column._replace(size=last, load=_loader(column.load()[:last])) for column in columns]


def _numeric(row: tuple[Any, ...]) -> bool:
    """Return whether most of what stands in a row is numbers."""
    filled = [value for value in row if value is not None]
    numbers = sum(not math.isnan(_number(value)) for value in filled)
    return numbers > 0 and 2 * numbers >= len(filled)


def _number(value: object) -> float:
    if isinstance(value, int | float):
        try:
            return float(value)
        except OverflowError:
            return math.nan
    return math.nan


def _names(above: list[tuple[Any, ...]], width: int, places: Container[int]) -> list[tuple[str, str]]:
    """Return name and unit of each column: of the last row of text, or of two where the last holds units only."""
    plain = [row for row in above if all(cell is None or isinstance(cell, str) for cell in row)]
    rows = [[common.text(row[k]) if k < len(row) else "" for k in range(width)] for row in plain]
    rows = [row for row in rows if not row or not names_a_setting(row[0])]
    rows = [row for row in rows if any(row)]
    last = rows[-1] if rows else [""] * width
    units = [word.strip("[]() ") if k in places else "" for k, word in enumerate(last)]
    if len(rows) > 1 and any(units) and all(is_unit(unit) for unit in units if unit):
        return [(name_and_unit(name)[0], unit) for name, unit in zip(rows[-2], units, strict=True)]
    return [name_and_unit(name) for name in last]


_BATCH = 2**18  # rows loaded at a time: 2 MB a column
_LONGEST_VALUE = 200  # bytes of metadata that are read: units are short, and pandas keeps its whole schema there


def sniff_parquet(head: bytes) -> bool:
    """Return whether a file begins like Parquet."""
    return head[:4] == b"PAR1"


def read_parquet(path: Path, options: Options) -> Record:
    """Read the numeric columns of a Parquet file, one at a time."""
    arrow, parquet = importlib.import_module("pyarrow"), importlib.import_module("pyarrow.parquet")
    with parquet.ParquetFile(path, memory_map=True) as file:
        common.check_count(path, file.metadata.num_columns)
        rows, schema = file.metadata.num_rows, file.schema_arrow
        columns, skipped = [], []
        for field in schema:
            if _holds_numbers(arrow.types, field.type):
                named = _decoded(field.metadata)
                unit = named.get("units", named.get("unit", ""))
                columns.append(common.ArrayColumn(field.name, rows, _batch_loader(file, field.name, rows), unit))
            elif _words(arrow.types, field.type) and (codes_of := _words_of(file, field.name)):
                columns.append(
                    common.ArrayColumn(field.name, rows, _coded(file, field.name, codes_of), words=tuple(codes_of))
                )
            else:
                skipped.append(field.name)
        grid = common.grid_of(_decoded(schema.metadata).items())
        return common.assemble(path, "parquet", columns, options, grid, common.left_out(skipped))


def _holds_numbers(types: Any, kind: Any) -> bool:
    tests = (types.is_integer, types.is_floating, types.is_boolean, types.is_timestamp, types.is_duration)
    return any(test(kind) for test in tests)


def _words(types: Any, kind: Any) -> bool:
    kind = kind.value_type if types.is_dictionary(kind) else kind
    return bool(types.is_string(kind) or types.is_large_string(kind))


def _words_of(file: Any, name: str) -> dict[str, int]:
    """Return the different words of a column; none where there are more than names of channels."""
    codes_of: dict[str, int] = {}
    for batch in file.iter_batches(_BATCH, columns=[name], use_threads=False):
        for word in batch.column(0).unique().to_pylist():
            if word and word not in codes_of:
                codes_of[word] = len(codes_of)
        if len(codes_of) > MOST_LABELS:
            return {}
    return codes_of


def _coded(file: Any, name: str, codes_of: dict[str, int]) -> Any:
    """Return the function that loads the places of the words of a column."""

    def load() -> Any:
        parts = [np.empty(0)]
        for batch in file.iter_batches(_BATCH, columns=[name], use_threads=False):
            parts.append(
                np.array([codes_of.get(word, np.nan) for word in batch.column(0).to_pylist()], dtype=np.float64)
            )
        return np.concatenate(parts)

    return load


def _decoded(metadata: dict[bytes, bytes] | None) -> dict[str, str]:
    return {
        common.text(name).lower(): common.text(value)
        for name, value in (metadata or {}).items()
        if len(value) < _LONGEST_VALUE
    }


def _batch_loader(file: Any, name: str, rows: int) -> Any:
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
            return common.floats(np.concatenate(parts))
        return out[:at]

    return load
