"""The unit in which a quantity is shown stands where the quantity is declared, and nowhere else."""

import ast
import re
from itertools import pairwise
from pathlib import Path

import pytest

import strikewave
from strikewave.base.units import DIMENSIONS, convertible

PACKAGE = Path(strikewave.__file__).parent
SOURCES = sorted(path.relative_to(PACKAGE).as_posix() for path in PACKAGE.rglob("*.py"))
DECLARED_BY = ("Quantity", "history")
"""What declares a quantity: `Quantity`, and the field of a history, `declare.history`."""
TABLES = (
    "base/units.py", "base/declare.py", "reporting/numbers.py", "records/readers/headings.py",
    "records/readers/recorders.py", "studies/search/machine.py",
)  # fmt: skip
"""Modules that know units themselves: how they convert, what is offered, which one suits a size, which ones files have and
cases are written in."""
PICTURES = ("reporting/style.py", "analyses/layered_bars.py", "web/charts.py")
"""Modules that draw, beside those in `figures`: an axis may say its own units."""


def is_text(node):
    return isinstance(node, ast.Constant) and isinstance(node.value, str)


def is_pair(si, unit):
    """Whether two texts are an SI unit and one that it is shown in, if only itself; the second may be a choice."""
    if isinstance(unit, ast.IfExp):
        return is_pair(si, unit.body) or is_pair(si, unit.orelse)
    if not (is_text(si) and is_text(unit)) or si.value not in DIMENSIONS:
        return False
    ratio = si.value == "1" and unit.value in ("1", "%")
    return ratio or (not unit.value.isdecimal() and convertible(unit.value, (si.value,)) is not None)


def pairs_in(text):
    """Return the lines that type an SI unit with the unit that it is shown in, beside it, by a keyword, by a key."""
    found = []
    for node in ast.walk(ast.parse(text)):
        if not isinstance(node, ast.Call | ast.Dict | ast.Tuple | ast.List | ast.Set):
            continue
        beside = node.args if isinstance(node, ast.Call) else getattr(node, "elts", [])
        if (
            isinstance(node, ast.Call)
            and (getattr(node.func, "attr", "") or getattr(node.func, "id", "")) in DECLARED_BY
        ):
            continue
        named = [one.value for one in getattr(node, "keywords", []) if one.arg in ("shown", "usual")]
        items = zip(node.keys, node.values, strict=True) if isinstance(node, ast.Dict) else ()
        together = [*items, *pairwise(beside), *((si, unit) for si in beside for unit in named)]
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
        ('shown(time, "s", "us" if time < 1e-3 else "ms")', True),
        ('SHOWN = {"m/s^2": "g"}', True),
        ('Quantity("N", "kN", digits=3)', False),
        ('declare.history("s", "when", usual="us")', False),
        ('headed("peak", *FORCE.units)', False),
        ('quantity("time", forces, "N", "contact force")', False),
        ('set_xticks([1, 2], ["1", "2"])', False),
        ('INTEGRALS = {"m/s^2": "m/s"}', False),
        ('letters = ["m", "n", "s"]', False),
    ],
)
def test_a_pair_of_units_is_found_where_it_is_typed(text, is_one):
    assert bool(pairs_in(text)) is is_one
    assert not is_one or BESIDE.search(text) or NAMED.search(text)


def is_drawn(path):
    return path in PICTURES or any(part in ("figures", "figures.py", "animation") for part in path.split("/"))


QUOTED = rf"""["'](?:{"|".join(map(re.escape, DIMENSIONS))})["']"""
BESIDE, NAMED = re.compile(rf"""{QUOTED}\s*[,:][(\s]*["']"""), re.compile(rf"{QUOTED}[^;]*?\b(shown|usual)=")
"""What stands in every module that types a pair: parsing each of them takes seconds."""


def test_no_module_but_those_that_draw_types_the_unit_of_a_quantity():
    texts = {path: (PACKAGE / path).read_text("utf-8") for path in SOURCES if path not in TABLES and not is_drawn(path)}
    assert len(texts) > 200
    likely = [path for path, text in texts.items() if BESIDE.search(text) or NAMED.search(text)]
    typed = {path: lines for path in likely if (lines := pairs_in(texts[path]))}
    assert not typed, "take these from a Quantity: path and lines"


TABLE_OF_UNITS = re.compile(r"dict\([^\n]*\.units\b|\.si: \w+\.usual|\.units for ")
"""What gives SI units their usual ones out of quantities."""


def test_the_usual_unit_of_a_number_that_the_data_decide_stands_in_one_table():
    tables = [path for path in SOURCES if TABLE_OF_UNITS.search((PACKAGE / path).read_text("utf-8"))]
    assert tables == ["base/shock_quantities.py"]


FACES = (
    "screen.py",
    "report.py",
    "chapter.py",
    "chapters.py",
    "words.py",
    "sentences.py",
    "_tables.py",
    "machine/result.py",
)
"""Ends of the names of modules that word what is shown: their sentences take units from quantities."""
TYPED = re.compile(r'f"[^"\n]*\{[^}\n]*\} (?:g|kN|N|us|µs|ms|m/s|mm|MPa|GPa|Hz|kHz)\b')
"""A number of a sentence with its unit typed behind it."""
FIXED = {
    "analyses/compare/report.py": 1,  # the sampling that a standard prescribes
    "studies/buffer/report.py": 1,  # of a notice, which documents hold too
}


def test_no_sentence_of_a_face_types_the_unit_of_its_number():
    faces = [path for path in SOURCES if path.endswith(FACES)]
    typed = {path: TYPED.findall((PACKAGE / path).read_text("utf-8")) for path in faces}
    assert {path: lines for path, lines in typed.items() if len(lines) != FIXED.get(path, 0)} == {}
