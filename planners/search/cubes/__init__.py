"""The temporal cubes-graph (Algorithm 1), static cube paths, and when an obstacle is in a cube."""

from planners.search.cubes.local import LocalGraph, temporal_cubes_graph

__all__ = ["LocalGraph", "temporal_cubes_graph"]
