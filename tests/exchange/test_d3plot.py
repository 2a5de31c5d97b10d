"""d3plot is read as its manual has it: words of both sizes, several files, deletion; damage is refused."""

import struct
from pathlib import Path

import dynars
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as some

from strikewave.base.errors import InputError
from strikewave.exchange.ls_dyna.d3plot import CONTROL, read_d3plot
from strikewave.exchange.units import SYSTEMS

from .ls_dyna_files import d3plot

MM = SYSTEMS["mm-t-s"]
BY_LASSO = Path(__file__).parent / "data" / "d3plot"
"""Written with lasso-python 2.0.4: two cubes, three states; see `test_a_file_by_lasso_gives_what_it_was_given`."""
POINTS = np.array([[x, y, z] for z in range(3) for y in (0, 1) for x in (0, 1)], float)
CELLS = np.array([[0, 1, 3, 2, 4, 5, 7, 6], [4, 5, 7, 6, 8, 9, 11, 10]])


def states(rng, count=3):
    return [
        (
            k * 2.0**-20,
            POINTS + 0.01 * k * rng.normal(size=(12, 3)),
            rng.normal(size=(12, 3)),
            100.0 * rng.normal(size=(2, 6)),
            rng.random(2),
            np.array([1.0, k < 2]),
        )
        for k in range(count)
    ]


def write(path, rng, **how):
    given_ = states(rng)
    d3plot(path, POINTS, CELLS, np.array([1, 0]), [20, 30], ["upper", "lower"], given_, **how)
    return given_


def test_a_file_by_lasso_gives_what_it_was_given():
    found = read_d3plot(BY_LASSO, MM)
    mesh = found.mesh
    assert (mesh.names, found.numbers) == (("upper", "lower"), (20, 30))
    assert np.array_equal(mesh.hexahedra, CELLS[::-1])
    assert np.array_equal(mesh.points, POINTS * 1e-3)
    for k, state in enumerate(found.states()):
        moved = k * 2.0**-6 * np.arange(36).reshape(12, 3)
        numbers = np.arange(1, 13).reshape(2, 6)[::-1]
        frame = state.frame
        assert frame.time == k * 2.0**-20
        # exact powers of two in the file; rounding of mm to m only
        np.testing.assert_allclose(frame.displacement, moved * 1e-3, rtol=0, atol=1e-18)
        np.testing.assert_allclose(frame.velocity, -8e-3 * moved, rtol=1e-15)
        np.testing.assert_allclose(frame.stress, (1 + k) * numbers * 1e6, rtol=1e-15)
        assert np.array_equal(frame.plastic_strain, k * np.array([0.5, 0.25]))
        assert state.alive.tolist() == [True, k < 2]
    assert k == 2


@pytest.mark.parametrize("word", [4, 8])
@pytest.mark.parametrize("order", ["<", ">"])
@pytest.mark.parametrize("alone", [True, False])
def test_words_of_both_sizes_and_orders_in_one_file_or_several(tmp_path, rng, word, order, alone):
    given_ = write(tmp_path / "d3plot", rng, word=word, order=order, alone=alone, history=3)
    found = read_d3plot(tmp_path / "d3plot", MM)
    read = list(found.states())
    near = {"rtol": 1e-6 if word == 4 else 1e-14, "atol": 1e-9 if word == 4 else 1e-18}
    assert len(read) == 3
    for (time, place, velocity, stress, strain, alive), state in zip(given_, read, strict=True):
        assert state.frame.time == time
        np.testing.assert_allclose(state.frame.displacement, (place - POINTS) * 1e-3, **near)
        np.testing.assert_allclose(state.frame.velocity, velocity * 1e-3, **near)
        np.testing.assert_allclose(state.frame.stress, stress[::-1] * 1e6, **near)
        np.testing.assert_allclose(state.frame.plastic_strain, strain[::-1], **near)
        assert np.array_equal(state.alive, alive[::-1] != 0.0)


def test_a_run_that_was_killed_reads_as_far_as_it_came(tmp_path, rng):
    path = tmp_path / "d3plot"
    write(path, rng)
    whole = path.read_bytes()
    counts = []
    for cut in range(len(whole), 0, -97):
        path.write_bytes(whole[:cut])
        try:
            counts.append(sum(1 for _ in read_d3plot(path, MM).states()))
        except InputError:
            counts.append(-1)
    assert counts[0] == 3
    assert set(counts) == {3, 2, 1, 0, -1}
    assert counts == sorted(counts, reverse=True)


@pytest.mark.parametrize("name", [*CONTROL])
def test_counts_that_the_file_has_no_room_for_are_refused(tmp_path, rng, name):
    path = tmp_path / "d3plot"
    write(path, rng)
    whole = bytearray(path.read_bytes())
    for value in (2**31 - 1, -7, 2**20):
        struct.pack_into("<i", whole, 4 * CONTROL[name], value)
        path.write_bytes(whole)
        try:
            assert sum(1 for _ in read_d3plot(path, MM).states()) <= 3
        except InputError:
            continue


