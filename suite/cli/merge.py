"""Put runs together."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer


def merge(
    runs: Annotated[list[Path], typer.Argument(help="Folders of runs, each with its run.db; they are only read.")],
    out: Annotated[Path, typer.Option(help="Folder to make.")],
    keep_first: Annotated[
        bool,
        typer.Option("--keep-first", help="Where two runs differ by the same code, let the first one's row stand."),
    ] = False,
) -> None:
    """Put seeds, planners or machines together in one run; what can be read of a damaged run is saved."""
    from suite.api import merge

    merged = merge(runs, out, keep_first=keep_first)
    print(f"{out}: {len(merged.trials)} trials")
