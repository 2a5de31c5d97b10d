"""`strikewave compare`: what is known of two histories comes out; what cannot be compared is refused in one line."""

import json
import os
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from strikewave import InputError, Scoring, compare, load_case, load_solution, run_case
from strikewave.analyses.compare.agreement import ComparedCurve, agreement, checked_curve, even_history, mean_curve
from strikewave.analyses.compare.run import _ringing
from strikewave.analyses.compare.simulated import _parts, solution_curve
from strikewave.base.datasets import LabelledArrays
from strikewave.reporting.faces import face_table
from strikewave.signal.alignment import EvenHistory
from strikewave.signal.filters import Filter

G = 9.80665


def bell(time, at=1e-3, peak=500.0, width=5e-5):
    return peak * np.exp(-(((time - at) / width) ** 2))


def write(name, values, step=1e-6, head="time (s),frame (g)"):
    table = np.column_stack([step * np.arange(len(values)), values])
    np.savetxt(name, table, delimiter=",", header=head, comments="", fmt="%.9g")
    return name


def curve(values, step=1e-6, start=0.0, unit="m/s^2", name="one"):
    return ComparedCurve(name, "record", EvenHistory(np.asarray(values), step, start), unit)


TIME = 1e-6 * np.arange(2000)


def test_a_history_agrees_with_itself_perfectly(strikewave, tmp_path):
    write("a.csv", bell(TIME))
    code, out, _ = strikewave("compare", "a.csv", "a.csv", "--json")
    metrics = json.loads(out)["metrics"]
    assert code == 0
    assert [metrics[name]["difference"] for name in ("peak", "width", "velocity_change")] == [0.0, 0.0, 0.0]
    assert (metrics["rms"], metrics["correlation"]) == (0.0, pytest.approx(1.0, abs=1e-12))
    assert [metrics["iso18571"][name] for name in ("corridor", "phase", "magnitude", "slope", "overall")] == [1.0] * 5
    assert metrics["srs"]["largest"]["ratio"] == 0.0
    assert metrics["shift"]["value"] == pytest.approx(0.0, abs=1e-15)


@pytest.mark.parametrize("name", ["jesd22-b111-b", "iec-60068-2-27-rubber", "en-166-ball", "li-ma-2019"])
def test_compare_reads_off_the_figures_of_the_run(name):
    """One pulse, one zero, one foot: 2e-3, of coarser samples, and of a carriage that still slows down by 3 g."""
    solution = run_case(load_case(name))
    first = solution.blows[0]
    pulse = solution_curve("A", solution, "rigid", 0, "").pulse
    assert pulse.peak == pytest.approx(first.rigid_peak, rel=2e-3)
    assert pulse.width == pytest.approx(first.width, rel=2e-3)
    assert pulse.area == pytest.approx(first.velocity_change, rel=2e-3)


@settings(max_examples=8, deadline=None, derandomize=True)
@given(
    st.floats(-4e-4, 4e-4),
    st.floats(0.3, 3.0),
    st.floats(0.4e-6, 2.5e-6),
    st.sampled_from(["correlation", "onset", "peak"]),
)
def test_a_known_shift_and_factor_come_back(shift, factor, step, align):
    """Whatever the sampling of B: 1e-3 is the parabola of the peak of a bell of 20 samples or more."""
    time = step * np.arange(int(3e-3 / step))
    b = curve(factor * bell(time, 1.2e-3 - shift), step)
    found = agreement(curve(bell(TIME, 1.2e-3)), b, align)
    assert found.shift.shift == pytest.approx(shift, abs=0.01 * min(step, 1e-6))
    assert found.pulse_b.peak / found.pulse_a.peak == pytest.approx(factor, rel=1e-3)
    assert found.pulse_b.area / found.pulse_a.area == pytest.approx(factor, rel=2e-3)
    assert found.rms == pytest.approx(abs(factor - 1.0), abs=2e-3)
    assert np.allclose(found.ratio, 20.0 * np.log10(factor), atol=0.05)
    assert found.rating.phase == 1.0


