"""A name of a class serves one class: a reader who meets it need not ask which one is meant."""

import ast
from collections import defaultdict
from pathlib import Path

SOURCE = Path(__file__).parents[2] / "src" / "strikewave"


def test_a_class_name_serves_one_class():
    places = defaultdict(list)
    for path in SOURCE.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            if isinstance(node, ast.ClassDef):
                places[node.name].append(str(path.relative_to(SOURCE)))
    assert len(places) > 500
    assert {name: files for name, files in places.items() if len(files) > 1} == {}
