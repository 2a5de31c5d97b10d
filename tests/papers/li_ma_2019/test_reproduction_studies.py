"""Studies of the reproduction: tables and documents that say what was run, from results as they come."""

import dataclasses
import json

import numpy as np
import pytest

from strikewave.base import declare
from strikewave.base.documents import plain
from strikewave.cases.case import load_case
from strikewave.papers.li_ma_2019.bodies import SimpleAnswer
from strikewave.papers.li_ma_2019.body_reasons import BodyRow
from strikewave.papers.li_ma_2019.element_studies import (
    SHARE,
    STAGES,
    Answer,
    Dimension,
    DimensionRow,
    DimensionStudy,
    MeshRow,
    changed,
    mesh_rows,
)
from strikewave.papers.li_ma_2019.report_tables import blow_table, body_table, dimension_table, mesh_table
from strikewave.papers.li_ma_2019.runs import executing
from strikewave.reporting.numbers import ShownUnits, showing

BASE = Answer(20e3, 2e-4, 2.0, 4e4, 0.01)
ROW = DimensionRow("top wall", "mesh.part.frame.top", 0.005, "assumed", dataclasses.replace(BASE, width=2.2e-4), BASE)


def test_changes_are_relative_and_of_the_right_quantity():
    cells = dimension_table(DimensionStudy("a", BASE, (ROW,))).rows[1]
    assert cells[:2] == ["top wall", "5 mm"]
    assert cells[2].text == "assumed"
    assert cells[3:] == ["+0.0 % / +0.0 %", "+10.0 % / +0.0 %", *["+0.0 % / +0.0 %"] * 3]


def test_answers_are_written_in_the_units_of_their_heads():
    table = mesh_table("a", [MeshRow(2.0, 10, 20, 1.5, -1e-6, 0.021, BASE)])
    cells = dict(zip(table.columns, table.rows[0], strict=True))
    assert cells["peak force (kN)"] == "20"
    assert cells["pulse width at 10 % (µs)"] == "200"
    assert cells["body's peak (g)"] == "4078.9", "4e4 m/s^2 over 9.80665"
    assert cells["hourglass energy (%)"] == "2.1"


def test_documents_are_plain_json():
    rows = [
        plain(declare.content(row))
        for row in (MeshRow(1.0, 1, 2, 3.0, 0.0, 0.0, BASE), DimensionStudy("a", BASE, (ROW,)))
    ]
    found = json.loads(json.dumps(rows))
    assert found[0]["answer"] == dataclasses.asdict(BASE)
    assert found[1]["rows"][0]["larger"]["width"] == 2.2e-4
    assert found[1]["rows"][0]["share"] == SHARE


@pytest.mark.verify
def test_meshes_report_their_progress_and_grow_finer():
    seen = []
    with executing(threads=2, report=lambda share, words: seen.append((share, words))) as execution:
        rows = mesh_rows("li-ma-2019-fem-rigid", execution, (4.0, 3.0))
    assert [share for share, _ in seen] == [0.0, 0.5, 1.0]
    assert rows[0].elements < rows[1].elements
    assert rows[0].steps < rows[1].steps
    assert dataclasses.astuple(rows[0])[0] == 4.0


def test_bodies_stand_in_the_chosen_units():
    answer = SimpleAnswer("lumped", np.zeros(0), np.zeros(0), 19685.34, 2.2e-4, 1.1e-4, 2, 2.5, 40e3)
    row = BodyRow("li-ma-2019-fem-rigid", "johnson", answer, answer)
    plain_cells = body_table([row]).rows[0][3:]
    assert plain_cells == ["19.69", "110", "220", "2", "2.5", "4079", "–"]
    with showing(ShownUnits.read("N,ms")):
        table = body_table([row])
    assert table.columns[3:5] == ["peak force (N)", "first pulse (ms)"]
    assert table.rows[0][3:5] == ["19685", "0.11"]


@pytest.mark.verify
def test_blows_are_those_of_whole_bodies():
    from strikewave.analyses.fem.run import run_fem
    from strikewave.papers.li_ma_2019.element_studies import studied
    from strikewave.papers.li_ma_2019.runs import coarser

    case = load_case("li-ma-2019-fem-rigid")
    solution = run_fem(studied(case.name, [*coarser(case, 4.0), "fem.blows=2"]), 2)
    table = blow_table(solution)
    first = dict(zip(table.columns, table.rows[0], strict=True))
    assert [row[0] for row in table.rows] == ["1", "2"]
    modelled = solution.model_contacts["frame.top-striker.round"]
    assert float(first["peak force (kN)"]) == pytest.approx(4.0 * modelled.peak / 1e3, rel=1e-3)
    assert float(first["impulse (N s)"]) == pytest.approx(4.0 * modelled.impulse, rel=1e-3)
    assert float(first["taken by yield (J)"]) == pytest.approx(4.0 * solution.model_run.energy["plastic"][-1], rel=5e-3)
    with showing(ShownUnits.read("N,mJ")):
        table = blow_table(solution)
    chosen = dict(zip(table.columns, table.rows[0], strict=True))
    assert float(chosen["peak force (N)"]) == pytest.approx(1e3 * float(first["peak force (kN)"]), rel=1e-4)
    assert float(chosen["taken by yield (mJ)"]) == pytest.approx(1e3 * float(first["taken by yield (J)"]), rel=5e-3)


def test_stages_leave_time_for_the_dimensions():
    assert 0.0 < sum(STAGES) < 0.9


def test_a_wall_of_a_tube_grows_inward():
    case = load_case("li-ma-2019-fem-rigid")
    wall = Dimension("wall", ("mesh.part.shell.inner_diameter",), outside="mesh.part.shell.outer_diameter")
    assert changed(case, wall, 0.5) == ["mesh.part.shell.inner_diameter=0.027"], "1 mm of wall becomes 1.5 mm"
