"""Supports of the wall in a deck."""

from __future__ import annotations

import math
from itertools import product

from deck import Deck, numbers
from settings import THICKNESS

__all__ = ["add_support"]

# how the solver names the two kinds of contact
_CONTACT = {"nodes": "NODE TO SURFACE", "faces": "SURFACE TO SURFACE"}


def add_support(deck: Deck) -> None:
    """Put a deck's wall on the support that its settings name."""
    if deck.settings.support == "struts":
        _add_struts(deck)
    else:
        _add_contact(deck)


def _add_contact(deck: Deck) -> None:
    """Penalty contact with friction between the wall's base and a foundation that is fixed.

    The whole base may touch, not only its corners: the solver determines the contact points.
    """
    settings = deck.settings
    x, y = 2.5 * deck.b, THICKNESS / 2
    number, nodes = deck.brick("GROUND", (-x, x), (-0.5, 0.0), (-y, THICKNESS + y))
    deck.material("GROUND", 300e9, 2400.0)
    deck.fixed += nodes
    deck.write("*SURFACE, NAME=BASE", *(f"{element}, S1" for element in deck.base))
    deck.write("*SURFACE, NAME=TOP", f"{number}, S2")
    deck.write(f"*CONTACT PAIR, INTERACTION=TOUCH, TYPE={_CONTACT[settings.support]}", "BASE, TOP")
    deck.write("*SURFACE INTERACTION, NAME=TOUCH")
    deck.write("*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR")
    deck.write(numbers(settings.stiffness, settings.tension, settings.gap))
    if settings.damping > 0:
        deck.write("*CONTACT DAMPING, TANGENT FRACTION=1.", numbers(settings.damping))
    deck.write("*FRICTION", numbers(settings.friction, settings.stick))


def _add_struts(deck: Deck) -> None:
    """Struts that carry compression only: a corner that presses is held, a free one is not."""
    struts = 0
    for side, y, way in product((0, -1), (0, 1), (-1.0, 1.0)):
        corner = int(deck.wall[side, 0, y])
        x, _, depth = deck.place(corner)
        deck.element("SPRINGA", "STRUT", (deck.node(x + way, -1.0, depth, fixed=True), corner))
        struts += 1
    case, stiffness = deck.case, deck.settings.strut_stiffness
    weight = case.wall.m_w * case.model.g * (1 + case.cable.eta_0)
    # so short that they carry the wall at rest without moving: each leans by 45 degrees
    gap = weight * math.sqrt(2) / struts / stiffness
    deck.write("*SPRING, ELSET=STRUT, NONLINEAR")
    deck.write(f"{-stiffness:.9e}, {gap - 1.0:.14f}", f"0., {gap:.14f}", "0., 5.")
