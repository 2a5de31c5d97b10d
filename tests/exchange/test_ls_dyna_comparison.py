"""A run of ours written as LS-DYNA would have, and read back beside itself: no difference, a known one, wrong units."""

import dataclasses
import json
import math
from pathlib import Path

import numpy as np
import pytest

from strikewave.base.errors import InputError
from strikewave.exchange.ls_dyna.comparison import StrikewaveRun, agreement, compare_runs, read_strikewave, slip
from strikewave.exchange.ls_dyna.folder import ENERGIES, EnergyHistory, Force, pulse_of, read_folder
from strikewave.exchange.units import SYSTEMS
from strikewave.fem.run import contact_measure

from .ls_dyna_files import binout, d3plot, glstat, rcforc

MM = SYSTEMS["mm-t-s"]
CHANGES = [
    "mesh.part.ball.finest=0.6 mm",
    "mesh.part.ground.finest=0.6 mm",
    "mesh.part.ground.size=12 mm",
    "fem.duration=75 us",
    "fem.frames=4",
]
NAME = "ball.round-ground.top"
DIGITS = 1e-5
"""Six digits of a text file, and those of the times between which it is summed."""


@pytest.fixture(scope="module")
def solution():
    from strikewave import load_case
    from strikewave.analyses.fem.run import run_fem

    return run_fem(load_case("hertz-ball-fem", CHANGES))


@pytest.fixture(scope="module")
def folder(solution, tmp_path_factory):
    from strikewave.fem.vtkhdf import FieldWriter

    home = tmp_path_factory.mktemp("ours")
    solution.data.to_netcdf(home / "histories.nc", engine="h5netcdf")
    with FieldWriter(home / "field.vtkhdf", solution.model.mesh) as writer:
        for frame in solution.frames:
            writer.add(frame)
    return home


@pytest.fixture(scope="module")
def ours(folder):
    return read_strikewave(folder)


@pytest.fixture
def written(tmp_path, ours, solution):
    """Write our run as a folder of LS-DYNA, forces and energies by a factor, later by a shift."""

    def write(units=MM, factor=1.0, shift=0.0, turn=1.0, title=NAME, fields=True):
        home = tmp_path / "dyna"
        home.mkdir(exist_ok=True)
        force = ours.forces[NAME]
        time = (force.time + shift) * units.factor(time=1)
        held = {7: turn * factor * force.force * units.force, 9: None}
        (home / "rcforc").write_text(rcforc(held, {7: title, 9: "self"}, time))
        energy = {ENERGIES[word][0]: values * factor * units.energy for word, values in ours.energies.energy.items()}
        (home / "glstat").write_text(glstat(ours.energies.time * units.factor(time=1), energy))
        mesh = solution.model.mesh
        states = [
            (
                frame.time * units.factor(time=1),
                (mesh.points + frame.displacement) * units.distance,
                frame.velocity * units.velocity,
                frame.stress * units.stress,
                frame.plastic_strain,
                np.ones(len(mesh.hexahedra)),
            )
            for frame in solution.frames
        ]
        if fields:
            points = mesh.points * units.distance
            d3plot(home / "d3plot", points, mesh.hexahedra, mesh.part, [3, 5], mesh.names, states, word=8)
        return home

    return write


@pytest.mark.verify
def test_our_forces_measured_anew_are_those_of_our_own_report(solution, ours):
    own = contact_measure(solution.model_run, NAME)  # as meshed, like those of LS-DYNA
    found = pulse_of(ours.forces[NAME])
    for what in ("peak", "at", "impulse", "begin", "end"):
        assert getattr(found, what) == pytest.approx(getattr(own, what), rel=1e-12, abs=1e-18), what
    assert ours.extremes["ball"].displacement == pytest.approx(
        max(
            np.linalg.norm(f.displacement[solution.model.mesh.nodes_of("ball")], axis=1).max() for f in solution.frames
        ),
        rel=1e-6,  # single precision of field.vtkhdf
    )


def missing(ours):
    """Share of the impulse before the first and after the last middle of an interval, which no trapezium holds."""
    force = ours.forces[NAME]
    step = force.time[1] - force.time[0]
    return 0.5 * step * (force.size[0] + force.size[-1]) / np.linalg.norm(force.impulse)


