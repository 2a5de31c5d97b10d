"""``strikewave settings --spec``: drop tables for JESD22-B110 and others, by closed forms, runs anew and other codes."""

import json
import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from strikewave.analyses.machine.run import run_case
from strikewave.base.constants import STANDARD_GRAVITY as G
from strikewave.base.errors import InputError, InputErrors, StrikewaveError
from strikewave.cases.case import load_case
from strikewave.contact import Contact, solve_impact
from strikewave.signal.pulse import measure_pulse
from strikewave.specifications.reading import load_specification
from strikewave.studies.engine.pools import GivenPool
from strikewave.studies.engine.store import RunStore
from strikewave.studies.search.drop_table import DropChoices, DropDesign, DropGoal, design_drop_table
from strikewave.studies.search.programmers import power_estimate, read_programmer

ROWS = ("H", "G", "B", "F", "A", "E", "D", "C")
FELT = "felt, stress=20 MPa, exponent=2.5, retardation=20 us"


def goal_of(asked, stroke=2.0):
    specification = load_specification(asked)
    return DropGoal(specification, specification.pulse_limits(), stroke)


def design(asked, programmer, diameters=(), stroke=2.0, masses=()):
    choice = DropChoices((read_programmer(programmer),), diameters, masses)
    return design_drop_table(load_case("jesd22-b111-b"), goal_of(asked, stroke), choice)


def test_a_design_goes_on_with_the_searches_that_a_store_has(unasked, pickling):
    choice = DropChoices((read_programmer("linear"), read_programmer(FELT)), (0.1,))
    words = load_case("jesd22-b111-b"), goal_of("jesd22-b110:A"), choice
    with RunStore(None) as store:
        first = design_drop_table(*words, store, GivenPool(pickling))
        again = design_drop_table(*words, store, unasked)
    assert first.document_text() == again.document_text()
    assert [one.departure for one in first.candidates] == [one.departure for one in again.candidates]


def test_a_linear_programmer_has_the_closed_form_of_a_half_sine():
    """v = A T/pi and d = A (T/pi)^2; the integrator then gives A and T back to 1e-6."""
    peak, duration, mass = 1500.0 * G, 0.5e-3, 20.0
    speed, depth = power_estimate(peak, duration, 0.0, 1.0, 1.0)
    assert speed == pytest.approx(peak * duration / math.pi, rel=1e-12)
    assert depth == pytest.approx(peak * (duration / math.pi) ** 2, rel=1e-12)
    blow = solve_impact(Contact(mass * peak / depth, 1.0), mass, math.inf, speed)
    assert float(blow.peak_force) == pytest.approx(mass * peak, rel=1e-6)
    assert float(blow.duration) == pytest.approx(duration, rel=1e-6)


@pytest.mark.parametrize("exponent", [1.0, 1.5, 2.5, 4.0])
def test_a_power_law_without_loss_has_the_peak_and_width_of_its_estimate(exponent):
    """Against scipy's integration of m x'' = -K x^n: the width at 10 % is read between 20 000 samples."""
    peak, width = 400.0 * G, 1.2e-3
    speed, depth = power_estimate(peak, width, 0.1, exponent, 1.0)
    stiffness = peak / depth**exponent

    def motion(_, y):
        return [y[1], -stiffness * max(y[0], 0.0) ** exponent]

    time = np.linspace(0.0, 2.0 * width, 20_001)
    path = solve_ivp(motion, (0.0, time[-1]), [0.0, speed], t_eval=time, rtol=1e-11, atol=1e-14).y[0]
    pulse = measure_pulse(stiffness * np.maximum(path, 0.0) ** exponent, float(time[1]))
    assert pulse.peak == pytest.approx(peak, rel=1e-6)
    assert pulse.width == pytest.approx(width, rel=1e-5)


