"""A layered bar under its load."""
