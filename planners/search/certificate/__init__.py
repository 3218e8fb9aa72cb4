"""A proof that a short motion is free of obstacles, from few states."""
