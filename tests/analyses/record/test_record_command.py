"""strikewave record as a user types it: exit codes, one JSON document, refusals that say what is allowed, whole folders."""

import json
import math
import os
import re
import shutil
import subprocess
import sys
from xml.etree import ElementTree

import numpy as np
import pytest

G = 9.80665
STEP, LENGTH = 1e-5, 100
WIDTH = LENGTH * STEP * (1.0 - 2.0 * math.asin(0.1) / math.pi)


def history(peak, seed=1, size=4000):
    u = (np.arange(size) - 1500.3) / LENGTH
    return np.where((u > 0.0) & (u < 1.0), peak * np.sin(np.pi * u), 0.0) + 1e-4 * abs(peak) * np.random.default_rng(
        seed
    ).normal(size=size)


def write(name, *histories, header="time [s],board [V],frame [V]"):
    rows = [",".join(header.split(",")[: 1 + len(histories)])]
    rows += [
        f"{STEP * k:.5f}," + ",".join(f"{v:.9g}" for v in row) for k, row in enumerate(zip(*histories, strict=True))
    ]
    with open(name, "w") as file:
        file.write("\n".join(rows) + "\n")
    return name


def document(out):
    parsed = json.loads(out)
    json.dumps(parsed, allow_nan=False)
    assert out.count("\n") == 1
    return parsed


@pytest.fixture
def volts(strikewave):
    """A file with two channels in volts."""
    return write("shot.csv", history(1.2), history(-0.3, 2))


def test_json_has_exactly_its_keys_and_nothing_is_written(strikewave, volts):
    code, out, err = strikewave("record", volts, "--json", "--sensitivity", "1.2 mV/g")
    assert code == 0
    found = document(out)
    assert set(found) >= {"schema", "version", "units", "warnings", "files", "campaign"}
    [file] = found["files"]
    assert set(file) >= {"file", "status", "reasons", "channels"}
    assert (file["file"], file["status"]) == ("shot.csv", "suspect")
    assert "negative" in " ".join(file["reasons"])
    board, frame = file["channels"]
    for channel in (board, frame):
        assert set(channel) >= {"name", "sampling_rate", "unit", "health", "pulses"}
        assert all(set(row) >= {"code", "message", "value"} for row in channel["health"])
        [pulse] = channel["pulses"]
        assert set(pulse) >= {"time", "peak", "rise", "width", "velocity_change", "ringing_frequency"}
    assert set(found["campaign"]) >= {"peak", "width", "velocity_change"}
    assert set(found["campaign"]["peak"]) >= {"mean", "cv", "low", "high", "n"}
    assert found["units"]["peak"] == "m/s^2"
    assert found["units"]["velocity_change"] == "m/s"
    assert found["units"]["width"] == found["units"]["time"] == "s"
    assert os.listdir() == ["shot.csv"]
    assert "done in" in err


def test_json_is_in_si(strikewave, volts):
    _, out, _ = strikewave("record", volts, "--channel", "board", "--sensitivity", "1.2 mV/g", "--json")
    [channel] = document(out)["files"][0]["channels"]
    [pulse] = channel["pulses"]
    assert (channel["name"], channel["unit"]) == ("board", "m/s^2")
    assert channel["sampling_rate"] == pytest.approx(1.0 / STEP)
    assert pulse["peak"] == pytest.approx(1000.0 * G, rel=2e-3)
    assert pulse["width"] == pytest.approx(WIDTH, rel=5e-3)
    assert pulse["velocity_change"] == pytest.approx(2e3 / math.pi * G * LENGTH * STEP, rel=5e-3)
    assert pulse["time"] == pytest.approx(STEP * 1550.3, abs=STEP)


