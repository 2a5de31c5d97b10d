"""Meshes from files: what is written comes back, and files that cannot be used say why."""

import json
import subprocess
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.spatial import cKDTree

from strikewave.base.errors import InputError, InputErrors
from strikewave.fem import mesh_files, meshio_child
from strikewave.fem.mesh import Mesh, exterior_faces, joined, volumes
from strikewave.fem.mesh_files import RawMesh, ordered_mesh, read_mesh
from strikewave.fem.sections import FLIPPED
from strikewave.fem.shapes import block, cylinder, moved


@pytest.fixture(scope="module")
def meshio():
    return pytest.importorskip("meshio", reason="meshio is not installed: pip install 'strikewave[mesh]'")


@pytest.fixture(scope="module")
def bodies():
    """A cylinder on a block, in mm."""
    base = block("base", (30.0, 20.0, 10.0), 3.0, 3.0, 3.0)
    return joined([base, moved(cylinder("bar", 8.0, 20.0, 2.0, 4.0), (0.0, 0.0, 10.0))])


def same(ours: Mesh, theirs: Mesh, scale: float = 1e-3) -> None:
    """Theirs has the parts, elements and faces of ours, in SI, its volumes positive and its sides outward."""
    assert sorted(ours.names) == sorted(theirs.names)
    assert np.all(volumes(theirs.points, theirs.hexahedra) > 0.0)
    for name in ours.names:
        alike(ours, ours.hexahedra[ours.elements_of(name)], theirs, theirs.hexahedra[theirs.elements_of(name)], scale)
    exterior = {tuple(face) for face in exterior_faces(theirs.hexahedra).tolist()}
    for side, faces in theirs.sides.items():
        alike(ours, ours.sides[side], theirs, faces, scale)
        assert {tuple(face) for face in faces.tolist()} <= exterior


def alike(ours, our_elements, theirs, their_elements, scale):
    assert len(our_elements) == len(their_elements)
    middle = ours.points[our_elements].mean(axis=1) * scale
    away, which = cKDTree(middle).query(theirs.points[their_elements].mean(axis=1))
    assert len(np.unique(which)) == len(which)
    assert away.max() < 1e-14


def as_gmsh(meshio, mesh, turn=False):
    """The mesh as gmsh would hold it: physical volumes 1.. and physical surfaces 11.., and a loose corner node."""
    top, foot = mesh.sides["bar.top"], mesh.sides["base.z-"]
    hexahedra = mesh.hexahedra[:, FLIPPED] if turn else mesh.hexahedra
    cells = [("quad", top[:, ::-1]), ("hexahedron", hexahedra), ("quad", foot), ("line", foot[:, :2])]
    tags = [np.full(len(top), 11), mesh.part.astype(int) + 1, np.full(len(foot), 12), np.zeros(len(foot), int)]
    points = np.concatenate([mesh.points, [[99.0, 99.0, 99.0]]])
    named = {"base": [1, 3], "bar": [2, 3], "top": [11, 2], "z-": [12, 2]}
    return meshio.Mesh(
        points,
        cells,
        cell_data={"gmsh:physical": tags, "gmsh:geometrical": tags},
        field_data={name: np.array(value) for name, value in named.items()},
    )


@pytest.mark.parametrize("turn", [False, True])
@pytest.mark.parametrize("binary", [False, True])
def test_a_gmsh_file_gives_its_physical_volumes_and_surfaces(meshio, bodies, tmp_path, binary, turn):
    path = tmp_path / "bodies.msh"
    as_gmsh(meshio, bodies, turn).write(path, file_format="gmsh22", binary=binary)
    found = read_mesh(path, 1e-3)
    same(bodies, found)
    assert found.names == ("base", "bar")
    assert sorted(found.sides) == ["bar.top", "base.z-"]


CUBE = {
    "4.1": """$MeshFormat
4.1 0 8
$EndMeshFormat
$PhysicalNames
4
2 1 "foot"
2 2 "outside"
3 3 "cube"
3 4 "everything"
$EndPhysicalNames
$Entities
0 0 2 1
1 0 0 0 1 1 0 2 1 2 0
2 0 0 1 1 1 1 1 2 0
1 0 0 0 1 1 1 2 3 4 2 1 2
$EndEntities
$Nodes
1 8 1 8
3 1 0 8
1
2
3
4
5
6
7
8
0 0 0
1 0 0
1 1 0
0 1 0
0 0 1
1 0 1
1 1 1
0 1 1
$EndNodes
$Elements
3 3 1 3
2 1 3 1
1 1 2 3 4
2 2 3 1
2 5 6 7 8
3 1 5 1
3 1 2 3 4 5 6 7 8
$EndElements
""",
    "2.2": """$MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
4
2 1 "foot"
2 2 "outside"
3 3 "cube"
3 4 "everything"
$EndPhysicalNames
$Nodes
8
1 0 0 0
2 1 0 0
3 1 1 0
4 0 1 0
5 0 0 1
6 1 0 1
7 1 1 1
8 0 1 1
$EndNodes
$Elements
5
1 3 2 1 1 1 2 3 4
2 3 2 2 1 1 2 3 4
3 3 2 2 2 5 6 7 8
4 5 2 3 1 1 2 3 4 5 6 7 8
5 5 2 4 1 1 2 3 4 5 6 7 8
$EndElements
""",
}


