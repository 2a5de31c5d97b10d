"""The unit in which a quantity is shown stands where the quantity is declared, and nowhere else."""

import ast
from itertools import pairwise
from pathlib import Path

import pytest

import strikewave
from strikewave.base.units import DIMENSIONS, convertible

PACKAGE = Path(strikewave.__file__).parent
SOURCES = sorted(path.relative_to(PACKAGE).as_posix() for path in PACKAGE.rglob("*.py"))
DECLARED_BY = ("Quantity", "history")
"""What declares a quantity: `Quantity`, and the field of a history, `declare.history`."""
TABLES = ("base/units.py", "base/declare.py", "reporting/shown_units.py", "records/readers/clock.py")
"""Modules that know units themselves: how they convert, what is offered, which ones files have."""
PICTURES = ("reporting/curves.py", "reporting/wave_curves.py", "reporting/wave_field.py", "web/charts.py")
"""Modules that draw, beside those in `figures`: an axis may say its own units."""
NOT_YET = ("studies/scatter/",)
"""Folders whose sentences still type units. This list only shrinks."""


def is_text(node):
    return isinstance(node, ast.Constant) and isinstance(node.value, str)


def is_pair(si, unit):
    """Whether two texts are an SI unit and one that it is shown in, if only itself."""
    if not (is_text(si) and is_text(unit)) or si.value not in DIMENSIONS:
        return False
    ratio = si.value == "1" and unit.value in ("1", "%")
    return ratio or (not unit.value.isdecimal() and convertible(unit.value, (si.value,)) is not None)


def pairs_in(text):
    """Return the lines that type an SI unit with the unit that it is shown in, beside each other or by a keyword."""
    found = []
    for node in ast.walk(ast.parse(text)):
        beside = node.args if isinstance(node, ast.Call) else getattr(node, "elts", [])
        if isinstance(node, ast.Call) and ast.unparse(node.func).rpartition(".")[2] in DECLARED_BY:
            continue
        named = [one.value for one in getattr(node, "keywords", []) if one.arg in ("shown", "usual")]
        together = [*pairwise(beside), *((si, unit) for si in beside for unit in named)]
        found += [si.lineno for si, unit in together if is_pair(si, unit)]
    return found


@pytest.mark.parametrize(
    ("text", "is_one"),
    [
        ('with_unit(peak, "m/s^2", "g")', True),
        ("f\"within {shown(time, 's', 'us')} µs\"", True),
        ('headed("restitution", "1", "1")', True),
        ('Column("time", times, "s", shown="us")', True),
        ('kinds = ("width", "s", "us")', True),
        ('Quantity("N", "kN", digits=3)', False),
        ('declare.history("s", "when", usual="us")', False),
        ('headed("peak", *FORCE.units)', False),
        ('quantity("time", forces, "N", "contact force")', False),
        ('set_xticks([1, 2], ["1", "2"])', False),
        ('letters = ["m", "n", "s"]', False),
    ],
)
def test_a_pair_of_units_is_found_where_it_is_typed(text, is_one):
    assert bool(pairs_in(text)) is is_one


def is_drawn(path):
    return path in PICTURES or any(part in ("figures", "figures.py", "animation") for part in path.split("/"))


@pytest.mark.parametrize("path", [path for path in SOURCES if path not in TABLES and not is_drawn(path)])
def test_no_module_but_those_that_draw_types_the_unit_of_a_quantity(path):
    typed = pairs_in((PACKAGE / path).read_text("utf-8"))
    assert path.startswith(NOT_YET) or not typed, f"take these from a Quantity: lines {typed}"


def test_folders_that_still_type_units_are_those_on_the_list():
    for folder in NOT_YET:
        texts = [(PACKAGE / path).read_text("utf-8") for path in SOURCES if path.startswith(folder)]
        assert any(pairs_in(text) for text in texts), f"{folder} is through: take it from the list"
