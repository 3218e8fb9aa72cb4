"""How fast a motion turns sections and moves the tip."""
