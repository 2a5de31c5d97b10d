"""The test report: every shock once with its verdict, calibrations, what is not stated, escaping, many shocks, PDF."""

import csv
import dataclasses
import hashlib
import html
import io
import json
import re
import tomllib
from importlib import resources

import numpy as np
import pytest
from PIL import Image
from pypdf import PdfReader

import strikewave as sw
from strikewave.analyses.clauses import SHOWN
from strikewave.analyses.record.laboratory_report import (
    DOUBT,
    MOST_LINES,
    MOST_LISTED,
    ONLY_ITEMS,
    drawn_shocks,
    report_of_test,
)
from strikewave.analyses.record.sentences import tag_of_records
from strikewave.base.errors import InputError, StrikewaveError
from strikewave.cases.performed_test import NO_TEST, ReportTables, StatedTest, example_file, load_test
from strikewave.cases.tables.common import PerformedTest
from strikewave.reporting.pdf import check_pdf, pdf_of
from strikewave.specifications.ideal_pulses import IdealPulse

SPEC = "iec-60068-2-27:50g-11ms"
SHOCKS = {"xp1": 50.0, "xp2": 51.0, "xp3": 49.0, "xn1": 50.0, "xn2": 66.0}
"""Files and their peaks, g; the last is above the limit of 60 g."""
NAMED = [row.split("=")[0] for row in example_file().splitlines() if "=" in row]


def write_shock(path, peak):
    time = np.arange(1000) * 1e-4
    noise = 0.05 * np.random.default_rng(5).normal(size=time.size)
    values = noise + IdealPulse("half-sine", peak, 11e-3).at(time - 0.03)
    np.savetxt(
        path, np.column_stack([time, values]), delimiter=",", header="time (s),table (g)", comments="", fmt="%.9g"
    )


@pytest.fixture(scope="session")
def folder(tmp_path_factory):
    place = tmp_path_factory.mktemp("shocks")
    for name, peak in SHOCKS.items():
        write_shock(place / f"{name}.csv", peak)
    return place


@pytest.fixture(scope="session")
def result(folder):
    files = [folder / f"{name}.csv" for name in SHOCKS]
    return sw.record(files, spec=SPEC, judging=sw.Judging(direction=["xp*=+x", "xn*=-x"], uncertainty="5 %"))


def filled_in(text="a b", date="2026-03-02"):
    """Return the file to fill in with every key filled in."""
    lines = []
    for line in example_file().splitlines():
        key = line.split(" = ")[0]
        days = ("date", "issued", "last_day", "received", "calibrated", "calibration_due")
        if key in ("direction", "file"):
            continue
        value = f"[{json.dumps(text)}]" if key == "statements" else json.dumps(date if key in days else text)
        lines.append(f"{key} = {value}" if " = " in line else line)
    return "\n".join(lines)


def stated(tmp_path, text):
    file = tmp_path / "test.toml"
    file.write_text(text, "utf-8")
    return load_test(file)


def tables_of(page):
    """Return the tables of a page by their captions: rows of plain text."""
    found = {}
    for caption, body in re.findall(r"<figcaption[^>]*><b>Table \d+.</b> (.*?)</figcaption>(.*?)</figure>", page, re.S):
        rows = re.findall(r"<tr>(.*?)</tr>", body, re.S)
        cells = [re.findall(r"<t[hd][^>]*>(.*?)</t[hd]>", row, re.S) for row in rows]
        plain = [[html.unescape(re.sub("<[^>]*>", "", cell)).strip() for cell in row] for row in cells]
        found[html.unescape(caption)] = plain
    return found


