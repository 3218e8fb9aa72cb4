"""One trial, from observation to verdict."""
