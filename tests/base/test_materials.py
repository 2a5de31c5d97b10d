"""Materials: the paper's tables, and what every row must have."""

import re

import pytest

from strikewave.base.citations import CHECKED, FROM_MEMORY, QUOTED
from strikewave.base.constants import material, materials
from strikewave.base.errors import InputError
from strikewave.sensors.chain import accelerometers


@pytest.mark.parametrize(
    ("name", "row"),
    [
        ("65Mn", (7820, 211e9, 0.288, 430e6)),  # Li & Ma 2019, Tables 1 and 2
        ("2A12", (2780, 72e9, 0.33, 345e6)),
        ("45 steel", (7850, 210e9, 0.31, 355e6)),
    ],
)
def test_rows_of_the_paper(name, row):
    m = material(name)
    assert (m.density, m.youngs_modulus, m.poissons_ratio, m.yield_strength) == row


def test_bar_speed_and_impedance_of_65mn():
    m = material("65Mn")
    assert m.bar_speed == pytest.approx(5194.43, abs=0.005)
    assert m.impedance == pytest.approx(4.0620e7, rel=2e-5)
    # yield in a wave begins at sigma_y/(rho c) = 10.6 m/s
    assert m.yield_strength / m.impedance == pytest.approx(10.6, abs=0.05)


@pytest.mark.parametrize("m", materials().values(), ids=lambda m: m.name)
def test_every_row_is_possible_and_names_its_source(m):
    assert 500 < m.density < 20000
    assert -1 < m.poissons_ratio < 0.5
    assert 30 < m.bar_speed < 7000
    assert m.yield_strength is None or 0 < m.yield_strength < 0.05 * m.youngs_modulus
    # 2.84 without hardening; no metal of the table hardens to more than twice that
    assert m.hardness is None or 2.5 < m.hardness / m.yield_strength < 5.7
    assert m.loss_factor is None or 0 < m.loss_factor < 1
    assert m.kind in ("metal", "polymer", "elastomer")
    assert m.kind == "metal" or m.loss_factor is not None


@pytest.mark.parametrize("row", [*materials().values(), *accelerometers().values()], ids=lambda row: row.name)
def test_a_row_says_where_its_numbers_were_seen(row):
    """What was opened can be found: an address or a year; what was quoted says by whom; what was not says what."""
    assert len(row.source) > 20
    assert row.status in (CHECKED, QUOTED, FROM_MEMORY)
    assert bool(getattr(row, "from_memory", row.status == FROM_MEMORY)) == (row.status == FROM_MEMORY)
    if row.status == FROM_MEMORY:
        assert "from memory" in row.note
    else:
        assert "from memory" not in row.note + row.source
        assert re.search(r"\w\.(com|org|net|gov|ru)\b|\b(19|20)\d\d\b", row.source)
    if row.status == QUOTED:
        assert "as quoted" in row.source


def test_rows_from_memory_are_known_one_by_one():
    """A row may leave this list when a source is opened; none may join it unseen."""
    tables = {**materials(), **accelerometers()}
    assert {name for name, row in tables.items() if row.status == FROM_MEMORY} <= {
        "PMMA",
        "polycarbonate",
        "PTFE",
        "Endevco 7270A-20K",
        "Endevco 7270A-60K",
        "Endevco 2225",
        "PCB 350C02",
        "PCB 3991A1020KG",
        "PCB 3991A1060KG",
    }


def test_thirteen_materials():
    assert len(materials()) >= 13


def test_unknown_material_names_the_nearest():
    with pytest.raises(InputError, match='did you mean "7075-T6"'):
        material("7075-T7")
