"""Which of several records stand for all: those that may be used, and the one whose spectrum is shown."""

from __future__ import annotations

from collections.abc import Sequence

from strikewave.records.campaign import Campaign
from strikewave.records.health_notice import STATUSES, worst
from strikewave.records.reading import ChannelReading, FileReading
from strikewave.signal.filters import Filter


def usable(files: Sequence[FileReading]) -> list[tuple[FileReading, ChannelReading]]:
    """Return the channels that are not bad, of files that are not: a bad channel does not spoil another."""
    sound = [file for file in files if worst(file.findings) != "bad"]
    return [(file, reading) for file in sound for reading in file.channels if reading.status != "bad"]


def best_of(files: Sequence[FileReading]) -> ChannelReading | None:
    """Return the first channel of the first file in which it is good; else suspect; else any."""
    firsts = [file.channels[0] for file in files if file.channels]
    sound = [reading for file, reading in usable(files) if reading is file.channels[0]]
    return min(sound, key=lambda reading: STATUSES.index(reading.status), default=next(iter(firsts), None))


def shown_response(files: Sequence[FileReading]) -> tuple[FileReading, ChannelReading] | None:
    """Return the record whose spectrum is shown: the first good acceleration, else a suspect one."""
    fit = [
        (file, reading) for file, reading in usable(files) if reading.pulses and reading.channel.unit in ("m/s^2", "")
    ]
    fit.sort(key=lambda row: row[1].channel.unit == "")
    return min(fit, key=lambda row: STATUSES.index(row[1].status), default=None)


def sources_of(files: Sequence[FileReading], campaigns: Sequence[Campaign], filter_: Filter | None) -> tuple[str, ...]:
    """Return the keys of the sources of the methods used."""
    read = any(file.channels for file in files)
    keys = ["siegel-1982"] if read else []
    keys += ["vangel-1996", "croux-1992"] if any(campaign.statistics for campaign in campaigns) else []
    keys += ["rosner-1983", "sen-1968"] if any(campaign.trends for campaign in campaigns) else []
    keys += ["smallwood-1981", "iso-18431-4"] if shown_response(files) is not None else []
    j211 = filter_ is None or "J211" in str(filter_)
    return tuple(keys + (["sae-j211"] if j211 and read else []))
