"""``strikewave reproduce``: document, files whole or not at all, and what bad input is told."""

import csv
import json
import re

import pytest

from strikewave.papers.li_ma_2019.reproduce import progress

ROW = {"name", "where", "quantity", "value_si", "si", "published_value", "published_unit", "origin", "note", "computed"}
ANSWER = {"by", "value_si", "low_si", "high_si", "role", "note", "difference"}
QUICK = ("reproduce", "li-ma-2019", "--without", "elements", "--without", "studies")


def document_cases(out):
    return json.loads(out)["cases"]


@pytest.mark.verify
def test_the_document_has_its_keys_and_numbers_that_agree_with_themselves(strikewave, tmp_path):
    code, out, err = strikewave(*QUICK, "--json")
    assert code == 0
    assert "done in" in err
    runs = [line.split()[2] for line in err.splitlines() if re.match(r" *\d+ %  ", line)]
    maps = ["li-ma-2019-fig5", "li-ma-2019-fig13"]
    assert runs == ["equations", *document_cases(out), *maps], "a line for each run where stderr is no terminal"
    document = json.loads(out)
    assert {"schema", "version", "units", "warnings", "paper", "cases", "elements", "consistency"} <= set(document)
    assert document["paper"] == "li-ma-2019"
    assert document["elements"] == []
    assert document["quick"] is False
    assert len(document["equations"]) == 41
    assert document["findings"]
    for row in document["published"]:
        assert set(row) == ROW
        assert row["si"] in {"m/s^2", "s", "N", "rad/s", "m", "kg/m^3", "Pa", "1"}
        for answer in row["computed"]:
            assert set(answer) == ANSWER
            if answer["value_si"] is not None:
                assert answer["difference"] == pytest.approx(answer["value_si"] / row["value_si"] - 1.0, abs=1e-12)
    window = next(row for row in document["published"] if row["name"] == "comparison time")
    values = [window[key] for key in ("value_si", "si", "published_value", "published_unit")]
    assert values == [0.15, "s", 150.0, "ms"]
    assert {row["verdict"] for row in document["findings"]} <= {"right", "partly", "not", "open"}
    assert not list(tmp_path.iterdir())  # with --json nothing is written unasked


@pytest.mark.verify
def test_the_folder_is_whole_and_its_table_holds_the_document(strikewave, tmp_path):
    code, out, _ = strikewave(*QUICK, "--out", "result")
    assert code == 0
    assert "Published numbers and what was computed" in out
    place = tmp_path / "result"
    names = {path.name for path in place.iterdir()}
    figures = {f"figure-{name}.svg" for name in ("5", "5-b", "7", "7-b", "7-c", "9", "11", "13", "13-b", "13-c", "15")}
    assert names == {"record.toml", "report.html", "reproduction.json", "published.csv", "runs.sqlite", *figures}
    document = json.loads((place / "reproduction.json").read_text())
    rows = list(csv.DictReader((place / "published.csv").open()))
    answers = [(row, answer) for row in document["published"] for answer in row["computed"] or (None,)]
    assert len(rows) == len(answers)
    for line, (row, answer) in zip(rows, answers, strict=True):
        assert line["name"] == row["name"]
        assert float(line["published"]) == row["value_si"]
        assert line["computed"] == ("" if answer is None else repr(answer["value_si"]))
    (place / "mine.txt").write_text("kept")
    code, _, err = strikewave(*QUICK, "--out", "result", "--force")
    assert code == 2
    assert "mine.txt" in err
    assert (place / "mine.txt").read_text() == "kept"


def test_a_run_has_one_line_however_often_it_reports(capsys):
    with progress() as report:
        for share, words in ((0.0, "a"), (0.1, "b: 3 s left"), (0.2, "b: 2 s left"), (0.6, "c"), (1.0, "")):
            report(share, words)
    assert capsys.readouterr() == ("", "  0 %  a\n 10 %  b\n 60 %  c\n")


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("reproduce", "li-ma-2018"), ('got "li-ma-2018"', "allowed: li-ma-2019")),
        (("reproduce", "li-ma-2019", "--without", "element"), ('--without: got "element"', "elements")),
        (("reproduce", "li-ma-2019", "--threads", "0"), ("--threads", "at least 1")),
        (("reproduce",), ("PAPER",)),
    ],
)
def test_bad_words_are_named_with_what_there_is(strikewave, words, said):
    code, out, err = strikewave(*words)
    assert code == 2
    assert out == ""
    assert all(word in err for word in said)
