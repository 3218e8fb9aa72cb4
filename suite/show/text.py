"""Tables as text: numbers for machines (CSV), sentences of numbers for people (Markdown, LaTeX, the terminal)."""

from __future__ import annotations

import json
import re
from collections import Counter
from collections.abc import Callable, Sequence
from typing import Any, Literal, NamedTuple

import pandas as pd
from tabulate import tabulate

from scenarios.spec import known_name
from suite.auditor.verdicts import VERDICTS
from suite.compare.conditions import Pooled
from suite.show.conditions import column, sentence, varying
from suite.store.frames import FLOAT_FORMAT
from suite.trial.columns import WORLD

_UNIT = re.compile(r" (%|s|ms|m|rad)$")
WORLD_NAMES = {condition.name for condition in WORLD}

Format = Literal["markdown", "csv", "latex"]

NOTES = """\
Success in percent of all trials with its 95 % Wilson interval; each verdict is stricter than the one before: per step
(no collision at whole seconds), swept (at no instant: the paper's protocol, beside which published numbers stand),
executable (swept, within bending rate and tip speed). A bound knows the true motion and is not compared. "Of
possible": executable successes, of as many scenarios as somebody solved so, to as many as are not proven impossible;
"of bound", in older tables, successes in percent of a bound's, one verdict after another. Planning time is the sum
over a trial's solves: mean / median over all trials. Solve is the median of the trials' median solves. Arrival, tip
path and smoothness S are medians over the trials that reached the goal. Errors are trials in which the planner failed
as a program: it raised, crashed or hung. Stale trials were run by other code than the present."""


class Shown(NamedTuple):
    """A column as people see it."""

    title: str
    cell: Callable[[Any], str]
    """Makes the text from a row of the summary."""


def as_csv(frame: pd.DataFrame) -> str:
    """Every column, unrounded."""
    return frame.to_csv(index=False, float_format=FLOAT_FORMAT, lineterminator="\n")


def shown_columns(summary: pd.DataFrame) -> list[Shown]:
    """The columns that people see of a summary; those that say nothing are left out."""
    published = "published_success_percent" in summary
    has_bound, is_known = summary["is_bound"].any(), summary["scenarios_possible"].notna().any()
    varied = varying(summary)
    columns = [
        Shown("family", lambda row: _or_all(row.family)) if len(set(summary["family"])) > 1 else None,
        Shown("obstacles", lambda row: _or_all(row.n_obstacles)),
        *(Shown(*column(summary, name)) for name in varied if name in WORLD_NAMES),
        Shown("planner", lambda row: f"{row.planner} (bound)" if row.is_bound else str(row.planner)),
        *(Shown(*column(summary, name)) for name in varied if name not in WORLD_NAMES),
        Shown("n", lambda row: str(row.trials)),
        Shown("stale", lambda row: str(row.stale)) if summary["stale"].any() else None,
        Shown("errors", lambda row: str(row.errors)) if summary["errors"].any() else None,
        Shown("per step %", _success("per_step")),
        # The paper counts a collision "at any point": what it publishes stands beside the swept verdict.
        Shown("published %", lambda row: _number(row.published_success_percent)) if published else None,
        Shown("swept %", _success("swept")),
        Shown("executable %", _success("executable")),
        Shown("of possible", _of_possible) if has_bound and is_known else None,
        Shown("of bound %", _shares) if has_bound and not is_known else None,
        Shown("planning s", _planning),
        Shown("published s", lambda row: _number(row.published_time_s)) if published else None,
        Shown("solve ms", lambda row: _number(1e3 * row.solve_median_s)),
        Shown("arrival s", lambda row: _number(row.arrival_median_s)),
        Shown("tip path m", lambda row: _number(row.tip_path_length_median_m)),
        Shown("S rad", lambda row: _number(row.smoothness_paper_median_rad)),
    ]
    return [column for column in columns if column is not None]


def cells(summary: pd.DataFrame, names: Sequence[str] | None = None) -> tuple[list[str], list[list[str]]]:
    """Titles and rows of text; of the columns called ``names`` alone, in their order, where some are named.

    Raises:
        SpecError: There is no column of that name; a unit need not be named.
    """
    columns = shown_columns(summary)
    if names is not None:
        columns = _chosen(columns, names)
    rows = [[column.cell(row) for column in columns] for row in summary.itertuples(index=False)]
    return [column.title for column in columns], rows


