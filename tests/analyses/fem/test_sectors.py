"""Sectors of bodies: what whole bodies come to, also beside those meshed whole; cuts that nothing holds; groups."""

import contextlib
import dataclasses
import functools
import io
import json
import math
import os
import re
from types import SimpleNamespace
from unittest import mock

import numpy as np
import pytest

from strikewave import load_case
from strikewave.analyses.compare.simulated import arrays_curve
from strikewave.analyses.fem.build import build_model
from strikewave.analyses.fem.notices import model_notices
from strikewave.analyses.fem.report import fem_report, fem_words, picture
from strikewave.analyses.fem.run import run_fem
from strikewave.analyses.fem.screen import show
from strikewave.analyses.fem.sectors import blow_of_bodies, of_whole_bodies, open_cuts, sectors
from strikewave.fem.model import Fixed, Guided, Rigid
from strikewave.fem.run import PartHistory
from strikewave.reporting.numbers import ShownUnits, showing
from strikewave.studies.simulation import Simulation, number_units
from strikewave.web.pages.case.elements_view import history_charts

BARS = """
schema = 1
{striker}
velocity = {{ z = "2 m/s" }}
{bar}
at = {{ z = "10 mm" }}
[fem]
duration = "12 us"
interval = "0.1 us"
frames = 0
[[fem.contact]]
first = "striker.z+"
second = "bar.z-"
[[fem.group]]
name = "both"
parts = ["striker", "bar"]
{boundaries}
"""
BLOCK = """
[[mesh.part]]
name = "{name}"
shape = "block"
material = "65Mn"
width = "4 mm"
depth = "4 mm"
height = "{height}"
size = "1 mm"
sector = "{sector}"
"""
SYMMETRY = '[[fem.boundary]]\nkind = "symmetry"\nside = "{}"\n'


def case_of(tmp_path, sector, held=True):
    cuts = {"whole": [], "half": ["y-"], "quarter": ["x-", "y-"]}[sector] if held else []
    parts = [("striker", "10 mm"), ("bar", "20 mm")]
    blocks = {name: BLOCK.format(name=name, height=height, sector=sector) for name, height in parts}
    rows = [SYMMETRY.format(f"{name}.{cut}") for name, _ in parts for cut in cuts]
    (tmp_path / f"{sector}.toml").write_text(BARS.format(**blocks, boundaries="".join(rows)))
    return load_case(str(tmp_path / f"{sector}.toml"))


def test_each_blow_names_the_body_of_its_rigid_peak_a_group_first(tmp_path, capsys, monkeypatch):
    from strikewave.analyses.fem.report import blows_section
    from strikewave.analyses.fem.screen import show
    from strikewave.reporting.parts import written

    case_of(tmp_path, "half")
    text = (tmp_path / "half.toml").read_text()
    text = text.replace("frames = 0", "frames = 0\nblows = 2").replace('"both"', '"object"')
    (tmp_path / "two.toml").write_text(text.replace('parts = ["striker", "bar"]', 'parts = ["bar"]'))
    solution = run_fem(load_case(str(tmp_path / "two.toml")))
    peaks = [["object", written(each.groups["object"].rigid_peak / 9.80665, 5)] for each in solution.blows]
    assert solution.parts["striker"].rigid_peak > solution.groups["object"].rigid_peak
    forces, *_ = blows_section(solution).parts
    places = [forces.columns.index(head) for head in ("body", "rigid peak (g)")]
    assert [[row[place] for place in places] for row in forces.rows] == peaks
    monkeypatch.setenv("COLUMNS", "200")
    show(solution)
    table = capsys.readouterr().out.partition("Blow after blow")[2].partition("Yield in each blow")[0]
    assert table.count(" object ") == 2


def test_groups_come_before_parts_free_ones_before_held_ones_and_the_heavy_before_the_light(bars_of_many):
    model, run = bars_of_many
    assert list(blow_of_bodies(model, run)) == ["crate", "light", "heavy", "ground", "still"]


