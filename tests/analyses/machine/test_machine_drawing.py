"""The drawing of the rotary machine: its geometry is that of the strike, its numbers are those of the case."""

import dataclasses
import itertools
import math

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg

from strikewave import load_case
from strikewave.analyses.machine.figures import geometry as machine_geometry
from strikewave.analyses.machine.figures.drawing import machine_drawings, machine_parts, scale_words, view
from strikewave.analyses.machine.figures.geometry import (
    DISC,
    NOSE,
    Pose,
    StrikeGeometry,
    at_rest,
    outlines,
    placed,
    stretched,
    strike_geometry,
)
from strikewave.analyses.machine.kinds.falling_ball import FallingBall
from strikewave.analyses.machine.report import _drawing, report

CAM = StrikeGeometry(radius=0.2, strikers=4, engagement=5.5e-3, nose_radius=0.01)
TANGENTIAL = dataclasses.replace(CAM, blow_angle=0.5 * math.pi, face_width=0.04)
OBLIQUE = dataclasses.replace(CAM, blow_angle=0.25 * math.pi, face_width=0.04)


def texts(figures):
    return [text.get_text() for figure in figures for axes in figure.axes for text in axes.texts]


def test_a_nose_touches_the_face_at_the_angle_of_a_cam():
    """arccos(1 - q/R) before the apex; the equation is that of docs/machines.md, not of the drawing."""
    angle = -math.acos(1.0 - CAM.engagement / CAM.radius)
    assert CAM.touch_angle() == pytest.approx(angle, rel=1e-12)
    assert CAM.approach(76.4) == pytest.approx(
        76.4 * math.sqrt(2.0 * CAM.radius * CAM.engagement - CAM.engagement**2), rel=1e-12
    )


@pytest.mark.parametrize("geometry", [CAM, OBLIQUE, TANGENTIAL], ids=["cam", "oblique", "tangential"])
def test_at_first_touch_the_drawn_nose_is_tangent_to_the_drawn_face(geometry):
    """The largest x of the nose's outline is the face, and no other nose reaches further at that moment."""
    assert geometry.reach - geometry.engagement == pytest.approx(
        geometry.noses(geometry.touch_angle())[0, 0] + geometry.nose_radius, abs=1e-15
    )
    before = geometry.noses(geometry.touch_angle() - 1e-6)[0, 0]
    assert before < geometry.noses(geometry.touch_angle())[0, 0]


@pytest.mark.parametrize(
    ("changes", "angle"),
    [
        ([], 0.0),
        (["machine.blow_angle=45 deg", "machine.face_width=60 mm"], 45.0),
        (["machine.blow_angle=90 deg", "machine.face_width=60 mm"], 90.0),
    ],
)
def test_the_outlines_of_a_case_meet_at_first_touch(changes, angle):
    """Corners on a circle of 36 points that has one at x: within rounding, the outline of the nose ends on the face."""
    made = outlines(load_case("li-ma-2019", changes))
    geometry = made.geometry
    assert math.degrees(geometry.blow_angle) == pytest.approx(angle)
    pose = at_rest(geometry, geometry.touch_angle())
    noses = [placed(s, pose, geometry.blow_angle) for s in made.shapes if s.look == "nose"]
    (face,) = (placed(s, pose, geometry.blow_angle) for s in made.shapes if s.look == "face")
    assert len(noses) == 4
    # a polygon of 36 corners turned by any angle ends up to r (1 - cos 5 deg) short of its circle
    short = geometry.nose_radius * (1.0 - math.cos(math.pi / 36))
    assert -1e-12 <= face[0, 0] - noses[0][:, 0].max() <= short
    centre = noses[0].mean(axis=0)
    assert face[:, 1].min() <= centre[1] <= face[:, 1].max()
    assert centre == pytest.approx(geometry.noses(geometry.touch_angle())[0], abs=1e-12)


def test_a_face_that_has_gone_back_is_met_later_and_one_out_of_reach_never():
    angles = [CAM.touch_angle(displacement) for displacement in (0.0, 2e-3, 5e-3, CAM.engagement)]
    assert all(a < b for a, b in itertools.pairwise(angles))
    assert angles[-1] == pytest.approx(0.0, abs=1e-7)  # arccos has an infinite slope there: half the digits
    assert math.isnan(CAM.touch_angle(CAM.engagement + 1e-6))


def test_strikers_stand_at_equal_angles_unless_the_case_says_otherwise():
    turned = np.unwrap(np.arctan2(*CAM.noses(0.3).T[::-1]))
    assert np.diff(turned) == pytest.approx(-0.5 * math.pi)
    own = dataclasses.replace(CAM, errors=((0.0, 0.0), (0.01, 1e-3), (0.0, 0.0), (0.0, 0.0)))
    moved = own.noses(0.3)[1]
    assert math.hypot(*moved) == pytest.approx(0.201)
    assert math.atan2(moved[1], moved[0]) == pytest.approx(0.3 - 0.5 * math.pi + 0.01)


