!> What stands behind the handle of a wall that a host program advances: scene, integrator, hybrid
!> system, the motion in force, and how its state is taken and put back.
module rwmf_embedding_wall_instance
   use rwmf_model_uplift, only: find_bearing
   use rwmf_problem_case, only: case_t
   use rwmf_core_control, only: control_t
   use rwmf_model_assembly, only: enter_interval, equation_t, interval_of
   use rwmf_core_error, only: error_t
   use rwmf_simulation_hybrid_loop, only: advance_hybrid, begin_hybrid, hybrid_t, mode_overturned
   use rwmf_core_kinds, only: i8, wp
   use rwmf_model_hysteresis_spring_set, only: renew_window
   use rwmf_motion_ground_motion, only: acceleration, follow_samples, motion_t, peak_acceleration, &
      piecewise_linear_motion
   use rwmf_simulation_held_wall, only: hold_wall
   use rwmf_simulation_recorder_recorder, only: create_observer, observer_t
   use rwmf_integrator_one_step, only: one_step_t
   use rwmf_simulation_run, only: guess_size, impact_law, initial_state, tolerances
   use rwmf_model_equation, only: hysteresis_t, sprung_t
   use rwmf_model_hysteresis_bilinear, only: spring_t
   use rwmf_integrator_integrator, only: stepper_t
   use rwmf_model_effects_storeys_yielding_storeys, only: follow_storeys
   implicit none
   private

   public :: machine_t, snapshot_t
   public :: start_machine, follow_host, hold_ground, advance_machine, take, put_back, identity_of

   !> All that belongs to one wall. Lives on the heap, because the integrators point into it.
   type :: machine_t
      type(case_t) :: case
      type(motion_t) :: own_motion
      !! that of the case
      type(motion_t) :: given_motion
      !! what the host says
      logical :: follows_host = .false.
      !! the motion in force is the host's
      type(equation_t) :: equation
      class(stepper_t), allocatable :: stepper
      type(hybrid_t) :: hybrid
      type(observer_t) :: observer
      real(wp) :: t
      !! how far the host has advanced; after overturning the motion ended earlier [s]
      real(wp) :: ground
      !! ground acceleration there [m/s2]
      real(wp) :: mass
      !! of the wall, without one of the frame; 1 when the case does not say [kg]
      integer(i8) :: steps = 0_i8
      !! of the integrator in all calls
   end type machine_t

   !> State of a wall between two calls: plain numbers, may be copied and forgotten at will.
   type :: snapshot_t
      logical :: is_filled = .false.
      real(wp) :: identity(6) = 0
      !! alpha, R, omega_s, gamma: a snapshot of another wall is refused
      logical :: is_one_step = .false.
      logical :: follows_host = .false.
      real(wp) :: t = 0
      real(wp) :: ground = 0
      integer :: mode = 0
      real(wp) :: t_hybrid = 0
      real(wp), allocatable :: y(:)
      !! (states)
      logical :: must_restart = .true.
      type(spring_t) :: tendon
      type(sprung_t), allocatable :: springs(:)
      !! memory of what yields
      type(spring_t), allocatable :: storeys(:)
      !! and of storeys that do
      type(hysteresis_t), allocatable :: laws(:)
      !! signs of their motion where they are smooth
      integer :: interval = 0
      integer :: side = 1
      integer :: course = 1
      type(hysteresis_t) :: hysteresis
      !! with the signs in force
      real(wp) :: extremes(5) = 0
      !! u_max, t_u_max, theta_max, theta_min, theta_dot_max of the observer
      integer(i8) :: counts(4) = 0
      !! impacts, lift-offs, steps, right-hand sides
      real(wp) :: h = 0
      !! step length of a one-step method [s]
      real(wp), allocatable :: f(:)
      !! (states) derivative that it would begin with
   end type snapshot_t

