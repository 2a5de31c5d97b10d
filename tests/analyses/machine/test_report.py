"""The report of a run: one page, whole, offline, escaped, complete, and the same bytes each time."""

import dataclasses
import hashlib
import math
import re
from html.parser import HTMLParser
from types import SimpleNamespace

import numpy as np
import pytest
from matplotlib.figure import Figure

from strikewave import load_case, run_case, run_wave
from strikewave.analyses.machine.figures.pulses import drawn_blows, rigid_acceleration, whole_train
from strikewave.analyses.machine.report import report
from strikewave.analyses.machine.result import load_solution
from strikewave.analyses.wave.report import wave_report
from strikewave.base import citations
from strikewave.base.declare import declarations
from strikewave.base.quantities import PROVENANCES
from strikewave.base.result import FAILED, Notice
from strikewave.base.units import in_unit
from strikewave.cases.case import dump_case, parse_case
from strikewave.machines import Blow
from strikewave.reporting.chapters import inline_svg
from strikewave.reporting.numbers import in_shown_units
from strikewave.reporting.parts import Code, Flow, Picture, Section, Table, Tag
from strikewave.reporting.style import MOST_PULSES, thin

VOID = {"meta", "br", "hr", "img", "input", "link", "wbr"}
LARGEST = 3_000_000
"""Bytes; asked of the report so that it can be sent by mail."""


class Page(HTMLParser):
    """Reads a page strictly: every tag is closed in order, no attribute comes twice."""

    def __init__(self, text):
        super().__init__(convert_charrefs=True)
        self.open, self.tags, self.ids, self.links, self.styles = [], [], [], [], []
        self.words, self.svg_words = [], []
        self.feed(text)
        self.close()
        assert self.open == []

    def handle_starttag(self, tag, attrs):
        if tag not in VOID:
            self.open.append(tag)
        self._seen(tag, attrs)

    def handle_startendtag(self, tag, attrs):
        assert "svg" in self.open or tag in VOID
        self._seen(tag, attrs)

    def _seen(self, tag, attrs):
        names = [name for name, _ in attrs]
        assert len(names) == len(set(names)), (tag, names)
        found = dict(attrs)
        self.tags.append((tag, found))
        self.ids += [found["id"]] if "id" in found else []
        self.links += [found[name] for name in ("href", "src", "xlink:href") if name in found]
        assert not any(name.startswith("on") for name in names), (tag, names)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        (self.styles if self.open[-1:] == ["style"] else self.svg_words if "svg" in self.open else self.words).append(
            data
        )

    @property
    def text(self):
        return " ".join(" ".join(self.words).split())


def tables(text):
    """Return caption -> rows of cell texts."""
    found = {}
    for block in re.findall(r'<figure class="table".*?</figure>', text, re.S):
        caption = re.search(r"</b> (.*?)</figcaption>", block)[1]
        rows = re.findall(r"<tr>(.*?)</tr>", block, re.S)
        cells = [
            [re.sub(r"<[^>]*>", "", c) for c in re.findall(r"<t[hd][^>]*>(.*?)</t[hd]>", row, re.S)] for row in rows
        ]
        found[caption] = cells
    return found


@pytest.fixture(scope="module")
def page(solution):
    return report(solution)


def test_page_is_well_formed_and_its_identifiers_are_unique(page):
    read = Page(page)
    assert len(read.ids) == len(set(read.ids))
    names = [tag for tag, _ in read.tags]
    for once in ("html", "head", "title", "body", "main", "nav", "h1"):
        assert names.count(once) == 1, once
    assert "script" not in names
    assert page.startswith("<!doctype html>\n<html lang=")
    heads = [int(tag[1]) for tag in names if re.fullmatch("h[1-6]", tag)]
    assert set(heads) == {1, 2}


def test_links_of_the_page_lead_to_something(page):
    read = Page(page)
    inner = {link[1:] for link in read.links if link.startswith("#")}
    inner |= set(re.findall(r"url\(#([^)]+)\)", page))
    labels = {word for _, found in read.tags for word in found.get("aria-labelledby", "").split()}
    assert inner | labels <= set(read.ids)


