"""One function a picture: solution in, matplotlib figure out."""

from strikewave.figures.summary import summary

__all__ = ["summary"]
