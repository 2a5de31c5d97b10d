"""``strikewave scatter`` as a user types it: documents, files, shares, and what bad input is told."""

import csv
import json
import math
from pathlib import Path

import numpy as np
import pytest

from strikewave import load_case
from strikewave.base.errors import StrikewaveError
from strikewave.cases.case import dump_case, parse_case
from strikewave.studies.scatter.figures import picture
from strikewave.studies.scatter.study import run_result, scatter
from strikewave.uncertainty.draws import FELT

QUICK = ("scatter", "bare.toml", "--workers", "1", "--runs", "10", "--set", "feed.blows=3")
TWO = ("--set", "striker.mass.tolerance=2 %", "--set", "feed.arrival.tolerance=0.05")


@pytest.fixture(scope="module")
def bare_case():
    """The published machine without its tolerances."""
    case = load_case("li-ma-2019")
    bare = {path: one.model_copy(update={"tolerance": None}) for path, one in case.values().items()}
    return case.with_values(bare, keep_tolerances=False)


@pytest.fixture(autouse=True)
def bare_file(bare_case, tmp_path):
    (tmp_path / "bare.toml").write_text(dump_case(bare_case))


@pytest.fixture(scope="module")
def study(bare_case, tmp_path_factory):
    file = tmp_path_factory.mktemp("bare") / "bare.toml"
    file.write_text(dump_case(bare_case))
    changes = ["feed.blows=3", "striker.mass.tolerance=2 %", "feed.arrival.tolerance=0.05"]
    return scatter(load_case(str(file), changes), runs=12, seed=3)


@pytest.mark.verify
def test_files_appear_whole_and_agree(strikewave, read_page):
    code, out, err = strikewave(*QUICK, *TWO)
    assert code == 0
    (folder,) = Path("out").iterdir()
    assert folder.name.startswith("scatter-li-ma-2019-")
    names = ["case.toml", "record.toml", "report.html", "runs.csv", "runs.sqlite", "scatter.json", "scatter.svg"]
    assert sorted(path.name for path in folder.iterdir()) == names
    assert f"written: {folder}/" in err
    for words in ("CV between runs", "dynamics", "Shares in the variance of the typical peak", "each striker"):
        assert words in out
    rows = list(csv.DictReader((folder / "runs.csv").open()))
    document = json.loads((folder / "scatter.json").read_text())
    assert len(rows) == document["runs"] == 10
    page, typical = read_page(folder / "report.html"), document["figures"]["peak"]["typical"]
    assert page.numbers["peak of the typical blow, mean of the runs"] == f"{typical['mean'] / 9.80665:.4g} g"
    assert page.numbers["CV of that peak from run to run"] == f"{100.0 * typical['cv']:.3g} %"
    assert page.pictures == 1
    assert "strikewave scatter" in page.text
    means = np.array([float(row["mean peak [m/s^2]"]) for row in rows])
    assert document["figures"]["peak"]["mean"]["mean"] == pytest.approx(means.mean(), rel=1e-12)
    assert document["figures"]["peak"]["mean"]["cv"] == pytest.approx(means.std(ddof=1) / means.mean(), rel=1e-12)
    assert all(0.97 <= float(row[f"striker.mass of {k} [kg]"]) <= 1.03 for row in rows for k in range(1, 5))
    assert {"blows", "full", "missed", "double", "glancing", "failure", "cv of peak [1]"} <= rows[0].keys()


ACTS_ON_NO_BLOW = {
    *("machine.brake", "feed.wait", "feed.valve_delay", "feed.release_delay", "feed.retract_time"),
    "contact.slowest_approach",  # a limit of the model, not of the machine
}


def test_published_machine_scatters_by_all_that_is_assumed_and_moves_a_blow():
    """Each assumed value has a tolerance, or a tenth more of it changes no peak of three blows by 1e-6; others have none."""
    case = load_case("li-ma-2019", ["feed.blows=3"])
    felt = {path: one for path, one in case.values().items() if path.partition(".")[0] in FELT and path != "feed.blows"}
    toleranced = {path for path, one in felt.items() if one.tolerance is not None}
    assumed = {path for path, one in felt.items() if one.provenance == "assumed"}
    assert toleranced == assumed - ACTS_ON_NO_BLOW
    assert all("tolerance" in felt[path].note or felt[path].si in (0.0, 0.15) for path in toleranced)
    peaks = run_result(case).peak
    for path in ACTS_ON_NO_BLOW:
        more = felt[path].model_copy(update={"si": 1.1 * felt[path].si})
        assert run_result(case.with_values({path: more})).peak == pytest.approx(peaks, rel=1e-6)