@pytest.mark.parametrize("units", [*SYSTEMS])
def test_our_run_written_by_ls_dyna_in_any_units_is_no_different(written, ours, units):
    system = SYSTEMS[units]
    found = compare_runs(read_folder(written(system), system), ours)
    (pair,) = found.forces
    assert (pair.contact.number, pair.side, found.warnings) == (7, "A", ())
    for what in ("peak", "width"):
        assert abs(getattr(pair.differences, what)) < DIGITS, what
    assert pair.differences.impulse == pytest.approx(-missing(ours), abs=DIGITS)
    assert abs(pair.shift) < DIGITS * pair.strikewave.width
    assert abs(pair.plain.magnitude) < DIGITS
    assert pair.plain.rms < DIGITS
    assert pair.plain.phase < 1e-4  # arccos near 1: the root of the differences' squares
    for word, values in ours.energies.energy.items():
        np.testing.assert_allclose(
            found.ls_dyna.energies.energy[word], values, rtol=DIGITS, atol=DIGITS * 1e-3 * np.abs(values).max()
        )
    assert found.parts == {"ball": "ball", "ground": "ground"}
    for name, one in ours.extremes.items():
        for what, value in dataclasses.asdict(one).items():
            assert getattr(found.ls_dyna.extremes[name], what) == pytest.approx(value, rel=1e-6), (name, what)


def test_a_known_factor_and_shift_are_found(written, ours):
    found = compare_runs(read_folder(written(factor=1.07, shift=4e-6), MM), ours)
    (pair,) = found.forces
    assert pair.differences.peak == pytest.approx(0.07, abs=DIGITS)
    assert pair.differences.impulse == pytest.approx(1.07 * (1.0 - missing(ours)) - 1.0, abs=DIGITS)
    assert abs(pair.differences.width) < DIGITS
    assert pair.shift == pytest.approx(4e-6, rel=1e-4)
    assert pair.moved.magnitude == pytest.approx(0.07, abs=DIGITS)
    assert pair.moved.phase < 1e-4
    assert pair.plain.phase > 0.01
    assert [notice.code for notice in found.warnings] == ["time-shift"]
    assert "4 us later" in found.warnings[0].message


def test_the_side_whose_impulse_points_as_ours_is_taken(written, ours):
    (pair,) = compare_runs(read_folder(written(turn=-1.0), MM), ours).forces
    assert pair.side == "B"
    assert abs(pair.differences.peak) < DIGITS
    assert pair.angle < 0.01


def test_a_sector_is_compared_as_meshed(written, ours, solution):
    """The deck holds a quarter of ball and half-space: a run of it comes to the forces of the quarter."""
    from strikewave.analyses.fem.ls_dyna.report import ls_dyna_words
    from strikewave.analyses.fem.ls_dyna.result import LsDynaResult

    found = compare_runs(read_folder(written(), MM), ours)
    (pair,) = found.forces
    assert pair.strikewave.peak == pytest.approx(solution.model_contacts[NAME].peak, rel=1e-9)
    assert pair.strikewave.peak < 0.26 * solution.contacts[NAME].peak
    assert abs(pair.differences.peak) < DIGITS
    assert not found.warnings
    assert ls_dyna_words(LsDynaResult(found)).endswith("of both are those of the meshed sector, not of whole bodies.")


def test_sectors_that_differ_are_named(written, ours):
    found = compare_runs(read_folder(written(factor=4.0), MM), ours)
    assert ("sector", 4.0) in [(notice.code, notice.limit) for notice in found.warnings]


@pytest.mark.parametrize(
    ("true", "said", "told"),
    [
        ("mm-t-s", "SI", {"total energy 1000", "displacement of ball 1000", "von mises of ball 1e-06"}),
        ("SI", "mm-t-s", {"total energy 0.001", "displacement of ball 0.001", "von mises of ball 1e+06"}),
        ("mm-g-us", "mm-t-s", {f"peak of {NAME} 1e-06", f"width of {NAME} 1e+06", "total energy 1e-06"}),
    ],
)
def test_units_that_were_mistaken_are_named_and_nothing_else(written, ours, true, said, told):
    found = compare_runs(read_folder(written(SYSTEMS[true]), SYSTEMS[said]), ours)
    (notice,) = found.warnings
    assert notice.code == "units"
    assert "is --units right?" in notice.message
    assert told <= set(notice.message.partition("(")[2].partition(")")[0].split(", "))


def test_a_force_off_by_a_million_alone_is_a_slip_too(written, ours):
    (notice,) = compare_runs(read_folder(written(factor=1e6, fields=False), MM), ours).warnings
    assert f"peak of {NAME} 1e+06" in notice.message


