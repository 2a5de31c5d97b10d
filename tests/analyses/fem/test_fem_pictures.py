"""Pictures of bodies cut open: what is mirrored, cut, kept and coloured is what the geometry and the fields say."""

import dataclasses
from types import SimpleNamespace

import numpy as np
import pytest

from strikewave import load_case
from strikewave.analyses.fem import report as fem_fields
from strikewave.analyses.fem.build import build_model
from strikewave.analyses.fem.figures import cut as fem_cut
from strikewave.analyses.fem.figures.pictures import frame_window
from strikewave.analyses.fem.report import fields_section
from strikewave.analyses.fem.result import place_words
from strikewave.analyses.fem.run import run_fem
from strikewave.fem.mesh import joined
from strikewave.fem.model import SurfaceContact
from strikewave.fem.snapshots import WAVE_INSTANTS, Snapshot, SnapshotRecorder, faces_on, recorder_from_frames, skin_of

from ...fem import synthetic

BAR = {"diameter": 12e-3, "length": 180e-3}


@pytest.fixture(scope="module")
def bars():
    return build_model(load_case("two-bars-fem", ["mesh.part.striker.size=2 mm", "mesh.part.bar.size=2 mm"]))


@pytest.fixture(scope="module")
def ball():
    return synthetic.model()


def areas(skin, points=None):
    corners = (skin.points if points is None else points)[skin.faces]
    return 0.5 * np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])


def still(skin, stress, time=0.0, strain=0.0):
    cells = np.broadcast_to(np.asarray(stress, np.float32), (len(skin.elements), 6))
    return Snapshot(
        time,
        np.zeros((len(skin.nodes), 3), np.float32),
        np.array(cells),
        np.full(len(skin.elements), strain, np.float32),
    )


# the film


def test_a_run_is_filmed_from_first_touch_on(bars):
    solution = run_fem(load_case("two-bars-fem", ["mesh.part.striker.size=3 mm", "mesh.part.bar.size=3 mm"]))
    film = solution.film
    assert film.touched == 0.0
    assert len(film.wave) == WAVE_INSTANTS
    assert film.snapshots[-1].time == pytest.approx(60e-6, rel=1e-9)
    skin = film.skin
    for one in film.wave[:6]:  # ahead of the fastest wave nothing is loaded: c_p = 1.16 c_0 at nu = 0.3
        middle = solution.model.mesh.points[solution.model.mesh.hexahedra[skin.elements]].mean(axis=1)
        ahead = middle[:, 2] > 0.06 + 1.16 * 0.12 * one.time / film.transit + 9e-3  # three elements
        stress = np.abs(fem_cut.axial_stress(skin, one))
        assert stress.max() > 20e6
        assert not ahead.any() or stress[ahead].max() < 0.05 * stress.max()
    words = " ".join(part.caption for part in fields_section(solution).parts)
    assert "8 instants from first touch on" in words
    (found,) = solution.contacts.values()
    assert (
        f"the stored instant nearest to the force peak of striker.top-bar.bottom, at {found.at * 1e6:.4g} µs" in words
    )


# the pictures


def test_stress_along_the_blow_and_pressure_on_faces_are_those_of_a_uniform_stress(ball):
    skin = skin_of(ball)
    stress = [0.0, 0.0, -250e6, 0.0, 0.0, 0.0]
    assert fem_cut.axial_stress(skin, still(skin, stress)) == pytest.approx(-250e6, rel=1e-6)
    turned = dataclasses.replace(skin, axis=np.array([0.6, 0.0, 0.8]))
    assert fem_cut.axial_stress(turned, still(skin, stress)) == pytest.approx(-250e6 * 0.64, rel=1e-6)
    found = fem_cut.pressures(skin, still(skin, stress))
    top = skin.touching == 1  # block.top
    assert found[top] == pytest.approx(250e6, rel=1e-6)
    assert (found[skin.touching < 0] == 0.0).all()


