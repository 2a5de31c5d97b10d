"""A map of blows over two settings of a machine."""
