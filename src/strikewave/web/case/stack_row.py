"""The layers of a bar as a page lists them, and the joints that can be added."""

from __future__ import annotations

from typing import NamedTuple

JOINTS = {
    "compliant": "stiffness = 1 GN/m\ndamping = 0 N s/m",
    "gasket": "material = PTFE\nthickness = 1 mm",
    "unilateral": "preload = 1 kN",
    "mass": "mass = 5 gram",
    "oscillator": "mass = 5 gram\nresonance = 50 kHz\nquality = 50",
    "contact": "law = hertz\nradius = 1 m",
    "cushion": "cushion.material = natural rubber 65 IRHD\ncushion.thickness = 10 mm\ncushion.diameter = 20 mm",
}
"""Kinds of joints, with properties that each may begin from."""


class StackRow(NamedTuple):
    """A layer, and the joint behind it: their keys, and each in words; no key and no words where there is no joint."""

    layer: str
    layer_words: str
    joint: str
    joint_words: str


class ListedStack(NamedTuple):
    """The layers of a bar, from the loaded face on, and the materials that one more may be of."""

    rows: list[StackRow]
    materials: list[str]
