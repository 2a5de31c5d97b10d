"""`record --spec`, `srs --spec` and `spec`: verdicts, exit codes, JSON, report, directions, files of one's own."""

import json
from pathlib import Path

import numpy as np
import pytest

import strikewave as sw
from strikewave.analyses.record.figures.verdicts import limits_figure, spectrum_limits_figure
from strikewave.base.errors import InputError
from strikewave.signal.filters import Filter, effect_on_half_sine
from strikewave.specifications.ideal_pulses import IdealPulse
from strikewave.specifications.judged_records import filter_leaves
from strikewave.specifications.judging import Limits, MeasuredFigure, Shock, SpectrumLimits, _width_clause
from strikewave.specifications.reading import load_specification

GRAVITY = 9.80665


def write_shot(
    name, peak=50.0, duration=11e-3, sign=1.0, step=2e-5, across=None, noise=0.05, blows=1, interval=0.5, clip=None
):
    """Half-sines of 50 g 11 ms, or so: what the severity iec-60068-2-27:50g-11ms asks for."""
    time = np.arange(round((0.1 + interval * (blows - 1)) / step)) * step
    values = noise * np.random.default_rng(3).normal(size=time.size)
    for blow in range(blows):
        start = 0.03 + blow * interval
        values += sign * IdealPulse("half-sine", peak, duration).at(time - start)
    if clip is not None:
        values = np.minimum(values, clip)
    columns, heads = [time, values], ["time (s)", "table (g)"]
    if across is not None:
        columns.append(across * values)
        heads.append("y (g)")
    np.savetxt(name, np.column_stack(columns), delimiter=",", header=",".join(heads), comments="", fmt="%.9g")


@pytest.fixture
def judged(strikewave):
    """Return exit code and the entry `spec` of the document."""

    def call(*words):
        code, out, err = strikewave(*words, "--json")
        assert code in (0, 3), err
        return code, json.loads(out)["spec"]

    return call


IEC = ("--spec", "iec-60068-2-27:50g-11ms")


def clauses_of(spec):
    return {clause["clause"]: clause for clause in spec["clauses"]}


def test_a_shock_as_asked_for_passes_by_indicative_limits_and_one_too_high_fails_with_exit_3(judged):
    write_shot("good.csv")
    code, spec = judged("record", "good.csv", *IEC)
    assert (code, spec["verdict"], spec["by_indicative_limits"]) == (0, "pass", True)
    clauses = clauses_of(spec)
    assert clauses["peak"]["limit"] == pytest.approx([40 * GRAVITY, 60 * GRAVITY])
    assert clauses["peak"]["margin"] == pytest.approx(10 * GRAVITY, rel=0.02)  # noise of 0.05 g on a peak of 50 g
    assert clauses["velocity change"]["value"] == pytest.approx(2 * 50 * GRAVITY * 11e-3 / np.pi, rel=0.005)
    assert clauses["cross-axis"]["verdict"] == clauses["shocks by direction"]["verdict"] == "not-judged"
    write_shot("high.csv", peak=65.0)
    code, spec = judged("record", "good.csv", "high.csv", *IEC)
    assert (code, spec["verdict"]) == (3, "fail")
    assert [shock["verdict"] for shock in spec["shocks"]] == ["pass", "fail"]
    worst = clauses_of(spec)["peak"]
    assert (worst["file"], worst["verdict"]) == ("high.csv", "fail")
    assert worst["margin"] == pytest.approx(-5 * GRAVITY, rel=0.05)


def test_a_shock_downwards_is_judged_by_its_size(judged):
    write_shot("down.csv", sign=-1.0)
    assert judged("record", "down.csv", *IEC)[1]["verdict"] == "pass"


@pytest.mark.verify
def test_strict_refuses_indicative_limits_and_guarded_leaves_the_uncertainty(judged):
    write_shot("good.csv")
    code, spec = judged("record", "good.csv", *IEC, "--strict")
    assert (code, spec["verdict"]) == (0, "cannot-tell")
    write_shot("near.csv", peak=58.0, duration=10.5e-3)
    assert judged("record", "near.csv", *IEC)[1]["verdict"] == "pass"
    code, spec = judged("record", "near.csv", *IEC, "--decision", "guarded", "--uncertainty", "5 %")
    assert clauses_of(spec)["peak"]["uncertainty"] == pytest.approx(0.05 * 58 * GRAVITY, rel=0.02)
    assert (code, clauses_of(spec)["peak"]["verdict"]) == (0, "cannot-tell")