@pytest.fixture
def bars_of_many():
    """Histories of five bodies that move by the clock."""
    time = np.linspace(0.0, 1.0, 11)

    def moving(mass, speed):
        velocity = np.outer(speed * time**2, [0.0, 0.0, 1.0])
        return PartHistory(mass, velocity, np.zeros((11, 3)), np.zeros((11, 3)))

    parts = {
        "ground": moving(500.0, 1.0),
        "heavy": moving(9.0, 1.0),
        "light": moving(12.0, 90.0),
        "still": moving(99, 0),
    }
    model = SimpleNamespace(boundaries=(Fixed("ground.bottom"), Guided("heavy", (0.0, 0.0, 1.0))))
    run = SimpleNamespace(time=time, parts=parts, groups={"crate": moving(1.0, 0.1)}, von_mises={}, plastic_strain={})
    return model, run


def test_forces_across_a_plane_of_symmetry_cancel(tmp_path):
    """A force aslant on a quarter: twice nothing across, four times what lies in both planes."""
    case = case_of(tmp_path, "quarter")
    solution = run_fem(case)
    (name,) = solution.contacts
    time, sector_of = solution.run.time, sectors(case, solution.model)
    slanted = dataclasses.replace(solution.model_run, impulse={name: np.outer(time, [3.0, -2.0, 5.0])})
    found = of_whole_bodies(solution.model, slanted, sector_of)
    assert found.impulse[name] == pytest.approx(np.outer(time, [0.0, 0.0, 20.0]), rel=1e-9, abs=1e-15)
    mixed = {**sector_of, "bar": sectors(case_of(tmp_path, "whole"), solution.model)["bar"]}
    found = of_whole_bodies(solution.model, slanted, mixed)
    assert found.impulse[name] is slanted.impulse[name]
    assert found.parts["striker"].mass == 4.0 * slanted.parts["striker"].mass
    assert found.parts["bar"].mass == slanted.parts["bar"].mass
    assert found.initial_energy == slanted.initial_energy


def test_sectors_that_do_not_match_are_reported(tmp_path):
    case_of(tmp_path, "quarter")
    text = (tmp_path / "quarter.toml").read_text()
    first, second, rest = text.partition('sector = "quarter"')
    (tmp_path / "mixed.toml").write_text(
        (first + second + rest.replace('"quarter"', '"half"')).replace(SYMMETRY.format("bar.x-"), "")
    )
    case = load_case(str(tmp_path / "mixed.toml"))
    (notice,) = model_notices(case, build_model(case))
    assert notice.code == "sectors-differ"
    assert notice.message.startswith("striker and bar are sectors that other parts do not match")
    words = fem_words(run_fem(case))
    assert "Meshed is a half of bar and a quarter of striker; masses are those of whole bodies" in words
    alike = case_of(tmp_path, "quarter")
    assert not list(model_notices(alike, build_model(alike)))


def test_a_cut_that_nothing_holds_is_said_before_and_after_a_run(tmp_path, strikewave):
    case = case_of(tmp_path, "half", held=False)
    model = build_model(case)
    found = sectors(case, model)
    assert list(open_cuts(model, found)) == ["striker.y-", "bar.y-"]
    (notice,) = model_notices(case, model)
    assert notice.code == "cut-without-symmetry"
    assert 'kind = "symmetry", side = "striker.y-"' in notice.message
    assert "cut-without-symmetry" in {notice.code for notice in run_fem(case).warnings}
    code, out, err = strikewave("fem", str(tmp_path / "half.toml"), "--check", "--json")
    assert code == 0
    assert [w["code"] for w in json.loads(out)["warnings"]] == ["cut-without-symmetry"]
    assert "warning [cut-without-symmetry]" in err
    guided = dataclasses.replace(model, boundaries=(Guided("striker", (0.0, 0.0, 1.0)), Guided("bar", (0.0, 1.0, 0.0))))
    assert list(open_cuts(guided, found)) == ["bar.y-"]  # what is guided along the cut's normal is not held there
    still = (False, False, False)
    rigid = dataclasses.replace(model, rigid=(Rigid("striker", (True, False, True), still), Rigid("bar")))
    assert list(open_cuts(rigid, found)) == ["bar.y-"]
    tumbling = dataclasses.replace(model, rigid=(Rigid("striker", (True, False, True)), Rigid("bar", rotations=still)))
    assert list(open_cuts(tumbling, found)) == ["striker.y-", "bar.y-"]
    assert not list(open_cuts(build_model(case_of(tmp_path, "quarter")), sectors(case, model)))


