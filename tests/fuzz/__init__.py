"""Broken files for everything that the suite reads: ``make fuzz``."""
