"""Compiled geometry on plain float arrays; checked public functions stand in ``scenarios.arm`` and ``scenarios.collision``."""
