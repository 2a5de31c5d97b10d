"""Specification files: the built-in ones hold, wrong ones are refused in one line with field, value and what is allowed."""

import math

import numpy as np
import pytest

from strikewave.base.errors import InputError
from strikewave.specifications.judging import STATUSES, Shock, judge_shock
from strikewave.specifications.reading import (
    Specification,
    asked_names,
    load_specification,
    parse_specification,
    read_built_in,
    specification_names,
)
from strikewave.specifications.tables import NumberReader, SpecificationTable, StatedNumber, numbers_of, standing

from .specification_table import PAGE, page_with_tables

HEAD = 'schema = 1\ntitle = "t"\nedition = "e"\nstatus = "normative"\nsource = "s"\n'
PULSE = '[pulse]\nshape = "half-sine"\npeak = "50 g"\nduration = "11 ms"\n'
SRS = '[srs]\npoints = [["10 Hz", "1 g"], ["100 Hz", "10 g"]]\n[[srs.tolerance]]\nfrom = "10 Hz"\nto = "100 Hz"\nlow = "-6 dB"\nhigh = "6 dB"\n'

WRONG = {
    "not TOML": ("schema = ", "allowed: a specification in TOML"),
    "a newer schema": (HEAD.replace("schema = 1", "schema = 2") + PULSE, "schema: got 2"),
    "no title": (HEAD.replace('title = "t"\n', "") + PULSE, "title: missing"),
    "an unknown key": (
        HEAD + PULSE.replace("duration", "duratoin"),
        'pulse.duratoin: unknown key; did you mean "duration"?',
    ),
    "an unknown table": (HEAD + PULSE + "[bands]\n", 'bands: unknown key; did you mean "band"?'),
    "a band without what is before": (
        HEAD + PULSE + '[band]\ntime = "10 %"\namplitude = "20 %"\nafter = "1 %"\n',
        'band.before: missing; add before = "20 %"',
    ),
    "a peak without its tolerance": (HEAD + PULSE + "[peak]\n", 'peak.tolerance: missing; add tolerance = "20 %"'),
    "a pulse without its shape": (
        HEAD + PULSE.replace('shape = "half-sine"\n', ""),
        "shape: missing; add shape, one of half-sine,",
    ),
    "a title left out": (HEAD.replace('title = "t"\n', "") + PULSE, 'title: missing; add title = "..."'),
    "an unknown status": (HEAD.replace("normative", "official") + PULSE, 'status: got "official"'),
    "a quoted number without its source": (
        HEAD + PULSE.replace('"50 g"', '{ value = "50 g", status = "quoted" }'),
        "pulse.peak.source: missing; needed: who has it: it is quoted",
    ),
    "a quoted table without its source": (HEAD + PULSE + 'status = "quoted"\n', "source: missing"),
    "an unknown shape": (HEAD + PULSE.replace("half-sine", "haversine"), 'pulse.shape: got "haversine"'),
    "a bare number": (
        HEAD + PULSE.replace('"50 g"', "50"),
        "pulse.peak: got 50; allowed: an acceleration with its unit",
    ),
    "a wrong unit": (HEAD + PULSE.replace('"11 ms"', '"11 mm"'), 'pulse.duration: got "11 mm"; allowed: a time'),
    "a duration of hours": (HEAD + PULSE.replace('"11 ms"', '"11 h"'), "at most 60 s"),
    "a peak below zero": (HEAD + PULSE.replace('"50 g"', '"-50 g"'), "above 0 m/s^2"),
    "no peak at all": (HEAD + PULSE.replace('peak = "50 g"\n', ""), "pulse: peak: missing"),
    "no peak in a condition": (
        HEAD + PULSE.replace('peak = "50 g"\n', "") + '[[condition]]\nname = "A"\n',
        "condition A: peak: missing; needed: here, or in [pulse]",
    ),
    "two conditions of one name": (
        HEAD + PULSE + '[[condition]]\nname = "A"\n[[condition]]\nname = "a"\n',
        'condition: got "a"; allowed: a name for each condition',
    ),
    "a condition with a colon": (HEAD + PULSE + '[[condition]]\nname = "a:b"\n', 'condition.0.name: got "a:b"'),
    "a tolerance of three": (HEAD + PULSE + '[peak]\ntolerance = ["1 %", "2 %", "3 %"]\n', "peak.tolerance"),
    "a tolerance in words": (HEAD + PULSE + '[peak]\ntolerance = "little"\n', 'a share with its sign, such as "20 %"'),
    "a tolerance of 5, which is no 5 %": (
        HEAD + PULSE + "[peak]\ntolerance = 5\n",
        'peak.tolerance: got 5; allowed: a share with its sign, such as "20 %", from 0 to 1000 %; write "5 %"',
    ),
    "a tolerance of 0.15": (
        HEAD + PULSE + "[velocity_change]\ntolerance = 0.15\n",
        'write "15 %", or "0.15 %" if that is meant',
    ),
    "a tolerance of two bare numbers": (HEAD + PULSE + "[peak]\ntolerance = [-10, 20]\n", 'write "-10 %"'),
    "a width of a bare time": (HEAD + PULSE + "[band]\ntime = 0.1\n", "band.time: got 0.1"),
    "a share above of 50": (HEAD + SRS.replace("[[srs", "share_above = 50\n[[srs"), "srs.share_above: got 50"),
    "a level above the peak": (HEAD + PULSE + '[width]\ntolerance = "10 %"\nlevel = "120 %"\n', "from 0 to 90 %"),
    "a slope of a half-sine": (HEAD + PULSE + 'rise = "10 %"\n', "a trapezoid only"),
    "a trapezoid without its slopes": (HEAD + PULSE.replace("half-sine", "trapezoid"), "rise: missing"),
    "a trapezoid of slopes alone": (
        HEAD + PULSE.replace("half-sine", "trapezoid") + 'rise = "60 %"\nfall = "60 %"\n',
        "at most 100 % together",
    ),
    "half a count": (HEAD + PULSE + "[count]\nper_direction = 2.5\n", "count.per_direction: got 2.5"),
    "seven directions": (HEAD + PULSE + "[count]\ndirections = 7\n", "at most 6"),
    "breakpoints downwards": (
        HEAD + SRS.replace('"100 Hz", "10 g"', '"5 Hz", "10 g"'),
        "two breakpoints or more, upwards",
    ),
    "breakpoints that are no pairs": (
        HEAD + SRS.replace('["10 Hz", "1 g"], ', '"10 Hz", '),
        "pairs of frequency and level",
    ),
    "a tolerance upside down": (HEAD + SRS.replace('high = "6 dB"', 'high = "-7 dB"'), "a level above low"),
    "a level without its sign": (HEAD + SRS.replace('"-6 dB"', "-6"), 'such as "-6 dB"'),
    "neither pulse nor spectrum": (HEAD, "a table [pulse], or [srs]"),
    "a band of a spectrum": (
        HEAD + '[band]\ntime = "10 %"\namplitude = "20 %"\nbefore = "100 %"\nafter = "100 %"\n' + SRS,
        "which [band] is about",
    ),
    "keys nested deep": (HEAD + "a" + ".a" * 5000 + " = 1\n", "a key of many parts"),
    "brackets nested deep": (HEAD + "a = " + "[" * 5000 + "\n", "a specification in TOML"),
    "a title that turns lines round": (HEAD.replace('"t"', '"t\u202e"') + PULSE, "U+202E"),
}