def test_shear_counts_in_stress_along_a_slanted_blow_and_in_pressure_on_slanted_faces(ball):
    """a . sigma a and -n . sigma n with the whole tensor, on the round side of a ball."""
    skin = skin_of(ball)
    xx, yy, zz, xy, yz, zx = stress = np.array([10e6, -70e6, 30e6, 110e6, -50e6, 80e6])
    tensor = np.array([[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]])
    for axis in (np.array([0.6, 0.0, 0.8]), np.array([2.0, -1.0, 2.0]) / 3.0, np.array([0.0, 0.28, 0.96])):
        turned = dataclasses.replace(skin, axis=axis)
        assert fem_cut.axial_stress(turned, still(skin, stress)) == pytest.approx(axis @ tensor @ axis, rel=1e-6)
    round_side = skin.touching == 0
    normal = areas(skin)[round_side]
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    expected = np.maximum(-np.einsum("fi,ij,fj->f", normal, tensor, normal), 0.0)
    assert (expected > 0.0).sum() > 20
    assert fem_cut.pressures(skin, still(skin, stress))[round_side] == pytest.approx(expected, rel=1e-5, abs=1.0)


@pytest.mark.parametrize(("across", "length"), [(40.0, 10.0), (90.0, 20.0), (2.2, 0.5)])
def test_the_bar_of_scale_is_as_long_as_it_says(across, length):
    from matplotlib.figure import Figure

    axes = Figure().add_subplot()
    frame_window(axes, (-0.5 * across, 0.5 * across, 0.0, across))
    (line,) = axes.lines
    assert np.ptp(line.get_xdata()) == pytest.approx(length, rel=1e-12)
    assert [text.get_text() for text in axes.texts] == [f"{length:g} mm"]


def test_all_instants_share_one_scale_whose_middle_is_zero(bars):
    skin = skin_of(bars)
    low, high = still(skin, [0, 0, -40e6, 0, 0, 0], 1e-6), still(skin, [0, 0, 80e6, 0, 0, 0], 2e-6)
    figure = fem_cut.wave_figure(skin, [low, high])
    *panels, bar = figure.axes
    assert bar.get_ylim() == (-80.0, 80.0)
    from matplotlib import colormaps

    for axes, share in zip(panels, (0.25, 1.0), strict=True):
        colours = axes.collections[0].get_facecolor()[:, :3]
        flat = colours[np.abs(colours - 0.13).max(axis=1) > 1e-9]  # but the outlines
        assert flat.max(axis=0) == pytest.approx(colormaps["RdBu_r"](share)[:3], abs=0.01)  # a byte of 256 levels
    assert {axes.get_xlim() for axes in panels} == {panels[0].get_xlim()}
    assert [axes.get_title(loc="left") for axes in panels] == ["1 µs", "2 µs"]


def test_the_scale_covers_the_loaded_surface_not_a_single_element(bars):
    skin = skin_of(bars)
    values = np.full(len(skin.faces), 10.0)
    values[0] = 5000.0
    scale, extend = fem_cut.colour_scale(skin, [values], fem_cut.QUANTITIES["von_mises"])
    assert (scale.norm.vmin, scale.norm.vmax) == (0.0, 10.0)
    assert extend == "max"
    nothing, extend = fem_cut.colour_scale(skin, [0.0 * values], fem_cut.QUANTITIES["axial_stress"])
    assert (nothing.norm.vmin, nothing.norm.vmax, extend) == (-1.0, 1.0, "neither")


def test_the_close_up_stands_where_the_pressure_is_and_on_the_mirror(bars):
    skin = skin_of(bars)
    pressed = still(skin, [0, 0, -40e6, 0, 0, 0], 5e-6)
    (meeting,) = bars.touching.values()
    own = faces_on(skin, bars.mesh, meeting)
    assert np.array_equal(own, skin.touching >= 0)
    others = [still(skin, [0, 0, 1e6, 0, 0, 0], 4e-6), still(skin, [0, 0, -900e6, 0, 0, 0], 9e-6)]
    found, zone = fem_cut.pressed_most(skin, [*others, pressed], 4.4e-6, own)
    assert found is pressed  # nearest to the peak of the force of those where anything presses
    x, _, z = zone.middle(skin, pressed)
    assert x == pytest.approx(0.0, abs=1e-12)
    assert z == pytest.approx(0.06, rel=1e-9)
    figure = fem_cut.close_up_figure(skin, zone, [(pressed, "von_mises"), (pressed, "plastic_strain")])
    axes = figure.axes[0]
    assert np.ptp(axes.get_xlim()) == pytest.approx(2e3 * zone.reach, rel=1e-9)
    assert axes.get_xlim()[0] <= -6.0 <= 6.0 <= axes.get_xlim()[1]  # all that is pressed
    assert fem_cut.pressed_most(skin, others[:1], 4e-6, own) is None
    assert fem_cut.pressed_most(skin, [pressed], 5e-6, np.zeros(len(skin.faces), bool)) is None


