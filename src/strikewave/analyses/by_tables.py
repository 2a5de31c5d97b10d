"""The analysis of a case or a set-up by its tables, its run, and the check that its parts fit together.

Only the analyses that a case is for are imported: elements and split bars take their time.
"""

from __future__ import annotations

from collections.abc import Sequence

from strikewave.base.documents import read_toml
from strikewave.base.errors import InputError
from strikewave.cases.case import Case, load_case
from strikewave.cases.files import read_case_text
from strikewave.cases.stack_of_case import build_channels, build_stack, build_taps, need
from strikewave.reporting.output_options import Output


def run_any(name: str, changes: Sequence[str], output: Output, animate: bool = False, band: bool = True) -> int:
    """Run a case or a set-up file, write and print its result, and return the exit code.

    With ``band``, a machine or a layered bar gets the bands of its results.
    """
    if holds_setup(read_case_text(name)[0]):
        from strikewave.analyses.hopkinson.build import load_setup
        from strikewave.analyses.hopkinson.screen import run_setup

        if animate:
            allowed = "a machine, a layered bar or elements"
            raise InputError("--animate", name, allowed, "a set-up of bars has no motion")
        return run_setup(load_setup(name, changes), changes, output)
    case = load_case(name, changes)
    if case.command == "fem":
        from strikewave.analyses.fem.screen import run_element_case
        from strikewave.reporting.options import FemOptions

        return run_element_case(case, changes, output, FemOptions(animate=animate))
    if case.command == "wave":
        from strikewave.analyses.wave.screen import run_wave_case

        return run_wave_case(case, changes, output, animate=animate, band=band)
    from strikewave.analyses.machine.screen import run_machine_case

    return run_machine_case(case, changes, output, animate, band)


def holds_setup(text: str) -> bool:
    """Tell whether a TOML text is a set-up of split bars: it has [bar.incident].

    Examples
    --------
    >>> holds_setup("[bar.incident]"), holds_setup("[machine]"), holds_setup("[")
    (True, False, False)
    """
    try:
        bar = read_toml(text).get("bar")
    except ValueError:
        return False
    return isinstance(bar, dict) and "incident" in bar


def check_case(case: Case) -> None:
    """Build all parts of a case, so that parts that do not fit together are refused."""
    if case.machine is not None:
        from strikewave.analyses.machine.build import build_machine

        build_machine(case)
    if case.stack.layer:
        stack = build_stack(case)
        build_taps(case)
        if case.load is not None or case.machine is None:
            from strikewave.analyses.wave.build import build_load

            build_load(case, stack)
            need(case.solver.duration, "solver.duration", "how long to follow", 'add duration = "300 us"')
    if case.fem is not None:
        from strikewave.analyses.fem.build import check_elements

        check_elements(case)
    build_channels(case)
