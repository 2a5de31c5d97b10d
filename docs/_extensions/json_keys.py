"""The directive `json-keys`: what documents of `--json` hold, a table for each command and for what several share."""

from typing import Any

from docutils import nodes
from docutils.parsers.rst import Directive
from json_meanings import LEADS_TO, MEANINGS, KeyTable, key_tables
from page_parts import link, section, table


class JsonKeys(Directive):
    """All tables."""

    def run(self) -> list[nodes.Node]:
        """Return the tables."""
        self.state.document.settings.record_dependencies.add(str(MEANINGS))
        commands, shared = key_tables()
        first = self.section(shared.pop("head"), _place("head"))
        own = [self.section(one, _place(one.title)) for one in commands]
        return [first, *own, *(self.section(one, _place_of_shared(name)) for name, one in shared.items())]

    def section(self, one: KeyTable, place: str) -> nodes.section:
        """Return a table below the lines that its documents are of."""
        text = "\n".join(f"strikewave {line} --json" for line in one.lines)
        rows = [[_key(path), unit, _meaning(one.meanings[path])] for path, unit in one.seen.items()]
        parts = [nodes.literal_block(text, text, language="none")] if text else []
        return section(self, one.title, place, *parts, table(["key", "unit", "meaning"], rows))


def _place(name: str) -> str:
    return "json-" + nodes.make_id(name)


def _place_of_shared(name: str) -> str:
    return _place(f"of {name}")


def _key(path: str) -> nodes.literal:
    return nodes.literal(text=path.replace("*", "NAME"))


def _meaning(text: str) -> str | nodes.reference:
    name = text.removeprefix(LEADS_TO)
    return text if name == text else link(f"see {name.replace('-', ' ')}", _place_of_shared(name))


def setup(app: Any) -> dict[str, bool]:
    """Offer the directive to Sphinx."""
    app.add_directive("json-keys", JsonKeys)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
