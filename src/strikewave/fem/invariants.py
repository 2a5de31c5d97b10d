"""Numbers of a stress that do not depend on the axes: von Mises stress and pressure; SI.

Stresses are (..., 6): xx yy zz xy yz zx, tension positive.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def von_mises(stress: Array) -> Array:
    """Return the von Mises stress sqrt(3/2 s : s), s the deviator, Pa, (...).

    Parameters
    ----------
    stress : array (..., 6)
        Pa.

    Examples
    --------
    >>> uniaxial, shear = [250.0, 0, 0, 0, 0, 0], [0, 0, 0, 100.0, 0, 0]
    >>> von_mises(np.array([uniaxial, shear])).round(3).tolist()
    [250.0, 173.205]
    """
    xx, yy, zz, xy, yz, zx = np.moveaxis(np.asarray(stress, float), -1, 0)
    direct = 0.5 * ((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2)
    return np.asarray(np.sqrt(direct + 3.0 * (xy**2 + yz**2 + zx**2)))


def pressure(stress: Array) -> Array:
    """Return the pressure -(xx + yy + zz) / 3, Pa, (...); compression is positive.

    Examples
    --------
    >>> float(pressure(np.array([-3.0, -3.0, -3.0, 1.0, 0.0, 0.0])))
    3.0
    """
    return np.asarray(-np.asarray(stress, float)[..., :3].mean(axis=-1))
