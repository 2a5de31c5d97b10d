"""Papers reproduced: equations, figures and numbers."""