def test_a_group_moves_as_the_sum_of_its_parts(tmp_path, strikewave):
    """Momentum over mass: what two bars that meet keep together, to rounding."""
    case = case_of(tmp_path, "half")
    solution = run_fem(case)
    run, group = solution.run, solution.run.groups["both"]
    parts = run.parts.values()
    assert group.mass == pytest.approx(sum(part.mass for part in parts), rel=1e-12)
    assert group.mass * group.velocity == pytest.approx(sum(part.mass * part.velocity for part in parts), abs=1e-12)
    assert group.velocity[:, 2] == pytest.approx(2.0 / 3.0, rel=1e-9)  # 10 mm of 30 mm came with 2 m/s
    assert solution.groups["both"].rigid_peak < 1e-6 * solution.parts["bar"].rigid_peak
    assert solution.document()["groups"]["both"]["sectors"] == 2
    assert "group.both.mean_acceleration" in solution.data
    assert "both velocity z [m/s]" in solution.history_table().splitlines()[0].split(",")
    text = (tmp_path / "half.toml").read_text()
    for good, bad, said in (
        ('["striker", "bar"]', '["striker", "baar"]', 'did you mean "bar"'),
        ('["striker", "bar"]', '["bar", "bar"]', "each part once"),
        ('["striker", "bar"]', "[]", "fem.group.both.parts"),
        ('"both"', '"bar"', "a name that no part has"),
    ):
        (tmp_path / "bad.toml").write_text(text.replace(good, bad))
        code, _, err = strikewave("fem", str(tmp_path / "bad.toml"), "--check")
        assert code == 2
        assert said in err


@pytest.mark.verify
@pytest.mark.parametrize(("finest", "coarse", "within"), [("0.8 mm", True, 0.1), ("0.3 mm", False, 0.02)])
def test_a_contact_of_few_faces_is_said_and_one_of_enough_is_near_hertz(finest, coarse, within):
    """Johnson 1985, ch. 11.4: a contact radius of 0.48 mm at the peak."""
    sizes = [f"mesh.part.{name}.finest={finest}" for name in ("ball", "ground")]
    solution = run_fem(load_case("hertz-ball-fem", [*sizes, "fem.frames=0"]))
    stiffness = 4.0 / 3.0 * 211e9 / (2.0 * (1.0 - 0.288**2)) * math.sqrt(10e-3)
    peak = stiffness**0.4 * (1.25 * solution.parts["ball"].mass) ** 0.6
    off = abs(solution.contact_force_peak / peak - 1.0)
    assert off < within
    assert (off > 0.04) == coarse
    assert ("contact-coarse" in {notice.code for notice in solution.warnings}) == coarse


def test_flat_faces_that_meet_wholly_are_no_coarse_contact(tmp_path):
    """Four faces are pressed, all there are."""
    case_of(tmp_path, "whole")
    text = (tmp_path / "whole.toml").read_text()
    (tmp_path / "coarse.toml").write_text(text.replace('size = "1 mm"', 'size = "2 mm"'))
    solution = run_fem(load_case(str(tmp_path / "coarse.toml")))
    (pressed,) = solution.run.pressed.values()
    assert pressed.shape[1:] == (2, 2)
    assert pressed.max(axis=0) == pytest.approx(np.array([[1.0, 4.0], [1.0, 4.0]]))
    assert "contact-coarse" not in {notice.code for notice in solution.warnings}


