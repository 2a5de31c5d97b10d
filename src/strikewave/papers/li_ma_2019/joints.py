"""Figure 13 over joints: what the sensor between two cylinders reads, by how hard the bolts press and the faces yield.

The joints above and below the sensor are bolted faces: unilateral springs under a preload. Where the tension behind the
front of the blow exceeds the preload they open, and chatter; each closing is a steep front, which the sensor answers
with its resonance.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from strikewave.analyses.machine.observe import observe
from strikewave.base import declare
from strikewave.base.declare import Quantity
from strikewave.base.shock_quantities import ACCELERATION, MICROSECONDS
from strikewave.cases.case import Case, load_case
from strikewave.papers.li_ma_2019.execution import Execution
from strikewave.papers.li_ma_2019.runs import FIXTURE
from strikewave.studies.engine.answers import OfCase
from strikewave.uncertainty.statistics import variation

Array = NDArray[np.float64]

FACES = ("upper", "sensor")
"""Joints of the case that the bolts press: above and below the sensor, by the layer that each stands behind."""
RIGID = math.inf
"""Stiffness of faces that do not give way: those of the case."""
KEPT = 0.05
"""Largest relative change of peak and width of the rigid pulse with which it counts as kept: by as much measured and
simulated peak of Figure 11 differ, which the paper calls good consistency."""
TRAINS_FROM = 0.6
"""About what share of the time first blows take, whole trains the rest: for the progress bar alone."""
CHATTER = 300.0, 2e9
"""Preload (N) and stiffness (N/m) of joints that chatter: bolts hardly tightened. They were chosen because they give
about the published peak, so that this is no prediction of it."""


class JointGrid(NamedTuple):
    """Joints that are tried: preload of each in N, stiffness of each pair of faces in N/m; pairs with whole trains."""

    preloads: tuple[float, ...]
    stiffnesses: tuple[float, ...]
    trains: tuple[tuple[float, float], ...] = ()


USUAL = JointGrid(
    (30.0, 100.0, 300.0, 1e3, 3e3, 10e3, 30e3),
    (0.2e9, 0.5e9, 1e9, 2e9, 5e9, 10e9, 20e9, RIGID),
    (CHATTER, (100.0, 5e9), (1e3, 2e9), (3e3, 2e9)),
)
"""From bolts turned by hand to tight ones, from faces that add as much to the stack as half a metre of steel to
rigid ones. The paper says that the faces are polished and bolted; all assumed."""
COARSE = JointGrid((300.0, 10e3), (0.2e9, 2e9, RIGID))
"""Six of them, for a run that shall take seconds."""
FINE = JointGrid(
    tuple(float(f"{preload:.3g}") for preload in np.geomspace(30.0, 30e3, 13)),
    (*(float(f"{stiffness:.3g}") for stiffness in np.geomspace(0.2e9, 20e9, 13)), RIGID),
    tuple(itertools.product((100.0, 300.0, 1e3, 3e3), (0.5e9, 1e9, 2e9, 5e9))),
)
"""The same range in finer steps."""


@declare.dataclass
class FixtureBlow:
    """The first blow on the sensor fixture."""

    peak: float = declare.number(ACCELERATION, "of the sensor, without its range")
    width: float = declare.number(MICROSECONDS, "of what it reads, at 10 % of the peak")
    clipped: bool = declare.word("whether the assumed range cuts it off")
    rigid_peak: float = declare.number(ACCELERATION, "of the rigid pulse of the whole object")
    rigid_width: float = declare.number(MICROSECONDS, "of the rigid pulse")

    def keeps(self, other: FixtureBlow) -> bool:
        """Tell whether the rigid pulse is that of another blow, within `KEPT`."""
        pairs = ((self.rigid_peak, other.rigid_peak), (self.rigid_width, other.rigid_width))
        return all(abs(mine / theirs - 1.0) <= KEPT for mine, theirs in pairs)


@declare.dataclass
class JointCell:
    """A preload and a stiffness of the faces, and the first blow."""

    preload: float = declare.number(Quantity("N", "N"), "of each joint")
    stiffness: float = declare.number(Quantity("N/m", "N/m"), "of each pair of faces; null of rigid ones")
    blow: FixtureBlow = declare.part(FixtureBlow, "the first blow", inline=True)


@dataclass(frozen=True)
class Mechanism:
    """Something that may give the published peak: its name, the changes to the case, and the first blow."""

    name: str
    changes: tuple[str, ...]
    blow: FixtureBlow


class TrainScatter(NamedTuple):
    """Coefficients of variation of the peaks over all blows of a train: of the sensor, and of the rigid pulse."""

    sensor: float
    rigid: float


@dataclass(frozen=True)
class JointStudy:
    """The sensor between two cylinders over its joints.

    Attributes
    ----------
    grid : JointGrid
    cells : tuple of JointCell
        In the order of the grid, the preload slowest.
    assumed : FixtureBlow
        With the joints of the case.
    mechanisms : tuple of Mechanism
    trains : tuple of TrainScatter
        Of the pairs of the grid.
    """

    grid: JointGrid
    cells: tuple[JointCell, ...]
    assumed: FixtureBlow
    mechanisms: tuple[Mechanism, ...]
    trains: tuple[TrainScatter, ...] = ()

    @property
    def keeping(self) -> tuple[JointCell, ...]:
        """The joints with which the rigid pulse is that of the case."""
        return tuple(cell for cell in self.cells if cell.blow.keeps(self.assumed))

    def field(self, name: str) -> Array:
        """Return an attribute of the blows, shape (preloads, stiffnesses)."""
        values = [float(getattr(cell.blow, name)) for cell in self.cells]
        return np.array(values).reshape(len(self.grid.preloads), len(self.grid.stiffnesses))


def joint_changes(preload: float, stiffness: float) -> tuple[str, ...]:
    """Return the changes to the case that give both joints a preload (N) and faces of a stiffness (N/m).

    Examples
    --------
    >>> joint_changes(300.0, RIGID)
    ('stack.joint.upper.preload=300 N', 'stack.joint.sensor.preload=300 N')
    """
    pressed = [f"stack.joint.{name}.preload={preload:.9g} N" for name in FACES]
    faces = [f"stack.joint.{name}.stiffness={stiffness:.9g} N/m" for name in FACES]
    return (*pressed, *(faces if math.isfinite(stiffness) else ()))


FRAME_TIMES = 10.0
"""How many times as stiff the frame is among the mechanisms: nearly no spring between the nose and the cylinders."""
RESONANCE = "5 kHz"
"""Resonance of the sensor among the mechanisms: far below any accelerometer's, near the 2.5 kHz of a 200 us pulse."""


