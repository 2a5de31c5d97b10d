"""Scatter of blows within the tolerances of a case."""
