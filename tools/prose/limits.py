"""Largest counts that tools/words accepts: lower them with every text that is rewritten."""

from __future__ import annotations

__all__ = ["LIMITS"]

# by kind of text: "what" per 1,000 words, then numbers of places
LIMITS: dict[str, dict[str, float]] = {
    "docstrings": {"what": 0.5, "banned": 0, "question": 0, "wide": 0, "long": 0},
    "comments": {"what": 0.5, "banned": 0, "question": 0, "wide": 0, "long": 0},
    "fortran": {"what": 9.9, "banned": 999, "question": 999, "wide": 0, "long": 999},
    "messages": {"what": 0.5, "banned": 0, "question": 0, "wide": 0, "long": 999},
    "pages": {"what": 9.9, "banned": 999, "question": 0, "wide": 999, "long": 999},
    "code": {"what": 0, "banned": 0, "question": 0, "wide": 999, "long": 0},
}
