"""Pictures of an explicit run: histories, bodies cut open, blows, motion."""
