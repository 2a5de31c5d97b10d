"""Every binary format, written by its own library or byte by byte from its layout, is read back to the bit."""

import importlib
import logging
import struct
import sys
import tracemalloc
import zipfile

import numpy as np
import pytest

from strikewave.base.errors import InputError
from strikewave.records.readers import FORMATS, Options, common, read_record

from .samples import BOARD, FRAME, NEEDS, RAW, SAMPLES, SIZE, START, STEP, TIME, uff_set

READERS = {form: importlib.import_module(f"strikewave.records.readers.{module}") for form, module in FORMATS.items()}


@pytest.fixture
def sample(tmp_path):
    def write(form, **how):
        if form in NEEDS:
            pytest.importorskip(NEEDS[form])
        SAMPLES[form](tmp_path / f"blow.{form}", **how)
        return tmp_path / f"blow.{form}"

    return write


def same(channel, values, step=STEP, start=START, unit="g", rough=1e-12):
    assert channel.values.dtype == np.float64
    assert np.array_equal(channel.values, values)
    assert channel.step == pytest.approx(step, rel=rough)
    assert channel.start == pytest.approx(start, rel=rough)
    assert channel.unit == unit


def names(record):
    return [channel.name for channel in record.channels]


def test_every_format_has_a_sample():
    assert set(SAMPLES) == set(FORMATS)


def test_hdf(sample):
    record = read_record(sample("hdf"))
    assert (record.format, names(record)) == ("hdf", ["blow 1/board", "blow 1/frame"])
    same(record.channels[0], BOARD)
    same(record.channels[1], FRAME, unit="")
    assert np.array_equal(record.channels[0].stamps, TIME)
    assert [finding.code for finding in record.findings] in ([], ["array-ignored"])


def test_matlab_7_3(tmp_path):
    """It is HDF5 behind a user block of 512 bytes; texts are arrays of small integers marked as such."""
    import h5py

    path = tmp_path / "blow.mat"
    with h5py.File(path, "w", userblock_size=512) as file:
        file["run/data"] = np.vstack([BOARD, FRAME])
        file["run/fs"] = [[1.0 / STEP]]
        file["run/name"] = np.full((4, 1), 65, np.uint16)
        file["run/name"].attrs["MATLAB_class"] = np.bytes_("char")
        file["run/cells"] = h5py.SoftLink("/run/data")
    with path.open("r+b") as file:
        file.write(b"MATLAB 7.3 MAT-file".ljust(124) + b"\x00\x02IM")
    record = read_record(path)
    assert (record.format, names(record)) == ("hdf", ["run/data 1", "run/data 2"])
    same(record.channels[1], FRAME, start=0.0, unit="")


def test_hdf_links_that_leave_the_file_are_not_followed(tmp_path):
    import h5py

    with h5py.File(tmp_path / "other.h5", "w") as file:
        file["secret"] = BOARD
    np.arange(8.0).tofile(tmp_path / "raw.bin")
    with h5py.File(tmp_path / "blow.h5", "w") as file:
        file["frame"] = FRAME
        file["board"] = h5py.ExternalLink(str(tmp_path / "other.h5"), "secret")
        file.create_dataset("raw", (8,), "f8", external=[(str(tmp_path / "raw.bin"), 0, 64)])
        layout = h5py.VirtualLayout((SIZE,), "f8")
        layout[:] = h5py.VirtualSource(str(tmp_path / "other.h5"), "secret", (SIZE,))
        file.create_virtual_dataset("virtual", layout)
    assert names(read_record(tmp_path / "blow.h5")) == ["frame"]


