"""Write the report of a run."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from suite.cli.options import Run, usage


def report(
    run: Run,
    output: Annotated[
        Path | None, typer.Option("--output", "-o", help="HTML file to write. [default: RUN/report.html]")
    ] = None,
) -> None:
    """Write a whole run as one page that works offline: table, curves, failures, and every trial's replay."""
    from suite.files import write_text
    from suite.show.report.page import report_page

    file = output or run / "report.html"
    if file.suffix != ".html" or not file.parent.is_dir():
        raise usage(f"--output: found {str(file)!r}, allowed a file that ends in .html in a folder that is there")
    text = report_page(run)
    try:
        write_text(file, text)
    except OSError as error:
        raise usage(f"{file}: cannot be written: {error.strerror}") from None
    print(f"{file} ({len(text.encode()) / 1e6:.1f} MB)")