def test_parts_move_with_what_carries_them():
    made = outlines(load_case("li-ma-2019"))
    pose = Pose(0.4, 1e-3, 2e-3, 3e-3)
    for shape in made.shapes:
        moved = placed(shape, pose, 0.0) - shape.points
        if shape.group == DISC:
            turn = np.array([[math.cos(0.4), math.sin(0.4)], [-math.sin(0.4), math.cos(0.4)]])
            assert placed(shape, pose, 0.0) == pytest.approx(shape.points @ turn, abs=1e-12)
        else:
            assert moved[:, 0] == pytest.approx(pose.shift(shape.group), abs=1e-12)
            assert not moved[:, 1].any()
    for connection in made.connections:
        line = stretched(connection, pose)[-1]
        ends = [at + pose.shift(group) for at, group in zip(connection.ends, connection.groups, strict=True)]
        assert line[:, 0].min() >= ends[0] - 1e-12
        assert line[-1, 0] <= ends[1] + 1e-12


def test_the_layers_of_a_stack_are_to_scale_and_move_as_nose_or_assembly():
    case = load_case("li-ma-2019-fig5")
    made = outlines(case)
    bodies = [shape for shape in made.shapes if shape.look.startswith("body") and np.ptp(shape.points[:, 0]) > 0.01]
    lengths = [np.ptp(shape.points[:, 0]) for shape in bodies]
    assert made.to_scale
    for layer in case.stack.layer:
        assert any(length == pytest.approx(layer.length.si) for length in lengths)
    (nose,) = (shape for shape in bodies if np.ptp(shape.points[:, 0]) == pytest.approx(10.9e-3))
    assert nose.group == NOSE
    long = load_case("li-ma-2019-fig5", ["stack.layer.specimen.length=2 m"])
    assert not outlines(long).to_scale
    assert any("Not to scale" in words and "layers" in words for words in scale_words(long, outlines(long)))


@pytest.mark.parametrize("name", ["li-ma-2019", "li-ma-2019-fig5"])
def test_every_number_of_the_list_is_the_case_s_with_its_provenance(name):
    case = load_case(name)
    held = {(f"{value.si:.4g}", value.provenance) for value in case.values().values()}
    scales = {"mm": 1e-3, "kg": 1.0, "g": 1e-3, "MN/m": 1e6, "kN/m": 1e3, "r/min": math.pi / 30, "ms": 1e-3}
    shown = [entry for part in machine_parts(case, strike_geometry(case)) for entry in part.entries]
    assert len(shown) > 20
    for entry in shown:
        if entry.provenance == "computed":
            continue
        number, _, unit = entry.shown.partition(" ")
        si = float(number) * scales.get(unit, 1.0)
        near = {
            (f"{value.si:.4g}", value.provenance)
            for value in case.values().values()
            if abs(value.si - si) <= 5e-4 * abs(si)
        }
        assert near & held, entry
        assert any(provenance == entry.provenance for _, provenance in near), entry


def test_the_drawing_writes_its_dimensions_and_the_table_all_numbers_with_their_provenance(published):
    words = texts(machine_drawings(published))
    for expected in ("R 200 mm", "q 5.502 mm", "stroke s 20 mm", "blow", "turns"):
        assert expected in words, expected
    assert any("46.6 mm" in line for line in scale_words(published, outlines(published)))  # sqrt(2 R q - q^2)
    *pictures, table = _drawing(published)
    assert len(pictures) == 2
    assert "fitted" in pictures[0].caption
    rows = {row[0]: (row[1], getattr(row[2], "text", row[2])) for row in table.rows}
    assert rows["1 turntable: speed"] == ("730 r/min", "published")
    assert rows["3 strike: engagement q"] == ("5.502 mm", "fitted")
    assert rows["3 strike: approach, nominal"] == ("3.562 m/s", "follows")
    assert rows["6 assembly with sensor"] == ("–", "–")
    numbers = {name.partition(" ")[0] for name in rows}
    assert numbers == {word for word in words if word.isdigit()}  # every balloon has its part, every part its balloon


@pytest.mark.verify
@pytest.mark.parametrize(
    "changes",
    [
        [],
        ["machine.strikers=1"],
        ["machine.strikers=2"],
        ["machine.strikers=12"],
        ["machine.strikers=100"],
        ["machine.blow_angle=45 deg", "machine.face_width=60 mm"],
        ["machine.blow_angle=90 deg", "machine.face_width=60 mm"],
        ["machine.engagement=0.01 mm"],
        ["machine.engagement=150 mm"],
        ["striker.nose_radius=3 m", "feed.stroke=5 m"],
    ],
    ids=lambda changes: ",".join(changes) or "published",
)
def test_all_words_stay_inside_the_drawing_and_off_each_other(changes):
    """Any machine that a case can describe: nothing is cut off, and no two words share a place."""
    for figure in machine_drawings(load_case("li-ma-2019", changes)):
        _inside_and_apart(figure)