@pytest.mark.parametrize(("text", "words"), WRONG.values(), ids=WRONG)
def test_a_wrong_file_is_refused_with_field_and_what_is_allowed(text, words):
    with pytest.raises(InputError) as raised:
        parse_specification(text, "my.toml")
    lines = str(raised.value).split("\n")
    assert any(words in line for line in lines), lines
    assert all(line.startswith("my.toml: ") and len(line) < 400 for line in lines)


def test_a_file_may_hold_several_conditions_and_one_is_asked_for_by_its_name(tmp_path):
    path = tmp_path / "own.toml"
    path.write_text(HEAD + PULSE + '[[condition]]\nname = "A"\n[[condition]]\nname = "B"\npeak = "100 g"\n')
    assert load_specification(f"{path}:b").pulse.peak == pytest.approx(100 * 9.80665)
    for asked, words in ((str(path), "choose from: A, B"), (f"{path}:C", "a condition")):
        with pytest.raises(InputError) as raised:
            load_specification(asked)
        assert words in str(raised.value)
    path.write_text(HEAD + PULSE)
    with pytest.raises(InputError, match="one severity"):
        load_specification(f"{path}:A")
    with pytest.raises(InputError, match="no such file"):
        load_specification(str(tmp_path / "none.toml"))
    path.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(InputError, match="UTF-8"):
        load_specification(str(path))
    path.write_bytes(b"#" * 300_000)
    with pytest.raises(InputError, match="200 kB"):
        load_specification(str(path))
    with pytest.raises(InputError, match='did you mean "mil-std-810h"'):
        load_specification("mil-std-801h")


