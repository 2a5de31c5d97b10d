"""The version of strikewave, in one place."""

__version__ = "0.1.0"
