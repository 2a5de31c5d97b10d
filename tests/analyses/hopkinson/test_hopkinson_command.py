"""``strikewave hopkinson``: a shot and a calibration from set-up to files, and what bad input is told."""

import json
import os
from pathlib import Path

import numpy as np
import pytest

from strikewave.analyses.hopkinson.build import load_setup
from strikewave.cases.tables.common import EXAMPLE as TEST_EXAMPLE

from ...hopkinson import bench

SETUP = """
schema = 1
title = "Elastic <b>shot</b>"
[bar.incident]
density = "7800 kg/m^3"
modulus = {{ value = "210 GPa", provenance = "measured", note = "by echoes" }}
diameter = "20 mm"
gauge_distance = "{first} m"
[bar.incident.gauge]
file = "shot.csv"
channel = "incident"
[bar.transmitted]
gauge_distance = "{second} m"
[bar.transmitted.gauge]
file = "shot.csv"
channel = "transmitted"
[specimen]
length = "{length} m"
diameter = "12 mm"
density = "2700 kg/m^3"
modulus = "70 GPa"
[striker]
length = "{striker} m"
[solver]
dispersion = "none"
"""


@pytest.fixture(scope="module")
def record():
    """Bars, specimen and the text of a record of an elastic shot."""
    bars, specimen, traces, _ = bench.bench()
    columns = np.column_stack([1e6 * traces[0].time, *(1e6 * t.strain for t in traces)])
    lines = ["time [us],incident [ustrain],transmitted [ustrain]"]
    lines += [",".join(f"{value:.9g}" for value in row) for row in columns]
    return bars, specimen, "\n".join(lines) + "\n"


@pytest.fixture
def shot(record, tmp_path):
    bars, specimen, text = record
    (tmp_path / "shot.csv").write_text(text)
    striker = 90e-6 * bars[0].speed / 2.0
    made = SETUP.format(
        first=bars[0].gauge_distance, second=bars[1].gauge_distance, length=specimen.length, striker=striker
    )
    (tmp_path / "shot.toml").write_text(made)
    return "shot.toml"


def test_json_has_the_modulus_of_the_specimen_and_writes_nothing(strikewave, shot, tmp_path):
    """The numbers of tests/hopkinson/test_reduction.py, through file, units and command."""
    code, out, err = strikewave("hopkinson", shot, "--json")
    document = json.loads(out)
    assert code == 0, err
    assert {"schema", "version", "units", "warnings"} <= set(document)
    curve, time = document["curves"]["3-wave"], np.array(document["time"])
    plateau = (time > 40e-6) & (time < 85e-6)
    ratio = np.array(curve["stress"])[plateau] / np.array(curve["strain"])[plateau]
    assert ratio == pytest.approx(70e9, rel=2e-4)
    assert abs(document["momentum"]["closure"]) < 1e-4
    assert document["striker"]["duration"] == pytest.approx(document["striker"]["duration_expected"], abs=2e-7)
    assert document["striker"]["strain_expected"] is None
    assert document["inputs"]["bar.incident.modulus"]["provenance"] == "measured"
    assert document["bars"]["transmitted"]["derived"] == "speed"
    assert sorted(os.listdir(tmp_path)) == ["shot.csv", "shot.toml"]


@pytest.mark.verify
def test_files_are_whole_and_the_saved_case_gives_them_again(strikewave, shot, tmp_path):
    code, out, err = strikewave("hopkinson", shot)
    assert code == 0, err
    assert "3-wave" in out
    folder = tmp_path / "out" / "shot"
    names = ["case.toml", "pulses.csv", "record.toml", "reduction.csv", "reduction.nc", "report.html", "summary.svg"]
    assert sorted(os.listdir(folder)) == names
    page = (folder / "report.html").read_text("utf-8")
    assert "<b>shot</b>" not in page
    assert "&lt;b&gt;shot&lt;/b&gt;" in page
    assert "<script" not in page
    assert (folder / "reduction.csv").read_text().splitlines()[0].startswith("time [s],incident strain [1]")
    before = (folder / "reduction.csv").read_bytes()
    code, _, err = strikewave("hopkinson", folder, "--out", "again")
    assert code == 0, err
    assert (tmp_path / "again" / "reduction.csv").read_bytes() == before
    import xarray

    with xarray.open_dataset(folder / "reduction.nc", engine="h5netcdf") as data:
        assert data["first_force"].attrs["units"] == "N"
        assert list(data["analysis"].values) == ["1-wave", "2-wave", "3-wave"]


