"""The numbers of the materials named in a case, and densities and moduli far from those of any material.

A layer, a gasket or a pad names its material, and its modulus stands in no field of the case. Here each such number has
a path of its own, ``material.PTFE.modulus``, one for all parts of that material: they are of one grade, and off
together. A number that a part states itself overrules the table, and is not listed.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any, NamedTuple, TypeVar

from strikewave.base.constants import MATERIAL, Material, material, materials
from strikewave.base.quantities import Provenance, Value
from strikewave.base.result import Notice
from strikewave.base.texts import plain
from strikewave.cases.case import Case
from strikewave.cases.paths import entries_of, quantities_of
from strikewave.cases.plausible import PLAUSIBLE, PlausibleRange
from strikewave.cases.tables.contact import CUSHION, CushionTable

T = TypeVar("T")

OF_A_LAYER, OF_A_JOINT = ("density", "modulus"), ("modulus", "loss_factor")
OF_A_GASKET = ("density", "modulus", "loss_factor")
"""Properties that a layer, a gasket between layers, and one under a sensor take from the table of materials."""
_WITHOUT_UNIT = ("loss_factor", "compression_factor")
_PRESSURES = ((1e9, "GPa"), (1e6, "MPa"), (1e3, "kPa"), (1.0, "Pa"))
_COLUMNS = {"modulus": "youngs_modulus"}
"""Names of numbers in the table of materials where they differ from those of a case."""


class NamedNumber(NamedTuple):
    """A number of a named material with its provenance, and the fields of the case that take it.

    ``plausible`` is its range from piece to piece, where nobody can weigh it or read it off.
    """

    value: Value
    fields: tuple[str, ...]
    plausible: PlausibleRange | None = None


def named_numbers(case: Case) -> dict[str, NamedNumber]:
    """Return the numbers of the materials named in a case, by path; a name that no table has is left out.

    Examples
    --------
    >>> from strikewave import load_case
    >>> number = named_numbers(load_case("li-ma-2019-fig5"))["material.PTFE.modulus"]
    >>> number.value.typed, number.value.provenance, number.fields[0]
    ('475 MPa', 'published', 'sensor.buffered.gasket.0.modulus')
    """
    numbers = dict[str, NamedNumber]()
    for path, field, number in _numbers(case):
        before = numbers.get(path, number)
        numbers[path] = before._replace(fields=(*before.fields, field))
    return numbers


def _numbers(case: Case) -> Iterator[tuple[str, str, NamedNumber]]:
    """Yield path, field and number of each, with no fields yet."""
    for layer in case.stack.layer:
        yield from _of_table(layer, f"stack.layer.{layer.name}", OF_A_LAYER)
    for joint in case.stack.joint:
        path = f"stack.joint.{joint.after}"
        if joint.kind == "gasket":
            yield from _of_table(joint, path, OF_A_JOINT)
        if joint.kind == CUSHION and joint.cushion is not None:
            yield from _of_cushion(joint.cushion, f"{path}.cushion")
    if case.contact is not None and case.contact.cushion is not None:
        yield from _of_cushion(case.contact.cushion, "contact.cushion")
    for sensor in case.sensor:
        for place, gasket in enumerate(sensor.gasket):
            yield from _of_table(gasket, f"sensor.{sensor.name}.gasket.{place}", OF_A_GASKET)


def _of_table(table: Any, path: str, keys: tuple[str, ...]) -> Iterator[tuple[str, str, NamedNumber]]:
    """Yield the numbers that a layer or gasket takes from the table of materials."""
    row = _row(table.material, materials())
    for key in keys:
        column = _COLUMNS.get(key, key)
        number = None if row is None else getattr(row, column)
        if row is None or number is None or getattr(table, key) is not None:
            continue
        provenance: Provenance = "assumed" if column in row.from_memory else "published"
        known = "" if row.from_memory and column not in row.from_memory else f" ({row.status})"
        note = f"{row.name} of the table of materials{known}"
        value = Value(si=number, typed=as_typed(key, number), provenance=provenance, note=note)
        yield f"{MATERIAL}.{row.name}.{key}", f"{path}.{key}", NamedNumber(value, (), _plausible(row, key))


def _plausible(row: Material, key: str) -> PlausibleRange | None:
    """Return the range of a number of a material from piece to piece; the modulus of a metal has none."""
    return None if key == "density" or (key == "modulus" and row.kind == "metal") else PLAUSIBLE[f"stack.joint.{key}"]


def _of_cushion(table: CushionTable, path: str) -> Iterator[tuple[str, str, NamedNumber]]:
    """Yield the numbers that a pad takes from the table of cushion materials."""
    from strikewave.contact.cushions import cushion_materials  # the laws are compiled: only where there is a pad

    row = _row(table.material, cushion_materials())
    for key, number in {} if row is None else row.properties.items():
        if row is not None and getattr(table, key) is None:
            note = f"{row.name} of the cushion materials ({row.status})"
            value = Value(si=number, typed=as_typed(key, number), provenance="published", note=note)
            plausible = PLAUSIBLE.get(f"contact.cushion.{key}")
            yield f"{MATERIAL}.{row.name}.{key}", f"{path}.{key}", NamedNumber(value, (), plausible)


def _row(name: str, rows: Mapping[str, T]) -> T | None:
    """Return the row of a name, whatever its case; None where there is none, which the build refuses."""
    return next((row for known, row in rows.items() if known.lower() == name.lower()), None)


def as_typed(key: str, number: float) -> str | float:
    """Return a number as a case file would have it: in the unit in which it is below a thousand.

    Examples
    --------
    >>> as_typed("modulus", 211e9), as_typed("plateau", 70e3), as_typed("density", 7820), as_typed("loss_factor", 0.05)
    ('211 GPa', '70 kPa', '7820 kg/m^3', 0.05)
    """
    if key in _WITHOUT_UNIT:
        return number
    if key == "density":
        return f"{number:.10g} kg/m^3"
    scale, unit = next((row for row in _PRESSURES if number >= row[0]), _PRESSURES[-1])
    return f"{number / scale:.10g} {unit}"


BELOW = 100.0
"""A density or modulus so many times below the least of the table of materials is noticed: foams, gels and aerogels
are up to some hundred times lighter and softer than rubber, the least of it; nothing solid is far beyond that."""
ABOVE = 5.0
"""The same above the greatest of the table: osmium is 1.2 times as dense as tungsten, diamond 3 times as stiff, and a
wave in diamond 3.5 times as fast as in steel."""
FROM_NAMED = 10.0
"""A number of its own that is so many times that of the material that the same part names, or below, is noticed: the
modulus of a metal hardly varies, that of a rubber grows by up to five under a fast load."""
_LIMITED_COLUMNS = {"density": "density", "modulus": "youngs_modulus"}
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
    named, tables = dict[str, Material](), dict[str, dict[str, Value]]()
    known = [name.lower() for name in materials()]
    for name, part in parts:
        for path, value in quantities_of(part, name):
            table, _, key = path.rpartition(".")
            if key in _LIMITED_COLUMNS:
                tables.setdefault(table, {})[key] = value
        for path, entry in entries_of(part, name):
            if path.endswith(".material") and str(entry).lower() in known:
                named[path.removesuffix(".material")] = material(str(entry))
    for table, stated in tables.items():
        row = named.get(table) or named.get(table.rpartition(".")[0])
        far = [notice for key, value in stated.items() for notice in _far(f"{table}.{key}", key, value, row)]
        yield from far or _too_fast(table, stated, row)


def _far(path: str, key: str, value: Value, row: Material | None) -> Iterator[Notice]:
    """Yield the notice on a number that is far from that of its material, or from those of all materials."""
    column = _LIMITED_COLUMNS[key]
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
        next((value.si for key, value in stated.items() if _LIMITED_COLUMNS[key] == column), getattr(row, column, None))
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
