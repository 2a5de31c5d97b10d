"""Which of several records stand for all: those that may be used, whose spectrum is shown, what they are called."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

from strikewave.records.campaign import Campaign
from strikewave.records.health_notice import STATUSES, worst
from strikewave.records.reading import ChannelReading, FileReading
from strikewave.signal.filters import Filter, advised_cutoff


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


def advised_filter(files: Sequence[FileReading]) -> Filter | None:
    """Return the filter that is advised for all files: it changes the steepest blow by at most 2 %.

    Its cutoff has three digits, rounded up. Only blows whose widths enter the means count, where there are any: what is
    no blow is often the steepest. None where no channel is sampled fast enough for one.
    """
    sound = [reading for _, reading in usable(files) if reading.pulses]
    counted = [reading for reading in sound if reading.figures("width")] or sound
    cutoff = max((found for found in map(cutoff_for, counted) if found is not None), default=None)
    if cutoff is None:
        return None
    digit = 10.0 ** (math.floor(math.log10(cutoff)) - 2)
    return Filter(float(f"{math.ceil(cutoff / digit) * digit:.3g}"))


def cutoff_for(reading: ChannelReading) -> float | None:
    """Return the cutoff advised for the steepest blow of a channel, Hz; None where there is none, or it is too high.

    Rise and width are those of the smooth pulse: ringing is what a filter shall take away.
    """
    advised = [
        advised_cutoff(pulse.smooth.rise(), pulse.smooth.width())
        for pulse in reading.unfiltered or reading.pulses
        if pulse.smooth.width() > 0.0
    ]
    cutoff = max(advised, default=math.inf)
    return cutoff if cutoff < 0.5 * reading.channel.sampling_rate else None


def sources_of(files: Sequence[FileReading], campaigns: Sequence[Campaign], filter_: Filter | None) -> tuple[str, ...]:
    """Return the keys of the sources of the methods used."""
    read = any(file.channels for file in files)
    keys = ["siegel-1982"] if read else []
    keys += ["vangel-1996", "croux-1992"] if any(campaign.statistics for campaign in campaigns) else []
    keys += ["rosner-1983", "sen-1968"] if any(campaign.trends for campaign in campaigns) else []
    keys += ["smallwood-1981", "iso-18431-4"] if shown_response(files) is not None else []
    j211 = filter_ is None or "J211" in str(filter_)
    return tuple(keys + (["sae-j211"] if j211 and read else []))


def name_of(paths: Sequence[Path]) -> str:
    """Return the name of the only file without its ending, or of the folder of several.

    Examples
    --------
    >>> name_of([Path("shots/a.csv")]), name_of([Path("shots/a.csv"), Path("shots/b.csv")])
    ('a', 'shots')
    """
    return paths[0].stem if len(paths) == 1 else paths[0].absolute().parent.name or "records"


def counted(files: Sequence[FileReading]) -> list[str]:
    """Return how many files there are of each status, in words."""
    statuses = [file.status for file in files]
    return [f"{statuses.count(status)} {status}" for status in STATUSES if status in statuses]