@pytest.mark.verify
def test_a_result_of_other_data_is_not_replaced_without_force(strikewave, shot, tmp_path):
    assert strikewave("hopkinson", shot, "--out", "kept")[0] == 0
    assert strikewave("hopkinson", shot, "--out", "kept")[0] == 0
    text = (tmp_path / "shot.csv").read_text()
    (tmp_path / "shot.csv").write_text(text.rstrip("\n").rpartition("\n")[0] + "\n")
    assert strikewave("hopkinson", shot, "--out", "kept")[0] == 2
    assert strikewave("hopkinson", shot, "--out", "kept", "--force")[0] == 0


def test_a_density_of_no_material_is_named(strikewave, shot):
    _, out, _ = strikewave("hopkinson", shot, "--json", "--set", "specimen.density=2.7 kg/m^3")
    messages = [warning["message"] for warning in json.loads(out)["warnings"] if warning["code"] == "material-far"]
    assert [message.partition(" is ")[0] for message in messages] == ["specimen.density = 2.7 kg/m^3"]


def test_a_broken_limit_is_told_and_exits_with_3(strikewave, shot):
    """A transmitted bar of half the stiffness makes half the force: impulses miss by half."""
    code, out, err = strikewave("hopkinson", shot, "--json", "--set", "bar.transmitted.modulus=105 GPa")
    assert code == 2
    assert "two of density, modulus and speed" in err
    changes = ("--set", "bar.transmitted.density=3900 kg/m^3", "--set", "bar.transmitted.modulus=1.05e11")
    code, out, err = strikewave("hopkinson", shot, "--json", *changes)
    assert code == 3, err
    codes = {warning["code"] for warning in json.loads(out)["warnings"]}
    assert {"force-misfit", "momentum"} <= codes


def test_a_voltage_with_its_bridge_is_the_same_strain(strikewave, shot, record, tmp_path):
    """Volts made by the arms of two opposite gauges, x/(2 + x), with an offset; strain back to 1e-9 of the plateau."""
    bars, _, text = record
    rows = [line.split(",") for line in text.splitlines()[1:]]
    lines = ["time [us],incident [V],transmitted [V]"]
    for time, *strains in rows:
        arms = [-2.0e-6 * float(s) for s in strains]
        lines.append(",".join([time, *(f"{0.3 + 800.0 * x / (2.0 + x):.15g}" for x in arms)]))
    plain = json.loads(strikewave("hopkinson", shot, "--json")[1])
    (tmp_path / "shot.csv").write_text("\n".join(lines) + "\n")
    changes = []
    for bar in ("incident", "transmitted"):
        gauge = {"bridge": "half", "gauge_factor": "2", "excitation": "8 V", "gain": "100"}
        changes += [part for key, value in gauge.items() for part in ("--set", f"bar.{bar}.gauge.{key}={value}")]
    volts = json.loads(strikewave("hopkinson", shot, "--json", *changes)[1])
    stress = [np.array(one["curves"]["1-wave"]["stress"]) for one in (plain, volts)]
    assert stress[1] == pytest.approx(stress[0], abs=1e-7 * stress[0].max())
    assert bars[0].stiffness > 0.0


def test_a_clipped_gauge_is_told(strikewave, shot, tmp_path, rng):
    """Noise on all samples, and an amplifier that ends at 60 % of the plateau."""
    lines = (tmp_path / "shot.csv").read_text().splitlines()
    rows = [[float(cell) for cell in line.split(",")] for line in lines[1:]]
    top = max(row[1] for row in rows)
    made = [
        f"{t},{min(i + 0.05 * rng.standard_normal(), 0.6 * top)},{o + 0.05 * rng.standard_normal()}" for t, i, o in rows
    ]
    (tmp_path / "shot.csv").write_text("\n".join([lines[0], *made]) + "\n")
    code, out, err = strikewave("hopkinson", shot, "--json")
    assert code == 3, err  # the incident impulse is missing
    told = [w["message"] for w in json.loads(out)["warnings"] if w["code"] == "record-clipped"]
    assert len(told) == 1
    assert "bar.incident.gauge" in told[0]


