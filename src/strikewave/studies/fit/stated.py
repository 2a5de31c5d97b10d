"""Errors that name where a file states what is wrong, instead of the option that would."""

from __future__ import annotations

import contextlib
import re
from collections.abc import Iterator

from strikewave.base.errors import InputError, InputErrors

_OPTION = re.compile(r"--(?:to|free|try|set|check-on|filter|vary|analysis)(?:: | |$)")


@contextlib.contextmanager
def stated_at(place: str) -> Iterator[None]:
    """Name the place of a file in an error that would name the option of the command; nothing where it is empty.

    Examples
    --------
    >>> with stated_at("fit.toml: number.0"):
    ...     raise InputError("--to first.width", "1", "a time with its unit")
    Traceback (most recent call last):
    strikewave.base.errors.InputErrors: fit.toml: number.0: first.width: got "1"; allowed: a time with its unit
    """
    try:
        yield
    except (InputError, InputErrors) as error:
        if not place:
            raise
        lines = error.lines if isinstance(error, InputErrors) else (str(error),)
        raise InputErrors(f"{place}: {_OPTION.sub('', line, count=1)}" for line in lines) from None