@pytest.mark.parametrize("row", ROWS)
def test_a_design_for_jesd22_b110_gives_peak_and_width_when_its_case_is_run(row):
    """Within 0.5 % of table 1, where 2 % are asked; a run gives what the design was judged by."""
    study = design(f"jesd22-b110:{row}", "linear")
    assert study.best is not None
    stated = study.goal.specification.condition
    blow = run_case(study.case_of()).blows[0]
    assert blow.rigid_peak == pytest.approx(stated.peak.si, rel=5e-3)
    width = stated.duration.si * (1.0 - 2.0 * math.asin(0.1) / math.pi)
    assert blow.width == pytest.approx(width, rel=5e-3)
    assert blow.rigid_peak == pytest.approx(study.best.reading.peak, rel=1e-3)  # a sample in 2000 of the duration
    # without loss the table leaves as fast as it came: half of the equivalent speed, a quarter of the equivalent height;
    # a ringing of the frame, at 37 kHz, stands on the peak of the shortest pulses, by up to 2 %
    assert study.best.velocity_change == pytest.approx(stated.velocity_change.si, rel=0.025)
    assert 4.0 * study.best.height == pytest.approx(stated.drop_height.si, rel=0.05)
    # and that is said: the equivalent height is that of a fall without rebound
    assert study.best.restitution == pytest.approx(1.0, abs=0.01)
    (notice,) = (one for one in study.notices if one.code == "no-loss")
    assert (notice.value, notice.limit) == (study.best.height, study.heights[-1].height)
    assert study.heights[-1].height == pytest.approx(stated.drop_height.si, rel=0.01)
    assert [one.height * (1.0 + one.restitution) ** 2 for one in study.heights] == pytest.approx(
        [study.heights[-1].height] * len(study.heights), rel=1e-12
    )


def test_velocity_changes_and_drop_heights_of_jesd22_b110_follow_from_peak_and_duration():
    """dv = 2 A T/pi and h = dv^2/(2 g), within 1 % of all rows."""
    for row in ROWS:
        specification = load_specification(f"jesd22-b110:{row}")
        stated = specification.condition
        change = 2.0 / math.pi * stated.peak.si * stated.duration.si
        assert change == pytest.approx(stated.velocity_change.si, rel=0.01)
        assert change**2 / (2.0 * G) == pytest.approx(stated.drop_height.si, rel=0.01)


def test_a_felt_is_confirmed_by_an_integration_of_its_own():
    """Two rigid bodies on F = A (s x^n + T d(s x^n)/dt), never pulling: scipy, without the frame of the table.

    The frame of 100 GN/m takes 1e-3 of the compression, so that 0.5 % are left for it.
    """
    study = design("jesd22-b110:A", FELT, (0.1,))
    one = study.candidates[0]
    area, thickness, mass, anvil = math.pi * 0.05**2, one.thickness, 20.0, 2000.0

    def force(depth, rate):
        strain = max(depth, 0.0) / thickness
        return max(area * 20e6 * (strain**2.5 + 20e-6 * 2.5 * strain**1.5 * rate / thickness), 0.0)

    def motion(_, y):
        push = force(y[0], y[1])
        return [y[1], G - push / mass - push / anvil]

    time = np.linspace(0.0, 3e-3, 30_001)
    found = solve_ivp(motion, (0.0, 3e-3), [0.0, math.sqrt(2.0 * G * one.height)], t_eval=time, rtol=1e-10, atol=1e-13)
    pulse = measure_pulse(np.array([force(*row) for row in found.y.T]) / mass, float(time[1]))
    assert one.reading.peak == pytest.approx(500.0 * G, rel=5e-3)
    assert one.reading.peak == pytest.approx(pulse.peak, rel=5e-3)
    assert one.reading.width == pytest.approx(pulse.width, rel=5e-3)


