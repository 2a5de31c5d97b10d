"""The ground floor: errors, units, quantities, materials, sources, compilation, and how results reach the disk."""
