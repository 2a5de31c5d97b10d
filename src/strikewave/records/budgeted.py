"""Records with the uncertainty of their blows by a budget."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence

from strikewave.base.errors import InputError
from strikewave.records.budget.blows import BlowUncertainty, blow_uncertainty
from strikewave.records.budget.contributions import Budget
from strikewave.records.reading import ChannelReading, FileReading


def check_amounts(budget: Budget, reading: ChannelReading, field: str = "--uncertainty") -> None:
    """Refuse a budget that states an acceleration for a channel that measures something else."""
    amounts = [one.name for one in budget.contributions if not one.relative]
    if amounts and reading.channel.unit != "m/s^2":
        wrong = f"{reading.channel.name}, {reading.channel.unit or 'no known unit'}"
        raise InputError(field, wrong, f"shares of the peak: {amounts[0]} states an acceleration")


def with_budget(files: Sequence[FileReading], budget: Budget, field: str = "--uncertainty") -> list[FileReading]:
    """Return records with the uncertainty of each blow; Monte Carlo validates that of the largest one of each channel.

    Raises
    ------
    InputError
        If the budget states an acceleration, and a channel with blows measures something else.
    """
    largest: dict[int, tuple[ChannelReading, int]] = {}
    for reading in (reading for file in files for reading in file.channels if reading.pulses):
        check_amounts(budget, reading, field)
        place = max(range(len(reading.pulses)), key=lambda k: abs(reading.pulses[k].peak))
        known = largest.get(reading.number)
        if known is None or abs(reading.pulses[place].peak) > abs(known[0].pulses[known[1]].peak):
            largest[reading.number] = reading, place
    checked = {
        number: blow_uncertainty(reading.channel, reading.pulses[place], budget, trials=True)
        for number, (reading, place) in largest.items()
    }

    def found(reading: ChannelReading, place: int) -> BlowUncertainty:
        best, at = largest[reading.number]
        if best is reading and at == place:
            return checked[reading.number]
        return blow_uncertainty(reading.channel, reading.pulses[place], budget).alike(checked[reading.number])

    def told(reading: ChannelReading) -> ChannelReading:
        each = tuple(found(reading, place) for place in range(len(reading.pulses)))
        return dataclasses.replace(reading, uncertainties=each)

    return [dataclasses.replace(file, channels=tuple(told(reading) for reading in file.channels)) for file in files]
