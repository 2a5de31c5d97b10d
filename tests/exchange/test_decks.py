"""Decks of every code: what would not run here is no deck, and what differs at walls is said."""

import math
from dataclasses import replace

import numpy as np
import pytest

from strikewave.base.errors import InputError
from strikewave.exchange.deck import LARGEST_ID, Heading, check_ids, lasting, plain, real, rows
from strikewave.exchange.ls_dyna.deck import keyword, ls_dyna_deck
from strikewave.exchange.radioss import radioss_deck
from strikewave.exchange.units import SYSTEMS, unit_system
from strikewave.fem.mesh import Mesh
from strikewave.fem.model import Controls, Model, Rigid, RigidWall, SurfaceContact, TimeCurve
from strikewave.fem.shapes import block
from strikewave.fem.solids import Elastic

BELOW = (0.0, 0.0, -1e-4), (0.0, 0.0, 1.0)
"""Point and normal of a wall below the column."""


@pytest.fixture(params=[ls_dyna_deck, radioss_deck])
def written(request):
    """The deck of a model, and its text."""

    def write(model):
        deck = request.param(model, SYSTEMS["mm-t-s"], Heading("a title"))
        return deck, "".join(next(iter(deck.files.values())))

    return write


def column(**more):
    """Two elements on each other, which share four nodes."""
    found = block("foot", (1e-3, 1e-3, 2e-3), 1e-3, 1e-3, 1e-3)
    part = (found.points[found.hexahedra].mean(axis=1)[:, 2] > 1e-3).astype(np.int32)
    mesh = Mesh(found.points, found.hexahedra, part, ("foot", "head"))
    solids = dict.fromkeys(mesh.names, Elastic(7820.0, 211e9, 0.3))
    return Model(mesh, solids, Controls(20e-6), velocity=dict.fromkeys(mesh.names, (0.0, 0.0, -10.0)), **more)


def test_a_rigid_part_before_a_wall_is_refused_as_by_a_run(written):
    model = column(rigid=(Rigid("head"),), walls=(RigidWall("head.all", *BELOW),))
    with pytest.raises(InputError, match="rigid on rigid"):
        written(model)


@pytest.mark.parametrize("friction", [-1.0, math.inf, math.nan])
def test_friction_that_is_none_is_refused(written, friction):
    walls = column(walls=(RigidWall("foot.all", *BELOW, friction),))
    with pytest.raises(InputError, match="friction"):
        written(walls)
    two = replace(column(), contacts=(SurfaceContact("foot.all", "head.all", friction),))
    with pytest.raises(InputError, match="friction"):
        written(two)


def test_a_side_that_stands_behind_a_wall_is_refused(written):
    with pytest.raises(InputError, match=r"foot\.all-wall"):
        written(column(walls=(RigidWall("foot.all", (0.0, 0.0, 1e-3), BELOW[1]),)))


@pytest.mark.parametrize("width", [10, 20])
@pytest.mark.parametrize("value", [math.inf, -math.inf, math.nan])
def test_what_is_not_finite_is_no_number_of_a_deck(value, width):
    with pytest.raises(InputError, match="finite"):
        real(value, width)


def test_walls_are_said_to_be_a_constraint_where_there_is_one(written):
    assert any(
        "penalty on the gap" in line for line in written(column(walls=(RigidWall("foot.all", *BELOW),)))[0].differs
    )
    assert not any("wall" in line for line in written(column())[0].differs)


def test_nodes_that_a_rigid_part_shares_are_stopped_by_the_wall_or_said_not_to_be(written):
    """RWPNAL is 0 unless said, and then LS-DYNA's walls do not see rigid nodes; OpenRadioss's see none."""
    wall = RigidWall("foot.all", *BELOW)
    for rigid in ((), (Rigid("head"),)):
        deck, text = written(column(rigid=rigid, walls=(wall,)))
        told = [line for line in (*deck.differs, *deck.left_out) if line.startswith(f"wall {wall.name}")]
        assert len(told) == len(rigid)
        if text.startswith("*KEYWORD"):
            assert text.count("*CONTROL_CONTACT\n       0.1       1.0") == len(rigid)


def test_unknown_system_is_told_by_the_field_where_it_was_said():
    with pytest.raises(InputError, match=r"^--units: got"):
        unit_system("si", "--units")


def test_mm_tonne_s_gives_newtons_megapascals_and_millijoules():
    system = SYSTEMS["mm-t-s"]
    assert (system.force, system.stress, system.energy) == (1.0, 1e-6, 1e3)


def test_mm_gram_microsecond_gives_meganewtons_terapascals_and_kilojoules():
    system = SYSTEMS["mm-g-us"]
    assert (system.force, system.stress, system.energy) == (1e-6, 1e-12, 1e-3)


@pytest.mark.parametrize("name", SYSTEMS)
def test_newtons_second_law_and_the_wave_speed_hold_in_every_system(name):
    system = SYSTEMS[name]
    # products of powers of ten, rounded to 14 digits each
    assert system.force == pytest.approx(system.density * system.distance**3 * system.acceleration, rel=1e-13)
    assert system.velocity**2 == pytest.approx(system.stress / system.density, rel=1e-13)
    assert system.heat_capacity == pytest.approx(system.density * system.specific_heat, rel=1e-13)
    assert system.energy == pytest.approx(system.force * system.distance, rel=1e-13)
    assert system.rate * system.duration == pytest.approx(1.0, rel=1e-13)


def test_unknown_system_names_the_nearest():
    with pytest.raises(InputError, match='"mm-t-s"'):
        unit_system("mm-ton-s")


def test_ids_beyond_eight_columns_are_refused():
    check_ids(LARGEST_ID)
    with pytest.raises(InputError, match="99999999"):
        check_ids(LARGEST_ID + 1)


@pytest.mark.parametrize("width", [10, 20])
def test_numbers_keep_the_digits_that_columns_hold(rng, width):
    values = rng.choice([-1.0, 1.0], 2000) * 10.0 ** rng.uniform(-12, 12, 2000)
    texts = [real(value, width) for value in values]
    assert max(map(len, texts)) <= width
    # the worst is -d.ddde-dd in ten columns, four digits; in twenty at least 13
    worst = max(abs(float(text) / value - 1.0) for text, value in zip(texts, values, strict=True))
    assert worst < (1e-3 if width == 10 else 1e-12)


def test_a_number_that_ten_columns_would_cut_makes_a_long_keyword():
    lines = keyword("MAT_ELASTIC", [1, 7.823456789e-9, 211000.0, 0.288])
    assert lines[0] == "*MAT_ELASTIC+"
    assert float(lines[1][20:40]) == 7.823456789e-9
    assert keyword("MAT_ELASTIC", [1, 7.82e-9, 211000.0, 0.288])[0] == "*MAT_ELASTIC"


def test_curves_are_constant_to_the_end_and_from_0():
    curve = TimeCurve((1e-6, 2e-6), (3.0, 4.0))
    longer = lasting(curve, 1e-3)
    instants = np.linspace(0.0, 1e-3, 1001)
    given = np.interp(instants, curve.time, curve.value)
    assert np.array_equal(np.interp(instants, longer.time, longer.value, left=0.0, right=0.0), given)


def test_titles_are_ascii_and_never_a_keyword():
    assert plain("*NODE\n/BEGIN é", 80) == "NODE /BEGIN ?"


def test_tables_larger_than_a_piece_are_whole():
    text = "".join(rows("%6d\n", [np.arange(10_000)]))
    assert [int(line) for line in text.splitlines()] == list(range(10_000))
