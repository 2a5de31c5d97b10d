"""What a command left, as plain values that can be compared: document, screen, messages, each file of its result."""

from __future__ import annotations

import contextlib
import csv
import hashlib
import json
import os
import re
import shlex
import shutil
import signal
import subprocess
from collections.abc import Iterator
from html.parser import HTMLParser
from pathlib import Path

VOLATILE = {
    "version", "elapsed", "seconds", "wall", "cpu", "element_steps_per_second", "elapsed_seconds", "rate", "sha256",
    "created",
}  # fmt: skip
"""Keys that say how long a run took, when and by what, not what it gave."""
TIME = r"\d+(\.\d+)?(e[+-]?\d+)?[ \u00a0](ns|µs|us|ms|s|min|h)\b"
UNSTEADY = tuple(
    (re.compile(pattern), replacement)
    for pattern, replacement in (
        (rf"\b{TIME}(?= (of|on|a|per) (a )?(processor|run|step|core))", "TIME"),
        (rf"\b(in|took|after|about) {TIME}", r"\1 TIME"),
        (r"\d+(\.\d+)? [MG]B of memory", "MEMORY"),
        (r"\d{4}-\d{2}-\d{2}([T ]\d{2}:\d{2}(:\d{2}(\.\d+)?)?Z?)?", "DATE"),
        (r"strikewave \d+\.\d+\S*", "strikewave VERSION"),
        (r"(?<![\w.])[0-9a-f]{16}([0-9a-f]{48})?(?!\w|\.\w)", "DIGEST"),
        (r"\d+(\.\d+)?(e[+-]?\d+)?[ \u00a0](M )?element-steps(/s| a second| per second)", "RATE"),
    )
)
"""Times, dates, versions, rates and digests of files (compared themselves) in texts, and what stands in their place."""
PROGRESS = re.compile(r"\w+ \d+ %")
"""A line that says how far a study is: there are as many as it lasts."""
TIMEOUT = 1800.0
"""Longest time of a command, s: a run of elements takes minutes of a busy machine."""
LONGEST_TABLE = 200
"""Rows of a table that is kept whole; of a longer one, a hash."""
STEADY, MOST_LOOKS = 10, 240
"""Looks at a page, half a second each, after which equal texts are its last; and most of them."""
UNFINISHED = ("getting ready", "the full run follows", "computing")
"""Words of a page that says more a little later."""
UNSEEN = {"script", "style", "svg", "head"}
"""Elements of a page without text that a reader sees."""


