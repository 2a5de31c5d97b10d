"""``strikewave wave`` and stacks in ``strikewave run``: JSON, files, routes, and what bad input is told."""

import json
import os

import numpy as np
import pytest

from strikewave import load_case, run_wave
from strikewave.analyses.by_tables import check_case
from strikewave.base.errors import InputErrors

BAR = """
schema = 1
[[stack.layer]]
name = "upper"
material = "65Mn"
length = "15.58 mm"
diameter = "30 mm"
[[stack.layer]]
name = "specimen"
material = "2A12"
length = "10.18 mm"
diameter = "30 mm"
[[stack.layer]]
name = "lower"
material = "65Mn"
length = "60 mm"
diameter = "30 mm"
[stack.end]
kind = "free"
[load]
shape = "sine-squared"
peak = "19685 N"
duration = "40 us"
[[tap]]
name = "mid"
layer = "specimen"
position = 0.5
[[tap]]
name = "end"
layer = "lower"
position = 1.0
[solver]
duration = "100 us"
"""


@pytest.fixture
def bar(tmp_path, monkeypatch):
    (tmp_path / "bar.toml").write_text(BAR)
    return "bar.toml"


def test_wave_json_has_its_keys_and_sample_i_stands_at_i_steps(strikewave, bar, tmp_path):
    code, out, err = strikewave("wave", "--no-band", bar, "--json")
    assert code == 0
    document = json.loads(out)
    assert {"schema", "version", "units", "warnings", "step", "error_bound", "layers", "taps"} <= set(document)
    assert set(document["layers"][0]) == {"name", "length_asked", "length_used", "steps", "stress"}
    keys = {"name", "layer", "position", "route", "peaks", "time", "force", "stress", "velocity", "acceleration"}
    for tap in document["taps"]:
        assert set(tap) == keys
        assert tap["time"] == pytest.approx(np.arange(len(tap["time"])) * document["step"], abs=1e-18)
    assert document["error_bound"] <= 1e-3  # what is wanted where nothing is said
    assert document["acceleration_error_bound"] <= 1e-2
    for layer in document["layers"]:
        assert layer["length_used"] == pytest.approx(layer["length_asked"], rel=document["mismatch"] * 1.001)
    assert os.listdir(tmp_path) == ["bar.toml"]
    assert "done in" in err


def test_an_asked_step_is_kept_and_its_bound_said(strikewave, bar):
    code, out, _ = strikewave("wave", "--no-band", bar, "--json", "--set", "solver.step=50 ns")
    document = json.loads(out)
    assert code == 0
    assert document["step"] == document["solver_step"] == 50e-9
    assert document["error_bound"] > 1e-3
    assert "error-bound" in {w["code"] for w in document["warnings"]}


def test_free_end_moves_twice_as_fast_as_the_wave_that_comes(strikewave, bar):
    """Before any echo from the specimen returns, v = 2 P/Z at the free end, P what two faces let pass."""
    _, out, _ = strikewave("wave", "--no-band", bar, "--json", "--set", "load.duration=10 us")
    end = json.loads(out)["taps"][1]
    z1, z2 = 4.0620e7, np.sqrt(72e9 * 2780.0)
    passed = 4 * z1 * z2 / (z1 + z2) ** 2  # first pass through both faces; echoes add later
    area = np.pi * 0.015**2
    peak = max(v for t, v in zip(end["time"], end["velocity"], strict=True) if t < 39e-6)  # the lower part's echo
    assert peak > 2 * passed * 19685.0 / (z1 * area)
    assert peak < 2 * 19685.0 / (z1 * area)
    assert max(abs(f) for f in end["force"]) < 1e-9 * 19685.0


@pytest.mark.verify
@pytest.mark.parametrize("route", ["as printed", "corrected"])
def test_a_route_of_the_paper_is_named_in_every_output(strikewave, bar, route):
    code, out, _ = strikewave("wave", "--no-band", bar, "--json", "--set", f"solver.route={route}")
    taps = json.loads(out)["taps"]
    assert code == 0
    assert [(tap["name"], tap["route"]) for tap in taps] == [("mid", route)]  # the end tap has one neighbour only
    code, out, _ = strikewave("wave", "--no-band", bar, "--out", "o", "--set", f"solver.route={route}")
    assert route in out
    page = open("o/report.html", encoding="utf-8").read()
    assert route in page