def _chosen(columns: Sequence[Shown], names: Sequence[str]) -> list[Shown]:
    """Those called ``names``, in that order."""
    titles = {column.title: column for column in columns}
    bare = Counter(_UNIT.sub("", title) for title in titles)
    known = {short: column for title, column in titles.items() if bare[short := _UNIT.sub("", title)] == 1} | titles
    return [known[name] if name in known else titles[known_name("--columns", name, titles)] for name in names]


def render(summary: pd.DataFrame, format: Literal["markdown", "csv"], names: Sequence[str] | None = None) -> str:
    """The summary for a file; of the columns called ``names`` alone, but for CSV. LaTeX: ``suite.show.latex``."""
    if format == "csv":
        return as_csv(summary)
    titles, rows = cells(summary, names)
    return _tabulated(titles, rows, format)


def render_pairs(pairs: pd.DataFrame, format: Format) -> str:
    """A comparison in pairs in one of the formats for files."""
    return as_csv(pairs) if format == "csv" else _tabulated(*pair_cells(pairs), format)


def pair_cells(pairs: pd.DataFrame) -> tuple[list[str], list[list[str]]]:
    """Titles and rows of text of a comparison in pairs."""
    conditions = [Shown(*column(pairs, name)) for name in varying(pairs)]
    counts = ["scenarios", "only_planner", "only_reference"]
    rows = [
        [
            _or_all(pair.n_obstacles),
            *(condition.cell(pair) for condition in conditions),
        ]
        + [str(pair.planner), str(pair.reference)]
        + [str(getattr(pair, count)) for count in counts]
        + [f"{getattr(pair, p):.2g}" for p in ("p_mcnemar", "p_holm")]
        for pair in pairs.itertuples(index=False)
    ]
    titles = ["obstacles", *(condition.title for condition in conditions), "planner", "reference"]
    titles += ["scenarios", "only planner", "only reference", "p", "p, Holm"]
    return titles, rows


def as_json(summary: pd.DataFrame, pairs: pd.DataFrame | None = None, pooled: Pooled | None = None) -> str:
    """Every column, unrounded: ``table``, with ``pairs`` and what was ``pooled`` where that was asked for."""
    parts: dict[str, Any] = {"table": _records(summary)}
    if pairs is not None:
        parts["pairs"] = _records(pairs)
    if pooled is not None:
        parts["pooled"] = pooled.over
    return json.dumps(parts, allow_nan=False, default=str)


def _records(frame: pd.DataFrame) -> list[dict[str, Any]]:
    """Rows as plain values; null for what there is not."""
    objects = frame.astype(object).where(frame.notna(), None)
    return [{str(key): value for key, value in row.items()} for row in objects.to_dict("records")]


def as_markdown_page(title: str, summary: pd.DataFrame) -> str:
    """The text of ``table.md``."""
    return "\n\n".join([f"# {title}", *filter(None, [sentence(summary)]), f"{render(summary, 'markdown')}\n{NOTES}\n"])


def _tabulated(titles: list[str], rows: list[list[str]], format: Format) -> str:
    style = {"markdown": "github", "latex": "latex_booktabs"}[format]
    return tabulate(rows, titles, tablefmt=style, disable_numparse=True) + "\n"


def _or_all(value: Any) -> str:
    """Missing where trials under several were pooled."""
    return "all" if pd.isna(value) else str(value)


def _success(verdict: str) -> Callable[[Any], str]:
    def cell(row: Any) -> str:
        percent, low, high = (getattr(row, f"success_{verdict}_{part}") for part in ("percent", "low", "high"))
        return "-" if pd.isna(percent) else f"{percent:.0f} [{low:.0f}, {high:.0f}]"

    return cell


def _shares(row: Any) -> str:
    shares = [getattr(row, f"success_{verdict}_of_bound_percent") for verdict in VERDICTS]
    return "-" if pd.isna(shares).all() else " / ".join("-" if pd.isna(share) else f"{share:.0f}" for share in shares)


def _of_possible(row: Any) -> str:
    if pd.isna(row.success_executable_percent) or pd.isna(row.scenarios_possible):
        return "-"
    successes = round(row.success_executable_percent * row.trials / 100)
    to = f" to {row.scenarios_possible + row.scenarios_open}" if row.scenarios_open else ""
    return f"{successes} of {row.scenarios_possible}{to}"


def _planning(row: Any) -> str:
    return f"{_number(row.planning_time_mean_s)} / {_number(row.planning_time_median_s)}"


def _number(value: Any) -> str:
    return "-" if pd.isna(value) else f"{value:.3g}"
