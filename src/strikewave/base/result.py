"""What every result is made of: what the user should know, and published numbers beside computed ones."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

SCHEMA = 3
"""Of the files of a solution; 2 adds readings and waves, 3 the contact of each blow."""
LEDGER_LIMIT = 1e-6
"""Energy or momentum missing beyond this share breaks a stated limit."""


@dataclass(frozen=True)
class Notice:
    """Something the user should know: code, words, the value that raised it, its limit.

    ``broken`` marks a stated limit (ledger, no blow at all) that makes the command exit with 3.
    """

    code: str
    message: str
    value: float
    limit: float
    broken: bool = False


@dataclass(frozen=True)
class Comparison:
    """A published number beside the computed one; ``difference`` is relative."""

    quantity: str
    published: float
    measured_or_simulated: str
    computed: float | None
    difference: float | None
    role: str
    note: str = ""
    sensor: str = ""


def ledger_notices(ledger: Mapping[str, float]) -> Iterator[Notice]:
    """Yield each error of a ledger (``energy_error``, ``momentum_error``, shares) that is beyond the limit."""
    for key, error in ledger.items():
        if not error <= LEDGER_LIMIT:
            name = key.removesuffix("_error")
            message = (
                f"the {name} ledger misses {error:.1e}: lower solver.tolerance (solver.step for a stack), or take "
                "less extreme values"
            )
            yield Notice(f"{name}-ledger", message, error, LEDGER_LIMIT, broken=True)
