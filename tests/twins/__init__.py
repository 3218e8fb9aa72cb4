"""Slow, plain twins of kernels and graph algorithms: other formulas, other libraries, no code shared with them."""
