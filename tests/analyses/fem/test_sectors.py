"""Sectors of bodies: what whole bodies come to, cuts that nothing holds, groups of parts, contacts of few faces."""

import dataclasses
import json
import math
import re
from types import SimpleNamespace

import numpy as np
import pytest

from strikewave import load_case
from strikewave.analyses.fem.build import build_model
from strikewave.analyses.fem.notices import model_notices
from strikewave.analyses.fem.run import run_fem
from strikewave.analyses.fem.sectors import Sector, blow_of_bodies, open_cuts, sectors, whole_forces
from strikewave.fem.measures import part_measure
from strikewave.fem.model import Fixed, Guided, Rigid
from strikewave.fem.run import PartHistory

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


@pytest.mark.parametrize(("sector", "pieces"), [("half", 2), ("quarter", 4)])
def test_sectors_come_to_the_numbers_of_the_whole_bodies(tmp_path, sector, pieces):
    """The whole, meshed and run, and its half and quarter: 1e-4, the sums of nodal masses in another order by steps."""
    whole, part = run_fem(case_of(tmp_path, "whole")), run_fem(case_of(tmp_path, sector))
    (name,) = whole.contacts
    assert part.wholes[name].peak == pytest.approx(whole.contacts[name].peak, rel=1e-4)
    assert part.wholes[name].impulse == pytest.approx(whole.contacts[name].impulse, rel=1e-4)
    for body in ("striker", "bar", "both"):
        one, other = (found.parts.get(body) or found.groups[body] for found in (part, whole))
        assert one.rigid_peak == pytest.approx(other.rigid_peak, rel=1e-4, abs=1.0)
        assert one.velocity_change == pytest.approx(other.velocity_change, rel=1e-4, abs=1e-9)
    assert part.contacts[name].peak == pytest.approx(whole.contacts[name].peak / pieces, rel=0.01)
    document = part.document()
    assert document["parts"]["bar"]["sectors"] == pieces
    assert document["parts"]["bar"]["whole_mass"] == pytest.approx(whole.parts["bar"].mass, rel=1e-9)
    assert document["contacts"][name]["whole_peak"] == part.wholes[name].peak
    assert whole.wholes == {name: None}
    assert "whole_peak" not in whole.document()["contacts"][name]


@pytest.mark.verify
def test_the_report_says_what_is_a_sector_and_names_no_other_solver(tmp_path):
    from strikewave.analyses.fem.report.page import fem_report

    solution = run_fem(case_of(tmp_path, "half"))
    page = fem_report(solution)
    assert "Sectors: striker is a half of its body" in page
    assert "peak force, whole bodies (kN)" in page
    assert "both (half)" in page
    assert "[solver]" not in page
    assert "Sectors:" not in (whole := fem_report(run_fem(case_of(tmp_path, "whole"))))
    assert "whole bodies" not in whole


@pytest.mark.verify
def test_the_report_begins_with_the_force_of_whole_bodies_and_a_named_body(tmp_path):
    """Cards and summary: four times the force of a quarter."""
    from strikewave.analyses.fem.report.page import fem_report
    from strikewave.reporting.numbers import with_unit
    from strikewave.reporting.parts import written

    solution = run_fem(case_of(tmp_path, "quarter"))
    page = re.sub(r"<[^>]*>", " ", fem_report(solution))
    (whole,) = solution.wholes.values()
    summary = page[page.index("Summary") : page.index("Contacts and walls")]
    peak, impulse = with_unit(whole.peak, "N", "kN"), written(whole.impulse)
    whole_peak = r"\s".join(map(re.escape, peak.split(" ")))  # no line ends between a number and its unit
    assert re.search(rf"contact force, peak, whole bodies\s+{whole_peak}", summary)
    assert f"reaches {peak}, lasts" in summary
    assert f"carries {impulse} N s, of whole bodies" in summary
    # the bars together do not change their velocity: the heavier of the two is the first that does
    assert "rigid-body peak of bar" in summary


