"""What of a model is seen: bodies cut open and mirrored, and the film of a run, against geometry by hand."""

import dataclasses
from types import SimpleNamespace

import numpy as np
import pytest

from strikewave.fem.mesh import Mesh, joined, volumes
from strikewave.fem.model import Controls, Driven, Fixed, Model, RigidWall, SurfaceContact, Symmetry, TimeCurve
from strikewave.fem.shapes import block, cylinder, moved
from strikewave.fem.snapshots import (
    PER_TRANSIT,
    WAVE_INSTANTS,
    Cut,
    Plane,
    SnapshotRecorder,
    Thinned,
    blow_axis,
    blow_contact,
    cut_of,
    faces_on,
    meeting_place,
    outward,
    recorder_from_frames,
    skin_of,
    snapshot_recorder,
    symmetry_planes,
    transit_time,
)
from strikewave.fem.solids import Elastic

from . import synthetic
from .bodies import STEEL

BAR = {"diameter": 12e-3, "length": 180e-3}
BRASS = Elastic(8500.0, 100e9, 0.35)


@pytest.fixture(scope="module")
def bars():
    """A quarter of a bar of 60 mm that strikes one of 120 mm."""
    striker, bar = (
        cylinder(name, BAR["diameter"], length, 3e-3, 6e-3, "quarter")
        for name, length in (("striker", 0.06), ("bar", 0.12))
    )
    return Model(
        joined([striker, moved(bar, (0.0, 0.0, 0.06))]),
        {"striker": STEEL, "bar": BRASS},
        Controls(60e-6),
        velocity={"striker": (0.0, 0.0, 10.0)},
        boundaries=tuple(Symmetry(f"{part}.{side}") for part in ("striker", "bar") for side in ("x-", "y-")),
        contacts=(SurfaceContact("striker.top", "bar.bottom"),),
    )


@pytest.fixture(scope="module")
def ball():
    return synthetic.model()


def areas(skin):
    corners = skin.points[skin.faces]
    return 0.5 * np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])


def enclosed(skin):
    """Volume by the flux of x/3 through bilinear faces, each by its four triangles about the middle."""
    corners = skin.points[skin.faces]
    middle = corners.mean(axis=1)
    sides = zip(range(4), (1, 2, 3, 0), strict=True)
    return sum(np.einsum("ij,ij->", middle, np.cross(corners[:, a], corners[:, b])) / 6.0 for a, b in sides)


# the skin


def test_a_quarter_becomes_the_half_with_a_flat_cut(bars):
    skin = skin_of(bars)
    assert skin.cut.symmetric
    quarter = float(volumes(bars.mesh.points, bars.mesh.hexahedra).sum())
    assert enclosed(skin) == pytest.approx(2.0 * quarter, rel=1e-12)
    assert np.linalg.norm(areas(skin).sum(axis=0)) < 1e-15  # closed
    normal = skin.cut.plane.normal
    on_cut = np.abs(skin.cut.plane.height(skin.points[skin.faces])).max(axis=1) < 1e-12
    assert float((areas(skin)[on_cut] @ normal).sum()) == pytest.approx(BAR["diameter"] * BAR["length"], rel=1e-12)
    inside = np.abs(skin.cut.mirror.height(skin.points[skin.faces])).max(axis=1) < 1e-12
    assert not inside.any()  # no faces where the images meet


def test_edges_have_two_faces_and_sharp_ones_are_the_outline(bars):
    skin = skin_of(bars)
    assert len(skin.edges.nodes) == 2 * len(skin.faces)  # of a closed surface of quadrilaterals
    sharp = skin.points[skin.edges.nodes[skin.edges.sharp]]
    ends = np.isclose(sharp[:, :, 2, None], [0.0, 0.06, 0.18]).any(axis=2).all(axis=1)  # rims of the two bars
    along = np.abs(np.abs(sharp[:, :, 0]) - 6e-3).max(axis=1) < 1e-9  # where the cut meets the round
    assert (ends | along).all()
    length = np.linalg.norm(sharp[:, 1] - sharp[:, 0], axis=1)
    assert length[along & ~ends].sum() == pytest.approx(2 * BAR["length"], rel=1e-9)