def test_page_works_offline(page):
    """Nothing is fetched: the only addresses are DOIs of cited sources, which a reader may follow."""
    read = Page(page)
    for link in read.links:
        assert link.startswith(("#", "data:", "https://doi.org/10.")), link
    without = re.sub(r'href="https://doi\.org/10\.[^"]*"', "", page)
    assert "http:" not in without
    assert "https:" not in without
    style = "".join(read.styles)
    assert "@import" not in style
    assert "url(" not in style
    assert not {"link", "img", "iframe", "object", "base"} & {tag for tag, _ in read.tags}
    policy = next(found["content"] for _, found in read.tags if found.get("http-equiv") == "Content-Security-Policy")
    assert policy.startswith("default-src 'none'")


def test_same_input_gives_the_same_bytes(solution, page):
    assert report(solution) == page


@pytest.mark.verify
def test_a_solution_read_back_gives_the_same_report(solution, page, tmp_path):
    solution.save(tmp_path / "solution.nc")
    assert report(load_solution(tmp_path)) == page


def test_head_names_case_version_and_digest(solution, page):
    digest = hashlib.sha256(dump_case(solution.case).encode()).hexdigest()
    assert f'<code title="{digest}">{digest[:16]}</code>' in page
    assert f"strikewave {__import__('strikewave').__version__}" in page
    text = Page(page).text
    first = solution.blows[0]
    assert f"{len(solution.blows)} blows, all full, 20.60 ms apart" in text
    assert f"{first.rigid_peak / 9.80665:.0f} g" in text
    assert f"{first.velocity_change:.3g} m/s" in text


def test_every_number_of_the_table_of_blows_is_there(solution, page):
    rows = tables(page)["Blows"][1:]
    assert len(rows) == len(solution.blows)
    columns = {
        name: one.quantity
        for name, one in declarations(Blow).items()
        if "blows" in one.tables.split() and one.kind == "number"
    }
    assert [*columns][:4] == ["time", "approach_speed", "impulse", "peak_force"]
    for blow, row in zip(solution.blows, rows, strict=True):
        numbers = [f"{in_unit(getattr(blow, name), q.si, q.usual):.{q.decimals}f}" for name, q in columns.items()]
        assert row == [str(blow.index), blow.kind, *numbers, str(blow.contacts)]
    assert tables(page)["Blows"][0][2:5] == ["time (ms)", "approach speed (m/s)", "impulse (N s)"]


def test_every_value_stands_with_provenance_and_note(solution, page):
    found = {}
    for caption, rows in tables(page).items():
        if caption.startswith("["):
            path = caption[1:].partition("]")[0]
            found |= {f"{path}.{row[0]}": row[1:] for row in rows[1:]}
    values = solution.case.values()
    assert len(values) >= 40
    for path, value in values.items():
        note = value.note.replace("'", "&#39;") or "–"
        assert found[path] == [str(value.typed), value.provenance, note], path
    counted = {row[0]: int(row[1]) for row in tables(page)["Where the values come from"][1:]}
    assert counted == {p: sum(v.provenance == p for v in values.values()) for p in PROVENANCES}
    text = Page(page).text
    for path in solution.case.fitted_fields():
        assert f"{path} = {values[path].typed}" in text


def test_published_numbers_stand_beside_computed_ones(solution, page):
    rows = tables(page)["Comparison with published values"][1:]
    assert len(rows) == len(solution.published)
    for entry, row in zip(solution.published, rows, strict=True):
        assert row[4:6] == [entry.measured_or_simulated, entry.role]
        assert row[3] == f"{entry.difference * 100:+z.1f} %"
    assert rows[0][1:3] == ["4151.25", "4151.25"]


def test_warnings_balances_masses_phases_and_sources_are_listed(solution, page):
    read, found = Page(page), tables(page)
    for notice in solution.warnings:
        row = next(r for r in found["Warnings; value and limit in SI units"] if r[0] == notice.code)
        assert row[2:4] == [f"{notice.value:.6g}", f"{notice.limit:.6g}"]
        assert in_shown_units(notice.message) in read.text
    assert [row[0] for row in found["Masses"][1:]] == list(solution.masses)
    assert [row[0] for row in found["Phases, from the valve signal"][1:]] == [name for name, _ in solution.phases]
    assert [row[3] for row in found["Balances"][1:]] == ["holds", "holds"]
    for key in solution.citations:
        assert citations.citation(key).partition(", doi:")[0] in read.text
        assert citations.citation(key).rpartition("doi:")[2] in read.text
    assert "strikewave run li-ma-2019" in page


