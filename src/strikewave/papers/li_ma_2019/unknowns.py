"""What inputs that are not published leave of published numbers: ranges over gaskets and over joints."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

from strikewave.papers.li_ma_2019 import gaskets, joints
from strikewave.papers.li_ma_2019.execution import Execution
from strikewave.papers.li_ma_2019.gaskets import GasketStudy, extremes, gasket_study
from strikewave.papers.li_ma_2019.joints import JointStudy, joint_study

GASKETS_SHARE = 0.75
"""About what share of the time the gaskets take, the joints the rest: for the progress bar alone."""


class OpenRange(NamedTuple):
    """A number between what unknown inputs make of it: lowest and highest, SI, and which inputs leave it."""

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
        gasket_study(first, gaskets.COARSE if coarse else gaskets.USUAL),
        joint_study(second, joints.COARSE if coarse else joints.USUAL),
    )