@pytest.mark.parametrize(
    ("name", "value", "words"),
    [
        ("particles", 5, "particles"), ("solids", -2, "solids of 10 nodes"), ("dimensions", 7, "NDIM = 7"),
        ("stress", 0, "no stress"), ("coordinates", 0, "no coordinates"), ("shells_of_8", 1, "shells of 8"),
    ],
)  # fmt: skip
def test_what_cannot_be_stepped_over_is_refused_by_name(tmp_path, rng, name, value, words):
    path = tmp_path / "d3plot"
    write(path, rng)
    whole = bytearray(path.read_bytes())
    struct.pack_into("<i", whole, 4 * CONTROL[name], value)
    path.write_bytes(whole)
    with pytest.raises(InputError, match=words):
        read_d3plot(path, MM)


WARM = {0: 0, 1: 1, 2: 1 + 3, 3: 3 + 3, 10: 1, 11: 2, 12: 5}
"""Numbers of a node by the word IT: temperature, one or three; flux of heat, three; added mass, one."""
RATES = {0: 0, 1: 1, 10: 6, 11: 7}
"""The same by IDTDT: rate of temperature; residual forces and moments."""


def full(path, states, warm, rates, heat, rigid, deletion):
    """Write solids, shells, beams and thick shells with all that may stand between them, by the source's State data.

    ``heat`` is NT3D, ``rigid`` the number of shells without a state, ``deletion`` MDLOPT.
    """
    solids, shells, beams, thick = len(CELLS), 3, 2, 1
    head = np.zeros(64, "<i4")
    head[11], head[15], head[16], head[18] = 1, 5 if rigid else 4, len(POINTS), 6
    head[19:24] = warm, 1, 1, 1, solids
    head[[27, 28, 30, 31, 33, 40, 42]] = 7, beams, 6, shells, 13, thick, 21
    head[36], head[43], head[44], head[51] = {0: 2, 1: -2, 2: -10002}[deletion], 1000, 1000, 4
    head[56], head[57] = rates, 64
    further = np.zeros(64, "<i4")
    further[65 - 64] = heat
    words = [head, further, *([np.array([rigid, 4, 1, 20, 1, 1], "<i4")] if rigid else []), POINTS.ravel()]
    words += [np.column_stack([CELLS + 1, [2, 1]]), np.ones((thick, 9), int), np.ones((beams, 6), int)]
    words += [np.ones((shells, 5), int)]
    held = b"".join(np.asarray(w, "<f4" if w.dtype.kind == "f" else "<i4").tobytes() for w in words)
    for time, place, velocity, stress, strain, alive in states:
        between = [WARM[warm] * len(POINTS) + RATES[rates] * len(POINTS), heat * solids]
        state = [np.array([time]), np.full(6, 7e7), place.ravel(), np.full(between[0], 8e8), velocity.ravel()]
        state += [np.full(POINTS.size, 9e9), np.full(between[1], 1e10), np.column_stack([stress, strain]).ravel()]
        state += [np.full(21 * thick + 6 * beams + 13 * (shells - rigid), 1e11)]
        state += [[], [np.ones(len(POINTS))], [alive, np.ones(thick + shells + beams)]][deletion]
        held += np.concatenate(state).astype("<f4").tobytes()
    path.write_bytes(held + np.array([-999999.0], "<f4").tobytes())


@pytest.mark.parametrize(
    ("warm", "rates", "heat", "rigid", "deletion"),
    [
        *((warm, 0, 0, 0, 2) for warm in WARM), *((0, rates, 0, 0, 2) for rates in RATES), (0, 0, 1, 0, 2),
        (0, 0, 0, 2, 2), (0, 0, 0, 0, 1), (0, 0, 0, 0, 0), (2, 11, 2, 2, 2), (3, 1, 1, 1, 1),
    ],
)  # fmt: skip
def test_what_stands_between_is_stepped_over(tmp_path, rng, warm, rates, heat, rigid, deletion):
    given_ = states(rng)
    full(tmp_path / "d3plot", given_, warm, rates, heat, rigid, deletion)
    read = list(read_d3plot(tmp_path / "d3plot", MM).states())
    assert len(read) == 3
    near = {"rtol": 1e-6, "atol": 1e-9}
    for (time, place, velocity, stress, strain, alive), state in zip(given_, read, strict=True):
        assert state.frame.time == time
        np.testing.assert_allclose(state.frame.displacement, (place - POINTS) * 1e-3, **near)
        np.testing.assert_allclose(state.frame.velocity, velocity * 1e-3, **near)
        np.testing.assert_allclose(state.frame.stress, stress[::-1] * 1e6, **near)
        np.testing.assert_allclose(state.frame.plastic_strain, strain[::-1], **near)
        assert np.array_equal(state.alive, alive[::-1] != 0.0 if deletion == 2 else [True, True])


