"""``strikewave cases``: the built-in cases."""

from __future__ import annotations

from strikewave.base import declare
from strikewave.base.declare import KEY, MAIN
from strikewave.base.json_document import head
from strikewave.cases.case import load_case
from strikewave.cases.case_files import bundled_cases
from strikewave.reporting.options.output import Shown
from strikewave.reporting.terminal import print_json, print_rows, tell


@declare.dataclass
class ListedCase:
    """A built-in case."""

    name: str = declare.word("name of a built-in case")

    @declare.phrase("to run it", column=KEY)
    def line(self) -> str:
        """Return the command line that runs it."""
        return f"strikewave {self.command} {self.name}"

    title: str = declare.word("its title", column=MAIN)
    source: str = declare.word("its source")
    command: str = declare.word("command that runs it")


@declare.dataclass
class CaseList:
    """The built-in cases."""

    cases: list[ListedCase] = declare.rows(ListedCase, "the built-in cases")


def command(shown: Shown) -> int:
    """List the built-in cases."""
    from strikewave.reporting.faces import columns_of

    read = [load_case(name) for name in bundled_cases()]
    listed = CaseList([ListedCase(one.name, one.title, one.source, one.command) for one in read])
    if shown.json:
        print_json({**head({}), **declare.content(listed)})
    else:
        tell(f"{len(read)} built-in cases.")
        print_rows("Built-in cases", columns_of(ListedCase, listed.cases))
    return 0
