"""Groups of a case with the types of their keys.

`tools/docs --made` generates this module from the kernel's table of keys.
"""

from __future__ import annotations

from typing import Literal

from rwmf.case.group import Group

__all__ = ["TYPES", "Groups"]


class Wall(Group):
    """Group ``&wall``.

    Attributes
    ----------
    h : float
        Half height of the wall [m].
    b : float
        Half width of the wall [m].
    m_w : float
        Mass of the wall; given: forces are reported in N as well [kg].
    density : float
        Or its density and thickness: m_w = 4 h b thickness density [kg/m3].
    thickness : float
        Across the plane of the motion [m].
    walls : int
        Number of equal walls side by side that turn together; m_w, h, b are those of one.
    shear_key : bool
        A key keeps the base from sliding: its force is reported, not the friction demand.
    base : str
        On two corners with impacts, or hinged in the middle.
    """

    __slots__ = ()
    h: float
    b: float
    m_w: float
    density: float
    thickness: float
    walls: int
    shear_key: bool
    base: Literal["rocking", "pinned"]


class Base(Group):
    """Group ``&base``.

    Attributes
    ----------
    k_t_over_m_w : float
        Stiffness per length of the base over m_w [1/m/s2].
    k : float
        Or the subgrade modulus: stress per settlement, with &wall thickness [N/m3].
    E : float
        Or the modulus of elasticity of the strip: k = E/length [Pa].
    length : float
        Height of the strip; beside E [m].
    xi : float
        Damping ratio of the bounce in full contact.
    delay : float
        Or the damping over the stiffness, c/k [s].
    c : float
        Or the damping per area [N s/m3].
    mu : float
        Coefficient of friction; absent: the base does not slide.
    d_y : float
        Settlement at which the strip crushes; absent: it is elastic [m].
    p_y : float
        Or the stress at which it crushes [Pa].
    strips : int
        Number of strips that crush one by one; beside d_y or p_y.
    """

    __slots__ = ()
    k_t_over_m_w: float
    k: float
    E: float
    length: float
    xi: float
    delay: float
    c: float
    mu: float
    d_y: float
    p_y: float
    strips: int


class Frame(Group):
    """Group ``&frame``.

    Attributes
    ----------
    T_s : float
        Undamped period; required without &spectrum [s].
    gamma : float
        Mass ratio m_s/m_w; required with &wall, refused without.
    m_s : float
        Or the mass of the frame, with and without &wall [kg].
    k_s : float
        Stiffness of the frame: T_s = 2 pi sqrt(m_s/k_s) [N/m].
    xi_s : float
        Viscous damping ratio.
    """

    __slots__ = ()
    T_s: float
    gamma: float
    m_s: float
    k_s: float
    xi_s: float


class Storeys(Group):
    """Group ``&storeys``.

    Attributes
    ----------
    m_over_m_w : tuple[float, ...]
        Mass of each floor over m_w (no wall: over any mass), from the ground up.
    k_over_m_w : tuple[float, ...]
        Stiffness of the storey below each floor over the same mass [1/s2].
    m : tuple[float, ...]
        Or the masses [kg].
    k : tuple[float, ...]
        Or the stiffnesses [N/m].
    height : tuple[float, ...]
        Height of each storey; with &wall their sum is 2h [m].
    n : int
        Number of storeys; masses, heights, stiffnesses: one number for all or one each.
    distribution : str
        Of stiffnesses from the lowest storey up; straight_mode: a straight first mode.
    T_1 : float
        Period of the first mode of the frame by itself: it scales all stiffnesses [s].
    coupling : str
        Roof linked: first mode or all modes; each floor: a straight line, or by a spring.
    k_link_over_m_w : tuple[float, ...]
        Stiffness of each link spring, or one for all, over the same mass [1/s2].
    k_link : tuple[float, ...]
        Or the stiffnesses [N/m].
    """

    __slots__ = ()
    m_over_m_w: tuple[float, ...]
    k_over_m_w: tuple[float, ...]
    m: tuple[float, ...]
    k: tuple[float, ...]
    height: tuple[float, ...]
    n: int
    distribution: Literal["uniform", "linear", "straight_mode"]
    T_1: float
    coupling: Literal["reduced", "every_floor", "full", "springs"]
    k_link_over_m_w: tuple[float, ...]
    k_link: tuple[float, ...]


class Link(Group):
    """Group ``&link``.

    Attributes
    ----------
    L : float
        Length of the link, Eqs (2), (3); absent: infinitely long [m].
    """

    __slots__ = ()
    L: float


class Damper(Group):
    """Group ``&damper``.

    Attributes
    ----------
    offset : tuple[float, ...]
        Place of each to the right of the axis, at most 4 b away; absent: two, at -b and b [m].
    c_over_m_w : float | tuple[float, ...]
        Constant of each viscous damper over m_w [1/s].
    c : float | tuple[float, ...]
        Or its constant [N s/m].
    """

    __slots__ = ()
    offset: tuple[float, ...]
    c_over_m_w: float | tuple[float, ...]
    c: float | tuple[float, ...]


class Inerter(Group):
    """Group ``&inerter``.

    Attributes
    ----------
    inertance_over_m_w : float
        Inerter under each corner of the base: its inertance over m_w.
    inertance : float
        Or its inertance [kg].
    """

    __slots__ = ()
    inertance_over_m_w: float
    inertance: float


