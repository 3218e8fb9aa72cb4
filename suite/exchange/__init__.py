"""In and out: recordings and scenes from elsewhere as scenarios, runs as files that other tools read."""
