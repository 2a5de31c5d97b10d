"""Bodies that a hand turns, in three dimensions."""

from __future__ import annotations

from nicegui import ui


class LiveBody(ui.element, component="live_body.js"):
    """The moving surface of a run of elements, with a slider of time, a field in colours and a plane that cuts.

    Parameters
    ----------
    url : str
        Where its bytes are (`strikewave.web.pages.case.body_field`).
    label : str
        What it shows, for who cannot see it.
    """

    library = ui.scene
    """What brings three.js: the page knows where to find it once this was named."""

    def __init__(self, url: str, label: str) -> None:
        super().__init__()
        self.props.update({"url": url, "label": label})
