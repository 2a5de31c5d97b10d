"""Two sensors on a frame of finite elements, whose rigid acceleration is pressure times area over mass."""

import functools

import numpy as np
import pytest

from strikewave import load_case
from strikewave.analyses.fem.run import run_fem
from strikewave.records import find_pulses
from strikewave.records.two_sensors import paired_motion

INTERVAL, PRESSURE, AREA = 0.5e-6, 5e6, 60e-3 * 20e-3
CASE = """
schema = 1
title = "A frame under a pulse of pressure"
[[mesh.part]]
name = "frame"
shape = "frame"
material = "65Mn"
width = "60 mm"
depth = "20 mm"
height = "60 mm"
left = "10 mm"
right = "10 mm"
bottom = "12 mm"
top = "8 mm"
size = "4 mm"
elements = "full"
[fem]
duration = "{duration} us"
interval = "0.5 us"
frames = 2
boundary = [{{ kind = "pressure", side = "frame.bottom", time = {times}, pressure = {pressures} }}]
[[fem.point]]
name = "low"
part = "frame"
place = {{ z = "12 mm" }}
[[fem.point]]
name = "high"
part = "frame"
place = {{ z = "60 mm" }}
[[fem.point]]
name = "corner"
part = "frame"
place = {{ x = "30 mm", y = "10 mm", z = "60 mm" }}
"""


@pytest.fixture(scope="module")
def blow(tmp_path_factory):
    """Return the function that gives the accelerations of three points under a pulse of a length, over its true peak."""

    @functools.cache
    def of(length):
        share = np.linspace(0.0, 1.0, 25)
        text = CASE.format(
            duration=6 * length,
            times=[f"{t} us" for t in share * length],
            pressures=[f"{p} Pa" for p in PRESSURE * np.sin(np.pi * share) ** 2],
        )
        path = tmp_path_factory.mktemp("frame") / "frame.toml"
        path.write_text(text)
        found = run_fem(load_case(path))
        assert not found.broken  # energy and momentum are booked
        peak = PRESSURE * AREA / found.parts["frame"].mass
        return {
            name: found.data[f"point.{name}.acceleration"].values[:, 2] / peak for name in ("low", "high", "corner")
        }

    return of


def paired(points, first, second, length, rng, share=0.003):
    """Compare two points as a recorder would have them: 150 samples a pulse, noise, a quiet time before."""
    factor = max(1, round(length * 1e-6 / 150.0 / INTERVAL))
    both = np.column_stack([points[first], points[second]])
    both = both[: len(both) // factor * factor].reshape(-1, factor, 2).mean(axis=1)
    quiet = round(8.0 * length * 1e-6 / INTERVAL / factor)
    both = np.vstack([np.zeros((quiet, 2)), both])
    both += share * rng.normal(size=both.shape)
    step = factor * INTERVAL
    return paired_motion(*both.T, step, find_pulses(both[:, 0], step) or find_pulses(both[:, 1], step))


@pytest.mark.verify
@pytest.mark.parametrize(
    ("first", "second", "length"), [("low", "high", 250), ("low", "high", 500), ("high", "corner", 250)]
)
def test_two_places_that_move_against_one_another_give_the_rigid_peak_and_its_uncertainty(
    blow, first, second, length, rng
):
    """An end alone is off by up to 22 % of the shorter pulse; the common motion is force over mass within its own doubt."""
    found = paired(blow(length), first, second, length, rng)
    assert found.rigid_peak == pytest.approx(1.0, abs=2.0 * found.common_uncertainty)
    assert found.common_uncertainty < 0.1


@pytest.mark.verify
def test_a_bend_that_both_places_share_is_not_seen_by_two_sensors(blow, rng):
    """Middle of the foot and corner of the head go the same way when the frame bends, and both places of the head ride
    on its legs: what the docs say of it holds, 1.5 % of the peak beside two uncertainties; of foot and corner under a
    pulse half as long, no peak is given."""
    for first in ("low", "high"):
        found = paired(blow(500), first, "corner", 500, rng)
        assert found.rigid_peak == pytest.approx(1.0, abs=2.0 * found.common_uncertainty + 0.015)
    assert not np.isfinite(paired(blow(250), "low", "corner", 250, rng).rigid_peak)


@pytest.mark.verify
@pytest.mark.parametrize(("first", "second"), [("low", "high"), ("low", "corner"), ("high", "corner")])
def test_a_blow_shorter_than_the_period_of_the_frame_gives_no_rigid_peak(blow, first, second, rng):
    """60 us, and a bending mode near 9 kHz: places move by up to 2.9 times the rigid acceleration."""
    found = paired(blow(60), first, second, 60, rng)
    assert found.one_body != "yes"
    assert not np.isfinite(found.rigid_peak)
