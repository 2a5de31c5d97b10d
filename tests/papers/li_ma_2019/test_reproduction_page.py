"""The report of a reproduced paper: every equation and number is on it, no curve is called measured, nothing escapes."""

import dataclasses
import html
import itertools
import re
import shlex
from html.parser import HTMLParser

import numpy as np
import pytest

from strikewave import load_case
from strikewave.analyses.fem.run import run_fem
from strikewave.base.constants import STANDARD_GRAVITY
from strikewave.base.texts import percent
from strikewave.papers.li_ma_2019 import compared_numbers as known
from strikewave.papers.li_ma_2019 import figures as draw
from strikewave.papers.li_ma_2019 import reproduce as whole_run
from strikewave.papers.li_ma_2019.element_pulses import BodyPulse, element_numbers, rise_slope, struck_body, whole_force
from strikewave.papers.li_ma_2019.figures import PublishedMark
from strikewave.papers.li_ma_2019.published import published_numbers
from strikewave.papers.li_ma_2019.report import (
    again,
    figure_sections,
    key_numbers,
    pictures,
    ratios,
    reproduction_report,
)
from strikewave.papers.li_ma_2019.report_tables import (
    elements_section,
    equation_sections,
    findings_section,
    materials_section,
    provenance_section,
)
from strikewave.papers.li_ma_2019.reproduce import reproduce
from strikewave.papers.li_ma_2019.runs import (
    ELEMENT_CASES,
    QUIET_ELEMENTS,
    QUIET_WAVE_ELEMENTS,
    RIGID_ELEMENTS,
    WAVE_ELEMENTS,
    Effort,
    coarser,
    element_cases,
)
from strikewave.reporting.parts import Tag
from strikewave.reporting.style import Trace

pytestmark = pytest.mark.verify

COMMAND = "strikewave reproduce li-ma-2019 --without elements"


@pytest.fixture(scope="module")
def page(result):
    return reproduction_report(result)


@pytest.fixture(scope="module")
def struck(result):
    """The same with finite-element models, on elements four times as large and for 60 us."""
    short = ["fem.duration=60 us", "fem.frames=0", "compare=true"]
    changes = {name: [*coarser(load_case(name), 4.0), *short] for name in ELEMENT_CASES}
    elements = tuple(run_fem(load_case(name, found)) for name, found in changes.items())
    runs = dataclasses.replace(result.runs, elements=elements, quick=True)
    return dataclasses.replace(
        result, runs=runs, numbers=known.number_rows(published_numbers(), runs, result.unknowns.ranges())
    )


@pytest.fixture(scope="module")
def chapters(struck):
    """Its chapters on the figures of the paper, by their number."""
    return {re.findall(r"\d+", section.title)[0]: section for section in figure_sections(struck)}


class Tables(HTMLParser):
    """Gathers row heads and cells of all tables, and every tag."""

    def __init__(self, text):
        super().__init__()
        self.rows, self.tags, self.inside = [], set(), False
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        self.tags.add(tag)
        if tag == "tr":
            self.rows.append([])
        if tag in ("th", "td"):
            self.rows[-1].append("")
            self.inside = True

    def handle_endtag(self, tag):
        if tag in ("th", "td"):
            self.inside = False

    def handle_data(self, data):
        if self.inside:
            self.rows[-1][-1] += data


def heads(page, columns):
    """Row heads of the tables with so many columns."""
    return [row[0].strip() for row in Tables(page).rows if len(row) == columns]


@pytest.mark.verify
def test_every_equation_stands_once_among_the_formulas_and_once_among_the_numbers(result, page):
    printed = [str(n) for n in range(1, 41)]
    assert sorted(re.findall(r"\d+", row.number)[0] for row in result.equations) == sorted([*printed, "35"])
    formulas, numbers = heads(page, 5), heads(page, 5)
    for row in result.equations:
        assert formulas.count(f"{row.number} {row.what}") == 1
        assert sum(head.startswith(f"{row.number} {row.quantity}") for head in numbers) == 1


