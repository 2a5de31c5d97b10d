"""Machines that strike: each yields blows on the struck object."""

from strikewave.machines.blows import Blow, blows
from strikewave.machines.feed import Feed
from strikewave.machines.rotary import RotaryMachine, RotaryRun, Striker, Strikers, run_rotary
from strikewave.machines.struck_object import StruckObject
from strikewave.machines.turntable import Turntable

__all__ = [
    "Blow",
    "Feed",
    "RotaryMachine",
    "RotaryRun",
    "Striker",
    "Strikers",
    "StruckObject",
    "Turntable",
    "blows",
    "run_rotary",
]
