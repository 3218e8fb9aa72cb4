"""Faults put into runs of real trials, which must end as the unbroken run does: ``make faults``."""
