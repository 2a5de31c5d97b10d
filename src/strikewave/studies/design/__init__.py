"""Settings of any case for goals on its numbers, ranked and verified; or which goals exclude each other."""
