"""Copper bar on a rigid wall (Taylor 1948) as computed by many (Wilkins & Guinan 1973; Kamoulakos 1990): 80 us."""

import numpy as np
import pytest

from strikewave.fem.model import Controls, Model, RigidWall, Symmetry
from strikewave.fem.shapes import cylinder
from strikewave.fem.solids import Bilinear
from strikewave.fem.solve import RunOptions, solve

COPPER = Bilinear(8930.0, 117e9, 0.35, 400e6, 100e6)
FULL = "full"


def taylor(size, hourglass):
    """A quarter of the bar of 32.4 mm and radius 3.2 mm at 227 m/s; return the run, its length and foot radius in mm."""
    mesh = cylinder("bar", 6.4e-3, 32.4e-3, size, size, "quarter")
    kind = {"full": ("bar",)} if hourglass == FULL else {"hourglass": hourglass}
    run = solve(
        Model(
            mesh,
            {"bar": COPPER},
            Controls(80e-6, interval=1e-6, threads=2, **kind),
            velocity={"bar": (0.0, 0.0, -227.0)},
            boundaries=(Symmetry("bar.x-"), Symmetry("bar.y-")),
            walls=(RigidWall("bar.bottom", (0.0, 0.0, 0.0), (0.0, 0.0, 1.0)),),
        ),
        RunOptions(frames=2),
    )
    place = 1e3 * (mesh.points + run.frames[-1].displacement)
    foot, top = (np.unique(mesh.side(f"bar.{side}")) for side in ("bottom", "top"))
    return run, place[top, 2].mean() - place[foot, 2].mean(), np.hypot(*place[foot, :2].T).max()


def assert_sound(run):
    assert not run.stopped
    assert abs(run.energy_error).max() < 2e-4
    assert run.momentum_error < 1e-9
    assert run.energy["hourglass"][-1] < 0.05 * run.energy["internal"][-1]
    rest = sum(run.energy[name][-1] for name in ("kinetic", "viscous", "hourglass"))
    assert run.energy["plastic"][-1] > 0.98 * run.initial_energy - rest


@pytest.mark.verify
@pytest.mark.parametrize("hourglass", [0.05, FULL])
def test_copper_bar_ends_as_long_and_wide_as_published(hourglass):
    """Four elements over the radius: length 21.4 to 21.6 mm, foot radius 7.0 to 7.5 mm, the range of published codes."""
    run, length, radius = taylor(0.8e-3, hourglass)
    assert_sound(run)
    assert 21.4 < length < 21.6
    assert 7.0 < radius < 7.5


@pytest.mark.verify
def test_copper_bar_hangs_little_on_hourglass_coefficient_and_mesh(capsys):
    """Elements of 0.8 mm by coefficients from 0.01 to 0.2, of 0.53 mm by the usual one, and full integration of both.

    The length stays in the published range everywhere; the foot radius where elements are fine, and it nears that of
    full integration as the coefficient or the element is made smaller.
    """
    usual, coarse, fine = 0.05, 0.8e-3, 0.53e-3
    coefficients = (0.01, usual, 0.1, 0.2)
    found = {}
    for size, coefficient in [*((coarse, one) for one in (*coefficients, FULL)), (fine, usual), (fine, FULL)]:
        run, length, radius = taylor(size, coefficient)
        assert_sound(run)
        found[size, coefficient] = radius
        share = run.energy["hourglass"][-1] / run.energy["internal"][-1]
        with capsys.disabled():
            print(
                f"\n{1e3 * size:.2f} mm, {coefficient}: {length:.2f} mm, {radius:.2f} mm, hourglass {share:.1%}", end=""
            )
        assert 21.4 < length < 21.6
        if size == fine:
            assert 7.0 < radius < 7.5
    assert np.all(np.diff([found[coarse, one] for one in coefficients]) < 0.0)
    assert found[coarse, FULL] == pytest.approx(found[coarse, 0.01], abs=0.02)
    off = [abs(found[size, usual] - found[size, FULL]) for size in (coarse, fine)]
    assert off[1] < 0.8 * off[0]
