"""Stress waves in a stack of layers and joints."""

from strikewave.waves.bar import run_bar
from strikewave.waves.bar_run import BarRun, Tap, Wanted
from strikewave.waves.layers import BONDED, Branch, End, Joint, Layer, Stack, round_bar
from strikewave.waves.load import Impactor, Load, Pulse, Sampled
from strikewave.waves.transit import ErrorBound, Grid, choose_grid, error_bound, grid_of

__all__ = [
    "BONDED",
    "BarRun",
    "Branch",
    "End",
    "ErrorBound",
    "Grid",
    "Impactor",
    "Joint",
    "Layer",
    "Load",
    "Pulse",
    "Sampled",
    "Stack",
    "Tap",
    "Wanted",
    "choose_grid",
    "error_bound",
    "grid_of",
    "round_bar",
    "run_bar",
]
