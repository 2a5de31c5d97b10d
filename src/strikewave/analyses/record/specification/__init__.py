"""Shock specifications as results: one with every number, and base motions that meet one."""
