"""Named arrays become channels: scales, grids, clocks, limits, labels and measurements, part by part."""

import json
import math
import sys
from pathlib import Path

import numpy as np
import pytest

from strikewave.base.errors import InputError
from strikewave.records import readers
from strikewave.records.readers import Options, apart, child, common, long_table, read_measurements, restarts
from strikewave.records.readers.common import (
    ArrayColumn,
    Scaled,
    array_columns,
    assemble,
    begin_together,
    floats,
    grid_of,
    guard,
    on_grids,
)
from strikewave.records.readers.headings import PICO
from strikewave.records.readers.long_table import Labels, as_asked, as_long_table, labels_of, may_be_labels, may_count
from strikewave.records.record import Channel, Record

NAN = math.nan


def column(name, values, **details):
    values = np.asarray(values)
    return ArrayColumn(name, values.size, lambda: values, **details)


def assembled(*columns, options=Options(), **details):  # noqa: B008
    return assemble(Path(__file__), "hdf", columns, options, **details)


def shown(record):
    return [(c.name, c.unit, c.values.tolist(), c.step, c.start) for c in record.channels]


# Sizes


@pytest.fixture
def sized(tmp_path, monkeypatch):
    monkeypatch.setattr(common, "FREE_BYTES", 3000)
    monkeypatch.setattr(common, "LARGEST_ARRAY", 20000)
    path = tmp_path / "blow"
    path.write_bytes(b"x" * 10)
    return path


@pytest.mark.parametrize(
    ("claimed", "compressed", "fine"),
    [(3000, True, True), (10000, True, True), (10001, True, False), (10, False, True), (11, False, False)],
)
def test_a_file_may_claim_a_thousand_times_its_bytes(sized, claimed, compressed, fine):
    if fine:
        guard(sized, claimed, compressed)
    else:
        with pytest.raises(InputError, match="it claims"):
            guard(sized, claimed, compressed)


def test_a_small_file_may_claim_what_harms_no_machine_and_a_large_one_what_fits(sized):
    sized.write_bytes(b"x")
    guard(sized, 3000)
    with pytest.raises(InputError, match="fits into memory"):
        guard(sized, 3001)
    sized.write_bytes(b"x" * 30)
    guard(sized, 20000)
    with pytest.raises(InputError, match="fits into memory"):
        guard(sized, 20001)


def test_files_of_too_many_arrays_are_refused(monkeypatch, tmp_path):
    monkeypatch.setattr(common, "MOST_ARRAYS", 2)
    common.check_count(tmp_path, 2)
    with pytest.raises(InputError, match="it has 3"):
        common.check_count(tmp_path, 3)


# Attributes and scales


def test_attributes_are_lines_of_text_or_finite_numbers():
    assert common.text(np.array([[b"a \n b"]])) == "a b"
    assert common.text(np.array(["a", "b"])) == common.text(5) == ""
    assert common.text("x" * 300) == "x" * 200
    assert [common.number(value) for value in (3, np.float32(2.5), np.array([[7]]), True, "4.5", b"-1e3")] == [
        3.0, 2.5, 7.0, 1.0, 4.5, -1000.0,
    ]  # fmt: skip
    assert all(math.isnan(common.number(value)) for value in ("x", None, np.inf, np.array([1.0, 2.0]), 10**400, 1j))


@pytest.mark.parametrize(
    ("attributes", "grid"),
    [
        ({"fs": 8.0}, (0.125, NAN)), ({"run/Sampling Rate [kHz]": 4.0}, (2.5e-4, NAN)), ({"rate (MHz)": 2.0}, (5e-7, NAN)),
        ({"dt": 3.0, "t0": -2.0}, (3.0, -2.0)), ({"dt [ms]": 3.0, "start time (us)": -2.0}, (3e-3, -2e-6)),
        ({"fs": 0.0}, (NAN, NAN)), ({"dt": 0.0}, (NAN, NAN)), ({"gain": 3.0}, (NAN, NAN)), ({"t0": 0.0}, (NAN, 0.0)),
        ({"dt": -1.0, "fs": -1.0}, (NAN, NAN)), ({"fs [Hz]": 4.0}, (0.25, NAN)),
    ],
)  # fmt: skip
def test_attributes_state_a_grid(attributes, grid):
    np.testing.assert_allclose(grid_of(attributes.items()), grid, rtol=1e-15)


def test_the_longest_arrays_of_a_folder_lie_on_its_grid():
    columns = [
        column("a/x", [1.0] * 3, folder="a/"), column("a/y", [1.0] * 2, folder="a/"),
        column("a/z", [1.0] * 3, folder="a/", step=7.0), column("b/x", [1.0] * 2, folder="b/"),
    ]  # fmt: skip
    found = on_grids(columns, {"a/": [("dt", 5.0), ("t0", 3.0)]})
    np.testing.assert_equal([(c.step, c.start) for c in found], [(5.0, 3.0), (NAN, NAN), (7.0, NAN), (NAN, NAN)])


