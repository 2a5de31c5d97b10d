"""A measured load: any format that records are read from, any unit, even or uneven times."""

import numpy as np
import pytest

from strikewave.build.load_file import read_load
from strikewave.errors import InputError

G = 9.80665


def test_force_over_uneven_times_without_a_head_is_in_newton_and_seconds(tmp_path):
    time, force = np.array([0.0, 1e-6, 3e-6, 10e-6]), np.array([0.0, 5.0, 7.0, 0.0])
    (tmp_path / "force.txt").write_text(
        "\n".join(f"{t!r} {f!r}" for t, f in zip(time.tolist(), force.tolist(), strict=True))
    )
    load = read_load(str(tmp_path / "force.txt"))
    assert load.kind == "force"
    assert np.array_equal(load.time, time)
    assert np.array_equal(load.values, force)


def test_acceleration_of_the_face_in_g_becomes_its_speed(tmp_path):
    import pyarrow as pa
    import pyarrow.parquet as pq

    time = np.linspace(0.0, 100.0, 101)
    pq.write_table(pa.table({"time [us]": time, "face [g]": np.full(101, 1000.0)}), tmp_path / "face.parquet")
    load = read_load(str(tmp_path / "face.parquet"))
    assert load.kind == "speed"
    assert load.values[-1] == pytest.approx(1000.0 * G * 100e-6, rel=1e-12)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("time [us], temperature [K]\n0,1\n1,2\n2,3\n", "a force, a speed or an acceleration"),
        ("", "empty"),
        ("time [us], force [kN]\n0,1\n2,2\n1,3\n", "times that rise"),
    ],
)
def test_what_is_no_load_is_refused_in_words(tmp_path, text, said):
    (tmp_path / "load.csv").write_text(text)
    with pytest.raises(InputError, match=said) as refused:
        read_load(str(tmp_path / "load.csv"))
    assert refused.value.field == "load.file"
