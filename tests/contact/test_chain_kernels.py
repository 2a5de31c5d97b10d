"""Links of a chain one by one, as plain functions: forces, switches and what they change, worked by hand."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from strikewave.contact import Chain, ChainContact, Contact, Damper, Friction, PressureCap, Spring, Stop, Vibration
from strikewave.contact import _chain_kernels as chains
from strikewave.contact._chain_kernels import (
    ACCELERATION,
    FORCE,
    OPEN,
    PLACE,
    PUSHING,
    SLACK,
    SLIDING,
    SLIDING_BACK,
    SPEED,
    STICKING,
    YIELDING,
    ChainSystem,
    ChainTables,
    chain_forces,
    chain_rates,
    contact_force,
    deepest_place,
    friction_force,
    friction_switch,
    frictionless,
    holding_force,
    let_go,
    link_force,
    link_motion,
    link_push,
    link_switch,
    link_switches,
    press,
    remember,
    shake,
    slip,
    spot_of,
    spring_energy,
)
from strikewave.contact._integrator import CONTINUE, RESTART
from strikewave.contact._law_kernels import flattening, stored, yielding
from strikewave.contact.chain import _bases_at, _shakes, first_depths, link_arrays

from .interpreted import interpret, taught

KERNELS = (
    chain_forces,
    chain_rates,
    contact_force,
    flattening,
    friction_force,
    friction_switch,
    frictionless,
    holding_force,
    let_go,
    link_motion,
    link_push,
    link_switch,
    link_switches,
    press,
    remember,
    slip,
    spot_of,
    spring_energy,
    stored,
    yielding,
    link_force,
    deepest_place,
    shake,
)
"""What is tried here."""


@pytest.fixture
def kernels(monkeypatch):
    return interpret(monkeypatch, KERNELS)


CAP = Contact(3e5, 1.5, cap=PressureCap(200.0, "point"))
TABLE = Vibration(2.0, 3.0, 5.0, 0.7)


def tables(links, masses=(2.0, 5.0), gravity=-3.0, bases=(0.5, 0.9), **moving):
    """Bodies a and b, bases w and t, and links, as the kernels take them."""
    chain = Chain(dict(zip("ab", masses, strict=True)), links, dict(zip("wt", bases, strict=True)))
    made = link_arrays(links, chain.nodes)
    table = _bases_at(_shakes(chain), 0.0)
    for i, speed in enumerate(moving.get("speeds", ())):
        table[SPEED, i] = speed
    for i, acceleration in enumerate(moving.get("accelerations", ())):
        table[ACCELERATION, i] = acceleration
    bodies = np.column_stack([masses, [gravity, gravity + 1.0]])
    return ChainTables(bodies, table, made.joins, made.values), made


def memory_of(links):
    """A memory of approach speeds 1, 2 .., in which nothing has yielded yet."""
    count = len(links.joins)
    return np.concatenate([np.arange(1.0, count + 1.0), first_depths(links), np.ones(count)])


def test_a_base_shakes_about_its_mean_and_its_speeds_are_derivatives():
    def at(t):
        return _bases_at(np.array([[-0.1, 0.0, 4.0, 1.0], [2.0, 3.0, 5.0, 0.7]]), t)

    # 5 x 0.3 + 0.7 = 2.2
    assert at(0.3)[PLACE] == pytest.approx([-0.1, 2.0 + 3.0 * math.sin(2.2)], rel=1e-15)
    before, here, after = at(0.3 - 1e-5), at(0.3), at(0.3 + 1e-5)
    assert here[SPEED] == pytest.approx((after[PLACE] - before[PLACE]) / 2e-5, rel=1e-8)
    assert here[ACCELERATION] == pytest.approx((after[SPEED] - before[SPEED]) / 2e-5, rel=1e-8)


def test_compressions_of_all_pairs_of_nodes(kernels):
    """d = x_a - x_b - offset, whichever of the two is a base."""
    links = [Spring("a", "b", 1.0, offset=0.25), Spring("w", "b", 1.0, offset=0.5), Stop("b", "t", 1.0, offset=-0.125)]
    chain, _ = tables(links, speeds=(7.0, 11.0))
    y = np.array([3.0, 1.0, 20.0, 6.0])
    assert [kernels.link_motion(chain, i, y) for i in range(3)] == [
        (1.75, 14.0),
        (-1.0, 1.0),
        (1.0 - 0.9 + 0.125, -5.0),
    ]


def test_forces_of_springs_stops_and_contacts_in_all_modes(kernels):
    links = [
        Spring("a", "b", 100.0, 8.0, preload=3.0, offset=0.25),
        Stop("a", "b", 200.0, 6.0, offset=0.25),
        ChainContact("a", "b", Contact(40.0, 2.0, 0.5), offset=0.25),
        ChainContact("a", "b", CAP, offset=0.25),
    ]
    chain, made = tables(links)
    y, memory = np.array([1.75, 1.0, 5.0, 3.0]), memory_of(made)
    # d = 0.5, d' = 2
    for modes, expected in (
        ((OPEN, OPEN, OPEN), [(69.0, 53.0, 2.0), (0.0, 0.0, 2.0), (0.0, 0.0, 2.0)]),
        ((PUSHING, PUSHING, PUSHING), [(69.0, 53.0, 2.0), (112.0, 100.0, 2.0), (10.0 * (1 + 1 / 3), 10.0, 2.0)]),
        ((SLACK, SLACK, SLACK), [(69.0, 53.0, 2.0), (0.0, 100.0, 2.0), (0.0, 10.0, 2.0)]),
    ):
        mode = np.array([*modes, PUSHING])
        found = [kernels.press(chain, i, y, mode, memory) for i in range(3)]
        assert np.array(found) == pytest.approx(np.array(expected), rel=1e-14)
        out = np.empty(4)
        kernels.chain_forces(chain, y, mode, memory, out)
        assert out[:3] == pytest.approx([force for force, _, _ in expected], rel=1e-14)
    # a capped contact: the memory of its own depth, and yielding
    memory[[7, 11]] = 0.6, 1.25
    law = chain.values[3]
    assert kernels.spot_of(chain, memory, 3) == (0.6, 1.25)
    force, elastic, _ = kernels.press(chain, 3, y, np.array([0, 0, 0, PUSHING]), memory)
    # s d - D (s - 1) = 0.475
    assert force == elastic == pytest.approx(3e5 * 0.475**1.5 / 1.25, rel=1e-13)
    yields = kernels.yielding(law, 0.5)
    assert kernels.press(chain, 3, y, np.array([0, 0, 0, YIELDING]), memory) == (yields[0], yields[2], 2.0)
    # a longer memory: what a system keeps besides lies between
    longer = np.concatenate([memory[:4], [77.0], memory[4:]])
    assert kernels.spot_of(chain, longer, 3) == (0.6, 1.25)
    assert kernels.press(chain, 2, y, np.full(4, PUSHING), longer)[0] == pytest.approx(10.0 * (1 + 1 / 3))


def test_a_contact_that_yields_has_its_hysteresis_too(kernels):
    links = [ChainContact("a", "b", Contact(3e5, 1.5, 0.5, cap=CAP.cap))]
    chain, _ = tables(links)
    row = chain.values[0]
    force, storing = kernels.contact_force(row, 0.5, 3.0, YIELDING, 2.0, 0.1, 1.0)
    assert force == pytest.approx(1.75 * kernels.yielding(row, 0.5)[0], rel=1e-14)
    assert storing == kernels.yielding(row, 0.5)[2]
    damped = link_arrays([ChainContact("a", "b", Contact(40.0, 2.0, damper=Damper(7.0, 1.0)))], "ab").values[0]
    # 40 x 0.25 + 7 x 0.5 x 3
    assert kernels.contact_force(damped, 0.5, 3.0, PUSHING, 2.0, 0.0, 1.0) == (20.5, 10.0)


def test_energies_of_a_spring_either_way_and_of_a_stop_where_pressed(kernels):
    """P d + k d^2/2 = 3 x 0.5 + 12.5, or -1.5 + 12.5; stop 25 or nothing."""
    chain, _ = tables([Spring("a", "b", 100.0, preload=3.0), Stop("a", "b", 200.0)])
    for x, expected in ((1.5, [14.0, 25.0]), (0.5, [11.0, 0.0])):
        y = np.array([x, 1.0, 0.0, 0.0])
        assert [kernels.spring_energy(chain, i, y) for i in range(2)] == expected


RUBBED = [Friction("a", "b", 6.0, 9.0), Spring("a", "w", 100.0, offset=-0.5), Spring("t", "b", 30.0, 2.0)]


def test_friction_holds_its_nodes_with_equal_accelerations(kernels):
    """a: -100 (x_a - 0.5 + 0.5)/2 - 3; b: (30 (0.9 - x_b) + 2 (v_t - v_b))/5 - 2; masses 2 and 5."""
    chain, made = tables(RUBBED, speeds=(0.0, 4.0))
    memory = memory_of(made)
    y, mode = np.array([0.1, 0.2, 1.0, 1.5]), np.array([STICKING, PUSHING, PUSHING])
    of_a, of_b = -10.0 / 2 - 3.0, (21.0 + 5.0) / 5 - 2.0
    assert kernels.frictionless(chain, 0, y, mode, memory) == pytest.approx(of_a, rel=1e-13)
    assert kernels.frictionless(chain, 1, y, mode, memory) == pytest.approx(of_b, rel=1e-13)
    hold = (of_a - of_b) * 2 * 5 / 7
    assert kernels.holding_force(chain, 0, y, mode, memory) == pytest.approx(hold, rel=1e-13)
    # the force pushes b forward and a back
    assert of_a - hold / 2 == pytest.approx(of_b + hold / 5, rel=1e-13)
    assert kernels.friction_switch(chain, 0, y, mode, memory, -0.5) == pytest.approx(9.0 - abs(hold), rel=1e-13)
    for way, force, switch in ((SLIDING, 6.0, -0.5), (SLIDING_BACK, -6.0, 0.5)):
        mode[0] = way
        assert kernels.friction_force(chain, 0, y, mode, memory) == force
        assert kernels.link_push(chain, 0, y, mode, memory) == (force, 0.0, -0.5)
        # up to a slip of 1e-12 m/s the other way
        assert kernels.friction_switch(chain, 0, y, mode, memory, -0.5) == switch + 1e-12


@pytest.mark.parametrize("behind", ["b", "t"])
def test_friction_on_a_base_follows_it(kernels, behind):
    """The base is as heavy as it needs to be: m (a_body - a_base), with the sign of the side it is on."""
    ends = ("b", "t") if behind == "b" else ("t", "b")
    chain, made = tables([Friction(*ends, 6.0, 9.0), Spring("w", "b", 30.0)], accelerations=(0.0, 11.0))
    y, mode, memory = np.array([0.0, 0.2, 0.0, 1.5]), np.array([STICKING, PUSHING]), memory_of(made)
    of_b = 30.0 * 0.3 / 5 - 2.0
    assert kernels.frictionless(chain, 3, y, mode, memory) == 11.0
    hold = 5.0 * (of_b - 11.0) if behind == "b" else 5.0 * (11.0 - of_b)
    assert kernels.holding_force(chain, 0, y, mode, memory) == pytest.approx(hold, rel=1e-13)
    # it breaks loose, whichever way that force would hold it
    kernels.slip(chain, 0, y, mode, memory)
    assert mode[0] == (SLIDING_BACK if behind == "b" else SLIDING)
    # and, with a base that does not accelerate, it comes to rest with the base's speed
    chain.bases[ACCELERATION, 1], chain.bases[SPEED, 1] = 0.0, 4.0
    kernels.slip(chain, 0, y, mode, memory)
    assert mode[0] == STICKING
    assert list(y) == [0.0, 0.2, 0.0, 4.0]


def test_bodies_that_come_to_rest_on_each_other_share_their_momentum(kernels):
    """2 x 1 + 5 x 1.5 = 7 v; they stick up to 9 N, and slide on where more would be needed to hold them."""
    left = 9.5 / 7
    for preload, mode_after in ((0.0, SLIDING_BACK), (-20.0, STICKING)):
        links = [RUBBED[0], Spring("a", "w", 100.0, preload=preload, offset=-0.5), RUBBED[2]]
        chain, made = tables(links, speeds=(0.0, 4.0))
        y, mode, memory = np.array([0.1, 0.2, 1.0, 1.5]), np.array([SLIDING, PUSHING, PUSHING]), memory_of(made)
        assert kernels.link_switch(chain, 0, y, mode, memory) == CONTINUE
        assert y == pytest.approx([0.1, 0.2, left, left], rel=1e-14)
        hold = kernels.holding_force(chain, 0, y, mode, memory)
        assert (abs(hold) > 9.0) == (mode_after == SLIDING_BACK)
        assert mode[0] == mode_after
    # at just its sticking force it sticks
    chain.values[0, chains.STICKING_FORCE] = abs(hold)
    mode[0] = SLIDING
    kernels.slip(chain, 0, y, mode, memory)
    assert mode[0] == STICKING
    # what sticks and is asked breaks loose, its speeds left as they are
    y[2] = 1.0
    kernels.slip(chain, 0, y, mode, memory)
    assert mode[0] == (SLIDING if hold > 0.0 else SLIDING_BACK)
    assert y[2] == 1.0
    chain.bases[PLACE, 0] += 10.0
    mode[0] = STICKING
    kernels.slip(chain, 0, y, mode, memory)
    assert kernels.holding_force(chain, 0, y, mode, memory) > 9.0
    assert mode[0] == SLIDING


def test_rates_of_a_chain_keep_momentum_and_name_their_losses(kernels):
    links = [
        Spring("a", "b", 100.0, 8.0, preload=3.0),
        Stop("b", "w", 200.0, 6.0),
        ChainContact("t", "a", Contact(40.0, 2.0, 0.5)),
        Friction("a", "w", 6.0),
    ]
    chain, made = tables(links, bases=(0.75, 1.5), speeds=(-1.0, 2.5))
    y, memory = np.array([1.25, 1.0, 5.0, 3.0, 0.0, 0.0, 0.0, 0.0]), memory_of(made)
    for open_ones in (False, True):
        mode = np.array([PUSHING, OPEN, OPEN, SLIDING] if open_ones else [PUSHING, PUSHING, PUSHING, SLIDING])
        dy, power = np.full(8, np.nan), np.full(4, np.nan)
        kernels.chain_rates(chain, y, mode, memory, dy, power)
        # d = 0.25, 0.25, 0.25 and d' = 2, 4, -2.5; v0 = 3 m/s
        stop, contact = (0.0, 0.0) if open_ones else (50.0 + 24.0, 2.5 * (1 - 1.25 / 3))
        spring = 3.0 + 25.0 + 16.0
        assert list(dy[:2]) == [5.0, 3.0]
        assert dy[2] == pytest.approx(-3.0 + (contact - spring - 6.0) / 2, rel=1e-14)
        assert dy[3] == pytest.approx(-2.0 + (spring - stop) / 5, rel=1e-14)
        assert chain.bases[FORCE] == pytest.approx([stop + 6.0, -contact], rel=1e-14)
        # the damper's force times its rate; 6 N over 6 m/s
        losses = [16.0 * 2, 0.0 if open_ones else 24.0 * 4, 0.0 if open_ones else 2.5 * 1.25 / 3 * 2.5, 36.0]
        assert power == pytest.approx(losses, rel=1e-13)


def switches(kernels, chain, y, mode, memory):
    g = np.full(3 * len(chain.joins), np.nan)
    kernels.link_switches(chain, y, np.asarray(mode), memory, g)
    return [list(row) for row in g.reshape(-1, 3)]


def test_switches_of_every_kind_of_link(kernels):
    """Positive while the mode holds: apart -d, touching d; the force over its elastic part; deeper than ever before."""
    links = [
        Spring("a", "b", 100.0),
        Stop("a", "b", 200.0, 6.0, offset=0.25),
        ChainContact("a", "b", Contact(40.0, 2.0, 0.5), offset=0.25),
        ChainContact("a", "b", CAP, offset=0.25),
        Friction("a", "w", 6.0),
    ]
    chain, made = tables(links)
    memory = memory_of(made)
    first = memory[8]
    assert first == pytest.approx((200.0 / 3e5) ** (2 / 3))
    y = np.array([1.75, 1.0, 5.0, 8.0])  # d = 0.5, d' = -3
    ones = [1.0, 1.0, 1.0]
    stop, contact = 1.0 - 18.0 / 100.0, 1.0 - 0.5
    pushing = switches(kernels, chain, y, [OPEN] + [PUSHING] * 3 + [SLIDING], memory)
    assert pushing[0] == ones
    assert pushing[1] == pytest.approx([0.5, stop, 1.0])
    assert pushing[2] == pytest.approx([0.5, contact, 1.0])
    assert pushing[3] == pytest.approx([0.5, 1.0, first - 0.5])
    assert pushing[4] == [5.0 + 1e-12, 1.0, 1.0]
    slack = switches(kernels, chain, y, [SLACK] * 4 + [SLIDING_BACK], memory)
    assert slack[1] == pytest.approx([0.5, 1e-9 - stop, 1.0], abs=1e-15)
    assert slack[2] == pytest.approx([0.5, 1e-9 - contact, 1.0], abs=1e-15)
    assert slack[3] == pytest.approx([0.5, 1e-9 - 1.0, 1.0], abs=1e-15)
    assert slack[4] == [-5.0 + 1e-12, 1.0, 1.0]
    apart = switches(kernels, chain, y, [PUSHING] + [OPEN] * 3 + [STICKING], memory)
    assert apart[1:4] == [[-0.5, 1.0, 1.0]] * 3
    assert switches(kernels, chain, y, [OPEN] * 3 + [YIELDING, SLIDING], memory)[3] == [1.0, 1.0, -3.0]
    # a spot that has sunk by 0.6 (1 - 1/1.25) is left where that much is left
    memory[[8, 13]] = 0.6, 1.25
    assert switches(kernels, chain, y, [OPEN] * 4 + [SLIDING], memory)[3][0] == pytest.approx(-0.38)
    assert switches(kernels, chain, y, [PUSHING] * 4 + [SLIDING], memory)[3] == pytest.approx([0.38, 1.0, 0.1])
    # a stop at first touch still has a force over nearly nothing
    y[0] = 1.25
    assert switches(kernels, chain, y, [PUSHING] * 4 + [SLIDING], memory)[1][1] < -1e20


def test_switching_changes_modes_and_remembers(kernels):
    links = [
        Stop("a", "b", 200.0, 6.0),
        ChainContact("a", "b", CAP, offset=0.25, spot=2),
        ChainContact("b", "w", CAP, spot=2),
        ChainContact("b", "t", CAP, spot=3),
        ChainContact("b", "t", CAP),
    ]
    chain, made = tables(links)
    memory = memory_of(made)
    first = memory[6]
    y = np.array([1.75, 1.0, 8.0, 5.0])  # d = 0.75, 0.5; d' = 3

    def change(k, before, speed=8.0):
        mode = np.full(5, OPEN)
        mode[k // 3] = before
        y[2] = speed
        return kernels.link_switch(chain, k, y, mode, memory), mode[k // 3]

    for k in (0, 3):
        assert change(k, OPEN) == (RESTART, PUSHING)
        assert change(k, PUSHING) == change(k, SLACK) == (CONTINUE, OPEN)
        assert change(k + 1, PUSHING) == (CONTINUE, SLACK)
        assert change(k + 1, SLACK) == (CONTINUE, PUSHING)
    assert list(memory[:5]) == [3.0, 3.0, 3.0, 4.0, 5.0]
    change(3, OPEN, speed=1.0)  # what goes apart has approached at no speed
    assert memory[1] == 0.0
    assert change(5, PUSHING) == (CONTINUE, YIELDING)
    assert list(memory[6:10]) == [first] * 4
    assert change(5, YIELDING) == (CONTINUE, PUSHING)
    # 0.5 for both contacts of spot 2, and the radius that follows
    assert list(memory[6:10]) == [0.5, 0.5, first, first]
    s = kernels.flattening(chain.values[1], 0.5)
    assert s > 1.0
    assert list(memory[11:15]) == [s, s, 1.0, 1.0]
    y[0] = 1.3  # shallower than before: nothing is forgotten
    change(5, YIELDING)
    assert list(memory[6:10]) == [0.5, 0.5, first, first]
    y[0] = 2.0
    kernels.remember(chain, 4, memory, 0.75)
    assert list(memory[6:10]) == [0.5, 0.5, first, 0.75]
    # let go while it yields: as deep as it is, 0.75; while it pushes: as deep as before
    for before, deepest in ((PUSHING, 0.5), (YIELDING, 0.75)):
        mode = np.array([OPEN, before, OPEN, OPEN, OPEN])
        lost = kernels.let_go(chain, 1, y, mode, memory)
        assert list(mode) == [OPEN] * 5
        assert memory[6] == memory[7] == deepest
        assert lost == kernels.stored(chain.values[1], 0.75, 0.75)


def test_three_bodies_and_one_base_in_a_row(kernels):
    """1, 2 and 4 kg, springs of 10, 20 and 40 N/m pressed by 0.5, 0.25 and 0.125 m: 5 N in each of them."""
    links = [Spring("a", "b", 10.0), Spring("b", "c", 20.0), Spring("c", "w", 40.0, 2.0)]
    made = link_arrays(links, ["a", "b", "c", "w"])
    bodies = np.column_stack([[1.0, 2.0, 4.0], [0.0, 0.0, 0.25]])
    chain = ChainTables(bodies, np.array([[0.125], [-3.0], [0.0], [0.0]]), *made)
    y = np.array([1.0, 0.5, 0.25, 7.0, 8.0, 9.0, 0.0, 0.0, 0.0])
    assert [kernels.link_motion(chain, i, y) for i in range(3)] == [(0.5, -1.0), (0.25, -1.0), (0.125, 12.0)]
    dy, power, mode = np.full(9, np.nan), np.full(3, np.nan), np.full(3, PUSHING)
    kernels.chain_rates(chain, y, mode, memory_of(made), dy, power)
    assert list(dy[:6]) == [7.0, 8.0, 9.0, -5.0, 0.0, 0.25 - 6.0]
    assert list(power) == [0.0, 0.0, 288.0]
    assert list(chain.bases[FORCE]) == [29.0]
    assert kernels.frictionless(chain, 2, y, mode, memory_of(made)) == 0.25 - 6.0
    assert kernels.frictionless(chain, 3, y, mode, memory_of(made)) == 0.0


def test_a_system_of_a_chain_moves_its_bases_first(kernels):
    """Whatever is asked at a time finds the base where it shakes to then; the last of the state are energies lost."""
    system_of = taught(chains, ChainSystem)
    links = [Spring("t", "a", 100.0, 2.0), ChainContact("a", "b", Contact(40.0, 2.0))]
    chain = Chain({"a": 2.0, "b": 5.0, "c": 7.0}, links, {"t": TABLE})
    made = link_arrays(links, chain.nodes)
    shakes = _shakes(chain)
    t, y, memory = 0.3, np.array([0.5, 1.0, 4.0, 8.0, 5.0, 6.0, 0.0, 0.0]), memory_of(made)
    mode = np.array([PUSHING, OPEN])
    place, speed = 2.0 + 3.0 * math.sin(2.2), 15.0 * math.cos(2.2)

    def fresh():
        bodies = np.array([[2.0, 0.0], [5.0, 1.0], [7.0, -1.0]])
        return ChainSystem(ChainTables(bodies, np.zeros((4, 1)), *made), shakes)

    dy, out, g = np.full(8, np.nan), np.empty(2), np.empty(6)
    system_of.derivatives(fresh(), t, y, mode, memory, dy)
    force, lost = 100.0 * (place - 0.5) + 2.0 * (speed - 8.0), 2.0 * (speed - 8.0) ** 2
    assert dy == pytest.approx([8.0, 5.0, 6.0, force / 2, 1.0, -1.0, lost, 0.0], rel=1e-13)
    system_of.forces(fresh(), t, y, mode, memory, out)
    assert out == pytest.approx([force, 0.0], rel=1e-13)
    links[1] = ChainContact("t", "b", Contact(40.0, 2.0))
    made = link_arrays(links, chain.nodes)
    system_of.switches(fresh(), t, y, mode, memory, g)
    assert g == pytest.approx([1.0, 1.0, 1.0, 1.0 - place, 1.0, 1.0], rel=1e-13)
    y[4] = -20.0
    assert system_of.switch(fresh(), 3, t, y, mode, memory) == RESTART
    assert mode[1] == PUSHING
    assert memory[1] == pytest.approx(speed + 20.0)
    assert system_of.horizon(fresh(), t, y, mode, memory) == math.inf
    assert chains.is_a(SimpleNamespace(instance_class=ChainSystem), ChainSystem)
    assert not chains.is_a(SimpleNamespace(instance_class=ChainTables), ChainSystem)
    assert ChainTables(*fresh().chain).links.joins is made.joins
