"""HDF5 on a disk that is full: an error of the disk, at any place of the file, where HDF5 itself would crash."""

import subprocess
import sys

import h5py
import numpy as np
import pytest

from strikewave.base.datasets import check_sealed, enduring_file, is_sealed

PROGRAM = """
import resource, sys
from pathlib import Path
import numpy as np
from strikewave.base.datasets import LabelledArrays
size, path = int(sys.argv[1]), Path(sys.argv[2])
resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))
names = {f"v{k}": ("time", np.arange(4000.0) + k, {"units": "N"}) for k in range(4)}
arrays = LabelledArrays.of(names, {"time": ("time", np.arange(4000.0))}, {"words": "x" * 9000})
try:
    arrays.write(path)
except OSError as error:
    print("refused", error.errno)
else:
    print("written")
"""


@pytest.mark.parametrize("size", [0, 10_000, 100_000, 10_000_000])
def test_a_file_that_finds_no_room_is_refused_and_the_process_lives(tmp_path, environment, size):
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM, str(size), str(tmp_path / "a.nc")],
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout == ("written\n" if size == 10_000_000 else "refused 27\n")  # EFBIG


FIELDS = """
import resource, sys
from pathlib import Path
import numpy as np
from strikewave.base.errors import InputError
from strikewave.fem.shapes import block
from strikewave.fem.run import FieldFrame
from strikewave.fem.vtkhdf import FieldWriter
mesh = block("b", (6e-3, 6e-3, 6e-3), 1e-3, 1e-3, 1e-3)
size = int(sys.argv[1])
resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))
rng, nodes, cells = np.random.default_rng(0), len(mesh.points), len(mesh.hexahedra)
try:
    with FieldWriter(Path(sys.argv[2]), mesh) as writer:
        for k in range(5):
            writer.add(FieldFrame(float(k), *(rng.random(s) for s in ((nodes, 3), (nodes, 3), (cells, 6), (cells,)))))
except InputError as error:
    print("refused", "File too large" in str(error))
else:
    print("written")
"""


@pytest.mark.parametrize("size", [1_000, *(pytest.param(n, marks=pytest.mark.verify) for n in (8_000, 30_000, 80_000))])
def test_fields_that_find_no_room_are_refused_and_the_process_lives(tmp_path, environment, size):
    command = [sys.executable, "-c", FIELDS, str(size), str(tmp_path / "f.vtkhdf")]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (0, "refused True\n", "")


def test_a_file_is_refused_unless_it_is_as_it_was_sealed(tmp_path):
    path = tmp_path / "a.h5"
    with enduring_file(path) as disk, h5py.File(disk, "w") as file:
        file["x"] = np.arange(100.0)
    whole = path.read_bytes()
    check_sealed(path)
    with h5py.File(path) as file:
        assert file["x"][7] == 7.0  # HDF5 does not see the seal
    rng = np.random.default_rng(0)
    for place in (0, len(whole) - 1, *rng.integers(0, len(whole), 200)):
        path.write_bytes(whole[:place] + bytes([whole[place] ^ 1]) + whole[place + 1 :])
        with pytest.raises(ValueError, match=r"check sum is missing|bytes of it have changed"):
            check_sealed(path)
    for end in (0, 10, len(whole) - 1):
        path.write_bytes(whole[:end])
        assert not is_sealed(path)
        with pytest.raises(ValueError, match="check sum is missing"):
            check_sealed(path)
    path.write_bytes(whole)
    with h5py.File(path, "r+") as file:
        file["x"][7] = 8.0
    with pytest.raises(ValueError, match=r"check sum is missing|bytes of it have changed"):
        check_sealed(path)