class Fuse(Group):
    """Group ``&fuse``.

    Attributes
    ----------
    offset : tuple[float, ...]
        Place of each to the right of the axis, at most 4 b away; absent: two, at -b and b [m].
    eta_y : float | tuple[float, ...]
        Yield force of each over m_w g.
    stroke_y : float | tuple[float, ...]
        Stroke at which it yields first [m].
    F_y : float | tuple[float, ...]
        Or the yield force [N].
    k : float | tuple[float, ...]
        Or the stiffness until then: stroke_y = F_y/k [N/m].
    hardening : float | tuple[float, ...]
        Stiffness after yield over the elastic one.
    law : str
        Bilinear, slipping, or self-centring.
    breakaway : float
        Force at which friction lets go over that at which it slips; friction only.
    flag_height : float
        Force by which a flag unloads lower, over its yield force; flag only.
    """

    __slots__ = ()
    offset: tuple[float, ...]
    eta_y: float | tuple[float, ...]
    stroke_y: float | tuple[float, ...]
    F_y: float | tuple[float, ...]
    k: float | tuple[float, ...]
    hardening: float | tuple[float, ...]
    law: Literal["elastic_plastic", "friction", "flag"]
    breakaway: float
    flag_height: float


class Yielding(Group):
    """Group ``&yielding``.

    Attributes
    ----------
    u_y : float
        Displacement at which the frame yields first, the same for all periods of a spectrum [m].
    f_y_over_m_s_g : float
        Or its yield force over the weight of its mass: u_y = f_y_over_m_s_g g/omega_s**2.
    storey_u_y : tuple[float, ...]
        Or, &storeys unless reduced, u_i - u_(i-1) at which storeys yield: one for all or one each
        [m].
    F_y : float
        Or the yield force of a frame without &storeys [N].
    storey_F_y : tuple[float, ...]
        Or the forces at which storeys yield: one for all or one each [N].
    hardening : float
        Stiffness of the yielding frame over its elastic one; < 0: it softens.
    ultimate : float
        Ductility of frame or storey at which it has collapsed, which ends the run.
    law : str
        Bilinear, slipping, self-centring, two that lose strength, or a smooth hysteresis.
    breakaway : float
        Force at which friction lets go over that at which it slips; friction only.
    flag_height : float
        Force by which a flag unloads lower, over its yield force; flag only.
    exponent : float
        Sharpness n of the knee; bouc_wen only.
    beta : float
        Of Bouc and Wen, with gamma = 1 - beta; bouc_wen only.
    cap : float
        Ductility at the largest force; required by peak_oriented, pinched.
    post_cap : float
        Ductility from there to zero force; required by peak_oriented, pinched.
    residual : float
        Strength that remains over that at first yield; peak_oriented, pinched.
    lambda_exponent : tuple[float, ...]
        Exponents c of the wear (E_i/(E_t - sum E_j))**c, as lambda.
    pinch_force : float
        Kappa_F: force at the pinching point over that on the straight way; pinched only.
    pinch_displacement : float
        Kappa_D: part of the plastic displacement left before that point; pinched only.
    """

    __slots__ = ()
    u_y: float
    f_y_over_m_s_g: float
    storey_u_y: tuple[float, ...]
    F_y: float
    storey_F_y: tuple[float, ...]
    hardening: float
    ultimate: float
    law: Literal[
        "elastic_plastic",
        "friction",
        "flag",
        "peak_oriented",
        "pinched",
        "bouc_wen",
    ]
    breakaway: float
    flag_height: float
    exponent: float
    beta: float
    cap: float
    post_cap: float
    residual: float
    lambda_exponent: tuple[float, ...]
    pinch_force: float
    pinch_displacement: float


class PDelta(Group):
    """Group ``&p_delta``.

    Attributes
    ----------
    m_g_over_m_s : float
        Mass whose weight leans on the frame, over the mass of the frame or of each floor.
    m_g : float
        Or that mass; of a frame with floors, the sum of all [kg].
    h_f : float
        Height of the frame; required without &wall, refused with &storeys [m].
    drift_limit : float
        Drift of the frame or of a storey at which it has collapsed, which ends the run.
    """

    __slots__ = ()
    m_g_over_m_s: float
    m_g: float
    h_f: float
    drift_limit: float


class NlDamper(Group):
    """Group ``&nl_damper``.

    Attributes
    ----------
    offset : tuple[float, ...]
        Place of each to the right of the axis, at most 4 b away; absent: two, at -b and b [m].
    eta_1 : float | tuple[float, ...]
        Force at 1 m/s of the damper under each corner over m_w g.
    F_1 : float | tuple[float, ...]
        Or that force [N].
    exponent : float
        Power of the velocity of the stroke that the force follows; 1 is &damper.
    """

    __slots__ = ()
    offset: tuple[float, ...]
    eta_1: float | tuple[float, ...]
    F_1: float | tuple[float, ...]
    exponent: float


class Bending(Group):
    """Group ``&bending``.

    Attributes
    ----------
    EI_over_m_w : float
        Bending stiffness of the wall over m_w [m3/s2].
    EI : float
        Or the bending stiffness [N m2].
    E : float
        Or the modulus of elasticity, with &wall thickness [Pa].
    cracking : float
        Factor on the moment of inertia of the gross section; only with E.
    modes : int
        Number of modes.
    xi : float
        Damping ratio, in the first mode of damping stiffness.
    xi_of : str
        Wall whose modes have xi: bare on a fixed base, or rocking with its floors (first mode).
    damping : str
        Equal ratios in all modes of the cantilever, or in proportion to the stiffness.
    nu : float
        Poisson's ratio; if given, the wall also deforms in shear.
    """

    __slots__ = ()
    EI_over_m_w: float
    EI: float
    E: float
    cracking: float
    modes: int
    xi: float
    xi_of: Literal["cantilever", "rocking"]
    damping: Literal["modal", "stiffness"]
    nu: float


