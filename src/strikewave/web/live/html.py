"""Words and tables that change while a hand moves."""

from __future__ import annotations

from nicegui import ui


class LiveHtml(ui.element, component="live_html.js"):
    """Markup that changes; whoever gives it escapes what others wrote (`strikewave.web.markup`).

    Parameters
    ----------
    content : str, optional
        What is shown at first.
    """

    def __init__(self, content: str = "") -> None:
        super().__init__()
        self.props["content"] = content

    def show(self, content: str) -> None:
        """Show other markup."""
        if content != self.props["content"]:
            with self.props.suspend_updates():
                self.props["content"] = content
            self.run_method("show", content)
