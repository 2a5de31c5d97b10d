"""Pictures of the wave field: what they show is what the field holds; no name gets out of its place."""

import base64
import dataclasses
import functools
import hashlib
import json
import re
from html.parser import HTMLParser
from xml.etree import ElementTree

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg

from strikewave import load_case, run_case, run_wave
from strikewave.analyses.layered_bars import (
    QUANTITIES,
    SNAPSHOTS,
    WaveField,
    cell_edges,
    sandwiched,
    shades,
    snapshot_rows,
    snapshots,
    staircase_diagram,
    xt_diagram,
)
from strikewave.analyses.machine.report import struck_field
from strikewave.analyses.wave import report
from strikewave.analyses.wave.report import field_of_solution, wave_animation, wave_page, wave_report, write_wave_gif
from strikewave.reporting.chapters import inline_svg
from strikewave.reporting.style import spread
from strikewave.waves import BONDED, End, Impactor, Joint, Layer, LoadPulse, Stack, Tap, WantedError, run_bar

STEEL, ALLOY = (7820.0, 211e9), (2780.0, 72e9)
HOSTILE = "_</script><img src=x onerror=alert(1)> $\\frac{1}{$ & \u202e\u2028"


def layer(name, matter, length, diameter=0.03, speed=0.0):
    return Layer(name, *matter, 0.25 * np.pi * diameter**2, length, speed=speed)


def field_of(stack, load, taps, duration, step=50e-9):
    run = run_bar(stack, load, [tap for _, tap in taps], duration, WantedError(step=step))
    held = (run.field_position, run.field_layer, run.field_force, run.field_velocity)
    return WaveField(stack, run.field_time, *held, tuple(taps), "time")


def three(lower_diameter=0.03, joints=(BONDED, BONDED), load=None, end="free", names=("upper", "specimen", "lower")):
    diameters = (0.03, 0.03, lower_diameter)
    bars = (layer(*made) for made in zip(names, (STEEL, ALLOY, STEEL), (0.1, 0.03, 0.1), diameters, strict=True))
    load = load or LoadPulse("rectangle", 2e4, 1e-3)
    return field_of(Stack(tuple(bars), joints, End(end)), load, [(f"tap {names[1]}", Tap(1, 0.5))], 100e-6)


KINDS = {
    "bonded": three,
    "gap": lambda: three(joints=(Joint(unilateral=True, gap=2e-6), BONDED)),
    "bolted": lambda: three(joints=(Joint(unilateral=True, preload=3e3), BONDED)),
    "springs and masses": lambda: three(joints=(Joint(1e9, 1e3), Joint(mass=0.05))),
    "struck": lambda: three(load=Impactor(0.2, 2.0)),
    "hostile names": lambda: three(names=(HOSTILE, "b" * 300, "$x^{")),
    "one layer": lambda: field_of(
        Stack((layer("only", STEEL, 0.1),)), LoadPulse("triangle", 2e4, 2e-5), [("t", Tap(0, 0.0))], 1e-4
    ),
    "no load": lambda: three(load=LoadPulse("half-sine", 0.0, 1e-5)),
    "striker bar": lambda: field_of(
        Stack(
            (layer("striker", STEEL, 0.1, speed=10.0), layer("bar", STEEL, 0.3)),
            (Joint(unilateral=True),),
            End("matched"),
        ),
        LoadPulse("half-sine", 0.0, 1e-5),
        [("gauge", Tap(1, 0.5))],
        1e-4,
    ),
    "three hundred layers": lambda: field_of(
        Stack(tuple(layer(f"layer {k}", (STEEL, ALLOY)[k % 2], 0.004) for k in range(300)), (BONDED,) * 299),
        LoadPulse("half-sine", 2e4, 3e-5),
        [("t", Tap(101, 0.5))],
        4e-4,
        None,
    ),
    "forty layers": lambda: field_of(
        Stack(
            tuple(layer(f"layer {k}", (STEEL, ALLOY)[k % 2], 0.002 + 0.01 * (k % 3)) for k in range(40)), (BONDED,) * 39
        ),
        LoadPulse("half-sine", 2e4, 3e-5),
        [("t", Tap(5, 0.5))],
        2e-4,
    ),
}


@pytest.fixture(scope="module")
def jump():
    """A jump of force on three bars, 100 us."""
    return three()


@pytest.fixture(scope="module")
def bar():
    return run_wave(load_case("li-ma-2019-fig13-bar"))


@functools.cache
def field_like(kind):
    return KINDS[kind]()


