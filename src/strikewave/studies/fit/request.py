"""What is asked of a fit, and where it was stated."""

from __future__ import annotations

import contextlib
from dataclasses import dataclass, field

from strikewave.analyses.compare.sources import SourceOptions
from strikewave.studies.fit.targets import Target
from strikewave.studies.study_file import stated_at


@dataclass(frozen=True)
class FitRequest:
    """What is asked of a fit.

    Attributes
    ----------
    to, check_on : tuple of (str or Target)
        Records and numbers that are fitted to, and that are kept out, as typed or taken apart.
    free : tuple of str
        Free fields, ``path`` or ``path=low..high``.
    tries : str
        Choices that are fitted each.
    reading : SourceOptions
        How records are read.
    bayes : bool
        Whether the posterior is sampled.
    file : str
        The file that states all this; empty where it was typed.
    """

    to: tuple[str | Target, ...] = ()
    free: tuple[str, ...] = ()
    tries: str = ""
    check_on: tuple[str | Target, ...] = ()
    reading: SourceOptions = field(default_factory=SourceOptions)
    bayes: bool = False
    file: str = ""

    def stated(self, table: str) -> contextlib.AbstractContextManager[None]:
        """Return the context in which an error names a table of the file, if there is one."""
        return stated_at(f"{self.file}: {table}" if self.file else "")
