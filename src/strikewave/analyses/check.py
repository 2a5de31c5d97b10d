"""All parts of a case built, whichever analyses it is for, so that what does not fit together is said."""

from strikewave.analyses.fem.build import check_elements
from strikewave.analyses.machine.build import build_machine
from strikewave.analyses.wave.build import build_load
from strikewave.cases.case import Case
from strikewave.cases.stack_of_case import build_channels, build_stack, build_taps, need


def check(case: Case) -> None:
    """Build all parts of a case, so that what does not fit together is said.

    Raises
    ------
    InputError
        As the builders do.
    """
    if case.machine is not None:
        build_machine(case)
    if case.stack.layer:
        stack = build_stack(case)
        build_taps(case)
        if case.load is not None or case.machine is None:
            build_load(case, stack)
            need(case.solver.duration, "solver.duration", "how long to follow", 'add duration = "300 us"')
    if case.fem is not None:
        check_elements(case)
    build_channels(case)