@pytest.mark.verify
@pytest.mark.parametrize("kind", KINDS)
def test_every_field_has_its_pictures(kind):
    """Well-formed and small; no name becomes an element, or mathematics."""
    field = field_like(kind)
    quantity = "velocity" if kind == "bonded" else "stress"
    figures = [xt_diagram(field, quantity), snapshots(field, quantity)]
    inner = sandwiched(field)
    assert (inner is None) == (kind in ("one layer", "no load", "striker bar"))
    if inner is not None:
        figures.append(staircase_diagram(field, inner, field.time, field.force[:, 0]))
    for figure in figures:
        svg = inline_svg(figure, "p1", "x")
        assert ElementTree.fromstring(svg).find(".//text") is not None
        assert "<img" not in svg
        assert len(svg.encode()) < 400_000


@pytest.mark.verify
def test_the_same_field_gives_the_same_picture(jump):
    for draw in (xt_diagram, snapshots):
        assert inline_svg(draw(jump), "p1", "x") == inline_svg(draw(jump), "p1", "x")


def mesh_of(figure):
    """Return times (s), places (m) and values of the cells of an x-t diagram, and its mesh."""
    (mesh,) = [c for c in figure.axes[0].collections if type(c).__name__ == "QuadMesh"]
    corners = mesh.get_coordinates()
    values = np.asarray(mesh.get_array()).reshape(corners.shape[0] - 1, corners.shape[1] - 1)
    return corners[0, :, 0] * 1e-6, corners[:, 0, 1] * 1e-3, values, mesh


@pytest.mark.verify
@pytest.mark.parametrize("quantity", QUANTITIES)
def test_the_colours_are_white_at_zero_and_the_scale_is_symmetric(jump, quantity):
    figure = xt_diagram(jump, quantity)
    _, _, values, mesh = mesh_of(figure)
    assert mesh.norm.vmin == -mesh.norm.vmax == -np.abs(values).max()
    red, green, blue, _ = mesh.cmap(0.5)
    assert min(red, green, blue) > 0.95
    unit = QUANTITIES[quantity].unit
    assert figure.axes[1].get_ylabel() == f"{quantity} ({unit}), {QUANTITIES[quantity].above} above 0"
    assert values.T * QUANTITIES[quantity].scale == pytest.approx(jump.values(quantity), rel=1e-12)


def test_the_front_moves_with_the_bar_speed_within_a_cell(jump):
    """In the picture: the farthest place under force at each time lies at c t, to a cell of the mesh."""
    _, edges, values, _ = mesh_of(xt_diagram(jump))
    steel, alloy = (np.sqrt(e / rho) for rho, e in (STEEL, ALLOY))
    arrivals = np.interp(edges, [0.0, 0.1, 0.13, 0.23], np.cumsum([0.0, 0.1 / steel, 0.03 / alloy, 0.1 / steel]))
    centres = jump.time
    rows = np.flatnonzero((centres > 2e-6) & (centres < 0.98 * arrivals[-1]))
    assert rows.size > 100
    for row in rows:
        reached = np.flatnonzero(np.abs(values[:, row]) > 1.0)[-1]  # MPa, of 28
        assert arrivals[reached] <= centres[row] + 1e-9
        assert arrivals[min(reached + 2, len(edges) - 1)] >= centres[row] - 1e-9


@pytest.mark.parametrize("kind", ["bonded", "striker bar", "forty layers", "three hundred layers"])
def test_nothing_moves_before_the_leading_characteristic(kind):
    """The dashed line is the first arrival: nothing before it, and something within two rows of it (a jump)."""
    field = field_like(kind)
    front, row = field.front(), field.time[1] - field.time[0]
    moved = np.abs(field.force) > 1e-9 * np.abs(field.force).max()
    for k, begin in enumerate(front):
        first = np.flatnonzero(moved[:, k])
        if first.size:
            assert field.time[first[0]] > begin - 1e-3 * row - 2e-3 * begin
            if kind == "bonded":
                assert field.time[first[0]] <= begin + 2.0 * row


def test_stress_jumps_by_the_areas_at_a_joint_and_force_does_not():
    field = three(lower_diameter=0.02)
    before, after = (np.flatnonzero(field.layer == k) for k in (1, 2))
    assert field.position[before[-1]] == pytest.approx(field.position[after[0]], rel=1e-12)
    force, stress = field.values("force"), field.values("stress")
    assert force[:, before[-1]] == pytest.approx(force[:, after[0]], abs=1e-9 * np.abs(force).max())
    scale = np.abs(stress).max()
    assert stress[:, after[0]] == pytest.approx(stress[:, before[-1]] * 2.25, abs=1e-9 * scale)