CASE = """
schema = 1
name = "bars"
{parts}
[fem]
duration = "12 us"
interval = "0.5 us"
frames = 0
blows = 2
least_step = "120 ns"
[[fem.contact]]
first = "striker.z+"
second = "bar.z-"
[[fem.wall]]
side = "bar.z+"
point = {{ z = "30 mm" }}
normal = {{ z = -1 }}
[[fem.group]]
name = "both"
parts = ["striker", "bar"]
[[fem.section]]
name = "across"
part = "bar"
point = {{ z = "12.1 mm" }}
normal = "z"
[[fem.section]]
name = "along"
part = "bar"
point = {{ x = "0.9 mm" }}
normal = "x"
[[fem.point]]
name = "corner"
part = "bar"
place = {{ x = "2 mm", y = "2 mm", z = "20 mm" }}
{boundaries}
"""
PART = """
[[mesh.part]]
name = "{name}"
shape = "block"
width = "4 mm"
depth = "4 mm"
height = "{height}"
size = "1 mm"
sector = "{sector}"
{place}
[mesh.part.solid]
law = "bilinear"
density = "7800 kg/m^3"
modulus = "210 GPa"
poissons_ratio = 0.3
yield_strength = "{strength}"
tangent_modulus = "2 GPa"
"""
CUTS = {"whole": [], "half": ["y-"], "quarter": ["x-", "y-"]}
PIECES = {"half": 2, "quarter": 4}
OF_THE_MESH = {"elements", "nodes", "steps", "seconds", "element_steps_per_second", "sectors"}
"""Keys beside those that begin with ``model_`` that say what is meshed."""
BALANCES = {"error", "energy_error", "momentum_error", "hourglass_share", "kinetic_share"}
"""Errors: rounding, not numbers of the bodies."""
SAME = 2e-3
"""Of the largest of a history or a number: the same elements, but sums run in another order and rounding decides when a
point of contact or of yield is reached; 1e-3 is the most that 144 steps of two blows came to."""
SUMMED_KEYS = {
    "peak",
    "impulse",
    "whole_peak",
    "whole_impulse",
    "mass",
    "whole_mass",
    "contact_force_peak",
    "added_mass",
}
SUMMED_KEYS |= {"initial", "kinetic", "internal", "plastic", "contact", "viscous", "hourglass", "striker", "bar"}
"""Keys of numbers that are sums over a body; plastic energy is by part."""
TABLES = ("Contacts and walls", "Parts, each as one rigid body", "Forces of each blow")
NUMBER = re.compile(r"(?<![\w.])\d+(?:\.\d+)?(?:e[-+]?\d+)?")


@functools.cache
def solution_of(sector, folder):
    rows = [("striker", "10 mm", 'velocity = { z = "40 m/s" }', "400 MPa")]
    rows += [("bar", "20 mm", 'at = { z = "10 mm" }', "300 MPa")]
    parts = "".join(PART.format(name=n, height=h, place=p, sector=sector, strength=s) for n, h, p, s in rows)
    cuts = [f'[[fem.boundary]]\nkind = "symmetry"\nside = "{n}.{c}"\n' for n, *_ in rows for c in CUTS[sector]]
    path = folder / f"{sector}.toml"
    path.write_text(CASE.format(parts=parts, boundaries="".join(cuts)))
    return run_fem(load_case(str(path)))


@pytest.fixture(scope="module")
def solved(tmp_path_factory):
    folder = tmp_path_factory.mktemp("sectors")
    return lambda sector: solution_of(sector, folder)


def leaves(value, path=""):
    """Yield every number of a document with its path."""
    if isinstance(value, dict):
        for key, inner in value.items():
            if key not in OF_THE_MESH | BALANCES and not key.startswith("model_"):
                yield from leaves(inner, f"{path}.{key}")
    elif isinstance(value, list):
        for place, inner in enumerate(value):
            yield from leaves(inner, f"{path}[{place}]")
    elif isinstance(value, int | float) and not isinstance(value, bool):
        yield path, np.asarray(float(value))


def of_json(solution):
    return dict(leaves(solution.content()))


def of_csv(solution):
    tables = {}
    for name, text in solution.tables().items():
        heads = text.splitlines()[0].split(",")
        rows = np.genfromtxt(io.StringIO(text), delimiter=",", skip_header=1)
        tables |= {f"{name} {head}": column for head, column in zip(heads, rows.T, strict=True)}
    return {name: column for name, column in tables.items() if "error" not in name}


