"""The page of records: dropped measured files, and what they show."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from nicegui import Client, ui
from starlette.requests import Request

from strikewave.web import parts
from strikewave.web.case_state import EditedField, address
from strikewave.web.desk import Desk
from strikewave.web.pages.record.request import CUTOFFS, SELDOM, TEXTS, RecordRequest, count_of_files
from strikewave.web.parts import DroppedFiles, LiveField, RestingHand
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
                        for key in CUTOFFS:
                            typed = self.given.get(key, "")
                            self.cutoffs[key] = CutoffField(key, typed, self._changed, self.begin)
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
                        "shock response spectrum", value=self.given.get("spectrum") != "no", on_change=self._changed
                    )
                    with ui.element("div").classes("sw-row"):
                        ui.button("judge", icon="play_arrow", on_click=self.begin).props("unelevated dense no-caps")
                        ui.button("stop", icon="stop", on_click=self.stop).props("outline dense no-caps")
            with ui.element("div").classes("sw-main"):
                self.bench = Workbench(
                    self.session,
                    "Drop measured files: CSV, LVM, TDMS, MAT, HDF5, UFF, WAV and more. Nothing leaves this machine.",
                )
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
        """Judge the remaining files; nothing is shown of none."""
        if self.files.names:
            self.begin()
        else:
            self.bench.empty()

    def _changed(self) -> None:
        """Mark the results as judged by other settings."""
        self.bench.changed("press judge")

    def stop(self) -> None:
        """Stop the current work."""
        self.bench.stop()

    def request(self) -> RecordRequest:
        """Return the current request."""
        texts = {key: str(self.boxes[key].value or "").strip() for key in (*TEXTS, *SELDOM)}
        texts["q"] = texts["q"] or "10"
        texts |= {key: cutoff.value for key, cutoff in self.cutoffs.items()}
        spec, spectrum = str(self.boxes["spec"].value or ""), bool(self.boxes["spectrum"].value)
        names = tuple(self.files.names)
        return RecordRequest(str(self.files.place), names, spec=spec, spectrum=spectrum, **texts)

    def begin(self) -> None:
        """Read and judge the files by the current request."""
        asked = self.request()
        self.count.text = count_of_files(len(asked.names)) if asked.names else ""
        shown = {key: str(self.boxes[key].value or "") for key in (*TEXTS, *SELDOM, "spec")}
        shown |= {key: cutoff.value for key, cutoff in self.cutoffs.items()}
        query = [(key, value) for key, value in shown.items() if value]
        with self.count:  # a handle that rests has no page of its own to speak to
            ui.navigate.history.replace(address(PLACE, query + ([] if asked.spectrum else [("spectrum", "no")])))
        self.bench.begin("strikewave.web.pages.record.view:measure", asked, same=asked.commands())


PREFERRED = (10, 12.5, 16, 20, 25, 31.5, 40, 50, 63, 80)
"""Steps of a decade, ISO 3 R10: the bands of test laboratories."""
CUTOFF_STEPS = tuple(
    f"{number * 10**decade:g} Hz" if decade < 2 else f"{number * 10 ** (decade - 3):g} kHz"
    for decade in range(4)
    for number in PREFERRED
)
"""Cutoffs of the slider, 10 Hz to 80 kHz."""


class CutoffField:
    """A cutoff with its slider; at its end, the upper one of a low-pass (``none_at_top``), nothing is filtered.

    ``moved`` is called when it begins to move, ``changed`` when it rests at another value.
    """

    def __init__(self, key: str, typed: str, moved: Callable[[], object], changed: Callable[[], object]) -> None:
        label, what, none_at_top = CUTOFFS[key]
        self.value, self._moved, self._changed = typed, moved, changed
        self._steps = (*CUTOFF_STEPS, "") if none_at_top else ("", *CUTOFF_STEPS)
        self._rest = RestingHand(changed)
        how = "typed with its unit, or slid; at the end of the slider nothing is filtered"
        last = len(self._steps) - 1.0
        field = EditedField(key, what, how, typed, "", self._at, 0.0, last, 1.0, "chosen", 1.0)
        self._shown = LiveField(field, typed, self._at, has_slider=True, label=label)
        self._shown.on_move(self._move)
        self._shown.on_type(self._type)

    @property
    def _at(self) -> float:
        """Place of the slider: its end for no filter and for a value between its steps."""
        return float(self._steps.index(self.value if self.value in self._steps else ""))

    def _move(self, place: float) -> None:
        self.value = self._steps[min(max(int(place), 0), len(self._steps) - 1)]
        self._shown.show(self.value)
        self._moved()
        self._rest.moved()

    def _type(self, text: str) -> None:
        self.value = text.strip()
        self._shown.show(self.value, self._at)
        self._changed()
