"""What is asked for: which planners meet which scenarios, under which conditions."""
