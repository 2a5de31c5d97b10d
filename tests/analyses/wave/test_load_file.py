"""A measured load: any format that records are read from, any unit, even or uneven times."""

import numpy as np
import pytest

from strikewave.base.errors import InputError
from strikewave.cases.stack_of_case import read_load

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


BAR = """
schema = 1
[[stack.layer]]
name = "bar"
material = "65Mn"
length = "100 mm"
diameter = "20 mm"
[load]
shape = "file"
file = "force.csv"
[solver]
duration = "100 us"
"""


def write_case(folder, text):
    (folder / "bar.toml").write_text(BAR)
    (folder / "force.csv").write_text(text)
    return folder / "bar.toml"


def test_a_load_file_lies_beside_its_case_and_the_case_runs_again_elsewhere(tmp_path, monkeypatch):
    from strikewave import load_case, run_wave
    from strikewave.cases.written_case import dump_case

    place = write_case(tmp_path, "time [us], force [kN]\n0,0\n10,5\n20,0\n")
    (tmp_path / "other").mkdir()
    monkeypatch.chdir(tmp_path / "other")
    case = load_case(str(place))
    (tmp_path / "other" / "again.toml").write_text(dump_case(case))
    runs = [run_wave(each).run for each in (case, load_case("again.toml"))]
    assert np.array_equal(runs[0].force, runs[1].force)
    assert runs[0].face_force.max() == pytest.approx(5e3, rel=1e-3)


@pytest.mark.parametrize(
    ("text", "codes"),
    [
        ("time, force\n0,0\n10,5\n20,0\n", {"load-unit", "load-long"}),
        ("time [us], force [kN]\n0,0.3\n10,5\n20,0\n", {"load-offset"}),
        ("time [us], force [kN]\n0,0\n10,5\n20,0\n", set()),
    ],
)
def test_what_may_be_wrong_with_a_measured_load_is_said(tmp_path, text, codes):
    from strikewave import load_case, run_wave

    found = {notice.code for notice in run_wave(load_case(str(write_case(tmp_path, text)))).warnings}
    assert found & {"load-unit", "load-long", "load-offset"} == codes
