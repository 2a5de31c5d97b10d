"""The commands as a user types them: exit codes, JSON, files, one line an error."""

import json
import os
import signal
import subprocess
import sys
from xml.etree import ElementTree

import pytest

BLOW_KEYS = {
    "index", "kind", "time", "contacts", "approach_speed", "rebound_speed", "contact_time", "impulse", "peak_force", "rigid_peak", "width",
    "velocity_change", "largest_displacement", "wave_peak", "total_peak", "bandwidth", "turntable_speed", "sensors", "restitution", "indentation",
    "residual_indentation", "contact_stiffness", "flattening", "side_force",
    "side_impulse", "friction_heat", "blow_velocity_change", "contact_impulse",
}  # fmt: skip


def test_run_json_has_exactly_its_keys(strikewave, tmp_path):
    code, out, err = strikewave("run", "li-ma-2019", "--json")
    assert code == 0
    document = json.loads(out)
    assert set(document) == {
        "schema", "version", "units", "warnings", "case", "route", "blows", "masses", "phases", "balance", "contact", "waves", "published", "fitted_fields", "stale_fits",
        "band", "band_method",
    }  # fmt: skip
    assert all(set(blow) == BLOW_KEYS for blow in document["blows"])
    assert set(document["masses"]) == {"striker", "object", "assembly"}
    assert all(set(phase) == {"name", "time"} for phase in document["phases"])
    assert set(document["balance"]) == {"energy_error", "momentum_error"}
    keys = {"quantity", "published", "measured_or_simulated", "computed", "difference", "role"}
    assert all(set(row) == keys for row in document["published"])
    assert document["fitted_fields"] == ["machine.engagement", "object.frame_stiffness"]
    assert all(set(w) == {"code", "severity", "message", "value", "limit"} for w in document["warnings"])
    for blow in document["blows"]:
        assert blow["impulse"] == pytest.approx(document["masses"]["object"] * blow["blow_velocity_change"], rel=1e-6)
    names = {f"{which}.{what}" for which in ("first", "typical") for what in ("rigid_peak", "width", "velocity_change")}
    assert set(document["band"]) == names | {"interval"}
    assert all(set(band) == {"low", "high", "level", "inputs"} for band in document["band"].values())
    assert all(
        set(one) == {"field", "share", "standard_error"} for band in document["band"].values() for one in band["inputs"]
    )
    known = {"field", "typed", "low", "high", "unit", "basis", "reason"}
    assert all(set(one) == known for one in document["band_method"]["inputs"])
    assert "done in" in err
    assert os.listdir(tmp_path) == []


@pytest.mark.usefixtures("undrawn")
def test_run_writes_a_whole_result_that_runs_again_to_the_same_numbers(strikewave, tmp_path):
    code, out, err = strikewave("run", "--no-band", "li-ma-2019", "--set", "feed.blows=2", "--out", "a")
    assert code == 0
    assert sorted(os.listdir("a")) == ["blows.csv", "case.toml", "report.html", "solution.nc", "summary.svg"]
    assert sorted(os.listdir(tmp_path)) == ["a"]
    assert "Comparison with published values" not in out  # of a changed case: see the next test
    assert "printed contact law on a rigid object" in out
    assert "written: a/ (report.html, " in err
    assert open("a/report.html", encoding="utf-8").read().startswith("<!doctype html>")
    assert strikewave("run", "--no-band", "a/case.toml", "--out", "b")[0] == 0
    assert open("a/blows.csv").read() == open("b/blows.csv").read()
    assert open("a/case.toml").read() == open("b/case.toml").read()
    ElementTree.parse("a/summary.svg")


@pytest.mark.verify
def test_run_refuses_the_folder_of_another_result(strikewave):
    assert strikewave("run", "--no-band", "li-ma-2019", "--set", "feed.blows=1", "--out", "a", "--json")[0] == 0
    code, out, err = strikewave("run", "--no-band", "li-ma-2019", "--set", "feed.blows=2", "--out", "a", "--json")
    assert (code, out) == (2, "")
    assert "add --force" in err
    assert strikewave("run", "--no-band", "li-ma-2019", "--set", "feed.blows=2", "--out", "a", "--force")[0] == 0


