"""Many runs of a case: what is varied, what is kept of each, where it is kept, and who runs them."""
