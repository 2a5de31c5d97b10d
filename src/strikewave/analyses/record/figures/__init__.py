"""Pictures of records, campaigns and spectra."""
