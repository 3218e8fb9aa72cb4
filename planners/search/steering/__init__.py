"""One short motion at a time: the tip runs straight while the body turns towards a posture."""
