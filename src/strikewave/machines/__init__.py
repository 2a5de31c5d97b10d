"""Machines that strike: each yields blows on the struck object."""

from strikewave.machines.blows import Blow, blows
from strikewave.machines.drive import Feed, Turntable
from strikewave.machines.machine import Arm, Launch, Machine, RotaryDrive, Striker, Strikers
from strikewave.machines.run import MachineRun, run_machine
from strikewave.machines.struck_object import StruckObject

__all__ = [
    "Arm",
    "Blow",
    "Feed",
    "Launch",
    "Machine",
    "MachineRun",
    "RotaryDrive",
    "Striker",
    "Strikers",
    "StruckObject",
    "Turntable",
    "blows",
    "run_machine",
]
