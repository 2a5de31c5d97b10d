"""The tables of docs/contact.md and docs/cushions.md are those of the laws that the program knows."""

from pathlib import Path

import pytest

from strikewave.contact import CAP_LAWS, damper_laws, damping_laws, restitution, stiffness_laws
from strikewave.contact.cushions import cushion_laws

DOCS = Path(__file__).parents[2] / "docs"
PAGE = "\n\n".join((DOCS / name).read_text("utf-8") for name in ("contact.md", "cushions.md"))
LAWS = {"damper": damper_laws(), "stiffness": stiffness_laws(), "cap": CAP_LAWS, "cushion": cushion_laws()}
ASKED = (0.1, 0.3, 0.5, 0.7, 0.9)


def tables() -> list[list[list[str]]]:
    """Return the tables of the page whose first column is the name of a law, without their heads."""
    blocks = [block.splitlines() for block in PAGE.split("\n\n")]
    cells = [[[cell.strip() for cell in row.strip("|").split(" | ")] for row in block] for block in blocks]
    return [rows[2:] for rows in cells if rows[0][0].strip() == "law"]


def test_the_damping_laws_stand_with_equation_status_and_what_comes_out():
    rows = tables()[0]
    assert [row[0] for row in rows] == [f"`{name}`" for name in damping_laws()]
    for row, law in zip(rows, damping_laws().values(), strict=True):
        assert row[1:3] == [law.equation.replace("chi", "χ"), law.status]
        assert row[3:] == [f"{restitution(law.function(e)):.3f}" for e in ASKED]


@pytest.mark.parametrize("laws", LAWS.values(), ids=LAWS)
def test_the_other_laws_stand_with_equation_range_and_status(laws):
    wanted = [[f"`{name}`", f"`{law.equation}`", law.limits, law.status] for name, law in laws.items()]
    assert wanted in tables()
