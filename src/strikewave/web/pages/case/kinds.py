"""The kinds of cases that have a page: machines, layered bars, elements."""

from __future__ import annotations

from typing import NamedTuple


class CaseKind(NamedTuple):
    """A kind of case that has a page."""

    place: str  # address of the page
    usual: str  # the case that is shown at first
    program: str  # command with the same result
    call: str  # function of Python with the same result
    view: str  # module of its `full` and its `look`, which run in processes
    charts: tuple[tuple[str, bool], ...]  # content of each diagram, True if wide; the last are hidden where not needed
    main: tuple[str, ...]  # fields with sliders until the most important ones are known
    files: tuple[tuple[str, str, str], ...]  # downloads beside the case: label, icon, name of the file
    quick: bool = False  # whether there is a first look
    waits: bool = False  # whether a run takes so long that only a button starts it
    drawn: bool = False  # whether there are drawings
    has_wishes: bool = False  # whether settings can be searched for wanted blows
    is_layered: bool = False  # whether it can be read at any section along its layers


CASES = "strikewave.web.case_values"
"""Module of the functions that all kinds share, which run in processes."""
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
