"""The tables of a case file as frozen models: which fields each has, and what each may be."""
