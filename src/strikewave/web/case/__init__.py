"""What a page holds of a case: its state, its quantities, its layers."""