def test_provenance_stands_in_the_json_as_typed(strikewave, volts):
    _, out, _ = strikewave(
        "record", volts, "--sensitivity", "1.20 mV/g", "--gain", "10", "--polarity", "frame=-1", "--json"
    )
    board, frame = document(out)["files"][0]["channels"]
    assert board["calibration"].items() >= {"sensitivity": "1.20 mV/g", "gain": "10"}.items()
    assert frame["calibration"].items() >= {"sensitivity": "1.20 mV/g", "gain": "10", "polarity": -1}.items()
    assert frame["pulses"][0]["peak"] > 0.0


@pytest.mark.parametrize("place", range(5))
def test_json_may_come_anywhere_after_the_command(strikewave, volts, place):
    words = [volts, "--channel", "board", "--unit", "g"]
    whole = [(word,) for word in words[:1]] + [tuple(words[1:3]), tuple(words[3:])]
    whole.insert(min(place, len(whole)), ("--json",))
    code, out, _ = strikewave("record", *(word for pair in whole for word in pair))
    assert code == 0
    assert document(out)["files"][0]["channels"][0]["unit"] == "m/s^2"


@pytest.mark.parametrize(
    ("option", "bare", "typed"),
    [
        ("--rate", "200000", "200 kHz"),
        ("--count", "0.000305", "305 uV"),
        ("--drop-height", "1.2", "1200 mm"),
        ("--filter", "5000", "5 kHz"),
    ],
)
def test_a_bare_number_is_si(strikewave, volts, option, bare, typed):
    words = ["record", volts, "--channel", "1", "--sensitivity", "1 mV/g", "--json"]
    one, two = (document(strikewave(*words, option, value)[1]) for value in (bare, typed))
    pulses = [found["files"][0]["channels"][0]["pulses"][0] for found in (one, two)]
    assert pulses[0]["peak"] == pytest.approx(pulses[1]["peak"], rel=1e-12)
    assert pulses[0]["width"] == pytest.approx(pulses[1]["width"], rel=1e-12)


def test_channels_are_taken_by_name_or_number(strikewave, volts):
    for wanted, names in (
        (["2"], ["frame"]),
        (["frame"], ["frame"]),
        (["2", "board"], ["frame", "board"]),
        ([], ["board", "frame"]),
    ):
        words = [word for one in wanted for word in ("--channel", one)]
        _, out, _ = strikewave("record", volts, *words, "--json")
        assert [channel["name"] for channel in document(out)["files"][0]["channels"]] == names


def test_a_file_without_a_calibration_says_so(strikewave, volts):
    _, out, _ = strikewave("record", volts, "--json")
    found = document(out)
    [warning] = found["warnings"]
    assert set(warning) == {"code", "severity", "message", "value", "limit"}
    assert warning["code"] == "not-calibrated"
    assert found["units"]["peak"] == "V"


def test_files_beside_the_data_calibrate_it_and_what_is_typed_goes_first(strikewave, volts):
    peaks = []
    for beside, text, typed in (
        ("calibration.toml", '[all]\nsensitivity = "1 mV/g"\n', ()),
        ("shot.csv.toml", '[channel.board]\nsensitivity = "2 mV/g"\n', ()),
        (None, None, ("--sensitivity", "1=4 mV/g")),
    ):
        if beside:
            with open(beside, "w") as file:
                file.write(text)
        _, out, _ = strikewave("record", volts, "--channel", "board", "--json", *typed)
        peaks.append(document(out)["files"][0]["channels"][0]["pulses"][0]["peak"])
    assert peaks == pytest.approx([1200.0 * G, 600.0 * G, 300.0 * G], rel=2e-3)


