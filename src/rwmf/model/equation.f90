!> Scene of an equation of motion: the model, which is fixed once assembled, and the discrete state.
!> The functions evaluate quantities that follow from both at a given rotation.
module rwmf_model_equation
   use rwmf_core_kinds, only: i8, wp
   use rwmf_model_beam, only: beam_t, tip_deflection, tip_rate
   use rwmf_model_elements, only: axis_row, chord_row, element_force, element_t, &
      line_rows, of_cable, rise_row, sum_of_moments
   use rwmf_model_kinematics, only: displacement_of, geometry_t, kinematics_of, kinematics_t, &
      put_wall_side, wall_row
   use rwmf_model_lanes, only: frame_coefficients, wall_coefficients
   use rwmf_model_parameters, only: parameters_t
   use rwmf_model_scene, only: axis_term, chord_term, elsewhere, first_wall, force_parts_t, &
      frame_term, line_term, rise_term, scene_t
   use rwmf_model_spring, only: branch_t, spring_t
   use rwmf_motion_ground_motion, only: acceleration, line_of, line_t, motion_t, &
      vertical_acceleration, vertical_line_of
   implicit none
   private

   public :: equation_t, model_t, discrete_state_t
   public :: contribution_t, floors_t, hysteresis_t, motion_signs_t, sprung_t, window_t
   public :: enter_interval, interval_of, enter_side, renew_coefficients, renew_effects
   public :: vertical_ground, has_further_effects
   public :: ground, kinematics_at, cable_state_t, cable_at, cable_force_at
   public :: uplift_demand, uplift_demands
   public :: frame_displacement, straight_displacement
   public :: tip_displacement, tip_velocity, tip_acceleration
   public :: frame_acceleration, frame_motion, frame_travel, frame_mass, has_elements, has_tendons

   !> Effect beyond wall, frame and cable: its lane loop, states, energy, power and force on the
   !> wall (developer/adding-an-effect.md).
   type :: contribution_t
      logical :: is_present = .false.
      !! the case contains the effect
      real(wp), allocatable :: constants(:)
      !! case data for its procedures, each constant in its unit
      procedure(coefficients_i), pointer, nopass :: coefficients => null()
      !! computes the coefficients of its loop; null if it has no loop
      integer :: n_coef = 0
      !! number of coefficients
      integer :: coef = 1
      !! column of its first coefficient
      integer :: n = 0
      !! number of its parts (floors)
      integer :: law = 0
      !! law of its loop
      logical :: has_sides = .false.
      !! its coefficients depend on the side of the motion
      logical :: is_kinematic = .false.
      !! it changes the kinematics that other loops read
      logical :: has_corner_at_turn = .false.
      !! its law has a corner at theta' = 0, where the integrator restarts
      procedure(energy_i), pointer, nopass :: energy => null()
      !! energy that it stores; null if it stores none
      procedure(frame_energy_i), pointer, nopass :: frame_energy => null()
      !! energy that it adds to that of an elastic frame with a single mass; null if none
      integer :: acts = elsewhere
      !! path of its force to the wall (constants of rwmf_model_scene)
      procedure(frame_force_i), pointer, nopass :: frame_force => null()
      !! force on the frame, called only for reactions; null if there is none
      integer :: states = 0
      !! number of its states; `add` sets their rates
      procedure(sizes_i), pointer, nopass :: sizes => null()
      !! expected sizes of its states
      integer :: first = 0
      !! index of its first state, or of the first state that it reads
      integer :: reads = 0
      !! number of states of another effect that its loop reads and whose rates it changes
      integer :: drifts = 0
      !! number of drifts with limits that end the run
      procedure(drifts_i), pointer, nopass :: put_drifts => null()
      !! computes these drifts
      procedure(land_i), pointer, nopass :: land => null()
      !! changes its states at an impact; null if they are continuous
   end type contribution_t

   !> Smooth Bouc-Wen hysteresis of the frame.
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
      !! index of z in the states
      real(wp) :: force_at_z1 = 0
      !! force at z = 1 over m_s [m/s2]
      integer :: factors = 0
      !! exponent n if it is a small natural number, so that |z|**n is a product; else 0
   end type hysteresis_t

   !> Signs in the current phase of motion, and their effect on smooth hysteresis.
   type :: motion_signs_t
      integer :: loading_direction = 1
      !! sign of theta', or of u_i' - u_(i-1)' for a storey; 0 before the first motion
      integer :: sense = 1
      !! sign of z
      real(wp) :: lost = 1
      !! coefficient of |z|**n [-]. It is 1 while |z| grows and 1 - 2 beta while |z| falls. It takes
      !! the sign of z where z**n replaces |z|**n and n is odd.
   end type motion_signs_t

   !> Floors of a frame from the ground to the roof, with all modes or condensed to one mode.
   type :: floors_t
      real(wp) :: excited_mass_ratio = 1
      !! mass of the frame excited by the ground motion, over the moving mass [-]
      real(wp) :: mass = 0
      !! part of the floor mass that does not move with the roof, over m_w; without a wall over the
      !! roof mass [-]
      logical :: are_linked = .false.
      !! every floor is linked to the wall, rigidly or by a spring, not only the roof
      real(wp) :: base_shear_ratio = 1
      !! shear of the lowest storey over the resisting force at the roof [-]
      real(wp) :: max_frequency = 0
      !! largest frequency of floors with states [rad/s]
      integer :: n = 0
      !! number of storeys with all modes; if 0 the following components are not allocated
      integer :: free = 0
      !! number of floors with states: n - 1 below a linked roof, n with link springs
      real(wp), allocatable :: k_link(:)
      !! (n) stiffness of the link springs over m_w [1/s2]; not allocated with rigid links
      real(wp), allocatable :: share(:)
      !! (n) height of each floor over that of the wall, with link springs [-]
      real(wp), allocatable :: m(:)
      !! (n) mass of each floor over m_w; without a wall over that of the roof [-]
      real(wp), allocatable :: k(:)
      !! (n) stiffness of the storey below over the same mass [1/s2]
      real(wp), allocatable :: c(:, :)
      !! (n, n) damping over the same mass [1/s]
      real(wp), allocatable :: height(:)
      !! (n) height of each storey [m]
      integer :: first = 3
      !! index of their first state
      integer :: n_storeys = 0
      !! number of storeys with a displacement (`storey_motion`); 1 if the frame beside a bending
      !! wall yields as one spring at the roof
      logical :: yields = .false.
      !! the storeys yield; if not, the following components are not allocated
      type(spring_t), allocatable :: springs(:)
      !! (storeys) spring of each storey; forces over the same mass
      type(hysteresis_t), allocatable :: laws(:)
      !! (storeys) law of each storey with smooth hysteresis; forces over the same mass
      real(wp) :: unit = 1
      !! reference mass of m, in the mass unit of the case [-]
   end type floors_t

   !> Spring with memory, and its place in the scene.
   type :: sprung_t
      type(spring_t) :: spring
      !! its force per unit m_w (frame: m_s) [m/s2], its elongation in m
      integer :: element = 0
      !! number of its vertical element; 0 for a spring between ground and frame
      real(wp) :: share = 0
      !! share of the frame's stiffness [-]
      real(wp) :: ends(2, -1:1) = 0
      !! elongations of an element at its turn before `angle_limit` and at that limit, by side [m]
   end type sprung_t

   !> Range of rotations in which the active branches are valid on a side.
   type :: window_t
      logical :: is_known = .false.
      real(wp) :: low = -huge(1.0_wp)
      !! lower limit [rad]; bare frame, displacement [m]
      real(wp) :: high = huge(1.0_wp)
      !! upper limit [rad] or [m]
      logical :: ends_at_peak = .false.
      !! a spring is yielding and unloads when the motion reverses
   end type window_t

   !> Current interval, side and branches, and the values derived from them. The components are
   !> plain values, so an assignment saves or restores the state.
   type :: discrete_state_t
      integer, private :: interval = 0
      !! interval of the motion; `interval_of` returns it, `enter_interval` sets it
      type(line_t) :: line
      !! line of the horizontal motion in that interval
      type(line_t) :: vertical_line
      !! line of the vertical motion in that interval
      integer :: side = 1
      !! sign of theta in the current flight
      type(motion_signs_t) :: signs
      !! signs of the frame until the next peak
      type(branch_t), allocatable :: springs(:)
      !! (springs) branches of the yielding frame and of the vertical elements
      logical, allocatable :: is_beyond(:)
      !! (springs) elements whose stroke has turned on the way from the base; not allocated if none
      !! can
      type(branch_t), allocatable :: storey_branches(:)
      !! (floors) branch of each storey
      type(motion_signs_t), allocatable :: storey_signs(:)
      !! (floors) signs of each storey with smooth hysteresis
      real(wp) :: frame_offset = 0
      !! force of the yielding frame over m_s, on the active branch at zero displacement [m/s2]
      real(wp) :: frame_slope = 0
      !! stiffness of the active branch over m_s [1/s2]
      real(wp) :: low = -huge(1.0_wp)
      !! smallest rotation (bare frame: displacement) at which the active branches hold [rad]
      real(wp) :: high = huge(1.0_wp)
      !! largest rotation at which the active branches hold [rad]
      logical :: ends_at_peak = .false.
      !! a spring is yielding and unloads when the motion reverses
      type(window_t) :: windows(-1:1)
      !! low, high and ends_at_peak by side, valid until a branch changes
      logical :: uplift_is_known = .false.
      !! the next two components are valid until a branch changes
      real(wp) :: uplift_acceleration(-1:1) = 0
      !! ground acceleration at uplift of the resting wall by side (+1: theta > 0), see
      !! `rwmf_model_system_lift_off` [m/s2]
      real(wp) :: lean = 0
      !! how far a bent wall's weight leans to the right, over b [-]
      real(wp) :: inertia_at_rest = 1
      !! inertia of the wall and all coupled masses at theta = 0, over m_w R**2 [-]
      logical :: capacity_is_known = .false.
      !! the following component is valid until a branch changes
      real(wp), allocatable :: uplift_capacity(:, :)
      !! (2, 2:states) uplift acceleration to the right and to the left. Column 2 holds the value
      !! with all further states zero; the other columns hold its increase per unit of each state.
      real(wp), allocatable :: coef(:, :)
      !! (1, coefficients) coefficients of the lane loops, see `renew_coefficients`
   end type discrete_state_t

   !> Uplift of the resting wall, as far as it does not depend on the state.
   type :: uplift_t
      real(wp) :: threshold = 0
      !! ground acceleration at uplift without further effects [m/s2]
      real(wp) :: weight_share = 0
      !! change of the threshold per vertical ground acceleration [-]
      real(wp) :: push_gain = 1
      !! moment of the ground acceleration on the wall over that on a rigid wall [-]
   end type uplift_t

   !> One scene and its ground motion, as assembled once.
   type :: model_t
      type(parameters_t) :: p
      !! parameters with the symbols of the paper; those of absent effects are zero
      type(uplift_t) :: uplift
      !! uplift of the resting wall
      logical :: effects_act_at_rest = .false.
      !! further effects act on the resting wall
      type(geometry_t) :: geometry
      real(wp) :: inertia = 4.0_wp/3
      !! inertia of the wall about its pivot over m_w R**2 [-]
      type(floors_t) :: floors
      !! floors of `&storeys`
      type(beam_t) :: beam
      !! modes of `&bending`
      type(hysteresis_t) :: hysteresis
      !! hysteresis law of the frame
      logical :: has_loading_direction = .false.
      !! rates depend on the sign of theta'
      real(wp) :: creep = 0
      !! velocity below which a wall on its base counts as resting [rad/s]. It is 0 unless the law
      !! of an effect has a corner at theta' = 0. Such an effect may hold the wall up to that
      !! velocity.
      logical :: moves_at_rest = .false.
      !! further states change while the wall rests
      logical :: has_wall
      logical :: has_impacts
      !! the wall rocks on its corners
      logical :: has_frame
      logical :: has_cable
      integer :: n = 2
      !! number of states
      type(element_t), allocatable :: elements(:)
      !! vertical elements of the wall, those of the cable first
      logical :: has_sides = .false.
      !! their arms or forces depend on the side of the motion
      integer :: walls = 1
      !! number of equal walls that share the frame
      type(contribution_t), allocatable :: effects(:)
      !! further effects of the case; not allocated if there are none
      logical :: has_bilinear_springs = .false.
      !! the scene has springs that yield or break
      logical :: may_hold = .false.
      !! springs of fuses, couplings or restraints may hold the wall up
      type(sprung_t), allocatable :: springs(:)
      !! springs of the yielding frame, then of the vertical elements
      real(wp) :: angle_limit = 0
      !! largest |theta| at which elongations of the springs are evaluated [rad]
      logical :: has_vertical = .false.
      !! the ground motion has a vertical component
      type(motion_t), pointer :: motion => null()
      type(scene_t) :: scene
      !! lane loops of the scene
      type(force_parts_t) :: parts
      !! lane loops grouped by the path of their forces
   end type model_t

   !> Equation of motion of one scene in the current phase of motion.
   type, extends(model_t) :: equation_t
      type(discrete_state_t) :: state
      integer(i8) :: rhs_evaluations = 0
   end type equation_t

   !> Force of the cable and its moment against phi, over m_w g and m_w g R.
   type :: cable_state_t
      real(wp) :: force
      !! sum of all tendons [-]
      real(wp) :: moment
      !! [-]
      real(wp) :: moment_1
      !! derivative of the moment by phi [1/rad]
   end type cable_state_t

   abstract interface
      !> Compute the coefficients of an effect's loop on the current side and the active branches.
      pure subroutine coefficients_i(effect, model, state, coef)
         import :: contribution_t, discrete_state_t, model_t, wp
         implicit none
         type(contribution_t), intent(in) :: effect
         type(model_t), intent(in) :: model
         type(discrete_state_t), intent(in) :: state
         real(wp), intent(out) :: coef(:)
         !! (n_coef)
      end subroutine coefficients_i

      !> Energy stored by an effect [J/kg].
      real(wp) function energy_i(effect, equation, y)
         import :: contribution_t, equation_t, wp
         implicit none
         type(contribution_t), intent(in) :: effect
         type(equation_t), intent(in) :: equation
         real(wp), intent(in) :: y(:)
         !! (states)
      end function energy_i

      !> Kinetic and strain energy of the frame, in addition to those of a single mass on an elastic
      !> spring [J/kg].
      function frame_energy_i(effect, equation, y) result(energy)
         import :: contribution_t, equation_t, wp
         implicit none
         type(contribution_t), intent(in) :: effect
         type(equation_t), intent(in) :: equation
         real(wp), intent(in) :: y(:)
         !! (states)
         real(wp) :: energy(2)
      end function frame_energy_i

      !> Compute the ratios of drifts to their limits, and the rates of these ratios.
      subroutine drifts_i(effect, equation, y, ratio, rate)
         import :: contribution_t, equation_t, wp
         implicit none
         type(contribution_t), intent(in) :: effect
         type(equation_t), intent(in) :: equation
         real(wp), intent(in) :: y(:)
         !! (states)
         real(wp), intent(out) :: ratio(:)
         !! (drifts of the effect) signed ratio; the run ends at -1 and 1 [-]
         real(wp), intent(out) :: rate(:)
         !! (drifts of the effect) [1/s]
      end subroutine drifts_i

      !> Change the velocities of an effect's states at an impact, by its balance of momentum.
      subroutine land_i(effect, equation, y, after, stays)
         import :: contribution_t, equation_t, wp
         implicit none
         type(contribution_t), intent(in) :: effect
         type(equation_t), intent(in) :: equation
         !! on the side before the impact
         real(wp), intent(inout) :: y(:)
         !! (states) at theta = 0, with theta' before the impact
         real(wp), intent(inout) :: after
         !! theta' after the impact; on input from the velocity factor [rad/s]
         logical, intent(inout) :: stays
         !! both corners stay on the base: theta' after the impact is 0; on entry: whatever the
         !! momentum
      end subroutine land_i

      !> Expected sizes of an effect's states, for absolute tolerances.
      subroutine sizes_i(effect, equation, size_guess, sizes)
         import :: contribution_t, equation_t, wp
         implicit none
         type(contribution_t), intent(in) :: effect
         type(equation_t), intent(in) :: equation
         real(wp), intent(in) :: size_guess(2)
         !! sizes of theta and theta' [rad], [rad/s] or of u and u' [m], [m/s]
         real(wp), intent(out) :: sizes(:)
         !! (states of the effect)
      end subroutine sizes_i

      !> Forces with which an effect resists the displaced frame; negative forces push it.
      function frame_force_i(effect, equation, y) result(force)
         import :: contribution_t, equation_t, wp
         implicit none
         type(contribution_t), intent(in) :: effect
         type(equation_t), intent(in) :: equation
         real(wp), intent(in) :: y(:)
         !! (states)
         real(wp) :: force(2)
         !! forces over m_w [m/s2]. The first acts against the links to the wall; the second is the
         !! total on floors with states.
      end function frame_force_i
   end interface

