"""What every table of a case is, and the names that it may have."""

from __future__ import annotations

import re
from typing import Annotated, Any

from pydantic import BaseModel, BeforeValidator, ConfigDict

from strikewave.base.errors import InputError

LONGEST_NAME, LONGEST_CASE_NAME = 40, 80
"""Characters of a name that stands in paths and heads of columns, and of a case, which names a folder: a table and a
path still fit a line."""


class CaseTable(BaseModel):
    """What every table of a case is: frozen, without unknown keys."""

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
