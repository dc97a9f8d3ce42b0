"""Cases that are exported to OpenSees: each group alone, and ten buildings."""

import rwmf

WALL = "&wall h = 5.0, b = 1.2, m_w = 40e3 / &impact rule = 'coupled' /"
FRAME = "&frame T_s = 0.8, gamma = 3.0, xi_s = 0.04 /"
CABLE = "&cable eta_0 = 0.8, eta_alpha = 5.0, law = 'truss' /"
TENDON = "&cable eta_0 = 0.8, eta_alpha = 5.0, {} /"
FUSE = "&fuse F_y = 40e3, k = 2e7, hardening = 0.02, law = '{}' /"
MOTION = "&motion kind = 'one_sine', a_max_g = 0.7, T_p = 0.8 / &solver t_end = 1.2 /"
LONGER = MOTION.replace("1.2", "2.5")
COLUMNS = "&yielding u_y = 0.03, hardening = 0.05, law = '{}' /"
STOREYS_YIELD = "&yielding storey_u_y = 0.012, hardening = 0.03, law = '{}' /"
CAPPED = (
    "&yielding storey_u_y = 0.012, law = '{}', hardening = 0.03, cap = 5.0, post_cap = 8.0, "
    "residual = 0.1, lambda = 60.0{} /"
)
PINCHED = CAPPED.format("pinched", ", pinch_force = 0.4, pinch_displacement = 0.5")
SPRINGS = (
    "&frame xi_s = 0.03 / &storeys n = 4, m = 25e3, k = 25e6, height = 2.5, coupling = 'springs', "
    "k_link = 3e7, 2e7, 2e7, 1e7 /"
)

PAIR = WALL.replace("40e3", "40e3, walls = {}")
PLATES = "&coupling F_y = 60e3, k = 3e7, hardening = 0.02 /"

BENT = "&bending EI = 4e9, modes = 6, damping = 'stiffness' /"
BENT_IN_SHEAR = BENT.replace(" /", ", nu = 0.2 /")


def storeys(n: int, coupling: str) -> str:
    """Write storeys of 10 m together."""
    return (
        f"&frame xi_s = 0.03 / &storeys n = {n}, m = 25e3, k = 25e6, height = {10.0 / n}, "
        f"coupling = '{coupling}', distribution = 'linear' /"
    )


ALONE = {
    "a frame": "&frame T_s = 0.8, xi_s = 0.04, m_s = 1e5 /",
    "storeys": storeys(3, "full"),
    "storeys that pinch": storeys(4, "full") + PINCHED + "&p_delta m_g = 150e3 /",
    "a wall": WALL,
    "tendon": WALL + FRAME + CABLE,
    "Eq. (1)": WALL + FRAME + TENDON.format("law = 'linear'"),
    "a tendon that yields": WALL + FRAME + TENDON.format("law = 'truss', eta_y = 1.1"),
    "a tendon that breaks": WALL + FRAME + TENDON.format("law = 'truss', rupture_strain = 0.006"),
    "link": WALL + FRAME + CABLE + "&link L = 12.0 /",
    "fuses": WALL + FRAME + CABLE + FUSE.format("elastic_plastic"),
    "damper": WALL + FRAME + CABLE + "&damper c = 4e4 /",
    "damper by a power": WALL + FRAME + CABLE + "&nl_damper F_1 = 3e4, exponent = 0.5 /",
    "vertical": WALL + FRAME + CABLE + "&vertical ratio = 0.5 /",
    "flag": WALL + FRAME + COLUMNS.format("flag"),
    "first mode": WALL + storeys(3, "reduced") + CABLE + "&p_delta m_g = 90e3 /",
    "roof": WALL + storeys(4, "full") + CABLE + PINCHED,
    "every floor": WALL + storeys(9, "every_floor") + CABLE,
    "springs": WALL + SPRINGS + CABLE,
    "a wall that bends": WALL + FRAME + CABLE + BENT,
    "roof of a wall that bends": WALL + storeys(3, "full") + CABLE + BENT,
    "every floor of a wall that bends": WALL + storeys(3, "every_floor") + CABLE + BENT_IN_SHEAR,
    "springs of a wall that bends": WALL + SPRINGS + CABLE + BENT_IN_SHEAR,
    "two walls and UFPs": PAIR.format(2) + FRAME + CABLE + PLATES,
    "three walls and beams": PAIR.format(3)
    + storeys(4, "full")
    + CABLE
    + "&coupling k = 2e6, c = 1e4, span = 1.5 /",
    "elements off the axis": WALL
    + FRAME
    + "&cable offset = -0.7, 0.4, height = 10.0, 8.0, eta_0 = 0.5, 0.4, eta_alpha = 3.0, 2.0, "
    + "law = 'truss' / &fuse offset = -1.6, 0.5, F_y = 40e3, 20e3, k = 2e7, 2e7, "
    + "hardening = 0.02 / "
    + "&damper offset = 0.3, c = 3e4 / "
    + "&restraint offset = -1.2, 3.0, height = 5.0, 10.0, k = 4e5, 2e5, c = 0.0, 5e3 /",
    "a base that gives": "&wall h = 5.0, b = 1.2, m_w = 40e3 /"
    + FRAME
    + CABLE
    + "&base k_t_over_m_w = 2e4, xi = 0.2 /",
    "hinge": "&wall h = 5.0, b = 1.2, m_w = 40e3, base = 'pinned' /" + FRAME,
}


def building(n: int, coupling: str, *effects: str) -> str:
    """Write a wall with storeys and effects."""
    return "".join((WALL, storeys(n, coupling), *effects, LONGER))


PLASTIC = FUSE.format("elastic_plastic")
BUILDINGS = {
    "1 storey, tendon, fuses": WALL + FRAME + CABLE + PLASTIC + LONGER,
    "2 storeys, roof, flag fuses": building(2, "full", CABLE, FUSE.format("flag")),
    "3 storeys, every floor, columns yield, P-Delta": building(
        3, "every_floor", STOREYS_YIELD.format("elastic_plastic"), "&p_delta m_g = 90e3 /"
    ),
    "4 storeys, roof, pinching, tendon": building(4, "full", CABLE, PINCHED),
    "4 storeys, every floor, peak oriented": building(
        4, "every_floor", CAPPED.format("peak_oriented", "")
    ),
    "5 storeys, roof, tendon that yields": building(
        5, "full", TENDON.format("law = 'truss', eta_y = 1.1")
    ),
    "6 storeys, every floor, tendon, fuses": building(6, "every_floor", CABLE, PLASTIC),
    "7 storeys, roof, flag columns, tendon": building(
        7, "full", CABLE, STOREYS_YIELD.format("flag")
    ),
    "8 storeys, every floor, dampers": building(
        8, "every_floor", CABLE, "&nl_damper F_1 = 3e4, exponent = 0.5 /"
    ),
    "9 storeys, every floor, tendon": building(9, "every_floor", CABLE),
}
CASES = ALONE | BUILDINGS


def case_of(text: str) -> rwmf.Case:
    """Return a case, with a pulse unless the text has a motion."""
    more = "" if "&motion" in text else MOTION
    return rwmf.Case.from_text(text + more + "&model formulation = 'exact' /")