def test_what_cannot_meet_a_pulse_says_why():
    study = design("jesd22-b110:B", "natural rubber 65 IRHD, restitution=0.75", (0.05, 0.3))
    first, last = study.candidates
    assert first.meets
    assert first.diameter == 0.3
    assert not last.meets
    assert "shape factor" in last.obstacles
    pressed = design("jesd22-b110:B", FELT, (0.05,)).candidates[0]
    assert not pressed.meets
    assert "of its thickness, above 90 %" in pressed.obstacles


def test_a_velocity_change_beyond_the_fall_is_refused_with_the_height_that_it_needs():
    """(1 + e) sqrt(2 g h) with e = 1: 30 000 g and 0.12 ms at 10 % need 7.3 m, less where the frame rings."""
    with pytest.raises(InputError, match=r"about 73\d\d mm or more") as caught:
        design("mil-std-883-2002:G", "linear")
    assert "a fall of 2000 mm gives at most 12.53 m/s" in caught.value.hint
    # where some programmer could, those that cannot say so
    study = design("mil-std-883-2002:G", "linear", stroke=7.0)
    assert study.best is not None
    goal = goal_of("jesd22-b110:B", 0.3)
    lossy = DropDesign(load_case("jesd22-b111-b"), goal, read_programmer("linear, restitution=0.5"), None, None, "")
    assert "needs a drop of" in lossy.candidate(lossy.answer()).obstacles


def test_a_spring_that_loses_energy_asks_for_the_height_of_its_velocity_change():
    """h = (dv/(1 + e))^2/(2 g), about: the search makes good that its pulse is no half-sine."""
    lossless, lossy = (design("jesd22-b110:A", f"linear, restitution={e}").candidates[0] for e in (1, 0.8))
    change = lossless.velocity_change
    assert lossy.reading.peak == pytest.approx(lossless.reading.peak, rel=5e-3)
    assert lossy.height == pytest.approx((change / 1.8) ** 2 / (2.0 * G), rel=0.1)
    assert lossy.departure > lossless.departure
    assert lossy.restitution == pytest.approx(0.8, abs=0.01)
    assert (lossless.lossless, lossy.lossless) == (True, False)


def test_a_heavier_table_takes_a_stiffer_spring_and_the_same_height():
    """The pulse depends on rate over mass alone, but for the anvil: 20 of 2000 kg, 40 of 2000."""
    study = design("jesd22-b110:A", "linear", masses=(20.0, 40.0))
    light, heavy = sorted(study.candidates, key=lambda one: one.table_mass)
    assert heavy.rate == pytest.approx(2.0 * light.rate, rel=0.02)
    assert heavy.height == pytest.approx(light.height, rel=0.03)


def test_the_pad_of_a_case_is_tried_with_its_own_properties_and_provenance():
    """That of iec-60068-2-27-rubber: 100 mm across and fitted to the peak of 100 g alone with 25 mm."""
    case = load_case("iec-60068-2-27-rubber")
    specification = load_specification("iec-60068-2-27:100g-6ms")
    goal = DropGoal(specification, specification.pulse_limits(), 2.0)
    study = design_drop_table(case, goal, DropChoices(diameters=(0.1,)))
    pad = next(one for one in study.candidates if one.programmer.table is not None)
    values = pad.case.values()
    assert values["contact.restitution"].si == 0.75
    assert values["contact.restitution"].note == case.values()["contact.restitution"].note
    assert pad.reading.peak == pytest.approx(100.0 * G, rel=5e-3)
    # the case has the peak alone, and is 6.05 ms wide at 10 %: for 5.62 ms the pad is stiffer, and so thinner
    assert pad.thickness < 0.025
    rubber = next(one for one in study.candidates if one.programmer.name == "natural rubber 65 IRHD")
    assert pad.thickness == pytest.approx(rubber.thickness, rel=1e-3)


