"""Many names in a line: the first few, and how many more there are."""

from collections.abc import Sequence


def are_many(names: Sequence[str], most: int) -> bool:
    """Tell whether names are counted beyond the first: to count one takes as much room as to name it."""
    return len(names) > most + 1


def first_few(names: Sequence[str], most: int, mark: str = ", ") -> str:
    """Return names in a line; of many, the first ones and how many more there are.

    Examples
    --------
    >>> first_few(["a", "b", "c"], 2), first_few(["a", "b", "c", "d"], 2, "; ")
    ('a, b, c', 'a; b and 2 more')
    """
    return f"{mark.join(names[:most])} and {len(names) - most} more" if are_many(names, most) else mark.join(names)
