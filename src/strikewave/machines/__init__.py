"""Machines that strike: each yields blows on the struck object."""

from strikewave.machines.blows import Blow, blows
from strikewave.machines.feed import Feed
from strikewave.machines.machine import Launch, RotaryMachine, Striker, Strikers
from strikewave.machines.rotary import RotaryRun, run_rotary
from strikewave.machines.struck_object import StruckObject
from strikewave.machines.turntable import Turntable

__all__ = [
    "Blow",
    "Feed",
    "Launch",
    "RotaryMachine",
    "RotaryRun",
    "Striker",
    "Strikers",
    "StruckObject",
    "Turntable",
    "blows",
    "run_rotary",
]
