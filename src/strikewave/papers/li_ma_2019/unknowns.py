"""The ranges that unpublished inputs leave to published numbers: Figure 5 over gaskets, Figure 13 over joints.

Figure 5: the engagement is fitted so that the buffered sensor reads its published peak, 6 353.22 g, with every gasket;
the direct sensor is then read in the same blow. Its peak is 6 353.22 g over the gain of the gasket, so that only the
gaskets bound it.

Figure 13: the reading of the sensor between two cylinders over the preload of the bolts and the stiffness of the faces.
The joints above and below the sensor are bolted faces: unilateral springs under a preload. Where the tension behind
the front of the blow exceeds the preload they open and chatter; each closing is a steep front, which the sensor
answers with its resonance.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from strikewave.analyses.machine.observe import observe
from strikewave.base import declare
from strikewave.base.declare import Quantity
from strikewave.base.quantities import Value
from strikewave.base.shock_quantities import ACCELERATION, LENGTH, MICROSECONDS, MODULUS, RATIO
from strikewave.cases.case import Case, load_case
from strikewave.cases.tables.stack import GasketTable
from strikewave.papers.li_ma_2019.published import published_number
from strikewave.papers.li_ma_2019.runs import COMPARISON, FIXTURE, MACHINE, Execution
from strikewave.studies.engine.questions import OfCase
from strikewave.uncertainty.statistics import variation

Array = NDArray[np.float64]

DIRECT, BUFFERED = "direct", "buffered"
"""Names of the two sensors of the case."""
FIRST_BLOW = ("feed.blows=1", "feed.stroke_time=20 ms")
"""Changes to the case: its first blow alone, and a feed that is through between two strikers: with that of the case the
striker before meets the object on its way from an engagement of 9.5 mm on."""
DEEPEST = 18e-3
"""Largest engagement that is tried, m: short of the stroke of the feed, 20 mm, which must clear the noses."""
ORDER = 0.5
"""Slope of the search: the peak grows with the speed, hence with the root of the engagement, w sqrt(2 R q - q^2)."""
MET = 2e-4
"""Relative miss of the buffered peak at which a search ends; that of the direct one is as small."""
MOST_RUNS = 8
"""Largest number of runs of a search: each takes the miss to a tenth or less."""
AFTER = 2e-4
"""End of the blow itself, s after first touch: the published width. Later readings are ringing."""
DENSITY, DIAMETER = "1200 kg/m^3", "15 mm"
"""Density and diameter of every gasket, both assumed: polymers lie within a third of this density, which hardly matters
against the sensor's mass; the diameter is that of the case."""


class GasketGrid(NamedTuple):
    """The gaskets of a map: modulus at the speed of a blow (Pa), loss factor, thickness of all together (m)."""

    moduli: tuple[float, ...]
    losses: tuple[float, ...]
    thicknesses: tuple[float, ...]


USUAL_GASKETS = GasketGrid((5e6, 10e6, 20e6, 50e6, 100e6, 200e6, 500e6, 1e9), (0.05, 0.2, 0.8), (1e-3, 3e-3, 6e-3))
"""From soft elastomers to hard polymers, hardly damped to made for damping, one thin gasket to a stack; all assumed.
The paper says "multiple layers of different wave impedance gaskets" of its other test, and nothing of these."""
COARSE_GASKETS = GasketGrid((50e6, 500e6), (0.05, 0.8), (3e-3,))
"""Four gaskets, for a run of seconds."""


@declare.dataclass
class GasketCell:
    """A gasket, and the first blow with which the buffered sensor reads its published peak; NaN where none does."""

    modulus: float = declare.number(MODULUS, "null of gaskets that are no single one")
    loss_factor: float = declare.number(RATIO, "null of gaskets that are no single one")
    thickness: float = declare.number(LENGTH, "null of gaskets that are no single one")
    engagement: float = declare.number(LENGTH, "refitted; null where no engagement gives the buffered peak")
    direct: float = declare.number(ACCELERATION, "peak of the direct sensor, with its sign")
    rigid_peak: float = declare.number(ACCELERATION, "of the object")
    direct_ringing: float = declare.number(ACCELERATION, "root mean square of the reading after the blow")
    buffered_ringing: float = declare.number(ACCELERATION, "the same of the buffered sensor")

    @declare.computed(declare.word("whether the buffered sensor rings less than the direct one"))
    def calm(self) -> bool:
        """True if the buffered sensor rings less than the direct one, as the paper states."""
        return self.buffered_ringing < self.direct_ringing