def of_netcdf(solution):
    named = [
        (f"{file} {name}", v) for file, arrays in solution.datasets().items() for name, v in arrays.variables.items()
    ]
    shown = {name: v.values for name, v in named if " model_" not in name and not name.endswith(".error")}
    return {name: values for name, values in shown.items() if values.dtype.kind == "f"}


def of_picture(solution):
    figure = picture(solution)
    drawn = {(k, n): line for k, axes in enumerate(figure.axes) for n, line in enumerate(axes.lines)}
    return {
        f"axes {k} ({figure.axes[k].get_ylabel()}) line {n}": np.asarray(line.get_ydata(), float)
        for (k, n), line in drawn.items()
        if "error" not in figure.axes[k].get_ylabel()
    }


def of_app(solution):
    charts = history_charts(solution)
    return {f"{k} {line['name']}": np.array(line["data"], float) for k, x in enumerate(charts) for line in x["series"]}


def of_studies(solution):
    study = Simulation(solution.case)
    study.__dict__["elements"] = solution
    numbers = {
        (name, body): study.number(name, body)
        for name in number_units(solution.case)
        for body in ("bar", "striker")
        if name not in BALANCES
    }
    return {f"{name} {body}": np.asarray(value, float) for (name, body), value in numbers.items() if value is not None}


def of_compare(solution):
    parts = ("striker.z+-bar.z-", "bar.z+-wall", "bar", "both")
    curves = {part: arrays_curve("--to", "bars", solution.arrays, part, 0, "") for part in parts}
    return {part: np.asarray(curve.history.values) for part, curve in curves.items()}


def of_words(solution, page=""):
    """The screen, its first sentences, the head of a notebook, and the tables of a report."""
    screen = io.StringIO()
    with mock.patch.dict(os.environ, COLUMNS="300"), contextlib.redirect_stdout(screen):  # a minus sign moves no line
        show(solution)
    lines = [line for line in screen.getvalue().splitlines() if "balance" not in line and "steps" not in line]
    lines += [fem_words(solution).partition("The energy balance")[0]]
    lines += [f"{name} {value}" for name, value in solution.highlights() if name != "elements"]
    captions = [page.find(f"{name}<") for name in TABLES if page]
    lines += [re.sub(r"<[^>]*>", " ", page[at : page.index("</table>", at)]) for at in captions]
    errors = re.compile(r"[-+]?\d(\.\d+)?e-\d+")
    return {f"line {place}": np.array(NUMBER.findall(errors.sub("", x)), float) for place, x in enumerate(lines)}


FACES = (of_json, of_csv, of_netcdf, of_picture, of_app, of_studies, of_compare)


def scales(values):
    """Return what the numbers of each path are held against: the largest over all blows and components of its kind."""
    kinds = {}
    for name, array in values.items():
        kind = re.sub(r"\[\d+\]|-\d|[xyz]{1,2}(?= \[)", "", name)
        kinds[kind] = max(kinds.get(kind, 0.0), float(np.nan_to_num(np.abs(array)).max(initial=0.0)))
    return {name: kinds[re.sub(r"\[\d+\]|-\d|[xyz]{1,2}(?= \[)", "", name)] for name in values}


def differences(face, whole, sector):
    """Return where a face of two results differs."""
    expected, got = face(whole), face(sector)
    assert expected.keys() == got.keys()
    assert len(expected) > 3
    scale = scales(expected)
    return [
        name
        for name, values in expected.items()
        if got[name].shape != values.shape
        or not np.allclose(got[name], values, rtol=0.0, atol=SAME * max(scale[name], 1e-12), equal_nan=True)
    ]


@pytest.mark.parametrize("face", FACES)
@pytest.mark.parametrize("sector", PIECES)
def test_a_sector_comes_to_the_numbers_of_the_whole_bodies_on_every_face(solved, sector, face):
    assert differences(face, solved("whole"), solved(sector)) == []


