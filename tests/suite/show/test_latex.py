import re
import shutil
import subprocess
from pathlib import Path

import pytest
from fake_runs import run_with_fakes

import suite
from suite.cli.main import main
from suite.show.latex import _aligned, as_latex, escaped

ROOT = Path(__file__).resolve().parents[3]
DOCUMENT = "\\documentclass{article}\n\\usepackage{booktabs}\n\\begin{document}\n%s\\end{document}\n"


@pytest.fixture(scope="module")
def run(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("latex") / "my_run"
    run_with_fakes(folder, planners=("pf", "ompl.RRT[range=0.5,goal_bias=0.1]"))
    return folder


def test_every_line_has_a_cell_for_every_column(run) -> None:
    text = as_latex("my_run", suite.load(run).table())
    spec = re.search(r"\\begin\{tabular\}\{(.*)\}", text)[1]
    columns = len(re.sub(r"@\{.*?\}", "", spec))
    lines = [line for line in text.splitlines() if line.endswith(r"\\")]
    assert len(lines) == 5  # the head, and two planners under two numbers of obstacles
    for line in lines:
        wide = sum(int(n) - 1 for n in re.findall(r"\\multicolumn\{(\d)\}", line))
        assert len(re.findall(r"(?<!\\)&", line)) + wide + 1 == columns
    assert text.count(r"\midrule") == 2
    assert r"\label{tab:my-run}" in text
    assert r"n = 4 trials a row" in text
    assert r"goal\_bias" in text
    assert not re.findall(r"(?<![\\\n])%(?! \\usepackage)", text.partition("\n")[2])


def test_points_stand_under_one_another() -> None:
    filled = _aligned(["1.25", "30", "-", "0.5"])
    assert filled == ["1.25", r"30\phantom{.00}", r"-\phantom{.00}", r"0.5\phantom{0}"]
    assert _aligned(["1", "30"]) == ["1", "30"]


def test_no_sign_is_a_command() -> None:
    assert escaped("a_b%{$#&}~^\\") == r"a\_b\%\{\$\#\&\}\textasciitilde{}\textasciicircum{}\textbackslash{}"


def test_columns_are_chosen_by_name_with_or_without_unit(run, capfd) -> None:
    assert main(["table", str(run), "--columns", "planner,swept,n,per step %", "--format", "markdown"]) == 0
    (head,) = [line for line in capfd.readouterr().out.splitlines() if "planner" in line]
    assert [cell.strip() for cell in head.strip("|").split("|")] == ["planner", "swept %", "n", "per step %"]
    assert main(["table", str(run), "--columns", "planner,sweept", "--format", "latex"]) == 2
    assert "nearest: swept" in capfd.readouterr().err
    assert main(["table", str(run), "--columns", "planner", "--format", "csv"]) == 2
    assert main(["table", str(run), "--columns", "planner,arrival"]) == 0


def test_names_that_two_columns_share_need_their_unit(capfd) -> None:
    table = ["table", str(ROOT / "results" / "table1"), "--against", "published", "--format", "markdown", "--columns"]
    assert main([*table, "planner,published"]) == 2
    out, err = capfd.readouterr()
    assert out == ""
    assert "nearest: published s" in err
    assert main([*table, "planner,published s"]) == 0
    assert "published s" in capfd.readouterr().out


@pytest.mark.skipif(not (shutil.which("tectonic") or shutil.which("pdflatex")), reason="found no tectonic, no pdflatex")
def test_it_compiles(run, tmp_path) -> None:
    (tmp_path / "a.tex").write_text(DOCUMENT % as_latex("my_run", suite.load(run).table()), encoding="utf-8")
    command = ["tectonic"] if shutil.which("tectonic") else ["pdflatex", "-interaction=nonstopmode", "-halt-on-error"]
    subprocess.run([*command, "a.tex"], cwd=tmp_path, check=True, stdout=subprocess.DEVNULL)
    assert (tmp_path / "a.pdf").read_bytes().startswith(b"%PDF")
