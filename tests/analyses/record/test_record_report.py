"""The report of measured records: whole, offline, escaped, and its numbers those of the readings."""

import dataclasses
import re
from html.parser import HTMLParser

import numpy as np
import pytest

from strikewave.analyses.record.chapters import MOST_ROWS, mean_sections
from strikewave.analyses.record.report import record_report
from strikewave.analyses.record.result import record_result
from strikewave.analyses.record.screen import MOST_ROWS as SCREEN_ROWS
from strikewave.analyses.record.screen import print_records
from strikewave.analyses.record.sentences import record_words
from strikewave.base.result import Notice, Source
from strikewave.records.campaign import compare, summed
from strikewave.records.health_notice import HealthNotice
from strikewave.records.reading import FileReading, Request, read_file
from strikewave.records.record import Channel, Record
from strikewave.reporting.numbers import in_shown_units
from strikewave.signal.filters import Filter

from ...counted_work import lines_run

STEP = 5e-6
LARGEST = 1_500_000
HOSTILE = "</title><script>alert('1')</script>\" onload=\"x &amp; $\\frac{ \x01\u202e {{ 7 * 7 }}"
FACTS = {"asked": "strikewave read a.csv --unit g", "calibrations": [("--unit", "g")]}
FEW = Notice("few", "too few", 2)


def page_of(files, campaigns, notices=(), asked="", digests=None, **more):
    """The page of a result, with further notices."""
    origin = Source("records", "runs", "", "record.toml", digests or {}, asked)
    result = record_result(files, campaigns, origin=origin, **more)
    return record_report(dataclasses.replace(result, notices=(*result.notices, *notices)))


class Page(HTMLParser):
    """Reads a page strictly."""

    def __init__(self, text):
        super().__init__(convert_charrefs=True)
        self.open, self.tags, self.ids, self.links, self.words = [], [], [], [], []
        self.feed(text)
        self.close()
        assert self.open == []

    def handle_starttag(self, tag, attrs):
        if tag not in {"meta", "br", "hr"}:
            self.open.append(tag)
        self.handle_startendtag(tag, attrs)

    def handle_startendtag(self, tag, attrs):
        found = dict(attrs)
        assert len(found) == len(attrs)
        assert not any(name.startswith("on") for name in found)
        self.tags.append(tag)
        self.ids += [found["id"]] if "id" in found else []
        self.links += [found[name] for name in ("href", "src", "xlink:href") if name in found]

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        if "style" not in self.open and "svg" not in self.open:
            self.words.append(data)

    @property
    def text(self):
        return " ".join(" ".join(self.words).split())


def tables(text):
    """Return caption -> rows of cell texts."""
    found = {}
    for block in re.findall(r'<figure class="table".*?</figure>', text, re.S):
        rows = re.findall(r"<tr>(.*?)</tr>", block, re.S)
        cells = [[re.sub(r"<[^>]*>", "", c) for c in re.findall(r"<t[hd][^>]*>(.*?)</t[hd]>", r, re.S)] for r in rows]
        found[re.search(r"</b> (.*?)</figcaption>", block)[1]] = cells
    return found


def record(peak=5000.0, count=1, unit="g", path="a.csv", name="board", limit=np.inf, size=20_000, extra=()):
    at = np.arange(size) * STEP
    values = 30.0 + 5.0 * np.random.default_rng(round(abs(peak))).normal(size=size)
    for k in range(count):
        since = (at - 0.01 - k * 0.08 / max(count, 1)) / 200e-6
        values += np.where(np.abs(since) < 0.5, peak * np.cos(np.pi * since), 0.0)
        values += np.where(since > 0.5, 0.1 * peak * np.exp(-np.maximum(since, 0.0)) * np.sin(np.pi * 4 * since), 0.0)
    return Record(path, "text", (Channel(name, np.clip(values, -limit, limit), STEP, unit=unit), *extra))


def read(*given, **wanted):
    return compare([read_file(one, {}, Request(**wanted)) for one in given])


@pytest.fixture(scope="module")
def files():
    """Sixteen: one clipped, one silent."""
    peaks = np.linspace(4500.0, 5300.0, 14)
    good = [record(peak, path=f"runs/impact_{k:02}.csv") for k, peak in enumerate(peaks)]
    return read(record(count=0, path="runs/silent.csv"), *good, record(limit=4000.0, path="runs/clipped.csv"))


@pytest.fixture(scope="module")
def page(files, without_lines):
    with without_lines():
        return page_of(files, [summed(files)], [FEW], **FACTS)


@pytest.fixture(scope="module")
def drawn(files):
    return page_of(files, [summed(files)], [FEW], **FACTS)