class PageText(HTMLParser):
    """The text of a page, a line an element that holds some."""

    def __init__(self) -> None:
        super().__init__()
        self.lines: list[str] = []
        self._unseen = 0

    # names and arguments are those of HTMLParser, which calls them
    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Note that an element begins whose text is not seen."""
        self._unseen += tag in UNSEEN

    def handle_endtag(self, tag: str) -> None:
        """Note that such an element ends."""
        self._unseen -= tag in UNSEEN

    def handle_data(self, data: str) -> None:
        """Keep a piece of text that is seen."""
        if data.strip() and not self._unseen:
            self.lines.append(" ".join(data.split()))


def steadied(text: str, folder: Path) -> list[str]:
    """Return the lines of a text without what differs from run to run."""
    text = text.replace(str(folder), "FOLDER")
    for pattern, word in UNSTEADY:
        text = pattern.sub(word, text)
    lines = (line.rstrip() for line in text.replace("\r", "\n").split("\n"))
    return [line for line in lines if line and not PROGRESS.fullmatch(line)]


def array_of(values: object) -> object:
    """Return an array as its shape, sum and a hash of its bytes, a short one whole."""
    import numpy as np

    array = np.asarray(values)
    if array.size <= 16:
        return array.tolist() if array.dtype.kind != "M" else array.astype(str).tolist()
    total = float(np.nansum(np.abs(array))) if array.dtype.kind in "fiub" else ""
    body = array.tobytes() if array.dtype.kind != "O" else repr(array.tolist()).encode()
    return {"shape": list(array.shape), "total": total, "bytes": hashlib.sha256(body).hexdigest()[:16]}


def file_face(path: Path, folder: Path) -> object:
    """Return what a file holds as plain values; of a kind that is drawn, that it is there."""
    kind = path.suffix
    if kind == ".csv":
        with path.open(newline="", encoding="utf-8") as file:
            rows = list(csv.reader(file))
        if len(rows) > LONGEST_TABLE:
            return {"head": rows[0], "rows": len(rows), "bytes": hashlib.sha256(path.read_bytes()).hexdigest()[:16]}
        return rows
    if kind == ".json":
        return json.loads(path.read_text("utf-8"))
    if kind == ".nc":
        import xarray

        with xarray.open_dataset(path, engine="h5netcdf", decode_timedelta=False) as data:
            return {
                str(name): {
                    "dims": list(part.dims),
                    "units": str(part.attrs.get("units", "")),
                    "values": array_of(part.values),
                }
                for name, part in data.variables.items()
            }
    if kind == ".parquet":
        import pyarrow.parquet

        table = pyarrow.parquet.read_table(path)
        return {name: array_of(table[name].to_numpy()) for name in table.column_names}
    if kind == ".xlsx":
        import openpyxl

        book = openpyxl.load_workbook(path, read_only=True)
        sheets = {}
        for sheet in book:
            rows = [list(row) for row in sheet.iter_rows(values_only=True)]
            text = json.dumps(rows, default=str)
            short = len(rows) < LONGEST_TABLE
            sheets[sheet.title] = steadied(text, folder) if short else hashlib.sha256(text.encode()).hexdigest()[:16]
        book.close()
        return sheets
    if kind in {".html", ".md"}:
        page = PageText()
        page.feed(path.read_text("utf-8"))
        return [line for text in page.lines for line in steadied(text, folder)]
    if kind in {".toml", ".txt", ".k", ".inp", ".rad", ".key"}:
        return steadied(path.read_text("utf-8", errors="replace"), folder)
    return "there"


def command_faces(program: Path, command: str, faces: set[str], folder: Path) -> dict[str, object]:
    """Run a command in a folder of samples; return its exit code and the faces asked for."""
    samples = {path.name for path in folder.iterdir()}
    environment = {**os.environ, "COLUMNS": "80", "NO_COLOR": "1", "LC_ALL": "C.UTF-8"}
    environment.pop("PYTHONPATH", None)
    line = [str(program), *shlex.split(command)]
    line += ["--json"] if "json" in faces else []
    line += ["--out", "result"] if "files" in faces and not command.startswith("new ") else []
    done = subprocess.run(
        line, cwd=folder, capture_output=True, text=True, check=False, env=environment, timeout=TIMEOUT
    )
    left: dict[str, object] = {"exit": done.returncode}
    if "json" in faces and done.stdout.startswith("{"):
        left["document"] = json.loads(done.stdout)
    else:
        left["screen"] = steadied(done.stdout, folder)
        left["messages"] = steadied(done.stderr, folder)
    if "files" in faces:
        made = sorted(p for p in folder.rglob("*") if p.is_file() and p.relative_to(folder).parts[0] not in samples)
        left["files"] = {str(path.relative_to(folder)): file_face(path, folder) for path in made}
    return left


@contextlib.contextmanager
def served_pages(program: Path, folder: Path) -> Iterator[object]:
    """Yield a function that returns the text of a page of the app, read by Chromium when nothing on it is busy."""
    from playwright.sync_api import sync_playwright

    server = subprocess.Popen(
        [str(program), "app", "--no-browser", "--port", "0"], cwd=folder, stderr=subprocess.PIPE, text=True
    )
    try:
        line = server.stderr.readline() if server.stderr else ""
        address = re.search(r"http://[^ ]+", line)
        if address is None:
            raise SystemExit(f"the app does not start: {line}")
        with sync_playwright() as play:
            browser = play.chromium.launch(executable_path=chromium(), args=["--no-sandbox"])

            def text_of(place: str) -> list[str]:
                page = browser.new_page(viewport={"width": 1280, "height": 1000})
                page.goto(address[0].rstrip("/") + place, wait_until="networkidle", timeout=120_000)
                texts: list[str] = []
                while (
                    len(texts) < STEADY
                    or len(set(texts[-STEADY:])) > 1
                    or page.locator("[aria-busy=true]").count()
                    or any(words in texts[-1] for words in UNFINISHED)
                ):
                    if len(texts) > MOST_LOOKS:
                        break
                    page.wait_for_timeout(500)
                    texts.append(page.inner_text("body"))
                page.close()
                return steadied(texts[-1], folder)

            yield text_of
            browser.close()
    finally:
        server.send_signal(signal.SIGINT)
        server.wait(30)


def chromium() -> str:
    """Return the Chromium of the system.

    Raises
    ------
    SystemExit
        If there is none.
    """
    for name in ("chromium-headless-shell", "chromium", "google-chrome"):
        if found := shutil.which(name):
            return found
    raise SystemExit("pages of the app need Chromium: apt-get install chromium-headless-shell, or --without app")
