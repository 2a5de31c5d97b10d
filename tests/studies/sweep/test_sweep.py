"""Sweeps: numbers against the runs themselves and known functions, main effects, designs, files."""

import math
from html import unescape

import numpy as np
import pytest
from scipy.stats import f_oneway

import strikewave
from strikewave import load_case
from strikewave.analyses.fem.run import run_fem
from strikewave.base.errors import InputError
from strikewave.fem.run import balance_measure
from strikewave.studies.engine.case_evaluation import read_kept
from strikewave.studies.sweep.effects import main_effect, share_by_chance
from strikewave.studies.sweep.figures import drawn_settings, picture
from strikewave.studies.sweep.report import page
from strikewave.studies.sweep.study import SweepRequest, plan_of, read_request, sweep

ONE = load_case("li-ma-2019", ["feed.blows=1"])


def test_each_row_is_the_run_of_its_case():
    study = sweep(ONE, ["machine.speed=500,700 rpm"], keep=["first.rigid_peak", "first.width", "first.wave_peak"])
    for row, speed in enumerate(("500 rpm", "700 rpm")):
        solution = strikewave.run_case(load_case("li-ma-2019", ["feed.blows=1", f"machine.speed={speed}"]))
        assert study.number("first.rigid_peak")[row] == solution.blows[0].rigid_peak
        assert study.number("first.width")[row] == solution.blows[0].width
    assert np.isnan(study.number("first.wave_peak")).all() == (solution.readings[0].wave_peak is None)


def test_an_impact_over_its_speed_follows_its_power():
    """Energy goes as v^2 into an elastic contact F = k d^n, and into one that is damped by the printed factors alike:
    the peak force rises with v^(2 n/(n + 1)) (Johnson 1985, 11.1), n = 10/9."""
    study = sweep(
        ONE, {"machine.speed": "300..1200 rpm:3 log"}, analysis="impact", keep=["peak_force", "approach_speed"]
    )
    n = 10.0 / 9.0  # of Palmgren's law, which the case has
    slopes = np.diff(np.log(study.number("peak_force"))) / np.diff(np.log(study.number("approach_speed")))
    assert slopes == pytest.approx(2.0 * n / (n + 1.0), rel=1e-8)


def test_words_are_varied_with_quantities():
    study = sweep(
        ONE,
        ["contact.damping=hunt-crossley,exact", "machine.speed=600..800 rpm:2"],
        analysis="fast",
        keep=["first.rigid_peak", "count"],
    )
    assert study.numbers.shape == (4, 2)
    assert [column.values for column in study.columns()][1] == ["hunt-crossley", "exact", "hunt-crossley", "exact"]
    exact = sweep(
        load_case("li-ma-2019", ["feed.blows=1", "contact.damping=exact"]),
        ["machine.speed=600..800 rpm:2"],
        analysis="fast",
        keep=["first.rigid_peak"],
    )
    np.testing.assert_array_equal(study.number("first.rigid_peak")[1::2], exact.number("first.rigid_peak"))


def test_draws_within_tolerances_are_those_of_scatter():
    case = load_case("li-ma-2019-equal-blows", ["feed.blows=2"])
    plan = plan_of(case, (), ["first.rigid_peak"], "fast", "tolerances", 3, 7)
    from strikewave.uncertainty.draws import drawn, random_points, tolerances_of

    inputs = tolerances_of(case)
    assert np.array_equal(np.array(plan.rows), drawn(inputs, random_points(inputs, 3, 7)))
    assert [variable.path for variable in plan.variables] == [name for one in inputs for name in one.names]


def test_a_run_that_fails_is_a_row_with_its_reason_and_a_mark():
    """No striker is 400 mm longer than its circle."""
    study = sweep(ONE, {"machine.engagement": ["1 mm", "400 mm"]}, analysis="fast", keep=["first.rigid_peak"])
    assert [bool(failure) for failure in study.failures] == [False, True]
    assert study.notices[0].code == "runs-failed"
    assert [study.exit_code(fail_on) for fail_on in ("failed", "broken", "never")] == [3, 3, 0]
    assert "run failed" in [text.get_text() for text in picture(study).legends[0].get_texts()]
    assert next(iter(study.reasons)) in unescape(page(study))


def test_the_stress_of_a_bar_is_the_force_over_its_area():
    case = load_case("li-ma-2019-fig13-bar")
    (layer,) = [one for one in case.stack.layer if one.name == next(t.layer for t in case.tap if t.name == "sensor")]
    force, stress = read_kept(case, "wave", ["tap.sensor.peak_force", "tap.sensor.peak_stress"])(case).numbers
    assert stress == pytest.approx(force / (math.pi / 4.0 * layer.diameter.si**2), rel=1e-14)