def test_hdf_scale_offset_fill_and_tables(tmp_path):
    import h5py

    table = np.zeros(SIZE, [("time", "f8"), ("board", "i2"), ("name", "S4")])
    table["time"], table["board"] = TIME * 1e3, np.arange(SIZE)
    with h5py.File(tmp_path / "blow.h5", "w") as file:
        file["table"] = table
        packed = file.create_dataset("packed", data=np.arange(7, dtype=np.int16))
        packed.attrs.update({"scale_factor": 0.5, "add_offset": 1.0, "_FillValue": np.int16(3), "dt": 0.25})
    record = read_record(tmp_path / "blow.h5")
    assert names(record) == ["packed", "table/board"]
    assert record.channels[0].values.tolist()[:3] == [1.0, 1.5, 2.0]
    assert np.flatnonzero(np.isnan(record.channels[0].values)).tolist() == [3]
    assert record.channels[0].step == 0.25
    same(record.channels[1], np.arange(SIZE), step=1e3 * STEP, start=1e3 * START, unit="")


def test_a_solution_of_strikewave(tmp_path):
    """What `strikewave run` saves: histories over time are channels, those of single blows and taps are not."""
    import xarray

    variables = {
        "force": ("time", BOARD, {"units": "N"}),
        "pulse": (("blow", "pulse_time"), np.zeros((2, 7))),
        "blow_speed": ("blow", [1.0, 2.0]),
        "blow_kind": ("blow", np.array(["a", "b"], object)),
    }
    coordinates = {"time": ("time", TIME, {"units": "s"}), "pulse_time": np.arange(7.0), "blow": [1, 2]}
    xarray.Dataset(variables, coordinates).to_netcdf(tmp_path / "solution.nc", engine="h5netcdf")
    record = read_record(tmp_path / "solution.nc")
    assert names(record) == ["force"]
    same(record.channels[0], BOARD, unit="N")
    assert {(finding.code, finding.severity) for finding in record.findings} == {("array-ignored", "good")}


def test_pandas_tables(tmp_path):
    """As pandas lays out a table of floats in its fixed format."""
    import h5py

    with h5py.File(tmp_path / "blow.h5", "w") as file:
        file["df/axis1"] = TIME
        file["df/block0_items"] = np.array([b"board", b"frame"])
        file["df/block0_values"] = np.column_stack([BOARD, FRAME])
    record = read_record(tmp_path / "blow.h5")
    assert names(record) == ["df/board", "df/frame"]
    same(record.channels[1], FRAME, unit="")


@pytest.mark.parametrize("how", [{"do_compression": True}, {"do_compression": False}, {"format": "4"}])
def test_matlab(tmp_path, how):
    from scipy.io import savemat

    savemat(tmp_path / "blow.mat", {"time": TIME, "both": np.column_stack([BOARD, FRAME]), "gain": 3.0}, **how)
    record = read_record(tmp_path / "blow.mat")
    assert (record.format, names(record)) == ("mat", ["both 1", "both 2"])
    same(record.channels[0], BOARD, unit="")
    same(record.channels[1], FRAME, unit="")


def test_matlab_structs_cells_and_texts(tmp_path):
    from scipy.io import savemat

    cells = np.empty(2, object)
    cells[:] = [BOARD, "text"]
    run = {"fs": 1.0 / STEP, "board": (BOARD * 16).astype(np.int16), "deeper": {"frame": FRAME}, "cells": cells}
    savemat(tmp_path / "blow.mat", {"run": run, "name": "text", "z": np.array([1j, 2.0])})
    record = read_record(tmp_path / "blow.mat")
    assert names(record) == ["run/board"]
    same(record.channels[0], BOARD * 16, start=0.0, unit="")
    assert "run/cells" in record.findings[0].message


def test_netcdf(sample):
    record = read_record(sample("netcdf"))
    assert (record.format, names(record)) == ("netcdf", ["board", "frame"])
    same(record.channels[0], BOARD)
    same(record.channels[1], FRAME)


def test_parquet(sample):
    record = read_record(sample("parquet"))
    assert (record.format, names(record)) == ("parquet", ["board", "frame"])
    same(record.channels[0], BOARD)
    same(record.channels[1], FRAME)


