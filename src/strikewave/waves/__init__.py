"""Stress waves in a stack of layers and joints."""

from strikewave.waves.layers import BONDED, Branch, End, Joint, Layer, Stack, round_bar

__all__ = ["BONDED", "Branch", "End", "Joint", "Layer", "Stack", "round_bar"]
