"""Figure 5 over gaskets: the direct sensor in the blow in which the buffered one reads its published peak.

The buffered peak, 6 353.22 g, is met by the engagement with every gasket; the direct reading of the same blow is then
asked. It is 6 353.22 g over what the gasket passes of a peak, so that it knows no bounds but those of the gaskets.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from strikewave.analyses.machine.observe import observe
from strikewave.base import declare
from strikewave.base.quantities import Value
from strikewave.base.shock_quantities import ACCELERATION, LENGTH, MODULUS, RATIO
from strikewave.cases.case import Case, load_case
from strikewave.cases.tables.sensor import GasketTable
from strikewave.papers.li_ma_2019.execution import Execution
from strikewave.papers.li_ma_2019.published import published_number
from strikewave.papers.li_ma_2019.runs import COMPARISON, MACHINE
from strikewave.studies.engine.answers import OfCase

Array = NDArray[np.float64]

DIRECT, BUFFERED = "direct", "buffered"
"""Names of the two sensors of the case."""
FIRST_BLOW = ("feed.blows=1", "feed.stroke_time=20 ms")
"""Changes to the case: its first blow alone; and a feed that is through between two strikers, since with that of the
case the striker before the first blow meets the object on its way as soon as the engagement is beyond 9.5 mm."""
DEEPEST = 18e-3
"""Largest engagement that is tried, m: short of the stroke of the feed, 20 mm, which must clear the noses."""
ORDER = 0.5
"""The peak grows with the speed, hence with the root of the engagement, w sqrt(2 R q - q^2): slope of the search."""
MET = 2e-4
"""Relative miss of the buffered peak at which a search ends: two parts in ten thousand of the direct one, too."""
MOST_RUNS = 8
"""Runs of a search at most: each takes the miss to a tenth or less."""
AFTER = 2e-4
"""When the blow itself is over, s after first touch: the published width. What a sensor reads later is ringing."""
DENSITY, DIAMETER = "1200 kg/m^3", "15 mm"
"""Of every gasket: polymers and elastomers lie within a third of this density, which hardly matters beside the sensor's
mass; the diameter is that of the case. Both assumed."""


class GasketGrid(NamedTuple):
    """Gaskets that are tried: modulus in Pa at the speed of a blow, loss factor, thickness in m of all together."""

    moduli: tuple[float, ...]
    losses: tuple[float, ...]
    thicknesses: tuple[float, ...]


USUAL = GasketGrid((5e6, 10e6, 20e6, 50e6, 100e6, 200e6, 500e6, 1e9), (0.05, 0.2, 0.8), (1e-3, 3e-3, 6e-3))
"""From soft elastomers to hard polymers, from hardly damped to made for damping, one thin gasket to a stack. The paper
says "multiple layers of different wave impedance gaskets" of its other test, and nothing of these; all assumed."""
COARSE = GasketGrid((50e6, 500e6), (0.05, 0.8), (3e-3,))
"""Four of them, for a run that shall take seconds."""
FINE = GasketGrid(
    tuple(float(f"{modulus:.3g}") for modulus in np.geomspace(5e6, 1e9, 13)),
    (0.05, 0.1, 0.2, 0.3, 0.4, 0.6, 0.8, 1.0),
    (1e-3, 2e-3, 3e-3, 4.5e-3, 6e-3),
)
"""The same range in finer steps: minutes."""


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
        """Whether the buffered sensor rings less than the direct one, as the paper says of its own."""
        return self.buffered_ringing < self.direct_ringing


@dataclass(frozen=True)
class GasketStudy:
    """The direct sensor over gaskets.

    Attributes
    ----------
    grid : GasketGrid
    cells : tuple of GasketCell
        In the order of the grid, the thickness slowest, the modulus fastest.
    assumed : GasketCell
        The gaskets of the case, in the same way.
    same_machine : float
        Peak of the direct sensor with the engagement of li-ma-2019, whatever the gasket, m/s^2: if the test ran as that
        of Figure 11 did, which is not said.
    """

    grid: GasketGrid
    cells: tuple[GasketCell, ...]
    assumed: GasketCell
    same_machine: float

    @property
    def reached(self) -> tuple[GasketCell, ...]:
        """The gaskets with which the buffered peak is met."""
        return tuple(cell for cell in self.cells if math.isfinite(cell.direct))

    @property
    def calm(self) -> tuple[GasketCell, ...]:
        """Of these, the ones that calm the pulse as the paper says."""
        return tuple(cell for cell in self.reached if cell.calm)

    def field(self, name: str) -> Array:
        """Return an attribute of the cells, shape (thicknesses, losses, moduli)."""
        moduli, losses, thicknesses = self.grid
        values = [float(getattr(cell, name)) for cell in self.cells]
        return np.array(values).reshape(len(thicknesses), len(losses), len(moduli))


def extremes(values: list[float]) -> tuple[float, float]:
    """Return the smallest and the largest size of values.

    Examples
    --------
    >>> extremes([3.0, -4.0])
    (3.0, 4.0)
    """
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
        seen = observe(case.with_values({"machine.engagement": Value(si=engagement, typed=engagement)}))
        history, reading = seen.histories[0], seen.readings[0]
        if history is None or reading is None:
            break
        peaks = {name: pulse.peak for name, pulse in reading.sensors.items()}
        ratio = abs(peaks[BUFFERED]) / wanted
        if abs(ratio - 1.0) < MET:
            read = dict(zip(peaks, history.readings, strict=True))
            rings = [ringing(read[name].time, read[name].values) for name in (DIRECT, BUFFERED)]
            return GasketCell(modulus, loss, thickness, engagement, peaks[DIRECT], seen.blows[0].rigid_peak, *rings)
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


def gasket_study(execution: Execution, grid: GasketGrid = USUAL) -> GasketStudy:
    """Run the first blow of Figure 5 with every gasket of a grid."""
    case = load_case(COMPARISON, FIRST_BLOW)
    gaskets = [(modulus, loss, thickness) for thickness, loss, modulus in itertools.product(*reversed(grid))]
    asked = [OfCase(with_gasket(case, *gasket), gasket_cell, GasketCell, gasket) for gasket in gaskets]
    assumed, *cells = execution.answers(f"{COMPARISON} over gaskets", [OfCase(case, gasket_cell, GasketCell), *asked])
    engagement = load_case(MACHINE).values()["machine.engagement"]
    reading = observe(case.with_values({"machine.engagement": engagement})).readings[0]
    same = math.nan if reading is None else reading.sensors[DIRECT].peak
    return GasketStudy(grid, tuple(cells), assumed, same)
