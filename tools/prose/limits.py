"""Largest counts that tools/words accepts: lower them with every text that is rewritten."""

from __future__ import annotations

__all__ = ["LIMITS"]

# by kind of text: "what" per 1,000 words, then numbers of places
LIMITS: dict[str, dict[str, float]] = {
    "docstrings": {"what": 0.5, "banned": 0, "question": 0, "wide": 0, "long": 37},
    "comments": {"what": 0.5, "banned": 0, "question": 0, "wide": 0, "long": 6},
    "fortran": {"what": 8.1, "banned": 115, "question": 350, "wide": 0, "long": 269},
    "messages": {"what": 2.85, "banned": 20, "question": 0, "wide": 0, "long": 34},
    "pages": {"what": 7.3, "banned": 57, "question": 0, "wide": 947, "long": 477},
    "code": {"what": 0, "banned": 0, "question": 0, "wide": 25, "long": 0},
}