def test_the_same_filter_on_both_leaves_the_same_difference():
    """A factor passes through a linear filter."""
    a, b = (curve(size * bell(TIME)).filtered(Filter(10e3)) for size in (1.0, 1.1))
    assert a.pulse.peak < 0.98 * 500.0
    assert agreement(a, b, "correlation").rms == pytest.approx(0.1, rel=1e-9)


def test_without_alignment_the_phase_score_says_how_late_b_comes():
    """The interval is that of both pulses with half of one on either side; 20 us of it over a fifth of it."""
    found = agreement(curve(bell(TIME, 1e-3)), curve(bell(TIME, 1.02e-3)), "none")
    length = found.interval[1] - found.interval[0]
    assert found.rating.phase == pytest.approx(1.0 - 20e-6 / (0.2 * length), abs=0.01)  # a sample of a thousand
    assert found.shift.shift == 0.0


def test_a_campaign_is_the_mean_of_its_records_with_their_deviations():
    """Three bells of 0.9, 1 and 1.1 at different times: deviation 0.1 of the mean at every sample."""
    curves = [curve(bell(TIME, at, 500.0 * size)) for at, size in ((1e-3, 1.0), (1.1e-3, 0.9), (0.95e-3, 1.1))]
    mean = mean_curve("A", "three", curves, [0.0, -1e-4, 5e-5])
    assert mean.pulse.peak == pytest.approx(500.0, rel=1e-4)
    assert np.allclose(mean.deviation, 0.1 * mean.history.values, atol=0.01)
    assert agreement(mean, curve(bell(TIME, 1e-3, 590.0)), "correlation").inside(2.0) == 1.0
    assert agreement(mean, curve(bell(TIME, 1e-3, 620.0)), "correlation").inside(2.0) == 0.0


def test_a_campaign_of_files_leaves_out_what_cannot_be_read(strikewave):
    os.mkdir("shots")
    for k, size in enumerate((480.0, 500.0, 520.0)):
        write(f"shots/{k}.csv", bell(TIME, 1e-3 + 1e-5 * k, size))
    with open("shots/note.txt", "w") as file:
        file.write("no record\n")
    with open("shots/calibration.toml", "w") as file:  # no record either
        file.write('[all]\nunit = "g"\n')
    write("b.csv", bell(TIME, peak=505.0))
    found = compare("shots", "b.csv", limits=["inside > 90 %"])
    assert found.a.count == 3
    assert found.verdict == "pass"
    assert "left-out" in {notice.code for notice in found.notices}


def test_all_blows_of_a_record_are_a_campaign(strikewave):
    """Four bells of 480 to 540 g: their mean, and the deviation of their peaks."""
    time, sizes = 1e-6 * np.arange(20_000), [480.0, 500.0, 520.0, 540.0]
    write("train.csv", sum(bell(time, 2e-3 + 5e-3 * k, size) for k, size in enumerate(sizes)))
    write("b.csv", bell(TIME, peak=510.0))
    found = compare("train.csv@all", "b.csv")
    assert (found.a.count, found.a.kind, found.a.name) == (4, "campaign", "4 blows of train.csv")
    assert found.figures["peak"].a == pytest.approx(510.0 * G, rel=1e-3)
    assert found.agreement.deviation.max() == pytest.approx(np.std(sizes, ddof=1) * G, rel=1e-2)
    assert found.agreement.inside(2.0) == 1.0
    assert compare("train.csv@3", "b.csv").figures["peak"].a == pytest.approx(520.0 * G, rel=1e-3)


@pytest.mark.verify
def test_a_case_is_run_and_its_band_held_against_the_record(strikewave):
    """The record is the simulation itself, one per cent higher: it lies within the band of the peak.

    Its zero is estimated from what lies before the blow, which begins gradually: 0.3 % of the peak.
    """
    kept = strikewave("run", "jesd22-b111-b", "--out", "kept")
    assert kept[0] == 0
    solution = load_solution("kept")
    time, values = solution.arrays["pulse_time"].values, solution.arrays["pulse_acceleration"].values[0]
    known = np.isfinite(values)
    record = np.interp(np.arange(time[known][0] - 5e-4, time[known][-1], 2e-6), time[known], values[known])
    write("record.csv", 1.01 * record / G, 2e-6)
    found = compare("record.csv", "kept")
    assert found.figures["peak"].difference == pytest.approx(1.0 / 1.01 - 1.0, abs=4e-3)
    assert found.agreement.rating.overall > 0.98
    assert {(one.figure, one.inside) for one in found.in_bands} >= {("peak", True), ("width", True)}
    for again in ("jesd22-b111-b:rigid@1", solution, (solution, "rigid@1")):
        assert compare("record.csv", again).agreement.rating == found.agreement.rating


