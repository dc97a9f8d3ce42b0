"""Figures of datasets and results, films, and loops of springs; none simulates."""
