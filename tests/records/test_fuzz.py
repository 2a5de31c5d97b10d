"""Mutated files of every format end in a record or in an error that says so: no crash, no hang, no gigabytes.

Each format is read in a child process, so that a library that crashes takes down the child alone; the bytes that did it
are saved and named. 1 000 files a format are tried, fewer where its library is slow.
"""

import json
import os
import select
import subprocess
import sys
from pathlib import Path

import pytest
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st

from strikewave.records.readers import FORMATS

from .samples import NEEDS, SAMPLES

HANG = 90.0
"""After how long a file is given up as one that never ends, s."""
LARGEST_MEMORY = 512 * 2**20

DRIVER = """
import json, resource, sys
from pathlib import Path
resource.setrlimit(resource.RLIMIT_AS, (6 * 2**30, 6 * 2**30))
resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
import warnings
warnings.simplefilter("error", category=UserWarning)
from strikewave.base.errors import InputError
from strikewave.records.readers import read_record
from strikewave.records.record import Record
def own_peak():  # ru_maxrss of this process would count what its parent held before the fork
    status = Path("/proc/self/status")
    if not status.exists():
        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return int(next(line for line in status.read_text().splitlines() if line.startswith("VmHWM")).split()[1])
for line in sys.stdin:
    path = line.strip()
    try:
        ended = type(read_record(path)).__name__
    except InputError:
        ended = "InputError"
    except BaseException as error:
        ended = f"{type(error).__name__}: {error}"[:300]
    children = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss
    memory = 1024 * max(own_peak(), children)
    print(json.dumps([ended, memory]), flush=True)
"""


@st.composite
def mutations(draw, whole):
    """Bytes of a valid file: flipped, inserted, deleted, repeated, cut off, or random behind its first bytes."""
    data = bytearray(whole)
    places = st.one_of(st.integers(0, min(len(whole), 600)), st.integers(0, len(whole)))
    for _ in range(draw(st.integers(1, 6))):
        at = min(draw(places), len(data))
        how = draw(st.sampled_from(("flip", "flip", "set", "set", "insert", "delete", "repeat", "cut", "random")))
        if how == "flip" and at < len(data):
            data[at] ^= 1 << draw(st.integers(0, 7))
        elif how == "set":
            value = draw(
                st.sampled_from((b"\0", b"\xff", b"\x7f", b"\xff" * 4, b"\xff\xff\xff\x7f", b"\xff" * 8, b"\x80"))
            )
            data[at : at + len(value)] = value
        elif how == "insert":
            data[at:at] = draw(st.binary(min_size=1, max_size=16))
        elif how == "delete":
            del data[at : at + draw(st.integers(1, 64))]
        elif how == "repeat":
            data[at:at] = data[at : at + draw(st.integers(1, 64))] * draw(st.integers(1, 20))
        elif how == "cut" and draw(st.integers(0, 3)) == 0:
            del data[at:]
        elif how == "random" and draw(st.integers(0, 5)) == 0:
            data[min(at, 600) :] = draw(st.binary(max_size=400))
    return bytes(data)


class Reader:
    """A child process that reads one file after the other; a new one after each that broke down."""

    def __init__(self, folder):
        self.folder, self.child, self.count, self.broken = folder, None, 0, []

    def read(self, data):
        self.count += 1
        path = self.folder / f"{self.count}.bin"
        path.write_bytes(data)
        ended, memory = self.ask(path)
        wrong = ended not in ("Record", "InputError") or memory > LARGEST_MEMORY
        if wrong:
            self.broken.append(f"{path}: {ended}, {memory / 2**20:.0f} MB")
            self.stop()
        else:
            path.unlink()

    def ask(self, path):
        if self.child is None:
            command = [sys.executable, "-W", "ignore::DeprecationWarning", "-c", DRIVER]
            self.child = subprocess.Popen(
                command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL
            )
        self.child.stdin.write(f"{path}\n".encode())
        self.child.stdin.flush()
        if not select.select([self.child.stdout], [], [], HANG)[0]:
            return "it hangs", 0
        line = self.child.stdout.readline()
        return json.loads(line) if line else (f"the reader died of {self.child.wait()}", 0)

    def stop(self):
        if self.child is not None:
            self.child.stdin.close()
            self.child.kill()
            self.child.wait()
            self.child.stdout.close()
            self.child = None


EXAMPLES = 1000
MOST_EXAMPLES = {"mdf": 50, "ide": 75, "rigol": 100, "hdf": 100}
"""Of formats that take a fifth of a second and more for a file: 1000 would take many minutes."""


@pytest.mark.verify
@pytest.mark.parametrize("form", FORMATS)
def test_mutated_files(form, tmp_path_factory):
    needed = NEEDS.get(form)
    if needed:
        pytest.importorskip(needed)
    folder = Path(os.environ.get("STRIKEWAVE_FUZZ", tmp_path_factory.mktemp(form)))
    sample = folder / f"whole.{form}"
    SAMPLES[form](sample)
    whole = sample.read_bytes()
    reader = Reader(folder)
    reader.read(whole)

    @settings(
        max_examples=MOST_EXAMPLES.get(form, EXAMPLES),
        deadline=None,
        database=None,
        phases=[Phase.generate],
        suppress_health_check=list(HealthCheck),
        derandomize=True,
    )
    @given(mutations(whole))
    def attack(data):
        reader.read(data)

    try:
        attack()
    finally:
        reader.stop()
    assert not reader.broken, "\n".join(reader.broken[:20])
