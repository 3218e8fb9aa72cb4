"""Check scenario files."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer


def check(files: Annotated[list[Path], typer.Argument(help="Scenario files.")]) -> None:
    """Check scenario files: format, fields, and whether each start is free."""
    from scenarios import load_scenarios, start_is_free
    from suite.errors import SuiteError

    for file in files:
        found = load_scenarios(file)
        hit = [scenario.id for scenario in found if not start_is_free(scenario)]
        if hit:
            raise SuiteError(
                f"{file}: {hit[0]}: found a start that an obstacle touches before t = 0, allowed a free one"
            )
        print(f"{file}: {len(found)} scenarios, all sound")
