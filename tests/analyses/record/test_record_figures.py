"""Pictures of records: what they show is what the readings hold; nothing is lost, nothing overlaps."""

import dataclasses
from xml.etree import ElementTree

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg

from strikewave.analyses.record.figures import records, spectra
from strikewave.records.campaign import summed
from strikewave.records.health_notice import HealthNotice
from strikewave.records.reading import Request, read_file
from strikewave.records.record import Channel, Record
from strikewave.reporting.chapters import inline_svg
from strikewave.signal.srs import srs

LARGEST = 150_000
STEP = 1e-6
HOSTILE = "_<b>$\\frac{1}{ \x01 & $x^{a$"


def blows(count, peaks=5000.0, width=200e-6, gap=4e-3, noise=0.0, unit="g", name="board", path="a.csv", limit=np.inf):
    """Return the reading of a file with half-sines, and a little noise from a fixed seed."""
    time = np.arange(round(gap * (count + 1) / STEP)) * STEP
    values = 30.0 + max(noise, 1e-6) * np.random.default_rng(7).normal(size=time.size)
    for k in range(count):
        since = (time - gap * (k + 0.7)) / width
        values += np.where(np.abs(since) < 0.5, np.broadcast_to(peaks, count)[k] * np.cos(np.pi * since), 0.0)
    channel = Channel(name, np.clip(values, -limit, limit), STEP, unit=unit)
    return read_file(Record(path, "text", (channel,)), {}, Request())


def dead(values=np.nan):
    return read_file(Record("d.csv", "text", (Channel(HOSTILE, np.full(400, values), 1e-5),)), {}, Request())


@pytest.fixture(scope="module")
def train():
    return blows(15, np.linspace(4800.0, 5200.0, 15), noise=20.0)


KINDS = {
    "one": lambda: blows(1),
    "fifteen": lambda: blows(15, noise=20.0),
    "sixty": lambda: blows(60, gap=1e-3, width=100e-6, noise=50.0),
    "noisy": lambda: blows(3, noise=1200.0),
    "none": lambda: blows(0, noise=20.0),
    "clipped": lambda: blows(3, limit=4000.0, noise=20.0),
    "negative": lambda: blows(3, -5000.0),
    "no unit": lambda: blows(3, unit=""),
    "force": lambda: blows(3, unit="N"),
    "dead": lambda: dead(3.0),
    "not a number": dead,
}


@pytest.mark.verify
@pytest.mark.parametrize("kind", KINDS)
def test_every_record_has_its_pictures(kind):
    """Well-formed, small, the same bytes each time, and with words where there is nothing to draw."""
    file = KINDS[kind]()
    reading = file.channels[0]

    def draw():
        yield records.history(reading)
        yield records.velocity(reading)
        yield records.overlay([(HOSTILE, reading)])
        yield spectra.spectrum(reading)
        yield spectra.record_summary([file], summed([file]), HOSTILE)

    for first, second in zip(draw(), draw(), strict=True):
        svg = inline_svg(first, "p1", "x")
        assert svg == inline_svg(second, "p1", "x")
        assert len(svg.encode()) < LARGEST
        assert ElementTree.fromstring(svg).find(".//text") is not None


def texts(figure):
    return [text.get_text() for axes in figure.axes for text in axes.texts]


def test_what_cannot_be_drawn_is_said():
    nothing, hollow = blows(0, noise=20.0).channels[0], dead().channels[0]
    assert texts(records.velocity(nothing)) == ["no blow was found: there is no velocity to draw"]
    assert texts(spectra.spectrum(nothing)) == ["no blow was found: there is no spectrum to draw"]
    assert texts(records.overlay([("a", nothing)])) == ["there is no blow to draw: every record is bad"]
    assert "no blow found" in records.history(nothing).axes[0].get_title(loc="left")
    assert texts(records.history(hollow))[0].endswith("no record to draw")
    assert texts(spectra.record_summary([], None)) == ["there is no record to draw"]
    assert spectra.response(nothing) is None


