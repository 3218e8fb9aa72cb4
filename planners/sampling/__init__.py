"""OMPL's own planners in space-time."""

from planners.sampling.trees import RRTSettings, TreeSettings, build_rrt, build_rrtconnect

__all__ = ["RRTSettings", "TreeSettings", "build_rrt", "build_rrtconnect"]