@pytest.mark.usefixtures("undrawn")
def test_every_shock_stands_once_with_the_verdict_and_the_failed_clauses_of_the_result(result):
    head, *rows = tables_of(report_of_test(result.of_test(NO_TEST)))[f"Each shock{DOUBT}"]
    assert [row[0] for row in rows] == [str(k + 1) for k in range(len(SHOCKS))]
    places = {name: head.index(name) for name in ("direction", "record", "verdict")}
    for row, one in zip(rows, result.verdict.shocks, strict=True):
        assert row[places["record"]] == one.file.rpartition("/")[2]
        assert row[places["direction"]] == one.direction
        assert row[places["verdict"]] == SHOWN[one.found.verdict]
        failed = [clause.clause for clause in one.found.clauses if clause.verdict == "fail"]
        assert row[-1] == (", ".join(failed) or "–")
    peaks = [float(row[head.index("peak (g)")].split(" ")[0]) for row in rows]
    assert peaks == pytest.approx(list(SHOCKS.values()), rel=0.005)  # noise of 0.05 g
    doubts = [float(row[head.index("peak (g)")].split(" ± ")[1]) for row in rows]
    assert doubts == pytest.approx([0.05 * peak for peak in SHOCKS.values()], rel=0.05)  # two digits; noise beside 5 %


@pytest.mark.usefixtures("undrawn")
def test_directions_say_what_was_asked_for_done_and_passed(result):
    tables = tables_of(report_of_test(result.of_test(NO_TEST)))
    rows = tables["Shocks by direction"][1:]
    assert [row[:7] for row in rows] == [["+x", "x", "3", "3", "3", "0", "0"], ["-x", "x", "3", "2", "1", "1", "0"]]
    assert [row[7] for row in rows] == ["PASS", "FAIL"]
    assert tables["All shocks together"][1][:4] == ["directions", "at least 6", "2", "FAIL"]


@pytest.mark.usefixtures("undrawn")
def test_a_report_with_all_that_is_asked_for_names_all_of_it_and_lists_nothing_as_missing(result, tmp_path):
    page = report_of_test(result.of_test(stated(tmp_path, filled_in("a b"))))
    assert "Nothing: all that clause 7.8 asks for" in page
    assert "Not stated" not in tables_of(page)
    for name in ("ISO/IEC 17025", ONLY_ITEMS, "Decision rule: simple acceptance", "5 % of the acceleration", "a b"):
        assert name in page, name
    assert page.count("Table") > 8


@pytest.mark.usefixtures("undrawn")
def test_what_is_not_stated_is_listed_with_its_clause_and_the_key_that_states_it(result):
    rows = tables_of(report_of_test(result.of_test(NO_TEST)))["Not stated"][1:]
    assert {row[0][:7] for row in rows} == {"7.8.2.1", "7.8.3.1", "6.5, no"}
    keys = [key for row in rows for key in row[2].split(", ") if "." in key]
    for key in keys:
        table, _, name = key.rpartition(".")
        assert name in tomllib.loads(example_file().replace("[[", "[").replace("]]", "]"))[table], key
    one = result.of_test(StatedTest(PerformedTest(date="2026-03-02"), ReportTables(report={"number": "7"})))
    left = tables_of(report_of_test(one))["Not stated"][1:]
    assert len(rows) - len(left) == 2


def overdue(due):
    row = {"name": "accelerometer", "model": "M", "calibrated": "2025-01-01", "calibration_due": due}
    return StatedTest(PerformedTest(date="2026-03-02"), ReportTables(equipment=[row]))


@pytest.mark.usefixtures("undrawn")
def test_an_overdue_calibration_stands_at_the_top_and_marks_the_verdict_wherever_it_is(result):
    marked = result.of_test(overdue("2026-03-01"))
    page = report_of_test(marked)
    assert "calibration overdue" in page[: page.index("</header>")]
    assert tag_of_records(marked.verdict, marked.performed).text.endswith("; calibration overdue")  # of both reports
    summary = page[page.index('<section id="summary"') :].partition("</section>")[0]
    assert "Calibration overdue. accelerometer M: calibration was due on 2026-03-01" in summary
    assert marked.document()["spec"]["calibration_overdue"] == ["accelerometer M"]
    assert "calibration-overdue" in [notice.code for notice in marked.notices]
    held = result.of_test(overdue("2026-03-02"))
    assert "overdue" not in report_of_test(held)
    assert held.document()["spec"]["calibration_overdue"] == []


