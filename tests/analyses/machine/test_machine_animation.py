"""The machine in motion: what the page and the GIF show is what the solution holds; the page is whole and safe."""

import base64
import dataclasses
import functools
import hashlib
import itertools
import json
import os
import re
import subprocess
from html.parser import HTMLParser

import numpy as np
import pytest

from strikewave import load_case
from strikewave.analyses.machine.blow_histories import carriage_position
from strikewave.analyses.machine.figures import animation
from strikewave.analyses.machine.figures import animation as machine_motion
from strikewave.analyses.machine.figures.animation import (
    MOST_DETAILED,
    detailed,
    frame_times,
    frame_words,
    machine_animation,
    machine_page,
    write_machine_gif,
)
from strikewave.analyses.machine.figures.animation import machine_motion as motion_of
from strikewave.base.constants import STANDARD_GRAVITY
from strikewave.base.datasets import LabelledArrays
from strikewave.machines._kernels import stroke_profile

from ...chromium import chromium

HOSTILE = "_</script><img src=x onerror=alert(1)> $\\frac{1}{$ & \u202e\u2028"
LARGEST = 500_000
"""Bytes of a page, so that it can be sent by mail."""


class Page(HTMLParser):
    """Reads a page: its elements with their attributes and the text inside."""

    def __init__(self, text):
        super().__init__(convert_charrefs=True)
        self.found, self.inside = [], []
        self.feed(text)
        self.close()

    def handle_starttag(self, tag, attrs):
        self.found.append((tag, dict(attrs), []))
        if tag not in ("meta", "input"):
            self.inside.append(self.found[-1])

    def handle_endtag(self, tag):
        assert self.inside.pop()[0] == tag

    def handle_data(self, data):
        if self.inside:
            self.inside[-1][2].append(data)

    def of(self, tag):
        return [(attributes, "".join(text)) for name, attributes, text in self.found if name == tag]


def unpacked(text, kind):
    return np.frombuffer(base64.b64decode(text), kind).astype(float)


@pytest.fixture(scope="module")
def motion(solution):
    return motion_of(solution)


@pytest.fixture(scope="module")
def page(solution):
    return machine_page(solution)


def missed(solution):
    """The same run with every blow called missed, as where the object stands out of reach."""
    blows = tuple(dataclasses.replace(blow, kind="missed") for blow in solution.blows)
    data = solution.data.copy()
    for name in ("pulse_force", "pulse_acceleration"):
        data[name] = data[name] * np.nan
    return dataclasses.replace(solution, blows=blows, sampled=LabelledArrays.of_xarray(data))


def test_the_page_is_whole_and_fetches_nothing(page):
    read = Page(page)
    assert read.inside == []
    assert not {"link", "img", "iframe", "object", "embed"} & {tag for tag, _, _ in read.found}
    for _, attributes, _ in read.found:
        assert not {"src", "href", "style", "onclick", "onload"} & set(attributes)
    words = re.sub(r'"[A-Za-z0-9+/=]{40,}"', '""', page)
    assert not re.search(r"https?:|//[a-z]|url\(|@import|fetch\(|eval\(|innerHTML|document\.write", words)
    assert {a["id"] for a, _ in read.of("canvas")} == {"whole", "close", "traces"}
    assert all(a["aria-label"] for a, _ in read.of("canvas"))
    assert [a["value"] for a, _ in read.of("option")][:3] == ["whole", "0", "1"]


def test_the_policy_allows_only_the_page_s_own_script_and_style(page):
    read = Page(page)
    (policy,) = [a["content"] for a, _ in read.of("meta") if "http-equiv" in a]
    rules = dict(rule.strip().split(" ", 1) for rule in policy.split(";"))
    assert rules["default-src"] == "'none'"
    data, script = read.of("script")
    assert data[0]["type"] == "application/json"
    for rule, source in (("script-src", script[1]), ("style-src", read.of("style")[0][1])):
        digest = base64.b64encode(hashlib.sha256(source.encode()).digest()).decode()
        assert rules[rule] == f"'sha256-{digest}'"


def test_hostile_titles_and_names_stay_text(solution):
    case = solution.case.model_copy(update={"name": HOSTILE, "title": HOSTILE})
    read = Page(machine_page(dataclasses.replace(solution, case=case)))
    assert "img" not in {tag for tag, _, _ in read.found}
    assert len(read.of("script")) == 2
    readable = HOSTILE.replace("\u202e", "\ufffd").replace("\u2028", "\ufffd")
    assert readable in read.of("h1")[0][1]
    assert readable in read.of("footer")[0][1]