def test_whole_case_file_can_be_taken_from_the_page(solution, page):
    class Pre(HTMLParser):
        found, inside = "", False

        def handle_starttag(self, tag, attrs):
            self.inside = tag == "pre"
            self.found = "" if self.inside else self.found

        def handle_endtag(self, tag):
            self.inside = False if tag == "pre" else self.inside

        def handle_data(self, data):
            self.found += data if self.inside else ""

    last = Pre()
    last.feed(page)
    assert parse_case(last.found.removeprefix("\n")) == solution.case


HOSTILE = "</title><script>alert('1')</script>\" onload=\"x &amp; <b> \x01\u202e {{ 7 * 7 }}"


def test_hostile_words_come_out_as_text(solution):
    """Titles, notes, messages, captions, cells, labels and code of a stranger; jinja's own marks too."""
    case = solution.case
    mass = case.object.mass.model_copy(update={"note": HOSTILE})
    case = case.model_copy(
        update={
            "title": HOSTILE,
            "object": case.object.model_copy(update={"mass": mass, "material": HOSTILE}),
            "published": (case.published[0].model_copy(update={"note": HOSTILE}),),
        }
    )
    figure = Figure(figsize=(3, 2))
    figure.add_subplot().set_title(HOSTILE.replace("$", ""))
    hostile = dataclasses.replace(
        solution,
        case=case,
        sampled={},
        notices=(Notice(HOSTILE, HOSTILE, 1.0, 2.0),),
        phases=((HOSTILE, 0.0),),
        masses={HOSTILE: 1.0},
        balance={HOSTILE: 0.0},
        citations=(HOSTILE,),
        comparisons=tuple(dataclasses.replace(entry, note=HOSTILE, role=HOSTILE) for entry in solution.published),
    )
    extra = Section(
        HOSTILE,
        HOSTILE,
        [
            Table(HOSTILE, [HOSTILE], [[HOSTILE], [Tag(HOSTILE, HOSTILE)]]),
            Table(HOSTILE, [HOSTILE], [], empty=HOSTILE),
            Picture(figure, HOSTILE, HOSTILE),
            Flow([HOSTILE], HOSTILE),
            Code(HOSTILE, HOSTILE),
            Code(HOSTILE),
        ],
    )
    page = report(hostile, [extra])
    read = Page(page)
    assert "script" not in {tag for tag, _ in read.tags}
    assert "<script" not in page
    assert "alert(" in read.text
    assert read.text.count("{{ 7 * 7 }}") >= 10
    assert "<b> \ufffd\u202e 49" not in read.text
    assert "\x01" not in page
    title = re.search(r"<title>(.*?)</title>", page, re.S)[1]
    assert title.startswith("&lt;/title&gt;&lt;script&gt;")
    assert any("alert(" in words for words in read.svg_words)


@pytest.mark.usefixtures("undrawn")
def test_sections_of_the_caller_are_shown_in_order_and_counted(solution):
    figure = Figure(figsize=(9, 3))
    figure.add_subplot().plot([0, 1], [0, 1])
    sections = [
        Section(
            "Sensors", "First.\n\nSecond.", [Table("Peaks", ["sensor", "peak (g)"], [["a", 4151.25], ["b", math.nan]])]
        ),
        Section("Waves", parts=[Picture(figure, "A wave.")]),
    ]
    page = report(solution, sections)
    read = Page(page)
    contents = re.findall(r'<li><a href="#section-\d+">(.*?)</a>', page)
    assert contents[:4] == ["Pulses", "Sensors", "Waves", "Blows"]
    assert tables(page)["Peaks"] == [["sensor", "peak (g)"], ["a", "4151"], ["b", "–"]]
    assert "<p>First.</p>\n<p>Second.</p>" in page
    numbers = [int(n) for n in re.findall(r"<b>Figure (\d+)\.</b>", page)]
    assert numbers == list(range(1, 8))  # four of the pulses, one of the caller, two drawings
    svgs = [found for tag, found in read.tags if tag == "svg"]
    assert len(svgs) == 7
    assert all(found["role"] == "img" and found["aria-label"] for found in svgs)
    assert len(re.findall("<figcaption>", page)) >= 5
    assert len(read.ids) == len(set(read.ids))


