"""Figures; what of it is public stands in `rwmf.plot`."""
