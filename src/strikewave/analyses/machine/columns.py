"""The columns of the tables of blows: where each is shown, in which unit.

A new column is a field of `strikewave.machines.Blow` and a line here.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from operator import attrgetter
from typing import Any, NamedTuple

from strikewave.base.result import Band
from strikewave.machines.blows import Blow
from strikewave.reporting.banded_numbers import table_decimals
from strikewave.reporting.bands import bands_of
from strikewave.reporting.layout import KEY, MAIN, MORE
from strikewave.reporting.parts import Tag
from strikewave.reporting.table_columns import TableColumn


class BlowColumn(NamedTuple):
    """A column of the tables of blows.

    Attributes
    ----------
    name : str
        Field of `Blow`.
    unit : str
        SI unit; "1" where there is none.
    shown : str
        Unit on screen and page.
    decimals : int
        Decimals on screen and page.
    tables : str
        Where it is shown: ``blows``, ``contact``, ``sliding`` (where friction acts across the face), or nowhere.
    document : bool
        Whether the JSON document holds it; blows.csv and the histories hold all.
    priority : int
        On a narrow screen a column of a larger number than `MAIN` is left out, the largest first.
    """

    name: str
    unit: str
    shown: str = ""
    decimals: int = 0
    tables: str = ""
    document: bool = True
    priority: int = MAIN


COLUMNS = (
    BlowColumn("striker", "1", document=False),
    BlowColumn("time", "s", "ms", 3, "blows"),
    BlowColumn("approach_speed", "m/s", "m/s", 3, "blows, contact", priority=MORE),
    BlowColumn("rebound_speed", "m/s", "m/s", 3, "contact", priority=MORE),
    BlowColumn("contact_time", "s", "us", 1, "contact", priority=MORE),
    BlowColumn("restitution", "1", "1", 4, "contact"),
    BlowColumn("indentation", "m", "um", 2, "contact"),
    BlowColumn("residual_indentation", "m", "um", 2, "contact", priority=MORE + 1),
    BlowColumn("contact_stiffness", "N/m", "MN/m", 1, "contact"),
    BlowColumn("flattening", "1", "1", 4, "contact", priority=MORE + 1),
    BlowColumn("side_force", "N", "kN", 2, "sliding"),
    BlowColumn("side_impulse", "N s", "N s", 3, "sliding"),
    BlowColumn("friction_heat", "J", "J", 2, "sliding", priority=MORE),
    BlowColumn("impulse", "N s", "N s", 3, "blows", priority=MORE + 1),
    BlowColumn("contact_impulse", "N s"),
    BlowColumn("support_impulse", "N s", document=False),
    BlowColumn("momentum_error", "1", document=False),
    BlowColumn("peak_force", "N", "kN", 2, "blows", priority=MORE),
    BlowColumn("rigid_peak", "m/s^2", "g", 1, "blows"),
    BlowColumn("width", "s", "us", 1, "blows"),
    BlowColumn("rise", "s", document=False),
    BlowColumn("velocity_change", "m/s", "m/s", 3, "blows"),
    BlowColumn("blow_velocity_change", "m/s"),
    BlowColumn("largest_displacement", "m", "mm", 2, "blows", priority=MORE + 1),
    BlowColumn("turntable_speed", "rad/s", "rad/s", 3, "sliding", priority=MORE),
)

BLOW_SI = {column.name: column.unit for column in COLUMNS if column.name != "striker"}
"""SI unit of each column that holds a quantity; "1" of a ratio."""
BLOW_UNITS = {name: unit for name, unit in BLOW_SI.items() if unit != "1"}
"""SI unit of each column that has one."""
CALLED = {
    "width": "pulse width at 10 %",
    "restitution": "coefficient of restitution",
    "yield_pressure": "largest pressure",
}
"""Head of each column whose name is short for the field's term."""
SENTENCE_DIGITS = {"rigid_peak": 4, "width": 4, "velocity_change": 3, "peak_force": 3}
"""Significant digits of what sentences give too, without a band; a table has as many, so that neither contradicts."""
HIDDEN = frozenset(column.name for column in COLUMNS if not column.document)
"""Columns that the JSON document leaves out."""


def shown_in(table: str) -> list[tuple[str, str, str, int]]:
    """Return name, SI unit, unit shown and decimals of the columns of a table, ``blows``, ``contact`` or ``sliding``.

    Examples
    --------
    >>> shown_in("contact")[1]
    ('rebound_speed', 'm/s', 'm/s', 3)
    """
    return [column[:4] for column in COLUMNS if table in column.tables]


def blow_columns(table: str, bands: Mapping[str, Band] | None = None) -> tuple[TableColumn[Blow], ...]:
    """Return the columns of a table, for screen and page, with the number of the blow; in ``blows`` kind and contacts.

    Examples
    --------
    >>> [column.head for column in blow_columns("contact")][:4]
    ['#', 'approach speed (m/s)', 'rebound speed (m/s)', 'contact time (µs)']
    """
    priorities = [column.priority for column in COLUMNS if table in column.tables]
    number: TableColumn[Blow] = TableColumn("#", lambda blow: str(blow.index), priority=KEY)
    shown = quantity_columns(shown_in(table), priorities, bands)
    if table != "blows":
        return (number, *shown)
    kind: TableColumn[Blow] = TableColumn("kind", lambda blow: Tag(blow.kind, blow.kind), words=True)
    return (number, kind, *shown, TableColumn("contacts", lambda blow: str(blow.contacts), priority=MORE + 2))


def quantity_columns(
    columns: Iterable[tuple[str, str, str, int]], priorities: Iterable[int], bands: Mapping[str, Band] | None = None
) -> list[TableColumn[Any]]:
    """Return the columns of quantities, each a field of the row: name, SI unit, usual unit, decimals.

    Of a quantity with bands there are the decimals that they leave, of another the digits that a sentence has of it.
    """
    made = []
    for (name, si, usual, decimals), priority in zip(columns, priorities, strict=True):
        own = bands_of(bands or {}, name)
        made.append(
            TableColumn[Any](
                CALLED.get(name, name).replace("_", " "),
                attrgetter(name),
                si,
                usual,
                decimals=table_decimals(own, si, usual, decimals),
                priority=priority,
                least_digits=0 if own else SENTENCE_DIGITS.get(name, 0),
            )
        )
    return made