def _inside_and_apart(figure):
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    renderer = canvas.get_renderer()
    boxes = [
        (text.get_text(), text.get_window_extent(renderer))
        for axes in figure.axes
        for text in [*axes.texts, axes._left_title]
        if text.get_text().strip()
    ]
    width, height = figure.bbox.width, figure.bbox.height
    for words, box in boxes:
        assert min(box.x0, box.y0) >= 0, words
        assert box.x1 <= width, words
        assert box.y1 <= height, words
    written = [(words, box) for words, box in boxes if len(words) > 2]
    for (one, a), (other, b) in itertools.combinations(written, 2):
        apart = a.x1 <= b.x0 + 1 or b.x1 <= a.x0 + 1 or a.y1 <= b.y0 + 2 or b.y1 <= a.y0 + 2
        assert apart, (one, other)


def test_a_view_does_not_distort():
    from matplotlib.figure import Figure

    figure = Figure(figsize=(4.0, 3.0))
    axes, scale = view(figure, (0.5, 0.5, 3.0, 2.0), (-1.0, 1.0, 0.0, 0.5))
    figure.canvas.draw()
    across = np.diff(axes.transData.transform([(0.0, 0.0), (1.0, 0.0)]), axis=0)[0, 0]
    up = np.diff(axes.transData.transform([(0.0, 0.0), (0.0, 1.0)]), axis=0)[0, 1]
    assert across == pytest.approx(up, rel=1e-9)
    assert across == pytest.approx(scale * figure.dpi, rel=1e-9)
    assert axes.get_xlim() == pytest.approx((-1.0, 1.0))


def test_hostile_layer_names_are_no_formula_in_the_drawing():
    """A name begins with a letter; what TeX would read must not reach a picture."""
    case = load_case("li-ma-2019-fig5")
    layers = tuple(
        layer.model_copy(update={"name": "fixture" if layer.name == "fixture" else f"{layer.name} $\\frac{{"})
        for layer in case.stack.layer
    )
    hostile = case.model_copy(update={"stack": case.stack.model_copy(update={"layer": layers})})
    *_, table = _drawing(hostile)
    assert any("$" in row[0] for row in table.rows)
    for figure in machine_drawings(hostile):
        FigureCanvasAgg(figure).draw()


@pytest.mark.verify
def test_other_cases_have_no_drawing_and_their_reports_leave_it_out(monkeypatch, solution):
    assert machine_drawings(load_case("li-ma-2019-fig13-bar")) == ()
    other = FallingBall.model_construct(kind="falling-ball")
    other = load_case("li-ma-2019").model_copy(update={"machine": other})
    assert strike_geometry(other) is None
    assert machine_drawings(other) == ()
    page = report(solution)
    assert "The machine at first touch" in page
    assert 'href="machine.html"' not in page
    monkeypatch.setattr("strikewave.analyses.machine.figures.drawing.outlines", lambda case: None)
    assert "The machine at first touch" not in report(solution)


@pytest.mark.verify
def test_the_set_up_says_how_the_nose_meets_the_face(solution):
    assert "like a cam" in report(solution)
    oblique = load_case("li-ma-2019", ["machine.blow_angle=30 deg", "machine.face_width=60 mm"])
    page = report(dataclasses.replace(solution, case=oblique))
    assert "The blow stands at 30° to the radius" in page
    assert "like a cam" not in page


def test_layers_named_as_parts_of_the_machine_keep_their_own_places():
    case = load_case("li-ma-2019-fig5")
    renamed = case.stack.layer[2].model_copy(update={"name": "stop"})
    stack = case.stack.model_copy(update={"layer": (*case.stack.layer[:2], renamed)})
    middles = outlines(case.model_copy(update={"stack": stack})).places.middles
    assert middles["stop"] == outlines(case).places.middles["stop"]
    assert middles["layer stop"] == outlines(case).places.middles["layer specimen"]


@pytest.mark.usefixtures("undrawn")
def test_the_report_links_the_animation_where_there_is_one(solution):
    assert '<a href="machine.html">' in report(solution, moving="machine.html")


def test_geometry_knows_no_case_beyond_its_numbers():
    """Oblique strikes can be drawn without a case: the module that draws takes lengths and angles."""
    assert machine_geometry.strike_geometry(load_case("li-ma-2019")).blow_angle == 0.0
    assert TANGENTIAL.touch_angle() == pytest.approx(-math.asin(5.5e-3 / 0.2), rel=1e-12)
    assert TANGENTIAL.approach(76.4) == pytest.approx(76.4 * 0.2 * math.sqrt(1.0 - (5.5e-3 / 0.2) ** 2), rel=1e-12)