def test_samples_are_floats_and_dates_seconds_since_the_first():
    assert floats(np.ma.masked_equal([1, 2, 3], 2)).tolist()[::2] == [1.0, 3.0]
    assert math.isnan(floats(np.ma.masked_equal([1, 2, 3], 2))[1])
    dates = np.array(["2026-01-05T10:00:00.5", "NaT", "2026-01-05T10:00:02"], "M8[ms]")
    np.testing.assert_equal(floats(dates), [0.0, NAN, 1.5])
    np.testing.assert_equal(floats(np.array([3, 5], "m8[us]")), [3e-6, 5e-6])
    assert floats(np.array([[1, 0], [0, 1]], bool)).tolist() == [1.0, 0.0, 0.0, 1.0]
    for wrong in (np.array(["a"]), np.array([1j]), np.array([None])):
        with pytest.raises(TypeError):
            floats(wrong)


@pytest.mark.parametrize(
    ("said", "expected"),
    [
        ({}, [1.0, 2.0, 5.0]), ({"scale_factor": 3.0}, [3.0, 6.0, 15.0]), ({"add_offset": 0.5}, [1.5, 2.5, 5.5]),
        ({"scale_factor": 3.0, "add_offset": 0.5, "_FillValue": 2.0}, [3.5, NAN, 15.5]), ({"missing_value": 5}, [1.0, 2.0, NAN]),
    ],
)  # fmt: skip
def test_scale_offset_and_fill_value_are_applied_in_this_order(said, expected):
    values = np.array([1.0, 2.0, 5.0])
    np.testing.assert_equal(Scaled(lambda key: values[key].copy(), said.get, (3,))[:], expected)


def test_a_table_is_cut_along_its_longer_side(monkeypatch):
    table = np.arange(6.0).reshape(2, 3)
    for array in (table, table.T):
        found = array_columns("run/x", array, "g", "run/", step=7.0)
        assert [(c.name, c.size, c.unit, c.folder, c.step, c.load().tolist()) for c in found] == [
            ("run/x 1", 3, "g", "run/", 7.0, [0.0, 1.0, 2.0]), ("run/x 2", 3, "g", "run/", 7.0, [3.0, 4.0, 5.0]),
        ]  # fmt: skip
    square = array_columns("x", np.arange(4.0).reshape(2, 2))
    assert [c.load().tolist() for c in square] == [[0.0, 2.0], [1.0, 3.0]]
    assert [(c.name, c.size) for c in array_columns("x", np.zeros((1, 5, 1)))] == [("x", 5)]
    assert [(c.name, c.size) for c in array_columns("x", np.zeros(1))] == [("x", 1)]
    assert [c.size for c in array_columns("x", np.zeros(0))] == [0]
    assert array_columns("x", np.zeros((2, 3, 4))) == array_columns("x", np.zeros((0, 3))) == []
    assert array_columns("x", np.zeros((1, 1))) == []
    monkeypatch.setattr(common, "MOST_COLUMNS", 2)
    assert len(array_columns("x", np.zeros((2, 3)))) == 2
    assert array_columns("x", np.zeros((3, 4))) == []


# Channels


def test_arrays_over_their_own_time_and_those_without_any():
    """Time of its own size in its folder, else anywhere; what has none is left out beside it."""
    record = assembled(
        column("run/t [ms]", [0.0, 2.0, 4.0], folder="run/"), column("run/bar [g]", [1.0, 2.0, 3.0], folder="run/"),
        column("t", [5.0, 6.0, 7.0]), column("top", [4.0, 5.0, 6.0], unit="N"), column("odd", [1.0, 2.0]),
        column("else/x", [7.0, 8.0, 9.0], folder="else/"),
    )  # fmt: skip
    assert shown(record) == [
        ("run/bar", "g", [1.0, 2.0, 3.0], 2e-3, 0.0), ("top", "N", [4.0, 5.0, 6.0], 1.0, 5.0),
        ("else/x", "", [7.0, 8.0, 9.0], 2e-3, 0.0),
    ]  # fmt: skip
    assert [finding.message for finding in record.findings] == ["1 arrays are no channels: odd"]