@pytest.mark.verify
def test_page_is_well_formed_offline_and_the_same_each_time(files, drawn):
    found = Page(drawn)
    assert len(found.ids) == len(set(found.ids))
    assert not {"script", "link", "img", "iframe", "object", "base"} & set(found.tags)
    assert set(re.findall(r"url\(#([^)]+)\)", drawn)) <= set(found.ids)
    assert all(link.startswith(("#", "https://doi.org/10.")) for link in found.links)
    assert "content=\"default-src 'none'; style-src" in drawn
    assert "http:" not in drawn
    assert page_of(files, [summed(files)], [FEW], **FACTS) == drawn


@pytest.mark.verify
def test_sixteen_files_stay_small(drawn):
    assert len(drawn.encode()) < LARGEST


@pytest.mark.verify
def test_summary_says_means_with_bounds_and_what_is_bad(files, page):
    campaign = summed(files)
    peak = campaign.statistics["peak"]
    text = Page(page).text
    assert "16 files: 14 good and 2 bad." in text
    assert f"peak {peak.mean / 9.80665:.0f} g in the mean" in text
    assert f"{peak.low / 9.80665:.0f} to {peak.high / 9.80665:.0f} g" in text
    assert f"grows by {100 * campaign.trends['peak'].change:.2g} %" in text
    assert "silent.csv is bad: no blow stands out of the noise." in text
    assert "clipped.csv is bad: clipped at 4000 g" in text
    assert "Report of measured records" in text


def test_what_is_bad_in_one_of_several_channels_is_named_with_its_channel():
    silent = (Channel("b", np.zeros(100), STEP, unit="m/s^2"),)
    files = read(*(record(count=0, path=f"runs/{k}.csv", extra=silent) for k in (1, 2)))
    text = record_words(
        record_result(files, [summed(files, 1), summed(files, 2)], origin=Source("records", "runs", "", "record.toml"))
    )
    assert f"{files[0].channels[0].channel.name} of 1.csv and" in text
    assert ",," not in text


def silent(count):
    """A result of so many channels, in none of which a blow stands out."""
    channels = tuple(Channel(f"c{k}", np.arange(20.0) + k, STEP) for k in range(count))
    files = read(Record("a.csv", "text", channels))
    origin = Source("records", "a", "", "record.toml")
    return record_result(files, [summed(files, k + 1) for k in range(count)], origin=origin)


def test_channels_without_a_figure_share_a_sentence_and_a_section():
    result = silent(6)
    assert "c0, c1, c2, c3 and 2 more: No record gave a peak that can be trusted." in record_words(result)
    [section] = mean_sections(result.campaigns, result.readings, {})
    [table] = section.parts
    assert [row[:2] for row in table.rows] == [[f"c{k}", "a.csv"] for k in range(6)]
    assert all("no blow stands out of the noise" in row[2] for row in table.rows)


def test_reasons_of_hundreds_of_channels_fit_on_a_screen(capsys):
    result = silent(200)
    [file] = result.readings

    def own(reading):
        return tuple(dataclasses.replace(f, message=f"{f.message}, {reading.number}") for f in reading.findings)

    channels = tuple(dataclasses.replace(one, findings=own(one)) for one in file.channels)
    print_records(dataclasses.replace(result, readings=[dataclasses.replace(file, channels=channels)]))
    printed = capsys.readouterr().out
    assert "more reasons: see report and JSON" in " ".join(printed.split())
    assert len(printed.splitlines()) < SCREEN_ROWS + 20


def test_the_figures_of_hundreds_of_channels_are_a_few_sentences(files):
    campaign = summed(files)
    campaigns = [dataclasses.replace(campaign, channel=f"c{k}") for k in range(200)]
    words = record_words(dataclasses.replace(silent(1), campaigns=campaigns))
    assert "c5: " in words
    assert "c6: " not in words
    assert "194 more channels gave a peak, see below." in words


class Counting(tuple):
    """Channels that count how often one of them is looked at in a loop, which `lines_run` does not see in one line."""

    looks = 0

    def __iter__(self):
        for one in super().__iter__():
            Counting.looks += 1
            yield one


@pytest.mark.verify
def test_work_of_page_and_screen_grows_with_the_number_of_channels(capsys):
    def shown(result):
        record_report(result)
        print_records(result)

    lines, looks = [], []
    for count in (4, 100, 200):  # the first one imports what is needed
        result = silent(count)
        [file] = result.readings
        Counting.looks = 0
        lines.append(
            lines_run(
                shown,
                dataclasses.replace(result, readings=[dataclasses.replace(file, channels=Counting(file.channels))]),
            )
        )
        looks.append(Counting.looks)
    assert (lines[2] - lines[0]) / (lines[1] - lines[0]) < 2.3
    assert looks[2] / looks[1] < 2.3


