"""The animation of an explicit run: a page that stands alone, a GIF with all pictures, both small and of one scale."""

import base64
import hashlib
import io
import json
import re
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from typer.testing import CliRunner

from strikewave import load_case
from strikewave.analyses.fem.build import build_model
from strikewave.analyses.fem.figures import animation as fem_animation
from strikewave.analyses.fem.figures.animation import fem_page, movie_of, shown_snapshots, write_fem_gif
from strikewave.analyses.fem.run import run_model
from strikewave.cli.app import app
from strikewave.fem.run import mean_force

COARSE = ["mesh.part.striker.size=3 mm", "mesh.part.bar.size=3 mm", "fem.duration=40 us", "fem.interval=0.4 us"]
HOSTILE = 'a <b> & "c" </script><script>alert(1)</script>'


@pytest.fixture(scope="module")
def solution():
    case = load_case("two-bars-fem", COARSE)
    return run_model(case, build_model(case), snapshots=12)


@pytest.fixture(scope="module")
def movie(solution):
    return movie_of(solution)


@pytest.fixture(scope="module")
def page(movie):
    return fem_page(movie, HOSTILE, "two-bars-fem")


def data_of(page: str) -> dict:
    return json.loads(re.search(r'<script type="application/json" id="run">(.*?)</script>', page, re.DOTALL)[1])


def unpacked(text: str, kind: str):
    return np.frombuffer(base64.b64decode(text), kind)


@pytest.mark.verify
def test_the_page_fetches_nothing_and_only_its_own_script_may_run(page):
    assert len(page.encode()) < 1.5e6
    assert "://" not in page
    assert not re.search(r"\b(src|href)=", page)
    assert HOSTILE not in page
    policy = re.search(r'Content-Security-Policy" content="([^"]*)"', page)[1]
    rules = dict(rule.strip().split(" ", 1) for rule in policy.split(";"))
    assert rules["default-src"] == "'none'"
    assert rules["img-src"] == "data:"
    for kind, pattern in (("script-src", r"<script>(.*?)</script>"), ("style-src", r"<style>(.*?)</style>")):
        (text,) = re.findall(pattern, page, re.DOTALL)
        digest = base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()
        assert rules[kind] == f"'sha256-{digest}'"
    assert 'style="' not in page  # which the policy would not let stand


def test_the_page_serves_keys_readers_without_motion_and_narrow_screens(page):
    for words in (
        "prefers-reduced-motion",
        'name="viewport"',
        'role="img"',
        "aria-valuetext",
        "ArrowRight",
        "noscript",
    ):
        assert words in page


def test_the_page_holds_a_picture_for_each_time_of_one_size(page, movie):
    data = data_of(page)
    (view,), scene = data["views"], data["canvases"][0]
    assert len(data["pictures"]) == len(view["time"]) == len(movie.time)
    assert np.allclose(view["time"], movie.time, rtol=1e-6)
    for address, image in zip(data["pictures"], movie.images, strict=True):
        kind, _, held = address.partition(",")
        assert kind in ("data:image/webp;base64", "data:image/jpeg;base64")
        seen = Image.open(io.BytesIO(base64.b64decode(held))).convert("RGB")
        assert seen.size == image.size
        off = np.abs(np.asarray(seen, float) - np.asarray(image, float)).mean()
        assert off < 6.0  # of 255: compressed, yet the same picture
    left, right, bottom, top = scene["limits"]
    assert right - left == movie.width
    assert (right - left) / (top - bottom) == pytest.approx(image.width / image.height)
    assert scene["colour_scale"]["limits"] == [0.0, movie.scale.norm.vmax]
    assert scene["colour_scale"]["label"] == "von Mises stress (MPa)"


def test_the_histories_of_the_page_are_those_of_the_run(page, solution):
    force, acceleration = data_of(page)["canvases"][1]["panels"]
    (curve,) = force["curves"]
    (history,) = curve["histories"]
    assert curve["name"] == "striker.top-bar.bottom"
    assert force["name"] == "contact force"  # of whole bodies, of which quarters are meshed
    sizes = 4e-3 * np.abs(mean_force(solution.model_run, "striker.top-bar.bottom")[:, 2])  # along the blow
    assert unpacked(history["values"], "<f4").max() == pytest.approx(sizes.max(), rel=1e-6)
    assert unpacked(history["values"], "<f4").max() == pytest.approx(
        4.0 * solution.model_contacts["striker.top-bar.bottom"].peak / 1e3, rel=1e-6
    )
    assert unpacked(history["time"], "<f4")[-1] == pytest.approx(39.8e-6, rel=1e-6)  # the middle of the last interval
    assert [one["name"] for one in acceleration["curves"]] == ["striker", "bar"]
    rates = unpacked(acceleration["curves"][0]["histories"][0]["values"], "<f4")  # slows down along the blow
    assert rates.min() == pytest.approx(-solution.parts["striker"].rigid_peak / 9.80665, rel=1e-6)


def test_names_of_curves_hold_no_letters_that_control_a_screen():
    time = np.arange(3.0)
    curves = fem_animation._curves(time, {"a\x1b[31m\u202eb": time})
    assert list(curves) == ["a\ufffd[31m\ufffdb"]


def test_most_instants_are_those_in_contact(solution):
    stills = shown_snapshots(solution.film)
    times = [still.time for still in stills]
    assert times == sorted(set(times))
    assert len(times) <= fem_animation.TOUCHING + fem_animation.APART
    touching = np.linalg.norm(solution.run.force["striker.top-bar.bottom"], axis=1) > 0.0
    end = float(solution.run.time[touching][-1])
    assert sum(time <= end for time in times) > 0.5 * len(times)
    assert times[-1] == pytest.approx(40e-6, rel=1e-9)


@pytest.mark.verify
def test_the_gif_has_its_pictures_and_they_move(movie, tmp_path, monkeypatch):
    monkeypatch.setattr(fem_animation, "GIF_PICTURES", 10)
    seen: list[float] = []
    write_fem_gif(movie, HOSTILE, tmp_path / "a.gif", seen.append)
    with Image.open(tmp_path / "a.gif") as gif:
        assert gif.n_frames == 10 < len(movie.time)
        assert gif.info["loop"] == 0
        first = np.asarray(gif.convert("RGB"), float)
        gif.seek(gif.n_frames - 1)
        last = np.asarray(gif.convert("RGB"), float)
    assert np.abs(first - last).max() > 100.0
    assert (tmp_path / "a.gif").stat().st_size < 5e6
    assert seen[-1] == pytest.approx(1.0)
    assert seen == sorted(seen)


@pytest.mark.verify
def test_pictures_that_are_too_large_are_compressed_more(movie, monkeypatch):
    usual = sum(map(len, fem_animation._encoded(movie.images)))
    monkeypatch.setattr(fem_animation, "LARGEST_PAGE", 1)
    assert sum(map(len, fem_animation._encoded(movie.images))) < 0.8 * usual


@pytest.mark.verify
def test_the_command_writes_both_and_refuses_without_a_folder(tmp_path):
    runner = CliRunner()
    sets = [word for change in [*COARSE, "fem.duration=4 us"] for word in ("--set", change)]
    done = runner.invoke(app, ["fem", "two-bars-fem", *sets, "--animate", "--no-report", "--out", str(tmp_path / "o")])
    assert done.exit_code == 0, done.output
    assert {"animation.html", "animation.gif"} <= {entry.name for entry in Path(tmp_path / "o").iterdir()}
    refused = runner.invoke(app, ["fem", "two-bars-fem", "--animate", "--json"])
    assert refused.exit_code != 0