def test_a_clipped_record_and_one_sampled_too_slowly_cannot_be_told(judged):
    write_shot("clipped.csv", peak=70.0, clip=55.0, noise=0.0)
    clause = clauses_of(judged("record", "clipped.csv", *IEC)[1])["peak"]
    assert clause["verdict"] == "cannot-tell"
    assert "clipped" in clause["reason"] or "flat-top" in clause["reason"]
    write_shot("slow.csv", peak=31.4)
    spec = judged("record", "slow.csv", "--spec", "mil-std-810h:ground")[1]
    rate = clauses_of(spec)["sampling rate"]
    assert (rate["value"], rate["limit"], rate["verdict"]) == (pytest.approx(5e4), [1e5, None], "cannot-tell")
    assert spec["verdict"] == "cannot-tell"


def test_cross_axis_channels_are_judged_and_are_no_shocks(judged):
    write_shot("two.csv", across=0.4)
    spec = judged("record", "two.csv", *IEC, "--cross-axis", "y")[1]
    assert len(spec["shocks"]) == 1
    cross = clauses_of(spec)["cross-axis"]
    assert (cross["verdict"], cross["value"]) == ("fail", pytest.approx(0.4 * 50 * GRAVITY, rel=0.02))


@pytest.mark.verify
def test_an_amount_of_a_budget_is_as_uncertain_across_as_along(judged):
    """A zero known to 10 g: 8 g of cross-axis motion under a limit of 15 g cannot be told to pass, 3 g can."""
    Path("zero.toml").write_text(
        'schema = 1\ntitle = "zero"\nstatus = "normative"\nsource = "certificate"\n'
        '[[contribution]]\nname = "zero"\nkind = "offset"\nvalue = "10 g"\ndistribution = "rectangular"\n'
    )
    verdicts = []
    for across in (0.06, 0.16):
        write_shot("two.csv", across=across)
        words = (*IEC, "--cross-axis", "y", "--decision", "guarded", "--uncertainty", "zero.toml")
        cross = clauses_of(judged("record", "two.csv", *words)[1])["cross-axis"]
        assert cross["uncertainty"] > 2.0 * 10.0 * GRAVITY / 3.0**0.5
        verdicts.append(cross["verdict"])
    assert verdicts == ["pass", "cannot-tell"]


def test_shocks_are_counted_by_direction_from_options_or_the_test(judged):
    for k in range(3):
        write_shot(f"up{k}.csv")
    write_shot("down0.csv", sign=-1.0)
    files = ["up0.csv", "up1.csv", "up2.csv", "down0.csv"]
    code, spec = judged("record", *files, *IEC, "--direction", "up*=+x", "--direction", "down*=-x")
    clauses = clauses_of(spec)
    assert (clauses["shocks in +x"]["value"], clauses["shocks in +x"]["verdict"]) == (3, "pass")
    assert (clauses["shocks in -x"]["value"], clauses["shocks in -x"]["verdict"]) == (1, "fail")
    assert clauses["directions"]["verdict"] == "fail"
    assert code == 3
    Path("test.toml").write_text('[test]\nitem = "board"\ndirection = "+z"\n')
    assert "shocks in +z" in clauses_of(judged("record", "up0.csv", *IEC, "--test", "test.toml")[1])


def test_a_direction_that_fits_no_file_or_channel_is_refused_with_those_that_there_are(strikewave):
    write_shot("up0.csv"), write_shot("side.csv", across=0.1)
    for word, words in (
        ("upp*=+x", "a pattern that fits one of the files; choose from: side.csv, up0.csv"),
        ("side.csv#z=+x", "name or number of a channel of these files; choose from: 1, 2, table, y"),
        ("=+x", "FILES#CHANNEL=DIRECTION"),
    ):
        code, out, err = strikewave("record", "up0.csv", "side.csv", *IEC, "--direction", word)
        assert (code, out) == (2, "")
        assert words in err, err
    code, _, err = strikewave("record", "up0.csv", "side.csv", *IEC, "--cross-axis", "up*#y")
    assert (code, "FILES#CHANNEL" in err) == (2, True)


