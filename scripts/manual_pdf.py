"""The manual as one PDF: `make docs-pdf`, from the one page that Sphinx makes of the site.

Sheets, equations and tables are set as those of reports (`strikewave.reporting.pdf`); pictures are put into the page,
since nothing is fetched while it is set.
"""

import base64
import mimetypes
import re
import sys
from pathlib import Path
from urllib.parse import unquote

from strikewave.reporting.pdf import check_pdf, pdf_of

BUILT = Path(__file__).parents[1] / "docs" / "_build"
PAGE = BUILT / "singlehtml" / "index.html"
MANUAL = BUILT / "strikewave-manual.pdf"
STYLE = """\
body { line-height: 1.35; color: #1a1f24; }
h1 { break-before: page; font-size: 17pt; }
h2 { font-size: 12.5pt; margin-top: 7mm; }
h3 { font-size: 10.5pt; }
h1, h2, h3 { break-after: avoid; color: #12324a; }
a { color: #1f5f8b; text-decoration: none; }
a.headerlink, div.sphinxsidebar, div.related, div.footer, div.clearer, script { display: none; }
.toctree-l1 > a::after, .toctree-l2 > a::after { content: leader(". ") target-counter(attr(href), page); }
div.toctree-wrapper .toctree-l2 ul { display: none; }
pre { background: #f3f5f7; padding: 2mm; font-size: 7.2pt; white-space: pre-wrap; overflow-wrap: anywhere; }
code { font-size: 90%; overflow-wrap: anywhere; }
table { border-collapse: collapse; margin: 3mm 0; font-size: 7.6pt; }
th, td { border-bottom: 0.3pt solid #c6ccd2; padding: 0.8mm 1mm; text-align: left; vertical-align: top; }
img, svg { max-width: 100%; }
img { max-height: 170mm; }
div.math { margin: 3mm 0 3mm 6mm; }
.eqno { float: right; }
dt { margin-top: 3mm; }
dl.py > dt { font-family: "DejaVu Sans Mono"; font-size: 7.6pt; }
"""


def with_pictures(page: str, folder: Path) -> str:
    """Return a page with the pictures that it names within it."""

    def within(found: re.Match[str]) -> str:
        place = folder / unquote(found[1])
        if not place.is_file():
            raise SystemExit(f"{place}: the page shows it, but it is not there")
        kind = mimetypes.guess_type(place.name)[0] or "image/png"
        return f'src="data:{kind};base64,{base64.b64encode(place.read_bytes()).decode()}"'

    return re.sub(r'src="(?!data:|https?:)([^"]+\.(?:svg|png|jpe?g|gif))"', within, page)


def without_screen(page: str) -> str:
    """Return a page without what is for screens alone: scripts, styles and links of its head."""
    page = re.sub(r"<script\b.*?</script>", "", page, flags=re.DOTALL)
    return re.sub(r"<link\b[^>]*>", "", page).replace("</head>", f"<style>{STYLE}</style></head>", 1)


def main() -> None:
    """Set the manual and write it."""
    check_pdf("make docs-pdf", MANUAL.name)
    if not PAGE.is_file():
        sys.exit(f"{PAGE} is not there: make docs-pdf builds it first")
    page = with_pictures(without_screen(PAGE.read_text("utf-8")), PAGE.parent)
    MANUAL.write_bytes(pdf_of(page, "A4"))
    print(f"{MANUAL}: {MANUAL.stat().st_size / 1e6:.1f} MB")


if __name__ == "__main__":
    main()