def test_a_campaign_of_files_in_any_order(strikewave):
    peaks = [0.9, 1.0, 1.1, 1.2]
    names = [write(f"shot{k}.csv", history(peak, k)) for k, peak in enumerate(peaks)]
    campaigns = []
    for order in (names, names[::-1]):
        code, out, _ = strikewave("record", *order, "--sensitivity", "1 mV/g", "--json")
        assert code == 0
        campaigns.append(document(out)["campaign"])
    assert campaigns[0]["peak"]["mean"] == pytest.approx(1050.0 * G, rel=2e-3)
    assert campaigns[0]["peak"]["n"] == 4
    assert campaigns[0]["peak"] == pytest.approx(campaigns[1]["peak"], rel=1e-12)
    assert campaigns[0]["trend"]["peak"]["slope"] == pytest.approx(100.0 * G, rel=0.02)
    assert campaigns[1]["trend"]["peak"]["slope"] == pytest.approx(-100.0 * G, rel=0.02)


def test_an_unreadable_file_among_others_is_named_and_exits_3(strikewave, volts):
    with open("broken.csv", "wb") as file:
        file.write(bytes(range(256)) * 20)
    code, out, err = strikewave("record", volts, "broken.csv", "missing.csv", "--sensitivity", "1 mV/g", "--json")
    assert code == 3
    found = document(out)
    assert [file["status"] for file in found["files"]][1:] == ["bad", "bad"]
    assert all(file["reasons"] and file["channels"] == [] for file in found["files"][1:])
    assert {row["file"] for row in found["campaign"]["left_out"]} >= {"broken.csv", "missing.csv"}
    assert found["campaign"]["peak"]["n"] == 1
    assert "broken.csv" in err
    assert "missing.csv" in err


def test_a_file_without_time_among_others_is_named_and_exits_3(strikewave, volts):
    with open("bare.csv", "w") as file:
        file.write("board,frame\n" + "".join(f"{0.1 * (k % 3)},{0.2 * (k % 5)}\n" for k in range(100)))
    code, out, err = strikewave("record", volts, "bare.csv", "--sensitivity", "1 mV/g", "--json")
    assert code == 3
    found = document(out)
    assert (found["files"][1]["status"], found["campaign"]["peak"]["n"]) == ("bad", 1)
    assert "a sampling rate" in found["files"][1]["reasons"][0]
    assert "left out: bare.csv: --rate" in err
    code, out, err = strikewave("record", "bare.csv", "--json")
    assert (code, out) == (2, "")
    assert "--rate" in err


def test_a_calibration_that_fits_none_of_the_files_is_bad_input(strikewave, volts):
    shutil.copy(volts, "again.csv")
    code, out, err = strikewave("record", volts, "again.csv", "--sensitivity", "0 mV/g", "--json")
    assert (code, out) == (2, "")
    assert "--sensitivity: got" in err


def test_files_of_which_none_can_be_read_are_bad_input(strikewave):
    code, out, err = strikewave("record", "a.csv", "b.csv", "--json")
    assert (code, out) == (2, "")
    assert "no such file: a.csv" in err


@pytest.mark.parametrize(
    ("words", "field", "came", "allowed"),
    [
        (("--rate", "0"), "--rate", '"0"', "above zero"),
        (("--rate", "-5 kHz"), "--rate", '"-5 kHz"', "above zero"),
        (("--rate", "5 m"), "--rate", '"5 m"', "a frequency"),
        (("--rate", "inf"), "--rate", '"inf"', "above zero"),
        (("--rate", "nan"), "--rate", '"nan"', "a frequency"),
        (("--channel", "bord"), "--channel", '"bord"', "board"),
        (("--channel", "9"), "--channel", '"9"', "from 1 to 2"),
        (("--time", "9"), "--time", '"9"', "from 1 to 3"),
        (("--sensitivity", "1.2"), "sensitivity", '"1.2"', "1.2 mV/g"),
        (("--sensitivity", "0 mV/g"), "sensitivity", '"0 mV/g"', "not zero"),
        (("--sensitivity", "bord=1 mV/g"), "--sensitivity", "bord", "board"),
        (("--unit", "bananas"), "unit", '"bananas"', "m/s^2"),
        (("--polarity", "2"), "--polarity", '"2"', "1 or -1"),
        (("--polarity", "frame=up"), "--polarity", '"up"', "1 or -1"),
        (("--gain", "10"), "gain", '"10"', "sensitivity"),
        (("--sensitivity", "1 uV/V/g", "--excitation", "0"), "excitation", '"0 V"', "voltage"),
        (("--drop-height", "-1 m"), "--drop-height", '"-1 m"', "above zero"),
        (("--drop-height", "1 s"), "--drop-height", '"1 s"', "a length"),
        (("--filter", "0"), "--filter", '"0"', "above zero"),
        (("--filter", "1 GHz"), "--filter", "1000 MHz", "half the sampling rate"),
        (("--cfc", "no"), "--cfc", '"no"', "60, 180, 600 or 1000"),
        (("--cfc", "1000", "--filter", "1 kHz"), "--cfc", '"1000"', "either --filter or --cfc"),
    ],
)
def test_wrong_input_says_field_what_came_and_what_is_allowed(strikewave, volts, words, field, came, allowed):
    code, out, err = strikewave("record", volts, *words, "--json")
    assert (code, out) == (2, "")
    assert field in err
    assert came in err
    assert allowed in err
    assert "Traceback" not in err
    assert os.listdir() == ["shot.csv"]


