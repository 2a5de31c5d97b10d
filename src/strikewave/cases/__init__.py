"""The case file: its tables and checks, the built-in cases, and the parts that several analyses build from it."""
