"""Files made to keep a program busy or to fill its memory: what each costs, and how it ends.

Each is made small on disk and large in one direction, and given to the command that reads its kind, in a process of its
own, whose processor time and largest memory are measured. A file is held where the command ends by itself, with its
result or with one line, within `MOST_SECONDS` of a processor and `MOST_MEMORY`. With `--write`, its rows go
into the table of docs/faults.md.
"""

from __future__ import annotations

import argparse
import gzip
import multiprocessing
import os
import resource
import sys
import tempfile
import zipfile
import zlib
from collections.abc import Callable
from pathlib import Path

import numpy as np
from kit import ROOT, renewed, table, write_into

PAGE, TABLE = ROOT / "docs/faults.md", "hostile files"
MOST_SECONDS, MOST_MEMORY = 30.0, 1500.0
"""Of a processor, and MB: a command that reads a usual file takes 2 s and 150 MB."""
STOPPED = 300
"""Seconds of a processor after which a command is stopped."""
BEFORE = {
    "a case with one dotted key of 80 kB": "6 300 MB",
    "a case with one dotted key of 400 kB": "16 000 MB",
    "Parquet of 11 000 columns": "114 s, 9 000 MB",
    "Parquet of 4 000 columns": "1 400 MB",
    "CSV of 9 999 columns without a head": "> 150 s",
    "TDMS of 10 000 segments": "97 s",
    "CSV of 6 666 spikes": "96 s",
}
"""What was measured before there were limits."""