@pytest.mark.verify
def test_changed_case_goes_to_a_folder_of_its_own(strikewave):
    assert strikewave("run", "--no-band", "li-ma-2019", "--set", "feed.blows=1")[0] == 0
    assert strikewave("run", "--no-band", "li-ma-2019", "--set", "feed.blows=2")[0] == 0
    assert len(os.listdir("out")) == 2


@pytest.mark.verify
def test_out_name_holds_the_last_run_of_that_name(strikewave):
    """new, run, change, run: nobody has to type --force for the folder that the command chose itself."""
    assert strikewave("new", "mine")[0] == 0
    assert strikewave("run", "--no-band", "mine.toml", "--set", "feed.blows=1")[0] == 0
    text = open("mine.toml").read().replace("value = 11,", "value = 1,", 1)
    for speed in ("730 rpm", "700 rpm"):
        open("mine.toml", "w").write(text.replace('"730 rpm"', f'"{speed}"'))
        assert strikewave("run", "--no-band", "mine.toml")[0] == 0
    assert "700 rpm" in open("out/mine/case.toml").read()


@pytest.mark.verify
def test_a_changed_case_says_so(strikewave):
    code, out, err = strikewave(
        "run", "--no-band", "li-ma-2019", "--set", "machine.speed=700 rpm", "--set", "feed.blows=2"
    )
    assert code == 0
    assert "here machine.speed = 700 rpm" in out
    assert "Comparison with published values" not in out
    assert "info [not-compared]" in err
    assert "warning [fit-stale]" in err
    assert "fitted: " not in out
    assert any(line.startswith("li-ma-2019: 700 rpm, 4 strikers") for line in out.splitlines())


@pytest.mark.verify
def test_fewer_or_more_blows_than_wanted_break_a_limit(strikewave):
    code, _, err = strikewave(
        "run", "--no-band", "li-ma-2019", "--set", "feed.retract_time=200 ms", "--set", "feed.blows=2"
    )
    assert code == 3
    assert "instead of the 2 wanted" in err


def test_json_goes_anywhere_after_the_command(strikewave):
    documents = [
        strikewave("cases", "--json")[1],
        strikewave("validate", "--json", "li-ma-2019")[1],
        strikewave("validate", "li-ma-2019", "--json")[1],
        strikewave("materials", "--json")[1],
        strikewave("diff", "li-ma-2019", "--json", "li-ma-2019")[1],
    ]
    for text in documents:
        document = json.loads(text)
        assert {"schema", "version", "units", "warnings"} <= set(document)
    assert documents[1] == documents[2]


IMPACT = ["impact", "--stiffness", "4.7e9", "--exponent", "1.1111", "--m1", "0.2", "--m2", "0.459", "--speed", "20"]


def test_impact_json(strikewave):
    code, out, _ = strikewave(*IMPACT, "-e", "0.5", "--damping", "exact", "--json")
    document = json.loads(out)
    assert code == 0
    assert document["restitution"] == pytest.approx(0.5, rel=1e-12)
    assert document["asked_restitution"] == 0.5
    assert document["duration"] == pytest.approx(30e-6, abs=0.5e-6)
    assert document["energy_lost"] == pytest.approx(0.5 * 0.2 * 0.459 / 0.659 * 400 * 0.75, rel=1e-12)
    keys = {
        "restitution", "asked_restitution", "max_indentation", "peak_force", "duration", "energy_lost", "stiffness",
        "exponent", "hysteresis_factor", "law", "law_status",
    }  # fmt: skip
    assert keys <= set(document)
    assert document["units"]["peak_force"] == "N"


def test_impact_by_law_with_units_and_an_infinite_mass(strikewave):
    words = [
        "impact",
        "--law",
        "palmgren",
        "--length",
        "40 mm",
        "--m1",
        "200 gram",
        "--m2",
        "inf",
        "--speed",
        "72 km/h",
    ]
    document = json.loads(strikewave(*words, "--json")[1])
    assert document["stiffness"] == pytest.approx(4.68e9, rel=2e-3)
    assert (document["law"], document["law_status"]) == ("palmgren", "quoted")
    assert document["energy_lost"] == 0.0
    code, out, _ = strikewave(*words)
    assert code == 0
    assert "palmgren" in out