def test_a_grid_of_its_own_goes_before_that_of_the_file():
    record = assembled(column("a", [1.0, 2.0], step=3.0), column("b", [1.0, 2.0], step=5.0, start=7.0), grid=(9.0, 4.0))
    assert [(c.step, c.start) for c in record.channels] == [(3.0, 4.0), (5.0, 7.0)]
    record = assembled(column("a", [1.0, 2.0]), grid=(NAN, NAN))
    np.testing.assert_equal((record.channels[0].step, record.channels[0].start), (NAN, 0.0))
    record = assembled(column("a", [1.0, 2.0], step=3.0, start=4.0), options=Options(rate=8.0))
    assert (record.channels[0].step, record.channels[0].start) == (0.125, 4.0)


def test_without_time_the_fullest_length_counts():
    """Three of two samples are as many as two of three: then the longer ones."""
    record = assembled(
        *[column(f"a{k}", [1.0, 2.0]) for k in range(3)], *[column(f"b{k}", [1.0] * 3) for k in range(2)]
    )
    assert [c.name for c in record.channels] == ["b0", "b1"]
    record = assembled(
        *[column(f"a{k}", [1.0, 2.0]) for k in range(4)], *[column(f"b{k}", [1.0] * 3) for k in range(2)]
    )
    assert [c.name for c in record.channels] == ["a0", "a1", "a2", "a3"]
    record = assembled(column("a", [1.0, 2.0], step=1.0), column("b", [1.0] * 3))
    assert [c.name for c in record.channels] == ["a"]


@pytest.mark.parametrize(
    ("columns", "options", "words"),
    [
        ([], Options(), "no arrays of numbers"),
        ([column("t", [0.0, 1.0])], Options(), "nothing but time"),
        ([column("t", [0.0, 1.0]), column("a", [0.0] * 3)], Options(), "nothing but time"),
        ([column("a", [0.0, 1.0])], Options(time_unit=2.0), "--time-unit"),
        ([column("a", [0.0, 1.0])], Options(time="b"), "--time"),
        ([column("a", [0.0, 1.0])], Options(time="0"), "--time"),
        ([column("a", [0.0, 1.0])], Options(time="2"), "--time"),
    ],
)
def test_arrays_without_samples_or_time_are_refused(columns, options, words):
    with pytest.raises(InputError, match=words):
        assembled(*columns, options=options)


def test_a_rate_leaves_arrays_without_time_in_and_time_out():
    record = assembled(column("t", [0.0, 1.0]), column("a", [0.0] * 3), options=Options(rate=4.0))
    assert [(c.name, c.step) for c in record.channels] == [("a", 0.25)]
    both = assembled(column("t", [0.0, 1.0, 3.0]), column("a", [5.0] * 3), options=Options(rate=4.0)).channels
    assert [(c.name, c.step, c.stamps) for c in both] == [("a", 0.25, None)]


@pytest.mark.parametrize(
    ("wanted", "clock"),
    [("b", "b"), ("2", "b"), ("run/c", "run/c"), ("c", "run/c"), (" a ", "a [ms]"), ("a [ms]", "a [ms]")],
)
def test_time_is_named_or_numbered_among_arrays(wanted, clock):
    columns = [column("a [ms]", [0.0, 1.0]), column("b", [0.0, 2.0]), column("run/c", [0.0, 3.0], folder="run/")]
    assert [c.name for c in common._clocks(columns, Options(time=wanted))] == [clock]


def test_one_name_of_time_may_stand_in_every_folder():
    columns = [column(f"{k}/c", [0.0, 1.0], folder=f"{k}/") for k in "ab"]
    assert [c.name for c in common._clocks(columns, Options(time="c"))] == ["a/c", "b/c"]
    assert [c.name for c in common._clocks([*columns, column("d", [0.0, 1.0])], Options(time="a/c"))] == ["a/c"]


def test_time_is_what_the_file_marks_and_what_is_called_so():
    def clocks(*columns):
        return [c.name for c in common._clocks(columns, Options())]

    marked = column("m", [0.0, 1.0], time=True)
    named, sounds, axis = column("Zeit", [0.0, 1.0]), column("wave time", [0.0, 1.0]), column("x", [0.0, 1.0])
    assert clocks(axis, sounds, named, marked) == ["m", "Zeit"]
    assert clocks(axis, sounds, marked) == ["m"]
    assert clocks(axis, sounds) == ["wave time"]
    assert clocks(axis) == []
    assert clocks(column("t", [0.0, 1.0], time=True)) == ["t"]


def test_only_channels_asked_for_are_loaded_under_either_name():
    def broken():
        raise AssertionError

    columns = [
        ArrayColumn("a [g]", 3, broken),
        column("run/b [N]", [1.0, 2.0, 3.0], folder="run/"),
        column("b", [7.0] * 3),
    ]
    record = assembled(*columns, options=Options(channels=("run/b [N]",)))
    assert [(c.name, c.unit, c.values.strides == (0,)) for c in record.channels] == [
        ("a", "g", True), ("run/b", "N", False), ("b", "", True),
    ]  # fmt: skip
    assert record.channels[0].values.size == 3
    twice = [column("a", [1.0, 2.0]), column("a", [3.0, 4.0])]
    found = assembled(*twice, options=Options(channels=("a",)))
    assert [np.isnan(c.values).all() for c in found.channels] == [False, True]