def dotted_key(path: Path, size: int) -> None:
    """Write a case whose key is a table in a table in a table."""
    path.write_text("schema = 1\n" + ".".join("a" * (size // 2)) + " = 1\n")


def wide_csv(path: Path) -> None:
    """Write rows of 9 999 numbers."""
    path.write_text("\n".join(",".join(f"{row + 0.001 * k:.3f}" for k in range(9_999)) for row in range(20)) + "\n")


def long_line(path: Path) -> None:
    """Write 100 MB without an end of line."""
    with path.open("w") as file:
        for _ in range(100):
            file.write("1,2;3 4 " * 125_000)


def spikes(path: Path) -> None:
    """Write a record of 6 666 short pulses."""
    values = np.random.default_rng(1).normal(size=2_000_000)
    for k in range(6_666):
        values[300 * k + 100 : 300 * k + 120] += 500.0 * np.sin(np.linspace(0.0, np.pi, 20))
    np.savetxt(
        path,
        np.column_stack([1e-6 * np.arange(values.size), values]),
        "%.6f,%.2f",
        header="time [s],a [g]",
        comments="",
    )


def parquet(path: Path, columns: int) -> None:
    """Write a table of many columns."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    pq.write_table(pa.table({f"column {k}": np.arange(6.0) for k in range(columns)}), path)


def segments(path: Path) -> None:
    """Write 10 000 segments of ten values."""
    from nptdms import ChannelObject, TdmsWriter

    with TdmsWriter(str(path)) as file:
        for k in range(10_000):
            file.write_segment([ChannelObject("g", "b", np.arange(10.0) + k, {"wf_increment": 1e-6})])


def packed_hdf(path: Path) -> None:
    """Write 40 GB of zeros that HDF5 packs into some megabytes."""
    import h5py

    with h5py.File(path, "w") as file:
        file["time"] = [0.0, 1e-5]
        data = file.create_dataset("board", (5_000_000_000,), "f8", chunks=(50_000_000,), compression="gzip")
        data[:50_000_000] = 0.0


def short_step(path: Path) -> None:
    """Write a record whose instants are 1e-308 s apart."""
    import h5py

    with h5py.File(path, "w") as file:
        file["time"] = 1e-308 * np.arange(400)
        file["board"] = np.sin(np.arange(400.0))


def packed_mat(path: Path) -> None:
    """Write a matrix that is a gigabyte of zeros, packed."""
    head = b"MATLAB 5.0 MAT-file".ljust(124) + b"\0\1IM"
    packer = zlib.compressobj(9)
    inner = packer.compress(np.array([14, 2**30 + 48], "<u4").tobytes())
    inner += b"".join(packer.compress(bytes(2**20)) for _ in range(1024)) + packer.flush()
    path.write_bytes(head + np.array([15, len(inner)], "<u4").tobytes() + inner)


def packed_sheet(path: Path) -> None:
    """Write a workbook whose sheet is a gigabyte of spaces, packed."""
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as file:
        file.writestr("[Content_Types].xml", "<Types/>")
        with file.open("xl/worksheets/sheet1.xml", "w") as sheet:
            for _ in range(1024):
                sheet.write(b" " * 2**20)


def packed_text(path: Path) -> None:
    """Write text of a gigabyte, packed."""
    with gzip.open(path, "wb") as file:
        for _ in range(64):
            file.write(b"0.0,1.0\n" * 2**21)


def huge_heads(path: Path) -> None:
    """Write a sound file that says it holds 4 GB, and holds 300 bytes."""
    path.write_bytes(
        b"RIFF\xff\xff\xff\xffWAVEfmt \x10\0\0\0\1\0\1\0\x80\xbb\0\0\0\x77\1\0\2\0\x10\0data\xff\xff\xff\xff"
        + bytes(300)
    )


def dimensions(path: Path) -> None:
    """Write a NetCDF file of two thousand million dimensions."""
    path.write_bytes(b"CDF\1\0\0\0\0\0\0\0\n\x7f\xff\xff\xff" + bytes(64))


FILES: dict[str, tuple[str, str, Callable[[Path], None]]] = {
    "a case with one dotted key of 80 kB": ("run", "a.toml", lambda path: dotted_key(path, 80_000)),
    "a case with one dotted key of 400 kB": ("run", "a.toml", lambda path: dotted_key(path, 400_000)),
    "a set-up of bars with such a key": ("hopkinson", "a.toml", lambda path: dotted_key(path, 400_000)),
    "a fit file with such a key": ("fit", "a.toml", lambda path: dotted_key(path, 400_000)),
    "CSV of 9 999 columns without a head": ("record", "a.csv", wide_csv),
    "CSV of 6 666 spikes": ("record", "a.csv", spikes),
    "text of 100 MB in one line": ("record", "a.csv", long_line),
    "text of 1 GB, packed": ("record", "a.csv.gz", packed_text),
    "Parquet of 4 000 columns": ("record", "a.parquet", lambda path: parquet(path, 4_000)),
    "Parquet of 11 000 columns": ("record", "a.parquet", lambda path: parquet(path, 11_000)),
    "TDMS of 10 000 segments": ("record", "a.tdms", segments),
    "HDF5 of 40 GB, packed": ("record", "a.h5", packed_hdf),
    "HDF5 with a step of 1e-308 s": ("record", "a.h5", short_step),
    "MAT of 1 GB, packed": ("record", "a.mat", packed_mat),
    "Excel of 1 GB, packed": ("record", "a.xlsx", packed_sheet),
    "WAV that says 4 GB": ("record", "a.wav", huge_heads),
    "NetCDF of 2^31 dimensions": ("record", "a.nc", dimensions),
}
"""Command that reads a file, its name, and who writes it."""


def cost(command: str, path: Path) -> tuple[int, float, float, str]:
    """Return the exit code of a command, its seconds of a processor, MB at most, and its first line of errors."""
    with tempfile.TemporaryFile("w+") as words:
        child = os.fork()
        if not child:
            os.chdir(path.parent)
            os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
            os.dup2(words.fileno(), 2)
            resource.setrlimit(resource.RLIMIT_CPU, (STOPPED, STOPPED))
            os.execv(sys.executable, [sys.executable, "-P", "-m", "strikewave", command, path.name])
        _, status, used = os.wait4(child, 0)
        words.seek(0)
        said = words.readline(2000).strip()
    return os.waitstatus_to_exitcode(status), used.ru_utime + used.ru_stime, used.ru_maxrss / 1e3, said


def main() -> int:
    """Give each file to its command; return how many were not held."""
    parser = argparse.ArgumentParser(description="files made to keep a program busy")
    parser.add_argument("--only", action="append", choices=FILES, help="one; may be repeated")
    parser.add_argument("--write", action="store_true", help="the table into docs/faults.md")
    asked = parser.parse_args()
    rows, bad = [], 0
    for name in asked.only or FILES:
        command, file, write = FILES[name]
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / file
            writer = multiprocessing.get_context("fork").Process(target=write, args=(path,))
            writer.start()  # a process begins with the largest memory of the one that it comes from
            writer.join()
            size = path.stat().st_size / 1e6
            code, seconds, memory, said = cost(command, path)
        held = code in (0, 2, 3) and seconds < MOST_SECONDS and memory < MOST_MEMORY
        bad += not held
        print(
            f"{name}: exit {code}, {seconds:.1f} s, {memory:.0f} MB{'' if held else ', NOT HELD'}: {said[:200]}",
            flush=True,
        )
        end = {0: "read", 2: "refused", 3: "read, a check failed"}.get(code, f"exit {code}")
        rows.append([name, f"{size:.2g}", BEFORE.get(name, ""), f"{seconds:.1f} s, {memory:.0f} MB", end])
    heads = ("File", "MB on disk", "before", "now", "ends")
    print(table(heads, rows))
    if asked.write:
        write_into(PAGE, TABLE, table(heads, renewed(PAGE, TABLE, rows)))
    return bad


if __name__ == "__main__":
    sys.exit(bool(main()))