def test_pictures_share_no_identifier():
    """The same figure twice: clip paths and markers would be taken from the other one."""
    figure = Figure(figsize=(3, 2))
    figure.add_subplot().plot([0, 1, 2], [0, 5, 0], "o-")
    one, two = inline_svg(figure, "p1", "x"), inline_svg(figure, "p2", "x")
    names = [set(re.findall(r'\bid="([^"]+)"', text)) for text in (one, two)]
    assert names[0]
    assert not names[0] & names[1]
    for text, own in zip((one, two), names, strict=True):
        used = re.findall(r'url\(#([^)]+)\)|href="#([^"]+)"', text)
        assert used
        assert {a or b for a, b in used} == own
    assert inline_svg(figure, "p1", "x") == one
    for mark in ("<?xml", "<!DOCTYPE", "<metadata", "<style", "xmlns", "http"):
        assert mark not in one
    assert "DejaVu Sans" in one


@pytest.mark.usefixtures("undrawn")
def test_solution_without_any_blow_says_so(solution):
    none = dataclasses.replace(
        solution,
        blows=(),
        comparisons=(),
        notices=(Notice("no-blow", "no striker touched the object", 0.0, 1.0, severity=FAILED),),
        citations=(),
        masses={},
        phases=(),
        balance={},
    )
    page = report(none)
    text = Page(page).text
    for words in (
        "No blow: no striker touched the object. There is no pulse to measure.",
        "No blow: no striker passed the object.",
        "there is no pulse to show",
        "No balance was computed.",
        "No mass is listed.",
        "No phase is listed.",
        "No source is named.",
        "check failed: no-blow",
    ):
        assert words in text
    assert "Comparison with published values" not in text
    assert page.count("<svg") == 3  # the train and two drawings


@pytest.mark.usefixtures("undrawn")
def test_histories_may_be_missing(solution):
    """What is not there is said in words."""
    bare = dataclasses.replace(solution, sampled={}, notices=())
    page = report(bare)
    text = Page(page).text
    assert "No warning was raised." in text
    assert "all checks passed" in text
    assert "Without the history time and rigid_acceleration there is no picture" in text
    assert page.count("<svg") == 2  # the drawings, which take only the case


@pytest.mark.verify
def test_missed_and_odd_blows_are_visible(solution):
    missing = {
        f.name: math.nan
        for f in dataclasses.fields(solution.blows[0])
        if f.name not in ("index", "kind", "striker", "time")
    }
    blows = list(solution.blows)
    blows[0] = dataclasses.replace(blows[0], **{**missing, "contacts": 0}, kind="missed")
    blows[2] = dataclasses.replace(blows[2], kind="glancing")
    blows[4] = dataclasses.replace(blows[4], kind="double", width=0.0)
    odd = dataclasses.replace(solution, blows=tuple(blows))
    page = report(odd)
    rows = tables(page)["Blows"][1:]
    assert [row[1] for row in rows[:5]] == ["missed", "full", "glancing", "full", "double"]
    assert rows[0][3:10] == ["–"] * 7
    for kind in ("missed", "glancing", "double"):
        assert f'<span class="tag {kind}">{kind}</span>' in page
    assert "10 blows, among 11 passes 1 missed, 1 glancing and 1 double" in Page(page).text
    assert "blow 2" in Page(page).text  # the first that struck is the one drawn


