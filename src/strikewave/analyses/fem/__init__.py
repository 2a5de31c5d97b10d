"""Explicit finite elements: bodies of hexahedra that strike each other."""