def test_cells_of_a_joint_end_at_the_joint():
    edges = cell_edges(np.array([0.0, 1.0, 2.0, 2.0, 5.0]))
    assert edges.tolist() == [0.0, 0.5, 1.5, 2.0, 3.5, 5.0]


def test_a_joint_is_drawn_open_exactly_while_no_force_crosses_it():
    field = field_like("gap")
    (line,) = [one for one in xt_diagram(field).axes[0].lines if one.get_color() == "white"]
    face = np.flatnonzero(field.layer == 0)[-1]
    drawn_open = np.isfinite(line.get_ydata())
    assert np.array_equal(drawn_open, np.abs(field.force[:, face]) <= 1e-9 * 2e4)
    assert drawn_open[0]
    assert 0 < drawn_open.sum() < drawn_open.size


def test_a_bolted_joint_is_open_where_its_force_is_minus_the_preload():
    field = field_like("bolted")
    (line,) = [one for one in xt_diagram(field).axes[0].lines if one.get_color() == "white"]
    face = np.flatnonzero(field.layer == 0)[-1]
    assert not np.isfinite(line.get_ydata()[0])
    assert np.array_equal(np.isfinite(line.get_ydata()), field.force[:, face] <= -3e3 + 1e-4)


@pytest.mark.parametrize("kind", KINDS)
def test_snapshots_are_few_rising_and_hold_the_greatest_value(kind):
    field = field_like(kind)
    for quantity in QUANTITIES:
        rows = [row for row, _ in snapshot_rows(field, quantity)]
        assert len(rows) == SNAPSHOTS
        assert rows == sorted(set(rows))
        assert 0 <= rows[0] <= rows[-1] < len(field.time)
        values = field.values(quantity)
        assert values[rows].max() >= 0.999 * values.max()
        if values.min() < -0.01 * np.abs(values).max():
            assert values[rows].min() <= 0.999 * values.min()


def test_snapshots_follow_the_front(jump):
    """Each named time is that of the front at the place, to a row of the field."""
    found = {why: jump.time[row] for row, why in snapshot_rows(jump)}
    steel, alloy = 0.1 / np.sqrt(211e9 / 7820.0), 0.03 / np.sqrt(72e9 / 2780.0)
    step = jump.time[1]
    whole = 2.0 * steel + alloy
    for why, time in (
        ("front in upper", 0.5 * steel),
        ("front in specimen", steel + 0.5 * alloy),
        ("front at the far end", whole),
        ("its echo half-way back", 1.5 * whole),
    ):
        assert 0.0 <= found[why] - time <= step


def test_a_short_field_has_as_many_snapshots_as_rows(jump):
    short = dataclasses.replace(jump, time=jump.time[:3], force=jump.force[:3], velocity=jump.velocity[:3])
    assert [row for row, _ in snapshot_rows(short)] == [0, 1, 2]
    FigureCanvasAgg(snapshots(short)).draw()


def test_the_curve_of_a_snapshot_is_the_field(jump):
    figure = snapshots(jump)
    for axes, (row, _) in zip(figure.axes, snapshot_rows(jump), strict=True):
        (curve,) = [line for line in axes.lines if len(line.get_xdata()) > 2]
        y = curve.get_ydata()
        assert y[np.isfinite(y)] == pytest.approx(jump.values("stress")[row] / 1e6, rel=1e-12)
        assert np.isnan(y).sum() == 2  # cut at both joints


def test_darker_layers_have_more_impedance():
    greys = shades(three().stack)
    assert greys[0] == greys[2] < greys[1]
    same = Stack((layer("a", STEEL, 0.1), layer("b", STEEL, 0.1)), (BONDED,))
    assert len(set(shades(same))) == 1


def test_names_beside_keep_their_distance(rng):
    for _ in range(50):
        count = int(rng.integers(1, 12))
        places = np.sort(rng.uniform(0.0, 10.0, count))
        moved = spread(places, 0.8, 10.0)
        assert np.diff(moved).min(initial=1.0) >= 0.8 - 1e-9
        assert moved.min() >= 0.4 - 1e-9
        assert moved.max() <= 9.6 + 1e-9
        apart = np.diff(places).min(initial=9.0) >= 0.8 and places[0] >= 0.4 and places[-1] <= 9.6
        if apart:
            assert moved == pytest.approx(places)