@pytest.mark.parametrize("version", sorted(CUBE))
def test_a_face_in_two_physical_groups_of_gmsh_is_in_both_and_a_solid_counts_once(meshio, tmp_path, version):
    mesh = read_mesh(written(tmp_path, CUBE[version], "cube.msh"))
    assert mesh.names == ("cube",)
    assert len(mesh.hexahedra) == 1
    assert {side: len(faces) for side, faces in mesh.sides.items()} == {"cube.foot": 1, "cube.outside": 2}


def test_a_vtu_file_gives_the_numbers_of_its_parts(meshio, bodies, tmp_path):
    path = tmp_path / "bodies.vtu"
    data = {"part": [bodies.part + 1]}
    meshio.Mesh(bodies.points, [("hexahedron", bodies.hexahedra)], cell_data=data).write(path)
    found = read_mesh(path)
    assert found.names == ("part-1", "part-2")
    np.testing.assert_allclose(np.bincount(found.part), np.bincount(bodies.part))


def test_a_legacy_vtk_file_without_parts_is_one_part(meshio, bodies, tmp_path):
    path = tmp_path / "bodies.vtk"
    meshio.Mesh(bodies.points, [("hexahedron", bodies.hexahedra)]).write(path)
    found = read_mesh(path)
    assert found.names == ("unnamed",)
    assert volumes(found.points, found.hexahedra).sum() == pytest.approx(
        volumes(bodies.points, bodies.hexahedra).sum(), rel=1e-12
    )


def test_what_meshio_writes_as_abaqus_is_read(meshio, bodies, tmp_path):
    path = tmp_path / "bodies.inp"
    sets = {name: [np.arange(len(bodies.hexahedra))[bodies.elements_of(name)]] for name in bodies.names}
    meshio.Mesh(bodies.points, [("hexahedron", bodies.hexahedra)], cell_sets=sets).write(path)
    same(bodies, read_mesh(path, 1e-3))


TWO_CUBES = """*HEADING
 two cubes, one upon the other
** a comment
*NODE, NSET=EVERY
 1, 0., 0., 0.
 2, 1., 0., 0.
 3, 1., 1., 0.
 4, 0., 1., 0.
 11, 0., 0., 1.
 12, 1., 0., 1.
 13, 1., 1., 1.
 14, 0., 1., 1.
 21, 0., 0., 2.D0
 22, 1., 0., 2.
 23, 1., 1., 2.
 24, 0., 1., 2.
*Element, type=C3D8R, elset=Lower
 100, 1, 2, 3, 4, 11, 12,
 13, 14
*ELEMENT, TYPE=C3D8
 200, 11, 12, 13, 14, 21, 22, 23, 24
*ELSET, ELSET=Upper, GENERATE
 200, 2000000000, 100
*ELSET, ELSET=Everything
 LOWER, Upper
*NSET, NSET=Foot
 1, 2, 3, 4,
*SURFACE, TYPE=ELEMENT, NAME=Head
 Upper, S2
*SURFACE, NAME=Flank
 100, S3
 200, S3
*SURFACE, NAME=Skin
 Lower,
*STEP
*DLOAD
 Head, P, 1.0
"""


def written(tmp_path, text, name="case.inp"):
    path = tmp_path / name
    path.write_bytes(text if isinstance(text, bytes) else text.encode("latin-1"))
    return path


def test_an_abaqus_file_gives_sets_and_surfaces_by_hand(tmp_path):
    mesh = read_mesh(written(tmp_path, TWO_CUBES))
    assert mesh.names == ("Lower", "Upper")
    middle = {name: mesh.points[faces].mean(axis=(0, 1)).round(12).tolist() for name, faces in mesh.sides.items()}
    assert middle["Upper.Head"] == [0.5, 0.5, 2.0]
    assert middle["Lower.Foot"] == [0.5, 0.5, 0.0]
    assert middle["Lower.Flank"] == [0.5, 0.0, 0.5]
    assert middle["Upper.Flank"] == [0.5, 0.0, 1.5]
    assert len(mesh.sides["Upper.EVERY"]) == 6
    assert len(mesh.sides["Lower.Skin"]) == 5  # a set without faces: those on the outside of the model
    assert len(mesh.points) == 12


