"""A file of twice the size takes twice the work: no small one keeps a program busy for minutes, or takes gigabytes."""

import dataclasses
import functools
import math
import tracemalloc
from unittest.mock import Mock

import numpy as np
import pytest

from strikewave.base.errors import InputError
from strikewave.records import Channel, FileReading, Record, Request, compare, find_pulses, read_file, summed
from strikewave.records.contacts import Baseline, find_boxes
from strikewave.records.health import examine, limits
from strikewave.records.health.limits import BlowShape
from strikewave.records.health.sampled_record import BlowRecord
from strikewave.records.readers import Options, common, read_record, recorders
from strikewave.records.readers.common import ArrayColumn, assemble, one_each

from ..counted_work import lines_run

LINEAR = 2.3
"""Most that twice as much may take of the work: 2 but for what a file costs by itself; what is quadratic takes 4."""


def write_csv(path, columns):
    rows = [",".join(f"{row + 1e-3 * k:.3f}" for k in range(columns)) for row in range(6)]
    path.write_text("\n".join(rows) + "\n")


def write_parquet(path, columns):
    import pyarrow as pa
    import pyarrow.parquet as pq

    pq.write_table(pa.table({f"column {k}": np.arange(6.0) for k in range(columns)}), path)


@pytest.mark.verify
@pytest.mark.parametrize("write", [write_csv, write_parquet])
def test_work_grows_with_the_number_of_columns(tmp_path, write):
    lines, bytes_held = [], []
    for columns in (8, 200, 400):  # the first one imports what is needed
        path = tmp_path / f"{columns} columns"
        write(path, columns)
        lines.append(lines_run(read_record, path))
        tracemalloc.start()
        read_record(path)
        bytes_held.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
    assert lines[2] / lines[1] < LINEAR
    assert bytes_held[2] / bytes_held[1] < LINEAR


@pytest.mark.parametrize("name", ["a", "time"])
def test_work_grows_with_the_number_of_arrays_of_one_name(tmp_path, name):
    def arrays(count):
        named = [ArrayColumn(name, 6, lambda: np.arange(6.0), folder=f"{k}/") for k in range(count)]
        return [*named, ArrayColumn("b", 6, lambda: np.arange(6.0), step=1e-6, folder="0/")]

    lines = [lines_run(assemble, tmp_path, "any", arrays(count), Options()) for count in (200, 400)]
    assert lines[1] / lines[0] < LINEAR


def test_names_that_come_again_get_the_first_number_that_is_free():
    assert one_each(["a", "a (2)", "a", "a", "a (2)"]) == ["a", "a (2)", "a (3)", "a (4)", "a (2) (2)"]


def test_parquet_of_too_many_columns_is_refused_before_one_is_looked_at(tmp_path, monkeypatch):
    monkeypatch.setattr(common, "MOST_ARRAYS", 5)
    monkeypatch.setattr("strikewave.records.readers.tables._numeric", None)
    write_parquet(tmp_path / "wide", 6)
    with pytest.raises(InputError, match="a file with at most 5 arrays"):
        read_record(tmp_path / "wide")


def test_tdms_of_many_segments_is_read_within_limits(tmp_path, monkeypatch):
    """Its first segments alone are counted; what is read is the same either way."""
    nptdms = pytest.importorskip("nptdms")
    with nptdms.TdmsWriter(str(tmp_path / "many")) as file:
        for k in range(12):
            file.write_segment([nptdms.ChannelObject("g", "b", np.arange(5.0) + k, {"wf_increment": 1e-6})])
    whole = read_record(tmp_path / "many").channels[0].values
    asked = []
    monkeypatch.setattr(
        recorders, "isolated", lambda *words: asked.append(words[0]) or recorders.parse_tdms(*words[1:])
    )
    for most, in_child in ((13, []), (12, []), (11, ["tdms"]), (1, ["tdms"])):
        asked.clear()
        monkeypatch.setattr(recorders, "MANY_SEGMENTS", most)
        assert np.array_equal(read_record(tmp_path / "many").channels[0].values, whole)
        assert asked == in_child


def test_work_grows_with_the_number_of_blows():
    def spikes(count):
        values = np.random.default_rng(1).normal(size=600 * count)
        for k in range(count):
            values[600 * k + 200 : 600 * k + 240] += 500.0 * np.sin(np.linspace(0.0, np.pi, 40))
        return values

    def found(values):
        assert len(find_boxes(values, Baseline(0.0, 0.0), 1.0)[1]) == values.size // 600

    lines = [lines_run(found, spikes(count)) for count in (50, 100, 200)]
    assert lines[2] / lines[1] < LINEAR


def test_work_of_reading_grows_with_the_number_of_blows():
    def read(count):
        values = np.random.default_rng(1).normal(size=300 * count)
        for k in range(count):
            values[300 * k + 100 : 300 * k + 120] += 500.0 * np.sin(np.linspace(0.0, np.pi, 20))
        [reading] = read_file(Record("a.csv", "text", (Channel("c", values, 1e-6),)), {}, Request()).channels
        assert len(reading.pulses) == count
        assert len(reading.intervals) == count - 1

    lines = [lines_run(read, count) for count in (5, 20, 40)]
    assert lines[2] / lines[1] < LINEAR


@pytest.mark.parametrize("ends", [[1.0, 2.0, 3.0], [3.0, 2.5, 2.7]])
def test_the_first_blow_that_ends_after_another_is_the_next(ends):
    """As a search through all blows finds it, whether or not one lies within another."""
    pulses = tuple(Mock(begin=0.5 + k, end=end) for k, end in enumerate(ends))
    record = BlowRecord(np.zeros(20), 1.0, pulses=pulses)
    for pulse in pulses:
        later = [other.begin for other in pulses if other.end > pulse.end]
        assert record.next_begin(pulse) == min(later, default=math.inf)


@pytest.mark.parametrize("measured", ["tip", "usual_tip", "flanks"])
def test_tip_and_sides_of_a_blow_are_measured_once(monkeypatch, measured):
    """Flat tops and limited slopes are both seen at them."""
    asked = []
    figure = vars(BlowShape)[measured].func
    counted = functools.cached_property(lambda shape: asked.append(measured) or figure(shape))
    counted.__set_name__(BlowShape, measured)
    monkeypatch.setattr(BlowShape, measured, counted)
    values = 100.0 * np.sin(np.pi * np.clip(np.arange(900.0) / 80.0 - 5.0, 0.0, 1.0))
    record = BlowRecord(values, 1e-6, pulses=tuple(find_pulses(values, 1e-6)))
    assert not examine(record, limits.flat_top, limits.bent_tip, limits.straight_side, limits.corner)
    assert asked == [measured]


def test_work_of_a_campaign_grows_with_the_number_of_channels():
    values = 1000.0 * np.exp(-0.5 * ((np.arange(2000) - 700) / 20.0) ** 2) + np.random.default_rng(1).normal(size=2000)
    [reading] = read_file(Record("a.csv", "text", (Channel("c", values, 1e-5, unit="g"),)), {}, Request()).channels

    def compared(count):
        channels = tuple(dataclasses.replace(reading, number=k) for k in range(1, count + 1))
        files = compare([FileReading(name, "text", channels) for name in "abc"])
        assert all(summed(files, k) for k in range(1, count + 1))

    lines = [lines_run(compared, count) for count in (4, 40, 80)]
    assert lines[2] / lines[1] < LINEAR