@pytest.mark.verify
def test_a_bar_alone_is_calibrated_by_its_echoes(strikewave, tmp_path):
    """A free bar of 1 m, 5000 m/s, in delay lines, stated 1 % too fast: the speed found, and a warning."""
    from strikewave.waves import End, Layer, LoadPulse, Stack, Tap, WantedError, run_bar

    layer = Layer("bar", 8000.0, 2e11, 1e-4, 1.0)
    run = run_bar(
        Stack((layer,), (), End("free")),
        LoadPulse("sine-squared", 1e3, 20e-6),
        [Tap(0, 0.5)],
        1.5e-3,
        WantedError(step=1e-7),
    )
    strain = np.concatenate([np.zeros(200), run.force[:, 0] / 2e7])
    lines = ["time [us],gauge [strain]", *(f"{0.1 * k:.10g},{e:.9g}" for k, e in enumerate(strain))]
    (tmp_path / "echo.csv").write_text("\n".join(lines) + "\n")
    (tmp_path / "echo.toml").write_text(
        'schema = 1\n[bar.incident]\ndensity = "8000 kg/m^3"\nspeed = "5050 m/s"\ndiameter = "11.28 mm"\n'
        'gauge_distance = "500 mm"\n[bar.incident.gauge]\nfile = "echo.csv"\n[solver]\ndispersion = "none"\n'
    )
    code, out, err = strikewave("hopkinson", "echo.toml", "--json")
    document = json.loads(out)
    assert code == 0, err
    assert document["speed"]["value"] == pytest.approx(5000.0, rel=1e-6)
    assert document["length"]["value"] == pytest.approx(1.0, rel=1e-6)
    assert [w["code"] for w in document["warnings"]] == ["speed-differs"]
    code, out, err = strikewave("hopkinson", "echo.toml", "--out", "echo")
    assert code == 0, err
    assert "bar speed (m/s)" in out
    names = ["case.toml", "echoes.csv", "echoes.nc", "report.html", "summary.svg"]
    assert sorted(os.listdir(tmp_path / "echo")) == names


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ("bar.incident.gauge_distance=0 m", "above 0"),
        ("bar.incident.gauge_distance=20 mm", "overlap"),
        ("bar.incident.gauge_distance=9 km", "record"),
        ("bar.incident.gauge.channel=3", "channel"),
        ("bar.incident.gauge.channel=transmitted", "another channel"),
        ("bar.incident.gauge.file=nothing.csv", "no such file"),
        ("bar.incident.gauge.unit=N", "strain"),
        ("bar.incident.gauge.unit=V", "strain_per_volt"),
        ("bar.incident.lenght=1 m", "length"),
        ("specimen.density=2 g", "gram"),
        ("solver.dispersion=love", "love-rayleigh"),
        ("solver.alignment=onsets", "onset"),
        ("limits.momentum=0", "above"),
        ("schema=2", "schema"),
        ("bar.incident.length=10 mm", r"^bar\.incident\.gauge_distance: .*length of the bar"),
        ("bar.incident.modulus=2100", r"bar speed of 0\.5189 m/s by 7800 kg/m\^3 and 2100 Pa"),
        ("bar.incident.gauge.channel=9", r"^bar\.incident\.gauge\.channel: "),
        ("bar.incident.gauge.file=nothing.csv", r"^bar\.incident\.gauge\.file: "),
        ("bar.incident.gauge.unit=strain", r"^incident trace: .*ustrain"),
        ("bar.transmitted.gauge.unit=strain", r"^transmitted trace: .*ustrain"),
        ("bar.transmitted.gauge.channel=incident", r"^bar\.transmitted\.gauge\.channel: .*another channel"),
        ("bar.transmitted.gauge.channel=1", r"^bar\.transmitted\.gauge\.channel: .*another channel"),
        ("specimen.length=1 nm", r"^specimen\.length: .*100 %"),
        ("striker.density=2700 kg/m^3", r"^striker\.modulus: missing"),
        ("striker.modulus=70 GPa", r"^striker\.density: missing"),
        ("bar=3", r"^--set bar: |^bar: got .*\[bar\]"),
        ("nonsense", "path=value"),
    ],
)
def test_bad_input_is_told_in_one_line_with_exit_2(strikewave, shot, change, told):
    import re

    code, out, err = strikewave("hopkinson", shot, "--json", "--set", change)
    assert code == 2, (out[:200], err)
    assert out == ""
    assert re.search(told, err), err
    assert "Traceback" not in err