def test_solid_sections_say_which_of_overlapping_sets_are_parts(tmp_path):
    overlapping = TWO_CUBES.replace("*STEP", "*ELSET, ELSET=Again\n 100\n*STEP")
    with pytest.raises(InputError, match="overlap"):
        read_mesh(written(tmp_path, overlapping))
    sections = "*SOLID SECTION, ELSET=lower, MATERIAL=steel\n1.\n*SOLID SECTION, ELSET=UPPER, MATERIAL=steel\n*STEP"
    assert read_mesh(written(tmp_path, overlapping.replace("*STEP", sections))).names == ("Lower", "Upper")


def cubes(*changes):
    """The two cubes, some of their lines replaced."""
    text = TWO_CUBES
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    return text


ONE_NAME = (("*ELEMENT, TYPE=C3D8\n", "*ELEMENT, TYPE=C3D8, ELSET=lower\n"), ("LOWER, Upper", "Lower"))


@pytest.mark.parametrize(
    ("changes", "names"),
    [
        # all elements named Lower, and a set of some of them that is there for a surface
        (ONE_NAME, ("Lower",)),
        # as above, the set of some of them there for nothing: no part either, since the rest would have no name
        ((*ONE_NAME, ("Upper, S2", "200, S2")), ("Lower",)),
        # all elements named Lower, and two sets on their own that hold each once
        ((*ONE_NAME, ("Upper, S2", "200, S2"), ("*NSET", "*ELSET, ELSET=First\n 100\n*NSET")), ("First", "Upper")),
        # each element named, and another set across both
        (
            (("*ELEMENT, TYPE=C3D8\n", "*ELEMENT, TYPE=C3D8, ELSET=second\n"), ("*NSET", "*ELSET, ELSET=A\n 100\n*NSET")),
            ("Lower", "second"),
        ),
        # no element named, and a set for a surface
        ((("*Element, type=C3D8R, elset=Lower", "*ELEMENT, TYPE=C3D8R"), (" LOWER, Upper", " Upper"), (" Lower,", " Upper,")), ("unnamed",)),
    ],
)  # fmt: skip
def test_parts_are_the_sets_that_hold_each_element_once(tmp_path, changes, names):
    text = cubes(*changes)
    if "elset=Lower" not in text:
        text = text.replace("*ELSET, ELSET=Everything\n Upper\n", "")
    found = read_mesh(written(tmp_path, text))
    assert sorted(found.names) == sorted(names)
    assert len(found.hexahedra) == 2


REFUSED = {
    "an element that is missing its node": ("200, 11", "200, 99", "number 99"),
    "an element that is cut off": ("23, 24\n*ELSET", "23\n*ELSET", "9 for each element"),
    "a node that comes twice": (" 2, 1., 0.", " 1, 1., 0.", "number 1 twice"),
    "a number that is none": (" 2, 1., 0.", " 2, one, 0.", "numbers as Abaqus"),
    "a number that is too large": (
        "*ELEMENT, TYPE=C3D8\n 200",
        "*ELEMENT, TYPE=C3D8\n 99999999999999999999",
        "numbers",
    ),
    "tetrahedra": ("*STEP", "*ELEMENT, TYPE=C3D4\n 300, 1, 2, 3, 11\n*STEP", "1 C3D4"),
    "another file": ("*STEP", "*INCLUDE, INPUT=/dev/zero\n*STEP", "INCLUDE"),
    "two parts": ("*STEP", "*PART, NAME=a\n*END PART\n*PART, NAME=b\n*STEP", "flat"),
    "a moved instance": ("*STEP", "*INSTANCE, NAME=a, PART=b\n 1., 0., 0.\n*STEP", "flat"),
    "a face inside": ("Upper, S2", "Upper, S1\nLower, S2", ""),
    "an unknown face": ("Upper, S2", "Upper, S7", "S1 to S6"),
    "an unknown set": ("Upper, S2", "Uper, S2", "did you mean"),
    "a set within itself": (" LOWER, Upper", " Everything", "before it"),
    "a step of nothing": ("2000000000, 100", "2000000000, 0", "at least 1"),
    "an endless keyword": ("*STEP", "*STEP,\n" + "a,\n" * 6000, "characters"),
}


