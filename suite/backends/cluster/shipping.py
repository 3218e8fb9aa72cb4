"""Planners from files on their way to a node that does not have the files: their sources travel with the trials."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path, PurePosixPath

from planners import PlannerSpec, plugins
from suite.errors import SuiteError
from suite.trial.task import TrialTask

Sources = Mapping[str, Mapping[str, bytes]]
"""By the place of a planner's file at the head: the sources behind it, by their path from that file's folder."""


def sources_of(specs: Iterable[PlannerSpec]) -> Sources:
    """What has to travel with trials of these planners."""
    places = {place for spec in specs if (place := _file_of(spec))}
    return {
        place: {source.relative_to(Path(place).parent).as_posix(): source.read_bytes() for source in sources}
        for place in sorted(places)
        for sources in [plugins.sources(place)]
    }


class Unpacked:
    """The sources on their node: each planner's in a folder of its own."""

    def __init__(self, sources: Sources, folder: Path) -> None:
        """Write them into ``folder``."""
        self._places: dict[str, str] = {}
        for number, (place, files) in enumerate(sources.items()):
            for name, content in files.items():
                path = PurePosixPath(name)
                if path.is_absolute() or ".." in path.parts:
                    raise SuiteError(f"planner: found the source {name!r}, allowed paths below its folder")
                file = folder / str(number) / path
                file.parent.mkdir(parents=True, exist_ok=True)
                file.write_bytes(content)
            self._places[place] = str(folder / str(number) / Path(place).name)

    def here(self, task: TrialTask) -> TrialTask:
        """The same task with its planner's file on this node.

        Raises:
            SuiteError: The planner's code is not what it is at the head.
        """
        spec = task.spec
        if place := _file_of(spec):
            spec = spec._replace(name=f"{self._places[place]}:{spec.name.rpartition(':')[2]}")
        if spec.code and (found := plugins.code_hash(spec.name)) != spec.code:
            allowed = f"allowed the same as here: {spec.code}"
            raise SuiteError(f"{spec.label}: found other code of it there ({found}), {allowed}")
        return replace(task, spec=spec)


def _file_of(spec: PlannerSpec) -> str:
    """The file of a planner from one, else nothing."""
    place = spec.name.rpartition(":")[0]
    return place if place.endswith(".py") else ""