def test_the_staircase_picture_shows_field_closed_form_and_steps(jump):
    """A jump on bonded bars: dashed and solid lie on each other until the first echo, the solid one goes on."""
    figure = staircase_diagram(jump, 1, jump.time, jump.force[:, 0])
    for k, axes in enumerate(figure.axes):
        curves = {line.get_label(): line for line in axes.lines}
        solid, dashed = curves["this stack"].get_ydata(), curves["endless neighbours, bonded"].get_ydata()
        since = curves["this stack"].get_xdata()
        away = np.abs((since - k) / 2.0 - np.round((since - k) / 2.0)) > 0.05  # not within a row of a step
        kept = away[: len(dashed)] & (since[: len(dashed)] < since[len(dashed) - 1] - 0.1)
        assert solid[: len(dashed)][kept] == pytest.approx(dashed[kept], abs=1e-9)
        assert len(solid) > len(dashed)
        levels = [line.get_ydata()[0] for line in axes.lines if line.get_linestyle() == ":"]
        assert levels[0] == pytest.approx((0.516642, 0.766365)[k], abs=1e-6)


def test_the_field_of_a_bar_ends_two_round_trips_after_its_load(bar):
    field = field_of_solution(bar)
    wanted = 10.03e-6 + 4.0 * bar.run.stack.transit
    assert wanted - bar.run.field_time[1] <= field.time[-1] <= wanted
    assert field.values("velocity").shape == (field.time.size, field.position.size)


def test_a_machine_has_the_same_picture_without_velocity():
    solution = run_case(load_case("li-ma-2019-fig13", ["feed.blows=1"]))
    field = struck_field(solution)
    layers = np.cumsum([one.length for one in field.stack.layers])
    for k, end in enumerate(layers):
        inside = field.position[field.layer == k]
        assert inside[0] == pytest.approx(layers[k - 1] if k else 0.0, abs=1e-12)
        assert inside[-1] == pytest.approx(end, rel=1e-12)
    xt_diagram(field)
    with pytest.raises(ValueError, match="no velocity"):
        field.values("velocity")


@pytest.mark.verify
def test_the_report_of_a_bar_shows_the_quantity_that_is_asked_for(bar):
    page = wave_report(bar, "velocity")
    assert "velocity (m/s), along the blow above 0" in page
    assert "purple is along the blow" in page
    assert "Interface II: sensor | lower" in page
    assert page.count("data:image/png") == 2  # the field and its scale
    assert len(page) < 500_000


class Page(HTMLParser):
    """What stands in a page: elements with their attributes and text; unclosed ones are found."""

    def __init__(self, text):
        super().__init__()
        self.open, self.found = [], []
        self.feed(text)
        self.close()

    def handle_starttag(self, tag, attributes):
        self.found.append((tag, dict(attributes), []))
        if tag not in ("meta", "input", "br", "link"):
            self.open.append((tag, self.found[-1]))

    def handle_endtag(self, tag):
        assert self.open.pop()[0] == tag

    def handle_data(self, data):
        if self.open:
            self.open[-1][1][2].append(data)

    def of(self, tag):
        return [(attributes, "".join(text)) for name, attributes, text in self.found if name == tag]


@pytest.fixture(scope="module")
def hostile_page():
    return Page(wave_page(field_like("hostile names"), HOSTILE, HOSTILE))


def test_the_animation_is_one_whole_page_that_fetches_nothing(jump):
    text = wave_page(jump, "a pulse", "a-case")
    page = Page(text)
    assert page.open == []
    assert not {"link", "img", "iframe", "object", "embed"} & {tag for tag, _, _ in page.found}
    for _, attributes, _ in page.found:
        assert not {"src", "href", "style", "onclick", "onload"} & set(attributes)
    without_data = re.sub(r'"counts":"[A-Za-z0-9+/=]*"', "", text)
    assert len(without_data) < 40_000
    assert not re.search(r"https?:|//[a-z]|url\(|@import|fetch\(|eval\(|innerHTML|document\.write", without_data)
    assert len(text) < 1.5e6
    assert {a["id"] for a, _ in page.of("input")} == {"time", "place", "loop"}
    assert page.of("canvas")[0][0]["aria-label"]


def test_the_policy_of_the_animation_allows_its_own_script_only(hostile_page):
    (policy,) = [a["content"] for a, _ in hostile_page.of("meta") if "http-equiv" in a]
    rules = dict(rule.strip().split(" ", 1) for rule in policy.split(";"))
    data, script = hostile_page.of("script")
    (_, style) = hostile_page.of("style")[0]
    assert rules["default-src"] == "'none'"
    assert data[0]["type"] == "application/json"
    for rule, source in (("script-src", script[1]), ("style-src", style)):
        digest = base64.b64encode(hashlib.sha256(source.encode()).digest()).decode()
        assert rules[rule] == f"'sha256-{digest}'"


