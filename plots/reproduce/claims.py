"""Claims of the paper: statement, measurement, and criterion for each."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from reproduce.formulations import ETAS, EXACT, PUBLISHED, SHIPPED_ETAS, Formulation
from reproduce.response_cache import ResponseCache

__all__ = ["Claim", "Judgement", "Measured", "evaluate"]

Etas = tuple[float, float]


@dataclass(frozen=True)
class Measured:
    """Results for one form of the model and one cable.

    Attributes
    ----------
    number : str
        The number that decides, with its unit.
    holds : bool or None
        True when it meets the criterion; None where the claim has no meaning, for example on the
        growth of the cable force without cable stiffness.
    """

    number: str
    holds: bool | None


@dataclass(frozen=True)
class Claim:
    """One statement of the paper.

    Attributes
    ----------
    place : str
        Where the paper makes it.
    text : str
        Text of the claim.
    criterion : str
        Criterion for a reproduced claim.
    measure : callable
        Computes the results from the cache, the form, and eta_0 with eta_alpha.
    has_cable : bool
        Whether the lost properties of the cable enter.
    """

    place: str
    text: str
    criterion: str
    measure: Callable[[ResponseCache, Formulation, Etas], Measured]
    has_cable: bool = True


@dataclass(frozen=True)
class Judgement:
    """The verdict on a claim.

    Attributes
    ----------
    claim : Claim
        The claim.
    published, exact : Measured
        Results for the shipped cable in both forms.
    held : int
        Number of `tried` cables for which the claim holds in the published form.
    tried : int
        Number of cables for which the claim has a meaning.
    """

    claim: Claim
    published: Measured
    exact: Measured
    held: int
    tried: int

    @property
    def verdict(self) -> str:
        """Verdict on the paper's own model."""
        if self.held in (0, self.tried):
            return _word(self.held > 0)
        return f"depends on Table 1 (holds for {self.held} of {self.tried} cables)"

    @property
    def exact_verdict(self) -> str:
        """Verdict on the exact form with coupled restitution and the shipped cable."""
        return _word(bool(self.exact.holds))


def evaluate(cache: ResponseCache, claim: Claim) -> Judgement:
    """Measure a claim for both forms, and for every cable in the published one."""
    cables = ETAS if claim.has_cable else (SHIPPED_ETAS,)
    found = {etas: claim.measure(cache, PUBLISHED, etas) for etas in cables}
    verdicts = [measured.holds for measured in found.values() if measured.holds is not None]
    return Judgement(
        claim=claim,
        published=found[SHIPPED_ETAS],
        exact=claim.measure(cache, EXACT, SHIPPED_ETAS),
        held=sum(verdicts),
        tried=len(verdicts),
    )


def _word(holds: bool) -> str:
    return "reproduced" if holds else "not reproduced"
