"""The kinds of cases that have a page: machines, layered bars, elements."""

from __future__ import annotations

from strikewave.web.case_page import CaseKind

REPORTS = (("report (.html)", "article", "report.html"), ("report (.pdf)", "picture_as_pdf", "report.pdf"))
MACHINE = CaseKind(
    place="/",
    usual="li-ma-2019",
    program="run",
    call="run_case",
    view="strikewave.web.machine_view",
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
)
TARGET = CaseKind(
    place="/target",
    usual="li-ma-2019-fig13-bar",
    program="wave",
    call="run_wave",
    view="strikewave.web.target_view",
    charts=(
        ("stress over place and time", True),
        ("stress at the taps", False),
        ("acceleration at the taps, and what sensors read", False),
    ),
    main=("load.peak", "load.duration"),
    files=(("taps (.csv)", "table_chart", "taps.csv"), *REPORTS, ("waves (.nc)", "data_array", "waves.nc")),
)
ELEMENTS = CaseKind(
    place="/elements",
    usual="taylor-bar-fem",
    program="fem",
    call="run_fem",
    view="strikewave.web.elements_view",
    charts=(("contact force", False), ("energies", False)),
    main=("fem.duration",),
    files=(*REPORTS, ("histories (.nc)", "data_array", "histories.nc")),
    waits=True,
)
KINDS = (MACHINE, TARGET, ELEMENTS)
