"""Stress and velocity at sections of a bar over time, as they are handed to a page."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np


class BarSections(NamedTuple):
    """Stress and velocity of a bar, in the units shown.

    Attributes
    ----------
    time : array (times,)
    position : array (places,)
        From the first face, mm.
    layer : tuple of str
        Name of the layer of each place.
    stress : array (times, places)
        Compression above zero.
    velocity : array (times, places)
    labels : tuple of str
        Of time, stress and velocity, with their units.
    """

    time: Any
    position: Any
    layer: tuple[str, ...]
    stress: Any
    velocity: Any
    labels: tuple[str, str, str]

    def nearest(self, position: float) -> int:
        """Return the place that is nearest to a position, mm.

        Examples
        --------
        >>> empty = np.zeros((1, 3))
        >>> BarSections(np.zeros(1), np.array([0.0, 1.0, 2.0]), ("a",) * 3, empty, empty, ("",) * 3).nearest(1.2)
        1
        """
        return int(np.argmin(np.abs(self.position - position)))