def test_contacts_go_together_by_title_by_being_alone_or_as_asked(written, ours):
    two = StrikewaveRun(
        ours.folder, ours.title, {NAME: ours.forces[NAME], "other": ours.forces[NAME]}, ours.energies, {}
    )
    theirs = read_folder(written(title=NAME.upper(), fields=False), MM)
    assert [pair.name for pair in compare_runs(theirs, two).forces] == [NAME]
    theirs = read_folder(written(title="nothing alike", fields=False), MM)
    assert compare_runs(theirs, two).forces == ()
    assert [notice.code for notice in compare_runs(theirs, two).warnings] == ["contact-unpaired"] * 2
    assert [pair.name for pair in compare_runs(theirs, two, {"other": 7}).forces] == ["other"]
    assert [pair.name for pair in compare_runs(theirs, ours).forces] == [NAME]
    for asked in ({"nobody": 7}, {NAME: 8}):
        with pytest.raises(InputError, match="--contact"):
            compare_runs(theirs, ours, asked)


def test_contacts_without_titles_are_numbered_as_in_our_deck(written, ours):
    two = StrikewaveRun(
        ours.folder, ours.title, {NAME: ours.forces[NAME], "other": ours.forces[NAME]}, ours.energies, {}
    )
    theirs = read_folder(written(fields=False), MM)
    touching = max(theirs.contacts, key=lambda contact: contact.number == 7)
    numbered = [dataclasses.replace(touching, number=k, title="") for k in (2, 1, 5)]
    found = compare_runs(dataclasses.replace(theirs, contacts=tuple(numbered)), two)
    assert [(pair.name, pair.contact.number) for pair in found.forces] == [(NAME, 1), ("other", 2)]
    titled = [dataclasses.replace(contact, title="of another deck") for contact in numbered[:1]]
    mixed = dataclasses.replace(theirs, contacts=(*titled, *numbered[1:]))
    assert compare_runs(mixed, two).forces == ()


def test_what_touches_in_one_run_alone_is_said(written, ours):
    force = ours.forces[NAME]
    still = dataclasses.replace(force, force=0.0 * force.force, impulse=np.zeros(3))
    quiet = StrikewaveRun(ours.folder, ours.title, {NAME: still}, ours.energies, {})
    found = compare_runs(read_folder(written(fields=False), MM), quiet)
    assert [notice.code for notice in found.warnings] == ["no-contact"]
    assert math.isnan(found.forces[0].differences.peak)


def test_forces_and_energies_come_from_binout_where_there_is_no_text(written, ours):
    home = written(fields=False)
    text = read_folder(home, MM)
    force, energies = ours.forces[NAME], ours.energies
    rows = [("/rcforc/metadata", "ids", 3, [7, 7]), (".", "side", 3, [0, 1])]
    for k, (time, vector) in enumerate(zip(force.time, force.force * MM.force, strict=True), 1):
        rows.append((f"/rcforc/d{k:06d}", "time", 10, [time]))
        rows += [(".", f"{axis}_force", 10, [x, -x]) for axis, x in zip("xyz", vector, strict=True)]
    for k, time in enumerate(energies.time):
        rows += [(f"/glstat/d{k:06d}", "time", 10, [time])]
        rows += [
            (".", ENERGIES[word][0].replace(" ", "_"), 10, [v[k] * MM.energy]) for word, v in energies.energy.items()
        ]
    (home / "binout0000").write_bytes(binout(rows))
    for name in ("rcforc", "glstat"):
        (home / name).unlink()
    archive = read_folder(home, MM)
    assert archive.contacts[0].first.force == pytest.approx(force.force, rel=1e-12, abs=1e-12)
    assert text.contacts[0].first.force == pytest.approx(force.force, rel=DIGITS, abs=1e-12)
    assert archive.energies.energy["total"] == pytest.approx(energies.energy["total"], rel=1e-12)


def test_sprague_and_geers_measures_of_known_curves():
    t = np.linspace(0.0, 1.0, 20_001)
    sine, cosine = np.sin(2.0 * np.pi * t), np.cos(2.0 * np.pi * t)
    found = agreement((t, sine), (t, 2.0 * cosine), (0.0, 1.0))
    # orthogonal over a period: P = 1/2; twice the size: M = 1
    assert (found.magnitude, found.phase) == pytest.approx((1.0, 0.5), abs=1e-9)
    assert found.combined == pytest.approx(math.sqrt(1.25), abs=1e-9)
    ahead = agreement((t, sine), (t, np.sin(2.0 * np.pi * (t - 0.1))), (0.0, 1.0))
    assert ahead.phase == pytest.approx(0.2, abs=1e-6)  # 0.1 of a period is 36 degrees of 180
    assert math.isnan(agreement((t, 0.0 * t), (t, sine), (0.0, 1.0)).magnitude)


