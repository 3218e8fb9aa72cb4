"""Temporal graphs, and the paper's planner on them."""