@pytest.mark.parametrize("fault", [name for name in REFUSED if name != "a face inside"])
def test_an_abaqus_file_that_cannot_be_used_says_why(tmp_path, fault):
    before, after, word = REFUSED[fault]
    assert before in TWO_CUBES
    with pytest.raises(InputError) as error:
        read_mesh(written(tmp_path, TWO_CUBES.replace(before, after)))
    assert word in str(error.value)


def test_a_named_face_inside_a_part_is_refused(tmp_path):
    one = TWO_CUBES.replace("elset=Lower", "elset=Whole").replace(
        "*ELEMENT, TYPE=C3D8\n", "*ELEMENT, TYPE=C3D8, ELSET=whole\n"
    )
    one = one.replace("LOWER, Upper", "Whole").replace("Lower", "Whole").replace("Upper, S2", "Upper, S1")
    with pytest.raises(InputError, match="1 of 1 faces of Head"):
        read_mesh(written(tmp_path, one.replace("*STEP", "*SOLID SECTION, ELSET=Whole\n*STEP")))


def test_a_flat_element_is_named_with_its_place(tmp_path):
    flat = TWO_CUBES.replace("2.D0", "1.").replace("1., 0., 2.", "1., 0., 1.")
    with pytest.raises(InputErrors, match=r"Upper element 0 at \(0.5, 0.5, 1.25\) m"):
        read_mesh(written(tmp_path, flat))


def test_sets_of_sets_do_not_fill_the_memory(tmp_path, monkeypatch):
    monkeypatch.setattr(mesh_files, "LARGEST_SETS", 100)
    many = "".join(f"*ELSET, ELSET=E{k}\n Everything\n" for k in range(100))
    with pytest.raises(InputError, match="members of all sets"):
        read_mesh(written(tmp_path, TWO_CUBES.replace("*STEP", many + "*STEP")))


def test_names_of_a_file_are_made_plain(tmp_path):
    odd = TWO_CUBES.replace("Lower", "<b>Lo.wer</b>").replace("LOWER", "<b>Lo.wer</b>")
    assert read_mesh(written(tmp_path, odd)).names == ("-b-Lo-wer-b-", "Upper")


def test_tetrahedra_are_refused_with_their_count(meshio, tmp_path):
    path = tmp_path / "tetra.msh"
    points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    meshio.Mesh(points, [("tetra", np.array([[0, 1, 2, 3]] * 7))]).write(path, file_format="gmsh22")
    with pytest.raises(InputError, match="7 tetra"):
        read_mesh(path)


@pytest.mark.verify
def test_a_packed_file_that_unpacks_to_more_than_the_bound_is_refused(meshio, tmp_path, monkeypatch):
    from strikewave.fem import mesh_files

    monkeypatch.setattr(mesh_files, "LEAST_MEMORY", 1 << 29)
    cube = block("a", (1.0, 1.0, 1.0), 0.5, 0.5, 0.5)
    path = tmp_path / "bomb.vtu"
    meshio.Mesh(cube.points, [("hexahedron", cube.hexahedra)]).write(path)
    assert len(read_mesh(path).hexahedra) == 8
    zeros = np.zeros((27, 1_000_000))
    meshio.Mesh(cube.points, [("hexahedron", cube.hexahedra)], point_data={"bomb": zeros}).write(
        path, compression="zlib"
    )
    assert path.stat().st_size < 5e6
    with pytest.raises(InputError, match="MemoryError"):
        read_mesh(path)


def test_a_gmsh_file_with_a_node_number_beyond_memory_is_refused(tmp_path):
    text = """$MeshFormat
4.1 0 8
$EndMeshFormat
$Nodes
1 1 1 900000000000
3 1 0 1
900000000000
0 0 0
$EndNodes
$Elements
1 1 1 1
3 1 5 1
1 900000000000 1 1 1 1 1 1 1
$EndElements
"""
    pytest.importorskip("meshio", reason="meshio is not installed: pip install 'strikewave[mesh]'")
    with pytest.raises(InputError, match="could not be read"):
        read_mesh(written(tmp_path, text, "far.msh"))


