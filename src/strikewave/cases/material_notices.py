"""Where a density or a modulus of a case is far from that of any known material: as a rule its unit is wrong."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from strikewave.base.materials import Material, material, materials
from strikewave.base.percents import plain
from strikewave.base.quantities import Value
from strikewave.base.result import Notice
from strikewave.cases.by_path import entries_of, quantities_of
from strikewave.cases.case import Case
from strikewave.cases.named_materials import as_typed

BELOW = 100.0
"""A density or modulus so many times below the least of the table of materials is noticed: foams, gels and aerogels
are up to some hundred times lighter and softer than rubber, the least of it; nothing solid is far beyond that."""
ABOVE = 5.0
"""The same above the greatest of the table: osmium is 1.2 times as dense as tungsten, diamond 3 times as stiff, and a
wave in diamond 3.5 times as fast as in steel."""
FROM_NAMED = 10.0
"""A number of its own that is so many times that of the material that the same part names, or below, is noticed: the
modulus of a metal hardly varies, that of a rubber grows by up to five under a fast load."""
_COLUMNS = {"density": "density", "modulus": "youngs_modulus", "youngs_modulus": "youngs_modulus"}
"""Names of the fields, and of the same in the table of materials."""
_LEAST = {"density": "lightest", "youngs_modulus": "softest"}
_GREATEST = {"density": "densest", "youngs_modulus": "stiffest"}


def material_notices(case: Case) -> Iterator[Notice]:
    """Report each density and modulus of a case that is far from those of all known materials.

    Examples
    --------
    >>> from strikewave import load_case
    >>> case = load_case("li-ma-2019-fig13-bar", ["stack.layer.upper.density=7.82 kg/m^3"])
    >>> [notice.code for notice in material_notices(case)]
    ['material-far']
    """
    return far_numbers((name, getattr(case, name)) for name in case.tables())


def far_numbers(parts: Iterable[tuple[str, Any]]) -> Iterator[Notice]:
    """Report densities and moduli of named tables far from those of any known material, alone or together."""
    values, named = dict[str, Value](), dict[str, Material]()
    for name, part in parts:
        values.update(quantities_of(part, name))
        for path, entry in entries_of(part, name):
            if path.endswith(".material") and str(entry).lower() in _known():
                named[path.removesuffix(".material")] = material(str(entry))
    tables = dict[str, dict[str, Value]]()
    for path, value in values.items():
        table, _, key = path.rpartition(".")
        if key in _COLUMNS:
            tables.setdefault(table, {})[key] = value
    for table, stated in tables.items():
        row = named.get(table) or named.get(table.rpartition(".")[0])
        far = [notice for key, value in stated.items() for notice in _far(f"{table}.{key}", key, value, row)]
        yield from far or _too_fast(table, stated, row)


def _known() -> set[str]:
    return {name.lower() for name in materials()}


def _far(path: str, key: str, value: Value, row: Material | None) -> Iterator[Notice]:
    """Yield the notice on a number that is far from that of its material, or from those of all materials."""
    column = _COLUMNS[key]
    if row is not None:
        usual: float = getattr(row, column)
        if not usual / FROM_NAMED < value.si < usual * FROM_NAMED:
            message = (
                f"{path} = {value.typed} is {_times(value.si / usual)} that of {row.name}, which the same part names "
                f"({as_typed(key, usual)}): look at its unit, or name another material"
            )
            yield Notice("material-far", message, value.si, usual)
        return
    rows = sorted(materials().values(), key=lambda known: float(getattr(known, column)))
    least, greatest = getattr(rows[0], column), getattr(rows[-1], column)
    if value.si < least / BELOW:
        which, name, limit = _LEAST[column], rows[0].name, least
    elif value.si > greatest * ABOVE:
        which, name, limit = _GREATEST[column], rows[-1].name, greatest
    else:
        return
    message = (
        f"{path} = {value.typed} is {_times(value.si / limit)} that of {name}, the {which} known material "
        f"({as_typed(key, limit)}): look at its unit"
    )
    yield Notice("material-far", message, value.si, limit)


def _too_fast(table: str, stated: Mapping[str, Value], row: Material | None) -> Iterator[Notice]:
    """Yield the notice on a density and a modulus that together make a wave faster than in any solid."""
    density, modulus = (
        next((value.si for key, value in stated.items() if _COLUMNS[key] == column), getattr(row, column, None))
        for column in ("density", "youngs_modulus")
    )
    if density is None or modulus is None:
        return
    speed, fastest = (modulus / density) ** 0.5, max(materials().values(), key=lambda known: known.bar_speed)
    if speed > ABOVE * fastest.bar_speed:
        fields = " and ".join(f"{table}.{key} = {value.typed}" for key, value in stated.items())
        message = (
            f"{fields} make a wave of {plain(speed, 4)}\xa0m/s, {_times(speed / fastest.bar_speed)} that in "
            f"{fastest.name}, the fastest known material ({plain(fastest.bar_speed, 4)}\xa0m/s): look at their units"
        )
        yield Notice("material-far", message, speed, fastest.bar_speed)


def _times(ratio: float) -> str:
    """Return a ratio in words.

    Examples
    --------
    >>> _times(250.0), _times(1e-3)
    ('250 times', '1/1000 of')
    """
    return f"{plain(ratio)} times" if ratio >= 1.0 else f"1/{plain(1.0 / ratio)} of"
