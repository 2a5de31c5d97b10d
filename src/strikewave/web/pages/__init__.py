"""The pages, a folder each: one case, measured files, fits and studies."""