@pytest.mark.verify
@pytest.mark.parametrize("kind", ["msh", "vtk", "vtu", "inp"])
def test_a_file_that_is_cut_off_or_garbled_ends_in_an_input_error(meshio, tmp_path, rng, kind):
    cube = block("a", (1.0, 1.0, 1.0), 0.5, 0.5, 0.5)
    path = tmp_path / f"whole.{kind}"
    options = {"file_format": "gmsh22"} if kind == "msh" else {}
    tags = {} if kind == "inp" else {"gmsh:physical": [np.ones(8, int)], "gmsh:geometrical": [np.ones(8, int)]}
    meshio.Mesh(cube.points, [("hexahedron", cube.hexahedra)], cell_data=tags).write(path, **options)
    whole = path.read_bytes()
    assert len(read_mesh(path).hexahedra) == 8
    refused = 0
    for trial in range(60 if kind == "inp" else 5):
        damaged = bytearray(whole[: rng.integers(1, len(whole))] if trial % 2 else whole)
        if not trial % 2:
            for place in rng.integers(0, len(whole), 5):
                damaged[place] = rng.integers(0, 256)
        try:
            read_mesh(written(tmp_path, bytes(damaged), f"damaged.{kind}"))
        except (InputError, InputErrors):
            refused += 1
    assert refused > (20 if kind == "inp" else 1)


@pytest.mark.parametrize(
    ("name", "content", "word"),
    [("nothing.msh", None, "no such file"), ("mesh.stl", b"solid", "ends in"), ("empty.inp", b"", "0 hexahedra")],
)
def test_files_that_are_no_meshes_are_refused(tmp_path, name, content, word):
    path = tmp_path / name
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(InputError, match=word):
        read_mesh(path)


def test_a_file_that_is_too_large_is_refused_unread(tmp_path):
    path = tmp_path / "large.inp"
    with path.open("wb") as file:
        file.truncate((1 << 30) + 1)
    with pytest.raises(InputError, match="bytes"):
        read_mesh(path)


def test_without_meshio_the_word_says_how_to_get_it(tmp_path, monkeypatch):
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    with pytest.raises(InputError, match=r"strikewave\[mesh\]"):
        read_mesh(written(tmp_path, "$MeshFormat", "a.msh"))


@pytest.mark.parametrize("scale", [0.0, -1.0, float("nan")])
def test_a_scale_must_be_above_zero(tmp_path, scale):
    with pytest.raises(InputError, match="scale"):
        read_mesh(written(tmp_path, TWO_CUBES), scale)


# An Abaqus file of a row of six cubes, with numbers of its own


def row_of_cubes(*more):
    """Elements 7, 10, 13, 16, 19, 22 along x, 2 m wide; node 1000 + 100 i + 10 j + k at (2 i, j, k); sets by hand."""
    nodes = [f"{1000 + 100 * i + 10 * j + k}, {2.0 * i}, {j}, {k}" for i in range(7) for j in (0, 1) for k in (0, 1)]
    cubes = []
    for i in range(6):
        corners = [
            (i, 0, 0),
            (i + 1, 0, 0),
            (i + 1, 1, 0),
            (i, 1, 0),
            (i, 0, 1),
            (i + 1, 0, 1),
            (i + 1, 1, 1),
            (i, 1, 1),
        ]
        cubes.append(f"{7 + 3 * i}, " + ", ".join(str(1000 + 100 * a + 10 * b + c) for a, b, c in corners))
    return "\n".join(["*NODE", *nodes, "*ELEMENT, TYPE=C3D8R", *cubes, *more]) + "\n"


def elements_by_part(mesh):
    """Which of the six cubes each part has, by their middles."""
    number = np.rint(mesh.points[mesh.hexahedra].mean(axis=1)[:, 0] / 2.0 - 0.5).astype(int)
    return {name: sorted(number[mesh.elements_of(name)].tolist()) for name in mesh.names}


def sides_of(mesh):
    return {name: sorted(mesh.points[faces].mean(axis=1).round(9).tolist()) for name, faces in mesh.sides.items()}


def test_ranges_of_sets_begin_at_their_first_number_and_end_with_their_last(tmp_path):
    text = row_of_cubes(
        "*ELSET, ELSET=Odd, GENERATE", "8, 19, 1", "*ELSET, ELSET=Each, GENERATE", "7, 22, 6",
        "*ELSET, ELSET=Late, GENERATE", "19, 21", "*ELSET, ELSET=Some", "7, 7, 10, 999,", "Late, 16",
        "*SOLID SECTION, ELSET=Some", "1.", "*SOLID SECTION, ELSET=Rest", "*ELSET, ELSET=Rest, GENERATE", "13, 13, 5",
        "22, 22, 1", "*SURFACE, NAME=foot, TYPE=ELEMENT", "Odd, S1", "*SURFACE, NAME=head", "Each, S2", "13, S2",
    )  # fmt: skip
    mesh = read_mesh(written(tmp_path, text))
    assert elements_by_part(mesh) == {"Some": [0, 1, 3, 4], "Rest": [2, 5]}
    sides = sides_of(mesh)
    assert sides["Some.foot"] == [[3.0, 0.5, 0.0], [7.0, 0.5, 0.0], [9.0, 0.5, 0.0]]
    assert sides["Rest.foot"] == [[5.0, 0.5, 0.0]]
    assert sides["Some.head"] == [[1.0, 0.5, 1.0], [9.0, 0.5, 1.0]]  # 7 and 19 of 7, 13, 19
    assert sides["Rest.head"] == [[5.0, 0.5, 1.0]]