@pytest.mark.verify
def test_files_without_a_direction_are_named_and_fail_no_count(strikewave, judged):
    for name in ("up0.csv", "up1.csv", "side.csv"):
        write_shot(name)
    words = ("record", "up0.csv", "up1.csv", "side.csv", *IEC, "--direction", "up*=+x")
    code, spec = judged(*words)
    clauses = clauses_of(spec)
    assert code == 0
    assert "side.csv has no direction" in clauses["shocks without a direction"]["reason"]
    assert (clauses["shocks in +x"]["value"], clauses["shocks in +x"]["verdict"]) == (2, "cannot-tell")
    assert "shocks without a direction" in strikewave(*words)[1]


def test_one_file_of_three_axes_states_a_direction_and_cross_axes_for_each_channel(judged):
    """A blow along x, later one along y, on a sensor of two axes: each is judged along, the other axis is across."""
    for name, along in (("x", 0), ("y", 1)):
        write_shot(f"{name}.csv", across=0.1)
        data = np.loadtxt(f"{name}.csv", delimiter=",", skiprows=1)
        data[:, 1:] = data[:, 1:] if along == 0 else data[:, :0:-1]
        np.savetxt(f"{name}.csv", data, delimiter=",", header="time (s),x (g),y (g)", comments="", fmt="%.9g")
    across = ("--cross-axis", "x.csv#y", "--cross-axis", "y.csv#1")
    spec = judged("record", "x.csv", "y.csv", *IEC, *across, "--direction", "x.csv#x=+x", "--direction", "#2=+y")[1]
    assert [(shock["channel"], shock["direction"]) for shock in spec["shocks"]] == [("x", "+x"), ("y", "+y")]
    clauses = clauses_of(spec)
    assert [clauses[f"shocks in {one}"]["value"] for one in ("+x", "+y")] == [1, 1]
    assert clauses["cross-axis"]["value"] == pytest.approx(5 * GRAVITY, rel=0.05)


@pytest.mark.verify
def test_a_pass_says_at_its_head_what_was_not_judged(strikewave):
    write_shot("good.csv")
    out = strikewave("record", "good.csv", *IEC, "--out", "kept")[1]
    head = "PASS for the clauses judged (by indicative limits); 2 not judged: cross-axis and shocks by direction."
    assert " ".join(out.split()).startswith(f"{head} One shock by IEC 60068-2-27")
    assert "PASS for the clauses judged (by indicative limits)<" in Path("kept/report.html").read_text("utf-8")


def test_a_blow_on_two_channels_counts_once(judged):
    """Two files with two channels each hold two shocks, not the three that are asked for."""
    for k in range(2):
        write_shot(f"up{k}.csv", across=1.0)
    spec = judged("record", "up0.csv", "up1.csv", *IEC, "--direction", "+x")[1]
    assert len(spec["shocks"]) == 4
    count = clauses_of(spec)["shocks in +x"]
    assert (count["value"], count["verdict"]) == (2, "fail")


def test_shocks_of_which_nothing_can_be_told_do_not_fail_their_count(judged):
    write_shot("slow.csv", peak=31.4, blows=3)
    spec = judged("record", "slow.csv", "--spec", "mil-std-810h:ground", "--direction", "+x")[1]
    count = clauses_of(spec)["shocks in +x"]
    assert (count["value"], count["verdict"]) == (0, "cannot-tell")
    write_shot("slow.csv", peak=31.4, blows=2)
    spec = judged("record", "slow.csv", "--spec", "mil-std-810h:ground", "--direction", "+x")[1]
    assert clauses_of(spec)["shocks in +x"]["verdict"] == "fail"


def test_a_clipped_cross_axis_channel_does_not_pass_and_one_of_another_unit_is_refused(strikewave, judged):
    write_shot("two.csv", across=0.4)
    data = np.loadtxt("two.csv", delimiter=",", skiprows=1)
    data[:, 2] = np.clip(data[:, 2], -14.0, 14.0)  # of 20 g, where 15 g are allowed
    for unit in ("g", "V"):
        np.savetxt(f"{unit}.csv", data, delimiter=",", header=f"time (s),table (g),y ({unit})", comments="")
    cross = clauses_of(judged("record", "g.csv", *IEC, "--cross-axis", "y")[1])["cross-axis"]
    assert (cross["verdict"], "clipped" in cross["reason"]) == ("cannot-tell", True)
    code, _, err = strikewave("record", "V.csv", *IEC, "--cross-axis", "y")
    assert (code, "channels of an acceleration" in err) == (2, True)


