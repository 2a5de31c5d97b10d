r"""Characters that command a screen or hide what stands beside them, in texts of strangers: titles, notes, file names.

They are taken out where text leaves the program: pages, pictures, tables and JSON here, terminals and error lines more
strictly, by `str.isprintable`.
"""

from __future__ import annotations

import re

_CONTROL = re.compile(
    "[\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f"  # of ASCII and of ISO 6429, where 9b begins a command
    "\u061c\u200e\u200f\u2028\u2029\u202a-\u202e\u2066-\u2069"  # direction of writing, ends of lines
    "\ud800-\udfff\ufffe\uffff]"  # no characters: no XML and no UTF-8 holds them
)
"""All but tabulators and ends of lines."""


def shown(text: str, sign: str = "\N{REPLACEMENT CHARACTER}") -> str:
    r"""Return a text with a sign in the place of each control character.

    Examples
    --------
    >>> shown("a\x1b[31mb\u202ec", "?")
    'a?[31mb?c'
    """
    return _CONTROL.sub(sign, text)


def escaped(text: str) -> str:
    r"""Return a JSON text that means the same and holds no control characters.

    Examples
    --------
    >>> print(escaped('"a\u202eb"'))
    "a\u202eb"
    """
    return _CONTROL.sub(lambda found: f"\\u{ord(found[0]):04x}", text)
