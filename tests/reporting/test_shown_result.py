"""What results show of themselves in Python: a line, a table and a curve in a notebook, picture, report, table."""

import dataclasses
import importlib
import pkgutil
import subprocess
import sys
import xml.etree.ElementTree as ElementTree
from html.parser import HTMLParser

import numpy as np
import pytest

import strikewave
from strikewave.base import declare
from strikewave.base.errors import InputError, StrikewaveError
from strikewave.base.result import FAILED, Notice, Result
from strikewave.reporting.numbers import ShownUnits, showing
from strikewave.reporting.shown_result import Curve, ShownResult, _svg, columns_of_mappings


def kinds():
    """Return every kind of result that can be made."""
    for room in ("analyses", "studies", "papers"):
        for module in pkgutil.walk_packages([f"{strikewave.__path__[0]}/{room}"], f"strikewave.{room}."):
            if module.name.rpartition(".")[2] not in ("command", "report"):
                importlib.import_module(module.name)

    def below(kind):
        for one in kind.__subclasses__():
            yield one
            yield from below(one)

    made = {
        kind
        for kind in below(Result)
        if not getattr(kind, "__abstractmethods__", None) and getattr(kind, "command", "")
    }
    return {kind for kind in made if kind.__module__.startswith("strikewave.")}


def test_every_declared_result_has_one_unit_a_key_and_a_meaning_of_each():
    found = [kind for kind in kinds() if declare.declarations(kind)]
    assert {kind.__name__ for kind in found} >= {"Solution", "WaveSolution", "FemSolution"}
    for kind in found:
        assert declare.units(kind) or kind.command == "deck"  # which has counts and words alone
        assert all(one.meaning[:1].strip() and one.meaning[-1] != "." for _, one in declare.keys(kind)), kind
        for each in {kind, *(one.of for _, one in declare.keys(kind) if one.of)}:  # doctest does not look into these
            computed = [one for one in vars(each).values() if isinstance(one, declare.ComputedField)]
            assert not [one.name for one in computed if ">>>" in (one.__doc__ or "")], each


def test_every_result_shows_itself_and_has_a_picture_or_says_that_it_has_none():
    found = kinds()
    assert len(found) >= 16
    for kind in found:
        assert issubclass(kind, ShownResult), kind
        assert kind.__repr__ is ShownResult.__repr__, kind
        for walk in ("highlights", "columns", "units", "content"):
            assert getattr(kind, walk) is getattr(ShownResult, walk), f"{kind}: {walk} is made from what fields declare"
        if kind.drawing:
            module = importlib.import_module(f"{kind.__module__.rpartition('.')[0]}.{kind.drawing}")
            assert callable(module.picture) or kind in module.picture, kind
        else:
            assert kind.command == "deck"


@pytest.fixture(scope="module")
def run():
    return strikewave.run_case(strikewave.load_case("li-ma-2019"))


class Checked(HTMLParser):
    """Reads a page and holds its tags; every tag that opens is closed."""

    def __init__(self, page):
        super().__init__()
        self.open, self.tags = [], []
        self.feed(page)
        assert not self.open

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)
        if tag not in ("br", "line", "polyline"):
            self.open.append(tag)

    def handle_endtag(self, tag):
        if tag not in ("line", "polyline"):
            assert self.open.pop() == tag


def test_a_run_is_one_line(run):
    text = repr(run)
    assert text.startswith("<Solution li-ma-2019: blows 11, first rigid peak 4151 g, first pulse width 200.0 µs")
    assert len(text) < 120
    assert "\n" not in text


def test_a_failed_check_stands_in_the_line_and_on_the_page(run):
    broken = Notice("energy-balance", "the energy balance is off", 1.0, 1e-6, FAILED)
    failed = dataclasses.replace(run, notices=(broken,))
    assert "check failed: energy-balance" in repr(failed)
    assert "check failed: energy-balance" in failed._repr_html_()


@pytest.mark.verify
def test_a_notebook_shows_numbers_curve_and_blows_with_no_script_and_no_matplotlib(run):
    page = run._repr_html_()
    tags = Checked(page).tags
    assert "script" not in tags
    assert tags.count("svg") == 1
    assert tags.count("tr") == 1 + len(run.highlights()) + 1 + len(run.blows)
    assert "rigid peak (g)" in page
    assert "4151" in page
    program = (
        "import sys, strikewave; result = strikewave.run_case(strikewave.load_case('li-ma-2019', ['feed.blows=1']));"
        "result._repr_html_(), repr(result), result.to_dataframe(); sys.exit('matplotlib' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", program], check=False).returncode == 0


def test_what_a_user_typed_is_no_markup_in_a_notebook(run):
    case = run.case.model_copy(update={"name": "<b>x</b>", "title": "<script>alert(1)</script>"})
    page = dataclasses.replace(run, case=case)._repr_html_()
    assert "<script" not in page
    assert "&lt;script&gt;" in page


def test_a_long_table_is_cut_in_a_notebook_and_whole_in_a_dataframe(run):
    many = dataclasses.replace(run, blows=run.blows * 3, readings=run.readings * 3)
    page = many._repr_html_()
    assert "21 more rows" in page
    assert len(many.to_dataframe()) == 33


