"""The player of all animations, in a browser: keys, loop, views and addresses; and the one writer of GIFs."""

import dataclasses
import html
import json
import re
import subprocess

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from PIL import Image

from strikewave.reporting.animation import (
    Animation,
    Chart,
    Clock,
    FieldCurve,
    LayerBand,
    Panel,
    PlaceAxis,
    PlaceMark,
    PlayedCurve,
    PlayedHistory,
    PlayedSpan,
    Readout,
    Scene,
    Shape,
    animation_page,
    write_gif,
)

from ..chromium import chromium

TIME = np.linspace(0.0, 10e-6, 11)
KEYS = """
const answers = [];
const say = () => answers.push(document.getElementById("reading").textContent);
const press = (key, more) => { document.dispatchEvent(new KeyboardEvent("keydown", { key, ...more })); say(); };
"""


def over_time(**changes):
    force = PlayedCurve(
        "", "#0072b2", [PlayedHistory(TIME, 1e9 * TIME), PlayedHistory(TIME[2:5], -1e9 * TIME[2:5], 2e-6)]
    )
    chart = Chart("chart", "Force over time.", "time", "time", 60.0, [Panel("force", "kN", [force], 1e3, decimals=3)])
    square = Shape(np.array([(0.0, 0.0), (0.0, 1.0), (0.1, 1.0)]), "#ff0000", ends=((0.0, "place"), (1.0, "place")))
    settings = {
        "kicker": "test",
        "note": "",
        "gif": "test.gif",
        "clock": Clock("µs", 1e-6, 2),
        "views": [PlayedSpan("whole", "whole run", TIME[[0, -1]]), PlayedSpan("0", "part", TIME[[2, 4]])],
        "canvases": [Scene("scene", "A square.", "a square", (0.0, 2.0, 0.0, 1.0)), chart],
        "smooth": True,
        "tracks": {"time": TIME, "place": 1e5 * TIME},
        "shapes": [square],
        "readouts": [Readout("square", "mm", "place", 1e-3, 1, 0.5)],
    }
    return Animation(**settings | changes)


def over_place():
    position = np.array([0.0, 0.01, 0.01, 0.02])
    values = np.outer(np.arange(11.0), [1.0, 2.0, -3.0, -4.0])
    chart = Chart("chart", "Stress.", "place", "distance", 60.0, [Panel("stress", "MPa", [FieldCurve("#000000", "#0072b2", "#d55e00", values)], limits=(-50.0, 50.0))])  # fmt: skip
    bands = [LayerBand("a<b>", 0.0, 0.01, 240), LayerBand("b", 0.01, 0.02, 220, "dashed")]
    places = PlaceAxis(position.tolist(), [0, 0, 1, 1], bands, [PlaceMark("end", 0.02)], 1, "mm", 1e-3)
    return Animation(
        "test", "", "test.gif", Clock.of(TIME), [PlayedSpan("whole", "whole", TIME)], [chart], places=places
    )


def answers(animation, script, tmp_path, at=""):
    """Return what stood below the pictures after each key; the policy is taken out for the script that presses them."""
    page = re.sub(r'<meta http-equiv="Content-Security-Policy"[^>]*>', "", animation_page(animation, "test"))
    script = f"{KEYS}{script}\ndocument.body.dataset.answers = JSON.stringify(answers);"
    place = tmp_path / "page.html"
    place.write_text(page.replace("</body>", f"<script>{{{script}}}</script></body>"), "utf-8")
    options = [
        "--no-sandbox",
        "--force-prefers-reduced-motion",
        "--dump-dom",
        "--virtual-time-budget=2000",
        "--window-size=900,800",
    ]
    done = subprocess.run([chromium(), *options, place.as_uri() + at], check=True, capture_output=True, timeout=60)
    dom = done.stdout.decode()
    return json.loads(html.unescape(re.search(r'data-answers="([^"]*)"', dom)[1])), dom


@pytest.mark.verify
def test_keys_step_through_time_and_views(tmp_path):
    script = """
    press("ArrowRight"); press("ArrowRight", { shiftKey: true }); press("End"); press("Home");
    press("PageDown"); press("End"); press("PageDown"); press("PageUp"); press("x");
    """
    said, _ = answers(over_time(), script, tmp_path)
    assert said == [
        "t = 0.05 µs: force 0.050 kN; square -495.0 mm",
        "t = 0.06 µs: force 0.055 kN; square -494.5 mm",
        "t = 10.00 µs: force 10.000 kN; square 500.0 mm",
        "t = 0.00 µs: force 0.000 kN; square -500.0 mm",
        "t = 2.00 µs: force -2.000 kN; square -300.0 mm",
        "t = 4.00 µs: force -4.000 kN; square -100.0 mm",
        "t = 4.00 µs: force -4.000 kN; square -100.0 mm",
        "t = 0.00 µs: force 0.000 kN; square -500.0 mm",
        "t = 0.00 µs: force 0.000 kN; square -500.0 mm",
    ]


