"""Photographs that a test file names: checked, made small and free of all but the picture, to stand in a page.

Nothing of a file goes into a page as it is: it is decoded, and what is seen is written anew.
"""

from __future__ import annotations

import base64
import hashlib
import io
import warnings
from dataclasses import dataclass
from pathlib import Path

from strikewave.base.errors import EXISTING_FILE, InputError

LARGEST_PHOTOGRAPH = 30_000_000
"""Bytes of a file, at most: a camera of 50 million pixels writes less."""
MOST_PIXELS = 50_000_000
"""Pixels, at most: they are some 200 MB while they are decoded."""
LONGEST_SIDE = 1400
"""Pixels of a side in a page: 180 mm of paper at 200 dots an inch."""
QUALITY = 85
"""Of the JPEG in a page."""


@dataclass(frozen=True)
class Photograph:
    """A photograph fit for a page.

    Attributes
    ----------
    file, caption : str
        As stated.
    digest : str
        SHA-256 of the file.
    jpeg : bytes
        The picture.
    """

    file: str
    caption: str
    digest: str
    jpeg: bytes

    @property
    def address(self) -> str:
        """The picture as the address of data within a page."""
        return "data:image/jpeg;base64," + base64.b64encode(self.jpeg).decode("ascii")


def read_photograph(folder: Path, file: str, caption: str, field: str) -> Photograph:
    """Read a PNG or JPEG file in a folder, or below it.

    Raises
    ------
    InputError
        If it lies elsewhere, is no such picture, or is too large.
    """
    try:
        place = (folder / file).resolve()
        if not place.is_relative_to(folder.resolve()):
            raise InputError(field, file, "a file beside the test file, or in a folder below it")
        if not place.is_file():
            raise InputError(field, file, EXISTING_FILE)
        with place.open("rb") as opened:
            data = opened.read(LARGEST_PHOTOGRAPH + 1)
    except (OSError, ValueError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(field, file, "a file that can be read", getattr(error, "strerror", "") or "") from None
    if len(data) > LARGEST_PHOTOGRAPH:
        raise InputError(field, file, f"a picture of at most {LARGEST_PHOTOGRAPH // 1_000_000} MB")
    return Photograph(file, caption, hashlib.sha256(data).hexdigest(), _redrawn(data, file, field))


def _redrawn(data: bytes, file: str, field: str) -> bytes:
    """Return the picture of a file as JPEG, upright, on white, and no larger than a page needs."""
    from PIL import Image, ImageFile, ImageOps

    allowed, most = "a PNG or JPEG picture", f"a picture of at most {MOST_PIXELS // 1_000_000} million pixels"
    cut = ImageFile.LOAD_TRUNCATED_IMAGES
    try:
        ImageFile.LOAD_TRUNCATED_IMAGES = False  # WeasyPrint allows them for the whole process
        with warnings.catch_warnings(), Image.open(io.BytesIO(data), formats=["PNG", "JPEG"]) as opened:
            warnings.simplefilter("ignore")
            width, height = opened.size
            if width * height > MOST_PIXELS:
                raise InputError(field, file, most, f"this one has {width} by {height}")
            opened.draft("RGB", (LONGEST_SIDE, LONGEST_SIDE))
            opened.load()
            image = ImageOps.exif_transpose(opened)
            image = image if image.mode in ("RGB", "RGBA", "L") else image.convert("RGBA")
            image.thumbnail((LONGEST_SIDE, LONGEST_SIDE))
            image = image.convert("RGBA")
    except InputError:
        raise
    except Image.DecompressionBombError:  # Pillow has a limit of its own, above ours
        raise InputError(field, file, most) from None
    except Exception as error:  # a damaged file may raise anything
        raise InputError(field, file, allowed, "" if isinstance(error, OSError) else type(error).__name__) from None
    finally:
        ImageFile.LOAD_TRUNCATED_IMAGES = cut
    white = Image.new("RGB", image.size, "white")
    white.paste(image, mask=image.getchannel("A"))
    written = io.BytesIO()
    white.save(written, "JPEG", quality=QUALITY, optimize=True)
    return written.getvalue()
