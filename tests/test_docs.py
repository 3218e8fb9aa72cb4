"""Pages whose code is run: every block, in the order in which it stands there."""

import csv
import os
import re
import shlex
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import NamedTuple

import pytest

from planners import ArmPlanner
from planners.plugins import GROUP
from suite.cli.main import main

ROOT = Path(__file__).resolve().parents[1]
PAGE = (ROOT / "docs" / "adding-a-planner.md").read_text(encoding="utf-8")


class Block(NamedTuple):
    language: str
    code: str


PYTHON_PAGE = (ROOT / "docs" / "python.md").read_text(encoding="utf-8")


def blocks_of(page: str) -> list[Block]:
    return [Block(*found) for found in re.findall(r"^```(\w*)\n(.*?)^```$", page, re.MULTILINE | re.DOTALL)]


BLOCKS = blocks_of(PAGE)


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    """A user's folder, with ``suite`` and ``python`` on the path."""
    folder = tmp_path_factory.mktemp("reader")
    (folder / "bin").mkdir()
    for name, command in (("suite", f"{sys.executable} -P -m suite"), ("python", sys.executable)):
        (folder / "bin" / name).write_text(f'#!/bin/sh\nexec {command} "$@"\n')
        (folder / "bin" / name).chmod(0o755)
    (folder / "work").mkdir()
    return folder


def run(folder: Path, *command: str, path: Path = ROOT) -> str:
    places = {"PATH": f"{folder / 'bin'}:{os.environ['PATH']}", "PYTHONPATH": f"{ROOT}:{path}"}
    done = subprocess.run(
        command, cwd=folder / "work", env=os.environ | places, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def test_the_page_has_blocks_of_known_languages_only() -> None:
    assert {block.language for block in BLOCKS} == {"sh", "python", "toml"}
    assert PAGE.count("```") == 2 * len(BLOCKS)


@pytest.mark.parametrize("block", BLOCKS, ids=lambda block: f"{block.language}: {block.code.splitlines()[0][:40]}")
def test_every_block_does_what_it_says(block: Block, folder: Path) -> None:
    if block.language == "sh":
        assert run(folder, "bash", "-ec", block.code.replace("--trials 200", "--trials 4"))
    elif block.language == "python":
        run(folder, "python", "-c", block.code)
    else:
        (points,) = tomllib.loads(block.code)["project"]["entry-points"].items()
        assert points[0] == GROUP
        metadata = folder / "site" / "mine-1.dist-info"
        metadata.mkdir(parents=True)
        (metadata / "METADATA").write_text("Metadata-Version: 2.1\nName: mine\nVersion: 1\n")
        lines = [f"[{GROUP}]", *(f"{name} = {value}" for name, value in points[1].items())]
        (metadata / "entry_points.txt").write_text("\n".join(lines))
        code = "from planners.spec import load, parse_planner; print(load(parse_planner('mine'))[0].__name__)"
        assert run(folder, "python", "-c", code, path=folder / "site") == "Mine\n"


def test_every_trial_among_no_obstacles_arrived(folder: Path) -> None:
    for name in ("mine-3", "mine-2"):
        with (folder / "work" / "results" / name / "table.csv").open(encoding="utf-8", newline="") as table:
            row = next(csv.DictReader(table))
        assert (row["planner"], row["trials"]) == ("Mine", "4")
        assert float(row["success_executable_percent"]) == 100.0


def test_the_page_knows_every_class_attribute() -> None:
    declared = {name for name, kind in ArmPlanner.__annotations__.items() if "ClassVar" in str(kind)}
    table = PAGE.partition("## What does the suite want to know of it?")[2].partition("\n## ")[0]
    assert set(re.findall(r"^\| `(\w+)` \|", table, re.MULTILINE)) == declared


def test_the_commands_of_the_papers_page_leave_the_files_it_names(folder: Path) -> None:
    page = (ROOT / "docs" / "paper.md").read_text(encoding="utf-8")
    (folder / "work" / "docs").symlink_to(ROOT / "docs")
    blocks = blocks_of(page)
    assert {block.language for block in blocks} == {"sh"}
    assert page.count("```") == 2 * len(blocks)
    for block in blocks:
        small = re.sub(r"--trials \d+", "--trials 1 --obstacles 1 --workers 1", block.code).replace(
            "docs/figures/depth.png", "depth.png"
        )
        run(folder, "bash", "-ec", small)
        for out in re.findall(r"--out (results/[\w-]+)(?:$|\s)", block.code):
            assert (folder / "work" / out / "table.md").is_file(), out
    assert (folder / "work" / "depth.png").is_file()
    assert "n = 1: ball 100.0 %, cube 100.0 %" in run(folder, "python", "docs/figures/arrival.py", "t3", "1", "1000")


def test_every_block_of_the_python_page_runs(folder: Path) -> None:
    blocks = blocks_of(PYTHON_PAGE)
    assert {block.language for block in blocks} == {"python"}
    assert PYTHON_PAGE.count("```") == 2 * len(blocks)
    said = [run(folder, "python", "-c", block.code) for block in blocks]  # the second reads what the first has run
    assert all(said)
    assert said[-1] == "stuck\n"


def test_simple_setup_drives_a_planner_as_the_page_of_the_arbiter_shows(folder: Path) -> None:
    page = (ROOT / "docs" / "arbiter.md").read_text(encoding="utf-8")
    (block,) = blocks_of(page)
    said = [line for line in run(folder, "python", "-c", block.code).splitlines() if not line.startswith("Info:")]
    assert [line.split()[0] for line in said] == ["0", "1", "2", "3"]


def test_the_page_on_looking_shows_what_it_says(tmp_path, monkeypatch, capfd) -> None:
    monkeypatch.setenv("BROWSER", "true")  # a command that opens nothing
    monkeypatch.chdir(tmp_path)
    page = (ROOT / "docs" / "looking.md").read_text(encoding="utf-8")
    (tmp_path / "scenarios").symlink_to(ROOT / "scenarios")
    blocks = blocks_of(page)
    assert {block.language for block in blocks} == {"sh"}
    said = []
    for command in "".join(block.code for block in blocks).splitlines():  # in this process: there are many
        words, _, file = command.partition(" > ")
        assert main(shlex.split(words)[1:]) == 0, command
        said.append(capfd.readouterr().out)
        if file:
            (tmp_path / file).write_text(said[-1])
    quoted = re.findall(r"(?:^> .*\n)+", page, re.MULTILINE)[0].replace("\n>", "").removeprefix("> ").strip()
    assert quoted in said[1]
    for name in ("trial.html", "report.html", "curve.pdf", "times.pdf", "profile.pdf", "verdicts.pdf", "paths.pdf"):
        assert (tmp_path / name).stat().st_size > 5000, name
    assert (tmp_path / "table.tex").read_text().startswith("% \\usepackage{booktabs}")
    for picture in re.findall(r"\]\((pictures/.*?)\)", page):
        assert (ROOT / "docs" / picture).stat().st_size < 300_000