def test_each_blow_names_the_body_of_its_rigid_peak_a_group_first(tmp_path, capsys, monkeypatch):
    from strikewave.analyses.fem.report.blows import blows_section
    from strikewave.analyses.fem.screen import show
    from strikewave.reporting.parts import written

    case_of(tmp_path, "half")
    text = (tmp_path / "half.toml").read_text()
    text = text.replace("frames = 0", "frames = 0\nblows = 2").replace('"both"', '"object"')
    (tmp_path / "two.toml").write_text(text.replace('parts = ["striker", "bar"]', 'parts = ["bar"]'))
    solution = run_fem(load_case(str(tmp_path / "two.toml")))
    peaks = [f"object: {written(each.groups['object'].rigid_peak / 9.80665)}" for each in solution.blows]
    assert solution.parts["striker"].rigid_peak > solution.groups["object"].rigid_peak
    forces, *_ = blows_section(solution).parts
    place = forces.columns.index("rigid peak (g)")
    assert [row[place] for row in forces.rows] == peaks
    monkeypatch.setenv("COLUMNS", "200")
    show(solution)
    assert capsys.readouterr().out.count("object: ") == 2


def test_groups_come_before_parts_free_ones_before_held_ones_and_the_heavy_before_the_light(bars_of_many):
    model, run, found = bars_of_many
    assert list(blow_of_bodies(model, run, found)) == ["crate", "light", "heavy", "ground", "still"]


@pytest.fixture
def bars_of_many():
    """Histories of five bodies that move by the clock: the light one is a quarter of a body of 12 kg."""
    time = np.linspace(0.0, 1.0, 11)

    def moving(mass, speed):
        velocity = np.outer(speed * time**2, [0.0, 0.0, 1.0])
        return PartHistory(mass, velocity, np.zeros((11, 3)), np.zeros((11, 3)))

    parts = {
        "ground": moving(500.0, 1.0),
        "heavy": moving(9.0, 1.0),
        "light": moving(3.0, 90.0),
        "still": moving(99, 0),
    }
    model = SimpleNamespace(boundaries=(Fixed("ground.bottom"), Guided("heavy", (0.0, 0.0, 1.0))))
    run = SimpleNamespace(time=time, parts=parts, groups={"crate": moving(1.0, 0.1)}, von_mises={}, plastic_strain={})
    found = {name: Sector(4 if name == "light" else 1) for name in (*parts, "crate")}
    return model, run, found


def test_forces_across_a_plane_of_symmetry_cancel(tmp_path):
    """A force aslant on a quarter: twice nothing across, four times what lies in both planes."""
    case = case_of(tmp_path, "quarter")
    solution = run_fem(case)
    (name,) = solution.contacts
    time = solution.run.time
    slanted = dataclasses.replace(solution.run, impulse={name: np.outer(time, [3.0, -2.0, 5.0])})
    found = whole_forces(solution.model, slanted, sectors(case, solution.model))[name]
    assert found.peak == pytest.approx(20.0, rel=1e-9)
    assert found.impulse == pytest.approx(20.0 * time[-1], rel=1e-9)
    unlike = case_of(tmp_path, "quarter").model_copy()
    mixed = {**sectors(unlike, solution.model), "bar": sectors(case_of(tmp_path, "whole"), solution.model)["bar"]}
    assert whole_forces(solution.model, slanted, mixed) == {name: None}


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
    free = solution.sectors["both"].free
    assert part_measure(run, "both", free).rigid_peak < 1e-6 * part_measure(run, "bar", free).rigid_peak
    assert solution.groups["both"].rigid_peak == part_measure(run, "both", free).rigid_peak
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
    peak = stiffness**0.4 * (1.25 * 4.0 * solution.parts["ball"].mass) ** 0.6
    (whole,) = solution.wholes.values()
    off = abs(whole.peak / peak - 1.0)
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
