"""Proofs that a scenario cannot be solved, by anybody; they know no planner and no audit (docs/possible.md)."""

from scenarios.proofs.bound import Bound, Proof, Reason
from scenarios.proofs.prove import Effort, prove

__all__ = ["Bound", "Effort", "Proof", "Reason", "prove"]