def test_the_written_case_gives_the_pulse_again(strikewave):
    words = (
        "--spec",
        "jesd22-b110:C",
        "--programmer",
        "natural rubber 65 IRHD, restitution=0.75",
        "--diameter",
        "100 mm",
    )
    code, out, _ = strikewave("settings", *words, "--out", "found", "--json")
    assert code == 0
    best = json.loads(out)["best"]
    assert best["verdict"] == "pass"
    assert [clause["verdict"] for clause in best["clauses"]] == ["pass", "pass"]
    code, out, _ = strikewave("run", "--no-band", "found/case.toml", "--json")
    assert code == 0
    (blow,) = json.loads(out)["blows"]
    assert blow["rigid_peak"] == pytest.approx(best["rigid_peak"], rel=1e-12)
    assert blow["rigid_peak"] == pytest.approx(100.0 * G, rel=5e-3)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--spec", "jesd22-b110:Z"], "--spec"),
        (["--spec", "nasa-gevs"], "a specification of a pulse"),
        (["--spec", "mil-std-810h-sawtooth:ground"], "a half-sine"),
        (["--spec", "jesd22-b110:B", "--peak", "100 g"], '--peak: got "100 g"; allowed: none with --spec, which states it'),
        (["--spec", "jesd22-b110:B", "--strikers", "3"], "--strikers: got 3; allowed: none of a drop table"),
        (["--spec", "jesd22-b110:B", "--programmer", "velt"], 'did you mean "felt"?'),
        (["--spec", "jesd22-b110:B", "--programmer", "felt, stress=20 MPa"], "exponent, retardation besides"),
        (["--spec", "jesd22-b110:B", "--programmer", "felt, stres=20 MPa"], 'did you mean "stress"?'),
        (["--spec", "jesd22-b110:B", "--programmer", "lead"], "one that comes back"),
        (["--spec", "jesd22-b110:B", "--programmer", "linear, restitution=2", "--out", "o"], "contact.restitution"),
        (["--spec", "jesd22-b110:B", "--stroke", "0.2 m", "--programmer", "linear"], "gives at most 3.961 m/s"),
        (["--spec", "jesd22-b110:B", "--diameter", "0 mm"], "--diameter"),
        (["--spec", "jesd22-b110:B", "--set", "machine.height=1 m"], "machine.height: got \"1 m\"; allowed: no --set of it"),
        (["--spec", "jesd22-b110:B", "--set", "contact.restitution=0.5"], "--programmer or --diameter state it"),
        (["--spec", "jesd22-b110:B", "--from", "en-166-ball"], "a drop table or a rotary machine"),
        (["--spec", "jesd22-b110:B", "--from", "li-ma-2019"], "--interval: missing"),
        (["--interval", "20 ms", "--peak", "1 g", "--width", "1 ms", "--stroke", "1 m"], "it is of a drop table"),
        (["--interval", "20 ms", "--width", "1 ms"], "--peak: missing"),
    ],
)  # fmt: skip
def test_a_wrong_word_is_one_line(strikewave, words, said):
    code, out, err = strikewave("settings", *words)
    assert (code, out) == (2, "")
    assert said in err
    assert len(err.splitlines()) == 1


@pytest.mark.verify
@pytest.mark.parametrize("row", ROWS)
def test_pads_for_jesd22_b110_meet_peak_and_width_where_they_keep_their_limits(row):
    """Felt and rubber, all diameters: half a minute."""
    study = design_drop_table(load_case("jesd22-b111-b"), goal_of(f"jesd22-b110:{row}"))
    stated = study.goal.specification.condition
    met = [one for one in study.candidates if one.meets]
    assert {one.programmer.name for one in met} >= {"linear", "felt"}
    for one in met:
        blow = run_case(one.case).blows[0]
        assert blow.rigid_peak == pytest.approx(stated.peak.si, rel=0.02)
        assert one.reading.width == pytest.approx(0.9362 * stated.duration.si, rel=0.02)