class Coupling(Group):
    """Group ``&coupling``.

    Attributes
    ----------
    eta_y : float | tuple[float, ...]
        Yield force of each over m_w g.
    stroke_y : float | tuple[float, ...]
        Stroke at which it yields first [m].
    F_y : float | tuple[float, ...]
        Or the yield force [N].
    k : float | tuple[float, ...]
        Or the stiffness; with F_y, that until it yields [N/m].
    hardening : float | tuple[float, ...]
        Stiffness after yield over the elastic one.
    law : str
        Bilinear, slipping, or self-centring.
    breakaway : float
        Force at which friction lets go over that at which it slips; friction only.
    flag_height : float
        Force by which a flag unloads lower, over its yield force; flag only.
    k_over_m_w : float | tuple[float, ...]
        Stiffness of each linear spring over m_w [1/s2].
    c_over_m_w : float | tuple[float, ...]
        Constant of each viscous damper over m_w [1/s].
    c : float | tuple[float, ...]
        Or its constant [N s/m].
    span : float
        Clear span of coupling beams clamped in both walls; 0: plates or dampers [m].
    """

    __slots__ = ()
    eta_y: float | tuple[float, ...]
    stroke_y: float | tuple[float, ...]
    F_y: float | tuple[float, ...]
    k: float | tuple[float, ...]
    hardening: float | tuple[float, ...]
    law: Literal["elastic_plastic", "friction", "flag"]
    breakaway: float
    flag_height: float
    k_over_m_w: float | tuple[float, ...]
    c_over_m_w: float | tuple[float, ...]
    c: float | tuple[float, ...]
    span: float


class Restraint(Group):
    """Group ``&restraint``.

    Attributes
    ----------
    offset : tuple[float, ...]
        Place of each held point to the right of the axis, at most 20 b away [m].
    height : float | tuple[float, ...]
        Height of each held point above the base, at most 2h [m].
    eta_y : float | tuple[float, ...]
        Yield force of each over m_w g.
    stroke_y : float | tuple[float, ...]
        Stroke at which it yields first [m].
    F_y : float | tuple[float, ...]
        Or the yield force [N].
    k : float | tuple[float, ...]
        Or the stiffness; with F_y, that until it yields [N/m].
    hardening : float | tuple[float, ...]
        Stiffness after yield over the elastic one.
    law : str
        Bilinear, slipping, or self-centring.
    breakaway : float
        Force at which friction lets go over that at which it slips; friction only.
    flag_height : float
        Force by which a flag unloads lower, over its yield force; flag only.
    k_over_m_w : float | tuple[float, ...]
        Stiffness of each linear spring over m_w [1/s2].
    c_over_m_w : float | tuple[float, ...]
        Constant of each viscous damper over m_w [1/s].
    c : float | tuple[float, ...]
        Or its constant [N s/m].
    """

    __slots__ = ()
    offset: tuple[float, ...]
    height: float | tuple[float, ...]
    eta_y: float | tuple[float, ...]
    stroke_y: float | tuple[float, ...]
    F_y: float | tuple[float, ...]
    k: float | tuple[float, ...]
    hardening: float | tuple[float, ...]
    law: Literal["elastic_plastic", "friction", "flag"]
    breakaway: float
    flag_height: float
    k_over_m_w: float | tuple[float, ...]
    c_over_m_w: float | tuple[float, ...]
    c: float | tuple[float, ...]


class Cable(Group):
    """Group ``&cable``.

    Attributes
    ----------
    eta_0 : float | tuple[float, ...]
        P(0)/(m_w g), Eq. (1).
    eta_alpha : float | tuple[float, ...]
        P(alpha)/(m_w g) of such a tendon on the axis: sets its stiffness.
    law : str
        Eq. (1), or the exact length of the straight cable.
    offset : tuple[float, ...]
        Place of each tendon to the right of the axis, at most 4 b away; absent: one, at 0 [m].
    height : float | tuple[float, ...]
        Height of each upper anchor, at most 2h, the default [m].
    eta_y : float | tuple[float, ...]
        P/(m_w g) at which the tendon yields; absent: it stays elastic.
    hardening : float | tuple[float, ...]
        Stiffness of the tendon after yield over its elastic one.
    rupture_strain : float | tuple[float, ...]
        Strain at which it breaks, that of the prestress included; absent: never.
    length : float | tuple[float, ...]
        Length that is strained, with strands or rupture_strain; absent: height [m].
    strands : int | tuple[int, ...]
        Number of strands: P(0) = strands strand_area initial_stress.
    strand_area : float | tuple[float, ...]
        Area of each [m2].
    modulus : float | tuple[float, ...]
        Of elasticity: P(alpha) follows from the elongation at alpha over length [Pa].
    initial_stress : float | tuple[float, ...]
        Stress at theta = 0 [Pa].
    yield_stress : float | tuple[float, ...]
        Stress at which it yields; absent: it stays elastic [Pa].
    """

    __slots__ = ()
    eta_0: float | tuple[float, ...]
    eta_alpha: float | tuple[float, ...]
    law: Literal["linear", "truss"]
    offset: tuple[float, ...]
    height: float | tuple[float, ...]
    eta_y: float | tuple[float, ...]
    hardening: float | tuple[float, ...]
    rupture_strain: float | tuple[float, ...]
    length: float | tuple[float, ...]
    strands: int | tuple[int, ...]
    strand_area: float | tuple[float, ...]
    modulus: float | tuple[float, ...]
    initial_stress: float | tuple[float, ...]
    yield_stress: float | tuple[float, ...]


