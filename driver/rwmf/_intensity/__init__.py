"""Intensity measures of ground motions, exact for samples joined by straight lines.

Nothing in this folder depends on a structure: a measure belongs to the site.
"""

from rwmf._intensity.measures import DAMPING, KINDS, Intensity, choose_measure
from rwmf._intensity.oscillator import pseudo_accelerations
from rwmf._intensity.waveform import Array, Waveform, waveform_of

__all__ = [
    "DAMPING",
    "KINDS",
    "Array",
    "Intensity",
    "Waveform",
    "choose_measure",
    "pseudo_accelerations",
    "waveform_of",
]
