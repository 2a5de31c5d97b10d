"""Tables, columns and key numbers of a result, made of what its fields declare: see `strikewave.base.declare`."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from strikewave.base.declare import KEY, MORE, NO_UNIT, Declaration, GivenUnits, Quantity, declarations
from strikewave.base.result import Band, Result
from strikewave.base.texts import first_few
from strikewave.reporting.bands import table_decimals, with_band
from strikewave.reporting.columns import Column, page_table
from strikewave.reporting.numbers import (
    FEWEST_DIGITS,
    LEAST_SHARE,
    decimals_of,
    fixed,
    share_with_error,
    shown,
    shown_unit,
    spelled,
)
from strikewave.reporting.parts import NONE, Cell, Table, Tag, written

if TYPE_CHECKING:
    from numpy.typing import NDArray

MOST_LISTED = 5  # a row stays one line; documents have all
"""Values of a history that a cell lists, such as the openings of a joint."""
PERCENT = "%"
LEAST_WORDS = f"< {100.0 * LEAST_SHARE:.0e}".replace("e-0", "e-")
"""Text in place of a share below `LEAST_SHARE`, in per cent: rounding of the runs makes it."""
BOUNDS = "95 % bounds"
"""Head of a column of bounds."""
Path = tuple[str, ...]
Bands = Mapping[str, Sequence[Band]]
"""Bands by what declarations call them: of a row, or of all rows of a column."""


@dataclass(frozen=True)
class FaceRow:
    """A row of a table of a result: its name, what it shows, which is of a declared class, its bands."""

    name: str
    value: Any
    bands: Bands = field(default_factory=dict)


def label_of(name: str, one: Declaration) -> str:
    """Return the label of a field on faces."""
    return one.label or one.quantity.label or name.replace("_", " ")


def leaves(kind: type, path: Path = ()) -> Iterator[tuple[Path, Declaration]]:
    """Yield the values of a class that are no rows, with the way to them; those of its parts too.

    The label of a part follows theirs: "peak, LS-DYNA".
    """
    for name, one in declarations(kind).items():
        if one.kind == "part" and one.of is not None:
            for place, leaf in leaves(one.of, (*path, name)):
                if one.label:
                    headline = leaf.headline and f"{leaf.headline}, {one.label}"
                    leaf = replace(leaf, label=f"{label_of(place[-1], leaf)}, {one.label}", headline=headline)
                yield place, leaf
        elif one.of is None:
            yield (*path, name), one


def at(value: Any, path: Path) -> Any:
    """Return the value at the end of a way; None where one on it is missing."""
    for name in path:
        value = value.get(name) if isinstance(value, Mapping) else getattr(value, name, None)
    return value


def columns_of(
    kind: type,
    rows: Sequence[Any],
    table: str = "",
    bands: Bands | None = None,
    least: int | None = None,
    given: GivenUnits = MappingProxyType({}),
) -> list[Column]:
    """Return the columns of rows of a declared class for screen, page, notebook and app.

    Parameters
    ----------
    kind : type
        Class of the rows.
    rows : sequence
        Rows of that class; a dash stands for what is missing.
    table : str, optional
        Name of the table of such rows, where there are several.
    bands : mapping, optional
        Bands of whole columns: they leave all cells of one as many decimals.
    least : int, optional
        Columns of a priority above this are left out.
    given : mapping, optional
        Units of numbers whose unit the data decide, where all rows have one: `Result.given_units`. Where they have
        not, each cell has its unit beside it.
    """
    return _columns(kind, [(row, bands or {}) for row in rows], table, least, given)


def _columns(
    kind: type, rows: Sequence[tuple[Any, Bands]], table: str, least: int | None, given: GivenUnits
) -> list[Column]:
    """Return columns of rows: each a value of the class, and its bands."""
    by_order: dict[int, list[tuple[Path, Declaration]]] = {}
    for path, one in leaves(kind):
        is_shown = one.column is not None and (least is None or one.column <= least)
        if is_shown and table in ("", *one.tables.split()):
            by_order.setdefault(one.order, []).append((path, one))
    columns: list[Column] = []
    has_bounds = False
    for path, one in [pair for order in sorted(by_order) for pair in by_order[order]]:
        label, quantity, priority = label_of(path[-1], one), one.quantity.within(given), one.column or KEY
        words = one.kind == "word" and not (quantity.si or quantity.given_by)
        has_own_units = one.kind == "number" and bool(quantity.given_by) and quantity.given_by not in given
        cells: list[float | str | Tag | None] = []
        for row, bands in rows:
            value, error = at(row, path), at(row, (*path[:-1], one.error)) if one.error else None
            if error is not None and LEAST_SHARE < error < math.inf:
                cells.append(share_with_error(value, error).removesuffix(f" {PERCENT}"))
            elif has_own_units:
                cells.append(own_unit_cell(one, value, row))
            else:
                cells.append(cell_of(one, value, bands.get(one.band, ()), label, given))
        column = Column.of(label, cells, quantity)
        columns.append(column._replace(digits=quantity.digits, priority=priority, words=words))
        if one.bounds:
            name = f"{BOUNDS} of the {label}" if has_bounds else BOUNDS
            bounds = Column.of(name, [_bounds_cell(one, path, row, given) for row, _ in rows], quantity)
            columns.append(bounds._replace(priority=priority + has_bounds))
            has_bounds = True
    return columns


def _bounds_cell(one: Declaration, path: Path, row: Any, given: GivenUnits) -> str | None:
    """Return the bounds of a number of a row, without their unit; None where one is missing."""
    quantity = one.quantity.within({**given, **getattr(row, "given_units", {})})
    ends = [cell_of(replace(one, quantity=quantity), at(row, (*path[:-1], name))) for name in one.bounds.split()]
    shown_ends = Column.of("", ends, quantity)._replace(digits=quantity.digits).texts()
    return None if NONE in shown_ends else " to ".join(shown_ends)


def own_unit_cell(one: Declaration, value: Any, row: Any) -> str | None:
    """Return a number with its unit, which is that of its row."""
    if value is None or value != value:
        return None
    given = getattr(row, "given_units", {})
    text = _with_unit(one, value, None, given, one.quantity.digits)
    return text if one.quantity.given_by in given else f"{text} (no unit)"


def cell_of(
    one: Declaration, value: Any, bands: Sequence[Band] = (), label: str = "", given: GivenUnits = MappingProxyType({})
) -> float | str | Tag | None:
    """Return the cell of a value, as its declaration writes it."""
    si, usual, _, decimals, digits, _, signed = one.quantity.within(given)
    if value is None or isinstance(value, str | Tag):
        return Tag(value, value) if one.is_tag and value and isinstance(value, str) else value or None
    if isinstance(value, bool):
        if one.is_tag:
            return Tag("yes", "good") if value else Tag("no", "bad")
        return Tag(label, "bad") if value else Tag("no")
    if one.kind in ("word", "count"):
        return ", ".join(map(str, value)) or None if isinstance(value, list | tuple) else str(value)
    if one.kind == "history":
        return first_few([written(shown(float(each), si, usual), 5) for each in value], MOST_LISTED) or NONE
    if math.isinf(value):
        return None
    if decimals is None and usual == PERCENT and 0.0 < abs(value) < LEAST_SHARE:
        return LEAST_WORDS
    if decimals is None and not bands:
        return float(value)
    if bands:
        return fixed(value, si, usual, table_decimals(bands, si, usual, *(() if decimals is None else (decimals,))))
    plus = "+" if signed and value >= 0.0 else ""
    return plus + fixed(value, si, usual, decimals_of(value, si, usual, decimals or 0, digits))


def bands_below(bands: Mapping[str, Band], firsts: Iterable[str]) -> dict[str, list[Band]]:
    """Return bands by the rest of their names, of those whose names begin with one of the first parts."""
    found: dict[str, list[Band]] = {}
    for first in firsts:
        for name, band in bands.items():
            if name.startswith(f"{first}."):
                found.setdefault(name.removeprefix(f"{first}."), []).append(band)
    return found


def face_rows(result: Result, name: str) -> list[FaceRow]:
    """Return the rows that a result has under a name, or its parts by their names, or one part, with their bands."""
    one, value = declarations(type(result))[name], getattr(result, name)
    listed = value if one.kind != "part" else [] if value is None else [value]
    rows = []
    for row in value.items() if one.kind == "named" else listed:
        called, row = row if one.kind == "named" else (getattr(row, "name", ""), row)
        bands = bands_below(result.band, [first.format(name=called) for first in one.band.split()])
        further = getattr(row, "further_bands", None)
        rows.append(FaceRow(called, row, {**bands, **(further(bands) if further else {})}))
    return rows


def face_columns(
    result: Result, name: str, table: str = "", least: int | None = None, rows: Sequence[FaceRow] | None = None
) -> list[Column]:
    """Return the columns of such rows, or of some of them, as `columns_of` does; named parts begin with their name."""
    one = declarations(type(result))[name]
    assert one.of is not None
    rows = face_rows(result, name) if rows is None else rows
    called = [Column(label_of(name, one), [row.name for row in rows], shown="", priority=KEY, words=True)]
    columns = _columns(one.of, [(row.value, row.bands) for row in rows], table, least, result.given_units)
    return called * (one.kind == "named") + columns


def numbers_of(value: Any, bands: Bands) -> list[tuple[str, str]]:
    """Return the numbers of a declared value that have a column, each as text with its unit; none that is missing."""
    columns = columns_of(type(value), [value], bands=bands)
    kept = [one for one in columns if one.si and one.values[0] is not None]
    return [(one.texts()[0], shown_unit(one.si, one.shown or "")) for one in kept]


def face_table(result: Result, name: str, table: str = "", caption: str = "", empty: str = Table.empty) -> Table:
    """Return such rows as a table of a page, under their meaning or another caption; ``empty`` where there are none."""
    caption = caption or capitalized(declarations(type(result))[name].meaning)
    return page_table(caption, face_columns(result, name, table), empty)


def part_tables(result: Result, name: str, caption: str = "") -> list[Table]:
    """Return the numbers of a part as a table, a line each; no table where there is no part."""
    one, value = declarations(type(result))[name], getattr(result, name)
    if value is None or one.of is None:
        return []
    caption = caption or capitalized(one.meaning)
    return [line_table(value, "", caption, label_of(name, one), result.given_units, one.of)]


def line_table(
    value: Any, table: str, caption: str, head: str, given: GivenUnits = MappingProxyType({}), kind: type | None = None
) -> Table:
    """Return the numbers of a declared value and its parts in one of their tables, a line each; none that is missing.

    ``kind`` is its class, where it is a dictionary.
    """
    columns = columns_of(kind or type(value), [value], table, given=given)
    lines: list[list[Cell]] = [[one.head, *one.cells()] for one in columns if one.values[0] is not None]
    return Table(caption, [head, "value"], lines)


def capitalized(text: str) -> str:
    """Return a text that begins with a capital.

    Examples
    --------
    >>> capitalized("pulse width")
    'Pulse width'
    """
    return text[:1].upper() + text[1:]


def data_columns(result: Result, name: str) -> list[Column]:
    """Return such rows as columns in SI for Python, CSV and workbooks: every single value, and those of named parts.

    A table is its columns. Words of a column that no document has are for faces alone, and what is a list in a row is
    no column.
    """
    one = declarations(type(result))[name]
    if one.kind == "table":
        return list(getattr(result, name))
    rows = [row.value for row in face_rows(result, name)]
    assert one.of is not None
    columns = [Column("name", [row.name for row in face_rows(result, name)])] if one.kind == "named" else []
    for path, leaf in leaves(one.of):
        values = [at(row, path) for row in rows]
        is_data = leaf.kind != "history" and (leaf.in_document or leaf.kind != "word" or leaf.column is None)
        if is_data and not (leaf.optional and all(value is None for value in values)):
            columns.append(Column(".".join(_keys(one.of, path)), values, leaf.quantity.within(result.given_units).si))
    columns = [one for one in columns if not any(isinstance(value, list | tuple | dict) for value in one.values)]
    columns += [
        Column(f"{called} {field}", values, leaf.quantity.within(result.given_units).si)
        for called, field, leaf, values in _of_named_parts(one.of, rows)
        if leaf.column is not None
    ]
    return columns


def _keys(kind: type, path: Path) -> list[str]:
    """Return the keys on the way to a value, as the document has them."""
    keys = []
    for name in path:
        one = declarations(kind)[name]
        keys += [] if one.inline else [one.key or name]
        kind = one.of or kind
    return keys


def _named(kind: type, path: Path = ()) -> Iterator[tuple[Path, type]]:
    """Yield the way to parts by their names within rows of a class, and the class of the parts."""
    for name, one in declarations(kind).items():
        if one.kind == "named" and one.of is not None:
            yield (*path, name), one.of
        elif one.kind == "part" and one.of is not None:
            yield from _named(one.of, (*path, name))


def _of_named_parts(kind: type, rows: Sequence[Any]) -> Iterator[tuple[str, str, Declaration, list[Any]]]:
    """Yield each value of parts by their names within rows, such as sensors: part, field, declaration, all values."""
    for path, of_part in _named(kind):
        parts = [at(row, path) or {} for row in rows]
        for called in dict.fromkeys(name for by_name in parts for name in by_name):
            for inner, leaf in leaves(of_part):
                yield called, inner[-1], leaf, [at(by_name.get(called), inner) for by_name in parts]


def key_numbers(result: Result) -> list[tuple[str, str]]:
    """Return the key numbers of a result, each with its label: of rows as their declaration says."""
    numbers = []
    for name, one in declarations(type(result)).items():
        if one.of is None and one.headline:
            value = getattr(result, name)
            if value is not None:
                text = _with_unit(one, value, result.band.get(one.band), result.given_units)
                numbers.append((one.headline, text))
        elif one.headline == "count":
            numbers.append((label_of(name, one), str(len(getattr(result, name)))))
        elif one.headline and one.of is not None:
            most = int(one.headline) if one.headline.isdecimal() else 1 if one.headline == "first" else None
            for row in face_rows(result, name)[:most]:
                for path, leaf in leaves(one.of):
                    value = at(row.value, path)
                    if leaf.headline and value is not None:
                        label = leaf.headline.format(name=row.name)
                        given = {**result.given_units, **getattr(row.value, "given_units", {})}
                        band = next(iter(row.bands.get(leaf.band, ())), None)
                        numbers.append((label, _with_unit(leaf, value, band, given)))
    return numbers


def text_of(value: Any, name: str, given: GivenUnits = MappingProxyType({})) -> str:
    """Return a field of a declared value for a sentence, with its unit, as its key number has it."""
    return _with_unit(declarations(type(value))[name], getattr(value, name), None, given)


def cell_text(value: Any, name: str, given: GivenUnits = MappingProxyType({})) -> str:
    """Return a field of a declared value with the digits of a table, and its unit behind it."""
    one, held = declarations(type(value))[name], getattr(value, name)
    quantity = one.quantity.within(given)
    if held is None or not math.isfinite(held):
        return NONE
    cell = cell_of(one, held, given=given)
    number = cell if isinstance(cell, str) else written(shown(held, quantity.si, quantity.usual), quantity.digits)
    unit = shown_unit(quantity.si, quantity.usual)
    return number if unit in ("", NO_UNIT) else f"{number} {spelled(unit)}"


def amount(quantity: Quantity, value: float | None, band: Band | None = None, digits: int = 0) -> str:
    """Return a number for a sentence, with its unit, in the digits of its quantity, or of its band with that.

    A sentence that needs other digits than tables have gives its own.

    Examples
    --------
    >>> amount(Quantity("1", "%", digits=3), 0.01234), amount(Quantity("m/s^2", "g"), 9806.65)
    ('1.23 %', '1000 g')
    >>> amount(Quantity("Hz", "kHz"), 12345.0), amount(Quantity("Hz", "kHz"), 12345.0, digits=3)
    ('12.35 kHz', '12.3 kHz')
    """
    own = quantity._replace(decimals=None, digits=digits) if digits else quantity
    return _with_unit(Declaration(kind="number", meaning="", quantity=own), value, band, {}, digits or FEWEST_DIGITS)


def _with_unit(
    one: Declaration, value: Any, band: Band | None, given: GivenUnits, most_digits: int = FEWEST_DIGITS
) -> str:
    if one.kind == "number":
        if value is not None and math.isinf(value):
            return NONE
        quantity = one.quantity.within(given)
        as_in_tables = quantity.decimals is not None and (quantity.signed or quantity.usual == PERCENT)
        if as_in_tables and band is None and value is not None and value == value:
            return f"{cell_of(one, value, given=given)} {spelled(shown_unit(quantity.si, quantity.usual))}"
        if quantity.usual == PERCENT and value is not None and 0.0 < abs(value) < LEAST_SHARE:
            return f"{LEAST_WORDS} {PERCENT}"
        digits = min(quantity.digits or FEWEST_DIGITS, most_digits)  # a sentence has no more than four
        return with_band(value, band, quantity.si or NO_UNIT, quantity.usual or NO_UNIT, digits)
    return written(value)


def shown_rows(
    result: Result, name: str, table: str = "", most: int | None = None, is_history: bool = False
) -> tuple[list[str], list[list[str]]]:
    """Return heads and cells of such rows, or of a table, as notebooks and the app show them.

    Parts by their names within a row, such as its sensors, have a column for each number that has a key number.
    """
    one = declarations(type(result))[name]
    if one.kind == "table":
        return heads_and_cells(getattr(result, name), most, is_history)
    rows = face_rows(result, name)[:most]
    columns = face_columns(result, name, table, least=MORE, rows=rows)
    columns += [
        Column.of(f"{called} {label_of(field, leaf)}", values, leaf.quantity)
        for called, field, leaf, values in _of_named_parts(one.of or type(None), [row.value for row in rows])
        if leaf.headline
    ]
    return heads_and_cells(columns)


def heads_and_cells(
    columns: Sequence[Column], most: int | None = None, is_history: bool = False
) -> tuple[list[str], list[list[str]]]:
    """Return heads and cells of the columns that faces show: the first rows, of a history as many spread over it.

    Examples
    --------
    >>> heads_and_cells([Column("peak", [9806.65, None], "m/s^2", shown="g"), Column("kept", [1.0, 2.0])])
    (['peak (g)'], [['1000'], ['–']])
    """
    kept = [one for one in columns if one.shown is not None]
    some = (_spread(one.values, most) if is_history and most is not None else one.values[:most] for one in kept)
    cells = (one._replace(values=values).texts() for one, values in zip(kept, some, strict=True))
    return [one.head for one in kept], [list(row) for row in zip(*cells, strict=True)]


def _spread(values: Sequence[Any] | NDArray[Any], most: int) -> list[Any]:
    """Return at most so many values, from the first to the last in equal steps."""
    count = len(values)
    places = range(count) if count <= most else [round(k * (count - 1) / (most - 1)) for k in range(most)]
    return [values[place] for place in places]
