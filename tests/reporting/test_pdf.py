"""Reports as PDF: size and number of sheets, nothing cut, nothing fetched, the same bytes again."""

import io
import os
import re
import sys
from html import unescape

import pytest
from pypdf import PdfReader

from strikewave.base.errors import InputError
from strikewave.reporting.chapters import Head, whole_page
from strikewave.reporting.parts import Formula, Section, Table, Tag
from strikewave.reporting.pdf import check_pdf, pdf_of

HEAD = Head("Blows <b>", "Report", "Case", "small", "", Tag("done", "good"), ["A summary."], [("peak", "4151 g")], "")
INCH = 72.0
IMPACT = ["--m1", "0.2", "--m2", "0.459", "--speed", "20", "--stiffness", "1e8", "-n", "1.5"]
MARGIN = 10.0 / 25.4 * INCH
SIZES = {"A4": (210.0 / 25.4 * INCH, 297.0 / 25.4 * INCH), "letter": (8.5 * INCH, 11.0 * INCH)}
EQUATION = Formula(r"\begin{array}{l} F = K \delta^n, \\ t \le t_0 \end{array}", "F = K delta^n, t <= t0")


@pytest.fixture(autouse=True)
def _pango():
    """Leave out, but in CI, what needs a library of the system."""
    try:
        check_pdf("--pdf", "A4")
    except InputError as error:
        (pytest.fail if os.environ.get("CI") == "true" else pytest.skip)(str(error))


def wide(columns):
    heads = [f"quantity{k} (m/s)" for k in range(columns)]
    return Table("Wide", heads, [[f"{1000.0 + k:.3f}" for k in range(columns)]] * 2)


def page(*parts, folded=""):
    return whole_page(HEAD, [Section("Parts", "", list(parts), folded=folded)])


def starts_of(reader):
    """Return where pieces of text begin across each sheet, in points, with its width and height."""
    for sheet in reader.pages:
        found = []

        def keep(text, cm, tm, font, size, found=found):
            if text.strip():
                found.append((tm[4] * cm[0] + tm[5] * cm[2] + cm[4], text.strip()))

        sheet.extract_text(visitor_text=keep)
        yield float(sheet.mediabox.width), float(sheet.mediabox.height), found


@pytest.mark.verify
@pytest.mark.parametrize("paper", ["A4", "letter"])
def test_sheets_have_the_size_asked_for_their_numbers_and_the_title(paper):
    parts = [Table(f"Table {k}", ["a", "b"], [[f"row {n}", n] for n in range(60)]) for k in range(2)]
    reader = PdfReader(io.BytesIO(pdf_of(page(*parts), paper)))
    assert len(reader.pages) > 1
    for number, sheet in enumerate(reader.pages, 1):
        # half a point: sizes are given in mm and written in points
        assert (sheet.mediabox.width, sheet.mediabox.height) == pytest.approx(SIZES[paper], abs=0.5)
        assert f"page {number} of {len(reader.pages)}" in sheet.extract_text()
        assert "Blows <b>" in sheet.extract_text()


def test_folded_parts_are_open_and_equations_are_drawn():
    parts = [Table("Equations", ["number", "equation"], [["(1)", EQUATION]])]
    text = page(*parts, folded="Show it")
    drawn = "".join(sheet.extract_text() for sheet in PdfReader(io.BytesIO(pdf_of(text, "A4"))).pages)
    assert "(1)" in drawn
    assert "Show it" not in drawn  # words of a button
    assert "delta" not in drawn  # neither words nor letters in a row: it is a drawing
    assert "δ" not in drawn
    unknown = page(Table("Equations", ["number", "equation"], [["(1)", Formula(r"{a \atop b}", "a over b")]]))
    assert "a over b" in PdfReader(io.BytesIO(pdf_of(unknown, "A4"))).pages[0].extract_text()


@pytest.mark.parametrize(("columns", "across"), [(6, False), (14, True), (40, True)])
def test_wide_tables_get_smaller_letters_then_a_sheet_across_and_stay_on_it(columns, across):
    table = wide(columns)
    reader = PdfReader(io.BytesIO(pdf_of(page(table), "A4")))
    sheets = list(starts_of(reader))
    assert any(width > height for width, height, _ in sheets) is across
    text = re.sub(r"\s", "", "".join(sheet.extract_text() for sheet in reader.pages))
    if columns < 40:  # more than that breaks words rather than cut them
        for head in table.columns:
            assert head.replace(" ", "") in text
    assert all(0.0 <= start < width - MARGIN for width, _, found in sheets for start, _ in found)


def test_a_picture_beside_a_table_within_a_table_is_set():
    picture = '<svg role="img" viewBox="0 0 420 150" width="420" height="150"><text>peak</text></svg>'
    cells = f"<td><table><tr><th>width</th><td>455 µs</td></tr></table></td><td>{picture}</td>"
    reader = PdfReader(io.BytesIO(pdf_of(f"<table><tr>{cells}</tr></table>", "A4")))
    assert len(reader.pages) == 1
    assert "455" in reader.pages[0].extract_text()