def test_bumps_have_a_rate(judged):
    write_shot("bumps.csv", peak=40.0, duration=6e-3, blows=4, interval=0.5)
    clauses = clauses_of(judged("record", "bumps.csv", "--spec", "iec-60068-2-27-bump:40g-6ms")[1])
    assert clauses["shocks a second"]["value"] == pytest.approx(2.0, rel=1e-3)
    assert clauses["shocks a second"]["verdict"] == "pass"


def test_what_a_filter_leaves_of_the_ideal_pulse_is_that_of_a_half_sine():
    """`effect_on_half_sine` was written apart, on a grid of its own: both are good to 1e-5."""
    low_pass = Filter(300.0)
    expected = effect_on_half_sine(low_pass, 11e-3).peak
    assert filter_leaves(low_pass, IdealPulse("half-sine", 5.0, 11e-3), 1e-5) == pytest.approx(expected, abs=2e-5)


def test_a_width_that_the_filter_alone_carries_over_its_limit_cannot_be_told():
    """A cutoff that leaves 98 % of the peak widens a half-sine by a seventh."""
    low_pass = Filter(100.0)
    assert effect_on_half_sine(low_pass, 11e-3).width > 1.1
    limits = Limits(0.9 * 10.3e-3, 1.1 * 10.3e-3, "quoted")
    width = MeasuredFigure(10.3e-3 * effect_on_half_sine(low_pass, 11e-3).width)
    for share, verdict in ((effect_on_half_sine(low_pass, 11e-3).width, "cannot-tell"), (1.0, "fail")):
        shock = Shock(np.zeros(3), 1e-5, 0.0, 1, filter_width=share)
        clause = _width_clause(shock, "pulse width at 10 %", width, limits, "simple", "")
        assert (clause.verdict, "filter" in clause.reason) == (verdict, share > 1.0)


@pytest.mark.verify
def test_report_and_screen_have_the_verdict_and_draw_the_band(strikewave):
    write_shot("good.csv")
    write_shot("high.csv", peak=65.0)
    code, out, err = strikewave("record", "good.csv", "high.csv", *IEC, "--out", "judged")
    assert code == 3
    assert out.startswith("FAIL (by indicative limits): 2 shocks by IEC 60068-2-27")
    assert "exit code 3: check failed: specification" in err
    page = Path("judged/report.html").read_text("utf-8")
    assert "Verdict by the specification" in page
    assert page.count("time from the begin of the ideal pulse") == 2
    places = [
        page.index(words)
        for words in ("high.csv, blow 1: FAIL.", "good.csv, blow 1: PASS.", "each where it came out worst")
    ]
    assert places == sorted(places)


def test_pictures_tell_spectra_of_one_verdict_apart_and_draw_the_limits_of_a_peak_beside_its_band():
    limits = SpectrumLimits((10.0, 1e3), (1.0, 1.0), "quoted", 10.0, "absolute", "maximax", 6.0, (), None)
    drawn = [(f"{k}", np.array([10.0, 1e3]), np.array([1.0, 2.0]), "pass") for k in range(8)]
    lines = spectrum_limits_figure(limits, drawn, "t").axes[0].get_lines()
    looks = [(line.get_linestyle(), line.get_marker()) for line in lines if "PASS" in line.get_label()]
    assert len(set(looks)) == 8
    figure = limits_figure(load_specification("iec-60068-2-27:50g-11ms").pulse_limits(), "t")
    dotted = [line.get_ydata() for line in figure.axes[0].get_lines() if line.get_linestyle() == ":"]
    assert [level[0] for level in dotted if len(level)] == pytest.approx([40.0, 60.0])


@pytest.mark.verify
def test_lines_of_the_filter_name_their_files(strikewave):
    for name in ("a.csv", "b.csv"):
        write_shot(name)
    out = strikewave("record", "a.csv", "b.csv", "--filter", "5 kHz")[1]
    assert all(f"{name}, table: zero-phase Butterworth" in out for name in ("a.csv", "b.csv"))


