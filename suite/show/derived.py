"""The files that are made from the journal, whole and anew each time."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TextIO

import numpy as np
import pandas as pd

from scenarios import PackedScenarios
from suite.compare.conditions import telling_apart
from suite.compare.tables import SUMMED_UP, summarize
from suite.files import replacing, write_text
from suite.show.text import as_csv, as_markdown_page
from suite.store.frames import FLOAT_FORMAT, columns_frame, compact, trials_csv
from suite.store.journal import Executed, Journal
from suite.trial.columns import COLUMN_NAMES
from suite.trial.task import Code


def write_derived(
    folder: Path, journal: Journal, scenarios: PackedScenarios, present: Mapping[str, Code]
) -> pd.DataFrame:
    """Write trials, tables, scenarios and trajectories; none of the large ones is ever held as a whole.

    Args:
        folder: The run's folder.
        journal: The run's journal.
        scenarios: The run's scenarios.
        present: The code of every planner by label, in the order in which the tables show them.

    Returns:
        The summary that stands in ``table.csv``.
    """
    trials = compact(journal.columns(SUMMED_UP), SUMMED_UP)
    summary = summarize(trials, list(present), present)
    with replacing(folder / "trials.csv") as handle:
        handle.write(",".join(COLUMN_NAMES) + "\n")
        handle.writelines(trials_csv(columns_frame(columns), header=False) for columns in journal.columns())
    write_text(folder / "table.csv", as_csv(summary))
    write_text(folder / "table.md", as_markdown_page(folder.name, summary))
    with replacing(folder / "scenarios.jsonl") as handle:
        handle.writelines(scenarios.lines())
    with replacing(folder / "trajectories.csv") as handle:
        n_sections = max(arm.n_sections for arm in scenarios.arms)
        _write_trajectories(handle, journal.executed(), telling_apart(trials), n_sections)
    return summary


def _write_trajectories(handle: TextIO, executed: Iterable[Executed], telling: Sequence[str], n_sections: int) -> None:
    """One line per timed state; arms with fewer sections leave the last columns empty.

    Where a planner met a scenario more than once, a column says under which of the ``telling`` conditions.
    """
    writer = csv.writer(handle, lineterminator="\n")
    bends = [f"{axis}{section}_rad" for section in range(1, n_sections + 1) for axis in "uv"]
    writer.writerow(["scenario_id", "planner", *(["condition"] if telling else []), "time_s", *bends])
    for trial in executed:
        timed = np.column_stack([trial.times_s, trial.configurations_rad])
        # One format for a whole trial: thousands of states are written in the time that cells would take for hundreds.
        names = io.StringIO()
        condition = ";".join(f"{name}={trial.conditions[name]}" for name in telling)
        named = [trial.scenario_id, trial.planner, *([condition] if telling else [])]
        csv.writer(names, lineterminator="").writerow(named)
        numbers = [FLOAT_FORMAT] * timed.shape[1] + [""] * (1 + len(bends) - timed.shape[1])
        line = ",".join([names.getvalue().replace("%", "%%"), *numbers]) + "\n"
        handle.write(line * len(timed) % tuple(timed.reshape(-1).tolist()))