def test_a_slip_is_a_power_of_a_thousand():
    assert [slip(x) for x in (1.0, 999.0, 3e-7, 0.0, math.inf, -1e3)] == [None, 1000.0, None, None, None, None]
    assert slip(6e-7) == 1e-6


@pytest.mark.parametrize("damage", ["none", "truncated", "another"])
def test_a_result_of_ours_that_is_damaged_is_refused(tmp_path, folder, damage):
    if damage != "none":
        held = (folder / "histories.nc").read_bytes()
        (tmp_path / "histories.nc").write_bytes(held[:5000] if damage == "truncated" else b"nothing" * 100)
    with pytest.raises(InputError, match="--compare"):
        read_strikewave(tmp_path)


@pytest.mark.verify
def test_the_command_writes_report_picture_and_numbers(strikewave, written, folder, solution):
    home = written(factor=1.07)
    code, said, told = strikewave("ls-dyna", home, "--units", "mm-t-s", "--compare", folder, "--out", "here")
    assert code == 0
    assert "(+7.00 %)" in said
    assert "written: here/" in told
    page = Path("here/report.html").read_text("utf-8")
    assert "<script" not in page
    assert f"Contact {NAME}" in page
    document = json.loads(Path("here/comparison.json").read_text("utf-8"))
    pair = document["comparison"]["contacts"][NAME]
    assert pair["peak_difference"] == pytest.approx(0.07, abs=DIGITS)
    assert document["states"] == len(solution.frames)
    code, out, _ = strikewave("ls-dyna", home, "--units", "mm-t-s", "--compare", folder, "--json")
    assert json.loads(out) == document
    assert strikewave("ls-dyna", home, "--units", "SI", "--compare", folder, "--out", "here")[0] == 2  # another one
    (home / "d3plot").unlink()
    assert strikewave("ls-dyna", home, "--units", "mm-t-s", "--out", "alone", "--force")[0] == 0


def test_titles_from_a_hostile_deck_are_escaped(strikewave, written):
    home = written(title="<script>alert(1)</script> $\\frac{", fields=False)
    assert strikewave("ls-dyna", home, "--units", "mm-t-s", "--out", "here")[0] == 0
    assert "<script" not in Path("here/report.html").read_text("utf-8")
    assert "<script" not in Path("here/comparison.svg").read_text("utf-8")


@pytest.mark.parametrize(
    ("words", "told"),
    [
        ([], "--units: missing; needed: one of SI, mm-t-s"),
        (["--units", "si"], '--units: got "si"; allowed: one of SI, mm-t-s, mm-ms-kg, mm-g-us; did you mean "SI"?'),
        (["--units", "SI", "--beside", "out/mine"], '--beside: got "out/mine"; allowed: --compare'),
        (["--units", "SI", "--contact", "ball"], "NAME=NUMBER"),
        (
            ["--units", "SI", "--contact", "ball=1"],
            '--contact: got "ball=1"; allowed: only with a result of strikewave fem',
        ),
        (["--units", "SI", "--part", "ball=1"], '--part: got "ball=1"; allowed: only with a result of strikewave fem'),
    ],
)
def test_what_the_command_needs_is_said(strikewave, tmp_path, words, told):
    code, _, said = strikewave("ls-dyna", tmp_path, *words)
    assert code == 2
    assert told in said


def test_a_folder_without_results_is_refused(tmp_path):
    with pytest.raises(InputError, match="rcforc, glstat, binout or d3plot"):
        read_folder(tmp_path, MM)


@pytest.mark.parametrize("name", ["rcforc", "glstat", "d3plot", "binout0000"])
def test_a_run_with_a_name_of_its_job_is_read(tmp_path, written, name):
    home = written()
    (home / "binout0000").write_bytes(
        binout([("/glstat/d000001", "time", 10, [1.0]), (".", "total_energy", 10, [2.0])])
    )
    for path in list(home.iterdir()):
        path.rename(path.with_name(f"fall.2.{path.name}")) if path.name == name else path.unlink()
    assert [path.name for path in read_folder(home, MM).files] == [f"fall.2.{name}"]
    (home / "rise.rcforc").write_text("")
    with pytest.raises(InputError, match=r"it holds those of several jobs: .fall\.2\., rise\."):
        read_folder(home, MM)


def test_one_without_a_job_comes_before_those_of_jobs(written):
    home = written(fields=False)
    (home / "old.rcforc").write_text("nothing")
    assert [path.name for path in read_folder(home, MM).files] == ["rcforc", "glstat"]


