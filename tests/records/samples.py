"""A file of every format, written by its own library or byte by byte from its layout: what the readers are tested with."""

import struct
from pathlib import Path

import numpy as np

STEP, START, SIZE = 2.0**-17, -(2.0**-8), 400
TIME = START + STEP * np.arange(SIZE)
BOARD = np.round(300.0 * np.sin(np.arange(SIZE) / 9.0)) / 16.0
FRAME = np.round(90.0 * np.cos(np.arange(SIZE) / 5.0)) / 16.0


def write_hdf(path):
    import h5py

    with h5py.File(path, "w", userblock_size=0) as file:
        file["time"] = TIME
        file["time"].attrs["units"] = "s"
        file.create_dataset("blow 1/board", data=BOARD, compression="gzip", shuffle=True).attrs["units"] = "g"
        file["blow 1/frame"] = FRAME.astype("f4")
        file["note"] = "text"


def write_mat(path):
    from scipy.io import savemat

    savemat(path, {"run": {"t": TIME, "board": BOARD, "n": 3.0}, "label": "text"}, do_compression=True)


def write_netcdf(path):
    from scipy.io import netcdf_file

    with netcdf_file(path, "w") as file:
        file.createDimension("time", SIZE)
        for name, values, unit in (("time", TIME, "s"), ("board", BOARD, "g"), ("frame", FRAME, "g")):
            variable = file.createVariable(name, "d", ("time",))
            variable[:] = values
            variable.units = unit


def write_parquet(path):
    import pyarrow as pa
    import pyarrow.parquet as pq

    fields = [pa.field("time [s]", pa.float64()), pa.field("board", pa.float64(), metadata={"units": "g"})]
    fields += [pa.field("frame [g]", pa.float32()), pa.field("note", pa.string())]
    table = pa.table([TIME, BOARD, FRAME.astype("f4"), ["a"] * SIZE], schema=pa.schema(fields))
    pq.write_table(table, path, compression="snappy")


def write_wav(path, values=None, rate=96000):
    from scipy.io import wavfile

    wavfile.write(path, rate, (np.column_stack([BOARD, FRAME]) * 16).astype(np.int16) if values is None else values)


def uff_set(binary, values=BOARD, label="board", unit="g", spacing=1, kind=1):
    return {
        "type": 58, "binary": binary, "func_type": kind, "rsp_node": 1, "rsp_dir": 1, "ref_node": 1, "ref_dir": 1,
        "data": values, "x": TIME[: len(values)], "abscissa_spacing": spacing, "id1": "a blow", "rsp_ent_name": "NONE",
        "ordinate_axis_lab": label, "ordinate_axis_units_lab": unit, "abscissa_axis_units_lab": "s",
        "abscissa_spec_data_type": 17, "ordinate_spec_data_type": 12, "orddenom_spec_data_type": 0,
        "z_axis_spec_data_type": 0,
    }  # fmt: skip


def write_uff(path, binary=0):
    import pyuff

    sets = [uff_set(binary), uff_set(binary, FRAME, "frame"), uff_set(binary, kind=4)]
    Path(path).unlink(missing_ok=True)
    pyuff.UFF(str(path)).write_sets(sets, "add")


def write_tdms(path):
    from nptdms import ChannelObject, GroupObject, TdmsWriter

    said = {"wf_increment": STEP, "wf_start_offset": START, "unit_string": "g"}
    with TdmsWriter(str(path)) as file:
        for part in (slice(0, 150), slice(150, None)):
            channels = [ChannelObject("blow", "board", BOARD[part], said)]
            channels += [ChannelObject("blow", "frame", (FRAME[part] * 16).astype(np.int16), said)]
            file.write_segment([GroupObject("blow"), *channels])


def write_mdf(path, version="4.10"):
    from asammdf import MDF, Signal

    with MDF(version=version) as file:
        signals = [Signal(BOARD, TIME, unit="g", name="board"), Signal(FRAME, TIME, unit="g", name="frame")]
        file.append(signals, comment="a blow")
        Path(file.save(path, overwrite=True)).rename(path)


