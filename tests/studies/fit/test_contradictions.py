"""A record slower than the machine arrives is named as what no value of the contact can give."""

import numpy as np
import pytest

from strikewave import fit, load_case, run_case

G = 9.80665
CASE = "jesd22-b111-b"
FREE = ["contact.reference_force", "contact.restitution"]


@pytest.fixture
def record(tmp_path):
    """Write the record of a fall from a height, with little rebound, and return its path."""

    def write(height):
        arrays = run_case(load_case(CASE, [f"machine.height={height} m", "contact.restitution=0.2"])).arrays
        time, values = arrays["pulse_time"].values, arrays["pulse_acceleration"].values[0]
        known = np.isfinite(values)
        clock = np.arange(-5e-4, time[known][-1], 2e-6)
        table = np.column_stack([clock, np.interp(clock, time[known], values[known] + G, left=0.0) / G])
        path = tmp_path / f"{height}.csv"
        np.savetxt(path, table, delimiter=",", header="time [s],acceleration [g]", comments="")
        return str(path)

    return write


@pytest.mark.verify
@pytest.mark.parametrize(("height", "named"), [(0.15, True), (0.27949, False)])
def test_a_record_slower_than_its_fall_is_named_with_the_height(record, height, named):
    """Of 0.15 m with 1.2 times its speed, 2.06 m/s: less than the 2.32 m/s of 0.279 m without rebound."""
    study = fit(load_case(CASE), [record(height)], FREE)
    found = [notice for notice in study.notices if notice.code == "slower-than-arrival"]
    assert bool(found) is named
    if named:
        assert found[0] is study.notices[0]
        assert "machine.height" in found[0].message
        assert found[0].value == pytest.approx(1.2 * (2.0 * G * height) ** 0.5, rel=2e-2)
        arrival, light = (2.0 * G * 0.27949) ** 0.5, 20.0 / 2000.0
        assert found[0].limit == pytest.approx(arrival / (1.0 + light), rel=1e-3)


@pytest.mark.verify
def test_a_height_that_is_free_settles_it(record):
    study = fit(load_case(CASE), [record(0.15)], [*FREE, "machine.height"])
    assert "slower-than-arrival" not in [notice.code for notice in study.notices]