def test_a_section_of_a_set_that_is_missing_or_empty_is_no_part(tmp_path):
    sections = [line for name in ("Gone", "None", "Left") for line in (f"*SOLID SECTION, ELSET={name}", "1.")]
    sets = ["*ELSET, ELSET=Left", "7, 10", "*ELSET, ELSET=None", "500"]
    assert elements_by_part(read_mesh(written(tmp_path, row_of_cubes(*sets, *sections)))) == {
        "Left": [0, 1],
        "unnamed": [2, 3, 4, 5],
    }


def test_each_face_of_an_element_has_its_number_and_a_set_alone_stands_for_its_free_faces(tmp_path):
    """S1 to S6 of one cube, by the manual: z-, z+, y-, x+, y+, x-; free faces lie on the outside of the whole model."""
    faces = [f"*SURFACE, NAME=s{k}\n22, S{k}" for k in (1, 2, 3, 4, 5)]
    more = ["*SURFACE, NAME=s6", "7, s6", "*ELSET, ELSET=Two", "7, 10", "*SURFACE, NAME=free", "Two", "10,"]
    more += ["*SURFACE, NAME=nodes, TYPE=NODE", "1000, 1.", "*SURFACE, TYPE=ELEMENT", "Nothing, S1"]
    sides = sides_of(read_mesh(written(tmp_path, row_of_cubes(*faces, *more))))
    middles = {"s1": [11.0, 0.5, 0.0], "s2": [11.0, 0.5, 1.0], "s3": [11.0, 0.0, 0.5], "s4": [12.0, 0.5, 0.5]}
    middles |= {"s5": [11.0, 1.0, 0.5], "s6": [0.0, 0.5, 0.5]}
    part = next(iter(sides)).partition(".")[0]
    for name, middle in middles.items():
        assert sides[f"{part}.{name}"] == [middle]
    # nine of ten faces of the first two; the tenth is between the second and the third
    assert len(sides[f"{part}.free"]) == 9
    assert [4.0, 0.5, 0.5] not in sides[f"{part}.free"]
    assert not any(name.endswith(("nodes", ".")) for name in sides)


def test_shells_and_node_sets_mark_sides(tmp_path):
    """A quadrilateral on the far end, and nodes of which four span a face; sets whose names begin with _ are inner."""
    shell = [
        "*ELEMENT, TYPE=S4R, ELSET=End",
        "99, 1600, 1610, 1611, 1601",
        "*ELEMENT, TYPE=SFM3D4",
        "98, 1000, 1010, 1011,",
        "1001",
    ]
    sets = [
        "*NSET, NSET=Base, GENERATE",
        "1000, 1110, 10",
        "1100, 1110",
        "*NSET, NSET=_inner",
        "1000, 1010, 1001, 1011",
    ]
    sides = sides_of(read_mesh(written(tmp_path, row_of_cubes(*shell, *sets))))
    assert sides == {"unnamed.End": [[12.0, 0.5, 0.5]], "unnamed.Base": [[1.0, 0.5, 0.0]]}


def test_coordinates_may_be_left_out_and_lines_go_on_after_a_comma(tmp_path):
    text = row_of_cubes().replace("1000, 0.0, 0, 0", "1000,\n").replace("1100, 2.0, 0, 0", "1100, 2.D0, , 0, 9, 9")
    text = text.replace("*ELEMENT, TYPE=C3D8R", '*ELEMENT,\n** a comment\n\nTYPE=C3D8R,\n ELSET="All"')
    mesh = read_mesh(written(tmp_path, "*HEADING\n title\n" + text))
    assert mesh.names == ("All",)
    assert volumes(mesh.points, mesh.hexahedra).tolist() == pytest.approx([2.0] * 6, rel=1e-14)


@pytest.mark.parametrize(
    ("text", "one"), [("*PART, NAME=a\n{}*END PART\n", 1), ("*INSTANCE, NAME=a\n*END INSTANCE\n{}", 2)]
)
def test_one_part_and_one_instance_in_its_place_are_read(tmp_path, text, one):
    path = written(tmp_path, text.format(row_of_cubes()))
    assert len(read_mesh(path).hexahedra) == 6
    twice = text.partition("{}")[0] * 2 + row_of_cubes()
    with pytest.raises(InputError, match="several"):
        read_mesh(written(tmp_path, twice, "twice.inp"))