def test_a_study_whose_runs_all_fail_is_broken():
    study = sweep(ONE, {"machine.engagement": ["400 mm", "410 mm"]}, analysis="fast")
    assert study.failed == 2
    assert study.broken


@pytest.mark.verify
def test_numbers_of_elements_go_by_the_names_that_fits_use():
    """One run of a coarse model; the reading of the result itself is the other way."""
    case = load_case("two-bars-fem", ["mesh.part.striker.size=3 mm", "mesh.part.bar.size=3 mm"])
    keep = ["first.peak_force", "first.rigid_peak bar", "von_mises bar", "velocity_change striker", "energy_error"]
    evaluation = read_kept(case, "fem", keep)
    solution = run_fem(case)
    bar, striker = solution.parts["bar"], solution.parts["striker"]
    balance = balance_measure(solution.run).energy
    numbers = solution.number("first.peak_force"), bar.rigid_peak, bar.von_mises, striker.velocity_change, balance
    assert evaluation(case).numbers == numbers
    with pytest.raises(InputError, match='"von_mises PART" with the name of a part'):
        read_kept(case, "fem", ["von_mises"])
    with pytest.raises(InputError, match='did you mean "bar"'):
        read_kept(case, "fem", ["von_mises bra"])


def test_numbers_without_a_unit_are_written_without_one():
    study = sweep(ONE, {"contact.restitution": [0.5]}, analysis="fast", keep=["count", "first.rigid_peak"])
    assert study.plan.kept[0].words(3.0) == "3"
    assert study.at(0) == "contact.restitution = 0.5"
    assert study.plan.words == "one run (fast), grid, over contact.restitution"


def test_main_effects_of_a_known_function():
    """y = 2 a + b over a full grid of -1, 0, 1: variances 4, 1 of 5, and a a b adds nothing to either mean."""
    a, b = (axis.ravel() for axis in np.meshgrid([-1.0, 0.0, 1.0], [-1.0, 0.0, 1.0]))
    y = 2.0 * a + b
    assert main_effect(a, y, True).share == pytest.approx(0.8, rel=1e-12)
    assert main_effect(b, y, True).share == pytest.approx(0.2, rel=1e-12)
    assert main_effect(a, a * b, True).share == pytest.approx(0.0, abs=1e-12)
    assert main_effect(a, y, True).means.tolist() == [-2.0, 0.0, 2.0]
    assert math.isnan(main_effect(a, np.ones(9), True).share)


def test_a_fine_grid_is_parted_by_its_values():
    """y = a over thirteen values of a and two of b: all of the variance is that of a, however many values it has."""
    a, b = (axis.ravel() for axis in np.meshgrid(np.arange(13.0), [0.0, 1.0]))
    effect = main_effect(a, a, True)
    assert effect.share == pytest.approx(1.0, rel=1e-12)
    assert effect.places.tolist() == effect.means.tolist() == effect.lows.tolist() == list(range(13))
    assert main_effect(b, a, True).share == pytest.approx(0.0, abs=1e-12)
    assert main_effect(a, b, True).share == pytest.approx(0.0, abs=1e-12)
    assert main_effect(a, np.full(26, np.nan), True).means.size == 0


def test_share_of_random_runs_is_that_of_the_analysis_of_variance(rng):
    """epsilon squared = (F - 1) (k - 1) / (F (k - 1) + n - k), with F of scipy's one-way analysis of variance."""
    x = rng.integers(0, 4, 60).astype(float)
    y = x + rng.normal(size=60)
    f = f_oneway(*(y[x == k] for k in range(4))).statistic
    assert main_effect(x, y, False).share == pytest.approx((f - 1.0) * 3.0 / (f * 3.0 + 56.0), rel=1e-12)


def test_chance_has_no_share(rng):
    """Of a setting that does nothing, the estimate of 200 trials of 100 runs is 0 on the mean: within four standard errors."""
    shares = [main_effect(rng.random(100), rng.normal(size=100), False).estimate for _ in range(200)]
    assert abs(np.mean(shares)) < 4.0 * np.std(shares) / math.sqrt(200)


def test_settings_that_do_nothing_are_named_in_a_twentieth_of_studies(rng):
    """The largest of ten shares of 64 random runs, 400 times: 5 % of them lie above, within three standard errors."""
    largest = [max(main_effect(rng.random(64), y, False).share for _ in range(10)) for y in rng.normal(size=(400, 64))]
    above = np.mean(np.array(largest) > share_by_chance(64, 8, 10))
    assert abs(above - 0.05) < 3.0 * math.sqrt(0.05 * 0.95 / 400)