@pytest.mark.parametrize("name", specification_names())
def test_a_built_in_specification_states_status_and_source_of_every_number(name):
    file, _ = read_built_in(name)
    rows = list(numbers_of(file))
    assert rows
    for path, _, status, source in rows:
        assert status in STATUSES, path
        assert len(source) > 5, path
        if status != "indicative":
            assert source != "from memory", path
    assert all(status != "normative" for _, _, status, _ in rows)  # no standard was at hand


@pytest.mark.parametrize("name", specification_names())
def test_the_ideal_pulse_of_a_built_in_specification_passes_it(name):
    file, _ = read_built_in(name)
    if file.pulse is None:
        return
    for condition in file.condition or (None,):
        asked = load_specification(name if condition is None else f"{name}:{condition.name}")
        limits = asked.pulse_limits()
        pulse = limits.pulse
        step = min(pulse.duration / 2000.0, 1e-5)
        values = pulse.at(step * np.arange(int(6 * pulse.duration / step)) - 2.0 * pulse.duration)
        found = judge_shock(Shock(values, step, 0.0, int(values.argmax())), limits)
        assert found.verdict == "pass", found
        assert math.isfinite(found.start)


def test_the_page_of_the_docs_has_every_number_of_the_built_in_files():
    """`python tests/specifications/specification_table.py` writes it anew."""
    text = PAGE.read_text("utf-8")
    assert text == page_with_tables(text)


@pytest.mark.parametrize(
    ("condition", "hint"),
    [
        ("50-g11ms", 'did you mean "50g-11ms"?'),
        ("1000g-1ms", "strikewave spec new my-spec.toml --from iec-60068-2-27"),  # another severity, no misspelling
    ],
)
def test_a_severity_that_is_not_there_is_no_misspelt_one(condition, hint):
    with pytest.raises(InputError) as error:
        load_specification(f"iec-60068-2-27:{condition}")
    assert hint in str(error.value)
    assert ("did you mean" in str(error.value)) == hint.startswith("did you mean")


def test_a_file_of_a_spectrum_is_sent_to_the_command_that_judges_it(strikewave):
    """Its head names that command, and the refusal of the other one the file as it was typed."""
    assert strikewave("spec", "new", "mine.toml", "--from", "mil-std-810h-srs")[0] == 0
    assert "strikewave srs FILES --spec mine.toml judges by it" in open("mine.toml").read()
    assert strikewave("spec", "new", "pulse.toml", "--from", "jesd22-b110")[0] == 0
    assert "strikewave record FILES --spec pulse.toml judges by it" in open("pulse.toml").read()
    with pytest.raises(InputError, match=r'got "mine\.toml".*strikewave srs FILES --spec mine\.toml'):
        _ = load_specification("mine.toml").pulse


def specification(text, condition=None):
    file = parse_specification(HEAD + text, "t")
    return Specification("t", file, None if condition is None else file.condition[condition], text)


