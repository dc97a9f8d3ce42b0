"""Files and streams: written completely or not at all, never over an input."""
