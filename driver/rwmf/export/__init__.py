"""Cases as input of other programs."""
