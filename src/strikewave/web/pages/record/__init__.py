"""The page of measured files."""
