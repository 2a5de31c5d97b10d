"""Shots measured by others: only what physics asks of them, never what this code once gave.

Copper and PMMA: LANL HopPyBar (BSD-3-Clause). 945 steel: shpb-shtb-data-processor (MIT).
"""

import pytest
from real_shots import (
    COPPER_STRIKER,
    MINI_ECHOES,
    MINI_SPEED,
    REFLECTED_SPEED,
    ROD_SPEED,
    STEEL,
    copper,
    mini_bar,
    steel,
)

from strikewave.hopkinson import energy, equilibrium, momentum
from strikewave.hopkinson.echoes import calibrate_bar


def test_copper_closes_its_impulses_and_lasts_as_long_as_its_striker_says(measured):
    """Two gauge factors known to 0.5 % each: impulses close within 2 %. 127 mm of the bars' titanium: 52.2 us.

    The width at half height is off the two transits of the striker by less than the rise of the pulse.
    """
    shot = copper(measured("lanl-kolsky"))
    pulses, reduction = shot.reduced()
    assert abs(momentum(reduction).closure) < 0.02
    assert pulses.width == pytest.approx(2.0 * COPPER_STRIKER / shot.bars[0].speed, abs=pulses.rise)
    assert equilibrium(reduction).misfit < 0.10


def test_two_speeds_of_titanium_bars_shift_waves_by_the_difference_of_ways(measured):
    """2 x 381 mm at 4865.9 and at 4975.0 m/s differ by 3.43 us: so does what the balance of forces finds, to 0.3 us.

    0.3 us is a sixteenth of the rise; the other speed also changes the dispersion and the force.
    """
    late = []
    for speed in (ROD_SPEED, REFLECTED_SPEED):
        late.append(copper(measured("lanl-kolsky"), speed).reduced()[1].waves.late_balance)
    expected = 2.0 * 0.381 * (1.0 / REFLECTED_SPEED - 1.0 / ROD_SPEED)
    for k in (0, 1):
        assert late[0][k] - late[1][k] == pytest.approx(expected, abs=0.3e-6)


@pytest.mark.verify
@pytest.mark.parametrize("name", STEEL)
def test_steel_keeps_impulse_and_loses_energy(measured, name):
    """Strain factors of unknown uncertainty: impulses within 5 %. A specimen that yields takes energy."""
    pulses, reduction = steel(measured("steel945-shpb"), name).reduced()
    assert [q.polarity for q in pulses.traces] == [-1, -1]
    assert abs(momentum(reduction).closure) < 0.05
    work = energy(reduction)
    assert 0.0 < work.absorbed < work.incident
    assert work.deformation > 0.9 * work.absorbed


@pytest.mark.verify
def test_both_steel_shots_blame_the_same_distance(measured):
    """What geometry gets wrong is the set-up's, not the shot's: both shots are late by the same, to 0.5 us."""
    late = [steel(measured("steel945-shpb"), name).reduced()[1].waves.late_balance for name in STEEL]
    assert late[0] == pytest.approx(late[1], abs=0.5e-6)


@pytest.mark.parametrize(("channel", "distance", "way", "skip"), [echoes[:4] for echoes in MINI_ECHOES])
def test_speed_of_the_mini_bars_by_their_own_echoes(measured, channel, distance, way, skip):
    """The record's head has 5051.3 m/s, and 40.394 us for 2 x 102.02 mm: within three standard errors, and 0.5 %.

    The incident bar's first two passes meet the specimen and are left out.
    """
    bar, strain = mini_bar(measured("lanl-kolsky"), channel, distance)
    found = calibrate_bar(strain, bar, way, skip)
    assert abs(found.speed.value - MINI_SPEED) < 3.0 * found.speed.error
    assert found.speed.value == pytest.approx(MINI_SPEED, rel=0.005)
    assert abs(found.length.value - 2.0 * distance) < 0.03 * distance  # the gauge is in the middle
    assert found.speed.freedom == found.times.size - 3