def test_the_page_holds_the_samples_of_the_solution(solution, motion):
    """Values are the solution's own samples to 32 bits (relative 6e-8); nothing is smoothed."""
    document = json.loads(json.dumps(machine_animation(motion).document()))
    data = solution.data
    time = data["time"].values
    kept = unpacked(document["tracks"]["time"], "<f8")
    rows = np.searchsorted(time, kept)
    assert np.array_equal(time[rows], kept)
    names = {
        "angle": "turntable_angle",
        "speed": "turntable_speed",
        "nose": "nose_position",
        "assembly": "assembly_position",
        "carriage": "carriage_position",
    }
    for name, variable in names.items():
        assert unpacked(document["tracks"][name], "<f4") == pytest.approx(data[variable].values[rows], rel=6e-8), name
    panels = document["canvases"][2]["panels"]
    for panel, variable in zip(panels[:2], ("contact_force", "rigid_acceleration"), strict=True):
        trace = panel["curves"][0]["histories"][0]
        at = unpacked(trace["time"], "<f4")
        assert np.abs(time[np.searchsorted(time, at - 5e-6)] - at).max() < 1e-7  # 32 bits of 0.28 s are 17 ns
        values = unpacked(trace["values"], "<f4")
        assert values.max() == pytest.approx(data[variable].values.max(), rel=6e-8)
        assert values.min() == pytest.approx(data[variable].values.min(), rel=6e-8)


def test_each_blow_keeps_its_peaks_and_its_samples(solution, motion):
    fine = solution.data["pulse_time"].values
    assert len(motion.near) == len(solution.blows)
    for row, one in enumerate(motion.near):
        for trace, name in ((one.force, "pulse_force"), (one.acceleration, "pulse_acceleration")):
            held = solution.data[name].values[row]
            assert np.all(np.diff(trace.time) > 0.0)
            assert trace.values.max() == np.nanmax(held)
            since = trace.time - one.blow.time
            within = (since >= fine[0]) & (since <= fine[np.isfinite(held)][-1])
            rows = np.rint((since[within] - fine[0]) / (fine[1] - fine[0])).astype(int)
            assert since[within] == pytest.approx(fine[rows], abs=1e-12)
            assert np.array_equal(trace.values[within], held[rows])
        # between the kept samples the pulse is a line: its impulse is that of all samples to 0.2 %
        within = slice(*np.searchsorted(one.force.time, one.blow.time + np.array([0.0, 4e-4])))
        kept = np.trapezoid(one.force.values[within], one.force.time[within])
        pulse = (fine >= 0.0) & (fine < 4e-4)
        whole = np.trapezoid(solution.data["pulse_force"].values[row][pulse], fine[pulse])
        assert kept == pytest.approx(whole, rel=2e-3)


def test_noses_meet_the_face_when_the_first_contact_begins(solution, motion):
    """Poses between kept samples are within a tenth of a millimetre; the nose runs at 3.6 m/s along the blow."""
    geometry = motion.made.geometry
    blow = solution.blows[0]
    pose = motion.pose(blow.time)
    reach = geometry.noses(pose.angle)[:, 0].max() + geometry.nose_radius
    assert reach == pytest.approx(geometry.reach + pose.nose, abs=1e-4)
    assert int(np.argmax(geometry.noses(pose.angle)[:, 0])) == blow.striker - 1


def test_the_angle_of_the_turntable_is_the_integral_of_its_speed(solution):
    """By the trapezoid rule over 10 us steps."""
    time, speed, angle = (solution.data[name].values for name in ("time", "turntable_speed", "turntable_angle"))
    turned = np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) * np.diff(time))])
    assert angle - angle[0] == pytest.approx(turned, abs=1e-6)


@pytest.mark.parametrize("shares", [(0.5, 0.5), (0.2, 0.6)])
def test_the_carriage_follows_the_stroke_of_the_machine(published, shares):
    """The law in the data and the kernel that moves the machine are two; they agree to rounding."""
    rise, fall = shares
    changes = [f"feed.acceleration={rise}", f"feed.cushion={fall}"]
    case = load_case("li-ma-2019", changes)
    phases = (("feed", 0.0), ("fed", 1.0), ("retract", 2.0), ("brake", 4.0))
    time = np.linspace(-0.5, 4.5, 501)
    stroke = published.feed.stroke.si
    fed = [stroke_profile(min(max(t, 0.0), 1.0), rise, fall)[0] for t in time]
    back = [stroke_profile(min(max(0.5 * (t - 2.0), 0.0), 1.0), rise, fall)[0] for t in time]
    assert carriage_position(case, phases, time) == pytest.approx(stroke * (1.0 - np.array(fed) + back), abs=1e-15)


