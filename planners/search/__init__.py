"""Pieces that several planners are made of."""