@pytest.mark.verify
def test_a_part_of_a_kept_bar_is_taken_in_the_quantity_of_the_record(strikewave):
    assert strikewave("wave", "li-ma-2019-fig13-bar", "--no-band", "--out", "bar")[0] == 0
    assert compare("bar:sensor", "bar").quantity == "acceleration"
    found = compare("bar:face", "bar:sensor", align="none")
    assert (found.quantity, found.unit) == ("force", "N")


def test_key_numbers_say_differences_as_their_table_does_and_documents_the_unit_of_each(strikewave):
    write("a.csv", bell(TIME)), write("b.csv", bell(TIME, 1.1e-3, 520.0))
    found = compare("a.csv", "b.csv")
    said = dict(found.highlights())
    assert list(said) == ["ISO/TS 18571", "peak", "pulse width at 10 %", "velocity change", "shift"]
    table = {str(row[0]).partition(" (")[0]: row[3] for row in face_table(found, "pairs").cells()}
    assert said["peak"] == table["peak"] == "+4.00 %"
    units = found.document()["units"]
    assert [units[key] for key in ("peak", "velocity_change", "history", "a_uncertainty", "overall")] == [
        "m/s^2", "m/s", "m/s^2", "as the figure", "1"
    ]  # fmt: skip


def test_limits_decide_verdict_and_exit_code(strikewave):
    write("a.csv", bell(TIME)), write("b.csv", bell(TIME, 1.1e-3, 520.0))
    limits = ("--limit", "peak < 5 %", "--limit", "srs < 0.5 dB", "--limit", "shift < 120 us")
    code, out, _ = strikewave("compare", "a.csv", "b.csv", *limits, "--out", "kept")
    assert (code, "PASS: 3 of 3" in out) == (0, True)
    assert sorted(os.listdir("kept")) == ["comparison.csv", "record.toml", "report.html", "spectrum.csv", "summary.svg"]
    code, out, _err = strikewave(
        "compare", "a.csv", "b.csv", "--limit", "peak <= 3 %", "--limit", "inside > 90 %", "--json"
    )
    document = json.loads(out)
    assert (code, document["verdict"]) == (3, "fail")
    assert [one["verdict"] for one in document["limits"]] == ["fail", "cannot-tell"]
    assert {w["code"] for w in document["warnings"]} == {"limit-peak", "limit-inside"}
    assert set(document["metrics"]) == {
        "peak", "width", "velocity_change", "impulse", "rms", "correlation", "srs", "iso18571", "shift", "inside", "band"
    }  # fmt: skip


@pytest.mark.verify
def test_a_limit_kept_by_less_than_its_uncertainty_says_so_and_one_missed_is_told_in_its_own_unit(strikewave):
    """Peaks 2 % apart pass by 1 % where 5 % are known; the message has no share beside a percentage."""
    write("a.csv", bell(TIME)), write("b.csv", bell(TIME, 1e-3, 510.0))
    words = ("compare", "a.csv", "b.csv", "--uncertainty", "5 %")
    _, out, err = strikewave(*words, "--limit", "peak < 3 %", "--out", "x")
    assert "limit-in-doubt" in err
    assert "2.0 ± 7.2 %" in out  # 5 % of each, times 1.02
    _, _, err = strikewave(*words, "--limit", "peak < 1 %", "--out", "y")
    assert "limit 0.01" not in err


@pytest.mark.verify
def test_units_shown_reach_the_limits(strikewave):
    write("a.csv", bell(TIME)), write("b.csv", bell(TIME, 1.1e-3))
    _, out, _ = strikewave("compare", "a.csv", "b.csv", "--limit", "shift < 120 us", "--show", "ms,m/s2", "--out", "x")
    assert "0.1 ms" in out
    assert "us" not in out.split("Limits")[1].replace("120 us", "")
    assert "4903" in out  # 500 g in m/s^2


