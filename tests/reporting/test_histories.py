"""Histories as CSV and Parquet: the reader of measured files finds in them the numbers of the run."""

import pytest

from strikewave import load_case, run_case
from strikewave.base.units import parse_quantity
from strikewave.records.readers import read_record
from strikewave.reporting.numbers import ShownUnits, showing
from strikewave.reporting.table_files import write_histories


@pytest.fixture(scope="module")
def run():
    return run_case(load_case("li-ma-2019", ["feed.blows=1"]))


@pytest.mark.parametrize("form", ["csv", "parquet"])
@pytest.mark.parametrize("units", ["", "g,us,kN"])
def test_record_reader_finds_the_peak_of_the_run(run, tmp_path, form, units):
    with showing(ShownUnits.read(units) if units else None):
        names = write_histories(run, tmp_path, form)
    assert names == [f"{stem}.{form}" for stem in ("histories", "histories-pulse", "histories-record")]
    record = read_record(tmp_path / names[0])
    channel = next(one for one in record.channels if one.name.startswith("rigid_acceleration"))
    size = parse_quantity(f"1 {channel.unit}", "m/s^2", "")
    # nine digits are written
    assert channel.values.max() * size == pytest.approx(float(run.data["rigid_acceleration"].max()), rel=1e-8)
    assert channel.step == pytest.approx(run.case.solver.output_step.si, rel=1e-6)