def test_own_file_and_errors_of_the_options(strikewave, judged):
    write_shot("good.csv")
    assert strikewave("spec", "new", "own", "--from", "iec-60068-2-27")[0] == 0
    text = (
        Path("own.toml")
        .read_text()
        .replace('status = "indicative"\nsource = "from memory"', 'status = "normative"\nsource = "our copy"', 1)
    )
    Path("own.toml").write_text(text)
    spec = judged("record", "good.csv", "--spec", "own.toml:15g-11ms")[1]
    assert (spec["name"], spec["condition"], spec["verdict"], spec["by_indicative_limits"]) == (
        "own",
        "15g-11ms",
        "fail",
        False,
    )
    wrong = {
        ("--spec", "iec-60068-2-27"): "choose from: 50g-11ms",
        ("--spec", "iec-60068-2-28:A"): 'did you mean "iec-60068-2-27"?',
        ("--spec", "none.toml"): "no such file: none.toml",
        ("--spec", "nasa-gevs"): "strikewave srs FILES --spec nasa-gevs",
        (*IEC, "--direction", "up"): '--direction: got "up"',
        (*IEC, "--cross-axis", "z"): '--cross-axis: got "z"',
        (*IEC, "--uncertainty", "2"): "--uncertainty",
        ("--strict",): "add --spec NAME",
        ("--direction", "+x"): "add --spec NAME",
    }
    for words, message in wrong.items():
        code, _, err = strikewave("record", "good.csv", *words)
        assert (code, message in err) == (2, True), err
    code, _, err = strikewave("spec", "new", "own")
    assert (code, "add --force" in err) == (2, True)


@pytest.mark.usefixtures("undrawn")
def test_records_of_a_force_or_of_nothing_cannot_be_judged(strikewave):
    write_shot("good.csv")
    Path("force.csv").write_text(Path("good.csv").read_text().replace("(g)", "(N)"))
    code, _, err = strikewave("record", "force.csv", *IEC)
    assert (code, "records of an acceleration" in err) == (2, True)
    flat = np.column_stack([np.arange(2000) * 1e-4, np.random.default_rng(1).normal(size=2000)])
    np.savetxt("flat.csv", flat, delimiter=",", header="time (s),table (g)", comments="")
    code, out, _ = strikewave("record", "flat.csv", *IEC)
    assert code == 0
    assert out.startswith("CANNOT TELL")


@pytest.mark.verify
def test_spectrum_of_a_record_is_judged_and_one_sampled_too_slowly_cannot_be(judged, strikewave):
    Path("own.toml").write_text(
        'schema = 1\ntitle = "t"\nedition = "e"\nstatus = "normative"\nsource = "s"\n[srs]\n'
        'points = [["200 Hz", "60 g"], ["2 kHz", "60 g"]]\nper_octave = 6\nshare_above = "50 %"\n'
        '[[srs.tolerance]]\nfrom = "200 Hz"\nto = "2 kHz"\nlow = "-3 dB"\nhigh = "3 dB"\n'
    )
    write_shot("good.csv")  # far above 1 / 11 ms the spectrum of a half-sine is its peak
    code, spec = judged("srs", "good.csv", "--spec", "own.toml")
    assert code == 3
    within, above = spec["clauses"]
    assert (within["value"], within["verdict"], above["value"], above["verdict"]) == (1.0, "pass", 0.0, "fail")
    write_shot("slow.csv", step=4e-4)
    assert judged("srs", "slow.csv", "--spec", "own.toml")[1]["verdict"] == "cannot-tell"
    strikewave("srs", "good.csv", "slow.csv", "--spec", "own.toml", "--out", "spectra")
    assert "Verdict by the specification" in Path("spectra/report.html").read_text("utf-8")
    code, _, err = strikewave("srs", "good.csv", "--spec", "own.toml", "--kind", "pseudo-velocity")
    assert (code, "--kind" in err) == (2, True)


OWN_SPECTRUM = (
    'schema = 1\ntitle = "t"\nedition = "e"\nstatus = "normative"\nsource = "s"\n[srs]\n'
    'points = [["200 Hz", "50 g"], ["2 kHz", "50 g"]]\nper_octave = 6\n'
    '[[srs.tolerance]]\nfrom = "200 Hz"\nto = "2 kHz"\nlow = "-3 dB"\nhigh = "3 dB"\n'
)


def test_each_spectrum_of_several_is_judged_as_it_is_alone(judged, strikewave):
    """A slowly sampled record beside a fast one neither takes its high frequencies, nor is taken for as fast as it."""
    Path("own.toml").write_text(OWN_SPECTRUM)
    write_shot("fast.csv"), write_shot("slow.csv", step=4e-4)
    for files in (("fast.csv", "slow.csv"), ("slow.csv", "fast.csv")):
        clauses = judged("srs", *files, "--spec", "own.toml")[1]["clauses"]
        found = {Path(clause["file"]).name: clause for clause in clauses}
        for name, clause in found.items():
            alone = judged("srs", name, "--spec", "own.toml")[1]["clauses"][0]
            assert [clause[key] for key in ("verdict", "value", "reason")] == [
                alone[key] for key in ("verdict", "value", "reason")
            ]
        assert found["fast.csv"]["verdict"] == "pass"
        assert "up to" in found["slow.csv"]["reason"]


