"""strikewave: predict, measure and design high-g impact tests.

Examples
--------
>>> import strikewave
>>> solution = strikewave.run_case(strikewave.load_case("li-ma-2019"))
>>> solution.blows[0].kind
'full'
"""

from importlib import import_module
from typing import Any

from strikewave._version import __version__

_HOMES = {
    "Case": "strikewave.cases.case",
    "load_case": "strikewave.cases.case",
    "dump_case": "strikewave.cases.case",
    "run_case": "strikewave.analyses.machine.run",
    "run_wave": "strikewave.analyses.wave.run",
    "run_fem": "strikewave.analyses.fem.run",
    "Solution": "strikewave.analyses.machine.result",
    "load_solution": "strikewave.analyses.machine.result",
    "material": "strikewave.base.materials",
    "materials": "strikewave.base.materials",
    "read_record": "strikewave.records",
    "find_pulses": "strikewave.records",
    "srs": "strikewave.signal.srs",
    "solve_impact": "strikewave.contact",
    "Contact": "strikewave.contact",
}

__all__ = ["__version__", *_HOMES]  # noqa: PLE0604  (the names stand once, above)


def __getattr__(name: str) -> Any:
    """Import a public name when it is first used (PEP 562)."""
    if name in _HOMES:
        return getattr(import_module(_HOMES[name]), name)
    raise AttributeError(f"module 'strikewave' has no attribute {name!r}")


def __dir__() -> list[str]:
    """List the public names."""
    return sorted(__all__)