def test_only_what_is_wanted_is_claimed(monkeypatch):
    claimed = []
    monkeypatch.setattr(common, "guard", lambda path, size, compressed=True: claimed.append(size))
    assembled(
        column("a", [1.0] * 3), column("b", [1.0] * 3), column("c", [1.0] * 3), options=Options(channels=("c", "a"))
    )
    assert claimed == [48.0]


def test_time_that_stands_still_or_differs_in_size_gives_no_step():
    record = assembled(column("t", [4.0, 4.0, 4.0]), column("a", [1.0, 2.0, 3.0]))
    np.testing.assert_equal((record.channels[0].step, record.channels[0].start), (NAN, 4.0))
    record = assembled(column("t", [1.0, 3.0, 5.0]), column("a", [1.0, 2.0, 3.0]), options=Options(time_unit=60.0))
    assert (record.channels[0].step, record.channels[0].start) == (120.0, 60.0)
    short = ArrayColumn("a", 3, lambda: np.zeros(2))
    assert assembled(column("t", [1.0, 3.0, 5.0]), short).channels[0].stamps is None


def test_arrays_left_out_are_named_up_to_eight():
    assert common.left_out([]) == ()
    (found,) = common.left_out([f"{k}" * 50 for k in range(8)])
    assert found.value == 8
    assert found.message == "8 arrays are no channels: " + ", ".join(f"{k}" * 40 for k in range(8))
    assert common.left_out(["a"] * 9)[0].message == "9 arrays are no channels: " + "a, " * 8 + "..."


# One clock


def test_channels_are_laid_on_one_clock_from_the_earliest():
    channels = [
        Channel(name, np.zeros(2), 0.5, 1.0, stamps=stamps)
        for name, stamps in (("a", None), ("b", np.array([1.0, 1.5])), ("c", None), ("d", None))
    ]
    moved, findings = begin_together(channels, [5 * PICO, 3 * PICO, None, 3 * PICO + 2500])
    assert [c.start for c in moved] == [3.0, 1.0, 1.0, 1.0 + 2.5e-9]
    assert moved[1].stamps.tolist() == [1.0, 1.5]
    assert begin_together(channels, [3 * PICO, 4 * PICO, None, None])[0][1].stamps.tolist() == [2.0, 2.5]
    assert [(one.code, one.severity, one.value) for one in findings] == [
        ("start-times", "good", 2.0), ("start-unknown", "suspect", 1.0),
    ]  # fmt: skip
    assert findings[0].message.endswith("later: a by 2\xa0s, d by 2.5\xa0ns")
    assert begin_together(channels, [None, None, 7, 7]) == (channels, [])


@pytest.mark.parametrize(("apart", "severity"), [(3600, "good"), (3601, "suspect")])
def test_starts_more_than_an_hour_apart_are_suspect(apart, severity):
    channels = [Channel("a", np.zeros(2), 0.5), Channel("b", np.zeros(2), 0.5)]
    assert begin_together(channels, [7 * PICO, (7 + apart) * PICO])[1][0].severity == severity


@pytest.mark.parametrize(
    ("seconds", "words"),
    [
        (172800.0, "2 d"), (86400.0, "1 d"), (86399.0, "23.9997 h"), (7200.0, "2 h"), (3599.0, "3599 s"), (1.0, "1 s"),
        (0.25, "250 ms"), (0.001, "1 ms"), (2.5e-4, "250 us"), (3e-8, "30 ns"), (5e-10, "0.5 ns"),
    ],
)  # fmt: skip
def test_a_time_that_passed_is_written_in_its_unit(seconds, words):
    assert common._lasting(seconds).replace("\xa0", " ") == words


# Long tables


