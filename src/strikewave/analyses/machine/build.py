"""Case in, machine out, with the checks that only the whole case allows."""

from __future__ import annotations

from strikewave.analyses.machine.kind import LaunchedKind, kind_of
from strikewave.analyses.machine.launched import build_launched
from strikewave.analyses.machine.rotary import build_rotary
from strikewave.cases.case import Case
from strikewave.machines import Machine


def build_machine(case: Case) -> Machine:
    """Turn a case into the machine that runs: launched machines are built alike, whatever their kind.

    Raises
    ------
    InputError
        With one line for each thing that does not fit together.
    """
    kind = kind_of(case)
    return build_launched(case, kind) if isinstance(kind, LaunchedKind) else build_rotary(case)