class Impact(Group):
    """Group ``&impact``.

    Attributes
    ----------
    rule : str
        Coupled: momentum balance of wall and frame; e, r imply constant, table_e table; none: e =
        1.
    e : float
        Factor on the angular velocity at impact; constant: exactly one of e and r.
    r : float
        E squared.
    table_theta_dot : tuple[float, ...]
        Angular velocities before impact, increasing; required for rule table [rad/s].
    table_e : tuple[float, ...]
        E at them: linear between, constant beyond; required for rule table.
    """

    __slots__ = ()
    rule: Literal["constant", "housner", "coupled", "table", "none"]
    e: float
    r: float
    table_theta_dot: tuple[float, ...]
    table_e: tuple[float, ...]


class Motion(Group):
    """Group ``&motion``.

    Attributes
    ----------
    kind : str
        One_sine: Eq. (16), one_cosine: Eq. (17), sine: cycles; all: reference/pulses.md.
    a_max_g : float
        Largest acceleration over g; exactly one of a_max_g and v_p.
    v_p : float
        Velocity amplitude of Eqs (16), (17), reference/pulses.md; no Ricker pulse has it [m/s].
    omega_p : float
        Angular frequency; exactly one of omega_p and T_p [rad/s].
    T_p : float
        Period of the pulse [s].
    cycles : float
        Number of cycles.
    n_pulses : int
        N of the pulse C_n.
    gamma_p : float
        Gamma, the number of cycles in the envelope; required for this kind.
    nu : float
        Phase of the carrier: 0 symmetric, pi/2 antisymmetric velocity [rad].
    t_0 : float
        Start of the pulse [s].
    file : str
        Path, relative to the case file; required for a record.
    dt : float
        Sampling interval; required for one column unless the file states it, refused for two
        columns and AT2 [s].
    unit : str
        Of the accelerations; required unless the file states it; refused for AT2.
    scale : float
        Factor on the accelerations.
    """

    __slots__ = ()
    kind: Literal[
        "none",
        "one_sine",
        "one_cosine",
        "sine",
        "type_c",
        "mavroeidis_papageorgiou",
        "ricker",
        "ricker_antisymmetric",
        "record",
    ]
    a_max_g: float
    v_p: float
    omega_p: float
    T_p: float
    cycles: float
    n_pulses: int
    gamma_p: float
    nu: float
    t_0: float
    file: str
    dt: float
    unit: Literal["g", "m/s2", "cm/s2"]
    scale: float


class Vertical(Group):
    """Group ``&vertical``.

    Attributes
    ----------
    ratio : float
        Vertical over horizontal ground acceleration; exactly one of ratio and file.
    file : str
        Record of the vertical acceleration (positive upward), relative to the case file.
    dt : float
        Sampling interval; required for one column unless the file states it, refused for two
        columns and AT2 [s].
    unit : str
        Of the accelerations; required unless the file states it; refused for AT2.
    scale : float
        Factor on the record.
    """

    __slots__ = ()
    ratio: float
    file: str
    dt: float
    unit: Literal["g", "m/s2", "cm/s2"]
    scale: float


class Initial(Group):
    """Group ``&initial``.

    Attributes
    ----------
    theta_over_alpha : float
        Rotation over slenderness; within the overturning angle.
    theta_dot : float
        Angular velocity [rad/s].
    """

    __slots__ = ()
    theta_over_alpha: float
    theta_dot: float


class Model(Group):
    """Group ``&model``.

    Attributes
    ----------
    formulation : str
        Eq. (15) as printed, or one that conserves energy.
    g : float
        Gravity [m/s2].
    overturning_angle : float
        Rotation at which the wall counts as overturned [rad].
    """

    __slots__ = ()
    formulation: Literal["published", "symmetric", "exact"]
    g: float
    overturning_angle: float


class Solver(Group):
    """Group ``&solver``.

    Attributes
    ----------
    method : str
        Integrator; auto: dop853 for runs, by scene and tolerance for spectra; paper: Eq. (15) by
        CVODE.
    rtol : float
        Relative tolerance; below the lower limit round-off governs every method.
    accuracy : float
        Relative error of a peak asked instead of rtol.
    accuracy_of : str
        Key of the peak that accuracy and verify are about; absent: u_s_max_m (no frame: theta_max).
    verify : bool
        Estimate error and sensitivity of a peak by further runs.
    atol : float
        Absolute tolerance (bare frame: m); absent: from rtol and the response [rad].
    t_end : float
        End of the simulation; required but for a record: its last sample [s].
    max_steps : int
        Most steps of one simulation.
    """

    __slots__ = ()
    method: Literal["auto", "taylor", "adams", "bdf", "dop853", "paper"]
    rtol: float
    accuracy: float
    accuracy_of: str
    verify: bool
    atol: float
    t_end: float
    max_steps: int


