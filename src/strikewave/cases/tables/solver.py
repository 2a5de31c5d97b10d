"""[solver]: how exactly to compute."""

from __future__ import annotations

from typing import Literal

from strikewave.base.quantities import MaybeError, MaybeFrequency, MaybeStep, MaybeTime, OutputStep, Tolerance, Value
from strikewave.cases.tables.base import CaseTable


class Solver(CaseTable):
    """[solver]: how exactly to compute, and how densely to keep the whole train.

    ``duration`` is that of a bar alone, ``error`` the wanted one of its velocities over their peak (1e-3; that of
    accelerations is ten times as large), ``step`` the time step of waves (chosen where left out), and
    ``bandwidth`` that at which total and wave acceleration are stated (chosen where left out). ``route`` is "exact",
    or one of the routes of Li & Ma 2019, which take the neighbours of a tap's layer as endless. ``method`` is
    "auto": delay lines, but the spectral solver where layers lose energy or disperse; ``dispersion`` slows short
    waves in every layer that has a Poisson's ratio.
    """

    tolerance: Tolerance = Value(si=1e-9, typed=1e-9)
    output_step: OutputStep = Value(si=1e-5, typed="10 us")
    duration: MaybeTime = None
    step: MaybeStep = None
    error: MaybeError = None
    bandwidth: MaybeFrequency = None
    route: Literal["exact", "as printed", "corrected"] = "exact"
    method: Literal["auto", "delay lines", "spectral"] = "auto"
    dispersion: Literal["none", "love-rayleigh", "pochhammer-chree"] = "none"
