"""A digest of every number that rwmf gives: the proof that a change has kept the bits.

Each row stands for one text of numbers: what one way in (batch program, Python, command, C,
Fortran) answers to one scene. The scenes are frozen files beside the digest, so that it changes
only when an answer does. Only what is public is called, so that everything private may move.
"""
