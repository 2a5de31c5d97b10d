"""Work as a count of lines run, the same on any machine and under any load."""

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import strikewave

OURS = str(Path(strikewave.__file__).parent)


def lines_run(function: Callable[..., Any], *words: Any) -> int:
    """Return how many lines of strikewave a call runs; what is compiled or written in C counts as the line it is in."""
    count = 0

    def in_line(frame: Any, event: str, argument: Any) -> Any:
        nonlocal count
        count += event == "line"
        return in_line

    def in_call(frame: Any, event: str, argument: Any) -> Any:
        return in_line(frame, "line", None) if frame.f_code.co_filename.startswith(OURS) else None

    before = sys.gettrace()
    sys.settrace(in_call)
    try:
        function(*words)
    finally:
        sys.settrace(before)
    return count
