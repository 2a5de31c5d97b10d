"""Gasket stacks under a sensor, ranked by what it then reads, and what a search for them begins with."""

WORST = "worst"
"""The blow that the stacks are compared at: that with the largest reading."""
THICKNESSES = ("0.5 mm", "1 mm", "2 mm")
"""Thicknesses of the gaskets."""
THICKEST = 0.1
"""Largest thickness of a gasket, m."""
LAYERS = 3
"""Largest number of gaskets in a stack."""
