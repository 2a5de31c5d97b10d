"""Specification files: the built-in ones hold, wrong ones are refused in one line with field, value and what is allowed."""

import math

import numpy as np
import pytest

from strikewave.base.errors import InputError
from strikewave.specifications.judging import STATUSES, Shock, judge_shock
from strikewave.specifications.reading import (
    load_specification,
    parse_specification,
    read_built_in,
    specification_names,
)
from strikewave.specifications.tables import numbers_of

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
