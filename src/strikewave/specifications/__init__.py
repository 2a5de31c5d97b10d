"""Shock specifications: their numbers with status and source, tolerance bands, and what is judged by them."""
