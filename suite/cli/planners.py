"""List what there is to choose from."""

from __future__ import annotations

from typing import Annotated, Literal

import typer


def planners(
    format: Annotated[Literal["text", "json"], typer.Option(help="Lines for people, or an object.")] = "text",
) -> None:
    """List planners with their settings, and predictors."""
    from suite.show.listing import planners_json, planners_text

    print(planners_text() if format == "text" else planners_json(), end="")
