"""Where things stand on the pages, seen by a browser: data first, nothing cut on a phone, all of it in print."""

import dataclasses
import html
import json
import re
import subprocess

import numpy as np
import pytest

from strikewave import load_case, run_case, run_fem, run_hopkinson, run_wave
from strikewave.analyses.fem.report import fem_report
from strikewave.analyses.hopkinson.build import load_setup
from strikewave.analyses.hopkinson.report import page as setup_page
from strikewave.analyses.machine.figures.animation import machine_page
from strikewave.analyses.machine.report import report
from strikewave.analyses.record.report import record_report
from strikewave.analyses.record.result import record_result
from strikewave.analyses.wave.report import wave_report
from strikewave.base.result import Band, InputShare
from strikewave.papers.li_ma_2019.report import reproduction_report
from strikewave.papers.li_ma_2019.reproduce import reproduce
from strikewave.papers.li_ma_2019.runs import Effort
from strikewave.records.campaign import compare, summed
from strikewave.records.readers import read_record
from strikewave.records.reading import Request, read_file
from strikewave.reporting.bands import band_sections, band_words
from strikewave.reporting.chapters import Head, whole_page
from strikewave.reporting.parts import Formula, Section, Table, Tag

from ..analyses.hopkinson.test_hopkinson_command import SETUP
from ..chromium import chromium
from ..hopkinson import bench

KINDS = ["machine", "bar", "drop", "fem", "record", "shot", "paper"]
FIRST_SCREEN = 900
"""Pixels of a page 1280 wide within which the whole of the first data plot lies."""
LEGIBLE = 8.0
"""Least height of letters of a figure on a phone, pixels, be it scrolled or not."""
OPEN = "for (const one of document.querySelectorAll('details')) one.open = true;"
MEASURES = """
const box = (element) => element.getBoundingClientRect();
const letters = (svg) => [...svg.querySelectorAll("text")].filter((text) => text.textContent.trim()).map((text) => {
  const m = text.getScreenCTM();
  return parseFloat(getComputedStyle(text).fontSize) * Math.sqrt(Math.abs(m.a * m.d - m.b * m.c));
});
const inside = (element) => element.closest(".scroll, .drawing, pre, svg, .skip");
document.body.dataset.answers = JSON.stringify({
  first: (document.querySelector(".picture svg") && box(document.querySelector(".picture svg")).bottom) ?? null,
  across: document.documentElement.scrollWidth,
  letters: Math.min(...[...document.querySelectorAll(".picture svg")].flatMap(letters)),
  beyond: [...document.querySelectorAll("main *")].filter((e) => !inside(e) && box(e).right > innerWidth + 1).length,
  hinted: [...document.querySelectorAll(".table .scroll")].filter((e) => e.clientWidth).map((e) =>
    [e.scrollWidth > e.clientWidth + 1,
      parseFloat(getComputedStyle(e.parentElement.querySelector("figcaption"), "::after").fontSize) > 0]),
  canvases: Math.max(0, ...[...document.querySelectorAll("canvas")].map((canvas) => box(canvas).bottom)),
  controls: document.getElementById("controls") && box(document.getElementById("controls")).bottom,
});
"""


def seen(page, tmp_path, width, height):
    """Return what a browser measures of a page at rest; its policy is taken out for the script that measures.

    Hints of scrolling follow the frames drawn, which a busy machine may draw late: the last of many measures counts.
    """
    place = tmp_path / "page.html"
    text = re.sub(r'<meta http-equiv="Content-Security-Policy"[^>]*>', "", page)
    place.write_text(
        text.replace("</body>", f"<script>{OPEN}setInterval(() => {{{MEASURES}}}, 100)</script></body>"), "utf-8"
    )
    options = ["--no-sandbox", "--hide-scrollbars", "--force-prefers-reduced-motion", "--dump-dom"]
    options += ["--virtual-time-budget=2000", f"--window-size={width},{height}"]
    done = subprocess.run([chromium(), *options, place.as_uri()], check=True, capture_output=True, timeout=60)
    return json.loads(html.unescape(re.search(r'data-answers="([^"]*)"', done.stdout.decode())[1]))


@pytest.fixture(scope="module")
def shot(tmp_path_factory):
    """The page of an elastic shot of bars whose answer is known."""
    place = tmp_path_factory.mktemp("shot")
    bars, specimen, (incident, transmitted), _ = bench.bench()
    columns = np.column_stack([1e6 * incident.time, 1e6 * incident.strain, 1e6 * transmitted.strain])
    heads = "time [us],incident [ustrain],transmitted [ustrain]"
    np.savetxt(place / "shot.csv", columns, "%.9g", ",", header=heads, comments="", encoding="utf-8")
    first, second = (bar.gauge_distance for bar in bars)
    striker = 90e-6 * bars[0].speed / 2.0
    setup = SETUP.format(first=first, second=second, length=specimen.length, striker=striker)
    (place / "shot.toml").write_text(setup, "utf-8")
    return setup_page(run_hopkinson(load_setup(str(place / "shot.toml"))))