def test_impact_says_when_a_law_misses_the_restitution(strikewave):
    document = json.loads(strikewave(*IMPACT, "-e", "0.5", "--damping", "li-ma-printed", "--json")[1])
    assert document["restitution"] == pytest.approx(0.4740, abs=5e-5)
    assert document["warnings"][0]["code"] == "restitution-differs"


BAD = [
    "run", "run nothing", "run li-ma-2019 --set machine.speed=fast", "run li-ma-2019 --set machine.sped=1",
    "run li-ma-2019 --set machine.speed", "run li-ma-2019 --set =3", "run li-ma-2019 --set object.nose_mass=9",
    "run li-ma-2019 --set contact.law=hertzz", "run li-ma-2019 --set striker.material=mud", "run li-ma-2019 --out .",
    "run li-ma-2019 --jsn", "rnu li-ma-2019", "run li-ma-2019 extra", "run taken", "run li-ma-2019 --out taken",
    "run li-ma-2019 --set machine.torque=1e-3", "run li-ma-2019 --set solver.tolerance=0.1", "validate nothing",
    "validate taken", "diff li-ma-2019", "diff li-ma-2019 nothing", "new", "new nowhere/case", "new mine --from nothing",
    "impact", "impact --m1 1 --m2 1 --speed 1", "impact --m1 1 --m2 1 --speed 1 --stiffness 1e9",
    "impact --m1 inf --m2 inf --speed 1 --stiffness 1e9 --exponent 1.5",
    "impact --m1 1 --m2 1 --speed -1 --stiffness 1e9 --exponent 1.5",
    "impact --m1 1 --m2 1 --speed 1 --stiffness 1e9 --exponent 1.5 -e 1.5",
    "impact --m1 1 --m2 1 --speed 1 --stiffness 1e9 --exponent 1.5 --damping exat",
    "impact --m1 1 --m2 1 --speed 1 --law palmgren", "impact --m1 1 --m2 1 --speed 1 --law hertz",
    "impact --m1 1 --m2 1 --speed 1 --law palmgrn", "impact --m1 heavy --m2 1 --speed 1 --law hertz",
    "impact --m1 1 --m2 1 --speed 1 --law palmgren --length 4 --stiffness 1e9", "run li-ma-2019 --out /",
    "impact --m1 1e300 --m2 1e300 --speed 1e300 --stiffness 1e9 --exponent 1.5", "new .", "new a/..",
    "impact --m1 1 --m2 1 --speed 1 --stiffness 1e9 --exponent 1.5 -e 1e-200", "run " + "x" * 300,
    "run li-ma-2019 --out " + "x" * 300, "run li-ma-2019 --out taken/below",
]  # fmt: skip


@pytest.mark.parametrize("line", BAD)
def test_bad_input_is_one_line_and_exit_2(strikewave, tmp_path, line):
    (tmp_path / "taken").write_text("not a case")
    code, out, err = strikewave(*line.split())
    assert code == 2
    assert out == ""
    assert len(err.strip().splitlines()) == 1, err
    assert "Traceback" not in err
    assert sorted(os.listdir(tmp_path)) == ["taken"]


def test_new_case_is_valid_and_differs_as_it_is_changed(strikewave):
    assert strikewave("new", "mine")[0] == 0
    assert strikewave("new", "mine")[0] == 2
    assert strikewave("new", "mine", "--force")[0] == 0
    assert strikewave("validate", "mine.toml")[0] == 0
    text = open("mine.toml").read()
    open("mine.toml", "w").write(text.replace('"730 rpm"', '"500 rpm"'))
    document = json.loads(strikewave("diff", "li-ma-2019", "mine.toml", "--json")[1])
    assert {"field": "machine.speed", "a": "730 rpm (published)", "b": "500 rpm (user)"} in document["differences"]
    assert "the cases are equal" in strikewave("diff", "li-ma-2019", "li-ma-2019")[1]


