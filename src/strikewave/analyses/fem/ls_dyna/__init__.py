"""A run of LS-DYNA beside ours."""
