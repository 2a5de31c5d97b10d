"""What the filters did to each channel, or which would leave all blows as they are."""

from __future__ import annotations

from collections.abc import Sequence

from strikewave.analyses.record.chosen import advised_filter
from strikewave.analyses.record.rows import FilterRow, filter_effect
from strikewave.analyses.record.screen.kit import MOST_LINES, mean_of, tell_first
from strikewave.analyses.record.tables import rows_of, short_names
from strikewave.base.shock_quantities import BANDWIDTH
from strikewave.records import FileReading
from strikewave.reporting.faces import amount
from strikewave.reporting.numbers import percent
from strikewave.reporting.terminal import tell
from strikewave.signal.filters import ADVISED_LOSS, Filter


def print_filter(files: Sequence[FileReading], filter_: Filter | None) -> None:
    """Say what the filters did to each channel, or which cutoff would leave the steepest blow of all as it is."""
    names = short_names([file.path for file in files]) if len(files) > 1 else {}
    channels = [
        (", ".join([*filter(None, [names.get(file.path)]), reading.channel.name]), reading)
        for file, reading in rows_of(files)
    ]
    passed = [
        f"{called}: {finding.message}"
        for called, reading in channels
        for finding in reading.findings
        if finding.code == "high-pass"
    ]
    tell_first(passed, MOST_LINES, "channels are filtered so")
    if filter_ is None:
        _print_advice(files)
    else:
        effects = [f"{called}: {_effect(filter_effect(reading, filter_))}" for called, reading in channels]
        tell_first(effects, MOST_LINES, "channels are filtered so")


def _print_advice(files: Sequence[FileReading]) -> None:
    """Say which cutoff leaves blows as steep as these as they are."""
    advised = advised_filter(files)
    if advised is not None:
        tell(
            f"a low-pass of {amount(BANDWIDTH, advised.cutoff)} or more (--filter) changes peak, pulse width and "
            f"velocity change of a half-sine as steep as these by at most {percent(ADVISED_LOSS, 0)}"
        )


def _effect(effect: FilterRow) -> str:
    """Say what a filter left of the blows of a channel; see `filter_effect`."""
    sentence = effect.name
    if effect.peak_left:
        peak, width = mean_of(effect.peak_left), mean_of(effect.width_left)
        sentence += f" leaves {percent(peak)} of the peak, {percent(width)} of the width"
    if effect.half_sine_peak_left is not None:
        sentence += f" (of a half-sine as wide {percent(effect.half_sine_peak_left)})"
    if effect.effect:
        figures = (("peak", "peak"), ("width", "width"), ("velocity_change", "velocity change"))
        shares = [f"{words} {percent(mean_of([one[key] for one in effect.effect]))}" for key, words in figures]
        sentence += f"; filter effect on the smooth pulse alone: {', '.join(shares)} left"
    return sentence
