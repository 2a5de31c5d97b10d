"""Split-Hopkinson shots that others measured, with bars, specimens and gauges as their own notes have them.

Copper and PMMA: LANL HopPyBar (BSD-3-Clause). 945 steel: shpb-shtb-data-processor (MIT). Files in tests/data.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from strikewave.hopkinson import Bar, Bridge, GaugeTrace, Pulses, Reduction, Specimen, align, find_pulses, reduce
from strikewave.hopkinson.alignment import Method
from strikewave.hopkinson.pulses import quieten
from strikewave.records import read_record
from strikewave.records.calibration import even

ROD_SPEED, REFLECTED_SPEED = 4974.964141, 4865.900383
"""Of the titanium bars, m/s: from ultrasound, and from the time of the reflected pulse; both from the record's head."""
COPPER_STRIKER, PMMA_STRIKER = 0.127, 25.4e-3
"""Lengths of the strikers, m, where they are published; of the material of their bars."""
STEEL = ("yao_945steel_03", "yao_945steel_sample02")
"""Files of the two shots on 945 steel."""
MINI = {"density": 2810.0, "modulus": 71.7e9, "diameter": 2.380880043e-3, "poissons_ratio": 0.332713755}
"""The miniature bars: square, of the round bar of equal area."""
MINI_SPEED = 2.0 * 0.10202 / 40.394e-6
"""Their bar speed, m/s: the reflected pulse over the way from gauge to specimen and back, by the record's head."""
MINI_ECHOES = ((3, 0.10135, "away", 0, "transmitted"), (1, 0.10202, "towards", 2, "incident, from its third pass"))
"""Channel, way from the gauge to the specimen (m), first way of the pulse, passes left out, name of each."""


@dataclass(frozen=True)
class Shot:
    """Bars, specimen and the traces of both gauges."""

    bars: tuple[Bar, Bar]
    specimen: Specimen
    traces: tuple[GaugeTrace, GaugeTrace]
    alignment: Method = "geometric"

    def reduced(self) -> tuple[Pulses, Reduction]:
        """Return its pulses, and its reduction."""
        pulses = find_pulses(*self.traces, self.bars)
        waves = align(pulses, self.bars, method=self.alignment, transit=self.specimen.transit)
        return pulses, reduce(waves, self.bars, self.specimen)


def trace(path: Path, channel: int, strain: Callable) -> GaugeTrace:
    """Return the strain of a channel."""
    found = even(read_record(path).channel(channel))[0]
    return GaugeTrace(strain(found.values), found.step, found.start)


def bridged(path: Path, channel: int, bridge: Bridge) -> GaugeTrace:
    """Return the strain of a channel in volts; a bridge is not quite linear: it must know that this is compression."""
    volts = quieten(trace(path, channel, np.asarray), path.name).trace
    return replace(volts, strain=-bridge.strain(-volts.strain))


def disc(length: float, diameter: float, density: float, modulus: float) -> Specimen:
    """Return a round specimen."""
    return Specimen(length, 0.25 * math.pi * diameter**2, density, modulus)


def copper(folder: Path, speed: float = REFLECTED_SPEED) -> Shot:
    """Return the copper shot between titanium bars; its program takes 2/gauge factor: two gauges across."""
    path = folder / "lanl_Cu_20061201_1148HE.raw"
    bar = Bar(4416.0, 4416.0 * speed**2, 9.47e-3, 0.381, 0.330302)
    bridges = [Bridge("half", factor, 8.0, 200.0) for factor in (2.061, 2.062)]
    traces = tuple(bridged(path, k + 1, bridge) for k, bridge in enumerate(bridges))
    return Shot((bar, bar), disc(3.204e-3, 6.34e-3, 8930.0, 117e9), traces)


def steel(folder: Path, name: str) -> Shot:
    """Return a shot on 945 steel between steel bars."""
    shared = {"density": 7800.0, "modulus": 210e9, "diameter": 0.02}
    bars = (Bar(**shared, gauge_distance=1.02, length=2.1), Bar(**shared, gauge_distance=0.77, length=1.8))
    traces = tuple(trace(folder / f"{name}.xlsx", k, lambda values: 1e-6 * values) for k in (1, 2))
    return Shot(bars, disc(4e-3, 8e-3, 7800.0, 210e9), traces)


def mini_bar(folder: Path, channel: int, distance: float) -> tuple[Bar, GaugeTrace]:
    """Return a miniature bar of aluminium and the trace of its gauge, whose factor is nominal."""
    path, bridge = folder / f"lanl_PMMA13_Ch{channel}.csv", Bridge("half", 2.1, 10.0, 100.0)
    return Bar(**MINI, gauge_distance=distance), bridged(path, 1, bridge)


def pmma(folder: Path) -> Shot:
    """Return the shot on PMMA between the miniature bars; modulus as handbooks have it."""
    found = [mini_bar(folder, channel, distance) for channel, distance in ((1, 0.10202), (3, 0.10135))]
    bars, traces = zip(*found, strict=True)
    return Shot(bars, disc(1.47e-3, 1.54e-3, 1190.0, 3.3e9), traces)
