"""What the built package says of itself: the README as an index shows it, and where the project lives.

Files of a repository have no address on an index, so that its pictures and links would lead nowhere. Who publishes
names the repository (`STRIKEWAVE_REPOSITORY=https://host/owner/strikewave make package`): pictures and links then lead
to the files of that version, and the address stands in the metadata. Where none is named, no host is made up: pictures
with their captions are left out, and links to files are plain text.
"""

import os
import re
from pathlib import Path
from typing import Any

from hatchling.metadata.plugin.interface import MetadataHookInterface

PICTURE = re.compile(r"^!\[([^\]]*)\]\((?!https?:)([^)]+)\)\n(\n\*[^*]+\*\n)?\n?", re.MULTILINE)
"""A picture in a paragraph of its own, and the caption below it, in italics."""
LINK = re.compile(r"(?<!!)\[([^\]]+)\]\((?!https?:)([^)#]+)(#[^)]*)?\)")


def readme_of_index(text: str, repository: str = "", version: str = "") -> str:
    """Return the README with addresses of files of a version, or without pictures and links to files.

    Examples
    --------
    >>> readme_of_index("See [waves](docs/waves.md#limits).", "https://host/a/b", "1.0.0")
    'See [waves](https://host/a/b/blob/v1.0.0/docs/waves.md#limits).'
    >>> readme_of_index("See [waves](docs/waves.md#limits).")
    'See waves.'
    """
    if not repository:
        return LINK.sub(r"\1", PICTURE.sub("", text))
    text = re.sub(r"!\[([^\]]*)\]\((?!https?:)([^)]+)\)", rf"![\1]({repository}/raw/v{version}/\2)", text)
    return LINK.sub(rf"[\1]({repository}/blob/v{version}/\2\3)", text)


class CustomMetadataHook(MetadataHookInterface):
    """Gives README and addresses to the build."""

    def update(self, metadata: dict[str, Any]) -> None:
        """Fill in what is dynamic, but for the version, which hatch reads itself."""
        root = Path(self.root)
        repository = os.environ.get("STRIKEWAVE_REPOSITORY", "").rstrip("/")
        version = re.search(r'__version__ = "(.+)"', (root / "src/strikewave/_version.py").read_text("utf-8"))[1]
        text = readme_of_index((root / "README.md").read_text("utf-8"), repository, version)
        metadata["readme"] = {"content-type": "text/markdown", "text": text}
        metadata["urls"] = (
            {
                "Repository": repository,
                "Documentation": f"{repository}/blob/v{version}/docs/index.md",
                "Changelog": f"{repository}/blob/v{version}/CHANGELOG.md",
                "Issues": f"{repository}/issues",
            }
            if repository
            else {}
        )
