"""A layer of a bar as a page lists it."""

from __future__ import annotations

from typing import NamedTuple


class StackRow(NamedTuple):
    """A layer, and the joint behind it: their keys, and each in words; no key and no words where there is no joint."""

    layer: str
    layer_words: str
    joint: str
    joint_words: str
