"""The browser of the tests."""

import os
import shutil

import pytest

PROGRAMS = ("chromium-headless-shell", "chromium", "google-chrome")
HOW_TO_GET = "chromium is not installed; Debian: apt-get install --no-install-recommends chromium-headless-shell"


def chromium():
    """Return where the system's Chromium is; a test that needs it is skipped without one, and fails in CI."""
    found = next(filter(None, map(shutil.which, PROGRAMS)), None)
    if found is None:
        (pytest.fail if os.environ.get("CI") == "true" else pytest.skip)(HOW_TO_GET)
    return found
