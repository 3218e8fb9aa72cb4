"""Small wrong changes to the code, each with the tests that must notice it: ``make mutants`` tries them one by one."""

from .table import MUTANTS, Mutant

__all__ = ["MUTANTS", "Mutant"]