def titled(path, rng, word, kind):
    """Write a d3plot with one more list of titles behind that of the parts, and return its states."""
    given_ = write(path, rng, word=word)
    end, whole = np.array([-999999.0], f"<f{word}").tobytes(), path.read_bytes()
    place = whole.index(end, whole.index(b"lower"))
    more = np.array([kind, 1, 20], f"<i{word}").tobytes() + b"a contact or a fluid".ljust(72)
    path.write_bytes(whole[:place] + more + whole[place:])
    return given_


@pytest.mark.parametrize("word", [4, 8])
@pytest.mark.parametrize("kind", [90002, 90020])
def test_titles_of_contacts_and_fluids_are_stepped_over(tmp_path, rng, word, kind):
    given_ = titled(tmp_path / "d3plot", rng, word, kind)
    found = read_d3plot(tmp_path / "d3plot", MM)
    assert found.mesh.names == ("upper", "lower")
    for state, (time, place, *_) in zip(found.states(), given_, strict=True):
        assert state.frame.time == time
        np.testing.assert_allclose(state.frame.displacement, (place - POINTS) * 1e-3, rtol=1e-6, atol=1e-9)


@pytest.mark.parametrize("word", [4, 8])
@pytest.mark.parametrize("kind", [90003, 90100, 900100])
def test_titles_of_another_kind_are_refused(tmp_path, rng, word, kind):
    titled(tmp_path / "d3plot", rng, word, kind)
    with pytest.raises(InputError, match=f"titles of kind {kind}"):
        read_d3plot(tmp_path / "d3plot", MM)


@pytest.mark.parametrize("value", [np.nan, np.inf])
@pytest.mark.parametrize(
    ("which", "name"), [(0, "time"), (1, "displacement"), (2, "velocity"), (3, "stress"), (4, "plastic strain")]
)
@pytest.mark.parametrize("word", [4, 8])
def test_states_of_a_run_that_blew_up_are_refused(tmp_path, rng, which, name, value, word):
    given_ = states(rng)
    broken = list(given_[1])
    broken[which] = np.full_like(np.asarray(broken[which], float), value)
    given_[1] = tuple(broken)
    d3plot(tmp_path / "d3plot", POINTS, CELLS, np.array([1, 0]), [20, 30], ["upper", "lower"], given_, word=word)
    read = read_d3plot(tmp_path / "d3plot", MM).states()
    assert next(read).frame.time == 0.0
    with pytest.raises(InputError, match=f"d3plot, {name} at .* s: .*finite numbers; the run blew up there"):
        next(read)


def test_solids_that_name_nodes_beyond_the_file_are_refused(tmp_path):
    d3plot(tmp_path / "d3plot", POINTS, CELLS + 5, np.array([1, 0]), [20, 30], ["upper", "lower"], [])
    with pytest.raises(InputError, match="nodes and parts beyond"):
        read_d3plot(tmp_path / "d3plot", MM)


@given(some.integers(0, 3000), some.binary(min_size=1, max_size=8))
def test_damaged_bytes_are_read_or_refused(tmp_path_factory, place, held):
    path = tmp_path_factory.mktemp("any") / "d3plot"
    write(path, np.random.default_rng(1))
    whole = path.read_bytes()
    path.write_bytes(whole[:place] + held + whole[place + len(held) :])
    try:
        assert sum(1 for _ in read_d3plot(path, MM).states()) <= 3
    except InputError:
        return


def test_dynars_reads_what_these_tests_write(tmp_path, rng):
    """An independent reader of d3plot finds nodes, times and places in the files that the tests above take for true."""
    given_ = write(tmp_path / "d3plot", rng, alone=False)
    read = dynars.open_d3plot(str(tmp_path / "d3plot"))
    assert read.num_states == len(given_)
    np.testing.assert_array_equal(read.initial_coordinates(), POINTS)
    np.testing.assert_allclose(read.times(), [state[0] for state in given_], rtol=1e-6)
    velocity, solid = (read.block(kind) for kind in (dynars.StateBlock.Velocity, dynars.StateBlock.Solid))
    for k, (_, place, speed, stress, strain, _) in enumerate(given_):
        np.testing.assert_allclose(read.node_coordinates(k), place, rtol=1e-6, atol=1e-7)
        np.testing.assert_allclose(velocity[k], speed, rtol=1e-6)
        np.testing.assert_allclose(solid[k][:, :6], stress, rtol=1e-6)
        np.testing.assert_allclose(solid[k][:, 6], strain, rtol=1e-6)
