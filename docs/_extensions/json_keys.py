"""The directive `json-keys`: what documents of `--json` hold, a table for each command and for what several share."""

from typing import Any

from docutils import nodes
from docutils.parsers.rst import Directive
from json_meanings import (
    DocumentHead,
    Key,
    check_documents,
    commands_of,
    described_with,
    heading_of,
    keys_of,
    shared_classes,
)
from page_parts import link, section, table


class JsonKeys(Directive):
    """All tables, of the commands of its content."""

    has_content = True

    def run(self) -> list[nodes.Node]:
        """Return the tables."""
        commands = commands_of("\n".join(self.content))
        check_documents(commands)
        shared = shared_classes(commands)
        first = self.section("Every document", _place("head"), [], keys_of(DocumentHead, shared))
        own = [
            self.section(
                command.title,
                _place(command.title),
                command.lines,
                [key for kind in described_with(command.kind) for key in keys_of(kind, shared)],
            )
            for command in commands
        ]
        rest = [self.section(heading_of(kind), _place_of(kind), [], keys_of(kind, shared)) for kind in shared]
        return [first, *own, *rest]

    def section(self, title: str, place: str, lines: list[str], keys: list[Key]) -> nodes.section:
        """Return a table below the lines that its documents are of."""
        text = "\n".join(f"strikewave {line} --json" for line in lines)
        parts = [nodes.literal_block(text, text, language="none")] if text else []
        rows = [[_key(one.path), one.unit, _meaning(one)] for one in keys]
        return section(self, title, place, *parts, table(["key", "unit", "meaning"], rows))


def _place(name: str) -> str:
    return "json-" + nodes.make_id(name)


def _place_of(kind: type) -> str:
    return _place(f"of {kind.__name__}")


def _key(path: str) -> nodes.literal:
    return nodes.literal(text=path.replace("*", "NAME"))


def _meaning(one: Key) -> str | nodes.reference:
    return one.meaning if one.leads_to is None else link(f"{one.meaning}: see its table", _place_of(one.leads_to))


def setup(app: Any) -> dict[str, bool]:
    """Offer the directive to Sphinx."""
    app.add_directive("json-keys", JsonKeys)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
