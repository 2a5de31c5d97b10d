"""Samples of many records laid down on disk, so that a campaign of any length takes the memory of a few files."""

from __future__ import annotations

import dataclasses
import mmap
import tempfile
from types import TracebackType
from typing import IO

import numpy as np

from strikewave.records.reading import FileReading
from strikewave.records.record import Array

IN_MEMORY = 2**20  # samples kept in memory: 8 MB beside the program's 150; fifty records of 20 000 never meet the disk
PART = 2**28  # bytes of a file on disk: few enough files for thousands of records, and what is not used takes no room
_BYTES = 8  # bytes of a sample


class SampleStore:
    """Keeps the samples of readings: those that come first in memory, all others in files without a name.

    Readings that it gives back read as before: their samples are views of what lies on disk, read when they are looked
    at. The files are gone with the last of the readings.

    ``in_memory`` are samples that stay in memory.
    """

    def __init__(self, in_memory: int = IN_MEMORY) -> None:
        self._left = in_memory
        self._file: IO[bytes] | None = None
        self._maps: list[mmap.mmap] = []
        self._used = 0

    def __enter__(self) -> SampleStore:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        """End it: nothing is laid down any more, and what was is still there to be read."""
        if self._file is not None:
            self._file.close()

    def kept(self, file: FileReading) -> FileReading:
        """Return a reading whose samples take no more memory than is left for them."""
        size = sum(reading.channel.values.size for reading in file.channels)
        self._left -= size
        if self._left >= 0:
            return file
        channels = [
            dataclasses.replace(
                reading, channel=dataclasses.replace(reading.channel, values=self._laid_down(reading.channel.values))
            )
            for reading in file.channels
        ]
        return dataclasses.replace(file, channels=tuple(channels))

    def forget(self) -> None:
        """Take out of memory what was read back from disk; it is read again where it is looked at again."""
        for mapped in self._maps if hasattr(mmap, "MADV_DONTNEED") else ():
            mapped.madvise(mmap.MADV_DONTNEED)

    def _laid_down(self, values: Array) -> Array:
        """Write samples to disk, and return a view of them there; the samples themselves where the disk is full."""
        if not values.size:
            return values
        try:
            file = self._file_for(_BYTES * values.size)
            file.seek(self._used)
            file.write(np.ascontiguousarray(values).data)
            file.flush()
        except OSError:
            return values
        view = np.frombuffer(self._maps[-1], np.float64, values.size, self._used)
        self._used += _BYTES * values.size
        return view

    def _file_for(self, size: int) -> IO[bytes]:
        """Return a file that has room for so many bytes; a new one, with holes, where there is too little."""
        if self._file is not None and self._used + size <= len(self._maps[-1]):
            return self._file
        if self._file is not None:
            self._file.close()
        self._file = file = tempfile.TemporaryFile()  # noqa: SIM115  (closed by __exit__)
        file.truncate(max(PART, size))
        self._maps.append(mmap.mmap(file.fileno(), max(PART, size), access=mmap.ACCESS_READ))
        self._used = 0
        return file
