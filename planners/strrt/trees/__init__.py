"""The two trees of ST-RRT*: the start's forward in time, the goals' backward."""
