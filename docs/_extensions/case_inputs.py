"""The directive `case-inputs`: every value of the built-in cases by provenance, a section a case."""

from typing import Any

from docutils import nodes
from docutils.parsers.rst import Directive
from page_parts import link, section, table

from strikewave import Case, load_case
from strikewave.base.quantities import PROVENANCES, Value
from strikewave.cases.files import bundled_cases


def by_provenance(case: Case) -> dict[str, dict[str, Value]]:
    """Return the values of a case by path, those of each provenance together."""
    values = case.values().items()
    return {word: {path: one for path, one in values if one.provenance == word} for word in PROVENANCES}


class CaseInputs(Directive):
    """How many values of each case have which provenance; then all of them."""

    def run(self) -> list[nodes.Node]:
        """Return the tables."""
        cases = {name: load_case(name) for name in bundled_cases()}
        values = {name: by_provenance(case) for name, case in cases.items()}
        used = [word for word in PROVENANCES if any(found[word] for found in values.values())]
        counts = [
            [link(name, _place(name)), *(str(len(found[word]) or "") for word in used)]
            for name, found in values.items()
        ]
        sections = [
            section(
                self,
                name,
                _place(name),
                nodes.paragraph(text=case.title),
                table(["provenance", "field", "value", "note"], _rows(values[name])),
            )
            for name, case in cases.items()
        ]
        return [table(["case", *used], counts), *sections]


def _place(name: str) -> str:
    return f"case-{name}"


def _rows(values: dict[str, dict[str, Value]]) -> list[list[str]]:
    def cells(word: str, path: str, one: Value) -> list[str]:
        return [word, path, str(one.typed).replace(" ", "\N{NO-BREAK SPACE}"), one.note]

    return [cells(word, path, one) for word, found in values.items() for path, one in found.items()]


def setup(app: Any) -> dict[str, bool]:
    """Offer the directive to Sphinx."""
    app.add_directive("case-inputs", CaseInputs)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
