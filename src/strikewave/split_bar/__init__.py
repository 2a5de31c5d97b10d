"""Split Hopkinson bars: a shot, an accelerometer on a bar end, or a bar alone; set-up file in, solution out."""

from strikewave.split_bar.building import check_setup
from strikewave.split_bar.echoes import EchoSolution
from strikewave.split_bar.reading import SplitBarCase, example_setup, holds_setup, load_setup, parse_setup, values_of
from strikewave.split_bar.sensor_solution import SensorSolution
from strikewave.split_bar.solution import SplitBarSolution
from strikewave.split_bar.solving import run_split_bar
from strikewave.split_bar.tables import SplitBarSetup

__all__ = [
    "EchoSolution",
    "SensorSolution",
    "SplitBarCase",
    "SplitBarSetup",
    "SplitBarSolution",
    "check_setup",
    "example_setup",
    "holds_setup",
    "load_setup",
    "parse_setup",
    "run_split_bar",
    "values_of",
]
