"""Sectors of bodies: what whole bodies come to, cuts that nothing holds, groups of parts, contacts of few faces."""

import dataclasses
import json
import math
from types import SimpleNamespace

import numpy as np
import pytest

from strikewave import load_case
from strikewave.analyses.fem.build import build_model
from strikewave.analyses.fem.notices import model_notices
from strikewave.analyses.fem.report import fem_words
from strikewave.analyses.fem.run import run_fem
from strikewave.analyses.fem.sectors import blow_of_bodies, of_whole_bodies, open_cuts, sectors
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
