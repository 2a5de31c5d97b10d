"""Pictures of waves in a layered bar: histories, x-t diagram, motion."""