@dataclass(frozen=True)
class GasketStudy:
    """The direct sensor over gaskets."""

    grid: GasketGrid
    cells: tuple[GasketCell, ...]
    """In the order of the grid, the thickness slowest, the modulus fastest."""
    assumed: GasketCell
    """The gaskets of the case."""
    same_machine: float
    """Peak of the direct sensor with the engagement of li-ma-2019, whatever the gasket, m/s^2: if the test ran as that
    of Figure 11 did, which is not said."""

    @property
    def reached(self) -> tuple[GasketCell, ...]:
        """The gaskets with which the buffered peak is met."""
        return tuple(cell for cell in self.cells if math.isfinite(cell.direct))

    @property
    def calm(self) -> tuple[GasketCell, ...]:
        """The gaskets of these that calm the pulse as the paper says."""
        return tuple(cell for cell in self.reached if cell.calm)

    def field(self, name: str) -> Array:
        """Return an attribute of the cells, shape (thicknesses, losses, moduli)."""
        moduli, losses, thicknesses = self.grid
        values = [float(getattr(cell, name)) for cell in self.cells]
        return np.array(values).reshape(len(thicknesses), len(losses), len(moduli))


def extremes(values: list[float]) -> tuple[float, float]:
    """Return the smallest and the largest size of values."""
    sizes = [abs(value) for value in values]
    return min(sizes), max(sizes)


def with_gasket(case: Case, modulus: float, loss_factor: float, thickness: float) -> Case:
    """Return a case whose buffered sensor stands on one gasket.

    Examples
    --------
    >>> case = with_gasket(load_case(COMPARISON), 50e6, 0.8, 3e-3)
    >>> [row.modulus.typed for row in case.sensor[1].gasket]
    ['50 MPa']
    """
    written = {
        "density": DENSITY,
        "diameter": DIAMETER,
        "modulus": f"{modulus / 1e6:.6g} MPa",
        "loss_factor": loss_factor,
        "thickness": f"{thickness * 1e3:.6g} mm",
    }
    gasket = GasketTable.model_validate(written)
    rows = (row.model_copy(update={"gasket": (gasket,)}) if row.name == BUFFERED else row for row in case.sensor)
    return case.model_copy(update={"sensor": tuple(rows)})


def gasket_cell(
    case: Case, modulus: float = math.nan, loss: float = math.nan, thickness: float = math.nan
) -> GasketCell:
    """Return the blow with which the buffered sensor of a case reads its published peak.

    A search along the logarithm of the engagement with the slope `ORDER`: each step takes the miss to a tenth or less.
    """
    wanted, engagement = published_number("buffered peak").value, case.values()["machine.engagement"].si
    for _ in range(MOST_RUNS):
        if engagement > DEEPEST:
            break
        observed = observe(case.with_values({"machine.engagement": Value(si=engagement, typed=engagement)}))
        history, reading = observed.histories[0], observed.readings[0]
        if history is None or reading is None:
            break
        peaks = {name: pulse.peak for name, pulse in reading.sensors.items()}
        ratio = abs(peaks[BUFFERED]) / wanted
        if abs(ratio - 1.0) < MET:
            read = dict(zip(peaks, history.readings, strict=True))
            rings = [ringing(read[name].time, read[name].values) for name in (DIRECT, BUFFERED)]
            return GasketCell(modulus, loss, thickness, engagement, peaks[DIRECT], observed.blows[0].rigid_peak, *rings)
        engagement *= ratio ** (-1.0 / ORDER)
    return GasketCell(modulus, loss, thickness, *[math.nan] * 5)


def ringing(time: Array, values: Array) -> float:
    """Return the root mean square of a reading `AFTER` first touch, in its unit.

    Examples
    --------
    >>> ringing(np.array([1e-4, 3e-4, 4e-4]), np.array([9.0, 2.0, -2.0]))
    2.0
    """
    return float(np.sqrt(np.mean(values[time > AFTER] ** 2)))


def gasket_study(execution: Execution, grid: GasketGrid = USUAL_GASKETS) -> GasketStudy:
    """Run the first blow of Figure 5 with every gasket of a grid."""
    case = load_case(COMPARISON, FIRST_BLOW)
    gaskets = [(modulus, loss, thickness) for thickness, loss, modulus in itertools.product(*reversed(grid))]
    runs = [OfCase(with_gasket(case, *gasket), gasket_cell, GasketCell, gasket) for gasket in gaskets]
    assumed, *cells = execution.answers(f"{COMPARISON} over gaskets", [OfCase(case, gasket_cell, GasketCell), *runs])
    engagement = load_case(MACHINE).values()["machine.engagement"]
    reading = observe(case.with_values({"machine.engagement": engagement})).readings[0]
    same = math.nan if reading is None else reading.sensors[DIRECT].peak
    return GasketStudy(grid, tuple(cells), assumed, same)


FACES = ("upper", "sensor")
"""Joints of the case that the bolts press, above and below the sensor, by the layer in front of each."""
RIGID = math.inf
"""Stiffness of rigid faces, as in the case."""
KEPT = 0.05
"""Largest relative change of peak and width of a kept rigid pulse: the difference that the paper calls good
consistency."""
TRAINS_FROM = 0.6
"""Rough share of time of first blows, the rest for whole trains; for the progress bar alone."""
CHATTER = 300.0, 2e9
"""Preload (N) and stiffness (N/m) of joints that chatter: bolts hardly tightened. Chosen because they give about the
published peak, which they so do not predict."""


