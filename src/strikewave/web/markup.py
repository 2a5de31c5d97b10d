"""Content of pages as HTML: numbers, tables, notices, refusals; texts from elsewhere are escaped here."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape

from strikewave.reporting.parts import Table

MOST_ROWS = 60
"""Rows of a table on a page, a few screens; the file has all."""
GRAVEST = {"failed": 0, "error": 0, "warning": 1}
"""Order of the notices by severity; all others come after."""
PageTable = tuple[str, Sequence[str], Sequence[Sequence[str]], Sequence[int]]
"""Title, heads, rows, and the columns of words."""


def page_table(shown: Table) -> PageTable:
    """Return a table of a report as one of a page.

    Examples
    --------
    >>> page_table(Table("Blows", ["kind", "peak (g)"], [["full", 4151.2]]))
    ('Blows', ['kind', 'peak (g)'], [['full', '4151']], (0,))
    """
    rows = [[cell if isinstance(cell, str) else cell.text for cell in row] for row in shown.cells()]
    return shown.caption, list(shown.columns), rows, tuple(k for k, plain in enumerate(shown.numeric()) if not plain)


def box(title: str, inner: str) -> str:
    """Return a box with a heading."""
    name = escape(title)
    return f'<section class="sw-box" aria-label="{name}"><h2>{name}</h2>{inner}</section>'


def key_numbers(rows: Sequence[Sequence[str]]) -> str:
    """Return the key numbers, each below its name, its band in small letters.

    Examples
    --------
    >>> key_numbers([("peak", "4151 g (4000 to 4300 g)")]).count("<small>(4000 to 4300 g)</small>")
    1
    """
    cards = []
    for name, text in rows:
        number, gap, band = text.partition(" (")
        small = f" <small>({escape(band)}</small>" if gap else ""
        cards.append(f'<div class="sw-card"><dt>{escape(name)}</dt><dd>{escape(number)}{small}</dd></div>')
    return f'<dl class="sw-key">{"".join(cards)}</dl>'


def table(caption: str, heads: Sequence[str], rows: Sequence[Sequence[str]], word_columns: Sequence[int] = ()) -> str:
    """Return a table, which a narrow screen scrolls by itself; ``word_columns`` are the columns of words.

    Examples
    --------
    >>> table("Blows", ["peak"], [["<b>"]]).count("&lt;b&gt;")
    1
    """

    def cells(tag: str, texts: Sequence[object]) -> str:
        scope = ' scope="col"' if tag == "th" else ""
        kinds = [' class="sw-words"' if place in word_columns else "" for place in range(len(texts))]
        return "".join(
            f"<{tag}{scope}{kind}>{escape(str(text))}</{tag}>" for kind, text in zip(kinds, texts, strict=True)
        )

    body = "".join(f"<tr>{cells('td', row)}</tr>" for row in rows[:MOST_ROWS])
    left_out = len(rows) - MOST_ROWS
    more = f'<div class="sw-soft">{left_out} more rows: the file has all</div>' if left_out > 0 else ""
    head = f"<thead><tr>{cells('th', heads)}</tr></thead>"
    return (
        f'<div class="sw-table" tabindex="0"><table aria-label="{escape(caption)}">{head}<tbody>{body}</tbody></table>'
        f"</div>{more}"
    )


def tables(listed: Sequence[PageTable]) -> str:
    """Return tables, each in a box."""
    return "".join(box(title, table(title, heads, rows, word_columns)) for title, heads, rows, word_columns in listed)


def notices(rows: Sequence[Sequence[str]]) -> str:
    """Return notices, the gravest first: severity in a word and a colour, code, message."""
    listed = sorted(rows, key=lambda row: GRAVEST.get(row[0], 2))
    return "".join(
        f'<div class="sw-notice {escape(severity)}"><b>{escape(severity)}: {escape(code.replace("-", " "))}.</b> '
        f"{escape(message)}</div>"
        for severity, code, message in listed
    )


def checks(balance: Sequence[str], listed: Sequence[Sequence[str]]) -> str:
    """Return the errors of balances with their limits, and the notices."""
    errors = f'<div class="sw-soft">balances: {escape("; ".join(balance))}</div>' if balance else ""
    return box("Checks and warnings", errors + notices(listed)) if balance or listed else ""


def refusal(message: str) -> str:
    """Return the reason of a refusal."""
    return f'<div class="sw-notice error" role="alert"><b>refused.</b> {escape(message)}</div>'


def verdict(word: str, text: str) -> str:
    """Return the verdict of a specification, in a colour and a word."""
    look = {"PASS": "good", "FAIL": "failed"}.get(word.partition(" ")[0], "warning")
    return f'<div class="sw-notice {look}"><b>{escape(word)}</b> {escape(text)}</div>'


def nothing(text: str) -> str:
    """Return the text of an empty page."""
    return f'<div class="sw-empty">{escape(text)}</div>'


def links(title: str, listed: Sequence[tuple[str, str]]) -> str:
    """Return a list of links, each with its address; nothing where there are none."""
    rows = "".join(f'<li><a href="{escape(place)}">{escape(label)}</a></li>' for label, place in listed)
    return box(title, f'<ol class="sw-links">{rows}</ol>') if listed else ""
