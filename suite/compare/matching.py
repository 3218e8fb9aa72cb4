"""Trials of two runs side by side: the same planner, on the same scenario, under the same conditions."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from typing import NamedTuple

import pandas as pd

from suite.errors import SuiteError
from suite.trial.columns import CONDITIONS, MEASURED

OF_THE_SCENARIO = ("family_parameters", "arm")
"""Conditions that a pair shares because they are part of the scenario's content, or of its provenance."""

FREE = ("settings", "experiment_seed")
"""Conditions in which pairs may differ: a planner's defaults and its seed are what changes from run to run."""

ACROSS = tuple(column.name for column in CONDITIONS if column.name not in (*OF_THE_SCENARIO, *FREE))
"""Conditions that pairs share, unless they are to be compared across them."""

BASE, NEW = "_base", "_new"
"""How the columns of two rows side by side end."""


class Matched(NamedTuple):
    """The trials of two runs, paired."""

    pairs: pd.DataFrame
    """One row per pair: the columns of ``keys`` and ``family`` once, all others with ``BASE`` and with ``NEW``."""
    keys: tuple[str, ...]
    """Conditions, by name, that all pairs of a group share."""
    missing: tuple[str, ...]
    """What is in one run only, a line each."""
    differing: tuple[str, ...]
    """Settings and conditions in which paired rows differ all the same, a line each."""

    @property
    def groups(self) -> Iterator[tuple[tuple[object, ...], pd.DataFrame]]:
        """Pairs by family, planner and conditions; numbers of obstacles stand together, since pairs allow for it."""
        yield from self.pairs.groupby(["family", "planner", *self.keys], sort=False, dropna=False)


def match(base: pd.DataFrame, new: pd.DataFrame, across: Collection[str] = ()) -> Matched:
    """Pair the trials of two runs.

    Several trials of one scenario under the same conditions (other seeds) are paired in the order of their seeds.

    Args:
        base: Frame of trial rows.
        new: The same, of what is held against it.
        across: Conditions, of ``ACROSS``, in which the rows of a pair may differ.

    Raises:
        SuiteError: ``across`` names something else.
    """
    for name in across:
        if name not in ACROSS:
            raise SuiteError(f"--across: found {name!r}, allowed {', '.join(ACROSS)}")
    keys = tuple(name for name in ACROSS if name not in across)
    on = ["scenario_hash", "planner", *keys, "turn"]
    frames = [_in_turn(frame, on[:-1]) for frame in (base, new)]
    both = frames[0].merge(frames[1].drop(columns=["family", *OF_THE_SCENARIO]), on=on, suffixes=(BASE, NEW))
    missing = [
        *_missing(frames[0], both, on, "NEW"),
        *_missing(frames[1], both, on, "BASE"),
        *_one_value_each(base, new, keys),
    ]
    return Matched(both, (*OF_THE_SCENARIO, *keys), tuple(missing), tuple(_differing(both, across)))


def same_rows(pairs: pd.DataFrame) -> pd.Series[bool]:
    """Which pairs are of equal rows, but for timings and for what the older version of a row does not say."""
    same = pd.Series(True, pairs.index)
    for column in MEASURED:
        base, new = pairs[column.name + BASE], pairs[column.name + NEW]
        if column.is_timing or (column.since > 1 and (base.isna().all() or new.isna().all())):
            continue
        same &= ((base == new).fillna(False) | (base.isna() & new.isna())).astype(bool)
    return same


def _in_turn(trials: pd.DataFrame, key: Sequence[str]) -> pd.DataFrame:
    ordered = trials.sort_values(["experiment_seed", "settings"], kind="stable")
    return ordered.assign(turn=ordered.groupby(list(key), dropna=False).cumcount())


def _missing(trials: pd.DataFrame, both: pd.DataFrame, on: Sequence[str], where: str) -> Iterator[str]:
    found = trials.merge(both[list(on)], how="left", on=list(on), indicator=True)
    rows = found[found["_merge"] == "left_only"]
    for (planner, family), group in rows.groupby(["planner", "family"], sort=False):
        names = list(dict.fromkeys(group["scenario_id"]))
        shown = ", ".join(names[:3]) + (f" and {len(names) - 3} more" if len(names) > 3 else "")
        yield f"{planner}, {family}: {len(group)} not in {where}: {shown}"


def _one_value_each(base: pd.DataFrame, new: pd.DataFrame, keys: Sequence[str]) -> Iterator[str]:
    """Planners whose rows can't be paired because of one condition, which each run has one value of."""
    for planner in [name for name in base["planner"].unique() if (new["planner"] == name).any()]:
        for key in keys:
            there, here = (frame.loc[frame["planner"] == planner, key].unique() for frame in (base, new))
            if len(there) == len(here) == 1 and str(there[0]) != str(here[0]):
                yield f"{planner}: {key} {there[0]} in BASE, {here[0]} in NEW; --across {key} pairs them all the same"


def _differing(pairs: pd.DataFrame, across: Collection[str]) -> Iterator[str]:
    for planner, group in pairs.groupby("planner", sort=False):
        for name in ("settings", "experiment_seed", *across):
            there, here = group[name + BASE], group[name + NEW]
            unlike = (there.astype("string").fillna("-") != here.astype("string").fillna("-")).to_numpy()
            if unlike.any():
                yield f"{planner}: {name} {there[unlike].iloc[0]} in BASE, {here[unlike].iloc[0]} in NEW"