def ebml(number, value):
    """Encode one EBML element: its number, its length in eight bytes, its value."""
    if isinstance(value, list):
        value = b"".join(ebml(*inner) for inner in value)
    elif isinstance(value, str):
        value = value.encode()
    elif isinstance(value, int):
        value = value.to_bytes(4, "big")
    elif isinstance(value, float):
        value = struct.pack(">d", value)
    name = number.to_bytes((number.bit_length() + 7) // 8, "big")
    return name + (2**56 | len(value)).to_bytes(8, "big") + value


def write_ide(path):
    """By the schema of the format: one sensor of two axes, 16 bits each, microseconds, 1/16 g a count."""
    axes = [
        (0x52A0, [(0x52A1, k), (0x52A2, name), (0x52A3, 1), (0x52A5, "Acceleration"), (0x52A6, "g")])
        for k, name in enumerate("XY")
    ]
    channel = [(0x5272, 8), (0x5273, "board"), (0x5275, "<hh"), (0x5277, "1/1000000"), *axes]
    sensors = (0x5240, [(0x5241, [(0x5242, 0), (0x5243, "accelerometer")])])
    raw = (np.column_stack([BOARD, FRAME]) * 16).astype("<i2")
    elements = [
        (0x1A45DFA3, [(0x4282, "mide"), (0x4287, 4), (0x4285, 3)]),
        (0x18526570, [sensors, (0x5270, [(0x5271, channel)])]),
        (0x4B00, [(0x4B01, [(0x4B03, 1), (0x4B08, 1.0 / 16.0), (0x4B08, 0.0)])]),
    ]
    for k in range(0, SIZE, 100):
        times = [(0xB8, 1000 * k), (0xB9, 1000 * (k + 99))]
        elements.append((0xA1, [(0xB0, 8), *times, (0xB2, raw[k : k + 100].tobytes())]))
    Path(path).write_bytes(b"".join(ebml(*element) for element in elements))


RAW = (127 + np.round(80 * np.sin(np.arange(SIZE) / 9.0))).astype(np.uint8)


def write_rigol(path):
    """DS1000Z, channel 1 alone: file header, waveform header at byte 64, samples behind the horizontal block."""
    head = struct.pack("<4sHH20s20s2sH", b"\x01\xff\xff\xff", 0, 0, b"DS1054Z", b"00.04.04.SP4", b"\1\0", 0)
    off = struct.pack("<BBBBB3xffBB10x", 0, 0, 1, 0, 6, 1.0, 0.0, 0, 2)
    channels = [struct.pack("<BBBBB3xffBB10x", 1, 0, 1, 0, 6, 0.5, -0.25, 0, 2), off, off, off]
    body = struct.pack("<QqI2sHB3x5I", 10**6, 5 * 10**6, 0, b"\xd8\0", 0, 0b0001, *(0,) * 5)
    body += struct.pack("<BBsBIf", 0, 0, b"\0", 0, SIZE, 0.25) + b"".join(channels)
    at = 64 + len(body) + 12 + 8 * 4
    body += bytes(12) + struct.pack("<8I", 0, 0, 16, at, 0, 0, 0, 0)
    Path(path).write_bytes(head.ljust(64, b"\0") + body + bytes(16) + RAW.tobytes())


def write_excel(path):
    import openpyxl

    book = openpyxl.Workbook()
    book.active.append(["Time/s", "board/g", "frame [g]"])
    for row in zip(TIME, BOARD, FRAME, strict=True):
        book.active.append([float(value) for value in row])
    book.save(path)


def write_lvm(path):
    rows = "\n".join(f"{t:.12g}\t{a:.6f}" for t, a in zip(TIME - START, BOARD, strict=True))
    Path(path).write_text(
        "LabVIEW Measurement\t\nWriter_Version\t2\nReader_Version\t2\nSeparator\tTab\nDecimal_Separator\t.\n"
        "Multi_Headings\tNo\nX_Columns\tOne\nTime_Pref\tRelative\n***End_of_Header***\t\n\t\n"
        f"Channels\t1\t\nSamples\t{SIZE}\t\nX_Dimension\tTime\t\nX0\t0.0\t\nDelta_X\t{STEP!r}\t\n"
        "***End_of_Header***\t\t\nX_Value\tboard\tComment\n" + rows + "\n"
    )


def write_text(path):
    rows = "\n".join(f"{t:.12g},{a:.6f},{b:.6f}" for t, a, b in zip(TIME, BOARD, FRAME, strict=True))
    Path(path).write_text("time [s],board [g],frame [g]\n" + rows + "\n")


SAMPLES = {
    "tdms": write_tdms, "mdf": write_mdf, "ide": write_ide, "rigol": write_rigol, "hdf": write_hdf, "mat": write_mat,
    "netcdf": write_netcdf, "parquet": write_parquet, "wav": write_wav, "uff": write_uff, "excel": write_excel,
    "lvm": write_lvm, "text": write_text,
}  # fmt: skip
NEEDS = {"tdms": "nptdms", "mdf": "asammdf", "ide": "idelib", "rigol": "RigolWFM", "excel": "openpyxl"}
