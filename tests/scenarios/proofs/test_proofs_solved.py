"""Scenarios that planners solve: ``python -m benchmarks soundness`` does the same with thousands."""

from itertools import islice

import pytest

from benchmarks.proofs import challenges
from scenarios.proofs import section


def test_what_a_planner_has_solved_is_not_proven_impossible(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(section, "COARSE", 24)  # as sound, and quick
    monkeypatch.setattr(section, "FINE", 36)
    tried = list(islice(challenges(), 100))
    assert not [(challenge.scenario.id, challenge.proof) for challenge in tried if challenge.refuted]
    solved = [challenge for challenge in tried if challenge.executable_s is not None]
    assert len(solved) > 40
    assert sum(challenge.swept_s is not None for challenge in tried) > len(solved)
    # There is something that might have been wrong.
    assert sum(challenge.proof.executable.outcome == "impossible" for challenge in tried) > 1
    assert sum(challenge.proof.executable.outcome == "deadline" for challenge in solved) > 1