def test_images_move_as_mirror_images(bars, rng):
    skin = skin_of(bars)
    moved = skin.moved(rng.normal(size=(len(skin.nodes), 3)).astype(np.float32)) - skin.points
    twins = {int(node): row for row, node in enumerate(skin.node) if not skin.image[row]}
    rows = np.flatnonzero(skin.image)
    originals = np.array([twins[int(skin.node[row])] for row in rows])
    assert np.allclose(moved[rows], moved[originals] * [-1.0, 1.0, 1.0], atol=1e-12)
    assert np.allclose(skin.points[rows], skin.points[originals] * [-1.0, 1.0, 1.0], atol=1e-12)


def test_whole_bodies_are_cut_through_where_they_meet(ball):
    skin = skin_of(ball)
    assert not skin.cut.symmetric
    assert skin.cut.mirror is None
    assert skin.cut.plane.point == pytest.approx([0.0, 0.0, 0.0], abs=1e-12)
    block = skin.part == ball.mesh.names.index("block")
    corners = skin.points[skin.faces]
    on_cut = block & (np.abs(corners[:, :, 1]).max(axis=1) < 1e-12)
    assert float(np.linalg.norm(areas(skin)[on_cut], axis=1).sum()) == pytest.approx(0.03 * 0.012, rel=1e-12)
    assert corners[:, :, 1].min() > -1e-12
    half = 0.5 * float(volumes(ball.mesh.points, ball.mesh.hexahedra).sum())
    assert enclosed(skin) == pytest.approx(half, rel=1e-9)


def test_only_planes_of_symmetry_along_the_blow_that_all_is_behind_are_cuts(ball, bars):
    floor = dataclasses.replace(ball, boundaries=(Symmetry("block.bottom"), Fixed("block.top")))
    assert symmetry_planes(floor) == []  # across the blow: a floor, no cut
    aside = dataclasses.replace(
        bars.mesh, points=bars.mesh.points - [1e-3, 0.0, 0.0] * (bars.mesh.points[:, 2:] > 0.06)
    )
    assert len(symmetry_planes(dataclasses.replace(bars, mesh=aside))) == 1  # x- of one bar cuts through the other
    half = dataclasses.replace(bars, boundaries=tuple(b for b in bars.boundaries if b.side.endswith("x-")))
    found = cut_of(half)
    assert found.mirror is None
    assert found.plane.normal == pytest.approx([-1.0, 0.0, 0.0], abs=1e-12)


def test_the_contact_of_the_blow_is_that_of_bodies_at_different_speeds(ball):
    resting = SurfaceContact("block.bottom", "block.top")
    both = dataclasses.replace(ball, contacts=(resting, *ball.contacts))
    assert blow_contact(both) is ball.contacts[0]
    assert blow_contact(dataclasses.replace(both, velocity={})) is resting
    alone = dataclasses.replace(ball, contacts=(), walls=(RigidWall("ball.all", (0.0, 0.0, -0.001), (0.0, 0.0, 2.0)),))
    assert meeting_place(alone) == pytest.approx([0.0, 0.0, -0.0005], abs=1e-12)
    assert blow_contact(dataclasses.replace(ball, contacts=())) is None


def bricks(*sizes, sides=(), **more):
    """Blocks of one element each upon one another; named a, b, c."""
    parts, height = [], 0.0
    for name, size in zip("abc", sizes, strict=False):
        parts.append(moved(block(name, size, *size), (0.0, 0.0, height)))
        height += size[2]
    mesh = joined(parts)
    boundaries = tuple(map(Symmetry, sides))
    given = {"velocity": {"a": (0.0, 0.0, 3.0)}} | more
    return Model(mesh, dict.fromkeys(mesh.names, STEEL), Controls(1e-3), boundaries=boundaries, **given)


