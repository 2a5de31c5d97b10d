"""The base of results of studies: the request above the case, files, and the frame of the page."""

from __future__ import annotations

import dataclasses
from abc import abstractmethod
from collections.abc import Callable, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar, TypeVar

from strikewave.base import declare
from strikewave.base.declare import ComputedField, Quantity
from strikewave.base.result import Source
from strikewave.reporting import chapters
from strikewave.reporting.case_result import ResultOfCase
from strikewave.reporting.parts import Picture, Section, Tag

if TYPE_CHECKING:
    from matplotlib.figure import Figure


T = TypeVar("T")


@declare.dataclass(eq=False)
class Study(ResultOfCase):
    """A result of many runs of a case; see `Result` for what it shares with others.

    Attributes
    ----------
    asked : str
        Command line that gives it again, where one does.
    """

    indent: ClassVar[int | None] = None
    """Indent of the JSON document; None where it holds long lists."""

    asked: str = dataclasses.field(default="", kw_only=True)

    @property
    @abstractmethod
    def marked_text(self) -> str:
        """The case as text, and above it what was asked: other runs are another result."""

    @cached_property
    def source(self) -> Source:
        """The case, and above it what was asked."""
        return Source("case", self.case.name, self.marked_text, asked=self.asked)

    def texts(self) -> dict[str, str]:
        """Return the JSON document as a file."""
        return {f"{self.command}.json": self.document_text(self.indent)}


def key_number(quantity: Quantity, label: str) -> Callable[[Callable[[Any], T]], ComputedField[T]]:
    """Declare a number that stands among the key numbers alone, as `declare.computed` does."""
    return declare.computed(declare.number(quantity, label, headline=label, in_document=False))


def picture_section(title: str, figure: Figure, caption: str) -> Section:
    """Return the section of the picture of a study."""
    return Section(title, "", [Picture(figure, caption, caption)])


def study_page(
    study: Study, summary_text: str, outcome: Sequence[Section], plan: Section, kind: str, status: Tag | None = None
) -> str:
    """Return the report of a study as one HTML page; ``kind`` is what it is, with its article."""
    sections = [*outcome, chapters.warnings(study.notices), plan, chapters.inputs(study.case)]
    summary = chapters.Summary(f"Report of {kind}", summary_text, study.highlights(), status)
    return chapters.result_page(study, summary, sections)
