"""The sections on stress waves and sensors: what they show is what the solution holds."""

import dataclasses
import re

import numpy as np
import pytest

from strikewave import load_case, run_case, run_wave
from strikewave.analyses.layered_bars import LOSS_FREQUENCIES, loss_tables
from strikewave.analyses.machine.report import report
from strikewave.analyses.wave.report import wave_report
from strikewave.base.constants import STANDARD_GRAVITY
from strikewave.base.result import Band


@pytest.fixture(scope="module")
def struck():
    return run_case(load_case("li-ma-2019-fig5", ["feed.blows=2"]))


@pytest.fixture(scope="module")
def bar():
    return run_wave(load_case("li-ma-2019-fig13-bar"))


@pytest.mark.verify
def test_every_peak_of_taps_and_sensors_stands_in_the_report(struck):
    page = report(struck)
    for blow, reading in zip(struck.blows, struck.readings, strict=True):
        for value in (blow.rigid_peak, reading.total_peak, reading.wave_peak):
            assert f"{value / STANDARD_GRAVITY:.0f}" in page
        for pulse in reading.sensors.values():
            assert f"{pulse.peak / STANDARD_GRAVITY:.0f}" in page
    for words in ("Stress along the stack", "Insertion loss", "direct", "buffered", "route: exact"):
        assert words in page
    assert page.count("data:image/png") == 2  # the x-t field and its scale are the only rasters


@pytest.mark.verify
def test_the_summary_says_what_the_specimen_and_the_sensors_felt(struck, bar):
    reading = struck.readings[0]
    page = report(struck)
    assert f"At the tap sensors it reaches {reading.total_peak / STANDARD_GRAVITY:.0f} g in all, at 11.9 kHz." in page
    for name, pulse in reading.sensors.items():
        assert f"{name} {pulse.peak / STANDARD_GRAVITY:.0f} g" in page
    assert "A layered bar under its load, route exact. Signed peak values: sensor (in sensor):" in wave_report(bar)


@pytest.mark.verify
def test_a_gap_and_a_refused_peak_are_said_in_the_report():
    page = report(run_case(load_case("li-ma-2019-fig13", ["feed.blows=1"])))
    assert "rise-too-steep" in page
    assert "No peak of total and wave is quoted" in page
    assert "Rigid, total and wave acceleration</caption>" not in page
    for route in ("exact, total", "as printed, wave", "corrected, wave", "superposed: rigid + as printed"):
        assert route in page


def test_insertion_loss_table_is_that_of_the_continuous_layers(struck):
    from strikewave.cases.stack_of_case import build_channels
    from strikewave.sensors import insertion_loss

    channels = build_channels(struck.case)
    [table] = loss_tables(channels)
    (row,) = table.rows
    expected = insertion_loss(channels[1].sensor.mounting, np.array(LOSS_FREQUENCIES))
    assert row[0] == "buffered"
    assert [float(cell) for cell in row[1:]] == pytest.approx(expected, abs=0.051)  # one decimal is written


@pytest.mark.verify
def test_bar_report_lists_the_lengths_used_and_the_bound(bar):
    page = wave_report(bar)
    assert f"velocity {bar.accuracy[0]:.1e}" in page
    for layer in bar.waves.layers:
        assert layer.name in page
        assert f"<td>{layer.steps}</td>" in page.replace(' class="number"', "") or str(layer.steps) in page
    assert "strikewave wave" in page
    assert re.search(r"SHA-256|sha256", page)


@pytest.mark.verify
def test_names_of_layers_and_taps_are_text_in_the_report(bar):
    hostile = "<script>alert(1)</script>"
    first, *others = bar.waves.layers
    stack = dataclasses.replace(bar.waves, layers=(dataclasses.replace(first, name=hostile), *others))
    page = wave_report(dataclasses.replace(bar, waves=stack))
    assert hostile not in page
    assert "&lt;script&gt;" in page


@pytest.mark.verify
def test_the_same_run_gives_the_same_page(bar):
    assert wave_report(bar) == wave_report(run_wave(load_case("li-ma-2019-fig13-bar")))


@pytest.mark.usefixtures("undrawn")
def test_key_numbers_are_those_of_the_first_tap_and_of_each_sensor(read_page, tmp_path):
    """On the page as in Python; the band of the stress is that of the force over the area, with the sign of the value."""
    solution = run_wave(load_case("li-ma-2019-fig13-bar"))
    force = abs(solution.peaks(0).force)
    band = {"tap.sensor.peak_force": Band(0.9 * force, 1.2 * force, 0.95)}
    banded = dataclasses.replace(solution, band=band)
    numbers = dict(banded.highlights())
    assert list(numbers) == ["force at sensor", "stress at sensor", "velocity at sensor", "taps"]
    area = solution.run.stack.layers[solution.taps[0][1].layer].area
    low, high = (f"{-share * force / area / 1e6:.0f}" for share in (1.2, 0.9))
    assert numbers["stress at sensor"].endswith(f"({low} to {high} MPa)")
    assert numbers["force at sensor"] == "-19.68 kN (-23.6 to -17.7 kN)"
    page = read_page(banded.report(tmp_path / "bar.html"))
    assert {label: re.sub("</?small>", "", page.numbers[label]) for label in numbers} == numbers
