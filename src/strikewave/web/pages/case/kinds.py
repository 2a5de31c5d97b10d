"""The kinds of cases that have a page: machines, layered bars, elements."""

from __future__ import annotations

from typing import NamedTuple


class CaseKind(NamedTuple):
    """A kind of case that has a page.

    Attributes
    ----------
    place : str
        Address of the page.
    usual : str
        The case that is shown at first.
    program, call : str
        The command, and the function of Python, that give the same.
    view : str
        Module of its `full`, and its `look`, which run in processes.
    charts : tuple of (str, bool)
        Content of each diagram, and True if it is as wide as the page; the last ones are hidden where a view has fewer.
    main : tuple of str
        Fields with sliders until it is known which matter most.
    files : tuple of (str, str, str)
        Files to download beside the case: words, icon, name of the file.
    quick : bool
        True if there is a first look.
    waits : bool
        True if a run takes so long that only a button starts it.
    drawn : bool
        True if there are drawings.
    has_wishes : bool
        True if settings are found for what is wanted of its blows.
    is_layered : bool
        True if it can be read at any section along its layers.
    """

    place: str
    usual: str
    program: str
    call: str
    view: str
    charts: tuple[tuple[str, bool], ...]
    main: tuple[str, ...]
    files: tuple[tuple[str, str, str], ...]
    quick: bool = False
    waits: bool = False
    drawn: bool = False
    has_wishes: bool = False
    is_layered: bool = False


CASES = "strikewave.web.case_values"
"""Module of what all kinds have in common, which runs in processes."""
REPORTS = (("report (.html)", "article", "report.html"), ("report (.pdf)", "picture_as_pdf", "report.pdf"))
MACHINE = CaseKind(
    place="/",
    usual="li-ma-2019",
    program="run",
    call="run_case",
    view="strikewave.web.pages.case.machine_view",
    charts=(
        ("contact force of the first blow", False),
        ("rigid-body acceleration of the first blow", False),
        ("peaks of all blows", True),
    ),
    main=(
        "machine.speed",
        "machine.height",
        "machine.engagement",
        "striker.mass",
        "object.mass",
        "object.frame_stiffness",
        "contact.restitution",
    ),
    files=(("blows (.csv)", "table_chart", "blows.csv"), *REPORTS, ("histories (.nc)", "data_array", "solution.nc")),
    quick=True,
    drawn=True,
    has_wishes=True,
)
TARGET = CaseKind(
    place="/target",
    usual="li-ma-2019-fig13-bar",
    program="wave",
    call="run_wave",
    view="strikewave.web.pages.case.target_view",
    charts=(
        ("stress over place and time", True),
        ("stress at the taps", False),
        ("acceleration at the taps, and what sensors read", False),
    ),
    main=("load.peak", "load.duration"),
    files=(("taps (.csv)", "table_chart", "taps.csv"), *REPORTS, ("waves (.nc)", "data_array", "waves.nc")),
    is_layered=True,
)
ELEMENTS = CaseKind(
    place="/elements",
    usual="taylor-bar-fem",
    program="fem",
    call="run_fem",
    view="strikewave.web.pages.case.elements_view",
    charts=(("contact force", False), ("energies", False)),
    main=("fem.duration",),
    files=(*REPORTS, ("histories (.nc)", "data_array", "histories.nc")),
    waits=True,
)
KINDS = (MACHINE, TARGET, ELEMENTS)
