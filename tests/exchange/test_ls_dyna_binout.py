"""binout is read as LSTC's own library writes it, and as far as a run came."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as some

from strikewave.errors import InputError
from strikewave.exchange.ls_dyna_binout import read_binout
from strikewave.exchange.lsda import archived

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
    assert a.moment.tolist() == [[1.5] * 3, [2.5] * 3]
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


@given(some.binary(max_size=200), some.integers(0, 600), some.booleans())
def test_any_bytes_are_read_or_refused(tmp_path_factory, held, place, begun):
    whole = binout(records(1))
    path = tmp_path_factory.mktemp("any") / "binout"
    path.write_bytes(whole[:place] + held + whole[place + len(held) :] if begun else held)
    try:
        read_binout([path])
    except InputError:
        return
