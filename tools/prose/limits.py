"""Largest counts that tools/words accepts: lower them with every text that is rewritten."""

from __future__ import annotations

__all__ = ["LIMITS"]

# by kind of text: "what" per 1,000 words, then numbers of places
LIMITS: dict[str, dict[str, float]] = {
    "docstrings": {"what": 0.25, "banned": 0, "question": 0, "wide": 0, "long": 37},
    "comments": {"what": 0.35, "banned": 0, "question": 0, "wide": 0, "long": 6},
    "fortran": {"what": 1.0, "banned": 14, "question": 39, "wide": 0, "long": 49},
    "messages": {"what": 1.55, "banned": 18, "question": 0, "wide": 0, "long": 15},
    "pages": {"what": 1.25, "banned": 2, "question": 0, "wide": 129, "long": 109},
    "code": {"what": 0, "banned": 0, "question": 0, "wide": 25, "long": 0},
}
