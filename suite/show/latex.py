r"""Tables for papers: a ``table`` with caption and label that needs ``\usepackage{booktabs}`` and nothing else.

Numbers stand under one another by their decimal points: what follows the point is filled up with invisible digits. A
rate and its interval, or a mean and a median, are two columns under one head.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import NamedTuple

import pandas as pd

from suite.compare.tables import WORLDS
from suite.show.conditions import sentence
from suite.show.text import cells

_SPECIAL = {
    "\\": r"\textbackslash{}", "~": r"\textasciitilde{}", "^": r"\textasciicircum{}",
    **{sign: f"\\{sign}" for sign in "&%$#_{}"},
}  # fmt: skip
_NUMBER = re.compile(r"-?\d+(\.\d+)?(e[+-]?\d+)?")
_PAIRS = ((re.compile(r"(\S+) (\[.*\])"), r"@{\,}"), (re.compile(r"(\S+) / (\S+)"), "@{ / }"))


class _Column(NamedTuple):
    """A column as LaTeX: its specification, its head, and its cells."""

    spec: str
    head: str
    cells: list[str]


def escaped(text: str) -> str:
    """Text in which no sign is a command."""
    return "".join(_SPECIAL.get(sign, sign) for sign in text)


def as_latex(name: str, summary: pd.DataFrame, columns: Sequence[str] | None = None) -> str:
    """The summary as a table, with a rule between sets of conditions.

    Args:
        name: What the run is called; the table's label.
        summary: One row per conditions and planner.
        columns: Titles of the columns that are wanted, in their order; all when None.
    """
    titles, rows = cells(summary, columns)
    made = [_column(title, [row[k] for row in rows]) for k, title in enumerate(titles)]
    groups = summary.groupby(WORLDS, sort=False, dropna=False).ngroup().tolist()
    lines = []
    for k, group in enumerate(groups):
        rule = "\\midrule\n" if k and group != groups[k - 1] else ""
        lines.append(rule + " & ".join(column.cells[k] for column in made) + r" \\")
    head = " & ".join(column.head for column in made) + r" \\"
    spec = "".join(column.spec for column in made)
    body = "\n".join(lines)
    return (
        "% \\usepackage{booktabs}\n\\begin{table}\n\\centering\n"
        f"\\caption{{{_caption(summary)}}}\n\\label{{tab:{re.sub(r'[^A-Za-z0-9-]', '-', name)}}}\n"
        f"\\begin{{tabular}}{{{spec}}}\n\\toprule\n{head}\n\\midrule\n{body}\n\\bottomrule\n\\end{{tabular}}\n"
        "\\end{table}\n"
    )


def _caption(summary: pd.DataFrame) -> str:
    low, high = int(summary["trials"].min()), int(summary["trials"].max())
    n = f"{low}" if low == high else f"{low} to {high}"
    said = f"Success in percent with 95 % Wilson intervals, n = {n} trials a row. {sentence(summary)}"
    return escaped(said.strip())


def _column(title: str, texts: list[str]) -> _Column:
    for pattern, between in _PAIRS:
        parts = [pattern.fullmatch(text) for text in texts]
        if any(parts) and all(part or text == "-" for part, text in zip(parts, texts, strict=True)):
            first = _aligned([part[1] if part else "-" for part in parts])
            second = [part[2] if part else "" for part in parts]
            second = second if between == _PAIRS[0][1] else _aligned(second)
            joined = [
                f"{a} & {b}" if b else rf"\multicolumn{{2}}{{c}}{{{a}}}" for a, b in zip(first, second, strict=True)
            ]
            return _Column(f"r{between}l", rf"\multicolumn{{2}}{{c}}{{{escaped(title)}}}", joined)
    if all(_NUMBER.fullmatch(text) or text == "-" for text in texts):
        return _Column("r", escaped(title), _aligned(texts))
    return _Column("l", escaped(title), [escaped(text) for text in texts])


def _aligned(texts: Sequence[str]) -> list[str]:
    """Numbers filled up with invisible digits, so that their points stand under one another when set to the right."""
    tails = [text.partition(".")[2] if _NUMBER.fullmatch(text) else "" for text in texts]
    longest = max(map(len, tails), default=0)
    filled = []
    for text, tail in zip(texts, tails, strict=True):
        missing = ("" if tail else ".") + "0" * (longest - len(tail)) if longest and text else ""
        filled.append(text + (rf"\phantom{{{missing}}}" if missing.strip(".") else ""))
    return filled
