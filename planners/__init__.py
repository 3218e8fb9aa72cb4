"""The methods: prediction, the space-time problem of OMPL, and every planner."""
