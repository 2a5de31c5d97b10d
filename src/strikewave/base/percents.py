"""How numbers and shares are written in messages, the same everywhere, and what is said of one without its sign."""

import math

NO_DOUBT = 1e-5
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
    """Say how a share is written that came without its sign; below 1 it may be meant either way.

    Examples
    --------
    >>> sign_needed(5.0), sign_needed(0.15)
    ('write "5 %"', 'write "15 %", or "0.15 %" if that is meant')
    """
    either = f', or "{number:g} %" if that is meant' if 0.0 < abs(number) < 1.0 else ""
    return f'write "{100.0 * number if either else number:g} %"{either}'
