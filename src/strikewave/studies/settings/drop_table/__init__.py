"""A drop table for a pulse: height, programmer and mass of the table."""
