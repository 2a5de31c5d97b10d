"""Pictures and the report of an explicit run: what they show is what the numbers say, and they cope with nothing."""

import dataclasses
import importlib
import re
from types import SimpleNamespace

import matplotlib
import numpy as np
import pytest

from strikewave.analyses.fem import report as fem_page
from strikewave.analyses.fem.figures import histories as fem
from strikewave.analyses.fem.figures import pictures
from strikewave.analyses.fem.figures import pictures as fem_pictures
from strikewave.analyses.fem.figures.pictures import ZONE_FACES, Camera, beyond_scale
from strikewave.analyses.fem.report import fem_report
from strikewave.analyses.fem.result import FemSolution
from strikewave.base.errors import InputError
from strikewave.base.result import FAILED, Notice
from strikewave.cases.case import load_case
from strikewave.fem.mesh import exterior, exterior_faces, joined
from strikewave.fem.model import SurfaceContact, Symmetry
from strikewave.fem.run import FieldFrame, balance_measure, blow_axis, contact_measure, near_axis

from ...fem import synthetic

CUT = Camera(toward=(-0.35, -1.0, 0.45), cut=((0.0, 0.0, 0.0), (0.0, -1.0, 0.0)))


@pytest.fixture(scope="module")
def mesh():
    return synthetic.mesh()


@pytest.fixture(scope="module")
def run(mesh):
    return synthetic.run(mesh)


def texts(figure):
    from matplotlib.text import Text

    return [text.get_text() for text in figure.findobj(Text)]


