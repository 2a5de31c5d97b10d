"""What is kept out of a fit and predicted: the scatter that is stated of it is in its band."""

import numpy as np
import pytest

from strikewave import fit, load_case
from strikewave.studies.simulation import Simulation

CASE = load_case("jesd22-b111-b")


@pytest.mark.verify
def test_a_stated_scatter_of_a_record_that_is_kept_out_widens_the_bands_of_its_amplitude(tmp_path):
    """By 1.96 times 2 % of peak and velocity change, in squares; a width has none of it."""
    history = Simulation(CASE).history("").history
    rows = np.column_stack([history.time - history.start, history.values])[::3]
    record = tmp_path / "kept.csv"
    np.savetxt(record, rows, delimiter=",", header="time (s),board (m/s2)", comments="")

    def widths(told):
        study = fit(CASE, ["first.rigid_peak=1500 g +- 1 %"], ["contact.reference_force"], check_on=[f"{record}{told}"])
        figures = study.checks.figures
        return {one.figure: ((one.high - one.low) / (2.0 * one.predicted)) ** 2 for one in figures}

    plain, scattered = widths(""), widths(" +- 2 %")
    assert scattered["width"] == pytest.approx(plain["width"], rel=1e-9)
    for name in ("peak", "velocity change"):
        assert scattered[name] - plain[name] == pytest.approx((1.96 * 0.02) ** 2, rel=1e-6)
