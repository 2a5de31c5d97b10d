"""Verdicts on records by a specification: options, screen, chapter of the report, pictures."""