def test_opposite_signs_are_reported(strikewave):
    write("a.csv", bell(TIME)), write("b.csv", -bell(TIME))
    assert "polarity" in {notice.code for notice in compare("a.csv", "b.csv", align="peak").notices}
    assert "polarity" not in {notice.code for notice in compare("a.csv", "a.csv").notices}


@pytest.mark.parametrize("shape", ["bell", "ringing"])
def test_pulses_of_opposite_sign_are_aligned_as_those_of_one(strikewave, shape):
    """Of the same pulse, shifted and turned round, the shift is that of the pulse; it was that of a flank or a swing."""
    first, second = (
        bell(TIME, at) * (1.0 if shape == "bell" else np.cos(2.0 * np.pi * 8e3 * (TIME - at)))
        for at in (1e-3, 1.0373e-3)
    )
    write("a.csv", first), write("b.csv", -second)
    found = compare("a.csv", "b.csv")
    assert found.agreement.shift.shift == pytest.approx(-37.3e-6, abs=1e-8)
    [said] = [notice.message for notice in found.notices if notice.code == "polarity"]
    assert "opposite signs" in said
    assert "polarity = -1 under [all] in a file beside one, such as shot.csv.toml" in said
    Path("b.csv.toml").write_text("[all]\npolarity = -1\n")
    turned = compare("a.csv", "b.csv")
    assert "polarity" not in {notice.code for notice in turned.notices}
    assert turned.figures["peak"].difference == pytest.approx(0.0, abs=1e-3)


def test_a_pickup_in_both_that_moves_the_shift_is_reported(strikewave, rng):
    """A tone of 60 kHz in both at the same time pulls the shift of 37.3 us towards it: by nine uncertainties."""
    for name, at, pickup in (("a.csv", 1e-3, 1.0), ("b.csv", 1.0373e-3, 1.0), ("c.csv", 1.0373e-3, 0.0)):
        noise = 10.0 * rng.normal(size=TIME.size)
        write(name, bell(TIME, at) + noise + 10.0 * pickup * np.sin(2.0 * np.pi * 60e3 * TIME))
    [said] = [one for one in compare("a.csv", "b.csv").notices if one.code == "alignment-doubt"]
    assert "--filter" in said.message
    low = float(said.message.partition("by the low ones alone is ")[2].split("\xa0")[0])
    assert low == pytest.approx(-37.3, abs=0.8)  # four standard uncertainties
    assert "alignment-doubt" not in {one.code for one in compare("a.csv", "c.csv").notices}
    assert "alignment-doubt" not in {one.code for one in compare("a.csv", "b.csv", filter="30 kHz").notices}


def test_what_the_coarser_history_cannot_hold_is_reported():
    ripple = 50.0 * np.sin(2e5 * 2.0 * np.pi * TIME) * (np.abs(TIME - 1e-3) < 3e-4)
    found = agreement(curve(bell(1e-5 * np.arange(200)), 1e-5), curve(bell(TIME) + ripple), "correlation")
    assert found.lost > 0.1
    assert agreement(curve(bell(TIME)), curve(bell(TIME) + ripple), "correlation").lost == 0.0


def test_times_that_are_not_even_are_taken_on_lines_between_them():
    time = np.array([0.0, 1.0, 2.0, 2.9, 4.0])
    history = even_history(time, 3.0 * time)
    assert history.step == 1.0
    assert np.allclose(history.values, 3.0 * history.time)


def test_elements_give_bodies_first_along_the_axis_on_which_they_move_most():
    along = np.zeros((50, 3))
    along[:, 2] = -bell(np.arange(50.0), 25.0, 9.0, 6.0)
    time = ("interval", 1e-6 * np.arange(50.0))
    names = ("contact.face.mean_force", "part.ball.mean_acceleration")
    variables = {
        name: (("interval", "axis"), along, {"units": unit}) for name, unit in zip(names, ("N", "m/s^2"), strict=True)
    }
    parts = list(_parts(LabelledArrays.of(variables, {"interval": time}, {}), {}))
    assert [(one.part, one.quantity) for one in parts[::4]] == [("ball", "acceleration"), ("face", "force")]
    assert np.array_equal(parts[0].values, along[:, 2])
    assert [one.part for one in parts[1:4]] == ["ball.x", "ball.y", "ball.z"]


