"""rcforc and glstat are read as LS-DYNA writes them; what it does not write is refused by its line."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as some

from strikewave.base.errors import InputError
from strikewave.exchange.ls_dyna import histories as ls_dyna_ascii
from strikewave.exchange.ls_dyna.histories import read_glstat, read_rcforc

from .ls_dyna_files import NEW, OLD, glstat, rcforc

DIGITS = 5e-6
"""Half a unit in the last of six digits, relative."""


@pytest.fixture
def written(tmp_path):
    """Write bytes or text into a file and return its path."""

    def write(held, name="rcforc"):
        path = tmp_path / name
        path.write_bytes(held if isinstance(held, bytes) else held.encode())
        return path

    return write


@pytest.fixture
def forces(rng):
    return rng.normal(size=(2, 40, 3)) * np.logspace(-8, 8, 40)[None, :, None]


@pytest.mark.parametrize("style", [OLD, NEW])
@pytest.mark.parametrize("moments", [False, True])
def test_forces_of_older_and_newer_versions_come_back_to_their_six_digits(written, forces, style, moments):
    time = np.linspace(0.0, 4e-5, 40)
    text = rcforc({3: forces[0], 12: forces[1], 4: None}, {3: "ball.round-plate", 12: "a wall"}, time, style, moments)
    found = {(one.number, one.side): one for one in read_rcforc(written(text))}
    assert sorted(found) == [(3, "A"), (3, "B"), (12, "A"), (12, "B")]
    for (number, side), one in found.items():
        sign = 1.0 if side == "A" else -1.0
        np.testing.assert_allclose(one.force, sign * forces[0 if number == 3 else 1], rtol=DIGITS)
        np.testing.assert_allclose(one.time, time, rtol=DIGITS)
        assert one.title == {3: "ball.round-plate", 12: "a wall"}[number]


def test_a_legend_is_not_needed(written, forces):
    found = read_rcforc(written(rcforc({1: forces[0]}, {}, np.arange(40.0))))
    assert [one.title for one in found] == ["", ""]


def test_numbers_whose_exponent_has_three_digits(written):
    line = "  slave           1 time 1.00000E-06  x  1.23450-100  y  1.00000E-101  z -2.50000+102 mass  0.00000E+00\n"
    (found,) = read_rcforc(written(line))
    assert found.force.tolist() == [[1.2345e-100, 1e-101, -2.5e102]]


def test_wherever_a_run_was_killed_every_number_read_is_a_whole_one(written, forces):
    text = rcforc({1: forces[0][:3]}, {1: "ball"}, np.arange(3.0))
    whole = {one.side: one.force.tolist() for one in read_rcforc(written(text))}
    begin = text.index("  SURFA")
    begin = text.index("\n", text.index("\n", begin) + 1) + 1
    for cut in range(begin, len(text)):
        for one in read_rcforc(written(text[:cut])):
            rows = one.force.tolist()
            assert rows == whole[one.side][: len(rows)], cut


def test_a_restart_that_writes_times_again_counts_last(written):
    first = np.ones((4, 3))
    text = rcforc({1: first}, {}, np.arange(4.0)) + rcforc({1: 2.0 * first}, {}, np.arange(2.0, 6.0))
    found = read_rcforc(written(text))[0]
    assert found.time.tolist() == [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]
    assert found.force[:, 0].tolist() == [1.0, 1.0, 2.0, 2.0, 2.0, 2.0]


@pytest.mark.parametrize(
    ("line", "allowed"),
    [
        ("  SURFA           1 time 0.0  x  0.0  y  0.0  w  0.0 mass  0.0", "a side, its number, then time, x, y, z"),
        ("  SURFA           1 time 0.0  x  0.0  y  0.0", "a side, its number, then time, x, y, z"),
        ("  SURFA         one time 0.0  x  0.0  y  0.0  z  0.0 mass  0.0", "the number of a contact"),
        ("  SURFA           1 time 0.0  x  zero  y  0.0  z  0.0 mass  0.0", "numbers such as 1.23456E+02"),
        ("  SURFA           1 time 0.0  x  NaN  y  0.0  z  0.0 mass  0.0", "finite numbers"),
        ("  SURFA           1 time 0.0  x  Infinity  y  0.0  z  0.0 mass  0.0", "finite numbers"),
    ],
)
def test_a_line_of_forces_that_is_none_is_named(written, line, allowed):
    good = "  SURFA           1 time 0.0  x  0.0  y  0.0  z  0.0 mass  0.0\n"
    with pytest.raises(InputError, match="rcforc, line 2: ") as caught:
        read_rcforc(written(good + line + "\n"))
    assert caught.value.allowed.startswith(allowed)


def test_lines_without_end_files_too_large_and_too_many_contacts_are_refused(written, monkeypatch, tmp_path):
    with pytest.raises(InputError, match="less than 1000 characters"):
        read_rcforc(written(b"x" * 100_000))
    many = "".join(f"  SURFA {n:11d} time 0.0  x  0.0  y  0.0  z  0.0\n" for n in range(30))
    monkeypatch.setattr(ls_dyna_ascii, "MOST_SERIES", 20)
    with pytest.raises(InputError, match=r"line 21: .* at most 20 sides"):
        read_rcforc(written(many))
    monkeypatch.setattr(ls_dyna_ascii, "LARGEST_FILE", 100)
    with pytest.raises(InputError, match="at most 100 bytes"):
        read_rcforc(written(many))
    with pytest.raises(InputError, match="can be read"):
        read_rcforc(tmp_path / "none")
    with pytest.raises(InputError):
        read_rcforc(tmp_path)


@pytest.mark.parametrize("version", ["smp d R16 R16.1_180_d50332d", "mpp.190 s", "(version ls971s R7.1)"])
def test_energies_come_back_by_their_names(written, rng, version):
    time = np.linspace(0.0, 1e-4, 7)
    given_ = {name: rng.normal(size=7) for name in ("kinetic energy", "hourglass energy", "sliding interface energy")}
    found = read_glstat(written(glstat(time, given_, version), "glstat"))
    np.testing.assert_allclose(found.time, time, rtol=DIGITS)
    for name, values in given_.items():
        np.testing.assert_allclose(found.values[name], values, rtol=DIGITS)
    further = {"total energy / initial energy", "energy ratio w/o eroded energy", "time per zone cycle.(nanosec)"}
    assert {*further, "added mass", "reached the minimum time step"} <= set(found.values)


def test_energies_of_several_walls_are_added_up_and_stars_are_no_number(written):
    block = (
        " dt of cycle       1 is controlled by solid              7 of part         1\n"
        " time...........................   1.00000E-03\n"
        " stonewall energy...............   1.50000E+01 wall#    1\n"
        " stonewall energy...............   2.50000E+00 wall#    2\n"
        " external work..................**************\n"
    )
    found = read_glstat(written(block, "glstat"))
    assert found.values["stonewall energy"].tolist() == [17.5]
    assert np.isnan(found.values["external work"]).all()


def test_a_block_of_energies_that_was_cut_off_does_not_count(written):
    text = glstat(np.arange(3.0), {"kinetic energy": np.array([1.0, 2.0, 3.0])})
    for cut in range(text.rindex(" dt of cycle"), text.rindex("0.22936E+05") + 11):
        found = read_glstat(written(text[:cut], "glstat"))
        assert found.values["kinetic energy"].tolist() == [1.0, 2.0]


def test_a_glstat_with_other_words_is_refused(written):
    with pytest.raises(InputError, match="dt of cycle"):
        read_glstat(written("nothing\n" * 10, "glstat"))
    with pytest.raises(InputError, match="glstat, line 2"):
        read_glstat(written(" dt of cycle 1\n time.......   1.0E0E0\n", "glstat"))
    many = " dt of cycle 1\n" + "".join(f" name {n}......  1.0\n" for n in range(300))
    with pytest.raises(InputError, match=r"line 202: .* at most 200 names"):
        read_glstat(written(many, "glstat"))


@given(some.binary(max_size=300))
def test_any_bytes_are_read_or_refused(tmp_path_factory, held):
    path = tmp_path_factory.mktemp("any") / "file"
    begun = b" dt of cycle 1\n time.... 1.0\n  SURFA 1 time 0.0 x 0.0 y 0.0 z 0.0\n"
    for start in (b"", begun):
        path.write_bytes(start + held)
        for read in (read_rcforc, read_glstat):
            try:
                read(path)
            except InputError:
                continue
