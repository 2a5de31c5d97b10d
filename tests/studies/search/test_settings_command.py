"""``strikewave settings`` as a user types it: table, document, files, the written case run anew, and bad input."""

import json
import tomllib
from pathlib import Path

import pytest

from strikewave.base.constants import STANDARD_GRAVITY as G
from strikewave.cases.case import load_case

GOAL = ("--interval", "20 ms", "--peak", "4000 g", "--width", "200 us")
FEW = ("--strikers", "4", "--striker-mass", "1 kg")


@pytest.mark.verify
@pytest.mark.parametrize(
    ("interval", "peak", "width", "strikers"),
    [("20 ms", "4000 g", "200 us", 4), ("12 ms", "3000 g", "180 us", 3), ("25 ms", "2000 g", "400 us", 2)],
)
def test_run_of_the_written_case_meets_the_goal(strikewave, interval, peak, width, strikers):
    """`strikewave run` on case.toml, its own table of blows: median of the later ones within 5 % of all three."""
    options = ("--interval", interval, "--peak", peak, "--width", width, "--strikers", strikers)
    code, _, _ = strikewave("settings", *options, "--striker-mass", "1 kg", "--blows", 6, "--out", "found")
    assert code == 0
    code, out, _ = strikewave("run", "--no-band", "found/case.toml", "--json")
    assert code == 0
    rows = json.loads(out)["blows"]
    assert [row["kind"] for row in rows] == ["full"] * 6

    def typical(key):
        later = sorted(row[key] for row in rows[1:])
        return later[len(later) // 2]

    assert typical("rigid_peak") == pytest.approx(float(peak.split()[0]) * G, rel=0.05)
    assert typical("width") == pytest.approx(float(width.split()[0]) * 1e-6, rel=0.05)
    span = (rows[-1]["time"] - rows[0]["time"]) / 5.0
    assert span == pytest.approx(float(interval.split()[0]) * 1e-3, rel=0.05)


@pytest.mark.verify
def test_document_says_goal_best_and_limits(strikewave):
    code, out, _ = strikewave("settings", *GOAL, *FEW, "--stop-limit", "1 kN", "--blows", 4, "--json")
    assert code == 0
    assert not list(Path().iterdir())
    document = json.loads(out)
    assert document["schema"] == 1
    assert document["goal"]["peak"] == pytest.approx(4000 * G, rel=1e-15)
    assert document["met"] is True
    best = document["best"]
    assert best == document["candidates"][0]
    assert best["place"] == 1
    assert all(abs(best[key]["miss"]) <= 0.05 for key in ("peak", "width", "interval"))
    assert best["settings"]["machine.strikers"]["typed"] == 4
    limits = {limit["name"]: limit for limit in best["limits"]}
    assert {"rim_speed", "disc_stress", "mount_stretch", "largest_displacement", "mean_torque", "stop_force"} <= set(
        limits
    )
    assert all(limit["kept"] for limit in limits.values() if limit["decides"])
    assert limits["stop_force"]["value"] == best["stop_force"] <= limits["stop_force"]["limit"] == 1000.0
    assert limits["contact_force"]["decides"] is False
    assert [warning["code"] for warning in document["warnings"]] == ["contact-yield"]
    assert {"peak", "stop_force", "interval"} <= set(document["units"])


@pytest.mark.verify
def test_folder_holds_case_document_page_and_picture(strikewave, read_page):
    code, out, err = strikewave("settings", *GOAL, *FEW, "--blows", "3", "--out", "found")
    assert code == 0
    count = len(json.loads(Path("found/settings.json").read_text("utf-8"))["candidates"])
    others = {f"case-{place}.toml" for place in range(2, count + 1)}
    assert others
    assert {path.name for path in Path("found").iterdir()} == {
        "case.toml",
        *others,
        "report.html",
        "settings.json",
        "settings.svg",
        "runs.sqlite",
    }
    assert load_case("found/case-2.toml").name == "settings-20ms-4000g-200us-2"
    assert "settings give blows of 4000 g and 200 us every 20 ms" in out
    assert "warning [contact-yield]" in err
    case = load_case("found")
    assert case.name == "settings-20ms-4000g-200us"
    assert case.rotary_tables().feed.blows.si == 3
    with Path("found/case.toml").open("rb") as file:
        engagement = tomllib.load(file)["machine"]["engagement"]
    assert engagement["provenance"] == "assumed"
    assert "chosen by strikewave settings" in engagement["note"]
    assert "<svg" in Path("found/settings.svg").read_text("utf-8")
    page, found = read_page("found/report.html"), json.loads(Path("found/settings.json").read_text("utf-8"))
    met = sum(row["meets"] for row in found["candidates"])
    assert page.numbers["settings that meet the goal"] == f"{met} of {len(found['candidates'])}"
    assert page.numbers["typical peak"] == f"{found['best']['peak']['typical'] / 9.80665:.4g} g"
    assert page.pictures == 1
    assert "strikewave settings --interval" in page.text


@pytest.mark.verify
def test_narrow_screen_leaves_out_columns(strikewave, monkeypatch):
    """At 80 characters no number is folded: every row of the first table is one line."""
    monkeypatch.setenv("COLUMNS", "80")
    options = ("--interval", "10 ms", "--peak", "3000 g", "--width", "200 us", "--strikers", 3, "--blows", 3)
    code, out, _ = strikewave("settings", *options, "--striker-mass", "1 kg", "--out", "found")
    assert code == 0
    rows = out.split("Limits of the first")[0].splitlines()
    assert max(map(len, rows)) <= 80
    table = rows[next(k for k, row in enumerate(rows) if row.lstrip().startswith("#")) :]
    assert "preload" not in table[0]
    numbered = [row.split() for row in table if row[:1].isdigit()]
    assert len(numbered) == 6
    assert all(row[7] in ("yes", "no") and row[8] in ("passed", "broken:") for row in numbered)


@pytest.mark.verify
def test_goal_that_no_setting_meets_exits_with_3(strikewave):
    """Six strikers leave the nose in the way: the nearest is written, and what stands in its way is said."""
    code, out, err = strikewave(
        "settings", *GOAL, "--strikers", 6, "--striker-mass", "1 kg", "--blows", 4, "--out", "found"
    )
    assert code == 3
    assert "0 of" in out
    assert "warning [not-met]: the nearest setting misses the goal: 4 double" in err
    document = json.loads(Path("found/settings.json").read_text("utf-8"))
    assert document["met"] is False
    assert document["best"] is None
    assert "double" in document["candidates"][0]["obstacles"]
    assert load_case("found").title == "nearest to blows of 4000 g and 200 us every 20 ms"
    assert "nearest to blows of 4000 g" in Path("found/settings.svg").read_text("utf-8")


@pytest.mark.verify
def test_on_a_larger_turntable_six_strikers_leave_in_time(strikewave):
    """What is set reaches the search: at twice the radius a nose is half as long in the way."""
    code, out, _ = strikewave(
        "settings", *GOAL, "--strikers", 6, "--striker-mass", "1 kg", "--blows", 4, "--json",
        "--set", "machine.radius=400 mm", "--set", "machine.inertia=20 kg m^2",
    )  # fmt: skip
    assert code == 0
    assert json.loads(out)["best"]["strikers"] == 6


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("--peak", "4000 g", "--width", "200 us"), "--interval: missing"),
        (("--interval", "20", "--peak", "4000 g", "--width", "200 us"), "--interval: got"),
        (("--interval", "20 ms", "--peak", "4000 Hz", "--width", "200 us"), "--peak: got"),
        (("--interval", "20 ms", "--peak", "-4000 g", "--width", "200 us"), "--peak: got"),
        (("--interval", "20 ms", "--peak", "4000 g", "--width", "0 us"), "--width: got"),
        (("--interval", "20 ms", "--peak", "4000 g", "--width", "5 ms"), "a tenth of the interval"),
        (("--interval", "2 ms", "--peak", "4000 g", "--width", "200 us", "--strikers", "1"), "feed.release_delay"),
        (("--interval", "20 ms", "--peak", "4000 g", "--width", "1 us"), "--width: got"),
        (("--interval", "20 ms", "--peak", "1 g", "--width", "200 us", *FEW), "object.frame_stiffness: got"),
        ((*GOAL, "--strikers", "0"), "a whole number from 1 to 100"),
        ((*GOAL, "--vary", "nose"), "--vary"),
        ((*GOAL, "--disc", "cheese"), "--disc"),
        ((*GOAL, "--stop-limit", "1 g"), "--stop-limit"),
        ((*GOAL, "--striker-mass", "1"), "--striker-mass"),
        ((*GOAL, "--blows", "0"), "feed.blows"),
        ((*GOAL, "--from", "nowhere"), "nowhere"),
        ((*GOAL, "--from", "li-ma-2019-fig5"), "nose on a frame"),
        ((*GOAL, "--set", "machine.sped=1"), "sped"),
        (("--interval", "20 ms", "--peak", "400000 g", "--width", "200 us"), "at most"),
        (("--interval", "20 ms", "--peak", "12000 g", "--width", "400 us", "--strikers", "8"), "radius"),
    ],
)
def test_bad_input_is_one_line_and_exit_2(strikewave, words, told):
    code, out, err = strikewave("settings", *words)
    assert code == 2
    assert out == ""
    assert told in err
    assert "Traceback" not in err
    assert not list(Path().iterdir())


