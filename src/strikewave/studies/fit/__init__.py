"""A case fitted to measurements: what they tell of its values, and what they do not."""
