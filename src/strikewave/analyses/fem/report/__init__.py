"""The report of an explicit run."""
