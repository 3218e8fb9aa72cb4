import sys
from pathlib import Path

import pytest
from fake_runs import run_with_fakes

from suite.cli.main import main
from suite.show.plots import plot
from suite.show.plots.asked import Asked
from suite.show.plots.style import axis_label, look, named
from suite.store.run_folder import planner_order, read_trials

MAGIC = {".png": b"\x89PNG", ".pdf": b"%PDF", ".svg": b"<?xml"}


@pytest.fixture(scope="module")
def run(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("runs") / "swept"
    run_with_fakes(folder, noise_mm=(0, 1, 2), obstacles=(1, 3), planners=("pf", "rrt", "temporal[horizon=2..3]"))
    return folder


def draw(run: Path, file: Path, **asked: object):
    return plot("curve", read_trials(run), planner_order(run), Asked(**asked), file)


@pytest.mark.parametrize("suffix", [".png", ".pdf", ".svg"])
def test_a_file_of_each_kind_twice_the_same(run: Path, tmp_path, suffix: str) -> None:
    files = [tmp_path / f"{name}{suffix}" for name in "ab"]
    for file in files:
        draw(run, file, over="noise_mm")
    first, second = (file.read_bytes() for file in files)
    assert first.startswith(MAGIC[suffix])
    assert first == second
    assert len(list(tmp_path.iterdir())) == 2


def test_what_is_drawn_is_what_was_counted(run: Path, tmp_path) -> None:
    trials = read_trials(run)
    drawn = draw(run, tmp_path / "a.svg", over="noise_mm", verdict="per_step")
    axes = [axis for axis in drawn.figure.axes if axis.get_visible()]
    assert [axis.get_title() for axis in axes] == ["obstacles 1", "obstacles 3"]
    for axis, n in zip(axes, (1, 3), strict=True):
        labels = [container.get_label() for container in axis.containers]
        assert labels == ["pf", "rrt", "temporal[horizon=2]", "temporal[horizon=3]"]
        for container in axis.containers:
            mine = trials[(trials["planner"] == container.get_label()) & (trials["n_obstacles"] == n)]
            rates = 100 * mine.groupby("noise_mm")["success_per_step"].mean().astype(float)
            x, y = container[0].get_data()
            assert list(x) == [0, 1, 2]
            assert list(y) == pytest.approx(rates.tolist())
            low, high = axis.get_xlim()
            assert low < 0
            assert high > 2
    assert drawn.remarks == ["n = 4 trials a point; bars are 95 % Wilson intervals."]
    assert drawn.figure.get_figwidth() == 3.4


def test_places_on_the_axis_are_the_numbers_themselves(tmp_path) -> None:
    """Whole numbers too, which pandas has types of its own for."""
    run_with_fakes(tmp_path / "run", obstacles=(0, 1, 4), trials=1)
    drawn = draw(tmp_path / "run", tmp_path / "a.svg", over="n_obstacles")
    assert list(drawn.figure.axes[0].containers[0][0].get_xdata()) == [0, 1, 4]


def test_looks_differ_and_names_are_for_people() -> None:
    assert len({look(position) for position in range(24)}) == 24
    assert len({look(position).color for position in range(8)}) == 8
    assert axis_label("max_speed_m_s") == "max speed [m/s]"
    assert named("noise_mm", 2.0) == "noise 2 mm"
    assert named("n_obstacles", 3) == "obstacles 3"


@pytest.mark.parametrize(
    ("options", "line"),
    [
        ("--over nois", "nearest: noise_mm"),
        ("curves", "plot: found 'curves', allowed curve"),
        ("-o figure.gif", "--output: found 'figure.gif', allowed"),
        ("-o no/such/folder/figure.png", "cannot be written"),
        ("--by colour", "by: found 'colour'"),
    ],
)
def test_a_mistake_is_one_line(run: Path, tmp_path, monkeypatch, capfd, options: str, line: str) -> None:
    monkeypatch.chdir(tmp_path)
    capfd.readouterr()
    assert main(["plot", str(run), *options.split()]) == 2
    out, err = capfd.readouterr()
    assert (out, err.count("\n")) == ("", 1)
    assert line in err
    assert list(tmp_path.iterdir()) == []


def test_without_matplotlib_one_line_says_how_to_install_it(run: Path, monkeypatch, capfd) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    capfd.readouterr()
    assert main(["plot", str(run)]) == 2
    assert "pip install 'continuum-arm-suite[report]'" in capfd.readouterr().err


def test_pooling_is_said(run: Path, tmp_path, monkeypatch, capfd) -> None:
    monkeypatch.chdir(tmp_path)
    capfd.readouterr()
    assert main(["plot", str(run), "curve", "--over", "noise_mm", "--by", "", "-o", "a.png"]) == 0
    assert capfd.readouterr().out.splitlines() == [
        "a.png",
        "n = 8 trials a point; bars are 95 % Wilson intervals.",
        "Pooled, as asked, over n_obstacles (1, 3).",
    ]
