"""``strikewave design``: files, exit codes, JSON, dry runs, and errors that name file, table and key."""

import csv
import json
from pathlib import Path

import pytest

DESIGN = """
schema = 1
case = "li-ma-2019"
set = { feed.blows = 1 }
analysis = "impact"
goals = ["peak_force = 30 kN +- 5 %", "approach_speed largest"]
runs = 32
[vary]
machine.speed = "200..900 rpm"
"""


@pytest.fixture
def written(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)

    def write(text=DESIGN):
        Path("d.toml").write_text(text)

    return write


def test_a_design_writes_its_settings_and_a_report(strikewave, written, read_page):
    written()
    code, out, err = strikewave("design", "d.toml", "--workers", 1, "--out", "o")
    assert code == 0, err
    assert "Ranked settings" in out
    assert {path.name for path in Path("o").iterdir()} == {
        "case.toml", "report.html", "design.svg", "design.json", "runs.csv", "runs.sqlite",
    }  # fmt: skip
    assert not list(Path().glob(".*"))
    document = json.loads(Path("o/design.json").read_text())
    assert document["met"]
    assert document["units"]["peak_force"] == "N"
    best = document["candidates"][0]
    assert 28.5e3 <= best["numbers"]["peak_force"] <= 31.5e3
    rows = list(csv.DictReader(Path("o/runs.csv").open()))
    assert len(rows) == document["runs"]
    page = read_page("o/report.html")
    assert "Settings" in page.sections
    code, out, _ = strikewave("sweep", "o/case.toml", "--vary", f"machine.speed={best['settings']['machine.speed']}",
                              "--analysis", "impact", "--keep", "peak_force", "--json", "--workers", 1)  # fmt: skip
    assert json.loads(out)["numbers"]["peak_force"][0] == pytest.approx(best["numbers"]["peak_force"], rel=1e-8)


@pytest.mark.verify
def test_the_same_design_replaces_its_result_and_another_is_refused_before_it_runs(strikewave, written):
    written()
    words = ("design", "d.toml", "--workers", 1, "--out", "o")
    assert [strikewave(*words)[0] for _ in range(2)] == [0, 0]
    first = Path("o/design.json").read_bytes()
    written(DESIGN.replace("30 kN", "31 kN"))
    code, _, err = strikewave(*words)
    assert code == 2
    assert "holds another result" in err
    assert Path("o/design.json").read_bytes() == first


@pytest.mark.verify
def test_goals_that_exclude_each_other_end_with_3_and_are_named(strikewave, written):
    written(DESIGN.replace('"approach_speed largest"', '"approach_speed > 50 m/s"'))
    code, out, _ = strikewave("design", "d.toml", "--workers", 1, "--json")
    assert code == 3
    document = json.loads(out)
    assert document["met"] is False
    assert {one["without"] for one in document["conflict"]["reachable"]} <= {
        "peak_force = 30 kN +- 5 %", "approach_speed > 50 m/s",
    }  # fmt: skip
    assert {path.name for path in Path().iterdir()} == {"d.toml"}


def test_a_dry_run_says_how_long(strikewave, written):
    written()
    code, out, _ = strikewave("design", "d.toml", "--dry-run", "--runs", 64, "--json")
    document = json.loads(out)
    assert code == 0
    assert document["runs"] == 64
    assert document["at_most"] > 64
    assert document["run_seconds"] > 0.0
    assert {path.name for path in Path().iterdir()} == {"d.toml"}


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (("schema = 1", "schema = 2"), "d.toml: schema"),
        (("goals =", "gaols ="), 'd.toml: gaols: unknown key; did you mean "goals"?'),
        (("peak_force = 30 kN", "peak_froce = 30 kN"), 'd.toml: goals.0: got "peak_froce"'),
        (("peak_force = 30 kN", "peak_force = 30 m"), "d.toml: goals.0"),
        (
            ("machine.speed", "machine.sped"),
            'd.toml: vary: got "machine.sped"; allowed: a quantity or a word of the case; did you mean "machine.speed"?',
        ),
        (("li-ma-2019", "li-ma-2018"), "d.toml: case"),
        (("feed.blows", "feed.blow"), "d.toml: set"),
        (('"200..900 rpm"', "true"), "d.toml: vary"),
        (('"impact"', '"fem"'), "d.toml: "),
        (("[vary]", "[vary"), "d.toml"),
    ],
)
def test_a_wrong_file_is_refused_with_its_place(strikewave, written, change, said):
    written(DESIGN.replace(*change))
    code, _, err = strikewave("design", "d.toml", "--json")
    assert code == 2
    assert said in " ".join(err.split())


def test_a_file_that_is_not_there_is_refused(strikewave, written):
    code, _, err = strikewave("design", "nowhere.toml")
    assert code == 2
    assert "no such file: nowhere.toml" in " ".join(err.split())