@pytest.mark.parametrize("kind", ["u1", "i2", "i4", "f4", "f8"])
def test_wav(sample, kind):
    raw = np.arange(SIZE).reshape(-1, 2) * 0.25 if kind[0] == "f" else np.arange(SIZE).reshape(-1, 2) // 2 + 20
    record = read_record(sample("wav", values=raw.astype(kind)))
    scale = {"u1": 128.0, "i2": 2.0**15, "i4": 2.0**31}.get(kind, 1.0)
    same(record.channel(2), (raw[:, 1] - (128.0 if kind == "u1" else 0.0)) / scale, 1.0 / 96000, 0.0, "")
    assert [f.code for f in record.findings] == ["wav-scale"] * (kind[0] != "f")


def test_wav_of_24_bits_by_hand(tmp_path):
    values = [0, 1, -1, 2**23 - 1, -(2**23)]
    data = b"".join(value.to_bytes(3, "little", signed=True) for value in values)
    form = struct.pack("<HHIIHH", 1, 1, 1000, 3000, 3, 24)
    chunks = b"fmt " + struct.pack("<I", 16) + form + b"LIST\x02\0\0\0ab" + b"data" + struct.pack("<I", len(data))
    (tmp_path / "a.wav").write_bytes(b"RIFF" + struct.pack("<I", 0) + b"WAVE" + chunks + data)
    record = read_record(tmp_path / "a.wav")
    assert record.channels[0].values.tolist() == [value / 2**23 for value in values]
    assert record.channels[0].step == 1e-3
    (tmp_path / "a.wav").write_bytes((tmp_path / "a.wav").read_bytes()[:-4])
    assert [f.code for f in read_record(tmp_path / "a.wav").findings] == ["wav-scale", "cut-off"]


@pytest.mark.parametrize("binary", [0, 1])
def test_uff(sample, binary):
    record = read_record(sample("uff", binary=binary))
    assert (record.format, names(record)) == ("uff", ["board", "frame"])
    same(record.channels[0], BOARD, rough=1e-5)  # the header writes six digits
    same(record.channels[1], FRAME, rough=1e-5)
    assert "data set 58" in record.findings[0].message


def test_uff_with_uneven_abscissa(tmp_path):
    import pyuff

    pyuff.UFF(str(tmp_path / "a.uff")).write_sets([uff_set(0, spacing=0)], "overwrite")
    same(read_record(tmp_path / "a.uff").channels[0], BOARD, rough=1e-5)


def test_tdms(sample):
    record = read_record(sample("tdms"))
    assert (record.format, names(record)) == ("tdms", ["blow/board", "blow/frame"])
    same(record.channels[0], BOARD)
    same(record.channels[1], FRAME * 16)
    assert record.channels[0].stamps is None


def write_waveforms(path, channels):
    """Write a TDMS file of (group, name, values, properties), as `nptdms` lays waveforms out."""
    nptdms = pytest.importorskip("nptdms")
    with nptdms.TdmsWriter(str(path)) as file:
        file.write_segment([nptdms.ChannelObject(*channel) for channel in channels])
    return path


def waveform(start, step=STEP, **others):
    return {"wf_increment": step, "wf_start_offset": 0.0, "wf_start_time": start, **others}


NOON = np.datetime64("2026-01-05T12:00:00.000000", "us")
LATER = NOON + np.timedelta64(3000, "us")


def test_tdms_waveforms_are_laid_on_one_clock_by_their_start_times(tmp_path):
    channels = [("a", "board", BOARD, waveform(LATER)), ("b", "frame", FRAME, waveform(NOON, 2.0 * STEP))]
    record = read_record(write_waveforms(tmp_path / "a.tdms", channels))
    assert [(c.start, c.step) for c in record.channels] == [(0.003, STEP), (0.0, 2.0 * STEP)]
    assert [(f.code, f.value) for f in record.findings] == [("start-times", 0.003)]


