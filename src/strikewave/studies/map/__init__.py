"""A map of blows over two settings of a machine, and what it is of unless said otherwise."""

X, Y = "machine.speed", "object.spring"
"""Settings along the axes."""
POINTS = (60, 60)
"""Points along the axes."""
TRAIN = 60
"""Blows of the longer train: its second half then shows a period of `LONGEST_PERIOD` `CYCLES` times; see `.regimes`."""
EQUAL = 0.02
"""Largest coefficient of variation of equal blows."""
