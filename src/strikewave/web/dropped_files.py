"""A field that files are dropped on, and the list of those that are kept; each can be removed and dropped again."""

from __future__ import annotations

import functools
import html
from collections.abc import Awaitable, Callable, Sequence
from pathlib import Path
from typing import Any

from nicegui import ui

from strikewave.base.errors import StrikewaveError
from strikewave.web.guard import LARGEST_UPLOAD
from strikewave.web.sessions import Session

DROP_HEAD = """
<div class="row no-wrap items-center q-pa-sm">
  <div class="col q-uploader__title">{label}</div>
  <q-spinner v-if="props.isUploading" />
  <q-btn v-if="props.canAddFiles" type="a" icon="add_box" flat dense aria-label="choose files: {label}">
    <q-uploader-add-trigger />
  </q-btn>
</div>"""
"""Head of a field that files are dropped on: that of the kit has a button without a name."""
FIELD_NAME = ":field-name='file => file.__key'"
"""Each file of a drop has a field of its own in what the browser sends: two of one name would be one."""
REFUSED = "entries => emit(entries.map(entry => [entry.failedPropValidation, entry.file.name]))"
MOST_NAMED = 3
"""Files that were refused which a note names."""
REASONS = {"max-file-size": f"a file takes {LARGEST_UPLOAD >> 20} MB at most", "duplicate": "it is on its way already"}
"""Why the browser does not send a file, by the name of the rule."""


class DroppedFiles:
    """The field and the list.

    Parameters
    ----------
    session : Session
    folder : str
        Of the session, for these files alone.
    label : str
        What may be dropped.
    dropped : callable
        Called with the files that were dropped now, once they are kept.
    removed : callable, optional
        Called when files were removed.
    """

    def __init__(
        self,
        session: Session,
        folder: str,
        label: str,
        dropped: Callable[[Sequence[Path]], Awaitable[None]],
        removed: Callable[[], None] = lambda: None,
    ) -> None:
        self._session, self._folder, self._dropped, self._removed = session, folder, dropped, removed
        with ui.element("div").classes("sw-drop").classes("sw-full"):
            zone = ui.upload(label=label, multiple=True, auto_upload=True, max_file_size=LARGEST_UPLOAD)
            zone.on_multi_upload(self._take)
        zone.on("rejected", self._refuse, js_handler=REFUSED)
        # what is kept stands in the list below; emptied by the browser itself: asked for from here, it comes late and
        # throws away what has been dropped since
        zone.on("finish", js_handler=f"() => runMethod({zone.id}, 'reset', [])")
        zone.add_slot("header", DROP_HEAD.format(label=html.escape(label)))
        zone.props(f'flat bordered batch {FIELD_NAME} aria-label="{html.escape(label)}"')
        self._list = ui.element("div").classes("sw-full")
        self._show()

    @property
    def place(self) -> Path:
        """The folder of these files."""
        return self._session.place(self._folder)

    @property
    def names(self) -> list[str]:
        """The files that are kept, in the order of their names."""
        return sorted(path.name for path in self.place.iterdir() if path.is_file())

    def _show(self) -> None:
        self._list.clear()
        names = self.names
        with self._list:
            for name in names:
                with ui.element("div").classes("sw-row sw-file"):
                    ui.label(name).classes("sw-soft sw-grow")
                    cross = ui.button(icon="close", on_click=functools.partial(self.remove, [name]))
                    cross.props(f'flat dense round size=sm aria-label="remove {html.escape(name)}"')
            if len(names) > 1:
                ui.button("remove all", icon="delete", on_click=lambda: self.remove(self.names)).props(
                    "flat dense no-caps"
                )

    def remove(self, names: Sequence[str]) -> None:
        """Remove files."""
        for name in names:
            (self.place / name).unlink(missing_ok=True)
        self._show()
        self._removed()

    async def _take(self, event: Any) -> None:
        taken = []
        try:
            files = [(file.name, await file.read()) for file in event.files]
            taken = self._session.take(files, self._folder)
        except StrikewaveError as error:
            ui.notify(f"refused: {error}", type="warning")
        for file in taken:
            if file.remark:
                ui.notify(file.remark, type="info", timeout=10000)
        self._show()
        await self._dropped([file.path for file in taken])

    def _refuse(self, event: Any) -> None:
        for rule, name in event.args[:MOST_NAMED]:
            ui.notify(f"refused: {name}: {REASONS.get(rule, 'the browser does not send it')}", type="warning")
