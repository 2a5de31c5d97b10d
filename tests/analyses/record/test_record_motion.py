"""Velocity and displacement of records: closed forms, and drift against drawn noise."""

import csv
import json
import math

import numpy as np
import pytest

from strikewave.analyses.record.rows import RecordMotion, moved
from strikewave.records import Channel, ChannelCalibration, Request
from strikewave.records.reading import read_channel
from strikewave.signal.motion import IntegratedMotion

STEP, START, WIDTH, SIZE, PEAK = 1e-5, 4000, 100, 8000, 1000.0
CHANGE = 2.0 * PEAK * WIDTH * STEP / math.pi
WAY = CHANGE * (0.5 * WIDTH + SIZE - 1 - START - WIDTH) * STEP
"""Of a half-sine: velocity change, and displacement at the end of the record."""


def blow():
    u = (np.arange(SIZE) - START) / WIDTH
    return np.where((u > 0.0) & (u < 1.0), PEAK * np.sin(np.pi * u), 0.0)


def motion_of(values):
    channel = Channel("x", values, STEP, unit="m/s^2")
    return moved("a.csv", read_channel(channel, 1, ChannelCalibration(), Request()))


def test_clean_half_sine_moves_by_its_closed_form():
    found = motion_of(blow() + 3.0).motion
    # straight lines lose (pi/100)^2/12 = 8e-5 of the area
    assert found.velocity[-1] == pytest.approx(CHANGE, rel=1e-4)
    assert found.displacement[-1] == pytest.approx(WAY, rel=1e-4)
    # rounding and the curve of the blow itself count as a little noise
    assert found.displacement_drift[-1] < 5e-4 * WAY


@pytest.mark.verify
@pytest.mark.parametrize("memory", [0.0, 0.95])
def test_drift_is_what_drawn_noise_does(memory):
    """White noise, and noise that forgets over 20 samples: the ends miss by the drift that is told."""
    rng = np.random.default_rng(3)
    missed = []
    for _ in range(60):
        noise = rng.normal(size=SIZE)
        if memory:
            noise = np.array(list(_remembering(noise, memory)))
        found = motion_of(blow() + noise).motion
        missed.append(
            [
                (found.velocity[-1] - CHANGE) / found.velocity_drift[-1],
                (found.displacement[-1] - WAY) / found.displacement_drift[-1],
            ]
        )
    # 60 draws know a standard deviation to 9 %; the wander is known from some twenty widths, to 16 % each
    assert np.sqrt(np.mean(np.square(missed), axis=0)).min() > 0.6
    assert np.sqrt(np.mean(np.square(missed), axis=0)).max() < 1.5


def _remembering(noise, memory):
    last = 0.0
    for one in noise:
        last = memory * last + math.sqrt(1.0 - memory**2) * one
        yield last


def test_a_displacement_below_its_drift_is_lost_from_there_to_the_end():
    time = np.arange(5.0)
    way, drift = np.array([0.0, 5.0, 1.0, 5.0, 3.0]), np.arange(5.0)
    none = np.zeros(5)
    assert RecordMotion("a.csv", "x", time, IntegratedMotion(none, way, none, drift)).lost == 4.0
    assert math.isnan(RecordMotion("a.csv", "x", time, IntegratedMotion(none, way + 2.0, none, drift)).lost)


@pytest.mark.verify
def test_the_command_gives_histories_and_where_they_end(strikewave):
    rng = np.random.default_rng(4)
    values = blow() + 5.0 * rng.normal(size=SIZE)
    with open("a.csv", "w") as file:
        file.write("time [s],x [m/s^2]\n")
        file.writelines(f"{k * STEP:.6f},{value:.6g}\n" for k, value in enumerate(values))
    code, out, err = strikewave("record", "a.csv", "--motion", "--out", "a", "--json")
    assert code == 0, err
    [one] = json.loads(out)["motion"]
    assert one["file"] == "a.csv"
    assert one["velocity"] == pytest.approx(CHANGE, abs=4.0 * one["velocity_drift"])
    assert one["lost"] is None
    with open("a/motion.csv") as file:
        head, *rows = csv.reader(file)
    assert head[2:] == [
        *("time [s]", "velocity [m/s]", "displacement [m]", "velocity_drift [m/s]", "displacement_drift [m]")
    ]
    assert float(rows[-1][4]) == pytest.approx(one["displacement"], rel=1e-8)
    again, _, err = strikewave("record", "a.csv", "--motion", "--out", "a", "--json")
    assert again == 0, err  # every file that it wrote is one of a result, and may be replaced
    code, out, _ = strikewave("record", "a.csv", "--motion")
    assert "drift exceeds the" in out


def test_what_is_no_acceleration_does_not_move():
    channel = Channel("x", blow(), STEP, unit="N")
    assert moved("a.csv", read_channel(channel, 1, ChannelCalibration(), Request())) is None
