"""``record --sensor``: blows of records on a sensor, by the command and in Python."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

import strikewave as sw

G, STEP = 9.80665, 1e-6
BLOWS = ((4e-3, 2e-4, 15000.0), (9e-3, 3e-5, 12000.0), (14e-3, 2e-4, 30000.0))
"""Begin, duration and peak (g) of half-sines: one that fits, one too short for 80 kHz, one beyond 20 000 g."""


@pytest.fixture
def shot(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    time = STEP * np.arange(19_000)
    values = sum(
        np.where((time > a) & (time < a + d), peak * np.sin(np.pi * (time - a) / d), 0.0) for a, d, peak in BLOWS
    )
    for name, sign in (("shot.csv", 1.0), ("down.csv", -1.0)):
        np.savetxt(name, np.column_stack([time, sign * values]), "%.8g", ",", header="time (s),frame (g)", comments="")
    return "shot.csv"


VERDICTS = ["can take it", "pulse too short for its resonance", "range exceeded"]


@pytest.mark.verify
def test_each_blow_is_tried(strikewave, shot):
    code, out, err = strikewave("record", shot, "--sensor", "endevco 2225", "--json", "--out", "out")
    assert code == 0, err
    found = json.loads(out)["sensor"]
    assert [blow["verdict"] for blow in found["blows"]] == VERDICTS
    assert (found["model"], found["status"], found["takes"]) == ("Endevco 2225", "from memory", False)
    last = found["blows"][2]
    # six samples lie under a ten-thousandth about the top of the half-sine
    assert last["peak_left"] == pytest.approx(found["range"] / (30000.0 * G), rel=2e-4)
    assert last["time_clipped"] == pytest.approx(2e-4 * (1.0 - 2.0 * math.asin(2.0 / 3.0) / math.pi), rel=0.02)
    codes = [notice["code"] for notice in json.loads(out)["warnings"]]
    assert {"sensor-from-memory", "sensor-trial"} <= set(codes)
    page = Path("out/report.html").read_text("utf-8")
    assert "On another sensor" in page
    assert all(verdict in page for verdict in VERDICTS)
    assert len(Path("out/sensor.csv").read_text("utf-8").splitlines()) == 4


@pytest.mark.verify
def test_the_screen_and_python_say_the_same(strikewave, shot):
    said = "Endevco 2225: can take 1 of 3 blows; pulse too short for its resonance in 1; range exceeded in 1."
    code, out, err = strikewave("record", shot, "--sensor", "Endevco 2225", "--wide")
    assert code == 0, err
    assert said in " ".join(out.split())
    assert "On Endevco 2225" in out
    result = sw.record(shot, examination=sw.Examination(sensor="Endevco 2225"))
    assert result.sensor.sentence() == said
    assert sw.record(shot).sensor is None


def test_a_file_gives_mounting_recorder_and_its_own_numbers(shot):
    Path("own.toml").write_text(
        '[[sensor]]\nname = "own"\nmodel = "Endevco 2225"\nrange = "50000 g"\nresonance = "2 MHz"\n'
        'sampling_rate = "100 kHz"\ncutoff = "20 kHz"\n'
    )
    found = sw.record(shot, examination=sw.Examination(sensor=Path("own.toml"))).sensor
    assert [blow.trial.verdict for blow in found.blows][1:] == ["pulse too short for its recorder", "can take it"]
    assert (found.stated.notices, found.called, found.row.status) == ((), "own", "stated")
    assert [notice.code for notice in found.notices] == ["sensor-trial", "sensor-beyond-band"]
    Path("soft.toml").write_text(
        '[[sensor]]\nname = "soft"\nrange = "50000 g"\nmass = "5 gram"\n'
        '[[sensor.gasket]]\nmaterial = "rubber"\nthickness = "3 mm"\ndiameter = "10 mm"\n'
    )
    found = sw.record(shot, examination=sw.Examination(sensor="soft.toml")).sensor
    assert found.resonance < 5e3
    [gasket] = found.row.gaskets
    assert (gasket.thickness, found.row.sensor_mass) == (3e-3, 5e-3)
    assert {blow.trial.verdict for blow in found.blows} == {"pulse too short for its resonance"}


def test_blows_to_the_other_side_come_out_alike(shot):
    up, down = (
        sw.record(name, examination=sw.Examination(sensor="PCB 3991A1020KG")).sensor.blows
        for name in (shot, "down.csv")
    )
    assert [blow.trial for blow in up] == [blow.trial for blow in down]


@pytest.mark.parametrize(
    ("stated", "lacks"), [('range = "50000 g"', "resonance"), ('resonance = "2 MHz"', "range"), ("", "range")]
)
def test_a_file_that_lacks_range_or_resonance_says_what_to_add_and_takes_nothing(strikewave, shot, stated, lacks):
    gasket = '[[sensor.gasket]]\nmaterial = "rubber"\nthickness = "1 mm"\ndiameter = "10 mm"\n'
    Path("own.toml").write_text(f'[[sensor]]\nname = "own"\nmass = "5 gram"\n{stated}\n{gasket if not stated else ""}')
    code, out, err = strikewave("record", shot, "--sensor", "own.toml", "--json")
    assert code == 0, err
    document = json.loads(out)
    notices = [w["message"] for w in document["warnings"] if w["code"] == "sensor-incomplete"]
    assert any(f"own states no {lacks}" in message and f"add {lacks} = " in message for message in notices)
    verdicts = {blow["verdict"] for blow in document["sensor"]["blows"]}
    assert "can take it" not in verdicts
    assert not stated or (verdicts, document["sensor"]["takes"]) == ({f"not known: no {lacks} stated"}, None)


def test_noise_that_drives_the_resonance_names_the_filter_that_takes_it_off(shot):
    """Noise of 5 % of a blow of 200 us, sampled at 1 MHz: the resonance at 80 kHz magnifies its share of it."""
    time = STEP * np.arange(8_000)
    clean = np.where((time > 4e-3) & (time < 4.2e-3), 10000.0 * np.sin(np.pi * (time - 4e-3) / 2e-4), 0.0)
    noisy = clean + 500.0 * np.random.default_rng(0).normal(size=time.size)
    np.savetxt("n.csv", np.column_stack([time, noisy]), "%.8g", ",", header="time (s),frame (g)", comments="")
    found = sw.record("n.csv", examination=sw.Examination(sensor="Endevco 2225")).sensor
    assert found.takes is None
    [said] = [notice.message for notice in found.notices if notice.code == "sensor-trial"]
    assert said.endswith('--filter "20 kHz" takes that noise off and leaves the blows')
    assert sw.record("n.csv", examination=sw.Examination(sensor="Endevco 2225"), filter="20 kHz").sensor.takes is True


WRONG = [
    ('[[sensor]]\nname = "a"\nmodel = "PCB 350C2"\n', 'did you mean "PCB 350C02"?'),
    ('[[sensor]]\nname = "a"\nrnge = "5 g"\n', 'did you mean "range"?'),
    ('[[sensor]]\nname = "a"\n', "a model, a range or a resonance"),
    ('[[sensor]]\nname = "a"\ntap = "x"\nrange = "5 g"\n', "no tap"),
    ('[[sensor]]\nname = "a"\nrange = "-5 g"\n', "above 0"),
    ('[[sensor]]\nname = "a"\nresonance = "5 kHz"\n[[sensor]]\nname = "b"\n', "it has 2"),
    ("schema = 1\n", 'it has "schema"'),
    ("", "it has nothing"),
    ("[sensor\n", "a TOML file with one [[sensor]]"),
    ('[[sensor]]\nname = "a"\nrange = "5 g"\nresonance = "5 kHz"\nmass = "5 gram"\n[[sensor.gasket]]\n', "thickness"),
]


@pytest.mark.parametrize(("text", "said"), WRONG)
def test_a_wrong_file_is_refused_in_a_line(strikewave, shot, text, said):
    Path("wrong.toml").write_text(text)
    code, _, err = strikewave("record", shot, "--sensor", "wrong.toml")
    assert code == 2
    assert said in err
    assert len(err.strip().splitlines()) == 1


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--sensor", "endevco 225"], 'did you mean "Endevco 2225"?'),
        (["--sensor", "nothing"], "choose from: Bruel & Kjaer 8309, Endevco 2225"),
        (["--sensor", "no.toml"], "no such file: no.toml"),
        (["--sensor", "Endevco 2225", "--unit", "N"], "records of an acceleration"),
    ],
)
def test_an_unknown_sensor_and_a_force_are_refused(strikewave, shot, words, said):
    code, _, err = strikewave("record", shot, *words)
    assert code == 2
    assert said in err


def test_python_names_the_parameter(shot):
    with pytest.raises(sw.InputError, match=r"^sensor: got"):
        sw.record(shot, examination=sw.Examination(sensor="Endevco 225"))


def test_a_record_without_a_blow_has_nothing_to_try(strikewave):
    Path("still.csv").write_text("time (s),frame (g)\n" + "".join(f"{k * STEP:.6f},{k % 3}\n" for k in range(400)))
    code, out, err = strikewave("record", "still.csv", "--sensor", "PCB 350C02", "--json")
    assert code == 0, err
    assert (json.loads(out)["sensor"]["takes"], json.loads(out)["sensor"]["blows"]) == (None, [])
