"""One function a picture: solution in, matplotlib figure out."""

from strikewave.figures.style import save
from strikewave.figures.summary import summary

__all__ = ["save", "summary"]