def drawn_texts(figure):
    """Return what is written, with its box in pixels."""
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    renderer = canvas.get_renderer()
    found = []
    for axes in figure.axes:
        marks = [*axes.texts, axes.title, axes._left_title, axes.xaxis.label, axes.yaxis.label]
        for axis in (axes.xaxis, axes.yaxis):
            low, high = sorted(axis.get_view_interval())
            marks += [tick.label1 for tick in axis.get_major_ticks() if low <= tick.get_loc() <= high]
        found += [(mark.get_text(), mark.get_window_extent(renderer)) for mark in marks if mark.get_text()]
    for legend in figure.legends:
        found += [(text.get_text(), text.get_window_extent(renderer)) for text in legend.get_texts()]
    return found


@pytest.mark.verify
def test_nothing_that_is_written_overlaps(train):
    reading = train.channels[0]
    campaign = summed([train, *(blows(5, peaks, path=str(peaks)) for peaks in (4000.0, 5000.0, 5500.0))])
    many = [(f"a rather long name of a file, number {k}", blows(2, path=str(k)).channels[0]) for k in range(8)]
    figures = [
        records.history(reading),
        records.velocity(reading),
        records.overlay(many),
        spectra.spectrum(reading),
        records.trend(campaign, count=4),
        spectra.srs_figure(spectra.response(reading)),
        spectra.tripartite(spectra.response(reading, "pseudo-velocity")),
        spectra.record_summary([train], summed([train]), "A title"),
    ]
    for figure in figures:
        boxes = drawn_texts(figure)
        width, height = figure.canvas.get_width_height()
        for k, (one, box) in enumerate(boxes):
            assert box.x0 >= -1.0, one
            assert box.x1 <= width + 1.0, one
            assert box.y0 >= -1.0, one
            assert box.y1 <= height + 1.0, one
            for other, beside in boxes[k + 1 :]:
                clear = min(box.x1, beside.x1) - max(box.x0, beside.x0) < 1.0
                assert clear or min(box.y1, beside.y1) - max(box.y0, beside.y0) < 1.5, (one, other)


def test_a_long_record_keeps_its_highest_and_lowest_sample(rng):
    values = rng.normal(size=1_000_003)
    values[[123_457, 900_001]] = 500.0, -400.0
    file = read_file(Record("long", "text", (Channel("a", values, STEP, unit="N"),)), {}, Request())
    line = records.history(file.channels[0]).axes[0].lines[0]
    assert line.get_ydata().max() == 0.5  # kN
    assert line.get_ydata().min() == -0.4
    assert line.get_xdata().size <= 2 * records.COLUMNS + 1


def test_marks_of_a_history_stand_at_the_peaks(train):
    reading = train.channels[0]
    axes = records.history(reading).axes[0]
    [marks] = [line for line in axes.lines if line.get_marker() == "o"]
    assert marks.get_xdata() == pytest.approx([1e3 * p.time for p in reading.pulses])
    assert marks.get_ydata() == pytest.approx([(p.peak + p.offset) / 9.80665 for p in reading.pulses])
    assert [text.get_text() for text in axes.texts] == [str(k) for k in range(1, 16)]
    assert axes.get_ylabel() == "acceleration (g)"


def test_findings_are_marked_where_they_are():
    clipped = blows(3, limit=4000.0, noise=20.0).channels[0]
    figure = records.history(clipped)
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert {"clipped", "blow", "peak", "baseline", "smooth pulse"} <= set(labels)
    hatched = [patch for patch in figure.axes[0].patches if patch.get_hatch()]
    assert hatched
    drift = blows(1).channels[0].with_finding(HealthNotice("zero-shift", "", start=3e-3))
    assert "zero-shift" in [text.get_text() for text in records.history(drift).legends[0].get_texts()]


def test_velocity_rises_by_the_change_of_each_blow(train):
    reading = train.channels[0]
    line = records.velocity(reading).axes[0].lines[0]
    assert line.get_ydata()[-1] == pytest.approx(sum(p.velocity_change for p in reading.pulses), rel=0.01)
    assert np.interp(1e3 * reading.pulses[0].begin, line.get_xdata(), line.get_ydata()) == pytest.approx(0.0, abs=0.2)


