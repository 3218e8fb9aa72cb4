"""A whole run in one page: table, curves, times, failures, pairs, and every trial's replay."""