def test_every_published_number_stands_once_in_its_table(result, page):
    found = heads(page, 8) + heads(page, 3)
    for row in result.numbers:
        mine = [head for head in found if head.startswith((f"{row.number.name}:", f"{row.number.name},"))]
        assert len(mine) == 1
        assert mine[0].endswith(row.number.where)


def test_every_finding_and_every_check_of_the_numbers_is_on_the_page(result, page):
    text = html.unescape(page)
    assert result.findings
    assert result.checks
    assert all(row.topic in text and row.found in text for row in result.findings)
    assert all(row.what in text and row.note in text for row in result.checks)


def test_no_curve_is_called_measured(result):
    """Only marks may be: the paper publishes numbers, no curves."""
    drawn = [part.figure for section in figure_sections(result) for part in section.parts if hasattr(part, "figure")]
    assert len(drawn) == 11
    for figure in drawn:
        for axes in figure.axes:
            labels = [line.get_label() for line in axes.lines]
            assert not [label for label in labels if "measured" in label or "DYNA" in label]
            levels = [text.get_text() for text in axes.texts if text.get_text().startswith(("measured", "LS-DYNA"))]
            flat = [line for line in axes.lines if np.ptp(np.asarray(line.get_ydata(), dtype=float)) == 0.0]
            assert len(levels) <= len(flat)


def test_levels_and_bars_stand_at_the_published_numbers():
    marks = [
        PublishedMark(4151.25 * STANDARD_GRAVITY, "measured", 200e-6),
        PublishedMark(4374.52 * STANDARD_GRAVITY, "LS-DYNA", 220e-6),
    ]
    axes = draw.pulse_figure("", [], marks, 4e-4).axes[0]
    data = [(np.asarray(line.get_xdata()), np.asarray(line.get_ydata(), dtype=float)) for line in axes.lines]
    assert [y[0] for _, y in data[:2]] == pytest.approx([4151.25, 4374.52], rel=1e-12)
    assert [x.tolist() for x, _ in data[2:]] == [pytest.approx([0.0, 200.0]), pytest.approx([0.0, 220.0])]
    levels, widths = ["measured 4 151.25 g", "LS-DYNA 4 374.52 g"], ["measured 200 µs", "LS-DYNA 220 µs"]
    assert [text.get_text() for text in axes.texts] == [*levels, *widths]
    assert [text.xy for text in axes.texts[2:]] == [(x[-1], y[-1]) for x, y in data[2:]], "at the ends of their bars"


def test_every_trace_is_a_line():
    time = np.linspace(0.0, 1e-4, 11)
    traces = [Trace(f"curve {k}", time, np.full(11, k * STANDARD_GRAVITY)) for k in range(len(draw.CURVES))]
    lines = draw.pulse_figure("", traces, []).axes[0].lines
    assert [line.get_label() for line in lines] == [trace.label for trace in traces]
    assert [line.get_ydata()[0] for line in lines] == [0.0, 1.0, 2.0, 3.0]
    with pytest.raises(ValueError, match="zip"):
        draw.pulse_figure("", [*traces, traces[0]], [])


def test_the_echo_comes_after_twice_the_way_and_is_printed_to_come_after_once(result):
    """The place is passed at x, 2 - x, 2 + x, ...; the paper's equations take the way back for nothing."""
    way = draw.passing_figure(result.runs.passing).axes[0]
    at = {line.get_label(): np.asarray(line.get_ydata(), dtype=float) for line in way.lines}
    x = float(way.lines[1].get_xdata()[0])
    assert at["exact"] == pytest.approx([x, 2 - x, 2 + x, 4 - x, 4 + x, 6 - x])
    assert at["as printed"] == pytest.approx([x, 1.0, 2.0, 3.0, 4.0, 5.0])


