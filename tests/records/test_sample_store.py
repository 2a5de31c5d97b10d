"""Samples laid down on disk read as before, take no memory, and stay where they are where there is no disk."""

import mmap
import tempfile
import tracemalloc
from pathlib import Path

import numpy as np
import pytest

from strikewave.records import Channel, FileReading, SampleStore, sample_store
from strikewave.records.calibration import ChannelCalibration
from strikewave.records.reading import ChannelReading


def reading(*histories):
    channels = [
        ChannelReading(Channel(f"{k}", values, 1e-5), k, (), (), ChannelCalibration())
        for k, values in enumerate(histories, start=1)
    ]
    return FileReading("a.csv", "text", tuple(channels))


def histories(file):
    return [one.channel.values for one in file.channels]


def test_samples_come_back_to_the_last_bit_also_when_the_store_is_gone(monkeypatch):
    monkeypatch.setattr(sample_store, "PART", 4096)  # so that files end in the middle, and one channel is too long
    random = np.random.default_rng(1)
    sizes = [(300, 5), (511, 512), (0, 513), (7, 20_000)]
    true = [[random.normal(size=n) for n in pair] for pair in sizes]
    with SampleStore(in_memory=400) as store:
        kept = [store.kept(reading(*pair)) for pair in true]
        assert histories(kept[3])[1].tobytes() == true[3][1].tobytes()
        store.forget()
    del store
    for file, pair in zip(kept, true, strict=True):
        assert [values.tobytes() for values in histories(file)] == [values.tobytes() for values in pair]
    assert histories(kept[0])[0] is true[0][0]  # the first 400 samples stay in memory


def test_memory_does_not_grow_with_the_number_of_records():
    size = 20_000
    tracemalloc.start()
    with SampleStore(in_memory=0) as store:
        kept = [store.kept(reading(np.full(size, float(k)))) for k in range(100)]
    held = tracemalloc.get_traced_memory()[0]
    tracemalloc.stop()
    assert held < 2 * 8 * size  # of 100 records; all that is left are the readings themselves
    assert [histories(file)[0][-1] for file in kept] == list(map(float, range(100)))


@pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="only Linux tells how much of a file is in memory")
def test_what_was_read_back_leaves_memory_when_it_is_forgotten():
    def mapped():
        return int(Path("/proc/self/statm").read_text().split()[2]) * mmap.PAGESIZE  # pages of files that are in memory

    size = 1_000_000
    with SampleStore(in_memory=0) as store:
        values = histories(store.kept(reading(np.arange(float(size)))))[0]
        before = mapped()
        total = float(values.sum())
        assert mapped() - before > 0.9 * 8 * size
        store.forget()
        assert mapped() - before < 0.1 * 8 * size
    assert float(values.sum()) == total


def test_samples_stay_in_memory_where_the_disk_takes_none(monkeypatch):
    def full():
        raise OSError(28, "no space left on device")

    monkeypatch.setattr(tempfile, "TemporaryFile", full)
    values = np.arange(5.0)
    assert histories(SampleStore(in_memory=0).kept(reading(values)))[0] is values
