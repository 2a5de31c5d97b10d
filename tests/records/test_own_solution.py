"""The blows that the machine computed, found again in its own result file as if it were measured."""

import math

import pytest

from strikewave.records import Request, read_file, read_record


@pytest.mark.verify
def test_blows_of_a_run_are_found_and_measured_in_its_file(solution, tmp_path):
    solution.save(tmp_path / "solution.nc")
    record = read_record(tmp_path / "solution.nc")
    [reading] = read_file(record, {}, Request(("rigid_acceleration",))).channels
    struck = [blow for blow in solution.blows if blow.kind != "missed"]
    assert reading.channel.unit == "m/s^2"
    assert len(reading.pulses) == len(struck)
    step = reading.channel.step
    for pulse, blow in zip(reading.pulses, struck, strict=True):
        # the file holds a sample each 10 us, 20 a blow: the highest may miss the peak by 1 - cos(pi/40) = 0.3 %
        # of a half-sine, and a parabola through three cannot do worse
        missed = 1.0 - math.cos(math.pi * step / (2.0 * blow.width))
        assert pulse.peak == pytest.approx(blow.rigid_peak, rel=2.0 * missed)
        assert pulse.width == pytest.approx(blow.width, abs=step)
        assert blow.time < pulse.time < blow.time + blow.width
