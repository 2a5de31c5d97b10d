"""Solids from STEP by the program gmsh, called from outside: the recipe of docs/exchange.md, and what becomes of it.

gmsh's OpenCASCADE kernel writes the STEP files itself, so that no CAD file comes along. Truth is the CAD solid (volume,
areas, radius), the same frame by our own generator, and the longitudinal frequency of a rod by Love.
"""

import math
import os
import re
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from strikewave.analyses.fem.build import build_model
from strikewave.analyses.fem.run import run_model
from strikewave.base.errors import InputError
from strikewave.cases.case import parse_case
from strikewave.fem.mesh import volumes
from strikewave.fem.mesh_files import read_mesh
from strikewave.fem.model import Controls, Model, Point, RigidWall
from strikewave.fem.quality import quality_report
from strikewave.fem.solids import Elastic
from strikewave.fem.solve import RunOptions, solve

GMSH = shutil.which("gmsh")
HOW_TO_GET = "gmsh is not installed; Debian, Ubuntu: apt-get install --no-install-recommends gmsh; else gmsh.info"
DOCS = Path(__file__).parents[2] / "docs" / "exchange.md"
SECTION = DOCS.read_text("utf-8").partition("## Solids from CAD (STEP)")[2].partition("\n## ")[0]
RECIPES = dict(re.findall(r"```geo\n// (\w+)\.geo: (.*?)```", SECTION, re.DOTALL))
CASE = re.search(r"```toml\n(.*?)```", SECTION, re.DOTALL)[1]
STEEL = Elastic(7800.0, 210e9, 0.3)

pytestmark = pytest.mark.verify


@pytest.fixture(autouse=True)
def tools():
    if GMSH is None:
        (pytest.fail if os.environ.get("CI") == "true" else pytest.skip)(HOW_TO_GET)
    pytest.importorskip("meshio", reason="meshio is not installed: pip install 'strikewave[mesh]'")


def gmsh(folder, script, *options):
    """Run gmsh on a script in a folder."""
    (folder / "script.geo").write_text(script)
    command = [GMSH, "script.geo", "-v", "2", "-nt", "1", *options]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


def meshed(folder, script, *options):
    """Return the mesh that gmsh writes, in m."""
    gmsh(folder, script, "-3", "-o", "part.msh", *options)
    return read_mesh(folder / "part.msh", 1e-3)


def recipe(folder, name, *options):
    """Draw the frame of the docs as STEP and mesh it, by their scripts as they stand."""
    gmsh(folder, "// " + RECIPES["draw"], "-parse_and_exit")
    return meshed(folder, "// " + RECIPES[name], *options)


def area(mesh, side):
    """Area of a side's faces as vectors, m^2."""
    a, b, c, d = (mesh.points[mesh.sides[side][:, k]] for k in range(4))
    return 0.5 * np.cross(c - a, d - b).sum(axis=0)


@pytest.mark.parametrize("name", ["solid", "extruded"])
def test_the_recipe_gives_volume_areas_and_names_of_the_cad_solid(name, tmp_path):
    """All faces are flat: sums over elements are those of the solid but for rounding (coordinates in the file: 16 digits)."""
    mesh = recipe(tmp_path, name)
    (row,) = quality_report(mesh)
    assert row.part == "frame"
    assert row.volume == pytest.approx(60e-3 * 20e-3 * 80e-3 - 40e-3 * 20e-3 * 60e-3, rel=1e-12)
    assert sorted(mesh.sides) == ["frame.bottom", "frame.top"]
    np.testing.assert_allclose(area(mesh, "frame.bottom"), [0.0, 0.0, -1.2e-3], rtol=1e-12, atol=1e-15)
    np.testing.assert_allclose(area(mesh, "frame.top"), [0.0, 0.0, 1.2e-3], rtol=1e-12, atol=1e-15)
    assert row.scaled_jacobian > (0.1 if name == "solid" else 0.4)


# A pin, drawn in m


PIN = """SetFactory("OpenCASCADE");
Cylinder(1) = {0, 0, 0, 0, 0, 0.06, 0.005};
Save "part.step";
"""