class Output(Group):
    """Group ``&output``.

    Attributes
    ----------
    dt : float
        Interval of the history; absent: no history [s].
    energy : bool
        Energy ledger: its parts at the end, with dt in every row.
    reactions : bool
        Reactions of the base, demands and member forces of a run: extrema, with dt rows.
    friction_limit : float
        Coefficient of friction: whether and when the friction demand exceeds it.
    conditioning : bool
        Sensitivity of each peak to the motion; absent: in runs, not in spectra and sweeps.
    """

    __slots__ = ()
    dt: float
    energy: bool
    reactions: bool
    friction_limit: float
    conditioning: bool


class BaseSection(Group):
    """Group ``&base_section``.

    Attributes
    ----------
    k : float
        Subgrade modulus: stress per settlement of the strip, which takes no tension [N/m3].
    E : float
        Modulus of elasticity: toe strain = k settlement/E; beside length: k = E/length [Pa].
    length : float
        Height of the strip over which it is strained; beside k: E = k length [m].
    f_c : float
        Compressive strength: largest stress; a toe stress above 0.6 f_c gives a warning [Pa].
    """

    __slots__ = ()
    k: float
    E: float
    length: float
    f_c: float


class Limits(Group):
    """Group ``&limits``.

    Attributes
    ----------
    u_s_max_m : float
        Largest displacement of the frame [m].
    tip_deflection_max_m : float
        Largest deflection of the top from the straight axis [m].
    toe_settlement_max_m : float
        Largest settlement of an edge of the base [m].
    middle_rise_max_m : float
        Largest height of the middle of the base [m].
    middle_end_m : float
        Height of the middle of the base at the end [m].
    toe_stress_max_over_k_m : float
        Largest stress of the base over its stiffness [m].
    base_normal_max_over_m_w_g : float
        Largest normal force of the base over weight of wall.
    base_normal_max_N : float
        Largest normal force of the base [N].
    base_shear_max_over_m_w_g : float
        Largest horizontal force of the base over weight of wall.
    slide_max_m : float
        Largest slip of the base [m].
    slide_end_m : float
        Slip of the base to the right at the end [m].
    crushed_depth_max_m : float
        Largest crushed depth of the base [m].
    crushed_left_m : float
        Crushed depth of the leftmost strip [m].
    crushed_right_m : float
        Crushed depth of the rightmost strip [m].
    theta_max_over_alpha : float
        Largest rotation over slenderness.
    theta_dot_max_rad_s : float
        Largest angular velocity [rad/s].
    cable_force_increment_max_over_m_w_g : float
        Largest increment of the cable force over weight of wall.
    cable_prestress_loss_over_m_w_g : float
        Cable force at theta = 0 that is lost at the end, over weight of wall.
    ductility : float
        Largest displacement over that at first yield.
    residual_displacement_m : float
        Displacement at which the frame alone would be without force at the end [m].
    theta_end_over_alpha : float
        Rotation at the end over slenderness.
    storeys_ductility : tuple[float, ...]
        Largest displacement of storey over that at first yield: one for all, or one each.
    storeys_residual_drift : tuple[float, ...]
        Drift of storey that unloading would leave at the end: one for all, or one each.
    storeys_residual_drift_at_rest : tuple[float, ...]
        Drift of storey in static equilibrium after the motion: one for all, or one each.
    base_shear_max_over_weight : float
        Largest base shear over weight of wall and frame.
    friction_demand_max : float
        Required coefficient of friction.
    friction_demand_impact_max : float
        Largest horizontal over vertical impulse of the base at an impact.
    shear_key_force_max_over_m_w_g : float
        Largest force of the shear key over weight of wall.
    wall_drift_max : float
        Largest drift of the wall.
    frame_drift_max : float
        Largest displacement of the frame, that of its roof, over the wall's height.
    cable_force_increment_max_N : float
        Largest increment of the cable force [N].
    cable_prestress_loss_N : float
        Cable force at theta = 0 that is lost at the end [N].
    base_shear_max_N : float
        Largest base shear [N].
    shear_key_force_max_N : float
        Largest force of the shear key [N].
    tendon_force_max_over_m_w_g : float
        Largest force of the cable over weight of wall.
    tendon_force_max_N : float
        Largest force of the cable [N].
    tendon_stress_max_Pa : float
        Largest stress of the strands of the cable [Pa].
    tendon_strain_max : float
        Largest strain of the cable, that of the prestress included.
    storeys_drift_max : tuple[float, ...]
        Largest drift of storey over its height: one for all, or one each.
    storey_drift_max : float
        Largest drift of all storeys over their heights.
    roof_drift_max : float
        Largest displacement of the roof over its height.
    storey_residual_drift_max : float
        Largest drift of a storey that unloading would leave at the end.
    roof_residual_drift : float
        Displacement of the roof that unloading would leave over its height.
    roof_residual_drift_at_rest : float
        Drift of the roof in static equilibrium after the motion.
    floors_acceleration_max_g : tuple[float, ...]
        Largest absolute acceleration of floor over g: one for all, or one each.
    floor_acceleration_max_g : float
        Largest absolute acceleration of all floors over g.
    storeys_shear_max_over_m_w_g : tuple[float, ...]
        Largest shear of the columns of storey over the weight that its mass is over: one for all,
        or one each.
    overturning_moment_max_over_weight_m : float
        Largest moment of all horizontal inertia about the ground over the weight [m].
    wall_shear_max_over_m_w_g : float
        Largest shear inside the wall over its weight.
    wall_moment_max_over_m_w_g_m : float
        Largest bending moment inside the wall over its weight [m].
    storeys_shear_max_N : tuple[float, ...]
        Largest shear of the columns of storey: one for all, or one each [N].
    overturning_moment_max_N_m : float
        Largest moment of all horizontal inertia about the ground [N m].
    wall_shear_max_N : float
        Largest shear inside the wall [N].
    wall_moment_max_N_m : float
        Largest bending moment inside the wall [N m].
    wall_shear_base_max_over_m_w_g : float
        Largest shear in the wall at its base over its weight.
    wall_moment_base_max_over_m_w_g_m : float
        Largest bending moment in the wall at its base over its weight [m].
    wall_shear_mid_max_over_m_w_g : float
        Largest shear in the wall at mid-height over its weight.
    wall_moment_mid_max_over_m_w_g_m : float
        Largest bending moment in the wall at mid-height over its weight [m].
    wall_shears_max_over_m_w_g : tuple[float, ...]
        Largest shear in the wall just below floor over its weight: one for all, or one each.
    wall_shears_above_max_over_m_w_g : tuple[float, ...]
        Largest shear in the wall just above floor over its weight: one for all, or one each.
    wall_moments_max_over_m_w_g_m : tuple[float, ...]
        Largest moment in the wall just below floor over its weight: one for all, or one each [m].
    wall_moments_above_max_over_m_w_g_m : tuple[float, ...]
        Largest moment in the wall just above floor over its weight: one for all, or one each [m].
    links_force_max_over_m_w_g : tuple[float, ...]
        Largest axial force of the link at floor over weight of wall: one for all, or one each.
    pivot_normal_max_over_m_w_g : float
        Largest pivot reaction over weight of wall.
    fuse_stroke_max_m : float
        Largest stroke of a fuse [m].
    fuse_stroke_sum_m : float
        Travel of a fuse there and back, of both the longer one [m].
    cables_force_max_over_m_w_g : tuple[float, ...]
        Largest force of tendon over weight of wall: one for all, or one each.
    cables_prestress_loss_over_m_w_g : tuple[float, ...]
        Force of tendon at theta = 0 that is lost at the end over weight of wall: one for all, or
        one each.
    fuses_stroke_max_m : tuple[float, ...]
        Largest stroke of fuse: one for all, or one each [m].
    fuses_stroke_sum_m : tuple[float, ...]
        Travel of fuse there and back: one for all, or one each [m].
    fuses_force_max_over_m_w_g : tuple[float, ...]
        Largest magnitude of the force of fuse over weight of wall: one for all, or one each.
    fuses_force_end_over_m_w_g : tuple[float, ...]
        Force of fuse at the end over weight of wall: one for all, or one each.
    restraints_stroke_max_m : tuple[float, ...]
        Largest stroke of restraint: one for all, or one each [m].
    restraints_stroke_sum_m : tuple[float, ...]
        Travel of restraint there and back: one for all, or one each [m].
    restraints_force_max_over_m_w_g : tuple[float, ...]
        Largest magnitude of the force of restraint over weight of wall: one for all, or one each.
    restraints_force_end_over_m_w_g : tuple[float, ...]
        Force of restraint at the end over weight of wall: one for all, or one each.
    coupling_stroke_max_m : float
        Largest magnitude of the stroke of a coupling [m].
    coupling_stroke_sum_m : float
        Travel of a coupling there and back [m].
    coupling_force_max_over_m_w_g : float
        Largest magnitude of the force of a coupling over weight of wall.
    coupling_force_end_over_m_w_g : float
        Force of a coupling at the end over weight of wall.
    cables_force_max_N : tuple[float, ...]
        Largest force of tendon: one for all, or one each [N].
    cables_prestress_loss_N : tuple[float, ...]
        Force of tendon at theta = 0 that is lost at the end: one for all, or one each [N].
    fuses_force_max_N : tuple[float, ...]
        Largest magnitude of the force of fuse: one for all, or one each [N].
    fuses_force_end_N : tuple[float, ...]
        Force of fuse at the end: one for all, or one each [N].
    restraints_force_max_N : tuple[float, ...]
        Largest magnitude of the force of restraint: one for all, or one each [N].
    restraints_force_end_N : tuple[float, ...]
        Force of restraint at the end: one for all, or one each [N].
    coupling_force_max_N : float
        Largest magnitude of the force of a coupling [N].
    coupling_force_end_N : float
        Force of a coupling at the end [N].
    floors_velocity_max_m_s : tuple[float, ...]
        Largest absolute velocity of floor: one for all, or one each [m/s].
    wall_shear_base_max_N : float
        Largest shear in the wall at its base [N].
    wall_moment_base_max_N_m : float
        Largest bending moment in the wall at its base [N m].
    wall_shear_mid_max_N : float
        Largest shear in the wall at mid-height [N].
    wall_moment_mid_max_N_m : float
        Largest bending moment in the wall at mid-height [N m].
    wall_shears_max_N : tuple[float, ...]
        Largest shear in the wall just below floor: one for all, or one each [N].
    wall_shears_above_max_N : tuple[float, ...]
        Largest shear in the wall just above floor: one for all, or one each [N].
    wall_moments_max_N_m : tuple[float, ...]
        Largest moment in the wall just below floor: one for all, or one each [N m].
    wall_moments_above_max_N_m : tuple[float, ...]
        Largest moment in the wall just above floor: one for all, or one each [N m].
    links_force_max_N : tuple[float, ...]
        Largest axial force of the link at floor: one for all, or one each [N].
    pivot_normal_max_N : float
        Largest pivot reaction [N].
    contact_length_min_m : float
        Smallest contact length of the base [m].
    toe_stress_max_Pa : float
        Largest compressive stress at the toe of the wall [Pa].
    toe_strain_max : float
        Largest compressive strain at the toe of the wall.
    """

    __slots__ = ()
    u_s_max_m: float
    tip_deflection_max_m: float
    toe_settlement_max_m: float
    middle_rise_max_m: float
    middle_end_m: float
    toe_stress_max_over_k_m: float
    base_normal_max_over_m_w_g: float
    base_normal_max_N: float
    base_shear_max_over_m_w_g: float
    slide_max_m: float
    slide_end_m: float
    crushed_depth_max_m: float
    crushed_left_m: float
    crushed_right_m: float
    theta_max_over_alpha: float
    theta_dot_max_rad_s: float
    cable_force_increment_max_over_m_w_g: float
    cable_prestress_loss_over_m_w_g: float
    ductility: float
    residual_displacement_m: float
    theta_end_over_alpha: float
    storeys_ductility: tuple[float, ...]
    storeys_residual_drift: tuple[float, ...]
    storeys_residual_drift_at_rest: tuple[float, ...]
    base_shear_max_over_weight: float
    friction_demand_max: float
    friction_demand_impact_max: float
    shear_key_force_max_over_m_w_g: float
    wall_drift_max: float
    frame_drift_max: float
    cable_force_increment_max_N: float
    cable_prestress_loss_N: float
    base_shear_max_N: float
    shear_key_force_max_N: float
    tendon_force_max_over_m_w_g: float
    tendon_force_max_N: float
    tendon_stress_max_Pa: float
    tendon_strain_max: float
    storeys_drift_max: tuple[float, ...]
    storey_drift_max: float
    roof_drift_max: float
    storey_residual_drift_max: float
    roof_residual_drift: float
    roof_residual_drift_at_rest: float
    floors_acceleration_max_g: tuple[float, ...]
    floor_acceleration_max_g: float
    storeys_shear_max_over_m_w_g: tuple[float, ...]
    overturning_moment_max_over_weight_m: float
    wall_shear_max_over_m_w_g: float
    wall_moment_max_over_m_w_g_m: float
    storeys_shear_max_N: tuple[float, ...]
    overturning_moment_max_N_m: float
    wall_shear_max_N: float
    wall_moment_max_N_m: float
    wall_shear_base_max_over_m_w_g: float
    wall_moment_base_max_over_m_w_g_m: float
    wall_shear_mid_max_over_m_w_g: float
    wall_moment_mid_max_over_m_w_g_m: float
    wall_shears_max_over_m_w_g: tuple[float, ...]
    wall_shears_above_max_over_m_w_g: tuple[float, ...]
    wall_moments_max_over_m_w_g_m: tuple[float, ...]
    wall_moments_above_max_over_m_w_g_m: tuple[float, ...]
    links_force_max_over_m_w_g: tuple[float, ...]
    pivot_normal_max_over_m_w_g: float
    fuse_stroke_max_m: float
    fuse_stroke_sum_m: float
    cables_force_max_over_m_w_g: tuple[float, ...]
    cables_prestress_loss_over_m_w_g: tuple[float, ...]
    fuses_stroke_max_m: tuple[float, ...]
    fuses_stroke_sum_m: tuple[float, ...]
    fuses_force_max_over_m_w_g: tuple[float, ...]
    fuses_force_end_over_m_w_g: tuple[float, ...]
    restraints_stroke_max_m: tuple[float, ...]
    restraints_stroke_sum_m: tuple[float, ...]
    restraints_force_max_over_m_w_g: tuple[float, ...]
    restraints_force_end_over_m_w_g: tuple[float, ...]
    coupling_stroke_max_m: float
    coupling_stroke_sum_m: float
    coupling_force_max_over_m_w_g: float
    coupling_force_end_over_m_w_g: float
    cables_force_max_N: tuple[float, ...]
    cables_prestress_loss_N: tuple[float, ...]
    fuses_force_max_N: tuple[float, ...]
    fuses_force_end_N: tuple[float, ...]
    restraints_force_max_N: tuple[float, ...]
    restraints_force_end_N: tuple[float, ...]
    coupling_force_max_N: float
    coupling_force_end_N: float
    floors_velocity_max_m_s: tuple[float, ...]
    wall_shear_base_max_N: float
    wall_moment_base_max_N_m: float
    wall_shear_mid_max_N: float
    wall_moment_mid_max_N_m: float
    wall_shears_max_N: tuple[float, ...]
    wall_shears_above_max_N: tuple[float, ...]
    wall_moments_max_N_m: tuple[float, ...]
    wall_moments_above_max_N_m: tuple[float, ...]
    links_force_max_N: tuple[float, ...]
    pivot_normal_max_N: float
    contact_length_min_m: float
    toe_stress_max_Pa: float
    toe_strain_max: float


