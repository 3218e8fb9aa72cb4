"""Write a planner to start from."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer


def new_planner(
    name: Annotated[str, typer.Argument(help="Name of the file, such as mine: makes mine.py and test_mine.py.")],
) -> None:
    """Write a planner to start from, and its test, into this folder."""
    from suite.scaffold import class_name, write_planner

    for file in write_planner(name, Path()):
        print(file)
    planner = f"./{name}.py:{class_name(name)}"
    print(f"\nCheck it:    suite check-planner {planner}")
    print(f"Compare it:  suite run --planners {planner},rrt --obstacles 0,3")
