"""What directives of this folder build pages of: text goes in as text, so that no name or note is taken for markup."""

from collections.abc import Sequence

from docutils import nodes
from docutils.parsers.rst import Directive


def section(directive: Directive, title: str, place: str, *parts: nodes.Node) -> nodes.section:
    """Return a section with its title, which stands in the list of contents and is found at `#place`."""
    made = nodes.section("", nodes.title(text=title), *parts, ids=[place], names=[nodes.fully_normalize_name(title)])
    directive.state.document.note_explicit_target(made, made)
    return made


def link(words: str, place: str) -> nodes.reference:
    """Return a link to a place of the same page."""
    return nodes.reference("", words, internal=True, refid=place)


def table(heads: Sequence[str], rows: Sequence[Sequence[str | nodes.Node]]) -> nodes.table:
    """Return a table."""
    group = nodes.tgroup("", *(nodes.colspec(colwidth=1) for _ in heads), cols=len(heads))
    group += nodes.thead("", _row(heads))
    group += nodes.tbody("", *map(_row, rows))
    return nodes.table("", group, classes=["colwidths-auto"])


def _row(cells: Sequence[str | nodes.Node]) -> nodes.row:
    inner = (nodes.Text(cell) if isinstance(cell, str) else cell for cell in cells)
    return nodes.row("", *(nodes.entry("", nodes.paragraph("", "", one)) for one in inner))
