"""Recipes: pages whose commands are run, one after the other, in one folder.

Of those that are not, being long or about other machines, test_pages.py reads the commands.
"""

from pathlib import Path

import pytest
from test_docs import ROOT, blocks_of, folder, run

NOT_RUN = {"ci-gate", "cluster", "ompl-planner", "paper-table"}
PAGES = sorted((ROOT / "docs" / "recipes").glob("*.md"))
RECIPES = [page for page in PAGES if page.stem not in NOT_RUN]

__all__ = ["folder"]  # a fixture


@pytest.mark.parametrize("page", RECIPES, ids=lambda page: page.stem)
def test_every_block_of_a_recipe_runs(page: Path, folder: Path) -> None:
    text = page.read_text(encoding="utf-8")
    blocks = blocks_of(text)
    assert {block.language for block in blocks} <= {"sh", "yaml"}
    assert text.count("```") == 2 * len(blocks)
    for block in blocks:
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