@pytest.mark.verify
def test_a_difference_has_the_uncertainty_that_noise_makes_it_scatter_by(strikewave):
    """Ten records of noise of 1 % tell a deviation within a quarter; factor two is three of those."""
    generator, found = np.random.default_rng(7), []
    write("a.csv", bell(TIME))
    for _ in range(10):
        write("b.csv", bell(TIME) + 5.0 * generator.normal(size=TIME.size))
        found.append(compare("a.csv", "b.csv").figures["velocity_change"])
    scatter = np.std([one.difference for one in found], ddof=1)
    assert 0.5 * scatter < np.mean([one.uncertainty for one in found]) < 2.0 * scatter


@pytest.mark.parametrize(
    ("peak", "duration", "verdict"), [(1.0, 1.0, "pass"), (1.19, 1.0, "pass"), (1.21, 1.0, "fail"), (1.0, 1.4, "fail")]
)
def test_a_pulse_is_judged_by_a_specification_as_b(strikewave, peak, duration, verdict):
    """JESD22-B110 condition B: 1500 g +- 20 % and 0.5 ms +- 30 %, at 10 % of the peak."""
    time = 1e-6 * np.arange(6000)
    share = (time - 2e-3) / (duration * 0.5e-3)
    write("a.csv", 1500.0 * peak * np.where((share > 0.0) & (share < 1.0), np.sin(np.pi * share), 0.0))
    code, out, _ = strikewave("compare", "a.csv", "spec:jesd22-b110:B", "--json")
    document = json.loads(out)
    assert (code, document["verdict"], document["spec"]["verdict"]) == (0 if verdict == "pass" else 3, verdict, verdict)
    assert {clause["clause"] for clause in document["spec"]["clauses"]} >= {"peak", "pulse width at 10 %"}
    assert document["metrics"]["peak"]["difference"] == pytest.approx(1.0 / peak - 1.0, abs=3e-3)
    if peak == duration == 1.0:
        assert document["metrics"]["iso18571"]["overall"] > 0.99


@pytest.mark.verify
def test_a_simulation_is_judged_by_the_specification_that_it_was_made_for(strikewave):
    """Its pulse lasts longer than the window of a blow: it is taken out of the whole run, and known to begin at rest."""
    code, out, _ = strikewave("compare", "jesd22-b111-b", "spec:jesd22-b111", "--out", "kept")
    assert code == 0
    assert out.startswith("PASS (by indicative limits) by JESD22-B111A")
    page = open("kept/report.html", encoding="utf-8").read()
    assert "Verdict by the specification" in page
    found = compare("iec-60068-2-27-rubber", "spec:iec-60068-2-27:100g-6ms", scoring=Scoring(band=False))
    assert (found.verdict, found.broken) == (
        "cannot-tell",
        False,
    )  # the run ends before the window of the velocity change
    assert found.agreement.rating.overall > 0.8
    assert found.a.history.start < -0.01
    assert {c.verdict for c in found.specified.found.clauses if c.clause == "peak"} == {"pass"}


@pytest.mark.parametrize("wrong", [3.0, ["a.csv"], (3.0, "sensor")])
def test_what_is_neither_a_name_nor_a_solution_is_refused(wrong):
    with pytest.raises(InputError, match=r"B: got .* a solution of run, wave or fem"):
        compare("li-ma-2019", wrong, scoring=Scoring(band=False))


