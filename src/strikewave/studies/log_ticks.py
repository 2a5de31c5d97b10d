"""Plain numbers along the logarithmic axes of the figures of studies."""

from __future__ import annotations

from typing import Any


def plain_log_ticks(axis: Any) -> None:
    """Write 1, 2, 5, 10 along a logarithmic axis: as plain numbers they are read at a glance, powers are not.

    Parameters
    ----------
    axis : matplotlib Axis
        Such as ``axes.xaxis``, after its scale was set.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> axes = Figure().add_subplot()
    >>> axes.set_xscale("log")
    >>> plain_log_ticks(axes.xaxis)
    >>> axes.xaxis.get_major_formatter()(2000.0)
    '2000'
    """
    from matplotlib.ticker import LogLocator, NullFormatter

    axis.set_major_locator(LogLocator(subs=(1, 2, 5)))
    axis.set_major_formatter("{x:g}")
    axis.set_minor_formatter(NullFormatter())
