"""What every result of a split-Hopkinson-bar set-up shares: its set-up and the files it names."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping
from typing import Any, ClassVar

from strikewave._version import __version__
from strikewave.analyses.hopkinson.setup_file import HopkinsonCase, values_of
from strikewave.base import declare
from strikewave.base.quantities import StatedValue
from strikewave.base.result import Source
from strikewave.base.variables import LabelledArrays
from strikewave.reporting.shown_result import ShownResult

SCHEMA = 1
"""Version of the layout of the files of a solution; it rises when they change."""


@declare.dataclass
class Outcome(ShownResult):
    """What a set-up came to; see `Result` for what it shares with others.

    Attributes
    ----------
    case : HopkinsonCase
        Set-up, its text, its folder.
    digests : mapping
        SHA-256 of the files, by their names.
    """

    command: ClassVar[str] = "hopkinson"
    main_rows: ClassVar[str] = "histories"
    is_history: ClassVar[bool] = True

    case: HopkinsonCase
    digests: Mapping[str, str]

    @declare.computed(declare.word("name of the set-up"))
    def setup(self) -> str:
        """What the set-up is called."""
        return self.case.setup.name

    @declare.computed(declare.named(StatedValue, "values of the set-up by their paths"))
    def inputs(self) -> dict[str, StatedValue]:
        """Every quantity of the set-up, with provenance."""
        values = values_of(self.case.setup)
        return {path: StatedValue(one.si, one.typed, one.provenance, one.note) for path, one in values}

    @property
    def title(self) -> str:
        """The title of the set-up."""
        return self.case.setup.title or self.case.setup.name

    @property
    def test(self) -> Mapping[str, str]:
        """What the set-up says of the test."""
        return self.case.setup.test.stated()

    @property
    def source(self) -> Source:
        """The set-up, with the files that it names."""
        return Source("set-up", self.case.setup.name, marked_text(self.case, self.digests), digests=self.digests)

    @property
    @abstractmethod
    def arrays(self) -> LabelledArrays:
        """The histories with units."""

    def attributes(self) -> dict[str, Any]:
        """Return what stands at the head of a dataset."""
        return {"strikewave_schema": SCHEMA, "strikewave_version": __version__, "case": self.case.text}


def marked_text(case: HopkinsonCase, digests: Mapping[str, str]) -> str:
    """Return the text of a set-up with the SHA-256 of its files below: other files are another result."""
    return case.text + "".join(f"# SHA-256 {digest} {name}\n" for name, digest in digests.items())
