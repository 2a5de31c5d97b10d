"""``strikewave hopkinson`` with [accelerometer]: from set-up to files, and what bad input is told."""

import json
import os

import numpy as np
import pytest

from ...hopkinson.bench import sensor_bench

SENSOR = """
schema = 1
title = "Sensor <i>7</i>"
[bar.incident]
density = "2700 kg/m^3"
modulus = "70 GPa"
diameter = "20 mm"
gauge_distance = "{distance} m"
[bar.incident.gauge]
file = "sensor.csv"
channel = "gauge"
[accelerometer]
file = "sensor.csv"
channel = "sensor"
mass = "30 gram"
[uncertainty]
strain = 0.01
speed = {{ value = 0.002, provenance = "measured", note = "by echoes" }}
[solver]
dispersion = "none"
"""
VOLTS_PER_G = 1.2e-3


@pytest.fixture(scope="module")
def sensor_record():
    """The set-up and the record of a sensor of 30 gram and -1.2 mV/g at the end of a bar, 2 us late, in delay lines."""
    from strikewave.waves import End

    bar, strain, sensor, _ = sensor_bench(End("mass", 0.03))
    volts = 0.05 - VOLTS_PER_G / 9.80665 * np.interp(sensor.time - 2e-6, sensor.time, sensor.strain)
    columns = np.column_stack([1e6 * strain.time, 1e6 * strain.strain, 1e3 * volts])[::5]
    lines = ["time [us],gauge [ustrain],sensor [mV]", *(",".join(f"{v:.9g}" for v in row) for row in columns)]
    return SENSOR.format(distance=bar.gauge_distance), "\n".join(lines) + "\n"


@pytest.fixture
def sensor(sensor_record, tmp_path):
    text, record = sensor_record
    (tmp_path / "sensor.csv").write_text(record)
    (tmp_path / "sensor.toml").write_text(text)
    return "sensor.toml"


def test_the_sensitivity_of_an_accelerometer_is_found(strikewave, sensor):
    """Samples of 0.5 us at 200 kHz: cubics between ten samples a period of it, far less at the pulse's own 5 kHz."""
    code, out, err = strikewave("hopkinson", sensor, "--json")
    document = json.loads(out)
    assert code == 0, err
    found = document["sensitivity"]
    assert document["sensitivity_unit"] == document["units"]["sensitivity"] == "V s^2/m"
    assert (document["units"]["reading"], document["units"]["reading_integral"]) == ("V", "V s")
    assert found["value"] * 9.80665 == pytest.approx(-VOLTS_PER_G, rel=1e-5)
    assert found["by_peaks"] == pytest.approx(found["value"], rel=1e-4)
    assert found["by_velocity"] == pytest.approx(found["value"], rel=1e-4)
    assert found["relative"] == pytest.approx(np.hypot(0.01, 0.00208), rel=1e-3)  # the speed counts a little more
    assert document["delay"] == pytest.approx(2e-6, abs=2e-9)
    assert document["bandwidth_by"] == "sampling"
    assert [w["code"] for w in document["warnings"]] == ["sensor-reversed"]
    assert len(document["time"]) == len(document["reference_acceleration"]) == len(document["reading"])


def test_a_stated_sensitivity_makes_it_a_ratio(strikewave, sensor):
    """1.25 mV/g said of a sensor of 1.2; and the same record called g."""
    code, out, err = strikewave("hopkinson", sensor, "--json", "--set", "accelerometer.sensitivity=1.25 mV/g")
    document = json.loads(out)
    assert code == 0, err
    assert document["sensitivity_unit"] == document["units"]["sensitivity"] == "1"
    assert document["units"]["reading"] == "m/s^2"
    assert document["sensitivity"]["value"] == pytest.approx(-1.2 / 1.25, rel=1e-5)
    code, out, err = strikewave("hopkinson", sensor, "--json", "--set", "accelerometer.unit=g")
    assert json.loads(out)["sensitivity"]["value"] == pytest.approx(-1.2, rel=1e-5), err
    code, out, err = strikewave("hopkinson", sensor, "--json", "--set", "accelerometer.gain=10")
    assert json.loads(out)["sensitivity"]["value"] * 9.80665 == pytest.approx(-VOLTS_PER_G / 10.0, rel=1e-5), err


@pytest.mark.verify
def test_files_of_a_sensor_are_whole_and_read_again(strikewave, sensor, tmp_path):
    code, out, err = strikewave("hopkinson", sensor)
    assert code == 0, err
    assert "mV/g" in out
    folder = tmp_path / "out" / "sensor"
    names = ["case.toml", "record.toml", "reduction.csv", "reduction.nc", "report.html", "summary.svg"]
    assert sorted(os.listdir(folder)) == names
    page = (folder / "report.html").read_text("utf-8")
    assert "&lt;i&gt;7&lt;/i&gt;" in page
    assert "<i>7" not in page
    before = (folder / "reduction.csv").read_bytes()
    code, _, err = strikewave("hopkinson", folder, "--out", "again")
    assert code == 0, err
    assert (tmp_path / "again" / "reduction.csv").read_bytes() == before
    assert strikewave("hopkinson", sensor, "--out", "again", "--set", "solver.bandwidth=50 kHz")[0] == 2
    assert strikewave("hopkinson", sensor, "--out", "again", "--set", "solver.bandwidth=50 kHz", "--force")[0] == 0
    import xarray

    with xarray.open_dataset(folder / "reduction.nc", engine="h5netcdf") as data:
        assert data["reading"].attrs["units"] == "V"
        peak = float(data["reference_acceleration"].max())
    rows = np.genfromtxt(folder / "reduction.csv", delimiter=",", names=True)
    assert rows["reference_acceleration_ms2"].max() == pytest.approx(peak, rel=1e-8)


