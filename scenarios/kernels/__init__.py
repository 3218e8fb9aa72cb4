"""Compiled geometry on plain float arrays; checked public functions stand in ``arm`` and ``collision``."""