def test_routes_whose_waves_are_too_many_are_left_out_or_refused(monkeypatch):
    monkeypatch.setattr("strikewave.waves.li_ma.MOST_ADDED", 1000)
    case = load_case("li-ma-2019-fig13-bar")
    solution = run_wave(case)
    assert not solution.routes
    assert "routes-left-out" in {notice.code for notice in solution.notices}
    with pytest.raises(InputErrors, match=r"^solver\.route: layer .* is too thin"):
        run_wave(load_case("li-ma-2019-fig13-bar", ["solver.route=corrected"]))


def test_wave_writes_a_whole_result(strikewave, bar):
    code, out, _ = strikewave("wave", "--no-band", bar, "--out", "w")
    assert code == 0
    assert sorted(os.listdir("w")) == ["case.toml", "field.svg", "report.html", "summary.svg", "taps.csv", "waves.nc"]
    head = open("w/taps.csv").readline()
    assert head.startswith(
        "time [s],mid force [N],mid stress [Pa],mid velocity [m/s],mid acceleration [m/s^2],end force"
    )
    assert "error bound" in out
    assert strikewave("wave", "--no-band", "w/case.toml", "--json")[0] == 0


@pytest.mark.verify
@pytest.mark.parametrize(
    ("field", "label"),
    [
        ("stress", "stress (MPa), compression above 0"),
        ("force", "force (kN), compression above 0"),
        ("velocity", "velocity (m/s), along the blow above 0"),
    ],
)
def test_the_pictures_along_the_stack_show_what_is_asked_for(strikewave, bar, field, label):
    assert strikewave("wave", "--no-band", bar, "--out", "w", "--field", field)[0] == 0
    assert f"<!-- {label} -->" in open("w/field.svg", encoding="utf-8").read()
    assert label in open("w/report.html", encoding="utf-8").read()


def test_an_unknown_field_names_the_nearest_and_nothing_runs(strikewave, bar, tmp_path):
    code, out, err = strikewave("wave", "--no-band", bar, "--field", "strss")
    assert (code, out) == (2, "")
    assert err == '--field: got "strss"; allowed: one of stress, force, velocity; did you mean "stress"?\n'
    assert os.listdir(tmp_path) == ["bar.toml"]


@pytest.mark.verify
def test_an_animation_comes_as_a_page_and_a_gif_and_may_be_replaced(strikewave, bar, monkeypatch):
    from PIL import Image

    from strikewave.analyses.wave import report

    monkeypatch.setattr(report, "GIF_FRAMES", 4)
    for more in ((), ("--force", "--set", "load.peak=10 kN")):
        code, _, err = strikewave("wave", "--no-band", bar, "--animate", "--out", "w", *more)
        assert code == 0
        assert "animation.html, animation.gif" in err
        assert {"animation.html", "animation.gif", "field.svg"} < set(os.listdir("w"))
        with Image.open("w/animation.gif") as film:
            assert film.n_frames == 4
    assert "mid" in open("w/animation.html", encoding="utf-8").read()


def test_an_animation_needs_a_place(strikewave, bar, tmp_path):
    code, out, err = strikewave("wave", "--no-band", bar, "--animate", "--json")
    assert (code, out) == (2, "")
    assert "--animate" in err
    assert "add --out DIR" in err
    assert os.listdir(tmp_path) == ["bar.toml"]


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        (["load.peak=5 mm"], "load.peak"),
        (["load.shape=half-sin"], "load.shape"),
        (["load.speed=5 m/s"], "load.speed"),
        (["load.shape=contact"], "load.peak"),
        (["load.shape=file"], "load.peak"),
        (["stack.layer.upper.length=0 mm"], "stack.layer.upper.length"),
        (["stack.layer.uper.length=5 mm"], "stack.layer.uper"),
        (["stack.layer.upper.material=65Nm"], 'did you mean "65Mn"?'),
        (["stack.layer.upper.area=5 mm^2"], "diameter or area, not both"),
        (["stack.end.kind=mass"], "stack.end.mass"),
        (["stack.end.kind=loose"], "stack.end.kind"),
        (["stack.end.mass=1 kg"], "for the kind free: no other field"),
        (["tap.mid.layer=specimn"], 'did you mean "specimen"?'),
        (["tap.mid.position=1.5"], "tap.mid.position"),
        (["solver.step=1 s"], "solver.step"),
        (["solver.step=0.000001 ns"], "solver"),
        (["solver.bandwidth=1e12 Hz"], "solver.bandwidth"),
        (["solver.route=printed"], "solver.route"),
    ],
)
def test_bad_bars_are_refused_in_one_line(strikewave, bar, changes, said, tmp_path):
    code, out, err = strikewave("wave", "--no-band", bar, *(word for change in changes for word in ("--set", change)))
    assert code == 2
    assert out == ""
    assert said in err
    assert len(err.strip().splitlines()) == 1
    assert os.listdir(tmp_path) == ["bar.toml"]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (BAR.replace("[load]", "[lod]"), "lod"),
        (BAR.replace('duration = "100 us"', ""), "solver.duration"),
        (BAR.replace('name = "lower"', 'name = "upper"'), "each name once"),
        (BAR.replace("[[tap]]", "[tap]", 1).replace("[[tap]]", "[tapx]"), "[[tap]]"),
        (BAR + '[[stack.joint]]\nafter = "lower"\nkind = "bonded"\n', "a layer that another one follows"),
        (BAR + '[[stack.joint]]\nafter = "upper"\nkind = "compliant"\n', "stack.joint.upper.stiffness"),
        (BAR + '[[stack.joint]]\nafter = "upper"\nkind = "bonded"\nmass = "1 kg"\n', "stack.joint.upper.mass"),
        (
            BAR + '[[stack.joint]]\nafter = "upper"\nkind = "unilateral"\ngap = "1 um"\npreload = "1 N"\n',
            "stack.joint.upper",
        ),
        (BAR + '[[sensor]]\nname = "s"\nmodel = "Endevco"\n', "did you mean"),
        ("schema = 1\n", "[[stack.layer]]"),
    ],
)
def test_bad_bar_files_are_refused_in_words(strikewave, tmp_path, text, said):
    (tmp_path / "bad.toml").write_text(text)
    code, out, err = strikewave("wave", "--no-band", "bad.toml")
    assert code == 2
    assert out == ""
    assert said in err


