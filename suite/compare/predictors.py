"""How well each predictor foretells the obstacles of a family: errors, honesty of its bounds, time."""

from __future__ import annotations

import time
from typing import NamedTuple

import numpy as np
import pandas as pd
from tabulate import tabulate

from planners import PREDICTORS
from planners.prediction import Predictor
from scenarios import STEP_S, Scenario, generate
from suite.errors import SuiteError
from suite.progress import progress
from suite.trial.observation import FloatArray, Observer

HORIZONS_S = (1, 2, 3, 5, 8, 12, 20)
SEEN = (6, 12, 30, 90)
"""Numbers of observations after which predictors are asked: at t = 0, and later in a trial."""
REACH_S, SPACING_S = 120.0, 0.25
"""What predictors are asked for: as much as any planner asks."""
SPREAD = 2.0
"""Bounds are judged at this many standard deviations, which should hold 95 % of errors."""
ROUNDING_M = 1e-8
"""An error below this is none."""


class Conditions(NamedTuple):
    """What predictors are measured on."""

    family: str
    n_obstacles: int
    trials: int
    seed: int
    noise_mm: float = 0.0
    dropout: float = 0.0

    def __str__(self) -> str:
        """The conditions in a sentence."""
        return (
            f"Family {self.family}, {self.trials} scenarios with {self.n_obstacles} obstacles, seed {self.seed};"
            f" noise {self.noise_mm:g} mm, dropout {self.dropout:g}."
        )


class _Sensing(NamedTuple):
    """See ``suite.trial.observation.Sensing``."""

    scenario: Scenario
    seed: int
    noise_mm: float
    dropout: float


class _Outcome(NamedTuple):
    """One prediction beside the truth, by horizon and obstacle."""

    errors_m: FloatArray
    bounds_m: FloatArray
    time_s: float


def measure(conditions: Conditions) -> pd.DataFrame:
    """Measure every predictor but the oracle, on what a planner would be given.

    Returns:
        One row per predictor, number of observations and horizon: mean and 95 % quantile of the error [m], the share of
        errors within ``SPREAD`` bounds, and the median time of a call [s].

    Raises:
        SuiteError: Noise or dropout out of range, or no obstacles.
        SpecError: Unknown family or setting.
        ScenarioError: Numbers out of range.
    """
    if not 0 <= conditions.noise_mm <= 1000:
        raise SuiteError(f"noise_mm: found {conditions.noise_mm}, allowed 0 to 1000")
    if not 0 <= conditions.dropout < 1:
        raise SuiteError(f"dropout: found {conditions.dropout}, allowed 0 to less than 1")
    if conditions.n_obstacles < 1:
        raise SuiteError(f"obstacles: found {conditions.n_obstacles}, allowed 1 to 1000")
    scenarios = generate(conditions.family, conditions.n_obstacles, conditions.trials, conditions.seed)
    names = [name for name, entry in PREDICTORS.items() if not entry.is_oracle]
    rows: list[dict[str, object]] = []
    with progress(len(names) * len(SEEN) * len(scenarios)) as advance:
        for name in names:
            for seen in SEEN:
                outcomes = []
                for scenario in scenarios:
                    sensing = _Sensing(scenario, conditions.seed, conditions.noise_mm, conditions.dropout)
                    outcomes.append(_ask(PREDICTORS[name].build(scenario), sensing, seen))
                    advance(name)
                rows += _rows(name, seen, outcomes)
    return pd.DataFrame(rows)


def _ask(predictor: Predictor, sensing: _Sensing, seen: int) -> _Outcome:
    """Predict after ``seen`` observations, twice: the first call may compile."""
    scenario = sensing.scenario
    now_s = (seen - 1) * STEP_S - scenario.observation_s
    observation = Observer(sensing).until(now_s)
    predictor.predict(observation, REACH_S, SPACING_S)
    started = time.perf_counter()
    prediction = predictor.predict(observation, REACH_S, SPACING_S)
    elapsed = time.perf_counter() - started
    ahead = np.array(HORIZONS_S, dtype=np.float64)
    rows = np.minimum((ahead / SPACING_S).astype(int), len(prediction.centers_m) - 1)  # at rest past its reach
    truth = np.stack([obstacle.position(now_s + ahead) for obstacle in scenario.obstacles], axis=1)
    errors = np.linalg.norm(prediction.centers_m[rows] - truth, axis=2)
    return _Outcome(errors, prediction.bounds_m[rows], elapsed)


def _rows(name: str, seen: int, outcomes: list[_Outcome]) -> list[dict[str, object]]:
    errors = np.concatenate([outcome.errors_m for outcome in outcomes], axis=1)
    bounds = np.concatenate([outcome.bounds_m for outcome in outcomes], axis=1)
    elapsed = float(np.median([outcome.time_s for outcome in outcomes]))
    return [
        {
            "predictor": name,
            "observations": seen,
            "horizon_s": horizon,
            "error_mean_m": errors[k].mean(),
            "error_p95_m": np.percentile(errors[k], 95),
            "covered_percent": 100.0 * (errors[k] <= SPREAD * bounds[k] + ROUNDING_M).mean(),
            "time_median_s": elapsed,
        }
        for k, horizon in enumerate(HORIZONS_S)
    ]


def as_table(measured: pd.DataFrame, style: str) -> str:
    """The measurement for people, one line per predictor and number of observations."""
    titles = ["observations", "predictor", *(f"{h} s" for h in HORIZONS_S), "ms"]
    lines = []
    for seen in measured["observations"].unique():
        for name in measured["predictor"].unique():
            mine = measured[(measured["observations"] == seen) & (measured["predictor"] == name)]
            cells = [
                f"{_cm(mean)} / {_cm(most)} ({covered:.0f})"
                for mean, most, covered in mine[["error_mean_m", "error_p95_m", "covered_percent"]].to_numpy()
            ]
            lines.append([str(seen), str(name), *cells, f"{1e3 * mine['time_median_s'].iloc[0]:.2f}"])
    return tabulate(lines, titles, tablefmt=style, disable_numparse=True) + "\n"


def _cm(length_m: float) -> str:
    """A length in cm, two digits."""
    if length_m < ROUNDING_M:
        return "0"
    return f"{100 * length_m:.2g}" if length_m < 1.0 else f"{100 * length_m:.0f}"


def as_markdown(conditions: Conditions, measured: pd.DataFrame) -> str:
    """The table with the conditions above it and what its numbers are below."""
    return f"{conditions}\n\n{as_table(measured, 'github')}\n{NOTES}\n"


NOTES = """\
Cells: mean / 95 % quantile of the error [cm], and in brackets the percentage of errors within two bounds (95 would be
honest). The last column is the median time of a call for all obstacles, 480 times a quarter of a second apart."""
