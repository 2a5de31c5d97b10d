"""Base motions that meet a specification of a shock response spectrum."""
