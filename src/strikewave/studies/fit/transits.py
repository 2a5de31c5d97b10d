"""Fields that change the time of a wave through a layer: delay lines follow it in whole time steps."""

from __future__ import annotations

import re
from collections.abc import Sequence

from strikewave.cases.case import Case
from strikewave.cases.stack_of_case import build_stack
from strikewave.studies.fit.free_fields import changed_case
from strikewave.studies.simulation import Simulation
from strikewave.waves.spectral import is_linear
from strikewave.waves.transit import WaveSetup, wave_setup

OF_TRANSIT = re.compile(r"stack\.layer\.(.+)\.(length|density|modulus)")
"""Fields that change a transit, and the layer that each is of."""


def smooth_case(case: Case, paths: Sequence[str]) -> Case:
    """Return a case whose run follows these fields smoothly, where there is one: a linear bar by the spectral solver.

    Examples
    --------
    >>> from strikewave import load_case
    >>> bar = load_case("li-ma-2019-fig13-bar")
    >>> smooth_case(bar, ["stack.layer.upper.length"]).solver.method, smooth_case(bar, ["load.peak"]).solver.method
    ('spectral', 'auto')
    """
    if case.command != "wave" or case.solver.method != "auto" or not any(map(OF_TRANSIT.fullmatch, paths)):
        return case
    from strikewave.analyses.wave.build import build_load

    stack = build_stack(case)
    return changed_case(case, ["solver.method=spectral"]) if is_linear(stack, build_load(case, stack)) else case


def stairs(case: Case, paths: Sequence[str]) -> list[float]:
    """Return by how much each field moves, as a share, until the run of a case feels it; 0 where it does smoothly.

    With a step that is stated, that is one step of the transit of its layer; else what the chosen one misses of it.

    Examples
    --------
    >>> from strikewave import load_case
    >>> bar = load_case("li-ma-2019-fig13-bar", ["solver.method=delay lines", "solver.step=50 ns"])
    >>> [round(share, 4) for share in stairs(bar, ["stack.layer.upper.length", "load.peak"])]
    [0.0104, 0.0]
    """
    found = [OF_TRANSIT.fullmatch(path) for path in paths]
    waves = _waves(case) if any(found) else None
    return [0.0 if one is None or waves is None else _stair(case, waves, one[1], one[2]) for one in found]


def _stair(case: Case, waves: WaveSetup, name: str, field: str) -> float:
    """Return by how much a field of a layer moves until delay lines feel it, as a share."""
    layer = next(one for one in waves.layers if one.name == name)
    if not layer.steps:  # by its spectrum
        return 0.0
    share = 1.0 / layer.steps if case.solver.step else 2.0 * waves.mismatch
    return share * (1.0 if field == "length" else 2.0)  # the transit goes with their square root


def _waves(case: Case) -> WaveSetup | None:
    """Return how the stack of a case is followed; None where it has none."""
    if case.command == "wave":
        waves: WaveSetup = Simulation(case).bar.waves
        return waves
    from strikewave.analyses.machine.build import build_machine

    layered = build_machine(case).layered if case.command == "run" else None
    return wave_setup(layered.stack, layered.grid) if layered is not None else None
