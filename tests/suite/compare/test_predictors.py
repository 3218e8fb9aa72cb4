import pandas as pd
import pytest

from planners import PREDICTORS
from suite.cli.main import main
from suite.compare.predictors import HORIZONS_S, SEEN, Conditions, as_table, measure

CONDITIONS = Conditions("orbit", 2, 2, 1000, 0.5)


def test_every_predictor_but_the_oracle_is_measured_at_every_horizon() -> None:
    measured = measure(CONDITIONS)
    names = [name for name, entry in PREDICTORS.items() if not entry.is_oracle]
    assert len(measured) == len(names) * len(SEEN) * len(HORIZONS_S)
    assert list(measured["predictor"].unique()) == names
    assert (measured["error_p95_m"] >= 0).all()
    assert measured["covered_percent"].between(0, 100).all()
    again = measure(CONDITIONS)
    pd.testing.assert_frame_equal(measured.drop(columns="time_median_s"), again.drop(columns="time_median_s"))


def test_the_arc_is_exact_on_orbits_without_noise() -> None:
    measured = measure(CONDITIONS._replace(noise_mm=0.0))
    arc = measured[measured["predictor"] == "arc"]
    assert (arc["error_p95_m"] < 1e-6).all()
    assert (arc["covered_percent"] == 100).all()
    lines = as_table(measured, "simple").splitlines()
    assert sum(" arc " in line and "0 / 0 (100)" in line for line in lines) == len(SEEN)


@pytest.mark.parametrize("suffix", [".csv", ".md"])
def test_the_command_prints_and_writes(tmp_path, capsys, suffix: str) -> None:
    file = tmp_path / f"measured{suffix}"
    assert main(["predictors", "--trials", "1", "--obstacles", "1", "--noise-mm", "1", "--out", str(file)]) == 0
    assert "portfolio" in capsys.readouterr().out
    assert "portfolio" in file.read_text()


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        ("--family spiral", "'spiral'"),
        ("--trials 0", "trials: found 0"),
        ("--obstacles 0", "obstacles: found 0"),
        ("--noise-mm nan", "noise_mm: found nan"),
        ("--dropout 1", "dropout: found 1.0"),
        ("--out here.txt", "'here.txt'"),
        ("--out nowhere/here.md", "'nowhere'"),
    ],
)
def test_a_mistake_is_one_line_and_exit_code_2(capsys, arguments: str, named: str) -> None:
    assert main(["predictors", *arguments.split()]) == 2
    said = capsys.readouterr().err.strip()
    assert len(said.splitlines()) == 1
    assert named in said
