"""``strikewave diff``: what two cases differ in."""

from __future__ import annotations

from typing import Annotated, Any

from strikewave.base import declare
from strikewave.base.declare import KEY, MAIN
from strikewave.base.json_document import head
from strikewave.cases.case import load_case
from strikewave.cases.written_case import document_of
from strikewave.reporting.options.output import Shown
from strikewave.reporting.options.shared import case_name
from strikewave.reporting.terminal import print_json, print_rows, tell


@declare.dataclass
class CaseDifference:
    """A field in which two cases differ."""

    field: str = declare.word("path of a field that differs", column=KEY)
    a: str | None = declare.word("as the first has it; null where it lacks it", label="A", column=MAIN)
    b: str | None = declare.word("as the second has it", label="B", column=MAIN)


@declare.dataclass
class CaseDifferences:
    """What two cases differ in."""

    a: str = declare.word("first case")
    b: str = declare.word("second case")
    differences: list[CaseDifference] = declare.rows(CaseDifference, "fields that differ")


def flat(document: dict[str, Any], prefix: str = "") -> dict[str, str]:
    """Return a case document as path: text.

    Examples
    --------
    >>> flat({"machine": {"speed": {"value": "730 rpm", "provenance": "published"}}})
    {'machine.speed': '730 rpm (published)'}
    """
    rows: dict[str, str] = {}
    for key, value in document.items():
        path = f"{prefix}{key}"
        if isinstance(value, dict) and "value" in value and "provenance" in value:
            rows[path] = f"{value['value']} ({value['provenance']})"
        elif isinstance(value, dict):
            rows |= flat(value, f"{path}.")
        elif isinstance(value, list):
            for place, entry in enumerate(value):
                inner = f"{path}.{place}"
                rows |= flat(entry, f"{inner}.") if isinstance(entry, dict) else {inner: str(entry)}
        else:
            rows[path] = str(value)
    return rows


def command(
    a: Annotated[str, case_name("A", "A case file, or the name of a built-in case.")],
    b: Annotated[str, case_name("B", "Another case to compare with A.")],
    *,
    shown: Shown,
) -> int:
    """List the differences of two cases."""
    from strikewave.reporting.faces import columns_of

    rows = [flat(document_of(load_case(name))) for name in (a, b)]
    paths = [path for path in dict.fromkeys([*rows[0], *rows[1]]) if rows[0].get(path) != rows[1].get(path)]
    found = CaseDifferences(a, b, [CaseDifference(path, *(row.get(path) for row in rows)) for path in paths])
    if shown.json:
        print_json({**head({}), **declare.content(found)})
    elif paths:
        tell(f"{a} (A) and {b} (B) differ in {len(paths)} field{'s' if len(paths) > 1 else ''}.")
        print_rows("Differences", columns_of(CaseDifference, found.differences))
    else:
        tell("the cases are equal")
    return 0