TRAPEZOID = '[pulse]\nshape = "trapezoid"\npeak = "100 m/s^2"\nduration = "10 ms"\nrise = "10 %"\nfall = "30 %"\n'


def test_every_limit_of_a_pulse_follows_from_its_tolerance():
    """A trapezoid of 100 m/s2, 10 ms, slopes of 10 and 30 %: 8 ms wide at half its peak, 0.8 m/s."""
    limits = specification(
        TRAPEZOID
        + '[peak]\ntolerance = ["-10 %", "20 %"]\n[width]\nlevel = "50 %"\ntolerance = "25 %"\n'
        + '[velocity_change]\ntolerance = "150 %"\nbefore = "20 %"\nafter = "40 %"\n[cross_axis]\nlimit = "30 %"\n'
        + '[band]\ntime = "5 %"\namplitude = "15 %"\namplitude_after = "25 %"\nbefore = "60 %"\nafter = "70 %"\n'
        + '[sampling]\nrate = "20 kHz"\n'
    ).pulse_limits()
    assert limits.pulse.duration == pytest.approx(0.01)
    assert limits.peak[:2] == pytest.approx((90.0, 120.0))
    assert limits.width[:2] == pytest.approx((0.006, 0.010))
    assert limits.velocity_change[:2] == pytest.approx((0.0, 2.0), abs=1e-12)
    assert (limits.level, limits.window) == (0.5, (0.2, 0.4))
    assert limits.cross_axis[:2] == (-math.inf, pytest.approx(30.0))
    band = limits.band
    assert (band.time, band.amplitude, band.amplitude_after, band.before, band.after) == pytest.approx(
        (0.05, 0.15, 0.25, 0.6, 0.7)
    )
    assert math.isnan(band.amplitude_before)
    assert (limits.rate[:2], limits.cutoff) == ((20e3, math.inf), None)
    bare = specification(PULSE).pulse_limits()
    assert (bare.level, bare.window, bare.peak, bare.band) == (0.1, (0.1, 0.1), None, None)


@pytest.mark.parametrize(
    ("least", "low", "high"), [("1 ms", 0.006, 0.010), ("3 ms", 0.005, 0.011), ("9 ms", 0.0, 0.017)]
)
def test_a_width_may_miss_by_its_least_tolerance_at_least(least, low, high):
    text = f'{TRAPEZOID}[width]\nlevel = "50 %"\ntolerance = "25 %"\nleast = "{least}"\n'
    assert specification(text).pulse_limits().width[:2] == pytest.approx((low, high), abs=1e-12)


def test_the_status_of_a_limit_is_the_weakest_of_its_numbers():
    quoted, memory = 'status = "quoted", source = "q"', 'status = "indicative"'
    text = PULSE + '[peak]\ntolerance = ["-10 %", { value = "20 %", ' + quoted + " }]\n"
    assert specification(text).pulse_limits().peak.status == "quoted"
    text = PULSE.replace('"11 ms"', '{ value = "11 ms", ' + memory + " }") + '[peak]\ntolerance = "10 %"\n'
    assert specification(text).pulse_limits().peak.status == "indicative"
    row = '[[condition]]\nname = "A"\nvelocity_change = { value = "2 m/s", ' + quoted + " }\n"
    changed = specification(text + '[velocity_change]\ntolerance = "10 %"\n' + row, 0).pulse_limits().velocity_change
    assert changed == (pytest.approx(1.8), pytest.approx(2.2), "quoted")
    band = '[band]\ntime = "5 %"\namplitude = { value = "5 %", ' + memory + ' }\nbefore = "1 %"\nafter = "1 %"\n'
    assert specification(PULSE + band).pulse_limits().band_status == "indicative"
    assert specification(PULSE).pulse_limits().band_status == "normative"


