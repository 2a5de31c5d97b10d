"""Units that the user chose stand in every table, sentence and picture of a machine, and no usual one beside them."""

import re
from html import unescape

import pytest

from strikewave import load_case, run_case
from strikewave.analyses.machine.report import blow_table, report
from strikewave.analyses.machine.screen import show
from strikewave.reporting.numbers import ShownUnits, showing

CHOICE = ShownUnits.read("m/s2,ms,N")
USUAL = re.compile(r".{0,40}(?:\d (?:g|µs|us|kN)\b|\((?:g|µs|us|kN)\))")
"""A number, or a head, in the usual unit of an acceleration, a time or a force."""
AS_TYPED = {"Warnings", "Set-up", "Inputs", "How to run this again"}
"""Sections that repeat values as they were typed, and notices, which are worded before anything is shown."""


@pytest.mark.verify
@pytest.mark.parametrize("name", ["li-ma-2019-fig13", "rodgers-2009-amplifier"])
def test_no_usual_unit_stands_beside_the_chosen_ones(name, capsys):
    solution = run_case(load_case(name, ["feed.blows=1"] if name.startswith("li-ma") else []))
    with showing(CHOICE):
        show(solution)
        page = report(solution)
    screen = "".join(line for line in capsys.readouterr() for line in line.splitlines(True) if "fitted:" not in line)
    assert USUAL.findall(screen) == []
    assert "(m/s²)" in screen
    sections = re.split(r"<h[12][^>]*>", re.sub(r"<(script|style)\b.*?</\1>", "", page, flags=re.S))
    heads = [section.partition("<")[0] for section in sections]
    assert set(heads) > AS_TYPED - {"Warnings"}
    for head, section in zip(heads, sections, strict=True):
        if head not in AS_TYPED:
            text = unescape(re.sub(r"<[^>]+>", "|", section)).replace("\n", " ")
            assert USUAL.findall(text) == [], head


def test_what_stands_beside_the_blows_is_in_the_chosen_unit_of_a_speed():
    solution = run_case(load_case("jesd22-b111-b"))
    with showing(ShownUnits.read("km/h")):
        words = blow_table(solution).text
    assert re.search(r"at the nominal [\d.]+ km/h and", words)
    assert "m/s " not in words