class Sensitivity(Group):
    """Group ``&sensitivity``.

    Attributes
    ----------
    parameters : tuple[str, ...]
        Keys by which `rwmf run` and `rwmf gradient` differentiate.
    quantities : tuple[str, ...]
        Results to differentiate; absent: u_s_max_m, of a block theta_max_over_alpha.
    """

    __slots__ = ()
    parameters: tuple[str, ...]
    quantities: tuple[str, ...]


class Design(Group):
    """Group ``&design``.

    Attributes
    ----------
    parameters : tuple[str, ...]
        Keys that the design chooses.
    low : tuple[float, ...]
        Least value of each parameter.
    high : tuple[float, ...]
        Largest value of each parameter.
    cost : tuple[float, ...]
        Cost of a unit of each parameter; the design has the least sum.
    percentile : float
        Percentile of the suite that meets &limits; 84 without probability [%].
    probability : float
        Share of the suite that may exceed a limit of &limits; beside no percentile.
    collapse_probability : float
        Share of the suite that may collapse or overturn.
    collapse_scale : float
        Factor on the motions for the collapse, such as 1.5 from design level to MCE.
    records : tuple[str, ...]
        The suite, from the folder of the case; absent: the motion of the case.
    left_out : tuple[str, ...]
        Records that judge the design; absent: every fourth of the suite.
    unit : str
        Unit of the records.
    designs : int
        Number of designs of the first stage.
    """

    __slots__ = ()
    parameters: tuple[str, ...]
    low: tuple[float, ...]
    high: tuple[float, ...]
    cost: tuple[float, ...]
    percentile: float
    probability: float
    collapse_probability: float
    collapse_scale: float
    records: tuple[str, ...]
    left_out: tuple[str, ...]
    unit: Literal["g", "m/s2", "cm/s2"]
    designs: int