def test_work_on_walls_is_contact_energy_as_ours(tmp_path):
    sliding, walls = np.array([1.0, 2.0]), np.array([0.25, 0.5])
    text = glstat(np.arange(2.0), {"sliding interface energy": sliding})
    block = " stonewall energy...............  {:.5E} wall#    1"
    lines = iter(block.format(value) for value in walls)
    text = "\n".join(line if "external work" not in line else f"{line}\n{next(lines)}" for line in text.splitlines())
    (tmp_path / "glstat").write_text(text + "\n")
    held = read_folder(tmp_path, SYSTEMS["SI"]).energies.energy
    assert held["contact"].tolist() == [1.25, 2.5]


def test_our_internal_energy_is_with_the_work_of_bulk_viscosity(folder, ours):
    import xarray

    with xarray.open_dataset(folder / "histories.nc", engine="h5netcdf") as held:
        internal, viscous = (held[f"model_energy.{name}"].values for name in ("internal", "viscous"))
    assert viscous.max() > 1e-4 * internal.max()
    assert np.array_equal(ours.energies.energy["internal"], internal + viscous)
    assert "viscous" not in ours.energies.energy


def test_stress_and_strain_of_deleted_elements_do_not_count(tmp_path):
    cube = np.array([[x, y, z] for z in range(3) for y in (0, 1) for x in (0, 1)], float)
    cells = np.array([[0, 1, 3, 2, 4, 5, 7, 6], [4, 5, 7, 6, 8, 9, 11, 10]])
    stress = np.array([[10.0, 0, 0, 0, 0, 0], [900.0, 0, 0, 0, 0, 0]])
    strain = np.array([0.5, 0.75])
    states = [(0.0, cube, 0 * cube, 0.5 * stress, 0.5 * strain, np.ones(2))]
    states += [(1.0, cube + 2.0, 0 * cube, stress, strain, np.array([1.0, 0.0]))]
    d3plot(tmp_path / "d3plot", cube, cells, np.zeros(2, int), [1], ["cubes"], states, word=8)
    found = read_folder(tmp_path, SYSTEMS["SI"]).extremes["cubes"]
    assert (found.von_mises, found.plastic_strain) == (450.0, 0.5)  # of the second before, of the first after
    assert found.displacement == pytest.approx(2.0 * math.sqrt(3.0), rel=1e-15)


def test_of_several_blows_only_the_first_is_compared_and_reported(tmp_path, folder, written):
    for name in ("histories.nc", "histories-2.nc", "histories-3.nc"):
        (tmp_path / name).write_bytes((folder / "histories.nc").read_bytes())
    found = compare_runs(read_folder(written(fields=False), MM), read_strikewave(tmp_path))
    (notice,) = found.warnings
    assert (notice.code, notice.value) == ("blows", 3.0)
    assert "only the first is compared" in notice.message


@pytest.mark.verify
def test_runs_of_the_same_name_do_not_overwrite_each_other(strikewave, written, tmp_path):
    home = written(fields=False)
    other = tmp_path / "further" / "dyna"
    other.mkdir(parents=True)
    for path in home.iterdir():
        (other / path.name).write_bytes(path.read_bytes())
    for words in ((home, "mm-t-s"), (other, "mm-t-s"), (home, "SI"), (home, "mm-t-s")):
        assert strikewave("ls-dyna", words[0], "--units", words[1])[0] == 0
    places = sorted(Path("out").iterdir())
    assert len(places) == 3
    assert all(path.name.startswith("ls-dyna-dyna-") for path in places)
    assert sum(str(other) in (path / "comparison.json").read_text("utf-8") for path in places) == 1


def test_pictures_of_nothing_say_so(tmp_path):
    from strikewave.analyses.fem.ls_dyna.report import comparison_sheet, ls_dyna_report
    from strikewave.analyses.fem.ls_dyna.result import LsDynaResult
    from strikewave.exchange.ls_dyna.comparison import RunComparison
    from strikewave.exchange.ls_dyna.folder import LsDynaContact, LsDynaRun

    empty = LsDynaRun(tmp_path, (), (), None, None, {}, 0, (math.nan, math.nan))
    assert "no rcforc or binout is there" in [
        t.get_text() for axes in comparison_sheet(RunComparison(empty), "").axes for t in axes.texts
    ]
    still = LsDynaContact(1, "", {"A": Force(np.array([0.0]), np.zeros((1, 3)))})
    one = dataclasses.replace(
        empty, contacts=(still,), energies=EnergyHistory(np.array([0.0]), {"kinetic": np.array([np.nan])})
    )
    assert "Nothing touched." in ls_dyna_report(LsDynaResult(RunComparison(one)))
