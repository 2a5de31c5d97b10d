"""A split-Hopkinson shot: set-up file in, solution out."""

from strikewave.split_bar.echoes import EchoSolution
from strikewave.split_bar.reading import SplitBarCase, load_setup, parse_setup
from strikewave.split_bar.solution import SplitBarSolution
from strikewave.split_bar.solving import run_split_bar
from strikewave.split_bar.tables import SplitBarSetup

__all__ = [
    "EchoSolution",
    "SplitBarCase",
    "SplitBarSetup",
    "SplitBarSolution",
    "load_setup",
    "parse_setup",
    "run_split_bar",
]
