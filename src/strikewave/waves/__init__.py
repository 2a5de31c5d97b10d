"""Stress waves in a stack of layers and joints."""

from strikewave.waves.bar import BarRun, Tap, WantedError, run_bar
from strikewave.waves.layers import BONDED, Branch, End, Joint, Layer, Stack, round_bar
from strikewave.waves.load import Impactor, Load, LoadPulse, Sampled
from strikewave.waves.transit import ErrorBound, TimeGrid, choose_grid, error_bound, grid_of

__all__ = [
    "BONDED",
    "BarRun",
    "Branch",
    "End",
    "ErrorBound",
    "Impactor",
    "Joint",
    "Layer",
    "Load",
    "LoadPulse",
    "Sampled",
    "Stack",
    "Tap",
    "TimeGrid",
    "WantedError",
    "choose_grid",
    "error_bound",
    "grid_of",
    "round_bar",
    "run_bar",
]