def test_the_instant_of_the_pictures_is_that_of_the_force_of_the_blow_not_of_the_largest_sum_of_pressures():
    """A third body presses the block from below, most at first: neither its pressure nor that of the blow decides."""
    mesh = joined([synthetic.mesh(), synthetic.grid("floor", (-0.02, -0.02, -0.02), (0.02, 0.02, -0.01), (20, 20, 2))])
    model = dataclasses.replace(
        synthetic.model(synthetic.mesh()),
        mesh=mesh,
        contacts=(SurfaceContact("ball.all", "block.top"), SurfaceContact("block.bottom", "floor.top")),
        solids={**synthetic.model().solids, "floor": synthetic.model().solids["block"]},
    )
    skin = skin_of(model)
    floor = mesh.part[skin.elements] == mesh.names.index("floor")
    stills = []
    for time, blow in ((10e-6, -50e6), (20e-6, -90e6), (30e-6, -10e6)):
        one = still(skin, [0, 0, blow, 0, 0, 0], time)
        one.stress[floor] = [0, 0, -1e15 * (40e-6 - time), 0, 0, 0]
        stills.append(one)
    run = synthetic.run(synthetic.mesh())  # whose half-sine of force on the ball peaks in the middle
    film = SnapshotRecorder(skin, 1e-5)
    film.whole.kept = stills
    snapshot, zone, _ = fem_fields._pressed(SimpleNamespace(model=model, run=run), film)
    assert snapshot.time == 0.5 * synthetic.DURATION
    on_floor = mesh.part[skin.elements[skin.element[zone.faces]]] == mesh.names.index("floor")
    assert not on_floor.any()


def test_the_largest_values_are_named_with_their_place_even_where_no_picture_shows_them(ball):
    """The last element before the plane of the cut is left out of all pictures."""
    frames, skin = synthetic.frames(ball.mesh, 5), skin_of(ball)
    middle = ball.mesh.points[ball.mesh.hexahedra].mean(axis=1)
    hidden = int(np.argmin(np.where(ball.mesh.part == ball.mesh.names.index("block"), middle[:, 1], np.inf)))
    assert hidden not in skin.elements
    frames[-1].plastic_strain[hidden] = 0.75
    frames[2].stress[hidden] = [0, 0, -7e9, 0, 0, 0]
    film = recorder_from_frames(ball, frames)
    assert film.largest["plastic_strain"] == (0.75, frames[-1].time, hidden)
    assert film.largest["von_mises"] == (pytest.approx(7e9), frames[2].time, hidden)
    place = ", ".join(f"{x * 1e3:.4g}" for x in middle[hidden])
    assert place_words(ball.mesh, hidden) == f"block at ({place}) mm"
    shown = SimpleNamespace(film=film, model=ball, run=synthetic.run(ball.mesh), frames=frames)
    section = fields_section(shown)
    assert f"von Mises stress 7000 MPa in block at ({place}) mm" in section.text
    (close,) = [part for part in section.parts if part.caption.startswith("Where bodies touch")]
    assert (
        f"The largest plastic strain of all, 0.75, is not in this view: it is in block at ({place}) mm" in close.caption
    )


def test_slender_bodies_lie_down_and_rows_fit_the_page(bars, ball):
    skin = skin_of(bars)
    lying = fem_cut.sight(skin, [still(skin, np.zeros(6))], fem_cut.TILT)
    assert lying[0] == pytest.approx([0.0, 0.0, 1.0], abs=1e-12)
    upright = fem_cut.sight(skin_of(ball), [still(skin_of(ball), np.zeros(6))], 0.0)
    assert upright == pytest.approx(np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]]), abs=1e-12)
    row = fem_cut.wave_figure(skin, [still(skin, np.zeros(6), k * 1e-6) for k in range(8)])
    assert row.get_size_inches()[0] < 10.0
    assert row.get_size_inches()[1] < 8.0
