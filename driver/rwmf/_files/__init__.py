"""Files and streams: complete or not at all, and never over what was read."""
