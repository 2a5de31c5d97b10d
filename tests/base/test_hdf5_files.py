"""HDF5 on a disk that is full: an error of the disk, at any place of the file, where HDF5 itself would crash."""

import subprocess
import sys

import numpy as np
import pytest

from strikewave.base.hdf5_files import content_digest

PROGRAM = """
import resource, sys
from pathlib import Path
import numpy as np
from strikewave.base.variables import LabelledArrays
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


def test_each_bit_name_type_and_shape_counts():
    values = np.arange(6.0)
    whole = content_digest({"x": values, "words": np.array(["a", "bc"])})
    others = [
        {"x": np.nextafter(values, np.inf), "words": np.array(["a", "bc"])},
        {"y": values, "words": np.array(["a", "bc"])},
        {"x": values.reshape(2, 3), "words": np.array(["a", "bc"])},
        {"x": values.astype("f4"), "words": np.array(["a", "bc"])},
        {"x": values, "words": np.array(["ab", "c"])},
        {"x": values},
    ]
    assert whole not in {content_digest(other) for other in others}