def test_arrays_of_labels_make_channels():
    codes = np.tile([4, 7], 20)
    time = np.repeat(np.arange(20) * 0.5, 2)
    values = np.arange(40.0)
    record = assembled(column("t", time), column("sensor", codes), column("v [g]", values))
    assert [(c.name, c.unit, c.values[:2].tolist(), c.step) for c in record.channels] == [
        ("sensor 4", "g", [0.0, 2.0], 0.5), ("sensor 7", "g", [1.0, 3.0], 0.5),
    ]  # fmt: skip
    words = ArrayColumn("sensor", 40, lambda: np.tile([1.0, 0.0], 20), words=("bar", "top"))
    record = assembled(column("t", time), words, column("v [g]", values), options=Options(channels=("top",), rate=8.0))
    assert [(c.name, np.isnan(c.values).all(), c.step) for c in record.channels] == [
        ("top", False, 0.125),
        ("bar", True, 0.125),
    ]
    plain = assembled(column("t", time), column("sensor", codes + 0.5), column("v", values))
    assert [c.name for c in plain.channels] == ["sensor", "v"]
    longer = assembled(column("t", time), column("sensor", codes), column("v", values), column("w", np.zeros(41)))
    assert [c.name for c in longer.channels] == ["sensor", "v"]
    apart_ = assembled(column("t", time), column("a/sensor", codes, folder="a/"), column("v", values))
    assert [c.name for c in apart_.channels] == ["a/sensor", "v"]
    short = ArrayColumn("sensor", 3, lambda: np.zeros(3), words=("bar",))
    assert [c.name for c in assembled(short, column("t", time), column("v", values)).channels] == ["v"]


@pytest.mark.parametrize(
    ("heading", "cell", "expected"),
    [
        ("Kanal", "-3", True),
        ("Kanal", "3.0", True),
        ("Kanal", "1234567", False),
        ("", "+3.", True),
        ("v", "3", False),
        ("Shot No.", "3", True),
    ],
)
def test_whole_numbers_may_name_channels(heading, cell, expected):
    assert may_count(heading, cell) is expected


@pytest.mark.parametrize(
    ("heading", "cells", "are_numbers", "expected"),
    [
        ("", ["A"] * 4, False, True), ("", ["A", "B", "A"], False, False), ("", ["A", "B"] * 4, False, True),
        ("", ["A"] * 9 + [""], False, True), ("", ["A"] * 8 + ["", ""], False, False), ("", ["", ""], False, False),
        ("", [], False, False), ("name", ["A", "B"], False, True), ("kanal", ["A", ""], False, True), ("kanal", [""], False, False),
        ("v", ["1"] * 8, True, False), ("", ["1"] * 8, True, True), ("shot", ["1", "2"], True, True), ("shot", ["1", "2.5"], True, False),
        ("kanal", ["1", ""], True, False), ("name", [f"{k}" for k in range(64)], False, True),
        ("name", [f"{k}" for k in range(65)], False, False),
    ],
)  # fmt: skip
def test_labels_are_few_and_come_again(heading, cells, are_numbers, expected):
    assert may_be_labels(heading, cells, are_numbers) is expected


def test_whole_numbers_become_labels_in_their_order():
    found = labels_of("", np.array([7.0, 3.0, NAN, 7.0, 12.0]))
    np.testing.assert_equal(found.codes, [1.0, 0.0, NAN, 1.0, 2.0])
    assert (list(found.words), found.are_numbers) == (["channel 3", "channel 7", "channel 12"], True)
    assert found.present() == [1, 0, 2]
    assert len(labels_of("shot", np.arange(70.0)).words) == 65


STAMPS = np.arange(40.0)
TURNS, BLOCKS = np.tile([0.0, 1.0], 20), np.repeat([0.0, 1.0], 20)


