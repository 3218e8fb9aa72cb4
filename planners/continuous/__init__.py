"""``temporal-ct`` and ``clairvoyant``: planning in configuration and time, within limits, valid at every instant."""
