"""Frequencies in words."""


def frequency_text(value: float) -> str:
    """Write a frequency, Hz, in the unit that leaves no row of zeros.

    Examples
    --------
    >>> frequency_text(3e6), frequency_text(1667.0), frequency_text(60e3), frequency_text(5.0)
    ('3 MHz', '1.667 kHz', '60 kHz', '5 Hz')
    """
    scale, unit = (1e6, "MHz") if value >= 1e6 else (1e3, "kHz") if value >= 1e3 else (1.0, "Hz")
    return f"{value / scale:g} {unit}"
