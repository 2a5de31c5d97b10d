"""The numbers of an equation, before they join its words."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

EQUAL = 5e-7
"""Relative difference that is written as 0 %: as much is left by integration and rounding."""


@dataclass(frozen=True)
class Values:
    """What an equation gives as printed, corrected and exactly; ``words`` are what its text mentions by name."""

    printed: float | None
    corrected: float | None = None
    exact: float | None = None
    words: Mapping[str, float | str] = field(default_factory=dict)
