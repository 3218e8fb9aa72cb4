"""A hundred thousand scenarios in little memory: as compressed text, each made anew whenever it is asked for."""

import hashlib
import zlib
from collections.abc import Iterable, Iterator
from itertools import islice

from scenarios.arm import ContinuumArm
from scenarios.scenario import Scenario

CHUNK = 100
"""Scenarios that are compressed, and made anew, together."""


class PackedScenarios:
    """Scenarios in a fixed order, of which some 200 bytes each are kept; as objects they take thirty times as much."""

    def __init__(self, scenarios: Iterable[Scenario]) -> None:
        """Take in the scenarios, none of which needs to be held by anyone."""
        self._chunks: list[bytes] = []
        self._count = 0
        digest = hashlib.sha256()
        arms = dict[ContinuumArm, None]()
        pending = iter(scenarios)
        while chunk := list(islice(pending, CHUNK)):
            for scenario in chunk:
                arms.setdefault(scenario.arm)
                digest.update(scenario.content_hash.encode())
            self._count += len(chunk)
            self._chunks.append(zlib.compress("".join(f"{s.model_dump_json()}\n" for s in chunk).encode()))
        self.arms = tuple(arms)
        """The arms among them, each once."""
        self.digest = digest.hexdigest()[:16]
        """16 hexadecimal digits of the content of all, in their order."""

    def __len__(self) -> int:
        """How many there are."""
        return self._count

    def __iter__(self) -> Iterator[Scenario]:
        """All of them, made as the iterator goes on."""
        for line in self.lines():
            yield Scenario.model_validate_json(line)

    def lines(self) -> Iterator[str]:
        """All of them as lines of a ``.jsonl`` file."""
        for chunk in self._chunks:
            yield from zlib.decompress(chunk).decode().splitlines(keepends=True)
