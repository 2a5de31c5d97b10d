"""[machine] of any kind: the tables of all kinds, found in the folder that holds one module a kind.

A kind of machine is one class, in one module: its table in a case file, how it comes to first touch, its words, its
sources, its drawing. That class needs what stands above this room, and a case needs its table to be read. So this
room knows the folder by its name alone, as it knows the contact laws of installed packages by their entry points: it
imports each module there and takes the class that it registers, and nothing else of it. What a module imports at its
head is therefore read with every case: tables and quantities, never numba; physics is imported where it is used.
"""

from __future__ import annotations

import functools
import importlib
import operator
import pkgutil
from typing import TYPE_CHECKING, Annotated, Any, TypeAlias, get_args

from pydantic import BeforeValidator, Field

from strikewave.base.errors import MISSING, InputError, nearest
from strikewave.cases.tables.machine import LaunchedTable, MachineTable

KINDS_FOLDER = "strikewave.analyses.machine.kinds"
"""The package whose modules are the kinds of machines; adding a module there adds a kind."""
BAR_ALONE = "a bar is no machine: give [[stack.layer]] and [load], and `strikewave wave` runs it"


def _kind_of(table: type[MachineTable]) -> str:
    """Return the kind that a table is of: the one value that its field ``kind`` may have; empty for a base class."""
    named = get_args(table.model_fields["kind"].annotation)
    return str(named[0]) if len(named) == 1 else ""


def _tables_of_folder() -> dict[str, type[MachineTable]]:
    """Return the class of each module of the folder by its kind, machines with a drive first.

    A path that names no kind, such as machine.speed, means the first table that has it: studies are of the drive.

    Raises
    ------
    TypeError
        If a module has not exactly one class of a kind.
    """
    folder = importlib.import_module(KINDS_FOLDER)
    tables: dict[str, type[MachineTable]] = {}
    for entry in pkgutil.iter_modules(folder.__path__):
        module = importlib.import_module(f"{KINDS_FOLDER}.{entry.name}")
        own = [
            item
            for item in vars(module).values()
            if isinstance(item, type) and issubclass(item, MachineTable) and item.__module__ == module.__name__
        ]
        if len(own) != 1 or not _kind_of(own[0]):
            raise TypeError(f"{module.__name__} must have one class of a machine with its kind, got {own}")
        tables[_kind_of(own[0])] = own[0]
    return dict(sorted(tables.items(), key=lambda item: issubclass(item[1], LaunchedTable)))


KINDS = _tables_of_folder()
"""Every kind of machine that there is, and its table."""


def _of_known_kind(raw: Any) -> Any:
    """Refuse a machine of no known kind."""
    if not isinstance(raw, dict) or raw.get("kind") in list(KINDS):
        return raw
    kind = raw.get("kind", MISSING)
    hint = BAR_ALONE if kind == "hopkinson" else "" if kind is MISSING else nearest(str(kind), KINDS)
    raise InputError("kind", kind, "one of " + ", ".join(f"'{known}'" for known in KINDS), hint)


if TYPE_CHECKING:
    AnyMachine: TypeAlias = MachineTable
else:
    _any = functools.reduce(operator.or_, KINDS.values())
    AnyMachine = Annotated[_any, Field(discriminator="kind"), BeforeValidator(_of_known_kind)]
"""[machine] of any kind."""