@pytest.mark.parametrize("name", ["bars", "ball"])
def test_faces_and_edges_know_their_elements_parts_and_sides(name, request):
    model = request.getfixturevalue(name)
    mesh, skin = model.mesh, skin_of(model)
    corners = skin.nodes[skin.node[skin.faces]]
    elements = mesh.hexahedra[skin.elements[skin.element]]
    assert (corners[:, :, None] == elements[:, None, :]).any(axis=2).all()
    assert np.array_equal(skin.part, mesh.part[skin.elements[skin.element]])
    for ends, faces in zip(skin.edges.nodes, skin.edges.faces, strict=True):
        assert all(set(ends) <= set(skin.faces[face]) for face in faces)
    images = skin.image[skin.faces].any(axis=1)
    assert (skin.touching[images] == -1).all()
    assert np.array_equal(skin.axis, [0.0, 0.0, 1.0 if name == "bars" else -1.0])
    (sides,) = model.touching.values()
    for number, side in enumerate(sides):
        wanted = {tuple(sorted(face)) for face in mesh.side(side)}
        own = {tuple(sorted(face)) for face in corners[(skin.touching == number) & ~images]}
        seen = {tuple(sorted(face)) for face in corners[~images]}
        assert own == wanted & seen
        assert len(own) > 3
        assert np.array_equal(faces_on(skin, mesh, [side]), skin.touching == number)


@pytest.mark.parametrize(("part", "sharp"), [((0, 0), 16), ((0, 1), 20)])
def test_edges_between_parts_are_sharp_where_they_are_flat(part, sharp):
    """Two cubes that share a face: 16 edges of the outline of 2 x 1 x 1, and the four around their common face."""
    two = block("a", (2.0, 1.0, 1.0), 1.0, 1.0, 1.0)
    mesh = Mesh(two.points, two.hexahedra, np.array(part, np.int32), ("a", "b")[: part[1] + 1])
    far = Cut(Plane(np.array([0.0, 0.0, 9.0]), np.array([0.0, 0.0, 1.0])))
    skin = skin_of(Model(mesh, dict.fromkeys(mesh.names, STEEL), Controls(1e-3)), far)
    assert (len(skin.edges.nodes), skin.edges.sharp.sum()) == (20, sharp)


@pytest.mark.parametrize(("share", "faces"), [(0.5, 10), (1.5, 12)])
def test_what_lies_a_millionth_off_the_mirror_is_on_it(share, faces):
    """A cube before its mirror at x = 0: on it both images share four nodes and lose a face each; off it they do not."""
    cube = moved(block("a", (1.0, 1.0, 1.0), 1.0, 1.0, 1.0), (0.5 + 1e-6 * share, 0.0, 0.0))
    model = Model(cube, {"a": STEEL}, Controls(1e-3))
    behind = Plane(np.zeros(3), np.array([-1.0, 0.0, 0.0]))
    skin = skin_of(model, Cut(Plane(np.array([0.0, 9.0, 0.0]), np.array([0.0, 1.0, 0.0])), behind))
    assert len(skin.faces) == faces
    assert len(skin.points) == faces + 2 if faces == 10 else 16


@pytest.mark.parametrize(("cosine", "count"), [(0.08, 1), (-0.15, 0)])
def test_a_plane_holds_the_axis_of_a_blow_within_six_degrees(cosine, count):
    along = (0.0, cosine, np.sqrt(1.0 - cosine**2))
    assert len(symmetry_planes(bricks((2.0, 3.0, 4.0), sides=("a.y-",), velocity={"a": along}))) == count


