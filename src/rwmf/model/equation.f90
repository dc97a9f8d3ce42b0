!> The scene that an equation of motion is written for: the model, which is fixed once it has been
!> put together, the discrete state, and what follows from both at a given rotation.
module rwmf_model_equation
   use rwmf_core_kinds, only: i8, wp
   use rwmf_model_beam, only: beam_t, tip_deflection, tip_rate
   use rwmf_model_cable, only: cable_law_i, cable_law_t, cable_row, cable_state_t
   use rwmf_model_hysteresis_spring, only: branch_t, spring_t
   use rwmf_model_kinematics, only: displacement_of, geometry_t, kinematics_of, kinematics_t, &
      put_wall_side, wall_row
   use rwmf_model_lanes, only: cable_coefficients, frame_coefficients, wall_coefficients
   use rwmf_model_parameters, only: parameters_t
   use rwmf_model_scene, only: elsewhere, first_wall, force_parts_t, frame_term, &
      linear_cable_term, scene_t, straight_cable_term
   use rwmf_motion_ground_motion, only: acceleration, line_of, line_t, motion_t, &
      vertical_acceleration, vertical_line_of
   implicit none
   private

   public :: equation_t, model_t, discrete_state_t
   public :: contribution_t, floors_t, hysteresis_t, motion_signs_t, sprung_t, window_t
   public :: place_frame, place_left, place_right
   public :: enter_interval, interval_of, enter_side, renew_coefficients, renew_effects
   public :: vertical_ground, has_further_effects
   public :: ground, kinematics_at, cable_at, lift_off_drive, lift_off_drives
   public :: frame_displacement, straight_displacement
   public :: frame_acceleration, frame_motion, frame_travel, frame_mass, corner_share

   !> An effect beyond wall, frame and cable: its loop over lanes, and the states, energy, power and
   !> force on the wall that belong to it (developer/adding-an-effect.md).
   type :: contribution_t
      logical :: is_present = .false.
      !! the case calls for it
      real(wp), allocatable :: constants(:)
      !! what its procedures need of the case, each constant in a unit of its own
      procedure(coefficients_i), pointer, nopass :: coefficients => null()
      !! that its loop reads; not associated: it has no loop
      integer :: n_coef = 0
      !! number of coefficients
      integer :: coef = 1
      !! column of the first among all
      integer :: n = 0
      !! how many parts it has (floors)
      integer :: law = 0
      !! which law its loop follows
      logical :: has_sides = .false.
      !! its coefficients follow the side of the motion
      logical :: is_kinematic = .false.
      !! it changes the kinematics that the loops of others read
      logical :: has_corner_at_turn = .false.
      !! its law has a corner where theta' is zero: the integrator begins anew there
      procedure(energy_i), pointer, nopass :: energy => null()
      !! of its own; not associated: stores nothing
      procedure(frame_energy_i), pointer, nopass :: frame_energy => null()
      !! not associated: the frame holds what an elastic one of a single mass does
      integer :: acts = elsewhere
      !! path of its force to the wall (constants of rwmf_model_scene)
      procedure(frame_force_i), pointer, nopass :: frame_force => null()
      !! asked only for reactions; not associated: no force on the frame
      integer :: states = 0
      !! number of states of its own, whose rates `add` puts in their places
      procedure(sizes_i), pointer, nopass :: sizes => null()
      !! that its states are expected to have
      integer :: first = 0
      !! place of its first state among all, or of the first that it reads
      integer :: reads = 0
      !! number of states of another effect that its loop reads, and whose rates it adds to
      integer :: drifts = 0
      !! number of drifts that end the run when they pass their limits
      procedure(drifts_i), pointer, nopass :: put_drifts => null()
      !! those drifts
      procedure(land_i), pointer, nopass :: land => null()
      !! changes its states at an impact; not associated: they go on
   end type contribution_t

   !> Smooth hysteresis of the frame after Bouc and Wen.
   type :: hysteresis_t
      real(wp) :: u_y = 1
      !! displacement at yield [m]
      real(wp) :: hardening = 0
      !! stiffness after yielding over elastic stiffness [-]
      real(wp) :: exponent = 2
      !! [-]
      real(wp) :: beta = 0.5_wp
      !! [-]
      integer :: place = 3
      !! of z among the states
      real(wp) :: force_at_z1 = 0
      !! force of z = 1 over m_s [m/s2]
      integer :: factors = 0
      !! n where it is a small natural number, so that |z|**n is a product; else 0
   end type hysteresis_t

   !> Signs in the piece of motion in force, and what they mean for smooth hysteresis.
   type :: motion_signs_t
      integer :: loading_direction = 1
      !! sign of the velocity: of theta', of a storey u_i' - u_(i-1)'; 0: it has not moved yet
      integer :: sense = 1
      !! sign of z
      real(wp) :: lost = 1
      !! part of |z|**n that is lost in it: 1 while |z| grows, 1 - 2 beta while it falls; with the
      !! sign of z where z**n takes the place of |z|**n and n is odd [-]
   end type motion_signs_t

   !> The floors of a frame, from the ground to the roof: with all its modes, or what one mode makes
   !> of them.
   type :: floors_t
      real(wp) :: excited_mass_ratio = 1
      !! mass of the frame that the ground motion pushes over the mass that moves [-]
      real(wp) :: mass = 0
      !! mass of floors that does not move with the roof, over m_w; without wall over the roof's [-]
      logical :: are_linked = .false.
      !! every floor is linked to the wall, not the roof alone
      real(wp) :: base_shear_ratio = 1
      !! shear of the lowest storey over the force that resists the roof [-]
      real(wp) :: max_frequency = 0
      !! largest frequency of floors that move by themselves [rad/s]
      integer :: n = 0
      !! number of floors that move by themselves; 0: the following are not there
      real(wp), allocatable :: m(:)
      !! (n) mass of each over m_w; without wall over that of the roof [-]
      real(wp), allocatable :: k(:)
      !! (n) stiffness of the storey below over the same mass [1/s2]
      real(wp), allocatable :: c(:, :)
      !! (n, n) damping over the same mass [1/s]
      real(wp), allocatable :: height(:)
      !! (n) of each storey [m]
      integer :: first = 3
      !! place of their first state among all
      logical :: yields = .false.
      !! the storeys do; without, the following are not there
      type(spring_t), allocatable :: springs(:)
      !! (n) of each storey; forces over the same mass
      type(hysteresis_t), allocatable :: laws(:)
      !! (n) of each storey where they are smooth; forces over the same mass
      real(wp) :: unit = 1
      !! the mass that m is over, in that of the case [-]
   end type floors_t

   integer, parameter :: place_frame = 0
   !! between ground and frame
   integer, parameter :: place_left = 1
   !! under the corner that lifts for theta > 0
   integer, parameter :: place_right = -1
   !! under the other one

   !> A spring with memory and its place.
   type :: sprung_t
      type(spring_t) :: spring
      !! its force per unit m_w (frame: m_s) [m/s2], its elongation in m
      integer :: place
      !! one of the `place_` numbers
      real(wp) :: share = 0
      !! of the frame's stiffness [-]
   end type sprung_t

   !> Rotations between which the branches in force hold on a side.
   type :: window_t
      logical :: is_known = .false.
      real(wp) :: low = -huge(1.0_wp)
      !! [rad]; bare frame: displacement [m]
      real(wp) :: high = huge(1.0_wp)
      !! [rad] or [m]
      logical :: ends_at_peak = .false.
      !! a spring yields, and unloads when the motion turns back
   end type window_t

   !> The interval, side and branches in force, and what follows from them. Plain values: an
   !> assignment saves or restores it.
   type :: discrete_state_t
      integer, private :: interval = 0
      !! of the motion: `interval_of`, set by `enter_interval`
      type(line_t) :: line
      !! of the motion in that interval
      type(line_t) :: vertical_line
      !! of the vertical motion in it
      integer :: side = 1
      !! sign of theta in this flight
      type(motion_signs_t) :: signs
      !! of the frame until the next peak
      type(branch_t) :: tendon
      !! of the cable
      type(branch_t), allocatable :: springs(:)
      !! (springs) of the yielding frame and the fuses
      type(branch_t), allocatable :: storeys(:)
      !! (floors) of each storey
      type(motion_signs_t), allocatable :: storey_signs(:)
      !! (floors) of each storey where their laws are smooth
      real(wp) :: frame_offset = 0
      !! force of the yielding frame over m_s: on the branch in force at zero displacement [m/s2]
      real(wp) :: frame_slope = 0
      !! and its stiffness [1/s2]
      real(wp) :: low = -huge(1.0_wp)
      !! rotation (bare frame: displacement) down to which the branches in force hold [rad]
      real(wp) :: high = huge(1.0_wp)
      !! and up to which they do [rad]
      logical :: ends_at_peak = .false.
      !! a spring yields, and unloads when the motion turns back
      type(window_t) :: windows(-1:1)
      !! the last three by side, as long as no branch changes
      logical :: uplift_is_known = .false.
      !! what follows holds until a branch changes
      real(wp) :: uplift_acceleration(-1:1) = 0
      !! ground acceleration at which the resting wall lifts off, by side (+1: theta > 0), see
      !! `rwmf_model_lift_off` [m/s2]
      real(wp) :: lean = 0
      !! how far a bent wall's weight leans to the right, over b [-]
      real(wp) :: inertia_at_rest = 1
      !! of all that moves with the wall, at theta = 0 over m_w R**2 [-]
      logical :: bearing_is_known = .false.
      !! what follows holds until a branch changes
      real(wp), allocatable :: bearing(:, :)
      !! (2, 2:states) uplift_acceleration to the right and to the left: where all further states
      !! are zero, and by how much it grows with each of them
      real(wp), allocatable :: coef(:, :)
      !! (1, coefficients) that the loops over lanes read, see `renew_coefficients`
   end type discrete_state_t

   !> One scene and its ground motion, as they are put together once.
   type :: model_t
      type(parameters_t) :: p
      !! parameters in the paper's letters; those of absent effects are zero
      real(wp) :: threshold
      !! ground acceleration at which the resting wall of the plain scene lifts off [m/s2]
      real(wp) :: weight_share = 0
      !! of it per vertical ground acceleration [-]
      logical :: effects_act_at_rest = .false.
      !! further effects act on the resting wall
      type(geometry_t) :: geometry
      real(wp) :: inertia = 4.0_wp/3
      !! of the wall about its pivot over m_w R**2 [-]
      type(floors_t) :: floors
      !! of `&storeys`
      type(beam_t) :: beam
      !! of `&bending`
      real(wp) :: push_gain = 1
      !! moment that the ground's acceleration exerts on the wall on its base over that on a rigid
      !! wall [-]
      type(hysteresis_t) :: hysteresis
      !! of the frame
      logical :: has_loading_direction = .false.
      !! rates depend on the sign of theta'
      real(wp) :: creep = 0
      !! velocity below which a wall on its base counts as resting; 0 unless an effect has a law
      !! with a corner at theta' = 0, which may hold it up to that velocity [rad/s]
      logical :: moves_at_rest = .false.
      !! further states move while the wall rests
      logical :: has_wall
      logical :: has_impacts
      !! the wall rocks on its corners
      logical :: has_frame
      logical :: has_cable
      integer :: n = 2
      !! number of states
      type(cable_law_t) :: cable
      type(contribution_t), allocatable :: effects(:)
      !! the further effects that the case calls for; not allocated without any
      logical :: has_bilinear_springs = .false.
      !! there are springs that yield or break
      logical :: has_fuses = .false.
      !! under the corners of a rocking wall
      type(sprung_t), allocatable :: springs(:)
      !! yielding frame, then fuses; the tendon's is in `cable`
      real(wp) :: angle_limit = 0
      !! largest |theta| at which the springs are asked for their elongation [rad]
      real(wp), allocatable :: reach(:, :, :)
      !! (2, side, spring) their elongations from the least |theta| up to it; spring 0 is the tendon
      !! [m]
      logical :: has_vertical = .false.
      !! the ground moves vertically as well
      type(motion_t), pointer :: motion => null()
      procedure(cable_law_i), pointer, nopass :: cable_law => null()
      type(scene_t) :: scene
      !! the loops over lanes
      type(force_parts_t) :: parts
      !! the same by the way of their forces
   end type model_t

   !> The equation of motion of one scene in the piece of motion in force.
   type, extends(model_t) :: equation_t
      type(discrete_state_t) :: state
      integer(i8) :: rhs_evaluations = 0
   end type equation_t

   abstract interface
      !> Coefficients of the loop of an effect, on the side and the branches in force.
      pure subroutine coefficients_i(effect, model, state, coef)
         import :: contribution_t, discrete_state_t, model_t, wp
         implicit none
         type(contribution_t), intent(in) :: effect
         type(model_t), intent(in) :: model
         type(discrete_state_t), intent(in) :: state
         real(wp), intent(out) :: coef(:)
         !! (n_coef)
      end subroutine coefficients_i

      !> Energy that an effect stores [J/kg].
      real(wp) function energy_i(effect, equation, y)
         import :: contribution_t, equation_t, wp
         implicit none
         type(contribution_t), intent(in) :: effect
         type(equation_t), intent(in) :: equation
         real(wp), intent(in) :: y(:)
         !! (states)
      end function energy_i

      !> Kinetic and strain energy of the frame beyond those of a single mass on an elastic spring
      !> [J/kg].
      function frame_energy_i(effect, equation, y) result(energy)
         import :: contribution_t, equation_t, wp
         implicit none
         type(contribution_t), intent(in) :: effect
         type(equation_t), intent(in) :: equation
         real(wp), intent(in) :: y(:)
         !! (states)
         real(wp) :: energy(2)
      end function frame_energy_i

      !> Drifts over their limits, and how fast these ratios change.
      subroutine drifts_i(effect, equation, y, ratio, rate)
         import :: contribution_t, equation_t, wp
         implicit none
         type(contribution_t), intent(in) :: effect
         type(equation_t), intent(in) :: equation
         real(wp), intent(in) :: y(:)
         !! (states)
         real(wp), intent(out) :: ratio(:)
         !! (drifts of the effect) with sign; the run ends at -1 and 1 [-]
         real(wp), intent(out) :: rate(:)
         !! (drifts of the effect) [1/s]
      end subroutine drifts_i

      !> Change the velocities of an effect's states at an impact by its own balance of momentum.
      subroutine land_i(effect, equation, y, after, stays)
         import :: contribution_t, equation_t, wp
         implicit none
         type(contribution_t), intent(in) :: effect
         type(equation_t), intent(in) :: equation
         !! on the side that the wall comes from
         real(wp), intent(inout) :: y(:)
         !! (states) at theta = 0; theta' keeps its value before the impact
         real(wp), intent(inout) :: after
         !! theta' after the impact, so far by the velocity factor [rad/s]
         logical, intent(inout) :: stays
         !! both corners stay on the base: theta' after the impact is 0; on entry: whatever the
         !! momentum
      end subroutine land_i

      !> Sizes that the states of an effect are expected to have, for absolute tolerances.
      subroutine sizes_i(effect, equation, size_guess, sizes)
         import :: contribution_t, equation_t, wp
         implicit none
         type(contribution_t), intent(in) :: effect
         type(equation_t), intent(in) :: equation
         real(wp), intent(in) :: size_guess(2)
         !! of theta and theta' [rad], [rad/s] or of u and u' [m], [m/s]
         real(wp), intent(out) :: sizes(:)
         !! (states of the effect)
      end subroutine sizes_i

      !> Forces with which an effect resists the displaced frame, or pushes on it where negative.
      function frame_force_i(effect, equation, y) result(force)
         import :: contribution_t, equation_t, wp
         implicit none
         type(contribution_t), intent(in) :: effect
         type(equation_t), intent(in) :: equation
         real(wp), intent(in) :: y(:)
         !! (states)
         real(wp) :: force(2)
         !! over m_w: that the links to the wall pull against; on floors that have states, together
         !! [m/s2]
      end function frame_force_i
   end interface