@pytest.mark.parametrize(
    "text",
    [
        "",
        "schema = 1",
        "schema = 1\n[bar",
        "schema = 1\nbar = 3",
        "schema = 1\n[bar]\nincident = 3",
        "\x00\x01",
        "a." * 5000 + "a = 1",
        "schema = true",
    ],
)
def test_broken_set_ups_are_told(strikewave, tmp_path, text):
    (tmp_path / "bad.toml").write_text(text)
    code, out, err = strikewave("hopkinson", "bad.toml")
    assert code == 2
    assert out == ""
    assert "Traceback" not in err
    assert os.listdir(tmp_path) == ["bad.toml"]


def test_bars_and_specimen_must_go_together(strikewave, shot, tmp_path):
    text = (tmp_path / shot).read_text()
    begin, end = text.index("[specimen]"), text.index("[striker]")
    (tmp_path / shot).write_text(text[:begin] + text[end:])
    code, _, err = strikewave("hopkinson", shot)
    assert code == 2
    assert "[specimen] between two bars" in err


def test_set_ups_of_the_docs_are_read():
    """Every TOML block of docs/hopkinson.md is a set-up that the command takes."""
    import re

    from strikewave.analyses.hopkinson.build import parse_setup

    text = (Path(__file__).parents[3] / "docs" / "hopkinson.md").read_text("utf-8")
    blocks = re.findall(r"```toml\n(.*?)```", text, re.DOTALL)
    assert [parse_setup(block).setup.kind for block in blocks] == ["shot", "echoes", "sensor"]


def test_a_disk_needs_its_accelerometer(strikewave, shot, tmp_path):
    (tmp_path / shot).write_text((tmp_path / shot).read_text() + '[disk]\nkind = "rigid"\nmass = "1 kg"\n')
    code, _, err = strikewave("hopkinson", shot)
    assert code == 2
    assert "accelerometer: missing" in err


def test_changes_take_what_their_field_takes():
    """Text stays text, a bare number is SI, a number that was asked for is one; a path through a value is told."""
    from strikewave.analyses.hopkinson.build import parse_setup
    from strikewave.base.errors import InputErrors

    text = (
        'schema = 1\n[bar.incident]\ndensity = "7800 kg/m^3"\nspeed = "5000 m/s"\ndiameter = "20 mm"\n'
        'gauge_distance = "1 m"\n[bar.incident.gauge]\nfile = "a.csv"\n'
    )
    changes = ["title=5", "schema=1", "bar.incident.speed=4900", "bar.incident.gauge.channel=2", "echoes.skip=3"]
    setup = parse_setup(text, "a", changes).setup
    assert (setup.title, setup.bar.incident.gauge.channel, setup.echoes.skip.si) == ("5", "2", 3.0)
    assert setup.bar.incident.speed.si == 4900.0
    assert setup.bar.incident.speed.provenance == "user"
    with pytest.raises(InputErrors, match=r"bar\.incident\.density\.of: got 3; allowed: value, provenance"):
        parse_setup(text, "a", ["bar.incident.density.of=3"])


def test_what_stands_for_a_table_is_told_without_the_words_of_a_library(strikewave, tmp_path):
    (tmp_path / "bad.toml").write_text("schema = 1\n[bar]\nincident = 3\n")
    err = strikewave("hopkinson", "bad.toml")[2]
    assert err.startswith("bar.incident: got 3; allowed: a table [bar.incident] with material, density")
    assert "dictionary" not in err


def codes_of(strikewave, setup, *changes):
    """Return the document of a shot with changes, and the codes of its warnings."""
    code, out, err = strikewave("hopkinson", setup, "--json", *(part for c in changes for part in ("--set", c)))
    assert code in (0, 3), err
    document = json.loads(out)
    return document, {warning["code"] for warning in document["warnings"]}


