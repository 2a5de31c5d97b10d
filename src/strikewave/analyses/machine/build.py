"""Case in, machine out, with the checks that only the whole case allows."""

from __future__ import annotations

from strikewave.analyses.machine.launched import build_launched
from strikewave.analyses.machine.rotary import build_rotary
from strikewave.cases.case import Case
from strikewave.machines import RotaryMachine


def build_machine(case: Case) -> RotaryMachine:
    """Turn a case into the machine that runs.

    Raises
    ------
    InputError, InputErrors
        With one line for each thing that does not fit together.
    """
    return build_rotary(case) if case.launched() is None else build_launched(case)
