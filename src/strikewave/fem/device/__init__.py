"""Runs whose steps are taken on a device, such as a GPU, by the formulas of `strikewave.fem`."""