def test_simulated_numbers_are_answered_by_the_papers_own_faces_first(struck):
    """Like for like: LS-DYNA had non-reflecting faces, the machine that was measured had none."""
    quiet, others = (QUIET_ELEMENTS, QUIET_WAVE_ELEMENTS), (RIGID_ELEMENTS, WAVE_ELEMENTS)
    seen = set()
    for row in struck.numbers:
        by = [one.by for one in row.computed if one.by in ELEMENT_CASES]
        groups = [name for name, _ in itertools.groupby(by, lambda name: name in quiet)]
        if len(groups) > 1:
            seen.add(row.number.origin)
            assert groups == ([True, False] if row.number.origin == "simulated" else [False, True])
        if by and row.number.origin == "simulated":
            assert row.computed[0].by in quiet
            assert row.best.by in (*quiet, *others)
    assert seen == {"simulated", "measured"}
    assert struck.row(known.DYNA_FORCE).best.by == QUIET_ELEMENTS
    assert struck.row(known.DYNA_WAVE_PEAK).best.by == QUIET_WAVE_ELEMENTS


def test_the_specimen_is_judged_by_the_model_with_the_papers_faces(struck, monkeypatch):
    monkeypatch.setattr(whole_run, "run_all", lambda effort, execution: struck.runs)
    monkeypatch.setattr(whole_run, "run_unknowns", lambda coarse, execution: struck.unknowns)
    found = reproduce(Effort(quick=True)).findings
    text = next(row.found for row in found if row.topic.startswith("mean acceleration of the specimen"))
    peaks = {name: element_numbers(struck.runs.element_solution(name)).mean_peak for name in ELEMENT_CASES[2:]}
    assert f"{peaks[QUIET_WAVE_ELEMENTS] / STANDARD_GRAVITY:.0f} g" in text
    assert not text.startswith(f"{peaks[WAVE_ELEMENTS] / STANDARD_GRAVITY:.0f} g")


@pytest.mark.verify
def test_the_head_has_ranges_and_predictions_alone(result, struck):
    for found in (result, struck):
        words = [label for label, _ in key_numbers(found)]
        assert [value.count(" to ") for _, value in key_numbers(found)] == [0, 1, 1 if found is result else 0]
        assert not [label for label in words if "later" in label or "specimen" in label]
    verdicts = [row.verdict for row in result.equations]
    words = f"equations hold as printed, and {verdicts.count('definition')} definitions"
    assert key_numbers(result)[0] == (words, f"{verdicts.count('right')} of 41")
    fitted = dataclasses.replace(struck.row(known.WAVE_PEAK).computed[0], role="fitted")
    rows = [
        dataclasses.replace(row, computed=(fitted,)) if row.number.name == known.WAVE_PEAK else row
        for row in struck.numbers
    ]
    assert len(key_numbers(dataclasses.replace(struck, numbers=tuple(rows)))) == 2


@pytest.mark.verify
def test_what_the_buffer_does_is_said_from_the_readings(result, chapters):
    """Peaks by those of the solution, ringing by the raw reading: its step, its start, the first blow."""
    solution = result.runs.comparison
    rms = []
    for number in (1, 2):
        values = solution.data[f"reading_{number}"]
        first = values.values[0][np.isfinite(values.values[0])]
        time = solution.data[f"reading_{number}_start"].values[0] + values.attrs["step"] * np.arange(first.size)
        rms.append(np.sqrt(np.mean(first[time > 200e-6] ** 2)) / STANDARD_GRAVITY)
    direct, buffered = (
        next(row.computed for row in solution.published if row.sensor == name) for name in ("direct", "buffered")
    )
    text = chapters["5"].text
    assert (
        f"takes {percent(1.0 - buffered / direct)} off the computed peak, where {percent(1.0 - 6353.22 / 9707.12)}"
        in text
    )
    assert f"reads {rms[1]:.0f} g (root mean square), the direct one {rms[0]:.0f} g" in text
    assert ("does not calm" in text) == (rms[1] >= rms[0])


def test_the_impulse_stands_beside_that_of_half_sines(struck, chapters):
    """2 A T m/pi with 0.459 kg: 2.38 N s of the measured pulse, 2.76 N s of LS-DYNA's."""
    text = chapters["11"].text
    assert "2.38 N s (measured) and 2.76 N s (LS-DYNA)" in text
    for name in (RIGID_ELEMENTS, QUIET_ELEMENTS):
        solution = struck.runs.element_solution(name)
        assert f"{whole_force(solution)[2]:.3g} N s" in text


