"""Reading speed of measured files, and memory beyond the arrays."""

import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from timing import table

ROWS = 4_000_000
"""Samples of each of two channels."""

CHILD = """
import sys, time
from strikewave.records import read_record
import h5py, pyarrow.csv, pyarrow.parquet
took = held = 0
if sys.argv[1]:
    begun = time.perf_counter()
    record = read_record(sys.argv[1])
    took = time.perf_counter() - begun
    stamps = record.channels[0].stamps
    held = sum(c.values.nbytes for c in record.channels) + (0 if stamps is None else stamps.nbytes)
peak = [line for line in open("/proc/self/status") if line.startswith("VmHWM")]  # of this process alone
print(took, held, 1024 * int(peak[0].split()[1]))
"""


def files(folder):
    """Write the same two channels in several formats; return names and paths."""
    import h5py
    import pyarrow as pa
    import pyarrow.csv
    import pyarrow.parquet
    from scipy.io import wavfile

    rng = np.random.default_rng(1)
    step = 1e-6
    channels = rng.normal(size=(ROWS, 2)).round(5)
    columns = {"time [s]": (np.arange(ROWS) * step).round(7), "a [g]": channels[:, 0], "b [g]": channels[:, 1]}
    pa.csv.write_csv(pa.table(columns), folder / "text.csv")
    text = (folder / "text.csv").read_text()
    (folder / "comma.csv").write_text(text.replace(",", ";").replace(".", ","))
    pa.parquet.write_table(pa.table(columns), folder / "table.parquet")
    with h5py.File(folder / "arrays.h5", "w") as file:
        for name, values in columns.items():
            file[name.split()[0]] = values
    wavfile.write(folder / "sound.wav", 1_000_000, (3000 * channels).astype(np.int16))
    return {
        "text (CSV)": folder / "text.csv",
        "text, decimal comma": folder / "comma.csv",
        "Parquet": folder / "table.parquet",
        "HDF5": folder / "arrays.h5",
        "WAV, 16 bit": folder / "sound.wav",
    }


def section():
    """Return the section of the page of benchmarks."""
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        bare = int(_child("")[2])
        for name, path in files(Path(folder)).items():
            runs = [_child(path) for _ in range(3)]
            took = min(run[0] for run in runs)
            size = path.stat().st_size
            over = min(run[2] for run in runs) - bare - runs[0][1]
            cells = f"{size / 1e6:.0f} MB", f"{1e3 * took:.0f} ms", f"{size / took / 1e6:.0f} MB/s"
            rows.append((name, *cells, f"{max(over, 0) / 2**20:.0f} MiB"))
    return f"""## Reading

Two channels of {ROWS:,} samples, each file in a process of its own; memory is what the process needed beyond its imports
and the arrays.

{table(("file", "size", "time", "speed", "memory beyond the arrays"), rows)}
"""


def _child(path):
    command = [sys.executable, "-c", CHILD, str(path)]
    result = subprocess.run(command, check=True, capture_output=True, text=True)
    return [float(word) for word in result.stdout.split()]


if __name__ == "__main__":
    print(section())
