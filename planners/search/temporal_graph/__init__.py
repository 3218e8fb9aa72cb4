"""Temporal graphs and their path problems."""