def test_hostile_names_stay_text_in_the_animation(hostile_page):
    assert "img" not in {tag for tag, _, _ in hostile_page.found}
    assert len(hostile_page.of("script")) == 2
    document = json.loads(hostile_page.of("script")[0][1])
    readable = HOSTILE.replace("\u202e", "\ufffd").replace("\u2028", "\ufffd")
    assert document["places"]["bands"][0]["name"] == readable
    assert hostile_page.of("title")[0][1] == hostile_page.of("h1")[0][1] == readable


def test_the_animation_holds_the_field_to_half_a_count(jump):
    """16 bits: each value lies within 1/65534 of the peak of what the field holds, rounding of the peak aside."""
    document = wave_animation(jump).document()
    rows = report.even_rows(len(jump.time), report.MOST_FRAMES)
    (view,), (chart,), places = document["views"], document["canvases"], document["places"]
    assert np.array(view["time"]) == pytest.approx(jump.time[rows], rel=1e-6)
    assert view["time"][-1] == pytest.approx(jump.time[-1], rel=1e-6)
    assert places["band"] == jump.layer.tolist()
    assert [band["end"] for band in places["bands"]] == pytest.approx([0.1, 0.13, 0.23])
    assert places["marks"] == [{"name": "tap specimen", "position": 0.115}]
    assert [panel["name"] for panel in chart["panels"]] == ["stress", "velocity"]
    for panel in chart["panels"]:
        (curve,) = panel["curves"]
        counts = np.frombuffer(base64.b64decode(curve["counts"]), "<i2").reshape(len(rows), -1)
        values = jump.values(panel["name"])[rows] / QUANTITIES[panel["name"]].scale
        assert np.abs(counts * (curve["peak"] / 32767) - values).max() <= curve["peak"] / 65534 * (1 + 1e-9)
        assert panel["limits"][1] > curve["peak"]


def test_of_very_many_layers_the_animation_knows_those_that_have_places():
    whole = field_like("three hundred layers")
    kept = (whole.layer % 3 == 0) | (whole.layer == 299)
    held = {name: getattr(whole, name)[:, kept] for name in ("force", "velocity")}
    field = dataclasses.replace(whole, position=whole.position[kept], layer=whole.layer[kept], **held)
    assert sandwiched(field) % 3 == 0
    FigureCanvasAgg(xt_diagram(field)).draw()
    places = wave_animation(field).places
    assert len(places.bands) == 101
    assert [places.bands[k].name for k in places.band] == [f"layer {k}" for k in field.layer]
    assert places.bands[-1].end == pytest.approx(1.2)
    assert places.bands[1].begin > places.bands[0].end


def test_the_animation_opens_at_its_first_tap_in_the_layer_of_the_tap():
    """The second face of a joint, not the first one, which has the same place."""
    field = three()
    second = dataclasses.replace(field, taps=(("entry", Tap(1, 0.0)),))
    start = wave_animation(second).places.start
    assert field.layer[start] == 1
    assert field.position[start] == pytest.approx(0.1, rel=1e-12)


def test_a_large_field_makes_a_page_of_bounded_size():
    places = 3000
    stack = Stack((layer("only", STEEL, 1.0),))
    values = np.random.default_rng(1).normal(size=(600, places))
    field = WaveField(
        stack,
        np.linspace(0.0, 1e-3, 600),
        np.linspace(0.0, 1.0, places),
        np.zeros(places, np.int64),
        values,
        values,
        (),
        "time",
    )
    assert len(wave_page(field, "large")) < 1.5e6


@pytest.mark.verify
def test_the_gif_has_its_frames_and_moves(jump, tmp_path, monkeypatch):
    from PIL import Image

    monkeypatch.setattr(report, "GIF_FRAMES", 8)
    shares = []
    write_wave_gif(jump, HOSTILE, tmp_path / "a.gif", shares.append)
    assert shares == pytest.approx(np.arange(1, 9) / 8)
    with Image.open(tmp_path / "a.gif") as film:
        assert film.n_frames == 8
        frames = []
        for k in range(8):
            film.seek(k)
            frames.append(np.asarray(film.convert("RGB"), float))
    # half of what lies left of the front in a frame is blue, which it is not in the first one
    blue = [np.mean(frame[..., 2] - frame[..., 0] > 20.0) for frame in frames]
    assert blue[0] < 0.01
    assert blue[1] < blue[2] < blue[3]
    assert blue[3] > 0.1