def test_planes_of_symmetry_are_sorted_by_all_of_their_cut_faces():
    """Faces of 3 m^2 each in one plane come before one of 5 m^2; of equal ones that across y comes first."""
    sides = ("a.y-", "a.x-", "b.x-")
    two = bricks((5.0, 3.0, 1.0), (5.0, 3.0, 1.0), sides=sides)
    assert [plane.normal.tolist() for plane in symmetry_planes(two)] == [[-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]]
    np.testing.assert_allclose(cut_of(two).plane.point, [-2.5, 0.0, 0.5], atol=1e-15)
    alone = bricks((5.0, 3.0, 1.0), (5.0, 3.0, 1.0), sides=sides[:2])
    assert [plane.normal.tolist() for plane in symmetry_planes(alone)] == [[0.0, -1.0, 0.0], [-1.0, 0.0, 0.0]]
    square = bricks((4.0, 4.0, 1.0), sides=("a.x-", "a.y-"))
    assert symmetry_planes(square)[0].normal.tolist() == [0.0, -1.0, 0.0]
    plate = bricks((4.0, 5.0, 1.0), sides=("a.x-", "a.x+", "a.y-"))
    assert [plane.normal.tolist() for plane in symmetry_planes(plate)] == [[0.0, -1.0, 0.0]]


@pytest.mark.parametrize(("slope", "mirrored"), [(0.05, True), (0.15, False), (-0.05, True), (-0.15, False)])
def test_the_mirror_stands_across_the_cut_within_six_degrees(slope, mirrored):
    """The side x- of a block leans by a slope; y- is the larger one."""
    model = bricks((5.0, 2.0, 1.0), sides=("a.x-", "a.y-"))
    points = model.mesh.points + np.outer(model.mesh.points[:, 1], [slope, 0.0, 0.0])
    cut = cut_of(dataclasses.replace(model, mesh=dataclasses.replace(model.mesh, points=points)))
    assert cut.plane.normal.tolist() == [0.0, -1.0, 0.0]
    assert (cut.mirror is not None) == mirrored
    if cut.mirror is not None:
        length = np.hypot(1.0, slope)
        np.testing.assert_allclose(cut.mirror.normal, [-1.0 / length, slope / length, 0.0], atol=1e-15)
        # a point 0.7 before the plane goes as far behind it
        place = cut.mirror.point + 0.7 * cut.mirror.normal + np.array([slope, 1.0, 2.0])
        assert cut.mirror.height(place) == pytest.approx(0.7, rel=1e-14)
        image = cut.mirror.point + cut.mirror.mirrored(place - cut.mirror.point)
        np.testing.assert_allclose(image, place - 1.4 * cut.mirror.normal, atol=1e-15)


@pytest.mark.parametrize(("cosine", "normal"), [(0.85, [0.0, -1.0, 0.0]), (-0.95, [-1.0, 0.0, 0.0])])
def test_bodies_without_symmetry_or_contact_are_cut_through_their_middle(cosine, normal):
    """Across y, or x where the blow goes along y."""
    model = bricks((2.0, 3.0, 4.0), velocity={"a": (np.sqrt(1.0 - cosine**2), cosine, 0.0)})
    cut = cut_of(model)
    assert cut.plane.normal.tolist() == normal
    assert cut.plane.point.tolist() == [0.0, 0.0, 2.0]


def test_the_axis_of_a_blow_is_that_of_the_greatest_momentum_or_of_what_is_driven():
    """6 m^3 of 3000 kg/m^3 at 5 m/s carry less than 2 m^3 of 12 000 kg/m^3, though these are slower."""
    model = bricks((1.0, 2.0, 3.0), (1.0, 2.0, 1.0), velocity={"a": (0.0, 0.0, 5.0), "b": (0.0, -3.2, 2.4)})
    model = dataclasses.replace(model, solids={"a": Elastic(3000.0, 1e9, 0.3), "b": Elastic(12000.0, 1e9, 0.3)})
    np.testing.assert_allclose(blow_axis(model), [0.0, -0.8, 0.6], rtol=1e-14)
    driven = Driven("a.x+", (3.0, 0.0, -4.0), TimeCurve((0.0,), (1.0,)))
    pushed = dataclasses.replace(model, velocity={"a": (0.0, 0.0, 0.0)}, boundaries=(Fixed("b.z+"), driven))
    np.testing.assert_allclose(blow_axis(pushed), [0.6, 0.0, -0.8], rtol=1e-14)
    assert blow_axis(dataclasses.replace(pushed, boundaries=())).tolist() == [0.0, 0.0, 1.0]


