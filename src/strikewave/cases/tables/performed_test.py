"""The [test] table: what was tested, by whom, where and when. It heads the report, and changes no result."""

from __future__ import annotations

import datetime
import unicodedata
from typing import Annotated, Any

from pydantic import BeforeValidator

from strikewave.base.errors import InputError
from strikewave.cases.tables.base import CaseTable

LONGEST_LINE, LONGEST_NOTES = 200, 2000
"""Characters of a field, so that it stays a line or two of the head, and of the notes: a third of a page."""
TURNS = "\u202a\u202b\u202c\u202d\u202e\u2066\u2067\u2068\u2069"
"""Characters that turn the direction of what follows: they could make a page read other than it is."""

UNPRINTED = ("Cc", "Cs", "Cn", "Zl", "Zp")
"""Categories of Unicode without a printed character: control, surrogate, unassigned, line and paragraph separators."""


def line_text(raw: Any) -> Any:
    """Return a text of one line; refuse any other."""
    return _text(raw, LONGEST_LINE)


def notes_text(raw: Any) -> Any:
    """Return a text of several lines; refuse any other."""
    return _text(raw, LONGEST_NOTES, "\n")


def _text(raw: Any, longest: int, allowed: str = "") -> str:
    """Return a text without blanks at its ends; refuse what is none, is too long, or cannot be printed."""
    if not isinstance(raw, str):
        quoted = f'write it in quotes: "{raw}"' if isinstance(raw, int | float) and not isinstance(raw, bool) else ""
        raise InputError("", raw, "a text", quoted)
    text = raw.replace("\r\n", "\n").strip()
    if len(text) > longest:
        raise InputError("", text, f"at most {longest} characters", f"this one has {len(text)}")
    odd = next((c for c in text if c not in allowed and (unicodedata.category(c) in UNPRINTED or c in TURNS)), "")
    if odd:
        where = "line breaks are, in the notes alone" if odd == "\n" else ""
        raise InputError("", text, f"text without control characters; this has U+{ord(odd):04X}", where)
    return text


def date_text(raw: Any) -> Any:
    """Return a date as ISO 8601 writes it; TOML's own kind of date is one."""
    if isinstance(raw, datetime.date) and not isinstance(raw, datetime.datetime):
        return raw.isoformat()
    try:
        return datetime.date.fromisoformat(raw.strip()).isoformat() if raw.strip() else ""
    except (AttributeError, ValueError):
        raise InputError("", raw if isinstance(raw, str) else str(raw), "a date as YYYY-MM-DD") from None


Line = Annotated[str, BeforeValidator(line_text)]


class PerformedTest(CaseTable):
    """[test]: what was tested, by whom, where and when; it heads the report and changes no result."""

    item: Line = ""
    serial_number: Line = ""
    operator: Line = ""
    laboratory: Line = ""
    order: Line = ""
    date: Annotated[str, BeforeValidator(date_text)] = ""
    direction: Line = ""
    notes: Annotated[str, BeforeValidator(notes_text)] = ""

    def stated(self) -> dict[str, str]:
        """Return the fields that are given, in their order.

        Examples
        --------
        >>> PerformedTest(date="2026-03-02", item="board 7").stated()
        {'item': 'board 7', 'date': '2026-03-02'}
        """
        return {key: text for key, text in self if text}


EXAMPLE = (
    "\n# What was tested: it heads every report. Take the marks away, and fill in what you have.\n# [test]\n"
    + "".join(f'# {key} = "{"2026-03-02" if key == "date" else ""}"\n' for key in PerformedTest.model_fields)
)
"""The table as a new case file shows it: a comment, for there is no test yet."""