@pytest.mark.parametrize(
    "words", [("--q", "50"), ("--from", "10 Hz"), ("--to", "1 kHz"), ("--per-octave", "12"), ("--side", "negative")]
)
def test_a_specification_fixes_which_spectrum_is_judged(strikewave, words):
    Path("own.toml").write_text(OWN_SPECTRUM)
    write_shot("fast.csv")
    code, _, err = strikewave("srs", "fast.csv", "--spec", "own.toml", *words)
    assert (code, err.startswith(words[0])) == (2, True)
    assert "with this --spec; the specification fixes it" in err
    same = ("--q", "10", "--from", "200 Hz", "--to", "2 kHz", "--per-octave", "6", "--side", "maximax")
    assert strikewave("srs", "fast.csv", "--spec", "own.toml", *same, "--json")[0] == 0


@pytest.mark.usefixtures("undrawn")
def test_spec_lists_and_shows_with_status_and_source_of_every_number(strikewave):
    code, out, _ = strikewave("spec", "--json")
    assert code == 0
    names = [one["name"] for one in json.loads(out)["specifications"]]
    assert {"iec-60068-2-27", "mil-std-810h", "jesd22-b110", "un-38-3-t4"} <= set(names)
    code, out, _ = strikewave("spec", "show", "jesd22-b110:B", "--json")
    document = json.loads(out)
    rows = {row["path"]: row for row in document["numbers"]}
    assert (document["condition"], rows["condition.B.peak"]["typed"]) == ("B", "1500 g")
    assert "condition.H.peak" not in rows
    assert all(row["status"] and row["source"] for row in rows.values())
    assert strikewave("spec", "show", "jesd22-b110:B", "--out", "shown")[0] == 0
    assert {"report.html", "summary.svg", "specification.toml"} <= {path.name for path in Path("shown").iterdir()}
    assert [strikewave("spec", "show", "jesd22-b111")[0] for _ in range(2)] == [0, 0]  # the second replaces the first
    code, _, err = strikewave("spec", "show", "jesd22-b111:A")
    assert (code, "one severity" in err) == (2, True)


def test_options_of_another_action_of_spec_are_refused_and_the_help_says_of_which_each_is(strikewave):
    for words in (("show", "un-38-3-t4:cell", "--from", "iso-16750-3"), ("new", "a.toml", "--rate", "1 MHz")):
        code, _, err = strikewave("spec", *words)
        assert (code, "only with" in err, Path("a.toml").exists()) == (2, True, False)
    out = strikewave("spec", "--help")[1]
    assert "--from" in out.partition("Of new:")[2].partition("Of synthesize:")[0]
    assert "--rate" in out.partition("Of synthesize:")[2].partition("Output:")[0]


def test_a_new_file_from_one_condition_holds_that_one_alone(strikewave):
    assert strikewave("spec", "new", "b.toml", "--from", "jesd22-b110:b")[0] == 0
    own, origin = load_specification("b.toml"), load_specification("jesd22-b110:B")
    assert [one.name for one in own.file.condition] == ["B"]
    assert own.pulse_limits() == origin.pulse_limits()
    assert "free state; 2 mounted" in own.text
    code, _, err = strikewave("spec", "new", "q.toml", "--from", "jesd22-b110:Q")
    assert (code, Path("q.toml").exists(), "choose from: H, G, B, F, A, E, D, C;" in err) == (2, False, True)


def test_a_call_of_python_gives_the_verdict_of_the_command(judged):
    write_shot("good.csv")
    write_shot("high.csv", peak=65.0)
    found = sw.record(
        ["good.csv", "high.csv"], spec=IEC[1], judging=sw.Judging(decision="guarded", uncertainty="3 %", direction="+x")
    )
    words = ("--decision", "guarded", "--uncertainty", "3 %", "--direction", "+x")
    assert judged("record", "good.csv", "high.csv", *IEC, *words)[1]["verdict"] == found.verdict.verdict == "fail"
    assert found.broken
    assert sw.record("good.csv").verdict is None
    for spec, wrong in (("none", {}), (IEC[1], {"decision": "kind"}), (IEC[1], {"direction": "up"})):
        with pytest.raises(InputError):
            sw.record("good.csv", spec=spec, judging=sw.Judging(**wrong))