def test_wrong_input_is_as_short_without_json(strikewave, volts):
    code, out, err = strikewave("record", volts, "--channel", "bord")
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert '"bord"' in err


def test_a_wrong_option_and_no_file_are_bad_input(strikewave):
    for words in ((), ("--json",), ("a.csv", "--sensitivty", "1 mV/g"), ("a.csv", "--channel")):
        code, out, err = strikewave("record", *words)
        assert (code, out) == (2, "")
        assert "see `strikewave record --help`" in err
        assert len(err.splitlines()) == 1


def test_a_hostile_calibration_file_is_bad_input(strikewave, volts):
    with open("calibration.toml", "w") as file:
        file.write("[all]\nsensitivity = [1]\n")
    code, out, err = strikewave("record", volts, "--json")
    assert (code, out) == (2, "")
    assert "calibration.toml: all.sensitivity: got [1]" in err


@pytest.mark.parametrize("name", ["--weird.csv", "a b.csv", "ünï.csv", "$(touch x).csv", "line\nbreak.csv"])
def test_any_file_name_is_a_file_name(strikewave, volts, name):
    os.rename(volts, name)
    code, out, _ = strikewave("record", "--json", "--unit", "g", "--", name)
    assert code == 0
    assert document(out)["files"][0]["file"] == name
    assert os.listdir() == [name]


def test_bad_records_are_done_and_exit_0(strikewave):
    write("dead.csv", np.full(200, 1.5))
    code, out, _ = strikewave("record", "dead.csv", "--json")
    found = document(out)
    assert code == 0
    assert found["files"][0]["status"] == "bad"
    assert "dead" in found["files"][0]["reasons"][0]
    assert "peak" not in found["campaign"]