def pin(folder, turns, size=4.0):
    """A pin of 10 mm diameter and 60 mm length, its STEP file in m: tetrahedra around it by the curvature."""
    gmsh(folder, PIN, "-parse_and_exit")
    step = folder / "part.step"
    text = step.read_text()
    assert text.count("SI_UNIT(.MILLI.,.METRE.)") == 1
    step.write_text(text.replace("SI_UNIT(.MILLI.,.METRE.)", "SI_UNIT($,.METRE.)"))
    script = RECIPES["solid"].replace('"frame"', '"pin"').replace("Curvature = 12", f"Curvature = {turns}")
    script += 'Physical Surface("round") = Surface In BoundingBox{-5.1, -5.1, -0.1, 5.1, 5.1, 60.1};\n'
    return meshed(folder, "// " + script, "-setnumber", "size", str(size))


def test_nodes_lie_on_the_round_face_and_the_missing_volume_falls_as_its_square(tmp_path):
    """Twice the flat faces around leave a quarter of what is missing, which is less than of a prism of n sides.

    That lacks 2 pi^2 / 3 n^2; rows of faces on the mantle are staggered, so that a mesh lacks less.
    """
    missing = []
    for turns in (8, 16):
        mesh = pin(tmp_path, turns)
        radius, z = np.hypot(*mesh.points[:, :2].T), mesh.points[:, 2]
        hull = np.unique(mesh.sides["pin.round"])
        ends = np.isclose(z[hull], 0.0, atol=1e-9) | np.isclose(z[hull], 0.06, atol=1e-9)
        np.testing.assert_allclose(radius[hull][~ends], 5e-3, rtol=1e-9)
        exact = math.pi * 5e-3**2 * 0.06
        missing.append(1.0 - volumes(mesh.points, mesh.hexahedra).sum() / exact)
        assert 0.0 < missing[-1] < 2.0 * math.pi**2 / (3.0 * (2 * turns) ** 2)
        np.testing.assert_allclose(area(mesh, "pin.round"), 0.0, atol=1e-12)
    assert math.log2(missing[0] / missing[1]) == pytest.approx(2.0, abs=0.2)


def test_a_pin_that_fell_on_its_end_rings_at_the_frequency_of_love(tmp_path):
    """c0 / 2L over the root of 1 + (pi nu r / L)^2 / 2 (Love 1892); here nearer than 1e-3, over 5 periods."""
    mesh = pin(tmp_path, 8)
    length, radius, c = 0.06, 5e-3, math.sqrt(STEEL.youngs_modulus / STEEL.density)
    love = c / (2.0 * length) / math.sqrt(1.0 + 0.5 * (math.pi * STEEL.poissons_ratio * radius / length) ** 2)
    model = Model(
        mesh,
        {"pin": STEEL},
        Controls(150e-6, interval=0.25e-6),
        velocity={"pin": (0.0, 0.0, -1.0)},
        walls=(RigidWall("pin.round", (0.0, 0.0, 0.0), (0.0, 0.0, 1.0)),),
        points=(Point("top", "pin", (0.0, 0.0, length)),),
    )
    run = solve(model, RunOptions())
    assert not run.stopped
    assert np.abs(run.energy_error).max() < 1e-4
    assert run.energy["hourglass"].max() < 0.05 * run.energy["internal"].max()
    free = run.time > 30e-6
    assert np.abs(run.force["pin.round-wall"][free]).max() == 0.0
    motion = (run.points["top"].displacement - run.parts["pin"].displacement)[free, 2]
    spectrum = np.abs(np.fft.rfft(motion * np.hanning(len(motion)), 1 << 17))
    assert np.fft.rfftfreq(1 << 17, 0.25e-6)[spectrum.argmax()] == pytest.approx(love, rel=2e-3)


# The frame beside our own mesh of it


def fallen(folder, replaced=""):
    """Solve the case of the docs for 60 us, which the contact lasts half of; replaced: another shape than the file."""
    text = CASE.replace('duration = "1 ms"', 'duration = "60 us"')
    if replaced:
        text = re.sub(r'shape = "file".*?unit = "mm"', replaced, text, flags=re.DOTALL)
    text = text.replace('"part.msh"', f'"{folder / "part.msh"}"')
    case = parse_case(text, "frame")
    return run_model(case, build_model(case), RunOptions())


OWN = """shape = "frame"
width = "60 mm"
depth = "20 mm"
height = "80 mm"
left = "10 mm"
right = "10 mm"
bottom = "12 mm"
top = "8 mm"
size = "2 mm"
"""