def test_every_file_finding_and_blow_is_listed(files, page):
    found = tables(page)
    rows = next(rows for caption, rows in found.items() if caption.startswith("Files"))
    assert [row[0] for row in rows[1:]] == [file.path.removeprefix("runs/") for file in files]
    assert [row[1] for row in rows[1:]] == [file.status for file in files]
    peaks = [f"{file.channels[0].figures('peak')[0] / 9.80665:.4g}" if file.status == "good" else "–" for file in files]
    assert [row[rows[0].index("peak (g)")] for row in rows[1:]] == peaks
    words = Page(page).text
    for file in files:
        for finding in file.all_findings:
            assert in_shown_units(finding.message) in words
    blows = found["Blows"]
    assert len(blows) == 1 + sum(len(file.channels[0].pulses) for file in files)
    first = files[1].channels[0].pulses[0]
    row = next(row for row in blows if row[0] == "impact_00.csv")
    assert row[2:5] == [f"{first.time * 1e3:.3f}", f"{first.peak / 9.80665:.4g}", f"{first.rise * 1e6:.4g}"]
    smooth = [f"{first.smooth.peak / 9.80665:.4g}", f"{first.smooth.width() * 1e6:.4g}"]
    place = blows[0].index("method")
    assert row[place : place + 3] == ["record", *smooth]
    assert set(row[place + 3 :]) <= {"–"}  # no mode explains what rings


def test_campaign_trend_and_what_was_left_out(files, page):
    campaign, found = summed(files), tables(page)
    means = {row[0]: row[1:] for row in found["Means and scatter, with bounds at 95 %"][1:]}
    assert means["peak (g)"][:2] == ["14", f"{campaign.statistics['peak'].mean / 9.80665:.4g}"]
    trends = {row[0]: row for row in found["Trend a file, with bounds at 95 %"][1:]}
    assert trends["peak (g)"][1] == f"{campaign.trends['peak'].slope / 9.80665:.3g}"
    assert trends["peak (g)"][-1] == "yes"
    assert {row[0] for row in found["Left out of the means"][1:]} == {"silent.csv", "clipped.csv"}


def test_only_some_files_are_drawn_and_the_page_says_so(page):
    text = Page(page).text
    assert "6 of 16 files are drawn: the first that are not good, and the first good ones." in text
    captions = re.findall(r"<b>Figure \d+\.</b> ([^,<]*), board", page)
    assert set(captions) == {"silent.csv", "clipped.csv", *(f"impact_{k:02}.csv" for k in range(4))}


def test_without_a_filter_the_page_advises_one(page):
    rows = next(rows for caption, rows in tables(page).items() if caption.startswith("What filters leave"))
    assert [row[0].partition(":")[0] for row in rows[1:]] == ["advised", "CFC 1000 (SAE J211)", "CFC 600 (SAE J211)"]
    assert rows[1][2].startswith("99")
    assert float(rows[1][3].rstrip(" %")) == pytest.approx(102.0, abs=0.3)
    assert float(rows[2][2].rstrip(" %")) == pytest.approx(52.0, abs=2.0)


@pytest.mark.verify
def test_what_a_filter_did_stands_beside_what_was_before():
    used = Filter.sae_j211(1000)
    files = read(record(count=2), filter=used)
    page = page_of(files, [summed(files)], filter=used, **FACTS)
    rows = tables(page)["Blows before and after the filter"][1:]
    reading = files[0].channels[0]
    assert len(rows) == 2
    for row, before, after in zip(rows, reading.unfiltered, reading.pulses, strict=True):
        assert row[3:5] == [f"{p.peak / 9.80665:.4g}" for p in (before, after)]
        assert float(row[5].rstrip(" %")) == pytest.approx(100.0 * after.peak / before.peak, rel=0.01)
    assert "went through: CFC 1000 (SAE J211)." in Page(page).text
    half_sine = next(rows for caption, rows in tables(page).items() if caption.startswith("What filters leave"))
    assert len(half_sine) == 2