UNFIT = {
    "specimen.diameter=21 mm": "specimen-wide",
    "bar.incident.diameter=150 mm": "gauge-near",
    "specimen.diameter=4 mm": "specimen-slender",
    "specimen.diameter=60 mm": "specimen-flat",
    "specimen.modulus=1 MPa": "stress-implausible",
    "specimen.diameter=1 um": "stress-implausible",
}


@pytest.mark.parametrize("change", UNFIT)
def test_what_cannot_be_of_a_specimen_is_told(strikewave, shot, change):
    assert UNFIT[change] in codes_of(strikewave, shot, change)[1]


def test_a_specimen_that_fits_is_told_nothing_of_it(strikewave, shot):
    assert not codes_of(strikewave, shot)[1] & {*UNFIT.values()}


def test_a_bar_that_would_yield_is_told(strikewave, shot, tmp_path):
    """7.6 ustrain times 1000 are 0.76 %: above 0.5, below the 2 that are refused."""
    text = (tmp_path / "shot.csv").read_text().splitlines()
    rows = [[float(cell) for cell in line.split(",")] for line in text[1:]]
    lines = [text[0], *(f"{t},{1000.0 * i},{1000.0 * o}" for t, i, o in rows)]
    (tmp_path / "shot.csv").write_text("\n".join(lines) + "\n")
    assert "bar-strain" in codes_of(strikewave, shot)[1]


def test_a_striker_takes_what_is_typed_over_its_material(strikewave, shot):
    """Width 2 L/c by what is typed; the material gives the rest."""
    plain = codes_of(strikewave, shot, "striker.material=65Mn")[0]["striker"]["duration_expected"]
    heavy = codes_of(strikewave, shot, "striker.material=65Mn", "striker.density=31280 kg/m^3")[0]
    from strikewave.base.constants import material

    ratio = np.sqrt(31280.0 / material("65Mn").density)
    assert heavy["striker"]["duration_expected"] == pytest.approx(ratio * plain, rel=1e-12)


@pytest.mark.verify
def test_tables_name_the_excess_impulse_and_hold_no_nan(strikewave, shot):
    """A transmitted bar that is said to be stiffer takes more impulse than came."""
    stiff = ("bar.transmitted.density=7800 kg/m^3", "bar.transmitted.speed=6000 m/s")
    code, out, err = strikewave("hopkinson", shot, *(part for c in stiff for part in ("--set", c)))
    assert code == 3, err
    assert "excess impulse" in out
    assert "missing" not in out
    assert "nan" not in out.lower()
    assert "slope of the rise" in out


def test_agreement_of_the_forces_is_told_with_begin_end_and_share(strikewave, shot):
    """An elastic specimen agrees on the plateau, 10 us of rise and a few transits of 2 us after the arrival."""
    alike = codes_of(strikewave, shot)[0]["equilibrium"]
    assert 5e-6 < alike["begin"] < 30e-6
    assert 80e-6 < alike["end"] < 100e-6
    assert alike["share"] >= (alike["end"] - alike["begin"]) / 102e-6


def echo_setup(tmp_path, length="", distance="300 mm", way="towards"):
    """Write a free bar of 1 m with its gauge 0.3 m from the far end, in delay lines, and its set-up."""
    from strikewave.waves import End, Layer, LoadPulse, Stack, Tap, WantedError, run_bar

    layer = Layer("bar", 8000.0, 2e11, 1e-4, 1.0)
    run = run_bar(
        Stack((layer,), (), End("free")),
        LoadPulse("sine-squared", 1e3, 20e-6),
        [Tap(0, 0.7)],
        1.9e-3,
        WantedError(step=1e-7),
    )
    strain = np.concatenate([np.zeros(400), run.force[:, 0] / 2e7])
    strain += 1e-9 * np.random.default_rng(4).standard_normal(strain.size)
    lines = ["time [us],gauge [strain]", *(f"{0.1 * k:.10g},{e:.9g}" for k, e in enumerate(strain))]
    (tmp_path / "echo.csv").write_text("\n".join(lines) + "\n")
    (tmp_path / "echo.toml").write_text(
        'schema = 1\n[bar.incident]\ndensity = "8000 kg/m^3"\nspeed = "5000 m/s"\ndiameter = "11.28 mm"\n'
        f'gauge_distance = "{distance}"\n{length}\n[bar.incident.gauge]\nfile = "echo.csv"\n[echoes]\nway = "{way}"\n'
        '[solver]\ndispersion = "none"\n'
    )
    return "echo.toml"


