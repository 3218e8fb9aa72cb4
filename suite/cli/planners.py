"""List what there is to choose from."""

from __future__ import annotations


def planners() -> None:
    """List planners with their settings, and predictors."""
    from suite.show.listing import planners_text

    print(planners_text(), end="")
