"""Measured records: blows found and measured, campaigns, shock response spectra."""