@pytest.mark.parametrize(
    ("heading", "codes", "stamps", "are_numbers", "expected"),
    [
        ("kanal", TURNS, None, False, True), ("shot", TURNS, None, False, True), ("name", TURNS, None, False, False),
        ("name", TURNS, STAMPS, False, True), ("shot", TURNS, STAMPS, False, False), ("name", BLOCKS, STAMPS, False, False),
        ("kanal", BLOCKS, STAMPS, False, True), ("kanal", BLOCKS, STAMPS, True, False), ("name", BLOCKS, STAMPS % 20, False, True),
        ("shot", BLOCKS, STAMPS % 20, False, True), ("name", TURNS, STAMPS % 20, False, False),
        ("kanal", TURNS, STAMPS % 20, False, True), ("kanal", TURNS, STAMPS % 20, True, False), ("name", TURNS, STAMPS // 2, False, True),
        ("name", np.zeros(40), STAMPS, False, False), ("kanal", np.repeat([0.0, 1.0], [16, 24]), None, False, True),
        ("kanal", np.repeat([0.0, 1.0], [15, 25]), None, False, False), ("name", TURNS[:39], STAMPS[:39], False, True),
        ("name", np.concatenate([TURNS[:38], [1.0, 0.0]]), STAMPS, False, False),
        ("name", np.tile([0.0, 1.0, 0.0, 2.0], 20), np.arange(80.0), False, False),
        ("kanal", np.repeat(np.arange(64.0), 16), None, False, True), ("kanal", np.repeat(np.arange(65.0), 16), None, False, False),
    ],
)  # fmt: skip
def test_lines_are_mark_responses_by_their_names_and_times(heading, codes, stamps, are_numbers, expected):
    words = [f"{k}" for k in range(70)]
    assert long_table._part(Labels(heading, codes, words, are_numbers), stamps) is expected


def table(values=None, stamps=None, **details):
    channel = Channel("v", np.arange(40.0) if values is None else values, stamps=stamps, **details)
    return Record("a.csv", "text", (channel,))


def test_lines_without_a_name_are_counted():
    codes = TURNS.copy()
    codes[[5, 8, 9]] = NAN
    found = as_long_table(table(step=0.5, start=3.0, unit="V"), [Labels("kanal", codes, ["A", "B"])])
    assert [(c.name, c.values.size, c.step, c.start, c.unit) for c in found.channels] == [
        ("A", 19, 0.5, 3.0, "V"), ("B", 18, 0.5, 3.0, "V"),
    ]  # fmt: skip
    assert [(one.code, one.value) for one in found.findings] == [("label-missing", 3.0)]
    shots = BLOCKS.copy()
    shots[[0, 39]] = NAN
    found = as_long_table(table(stamps=STAMPS % 20), [Labels("shot", shots, ["1", "2"])])
    assert [one.channels[0].values.size for one in (found, *found.further)] == [19, 19]
    assert [one.channels[0].start for one in (found, *found.further)] == [1.0, 0.0]
    assert found.findings[0].value == 2.0
    assert as_long_table(table(), [Labels("name", codes, ["A", "B"])]) is None
    assert as_long_table(Record("a.csv", "text", ()), []) is None


def test_each_channel_has_its_own_unit_and_values_keep_their_names():
    two = Record("a.csv", "text", (Channel("v", np.arange(40.0), 0.5, unit="g"), Channel("w", -np.arange(40.0), 0.5)))
    labels = [Labels("kanal", TURNS, ["A", "B"]), Labels("unit", 1.0 - TURNS, ["N", "V"])]
    found = as_long_table(two, labels)
    assert [(c.name, c.unit, c.values[1]) for c in found.channels] == [
        ("A v", "V", 2.0), ("A w", "V", -2.0), ("B v", "N", 3.0), ("B w", "N", -3.0),
    ]  # fmt: skip
    with pytest.raises(InputError, match="one unit for all lines of A"):
        as_long_table(two, [labels[0], Labels("unit", BLOCKS, ["N", "V"])])
    blank = as_long_table(two, [labels[0], Labels("unit", np.where(TURNS > 0.0, NAN, 0.0), ["N"])])
    assert [c.unit for c in blank.channels] == ["N", "N", "", ""]


def test_channels_asked_for_and_a_rate_hold_in_all_measurements():
    shots = as_long_table(table(stamps=STAMPS % 20), [Labels("shot", BLOCKS, ["1", "2"])])
    found = as_asked(shots, Options(rate=8.0))
    for one in (found, *found.further):
        assert [(c.step, c.start, c.stamps, c.values.size) for c in one.channels] == [(0.125, 0.0, None, 20)]
        assert (one.findings[-1].code, one.findings[-1].value) == ("long-table", 1.0)


# Measurements


@pytest.mark.parametrize(
    ("stamps", "places"),
    [
        (np.tile(np.arange(16.0), 2), [16]), (np.tile(np.arange(15.0), 2), []), (np.concatenate([np.arange(20.0), np.arange(15.0)]), []),
        (np.concatenate([np.arange(21.0), 10.0 + np.arange(20.0)]), [21]), (np.concatenate([np.arange(21.0), 10.1 + np.arange(20.0)]), []),
        (np.concatenate([5.0 + np.arange(21.0), 15.0 + np.arange(20.0)]), [21]), (np.arange(40.0), []),
        (np.concatenate([5.0 + np.arange(21.0), 15.1 + np.arange(20.0)]), []),
    ],
)  # fmt: skip
def test_time_begins_anew_where_it_falls_back_by_half_of_a_piece(stamps, places):
    assert restarts(stamps) == places


def test_a_record_is_parted_where_all_its_clocks_begin_anew():
    stamps = np.tile(3.0 + np.arange(20.0), 2)
    late = np.concatenate([np.arange(21.0), np.arange(19.0)])
    values = np.arange(40.0)

    def of(*clocks, sizes=(40, 40)):
        return Record(
            "a",
            "text",
            tuple(
                Channel(f"{k}", values[:n], 1.0, 9.0, "", s)
                for k, (s, n) in enumerate(zip(clocks, sizes, strict=False))
            ),
        )

    both = apart(of(stamps, stamps.copy()))
    assert [[c.values[0] for c in one.channels] for one in (both, *both.further)] == [[0.0, 0.0], [20.0, 20.0]]
    assert [one.channels[1].start for one in (both, *both.further)] == [3.0, 3.0]
    for whole in (of(stamps, late), of(stamps, None), of(np.arange(40.0)), of(stamps, stamps, sizes=(40, 39)), of()):
        assert apart(whole) is whole


def test_more_measurements_than_the_most_are_refused(monkeypatch):
    monkeypatch.setattr(readers, "MOST_MEASUREMENTS", 2)
    whole = Record("a", "text", (Channel("a", np.arange(9.0), 1.0, 5.0), Channel("b", np.arange(8.0), 1.0, 5.0)))
    found = readers.parted(whole, [4])
    assert [[c.values.size for c in one.channels] for one in (found, *found.further)] == [[4, 4], [5, 4]]
    assert found.further[0].channels[0].start == 5.0
    with pytest.raises(InputError, match="it has 3: split it"):
        readers.parted(whole, [3, 6])


@pytest.mark.parametrize(
    ("step", "stamps", "fine"),
    [
        (1e-15, None, True), (0.9e-15, None, False), (1e6, None, True), (1.1e6, None, False), (-1.1e6, None, False),
        (-1e-16, None, False), (0.0, None, True), (NAN, None, True), (1.0, [0.0, 1e6, 2.1e6], False), (1.0, [0.0, 2e6], False),
        (1.0, [0.0, 5e-16, 1.9e-15], False), (1e9, [0.0, 1.0, 2.0], True), (1e9, [0.0], False), (1.0, [1e7, 1e7 + 1.0], True),
    ],
)  # fmt: skip
def test_steps_that_no_recorder_takes_are_refused(step, stamps, fine):
    stamps = None if stamps is None else np.array(stamps)
    record = Record("a", "text", (Channel("a", np.zeros(3), step, stamps=stamps),))
    if fine:
        readers._check_steps(record)
    else:
        with pytest.raises(InputError, match="between two samples"):
            readers._check_steps(record)


@pytest.mark.parametrize("rate", [1e-6, 0.999e15])
def test_rates_at_either_end_are_taken_and_no_others(tmp_path, rate):
    (tmp_path / "a.csv").write_text("a\n1.5\n2.5\n3.5\n")
    (record,) = read_measurements(tmp_path / "a.csv", Options(rate=rate))
    assert record.channels[0].step == 1.0 / rate
    with pytest.raises(InputError, match="a sampling rate of 1e-06 to 1e"):
        read_measurements(tmp_path / "a.csv", Options(rate=rate * (0.99 if rate < 1.0 else 1.01)))


def test_a_folder_names_the_ending_that_most_of_its_files_have(tmp_path):
    for name in ("a.csv", "b.csv", "c.txt", "none"):
        (tmp_path / name).touch()
    (tmp_path / "d.txt").mkdir()
    (tmp_path / "e.txt").mkdir()
    assert readers._of_folder(tmp_path) == f'this is a folder; name its files: "{tmp_path}/*.csv"'
    (tmp_path / "f.txt").touch()
    assert readers._of_folder(tmp_path).endswith('*.txt"')


@pytest.mark.parametrize(("content", "hint"), [(b"", "it is empty"), (b"\0 \r\n\t", "zeros or blanks")])
def test_files_of_nothing_are_refused(tmp_path, content, hint):
    (tmp_path / "a").write_bytes(content)
    with pytest.raises(InputError, match=hint):
        read_measurements(tmp_path / "a")


def test_measurements_are_numbered_from_one(tmp_path):
    lines = "".join(f"{k},{k * k}\n" for k in range(20))
    (tmp_path / "a.csv").write_text("time,a\n" + lines * 3)
    found = read_measurements(tmp_path / "a.csv")
    assert [record.path.rpartition(": ")[2] for record in found] == [f"measurement {k}" for k in (1, 2, 3)]
    assert {record.findings[0].value for record in found} == {3.0}
    assert read_measurements(tmp_path / "a.csv", Options(measurement=3))[0].path == found[2].path
    for wrong in (0, 4):
        with pytest.raises(InputError, match="it holds 3 measurements"):
            read_measurements(tmp_path / "a.csv", Options(measurement=wrong))


def test_a_file_of_one_measurement_has_no_second(tmp_path):
    (tmp_path / "a.csv").write_text("time,a\n" + "".join(f"{k},{k * k}\n" for k in range(20)))
    assert read_measurements(tmp_path / "a.csv", Options(measurement=1))[0].path == str(tmp_path / "a.csv")
    with pytest.raises(InputError, match="it holds one measurement"):
        read_measurements(tmp_path / "a.csv", Options(measurement=2))


# The child process


def test_a_child_has_time_and_memory_by_the_size_of_its_file(tmp_path, monkeypatch):
    """20 s and 1 us a byte, up to the whole second; half a GiB and 100 bytes a byte, up to twice the largest array."""
    path = tmp_path / "a"
    path.write_bytes(b"x" * 1500)
    told = {}

    def run(command, **how):
        told.update(json.loads(how["input"]), timeout=how["timeout"])
        answer = {"channels": [], "stamps": 0, "findings": []}
        (Path(told["folder"]) / "answer.json").write_text(json.dumps(answer))

    monkeypatch.setattr(child.subprocess, "run", run)
    child.isolated("hdf", path, Options(channels=("b",)))
    assert (told["memory"], told["seconds"], told["reader"]) == (2**29 + 150000, 21, "hdf")
    assert told["timeout"] == pytest.approx(20.0015, rel=1e-9)
    monkeypatch.setattr(child, "LARGEST_ARRAY", 2**28)
    child.isolated("hdf", path, Options())
    assert told["memory"] == 2**29


def test_channels_come_back_from_a_child_as_they_were(tmp_path):
    stamps = np.array([1.0, 2.0, 4.0])
    other = stamps + 1.0
    unread = np.broadcast_to(np.float64(NAN), (3,))
    channels = (
        Channel("a", np.arange(3.0), 0.5, 7.0, "g", stamps), Channel("b", unread, 0.25, 8.0, "N", stamps),
        Channel("c", -np.arange(3.0), 0.5, 9.0, "", other), Channel("d", np.array([5.0]), 0.5), Channel("e", unread[:1], 2.0), Channel("f", unread[:2], 3.0),
    )  # fmt: skip
    record = Record("a", "hdf", channels, common.left_out(["x"]))
    answer = json.loads(json.dumps(child._written(record, tmp_path)))
    assert (answer["stamps"], [c["size"] for c in answer["channels"]]) == (2, [None, 3, None, None, None, 2])
    back = child._record(tmp_path / "file", "hdf", tmp_path, answer)
    for one, came in zip(channels, back.channels, strict=True):
        np.testing.assert_equal(came.values, one.values)
        np.testing.assert_equal(
            (came.name, came.step, came.start, came.unit), (one.name, one.step, one.start, one.unit)
        )
        np.testing.assert_equal(came.stamps, one.stamps)
    assert back.channels[1].values.strides == (0,)
    assert back.channels[0].stamps is back.channels[1].stamps
    assert [(one.code, one.message, one.value) for one in back.findings] == [
        ("array-ignored", "1 arrays are no channels: x", 1)
    ]


def test_an_error_of_a_child_is_that_of_its_file(tmp_path):
    for field, got in (("FILE", "here"), ("--time", "x")):
        answer = {"error": {"field": field, "got": "x", "allowed": "y", "hint": "z"}}
        with pytest.raises(InputError) as caught:
            child._record(tmp_path / "here", "hdf", tmp_path, answer)
        assert str(caught.value.got).endswith(got)


def test_a_clock_that_is_uneven_has_the_usual_step():
    """Numbers of a binary file have no last digit that would excuse what they stray."""
    uneven = np.array([3.0, 3.001, 3.002, 3.0035, 3.0045])
    stamps, step, start = common._stamps(ArrayColumn("time", 5, lambda: uneven), None)
    assert (stamps.tolist(), step, start) == (uneven.tolist(), pytest.approx(1e-3, rel=1e-9), 3.0)


@pytest.mark.skipif(sys.platform == "win32", reason="it has no such limits")
def test_a_child_bounds_its_memory_and_time(monkeypatch):
    import resource

    set_to = {}
    monkeypatch.setattr(resource, "setrlimit", lambda what, limits: set_to.update({what: limits}))
    child._limit(7000, 30)
    assert set_to == {resource.RLIMIT_DATA: (7000, 7000), resource.RLIMIT_CPU: (30, 30), resource.RLIMIT_CORE: (0, 0)}


def test_channels_are_called_by_number_name_and_unit():
    record = Record(
        "a.csv",
        "text",
        (Channel("bar", np.zeros(5), 0.25, 3.0, "g"), Channel("2", np.ones(3), unit="N"), Channel("bar", np.ones(2))),
    )
    assert [
        record.channel(w) is record.channels[k] for w, k in ((1, 0), ("3", 2), ("bar", 0), ("bar [g]", 0), ("2 (N)", 1))
    ] == [True] * 5
    assert (record.channels[0].sampling_rate, record.channels[0].duration) == (4.0, 1.0)
    assert record.channels[0].time.tolist() == [3.0, 3.25, 3.5, 3.75, 4.0]
    with pytest.raises(InputError, match="a number from 1 to 3"):
        record.channel(4)
