"""OMPL's own planners."""

from planners.sampling.roadmap import PRMPlanner, PRMSettings
from planners.sampling.trees import RRTConnectPlanner, RRTPlanner, RRTSettings, TreeSettings

__all__ = ["PRMPlanner", "PRMSettings", "RRTConnectPlanner", "RRTPlanner", "RRTSettings", "TreeSettings"]
