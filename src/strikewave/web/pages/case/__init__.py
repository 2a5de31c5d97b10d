"""Pages of one case: machines, layered bars, elements."""