@pytest.mark.parametrize(
    ("stated", "codes"),
    [
        ({}, set()),
        ({"length": 'length = "1 m"'}, set()),
        ({"length": 'length = "1.03 m"'}, {"length-differs", "speed-differs"}),
        ({"way": "away"}, {"speed-differs"}),
        ({"way": "away", "length": 'length = "1 m"'}, {"way-differs", "length-differs"}),
    ],
    ids=["fits", "length fits", "length off", "way off", "way off with the length"],
)
def test_a_calibration_tells_what_does_not_fit(strikewave, tmp_path, stated, codes):
    code, out, err = strikewave("hopkinson", echo_setup(tmp_path, **stated), "--json")
    assert code == 0, err
    warnings = {one["code"]: one["message"] for one in json.loads(out)["warnings"]}
    assert set(warnings) == codes
    if "way" in stated:
        assert any('echoes.way = "towards" would give 5000 m/s' in message for message in warnings.values())


@pytest.mark.usefixtures("undrawn")
def test_a_calibration_states_students_factor(strikewave, tmp_path):
    """Nine passes and three unknowns: six degrees of freedom, 2.447 standard errors for 95 % (tables of Student)."""
    code, out, err = strikewave("hopkinson", echo_setup(tmp_path))
    assert code == 0, err
    document = json.loads(strikewave("hopkinson", "echo.toml", "--json")[1])
    assert document["speed"]["freedom"] == len(document["passes"]) - 3 == 6
    assert document["speed"]["student"] == pytest.approx(2.447, abs=1e-3)
    assert "2.45" in out


def test_new_writes_the_example_of_the_docs_and_validate_takes_it(strikewave, tmp_path):
    import re

    code, _, err = strikewave("new", "my-bars", "--from", "hopkinson")
    assert code == 0, err
    docs = (Path(__file__).parents[3] / "docs" / "hopkinson.md").read_text("utf-8")
    written = (tmp_path / "my-bars.toml").read_text("utf-8")
    assert written.removesuffix(TEST_EXAMPLE) == re.findall(r"```toml\n(.*?)```", docs, re.DOTALL)[0]
    assert strikewave("new", "my-bars", "--from", "hopkinson")[0] == 2
    code, out, err = strikewave("validate", "my-bars.toml")
    assert code == 0, err
    assert "bar.incident.speed" in out
    assert "3 measured" in out
    assert "not there yet" not in err
    document = json.loads(strikewave("validate", "my-bars.toml", "--json")[1])
    assert document["values"]["specimen.length"]["value"] == pytest.approx(3.204e-3)


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ("bar.incident.speed=4866 mm", "bar.incident.speed"),
        ("bar.incident.length=0.1 m", "gauge_distance"),
        ("striker.density=8000 kg/m^3", "striker.modulus"),
        ("specimen.area=1 mm^2", "either a diameter or an area"),
    ],
)
def test_validate_tells_what_is_wrong_with_a_set_up(strikewave, tmp_path, change, told):
    assert strikewave("new", "mine", "--from", "hopkinson")[0] == 0
    code, _, err = strikewave("validate", "mine.toml", "--set", change)
    assert code == 2
    assert told in err


def tension_warnings(strikewave, *command):
    code, out, err = strikewave("hopkinson", *command, "--json")
    assert code == 0, err
    return [
        (one["code"], one["message"])
        for one in json.loads(out)["warnings"]
        if one["code"] in ("tension", "signs-differ")
    ]


def test_the_first_sentence_says_that_compression_is_assumed(strikewave, shot):
    code, out, err = strikewave("hopkinson", shot)
    assert code == 0, err
    assert " ".join(out.split()).startswith("Each first pulse is taken as compression, whatever its sign: the specimen")
    assert tension_warnings(strikewave, shot) == []


