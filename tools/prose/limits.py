"""Largest counts that tools/words accepts: lower them with every text that is rewritten."""

from __future__ import annotations

__all__ = ["LIMITS"]

# by kind of text: "what" per 1,000 words, then numbers of places
LIMITS: dict[str, dict[str, float]] = {
    "docstrings": {"what": 0.03, "banned": 0, "question": 0, "wide": 0, "long": 24},
    "comments": {"what": 0.09, "banned": 0, "question": 0, "wide": 0, "long": 6},
    "fortran": {"what": 0, "banned": 0, "question": 0, "wide": 0, "long": 48},
    "messages": {"what": 0.46, "banned": 0, "question": 0, "wide": 0, "long": 15},
    "pages": {"what": 0.3, "banned": 0, "question": 0, "wide": 0, "long": 74},
    "code": {"what": 0, "banned": 0, "question": 0, "wide": 15, "long": 0},
}
