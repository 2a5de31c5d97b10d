"""The pictures of README and docs that show what a user sees: screens of 80 columns, and how a report begins.

Screens are what the commands print to a terminal, so they are SVG, the same bits each time; `tests/project/
test_pictures.py` compares them with what is printed now. The beginning of a report is photographed by Chromium at the
width of a desk and of a telephone; where there is none, those two stay as they are. Run it by `make pictures`.
"""

import argparse
import lzma
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from PIL import Image
from rich.console import Console
from rich.text import Text

ROOT = Path(__file__).parents[1]
IMAGES = ROOT / "docs" / "images"
BLOWS = ROOT / "tests" / "data" / "smd-5kg-impacts"
WIDTH = 80
SCREENS = {
    "screen-run": (["run", "li-ma-2019"], 27),
    "screen-record": (["record", "blows/impact_*.lvm", "--channel", "1", "--unit", "g"], 40),
}
"""Command of each screen, and the lines that are shown of it; a line of dots follows where it goes on."""
PAGES = {"report": (1280, 900), "report-narrow": (390, 844)}
"""Width and height of each photograph of the report of `li-ma-2019`, in pixels."""
COLOURS = 200
"""Of a photograph: text and lines need no more, and it is less than half as large."""
BROWSERS = ("chromium-headless-shell", "chromium", "chromium-browser", "google-chrome")
SVG = """\
<svg viewBox="0 0 {width} {height}" xmlns="http://www.w3.org/2000/svg">
<style>
.{unique_id}-matrix {{ font-family: ui-monospace, "DejaVu Sans Mono", Menlo, Consolas, monospace;
 font-size: {char_height}px; line-height: {line_height}px; }}
.{unique_id}-title {{ font-size: 18px; font-family: sans-serif; }}
{styles}
</style>
<defs><clipPath id="{unique_id}-clip-terminal"><rect width="{terminal_width}" height="{terminal_height}"/></clipPath>
{lines}</defs>
{chrome}
<g transform="translate({terminal_x}, {terminal_y})" clip-path="url(#{unique_id}-clip-terminal)">
{backgrounds}
<g class="{unique_id}-matrix">
{matrix}
</g>
</g>
</svg>
"""
"""Of rich, without the fonts that its own one fetches: the picture fetches nothing, and takes what the reader has."""


def printed(words: list[str], folder: Path) -> str:
    """Return what a command prints on a terminal of 80 columns, with its styles; ``folder`` is where it runs."""
    import pty

    blows = folder / "blows"
    blows.mkdir(exist_ok=True)
    for packed in BLOWS.glob("impact_0*.xz"):
        (blows / packed.stem).write_bytes(lzma.decompress(packed.read_bytes()))
    typed = [str(path.relative_to(folder)) for word in words if "*" in word for path in sorted(folder.glob(word))]
    place = next((k for k, word in enumerate(words) if "*" in word), len(words))
    command = [sys.executable, "-m", "strikewave", *words[:place], *typed, *words[place + 1 :]]
    environment = {**os.environ, "COLUMNS": str(WIDTH), "TERM": "xterm-256color"}
    environment.pop("NO_COLOR", None)
    reader, writer = pty.openpty()
    child = subprocess.Popen(command, cwd=folder, env=environment, stdout=writer, stderr=subprocess.DEVNULL)
    os.close(writer)
    content = b""
    while True:
        try:
            block = os.read(reader, 65536)
        except OSError:  # Linux says so at the end of what the child printed
            break
        if not block:
            break
        content += block
    os.close(reader)
    if child.wait() not in (0, 3):
        raise SystemExit(f"{' '.join(words)} ended with {child.returncode}")
    return content.decode().replace("\r\n", "\n")


def shown(words: list[str], lines: int, folder: Path) -> Text:
    """Return the first lines of a screen below the command that was typed."""
    screen = printed(words, folder).rstrip("\n").split("\n")
    head = Text("$ strikewave " + " ".join(words), style="bold")
    body = Text.from_ansi("\n".join(screen[:lines]))
    return Text("\n").join([head, body, *([Text("…", style="dim")] if len(screen) > lines else [])])


def screen_svg(name: str, folder: Path) -> str:
    """Return a screen as SVG."""
    words, lines = SCREENS[name]
    with open(os.devnull, "w", encoding="utf-8") as nowhere:
        console = Console(record=True, width=WIDTH, file=nowhere, force_terminal=True, color_system="truecolor")
        console.print(shown(words, lines, folder), no_wrap=True, crop=False)
        svg = console.export_svg(title="", code_format=SVG, unique_id=name)
    return "\n".join(line.rstrip() for line in svg.split("\n") if line.strip()) + "\n"


def found_browser() -> str | None:
    """Return where a Chromium is."""
    return next(filter(None, map(shutil.which, BROWSERS)), None)


def make_small(place: Path, colours: int) -> None:
    """Keep a photograph in few colours, and say that it is there."""
    with Image.open(place) as picture:
        few = picture.convert("RGB").quantize(colours, Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE)
    few.save(place, optimize=True)
    print(place.relative_to(ROOT))


def photograph(page: Path, name: str) -> None:
    """Write the first screenful of a page as PNG."""
    browser = found_browser()
    if browser is None:
        print(f"{name}.png stays as it is: there is none of {', '.join(BROWSERS)}")
        return
    width, height = PAGES[name]
    place = IMAGES / f"{name}.png"
    options = ["--headless", "--no-sandbox", "--hide-scrollbars", "--force-device-scale-factor=1"]
    options += [f"--window-size={width},{height}", f"--screenshot={place}", page.as_uri()]
    subprocess.run([browser, *options], check=True, capture_output=True)
    make_small(place, COLOURS)


def main() -> None:
    """Draw all of them, or those that are named."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*", choices=[[], *SCREENS, *PAGES])
    names = parser.parse_args().names or [*SCREENS, *PAGES]
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        for name in (name for name in SCREENS if name in names):
            path = IMAGES / f"{name}.svg"
            path.write_text(screen_svg(name, folder), "utf-8")
            print(path.relative_to(ROOT))
        page = folder / "out" / "li-ma-2019" / "report.html"
        if set(names) & set(PAGES) and not page.exists():
            printed(SCREENS["screen-run"][0], folder)
        for name in (name for name in PAGES if name in names):
            photograph(page, name)


if __name__ == "__main__":
    main()
