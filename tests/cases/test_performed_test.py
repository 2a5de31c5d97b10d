"""The [test] table: what it takes and refuses, where it goes, and that it changes no result."""

import datetime
import json
import tomllib

import pytest

from strikewave.analyses.hopkinson.build import example_setup, parse_setup, with_test
from strikewave.base.errors import InputError
from strikewave.cases.case import dump_case, load_case, parse_case
from strikewave.cases.performed_test import load_test
from strikewave.cases.tables.common import EXAMPLE, LONGEST_LINE, LONGEST_NOTES, PerformedTest
from strikewave.reporting.chapters import Summary, result_page

STATED = {
    "item": "board <b>7</b> & co", "serial_number": "0042", "operator": "A. Person", "laboratory": "hall 3",
    "order": "2026-117", "date": "2026-03-02", "direction": "+x", "notes": "first line\nsecond line",
}  # fmt: skip


def with_stated(name="li-ma-2019-fig13-bar"):
    return load_case(name).model_copy(update={"test": PerformedTest(**STATED)})


def test_a_case_is_written_and_read_with_its_test_and_stays_the_built_in_case():
    case = with_stated()
    again = parse_case(dump_case(case))
    assert again.test.stated() == STATED
    assert list(again.test.stated()) == list(PerformedTest.model_fields)
    assert again.changed_fields() == load_case(case.name).changed_fields() == []
    assert again.entries() == load_case(case.name).entries()


def test_the_example_of_a_new_case_lists_every_field_and_reads_once_its_marks_are_gone(strikewave, tmp_path):
    text = "\n".join(line.removeprefix("# ") for line in EXAMPLE.splitlines()[2:])
    assert list(tomllib.loads(text)["test"]) == list(PerformedTest.model_fields)
    assert strikewave("new", "mine.toml")[0] == 0
    lines = (tmp_path / "mine.toml").read_text().splitlines()
    start = lines.index("# [test]")
    bare = "\n".join(lines[:start] + [line.removeprefix("# ") for line in lines[start:]])
    assert parse_case(bare).test.stated() == {"date": "2026-03-02"}


@pytest.mark.parametrize("head", ["[test]\n", ""])
def test_a_file_of_a_test_holds_a_table_or_its_keys(tmp_path, head):
    file = tmp_path / "item.toml"
    file.write_text(head + 'item = " board 7 "\ndate = 2026-03-02\n')
    assert load_test(file).stated() == {"item": "board 7", "date": "2026-03-02"}


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('sreial_number = "1"', 'unknown key; did you mean "serial_number"?'),
        ('[test]\nitem = "a"\n[machine]\nspeed = "1 rpm"', "machine: unknown key"),
        ("serial_number = 42", 'write it in quotes: "42"'),
        ('date = "02.03.2026"', "a date as YYYY-MM-DD"),
        ("date = 2026-03-02T10:00:00", "a date as YYYY-MM-DD"),
        ('date = "2026-02-30"', "a date as YYYY-MM-DD"),
        ('item = "a\\u001b[31m"', "U+001B"),
        ('item = "a\\nb"', "in the notes alone"),
        ('notes = "a\\u202eb"', "U+202E"),
        (f'item = "{"x" * (LONGEST_LINE + 1)}"', f"at most {LONGEST_LINE} characters"),
        (f'notes = "{"x" * (LONGEST_NOTES + 1)}"', f"at most {LONGEST_NOTES} characters"),
        ("", "one of item, serial_number"),
        ('test = "a"', "a table [test]"),
        ("item = ", "a TOML file"),
    ],
)
def test_what_is_wrong_with_a_file_of_a_test_is_one_line_that_names_the_option(tmp_path, text, words):
    file = tmp_path / "item.toml"
    file.write_text(text)
    with pytest.raises(InputError) as caught:
        load_test(file)
    assert words in str(caught.value)
    assert str(caught.value).startswith("--test")
    assert "\n" not in str(caught.value)


def test_a_test_of_today_is_a_date_of_toml_or_its_text():
    assert PerformedTest(date=datetime.date(2026, 3, 2)) == PerformedTest(date=" 2026-03-02 ")


def test_a_set_up_takes_a_test_and_is_written_with_it():
    case = parse_setup(example_setup() + '\n[test]\nitem = "bar 3"\n', "shot")
    assert case.setup.test.stated() == {"item": "bar 3"}
    other = with_test(case, {"operator": "A. Person"})
    assert parse_setup(other.text).setup.test.stated() == other.setup.test.stated() == {"operator": "A. Person"}
    assert with_test(case, {}) is case


@pytest.mark.verify
def test_the_test_heads_page_document_and_case_of_a_run_escaped(strikewave, tmp_path):
    case, out = tmp_path / "case.toml", tmp_path / "out"
    case.write_text(dump_case(with_stated()))
    code, shown, _ = strikewave("wave", "--no-band", case, "--json", "--out", out)
    document = json.loads(shown)
    assert code == 0
    assert document["test"] == STATED
    page = (out / "report.html").read_text()
    head = page[page.index("<header>") : page.index("</header>")]
    assert "board &lt;b&gt;7&lt;/b&gt; &amp; co" in head
    assert "<b>7" not in page
    assert all(label in head for label in ("Item", "Serial number", "Operator", "Laboratory", "Order", "Date", "Notes"))
    assert tomllib.loads((out / "case.toml").read_text())["test"] == STATED


@pytest.mark.verify
def test_measured_files_get_their_test_from_the_command_line(strikewave, tmp_path):
    record, item = tmp_path / "shot.csv", tmp_path / "item.toml"
    rows = [f"{1e-5 * k:.6f},{1000.0 if 40 < k < 60 else 0.0}" for k in range(400)]
    record.write_text("\n".join(["time (s),a (g)", *rows]))
    item.write_text('[test]\nitem = "board 7"\n')
    code, shown, _ = strikewave("record", record, "--test", item, "--json", "--out", "out")
    assert code == 0
    assert json.loads(shown)["test"] == {"item": "board 7"}
    assert tomllib.loads((tmp_path / "out" / "record.toml").read_text())["test"] == {"item": "board 7"}
    assert "board 7" in (tmp_path / "out" / "report.html").read_text()


def test_a_command_that_tests_nothing_refuses_a_test(strikewave, tmp_path):
    item = tmp_path / "item.toml"
    item.write_text('item = "board 7"\n')
    code, _, error = strikewave("laws", "--test", item)
    assert code == 2
    assert error.startswith("--test")


def test_a_result_without_a_test_has_no_such_key_and_no_such_head(solution):
    assert "test" not in solution.document()
    assert 'class="facts test"' not in result_page(solution, Summary("A report", ""), [])
