"""The pictures of a report of records: histories, velocities, amplitude and shock response spectra."""

from __future__ import annotations

from collections.abc import Sequence

from strikewave.analyses.record.chapters import same_channel
from strikewave.analyses.record.chosen import advised_filter, shown_response
from strikewave.analyses.record.figures import records, spectra
from strikewave.analyses.record.figures.campaigns import trend
from strikewave.analyses.record.tables import Names, amount, called
from strikewave.records.campaign import Campaign
from strikewave.records.reading import ChannelReading, FileReading
from strikewave.reporting.numbers import listed
from strikewave.reporting.parts import Part, Picture, Section

MOST_FILES = 6
"""Files of which there are pictures: each adds some 100 kB to a page that must open at once."""
MOST_DRAWN = 12
"""Channels of which there are pictures, in all files together: two of each file."""


def campaign_sections(campaigns: Sequence[Campaign], files: Sequence[FileReading], names: Names) -> list[Section]:
    """Draw the blows of each channel over each other, and its figures over the files; nothing where no blow is."""
    sections = []
    for campaign in campaigns:
        parts: list[Part] = []
        named = [(names[path], reading) for path, reading in same_channel(files, campaign)]
        if any(reading.pulses and reading.status != "bad" for _, reading in named):
            several = sum(len(reading.pulses) for _, reading in named) > 1
            words = "Blows of the files over each other; bad records are left out." if several else "The only blow."
            parts.append(Picture(records.overlay(named), words))
        if len({k for pairs in campaign.points.values() for k, _ in pairs}) > 1:
            words = "Figures over the files, in the order in which they were given. What was left out is not drawn."
            parts.append(Picture(trend(campaign, len(files)), words))
        if parts:
            title = f"Pulses: {campaign.channel}" if len(campaigns) > 1 else "Pulses"
            sections.append(Section(title, "", parts))
    return sections


def picture_section(files: Sequence[FileReading], names: Names) -> Section:
    """Draw records, velocities and amplitude spectra."""
    chosen, advised = _chosen(files), advised_filter(files)
    each = max(MOST_DRAWN // max(len(chosen), 1), 1)
    parts: list[Part] = []
    words = []
    for file in chosen:
        for reading in file.channels[:each]:
            if reading.responses:
                continue  # a chapter of its own draws it
            if records.drawable(reading):
                parts += _pictures(names[file.path], reading, None if advised is None else advised.cutoff)
            else:
                words.append(f"{names[file.path]}, {reading.channel.name} holds nothing that could be drawn.")
    if len(chosen) < len([file for file in files if file.channels]):
        words.append(
            f"{len(chosen)} of {len(files)} files are drawn: the first that are not good, and the first good ones."
        )
    if any(len(file.channels) > each for file in chosen):
        words.append(f"Of each, the first {'channel is' if each == 1 else f'{each} channels are'} drawn.")
    return Section("Records", " ".join(words) or ("" if parts else "There is no record to draw."), parts)


def _chosen(files: Sequence[FileReading]) -> list[FileReading]:
    """Return the files that are drawn: all of a few, else the first three that are not good and the first good."""
    have = [k for k, file in enumerate(files) if file.channels]
    if len(have) > MOST_FILES:
        faulty = [k for k in have if files[k].status != "good"]
        good = [k for k in have if files[k].status == "good"]
        many = min(len(faulty), max(MOST_FILES // 2, MOST_FILES - len(good)))
        have = sorted([*faulty[:many], *good[: MOST_FILES - many]])
    return [files[k] for k in have]


def _pictures(name: str, reading: ChannelReading, advised: float | None) -> list[Part]:
    who = f"{name}, {reading.channel.name}"
    count = len(reading.pulses)
    blows = "no blow" if not count else "one blow" if count == 1 else f"{count} blows"
    text = f"{who}: {reading.status}, {blows}."
    if not reading.pulses:
        return [Picture(records.history(reading), f"{text} There is no velocity and no spectrum without a blow.")]
    unit = reading.channel.unit
    peaks = [amount("peak", unit, pulse.peak) for pulse in reading.pulses[:3]]
    return [
        Picture(
            records.history(reading),
            f"{text} The whole record, and the largest blow with its smooth pulse.",
            f"Record of {who}, {blows}: peaks {listed(peaks)}" + (" and more." if count > 3 else "."),
        ),
        Picture(
            records.velocity(reading),
            f"{who}: the integral of the record; the baseline before the first blow is taken off.",
        ),
        Picture(
            spectra.spectrum(reading, advised),
            f"{who}: amplitude spectrum |X(f)| of the stretch around the largest blow. At low frequency it is the "
            f"{called('velocity_change', unit)}.",
        ),
    ]


def response_section(files: Sequence[FileReading], names: Names) -> Section:
    """Draw the shock response spectra of the first good record."""
    title = "Shock response spectrum"
    best = shown_response(files)
    if best is None:
        return Section(title, "No record that is not bad holds a blow and an acceleration: there is no spectrum.")
    file, reading = best
    absolute = spectra.response(reading)
    if absolute is None:
        return Section(title, "The record is too short beside its blow for a spectrum.")
    who = f"{names[file.path]}, {reading.channel.name}"
    text = (
        f"Of {who}, the first that is {reading.status}: from just before its first blow to {spectra.AFTER:g} lengths "
        f"of the last one after it, baseline taken off, Q = {spectra.Q:g} (5 % of critical damping), 12 natural "
        "frequencies an octave. The oscillators swing on after the record."
    )
    harmed = [f.code for f in reading.findings if "spectrum" in f.harms]
    if harmed:
        text += f" Not to be trusted without a look at the findings {listed(harmed)}."
    unit = reading.channel.unit
    parts: list[Part] = [
        Picture(
            spectra.srs_figure(absolute, unit=unit),
            "Largest response of oscillators whose base moves as the record says, over their natural frequency: "
            "upwards (positive), downwards (negative), and the larger of both (maximax).",
        )
    ]
    pseudo = spectra.response(reading, "pseudo-velocity") if unit == "m/s^2" else None
    if pseudo is not None:
        words = (
            "The same record as pseudo-velocity on four-coordinate paper: rising lines are those of one relative "
            "displacement, falling ones those of one acceleration."
        )
        parts.append(Picture(spectra.tripartite(pseudo), words))
    return Section(title, text, parts)
