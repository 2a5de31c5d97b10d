"""What `strikewave new` says of a field: every field that a built-in case has, and nothing that is no field."""

import functools
import itertools
import re

import pytest

from strikewave.cases.case import FORM, comment_lines, dump_case, explanations, load_case, own_case
from strikewave.cases.files import bundled_cases

HEAD = ("schema", "name", "title", "source")


@pytest.mark.parametrize("name", bundled_cases())
def test_every_line_of_a_new_file_is_explained(name):
    """Each key has a comment above it, and each value says why it is taken: in its note, or in the comment."""
    case = own_case(load_case(name), "mine", name)
    comments = functools.partial(comment_lines, kind=case.machine.kind if case.machine else "")
    lines = dump_case(case, comments).split("[[fit]]")[0].splitlines()
    keys = [k for k, line in enumerate(lines) if re.match(r"\w+ = ", line) and line.split(" = ")[0] not in HEAD]
    assert len(keys) >= 20
    for k in keys:
        assert lines[k - 1].startswith("# "), lines[k]
        begin = next(row for row in range(k - 1, -1, -1) if not lines[row].startswith("#"))
        comment = " ".join(line.removeprefix("# ") for line in lines[begin + 1 : k])
        assert "How to get it: " in comment, lines[k]
        assert "Taken here: " in comment or re.search(r'note = "(?!tolerance)', lines[k]), lines[k]


def test_every_explanation_is_of_a_field():
    """A table may be an array: then a name stands after it for its row."""
    for path, words in explanations().items():
        *tables, key = path.split(".")
        ways = itertools.product(*([[table], [table, "a row"]] for table in tables))
        assert any(key in FORM.keys_at(list(itertools.chain(*way))) for way in ways), path
        assert all(words), path
