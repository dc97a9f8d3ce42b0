"""A digest of the numbers that rwmf gives: the proof that a change has kept the bits.

Each row is the digest of one answer: a way in (batch program, Python, Fortran), a scene and a
method. Texts (messages, help, units, labels) are no part of it, so that a further group or another
wording moves no row; tests look at texts. The scenes are frozen files beside the digest. Only
public names are called, so that everything private may move.
"""
