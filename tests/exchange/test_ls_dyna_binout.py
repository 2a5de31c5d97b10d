"""binout is read as LSTC's own library writes it, and as far as a run came."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as some

from strikewave.base.errors import InputError
from strikewave.exchange.ls_dyna.folder import read_folder
from strikewave.exchange.ls_dyna.histories import archived, read_binout
from strikewave.exchange.units import SYSTEMS

from .ls_dyna_files import binout

BY_LASSO = Path(__file__).parent / "data" / "binout0000"
"""Written with ``Lsda`` of lasso-python 2.0.4, which is LSTC's own module: ids 1, 4; x, y, z = k, 2 k, 3 k of contact 1."""


def records(outputs, real=9, moments=False):
    rows = [("/rcforc/metadata", "ids", 3, [1, 1]), ("", "side", 3, [0, 1])]
    rows += [("", "legend_ids", 3, [1]), ("", "legend", 1, list(f"{'ball':70s}".encode()))]
    for k in range(1, outputs + 1):
        rows.append((f"../d{k:06d}", "time", real, [0.5 * k]))
        rows += [("", name, real, [k + 0.25, -k - 0.25]) for name in ("x_force", "y_force", "z_force", "mass")]
        rows += [("", name, real, [k + 0.5, 0.0]) for name in ("x_moment", "y_moment", "z_moment") if moments]
    rows += [("/glstat/d000001", "time", real, [0.5]), ("", "kinetic_energy", real, [3.5])]
    rows += [("", "stonewall_energy", real, [1.0, 2.0])]
    return [(folder or ".", name, kind, values) for folder, name, kind, values in rows]


def test_an_archive_by_lstcs_library_gives_what_it_was_given():
    contacts, energies = read_binout([BY_LASSO])
    k = np.arange(1.0, 4.0)
    assert [(one.number, one.side, one.title) for one in contacts] == [
        (1, "A", "ball"), (1, "B", "ball"), (4, "A", "wall"), (4, "B", "wall"),
    ]  # fmt: skip
    for one, factor in zip(contacts, (1.0, -1.0, 10.0, -10.0), strict=True):
        assert np.array_equal(one.force, factor * k[:, None] * [1.0, 2.0, 3.0])
        assert np.array_equal(one.time, k * 2.0**-20)
    assert np.array_equal(energies.values["kinetic energy"], 2.0 * k)
    assert np.array_equal(energies.values["sliding interface energy"], 3.0 * k)


@pytest.mark.parametrize("order", ["<", ">"])
@pytest.mark.parametrize("real", [9, 10])
def test_both_byte_orders_and_precisions(tmp_path, order, real):
    path = tmp_path / "binout"
    path.write_bytes(binout(records(2, real, moments=True), order))
    (a, b), energies = read_binout([path])
    assert a.force.tolist() == [[1.25] * 3, [2.25] * 3]
    assert (-b.force).tolist() == a.force.tolist()
    assert {name: values.tolist() for name, values in energies.values.items()} == {
        "kinetic energy": [3.5], "stonewall energy": [3.0],
    }  # fmt: skip


def test_files_of_several_processors_are_one_archive(tmp_path):
    rows = records(2)
    split = next(k for k, row in enumerate(rows) if row[0].startswith("/glstat"))
    for name, some_rows in (("binout0000", rows[:split]), ("binout0001", rows[split:])):
        (tmp_path / name).write_bytes(binout(some_rows))
    contacts, energies = read_binout(sorted(tmp_path.iterdir()))
    assert len(contacts) == 2
    assert energies.time.tolist() == [0.5]


def test_a_run_that_was_killed_reads_as_far_as_it_came(tmp_path):
    whole = binout(records(2))
    path = tmp_path / "binout"
    path.write_bytes(whole)
    names = [found.path for found in archived(path)]
    for cut in range(9, len(whole)):
        path.write_bytes(whole[:cut])
        read = [found.path for found in archived(path)]
        assert read == names[: len(read)], cut


def test_outputs_that_do_not_fit_their_contacts_are_refused(tmp_path):
    rows = [row if row[1] != "y_force" else (*row[:3], [1.0]) for row in records(1)]
    path = tmp_path / "binout"
    path.write_bytes(binout(rows))
    with pytest.raises(InputError, match=r"y_force: got \"1 numbers\"; allowed: 2 in each"):
        read_binout([path])


def read(tmp_path, rows):
    (tmp_path / "binout").write_bytes(binout(rows))
    return read_binout([tmp_path / "binout"])


