"""Figures; `rwmf.plot` exports the public functions."""
