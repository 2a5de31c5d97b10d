"""Draws of what is uncertain, the statistics of their results, and the share of each input."""
