"""The temporal cubes-graph (Algorithm 1) and the layered graph of configurations (section II-E)."""

from planners.search.cubes.layered import EdgeFilter, LayeredGraph
from planners.search.cubes.local import LocalGraph, ObstacleSteps, temporal_cubes_graph

__all__ = ["EdgeFilter", "LayeredGraph", "LocalGraph", "ObstacleSteps", "temporal_cubes_graph"]
