"""Random numbers for compiled searches."""