@pytest.mark.parametrize(
    ("apart", "words", "severity"),
    [
        (np.timedelta64(3, "ms"), "later: a/board by 3\xa0ms", "good"),
        (np.timedelta64(3600, "s"), "later: a/board by 1\xa0h", "good"),
        (np.timedelta64(36, "h"), "later: a/board by 1.5\xa0d; starts more than an hour apart", "suspect"),
    ],
)
def test_channels_that_begin_more_than_an_hour_apart_are_suspect(tmp_path, apart, words, severity):
    channels = [("a", "board", BOARD, waveform(NOON + apart)), ("b", "frame", FRAME, waveform(NOON))]
    (notice,) = read_record(write_waveforms(tmp_path / "a.tdms", channels)).findings
    assert notice.message.partition("one clock; ")[2].startswith(words)
    assert notice.severity == severity


def test_tdms_start_times_finer_than_a_microsecond_count(tmp_path):
    nptdms = pytest.importorskip("nptdms")
    times = [nptdms.timestamp.TdmsTimestamp(3850761600, fraction) for fraction in (0, 2**64 // 10**8)]
    channels = [("a", name, BOARD, waveform(time)) for name, time in zip("xy", times, strict=True)]
    record = read_record(write_waveforms(tmp_path / "a.tdms", channels))
    assert record.channels[1].start == pytest.approx(1e-8, abs=1e-12)


@pytest.mark.parametrize("unset", [np.datetime64("1904-01-01T00:00:00", "us"), "no time"])
def test_a_tdms_start_time_that_was_never_set_moves_nothing_and_is_reported(tmp_path, unset):
    channels = [
        ("a", "x", BOARD, waveform(unset)),
        ("a", "y", BOARD, waveform(NOON)),
        ("a", "z", BOARD, waveform(LATER)),
    ]
    record = read_record(write_waveforms(tmp_path / "a.tdms", channels))
    assert [channel.start for channel in record.channels] == [0.0, 0.0, 0.003]
    assert [f.code for f in record.findings] == ["start-times", "start-unknown"]


def test_tdms_channels_of_clock_times_keep_the_time_between_groups(tmp_path):
    stamps = NOON + np.arange(SIZE) * np.timedelta64(20, "us")
    late = stamps + np.timedelta64(3000, "us")
    channels = [
        ("a", "time", stamps, {}),
        ("a", "board", BOARD, {}),
        ("b", "time", late, {}),
        ("b", "frame", FRAME, {}),
    ]
    record = read_record(write_waveforms(tmp_path / "a.tdms", channels))
    assert [channel.start for channel in record.channels] == pytest.approx([0.0, 0.003], abs=1e-12)
    assert record.channels[1].step == pytest.approx(2e-5, rel=1e-9)


def test_a_tdms_grid_is_in_the_unit_that_the_file_states_and_a_spectrum_is_no_record(tmp_path):
    channels = [("a", "x", BOARD, waveform(NOON, 0.02, wf_xunit_string="ms"))]
    channels += [("a", "y", BOARD, waveform(NOON, 5.0, wf_xunit_string="Hz"))]
    record = read_record(write_waveforms(tmp_path / "a.tdms", channels))
    assert [(c.name, c.step) for c in record.channels] == [("a/x", pytest.approx(2e-5, rel=1e-12))]
    assert [f.code for f in record.findings] == ["array-ignored"]


@pytest.mark.parametrize("version", ["3.30", "4.10"])
def test_mdf(sample, version):
    record = read_record(sample("mdf", version=version))
    assert (record.format, names(record)) == ("mdf", ["board", "frame"])
    same(record.channels[0], BOARD)
    same(record.channels[1], FRAME)
    assert np.array_equal(record.channels[0].stamps, TIME)


def test_mdf_formulas_are_not_run(tmp_path):
    asammdf = pytest.importorskip("asammdf")
    from asammdf.blocks.conversion_utils import from_dict

    linear, formula = from_dict({"a": 0.5, "b": 1.0}), from_dict({"formula": "X1 * 2"})
    raw = np.arange(5, dtype=np.int16)
    with asammdf.MDF() as file:
        signals = [
            asammdf.Signal(raw, TIME[:5], name=name, conversion=conversion)
            for name, conversion in (("linear", linear), ("formula", formula))
        ]
        file.append(signals)
        file.save(tmp_path / "blow.mf4")
    record = read_record(tmp_path / "blow.mf4")
    assert [channel.values.tolist() for channel in record.channels] == [[1.0, 1.5, 2.0, 2.5, 3.0], [0, 1, 2, 3, 4]]
    assert [finding.code for finding in record.findings] == ["not-converted"]


def test_ide(sample):
    record = read_record(sample("ide"))
    assert record.format == "ide"
    assert [channel.unit for channel in record.channels] == ["g", "g"]
    same(record.channels[0], BOARD, 1e-3, 0.0)
    same(record.channels[1], FRAME, 1e-3, 0.0)


def test_rigol(sample):
    """By the layout: volts = (raw - 127) scale / 20 - shift + scale, here of 0.5 V a division and -0.25 V."""
    record = read_record(sample("rigol"))
    assert (record.format, names(record)) == ("rigol", ["CH1"])
    volts = (RAW.astype(float) - 127.0) * 0.5 / 20.0 + 0.25 + 0.5
    assert record.channels[0].values == pytest.approx(volts, abs=1e-15)
    assert (record.channels[0].step, record.channels[0].unit) == (4e-9, "V")
    assert record.channels[0].start == pytest.approx(5e-6 - SIZE / 2 * 4e-9, rel=1e-12)


def test_rigol_leaves_matplotlib_and_the_network_alone(sample):
    path = sample("rigol")
    import subprocess

    code = (
        "import sys; from pathlib import Path; from strikewave.records.readers import recorders, Options;"
        f"recorders.parse_rigol(Path({str(path)!r}), Options()); print({{'requests', 'matplotlib'}} & set(sys.modules))"
    )
    assert (
        subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True).stdout.strip()
        == "set()"
    )


def test_excel(sample):
    record = read_record(sample("excel"))
    assert (record.format, names(record)) == ("excel", ["board", "frame"])
    same(record.channels[0], BOARD)
    same(record.channels[1], FRAME)


def test_excel_sheets_units_below_names_and_gaps(tmp_path):
    openpyxl = pytest.importorskip("openpyxl")
    book = openpyxl.Workbook()
    for row in (["A blow"], [], ["time", "board"], ["ms", "g"], [0, 1], [1, None], [2, 3], [None, None]):
        book.active.append(row)
    book.create_sheet("notes").append(["text"])
    book.save(tmp_path / "a.xlsx")
    channel = read_record(tmp_path / "a.xlsx").channels[0]
    assert (channel.name, channel.unit, channel.step) == ("Sheet/board", "g", 1e-3)
    assert np.array_equal(channel.values, [1.0, np.nan, 3.0], equal_nan=True)


def test_excel_of_a_split_hopkinson_bar(measured):
    pytest.importorskip("openpyxl")
    record = read_record(measured("steel945-shpb") / "yao_945steel_03.xlsx")
    assert names(record) == ["incident_bar_signal", "transmission_bar_signal"]
    assert {channel.unit for channel in record.channels} == {"με"}
    assert record.channels[0].values.size == 20000
    assert record.channels[0].step == pytest.approx(3.2e-8, rel=1e-6)


def test_excel_bombs_are_refused_before_they_are_unpacked(tmp_path, monkeypatch):
    """One of 30 MB, where 16 are what any file may hold; at its own 256, writing a bomb takes a second."""
    monkeypatch.setattr(common, "FREE_BYTES", common.FREE_BYTES // 16)
    with zipfile.ZipFile(tmp_path / "a.xlsx", "w", zipfile.ZIP_DEFLATED) as packed:
        packed.writestr("[Content_Types].xml", bytes(30 * 2**20))
    tracemalloc.start()
    with pytest.raises(InputError, match="fits into memory"):
        read_record(tmp_path / "a.xlsx")
    assert tracemalloc.get_traced_memory()[1] < 16 * 2**20
    tracemalloc.stop()


@pytest.mark.parametrize("form", NEEDS)
def test_a_missing_extra_says_how_to_install_it(sample, monkeypatch, form):
    path = sample(form)
    monkeypatch.setitem(sys.modules, NEEDS[form], None)
    with pytest.raises(InputError, match=r"pip install 'strikewave\[formats\]'"):
        read_record(path)


@pytest.mark.parametrize("form", FORMATS)
def test_the_format_is_told_by_content(sample, form):
    """The test of each format reads it under its own name."""
    path = sample(form)
    records = []
    for name in ("a", "a.csv" if form == "excel" else "a.xlsx"):
        path = path.rename(path.with_name(name))
        records.append(read_record(path))
    assert [record.format for record in records] == [form, form]
    assert names(records[0]) == names(records[1])


@pytest.mark.verify
@pytest.mark.parametrize("form", sorted(set(FORMATS) - {"text", "lvm"}))
def test_rate_overrules_and_channels_not_asked_for_cost_nothing(sample, form):
    path = sample(form)
    record = read_record(path, Options(rate=50.0))
    assert {channel.step for channel in record.channels} == {0.02}
    assert all(channel.stamps is None for channel in record.channels)
    whole = read_record(path)
    some = read_record(path, Options(channels=(str(len(whole.channels)),)))
    assert names(some) == names(whole)
    assert np.array_equal(some.channels[-1].values, whole.channels[-1].values)
    for channel in some.channels[:-1]:
        assert channel.values.strides == (0,)
        assert np.isnan(channel.values[0])


def test_time_by_name_or_number(tmp_path):
    from scipy.io import savemat

    savemat(tmp_path / "a.mat", {"clock_ticks": TIME, "board": BOARD})
    for time in ("clock_ticks", "1"):
        record = read_record(tmp_path / "a.mat", Options(time=time))
        assert names(record) == ["board"]
        same(record.channels[0], BOARD, unit="")
    assert np.isnan(read_record(tmp_path / "a.mat").channels[0].step)
    with pytest.raises(InputError, match=r"--time.*did you mean \"clock_ticks\""):
        read_record(tmp_path / "a.mat", Options(time="clock_tick"))


def test_arrays_of_objects_are_refused(tmp_path):
    """NumPy's own files hold pickles; they are no known format."""
    np.save(tmp_path / "a.npy", np.array([{}], object), allow_pickle=True)
    with pytest.raises(InputError):
        read_record(tmp_path / "a.npy")


def big_wav(path, count):
    held = struct.pack(
        "<4sI4s4sIHHIIHH4sI", b"RIFF", 0, b"WAVE", b"fmt ", 16, 1, 1, 10**6, 0, 2, 16, b"data", 2 * count
    )
    with open(path, "wb") as file:
        file.write(held)
        file.truncate(len(held) + 2 * count)


def big_tdms(path, count):
    nptdms = pytest.importorskip("nptdms")
    part = np.zeros(2**20, np.float64)
    with nptdms.TdmsWriter(str(path)) as file:
        for _ in range(count // part.size):
            file.write_segment([nptdms.ChannelObject("a", "b", part, {"wf_increment": 1e-6})])


def big_hdf(path, count):
    import h5py

    with h5py.File(path, "w") as file:
        file.create_dataset("b", (count,), "f4", chunks=(2**16,)).attrs["dt"] = 1e-6
        for k in range(0, count, 2**22):
            file["b"][k : k + 2**22] = 1.0


@pytest.mark.verify
@pytest.mark.parametrize(
    ("write", "count"),
    [(big_wav, 100 * 2**20), (big_tdms, 25 * 2**20), (big_hdf, 50 * 2**20)],
    ids=["wav", "tdms", "hdf"],
)
def test_memory_of_200_mb(tmp_path, write, count):
    """Peak memory stays near that of the float64 array itself."""
    write(tmp_path / "big", count)
    assert (tmp_path / "big").stat().st_size >= 200 * 2**20
    tracemalloc.start()
    channel = read_record(tmp_path / "big").channels[0]
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert channel.values.size == count
    assert channel.step == pytest.approx(1e-6)
    assert peak < 1.3 * channel.values.nbytes


def nested_cells(depth):
    """Return a MATLAB file of cells in cells, which makes readers that follow them run out of stack."""

    def element(kind, data):
        return struct.pack("<II", kind, len(data)) + data + bytes(-len(data) % 8)

    body = b""
    for _ in range(depth):
        head = element(6, struct.pack("<II", 1, 0)) + element(5, struct.pack("<ii", 1, 1)) + element(1, b"")
        body = element(14, head + body)
    return b"MATLAB 5.0 MAT-file".ljust(124) + b"\x00\x01IM" + body


HOSTILE = {
    "wav without frames": b"RIFF\0\0\0\0WAVEfmt \x10\0\0\0\1\0\0\0\0\0\0\0\0\0\0\0\0\0\x10\0data\xff\xff\xff\xff",
    "wav of no bits": b"RIFF\0\0\0\0WAVEfmt \x10\0\0\0\1\0\1\0\0\0\0\0\0\0\0\0\0\0\0\0data\xff\0\0\0" + bytes(300),
    "cells without end": nested_cells(300),
    "a matrix of all memory": b"\0\0\0\0\xff\xff\xff\x7f\xff\xff\xff\x7f\0\0\0\0\2\0\0\0a\0",
    "hdf of its signature": b"\x89HDF\r\n\x1a\n" + bytes(100),
    "netcdf of 2^31 dimensions": b"CDF\1\0\0\0\0\0\0\0\n\x7f\xff\xff\xff" + bytes(64),
    "parquet of its magic": b"PAR1" + bytes(64) + b"\xff\xff\xff\x7fPAR1",
    "uff of nothing": b"    -1\n    58\n    -1\n",
    "zip of nothing": b"PK\3\4xl/" + bytes(64),
    "tdms of 2^63 bytes": b"TDSm" + struct.pack("<lLQQ", 14, 4713, 2**62, 2**62),
    "mdf of its magic": b"MDF     4.10    " + bytes(200),
    "ide of its magic": b"\x1aE\xdf\xa3\x87\x42\x82\x84mide" + bytes(200),
    "rigol of its magic": b"\x01\xff\xff\xff" + bytes(400),
}


@pytest.mark.parametrize("name", HOSTILE)
def test_hostile_files_end_in_an_input_error(tmp_path, name):
    (tmp_path / "a").write_bytes(HOSTILE[name])
    tracemalloc.start()
    with pytest.raises(InputError):
        read_record(tmp_path / "a")
    assert tracemalloc.get_traced_memory()[1] < 64 * 2**20
    tracemalloc.stop()


def test_an_ide_file_whose_numbers_are_expressions(sample):
    """``9**9**9`` in place of a number would keep a reader busy for ever that works it out."""
    path = sample("ide")
    held = path.read_bytes()
    assert b"1/1000000" in held
    path.write_bytes(held.replace(b"1/1000000", b"9**9**9**"))
    with pytest.raises(InputError):
        read_record(path)


@pytest.fixture
def logs():
    """Two libraries are silenced where they run in a process of their own."""
    before = logging.root.manager.disable
    yield
    logging.disable(before)


@pytest.mark.parametrize("form", ["hdf", "tdms", "ide", "rigol"])
def test_what_is_read_in_a_child_process_is_read_in_this_one(sample, form, logs):
    """As the tests of these formats above, where the code that reads runs beside the test."""
    record = getattr(READERS[form], f"parse_{form}")(sample(form), Options())
    if form == "rigol":
        volts = (RAW.astype(float) - 127.0) * 0.5 / 20.0 + 0.25 + 0.5
        assert record.channels[0].values == pytest.approx(volts, abs=1e-15)
        assert record.channels[0].start == pytest.approx(5e-6 - SIZE / 2 * 4e-9, rel=1e-12)
        return
    step, start = (1e-3, 0.0) if form == "ide" else (STEP, START)
    same(record.channels[0], BOARD, step, start)
    if form == "tdms":
        same(record.channels[1], FRAME * 16, step, start, unit="g")
    else:
        same(record.channels[1], FRAME, step, start, unit="" if form == "hdf" else "g")


def mat_array(name, values, order="<"):
    """Lay an array of doubles out as the format says: flags, shape, name and numbers, each to eight bytes."""

    def part(kind, body):
        return struct.pack(order + "II", kind, len(body)) + body + bytes(-len(body) % 8)

    values = np.asarray(values)
    body = part(6, struct.pack(order + "II", 6, 0)) + part(5, struct.pack(f"{order}{values.ndim}i", *values.shape))
    kind = {"f8": 9, "i2": 3, "u1": 2}[values.dtype.str[1:]]
    numbers = values.astype(values.dtype.newbyteorder(order)).tobytes(order="F")
    return part(14, body + part(1, name.encode()) + part(kind, numbers))


@pytest.mark.parametrize("order", ["<", ">"])
def test_a_matlab_file_byte_by_byte(tmp_path, order):
    """Version 5, of both orders of bytes: names and numbers of lengths that are padded, and columns as they lie."""
    head = b"MATLAB 5.0".ljust(124) + ({"<": b"\x00\x01IM", ">": b"\x01\x00MI"}[order])
    table = np.column_stack([BOARD, FRAME])
    odd = np.arange(5, dtype=np.uint8).reshape(5, 1)
    parts = [("dt", np.array([[STEP]])), ("odd_name_x", odd), ("acc", table), ("n16", (16 * BOARD).astype("i2"))]
    path = tmp_path / "blow.mat"
    path.write_bytes(head + b"".join(mat_array(*part, order) for part in parts))
    record = read_record(path)
    assert names(record) == ["acc 1", "acc 2", "n16"]
    for channel, values in zip(record.channels, (BOARD, FRAME, 16 * BOARD), strict=True):
        same(channel, values, start=0.0, unit="")
    path.write_bytes(path.read_bytes()[:-1])
    with pytest.raises(InputError, match="ends within an array"):
        read_record(path)


@pytest.mark.parametrize("compressed", [False, True])
def test_structs_within_structs_of_matlab(tmp_path, compressed):
    from scipy.io import savemat

    inner = {"time": TIME, "acceleration": BOARD, "g": FRAME.astype("f4")}
    savemat(tmp_path / "blow.mat", {"run": {"first": inner, "fs": 3.0}, "z": 1j * BOARD}, do_compression=compressed)
    record = read_record(tmp_path / "blow.mat")
    assert names(record) == ["run/first/acceleration", "run/first/g"]
    same(record.channels[0], BOARD, unit="")
    same(record.channels[1], FRAME, unit="")
    assert [finding.value for finding in record.findings if finding.code == "array-ignored"] == [1]


@pytest.mark.parametrize("order", ["<", ">"])
def test_a_matlab_file_of_version_4(tmp_path, order):
    """Type, rows, columns, whether complex, length of the name, the name with its zero, the numbers."""

    def array(name, values, kind, imaginary=0):
        values = np.asarray(values)
        head = struct.pack(order + "5i", 1000 * "<>".index(order) + kind, *values.shape, imaginary, len(name) + 1)
        body = values.astype({0: "f8", 30: "i2"}[kind]).astype(order + {0: "f8", 30: "i2"}[kind])
        return head + name.encode() + b"\0" + body.tobytes(order="F") * (1 + imaginary)

    parts = array("dt", [[STEP]], 0), array("z", BOARD[:, None], 0, 1), array("board", 16 * BOARD[:, None], 30)
    path = tmp_path / "blow.mat"
    path.write_bytes(b"".join(parts) + array("both", np.column_stack([BOARD, FRAME]), 0))
    record = read_record(path)
    assert names(record) == ["board", "both 1", "both 2"]
    for channel, values in zip(record.channels, (16 * BOARD, BOARD, FRAME), strict=True):
        same(channel, values, start=0.0, unit="")
    path.write_bytes(path.read_bytes()[:-8])
    with pytest.raises(InputError, match="ends within an array"):
        read_record(path)
