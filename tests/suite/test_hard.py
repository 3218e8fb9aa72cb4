"""Scenarios that tell planners apart: solved by somebody, failed by the planners that are named."""

import csv
from unittest.mock import patch

import pytest

from scenarios import generate, load_scenarios
from suite import hard, run_trial
from suite.cli.main import main


@pytest.fixture(scope="module")
def kept(tmp_path_factory):
    """Two hard scenarios, and the list of who solved them."""
    file = tmp_path_factory.mktemp("hard") / "hard.jsonl"
    given = ["--keep", "possible-hard", "--failed-by", "pf", "--obstacles", "6", "--trials", "2", "--seed", "1000"]
    with patch.object(hard, "FIRST_BATCH", 12):
        assert main(["generate", str(file), *given, "--workers", "1"]) == 0
    with file.with_suffix(".csv").open(encoding="utf-8", newline="") as handle:
        return load_scenarios(file), list(csv.DictReader(handle))


def test_somebody_solves_them_and_the_named_planner_does_not(kept) -> None:
    scenarios, listed = kept
    assert [row["scenario_hash"] for row in listed] == [scenario.content_hash for scenario in scenarios]
    assert len(scenarios) == 2
    for scenario, row in zip(scenarios, listed, strict=True):
        assert not run_trial(scenario, row["failed_by"]).row["success_executable"]
        assert run_trial(scenario, row["solved_by"]).row["success_executable"]


def test_they_are_scenarios_of_the_family_as_it_is(kept) -> None:
    drawn = {scenario.content_hash for scenario in generate("orbit", 6, 100, 1000)}
    assert {scenario.content_hash for scenario in kept[0]} <= drawn