@pytest.mark.verify
def test_the_case_file_of_a_result_runs_again_to_the_same_bits(strikewave):
    strikewave(*QUICK, *TWO, "--shares", "none", "--out", "first")
    strikewave("scatter", "first", "--workers", "1", "--runs", "10", "--shares", "none", "--out", "second")
    assert Path("first/runs.csv").read_bytes() == Path("second/runs.csv").read_bytes()
    case = parse_case(Path("second/case.toml").read_text())
    assert case.striker.mass.half_width == 0.02


@pytest.mark.verify
def test_another_seed_is_another_result_and_needs_force(strikewave):
    words = (*QUICK, *TWO, "--shares", "none", "--out", "here")
    assert strikewave(*words)[0] == 0
    code, _, err = strikewave(*words, "--seed", "2")
    assert code == 2
    assert "--force" in err
    assert strikewave(*words, "--seed", "2", "--force")[0] == 0


@pytest.mark.verify
def test_json_alone_writes_no_files(strikewave):
    code, out, _ = strikewave(*QUICK, *TWO, "--json")
    document = json.loads(out)
    assert code == 0
    assert not Path("out").exists()
    assert document["shares"]["method"] == "alone"
    drawn = {row["path"]: row["drawn"] for row in document["tolerances"]}
    assert drawn == {"feed.arrival": "once a run", "striker.mass": "for each striker"}
    assert document["figures"]["peak"]["cv_within"]["limit"] is None
    assert {row["path"] for one in document["shares"]["of"] for row in one["rows"]} == set(drawn)


@pytest.mark.verify
def test_sobol_indices_come_with_totals(strikewave):
    code, out, _ = strikewave(*QUICK, *TWO, "--shares", "sobol", "--json")
    document = json.loads(out)
    assert code == 0
    for one in document["shares"]["of"]:
        assert one["runs_each"] == 16
        assert all(row["total_low"] <= row["total"] <= row["total_high"] for row in one["rows"])
    assert any("Saltelli" in source for source in document["sources"])


@pytest.mark.verify
def test_changed_case_gets_a_folder_of_its_own(strikewave):
    for change in ("feed.arrival.tolerance=0.05", "feed.arrival.tolerance=0.1"):
        assert strikewave(*QUICK, "--shares", "none", "--set", change)[0] == 0
    assert len(list(Path("out").iterdir())) == 2


def test_no_more_processes_than_cores(strikewave, monkeypatch):
    asked = []

    def note(case, plan, store, pool, report):
        asked.append(pool.width)
        raise StrikewaveError("enough is known")

    monkeypatch.setattr("os.cpu_count", lambda: 3)
    monkeypatch.setattr("strikewave.studies.scatter.report.make_scatter", note)
    assert strikewave(*QUICK, *TWO, "--shares", "none", "--workers", "64", "--json")[0] == 2
    assert asked == [3]


@pytest.mark.verify
@pytest.mark.parametrize("shares", ["alone", "sobol"])
def test_narrow_screen_folds_no_row(strikewave, monkeypatch, shares):
    """At 80 characters each number stands whole on one line, and so does each path."""
    monkeypatch.setenv("COLUMNS", "80")
    long = ("--set", "object.stop_restitution.tolerance=0.1", "--set", "striker.mount_stiffness.tolerance=5 %")
    code, out, _ = strikewave(*QUICK, *long, "--shares", shares)
    assert code == 0
    rows = out.splitlines()
    assert max(map(len, rows)) <= 80
    rows = rows[next(k for k, row in enumerate(rows) if row.startswith("Means of the runs")) :]
    assert sum(row.strip().startswith("object.stop_restitution ") for row in rows) == 2
    assert sum(row.strip().startswith("striker.mount_stiffness ") for row in rows) == 2
    for figure, unit in (("peak", "g"), ("interval", "ms")):
        (means, typical, *within) = [row.split() for row in rows if row.strip().startswith(f"{figure} ")]
        assert len(means) == len(typical) == 1 + 2 + 3 + 1 + 3
        assert means[2] == typical[2] == unit
        assert [len(cells) for cells in within] == [1 + 1 + 1 + 1 + 3 + 1] * 2


