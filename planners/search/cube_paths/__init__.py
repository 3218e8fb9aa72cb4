"""Shortest temporal cube paths on which every motion was looked at that they depend on."""