def test_counts_and_rates_are_read_with_their_tolerance():
    count = "[count]\nper_direction = 1000\n"
    assert specification(PULSE + count).count() == (1000.0, math.inf, 6, "normative")
    more = specification(
        PULSE + count + 'tolerance = "1 %"\ndirections = 2\n[[condition]]\nname = "A"\nper_direction = 300\n', 0
    )
    assert more.count() == (pytest.approx(297.0), pytest.approx(303.0), 2, "normative")
    assert specification(PULSE + "[count]\ndirections = 2\n").count() is None
    assert specification(PULSE).count() is None
    assert specification(PULSE + '[repetition]\nlow = "1 Hz"\n').repetition()[:2] == (1.0, math.inf)
    assert specification(PULSE + '[repetition]\nhigh = "3 Hz"\n').repetition()[:2] == (0.0, 3.0)
    assert specification(PULSE + "[repetition]\n").repetition() is None
    assert specification(PULSE).repetition() is None


def test_breakpoints_and_tolerances_of_a_spectrum_are_read():
    limits = specification(SRS.replace("[[srs", 'q = 5\nshare = "90 %"\nshare_above = "50 %"\n[[srs')).spectrum_limits()
    assert (limits.frequency, limits.level) == ((10.0, 100.0), (pytest.approx(9.80665), pytest.approx(98.0665)))
    assert limits.bands == ((10.0, 100.0, -6.0, 6.0, "normative"),)
    assert (limits.q, limits.share[:2], limits.share_above[:2]) == (5.0, (0.9, math.inf), (0.5, math.inf))
    assert specification(SRS).spectrum_limits().share_above is None
    with pytest.raises(InputError, match="a specification of a spectrum"):
        specification(PULSE).spectrum_limits()


def test_numbers_that_are_stated_are_listed_by_their_path():
    text = (
        PULSE
        + '[peak]\ntolerance = "10 %"\n[width]\ntolerance = ["-1 %", "2 %"]\n[[condition]]\nname = "A"\npeak = "9 g"\n'
    )
    rows = [(path, number.si) for path, number, _, _ in numbers_of(parse_specification(HEAD + text, "t"))]
    assert rows == [
        ("pulse.peak", pytest.approx(50 * 9.80665)),
        ("pulse.duration", pytest.approx(0.011)),
        ("peak.tolerance", 0.1),
        ("width.tolerance", -0.01),
        ("width.tolerance.1", 0.02),
        ("condition.A.peak", pytest.approx(9 * 9.80665)),
    ]
    paths = [path for path, *_ in numbers_of(parse_specification(HEAD + SRS, "t"))]
    assert "srs.tolerance.0.from" in paths
    assert paths[:4] == ["srs.points", "srs.points.1", "srs.points.2", "srs.points.3"]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (SRS.replace('["10 Hz", "1 g"], ', ""), "two breakpoints or more"),
        (SRS.replace('"100 Hz", "10 g"', '"10 Hz", "10 g"'), "two breakpoints or more"),
        (SRS.replace('to = "100 Hz"', 'to = "10 Hz"'), "a frequency above from"),
        (SRS.replace('high = "6 dB"', 'high = "-6 dB"'), "a level above low"),
        (SRS.replace('high = "6 dB"', 'high = "60.5 dB"'), "from -60 to 60 dB"),
        (PULSE.replace('"half-sine"', '"trapezoid"') + 'rise = "50 %"\nfall = "50.5 %"\n', "at most 100 % together"),
        (PULSE.replace('"half-sine"', '"trapezoid"') + 'rise = "50 %"\n', "fall: missing"),
        (PULSE + '[peak]\ntolerance = "1001 %"\n', "from 0 to 1000 %"),
        (PULSE + '[peak]\ntolerance = ["-101 %", "1 %"]\n', "from -100 to 0 %"),
    ],
)
def test_limits_of_what_a_file_may_hold(text, words):
    with pytest.raises(InputError) as raised:
        parse_specification(HEAD + text, "t")
    assert words in str(raised.value)