contains

   !> Integrator, hybrid system and observer at their beginning.
   subroutine start_machine(machine, t_begin, peak, error)
      type(machine_t), pointer, intent(in) :: machine
      real(wp), intent(in), optional :: t_begin
      real(wp), intent(in), optional :: peak
      type(error_t), allocatable, intent(out) :: error

      associate (equation => machine%equation, case => machine%case)
         call machine%stepper%create(equation, tolerances(case, equation, &
            size_to_expect(machine, peak)), error)
         if (allocated(error)) return
         machine%t = 0
         if (present(t_begin)) machine%t = t_begin
         machine%mass = 1
         if (allocated(case%wall)) then
            if (allocated(case%wall%m_w)) machine%mass = case%wall%m_w
         end if
         machine%hybrid%restitution = impact_law(case, equation%p%alpha)
         machine%hybrid%overturning_angle = case%model%overturning_angle
         machine%hybrid%rtol = case%solver%rtol
         machine%hybrid%max_steps = case%solver%max_steps
         call begin_hybrid(machine%hybrid, equation, machine%t, initial_state(case, equation))
         machine%ground = acceleration(equation%motion, interval_of(equation), machine%t)
         call create_observer(machine%observer, case, equation, machine%t, machine%hybrid%y, error)
         machine%observer%keeps_events = .true.
      end associate
   end subroutine start_machine

   !> Sizes of theta and theta' that the absolute tolerances belong to.
   function size_to_expect(machine, peak) result(size_guess)
      type(machine_t), pointer, intent(in) :: machine
      real(wp), intent(in), optional :: peak
      real(wp) :: size_guess(2)
      !! [rad], [rad/s]
      real(wp) :: a
      real(wp) :: ratio
      !! of the vertical motion to whatever the host hands over [-]

      a = peak_acceleration(machine%own_motion)
      if (.not. a > 0) a = machine%case%model%g/10
      if (present(peak)) a = peak
      ratio = 0
      if (allocated(machine%case%vertical)) then
         if (allocated(machine%case%vertical%ratio)) ratio = machine%case%vertical%ratio
      end if
      machine%given_motion = piecewise_linear_motion([0.0_wp], [a], ratio)
      machine%equation%motion => machine%given_motion
      size_guess = guess_size(machine%case, machine%equation)
      machine%equation%motion => machine%own_motion
   end function size_to_expect

   !> The motion that the host has just given comes into force at the present time.
   subroutine follow_host(machine, a)
      type(machine_t), pointer, intent(in) :: machine
      real(wp), intent(in) :: a
      !! its first value [m/s2]

      machine%equation%motion => machine%given_motion
      call enter_interval(machine%equation, 1)
      machine%follows_host = .true.
      ! A kink costs a multistep method less than a restart; a jump does not.
      if (abs(a - machine%ground) > 1.0e4_wp*epsilon(a)*max(abs(a), abs(machine%ground))) then
         machine%hybrid%must_restart = .true.
      end if
   end subroutine follow_host

   !> The host's motion stays at its present value until it says more.
   subroutine hold_ground(machine)
      type(machine_t), pointer, intent(in) :: machine

      call follow_samples(machine%given_motion, [machine%t], [machine%ground])
      machine%equation%motion => machine%given_motion
      call enter_interval(machine%equation, 1)
      machine%follows_host = .true.
   end subroutine hold_ground

   !> Let time pass; a failure takes everything back.
   subroutine advance_machine(machine, t, error)
      type(machine_t), pointer, intent(in) :: machine
      real(wp), intent(in) :: t
      !! [s]
      type(error_t), allocatable, intent(out) :: error
      type(control_t) :: nobody
      type(snapshot_t) :: before

      call take(machine, before)
      machine%stepper%steps = 0_i8
      machine%observer%n_events = 0
      call advance_hybrid(machine%hybrid, machine%equation, machine%stepper, machine%observer, t, &
         nobody, error)
      if (allocated(error)) then
         call put_back(machine, before)
         machine%hybrid%must_restart = .true.
         if (machine%follows_host) call hold_ground(machine)
         machine%observer%n_events = 0
         return
      end if
      machine%steps = machine%steps + machine%stepper%steps
      machine%t = t
      if (machine%hybrid%mode /= mode_overturned) then
         machine%ground = acceleration(machine%equation%motion, interval_of(machine%equation), t)
      end if
   end subroutine advance_machine

   subroutine take(machine, snapshot)
      type(machine_t), pointer, intent(in) :: machine
      type(snapshot_t), intent(out) :: snapshot

      snapshot%is_filled = .true.
      snapshot%identity = identity_of(machine%equation)
      snapshot%follows_host = machine%follows_host
      snapshot%t = machine%t
      snapshot%ground = machine%ground
      snapshot%interval = interval_of(machine%equation)
      snapshot%side = machine%equation%side
      snapshot%course = machine%equation%course
      snapshot%hysteresis = machine%equation%hysteresis
      snapshot%tendon = machine%equation%cable%tendon
      if (machine%equation%has_memory) snapshot%springs = machine%equation%springs
      if (allocated(machine%equation%floors%springs)) then
         snapshot%storeys = machine%equation%floors%springs
      end if
      if (allocated(machine%equation%floors%laws)) snapshot%laws = machine%equation%floors%laws
      associate (hybrid => machine%hybrid, observer => machine%observer)
         snapshot%mode = hybrid%mode
         snapshot%t_hybrid = hybrid%t
         snapshot%y = hybrid%y
         snapshot%must_restart = hybrid%must_restart
         snapshot%extremes = [observer%u_max, observer%t_u_max, observer%theta_max, &
            observer%theta_min, observer%theta_dot_max]
         snapshot%counts = [observer%impacts, observer%lift_offs, machine%steps, &
            machine%equation%rhs_evaluations]
      end associate
      select type (method => machine%stepper)
      class is (one_step_t)
         snapshot%is_one_step = .true.
         snapshot%h = method%h
         snapshot%f = method%f1
      class default
         snapshot%is_one_step = .false.
      end select
   end subroutine take

   subroutine put_back(machine, snapshot)
      type(machine_t), pointer, intent(in) :: machine
      type(snapshot_t), intent(in) :: snapshot

      machine%follows_host = snapshot%follows_host
      machine%t = snapshot%t
      machine%ground = snapshot%ground
      if (.not. snapshot%follows_host) machine%equation%motion => machine%own_motion
      call enter_interval(machine%equation, snapshot%interval)
      machine%equation%side = snapshot%side
      machine%equation%course = snapshot%course
      machine%equation%hysteresis = snapshot%hysteresis
      if (machine%equation%moves_at_rest) call hold_wall(machine%equation, .false.)
      machine%equation%cable%tendon = snapshot%tendon
      if (machine%equation%has_memory) then
         machine%equation%springs = snapshot%springs
         call renew_window(machine%equation)
      end if
      if (allocated(machine%equation%floors%laws)) machine%equation%floors%laws = snapshot%laws
      if (allocated(machine%equation%floors%springs)) then
         machine%equation%floors%springs = snapshot%storeys
         call follow_storeys(machine%equation)
      end if
      machine%equation%rhs_evaluations = snapshot%counts(4)
      machine%steps = snapshot%counts(3)
      associate (hybrid => machine%hybrid, observer => machine%observer)
         hybrid%mode = snapshot%mode
         hybrid%t = snapshot%t_hybrid
         hybrid%y(:) = snapshot%y
         hybrid%must_restart = snapshot%must_restart
         observer%u_max = snapshot%extremes(1)
         observer%t_u_max = snapshot%extremes(2)
         observer%theta_max = snapshot%extremes(3)
         observer%theta_min = snapshot%extremes(4)
         observer%theta_dot_max = snapshot%extremes(5)
         observer%impacts = snapshot%counts(1)
         observer%lift_offs = snapshot%counts(2)
         call find_bearing(machine%equation, hybrid%y)
      end associate
      select type (method => machine%stepper)
      class is (one_step_t)
         method%h = snapshot%h
         method%f1(:) = snapshot%f
         method%t1 = snapshot%t_hybrid
         method%y1(:) = snapshot%y
      class default
         machine%hybrid%must_restart = .true.
      end select
   end subroutine put_back

   function identity_of(equation) result(identity)
      type(equation_t), intent(in) :: equation
      real(wp) :: identity(6)

      identity(:4) = [equation%p%alpha, equation%p%R, equation%p%omega_s, equation%p%gamma]
      ! What yields has to find its memory in the snapshot.
      identity(5:) = 0
      if (equation%cable%is_tendon) identity(5) = 1
      if (equation%has_memory) identity(6) = 1 + size(equation%springs)
      if (allocated(equation%floors%springs)) identity(6) = identity(6) + 0.5_wp
      if (allocated(equation%floors%laws)) identity(6) = identity(6) + 0.25_wp
   end function identity_of

end module rwmf_embedding_wall_instance
