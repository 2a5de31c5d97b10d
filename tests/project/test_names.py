"""A name of a class serves one class: a reader who meets it need not ask which one is meant."""

import re
from collections import defaultdict
from pathlib import Path

SOURCE = Path(__file__).parents[2] / "src" / "strikewave"


def test_a_class_name_serves_one_class():
    places = defaultdict(list)
    for path in SOURCE.rglob("*.py"):
        for name in re.findall(r"^ *class (\w+)\s*[(\[:]", path.read_text("utf-8"), re.MULTILINE):
            places[name].append(str(path.relative_to(SOURCE)))
    assert len(places) > 500
    assert {name: files for name, files in places.items() if len(files) > 1} == {}
