"""The page of records: drop measured files, and see what they say."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from nicegui import Client, ui
from starlette.requests import Request

from strikewave.web import parts
from strikewave.web.case.state import address
from strikewave.web.desk import Desk
from strikewave.web.dropped_files import DroppedFiles
from strikewave.web.pages.record.cutoff_field import CutoffField
from strikewave.web.pages.record.fields import CUTOFFS, SELDOM, TEXTS
from strikewave.web.pages.record.request import RecordRequest, count_of_files
from strikewave.web.sessions import Session
from strikewave.web.workbench import Workbench

PLACE = "/record"
SPECIFICATIONS = "strikewave.web.pages.study.view:specifications"
FOLDER = "records"


def add(desk: Desk) -> None:
    """Add the page to the app."""

    @ui.page(PLACE)
    async def record(request: Request, client: Client) -> None:
        opened = await desk.open_page(PLACE, client, lambda _: desk.lookers.ask(SPECIFICATIONS))
        if opened is not None:
            session, specifications = opened
            RecordPage(session, dict(request.query_params), specifications).build()


class RecordPage:
    """One open page of records."""

    def __init__(self, session: Session, given: dict[str, str], specifications: list[str]) -> None:
        self.session, self.given, self.specifications = session, given, specifications
        self.boxes: dict[str, Any] = {}
        self.cutoffs: dict[str, CutoffField] = {}

    def build(self) -> None:
        """Put everything on the page."""
        with ui.element("main").classes("sw-page").props('id="main"'):
            with ui.element("div").classes("sw-side"):
                with parts.box("Measured files"):
                    self.count = ui.label("").classes("sw-soft")
                    label = "drop files of any format, many at once"
                    self.files = DroppedFiles(self.session, FOLDER, label, self._dropped, self._removed)
                with parts.box("What they are, and what is asked"):
                    self._texts(TEXTS)
                    with ui.expansion("How files are read", value=any(map(self.given.get, SELDOM))).props("dense"):
                        self._texts(SELDOM)
                    with parts.box("Filter and baseline"):
                        ui.label("what they cost stands beside the pulses, with and without them").classes("sw-soft")
                        for key, (label, what, none_at_top) in CUTOFFS.items():
                            typed = self.given.get(key, "")
                            self.cutoffs[key] = CutoffField(
                                key, label, what, typed, none_at_top, self._changed, self.begin
                            )
                    options = {"": "none", **{name: name for name in self.specifications}}
                    spec = self.given.get("spec", "")
                    self.boxes["spec"] = ui.select(
                        options,
                        value=spec if spec in options else "",
                        label="specification",
                        with_input=True,
                        on_change=self._changed,
                    ).props("dense outlined options-dense")
                    self.boxes["spec"].style("width:100%")
                    self.boxes["spectrum"] = ui.checkbox(
                        "shock response spectrum",
                        value=self.given.get("spectrum") != "no",
                        on_change=self._changed,
                    )
                    with ui.element("div").classes("sw-row"):
                        ui.button("judge", icon="play_arrow", on_click=self.begin).props("unelevated dense no-caps")
                        ui.button("stop", icon="stop", on_click=self.stop).props("outline dense no-caps")
            with ui.element("div").classes("sw-main"):
                words = (
                    "Drop measured files: CSV, LVM, TDMS, MAT, HDF5, UFF, WAV and more. Nothing leaves this machine."
                )
                self.bench = Workbench(self.session, words)
        if self.files.names:
            self.begin()

    def _texts(self, asked: dict[str, tuple[str, str]]) -> None:
        for key, (label, example) in asked.items():
            box = ui.input(label, placeholder=example, value=self.given.get(key, ""), on_change=self._changed)
            box.props("dense outlined stack-label").style("width:100%; margin-bottom:.35rem")
            self.boxes[key] = box.on("keydown.enter", self.begin)

    async def _dropped(self, _: Sequence[Path]) -> None:
        self._removed()

    def _removed(self) -> None:
        """Judge the files that are kept now; of none nothing is said."""
        if self.files.names:
            self.begin()
        else:
            self.bench.empty()

    def _changed(self) -> None:
        """Mark what is shown as judged by other settings."""
        self.bench.changed("press judge")

    def stop(self) -> None:
        """Stop what is under way."""
        self.bench.stop()

    def request(self) -> RecordRequest:
        """Return what is asked now."""
        texts = {key: str(self.boxes[key].value or "").strip() for key in (*TEXTS, *SELDOM)}
        texts["q"] = texts["q"] or "10"
        texts |= {key: cutoff.value for key, cutoff in self.cutoffs.items()}
        spec, spectrum = str(self.boxes["spec"].value or ""), bool(self.boxes["spectrum"].value)
        names = tuple(self.files.names)
        return RecordRequest(str(self.files.place), names, spec=spec, spectrum=spectrum, **texts)

    def begin(self) -> None:
        """Read and judge the files as is asked now."""
        asked = self.request()
        self.count.text = count_of_files(len(asked.names)) if asked.names else ""
        shown = {key: str(self.boxes[key].value or "") for key in (*TEXTS, *SELDOM, "spec")}
        shown |= {key: cutoff.value for key, cutoff in self.cutoffs.items()}
        query = [(key, value) for key, value in shown.items() if value]
        with self.count:  # a handle that rests has no page of its own to speak to
            ui.navigate.history.replace(address(PLACE, query + ([] if asked.spectrum else [("spectrum", "no")])))
        self.bench.begin("strikewave.web.pages.record.view:measure", asked, same=asked.commands())
