"""The report of a reproduced paper: every equation and number is on it, no curve is called measured, nothing escapes."""

import dataclasses
import html
import os
import re
from html.parser import HTMLParser

import numpy as np
import pytest

from strikewave import load_case
from strikewave.figures import reproduction as draw
from strikewave.figures.reproduction import Mark
from strikewave.report.reproduction_figures import figure_sections, ratios
from strikewave.report.reproduction_page import reproduction_report
from strikewave.report.reproduction_tables import equation_sections, findings_section, materials_section
from strikewave.studies.reproduction import answers as known
from strikewave.studies.reproduction.element_pulses import (
    BodyPulse,
    element_numbers,
    rise_slope,
    struck_body,
    whole_force,
)
from strikewave.studies.reproduction.reproduce import reproduce
from strikewave.studies.reproduction.runs import ELEMENT_CASES, Effort
from strikewave.units import STANDARD_GRAVITY

COMMAND = "strikewave reproduce li-ma-2019 --without elements"


@pytest.fixture(scope="module")
def result():
    return reproduce(Effort(elements=False))


@pytest.fixture(scope="module")
def page(result):
    return reproduction_report(result, COMMAND)


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
    assert len(drawn) == 9
    for figure in drawn:
        for axes in figure.axes:
            labels = [line.get_label() for line in axes.lines]
            assert not [label for label in labels if "measured" in label or "DYNA" in label]
            levels = [text.get_text() for text in axes.texts if text.get_text().startswith(("measured", "LS-DYNA"))]
            flat = [line for line in axes.lines if np.ptp(np.asarray(line.get_ydata(), dtype=float)) == 0.0]
            assert len(levels) <= len(flat)


def test_levels_and_bars_stand_at_the_published_numbers():
    marks = [Mark(4151.25 * STANDARD_GRAVITY, "measured", 200e-6), Mark(4374.52 * STANDARD_GRAVITY, "LS-DYNA", 220e-6)]
    axes = draw.pulse_figure("", [], marks, 4e-4).axes[0]
    data = [(np.asarray(line.get_xdata()), np.asarray(line.get_ydata(), dtype=float)) for line in axes.lines]
    assert [y[0] for _, y in data[:2]] == pytest.approx([4151.25, 4374.52], rel=1e-12)
    assert [x.tolist() for x, _ in data[2:]] == [pytest.approx([0.0, 200.0]), pytest.approx([0.0, 220.0])]
    assert [text.get_text() for text in axes.texts] == ["measured 4 151.25 g, 200 µs", "LS-DYNA 4 374.52 g, 220 µs"]


def test_roles_are_those_of_the_cases(result):
    """What a case was fitted to is marked so; the direct sensor and the stress wave are predictions."""
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
            assert role in mine
    assert result.row(known.DIRECT_PEAK).best.role == "predicted"
    assert result.row(known.RIGID_PEAK).best.role == "fitted"


def test_the_overview_shows_only_what_can_be_compared(result):
    shown = ratios(result)
    assert {row.role for row in shown} == {"fitted", "predicted"}
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


def test_the_page_stands_alone_and_nothing_escapes(result, page):
    evil = '<script>alert(1)</script>"&'
    equation = dataclasses.replace(result.equations[0], what=evil, formula=evil, note=evil, quantity=evil)
    finding = dataclasses.replace(result.findings[0], topic=evil, found=evil, paper=evil, shown_by=evil)
    spoiled = dataclasses.replace(result, equations=(equation,), findings=(finding,))
    text = reproduction_report(spoiled, evil)
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
    from strikewave.elements import run_fem

    solution = run_fem(load_case("two-bars-fem", ["fem.interval=1 us", "fem.duration=40 us"]))
    assert struck_body(solution) == "bar"
    numbers = element_numbers(solution)
    time, force, impulse = whole_force(solution)
    area = 4.0 * solution.run.parts["bar"].mass / (7820.0 * 0.12)  # of the mesh, whose round side has flat faces
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


@pytest.mark.skipif(os.environ.get("STRIKEWAVE_VERIFY") != "1", reason="minutes: STRIKEWAVE_VERIFY=1 runs it")
def test_the_whole_reproduction_runs_its_elements():
    whole = reproduce(Effort(threads=os.cpu_count() or 1))
    assert [solution.case.name for solution in whole.runs.elements] == list(ELEMENT_CASES)
    assert not whole.broken
    for name in (known.DYNA_PEAK, known.DYNA_FORCE, known.DYNA_WAVE_PEAK):
        assert whole.row(name).best.by.startswith("li-ma-2019-fem")
    assert "open" not in {row.verdict for row in whole.findings}
    text = html.unescape(reproduction_report(whole, "strikewave reproduce li-ma-2019"))
    assert all(f"The mesh of {name}" in text for name in (ELEMENT_CASES[0], ELEMENT_CASES[2]))