REFUSED = [
    (("a.csv", "b.cvs"), "B: got", 'did you mean "b.csv"?'),
    (("li-ma-2091", "a.csv"), "A: got", 'did you mean "li-ma-2019"?'),
    (("none*.csv", "a.csv"), "A: got", "a pattern that finds files"),
    (("a.csv", "empty"), "B: got", "it is empty"),
    (("a.csv", "nothing.csv"), "nothing.csv", ""),
    (("a.csv", "force.csv"), "B: got", "the quantity of A"),
    (("a.csv", "bare.csv"), "--unit: got", "state --unit"),
    (("a.csv", "zero.csv"), "B: got", "zero throughout"),
    (("a.csv", "short.csv"), "B: got", "8 samples or more"),
    (("a.csv", "a.csv#fram"), "B: got", 'did you mean "frame"?'),
    (("a.csv", "a.csv@3"), "B: got", "a blow from 1 to 1"),
    (("a.csv", "a.csv@0"), "B: got", 'did you mean "a.csv"?'),
    (("a.csv", "@2"), "B: got", "a measured file"),
    (("a.csv", "a.csv@all"), "B: got", "two blows or more"),
    (("a.csv", "li-ma-2019@all"), "B: got", "@all for a record alone"),
    (("a.csv", "a" * 5000), "B: got", "a measured file"),
    (("a.csv", "result"), "B: got", "names the files that it is of"),
    (("a.csv:frame", "a.csv"), "A: got", 'write "a.csv#frame"'),
    (("li-ma-2019#rigid", "a.csv"), "A: got", 'write "li-ma-2019:rigid"'),
    (("a.csv", "late.csv", "--align", "none"), "--align: got", "histories that overlap in time"),
    (("a.csv", "b.csv", "--filter", "600 kHz"), "--filter: got", "half the sampling rate"),
    (("a.csv", "b.csv", "--align", "fit"), "--align", "correlation"),
    (("a.csv", "b.csv", "--limit", "iso1857 > 0.8"), "--limit: got", 'did you mean "iso18571"?'),
    (("a.csv", "b.csv", "--limit", "iso18571"), "--limit: got", "one of < <= > >="),
    (("a.csv", "b.csv", "--limit", "shift < 3"), "--limit: got", "a time with its unit"),
    (("a.csv", "b.csv", "--limit", "peak < much"), "--limit: got", "a share with its sign"),
    (("a.csv", "b.csv", "--limit", "peak < 5"), "--limit: got", 'write "5 %"'),
    (("a.csv", "b.csv", "--limit", "inside > 0.9"), "--limit: got", 'write "90 %", or "0.9 %"'),
    (("a.csv", "b.csv", "--limit", "rms < 5 dB"), "--limit: got", "a share with its sign"),
    (("a.csv", "b.csv", "--limit", "srs < 3"), "--limit: got", 'such as "3 dB"'),
    (("a.csv", "b.csv", "--limit", "iso18571 > 80"), "--limit: got", "at most 1"),
    (("a.csv", "b.csv", "--limit", "iso18571 < 0.8"), "--limit: got", "> or >= of iso18571; high is good"),
    (("a.csv", "b.csv", "--limit", "peak > 5 %"), "--limit: got", "< or <= of peak"),
    (("a.csv", "b.csv", "--limit", "peak < -5 %"), "--limit: got", "at least 0"),
    (("a.csv", "b.csv", "--limit", "energy < 5 %"), "--limit: got", "peak, width, velocity_change, impulse, rms,"),
    (("a.csv", "b.csv", "--limit", "peak 5 %"), "--limit: got", "metrics: peak, width, velocity_change"),
    (("a.csv", "b.csv", "--from", "5 s", "--to", "6 s"), "--from: got", "within the common time"),
    (("a.csv", "b.csv", "--from", "2 ms", "--to", "1 ms"), "--to: got", "a time after --from"),
    (("spec:jesd22-b110:B", "a.csv"), "A: got", "name the specification second"),
    (("a.csv", "spec:jesd22-b11:B"), "B: got", 'did you mean "jesd22-b111"?'),
    (("a.csv", "spec:nasa-gevs"), "--spec: got", "a specification of a pulse"),
    (("force.csv", "spec:jesd22-b110:B"), "B: got", "the quantity of A"),
    (("[ab].csv", "spec:jesd22-b110:B"), "A: got", "one blow of a record, or a simulation"),
    (("a.csv", "b.csv", "--deviations", "-1"), "--deviations: got", "above 0"),
]


