"""Print versions."""

from __future__ import annotations


def version() -> None:
    """Print the versions of the suite and of what its numbers depend on."""
    from suite.experiment.code import DISTRIBUTION, installed, versions

    for name, number in ({DISTRIBUTION: installed(DISTRIBUTION)} | versions()).items():
        print(name, number or "not installed")
