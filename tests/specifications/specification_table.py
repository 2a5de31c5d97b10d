"""The table of all built-in numbers for docs/specifications.md; `python tests/specifications/specification_table.py` writes it."""

from pathlib import Path

from strikewave.specifications.reading import read_built_in, specification_names
from strikewave.specifications.tables import numbers_of

PAGE = Path(__file__).parents[2] / "docs" / "specifications.md"
BEGIN = "<!-- all built-in numbers -->\n"


def lines():
    """Return the lines of the tables: a section a specification, a row a number that is stated."""
    found = []
    for name in specification_names():
        file, _ = read_built_in(name)
        found += [f"### {name}", "", f"{file.title} ({file.edition})", ""]
        found += ["| Number | Value | Status | Source |", "| --- | --- | --- | --- |"]
        for path, number, status, source in numbers_of(file):
            found.append(f"| `{path}` | {number.typed} | {status} | {source} |")
        found.append("")
    return found


def page_with_tables(text):
    """Return a page with the tables in the place of those that it has."""
    return text.partition(BEGIN)[0] + BEGIN + "\n" + "\n".join(lines())


if __name__ == "__main__":
    PAGE.write_text(page_with_tables(PAGE.read_text("utf-8")), "utf-8")