def test_force_over_mass_is_that_of_whole_bodies(struck, chapters):
    solution = struck.runs.element_solution(QUIET_ELEMENTS)
    peak = next(iter(solution.contacts.values())).peak / solution.run.groups["object"].mass
    lines = {line.get_label(): line for line in chapters["11"].parts[0].figure.axes[0].lines}
    assert max(lines["the same, contact force over mass"].get_ydata()) == pytest.approx(
        peak / STANDARD_GRAVITY, rel=1e-3
    )
    assert {"machine model", "elements", "elements, non-reflecting faces"} < set(lines)


@pytest.mark.verify
def test_pictures_are_named_after_the_figures_of_the_paper(struck):
    names = [name for name, _ in pictures(struck)]
    assert len(names) == len(set(names))
    assert {name.split("-")[1] for name in names} == {"5", "7", "9", "11", "13", "15"}


def test_quick_runs_are_run_again_as_they_were(result):
    """Every option that is printed makes the same case; a quick run changes sizes by itself, no user does."""
    cases = element_cases(Effort(quick=True))
    for case in cases:
        words = shlex.split(again(case, quick=True))
        assert words[:3] == ["strikewave", "fem", case.name]
        assert set(words[3::2]) == {"--set"}
        assert load_case(case.name, words[4::2]) == case
    assert again(result.runs.machine.case, quick=True) == "strikewave run li-ma-2019"
    known = provenance_section(cases).parts[1].rows
    notes = {row[3] for row in known if row[2] == Tag("user", "user")}
    assert notes == {"set by --quick"}


def test_equations_say_what_their_exact_number_is_and_its_unit(result):
    row = dataclasses.replace(
        result.equations[0], printed=2.0, exact=3.0, unit="Pa", basis="round trip", printed_unit="1/Pa"
    )
    own = dataclasses.replace(row, basis="independent", printed_unit="")
    said, given = (part.rows for part in equation_sections((row, own))[0].parts)
    assert [cells[-1] for cells in said] == ["in another unit", "-33.3 %"]
    assert [cells[3] for cells in given] == ["3, round trip", "3"]
    assert given[0][1].startswith("2 ")
    assert "Pa" in given[0][1]
    assert given[1][1] == "2"


@pytest.mark.verify
def test_the_page_puts_no_words_in_the_papers_mouth(struck, page):
    text = elements_section(struck.runs.elements).text
    assert "as in the paper's simulations" not in text
    assert "statements of the paper" not in page
    assert "more equal" not in page


def test_roles_are_those_of_the_cases(result):
    """What a case was fitted to is marked so; what unpublished gaskets and joints leave open is shown, here a range."""
    for solution in (result.runs.machine, result.runs.comparison, result.runs.fixture):
        roles = {(row.published, row.measured_or_simulated, row.quantity): row.role for row in solution.published}
        for (value, origin, _), role in roles.items():
            mine = [
                one.role
                for row in result.numbers
                for one in row.computed
                if row.number.value == pytest.approx(value, rel=1e-12)
                and row.number.origin == origin
                and one.by == solution.case.name
            ]
            assert role in mine or (role, set(mine)) == ("shown", {"range"})
    assert result.row(known.DIRECT_PEAK).best.role == "range"
    assert result.row(known.RIGID_PEAK).best.role == "fitted"


def test_the_overview_shows_only_what_can_be_compared(result):
    shown = ratios(result)
    assert {row.role for row in shown} == {"fitted", "predicted", "range"}
    assert all(abs(row.value - 1.0) < 1e-6 for row in shown if row.role == "fitted")  # by construction
    assert any(abs(row.value - 1.0) > 0.5 for row in shown)  # misses are shown too


