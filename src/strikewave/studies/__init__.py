"""Questions over many runs: each its study, its pictures, its command."""
