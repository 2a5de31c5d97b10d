"""A page or picture that cannot be drawn costs no result: it is named, and all else is written."""

import errno
import json
import re
from pathlib import Path

import pytest

import strikewave as package
from strikewave.base.errors import InputError
from strikewave.reporting.output_options import Output
from strikewave.reporting.run_and_write import NOT_DRAWN

from .test_pdf import IMPACT

SHEET = "strikewave.analyses.impact.report.impact_picture"
PAGE = "strikewave.analyses.impact.report.impact_report"


def raising(error):
    def draw(*_):
        raise error

    return draw


@pytest.mark.parametrize(
    ("planted", "lost", "stays", "error"),
    [
        (SHEET, "impact.svg", "report.html", ZeroDivisionError("division by zero")),
        (PAGE, "report.html", "impact.svg", InputError("view", "nothing left", "some")),
    ],
)
def test_a_picture_that_fails_is_named_and_the_rest_is_written(
    strikewave, monkeypatch, without_lines, planted, lost, stays, error
):
    with without_lines():
        code, whole, _ = strikewave("impact", *IMPACT, "--out", "whole", "--json")
    assert code == 0
    monkeypatch.setattr(planted, raising(error))
    code, out, err = strikewave("impact", *IMPACT, "--out", "a", "--json")
    assert code == 0
    assert {path.name for path in Path("a").iterdir()} == {path.name for path in Path("whole").iterdir()} - {lost}
    assert (Path("a") / stays).stat().st_size > 1000
    document, expected = json.loads(out), json.loads(whole)
    (notice,) = [row for row in document.pop("warnings") if row["code"] == NOT_DRAWN]
    assert notice["severity"] == "warning"
    assert notice["message"].startswith(f"{lost} could not be drawn (in draw")
    assert str(error).partition(":")[0] in notice["message"]
    del expected["warnings"]
    assert document == expected
    assert lost not in err.partition("written:")[2]


def test_a_pdf_of_a_page_that_fails_is_left_out_with_a_warning(strikewave, monkeypatch):
    monkeypatch.setattr(Output, "check_files", lambda self, usual: None)  # WeasyPrint may be absent
    monkeypatch.setattr(PAGE, raising(ValueError("no")))
    code, _, err = strikewave("impact", *IMPACT, "--out", "a", "--pdf", "A4")
    assert code == 0
    assert "there is no PDF, for there is no report.html" in err
    assert (Path("a") / "impact.svg").is_file()


def test_a_full_disk_while_a_picture_is_written_still_leaves_nothing(strikewave, monkeypatch):
    monkeypatch.setattr(SHEET, raising(OSError(errno.ENOSPC, "No space left on device")))
    code, _, _ = strikewave("impact", *IMPACT, "--out", "a")
    assert code == 2
    assert not Path("a").exists()


def test_whoever_looks_for_the_place_in_the_code_gets_the_error_itself(strikewave, monkeypatch):
    monkeypatch.setenv("STRIKEWAVE_TRACE", "1")
    monkeypatch.setattr(SHEET, raising(InputError("view", "nothing left", "some")))
    code, _, err = strikewave("impact", *IMPACT, "--out", "a")
    assert (code, Path("a").exists()) == (2, False)
    assert "nothing left" in err


def test_every_command_draws_each_file_for_itself():
    """One picture that fails leaves the others: no page or picture is written outside `drawing`."""
    home = Path(package.__file__).parent
    direct = re.compile(r"^ *(save\(.*, |\()folder / .*\)(\.write_text\(.*\))?$", re.M)
    places = {
        str(path.relative_to(home)): direct.findall(path.read_text("utf-8"))
        for room in ("analyses", "studies", "papers")
        for path in (home / room).rglob("*.py")
    }
    assert {name for name, lines in places.items() if lines} == {"analyses/machine/report.py"}  # in a copied process
    assert len(places["analyses/machine/report.py"]) == 1
