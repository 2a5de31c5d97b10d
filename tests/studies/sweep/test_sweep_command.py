"""``strikewave sweep``: files, JSON, going on, dry runs; killed at random, it ends as an undisturbed one."""

import csv
import json
import os
import random
import signal
import sqlite3
import subprocess
import sys
import time
from pathlib import Path

import pyarrow.parquet as parquet
import pytest

FAST = ["--set", "feed.blows=1", "--analysis", "fast", "--workers", 1]


def test_a_sweep_writes_its_runs_and_a_report(strikewave, read_page):
    vary = ["--vary", "machine.speed=600..800rpm:3", "--vary", "object.spring=20,40 kN/m"]
    code, out, err = strikewave("sweep", "li-ma-2019", *vary, *FAST, "--keep", "first.rigid_peak,blows", "--out", "o")
    assert code == 0, err
    assert "Main effects" in out
    names = {path.name for path in Path("o").iterdir()}
    assert names == {
        "case.toml", "report.html", "sweep.svg", "sweep.json", "runs.csv", "runs.parquet", "runs.sqlite", "run-histories-1.parquet",
    }  # fmt: skip
    assert not list(Path().glob(".*"))
    page = read_page("o/report.html")
    assert page.numbers["runs"] == "6"
    rows = list(csv.DictReader(Path("o/runs.csv").open()))
    assert [row["machine.speed [rpm]"] for row in rows][:3] == ["600", "700", "800"]
    table = parquet.read_table("o/runs.parquet").to_pydict()
    written = [float(row["first.rigid_peak [m/s^2]"]) for row in rows]
    assert table["first.rigid_peak [m/s^2]"] == pytest.approx(written, rel=1e-8)  # nine digits
    histories = parquet.read_table("o/run-histories-1.parquet").to_pylist()
    peaks = {one["key"].hex(): one["values"][0] for one in histories if one["name"] == "blows.rigid_peak"}
    assert [peaks[row["key"]] for row in rows] == table["first.rigid_peak [m/s^2]"]
    document = json.loads(Path("o/sweep.json").read_text())
    assert document["numbers"]["first.rigid_peak"] == table["first.rigid_peak [m/s^2]"]
    assert document["units"]["first.rigid_peak"] == "m/s^2"
    assert document["effects"]["first.rigid_peak"]["machine.speed"]["share"] > 0.9


def test_json_alone_writes_nothing_and_a_store_is_used_again(strikewave):
    words = ["sweep", "li-ma-2019", *FAST, "--keep", "count", "--json", "--store", "kept"]
    code, out, err = strikewave(*words, "--vary", "machine.speed=600..800rpm:3")
    assert code == 0, err
    assert json.loads(out)["numbers"]["count"] == [1.0, 1.0, 1.0]
    assert {path.name for path in Path("kept").iterdir()} == {"index.sqlite"}
    assert strikewave(*words, "--vary", "machine.speed=600..800rpm:5")[0] == 0
    base = sqlite3.connect("kept/index.sqlite")
    assert base.execute("SELECT count(*) FROM runs").fetchone() == (5,)
    base.close()
    code, out, _ = strikewave(*words, "--vary", "machine.speed=600..800rpm:9", "--dry-run")
    dry = json.loads(out)
    assert (code, dry["runs"], dry["finished"]) == (0, 9, 5)
    assert dry["run_seconds"] > 0.0
    assert {path.name for path in Path().iterdir()} == {"kept"}


def test_histories_without_a_folder_are_refused_before_the_work(strikewave):
    code, _, err = strikewave(
        "sweep", "li-ma-2019", *FAST, "--vary", "machine.speed=1..2rpm", "--keep", "blows", "--json"
    )
    assert code == 2
    assert "--store DIR" in err


def test_a_dry_run_says_how_long(strikewave):
    code, out, _ = strikewave("sweep", "li-ma-2019", *FAST, "--vary", "machine.speed=600..800rpm", "--dry-run")
    assert code == 0
    assert "11 runs: about" in " ".join(out.split())
    assert not list(Path().iterdir())


def started(folder, words, environment):
    program = [sys.executable, "-m", "strikewave", "sweep", *map(str, words)]
    return subprocess.Popen(program, cwd=folder, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def study(count, workers):
    vary = ["--vary", f"machine.speed=400..900rpm:{count}"]
    return ["li-ma-2019", *vary, "--analysis", "fast", "--keep", "first.rigid_peak,cv,blows", "--workers", workers]


@pytest.mark.verify
def test_killed_at_random_it_goes_on_and_ends_as_an_undisturbed_one(tmp_path, environment):
    """Killed by -9 up to 20 times, on two processes; its rows are those of one process that nobody disturbed."""
    words, chance, kills = study(400, 2), random.Random(5), 0
    assert started(tmp_path, [*study(400, 1), "--out", "whole"], environment).wait() == 0
    for _ in range(20):
        process = started(tmp_path, [*words, "--out", "killed"], environment)
        try:
            process.wait(chance.uniform(1.0, 6.0))
            break
        except subprocess.TimeoutExpired:
            os.kill(process.pid, signal.SIGKILL)
            process.wait()
            kills += 1
            time.sleep(0.2)
    else:
        assert started(tmp_path, [*words, "--out", "killed"], environment).wait() == 0
    assert kills > 0
    for name in ("runs.csv", "sweep.json"):
        assert (tmp_path / "killed" / name).read_bytes() == (tmp_path / "whole" / name).read_bytes(), name
    keys = [
        (row["key"], row["name"])
        for chunk in (tmp_path / "killed").glob("run-histories-*.parquet")
        for row in parquet.read_table(chunk, columns=["key", "name"]).to_pylist()
    ]
    assert len(keys) == len(set(keys)) == 400 * 7
    assert not list(tmp_path.glob(".killed*"))


@pytest.mark.verify
def test_a_worker_that_is_killed_loses_no_run(tmp_path, environment):
    """Of two workers, one after the other is killed by -9 while the study runs."""
    process = started(tmp_path, [*study(300, 2), "--out", "o"], environment)
    killed = 0
    while process.poll() is None and killed < 3:
        time.sleep(2.0)
        children = subprocess.run(
            ["ps", "-ww", "-o", "pid=,args=", "--ppid", str(process.pid)], capture_output=True, text=True, check=False
        ).stdout.splitlines()
        workers = [line for line in children if "spawn_main" in line]
        if len(workers) == 2:
            os.kill(int(workers[killed % 2].split()[0]), signal.SIGKILL)
            killed += 1
    assert process.wait() == 0
    assert killed > 0
    rows = list(csv.DictReader((tmp_path / "o" / "runs.csv").open()))
    assert len(rows) == 300
    assert {row["failure"] for row in rows} == {""}
