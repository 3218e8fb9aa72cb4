"""The paper's planners: temporal graphs, two heuristics, a potential field."""