@pytest.mark.verify
def test_frames_and_places_are_stepped_one_by_one(tmp_path):
    script = 'press("ArrowRight"); press("ArrowDown"); press("ArrowDown"); press("ArrowDown"); press("End"); press("ArrowUp");'
    said, dom = answers(over_place(), script, tmp_path)
    assert said == [
        "t = 1 µs, at 10 mm in a<b>: stress 2 MPa",
        "t = 1 µs, at 10 mm in b: stress -3 MPa",
        "t = 1 µs, at 20 mm in b, tap end: stress -4 MPa",
        "t = 1 µs, at 20 mm in b, tap end: stress -4 MPa",
        "t = 10 µs, at 20 mm in b, tap end: stress -40 MPa",
        "t = 10 µs, at 10 mm in b: stress -30 MPa",
    ]
    assert 'aria-valuetext="10 mm in b"' in dom
    assert "<b>" not in dom.split("<main>")[1].split("</main>")[0]


@pytest.mark.verify
def test_an_address_opens_a_view_at_a_time(tmp_path):
    said, dom = answers(over_time(), "say();", tmp_path, at="#view=0&time=3")
    assert said == ["t = 3.00 µs: force -3.000 kN; square -200.0 mm"]
    assert ">Play</button>" in dom
    said, _ = answers(over_place(), "say();", tmp_path, at="#time=6.9&view=constructor")
    assert said == ["t = 7 µs, at 10 mm in a<b>: stress 14 MPa"]


@pytest.mark.verify
@pytest.mark.parametrize("loop", [True, False])
def test_it_plays_and_ends_where_no_loop_is_wanted(loop, tmp_path):
    """Ten seconds at speed 8 take 1.25 s, here in steps of 20 ms."""
    script = f"""
    let asked = null, clock = 0;
    window.requestAnimationFrame = (tick) => {{ asked = tick; }};
    const wait = (steps) => {{
      for (let k = 0; asked && k < steps; k += 1) {{ const tick = asked; asked = null; tick(clock += 20); }}
      say();
      answers.push(document.getElementById("play").textContent);
    }};
    document.getElementById("loop").checked = {json.dumps(loop)};
    document.getElementById("speed").value = "8";
    press(" "); wait(31); wait(40);
    """
    said, dom = answers(over_place(), script, tmp_path)
    place = "at 10 mm in a<b>"
    assert said[:3] == [f"t = 0 µs, {place}: stress 0 MPa", f"t = 5 µs, {place}: stress 10 MPa", "Pause"]
    assert said[3:] == (
        [f"t = 1 µs, {place}: stress 2 MPa", "Pause"] if loop else [f"t = 10 µs, {place}: stress 20 MPa", "Play"]
    )
    assert re.search(r'id="slowed"[^>]*>slowed [\d,]+ times<', dom)


def test_hostile_texts_of_every_kind_stay_text():
    hostile = "</script><img src=x onerror=alert(1)> \u202e"
    animation = dataclasses.replace(over_time(), kicker=hostile, note=hostile, gif=hostile)
    views = [PlayedSpan(f'"{hostile}', hostile, TIME)]
    page = animation_page(dataclasses.replace(animation, views=[*views, *views]), hostile, hostile)
    assert "<img" not in page
    assert page.count("</script>") == 2


def test_a_clock_tells_each_time_from_the_next():
    assert Clock.of(TIME) == ("µs", 1e-6, 0)
    assert Clock.of(np.array([0.0, 1e-6, 1.25e-6])).decimals == 1
    assert Clock.of(np.array([0.0, 0.0])).decimals == 0
    assert Clock.of(np.array([0.0, 1e-2])).unit == "ms"


def test_a_gif_keeps_its_commonest_colours(tmp_path):
    """White, and a grey 8 below it, which Pillow's look-up would mix up with what is near them."""
    figure = Figure(figsize=(2.0, 1.0), dpi=50)
    look = {"transform": figure.transFigure, "linewidth": 0.0}
    moving = Rectangle((0.2, 0.5), 0.1, 0.2, facecolor="#d55e00", **look)
    figure.patches += [Rectangle((0.5, 0.0), 0.5, 1.0, facecolor="#f7f7f7", **look), moving]
    shares = []
    write_gif(tmp_path / "a.gif", figure, lambda k: moving.set_y(0.05 * k), list(range(10)), shares.append)
    assert shares == pytest.approx(np.arange(1, 11) / 10)
    with Image.open(tmp_path / "a.gif") as film:
        assert (film.n_frames, film.info["duration"], film.info["loop"]) == (10, 100, 0)
        for k in range(film.n_frames):
            film.seek(k)
            pixels = film.convert("RGB")
            assert pixels.getpixel((5, 25)) == (255, 255, 255)
            assert pixels.getpixel((95, 2)) == (247, 247, 247)