def test_a_long_run_makes_a_page_of_bounded_size(solution):
    """A hundred blows: the first, the last and an even choice can be looked at closely, odd ones first."""
    many = [dataclasses.replace(solution.blows[k % 11], index=k + 1) for k in range(100)]
    many[50] = dataclasses.replace(many[50], kind="glancing")
    rows = detailed(tuple(many))
    assert {0, 50, 99} <= set(rows)
    assert len(rows) <= MOST_DETAILED
    data = solution.data.drop_vars([name for name in solution.data if "blow" in solution.data[name].dims])
    data = data.drop_vars("blow")
    for name in ("pulse_force", "pulse_acceleration"):
        values = np.tile(solution.data[name].values, (10, 1))[:100]
        data[name] = (("blow", "pulse_time"), values)
    assert (
        len(machine_page(dataclasses.replace(solution, blows=tuple(many), sampled=LabelledArrays.of_xarray(data))))
        < LARGEST
    )


def test_where_all_blows_missed_the_machine_still_moves(solution):
    empty = missed(solution)
    moving = motion_of(empty)
    assert "blow 1 (missed)" in machine_page(empty)
    times, slow = frame_times(moving)
    assert not slow.any()
    assert times[[0, -1]] == pytest.approx([0.0, moving.time[-1]])
    none = dataclasses.replace(solution, blows=())
    assert motion_of(none).near == ()
    assert 'value="0"' not in re.sub(r"<input[^>]*>", "", machine_page(none))
    assert "no blow yet" in frame_words(motion_of(none), 0.1, 1.0)


@pytest.mark.verify
def test_the_gif_has_its_frames_and_says_how_slow_it_is(solution, motion, tmp_path, monkeypatch):
    from PIL import Image

    for name, frames in (("BEFORE_BLOW", 2), ("IN_BLOW", 4), ("AFTER_BLOW", 3)):
        monkeypatch.setattr(animation, name, frames)
    shares = []
    write_machine_gif(solution, tmp_path / "m.gif", shares.append)
    assert shares == pytest.approx(np.arange(1, 10) / 9)
    with Image.open(tmp_path / "m.gif") as film:
        assert film.n_frames == 9
        frames = []
        for k in range(9):
            film.seek(k)
            assert film.info["duration"] == 100
            frames.append(np.asarray(film.convert("L"), float))
    assert all(np.abs(a - b).max() > 50.0 for a, b in itertools.pairwise(frames))
    times, slow = frame_times(motion)
    assert np.all(np.diff(times) > 0.0)
    assert times[slow][[0, -1]] - solution.blows[0].time == pytest.approx([-2e-4, 8e-4])


def test_the_words_of_a_frame_are_the_solution_s(solution, motion):
    row = int(np.searchsorted(solution.data["time"].values, motion.time[700]))
    time = float(solution.data["time"].values[row])
    words = frame_words(motion, time, 30.0)
    speed = float(solution.data["turntable_speed"].values[row]) * 30.0 / np.pi
    displacement = (float(solution.data["nose_position"].values[row]) + motion.made.geometry.engagement) * 1e3
    done = sum(blow.time <= time for blow in solution.blows)
    assert f"{speed:.1f} r/min" in words
    assert f"face {displacement:+6.2f} mm" in words
    assert f"blow {done} " in words
    assert "slowed 30 times" in words


def test_only_a_rotary_machine_is_shown(solution, monkeypatch, tmp_path):
    monkeypatch.setattr(machine_motion, "outlines", lambda case: None)
    assert machine_page(solution) is None
    with pytest.raises(ValueError, match="rotary"):
        write_machine_gif(solution, tmp_path / "m.gif")


@pytest.mark.verify
def test_run_animate_writes_page_gif_and_link_and_may_be_repeated(strikewave, monkeypatch):
    for name in ("BEFORE_BLOW", "IN_BLOW", "AFTER_BLOW"):
        monkeypatch.setattr(animation, name, 2)
    for _ in range(2):
        code, _, err = strikewave("run", "--no-band", "li-ma-2019", "--set", "feed.blows=1", "--animate", "--out", "m")
        assert code in (0, 3), err
        assert "machine.html, machine.gif" in err
        assert {"machine.html", "machine.gif", "report.html"} < set(os.listdir("m"))
    assert '<a href="machine.html">' in open("m/report.html", encoding="utf-8").read()
    code, _, err = strikewave("run", "--no-band", "li-ma-2019", "--animate", "--json")
    assert code == 2
    assert "--out DIR" in err


