"""How a share is written in per cent, the same everywhere, and what is said of one without its sign."""


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


def sign_needed(number: float) -> str:
    """Say how a share is written that came without its sign; below 1 it may be meant either way.

    Examples
    --------
    >>> sign_needed(5.0), sign_needed(0.15)
    ('write "5 %"', 'write "15 %", or "0.15 %" if that is meant')
    """
    either = f', or "{number:g} %" if that is meant' if 0.0 < abs(number) < 1.0 else ""
    return f'write "{100.0 * number if either else number:g} %"{either}'