@pytest.mark.verify
def test_the_rotary_machine_is_judged_blow_by_blow(strikewave):
    words = ("--spec", "jesd22-b110:H", "--from", "li-ma-2019", "--interval", "20 ms", "--blows", 4)
    code, out, _ = strikewave("settings", *words, "--strikers", 4, "--striker-mass", "1 kg", "--json")
    assert code == 0
    best = json.loads(out)["best"]
    assert best["verdict"] == "pass"
    assert {clause["clause"] for clause in best["clauses"]} == {"peak", "pulse width at 10 %"}
    assert best["peak"]["typical"] == pytest.approx(2900.0 * G, rel=0.05)


def test_python_refuses_a_specification_without_an_interval_as_the_command_does():
    import strikewave

    with pytest.raises(InputError, match="--interval: missing"):
        strikewave.settings(spec="jesd22-b110:H")
    with pytest.raises(InputError, match="programmers"):
        strikewave.drop_table("jesd22-b110:A", programmers=["velt"])
    with pytest.raises(InputError, match="by: got"):
        strikewave.synthesize("nasa-gevs", by="cosines")


@pytest.mark.verify
def test_the_recorder_of_a_design_holds_what_the_specification_looks_at(strikewave):
    """The record of its run, zero in the fall, is judged as the design is: it ended in the pulse, and began at touch."""
    asked = "iec-60068-2-27:50g-11ms"
    chosen = ("--programmer", "linear, restitution=1", "--out", "design")
    assert strikewave("settings", "--spec", asked, *chosen)[0] == 0
    run = strikewave("run", "design/case.toml", "--no-band", "--histories", "csv", "--out", "kept", "--json")
    assert "recorder-memory" not in run[1]
    code, out, err = strikewave("record", "kept/histories-record.csv", "--spec", asked, "--json")
    assert code == 0, err
    assert json.loads(out)["spec"]["verdict"] == "pass"


def test_a_stroke_that_is_too_short_is_refused_with_what_its_fall_gives():
    """(1 + e) sqrt(2 g h) of 50 mm is 1.981 m/s."""
    with pytest.raises(InputError, match=r'--stroke: got "50 mm".*at most 1\.981 m/s'):
        design("iec-60068-2-27:50g-11ms", "linear, restitution=1", stroke=0.05)


def test_a_rate_at_its_bound_is_called_a_rate():
    bounds = np.log([1.0, 1.0]), np.log([9.0, 9.0])
    for programmer, diameter, size in (("linear", None, "rate"), (FELT, 0.1, "thickness")):
        tried = DropDesign(
            load_case("jesd22-b111-b"), goal_of("jesd22-b110:A"), read_programmer(programmer), diameter, None, ""
        )
        assert tried.at_bound(np.log([9.0, 2.0]), *bounds) == f"the {size} stands at the largest that is sought"
        assert tried.at_bound(np.log([2.0, 9.0]), *bounds) == ""


def test_where_nothing_can_be_run_each_reason_is_named_once(monkeypatch):
    def fails(*_):
        raise StrikewaveError("it cannot be followed")

    monkeypatch.setattr("strikewave.studies.search.drop_table.run_machine", fails)
    choice = DropChoices((read_programmer("linear"), read_programmer(FELT)), (0.1,))
    with pytest.raises(InputErrors) as told:
        design_drop_table(load_case("jesd22-b111-b"), goal_of("jesd22-b110:A"), choice)
    assert told.value.lines == ("it cannot be followed",)


@pytest.mark.verify
def test_each_design_that_does_not_meet_has_its_reason_and_an_assumed_law_is_said(strikewave):
    code, out, _ = strikewave("settings", "--spec", "iec-60068-2-27:50g-11ms", "--diameter", "50 mm", "--out", "kept")
    assert code == 0
    assert "#4: pressed by 33" in out
    assert "its law is assumed" in out.replace("\n", " ")
    rows = json.loads(open("kept/settings.json").read())["candidates"]
    met = [row["programmer"] for row in rows if row["meets"]]
    assert "felt" not in met or met.index("felt") == len(met) - 1