def test_the_dataframe_holds_the_blows_in_si_with_units_and_as_the_file_has_them(run):
    table = run.to_dataframe()
    for place, blow in enumerate(run.blows):
        for name in ("index", "kind", "time", "rigid_peak", "width", "velocity_change", "contacts"):
            assert table[name][place] == getattr(blow, name)
    assert table.attrs["units"]["rigid_peak"] == "m/s^2"
    assert table.attrs["units"]["width"] == "s"
    assert "kind" not in table.attrs["units"]
    heads = run.tables()["blows.csv"].splitlines()[0].split(",")
    assert [head.partition(" [")[0] for head in heads] == list(table.columns)


def test_units_chosen_hold_for_line_and_notebook_but_not_for_the_dataframe(run):
    with showing(ShownUnits.read("m/s^2,ms")):
        assert "first rigid peak 40710 m/s²" in repr(run)
        assert "rigid peak (m/s²)" in run._repr_html_()
        assert run.to_dataframe()["rigid_peak"][0] == run.blows[0].rigid_peak


def test_the_curve_of_a_run_has_the_peak_and_the_width_of_its_first_blow(run):
    curve, first = run.preview(), run.blows[0]
    peak = first.rigid_peak / 9.80665
    assert curve.y.max() == pytest.approx(peak, rel=1e-3)  # the nearest of 1000 samples and more over the pulse
    below = np.flatnonzero(curve.y < 0.1 * peak)
    top = int(curve.y.argmax())
    begin, end = curve.x[below[below < top].max(initial=0)], curve.x[below[below > top].min()]
    assert end - begin == pytest.approx(first.width * 1e6, abs=2.0 * (curve.x[1] - curve.x[0]))


def test_a_curve_is_drawn_to_scale_with_its_peak_however_many_samples_it_has():
    x = np.linspace(0.0, 10.0, 100_001)
    y = np.zeros_like(x)
    y[70_000] = 5.0
    drawing = ElementTree.fromstring(_svg(Curve(x, y, "time (s)", "a <b> & c")))
    points = drawing.find("polyline").attrib["points"].split()
    across, down = np.array([[float(v) for v in point.split(",")] for point in points]).T
    assert len(points) < 500
    assert across[np.argmin(down)] == pytest.approx(34 + 0.7 * (420 - 68), abs=1.0)  # a column of it is 1.7 wide
    assert down.min() == pytest.approx(34.0, abs=0.1)
    assert "a <b> & c: to 5" in "".join(drawing.itertext())


def test_the_picture_is_that_of_the_command(run):
    assert [axes.get_title(loc="left") for axes in run.plot().axes][2] == "Rigid-body acceleration, whole train"


@pytest.mark.verify
def test_the_report_is_that_of_the_command_whole_and_nothing_beside_it(run, tmp_path):
    from strikewave.analyses.machine.report import report

    place = run.report(tmp_path / "run.html")
    assert place == tmp_path / "run.html"
    assert place.read_bytes() == report(run).encode()  # lines end with \n on every system
    assert run.report(str(tmp_path)) == tmp_path / "report.html"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["report.html", "run.html"]


@pytest.mark.usefixtures("undrawn")
def test_a_report_for_a_folder_takes_the_place_of_no_page_of_the_users(run, tmp_path):
    (tmp_path / "report.html").write_text("<!doctype html><title>thesis</title>")
    with pytest.raises(InputError, match="cannot be used; needed: a page that strikewave wrote; name the file"):
        run.report(tmp_path)
    assert "thesis" in (tmp_path / "report.html").read_text()
    run.report(tmp_path / "run.html").rename(tmp_path / "report.html")
    assert run.report(tmp_path).name == "report.html"  # it takes the place of the first: strikewave wrote it


@pytest.mark.parametrize("name", ["run.pdf", "run", "nowhere/run.html"])
def test_a_report_elsewhere_is_refused_in_one_line(run, tmp_path, name):
    with pytest.raises(InputError, match=r"ends in \.html") as error:
        run.report(tmp_path / name)
    assert "\n" not in str(error.value)
    assert not list(tmp_path.iterdir())


def test_a_table_within_a_row_is_spread_and_a_list_left_out():
    columns = columns_of_mappings(
        [{"a": 1, "b": {"c": 2.0, "d": {"e": 3.0}}, "f": [1, 2]}, {"a": 2}], {"c": "N", "b.d.e": "m"}
    )
    assert [tuple(column[:3]) for column in columns] == [
        ("a", [1, 2], ""),
        ("b.c", [2.0, None], "N"),
        ("b.d.e", [3.0, None], "m"),
    ]


def test_a_result_without_a_table_or_picture_says_so(run):
    class Bare(type(run)):
        drawing = ""

        def columns(self):
            return []

    bare = Bare(**{field.name: getattr(run, field.name) for field in dataclasses.fields(run)})
    with pytest.raises(StrikewaveError, match="Bare has no picture"):
        bare.plot()
    with pytest.raises(StrikewaveError, match="Bare has no table"):
        bare.to_dataframe()