def test_the_last_that_a_file_may_hold_is_taken():
    slopes = 'rise = "50 %"\nfall = "50 %"\n'
    assert specification(PULSE.replace('"half-sine"', '"trapezoid"') + slopes).pulse.velocity_change > 0.0
    limits = specification(PULSE + '[peak]\ntolerance = ["-100 %", "1000 %"]\n').pulse_limits()
    assert limits.peak[:2] == pytest.approx((0.0, 11 * 50 * 9.80665), abs=1e-9)
    assert specification(SRS.replace('"6 dB"', '"60 dB"')).spectrum_limits().bands[0].high == 60.0
    assert specification(PULSE + '[width]\nlevel = "90 %"\ntolerance = "0 %"\n').pulse_limits().level == pytest.approx(
        0.9
    )


@pytest.mark.parametrize(("size", "taken"), [(200_000, True), (200_001, False)])
def test_a_file_of_200_kb_is_read_to_its_end(tmp_path, size, taken):
    path = tmp_path / "own.toml"
    path.write_text(HEAD + "#".ljust(size - len(HEAD + PULSE) - 1) + "\n" + PULSE)
    assert path.stat().st_size == size
    if taken:
        assert load_specification(str(path)).pulse.duration == pytest.approx(0.011)
    else:
        with pytest.raises(InputError, match="200 kB"):
            load_specification(str(path))


def test_a_condition_changes_what_it_states_alone(tmp_path):
    """Shape and velocity change of itself or of the file; the one of a file need not be named."""
    rows = '[[condition]]\nname = "A"\nshape = "sawtooth"\n[[condition]]\nname = "B"\nvelocity_change = "2 m/s"\n'
    text = PULSE + '[velocity_change]\ntolerance = "10 %"\n[count]\nper_direction = 300\n' + rows
    first, second = (specification(text, k) for k in (0, 1))
    assert [one.pulse.shape for one in (first, second, specification(PULSE))] == ["sawtooth", "half-sine", "half-sine"]
    change = 50 * 9.80665 * 0.011 / 2.0
    assert first.pulse_limits().velocity_change[:2] == pytest.approx((0.9 * change, 1.1 * change))
    assert second.pulse_limits().velocity_change[:2] == pytest.approx((1.8, 2.2))
    assert first.count().low == 300.0
    (tmp_path / "one.toml").write_text(HEAD + PULSE + '[[condition]]\nname = "only"\ntitle = "the one"\n')
    asked = load_specification(str(tmp_path / "one.toml"))
    assert (asked.condition.name, asked.file_name) == ("only", "one-only")
    assert asked.title == "t (one.toml), the one"
    with pytest.raises(InputError, match=r"such as .*one\.toml:only"):
        load_specification(f"{tmp_path / 'one.toml'}:other")


def test_a_file_of_one_s_own_is_called_by_what_it_was_made_from(tmp_path):
    name = next(one for one in specification_names() if len(read_built_in(one)[0].condition) > 1)
    file, text = read_built_in(name)
    path = tmp_path / "mine.toml"
    first = file.condition[0].name

    def title(changed):
        path.write_text(changed)
        return load_specification(f"{path}:{first}").title

    assert title(text).startswith(f"mine.toml, made from {file.title}, without changes")
    assert f"made from {file.title}, with changes" in title(text + '\n[repetition]\nhigh = "77 Hz"\n')
    more = '\n[[condition]]\nname = "own"\npeak = "77 g"\nduration = "7 ms"\n'
    assert f"made from {file.title}, with changes" in title(text + more)
    path.write_text(HEAD + PULSE)
    assert load_specification(str(path)).title == "t (mine.toml)"


def test_names_that_can_be_asked_for_have_their_conditions():
    names = asked_names()
    assert {"mil-std-810h-srs", "mil-std-810h:ground", "un-38-3-t4:cell"} <= set(names)
    assert "un-38-3-t4" not in names
    with pytest.raises(InputError) as raised:
        load_specification("mil-std-810h:ground").spectrum_limits()
    choice = str(raised.value).partition("choose from: ")[2].split(", ")
    assert choice == [one for one in specification_names() if read_built_in(one)[0].srs is not None]
    with pytest.raises(InputError, match=r"spec new FILE\.toml --from mil-std-810h-srs, and add them"):
        load_specification("mil-std-810h-srs").spectrum_limits()


