"""Show trials, or a scenario, in the browser."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from suite.cli.options import say, usage


def show(
    run: Annotated[Path, typer.Argument(help="Folder of a run, or a scenario file.")],
    scenario: Annotated[
        str | None, typer.Option(help="Id of a scenario. [default: the first that somebody failed on]")
    ] = None,
    planner: Annotated[
        str | None, typer.Option(help="Planners to show side by side, as the table names them. [default: all]")
    ] = None,
    out: Annotated[Path | None, typer.Option(help="HTML file to write, in place of opening a browser.")] = None,
) -> None:
    """Show a scenario of a run in 3D: what planners did, what they believed, and what came; works offline."""
    from scenarios.spec import split_specs
    from suite.files import write_text
    from suite.show.replay.pages import open_page, replay_page, scenario_page

    if out is not None and (out.suffix != ".html" or not out.parent.is_dir()):
        raise usage(f"--out: found {str(out)!r}, allowed a file that ends in .html in a folder that is there")
    if run.is_file():
        if planner is not None:
            raise usage(f"--planner: found beside the scenario file {run}, allowed with the folder of a run")
        made = scenario_page(run, scenario)
    else:
        made = replay_page(run, scenario, () if planner is None else split_specs(planner))
    for line in made.remarks:
        say(line)
    for line in made.story:
        print(line)
    if out is None:
        print(open_page(made.text))
        return
    try:
        write_text(out, made.text)
    except OSError as error:
        raise usage(f"{out}: cannot be written: {error.strerror}") from None
    print(out)