def test_materials_are_judged_against_the_printed_ones(result):
    section = materials_section(result.numbers)
    assert [row[-1].text for row in section.parts[0].rows] == ["the same"] * 3
    wrong = [
        dataclasses.replace(row, number=dataclasses.replace(row.number, value=row.number.value * 1.01))
        if row.number.name == "2A12 density"
        else row
        for row in result.numbers
    ]
    assert [row[-1].text for row in materials_section(wrong).parts[0].rows] == ["the same", "differs", "the same"]
    values = {row.number.name: row.number.value for row in result.numbers}
    swap = {"65Mn density": "65Mn yield strength", "65Mn yield strength": "65Mn density"}
    swapped = [
        dataclasses.replace(
            row, number=dataclasses.replace(row.number, value=values[swap.get(row.number.name, row.number.name)])
        )
        for row in result.numbers
    ]
    assert [row[-1].text for row in materials_section(swapped).parts[0].rows] == ["differs", "the same", "the same"]


@pytest.mark.verify
def test_the_page_stands_alone_and_nothing_escapes(result, page):
    evil = '<script>alert(1)</script>"&'
    equation = dataclasses.replace(result.equations[0], what=evil, formula=evil, note=evil, quantity=evil)
    finding = dataclasses.replace(result.findings[0], topic=evil, found=evil, paper=evil, shown_by=evil)
    spoiled = dataclasses.replace(result, equations=(equation,), findings=(finding,))
    text = reproduction_report(spoiled)
    assert "script" not in Tables(text).tags
    assert html.unescape(text).count("<script>alert(1)</script>") >= 8
    assert "script" not in Tables(page).tags
    assert not re.search(r'(?:src|href)="(?!#|https://doi\.org/|data:image/png)', page)


def test_a_page_without_elements_says_so(page):
    assert "the element models were not run" in page
    assert all(name in html.unescape(page) for name in ("Not run here: li-ma-2019-fem-rigid.", COMMAND))


def test_without_rows_the_sections_still_stand():
    assert [section.title for section in equation_sections(())] == [
        "Equations: contact force",
        "Equations: stress waves",
    ]
    assert findings_section(()).parts[0].rows == []


def test_a_rise_is_as_steep_as_it_was_made():
    time = np.linspace(0.0, 1.0, 1001)
    rise = np.where(time < 0.4, time, 0.4 + 3.0 * (time - 0.4))  # slope 1, then 3
    pulse = np.where(time <= 0.8, rise, rise[800] * (1.0 - time) / 0.2)
    assert rise_slope(time, pulse, (0.05, 0.2)) == pytest.approx(1.0, rel=1e-9)
    assert rise_slope(time, pulse, (0.5, 0.9)) == pytest.approx(3.0, rel=1e-9)


def test_the_struck_bar_of_two_bars_meets_the_closed_form():
    """Two equal bars: force rho c0 v A/2 for 2 l/c0 (Kolsky 1963, ch. 3), of the whole bars, not of the quarters.

    Over the middle of the blow, behind the front that radial inertia makes ring. All momentum goes over,
    and 1.3 % more, because the ringing striker leaves backwards.
    """
    solution = run_fem(load_case("two-bars-fem", ["fem.interval=1 us", "fem.duration=40 us"]))
    assert struck_body(solution) == "bar"
    numbers = element_numbers(solution)
    time, force, impulse = whole_force(solution)
    area = solution.run.parts["bar"].mass / (7820.0 * 0.12)  # of the mesh, whose round side has flat faces
    steady = np.median(force[(time > 5e-6) & (time < 20e-6)])
    assert steady == pytest.approx(0.5 * 7820.0 * np.sqrt(211e9 / 7820.0) * 2.0 * area, rel=0.005)
    assert impulse == numbers.impulse == pytest.approx(7820.0 * area * 0.06 * 2.0, rel=0.015)
    assert numbers.peak_force == force.max()
    assert numbers.mean_peak is None
    assert numbers.plastic_strain == 0.0
    pulse = known.element_pulse(solution)
    assert isinstance(pulse, BodyPulse)
    assert pulse.name == "bar"
    gained = float(np.sum(pulse.acceleration) * (pulse.time[1] - pulse.time[0]))
    assert gained == pytest.approx(pulse.measure.velocity_change, rel=0.05)
