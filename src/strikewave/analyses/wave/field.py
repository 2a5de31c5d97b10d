"""The whole wave field of a layered bar."""

from __future__ import annotations

from typing import TYPE_CHECKING

from strikewave.reporting.wave_field import WaveField
from strikewave.waves import Impactor

if TYPE_CHECKING:
    from strikewave.analyses.wave.run import WaveSolution

_ROUND_TRIPS = 2.0
"""Round trips through the stack that are shown after the load has ended (chosen: the first shows the echoes, the second
that they repeat)."""


def field_of_solution(solution: WaveSolution) -> WaveField:
    """Return the field of a bar alone, until its load is over and two round trips later."""
    run = solution.run
    lasting = float(run.touches[:, 1].max(initial=0.0)) if isinstance(run.load, Impactor) else float(run.load.duration)
    whole = WaveField(
        run.stack,
        run.field_time,
        run.field_position,
        run.field_layer,
        run.field_force,
        run.field_velocity,
        solution.taps,
        "time after the start of the load",
    )
    return whole.up_to(lasting + _ROUND_TRIPS * 2.0 * run.stack.transit)
