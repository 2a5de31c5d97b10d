"""A record: the channels of one file, evenly sampled, as the file has them or calibrated to SI."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from strikewave.base.errors import InputError, nearest
from strikewave.records.health_notice import HealthNotice

Array = NDArray[np.float64]

# Names of a run's histories of whole bodies: what swings in them is the body's motion, no sensor's
OF_BODY = ("record_acceleration", "rigid_acceleration", "pulse_acceleration")


@dataclass(frozen=True, eq=False)
class Channel:
    """One measured history.

    Attributes
    ----------
    name : str
        As the file has it, or ``channel 1`` and so on.
    values : ndarray
        Samples, float64; NaN where the file has none.
    step : float
        Time between samples, s; NaN where the file has none.
    start : float
        Time of the first sample, s.
    unit : str
        Unit of the values, as the file writes it; empty where it has none.
    stamps : ndarray or None
        The file's own time stamps, s, one a sample; None where it has a rate instead.
    """

    name: str
    values: Array
    step: float = float("nan")
    start: float = 0.0
    unit: str = ""
    stamps: Array | None = None

    @property
    def of_body(self) -> bool:
        """True if the name says that this is the acceleration of a whole body, as a run writes it."""
        return self.name in OF_BODY

    @property
    def sampling_rate(self) -> float:
        """Samples a second, Hz."""
        return 1.0 / self.step

    @property
    def duration(self) -> float:
        """Time from the first sample to the last, s."""
        return (self.values.size - 1) * self.step

    @property
    def time(self) -> Array:
        """Time of each sample, s, on an even grid."""
        return np.asarray(self.start + self.step * np.arange(self.values.size), dtype=np.float64)


@dataclass(frozen=True, eq=False)
class Record:
    """The channels of one file.

    Attributes
    ----------
    path : str
        As it was given.
    format : str
        Format of the file, as found, such as ``text`` or ``tdms``.
    channels : tuple of Channel
        In the order of the file, without its time column.
    findings : tuple of HealthNotice
        Findings of reading it: a last line cut off, a column left out.
    further : tuple of Record
        The other measurements of the file, where it holds several: each has a time of its own.
    """

    path: str
    format: str
    channels: tuple[Channel, ...]
    findings: tuple[HealthNotice, ...] = ()
    further: tuple[Record, ...] = ()

    def channel(self, wanted: str | int = 1, field: str = "--channel") -> Channel:
        """Return a channel by its name, or by its number counted from 1; ``field`` is what an error calls it.

        Examples
        --------
        >>> record = Record("a.csv", "text", (Channel("board", np.zeros(3)), Channel("frame", np.ones(3))))
        >>> record.channel(2).name, record.channel("board").name
        ('frame', 'board')
        """
        text = str(wanted).strip()
        if text in self.keys:
            return self.channels[self.keys[text]]
        names = [channel.name for channel in self.channels]
        listed = ", ".join(f"{k} {name}" for k, name in enumerate(names[:40], start=1))
        near = nearest(text, names)
        hint = near if near.startswith("did you mean") and not text.isdecimal() else f"{self.path} has: {listed}"
        raise InputError(field, wanted, f"a name, or a number from 1 to {len(names)}", hint)

    @property
    def keys(self) -> dict[str, int]:
        """Place of each channel by what it can be called: its number from 1, its name, its name with its unit."""
        places: dict[str, int] = {str(k + 1): k for k in range(len(self.channels))}
        for k, channel in reversed(list(enumerate(self.channels))):
            places |= {f"{channel.name} {o}{channel.unit}{c}": k for o, c in ("[]", "()")}
            places[channel.name] = k
        return places

    def only(self, wanted: Sequence[str | int]) -> Record:
        """Return the record with some of its channels, in the order asked for; all of them for none asked."""
        return replace(self, channels=tuple(self.channel(w) for w in wanted)) if wanted else self
