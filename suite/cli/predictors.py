"""Measure the predictors."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import typer

from suite.cli.options import usage


def predictors(
    family: Annotated[str, typer.Option(help="Scenario family.")] = "orbit",
    obstacles: Annotated[int, typer.Option(help="Number of obstacles.")] = 3,
    trials: Annotated[int, typer.Option(help="Number of scenarios.")] = 100,
    seed: Annotated[int, typer.Option(help="Seed of the scenarios and of the noise.")] = 1000,
    noise_mm: Annotated[float, typer.Option(help="Noise on observed positions.")] = 0.0,
    dropout: Annotated[float, typer.Option(help="Share of observations lost.")] = 0.0,
    format: Annotated[Literal["text", "json"], typer.Option(help="A table for people, or an object.")] = "text",
    out: Annotated[Path | None, typer.Option(help="File to write as well: .csv or .md.")] = None,
) -> None:
    """Measure the predictors: error over horizon, honesty of their bounds, time per call."""
    from suite.compare.predictors import NOTES, Conditions, as_markdown, as_table, measure
    from suite.files import write_text
    from suite.show.text import as_csv
    from suite.show.text import as_json as table_json

    if out is not None and out.suffix not in {".csv", ".md"}:
        raise usage(f"--out: found {str(out)!r}, allowed a file that ends in .csv or .md")
    if out is not None and not out.parent.is_dir():
        raise usage(f"--out: found no folder {str(out.parent)!r}, allowed one that is there")
    conditions = Conditions(family, obstacles, trials, seed, noise_mm, dropout)
    measured = measure(conditions)
    if format == "json":
        print(table_json(measured))
    else:
        print(f"{conditions}\n\n{as_table(measured, 'simple')}\n{NOTES}")
    if out is not None:
        write_text(out, as_csv(measured) if out.suffix == ".csv" else as_markdown(conditions, measured))