@pytest.mark.verify
def test_runs_without_a_limit_count_as_beyond_it(study):
    """Of 96 runs the 95th is the limit (Wilks): with eight more that failed or missed a blow there is none."""
    from dataclasses import replace

    good = study.runs * 8
    assert replace(study, runs=good).figures["peak"].within.limit == max(run.variation("peak") for run in good)
    failed = replace(study.runs[0], kinds=(), peak=np.empty(0), failure="it did not fit")
    missed = replace(study.runs[0], kinds=("full", "missed", "full"))
    for one in (failed, missed):
        spoiled = replace(study, runs=(*good, *(one,) * 8))
        assert sum(spoiled.without_limit) == 8
        assert spoiled.figures["peak"].within.limit == math.inf
        assert spoiled.document()["figures"]["peak"]["cv_within"]["limit"] is None
        assert spoiled.document()["without_limit"] == 8


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("scatter", "bare.toml"), 'striker.mass.tolerance="2 %"'),
        (("scatter", "bare.toml", "--set", "recorder.pre_trigger.tolerance=10 %"), "quantity that the run feels"),
        (("scatter", "li-ma-2019-fig13-bar"), "strikewave wave"),
        ((*QUICK, *TWO, "--runs", "1"), "--runs: got 1; allowed: a whole number from 10"),
        ((*QUICK, *TWO, "--shares", "half"), '--shares: got "half"; allowed: one of alone, sobol, none'),
        ((*QUICK, *TWO, "--workers", "0"), "--workers"),
        ((*QUICK, "--set", "striker.mass.tolerance=2 mm"), "striker.mass.tolerance"),
        ((*QUICK, "--set", "striker.mass.tolerance=150 %"), "at most 100 %"),
        ((*QUICK, "--set", "feed.blows.tolerance=1"), "no tolerance on a whole number"),
    ],
)
def test_bad_input_is_told_in_one_line(strikewave, words, told):
    code, out, err = strikewave(*words)
    assert (code, out) == (2, "")
    assert told in err
    assert err.count("\n") == 1
    assert not Path("out").exists()


def test_picture_shows_peaks_bands_and_shares(study):
    figure = picture(study)
    peaks, between, within = figure.axes
    medians = next(line for line in peaks.lines if line.get_label() == "median").get_ydata()
    np.testing.assert_allclose(medians, np.median([run.peak for run in study.runs], axis=0) / 9.80665, rtol=1e-12)
    still = next(line for line in peaks.lines if line.get_label() == "dynamics alone").get_ydata()
    np.testing.assert_allclose(still, study.nominal_run.peak / 9.80665, rtol=1e-12)
    for axes, shares in ((between, study.shares[0]), (within, study.shares[1])):
        assert [text.get_text() for text in axes.get_yticklabels()] == [row.path for row in shares.rows]
        widths = [bar.get_width() for bar in axes.patches]
        np.testing.assert_allclose(widths, [100.0 * row.share for row in shares.rows], rtol=1e-12)


def test_picture_of_runs_with_missed_blows(study):
    """A blow that no run struck leaves a gap; missed runs are counted in words."""
    from dataclasses import replace

    lost = np.where(np.arange(3) == 1, math.nan, study.runs[0].peak)
    missed = replace(study.runs[0], kinds=("full", "missed", "full"), peak=lost)
    figure = picture(replace(study, runs=(missed,) * 12, shares=()))
    (axes,) = figure.axes
    assert "12 runs with missed blows" in axes.get_title(loc="left")
    median = next(line for line in axes.lines if line.get_label() == "median").get_ydata()
    assert np.isnan(median).tolist() == [False, True, False]
    figure.canvas.draw()