def test_bounds_of_an_abaqus_file_are_two_million_elements_and_a_hundred_million_members():
    class Many(list):
        def __len__(self):
            return 18_000_000 - 9 + super().__len__()

    contents = mesh_files._Contents()
    contents.hexahedra = Many()
    row = ["1, 1, 2, 3, 4, 5, 6, 7, 8"]
    mesh_files._elements(contents, {"TYPE": "C3D8"}, row)
    with pytest.raises(InputError, match="2000001 hexahedra"):
        mesh_files._elements(contents, {"TYPE": "C3D8"}, row)
    resolver = mesh_files._Resolver(mesh_files._Contents())
    resolver._spend(99_999_990)
    resolver._spend(10)
    with pytest.raises(InputError, match="at most 100000000 members"):
        resolver._spend(1)


def test_a_keyword_of_ten_thousand_characters_is_the_longest(tmp_path):
    for count, read in ((1990, True), (2010, False)):
        text = row_of_cubes("*ELSET,", *["a=b, ,"] * count, "ELSET=Long", "7")  # 5 characters each, stripped
        if read:
            assert len(read_mesh(written(tmp_path, text.replace("a=b, ,", "a=b,,"))).hexahedra) == 6
        else:
            with pytest.raises(InputError, match="at most 10000 characters"):
                read_mesh(written(tmp_path, text.replace("a=b, ,", "a=b,,")))


# What a file holds, put in order


def raw_row(**more):
    """Three cubes in a row along x, the second inverted, and a node of nothing before them."""
    points = np.array([[99.0, 9, 9], *([i, j, k] for i in range(4) for j in (0, 1) for k in (0, 1))], float)
    cube = np.array([0, 4, 6, 2, 1, 5, 7, 3])
    hexahedra = np.array([1 + cube, 5 + cube[FLIPPED], 9 + cube])
    return RawMesh(points, hexahedra, **more)


def test_parts_that_are_set_in_order_keep_their_elements_and_sides():
    ends = {"low end": np.array([[1, 2, 4, 3]]), "high": np.array([[13, 14, 16, 15]])}
    sets = {"top": np.array([0, 2, 4, 6, 8, 10, 12]), "one": np.array([1, 2, 3])}
    mesh = ordered_mesh(raw_row(parts={"outer": np.array([2, 0])}, quads=ends, node_sets=sets), 0.5)
    assert mesh.names == ("outer", "unnamed")
    middle = mesh.points[mesh.hexahedra].mean(axis=1)
    assert sorted(middle[mesh.elements_of("outer"), 0]) == [0.25, 1.25]
    assert middle[mesh.elements_of("unnamed")].tolist() == [[0.75, 0.25, 0.25]]
    np.testing.assert_allclose(volumes(mesh.points, mesh.hexahedra), 0.125, rtol=1e-14)
    assert len(mesh.points) == 16
    assert sides_of(mesh) == {
        "outer.low-end": [[0.0, 0.25, 0.25]],
        "outer.high": [[1.5, 0.25, 0.25]],
        "outer.top": [[0.25, 0.25, 0.5]],
        "unnamed.top": [[0.75, 0.25, 0.5]],
    }
    whole = ordered_mesh(raw_row(parts={"all": np.arange(3), "none": np.array([], int), "again": np.arange(3)}))
    assert whole.names == ("all",)


@pytest.mark.parametrize(
    ("raw", "scale", "words"),
    [
        (RawMesh(np.zeros((8, 3)), np.zeros((0, 8), int)), 1.0, "0 hexahedra"),
        (RawMesh(np.zeros((8, 3)), np.broadcast_to(np.arange(8), (2_000_001, 8))), 1.0, "2000001 hexahedra"),
        (RawMesh(np.zeros((16, 3)), raw_row().hexahedra), 1.0, "nodes below 16"),
        (RawMesh(np.zeros((99, 3)), raw_row().hexahedra - 2), 1.0, "nodes below 99"),
        (raw_row(), 3.4e5, "coordinates within 1e"),
        (raw_row(parts={"a": np.array([0, 1]), "b": np.array([1, 2])}), 1.0, "sets a and b overlap"),
        (raw_row(parts={"a b": np.array([0]), "a.b": np.array([2])}), 1.0, "names differ in letters and digits"),
        (raw_row(quads={"inner": np.array([[5, 6, 8, 7], [1, 2, 4, 3]])}), 1.0, "1 of 2 faces of inner"),
    ],
)
def test_what_makes_no_mesh_is_refused(raw, scale, words):
    with pytest.raises(InputError, match=words):
        ordered_mesh(raw, scale)


