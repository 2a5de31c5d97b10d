"""Two histories held against one another: measured, simulated, or the corridor of a campaign."""
