"""The guide's commands, page by page, as they stand there but for fewer and smaller trials.

Pages whose blocks build on each other run in test_docs.py and test_recipes.py. This file runs the commands of all
others in one folder that has what its reader would have: finished runs, a planner, tracks, scenes, meshes.
"""

import json
import os
import re
import shlex
import shutil
from pathlib import Path

import pytest
from test_pages import commands

from suite.cli.main import main

ROOT = Path(__file__).resolve().parents[1]
GUIDE = ["README.md", *(f"docs/{name}.md" for name in (
    "audit", "commands", "compare", "export", "import", "merge", "possible", "prediction", "scenarios", "start",
    "strrt", "table", "temporal-ct",
))]  # fmt: skip
STUDY = """
planners: [pf]
obstacles: [1]
trials: 1
sweep: {noise_mm: [0, 2]}
"""
SCENE = {
    "fps": 30,
    "frame_count": 1,
    "start_configuration": [0.0] * 6,
    "obstacles": [
        {"name": "ball", "type": "dynamic_sphere", "radius": 0.05, "positions": [[0.3, 0, 0.2, 0, 0, 0, 1]] * 2}
    ],
}
CORNERS = ((0, 0, 0), (100, 0, 0), (0, 100, 0), (0, 0, 100))
TETRAHEDRON = ((0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3))


def small(line: str) -> list[str]:
    """Words of a command that asks for as little as it can."""
    words = shlex.split(os.path.expandvars(line), comments=True)[1:]
    fewest = {"run": {"--trials": "1", "--obstacles": "1"}, "predictors": {"--trials": "2", "--obstacles": "1"},
              "generate": {"--trials": "1", "--obstacles": "3"}}.get(words[0], {})  # fmt: skip
    if "hard" in words:
        fewest["--obstacles"] = "3"
    for option, value in fewest.items():
        if option in words:
            words[words.index(option) + 1] = value
        elif "--scenarios" not in words:
            words += [option, value]
    more = {"run": ["--workers", "1"], "export": ["--overwrite"]}
    return [*words, *more.get(words[0], [])]


def do(line: str) -> None:
    assert main(shlex.split(line)) == 0, line


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A reader's folder."""
    folder = tmp_path_factory.mktemp("reader")
    back = Path.cwd()
    os.chdir(folder)
    try:
        for name in ("scenarios", "docs"):
            (folder / name).symlink_to(ROOT / name)
        shutil.copytree(ROOT / "results" / "table1", folder / "results" / "table1")
        do("run --planners t3,rrt --obstacles 3 --trials 8 --out results/mine --workers 1")
        do("run --planners temporal-ct --obstacles 1 --trials 1 --out results/one --workers 1")
        do("run --planners temporal-ct --obstacles 1 --trials 1 --seed 1 --out results/two --workers 1")
        for name, like in (("before", "one"), ("after", "one"), ("seed-0", "one"), ("seed-1", "two")):
            shutil.copytree(folder / "results" / like, folder / "results" / name)
        shutil.copytree(folder / "results" / "one", folder / "laptop" / "run")
        do("export results/mine points motion.npz --scenario orbit-n3-s0-0007 --planner rrt")
        shutil.copy(folder / "results" / "mine" / "scenarios.jsonl", folder)
        header, *states = (folder / "results" / "mine" / "trajectories.csv").read_text().splitlines(keepends=True)
        found = [line for line in states if line.startswith("orbit-n3-s0-0007,rrt")]
        (folder / "trajectories.csv").write_text("".join([header, *found]))
        (folder / "study.yaml").write_text(STUDY)
        do("run study.yaml --workers 1")
        walk = [f"walker,{t},{0.6 - t / 100},0.3,0.3" for t in range(30)]
        (folder / "walk.csv").write_text("\n".join(["id,t,x,y,z", *walk]))
        (folder / "scene_task.json").write_text(json.dumps(SCENE))
        facets = ["facet normal 0 0 0\nouter loop", "endloop\nendfacet"]
        vertices = [[f"vertex {' '.join(map(str, CORNERS[k]))}" for k in face] for face in TETRAHEDRON]
        stl = ["solid shelf", *("\n".join([facets[0], *three, facets[1]]) for three in vertices), "endsolid shelf"]
        (folder / "shelf.stl").write_text("\n".join(stl))
        points = [f"v {' '.join(map(str, corner))}" for corner in CORNERS]
        faces = [f"f {' '.join(str(k + 1) for k in face)}" for face in TETRAHEDRON]
        (folder / "table.obj").write_text("\n".join([*points, *faces]))
    finally:
        os.chdir(back)
    return folder


@pytest.mark.parametrize("page", GUIDE)
def test_every_command_of_a_page_of_the_guide_runs(page: str, folder: Path, tmp_path: Path, monkeypatch) -> None:
    shutil.copytree(folder, tmp_path, symlinks=True, dirs_exist_ok=True)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("BROWSER", "true")  # a command that opens nothing
    text = (ROOT / page).read_text(encoding="utf-8")
    for name, value in re.findall(r"^    ([A-Z]+)=(\S+)$", text, re.MULTILINE):
        monkeypatch.setenv(name, value)
    found = commands(text)
    assert found
    for line in found:
        assert main(small(line)) == 0, line