@pytest.mark.verify
def test_a_rise_that_is_too_steep_is_not_quoted(strikewave, sensor):
    """A rise of 48 us is 1.2 diameters of travel in a bar of 200 mm, and 2 to 5 in one of 60 mm."""
    words = ("hopkinson", sensor, "--set", "solver.bandwidth=100 kHz", "--set")
    code, out, err = strikewave(*words, "bar.incident.diameter=200 mm", "--json")
    document = json.loads(out)
    assert code == 0, err
    assert document["quoted"] is False
    assert document["sensitivity"]["value"] is None
    assert document["peak"]["acceleration"] is None
    assert document["velocity_change"]["velocity"] > 0.0
    assert "rise-too-steep" in {w["code"] for w in document["warnings"]}
    code, out, err = strikewave(*words, "bar.incident.diameter=200 mm", "--out", "steep")
    assert "not quoted" in out
    document = json.loads(strikewave(*words, "bar.incident.diameter=60 mm", "--json")[1])
    assert document["quoted"] is True
    assert "rise-steep" in {w["code"] for w in document["warnings"]}


def test_what_stands_on_the_end_is_read(strikewave, sensor, tmp_path):
    """30 gram as a rigid disk under a sensor without mass are the same; as an elastic one they warn of their shape.

    Rigid and elastic differ by (w t)^2/2, with the transit t = 2.3 us at 5 kHz 0.3 %.
    """
    text = (tmp_path / sensor).read_text().replace('mass = "30 gram"\n', "")
    first = json.loads(strikewave("hopkinson", sensor, "--json")[1])
    (tmp_path / sensor).write_text(text + '[disk]\nkind = "rigid"\nmass = "30 gram"\n')
    second = json.loads(strikewave("hopkinson", sensor, "--json")[1])
    assert second["sensitivity"]["value"] == first["sensitivity"]["value"]
    disk = '[disk]\nkind = "elastic"\nmaterial = "65Mn"\nthickness = "12.2 mm"\n'
    (tmp_path / sensor).write_text(text + disk)
    third = json.loads(strikewave("hopkinson", sensor, "--json")[1])
    assert third["end"]["disk_mass"] == pytest.approx(0.03, rel=0.01)
    assert third["sensitivity"]["value"] == pytest.approx(first["sensitivity"]["value"], rel=5e-3)
    assert third["delay"] < first["delay"]  # the disk itself takes its time
    assert "short-layer" in {w["code"] for w in third["warnings"]}


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ("accelerometer.channel=accel", "channel"),
        ("accelerometer.file=none.csv", "no such file"),
        ("accelerometer.unit=N", "acceleration"),
        ("accelerometer.unit=furlong", "accelerometer.unit"),
        ("accelerometer.sensitivity=1 mV/N", "accelerometer.sensitivity"),
        ("accelerometer.sensitivity=much", "accelerometer.sensitivity"),
        ("accelerometer.sensitivity=1e-300 V/g", "look at its factors"),
        ("accelerometer.gain=1e-300", "look at its factors"),
        ("accelerometer.rate=1 kHz", "solver.bandwidth"),
        ("accelerometer.excitation=10 V", "accelerometer.excitation"),
        ("accelerometer.mass=30 g", "gram"),
        ("accelerometer.mas=30 gram", "mass"),
        ("disk.kind=soft", "rigid"),
        ("disk.mass=20 gram", "disk.kind"),
        ("uncertainty.strain=1", "at most 0.5"),
        ("uncertainty.stain=0.1", "strain"),
        ("solver.bandwidth=10 MHz", "solver.bandwidth"),
        ("solver.bandwidth=10 Hz", "solver.bandwidth"),
        ("specimen.length=1 mm", "specimen"),
        ("bar.incident.gauge_distance=30 mm", "overlap"),
    ],
)
def test_bad_set_ups_of_a_sensor_are_told(strikewave, sensor, change, told):
    import re

    code, out, err = strikewave("hopkinson", sensor, "--json", "--set", change)
    assert code == 2, (out[:200], err)
    assert out == ""
    assert re.search(told, err), err
    assert "Traceback" not in err


@pytest.mark.parametrize(
    ("disk", "told"),
    [
        ('kind = "rigid"', "disk.mass"),
        ('kind = "rigid"\nmass = "0 kg"', "above 0"),
        ('kind = "rigid"\nmass = "1 kg"\nthickness = "2 mm"', "disk.thickness"),
        ('kind = "elastic"\nmass = "1 kg"', "disk.mass"),
        ('kind = "elastic"\nmaterial = "65Mn"', "disk.thickness"),
        ('kind = "elastic"\nthickness = "2 mm"\ndensity = "1000 kg/m^3"', "disk.material"),
        ('kind = "elastic"\nthickness = "2 mm"\nmaterial = "65Mm"', "65Mn"),
        ('kind = "elastic"\nthickness = "1 nm"\nmaterial = "65Mn"', "disk"),
    ],
)
def test_disks_that_do_not_fit_are_told(strikewave, sensor, tmp_path, disk, told):
    import re

    (tmp_path / sensor).write_text((tmp_path / sensor).read_text() + f"[disk]\n{disk}\n")
    code, _, err = strikewave("hopkinson", sensor, "--json")
    assert code == 2
    assert re.search(told, err), err
    assert "Traceback" not in err
