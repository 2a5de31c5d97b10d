"""The fields of the page of records, and messages of the command in their words."""

from __future__ import annotations

import re

TEXTS = {
    "unit": ("unit of the numbers", "that of the file, or such as g"),
    "channel": ("channel", "all, or a name or number"),
    "sensitivity": ("sensitivity", "such as 1.2 mV/g"),
    "ac_coupling": ("AC coupling to take off", "none, or auto, 10 ms, 20 Hz"),
    "q": ("Q of the spectrum", "10 by default"),
    "beside": ("simulation beside it", "none, or such as li-ma-2019:rigid"),
}
"""Options that are typed: what each is, and what one types."""
SELDOM = {
    "polarity": ("polarity", "1, or -1 to turn it"),
    "base": ("base channel", "none, or the one that drives the others"),
    "rate": ("sampling rate", "such as 200 kHz, where a file has no time"),
    "time": ("column of time", "found by itself, or a name or number"),
    "time_unit": ("unit of the time", "that of the file, or such as ms"),
}
"""The same of those that few files need, folded."""
CUTOFFS = {
    "filter": (
        "low-pass",
        "Zero-phase low-pass before blows are measured: a cutoff, or a class such as CFC 1000",
        True,
    ),
    "high_pass": ("high-pass", "Zero-phase high-pass, which takes a slow baseline off", False),
}
"""Options with a handle: what each is, what it does, and whether no filter is at the upper end."""
_LABELS = {key: label for key, (label, *_) in {**TEXTS, **SELDOM, **CUTOFFS, "spec": ("specification",)}.items()}
_OPTION = re.compile(r"--([a-z]+(?:-[a-z]+)*)|^([a-z_]+)(?=: )")


def on_page(message: str) -> str:
    """Return a message that names options of the command, or begins with one of Python, with the fields of the page.

    Examples
    --------
    >>> on_page("the blows are negative: --polarity -1 turns it"), on_page("high_pass: got 1")
    ('the blows are negative: “polarity” -1 turns it', '“high-pass”: got 1')
    >>> on_page("state it, such as --rated-excitation")
    'state it, such as --rated-excitation'
    """

    def named(found: re.Match[str]) -> str:
        label = _LABELS.get((found[1] or found[2]).replace("-", "_"))
        return f"“{label}”" if label else found[0]

    return _OPTION.sub(named, message)