@pytest.mark.verify
def test_calibration_and_command_are_told(files, page):
    found = tables(page)
    assert found["Where it was stated"][1:] == [["--unit", "g"]]
    assert "strikewave read a.csv --unit g" in page
    assert found["Warnings; value and limit in SI units"][-1] == ["few", "too few", "2", "–", "warning"]
    assert "impact_00.csv" in page
    stated = read(record(unit="V"), calibrations={"all": {"sensitivity": "2 mV/g", "polarity": -1}})
    told = page_of(stated, [summed(stated)])
    assert tables(told)["What each channel was taken as"][1][1:3] == ["sensitivity 2 mV/g, polarity -1", "m/s²"]
    digests = {file.path: f"{k:064x}" for k, file in enumerate(files[:2])}
    sealed = page_of(files[:2], [], digests=digests)
    assert ["runs/impact_00.csv", f"{1:064x}"] in tables(sealed)["Files read"]
    assert "SHA-256 of the files" in sealed
    assert "SHA-256 of the files" not in page


@pytest.mark.verify
def test_hostile_names_come_out_as_text():
    extra = (Channel(HOSTILE + "2", np.full(500, np.nan), STEP),)
    files = read(record(path=HOSTILE, name=HOSTILE, unit=HOSTILE[:20], extra=extra))
    said = HealthNotice(HOSTILE, HOSTILE, severity="suspect", start=0.01)
    files = [dataclasses.replace(files[0], format=HOSTILE, findings=(said,))]
    facts = {"asked": HOSTILE, "calibrations": [(HOSTILE, HOSTILE)], "digests": {HOSTILE: HOSTILE}}
    page = page_of(files, [summed(files, 1), summed(files, 2)], [Notice(HOSTILE, HOSTILE)], **facts)
    found = Page(page)
    assert "<script" not in page
    assert "script" not in found.tags
    assert "\x01" not in page
    assert found.text.count("{{ 7 * 7 }}") >= 10
    assert "alert(" in found.text


@pytest.mark.verify
def test_one_file_and_no_file_and_nothing_but_bad_ones():
    one = read(record(count=15))
    text = Page(page_of(one, [summed(one)], **FACTS)).text
    assert "One file, good. 15 blows" in text
    assert "A trend needs values from three files." in text
    assert "interval" in text
    none = page_of([], [])
    for words in (
        "No file was read.",
        "No blow was found.",
        "There is no record to draw.",
        "The command is not known.",
    ):
        assert words in Page(none).text
    bad = read(record(count=0), Record("nan", "text", (Channel("x", np.full(99, np.nan), STEP),)))
    text = Page(page_of([*bad, FileReading("void", "text", ())], [summed(bad)], **FACTS)).text
    for words in (
        "No record gave a peak that can be trusted.",
        "holds nothing that could be drawn",
        "there is no spectrum",
        "There is no blow to filter.",
        "no channel was read",
    ):
        assert words in text


@pytest.mark.verify
def test_units_that_are_not_known_or_differ_are_said():
    unknown = read(record(unit="", peak=-5000.0))
    page = page_of(unknown, [summed(unknown)], **FACTS)
    assert "peak (file&#39;s own numbers)" in page
    assert "four-coordinate paper" not in page
    mixed = read(record(), record(unit="N", path="b.csv"))
    page = page_of(mixed, [summed(mixed)], **FACTS)
    assert "in different units, N and m/s^2: peak and velocity change are summed up in the usual one" in Page(page).text
    assert "it is in N, the other files in m/s^2" in Page(page).text


@pytest.mark.verify
def test_two_channels_stand_apart():
    other = record(3000.0, name="frame").channels
    files = read(*(record(5000.0 + k, path=f"{k}.csv", extra=other) for k in range(3)))
    page = page_of(files, [summed(files, 1), summed(files, 2)], **FACTS)
    contents = re.findall(r'<li><a href="#section-\d+">(.*?)</a>', page)
    assert [title for title in contents if title.startswith("Campaign")] == ["Campaign: board", "Campaign: frame"]
    assert {row[1] for row in tables(page)["Blows"][1:]} == {"board", "frame"}
    mean = summed(files, 2).statistics["peak"].mean
    assert f"frame: 3 blows, peak {mean / 9.80665:.4g} g" in Page(page).text


@pytest.mark.verify
def test_a_long_list_of_blows_is_cut_and_says_so():
    files = read(record(count=8))
    reading = files[0].channels[0]
    many = dataclasses.replace(files[0], channels=(dataclasses.replace(reading, pulses=reading.pulses * 40),))
    page = page_of([many], [], **FACTS)
    assert len(tables(page)["Blows"]) == MOST_ROWS + 1
    assert f"The first {MOST_ROWS} of 320 blows are listed." in Page(page).text


@pytest.mark.verify
def test_findings_that_files_share_stand_once():
    files = read(*(record(unit="", path=f"{k}.csv") for k in range(6)))
    rows = tables(page_of(files, [summed(files)], **FACTS))["Findings, the worst first"][1:]
    assert [row[0] for row in rows if row[3] == "unit-unknown"] == ["6 files, 0.csv to 5.csv"]