contains

   !> An interval of the motion comes into force, or the motion has changed within it.
   !>
   !> The only way to set it, so that nobody can forget what depends on it.
   pure subroutine enter_interval(model, state, interval)
      type(model_t), intent(in) :: model
      type(discrete_state_t), intent(inout) :: state
      integer, intent(in) :: interval
      !! as `interval_at` counts

      state%interval = interval
      state%line = line_of(model%motion, interval)
      if (model%has_vertical) state%vertical_line = vertical_line_of(model%motion, interval, &
         state%line)
   end subroutine enter_interval

   !> Interval of the motion that is in force.
   pure integer function interval_of(equation) result(interval)
      type(equation_t), intent(in) :: equation

      interval = equation%state%interval
   end function interval_of

   !> A side of the motion comes into force.
   pure subroutine enter_side(model, state, side)
      type(model_t), intent(in) :: model
      type(discrete_state_t), intent(inout) :: state
      integer, intent(in) :: side
      !! +1 or -1

      state%side = side
      if (.not. allocated(state%coef)) return
      if (model%has_wall) call put_wall_side(model%geometry, side, state%coef(1, first_wall))
      if (model%cable%is_signed) call renew_terms(model, state)
      call renew_effects(model, state, is_side_alone=.true.)
   end subroutine enter_side

   !> Let the loops over lanes follow the side and the branches in force; to be called when a branch
   !> has changed. What followed from the others is forgotten.
   pure subroutine renew_coefficients(model, state)
      type(model_t), intent(in) :: model
      type(discrete_state_t), intent(inout) :: state

      state%uplift_is_known = .false.
      state%bearing_is_known = .false.
      if (.not. allocated(state%coef)) return
      if (model%has_wall) call put_row(wall_coefficients, wall_row(model%geometry, state%side, &
         model%p%R, model%inertia, model%p%g), state%coef(1, first_wall))
      call renew_terms(model, state)
      call renew_effects(model, state)
   end subroutine renew_coefficients

   !> Coefficients of frame and cable.
   pure subroutine renew_terms(model, state)
      type(model_t), intent(in) :: model
      type(discrete_state_t), intent(inout) :: state
      integer :: i

      do i = 1, size(model%scene%terms)
         associate (term => model%scene%terms(i))
            select case (term%effect)
            case (frame_term)
               call put_row(frame_coefficients, [frame_mass(model), &
                  model%p%two_xi_omega, state%frame_slope, state%frame_offset/model%p%R], &
                  state%coef(1, term%coef))
            case (linear_cable_term, straight_cable_term)
               call put_row(cable_coefficients, cable_row(model%cable, state%tendon, &
                  state%side, model%p%g_over_R), state%coef(1, term%coef))
            case default
               ! an effect, below
            end select
         end associate
      end do
   end subroutine renew_terms

   !> Coefficients of further effects.
   pure subroutine renew_effects(model, state, is_side_alone)
      type(model_t), intent(in) :: model
      type(discrete_state_t), intent(inout) :: state
      logical, intent(in), optional :: is_side_alone
      !! nothing else has changed
      logical :: has_sides_alone
      integer :: i

      if (.not. allocated(model%effects)) return
      has_sides_alone = present(is_side_alone)
      if (has_sides_alone) has_sides_alone = is_side_alone
      do i = 1, size(model%effects)
         associate (extra => model%effects(i))
            if (has_sides_alone .and. .not. extra%has_sides) cycle
            if (associated(extra%coefficients)) call extra%coefficients(extra, model, state, &
               state%coef(1, extra%coef:extra%coef + extra%n_coef - 1))
         end associate
      end do
   end subroutine renew_effects

   !> Coefficients of one loop into their columns.
   pure subroutine put_row(n, row, coef)
      integer, intent(in) :: n
      real(wp), intent(in) :: row(n)
      real(wp), intent(inout) :: coef(n)

      coef = row
   end subroutine put_row

   !> Does anything act beyond wall, frame, cable and their kinematics?
   pure logical function has_further_effects(equation)
      type(equation_t), intent(in) :: equation

      has_further_effects = allocated(equation%effects)
      if (has_further_effects) has_further_effects = .not. all(equation%effects%is_kinematic)
   end function has_further_effects

   !> Ground acceleration of the interval in force [m/s2].
   real(wp) function ground(equation, t)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      !! [s]

      associate (line => equation%state%line)
         if (line%is_straight) then
            ground = line%a_0 + line%slope*(t - line%t_0)
         else
            ground = acceleration(equation%motion, equation%state%interval, t)
         end if
      end associate
   end function ground

   !> Vertical ground acceleration of the interval in force, positive upward [m/s2].
   real(wp) function vertical_ground(equation, t)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      !! [s]

      associate (line => equation%state%vertical_line)
         if (line%is_straight) then
            vertical_ground = line%a_0 + line%slope*(t - line%t_0)
         else
            vertical_ground = vertical_acceleration(equation%motion, equation%state%interval, t)
         end if
      end associate
   end function vertical_ground

   !> Kinematics at a rotation.
   pure type(kinematics_t) function kinematics_at(equation, theta, side) result(kin)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: theta
      !! [rad]
      integer, intent(in), optional :: side
      !! +1 or -1; the one in force
      integer :: which

      which = equation%state%side
      if (present(side)) which = side
      kin = kinematics_of(equation%geometry, which, which*theta)
   end function kinematics_at

   !> Cable on a side.
   type(cable_state_t) function cable_at(equation, theta, side) result(cable)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: theta
      !! [rad]
      integer, intent(in), optional :: side
      !! +1 or -1; the one in force
      integer :: which

      which = equation%state%side
      if (present(side)) which = side
      call equation%cable_law(equation%cable, equation%state%tendon, equation%p%sin_alpha, &
         which*theta, which, cable)
   end function cable_at

   !> How far the ground acceleration exceeds what the resting wall bears on one side [m/s2]:
   !> positive means lift-off, negative that the wall is pressed down (paper's Eq. (8) at
   !> theta = 0).
   pure real(wp) function lift_off_drive(equation, side, interval, t) result(drive)
      type(equation_t), intent(in) :: equation
      integer, intent(in) :: side
      !! +1 or -1
      integer, intent(in) :: interval
      !! of the motion
      real(wp), intent(in) :: t
      !! [s]

      drive = -side*equation%push_gain*acceleration(equation%motion, interval, t) &
         - equation%state%uplift_acceleration(side)
      if (equation%has_vertical) then
         drive = drive - equation%weight_share*(1 - side*equation%state%lean) &
            *vertical_acceleration(equation%motion, interval, t)
      end if
   end function lift_off_drive

   !> The same on both sides.
   pure function lift_off_drives(equation, interval, t) result(drive)
      type(equation_t), intent(in) :: equation
      integer, intent(in) :: interval
      !! of the motion
      real(wp), intent(in) :: t
      !! [s]
      real(wp) :: drive(2)
      !! on the negative and on the positive side [m/s2]
      real(wp) :: push

      push = equation%push_gain*acceleration(equation%motion, interval, t)
      drive(1) = push - equation%state%uplift_acceleration(-1)
      drive(2) = -push - equation%state%uplift_acceleration(1)
      if (equation%has_vertical) drive = drive - equation%weight_share*(1 - equation%state%lean &
         *[-1, 1])*vertical_acceleration(equation%motion, interval, t)
   end function lift_off_drives

   !> Displacement of the frame u_s on a side [m].
   pure real(wp) function frame_displacement(model, side, y) result(u_s)
      class(model_t), intent(in) :: model
      integer, intent(in) :: side
      !! +1 or -1
      real(wp), intent(in) :: y(:)
      !! (states)

      u_s = straight_displacement(model, side, y(1))
      if (model%beam%n > 0) u_s = u_s + cos(y(1))*tip_deflection(model%beam, y)
   end function frame_displacement

   !> Displacement of the frame u_s beside a wall that does not bend [m].
   pure real(wp) function straight_displacement(model, side, theta) result(u_s)
      class(model_t), intent(in) :: model
      integer, intent(in) :: side
      !! +1 or -1
      real(wp), intent(in) :: theta
      !! [rad]; bare frame: the displacement itself [m]

      if (model%has_wall) then
         u_s = side*model%p%R*displacement_of(model%geometry, side, side*theta)
      else
         u_s = theta
      end if
   end function straight_displacement

   !> Displacement and velocity of the frame on a side.
   pure subroutine frame_motion(model, side, y, u_s, u_s_dot)
      class(model_t), intent(in) :: model
      integer, intent(in) :: side
      !! +1 or -1
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp), intent(out) :: u_s
      !! [m]
      real(wp), intent(out) :: u_s_dot
      !! [m/s]
      type(kinematics_t) :: kin

      u_s = y(1)
      u_s_dot = y(2)
      if (.not. model%has_wall) return
      kin = kinematics_of(model%geometry, side, side*y(1))
      u_s = side*model%p%R*kin%u
      u_s_dot = model%p%R*kin%j*y(2)
      if (model%beam%n == 0) return
      associate (w => tip_deflection(model%beam, y))
         u_s = u_s + cos(y(1))*w
         u_s_dot = u_s_dot + cos(y(1))*tip_rate(model%beam, y) - sin(y(1))*w*y(2)
      end associate
   end subroutine frame_motion

   !> Acceleration of the frame relative to the ground [m/s2].
   pure real(wp) function frame_acceleration(model, side, y, y_dot) result(u_s_ddot)
      class(model_t), intent(in) :: model
      integer, intent(in) :: side
      !! +1 or -1
      real(wp), intent(in) :: y(:), y_dot(:)
      !! (states) and their rates; without `&bending` the first two are enough
      type(kinematics_t) :: kin

      u_s_ddot = y_dot(2)
      if (.not. model%has_wall) return
      kin = kinematics_of(model%geometry, side, side*y(1))
      u_s_ddot = model%p%R*(kin%j*y_dot(2) + side*kin%k*y(2)**2)
      if (model%beam%n == 0) return
      associate (w => tip_deflection(model%beam, y), w_dot => tip_rate(model%beam, y), &
         sine => sin(y(1)), cosine => cos(y(1)))
         u_s_ddot = u_s_ddot + cosine*(tip_rate(model%beam, y_dot) - w*y(2)**2) &
            - sine*(2*w_dot*y(2) + w*y_dot(2))
      end associate
   end function frame_acceleration

   !> Displacement of the frame per small rotation [m/rad]; 1 for the bare frame.
   pure real(wp) function frame_travel(model) result(travel)
      class(model_t), intent(in) :: model

      travel = 1
      if (model%has_wall) travel = 2*model%p%R*model%p%cos_alpha
   end function frame_travel

   !> A rocking wall has one corner that moves, at the arm 2b; a hinged one two with half the arm
   !> and so half the moment [-].
   pure real(wp) function corner_share(model)
      class(model_t), intent(in) :: model

      corner_share = merge(1.0_wp, 0.5_wp, model%has_impacts)
   end function corner_share

   !> Mass of the frame over that of the wall; 1 for the bare frame [-].
   pure real(wp) function frame_mass(model)
      class(model_t), intent(in) :: model

      frame_mass = 1
      if (model%has_wall) frame_mass = model%p%gamma
   end function frame_mass

end module rwmf_model_equation
