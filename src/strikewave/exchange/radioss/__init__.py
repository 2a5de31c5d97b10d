"""Decks for OpenRadioss written."""
