"""Animations: one page with one player for all analyses, and one writer of GIFs."""