def test_ishigami_first_order_indices():
    """Closed form (Ishigami & Homma 1990, a = 7, b = 0.1): S1 = 0.3139, S2 = 0.4424, S3 = 0, less what varies within an
    eighth of a range: of sin^2 the means are 1/2 -+ 1/pi, of sin (1 - c) 4/pi and c 4/pi, c = cos 45 deg. 0.004 is what
    the points of 4096 runs leave."""
    from strikewave.studies.engine.plan import sobol_sequence

    x = math.pi * (2.0 * sobol_sequence(3, 4096, 1) - 1.0)
    y = np.sin(x[:, 0]) + 7.0 * np.sin(x[:, 1]) ** 2 + 0.1 * x[:, 2] ** 4 * np.sin(x[:, 0])
    shares = [main_effect(x[:, k], y, False).share for k in range(3)]
    whole = 0.5 + 49.0 / 8.0 + 0.1 * math.pi**4 / 5.0 + 0.01 * math.pi**8 / 18.0
    c = math.cos(math.pi / 4.0)
    first = (1.0 + 0.1 * math.pi**4 / 5.0) ** 2 * 0.5 * (16.0 / math.pi**2) * ((1.0 - c) ** 2 + c**2) / whole
    second = 49.0 / math.pi**2 / whole
    assert shares == pytest.approx([first, second, 0.0], abs=0.004)


@pytest.mark.parametrize(
    ("asked", "said"),
    [
        ({"design": "gird"}, "grid"),
        ({"analysis": "wave"}, "run, which this case is for"),
        ({"runs": 5}, "none with a grid"),
        ({"design": "sobol", "runs": 5}, "power of two"),
        ({"design": "tolerances"}, "nothing beside"),
        ({"vary": ()}, "missing; needed: a setting"),
        ({"vary": ["machine.speed=1..2 rpm", "machine.speed=1..2 rpm"]}, "each setting once"),
        ({"vary": ["machine.speed=1..2 rpm:10000", "object.spring=1..2 kN/m:10000"]}, "at most 1000000"),
        ({"design": "sobol", "seed": -1}, "--seed"),
    ],
)
def test_what_cannot_be_asked_is_refused(asked, said):
    with pytest.raises(InputError, match=said):
        plan_of(ONE, **{"vary": ["machine.speed=400..900 rpm:2"], **asked})


def test_many_settings_are_drawn_by_their_shares():
    case = load_case("li-ma-2019", ["feed.blows=1"])
    study = sweep(case, design="tolerances", runs=12, analysis="fast", keep=["first.rigid_peak"])
    chosen = drawn_settings(study)
    assert len(chosen) == 6 < len(study.plan.variables)
    assert len(picture(study).axes) >= 7


STUDY = """
schema = 1
case = "li-ma-2019"
set = { feed.blows = 1 }
keep = ["first.rigid_peak", "cv"]
analysis = "fast"
[vary]
machine.speed = "600..800 rpm:3"
object.spring = ["20 kN/m", "40 kN/m"]
"""


def test_a_study_file_asks_the_same(tmp_path):
    (tmp_path / "study.toml").write_text(STUDY)
    request = read_request(str(tmp_path / "study.toml"), ["object.damper=5 N s/m"], SweepRequest(keep=("count",)))
    plan = request.plan(request.loaded)
    assert [(v.path, len(v.axis.values)) for v in plan.variables] == [("machine.speed", 3), ("object.spring", 2)]
    assert plan.evaluation.names == ("count",)
    assert plan.evaluation.analysis == "fast"
    assert request.loaded.values()["object.damper"].si == 5.0
    assert request.loaded.values()["feed.blows"].si == 1.0


def test_a_study_file_need_not_vary(tmp_path):
    """Of draws within tolerances, the case says what moves."""
    (tmp_path / "drawn.toml").write_text('schema = 1\ncase = "li-ma-2019"\ndesign = "tolerances"\nruns = 4')
    request = read_request(str(tmp_path / "drawn.toml"), (), SweepRequest())
    assert len(request.plan(request.loaded).rows) == 4


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ('analysis = "fast"', 'analyse = "fast"'),
        ("schema = 1", "schema = 2"),
        ('case = "li-ma-2019"', ""),
        ('"600..800 rpm:3"', "true"),
    ],
)
def test_a_wrong_study_file_is_refused(tmp_path, change, said):
    (tmp_path / "study.toml").write_text(STUDY.replace(change, said))
    with pytest.raises(InputError):
        request = read_request(str(tmp_path / "study.toml"), (), SweepRequest())
        request.plan(request.loaded)