@pytest.mark.verify
def test_run_takes_a_bar_as_wave_does_and_a_machine_is_sent_from_wave_to_run(strikewave, bar):
    by_run, by_wave = (json.loads(strikewave(command, bar, "--json")[1]) for command in ("run", "wave"))
    assert by_run["taps"] == by_wave["taps"]
    code, _, err = strikewave("wave", "--no-band", "li-ma-2019-fig13")
    assert code == 2
    assert "strikewave run" in err


def test_a_measured_force_in_a_file_gives_the_same_as_its_shape(strikewave, bar, tmp_path):
    """A half-sine sampled every 20 ns and read back in us and kN: linear between samples, 1e-5 of the peak."""
    t = np.arange(0.0, 40.02e-6, 20e-9)
    force = np.where(t < 40e-6, 19685.0 * np.sin(np.pi * t / 40e-6) ** 2, 0.0)
    rows = "\n".join(f"{1e6 * a:.6f};{1e-3 * b:.9f}" for a, b in zip(t, force, strict=True))
    (tmp_path / "force.csv").write_text("time [us];force [kN]\n" + rows + "\n")
    text = BAR.replace(
        'shape = "sine-squared"\npeak = "19685 N"\nduration = "40 us"', 'shape = "file"\nfile = "force.csv"'
    )
    (tmp_path / "filed.toml").write_text(text)
    whole = json.loads(strikewave("wave", "--no-band", bar, "--json", "--set", "solver.step=20 ns")[1])["taps"]
    filed = json.loads(strikewave("wave", "--no-band", "filed.toml", "--json", "--set", "solver.step=20 ns")[1])["taps"]
    for a, b in zip(whole, filed, strict=True):
        assert np.abs(np.array(a["velocity"]) - b["velocity"]).max() < 1e-5 * np.abs(a["velocity"]).max()


def test_a_load_by_contact_reports_the_force_of_the_law(strikewave, bar, tmp_path):
    """A striker on an endless bar: never more than the rigid striker's Z v, and less momentum than m v (1 + e)."""
    text = BAR.replace(
        'shape = "sine-squared"\npeak = "19685 N"\nduration = "40 us"', 'shape = "contact"\nspeed = "2 m/s"'
    ).replace('kind = "free"', 'kind = "matched"')
    text += """
[striker]
mass = "0.2 kg"
material = "65Mn"
nose_radius = "10 mm"
contact_length = "20 mm"
mount_stiffness = "300 MN/m"
mount_damping = "0 N s/m"
[contact]
restitution = 0.7
slowest_approach = "0.1 m/s"
"""
    (tmp_path / "struck.toml").write_text(text)
    code, out, _ = strikewave("wave", "--no-band", "struck.toml", "--json")
    assert code == 0
    force = np.array(json.loads(out)["taps"][0]["force"])
    z = 4.0620e7 * np.pi * 0.015**2
    assert 0.3 * z * 2.0 < force.max() < z * 2.0