@pytest.fixture(scope="module")
def pages(solution, shot, measured):
    bar = run_wave(load_case("li-ma-2019-fig13-bar"))
    drop = run_case(load_case("jesd22-b111-b"))
    files = sorted(measured("smd-5kg-impacts").glob("*.lvm"))
    readings = compare([read_file(read_record(file), {}, Request(("1",), {"all": {"unit": "g"}})) for file in files])
    return {
        "machine": report(solution),
        "bar": wave_report(bar),
        "drop": report(drop),
        "fem": fem_report(run_fem(load_case("two-bars-fem"))),
        "record": record_report(record_result(readings, [summed(readings)])),
        "shot": shot,
        "paper": reproduction_report(reproduce(Effort(elements=False, studies=False))),
    }


def test_pictures_of_data_come_before_tables_and_inputs_are_folded(solution):
    page = report(solution)
    titles = re.findall(r'<li><a href="#section-\d+">(.*?)</a>', page)
    wanted = ["Pulses", "Blows", "Comparison with published values", "Warnings", "Set-up", "Inputs"]
    assert [title for title in titles if title in wanted] == wanted
    assert page.index('<figure class="picture') < page.index('<figure class="table')
    folded = page.index("<details><summary>Show")
    assert page.index(">Inputs</h2>") < folded < page.index("[machine]") < page.index("</details>", folded)


def test_a_band_stands_in_brackets_with_what_it_depends_on():
    inputs = (InputShare("machine.engagement", 0.62), InputShare("object.frame_stiffness", 0.2))
    bands = {"first.rigid_peak": Band(7850.0, 15400.0, 0.95, inputs), "interval": Band(0.0198, 0.0203, 0.95)}
    (words,) = band_words(bands)
    assert "the model's own error is not in it" in words
    assert "machine.engagement (62 %) and object.frame_stiffness (20 %)" in words
    solution = run_case(load_case("jesd22-b111-b"))
    (section,) = band_sections(dataclasses.replace(solution, band=bands))
    first, interval = section.parts[0].rows
    assert first[:3] == ["rigid peak of the first blow", "800 to 1600 g", "machine.engagement 62 %"]
    assert interval == ["interval of the blows, median", "19.80 to 20.30 ms", "–", "–", "–"]
    assert band_words({}) == []
    assert band_sections(solution) == []
    head = Head("t", "", "Case", "", "", Tag("ok"), [words], [("first peak", "1200 g (800 to 1600 g)")], "")
    assert "<dd>1200\xa0g <small>(800\xa0to 1600\xa0g)</small></dd>" in whole_page(head, [])


def test_a_formula_is_typeset_without_script_and_its_text_is_escaped():
    formula = Formula(r"\text{a<b>} \frac{1}{2}", '"<i>')
    page = whole_page(
        Head("t", "", "", "", "", Tag(""), [], [], ""), [Section("s", "", [Table("f", ["f"], [[formula]])])]
    )
    assert "<mfrac><mrow><mn>1</mn></mrow><mrow><mn>2</mn></mrow></mfrac>" in page
    assert 'alttext="&quot;&lt;i&gt;"' in page
    assert "<b>}" not in page
    assert "a&lt;b&gt;" in page


@pytest.mark.verify
@pytest.mark.parametrize("kind", KINDS)
def test_the_first_data_plot_lies_on_the_first_screen(pages, kind, tmp_path):
    assert seen(pages[kind], tmp_path, 1280, 900)["first"] <= FIRST_SCREEN


@pytest.mark.verify
@pytest.mark.parametrize("width", [390, 768, 1280])
@pytest.mark.parametrize("kind", KINDS)
def test_nothing_is_cut_at_any_width(pages, kind, width, tmp_path):
    """Only boxes scroll, and a table says so; letters of figures stay legible."""
    found = seen(pages[kind], tmp_path, width, 844)
    assert found["across"] <= width
    assert found["beyond"] == 0
    assert found["letters"] >= LEGIBLE
    assert all(scrolls == hint for scrolls, hint in found["hinted"])


@pytest.mark.verify
@pytest.mark.parametrize("size", [(1280, 720), (390, 844)])
def test_an_animation_and_its_controls_are_in_view_together(solution, size, tmp_path):
    found = seen(machine_page(solution), tmp_path, *size)
    assert 0 < found["canvases"] < found["controls"] <= size[1]


@pytest.mark.verify
def test_print_shows_what_is_folded(pages, tmp_path):
    """The text of the PDF holds a value of the inputs, which begin folded away."""
    (tmp_path / "page.html").write_text(pages["machine"], "utf-8")
    folded = re.sub(r"details::details-content[^}]*}", "", pages["machine"])
    (tmp_path / "folded.html").write_text(folded, "utf-8")
    sizes = []
    for name in ("page", "folded"):
        options = ["--no-sandbox", "--no-pdf-header-footer", f"--print-to-pdf={tmp_path / name}.pdf"]
        place = (tmp_path / f"{name}.html").as_uri()
        subprocess.run([chromium(), *options, place], check=True, capture_output=True, timeout=60)
        sizes.append(len(re.findall(rb"/Type /Page\b", (tmp_path / f"{name}.pdf").read_bytes())))
    assert sizes[0] >= sizes[1] + 2  # two pages of inputs at least