def test_words_of_a_hostile_file_stay_words(result, tmp_path):
    text = "<script>alert(1)</script><img src=x onerror=alert(1)>&\"'{{ 7*7 }}</style>"
    Image.new("RGB", (8, 8)).save(tmp_path / "p.png")
    words = filled_in(text).replace("[[setup.photograph]]", '[[setup.photograph]]\nfile = "p.png"')
    page = report_of_test(result.of_test(stated(tmp_path, words)))
    assert "<script" not in page
    images = re.findall("<img[^>]*>", page)
    assert len(images) == 1  # the photograph, its caption as text in quotes
    assert images[0].startswith('<img src="data:image/jpeg;base64,')
    assert " onerror" not in re.sub('"[^"]*"', "", images[0])
    assert page.count("</style>") == 1
    assert "&lt;script&gt;alert(1)&lt;/script&gt;" in page
    assert "{{ 7*7 }}" in html.unescape(page)


def many(result, count):
    """Return a result with so many shocks, made of those of a few files; every hundredth is one that fails."""
    bad = next(one for one in result.verdict.shocks if one.found.verdict == "fail")
    good = [one for one in result.verdict.shocks if one.found.verdict == "pass"]
    shocks = [
        (bad if k % 100 == 99 else good[k % len(good)])._replace(number=k + 1, file=good[0].file) for k in range(count)
    ]
    return dataclasses.replace(result, verdict=dataclasses.replace(result.verdict, shocks=tuple(shocks)))


@pytest.mark.usefixtures("undrawn")
def test_4000_shocks_are_summed_up_and_those_that_fail_listed(result):
    multiplied = many(result, 4000)
    shocks = multiplied.verdict.shocks
    page = report_of_test(multiplied.of_test(NO_TEST))
    assert len(page) < 600_000
    tables = tables_of(page)
    assert f"Each shock{DOUBT}" not in tables
    peaks = [row for row in tables["All shocks, by direction"][1:] if row[1] == "peak"]
    assert sum(int(row[2]) for row in peaks) == 4000
    assert sum(int(row[5]) for row in tables["Shocks by direction"][1:]) == 40
    for row, sign in zip(peaks, ("+x", "-x"), strict=True):
        here = [one for one in shocks if one.direction == sign]
        mean = np.mean([clause.value for one in here for clause in one.found.clauses if clause.clause == "peak"])
        assert float(row[4].split(" ")[0].split()[0]) == pytest.approx(mean / 9.80665, rel=1e-3)  # four digits
    failed = tables[f"Shocks that do not pass{DOUBT}"][1:]
    assert [int(row[0]) for row in failed] == [100 * k for k in range(1, 41)]
    extremes = tables[f"Shocks with the largest and smallest figures{DOUBT}"][1:]
    assert {"66", "49"} <= {str(round(float(row[5].split(" ")[0]))) for row in extremes}
    assert all(len(rows) <= MOST_LISTED + 1 for rows in tables.values())


def test_the_drawn_shocks_are_few_and_have_those_that_fail(result):
    shocks = many(result, 1000).verdict.shocks
    drawn = drawn_shocks(shocks)
    assert len(drawn) == MOST_LINES
    assert sum(one.found.verdict == "fail" for one in drawn) == 10
    assert drawn_shocks(shocks[:5]) == list(shocks[:5])


@pytest.mark.verify
@pytest.mark.parametrize("paper", ["A4", "letter"])
def test_the_sheets_have_number_and_count_of_pages_and_all_that_is_signed(result, paper):
    try:
        check_pdf("--pdf", paper)
    except InputError as error:
        pytest.skip(str(error))
    signed = ReportTables(report={"number": "TR-17"}, signature=[{"role": "Authorized by", "name": "D. Head"}])
    reader = PdfReader(io.BytesIO(pdf_of(report_of_test(result.of_test(StatedTest(tables=signed))), paper)))
    words = [sheet.extract_text() for sheet in reader.pages]
    count = len(words)
    assert count > 3
    for place, text in enumerate(words, start=1):
        assert f"page {place} of {count}" in text
        assert "Test report TR-17" in text
    assert "End of test report TR-17" in words[-1]
    assert sum("Authorized by: D. Head" in text.replace("\n", " ") for text in words) == 1


