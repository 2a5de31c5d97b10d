"""Limits are those of the analysis: every face states the one that is declared, and no text states one by itself."""

import ast
import contextlib
import io
import re
from pathlib import Path

import pytest

from strikewave import load_case
from strikewave.base.result import BALANCE_LIMIT, BalanceCheck
from strikewave.fem.run import ENERGY_LIMIT, HOURGLASS_LIMIT
from strikewave.reporting.chapters import balance_table
from strikewave.web import markup
from strikewave.web.case_values import notices_and_balance

SOURCE = Path(__file__).parents[2] / "src" / "strikewave"
BARS = ["fem.duration=2 us", "fem.frames=0", "mesh.part.striker.size=3 mm", "mesh.part.bar.size=3 mm"]


def of_machine():
    from strikewave.analyses.machine.run import run_case
    from strikewave.analyses.machine.screen import show

    return run_case(load_case("jesd22-b111-b")), show


def of_wave():
    from strikewave.analyses.wave.run import run_wave
    from strikewave.analyses.wave.screen import show

    return run_wave(load_case("togami-1996-bar", ["solver.duration=50 us"])), show


def of_elements():
    from strikewave.analyses.fem.run import run_fem
    from strikewave.analyses.fem.screen import show

    return run_fem(load_case("two-bars-fem", BARS)), show


DECLARED = {
    of_machine: {"energy": BALANCE_LIMIT, "momentum": BALANCE_LIMIT},
    of_wave: {"momentum": BALANCE_LIMIT},
    of_elements: {"energy": ENERGY_LIMIT, "hourglass energy": HOURGLASS_LIMIT, "momentum": BALANCE_LIMIT},
}


@pytest.mark.parametrize("solved", DECLARED)
def test_screen_app_and_report_state_the_limits_of_the_analysis(solved):
    solution, show = solved()
    checks = solution.balance_checks
    assert {check.name: check.limit for check in checks} == DECLARED[solved]
    screen = io.StringIO()
    with contextlib.redirect_stdout(screen):
        show(solution)
    page = markup.checks(notices_and_balance(solution)["balance"], ())
    printed = " ".join(screen.getvalue().split())
    stated = re.compile(r"(?P<name>[a-z ]+) [-+0-9.e]+ \(limit (?P<limit>[0-9.e-]+)\)")
    for text in (printed[printed.index("balance: ") + 9 :], page.partition("balances: ")[2]):
        found = {match["name"].strip(): float(match["limit"]) for match in stated.finditer(text)}
        assert found == DECLARED[solved]
    rows = {str(row[0]): float(row[2]) for row in balance_table(checks).rows}
    assert rows == DECLARED[solved]


def test_an_error_beyond_the_limit_of_its_analysis_alone_breaks_it():
    """3.6e-5: within the 1 % of elements, beyond the 1e-6 of machines; what is no number is beyond every limit."""
    assert BalanceCheck("energy", 3.6e-5, ENERGY_LIMIT).holds
    assert not BalanceCheck("energy", -3.6e-5).holds
    assert not BalanceCheck("energy", float("nan"), ENERGY_LIMIT).holds


TYPED = re.compile(r"(?:\blimit|\bfails|off by)\s?[^\w{]{0,3}\d+(?:\.\d+)?(?:e-?\d+| ?%)")
"""A limit in a text, such as "(limit 1e-6)" or "off by 1 %"."""


def typed_limits(source):
    """Return the texts of a module, docstrings aside, that state a limit as a number of their own."""
    tree = ast.parse(source)
    plain = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr)}
    texts = [node for node in ast.walk(tree) if isinstance(node, ast.Constant) and isinstance(node.value, str)]
    return [node.value for node in texts if id(node) not in plain and TYPED.search(node.value)]


def test_no_text_states_a_limit_as_a_number_of_its_own():
    sources = {path: path.read_text("utf-8") for path in SOURCE.rglob("*.py")}
    assert [str(path) for path, text in sources.items() if TYPED.search(text) and typed_limits(text)] == []


@pytest.mark.parametrize(
    "planted",
    ['f"{x} (a run that is off by 1e-6 fails)"', 'f"momentum {error:.1e} (limit 1e-6)"', '"energy error, limit 1 %"'],
)
def test_a_typed_limit_is_found(planted):
    assert typed_limits(f"words = {planted}")
    assert not typed_limits('words = f"{error:.1e} (limit {limit:.0e})"')
