"""Uncertainty budgets of measured blows and spectra: what the channel may have done to the record, propagated twice."""
