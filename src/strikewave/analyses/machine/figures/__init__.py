"""Pictures of a machine: summary, pulses, drawing, motion."""