def changed(rows, folder, name, kind, values):
    """Return the records with another array in place of one."""
    at, found = "", []
    for row in rows:
        at = at if row[0] == "." else row[0]
        mine = (at.rpartition("/")[2], row[1]) == (folder, name)
        found.append((row[0], name, kind, values) if mine else row)
    assert found != rows
    return found


def test_an_output_that_was_cut_off_does_not_count(tmp_path):
    rows = records(3, moments=True)
    last = next(k for k, row in enumerate(rows) if row[0] == "../d000003")
    whole = read(tmp_path, rows)[0][0]
    for cut in range(last, next(k for k, row in enumerate(rows) if row[0] == "/glstat/d000001")):
        (one, _), _ = read(tmp_path, rows[:cut])
        assert one.time.tolist() == whole.time[:2].tolist()
        assert np.array_equal(one.force, whole.force[:2])
    second = [("/glstat/d000002", "time", 9, [1.0]), (".", "kinetic_energy", 9, [4.5])]
    assert read(tmp_path, rows + second)[1].time.tolist() == [0.5]  # without its energy of walls
    assert read(tmp_path, [*rows, *second, (".", "stonewall_energy", 9, [0.0])])[1].time.tolist() == [0.5, 1.0]


@pytest.mark.parametrize(
    ("folder", "name", "told"),
    [
        ("d000002", "time", "rcforc time"),
        ("d000001", "y_force", "rcforc y_force"),
        ("d000001", "kinetic_energy", "glstat kinetic_energy"),
    ],
)
@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_numbers_of_a_run_that_blew_up_are_refused(tmp_path, folder, name, told, value):
    rows = records(2, moments=True)
    size = next(len(row[3]) for row in rows if row[1] == name)
    with pytest.raises(InputError, match=f'{told}: got "NaN or infinity"; allowed: finite numbers; the run blew up'):
        read(tmp_path, changed(rows, folder, name, 10, [value] * size))


def test_outputs_without_a_time_are_none(tmp_path):
    assert read(tmp_path, [("/glstat/d000001", "kinetic_energy", 10, [1.0])]) == ((), None)
    rows = [row for row in records(1) if row[1] != "time"]
    rows = [("/rcforc/d000001" if row[1] == "x_force" else row[0], *row[1:]) for row in rows]
    assert read(tmp_path, rows) == ((), None)


@pytest.mark.parametrize("kind", [1, 5])
def test_a_time_may_be_a_whole_number(tmp_path, kind):
    held = binout([("/glstat/d000001", "time", 1, [3]), (".", "kinetic_energy", 10, [1.5])])
    place = held.index(b"time") - 2
    assert held[place] == 1
    (tmp_path / "binout").write_bytes(held[:place] + bytes([kind]) + held[place + 1 :])
    _, found = read_binout([tmp_path / "binout"])
    assert (found.time.tolist(), found.values["kinetic energy"].tolist()) == ([3.0], [1.5])


@pytest.mark.parametrize("name", ["ids", "side", "legend_ids"])
def test_numbers_of_contacts_are_whole(tmp_path, name):
    size = 1 if name == "legend_ids" else 2
    with pytest.raises(InputError, match=f"rcforc/metadata/{name}: got .*float64.*whole numbers"):
        read(tmp_path, changed(records(1), "metadata", name, 10, [np.nan, 1e300][:size]))


def test_two_forces_on_one_side_of_a_contact_are_refused(tmp_path):
    read(tmp_path, changed(records(1), "metadata", "side", 3, [1, 1]))
    with pytest.raises(InputError, match='contact 1, side B: got "two forces"; allowed: one force on each side'):
        read_folder(tmp_path, SYSTEMS["SI"])


def test_a_file_beside_a_binout_is_not_part_of_it(tmp_path):
    (tmp_path / "binout0000").write_bytes(binout(records(2)))
    (tmp_path / "binout.bak").write_bytes(b"notes of mine")
    found = read_folder(tmp_path, SYSTEMS["SI"])
    assert [path.name for path in found.files] == ["binout0000"]


@given(some.binary(max_size=200), some.integers(0, 600), some.booleans())
def test_any_bytes_are_read_or_refused(tmp_path_factory, held, place, begun):
    whole = binout(records(1))
    path = tmp_path_factory.mktemp("any") / "binout"
    path.write_bytes(whole[:place] + held + whole[place + len(held) :] if begun else held)
    try:
        read_binout([path])
    except InputError:
        return
