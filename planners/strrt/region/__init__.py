"""The goal region of ST-RRT*, as far as it has been expanded, and samples from it and on the way to it."""
