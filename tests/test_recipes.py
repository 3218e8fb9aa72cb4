"""Recipes: pages whose commands are run, one after the other, in one folder; fewer trials where they take minutes."""

from pathlib import Path

import pytest
from test_docs import ROOT, blocks_of, folder, run

RECIPES = sorted((ROOT / "docs" / "recipes").glob("*.md"))
BEFORE = {
    "ci-gate": "suite new-planner mine",
    "cluster": "for s in one two; do suite run --planners pf --obstacles 1 --trials 1 --out results/$s; done",
}
"""What a reader of a page has done before."""
SMALLER = {
    "ci-gate": {"--obstacles 1,3,5,6 --trials 100": "--obstacles 1 --trials 1"},
    # On machines of one's own: tests/suite/backends/cluster has a scheduler and workers that were there before.
    "cluster": {
        "--workers 2": "--workers 2 --obstacles 1 --trials 1",
        "--out results/large": "--out results/large --dry-run",
    },
    "ompl-planner": {"--trials 10": "--trials 1"},
    "paper-table": {"--trials 400": "--trials 1", "--preset table1": "--preset table1 --obstacles 1 --trials 1"},
}
"""What takes minutes, and what is run in its place."""

__all__ = ["folder"]  # a fixture


@pytest.mark.parametrize("page", RECIPES, ids=lambda page: page.stem)
def test_every_block_of_a_recipe_runs(page: Path, folder: Path) -> None:
    text = page.read_text(encoding="utf-8")
    blocks = blocks_of(text)
    assert {block.language for block in blocks} <= {"sh", "yaml"}
    assert text.count("```") == 2 * len(blocks)
    run(folder, "bash", "-ec", BEFORE.get(page.stem, "true"))
    for as_written, smaller in SMALLER.get(page.stem, {}).items():
        assert as_written in text
        text = text.replace(as_written, smaller)
    for block in blocks_of(text):
        if block.language == "yaml":
            name = block.code.partition("\n")[0].removeprefix("# ")
            (folder / "work" / name).write_text(block.code)
        else:
            assert run(folder, "bash", "-ec", block.code)


def test_the_sweep_was_grown_drawn_and_pooled(folder: Path) -> None:
    said = run(folder, "suite", "table", "results/study", "--by", "noise_mm")
    assert said.startswith("Pooled, as asked, over n_obstacles (1, 2), max_speed_m_s (0.01, 0.03).")
    rows = (folder / "work" / "results" / "study" / "trials.csv").read_text().splitlines()
    assert len(rows) == 1 + 2 * 2 * 2 * 3 * 2  # planners, obstacles, speeds, noises, trials
    assert (folder / "work" / "noise.svg").read_text().count("<svg") == 1
    assert (folder / "work" / "depth.pdf").read_bytes().startswith(b"%PDF")