@pytest.fixture(scope="module")
def fig5():
    from strikewave import load_case, run_case

    return run_case(load_case("li-ma-2019-fig5", ["feed.blows=2"]))


def test_a_sensor_on_a_bar_reads_its_tap(strikewave, bar, tmp_path):
    """An ideal sensor at a tap reads the largest acceleration of that tap."""
    (tmp_path / "sensed.toml").write_text(BAR + '[[sensor]]\nname = "s"\ntap = "mid"\n')
    document = json.loads(strikewave("wave", "--no-band", "sensed.toml", "--json")[1])
    peak = max(document["taps"][0]["acceleration"], key=abs)
    assert document["sensors"]["s"]["peak"] == pytest.approx(peak, rel=1e-4)  # between samples by a parabola


def test_an_ideal_sensor_reads_every_sample_of_its_tap_from_the_jump_of_the_load_on():
    """To the last digit: a rectangle accelerates the struck face in the first sample, whose half is lost without it."""
    from strikewave.analyses.wave.run import run_wave
    from strikewave.cases.case import parse_case

    face = '[[tap]]\nname = "face"\nlayer = "upper"\nposition = 0.0\n[[sensor]]\nname = "s"\ntap = "face"\n'
    solution = run_wave(parse_case(BAR.replace("sine-squared", "rectangle") + face))
    reading = solution.readings[0]
    assert solution.run.acceleration[0, 2] > 0.0
    assert reading.time == pytest.approx(solution.run.time, abs=1e-18)
    assert np.array_equal(reading.values, solution.run.acceleration[:, 2])


def test_a_sensor_that_rings_faster_than_what_is_kept_is_noticed():
    """500 kHz at 200 ns are 10 samples a period; left to itself the run keeps 50."""
    from strikewave.analyses.wave.run import run_wave
    from strikewave.cases.case import parse_case

    sensor = '[[sensor]]\nname = "s"\ntap = "mid"\nresonance = "500 kHz"\n'
    coarse = run_wave(parse_case(BAR.replace("[solver]", '[solver]\nstep = "200 ns"') + sensor))
    notice = next(notice for notice in coarse.notices if notice.code == "sensor-unresolved")
    assert notice.limit == pytest.approx(2e-6 / 12.0)
    chosen = run_wave(parse_case(BAR + sensor))
    assert "sensor-unresolved" not in {notice.code for notice in chosen.notices}
    assert chosen.run.time[1] <= 2e-6 / 50.0 * (1.0 + 1e-12)


def test_run_with_a_stack_states_total_wave_bandwidth_and_sensors(fig5):
    document = fig5.document()
    for blow in document["blows"]:
        assert blow["bandwidth"] == pytest.approx(0.35 * np.sqrt(72e9 / 2780.0) / (5 * 0.03), rel=0.03)
        assert set(blow["sensors"]) == {"direct", "buffered"}
        assert set(blow["sensors"]["direct"]) == {"peak", "width", "clipped", "cut"}
        assert abs(blow["wave_peak"]) < blow["total_peak"]
    assert document["route"] == "exact"
    assert document["balance"]["energy_error"] < 1e-6
    assert document["balance"]["momentum_error"] < 1e-9


def test_a_solution_with_a_stack_reads_back_the_same(fig5, tmp_path):
    from strikewave import load_solution

    fig5.save(tmp_path / "solution.nc")
    again = load_solution(tmp_path / "solution.nc")
    assert again.readings == fig5.readings
    assert again.waves == fig5.waves
    assert np.array_equal(again.data["tap_acceleration"], fig5.data["tap_acceleration"], equal_nan=True)
    assert again.data["reading_2"].attrs["sensor"] == "buffered"


def test_removing_all_gaskets_returns_the_direct_reading(fig5):
    """Same sensor, same tap: without gaskets and edge the buffered channel reads what the direct one reads, to 1e-9."""
    from strikewave.analyses.machine.observe import observe

    case = load_case("li-ma-2019-fig5", ["feed.blows=1"])
    bare = case.sensor[1].model_copy(update={"gasket": (), "edge_stiffness": None, "edge_damping": None})
    seen = observe(case.model_copy(update={"sensor": (case.sensor[0], bare)}))
    direct, buffered = seen.histories[0].readings
    assert np.abs(direct.values - buffered.values).max() <= 1e-9 * np.abs(direct.values).max()