def test_amplitude_spectrum_begins_at_the_velocity_change_and_marks_frequencies():
    reading = blows(1, noise=5.0).channels[0]
    frequency, magnitude = spectra.amplitude(reading)
    assert magnitude[frequency < 300.0] == pytest.approx(reading.pulses[0].velocity_change, rel=0.02)
    first_zero = 1.5 / 200e-6  # of a half-sine
    assert magnitude[np.abs(frequency - first_zero) < 100.0].min() < 1e-3 * magnitude[0]
    labels = [text.get_text() for text in spectra.spectrum(reading, 5.22e3).legends[0].get_texts()]
    assert labels == ["the largest blow", "advised cutoff, 5.22 kHz", "half the sampling rate, 500 kHz"]
    ringing = dataclasses.replace(reading.pulses[0], ringing_frequency=11e3)
    labels = spectra.spectrum(dataclasses.replace(reading, pulses=(ringing,))).legends[0].get_texts()
    assert labels[1].get_text() == "ringing, 11 kHz"


def test_thinned_spectrum_keeps_its_extremes(rng):
    frequency, magnitude = np.linspace(1.0, 1e6, 300_000), rng.uniform(1.0, 2.0, 300_000)
    magnitude[[0, 777, 250_000]] = 9.0, 5.0, 0.1
    f, m = spectra._thin_log(frequency, magnitude)
    assert f.size <= 2 * spectra.COLUMNS + 2
    assert {9.0, 5.0, 0.1} <= set(m)
    assert np.all(np.diff(f) >= 0.0)


def test_overlay_aligns_peaks_and_leaves_bad_records_out():
    good, bad = blows(2, noise=10.0), blows(3, limit=4000.0, noise=10.0)
    named = [("good", good.channels[0]), ("bad", bad.channels[0]), ("other", blows(1).channels[0])]
    axes = records.overlay(named).axes[0]
    assert axes.get_title(loc="left") == "3 blows of 2 files, aligned at their peaks"
    for line in axes.lines:
        top = np.argmax(line.get_ydata())
        assert line.get_ydata()[top] == pytest.approx(5000.0, rel=0.01)
        assert line.get_xdata()[top] == pytest.approx(0.0, abs=10.0)
    assert axes.get_legend_handles_labels()[1] == ["good", "other", "median"]
    nine = records.overlay([(str(k), good.channels[0]) for k in range(9)]).axes[0]
    assert nine.get_legend_handles_labels()[1] == ["median"]


class OnDisk:
    """Samples of which only parts can be had, as they lie on disk: each part is counted."""

    def __init__(self, values):
        self._values, self.size, self.read = values, values.size, 0

    def __getitem__(self, part):
        assert isinstance(part, slice)
        self.read += self._values[part].size
        return self._values[part]


def test_overlay_of_a_campaign_reads_no_more_of_each_record_than_its_blow():
    """Samples of long campaigns lie on disk: an overlay that looked at all would bring them all back into memory."""
    reading = blows(1, gap=20e-3).channels[0]
    named, disks = [], []
    for k in range(3):
        disks.append(OnDisk(reading.channel.values))
        named.append(
            (str(k), dataclasses.replace(reading, channel=dataclasses.replace(reading.channel, values=disks[k])))
        )
    assert len(records.overlay(named).axes[0].lines) == 4
    span = (reading.pulses[0].end - reading.pulses[0].begin) / STEP
    # drawn once and averaged once, from 1.2 lengths before the peak to 2 after it, and the sample at the end
    assert max(disk.read for disk in disks) <= 2 * (3.2 * span + 2)


def test_trend_shows_points_mean_and_how_many_are_left_out():
    peaks = (4000.0, 4200.0, 4400.0, 4600.0, 4800.0, 5000.0)
    files = [blows(2, peak, path=str(peak), noise=5.0) for peak in peaks]
    files.insert(1, blows(2, limit=3000.0, path="clipped"))
    campaign = summed(files)
    axes = records.trend(campaign, count=7).axes
    assert [a.get_title(loc="left") for a in axes] == [
        f"{name} (1 file left out)" for name in ("Peak", "Pulse width at 10 %", "Velocity change", "Interval")
    ]
    lines = {line.get_label(): line for line in axes[0].lines}
    assert lines["blows"].get_xdata().tolist() == [file for file in (1, 3, 4, 5, 6, 7) for _ in range(2)]
    assert lines["mean"].get_ydata() == pytest.approx(4500.0, rel=0.01)
    run, rise = (np.ptp(data) for data in lines["trend"].get_data())
    assert rise / run == pytest.approx(campaign.trends["peak"].slope / 9.80665)
    few = records.trend(summed([files[0], *files[2:4]])).axes[0]  # of three files none stands out
    assert "trend" not in {line.get_label() for line in few.lines}
    none = records.trend(summed([files[1]]))
    assert texts(none) == ["no file gave a value: 1 file left out"]


