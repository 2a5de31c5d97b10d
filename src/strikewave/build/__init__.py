"""Case in, parts out: machine, stack, load and sensors, with the checks that only the whole case allows."""

from strikewave.build.machine import build_machine, contact_stiffness
from strikewave.build.sensor import build_channels
from strikewave.build.stack import build_load, build_stack, build_taps, wanted

__all__ = [
    "build_channels",
    "build_load",
    "build_machine",
    "build_stack",
    "build_taps",
    "contact_stiffness",
    "wanted",
]