def pixels(figure):
    """Return the picture as numbers from 0 to 1, rows from the top, and where its data stand in it."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    return np.asarray(canvas.buffer_rgba())[:, :, :3] / 255.0


# measures


def test_contact_of_a_half_sine_has_its_closed_impulse_peak_and_width(run):
    """The mean of a half-sine over an interval h is its value in the middle times sin(u)/u, u = pi h / (2 duration)."""
    found = contact_measure(run, "ball.all-block.top")
    duration, u = synthetic.DURATION, 0.5 * np.pi * synthetic.INTERVAL / synthetic.DURATION
    middle = np.cos(u)  # that of the intervals beside the top
    assert found.peak == pytest.approx(0.5 * np.pi * found.impulse / duration * middle * np.sin(u) / u, rel=1e-9)
    width = duration * (1 - 2 * np.arcsin(0.1) / np.pi)
    assert found.duration == pytest.approx(width, rel=1e-4)  # chords of the half-sine at 120 samples
    assert abs(found.at - 0.5 * duration) == pytest.approx(0.5 * synthetic.INTERVAL, rel=1e-9)


def chattering(gathered, time, way):
    return contact_measure(SimpleNamespace(time=time, impulse={"a": np.outer(gathered, way)}), "a")


def test_contact_that_chatters_lasts_from_first_to_last_and_one_that_goes_on_ends_with_the_run():
    t = np.linspace(0.0, 1.0, 1001)
    size = np.where((t % 0.2) < 0.1, 1.0, 0.0) * (t < 0.75)
    found = chattering(0.001 * size.cumsum(), t, [0.6, 0.0, 0.8])
    assert found.peak == pytest.approx(1.0, rel=1e-9)
    assert found.begin == 0.0
    assert found.end == pytest.approx(0.7, abs=0.001)
    found = chattering(0.5 * t**2, t, [1.0, 0.0, 0.0])  # a force that grows with time: peak 0.9995, in the last one
    assert found.end == 1.0
    assert found.begin == pytest.approx(0.09995, abs=1e-12)


@pytest.mark.parametrize("dt", [1e-8, 1e-7])
def test_the_mean_force_does_not_hang_on_the_step_in_which_surfaces_meet(dt):
    """A velocity taken within one step is a force of p/dt in it, and a mean of p/h over the interval h, whatever dt."""
    t, p, h = 1e-6 * np.arange(11), 2.5, 1e-6
    given = p * np.clip((t - 3e-6 - 0.5e-6) / dt + 1.0, 0.0, 1.0)
    found = chattering(given, t, [0.0, 0.0, 1.0])
    assert found.peak == pytest.approx(p / h, rel=1e-12)
    assert found.at == pytest.approx(3.5e-6, rel=1e-9)


def test_a_direction_near_an_axis_is_that_axis_and_keeps_its_sign():
    for sign in (1.0, -1.0):
        for angle, snapped in ((4.9, True), (5.1, False)):
            way = sign * np.array([np.sin(np.radians(angle)), 0.0, np.cos(np.radians(angle))])
            found = near_axis(7.0 * way)
            assert found == pytest.approx([0.0, 0.0, sign] if snapped else way, abs=1e-15)


def test_nothing_that_touches_measures_none(run):
    zero = {"a": np.zeros((run.time.size, 3))}
    still = dataclasses.replace(run, force=zero, impulse=zero)
    assert contact_measure(still, "a") is None


def test_balance_measure_finds_the_leak_and_the_hourglass_share(mesh):
    balance = balance_measure(synthetic.run(mesh, leak=-0.03, hourglass=0.02))
    assert balance.energy == pytest.approx(-0.03, rel=1e-12)
    assert balance.hourglass == pytest.approx(
        0.02 / (1 - 0.02 - 0.02), rel=0.05
    )  # contact energy and leak take a little
    assert balance.momentum < 1e-12


def test_blow_axis_follows_the_momentum(run):
    turn = np.array([0.6, 0.0, -0.8])
    turned = {
        name: dataclasses.replace(part, velocity=np.outer(part.velocity[:, 2], turn))
        for name, part in run.parts.items()
    }
    nearly = np.array([0.05, 0.0, -0.99])
    leaning = {
        name: dataclasses.replace(part, velocity=np.outer(part.velocity[:, 2], nearly))
        for name, part in run.parts.items()
    }
    assert blow_axis(run).tolist() == [0.0, 0.0, 1.0]
    assert blow_axis(dataclasses.replace(run, parts=leaning)).tolist() == [0.0, 0.0, 1.0]
    assert blow_axis(dataclasses.replace(run, parts=turned)) == pytest.approx([-0.6, 0.0, 0.8], rel=1e-12)
    assert blow_axis(dataclasses.replace(run, parts={})).tolist() == [0.0, 0.0, 1.0]


# histories


def test_force_picture_marks_peak_and_impulse(run):
    figure = fem.force_figure(run)
    found = contact_measure(run, "ball.all-block.top")
    assert f"{found.peak / 1e3:#.4g} kN" in texts(figure)
    assert any(f"{found.impulse:.3g} N s" in words for words in texts(figure))
    curve = max((line for line in figure.axes[0].lines), key=lambda line: len(line.get_xdata()))
    assert curve.get_ydata().max() * 1e3 == pytest.approx(found.peak, rel=1e-9)
    assert {axes.get_ylabel() for axes in figure.axes} == {"force, mean of 0.5 µs (kN)", "impulse, dotted (N s)"}


def test_acceleration_picture_shows_g_along_the_blow(run):
    axes = fem.acceleration_figure(run).axes[0]
    assert axes.get_ylabel() == "along z, mean of 0.5 µs (g)"
    drawn = {line.get_label(): line.get_ydata() for line in axes.lines}
    means = np.diff(run.parts["ball"].velocity[:, 2]) / synthetic.INTERVAL
    assert drawn["ball"].max() == pytest.approx(means.max() / 9.80665, rel=1e-9)
    assert drawn["block"].min() < 0.0


def test_groups_set_the_scale_lie_on_top_and_what_is_cut_off_is_said(run):
    """A shell that rings at ten times the peak of its group must not flatten it; a part within three times is whole."""
    ball = run.parts["ball"]
    rung = 10.0 * np.diff(ball.velocity, axis=0, prepend=0.0) * np.where(np.arange(run.time.size) % 2, 1, -1)[:, None]
    parts = {
        "shell": dataclasses.replace(ball, velocity=rung.cumsum(axis=0)),
        "frame": dataclasses.replace(ball, velocity=2.0 * ball.velocity),
    }
    with_group = dataclasses.replace(run, parts=parts, groups={"object": ball})
    axes = fem.acceleration_figure(with_group).axes[0]
    lines = {line.get_label(): line for line in axes.lines}
    (cut,) = [name for name in lines if name.startswith("shell")]
    peak = np.abs(lines["object"].get_ydata()).max()
    assert max(np.abs(axes.get_ylim())) < 2.5 * peak
    assert max(np.abs(axes.get_ylim())) >= np.abs(lines["frame"].get_ydata()).max()
    low, high = (float(word) for word in re.search(r"cut off: (\S+) to (\S+)\)", cut).groups())
    assert low == pytest.approx(lines[cut].get_ydata().min(), rel=0.005)
    assert high == pytest.approx(lines[cut].get_ydata().max(), rel=0.005)
    assert lines["object"].get_linewidth() > 1.5 * lines["frame"].get_linewidth()
    assert lines["object"].get_zorder() > max(lines[name].get_zorder() for name in ("frame", cut))
    many = dataclasses.replace(with_group, parts={f"p{k}": parts["shell"] for k in range(12)})
    assert "object" in {line.get_label() for line in fem.acceleration_figure(many).axes[0].lines}


def test_energy_picture_leaves_out_what_is_nothing_and_shows_the_limit_where_it_is_near(mesh, run):
    figure = fem.energy_figure(run)
    labels = {line.get_label() for line in figure.axes[0].lines}
    assert "external" not in labels
    assert {"kinetic", "internal", "plastic (in internal)"} <= labels
    assert len(figure.axes[1].lines) == 1
    assert len(fem.energy_figure(synthetic.run(mesh, leak=0.02)).axes[1].lines) == 3


def test_histories_cope_with_nothing_with_much_and_with_odd_names(run):
    empty = dataclasses.replace(run, force={}, impulse={}, points={}, sections={})
    for draw in (fem.force_figure, fem.section_figure, fem.point_figure):
        figure = draw(empty)
        pixels(figure)
        assert any(words in texts(figure) for words in ("no contact is watched", "none is watched"))
    zero = {"a-b": np.zeros((run.time.size, 3))}
    still = dataclasses.replace(run, force=zero, impulse=zero)
    assert "nothing touched" in texts(fem.force_figure(still))
    part = run.parts["ball"]
    many = {f"part $\\frac{{{k}$ " + "long " * 12: part for k in range(30)}
    figure = fem.acceleration_figure(dataclasses.replace(run, parts=many))
    pixels(figure)
    assert "8 of 30: those that reach farthest" in texts(figure)
    pixels(fem.summary_sheet(run, "a $title & <b>"))


def test_a_long_noisy_history_keeps_its_peak_and_few_points(run, rng):
    n, step = 200_000, 5e-9
    rates = rng.normal(size=(n, 3))
    rates[123_457, 2] = 99.0
    velocity = np.concatenate([np.zeros((1, 3)), step * rates.cumsum(axis=0)])
    part = dataclasses.replace(run.parts["ball"], velocity=velocity)
    long = dataclasses.replace(run, time=step * np.arange(n + 1), parts={"ball": part})
    line = fem.acceleration_figure(long).axes[0].lines[0]
    assert line.get_ydata().size < 3000
    axis = blow_axis(long)
    assert line.get_ydata().max() == pytest.approx(float((rates @ axis).max()) / 9.80665, rel=1e-9)


# pictures in space


def nearest_faces(mesh, view, places):
    """Return which exterior face of the kept elements a ray at each place (n, 2; mm) meets first: by brute force."""
    kept = fem_pictures.kept_elements(mesh, view)
    faces, element = exterior(mesh.hexahedra[kept])
    corners = (mesh.points[faces] @ view.axes().T) * [1e3, 1e3, 1.0]
    found, depth = np.full(len(places), -1), np.full(len(places), -np.inf)
    for k, quad in enumerate(corners):
        for a, b, c in (quad[[0, 1, 2]], quad[[0, 2, 3]]):
            sides = np.column_stack([b[:2] - a[:2], c[:2] - a[:2]])
            if abs(np.linalg.det(sides)) < 1e-12:
                continue
            s, t = np.linalg.solve(sides, (places - a[:2]).T)
            z = a[2] + s * (b[2] - a[2]) + t * (c[2] - a[2])
            nearer = (s >= 0) & (t >= 0) & (s + t <= 1) & (z > depth)
            found[nearer], depth[nearer] = k, z[nearer]
    return found, faces, np.flatnonzero(kept)[element]


@pytest.mark.parametrize("turned", [(-0.35, -1.0, 0.45), (1.0, 0.3, 0.2), (0.2, 0.5, 1.5)])
def test_each_pixel_shows_the_face_that_a_ray_meets_first(monkeypatch, rng, turned):
    monkeypatch.setattr(pictures, "SMALLEST_LINED", np.inf)  # no mesh lines
    post = synthetic.grid("post", (-0.014, -0.013, 0.001), (-0.012, 0.013, 0.02), (1, 1, 1))  # long faces beside small
    plate = synthetic.grid("plate", (-0.02, -0.02, -0.003), (0.02, 0.02, 0.0), (2, 2, 1))
    mesh = joined([synthetic.ball("ball", (0.0, 0.0, 0.0075), 0.006, 6), post, plate])
    frame = synthetic.frame(synthetic.mesh(), 0.0)
    values = rng.permutation(len(mesh.hexahedra)).astype(float)
    still = np.zeros_like(mesh.points)
    frame = dataclasses.replace(
        frame, displacement=still, velocity=still, stress=np.zeros((len(values), 6)), plastic_strain=values
    )
    view = Camera(toward=turned)
    figure = fem_pictures.body_picture(mesh, frame, view, "plastic_strain")
    image, axes = pixels(figure), figure.axes[0]
    (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
    centres = np.column_stack([rng.uniform(left, right, 700), rng.uniform(low, high, 700)])
    pixel = (right - left) / axes.get_window_extent().width
    around = [nearest_faces(mesh, view, centres + 2.0 * pixel * (np.array(d) - 1.0)) for d in np.ndindex(3, 3)]
    found, faces, element = nearest_faces(mesh, view, centres)
    inner = np.all([other == found for other, _, _ in around], axis=0) & (found >= 0)
    assert inner.sum() > 150
    mappable = axes.collections[0]
    corners = mesh.points[faces] @ view.axes().T
    normal = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
    shade = 0.78 + 0.22 * normal[:, 2] / np.linalg.norm(normal, axis=1)
    assert mappable.get_rasterized()
    share = values / values.max()
    colours = matplotlib.colormaps["viridis"](share)[element, :3] * shade[:, None]
    x, y = axes.transData.transform(centres[inner]).T
    drawn = image[image.shape[0] - 1 - y.astype(int), x.astype(int)]
    off = np.abs(drawn - colours[found[inner]]).max(axis=1)
    assert (off < 2.5 / 255).all()  # rounding of colours to a byte, twice


def test_faces_are_those_of_the_mesh_with_their_elements(mesh):
    faces, element = exterior(mesh.hexahedra)
    assert np.array_equal(np.sort(faces.ravel()), np.sort(exterior_faces(mesh.hexahedra).ravel()))
    assert all(set(face) <= set(mesh.hexahedra[k]) for face, k in zip(faces, element, strict=True))


def test_a_cut_leaves_the_elements_behind_its_plane_and_a_zone_those_near(mesh):
    middle = mesh.points[mesh.hexahedra].mean(axis=1)
    assert np.array_equal(fem_pictures.kept_elements(mesh, CUT), middle[:, 1] >= 0.0)
    near = fem_pictures.kept_elements(mesh, Camera(near=((0.0, 0.0, 0.0), 0.004)))
    assert np.array_equal(near, np.linalg.norm(middle, axis=1) <= 0.004)
    one = fem_pictures.kept_elements(mesh, Camera(parts=("ball",)))
    assert one.sum() == 216
    with pytest.raises(InputError, match="leave elements"):
        fem_pictures.kept_elements(mesh, Camera(near=((1.0, 0.0, 0.0), 0.001)))
    with pytest.raises(InputError, match='did you mean "ball"'):
        fem_pictures.kept_elements(mesh, Camera(parts=("bal",)))


def test_a_sequence_has_one_scale_and_says_its_unit(mesh):
    frames = synthetic.frames(mesh, 4)
    figure = fem_pictures.frames_picture(mesh, frames, CUT)
    bar = figure.axes[-1]
    assert bar.get_ylabel() == "von Mises stress (MPa)"
    kept = fem_pictures.kept_elements(mesh, CUT)
    from strikewave.fem.solids import von_mises

    highest = max(von_mises(frame.stress)[kept].max() for frame in frames) / 1e6
    assert bar.get_ylim() == pytest.approx((0.0, highest), rel=1e-12)
    windows = {(axes.get_xlim(), axes.get_ylim()) for axes in figure.axes if axes.collections and axes is not bar}
    assert len(windows) == 1
    assert "20 µs" in texts(figure)
    warped = fem_pictures.body_picture(mesh, frames[1], dataclasses.replace(CUT, warp=20.0))
    assert "20 µs, displacements × 20" in texts(warped)


def test_given_limits_hold_and_the_bar_says_that_values_lie_beyond(mesh):
    frame = synthetic.frames(mesh, 3)[1]
    figure = fem_pictures.body_picture(mesh, frame, dataclasses.replace(CUT, limits=(0.0, 100e6)))
    assert figure.axes[-1].get_ylim() == (0.0, 100.0)
    assert beyond_scale([np.array([50.0, 150.0])], _scale_of(0.0, 100.0)) == "max"
    assert beyond_scale([np.array([-1.0, 150.0])], _scale_of(0.0, 100.0)) == "both"
    assert beyond_scale([np.array([0.0, 100.0])], _scale_of(0.0, 100.0)) == "neither"


def _scale_of(low, high):
    return SimpleNamespace(norm=SimpleNamespace(vmin=low, vmax=high))


@pytest.mark.verify
@pytest.mark.parametrize("quantity", sorted(fem_pictures.QUANTITIES))
def test_every_field_can_be_shown_even_where_it_is_nothing(mesh, quantity):
    for frame in synthetic.frames(mesh, 2):
        image = pixels(fem_pictures.body_picture(mesh, frame, CUT, quantity))
        assert np.isfinite(image).all()
        assert (image.min(axis=2) < 0.9).mean() > 0.05


def test_wrong_wishes_are_told(mesh):
    frame = synthetic.frame(mesh, 1e-5)
    with pytest.raises(InputError, match='did you mean "von_mises"'):
        fem_pictures.body_picture(mesh, frame, CUT, "von_mise")
    with pytest.raises(InputError, match="a direction other than up"):
        fem_pictures.body_picture(mesh, frame, Camera(toward=(0.0, 0.0, 1.0)))
    with pytest.raises(InputError, match="at least one"):
        fem_pictures.frames_picture(mesh, [], CUT)


def test_fifty_thousand_faces_are_drawn():
    mesh = synthetic.grid("plate", (0, 0, 0), (0.1, 0.1, 0.002), (156, 156, 1))
    assert len(exterior_faces(mesh.hexahedra)) > 49_000
    cells, nodes = len(mesh.hexahedra), len(mesh.points)
    frame = FieldFrame(0.0, np.zeros((nodes, 3)), np.zeros((nodes, 3)), np.ones((cells, 6)), np.arange(cells))
    drawn = pixels(fem_pictures.body_picture(mesh, frame, Camera(), "plastic_strain"))
    assert drawn.std() > 0.0


def test_the_view_of_a_model_looks_onto_its_symmetry_or_cuts_along_its_blow(mesh):
    whole = fem_pictures.view_of(synthetic.model(mesh))
    assert whole.cut is not None
    assert whole.cut[1][2] == 0.0  # the plane holds the axis of the blow
    assert np.dot(whole.cut[1], whole.toward) > 0.0
    half = dataclasses.replace(synthetic.model(mesh), boundaries=(Symmetry("block.bottom"),))
    seen = fem_pictures.view_of(half)
    assert seen.cut is None
    assert np.dot(seen.toward, (0.0, 0.0, -1.0)) > 0.0
    seen.axes()


def test_the_zone_of_a_contact_is_where_its_sides_are_nearest(mesh):
    place, radius = fem_pictures.contact_zone(synthetic.model(mesh))
    assert place == pytest.approx((0.0, 0.0, 0.0), abs=1e-12)
    assert radius == pytest.approx(0.006, rel=1e-9)  # the ball's: its faces are large
    plates = [
        synthetic.grid(name, (0, 0, z), (0.05, 0.05, z + 0.001), (50, 50, 1)) for name, z in (("a", 0), ("b", 1e-3))
    ]
    touching = dataclasses.replace(synthetic.model(joined(plates)), contacts=(SurfaceContact("a.top", "b.bottom"),))
    place, radius = fem_pictures.contact_zone(touching)
    assert place == pytest.approx((0.025, 0.025, 0.001), rel=1e-9)
    assert radius == pytest.approx(ZONE_FACES * 0.001, rel=1e-9)
    assert fem_pictures.contact_zone(dataclasses.replace(synthetic.model(mesh), contacts=())) is None


def wedge(name):
    """One element whose corners lie beyond the middle of its extent but for one: a cut there leaves nothing of it."""
    one = synthetic.grid(name, (0, 0, 0), (0.01, 0.01, 0.01), (1, 1, 1))
    points = one.points + np.where(one.points[:, 1:2] == 0.0, [[0.0, 0.008, 0.0]], 0.0)
    points[0, 1] = 0.0
    return dataclasses.replace(one, points=points)


@pytest.mark.parametrize(
    "parts",
    [
        [synthetic.grid(*box, (1, 1, 1)) for box in (("a", (0, 0, 0), (0.01, 0.01, 1.0)), ("b", (0, 0, 1), (1, 1, 2)))],
        [synthetic.grid("a", (0, 0, -3), (0.1, 0.1, 0), (1, 1, 1)), synthetic.ball("b", (0.05, 0.05, 0.2), 0.2, 2)],
        [synthetic.grid("a", (0, 0, 0), (0.006, 0.006, 0.06), (1, 1, 10)), wedge("b")],
        [wedge("a"), wedge("b")],
    ],
)
def test_the_automatic_views_show_both_bodies_of_meshes_as_coarse_as_one_element(parts):
    sides = (f"a.{'top' if 'a.top' in parts[0].sides else 'all'}", f"b.{'all' if 'b.all' in parts[1].sides else 'top'}")
    model = dataclasses.replace(synthetic.model(joined(parts)), contacts=(SurfaceContact(*sides),), velocity={})
    view = fem_pictures.view_of(model)
    seen = fem_pictures.kept_elements(model.mesh, view)
    near = dataclasses.replace(view, near=fem_pictures.contact_zone(model, view))
    zone = fem_pictures.kept_elements(model.mesh, near)
    assert set(model.mesh.part[zone]) == set(model.mesh.part[seen])
    pixels(fem_pictures.mesh_picture(model.mesh, near))


@pytest.mark.verify
def test_pyvista_shows_the_same_and_its_absence_is_told(mesh, monkeypatch):
    frame = synthetic.frame(mesh, 3e-5)

    def absent(name):
        raise ImportError(name)

    with monkeypatch.context() as without:
        without.setattr(importlib, "import_module", absent)
        with pytest.raises(InputError, match=r"pip install 'strikewave\[mesh\]'"):
            fem_pictures.scene(mesh, frame, CUT)
    pytest.importorskip("pyvista", reason="pyvista is not installed")
    try:
        image = fem_pictures.scene(mesh, frame, CUT)
    except InputError as error:
        pytest.skip(str(error))
    assert image.ndim == 3
    assert (image.min(axis=2) < 230).mean() > 0.1  # the parts are there
    assert (image.min(axis=2) > 250).mean() > 0.3  # and so is the white around them


# the report


def solution(mesh, run, **more):
    title = "A ball on <b>brass</b> & steel <script>alert(1)</script>"
    case = load_case("two-bars-fem").model_copy(update={"title": title, "mesh": None, "published": ()})
    held = {
        "case": case,
        "run": run,
        "model": synthetic.model(mesh),
        "notices": (),
        "frames": synthetic.frames(mesh, 5),
        "citations": ("johnson-1985",),
    }
    return FemSolution(**{**held, **more})


@pytest.mark.verify
def test_the_report_stands_alone_and_says_the_numbers(mesh, run):
    page = fem_report(solution(mesh, run))
    assert len(page.encode()) < 3e6
    assert "<script" not in page
    assert "http-equiv" in page
    assert not any(f'{word}="http' in page for word in ("src", "xlink:href"))
    assert "A ball on &lt;b&gt;brass&lt;/b&gt; &amp; steel" in page
    found = contact_measure(run, "ball.all-block.top")
    for words in (f"{found.peak / 1e3:.4g}", f"{found.impulse:.4g}", "all checks passed", "within its limit of 1 %"):
        assert words in page
    assert f"{run.parts['ball'].mass * 1e3:.4g}" in page
    assert "bilinear" in page
    assert "K. L. Johnson" in page
    assert page == fem_report(solution(mesh, run))


@pytest.mark.verify
def test_the_report_says_what_is_broken(mesh):
    page = fem_report(
        solution(
            mesh,
            dataclasses.replace(synthetic.run(mesh, leak=-0.04, hourglass=0.2), stopped="an element turned inside out"),
            notices=(Notice("energy-balance", "energy is <missing>", 0.04, 0.01, severity=FAILED),),
        )
    )
    for words in (
        "stopped early; check failed: energy-balance",
        "The run ended early: an element turned inside out.",
        "The energy balance error is -4 %, beyond its limit of 1 %",
        "of the internal energy, beyond 5 %",
        "energy is &lt;missing&gt;",
        "broken",
    ):
        assert words in page


def test_the_status_names_each_broken_limit_once_with_its_blows(mesh, run):
    def broken(code, message):
        return Notice(code, message, 1.0, 0.1, severity=FAILED)

    many = (broken("hourglass-energy", "h"), broken("hourglass-energy", "blow 2: h"), broken("stopped", "blow 2: s"))
    held = solution(mesh, run, notices=many)
    assert fem_page._status(held).text == "checks failed: hourglass-energy, stopped"
    held = dataclasses.replace(held, later=(run,))
    assert fem_page._status(held).text == "checks failed: hourglass-energy (blows 1 and 2), stopped (blow 2)"


@pytest.mark.verify
def test_the_report_copes_with_no_contact_no_frames_and_no_motion(mesh, run):
    zero = np.zeros((run.time.size, 3))
    parts = {name: dataclasses.replace(p, velocity=zero, acceleration=zero) for name, p in run.parts.items()}
    energy = {name: np.zeros(run.time.size) for name in run.energy}
    still = dataclasses.replace(
        run, force={}, impulse={}, parts=parts, points={}, sections={}, energy=energy, initial_energy=0.0, momentum=zero
    )
    page = fem_report(solution(mesh, still, model=dataclasses.replace(synthetic.model(mesh), contacts=()), frames=()))
    for words in ("No contact is in the model.", "No frame of the fields was kept", "does not move", "nothing moves"):
        assert words in page
    assert not re.search(r"\bnan\b", re.sub(r'"data:[^"]*"', "", page))
