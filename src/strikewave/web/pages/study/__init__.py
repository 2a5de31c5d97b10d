"""The page of fits and studies."""