def test_thinned_history_keeps_every_peak(rng):
    """Each column keeps its smallest and largest sample; spikes one sample wide included."""
    time_axis = np.arange(28_391) * 1e-5
    values = rng.normal(size=time_axis.size)
    values[rng.choice(values.size, 11)] = 1000.0
    values[-1] = -77.0
    kept_time, kept = thin(time_axis, values)
    assert kept.size <= 2 * 1400 + 3
    assert np.count_nonzero(kept == 1000.0) >= min(11, np.count_nonzero(values == 1000.0)) - 1
    assert (kept.min(), kept.max()) == (values.min(), values.max())
    assert np.all(np.diff(kept_time) > 0.0)
    assert kept_time[-1] == time_axis[-1]


def test_size_stays_small(page):
    assert len(page.encode()) < LARGEST / 10


@pytest.mark.verify
def test_a_thousand_blows_stay_below_the_largest_size(solution):
    """The most blows that a case may ask for: the table holds all, the overlay a choice."""
    many = 1000
    rows = np.arange(many) % len(solution.blows)
    blows = tuple(dataclasses.replace(solution.blows[row], index=i + 1) for i, row in enumerate(rows))
    data = {name: solution.data[name] for name in ("time", "rigid_acceleration", "pulse_time")}
    for name in ("pulse_force", "pulse_acceleration"):
        data[name] = SimpleNamespace(values=solution.data[name].values[rows])
    long = dataclasses.replace(solution, blows=blows, sampled=data)
    assert len(drawn_blows(long)) <= MOST_PULSES
    page = report(long)
    assert len(tables(page)["Blows"]) == many + 1
    assert len(page.encode()) < LARGEST
    assert "20 of 1000 are drawn" in page


STACK = """
schema = 1
name = "bar"
title = "A bar alone"
[[stack.layer]]
name = "upper"
material = "65Mn"
length = { value = "80 mm", provenance = "measured", note = "calliper" }
diameter = "20 mm"
[[stack.layer]]
name = "lower"
material = "65Mn"
length = "40 mm"
diameter = "20 mm"
[[stack.joint]]
after = "upper"
kind = "compliant"
stiffness = "1 GN/m"
[load]
shape = "half-sine"
peak = "20 kN"
duration = "50 us"
[solver]
duration = "200 us"
"""


@pytest.mark.verify
def test_a_stack_without_machine_has_a_report_too():
    """Its values come in arrays of tables; there is no blow to speak of."""
    page = wave_report(run_wave(parse_case(STACK)))
    read = Page(page)
    titles = ["Stress waves", "Peak values", "Warnings", "Set-up", "Inputs"]
    assert re.findall(r'<li><a href="#section-\d+">(.*?)</a>', page)[:5] == titles
    layers = {row[0]: row[1:] for row in next(v for k, v in tables(page).items() if k.startswith("[stack.layer]"))[1:]}
    assert layers["upper.length"] == ["80 mm", "measured", "calliper"]
    assert layers["lower.length"][:2] == ["40 mm", "user"]
    steps = re.findall(r"<li>([^<]*)</li>", page)
    assert steps[:4] == ["upper", "compliant joint", "lower", "free end"]
    assert "A layered bar under its load" in read.text
    assert "strikewave wave case.toml" in page


def test_a_long_pulse_is_drawn_whole_and_marked_at_its_peak():
    """11 ms on a spring of 1.655 kN/mm: the window lasts as long as the pulse, and the mark stands within it."""
    spring = (
        "contact.law=power",
        "contact.exponent=1",
        "contact.reference_force=1655 N",
        "contact.reference_depth=1 mm",
    )
    solution = run_case(
        load_case("jesd22-b111-b", [*spring, "machine.height=143.8 mm", "machine.follow=30 ms"]), band=False
    )
    time, values = rigid_acceleration(solution).axes[0].lines[0].get_data()
    blow = solution.blows[0]
    assert time[-1] == pytest.approx(2.2e6 * blow.width, rel=1e-3)
    assert np.max(values) == pytest.approx(in_unit(blow.rigid_peak, "m/s^2", "g"), rel=1e-4)
    assert max(solution.preview().x) * 1e-3 == pytest.approx(2.2 * blow.width, rel=1e-2)
    # within a tenth of a width of its middle: a half-sine
    mark = whole_train(solution).axes[0].lines[1].get_xdata()[0]
    assert mark * 1e-3 == pytest.approx(blow.time + 0.5 * blow.width, abs=0.1 * blow.width)