@pytest.mark.parametrize("sector", PIECES)
def test_the_screen_shows_the_numbers_of_whole_bodies(solved, sector):
    """Digit by digit: 5 of them at most, and a place may be in any of the sectors."""
    expected, got = of_words(solved("whole")), of_words(solved(sector))
    assert len(expected) > 40
    for line, values in expected.items():
        assert got[line] == pytest.approx(values, rel=SAME), line


@pytest.mark.verify
def test_the_report_shows_the_numbers_of_whole_bodies(solved):
    expected, got = (of_words(one, fem_report(one)) for one in (solved("whole"), solved("quarter")))
    assert len(expected) > len(of_words(solved("whole")))
    for line, values in expected.items():
        assert got[line] == pytest.approx(values, rel=SAME), line


@pytest.mark.usefixtures("undrawn")
def test_parts_and_their_solids_stand_on_the_page_in_the_chosen_units(solved):
    with showing(ShownUnits.read("Pa,km/h,gram/cm^3")):
        page = fem_report(solved("quarter"))
    heads = ("density (gram/cm³)", "E (Pa)", "initial velocity (km/h)")
    assert [head for head in heads if f">{head}<" not in page] == []


@pytest.mark.parametrize("face", FACES)
def test_the_walk_sees_a_face_that_is_made_of_the_sector(solved, face):
    """Each sum over a body differs where a face shows the run as meshed, and so does one at least on every face."""
    as_meshed = dataclasses.replace(
        solved("quarter"), run=solved("quarter").model_run, later=solved("quarter").modelled[1:]
    )
    seen = differences(face, solved("whole"), as_meshed)
    assert seen
    if face is of_json:
        keys = {name.rpartition(".")[2] for name in seen}
        assert keys >= SUMMED_KEYS
        document = as_meshed.content()
        zero = {name for name, value in solved("whole").content()["energy"].items() if not value}
        assert zero == {"external"}
        assert document["contact_force_peak"] == pytest.approx(solved("whole").contact_force_peak / 4.0, rel=0.01)


@pytest.mark.parametrize(("sector", "pieces"), PIECES.items())
def test_what_is_meshed_has_names_of_its_own(solved, sector, pieces):
    solution, document = solved(sector), solved(sector).content()
    for kind in ("parts", "groups"):
        for row in document[kind].values():
            assert row["sectors"] == pieces
            assert row["mass"] == row["whole_mass"] == pytest.approx(pieces * row["model_mass"], rel=1e-12)
    for row in document["contacts"].values():
        assert (row["whole_peak"], row["whole_impulse"]) == (row["peak"], row["impulse"])
        assert row["model_impulse"] == pytest.approx(row["impulse"] / pieces, rel=0.01)
    assert document["contact_force_peak"] > 1.9 * document["model_contact_force_peak"]
    assert document["added_mass"] == pieces * document["model_added_mass"] > 0.0
    for name, value in document["model_energy"].items():
        assert document["energy"][name] == pieces * value
    arrays = solution.arrays
    assert np.array_equal(arrays["model_energy.kinetic"].values * pieces, arrays["energy.kinetic"].values)
    assert np.array_equal(arrays["model_contact.bar.z+-wall.force"].values, solution.model_run.force["bar.z+-wall"])
    assert not [name for name in solved("whole").arrays.variables if name.startswith("model_")]
    assert f"Meshed is a {sector} of striker and bar" in fem_words(solution)
    assert "Meshed" not in fem_words(solved("whole"))
    assert set(solution.units()) >= {key for key in document if key.startswith("model_") and key != "model_energy"}


@pytest.mark.verify
def test_histories_kept_before_forces_were_of_whole_bodies_are_refused_where_a_sector_is_meshed(solved, tmp_path):
    from strikewave import InputError, compare

    file = tmp_path / "histories.nc"
    asked = f"{file}:bar"
    for sector in ("quarter", "whole"):
        for schema in (1, 2):
            solved(sector).arrays.with_attributes({"strikewave_schema": schema}).write(file)
            if (sector, schema) == ("quarter", 1):
                with pytest.raises(InputError, match="its forces are those of the meshed sector; run the case again"):
                    compare(asked, asked)
            else:
                assert compare(asked, asked).content()["metrics"]["peak"]["difference"] == 0.0