def test_coordinates_may_reach_a_thousand_kilometres():
    assert ordered_mesh(raw_row(), 3.3e5).points.max() == pytest.approx(9.9e5)


# What meshio hands over


def handed(cells, data=None, names=None, sets=None):
    blocks = [SimpleNamespace(type=kind, data=np.array(rows)) for kind, rows in cells]
    return SimpleNamespace(
        cells=blocks, cell_data=data or {}, field_data=names or {}, cell_sets=sets or {}, points=np.eye(3)
    )


def groups_of(arrays, what):
    names = json.loads(str(arrays["names"]))[what]
    return {name: arrays[what][arrays[what][:, 0] == k, 1].tolist() for k, name in enumerate(names)}


A, B, C = np.arange(8), np.arange(8) + 8, np.arange(8) + 16
QUADS = [[0, 1, 2, 3], [4, 5, 6, 7], [8, 9, 10, 11]]


def test_groups_of_gmsh_have_the_names_of_their_dimension_and_repeated_cells_count_once():
    """Blocks of quadrilaterals lie between those of hexahedra; number 1 is a surface, 3 a volume, 4 has no name."""
    cells = [
        ("hexahedron", [A, B]),
        ("quad", QUADS[:2]),
        ("hexahedron", [B[::-1], C, A]),
        ("quad", QUADS[2:]),
        ("tetra", [[0, 1, 2, 3]] * 2),
    ]
    tags = [np.array(values) for values in ([3, 3], [1, 4], [4, 4, 0], [1], [0, 0])]
    names = {"side": np.array([1, 2]), "body": np.array([3, 3]), "line": np.array([4, 1])}
    arrays = meshio_child.contents(handed(cells, {"gmsh:physical": tags, "part": None}, names), "gmsh")
    assert sorted(np.sort(arrays["hexahedra"], axis=1)[:, 0].tolist()) == [0, 8, 16]
    first = np.sort(arrays["hexahedra"], axis=1)[:, 0]
    parts = groups_of(arrays, "parts")
    assert {name: sorted(first[rows].tolist()) for name, rows in parts.items()} == {"body": [0, 8], "part-4": [8, 16]}
    assert groups_of(arrays, "sides") == {"side": [0, 2], "side-4": [1]}
    assert arrays["quads"].tolist() == QUADS
    assert json.loads(str(arrays["names"]))["others"] == {"tetra": 2}
    assert arrays["points"].dtype == float


def test_sets_of_cells_count_from_the_blocks_that_they_lie_in():
    cells = [("hexahedron", [A, B]), ("quad", QUADS), ("hexahedron", [C])]
    tags = [np.array(values) for values in ([7, 7], [5, 5, 5], [7])]
    names = {"body": np.array([9, 3]), "side": np.array([5, 2])}
    sets = {
        "body": [np.array([1]), np.array([2]), np.array([0])],
        "side": [np.array([], int), np.array([0, 2]), np.array([], int)],
    }
    arrays = meshio_child.contents(handed(cells, {"gmsh:physical": tags}, names, sets), "gmsh")
    assert groups_of(arrays, "parts") == {"part-7": [0, 1, 2], "body": [1, 2]}
    assert groups_of(arrays, "sides") == {"side": [0, 2]}
    plain = meshio_child.contents(handed(cells, {"MaterialId": tags}, names), "vtu")
    assert groups_of(plain, "parts") == {"part-7": [0, 1, 2]}
    assert groups_of(plain, "sides") == {"side-5": [0, 1, 2]}
    assert groups_of(meshio_child.contents(handed(cells), "vtk"), "parts") == {}


def test_a_file_may_take_memory_and_time_by_its_size(tmp_path, monkeypatch):
    """4 GiB and 20 bytes for each of its own; a minute and a second for each megabyte."""
    asked = []

    def run(words, timeout, **options):
        asked.append((*words[-2:], timeout))
        raise subprocess.TimeoutExpired(words, timeout)

    monkeypatch.setattr("strikewave.fem.mesh_files.subprocess.run", run)
    pytest.importorskip("meshio")
    with pytest.raises(InputError, match="it takes too long; gmsh writes"):
        read_mesh(written(tmp_path, b"x" * 2_400_000, "large.msh"))
    assert asked == [(str(2**32 + 48_000_000), "63", 63)]