class JointGrid(NamedTuple):
    """The joints of a map: preloads (N), stiffnesses of each pair of faces (N/m), and pairs with whole trains."""

    preloads: tuple[float, ...]
    stiffnesses: tuple[float, ...]
    trains: tuple[tuple[float, float], ...] = ()


USUAL_JOINTS = JointGrid(
    (30.0, 100.0, 300.0, 1e3, 3e3, 10e3, 30e3),
    (0.2e9, 0.5e9, 1e9, 2e9, 5e9, 10e9, 20e9, RIGID),
    (CHATTER, (100.0, 5e9), (1e3, 2e9), (3e3, 2e9)),
)
"""From bolts turned by hand to tight ones, from faces as soft as half a metre of steel to rigid ones; all assumed. The
paper says that the faces are polished and bolted."""
COARSE_JOINTS = JointGrid((300.0, 10e3), (0.2e9, 2e9, RIGID))
"""Six joints, for a run of seconds."""


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
    """A possible cause of the published peak: its name, the changes to the case, and the first blow."""

    name: str
    changes: tuple[str, ...]
    blow: FixtureBlow


class TrainScatter(NamedTuple):
    """Coefficients of variation of the peaks of a train: of the sensor, and of the rigid pulse."""

    sensor: float
    rigid: float


@dataclass(frozen=True)
class JointStudy:
    """The sensor between two cylinders over its joints; cells in the order of the grid, the preload slowest."""

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
"""Factor of the stiffness of the frame among the mechanisms: nearly no spring between nose and cylinders."""
RESONANCE = "5 kHz"
"""Resonance of the sensor among the mechanisms: far below any accelerometer's, near the 2.5 kHz of a 200 us pulse."""


def mechanism_changes() -> dict[str, tuple[str, ...]]:
    """Return the possible causes of the published peak: changes to the case by name."""
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
    observed = observe(case)
    history, reading = observed.histories[0], observed.readings[0]
    if history is None or reading is None:
        raise ValueError(f"{case.name} does not strike")
    (read,), (pulse,), blow = history.readings, reading.sensors.values(), observed.blows[0]
    return FixtureBlow(read.peak_before_clip, pulse.width, pulse.clipped, blow.rigid_peak, blow.width)


def joint_study(execution: Execution, grid: JointGrid = USUAL_JOINTS) -> JointStudy:
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
    observed = observe(case)
    histories = [history for history in observed.histories if history is not None]
    peaks = [history.readings[0].peak_before_clip for history in histories]
    return TrainScatter(variation(peaks), variation([b.rigid_peak for b in observed.blows if b.kind != "missed"]))


GASKETS_SHARE = 0.75
"""Rough share of time of the gaskets, the rest for the joints; for the progress bar alone."""


class OpenRange(NamedTuple):
    """The ends of a number that unknown inputs leave open, SI, and these inputs."""

    low: float
    high: float
    left_by: str


@dataclass(frozen=True)
class Unknowns:
    """The maps behind the ranges: gaskets of Figure 5, joints of Figure 13."""

    gaskets: GasketStudy
    joints: JointStudy

    @property
    def direct_peak(self) -> OpenRange:
        """Peak of the direct sensor over the gaskets that calm the pulse as the paper says."""
        low, high = extremes([cell.direct for cell in self.gaskets.calm])
        return OpenRange(low, high, "material, thickness, modulus and loss of the gaskets")

    @property
    def wave_peak(self) -> OpenRange:
        """Peak of the sensor between cylinders over the joints that keep the rigid pulse."""
        low, high = extremes([cell.blow.peak for cell in self.joints.keeping])
        return OpenRange(low, high, "preload and stiffness of the faces of both joints")

    @property
    def wave_width(self) -> OpenRange:
        """Width of what it reads, over the same joints."""
        low, high = extremes([cell.blow.width for cell in self.joints.keeping])
        return OpenRange(low, high, "preload and stiffness of the faces of both joints")

    def ranges(self) -> Mapping[str, OpenRange]:
        """Return the range of each published number that has one, by its name."""
        return {
            "direct peak": self.direct_peak,
            "wave peak": self.wave_peak,
            "wave width": self.wave_width,
            "wave peak simulated": self.wave_peak,
        }


def run_unknowns(coarse: bool, execution: Execution) -> Unknowns:
    """Run both maps; a few cells of them where they shall be coarse."""
    first, second = execution.within(0.0, GASKETS_SHARE), execution.within(GASKETS_SHARE, 1.0)
    return Unknowns(
        gasket_study(first, COARSE_GASKETS if coarse else USUAL_GASKETS),
        joint_study(second, COARSE_JOINTS if coarse else USUAL_JOINTS),
    )