def test_a_gasket_too_thick_for_its_waves_is_refused_before_the_run():
    case = load_case("li-ma-2019-fig5", ["sensor.buffered.gasket.0.thickness=0.5 m"])
    with pytest.raises(InputErrors, match=r"sensor\.buffered\.gasket: a gasket of 0\.5 m .* take a thinner"):
        check_case(case)


def test_a_peak_beyond_one_dimensional_theory_is_refused_and_the_number_said():
    from strikewave import load_case, run_case

    solution = run_case(load_case("li-ma-2019-fig13", ["feed.blows=1"]))
    (blow,) = solution.document()["blows"]
    assert blow["total_peak"] is None
    assert blow["wave_peak"] is None
    (notice,) = [n for n in solution.warnings if n.code == "rise-too-steep"]
    assert notice.value < notice.limit == 2.0
    assert "would say" in notice.message
    low = run_case(load_case("li-ma-2019-fig13", ["feed.blows=1", "solver.bandwidth=10 kHz"]))
    assert low.document()["blows"][0]["total_peak"] is not None
    assert not {n.code for n in low.warnings} & {"rise-too-steep", "rise-steep"}


def test_the_paper_by_choice_superposes_rigid_and_wave():
    """By the printed route, total is rigid plus a wave that the contact force drives through endless fixtures."""
    from strikewave.analyses.machine.observe import observe

    changes = ["feed.blows=1", "solver.bandwidth=100 kHz"]
    exact = observe(load_case("li-ma-2019-fig13", changes))
    printed = observe(load_case("li-ma-2019-fig13", [*changes, "solver.route=as printed"]))
    known = np.isfinite(exact.histories[0].rigid)
    superposed = (exact.histories[0].rigid + exact.histories[0].routes[0, "as printed"])[known]
    total = printed.histories[0].total[:, known]
    assert total[0] == pytest.approx(superposed, abs=1e-9 * np.abs(superposed).max())
    assert np.isnan(total[1]).all()  # the far end has one neighbour only: no route knows it


@pytest.mark.verify
def test_a_route_runs_through_to_the_report_though_a_tap_has_none(strikewave):
    """The far end of the two cylinders has one neighbour only: its columns are empty, the rest is there."""
    words = ("--set", "solver.route=as printed", "--set", "feed.blows=1", "--out", "r")
    code, out, _ = strikewave("run", "--no-band", "li-ma-2019-fig13", *words)
    assert code == 0
    assert "route as printed" in out
    assert "as printed" in open("r/blows.csv").read()
    assert "route: as printed" in open("r/report.html", encoding="utf-8").read()


def test_a_changed_material_makes_another_case(strikewave):

    case = load_case("li-ma-2019-fig5", ["sensor.buffered.gasket.0.material=rubber", "recorder.sampling_rate=50 kHz"])
    assert set(case.changed_fields()) == {"sensor.buffered.gasket.0.material", "recorder.sampling_rate"}


def test_the_bandwidth_that_the_warning_names_is_quotable(strikewave, bar):
    """What is advised works: a peak acceleration is then quoted, with the milder warning."""
    _, out, _ = strikewave("wave", "--no-band", bar, "--json", "--set", "load.duration=10 us")
    (notice,) = [w for w in json.loads(out)["warnings"] if w["code"] == "rise-too-steep"]
    advised = notice["message"].rpartition("--set ")[2].replace('"', "")
    _, out, _ = strikewave("wave", "--no-band", bar, "--json", "--set", "load.duration=10 us", "--set", advised)
    codes = {w["code"] for w in json.loads(out)["warnings"]}
    assert "rise-too-steep" not in codes
    assert "rise-steep" in codes


def test_the_cases_of_the_docs_run(strikewave, tmp_path):
    """The examples of docs/waves.md as they stand there: the first one without a warning, and under its striker."""
    from pathlib import Path

    text = (Path(__file__).parents[3] / "docs" / "waves.md").read_text("utf-8")
    first, struck = (part.partition("```")[0] for part in text.split("```toml\n")[1:3])
    (tmp_path / "docs.toml").write_text(first)
    code, out, _ = strikewave("wave", "--no-band", "docs.toml", "--json")
    assert code == 0
    assert json.loads(out)["warnings"] == []
    before, _, load = first.partition("[load]")
    (tmp_path / "struck.toml").write_text(before + struck + "[[tap]]" + load.partition("[[tap]]")[2])
    code, out, _ = strikewave("wave", "--no-band", "struck.toml", "--json")
    assert code == 0
    contact = json.loads(out)["contact"]
    # no more than the momentum of the striker twice over
    assert 0.2 * 5.0 < contact["impulse"] < 2 * 0.2 * 5.0