@pytest.mark.parametrize(
    ("lowered", "place"), [(0.5e-6, [1.0, 1.0, 1.15]), (1.5e-6, [0.0, 0.0, 1.15]), (0.1, [0.0, 0.0, 1.05])]
)
def test_bodies_meet_in_the_middle_of_their_nearest_nodes(lowered, place):
    """A brick 0.3 above four of nine nodes; lowered at one corner by more than a millionth of its width, there alone."""
    low = block("a", (4.0, 4.0, 1.0), 2.0, 2.0, 1.0)
    up = moved(block("b", (2.0, 2.0, 1.0), 2.0, 2.0, 1.0), (1.0, 1.0, 1.3))
    corner = np.argmin(np.abs(up.points - [0.0, 0.0, 1.3]).sum(axis=1))
    up.points[corner, 2] -= 2.0 * lowered
    model = Model(joined([low, up]), {"a": STEEL, "b": STEEL}, Controls(1e-3), velocity={"b": (0.0, 0.0, -1.0)})
    facing = dataclasses.replace(model, contacts=(SurfaceContact("b.z-", "a.z+"),))
    np.testing.assert_allclose(meeting_place(facing), place, atol=2e-6)
    wall = RigidWall("b.z-", (5.0, 5.0, 1.0), (0.0, 0.0, 3.0))
    np.testing.assert_allclose(meeting_place(dataclasses.replace(model, walls=(wall,))), place, atol=2e-6)
    assert meeting_place(model) is None


def test_the_mean_normal_of_a_side_points_outward():
    slanted = block("a", (2.0, 3.0, 4.0), 1.0, 1.5, 4.0)
    slanted.points[:, 2] += 0.75 * slanted.points[:, 0]
    np.testing.assert_allclose(outward(slanted, "a.z+"), [-0.6, 0.0, 0.8], atol=1e-15)
    np.testing.assert_allclose(outward(slanted, "a.y-"), [0.0, -1.0, 0.0], atol=1e-15)


# the film


def test_the_wave_takes_the_way_to_the_far_end_at_the_speed_in_bars(bars):
    solid = bars.solids["bar"]
    assert transit_time(bars) == pytest.approx(0.12 / np.sqrt(solid.youngs_modulus / solid.density), rel=1e-12)
    steel = dataclasses.replace(bars, contacts=(SurfaceContact("bar.top", "striker.top"),))  # the far end is z = 0
    apart = transit_time(dataclasses.replace(steel, contacts=(), boundaries=()))
    assert apart == pytest.approx(0.18 / np.sqrt(solid.youngs_modulus / solid.density), rel=1e-12)
    assert transit_time(steel) == pytest.approx(0.12 / np.sqrt(STEEL.youngs_modulus / STEEL.density), rel=1e-12)


def test_a_film_keeps_few_even_instants_more_in_contact_and_those_of_the_wave(ball):
    frame = synthetic.frame(ball.mesh, 1e-5)
    film = snapshot_recorder(ball, 10)
    time = 1e-7 * np.arange(1001)
    touching = (time > 2e-5) & (time < 4e-5)
    largest = np.where(np.arange(1001) == 777, 9e8, 1e8)
    for t, touch, most in zip(time, touching, largest, strict=True):
        film.offer(float(t), bool(touch), float(most), lambda at=t: dataclasses.replace(frame, time=float(at)))
    kept = np.array([one.time for one in film.whole.kept])
    assert 10 <= len(kept) < 20
    assert np.allclose(np.diff(kept), kept[1] - kept[0], rtol=1e-9)
    close = np.array([one.time for one in film.contact.kept])
    assert 10 <= len(close) < 20
    assert close.min() > 2e-5
    assert close.max() < 4e-5
    assert (PER_TRANSIT, WAVE_INSTANTS) == (6, 8)  # as the docs and the caption say
    due = film.touched + film.transit / 6.0 * np.arange(1, 9)
    late = np.array([one.time for one in film.wave]) - due
    assert (late > -1e-12).all()
    assert (late < 1e-7 + 1e-12).all()  # the next instant of the histories
    assert film.worst.time == pytest.approx(777e-7, rel=1e-12)
    assert len(film.snapshots) <= 20 + 20 + WAVE_INSTANTS + 2


