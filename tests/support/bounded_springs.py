"""Springs whose force stays between two bounds, an elastic one inside them.

Bilinear, softening, slipping and self-centring springs differ only in their bounds: two parallel
lines; the same with a higher pair for as long as friction holds; two lines with a corner each that
meet around the origin. The program is independent of the kernel, which stores branches and plastic
displacements.
"""

import math
from dataclasses import dataclass


@dataclass
class Spring:
    """A spring and its state variables.

    Attributes
    ----------
    k : float
        Stiffness, in the unit of the forces over a metre.
    u_y : float
        Elongation at first yield [m]; infinite: elastic.
    hardening : float
        Slope of the bounds over the stiffness [-].
    law : str
        'elastic_plastic', 'friction' or 'flag'.
    flag_height, breakaway : float
        As in `&yielding`.
    on : int
        1 on the upper bound, -1 on the lower one, 0 between them.
    place, level : float
        Elongation and force where the way between the bounds began.
    """

    k: float
    u_y: float = math.inf
    hardening: float = 0.0
    law: str = "elastic_plastic"
    flag_height: float = 1.0
    breakaway: float = 1.0
    on: int = 0
    place: float = 0.0
    level: float = 0.0

    def _line(self, d: float, share: float) -> float:
        """Return the force on the line whose corner is at a share of the yield elongation."""
        beyond = max(0.0, abs(d) - share * self.u_y)
        return self.k * math.copysign(abs(d) - (1 - self.hardening) * beyond, d)

    def bound(self, d: float, sign: int) -> float:
        """Return the upper (1) or the lower (-1) bound at an elongation."""
        if self.law == "flag":
            lines = sorted((self._line(d, 1.0), self._line(d, 1 - self.flag_height)))
            return lines[(sign + 1) // 2]
        return self.k * (sign * (1 - self.hardening) * self.u_y + self.hardening * d)

    def force(self, d: float) -> float:
        """Return the force at an elongation."""
        if self.on:
            return self.bound(d, self.on)
        return self.level + self.k * (d - self.place)

    def limits(self) -> tuple[float, float]:
        """Return the elongations at which the elastic path reaches the bounds [m]."""
        if self.u_y == math.inf:
            return -math.inf, math.inf
        offset = self.place - self.level / self.k
        low, high = -self.breakaway, self.breakaway
        if self.law == "flag":
            if abs(offset) < 1e-12 * self.u_y:
                return -self.u_y, self.u_y
            low, high = 1 - self.flag_height, 1.0
            if offset < 0:
                low, high = -high, -low
        strength = [share * self.u_y for share in (low, high)]
        first, second = (offset / (1 - self.hardening) + s for s in strength)
        return first, second

    def corner(self) -> float | None:
        """Return the |elongation| at which the way back joins the line through the origin."""
        inner = (1 - self.flag_height) * self.u_y
        return inner if self.law == "flag" and self.on else None

    def reach(self, sign: int) -> None:
        """Move the spring to a bound."""
        self.on = sign

    def turn(self, d: float) -> None:
        """Leave the bound."""
        if self.on:
            self.place, self.level, self.on = d, self.bound(d, self.on), 0

    def come_home(self) -> None:
        """Go on along the line through the origin."""
        self.place, self.level, self.on = 0.0, 0.0, 0

    def residual(self, d: float) -> float:
        """Return the elongation that slow unloading leaves [m]."""
        if self.law == "flag" or self.u_y == math.inf:
            return 0.0
        left = d - self.force(d) / self.k
        if self.hardening <= 0:
            return left
        most = (1 - self.hardening) * self.u_y / self.hardening
        return min(most, max(-most, left))
