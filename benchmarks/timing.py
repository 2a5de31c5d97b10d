"""What all benchmarks share: the shortest of several times, and tables in markdown."""

import time


def best(function, tries=5):
    """Return the shortest of several times, s; the first call, which may compile, does not count."""
    function()
    times = []
    for _ in range(tries):
        begun = time.perf_counter()
        function()
        times.append(time.perf_counter() - begun)
    return min(times)


def write(seconds):
    """Write a time with a unit that suits it."""
    for unit, size in (("s", 1.0), ("ms", 1e-3), ("us", 1e-6)):
        if seconds >= size:
            return f"{seconds / size:.3g} {unit}"
    return f"{seconds * 1e9:.3g} ns"


def table(heading, rows):
    """Return a table in markdown."""
    lines = [heading, ["---"] * len(heading), *rows]
    return "\n".join("| " + " | ".join(row) + " |" for row in lines)