def test_validate_names_a_modulus_of_no_material(strikewave):
    change = ("--set", "stack.layer.upper.modulus=211 MPa")
    document = json.loads(strikewave("validate", "li-ma-2019-fig13-bar", "--json", *change)[1])
    assert [warning["code"] for warning in document["warnings"]] == ["material-far"]
    code, _, err = strikewave("validate", "li-ma-2019-fig13-bar", *change)
    assert code == 0
    assert "stack.layer.upper.modulus = 211 MPa is 1/1000 of that of 65Mn" in err


def test_validate_lists_every_value_with_its_provenance(strikewave):
    document = json.loads(strikewave("validate", "li-ma-2019", "--json")[1])
    assert document["values"]["machine.speed"]["provenance"] == "published"
    assert document["provenance"]["fitted"] == 2
    code, out, _ = strikewave("validate", "li-ma-2019")
    assert code == 0
    assert "2 fitted" in out


def test_broken_limit_exits_with_3(strikewave, monkeypatch):
    monkeypatch.setattr("strikewave.base.result.BALANCE_LIMIT", 0.0)
    code, out, _ = strikewave("run", "--no-band", "li-ma-2019", "--set", "feed.blows=1", "--json")
    assert code == 3
    assert {"energy-balance", "momentum-balance"} <= {w["code"] for w in json.loads(out)["warnings"]}


def test_our_own_fault_exits_with_1_in_one_line(strikewave, monkeypatch):
    monkeypatch.setattr("strikewave.analyses.machine.observe.blows", lambda run: 1 / 0)
    code, out, err = strikewave("run", "--no-band", "li-ma-2019", "--set", "feed.blows=1", "--json")
    assert (code, out) == (1, "")
    assert "please report it" in err


@pytest.mark.verify
def test_full_disk_leaves_nothing_half_written(strikewave, monkeypatch, tmp_path):
    def full(*_, **__):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("h5netcdf.File", full)
    code, _, err = strikewave("run", "--no-band", "li-ma-2019", "--set", "feed.blows=1", "--out", "a")
    assert code == 2
    assert "No space left" in err
    assert os.listdir(tmp_path) == []


@pytest.mark.verify
@pytest.mark.skipif(os.name == "nt", reason="signals of POSIX")
def test_interrupt_leaves_nothing_half_written(tmp_path, environment):
    """Ctrl-C while the result is being written."""
    program = (
        "import sys, time; from strikewave.reporting import run_and_write; write = run_and_write.write_files\n"
        "def slow(result, folder):\n"
        "    write(result, folder); print('writing', flush=True); time.sleep(60)\n"
        "run_and_write.write_files = slow\n"
        "sys.argv = ['strikewave', 'run', 'li-ma-2019', '--set', 'feed.blows=1', '--out', 'a']\n"
        "from strikewave.cli.app import main; main()\n"
    )
    child = subprocess.Popen(
        [sys.executable, "-c", program],
        cwd=tmp_path,
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert child.stdout.readline().strip() == "writing"
    child.send_signal(signal.SIGINT)
    _, err = child.communicate(timeout=30)
    assert child.returncode == 130
    assert "nothing was written" in err
    assert os.listdir(tmp_path) == []


def test_help_and_version(environment):
    done = subprocess.run(
        [sys.executable, "-m", "strikewave", "--help"], env=environment, capture_output=True, text=True, check=True
    )
    for command in ("run", "impact", "new", "validate", "diff", "cases", "materials"):
        assert command in done.stdout
    done = subprocess.run(
        [sys.executable, "-m", "strikewave", "--version"], env=environment, capture_output=True, text=True, check=True
    )
    assert done.stdout.startswith("strikewave ")


def test_heavy_libraries_are_imported_when_used(environment):
    """The reason why `import strikewave` and --help are fast; their times stand in the benchmarks."""
    program = "import sys, strikewave, strikewave.cli.app; print([m for m in ('numba','xarray','pint','matplotlib','scipy','pandas') if m in sys.modules])"
    done = subprocess.run([sys.executable, "-c", program], env=environment, capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
