"""A diagram that changes while a hand moves."""

from __future__ import annotations

from typing import Any

from nicegui import ui


class LiveChart(ui.element, component="live_chart.js"):
    """A diagram that ECharts draws, which NiceGUI brings.

    Parameters
    ----------
    options : dict
        As ECharts takes them (`strikewave.web.charts`).
    """

    library = ui.echart
    """What brings ECharts: the page knows where to find it once this was named."""

    def __init__(self, options: dict[str, Any]) -> None:
        super().__init__()
        self.shown = options
        self.props["options"] = options

    def show(self, options: dict[str, Any]) -> None:
        """Show other curves: only what differs is sent."""
        changed = {key: value for key, value in options.items() if self.shown.get(key) != value}
        gone = self.shown.keys() - options.keys()
        self.shown = options
        if changed or gone:
            self.run_method("show", options if gone else changed, bool(gone))