@pytest.mark.parametrize("before", [0.0, 5.0])
def test_a_run_that_went_on_after_first_touch_has_no_row_of_the_wave(ball, before):
    frame, film = synthetic.frame(ball.mesh, 1e-5), snapshot_recorder(ball)
    rows = {f"force/{film.contact_name}": [np.array([0.0, 0.0, before])], "von_mises/ball": [np.array(1e6)]}
    engine = SimpleNamespace(recorder=SimpleNamespace(rows=rows, bearing=["ball"]), frame=lambda: frame)
    for k in range(30):
        engine.time = 1e-6 * (50 + k)
        rows[f"force/{film.contact_name}"].append(np.array([0.0, 0.0, 7.0]))
        film.observe(engine, last=k == 29)
    assert film.missed == (before > 0.0)
    assert len(film.wave) == (0 if before else WAVE_INSTANTS)
    assert film.last is not None


def test_a_film_of_a_large_model_keeps_fewer_instants(ball, monkeypatch):
    skin = skin_of(ball)
    each = 4 * (3 * len(skin.nodes) + 7 * len(skin.elements))
    monkeypatch.setattr("strikewave.fem.snapshots.LARGEST", 4 * each * 11)
    assert SnapshotRecorder(skin, 1e-5, "", 60).wanted == 11


def test_a_row_that_grows_is_thinned_by_every_other_one():
    row = Thinned(2)
    for k in range(10):
        if row.wants():
            row.add(k)
    assert row.kept == [0, 4, 8]
    assert (row.every, row.offered) == (4, 10)


def test_instants_of_the_wave_and_of_the_largest_stress_have_thresholds():
    """One of a wave may come a millionth of its interval early; a stress counts as larger from 2 % on."""
    film, frame = snapshot_recorder(synthetic.model(), 10), synthetic.frame(synthetic.mesh(), 1e-5)
    film.transit = 6.0
    offers = [(0.5, False, 1e8), (2.0, True, 1.01e8), (3.0 - 0.6e-6, True, 1.0198e8), (4.0 - 1.7e-6, True, 1.021e8)]
    for time, touching, largest in [*offers, (4.5, False, 0.9e8)]:
        film.offer(time, touching, largest, lambda at=time: dataclasses.replace(frame, time=at))
    assert [one.time for one in film.whole.kept] == [0.5, 2.0, 3.0 - 0.6e-6, 4.0 - 1.7e-6, 4.5]
    assert [one.time for one in film.contact.kept] == [2.0, 3.0 - 0.6e-6, 4.0 - 1.7e-6]
    assert (film.touched, film.missed) == (2.0, False)
    assert [one.time for one in film.wave] == [3.0 - 0.6e-6, 4.5]
    assert film.worst.time == 4.0 - 1.7e-6


@pytest.mark.parametrize(
    ("rows", "wanted", "kept"), [(10, None, 24), (10, 3, 8), (160_000, None, 10), (1_600_000, 30, 8)]
)
def test_a_film_takes_a_quarter_of_a_gigabyte_at_most(rows, wanted, kept):
    """Ten single numbers a row, of instants over the run, while bodies touch, and as many again: 160 bytes."""
    skin = SimpleNamespace(nodes=range(rows), elements=range(rows))
    film = SnapshotRecorder(skin, 1e-5) if wanted is None else SnapshotRecorder(skin, 1e-5, "", wanted)
    assert (film.wanted, film.whole.wanted, film.contact.wanted) == (kept, kept, kept)


def test_frames_alone_make_a_film_too(ball):
    film = recorder_from_frames(ball, synthetic.frames(ball.mesh, 5))
    assert [one.time for one in film.snapshots] == pytest.approx(np.linspace(0.0, synthetic.DURATION, 5).tolist())
    assert film.worst.time == pytest.approx(0.5 * synthetic.DURATION)
    assert film.wave == []
