"""The file of a whole fit: the same result as the command line, and wrong or hostile files in one line."""

import json
import tomllib
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from strikewave import load_case
from strikewave.base.errors import InputError, StrikewaveError
from strikewave.studies.fit.fit_file import FitFile, is_fit_file, load_fit
from strikewave.studies.fit.study import fit
from strikewave.studies.fit.targets import parse_targets, read_targets

WHOLE = """
schema = 1
case = "jesd22-b111-b"
set = { contact.restitution = 0.65 }

[[free]]
path = "contact.restitution"
low = 0.4
high = 0.9

[[free]]
path = "contact.reference_force"

[[record]]
file = "shots/a.csv"
channel = "board"
scatter = "2 %"
set = { machine.height = "0.25 m" }

[[number]]
name = "first.width"
value = "380 us"
uncertainty = "2 %"
set = { "machine.height" = "0.35 m" }

[[number]]
name = "first.rigid_peak"
value = "1600 g"
kept_out = true

[reading]
filter = "10 kHz"
rate = "50 kHz"
polarity = { board = -1 }
unit = "g"
"""
TYPED = [
    "jesd22-b111-b", "--set", "contact.restitution=0.65", "--free", "contact.restitution=0.4..0.9",
    "--free", "contact.reference_force", "--to", "{}#board +- 2 %; machine.height=0.25 m",
    "--to", "first.width=380 us +- 2 %; machine.height=0.35 m", "--check-on", "first.rigid_peak=1600 g",
    "--filter", "10 kHz", "--rate", "50 kHz", "--polarity", "board=-1", "--unit", "g",
]  # fmt: skip


FREE = ["contact.reference_force=600 kN..900 kN"]
NUMBER = """
schema = 1
case = "jesd22-b111-b"
free = [{ path = "contact.reference_force", low = "600 kN", high = "900 kN" }]
number = [{ name = "first.rigid_peak", value = "1500 g", uncertainty = "1 %" }]
"""


@pytest.fixture
def whole(tmp_path):
    """The file, and beside it a half-sine of 450 us and 1100 g, sampled at 50 kHz without a time column, upside down."""
    (tmp_path / "shots").mkdir()
    time = np.arange(-2e-3, 4e-3, 2e-5)
    pulse = 1100.0 * np.where((time > 0.0) & (time < 450e-6), np.sin(np.pi * time / 450e-6), 0.0)
    noise = 5.0 * np.random.default_rng(1).standard_normal(time.size)
    (tmp_path / "shots" / "a.csv").write_text("board\n" + "\n".join(f"{-one:.3f}" for one in pulse + noise))
    (tmp_path / "study.toml").write_text(WHOLE)
    return tmp_path / "study.toml"


def test_a_file_asks_what_the_command_line_asks(whole, strikewave, monkeypatch):
    """The same case, fields, targets and reading: what `requested` gets decides the result."""
    asked = []

    def ask(case, request, progress, pool, store):
        asked.append((case, request))
        raise InputError("stop", "here", "no run")

    monkeypatch.setattr("strikewave.studies.fit.report.requested", ask)
    record = str(whole.parent / "shots" / "a.csv")
    for words in ([str(whole)], [word.format(record) for word in TYPED]):
        assert strikewave("fit", *words, "--json")[0] == 2
    (case, request), (other, typed) = asked
    assert case == other
    assert (request.free, request.tries, request.reading) == (typed.free, typed.tries, typed.reading)
    for one, words in ((request.to, typed.to), (request.check_on, typed.check_on)):
        assert parse_targets(one, case) == parse_targets(words, case)
    assert read_targets("--to", case, parse_targets(request.to, case), (), request.reading).pulses[0].unit == "m/s^2"


def test_a_file_is_fitted(whole, strikewave):
    """One number, one field: the same bits as typed; the file is named beside the result with its SHA-256."""
    whole.write_text(NUMBER)
    code, _, words = strikewave("fit", whole, "--out", "written")
    assert code == 0, words
    assert str(whole) in Path("written/record.toml").read_text()
    (typed,) = fit(load_case("jesd22-b111-b"), ["first.rigid_peak=1500 g +- 1 %"], FREE).parameters
    assert json.loads(Path("written/fit.json").read_text())["parameters"][0]["value"] == typed.value


def test_a_file_is_told_from_a_case(whole, tmp_path):
    (tmp_path / "case.toml").write_text('schema = 1\n[machine]\nkind = "drop"\n')
    assert is_fit_file(str(whole))
    assert not any(map(is_fit_file, (str(tmp_path / "case.toml"), "li-ma-2019", str(tmp_path))))


