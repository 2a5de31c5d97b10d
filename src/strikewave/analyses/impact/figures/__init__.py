"""Pictures of contact laws and impacts."""
