"""Base of every table of a case, and the tables that any case may have: [solver], [test] and [[published]]."""

from __future__ import annotations

import datetime
import re
import unicodedata
from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import BaseModel, BeforeValidator, ConfigDict

from strikewave.base.declare import NO_UNIT
from strikewave.base.errors import InputError, nearest
from strikewave.base.quantities import (
    MaybeError,
    MaybeFrequency,
    MaybeStep,
    MaybeTime,
    OutputStep,
    Range,
    Tolerance,
    Value,
)
from strikewave.base.shock_quantities import PUBLISHED_QUANTITIES

LONGEST_NAME, LONGEST_CASE_NAME = 40, 80
"""Characters of a name that stands in paths and heads of columns, and of a case, which names a folder: a table and a
path still fit a line."""


class CaseTable(BaseModel):
    """Base of every table of a case: frozen, without unknown keys."""

    model_config = ConfigDict(frozen=True, extra="forbid", defer_build=True)


def _name(raw: Any) -> Any:
    """Check a name that stands in paths and heads of columns."""
    if isinstance(raw, str) and re.fullmatch(rf"[^\W_][\w +-]{{0,{LONGEST_NAME - 1}}}", raw) and not raw.isdigit():
        return raw
    allowed = f"a letter or digit, then also space, +, - and _, at most {LONGEST_NAME} in all, not a number alone"
    raise InputError("", raw, allowed)


Name = Annotated[str, BeforeValidator(_name)]


def case_name(raw: Any) -> Any:
    """Check the name of a case: it names a folder."""
    if isinstance(raw, str) and not re.fullmatch(rf"[\w][\w .+-]{{0,{LONGEST_CASE_NAME - 1}}}|", raw):
        allowed = f"letters, digits, space, dot, +, - and _, at most {LONGEST_CASE_NAME}"
        raise InputError("", raw, allowed, "the name becomes a folder's")
    return raw


class Solver(CaseTable):
    """[solver]: how exactly to compute, and how densely to keep the whole train.

    ``duration`` is that of a bar alone, ``error`` the wanted one of its velocities over their peak (1e-3; that of
    accelerations is ten times as large), ``step`` the time step of waves (chosen where left out), and
    ``bandwidth`` that at which total and wave acceleration are stated (chosen where left out). ``route`` is "exact",
    or one of the routes of Li & Ma 2019, which take the neighbours of a tap's layer as endless. ``method`` is
    "auto": delay lines, but the spectral solver where layers lose energy or disperse; ``dispersion`` slows short
    waves in every layer that has a Poisson's ratio.
    """

    tolerance: Tolerance = Value(si=1e-9, typed=1e-9)
    output_step: OutputStep = Value(si=1e-5, typed="10 us")
    duration: MaybeTime = None
    step: MaybeStep = None
    error: MaybeError = None
    bandwidth: MaybeFrequency = None
    route: Literal["exact", "as printed", "corrected"] = "exact"
    method: Literal["auto", "delay lines", "spectral"] = "auto"
    dispersion: Literal["none", "love-rayleigh", "pochhammer-chree"] = "none"


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


def published_unit(quantity: str) -> str:
    """Return the SI unit of a published number by its name; empty of a ratio and a count, as cases have them.

    Examples
    --------
    >>> published_unit("first.width"), published_unit("count")
    ('s', '')
    """
    return PUBLISHED_QUANTITIES[quantity].si.replace(NO_UNIT, "")


class Published(CaseTable):
    """[[published]]: a number to compare the result with; ``sensor`` names the one it was read from.

    In a finite-element case ``sensor`` is the part or group that moves. Its ``origin`` is a measurement, a simulation,
    or what a standard specifies.
    """

    quantity: str
    sensor: str = ""
    value: Value
    origin: Literal["measured", "simulated", "specified"]
    role: Literal["fitted", "predicted", "shown"]
    note: str = ""


def read_published(raw: Any) -> Any:
    """Read a published number in the unit of the quantity it names."""
    if not isinstance(raw, Mapping) or "quantity" not in raw or "value" not in raw:
        return raw
    quantity, value = raw["quantity"], raw["value"]
    if not isinstance(quantity, str) or quantity not in PUBLISHED_QUANTITIES:
        raise InputError("quantity", quantity, "a computed quantity", nearest(str(quantity), PUBLISHED_QUANTITIES))
    if isinstance(value, Value):
        return raw
    read = Range(published_unit(quantity), 0.0, open_low=True).read(value)
    if read.tolerance is not None:
        raise InputError("value.tolerance", read.tolerance.typed, "no tolerance on a published number", "remove it")
    return {**raw, "value": read.model_copy(update={"provenance": "published"})}