WRONG = {
    "key": ("channel =", "chanel =", 'study.toml: record.0.chanel: unknown key; did you mean "channel"?'),
    "table": ("[reading]", "[raeding]", 'study.toml: raeding: unknown key; did you mean "reading"?'),
    "case": ("jesd22-b111-b", "jesd22-b111-c", 'study.toml: no such case: jesd22-b111-c; did you mean "jesd22-b111-b"'),
    "field": ('path = "contact.reference_force"', 'path = "contact.reference_fource"',
              'study.toml: free: got "contact.reference_fource"; allowed: a quantity of the case; did you mean "contact.ref'),
    "bound": ("low = 0.4\n", "", "study.toml: free.0.low: missing; needed: both bounds, or none"),
    "bounds": ("low = 0.4", 'low = "x"', "study.toml: free: contact.restitution: got "),
    "setting": ("machine.height = ", "machine.hight = ", "study.toml: record.0: machine.hight: unknown key; did you mean"),
    "settings": ('{ machine.height = "0.25 m" }', "[1]", "study.toml: record.0.set: got [1]; allowed: paths with their"),
    "number": ("first.width", "first.wdith", 'study.toml: number.0: got "first.wdith"; allowed: a number that the case'),
    "unit": ("380 us", "380", 'study.toml: number.0: first.width: got "380"; allowed: a time with its unit'),
    "scatter": ('scatter = "2 %"', 'scatter = "200 %"', 'study.toml: record.0.scatter: got "200 %"; allowed: a share above 0'),
    "uncertainty": ('uncertainty = "2 %"', "uncertainty = true", "study.toml: number.0.uncertainty: got True; allowed: a quantity"),
    "record": ("shots/a.csv", "shots/b.csv", "study.toml: record.0: got "),
    "channel": ('channel = "board"', 'channel = "bord"', "board"),
    "blow": ('channel = "board"', "blow = 0", "study.toml: record.0.blow"),
    "reading": ("10 kHz", "10 kg", 'study.toml: reading: filter: got "10 kg"; allowed: a cutoff'),
    "schema": ("schema = 1", "schema = 2", "study.toml: schema"),
}  # fmt: skip


@pytest.mark.parametrize("wrong", WRONG)
def test_a_wrong_file_is_answered_with_file_table_and_key(whole, wrong):
    one, other, words = WRONG[wrong]
    assert one in WHOLE
    whole.write_text(WHOLE.replace(one, other, 1))
    with pytest.raises(StrikewaveError) as error:
        fit(whole)
    assert words in str(error.value)
    if wrong not in ("blow",):  # a count or "all": a line each
        assert "\n" not in str(error.value)


def test_what_the_file_states_is_not_typed_beside_it(whole, strikewave):
    code, _, words = strikewave("fit", str(whole), "--free", "contact.restitution", "--json")
    assert code == 2
    assert "the file of a whole fit states them" in words


def test_the_example_of_the_docs_is_a_file_of_a_fit():
    docs = Path(__file__).parents[3] / "docs" / "fit.md"
    text = next(text for text in docs.read_text("utf-8").split("```toml\n") if "[[free]]" in text).partition("```")[0]
    file = FitFile.model_validate(tomllib.loads(text))
    assert file.free[0].word == "contact.restitution=0.3..0.9"
    assert [one.kept_out for one in file.record] == [False, True]
    assert file.reading.options().low_pass is not None


KEYS = st.sampled_from(["case", "set", "free", "record", "number", "try", "reading", "file", "path", "x", "a\0", "a=b"])
LEAVES = st.one_of(st.text(max_size=8), st.integers(), st.floats(), st.booleans(), st.just("jesd22-b111-b"))


def within(inner):
    """What stands alone, in a list, or in a table."""
    return st.one_of(inner, st.lists(inner, max_size=3), st.dictionaries(KEYS, inner, max_size=3))


TREES = within(within(LEAVES))


@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.dictionaries(KEYS, TREES, max_size=5))
def test_hostile_files_are_answered(tmp_path, tree):
    """Any tree of TOML: read, or one line for each fault; never another error."""
    import tomlkit

    (tmp_path / "hostile.toml").write_text(tomlkit.dumps({"schema": 1, "case": "jesd22-b111-b", **tree}), "utf-8")
    try:
        load_fit(tmp_path / "hostile.toml")
    except StrikewaveError as error:
        assert all("hostile.toml" in line for line in str(error).splitlines())


@pytest.mark.parametrize(
    "text",
    [
        "x = [" * 2000,
        "schema = 1\n" + "#" * 200_000,
        "schema = 1\ncase = 'jesd22-b111-b'\n" + "[[number]]\nname='a'\nvalue=1\n" * 1001,
        "schema = 1\ncase = 'jesd22-b111-b'\nset = {" + "a." * 50 + "b = 1}",
    ],
)
def test_files_without_bounds_are_refused(tmp_path, text):
    (tmp_path / "large.toml").write_text(text)
    with pytest.raises(StrikewaveError) as error:
        load_fit(tmp_path / "large.toml")
    assert len(str(error.value)) < 400