def test_the_frame_falls_as_our_own_mesh_of_it_nearer_with_smaller_elements(tmp_path):
    """Mass but for rounding; impulse of the wall within 2 % and 1 %, energy and hourglass modes within their limits."""
    own = fallen(tmp_path, OWN)
    off = []
    for size, most in ((16, 0.02), (8, 0.01)):
        recipe(tmp_path, "solid", "-setnumber", "size", str(size))
        found = fallen(tmp_path)
        assert found.parts["frame"].mass == pytest.approx(own.parts["frame"].mass, rel=1e-12)
        off.append(abs(found.contacts["frame.bottom-wall"].impulse / own.contacts["frame.bottom-wall"].impulse - 1.0))
        assert off[-1] < most
        assert np.abs(found.run.energy_error).max() < 1e-4
    assert off[1] < off[0]
    assert not found.broken, found.warnings


# What else gmsh may write

TWO = """SetFactory("OpenCASCADE");
Box(1) = {0, 0, 0, 10, 10, 10};
Box(2) = {0, 0, 10, 10, 10, 10};
Save "part.step";
"""
GROUPS = """SetFactory("OpenCASCADE");
v() = ShapeFromFile("part.step");
DefineConstant[ bonded = 0, version = 4.1, split = 2 ];
If (bonded)
  Coherence;
EndIf
Physical Volume("lower cube") = Volume In BoundingBox{-1, -1, -1, 11, 11, 11};
Physical Volume("upper") = Volume In BoundingBox{-1, -1, 9, 11, 11, 21};
Physical Volume("everything") = Volume{:};
Physical Surface("foot") = Surface In BoundingBox{-1, -1, -1, 11, 11, 1};
Physical Surface("joint") = Surface In BoundingBox{-1, -1, 9, 11, 11, 11};
Physical Surface("skin") = Surface{:};
Mesh.MeshSizeMax = 8;
Mesh.SubdivisionAlgorithm = split;
Mesh.MshFileVersion = version;
"""


@pytest.mark.parametrize("options", [("-bin",), (), ("-setnumber", "version", "2.2")])
@pytest.mark.parametrize("bonded", [0, 1])
def test_what_is_in_several_physical_groups_is_in_each_of_them(options, bonded, tmp_path):
    """Sides have their whole area, 1 cm^2 a face of the cubes, and each element counts once: 1 cm^3 a cube."""
    gmsh(tmp_path, TWO, "-parse_and_exit")
    mesh = meshed(tmp_path, GROUPS, "-setnumber", "bonded", str(bonded), *options)
    assert sorted(mesh.names) == ["lower-cube", "upper"]
    assert [row.volume for row in quality_report(mesh)] == pytest.approx([1e-6, 1e-6], rel=1e-12)
    names = ["lower-cube.foot", "lower-cube.joint", "lower-cube.skin", "upper.joint", "upper.skin"]
    assert sorted(mesh.sides) == names
    for name, cm2 in zip(names, (1, 1, 6, 1, 6), strict=True):
        a, b, c, d = (mesh.points[mesh.sides[name][:, k]] for k in range(4))
        assert 0.5e4 * np.linalg.norm(np.cross(c - a, d - b), axis=1).sum() == pytest.approx(cm2, rel=1e-12)
    common = np.intersect1d(mesh.nodes_of("lower-cube"), mesh.nodes_of("upper"))
    assert (len(common) > 0) == bool(bonded)


@pytest.mark.parametrize(
    ("options", "word"),
    [
        (("-setnumber", "split", "0"), "tetra.*SubdivisionAlgorithm = 2"),
        (("-save_all",), "Mesh.MshFileVersion 4.1"),
        (("-setnumber", "Mesh.SaveParametric", "1"), "SaveParametric 0"),
        (("-setnumber", "version", "4"), "Mesh.MshFileVersion 4.1"),
        (("-setnumber", "Mesh.ElementOrder", "2"), "hexahedra of 8 nodes"),
    ],
)
def test_what_cannot_be_read_of_gmsh_says_what_to_do(options, word, tmp_path):
    gmsh(tmp_path, TWO, "-parse_and_exit")
    with pytest.raises(InputError, match=word):
        meshed(tmp_path, GROUPS, *options)