def test_bounds_of_positive_peaks_are_drawn_above_zero():
    """Of two files that differ much, Student's t would have the mean below zero."""
    campaign = summed([blows(1, peak, path=str(peak)) for peak in (1000.0, 5000.0)])
    assert campaign.statistics["peak"].low < 0.0
    axes = records.trend(campaign).axes[0]
    [bounds] = axes.collections
    assert min(bounds.get_paths()[0].vertices[:, 1]) == 0.0


def test_response_spectrum_shows_both_sides_in_g():
    reading = blows(1).channels[0]
    found = spectra.response(reading)
    figure = spectra.srs_figure(found)
    lines = {line.get_label(): line for line in figure.axes[0].lines}
    assert set(lines) == {"maximax", "positive", "negative"}
    assert lines["maximax"].get_ydata() == pytest.approx(found.maximax / 9.80665)
    high = lines["maximax"].get_ydata()[-1]
    assert high == pytest.approx(5000.0, rel=0.05)  # a stiff oscillator follows its base
    two = spectra.srs_figure(found, found, labels=[HOSTILE])
    assert [line.get_label() for line in two.axes[0].lines] == [records.plain(HOSTILE), "spectrum 2"]
    unknown = spectra.response(blows(1, unit="").channels[0])
    assert "own numbers" in spectra.srs_figure(unknown, unit="").axes[0].get_ylabel()


def test_lines_of_four_coordinate_paper_are_those_they_are_called():
    """At the place of its name, a line's pseudo-velocity is 2 pi f d, or a / (2 pi f)."""
    pulse = 1e4 * np.sin(np.pi * np.arange(201) / 200)
    axes = spectra.tripartite(srs(pulse, STEP, np.geomspace(100.0, 1e5, 60), kind="pseudo-velocity")).axes[0]
    units = {"m": 1.0, "mm": 1e-3, "µm": 1e-6}
    seen = set()
    for text in axes.texts:
        number, unit = text.get_text().replace(" ", "").rstrip("gmµ"), text.get_text().split()[-1]
        frequency, velocity = text.xy
        omega = 2.0 * np.pi * frequency
        value = velocity * omega / 9.80665 if unit == "g" else velocity / omega / units[unit]
        assert value == pytest.approx(float(number), rel=1e-9), text.get_text()
        seen.add(unit)
    assert "g" in seen
    assert seen & set(units)
    FigureCanvasAgg(axes.figure).draw()
    (x0, x1), (y0, y1) = np.log10(axes.get_xlim()), np.log10(axes.get_ylim())
    box = axes.get_window_extent()
    assert box.width / (x1 - x0) == pytest.approx(box.height / (y1 - y0), rel=1e-6)  # so that they stand at 45 degrees
    with pytest.raises(ValueError, match="pseudo-velocity"):
        spectra.tripartite(srs(pulse, STEP, [100.0]))


def test_a_bad_channel_does_not_spoil_another():
    good, bad = blows(1).channels[0], dead(3.0).channels[0]
    file = dataclasses.replace(blows(1), channels=(good, bad))
    assert file.status == "bad"
    assert spectra.best_of([dead(3.0), file]) is good
    assert [reading for _, reading in spectra.usable([file])] == [good]
    spoilt = dataclasses.replace(file, findings=(HealthNotice("time-backwards", "", severity="bad"),))
    assert spectra.usable([spoilt]) == []
    assert spectra.best_of([spoilt]) is good
    assert spectra.best_of([]) is None


def test_names_of_strangers_are_drawn_as_they_are():
    file = blows(2, name=HOSTILE)
    named = [(HOSTILE, file.channels[0]), ("b", blows(1).channels[0])]
    for figure in (records.history(file.channels[0]), records.overlay(named)):
        words = " ".join(ElementTree.fromstring(inline_svg(figure, "p1", "x")).itertext())
        assert "<b>$\\frac{1}{ \ufffd & $x^{a$" in words
