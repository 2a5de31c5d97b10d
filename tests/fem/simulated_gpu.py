"""A small impact on the GPU that numba simulates, against the processor; nothing is compiled (tests/fem/test_device.py)."""

import numpy as np
import plain_kernels  # noqa: F401

from strikewave.fem.device.gpu import Cuda
from strikewave.fem.mesh import joined
from strikewave.fem.model import Controls, Guided, Model, Pressure, Rigid, SurfaceContact, Tie, TimeCurve
from strikewave.fem.shapes import block, moved
from strikewave.fem.solids import Bilinear
from strikewave.fem.solve import RunOptions, solve

SIZE = 1e-3


def model():
    """Return an element that strikes a rigid one aslant, with friction, and yields; one that is pressed and guided is tied to it."""
    low, up, top = (block(name, (SIZE, SIZE, SIZE), SIZE, SIZE, SIZE) for name in ("low", "up", "top"))
    solid = Bilinear(7820.0, 211e9, 0.29, yield_strength=200e6, tangent_modulus=2e9)
    return Model(
        joined([low, moved(up, (0.3 * SIZE, 0.2 * SIZE, SIZE)), moved(top, (0.3 * SIZE, 0.2 * SIZE, 2.0 * SIZE))]),
        {"low": solid, "up": solid, "top": solid},
        Controls(0.2e-6, 0.2e-6),
        velocity={"up": (0.0, 1.0, -60.0), "top": (0.0, 1.0, -60.0)},
        contacts=(SurfaceContact("low.z+", "up.z-", 0.2),),
        ties=(Tie("top.z-", "up.z+"),),
        rigid=(Rigid("low"),),
        boundaries=(Pressure("top.z+", TimeCurve((0.0,), (100e6,))), Guided("top.z+", (0.0, 0.0, 1.0))),
    )


if __name__ == "__main__":
    run, other = solve(model()), solve(model(), RunOptions(device=Cuda()))
    assert np.abs(next(iter(run.force.values()))).max() > 100.0
    assert run.energy["plastic"][-1] > 0.0
    for what in ("energy", "force", "impulse"):
        for name, column in getattr(run, what).items():
            scale = max(np.abs(column).max(), 1e-300)
            # sums of corners in another order
            np.testing.assert_allclose(getattr(other, what)[name] / scale, column / scale, atol=1e-10, rtol=0.0)
