"""Materials: the paper's tables, and what every row must have."""

import pytest

from strikewave.base.errors import InputError
from strikewave.base.materials import material, materials


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
    assert m.status in ("checked", "from memory")
    assert len(m.source) > 20


def test_thirteen_materials():
    assert len(materials()) >= 13


def test_unknown_material_names_the_nearest():
    with pytest.raises(InputError, match='did you mean "7075-T6"'):
        material("7075-T7")
