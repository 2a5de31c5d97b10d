"""Split Hopkinson pressure bars: pulses, reduction, checks, echoes, bar ends. Knows no units and no files."""

from strikewave.hopkinson.alignment import METHODS, Carrier, FaceWaves, align, carried
from strikewave.hopkinson.bars import BRIDGES, Bar, BarMaterial, Bridge, Specimen, StrikerBar, elastic
from strikewave.hopkinson.checks import (
    energy,
    equilibrium,
    face_forces,
    momentum,
    rise_slope,
    rise_slopes,
    stress_difference,
    striker_check,
    transits_to_uniform,
)
from strikewave.hopkinson.pulses import GaugeTrace, Pulses, find_pulses
from strikewave.hopkinson.reduction import ANALYSES, Reduction, StressStrainCurve, reduce

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
