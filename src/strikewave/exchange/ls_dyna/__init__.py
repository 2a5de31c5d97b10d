"""Decks for LS-DYNA written, its results read."""
