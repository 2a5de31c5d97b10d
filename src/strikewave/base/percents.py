"""How a share is written in per cent, the same everywhere."""


def percent(share: float, decimals: int = 1, sign: str = "") -> str:
    """Write a share in per cent, with a space before the sign as SI asks for.

    Examples
    --------
    >>> percent(0.0331), percent(-0.002, 2, "+"), percent(0.5, 0)
    ('3.3 %', '-0.20 %', '50 %')
    """
    return f"{100.0 * share:{sign}.{decimals}f} %"