def test_what_cannot_be_compared_is_refused_in_one_line(strikewave):
    write("a.csv", bell(TIME)), write("b.csv", bell(TIME)), write("force.csv", bell(TIME), head="time (s),F (kN)")
    write("bare.csv", bell(TIME), head="time,value"), write("zero.csv", 0.0 * TIME), write("short.csv", bell(TIME)[:5])
    late = np.column_stack([TIME + 5.0, bell(TIME)])
    np.savetxt("late.csv", late, delimiter=",", header="time (s),frame (g)", comments="", fmt="%.9g")
    os.mkdir("empty")
    open("nothing.csv", "w").close()
    os.mkdir("result")
    for name in ("record.toml", "report.html"):
        open(f"result/{name}", "w").close()
    for words, begins, holds in REFUSED:
        code, out, err = strikewave("compare", *words)
        errors = [line for line in err.splitlines() if begins in line]
        assert (code, out) == (2, ""), (words, err)
        assert errors, (words, err)
        assert holds in errors[0], (words, err)
        assert not os.path.exists("out"), words


def test_samples_that_are_no_numbers_are_refused():
    values = bell(TIME)
    values[900:1100] = np.nan
    with pytest.raises(InputError, match="no numbers"):
        checked_curve("A", curve(values))


@pytest.mark.verify
def test_a_table_in_its_fall_is_compared_as_a_sensor_reads_it(strikewave):
    """A record of the run, its zero taken in the fall, is the run: at 1 g of 49 g, 2 % of the peak were missing.

    The record is the histories as written, 10 um/s^2 rounded, on 5 us instead of 22: lines between samples err by 1e-4.
    """
    changes = ("machine.height=143.8 mm", "contact.law=power", "contact.reference_force=1655 N")
    machine = ("machine.follow=30 ms", "solver.output_step=22 us", "contact.reference_depth=1 mm")
    given = [word for change in (*changes, *machine) for word in ("--set", change)]
    given += ["--set", "contact.exponent=1", "--no-band", "--out", "kept"]
    code, _, err = strikewave("run", "jesd22-b111-b", *given)
    assert code == 0, err
    arrays = load_solution("kept").arrays
    time, values = arrays["time"].values, arrays["rigid_acceleration"].values
    assert values[0] == pytest.approx(0.0, abs=1e-9)
    clock = np.arange(-0.03, time[-1], 5e-6)
    write("record.csv", np.interp(clock, time, values) / G, 5e-6)
    found = compare("record.csv", "kept")
    assert found.figures["peak"].difference == pytest.approx(0.0, abs=5e-4)
    assert found.figures["velocity_change"].difference == pytest.approx(0.0, abs=5e-3)
    judged = strikewave("compare", "kept", "spec:iec-60068-2-27:50g-11ms")  # not held before, nothing was judged
    assert "CANNOT TELL" not in judged[1]


@pytest.mark.parametrize("length", [150, 2000])
def test_a_run_that_ends_within_its_pulse_or_rests_after_it_has_no_ringing(length):
    """A half-sine of 100 samples: what follows stands still, or is not there."""
    values = np.where(np.arange(length) < 100, np.sin(np.pi * np.arange(length) / 100.0), 0.0)
    cut = values[:60] if length == 150 else values
    assert np.isnan(_ringing(curve(cut))).all()


@pytest.mark.parametrize(
    "attributes",
    [
        {},
        {"strikewave_schema": "two"},
        {"strikewave_schema": 1, "case": "mesh = ["},
        {"strikewave_schema": 1, "case": 'mesh = "fine"'},
        {"strikewave_schema": 2},
    ],
    ids=["no schema", "no number", "broken TOML", "another table", "an array without a unit"],
)
def test_a_sealed_file_of_something_else_is_refused_in_a_sentence(tmp_path, attributes):
    file = tmp_path / "histories.nc"
    arrays = {"part.bar.velocity": (("time", "axis"), np.zeros((2, 3))), "time": ("time", [0.0, 1.0])}
    LabelledArrays.of(arrays, {}, attributes).write(file)
    with pytest.raises(InputError, match=r"the file of a result that `strikewave run`, `wave` or `fem` wrote"):
        compare(f"{file}:bar", f"{file}:bar")
