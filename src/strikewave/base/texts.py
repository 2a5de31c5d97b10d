"""Texts of messages: numbers and shares, the first few of many names, command lines, texts of strangers.

Titles, notes and names of files may hold characters that command a screen or hide their neighbours. They are taken out
where text leaves the program: pages, pictures, tables and JSON here, terminals and error lines more strictly, by
`str.isprintable`.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Sequence

NO_DOUBT = 1e-5  # four digits are shown
"""Uncertainty over its value below which no digit that is shown depends on it."""


def percent(share: float, decimals: int = 1, sign: str = "") -> str:
    """Write a share in per cent, with a space before the sign as SI asks for.

    Examples
    --------
    >>> percent(0.0331), percent(-0.002, 2, "+"), percent(0.5, 0)
    ('3.3 %', '-0.20 %', '50 %')

    What rounds to nothing is not below it:

    >>> percent(-0.0002), percent(-0.0002, sign="+")
    ('0.0 %', '+0.0 %')
    """
    return f"{100.0 * share:{sign}z.{decimals}f} %"


def plain(value: float, digits: int = 3, sign: str = "") -> str:
    """Write a number with so many significant digits, as plain digits where an engineer would write them.

    Examples
    --------
    >>> plain(3000.2), plain(460.4, 2, "+"), plain(0.012345), plain(2.5e7)
    ('3000', '+460', '0.0123', '2.5e+07')
    """
    text = f"{value:{sign}.{digits}g}"
    return f"{value:{sign}.0f}" if "e" in text and 1e-4 <= abs(value) < 1e7 else text


def rounded(value: float, decimals: int) -> str:
    """Write a number with so many decimals; below 0 it is rounded to tens, hundreds and so on. No zero has a sign.

    Examples
    --------
    >>> rounded(1165.2, -2), rounded(1165.2, 1), rounded(-0.2, 0)
    ('1200', '1165.2', '0')
    """
    return f"{round(value, decimals) + 0.0:.{max(decimals, 0)}f}"


def beside_doubt(value: float, doubt: float) -> tuple[str, str]:
    """Write a number and its uncertainty: that with two digits, the number with as many decimals.

    Where no digit depends on the uncertainty, or one of them is no number, the number has four digits.

    Examples
    --------
    >>> beside_doubt(3000.0004, 0.067), beside_doubt(460.4, 31.0), beside_doubt(1.0, 1e-7)
    (('3000.000', '0.067'), ('460', '31'), ('1', '1e-07'))
    """
    if not (math.isfinite(value + doubt) and doubt > NO_DOUBT * abs(value)):
        return plain(value, 4), plain(doubt, 2)
    decimals = 1 - math.floor(math.log10(float(f"{doubt:.1e}")))
    return rounded(value, decimals), rounded(doubt, decimals)


def sign_needed(number: float) -> str:
    """Return the spelling of a share that came without its sign; below 1 it may be meant either way.

    Examples
    --------
    >>> sign_needed(5.0), sign_needed(0.15)
    ('write "5 %"', 'write "15 %", or "0.15 %" if that is meant')
    """
    either = f', or "{number:g} %" if that is meant' if 0.0 < abs(number) < 1.0 else ""
    return f'write "{100.0 * number if either else number:g} %"{either}'


def are_many(names: Sequence[str], most: int) -> bool:
    """Tell whether names are counted beyond the first: to count one takes as much room as to name it."""
    return len(names) > most + 1


def first_few(names: Sequence[str], most: int, mark: str = ", ") -> str:
    """Return names in a line; of many, the first ones and how many more there are.

    Examples
    --------
    >>> first_few(["a", "b", "c"], 2), first_few(["a", "b", "c", "d"], 2, "; ")
    ('a, b, c', 'a; b and 2 more')
    """
    return f"{mark.join(names[:most])} and {len(names) - most} more" if are_many(names, most) else mark.join(names)


def frequency_text(value: float) -> str:
    """Write a frequency, Hz, in the unit that leaves no row of zeros.

    Examples
    --------
    >>> frequency_text(3e6), frequency_text(1667.0), frequency_text(60e3), frequency_text(5.0)
    ('3 MHz', '1.667 kHz', '60 kHz', '5 Hz')
    """
    scale, unit = (1e6, "MHz") if value >= 1e6 else (1e3, "kHz") if value >= 1e3 else (1.0, "Hz")
    return f"{value / scale:g} {unit}"


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


def file_word(name: str) -> str:
    """Return the name of a file as a command takes it: one that begins as an option does leads through its folder.

    Examples
    --------
    >>> file_word("-rf.csv"), file_word("--out.csv"), file_word("shot 1.csv")
    ('./-rf.csv', './--out.csv', 'shot 1.csv')
    """
    return f"./{name}" if name.startswith("-") else name


def command_line(words: Iterable[str]) -> str:
    """Return the words behind ``strikewave`` as a line for a shell.

    Examples
    --------
    >>> command_line(["record", file_word("-a b.csv"), "--unit", "g"])
    "strikewave record './-a b.csv' --unit g"
    """
    import shlex  # each command of the screen imports this module for its names of files

    return shlex.join(["strikewave", *words])
