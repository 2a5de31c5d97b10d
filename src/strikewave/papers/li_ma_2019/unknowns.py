"""What inputs that are not published leave of published numbers: ranges over gaskets and over joints."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

from strikewave.papers.li_ma_2019 import gaskets, joints
from strikewave.papers.li_ma_2019.gaskets import GasketStudy, extremes, gasket_study
from strikewave.papers.li_ma_2019.joints import JointStudy, joint_study
from strikewave.papers.li_ma_2019.runs import Report, within

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


def run_unknowns(coarse: bool = False, report: Report = lambda share, words: None) -> Unknowns:
    """Run both maps.

    Parameters
    ----------
    coarse : bool, optional
        Whether a few cells do.
    report : callable, optional
        Called with the share done, 0 to 1, and what runs now.
    """
    return Unknowns(
        gasket_study(gaskets.COARSE if coarse else gaskets.USUAL, within(report, 0.0, GASKETS_SHARE)),
        joint_study(joints.COARSE if coarse else joints.USUAL, within(report, GASKETS_SHARE, 1.0)),
    )
