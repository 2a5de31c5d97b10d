"""The page and the picture of a contact identified from a pulse."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from strikewave.analyses.impact.identified import IdentifyResult, identified_words
from strikewave.base.declare import Quantity
from strikewave.base.shock_quantities import MICROSECONDS
from strikewave.base.texts import percent
from strikewave.contact.identification import Identified
from strikewave.reporting import chapters
from strikewave.reporting.faces import face_table, text_of
from strikewave.reporting.numbers import axis_unit, headed, spelled
from strikewave.reporting.parts import Cell, Picture, Section, Table, Tag
from strikewave.reporting.style import BLUE, GREY, ORANGE, legend_below, new_figure, quiet, titled

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def identified_report(result: IdentifyResult) -> str:
    """Return the report of an identified contact as one HTML page: no script, nothing fetched, the same bytes."""
    caption = (
        "Force from first touch on: measured, and by the law that fits best. Below, measured less fitted, beside the "
        "standard deviation of a sample."
    )
    sections = [
        Section("Pulse", "", [Picture(identified_figure(result.found), caption)]),
        _value_section(result),
        chapters.warnings(result.notices),
        _record_section(result),
    ]
    status = None if result.found.described else Tag("the law does not describe the blow", "bad")
    summary = chapters.Summary("Report of an identified contact", identified_words(result), result.highlights(), status)
    return chapters.result_page(result, summary, sections)


def _value_section(result: IdentifyResult) -> Section:
    """List all values with their standard errors, and the correlation of what was determined."""
    contact, called = result.contact, {row.key: row.name for row in result.identified_rows}
    names, matrix = contact.correlation.names, contact.correlation.matrix.tolist()
    tables = [face_table(result, "identified_rows")]
    if names:
        heads = [called[name] for name in names]
        rows = [[head, *(f"{value:+.2f}" for value in row)] for head, row in zip(heads, matrix, strict=True)]
        tables.append(Table("Correlation of the errors of what was determined", ["", *heads], rows))
    text = (
        f"Standard errors rest on a standard deviation of {text_of(contact, 'noise')} of a sample; "
        f"{contact.time.size} samples were fitted."
    )
    return Section("What the pulse determines", text, tables)


def _record_section(result: IdentifyResult) -> Section:
    """Return the section on the channel, its calibration, unit and status."""
    reading = result.reading
    stated = ", ".join(f"{key.replace('_', ' ')} {value}" for key, value in reading.calibration.stated().items())
    row: list[Cell] = [
        reading.channel.name,
        stated or "nothing was stated",
        spelled(reading.channel.unit),
        reading.status,
    ]
    return Section(
        "Record", "", [Table("What the channel was taken as", ["channel", "stated", "SI unit", "status"], [row])]
    )


def identified_picture(result: IdentifyResult) -> Figure:
    """Return the pulse beside the law."""
    return titled(identified_figure(result.found), result.title)


NEWTONS = Quantity("N", "N")
FIT_POINTS = 800
"""Points of the fitted line: about the pixels of its width."""
FIT_SIZE = (9.0, 5.0)
"""Inches."""


def identified_figure(found: Identified) -> Figure:
    """Draw measured and fitted force from first touch on, and measured minus fitted below; N and microseconds.

    Examples
    --------
    >>> from strikewave.contact.force_pulse import ForcePulse
    >>> from strikewave.contact.identification import identify
    >>> t = np.arange(300) * 1e-6
    >>> figure = identified_figure(identify(t, ForcePulse(50e-6, 2e4, 60e-6, 1.5, 0.6).force(t)))
    >>> [axes.get_ylabel() for axes in figure.axes]
    ['force (N)', 'residual (N)']
    """
    figure = new_figure(FIT_SIZE)
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=(3.0, 1.2))
    _draw_force(above, found)
    _draw_residual(below, found)
    below.set_xlim(*((found.time[[0, -1]] - found.pulse.begin) / axis_unit(*MICROSECONDS.units)[0]))
    return legend_below(figure)


def _draw_force(axes: Any, found: Identified) -> None:
    pulse = found.pulse
    (second, _), (newton, _) = axis_unit(*MICROSECONDS.units), axis_unit(*NEWTONS.units)
    line = np.linspace(found.time[0], found.time[-1], FIT_POINTS)
    axes.plot((line - pulse.begin) / second, pulse.force(line) / newton, color=ORANGE, linewidth=2.0, label="fitted")
    axes.plot(
        (found.time - pulse.begin) / second,
        found.measured / newton,
        "o",
        color=BLUE,
        markersize=2.6,
        label="measured",
        zorder=3,
    )
    contact = (0.0, pulse.duration / second)
    axes.axvline(contact[0], color=GREY, linestyle=":", linewidth=1.1, label="first touch and release")
    axes.axvline(contact[1], color=GREY, linestyle=":", linewidth=1.1)
    title = f"n = {pulse.exponent:.3g}, e = {pulse.restitution:.3g}, misfit {percent(found.residual, 2)} of the peak"
    quiet(axes, title, "", headed("force", *NEWTONS.units))
    axes.margins(y=0.08)


def _draw_residual(axes: Any, found: Identified) -> None:
    (second, _), (newton, _) = axis_unit(*MICROSECONDS.units), axis_unit(*NEWTONS.units)
    time, noise = (found.time - found.pulse.begin) / second, found.noise / newton
    axes.axhspan(-noise, noise, color=GREY, alpha=0.18, linewidth=0.0, label="± one standard deviation of a sample")
    axes.axhline(0.0, color=ORANGE, linewidth=1.2)
    axes.plot(time, (found.measured - found.fitted) / newton, "o-", color=BLUE, markersize=2.2, linewidth=0.6)
    quiet(axes, "", headed("time after first touch", *MICROSECONDS.units), headed("residual", *NEWTONS.units))
    axes.margins(y=0.12)


picture, page = identified_picture, identified_report
"""Picture and page of the result in Python, see `strikewave.reporting.shown_result`."""