# ---- with a browser ----


def opened(place, width=1280, at=""):
    """Return the page as a browser has it after its script ran."""
    options = ["--no-sandbox", "--force-prefers-reduced-motion", f"--window-size={width},900", "--dump-dom"]
    done = subprocess.run(
        [chromium(), *options, "--virtual-time-budget=2000", f"{place.as_uri()}{at}"],
        check=True,
        capture_output=True,
        timeout=60,
    )
    return Page(done.stdout.decode())


@functools.cache
def numbers(text):
    found = re.search(
        r"t = ([\d.]+) ms.*contact force (-?[\d.]+) kN; rigid-body acceleration (-?[\d.]+) g; turntable speed "
        r"([\d.]+) r/min; face (-?[\d.]+) mm behind its place at rest; carriage (-?[\d.]+) mm back",
        text,
    )
    return [float(number) for number in found.groups()]


@pytest.mark.verify
def test_the_browser_shows_the_numbers_of_the_solution(solution, motion, page, tmp_path):
    """At kept samples, to the decimals that are written: half of the last one, and the 32 bits of a value."""
    place = tmp_path / "machine.html"
    place.write_text(page, "utf-8")
    near = motion.near[2]
    top = int(np.argmax(near.force.values))
    row = int(np.searchsorted(motion.time, near.blow.time))
    for at, which in ((near.force.time[top], "force"), (motion.time[row], "places")):
        read = opened(place, at=f"#view=2&time={float(at) * 1e3!r}")
        (text,) = [words for a, words in read.of("p") if a.get("id") == "reading"]
        time, force, _, speed, displacement, carriage = numbers(text)
        assert time == pytest.approx(at * 1e3, abs=5.1e-4)
        assert f"blow {near.blow.index} (full)" in text
        if which == "force":
            # the time of a sample is kept to 0.1 ns, in which the force changes by less than 1 N
            assert force == pytest.approx(near.force.values[top] / 1e3, abs=1.6e-3)
            assert force == pytest.approx(near.blow.peak_force / 1e3, rel=1e-2)  # half a microsecond beside its top
        else:
            assert speed == pytest.approx(motion.speed[row] * 30.0 / np.pi, abs=5.1e-3)
            assert displacement == pytest.approx((motion.nose[row] - motion.rest) * 1e3, abs=5.1e-3)
            assert carriage == pytest.approx(motion.carriage[row] * 1e3, abs=5.1e-3)


@pytest.mark.verify
def test_the_browser_obeys_reduced_motion_and_hostile_addresses(page, tmp_path):
    place = tmp_path / "machine.html"
    place.write_text(page, "utf-8")
    read = opened(place, at="#view=__proto__&time=1e999")
    assert [words for a, words in read.of("button") if a["id"] == "play"] == ["Play"]
    (text,) = [words for a, words in read.of("p") if a.get("id") == "reading"]
    assert numbers(text)[0] == 0.0


@pytest.mark.verify
def test_nothing_is_wider_than_a_narrow_screen(page, tmp_path):
    """The policy is taken out of the copy that is measured, for a script that measures it."""
    measured = re.sub(r'<meta http-equiv="Content-Security-Policy"[^>]*>', "", page)
    script = "document.body.dataset.wide = document.documentElement.scrollWidth + ' ' + window.innerWidth;"
    place = tmp_path / "narrow.html"
    place.write_text(measured.replace("</body>", f"<script>{script}</script></body>"), "utf-8")
    (body,) = opened(place, width=390).of("body")
    wide, window = map(int, body[0]["data-wide"].split())
    assert window == 390
    assert wide <= window


def test_missing_blows_and_no_duration_have_frames(motion):
    """A GIF never holds two frames of one time, however early the first blow comes."""
    early = motion.near[0]._replace(blow=dataclasses.replace(motion.near[0].blow, time=1e-5))
    times, _ = frame_times(dataclasses.replace(motion, near=(early,)))
    assert np.all(np.diff(times) >= 0.0)
    assert times[0] == 0.0


def test_accelerations_are_shown_in_standard_gravities(motion):
    acceleration = machine_animation(motion).canvases[2].panels[1]
    assert (acceleration.unit, acceleration.per) == ("g", STANDARD_GRAVITY)