def test_what_starts_the_command_is_light(environment, tmp_path):
    """--help needs no numbers, and a wrong option is refused before a file is read."""
    program = "import sys; sys.argv = ['strikewave', 'record', '--help']\nfrom strikewave.cli import app\ntry: app.main()\nfinally: print('scipy' in sys.modules, 'matplotlib' in sys.modules)"
    done = subprocess.run(
        [sys.executable, "-c", program], env=environment, cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert done.stdout.endswith("False False\n")


@pytest.mark.verify
def test_a_folder_appears_whole_and_is_the_same_again(strikewave, volts):
    words = ("record", volts, "--channel", "board", "--sensitivity", "1.2 mV/g")
    code, out, err = strikewave(*words)
    assert code == 0
    assert sorted(os.listdir("out/record-shot")) == ["pulses.csv", "record.toml", "report.html", "summary.svg"]
    assert sorted(os.listdir("out")) == ["record-shot"]
    assert "board" in out
    assert "written: out/record-shot/" in err
    with open("out/record-shot/pulses.csv") as file:
        header, row = file.read().splitlines()
    found = dict(zip(header.split(","), row.split(","), strict=True))
    assert float(found["peak [m/s^2]"]) == pytest.approx(1000.0 * G, rel=2e-3)
    assert found["unit"] == "m/s^2"
    ElementTree.parse("out/record-shot/summary.svg")
    with open("out/record-shot/report.html", encoding="utf-8") as file:
        assert file.read().startswith("<!doctype html>")
    first = open("out/record-shot/pulses.csv").read()
    shutil.rmtree("out")
    assert strikewave(*words)[0] == 0
    assert open("out/record-shot/pulses.csv").read() == first


@pytest.mark.verify
def test_json_with_out_writes_too_and_never_over_other_files(strikewave, volts):
    words = ("record", volts, "--unit", "g", "--json", "--out", "there")
    assert strikewave(*words)[0] == 0
    assert "pulses.csv" in os.listdir("there")
    code, out, err = strikewave(*words, "--polarity", "-1")
    assert (code, out) == (2, "")
    assert "--force" in err
    assert strikewave(*words, "--polarity", "-1", "--force")[0] == 0
    os.mkdir("mine")
    open("mine/thesis.doc", "w").close()
    code, out, err = strikewave("record", volts, "--unit", "g", "--json", "--out", "mine", "--force")
    assert (code, out) == (2, "")
    assert os.listdir("mine") == ["thesis.doc"]


def test_the_exit_code_follows_the_worst_status_that_is_asked_for(strikewave):
    write("good.csv", history(100.0), header="time [s],board [g]")
    write("turned.csv", history(-100.0), header="time [s],board [g]")  # negative blows: suspect
    assert strikewave("record", "good.csv", "--json", "--fail-on", "suspect")[0] == 0
    assert strikewave("record", "turned.csv", "--json")[0] == 0
    assert strikewave("record", "turned.csv", "--json", "--fail-on", "bad")[0] == 0
    code, out, err = strikewave("record", "good.csv", "turned.csv", "--json", "--fail-on", "suspect")
    assert code == 3
    [warning] = document(out)["warnings"]
    assert (warning["code"], warning["value"]) == ("fail-on", 1.0)
    assert "1 suspect of 2 files" in warning["message"]
    assert "exit code 3: check failed: fail-on" in err


def test_repeats_in_columns_make_one_campaign(strikewave):
    peaks = [100.0, 104.0, 96.0]
    write("all.csv", *map(history, peaks), header="time [s],shot 1 [g],shot 2 [g],shot 3 [g]")
    _, out, _ = strikewave("record", "all.csv", "--columns", "repeats", "--json")
    found = document(out)
    assert [file["file"] for file in found["files"]] == [f"all.csv: shot {k}" for k in (1, 2, 3)]
    assert "campaigns" not in found
    assert found["campaign"]["channel"] == "shot"
    peak = found["campaign"]["peak"]
    assert (peak["n"], peak["mean"] / G) == (3, pytest.approx(100.0, rel=2e-3))  # noise of 1e-4 at the top
    assert peak["cv"] == pytest.approx(0.04, rel=0.02)


def test_files_are_taken_in_natural_order_where_they_come_as_a_shell_lists_them(strikewave):
    names = ["a1.csv", "a10.csv", "a2.csv"]
    for name in names:
        write(name, history(100.0), header="time [s],board [g]")

    def order(*given):
        return [file["file"] for file in document(strikewave("record", *given, "--json")[1])["files"]]

    assert order(*names) == ["a1.csv", "a2.csv", "a10.csv"]
    assert order("a*.csv") == ["a1.csv", "a2.csv", "a10.csv"]  # where the shell leaves patterns to the command
    assert order("a10.csv", "a1.csv", "a2.csv") == [
        "a1.csv",
        "a2.csv",
        "a10.csv",
    ]  # as locales sort that pass marks over
    assert order("a2.csv", "a1.csv", "a10.csv") == ["a2.csv", "a1.csv", "a10.csv"]
    code, out, err = strikewave("record", "a1.csv", "./a1.csv", "--json")
    assert (code, len(document(out)["files"])) == (0, 1)
    assert "named twice" in err


def test_a_unit_that_is_a_mass_is_refused_with_what_may_be_meant(strikewave):
    write("shot.csv", history(1.2), header="time [s],board [kg]")
    code, _, err = strikewave("record", "shot.csv", "--unit", "kg", "--json")
    assert (code, '--unit "1000 g"' in err) == (2, True)
    code, out, _ = strikewave("record", "shot.csv", "--unit", "1000 g", "--json")
    assert code == 0
    assert document(out)["campaign"]["peak"]["mean"] / G == pytest.approx(1200.0, rel=2e-3)
    _, out, _ = strikewave("record", "shot.csv", "--json")
    assert "kg is a mass" in document(out)["warnings"][0]["message"]


@pytest.mark.verify
def test_screen_report_and_document_advise_the_same_filter(strikewave):
    u = np.arange(4000.0)
    ringing = np.where(
        u > 1500.0, 30.0 * np.exp(-(u - 1500.0) / 150.0) * np.sin(2.0 * np.pi * (u - 1500.0) / 20.0), 0.0
    )
    write("smooth.csv", history(100.0), header="time [s],board [g]")
    write("rings.csv", history(100.0) + ringing, header="time [s],board [g]")
    hum = 0.5 * np.sin(u / 3.0) + np.where(u == 700.0, 100.0, 0.0)  # a spike, steeper than any blow, and no blow
    write("spike.csv", hum, header="time [s],board [g]")
    code, out, _ = strikewave("record", "smooth.csv", "rings.csv", "spike.csv", "--out", "found")
    assert code == 0
    shown = float(re.search(r"a low-pass of ([\d.]+) kHz", " ".join(out.split()))[1])
    with open("found/report.html") as file:
        page = file.read()
    assert f"{shown:g} kHz" in re.search(r"advised: ([^<]*)", page)[1]
    assert set(re.findall(r"advised cutoff, ([\d.]+ kHz)", page)) == {f"{shown:g} kHz"}
    _, out, _ = strikewave("record", "smooth.csv", "rings.csv", "spike.csv", "--json")
    found = document(out)
    assert found["advised_cutoff"] == pytest.approx(1e3 * shown, rel=1e-12)
    each = [file["channels"][0]["advised_cutoff"] for file in found["files"][:2]]
    assert found["advised_cutoff"] == pytest.approx(max(each), rel=1e-2)  # three digits, rounded up
    # a half-sine of 1 ms widens by 2 % at a cutoff of 2.47 over its length; the ringing one is fitted within some percent
    assert found["advised_cutoff"] == pytest.approx(2470.0, rel=0.15)


@pytest.mark.parametrize(
    ("option", "value", "words"),
    [
        ("--gain", "ten", "a number that is not zero"),
        ("--gain", "0", "a number that is not zero"),
        ("--sensitivity", "1.2", "1.2 mV/g"),
        ("--count", "1 g", "a voltage"),
        ("--excitation", "-5", "a voltage above zero"),
        ("--unit", "kNN", 'did you mean "kN"'),
        ("--time-unit", "mss", 'did you mean "ms"'),
        ("--columns", "rows", "channels or repeats"),
        ("--fail-on", "good", "bad or suspect"),
    ],
)
def test_a_value_that_can_be_none_is_refused_by_the_name_of_its_option(strikewave, volts, option, value, words):
    code, out, err = strikewave("record", volts, "--json", option, value)
    assert (code, out) == (2, "")
    assert err.startswith(f"{option}: got")
    assert words in err