def test_a_misspelt_condition_is_named_and_another_severity_is_no_misspelt_one():
    with pytest.raises(InputError) as raised:
        load_specification("jesd22-b110:Z9")
    assert "choose from: " in str(raised.value)
    assert "strikewave spec new my-spec.toml --from jesd22-b110" in str(raised.value)
    with pytest.raises(InputError) as raised:
        load_specification("jesd22-b110")
    assert "a condition, such as jesd22-b110:" in str(raised.value)
    assert "spec new" not in str(raised.value)


@pytest.mark.parametrize(
    ("reader", "example"),
    [
        (NumberReader("%"), '"20 %"'),
        (NumberReader("dB"), '"-6 dB"'),
        (NumberReader("s"), '"200 us"'),
        (NumberReader("count", 1, 20), "1"),
        (NumberReader("", 2.5, 9.0), "2.5"),
    ],
)
def test_an_example_of_a_number_is_one_of_its_kind(reader, example):
    assert reader.example() == example
    assert reader.read(example.strip('"') if '"' in example else float(example)).si is not None


def test_a_number_has_its_own_source_and_the_status_of_its_table():
    table = SpecificationTable(status="quoted", source="t")
    file = SpecificationTable(status="indicative", source="f")
    bare, own = StatedNumber(si=1.0, typed=1.0), StatedNumber(si=1.0, typed=1.0, source="n")
    sure = StatedNumber(si=1.0, typed=1.0, status="normative", source="n")
    assert [standing(one, table, file) for one in (bare, own, sure)] == [
        ("quoted", "t"),
        ("quoted", "n"),
        ("normative", "n"),
    ]
    nothing = SpecificationTable()
    assert standing(bare, nothing, file) == ("indicative", "f")
    assert standing(bare, nothing, SpecificationTable(status="indicative")) == ("indicative", "from memory")


@pytest.mark.parametrize(
    ("text", "words", "hint"),
    [
        (PULSE + "[peak]\ntolerance = true\n", "peak.tolerance", False),
        (SRS.replace('["10 Hz", "1 g"], ["100 Hz", "10 g"]', '"1g", "2g"'), "pairs of frequency and level", False),
        (SRS.replace('["10 Hz", "1 g"], ', '["10 Hz", "1 g", "2 g"], '), "pairs of frequency and level", False),
        (PULSE + "[peak]\ntolerance = 5\n", "peak.tolerance", True),
        (SRS.replace('"6 dB"', "6"), "srs.tolerance.0.high", False),
        (PULSE + '[peak]\ntolerance = ["0.5 %", "1 %"]\n', "from -100 to 0 %", False),
        (PULSE + '[peak]\ntolerance = ["-100.5 %", "1 %"]\n', "from -100 to 0 %", False),
        (PULSE.replace('"50 g"', '{ value = "50 g", source = "x", sauce = "y" }'), 'did you mean "source"', False),
        (PULSE.replace('"50 g"', '{ status = "indicative" }'), "the number itself", False),
    ],
)
def test_a_wrong_number_is_told_its_sign_where_one_is_missing(text, words, hint):
    with pytest.raises(InputError) as raised:
        parse_specification(HEAD + text, "t")
    assert words in str(raised.value)
    assert ("write " in str(raised.value)) == hint


@pytest.mark.parametrize(("count", "taken"), [(200, True), (201, False)])
def test_a_file_has_200_conditions_and_1000_breakpoints_at_most(count, taken):
    rows = "".join(f'[[condition]]\nname = "c{k}"\n' for k in range(count))
    points = ", ".join(f'["{k + 1} Hz", "1 g"]' for k in range(1000 if taken else 1001))
    texts = (PULSE + rows, SRS.replace('["10 Hz", "1 g"], ["100 Hz", "10 g"]', points))
    for text, words in zip(texts, ("201 tables", "1001 pairs"), strict=True):
        if taken:
            assert parse_specification(HEAD + text, "t")
        else:
            with pytest.raises(InputError, match=words):
                parse_specification(HEAD + text, "t")