@pytest.mark.verify
def test_one_command_writes_the_report_and_a_line_a_shock(strikewave, tmp_path, folder, read_page):
    (tmp_path / "test.toml").write_text('[report]\nnumber = "TR-17"\n')
    files = [folder / f"{name}.csv" for name in ("xp1", "xn2")]
    words = ["record", *files, "--spec", SPEC, "--test", "test.toml", "--show", "m/s2"]
    assert strikewave(*words, "--out", "out")[0] == 3
    page = read_page(tmp_path / "out" / "test-report.html")
    assert "<h1>Test report TR-17</h1>" in page.text
    assert "peak (m/s²)" in tables_of(page.text)[f"Each shock{DOUBT}"][0]
    for file in files:  # the records by their SHA-256
        digest = dict(row[:2] for row in tables_of(page.text)["Records"][1:])[str(file)]
        assert len(digest) == 64
    rows = list(csv.DictReader(io.StringIO((tmp_path / "out" / "shocks.csv").read_text())))
    assert [row["verdict"] for row in rows] == ["pass", "fail"]
    assert float(rows[1]["peak margin [m/s^2]"]) == pytest.approx(-6 * 9.80665, rel=0.05)


@pytest.mark.verify
def test_without_a_specification_or_a_test_there_is_no_test_report(strikewave, tmp_path, folder, result):
    (tmp_path / "test.toml").write_text('item = "board 7"\n')
    assert strikewave("record", folder / "xp1.csv", "--test", "test.toml", "--out", "a")[0] == 0
    assert strikewave("record", folder / "xp1.csv", "--spec", SPEC, "--out", "b")[0] == 0
    assert not list(tmp_path.glob("?/test-report.html"))
    with pytest.raises(StrikewaveError, match="a test report needs a verdict"):
        sw.record(folder / "xp1.csv").test_report(tmp_path)
    assert result.test_report(tmp_path).name == "test-report.html"


@pytest.mark.usefixtures("undrawn")
def test_a_shock_of_which_nothing_can_be_said_is_counted_named_and_told_why(tmp_path):
    """A peak of 59 g with 5 % lies across the limit of 60 g."""
    for name, peak in (("a", 50.0), ("b", 59.0), ("c", 66.0)):
        write_shock(tmp_path / f"{name}.csv", peak)
    found = sw.record(
        sorted(tmp_path.glob("*.csv")),
        spec=SPEC,
        judging=sw.Judging(decision="guarded", uncertainty=0.05, direction="+x"),
    )
    page = report_of_test(found.of_test(NO_TEST))
    assert re.search(r"<dt>cannot tell</dt><dd>1</dd>", page)
    assert "nothing can be said (b.csv, blow 1): peak" in page
    rows = tables_of(page)[f"Each shock{DOUBT}"]
    assert rows[2][-1].endswith("the uncertainty reaches over the limit")


@pytest.mark.usefixtures("undrawn")
def test_the_annex_has_the_budget_and_the_hashes_of_what_was_judged_by(tmp_path, folder):
    """Specification of one's own, budget and test file, each by the SHA-256 of its bytes."""
    origin = (resources.files("strikewave.specifications.published") / "iec-60068-2-27.toml").read_text("utf-8")
    budget = 'schema = 1\ntitle = "Channel 1"\nstatus = "normative"\nsource = "certificate 4711"\n[[contribution]]\n'
    texts = {
        "own.toml": origin.replace('tolerance = "20 %"', 'tolerance = "10 %"'),
        "budget.toml": budget + 'kind = "sensitivity"\nvalue = "3 %"\ncoverage = 2\n',
        "test.toml": 'item = "board 7"\n',
    }
    for name, text in texts.items():
        (tmp_path / name).write_text(text, "utf-8")
    spec = f"{tmp_path / 'own.toml'}:50g-11ms"
    found = sw.record(
        folder / "xp1.csv",
        spec=spec,
        judging=sw.Judging(uncertainty=tmp_path / "budget.toml", test=tmp_path / "test.toml"),
    )
    page = report_of_test(found)
    tables = tables_of(page)
    digests = {name: hashlib.sha256((tmp_path / name).read_bytes()).hexdigest() for name in texts}
    assert {row[2] for row in tables["Judged by"][1:]} == set(digests.values())
    assert ["sensitivity", "sensitivity", "3 %, k = 2", "normative: certificate 4711"] in tables[
        "What is stated, and by whom"
    ]
    assert "own.toml, made from IEC 60068-2-27, test Ea, half-sine, with changes" in page
