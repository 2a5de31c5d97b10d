"""Split Hopkinson pressure bars: pulses, reduction, checks, echoes, bar ends. Knows no units and no files."""

from strikewave.hopkinson.alignment import METHODS, FaceWaves, align
from strikewave.hopkinson.bars import Bar, BarMaterial, Specimen, StrikerBar, elastic
from strikewave.hopkinson.checks import (
    energy,
    equilibrium,
    momentum,
    rise_slope,
    rise_slopes,
    striker_check,
)
from strikewave.hopkinson.gauges import BRIDGES, Bridge
from strikewave.hopkinson.pulses import GaugeTrace, Pulses, find_pulses
from strikewave.hopkinson.reduction import ANALYSES, Reduction, StressStrainCurve, reduce
from strikewave.hopkinson.shifting import Carrier, carried
from strikewave.hopkinson.uniformity import face_forces, stress_difference, transits_to_uniform

__all__ = [
    "ANALYSES",
    "BRIDGES",
    "METHODS",
    "Bar",
    "BarMaterial",
    "Bridge",
    "Carrier",
    "FaceWaves",
    "GaugeTrace",
    "Pulses",
    "Reduction",
    "Specimen",
    "StressStrainCurve",
    "StrikerBar",
    "align",
    "carried",
    "elastic",
    "energy",
    "equilibrium",
    "face_forces",
    "find_pulses",
    "momentum",
    "reduce",
    "rise_slope",
    "rise_slopes",
    "stress_difference",
    "striker_check",
    "transits_to_uniform",
]