def mechanism_changes() -> dict[str, tuple[str, ...]]:
    """Return what may give the published peak: changes to the case by name."""
    frame = load_case(FIXTURE).values()["stack.joint.nose.stiffness"].si
    open_joint = "stack.joint.upper.preload=0 N"
    return {
        "joints that hold (the case)": (),
        "joints that chatter (300 N, faces of 2 GN/m)": joint_changes(*CHATTER),
        "a gap of 2 µm above the sensor, rigid faces": ("stack.joint.upper.gap=2 um", open_joint),
        "a gap of 20 µm above the sensor, rigid faces": ("stack.joint.upper.gap=20 um", open_joint),
        f"a frame {FRAME_TIMES:g} times as stiff": (f"stack.joint.nose.stiffness={FRAME_TIMES * frame:.9g} N/m",),
        f"a sensor that resonates at {RESONANCE}": (f"sensor.oscilloscope.resonance={RESONANCE}",),
    }


def with_joints(changes: Sequence[str] = ()) -> Case:
    """Return the first blow of Figure 13 with some changes to the case."""
    return load_case(FIXTURE, ["feed.blows=1", *changes])


def fixture_blow(case: Case) -> FixtureBlow:
    """Return the first blow on the sensor fixture; see `with_joints`."""
    seen = observe(case)
    history, reading = seen.histories[0], seen.readings[0]
    if history is None or reading is None:
        raise ValueError(f"{case.name} does not strike")
    (read,), (pulse,), blow = history.readings, reading.sensors.values(), seen.blows[0]
    return FixtureBlow(read.peak_before_clip, pulse.width, pulse.clipped, blow.rigid_peak, blow.width)


def joint_study(execution: Execution, grid: JointGrid = USUAL) -> JointStudy:
    """Run the first blow of Figure 13 with every joint of a grid, with each mechanism, and two trains."""
    pairs = list(itertools.product(grid.preloads, grid.stiffnesses))
    named = mechanism_changes()
    changes = [*(joint_changes(*pair) for pair in pairs), *named.values()]
    blows = execution.within(0.0, TRAINS_FROM).answers(
        f"{FIXTURE} over joints", [OfCase(with_joints(change), fixture_blow, FixtureBlow) for change in changes]
    )
    trains = [OfCase(load_case(FIXTURE, joint_changes(*pair)), train_scatter, TrainScatter) for pair in grid.trains]
    scatters = execution.within(TRAINS_FROM, 1.0).answers(f"{FIXTURE} over joints: whole trains", trains)
    cells = tuple(JointCell(*pair, blow) for pair, blow in zip(pairs, blows, strict=False))
    mechanisms = tuple(map(Mechanism, named, named.values(), blows[len(pairs) :]))
    return JointStudy(grid, cells, mechanisms[0].blow, mechanisms, tuple(scatters))


def train_scatter(case: Case) -> TrainScatter:
    """Return how far the peaks of a whole train of the case scatter."""
    seen = observe(case)
    histories = [history for history in seen.histories if history is not None]
    peaks = [history.readings[0].peak_before_clip for history in histories]
    return TrainScatter(variation(peaks), variation([b.rigid_peak for b in seen.blows if b.kind != "missed"]))
