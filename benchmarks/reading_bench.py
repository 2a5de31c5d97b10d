"""Reading speed of measured files, memory beyond the arrays, and campaigns of many files."""

import json
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from timing import table

ROWS = 4_000_000
"""Samples of each of two channels."""
CAMPAIGNS, SAMPLES = (16, 50, 500), 20_000
"""Files of a campaign, and samples of each."""

LARGE_ROWS = 40_000_000
"""Lines of the long text, some 1 GB."""
LARGE = {
    "strikewave": "from strikewave.records import read_record; read = lambda path: read_record(path)",
    "numpy.loadtxt": "import numpy; read = lambda path: numpy.loadtxt(path, delimiter=',', skiprows=1)",
    "pandas.read_csv": "import pandas; read = lambda path: pandas.read_csv(path)",
    "pyarrow.csv.read_csv": "import pyarrow.csv; read = lambda path: pyarrow.csv.read_csv(path)",
}
"""How the long text is read, each in a process of its own."""

LARGE_CHILD = """
import sys, time
exec(sys.argv[2])
begun, spent = time.perf_counter(), time.process_time()
record = read(sys.argv[1])
peak = [line for line in open("/proc/self/status") if line.startswith("VmHWM")]
print(time.perf_counter() - begun, time.process_time() - spent, 1024 * int(peak[0].split()[1]))
"""

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

A text of {LARGE_ROWS:,} lines of time and two channels ({3 * 8 * LARGE_ROWS / 2**20:.0f} MiB as arrays of float64), the whole
process; the peers take the columns as numbers, and do not look for head, units, decimal mark, time column or faults:

{table(("reader", "size", "time", "CPU time", "speed", "peak memory"), large())}

Campaigns of text files, {SAMPLES:,} samples each, one blow in each, through `strikewave record`, the whole process:

{table(("campaign", "output", "time", "CPU time", "peak memory"), campaigns())}
"""


def large():
    """Return rows of a long text, which is gone afterwards, as it is read here and by the peers."""
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "long.csv"
        _write_long(path)
        size = path.stat().st_size
        for name, how in LARGE.items():
            command = [sys.executable, "-c", LARGE_CHILD, str(path), how]
            result = subprocess.run(command, check=True, capture_output=True, text=True)
            took, spent, peak = (float(word) for word in result.stdout.split())
            cells = f"{size / 1e9:.2f} GB", f"{took:.1f} s", f"{spent:.1f} s", f"{size / took / 1e6:.0f} MB/s"
            rows.append((name, *cells, f"{peak / 2**20:.0f} MiB"))
    return rows


def _write_long(path, part=1_000_000):
    """Write time and two channels part by part, so that no more than a part is in memory."""
    import pyarrow as pa
    import pyarrow.csv

    rng = np.random.default_rng(2)
    with path.open("wb") as file:
        file.write(b"time [s],a [g],b [g]\n")
        for first in range(0, LARGE_ROWS, part):
            time_, channels = np.arange(first, first + part) * 1e-6, rng.normal(size=(part, 2)).round(5)
            columns = {"t": time_.round(7), "a": channels[:, 0], "b": channels[:, 1]}
            pa.csv.write_csv(pa.table(columns), file, pa.csv.WriteOptions(include_header=False))


def campaigns():
    """Return rows of campaigns through `strikewave record`: whole processes, as JSON and with report and pictures."""
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        paths = [str(_shot(Path(folder) / f"shot{k}.csv", k)) for k in range(max(CAMPAIGNS))]
        for count in CAMPAIGNS:
            for name, rest in (("--json", ["--json"]), ("with report", ["--out", f"{folder}/{count}", "--force"])):
                took, spent, peak = _whole([sys.executable, "-m", "strikewave", "record", *paths[:count], *rest])
                cells = f"{took:.1f} s", f"{spent:.1f} s", f"{peak / 2**20:.0f} MiB"
                rows.append((f"{count} files", name, *cells))
    return rows


def _shot(path, seed):
    """Write a record of one blow of about 4600 g and 200 us at 200 kHz as text."""
    rng = np.random.default_rng(seed)
    t = np.arange(SAMPLES) * 5e-6
    u = (t - 0.03) / 200e-6
    pulse = 4600.0 * (1.0 + 0.025 * rng.normal()) * np.sin(np.pi * np.clip(u, 0.0, 1.0))
    values = pulse + rng.normal(0.0, 3.0, SAMPLES)
    np.savetxt(
        path, np.column_stack([t, values]), ["%.6f", "%.4f"], ",", header="time (s),acceleration (g)", comments=""
    )
    return path


def _whole(command):
    """Run a command in a child of a child, so that the peak memory is its own; return time, CPU time and memory."""
    code = "import json, sys; sys.path.insert(0, sys.argv[1]); import reading_bench as b; b.report(json.loads(sys.argv[2]))"
    child = [sys.executable, "-c", code, str(Path(__file__).parent), json.dumps(command)]
    result = subprocess.run(child, check=True, capture_output=True, text=True)
    return [float(word) for word in result.stdout.split()]


def report(command):
    """Run a command and print its time, CPU time and peak memory."""
    begun = time.perf_counter()
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    print(time.perf_counter() - begun, used.ru_utime + used.ru_stime, 1024 * used.ru_maxrss)


def _child(path):
    command = [sys.executable, "-c", CHILD, str(path)]
    result = subprocess.run(command, check=True, capture_output=True, text=True)
    return [float(word) for word in result.stdout.split()]


if __name__ == "__main__":
    print(section())