def test_nothing_is_fetched(tmp_path, monkeypatch):
    opened = []
    monkeypatch.setattr("urllib.request.OpenerDirector.open", lambda self, url, *a, **k: opened.append(url))
    secret = tmp_path / "secret.svg"
    secret.write_text('<svg xmlns="http://www.w3.org/2000/svg"><text y="10">secret</text></svg>')
    text = page(wide(3)).replace(
        "</main>",
        f'<img src="{secret.as_uri()}"><img src="http://localhost:9/a.png"><link rel="stylesheet" href="https://localhost:9/b.css">'
        f'<link rel="attachment" href="{secret.as_uri()}"><svg viewBox="0 0 9 9"><image href="{secret.as_uri()}"/></svg></main>',
    )
    pdf = pdf_of(text, "A4")
    assert opened == []
    reader = PdfReader(io.BytesIO(pdf))
    assert not reader.attachments
    assert "secret" not in reader.pages[0].extract_text()


def test_same_page_gives_the_same_bytes():
    text = page(wide(5), Table("Equations", ["equation"], [[EQUATION]]))
    assert pdf_of(text, "A4") == pdf_of(text, "A4")


def test_without_the_extra_an_error_says_how_to_install_it(monkeypatch):
    monkeypatch.setitem(sys.modules, "weasyprint", None)
    with pytest.raises(InputError, match=re.escape("--pdf needs WeasyPrint: pip install 'strikewave[pdf]'")):
        check_pdf("--pdf", "A4")


@pytest.mark.verify
def test_pdf_needs_a_folder_and_a_report(strikewave, tmp_path):
    code, out, err = strikewave("impact", *IMPACT, "--json", "--pdf", "A4")
    assert (code, out) == (2, "")
    assert '--pdf: got "--json without --out"' in err
    code, _, err = strikewave("laws", "--pdf", "letter", "--out", "laws")
    assert code == 2
    assert "only where a report is written" in err
    assert not list(tmp_path.iterdir())


@pytest.mark.verify
def test_report_is_in_the_folder_as_pdf_and_goes_with_a_run_without_it(strikewave, tmp_path):
    code, _, err = strikewave("impact", *IMPACT, "--out", "a", "--pdf", "a4")
    assert code == 0
    assert "report.pdf" in err
    assert (tmp_path / "a" / "report.pdf").read_bytes().startswith(b"%PDF-")
    code, _, err = strikewave("impact", *IMPACT, "--out", "a", "--force")
    assert code == 0
    assert "removed: report.pdf" in err
    assert not (tmp_path / "a" / "report.pdf").exists()


GOAL = ["--interval", "20 ms", "--peak", "4000 g", "--width", "200 us", "--strikers", "4", "--striker-mass", "1 kg"]
FEW = ["--set", "feed.blows=3"]
GASKETS = ["--sensor", "buffered", "--limit", "7000 g", "--material", "PTFE", "--thickness", "1 mm", "--layers", "2"]
COMMANDS = [
    ["run", "jesd22-b111-b"],
    ["run", "li-ma-2019", *FEW],
    ["wave", "li-ma-2019-fig13-bar"],
    ["scatter", "li-ma-2019", "--runs", "10", "--shares", "none", *FEW],
    ["impact", *IMPACT],
    ["record", "{measured}/impact_05.lvm"],
    ["srs", "{measured}/impact_05.lvm"],
    ["fem", "two-bars-fem"],
    ["hopkinson", "shot.toml"],
    ["map", "li-ma-2019", "--points", "3x3", "--train", "0", "--workers", "1", *FEW],
    ["settings", *GOAL, "--blows", "3"],
    ["buffer", "li-ma-2019-fig5", *GASKETS, *FEW],
]
CASES = [(command, ("A4", "letter")[k % 2]) for k, command in enumerate(COMMANDS)]
"""Each on one kind of paper, in turn: each takes seconds."""


@pytest.mark.verify
@pytest.mark.parametrize(
    ("command", "paper"), CASES, ids=[f"{'-'.join(command[:2])}-{paper}".replace("/", "-") for command, paper in CASES]
)
def test_no_word_of_a_head_is_cut_or_broken_in_a_report(command, paper, measured, tmp_path, strikewave):
    folder = str(measured("smd-5kg-impacts")) if "{" in command[1] else ""
    words = [word.replace("{measured}", folder) for word in command]
    if command[0] == "hopkinson":
        assert strikewave("new", "shot", "--from", "hopkinson")[0] == 0
    assert strikewave(*words, "--out", "a", "--pdf", paper)[0] in (0, 3)
    reader = PdfReader(tmp_path / "a" / "report.pdf")
    printed = set("\n".join(sheet.extract_text() for sheet in reader.pages).split())
    page = (tmp_path / "a" / "report.html").read_text("utf-8")
    tables = heads_of(page)
    assert tables
    assert [word for heads in tables for head in heads for word in head.split() if word not in printed] == []
    # words of pictures, which grow and shrink as a whole, are placed in units of the picture
    drawn = {unescape(re.sub("<[^>]*>", "", text)).strip() for text in re.findall(r"<text.*?</text>", page, re.DOTALL)}
    placed = [(start, width, text) for width, _, found in starts_of(reader) for start, text in found]
    set_by_sheet = [(start, width, text) for start, width, text in placed if text not in drawn]
    assert len(set_by_sheet) > 50
    assert [text for start, width, text in set_by_sheet if not 0.0 <= start < width - MARGIN] == []


def heads_of(text):
    """Return the heads of every table of a page."""
    tables = re.findall(r"<thead><tr>(.*?)</tr></thead>", text, re.DOTALL)
    return [[unescape(head) for head in re.findall(r"<th[^>]*>(.*?)</th>", table, re.DOTALL)] for table in tables]
