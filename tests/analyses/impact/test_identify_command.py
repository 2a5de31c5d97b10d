"""strikewave identify as a user types it: force and acceleration, what is known, refusals, JSON, a folder, exit codes."""

import json
import os
from xml.etree import ElementTree

import numpy as np
import pytest

from strikewave.base.constants import STANDARD_GRAVITY
from strikewave.contact import Contact, exact, impact_history, reduced_mass, solve_impact

M1, M2, SPEED, STIFFNESS, EXPONENT, RESTITUTION = 0.2, 0.459, 5.0, 4.7e9, 10 / 9, 0.6
MASS = float(reduced_mass(M1, M2))
BEGIN, STEP = 400e-6, 0.5e-6


@pytest.fixture
def command(strikewave):
    return lambda *words: strikewave("identify", *words)


def force():
    blow = solve_impact(Contact(STIFFNESS, EXPONENT, exact(RESTITUTION)), M1, M2, SPEED)
    t = np.arange(3000) * STEP
    inside = (t > BEGIN) & (t < BEGIN + float(blow.duration))
    values = np.zeros(t.size)
    values[inside] = impact_history(blow, t[inside] - BEGIN).force
    noise = np.random.default_rng(1).normal(size=t.size) * 1e-3 * values.max()
    return t, values + noise


def written(unit, scale=1.0, name="blow.csv", extra=0.0):
    t, values = force()
    rows = [f"{time:.7f},{value:.9g}" for time, value in zip(t, scale * (values + extra), strict=True)]
    with open(name, "w") as file:
        file.write(f"time [s],hammer [{unit}]\n" + "\n".join(rows) + "\n")
    return name


def document(out):
    assert out.count("\n") == 1
    return json.loads(out)


def test_a_force_with_both_masses_tells_the_rest(command):
    code, out, _ = command(written("N"), "--m1", "0.2", "--m2", "459 gram", "--json")
    assert code == 0
    found = document(out)
    assert set(found) >= {"schema", "version", "units", "warnings", "values", "combinations", "correlation", "words"}
    truth = {"exponent": EXPONENT, "restitution": RESTITUTION, "speed": SPEED}
    for name, value in truth.items():
        row = found["values"][name]
        assert abs(row["value"] - value) < 4.0 * row["standard_error"] < 0.1 * value
    assert found["values"]["mass"] == {"value": MASS, "standard_error": None, "given": True}
    assert found["combinations"]["momentum"]["value"] == pytest.approx(MASS * SPEED, rel=0.01)
    assert found["begin"]["value"] == pytest.approx(BEGIN, abs=1e-6)
    assert found["units"]["stiffness"] == "N/m^n"
    assert len(found["time"]) == len(found["measured"]) == len(found["fitted"])
    assert np.shape(found["correlation"]["matrix"]) == (5, 5)
    assert os.listdir() == ["blow.csv"]


def test_an_acceleration_takes_the_mass_of_the_struck_body(command):
    file = written("g", 1.0 / (M2 * STANDARD_GRAVITY))
    code, _, err = command(file, "--speed", "5 m/s")
    assert code == 2
    assert err.startswith("--m2: missing")
    assert "acceleration" in err
    code, out, _ = command(file, "--m2", "0.459 kg", "--speed", "5 m/s", "--json")
    assert code == 0
    found = document(out)
    assert found["values"]["mass"]["value"] == pytest.approx(MASS, rel=0.01)
    assert found["combinations"]["peak_force"]["value"] == pytest.approx(force()[1].max(), rel=0.01)


def test_the_screen_says_what_cannot_be_mark_responses(command):
    code, out, _ = command(written("N"))
    assert code == 0
    assert out.count("not determined") == 3
    assert "mass x speed" in out
    assert "cannot be told apart" in out
    assert "give one of the three" in out


def test_everything_known_is_shown_as_given(command):
    words = ["--mass", "0.1393 kg", "--speed", "5", "--stiffness", "4.7e9", "-n", "1.1111", "-e", "0.6"]
    code, out, _ = command(written("N"), *words)
    assert code == 0
    assert out.count("given") == 5


def test_noise_and_forces_are_told_in_the_unit_that_was_chosen(command):
    out = command(written("N"), "--mass", "0.1393 kg", "--show", "lbf")[1]
    assert [line.split()[2] for line in out.splitlines() if line.startswith("noise")] == ["lbf,"]
    assert next(line for line in out.splitlines() if line.startswith("peak force")).endswith("lbf")


def test_exit_3_where_the_law_does_not_describe_the_blow(command):
    t, values = force()
    late = np.where(t > BEGIN, t - BEGIN, 0.0)
    file = written("N", extra=0.12 * values.max() * np.sin(2 * np.pi * 30e3 * late) * np.exp(-late / 1e-4))
    code, out, err = command(file, "--mass", "0.1393 kg", "--json")
    assert code == 3
    found = document(out)
    assert not found["described"]
    assert [warning["code"] for warning in found["warnings"]][-1] == "law-misfit"
    code, _, err = command(file, "--mass", "0.1393 kg")
    assert code == 3
    assert err.count("does not describe") == 1


def test_a_folder_holds_page_picture_and_document(command, read_page):
    code, _, err = command(written("N"), "--mass", "0.1393 kg", "--out", "told")
    assert code == 0
    assert "written: told/" in err
    assert sorted(os.listdir("told")) == ["identify.json", "record.toml", "report.html", "summary.svg"]
    ElementTree.parse("told/summary.svg")
    with open("told/identify.json") as file:
        found = json.load(file)
    assert found["values"]["mass"]["value"] == 0.1393
    page = read_page("told/report.html")
    exponent, _, error = page.numbers["exponent"].partition(" ± ")
    assert exponent == f"{found['values']['exponent']['value']:.5g}"
    assert float(error) == float(f"{found['values']['exponent']['standard_error']:.2g}")
    assert page.pictures == 1


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--m1", "0.2"], "--m2: missing"),
        (["--m2", "0.2"], "--m1: missing"),
        (["--m1", "inf", "--m2", "inf"], "at most one infinite mass"),
        (["--m1", "0.2", "--mass", "0.1"], "--mass"),
        (["--mass", "-1"], "above zero"),
        (["--mass", "1 N"], "a mass"),
        (["--speed", "0"], "above zero"),
        (["-e", "1.5"], "0.001 to 1"),
        (["-n", "two"], "0.2 to 8"),
        (["--stiffness", "0"], "in N/m^n"),
        (["--from", "2 s", "--to", "1 s"], "after --from"),
        (["--from", "1 s"], "--from, --to"),
        (["--polarity", "-1"], "--polarity -1"),
        (["--unit", "mV"], "--sensitivity"),
        (["--to", "350 us"], "no pulse stands out of the noise"),
    ],
)
def test_refusals_name_the_option(command, words, said):
    code, out, err = command(written("N"), *words)
    assert code == 2
    assert said in err
    assert err.count("\n") == 1
    assert out == ""


def test_a_window_chooses_another_blow(command):
    code, out, _ = command(written("N"), "--from", "300 us", "--to", "800 us", "--mass", "0.1393 kg", "--json")
    assert code == 0
    found = document(out)
    assert 300e-6 <= found["time"][0] < found["time"][-1] <= 800e-6
