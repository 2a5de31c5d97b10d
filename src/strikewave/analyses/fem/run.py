"""Explicit finite elements: case in, solution out."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from strikewave.analyses.fem.build import build_model, fields_of_case
from strikewave.analyses.fem.notices import all_notices
from strikewave.analyses.fem.result import FemSolution
from strikewave.analyses.fem.sectors import of_whole_bodies, sectors
from strikewave.base import citations
from strikewave.base.compiling import compiling_shown
from strikewave.cases.case import Case
from strikewave.fem.device.devices import device_named
from strikewave.fem.engine import Engine
from strikewave.fem.hexahedron import fitting, scaled_masses
from strikewave.fem.model import Model, NonReflecting
from strikewave.fem.run import FieldFrame
from strikewave.fem.snapshots import SNAPSHOTS, snapshot_recorder
from strikewave.fem.solids import JohnsonCook, ZerilliArmstrong, von_mises

if TYPE_CHECKING:
    from strikewave.fem.solve import RunOptions, Writer


@dataclass
class Watch:
    """Frames on their way to a writer; the one of the largest stress and the last are kept."""

    writer: Writer | None = None
    worst: FieldFrame | None = None
    last: FieldFrame | None = None
    _largest: float = field(default=0.0, init=False)

    def add(self, frame: FieldFrame) -> None:
        """Take a frame."""
        if self.writer is not None:
            self.writer.add(frame)
        largest = float(von_mises(frame.stress).max())
        if largest > self._largest:
            self._largest, self.worst = largest, frame
        self.last = frame

    @property
    def shown(self) -> tuple[FieldFrame, ...]:
        """The frames to be shown, in the order of time."""
        by_time = {frame.time: frame for frame in (self.worst, self.last) if frame is not None}
        return tuple(by_time[time] for time in sorted(by_time))


def run_fem(case: Case, threads: int = 1, device: str | None = None) -> FemSolution:
    """Run the finite element model of a case.

    Parameters
    ----------
    case : Case
        With a mesh.
    threads : int, optional
        Threads that share the elements; their number changes no result.
    device : str, optional
        ``cuda`` or ``cuda-mixed``: the steps are taken on an NVIDIA GPU.

    Returns
    -------
    FemSolution
        Histories of parts, contacts and points, energies, pictures and comparisons.

    Raises
    ------
    InputError
        If the case has no mesh, parts of it do not fit together, or there is no such device.

    Examples
    --------
    >>> from strikewave import load_case
    >>> solution = run_fem(load_case("two-bars-fem", ["fem.duration=5 us"]))
    >>> solution.run.momentum_error < 1e-9
    True
    """
    from strikewave.fem.solve import RunOptions

    options = RunOptions(device=device_named(device) if device else None)
    return run_model(case, build_model(case, threads), options)


@compiling_shown()
def run_model(case: Case, model: Model, options: RunOptions | None = None, snapshots: int = SNAPSHOTS) -> FemSolution:
    """Run the model of a case; ``snapshots`` are kept for pictures, and as many again while anything touches."""
    from strikewave.fem.solve import RunOptions, check_controls, solve_blows

    options = options or RunOptions()
    watch, later = Watch(options.writer), options.later
    frames = int(case.fem.frames.si) if case.fem else 0
    with fields_of_case(model):
        check_controls(model)
        recorder = snapshot_recorder(model, snapshots)
        options = options._replace(writer=watch, later=later or (lambda _: Watch()), observer=recorder, frames=frames)
        run, *others = solve_blows(model, options)
    origin = [key for key in citations.SOURCES if case.source.startswith(key)][:1]
    sector_of = sectors(case, model)
    whole, *later_whole = (of_whole_bodies(model, blow, sector_of) for blow in (run, *others))
    solution = FemSolution(
        case=case,
        model=model,
        run=whole,
        frames=watch.shown,
        film=recorder,
        citations=(*origin, *sources(model)),
        later=tuple(later_whole),
        modelled=() if whole is run else (run, *others),
    )
    solution = dataclasses.replace(solution, notices=tuple(all_notices(solution)))
    return dataclasses.replace(solution, comparisons=solution.compared())


def check_model(model: Model) -> None:
    """Prepare a model as a run would, up to its first step, and refuse what would stop it there."""
    from strikewave.fem.solve import check_controls

    with fields_of_case(model):
        check_controls(model)
        Engine(model)


def first_step(model: Model) -> float:
    """Return the time step that a run begins with, s."""
    controls, rigid = model.controls, {body.part for body in model.rigid}
    with fields_of_case(model):
        _, _, critical = scaled_masses(model, [name for name in model.mesh.names if name not in rigid])
    return fitting(controls.interval, controls.safety * critical)


def sources(model: Model) -> tuple[str, ...]:
    """Return the keys of the sources that a model rests on."""
    solids, boundaries = ({type(x) for x in rows} for rows in (model.solids.values(), model.boundaries))
    used = {
        "flanagan-belytschko-1981": True,
        "hughes-winget-1980": True,
        "johnson-cook-1983": JohnsonCook in solids,
        "zerilli-armstrong-1987": ZerilliArmstrong in solids,
        "lysmer-kuhlemeyer-1969": NonReflecting in boundaries,
        "cundall-1976": model.controls.blows > 1,
        "barnes-1999": model.controls.blows > 1,
    }
    return tuple(key for key, is_used in used.items() if is_used)
