"""A kit for reports and screens that knows no analysis: pages, tables, pictures, progress, folders of results."""