contains

   !> Enter an interval of the motion, or update the current one after the motion has changed.
   !>
   !> Only this procedure sets the private interval, which keeps its derived values consistent.
   pure subroutine enter_interval(model, state, interval)
      type(model_t), intent(in) :: model
      type(discrete_state_t), intent(inout) :: state
      integer, intent(in) :: interval
      !! number of the interval, as in `interval_at`

      state%interval = interval
      state%line = line_of(model%motion, interval)
      if (model%has_vertical) state%vertical_line = vertical_line_of(model%motion, interval, &
         state%line)
   end subroutine enter_interval

   !> Current interval of the motion.
   pure integer function interval_of(equation) result(interval)
      type(equation_t), intent(in) :: equation

      interval = equation%state%interval
   end function interval_of

   !> Enter a side of the motion and update the coefficients that depend on it.
   pure subroutine enter_side(model, state, side)
      type(model_t), intent(in) :: model
      type(discrete_state_t), intent(inout) :: state
      integer, intent(in) :: side
      !! +1 or -1

      state%side = side
      if (.not. allocated(state%coef)) return
      if (model%has_wall) call put_wall_side(model%geometry, side, state%coef(1, first_wall))
      if (allocated(state%is_beyond)) state%is_beyond = .false.
      if (model%has_sides) call renew_terms(model, state)
      call renew_effects(model, state, is_side_alone=.true.)
   end subroutine enter_side

   !> Update the coefficients of the lane loops for the current side and branches. Call it after a
   !> change of a branch. Values derived from the previous branches become invalid.
   pure subroutine renew_coefficients(model, state)
      type(model_t), intent(in) :: model
      type(discrete_state_t), intent(inout) :: state

      state%uplift_is_known = .false.
      state%capacity_is_known = .false.
      if (.not. allocated(state%coef)) return
      if (model%has_wall) call put_row(wall_coefficients, wall_row(model%geometry, state%side, &
         model%p%R, model%inertia, model%p%g), state%coef(1, first_wall))
      call renew_terms(model, state)
      call renew_effects(model, state)
   end subroutine renew_coefficients

   !> Update the coefficients of frame and vertical elements.
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
            case (axis_term)
               call put_row(term%n_coef, axis_row(model%elements, state%springs, state%side, &
                  model%p%R), state%coef(1, term%coef))
            case (line_term)
               call put_row(term%n_coef, line_rows(model%elements, state%springs, state%side, &
                  model%p%R), state%coef(1, term%coef))
            case (chord_term)
               call put_row(term%n_coef, chord_row(model%elements, state%springs, state%side, &
                  model%p%R), state%coef(1, term%coef))
            case (rise_term)
               call put_row(term%n_coef, rise_row(model%elements, state%springs, state%side, &
                  model%p%R), state%coef(1, term%coef))
            case default
               ! `renew_effects` updates the effects
            end select
         end associate
      end do
   end subroutine renew_terms

   !> Update the coefficients of further effects.
   pure subroutine renew_effects(model, state, is_side_alone)
      type(model_t), intent(in) :: model
      type(discrete_state_t), intent(inout) :: state
      logical, intent(in), optional :: is_side_alone
      !! only the side has changed
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

   !> Copy the coefficients of one loop to their columns.
   pure subroutine put_row(n, row, coef)
      integer, intent(in) :: n
      real(wp), intent(in) :: row(n)
      real(wp), intent(inout) :: coef(n)

      coef = row
   end subroutine put_row

   !> True if the scene has effects beyond wall, frame, a cable on the axis and their kinematics.
   pure logical function has_further_effects(equation)
      type(equation_t), intent(in) :: equation

      has_further_effects = .false.
      if (has_elements(equation)) has_further_effects = any(equation%elements%group /= of_cable &
         .or. abs(equation%elements%offset) > 0)
      if (has_further_effects) return
      has_further_effects = allocated(equation%effects)
      if (has_further_effects) has_further_effects = .not. all(equation%effects%is_kinematic)
   end function has_further_effects

   !> Ground acceleration in the current interval [m/s2].
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

   !> Vertical ground acceleration in the current interval, positive upward [m/s2].
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
      !! +1 or -1; by default the current side
      integer :: which

      which = equation%state%side
      if (present(side)) which = side
      kin = kinematics_of(equation%geometry, which, which*theta)
   end function kinematics_at

   !> State of the cable on a side: the sum of all tendons.
   pure type(cable_state_t) function cable_at(equation, theta, side) result(cable)
      class(equation_t), intent(in) :: equation
      real(wp), intent(in) :: theta
      !! [rad]
      integer, intent(in), optional :: side
      !! +1 or -1; by default the current side
      integer :: which

      cable = cable_state_t(0, 0, 0)
      if (.not. equation%has_cable) return
      which = equation%state%side
      if (present(side)) which = side
      associate (p => equation%p, moment => sum_of_moments(equation%elements, [of_cable], &
         equation%state%springs, which, which*theta))
         cable = cable_state_t(cable_force_at(equation, theta, which), moment(1)/(p%g*p%R), &
            moment(2)/(p%g*p%R))
      end associate
   end function cable_at

   !> Force of all tendons over m_w g on a side [-].
   pure real(wp) function cable_force_at(equation, theta, side) result(force)
      class(equation_t), intent(in) :: equation
      real(wp), intent(in) :: theta
      !! [rad]
      integer, intent(in) :: side
      !! +1 or -1
      integer :: i

      force = 0
      if (.not. equation%has_cable) return
      do i = 1, size(equation%elements)
         if (equation%elements(i)%group /= of_cable) exit
         force = force + element_force(equation%elements(i), equation%state%springs, side, &
            side*theta, 0.0_wp)/equation%p%g
      end do
   end function cable_force_at

   !> Uplift demand on one side: ground acceleration beyond the uplift acceleration of the resting
   !> wall [m/s2]. A positive value means lift-off, a negative one contact (paper's Eq. (8) at theta
   !> = 0).
   pure real(wp) function uplift_demand(equation, side, interval, t) result(drive)
      type(equation_t), intent(in) :: equation
      integer, intent(in) :: side
      !! +1 or -1
      integer, intent(in) :: interval
      !! of the motion
      real(wp), intent(in) :: t
      !! [s]

      drive = -side*equation%uplift%push_gain*acceleration(equation%motion, interval, t) &
         - equation%state%uplift_acceleration(side)
      if (equation%has_vertical) then
         drive = drive - equation%uplift%weight_share*(1 - side*equation%state%lean) &
            *vertical_acceleration(equation%motion, interval, t)
      end if
   end function uplift_demand

   !> Uplift demand on both sides.
   pure function uplift_demands(equation, interval, t) result(drive)
      type(equation_t), intent(in) :: equation
      integer, intent(in) :: interval
      !! of the motion
      real(wp), intent(in) :: t
      !! [s]
      real(wp) :: drive(2)
      !! demand on the negative and on the positive side [m/s2]
      real(wp) :: push

      push = equation%uplift%push_gain*acceleration(equation%motion, interval, t)
      drive(1) = push - equation%state%uplift_acceleration(-1)
      drive(2) = -push - equation%state%uplift_acceleration(1)
      if (equation%has_vertical) drive = drive - equation%uplift%weight_share &
         *(1 - equation%state%lean*[-1, 1])*vertical_acceleration(equation%motion, interval, t)
   end function uplift_demands

   !> Displacement of the frame u_s on a side [m].
   pure real(wp) function frame_displacement(model, side, y) result(u_s)
      class(model_t), intent(in) :: model
      integer, intent(in) :: side
      !! +1 or -1
      real(wp), intent(in) :: y(:)
      !! (states)

      u_s = straight_displacement(model, side, y(1))
      if (model%beam%n > 0) u_s = u_s + tip_displacement(model, y)
   end function frame_displacement

   !> Displacement of the frame u_s beside a wall that does not bend [m].
   pure real(wp) function straight_displacement(model, side, theta) result(u_s)
      class(model_t), intent(in) :: model
      integer, intent(in) :: side
      !! +1 or -1
      real(wp), intent(in) :: theta
      !! [rad]; bare frame, the displacement itself [m]

      if (model%has_wall) then
         u_s = side*model%p%R*displacement_of(model%geometry, side, side*theta)
      else
         u_s = theta
      end if
   end function straight_displacement

   !> Compute displacement and velocity of the frame on a side.
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
      u_s = u_s + tip_displacement(model, y)
      u_s_dot = u_s_dot + tip_velocity(model, y)
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
      if (model%beam%n > 0) u_s_ddot = u_s_ddot + tip_acceleration(model, y, y_dot)
   end function frame_acceleration

   !> Horizontal displacement of the wall's top due to its deflection [m].
   pure real(wp) function tip_displacement(model, y) result(u)
      class(model_t), intent(in) :: model
      !! with `&bending`
      real(wp), intent(in) :: y(:)
      !! (states)

      u = cos(y(1))*tip_deflection(model%beam, y)
   end function tip_displacement

   !> Rate of `tip_displacement` [m/s].
   pure real(wp) function tip_velocity(model, y) result(v)
      class(model_t), intent(in) :: model
      !! with `&bending`
      real(wp), intent(in) :: y(:)
      !! (states)

      v = cos(y(1))*tip_rate(model%beam, y) - sin(y(1))*tip_deflection(model%beam, y)*y(2)
   end function tip_velocity

   !> Second rate of `tip_displacement` [m/s2].
   pure real(wp) function tip_acceleration(model, y, y_dot) result(a)
      class(model_t), intent(in) :: model
      !! with `&bending`
      real(wp), intent(in) :: y(:), y_dot(:)
      !! (states) and their rates

      associate (w => tip_deflection(model%beam, y), w_dot => tip_rate(model%beam, y), &
         sine => sin(y(1)), cosine => cos(y(1)))
         a = cosine*(tip_rate(model%beam, y_dot) - w*y(2)**2) - sine*(2*w_dot*y(2) + w*y_dot(2))
      end associate
   end function tip_acceleration

   !> Displacement of the frame per small rotation [m/rad]; 1 for the bare frame.
   pure real(wp) function frame_travel(model) result(travel)
      class(model_t), intent(in) :: model

      travel = 1
      if (model%has_wall) travel = 2*model%p%R*model%p%cos_alpha
   end function frame_travel

   !> True if a tendon has a memory: it can yield, go slack or break.
   pure logical function has_tendons(model)
      class(model_t), intent(in) :: model

      has_tendons = .false.
      if (has_elements(model)) has_tendons = any(model%elements%group == of_cable &
         .and. model%elements%spring > 0)
   end function has_tendons

   !> True if the wall has vertical elements.
   pure logical function has_elements(model)
      class(model_t), intent(in) :: model

      has_elements = allocated(model%elements)
   end function has_elements

   !> Mass of the frame over that of the wall; 1 for the bare frame [-].
   pure real(wp) function frame_mass(model)
      class(model_t), intent(in) :: model

      frame_mass = 1
      if (model%has_wall) frame_mass = model%p%gamma
   end function frame_mass

end module rwmf_model_equation