@pytest.mark.parametrize(
    ("title", "warned"),
    [
        ("18CrNiMo7-6 in tension", "the title of the set-up says tension"),
        ("SHTB 7", "the title of the set-up says SHTB"),
        ("Zugversuch", "the title of the set-up says Zugversuch"),
        ("\u62c9\u4f38\u8bd5\u9a8c", "the title of the set-up says \u62c9\u4f38"),
        ("tension positive", "tension positive, and the first pulse of bar.incident.gauge is positive"),
        ("compression negative", "compression negative, and the first pulse of bar.incident.gauge is positive"),
        ("compression positive, no tension", ""),
        ("tension is negative", ""),
        ("attention: extension pulley", ""),
        ("compression - steel, shot 3", ""),
        ("shot 3 - compression", ""),
        ("compression (-)", "compression (-, and the first pulse of bar.incident.gauge is positive"),
    ],
)
def test_a_sign_or_a_shot_that_the_set_up_calls_tension_is_warned_of(strikewave, shot, title, warned):
    """The pulses of the shot are positive."""
    found = tension_warnings(strikewave, shot, "--set", f"title={title}")
    assert warned in (found[0][1] if found else "")
    assert bool(found) == bool(warned)


def test_a_head_or_a_channel_of_the_file_that_says_tension_is_warned_of(strikewave, shot, tmp_path):
    text = (tmp_path / "shot.csv").read_text()
    (tmp_path / "shot.csv").write_text("# gauges: tension is positive\n" + text)
    assert [code for code, _ in tension_warnings(strikewave, shot)] == ["tension", "tension"]
    (tmp_path / "shot.csv").write_text(text.replace("incident", "incident tension"))
    renamed = tension_warnings(strikewave, shot, "--set", "bar.incident.gauge.channel=incident tension")
    assert [code for code, _ in renamed] == ["tension"]


def test_first_pulses_of_opposite_signs_are_warned_of(strikewave, shot, tmp_path):
    head, *lines = (tmp_path / "shot.csv").read_text().splitlines()
    cells = [line.split(",") for line in lines]
    turned = [f"{time},{first},{-float(second):.9g}" for time, first, second in cells]
    (tmp_path / "shot.csv").write_text("\n".join([head, *turned]) + "\n")
    assert [code for code, _ in tension_warnings(strikewave, shot)] == ["signs-differ"]


@pytest.mark.parametrize("force", [(), ("--force",)])
def test_the_record_of_the_example_takes_the_place_of_no_measurement(strikewave, tmp_path, force):
    (tmp_path / "shot.csv").write_text("mine")
    code, _, err = strikewave("new", "my-bars", "--from", "hopkinson", *force)
    assert code == 0, err
    assert sorted(os.listdir(tmp_path)) == ["my-bars-shot.csv", "my-bars.toml", "shot.csv"]
    assert (tmp_path / "shot.csv").read_text() == "mine"
    setup = load_setup("my-bars.toml").setup
    assert setup.bar.incident.gauge.file == setup.bar.transmitted.gauge.file == "my-bars-shot.csv"
    (tmp_path / "my-bars-shot.csv").write_text("mine too")
    (tmp_path / "my-bars.toml").unlink()
    for name in ("shot", "my-bars"):  # the record of a set-up called shot is shot.csv
        code, _, err = strikewave("new", name, "--from", "hopkinson", *force)
        assert (code, (tmp_path / f"{name}.toml").exists()) == (2, False)
        assert "no file of yours is replaced" in err
    assert (tmp_path / "shot.csv").read_text() == "mine"
    assert (tmp_path / "my-bars-shot.csv").read_text() == "mine too"


def test_the_example_of_a_set_up_runs_under_any_name(strikewave):
    for name in ("my-bars", "a b", 'q"1'):
        assert strikewave("new", name, "--from", "hopkinson")[0] == 0
        assert strikewave("new", name, "--from", "hopkinson", "--force")[0] == 0  # the same record stays
        assert load_setup(f"{name}.toml").setup.bar.incident.gauge.file == f"{name}-shot.csv"
    code, _, err = strikewave("hopkinson", "my-bars.toml", "--json")
    assert code in (0, 3), err
