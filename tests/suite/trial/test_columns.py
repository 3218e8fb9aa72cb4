from pathlib import Path

import numpy as np
import pytest

from suite.auditor.verdicts import VERDICTS
from suite.trial.columns import COLUMN_NAMES, COLUMNS, TIMING_NAMES, complete_row


def test_names_are_unique_and_carry_their_unit() -> None:
    assert len(set(COLUMN_NAMES)) == len(COLUMN_NAMES)
    for column in COLUMNS:
        assert not column.unit or column.name.endswith(f"_{column.unit}"), column.name
        assert column.meaning


def test_every_verdict_has_its_columns() -> None:
    for verdict in VERDICTS:
        expected = {f"success_{verdict}", f"violation_{verdict}_time_s", f"violation_{verdict}_kind"}
        assert expected <= set(COLUMN_NAMES)


def test_timings_are_the_wall_clock_columns_only() -> None:
    expected = {"planning_time_s", "solve_p50_s", "solve_p95_s", "solve_max_s", "audit_time_s", "trial_wall_s"}
    assert expected == TIMING_NAMES


def test_a_row_has_all_columns_in_order_as_plain_values() -> None:
    row = complete_row({"n_solves": np.int64(3), "limits": np.True_, "min_clearance_m": np.float64(0.5)})
    assert tuple(row) == COLUMN_NAMES
    assert type(row["n_solves"]) is int
    assert row["limits"] is True
    assert type(row["min_clearance_m"]) is float


@pytest.mark.parametrize("missing", [None, float("nan"), np.float64("nan")])
def test_what_a_trial_does_not_have_is_none(missing: float | None) -> None:
    assert complete_row({"arrival_time_s": missing})["arrival_time_s"] is None


def test_zero_is_not_missing() -> None:
    row = complete_row({"arrival_time_s": 0.0, "n_solves": 0, "success_swept": False})
    assert (row["arrival_time_s"], row["n_solves"], row["success_swept"]) == (0.0, 0, False)


def test_an_unknown_name_is_an_error() -> None:
    with pytest.raises(KeyError, match="planing_time_s"):
        complete_row({"planing_time_s": 1.0})


def test_every_column_is_in_the_docs() -> None:
    page = (Path(__file__).parents[3] / "docs" / "numbers.md").read_text()
    for column in COLUMNS:
        assert f"| `{column.name}` | {column.unit} | {column.meaning} |" in page