class Spectrum(Group):
    """Group ``&spectrum``.

    Attributes
    ----------
    T_s : tuple[float, ...]
        Periods one by one (block: 2 pi/p); otherwise T_s_min, T_s_max and n are required [s].
    T_s_min : float
        Shortest period [s].
    T_s_max : float
        Longest period [s].
    n : int
        Number of periods, both ends included.
    spacing : str
        Spacing of the periods.
    gamma : tuple[float, ...]
        Mass ratios; absent: that of the case.
    b : tuple[float, ...]
        Half widths; absent: that of &wall [m].
    quantities : tuple[str, ...]
        Keys of what each ordinate reports; absent: u_s_max_m, of a block theta_max_over_alpha.
    """

    __slots__ = ()
    T_s: tuple[float, ...]
    T_s_min: float
    T_s_max: float
    n: int
    spacing: Literal["linear", "log"]
    gamma: tuple[float, ...]
    b: tuple[float, ...]
    quantities: tuple[str, ...]


class Groups:
    """The groups as attributes.

    An attribute is None where the case lacks the group. The declared types are those of a group
    that is present; ``"wall" in case.groups`` tests for it.

    Attributes
    ----------
    wall : Wall
        Group ``&wall``.
    base : Base
        Group ``&base``.
    frame : Frame
        Group ``&frame``.
    storeys : Storeys
        Group ``&storeys``.
    link : Link
        Group ``&link``.
    damper : Damper
        Group ``&damper``.
    inerter : Inerter
        Group ``&inerter``.
    fuse : Fuse
        Group ``&fuse``.
    yielding : Yielding
        Group ``&yielding``.
    p_delta : PDelta
        Group ``&p_delta``.
    nl_damper : NlDamper
        Group ``&nl_damper``.
    bending : Bending
        Group ``&bending``.
    coupling : Coupling
        Group ``&coupling``.
    restraint : Restraint
        Group ``&restraint``.
    cable : Cable
        Group ``&cable``.
    impact : Impact
        Group ``&impact``.
    motion : Motion
        Group ``&motion``.
    vertical : Vertical
        Group ``&vertical``.
    initial : Initial
        Group ``&initial``.
    model : Model
        Group ``&model``.
    solver : Solver
        Group ``&solver``.
    output : Output
        Group ``&output``.
    base_section : BaseSection
        Group ``&base_section``.
    limits : Limits
        Group ``&limits``.
    sensitivity : Sensitivity
        Group ``&sensitivity``.
    design : Design
        Group ``&design``.
    spectrum : Spectrum
        Group ``&spectrum``.
    """

    __slots__ = ()
    wall: Wall
    base: Base
    frame: Frame
    storeys: Storeys
    link: Link
    damper: Damper
    inerter: Inerter
    fuse: Fuse
    yielding: Yielding
    p_delta: PDelta
    nl_damper: NlDamper
    bending: Bending
    coupling: Coupling
    restraint: Restraint
    cable: Cable
    impact: Impact
    motion: Motion
    vertical: Vertical
    initial: Initial
    model: Model
    solver: Solver
    output: Output
    base_section: BaseSection
    limits: Limits
    sensitivity: Sensitivity
    design: Design
    spectrum: Spectrum


TYPES: dict[str, type[Group]] = {
    "wall": Wall,
    "base": Base,
    "frame": Frame,
    "storeys": Storeys,
    "link": Link,
    "damper": Damper,
    "inerter": Inerter,
    "fuse": Fuse,
    "yielding": Yielding,
    "p_delta": PDelta,
    "nl_damper": NlDamper,
    "bending": Bending,
    "coupling": Coupling,
    "restraint": Restraint,
    "cable": Cable,
    "impact": Impact,
    "motion": Motion,
    "vertical": Vertical,
    "initial": Initial,
    "model": Model,
    "solver": Solver,
    "output": Output,
    "base_section": BaseSection,
    "limits": Limits,
    "sensitivity": Sensitivity,
    "design": Design,
    "spectrum": Spectrum,
}