def test_folder_with_other_files_is_refused_before_the_work(strikewave):
    Path("mine").mkdir()
    Path("mine/notes.txt").write_text("kept")
    code, _, err = strikewave("settings", *GOAL, "--out", "mine", "--force")
    assert code == 2
    assert "notes.txt" in err
    assert [path.name for path in Path("mine").iterdir()] == ["notes.txt"]


@pytest.mark.verify
def test_same_goal_again_replaces_its_own_result(strikewave):
    for _ in range(2):
        assert strikewave("settings", *GOAL, *FEW, "--blows", "3", "--out", "found")[0] == 0


@pytest.mark.verify
def test_other_question_is_refused_before_the_work(strikewave, monkeypatch):
    """Another goal or another choice is another result: nothing is searched before --force is asked for."""
    assert strikewave("settings", *GOAL, *FEW, "--blows", "3", "--out", "found")[0] == 0
    monkeypatch.setattr("strikewave.studies.search.rotary.design_settings", lambda *_: pytest.fail("searched"))
    other = ("--interval", "20 ms", "--peak", "4000 g", "--width", "210 us")
    for words in ((*other, *FEW), (*GOAL, *FEW, "--vary", "mount"), (*GOAL, *FEW, "--set", "machine.inertia=5 kg m^2")):
        code, _, err = strikewave("settings", *words, "--blows", "3", "--out", "found")
        assert code == 2
        assert "--force" in err


@pytest.mark.verify
def test_changed_case_gets_a_folder_of_its_own(strikewave):
    for change in ((), ("--set", "machine.inertia=5 kg m^2")):
        assert strikewave("settings", *GOAL, *FEW, "--blows", "3", *change)[0] == 0
    names = sorted(path.name for path in Path("out").iterdir())
    assert len(names) == 2
    assert all(name.startswith("settings-20ms-4000g-200us-") for name in names)
