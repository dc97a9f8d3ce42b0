!> Data and state of a wall that a host program advances.
!>
!> An instance has a scene, an integrator, a hybrid system and a current motion. Its state can be
!> saved and restored.
module rwmf_embedding_wall_instance
   use rwmf_core_control, only: control_t
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: i8, wp
   use rwmf_integrator_interface_integrator, only: integrator_t
   use rwmf_integrator_one_step, only: one_step_t
   use rwmf_integrator_taylor, only: taylor_t
   use rwmf_model_equation, only: discrete_state_t, has_elements
   use rwmf_model_impact_rule, only: impact_law
   use rwmf_model_system_assembly, only: enter_interval, equation_t, interval_of
   use rwmf_motion_ground_motion, only: acceleration, follow_samples, interval_at, motion_t, &
      peak_acceleration, piecewise_linear_motion
   use rwmf_problem_case, only: case_t, has_floors
   use rwmf_simulation_advance, only: advance
   use rwmf_simulation_base_base_record, only: of_rate
   use rwmf_simulation_base_base_run, only: advance_on_base, base_motion_t, begin_on_base, &
      expand_present
   use rwmf_simulation_finite_check, only: check_numbers
   use rwmf_simulation_hybrid_hybrid_loop, only: start_hybrid
   use rwmf_simulation_lanes_batch, only: batch_t
   use rwmf_simulation_recorder_recorder, only: create_recorder, has_more_than_peaks, peaks_t, &
      recorder_t
   use rwmf_simulation_run, only: guess_size, initial_state, tolerances
   use rwmf_simulation_state_hybrid_state, only: has_ended, hybrid_state_t, hybrid_t
   implicit none
   private

   public :: wall_instance_t, snapshot_t
   public :: start_instance, start_on_base, use_host_motion, hold_ground_acceleration
   public :: advance_instance, copy_base, save_state, restore_state

   !> Time of a wall, with the numbers that a snapshot keeps unchanged.
   type :: wall_time_t
      real(wp) :: t = 0
      !! time reached by the host; after overturning or collapse the motion ended earlier [s]
      real(wp) :: ground = 0
      !! ground acceleration at this time [m/s2]
      logical :: follows_host = .false.
      !! the current motion is that of the host
      integer(i8) :: steps = 0_i8
      !! steps of the integrator in all calls
      real(wp) :: identity(8) = 0
      !! result of `identity_of`, in mixed units: a snapshot of another wall is refused
   end type wall_time_t

   !> Data of one wall. It is on the heap, because the integrators point into it.
   type, extends(wall_time_t) :: wall_instance_t
      type(case_t) :: case
      type(motion_t) :: own_motion
      !! motion of the case
      type(motion_t) :: given_motion
      !! motion given by the host
      type(equation_t) :: equation
      class(integrator_t), allocatable :: integrator
      type(hybrid_t) :: hybrid
      type(recorder_t) :: recorder
      type(batch_t) :: batch
      !! batch of one lane, for methods that step in lanes
      type(base_motion_t), allocatable :: base
      !! a wall on a base that gives has this in place of equation, integrator and hybrid state
      real(wp) :: mass
      !! mass of the wall, or of a bare frame; 1 if the case gives none [kg]
      type(control_t) :: control
      !! stop flag of the current call
   end type wall_instance_t

   !> State of a wall between two calls. Assignment copies it; it needs no destruction.
   type, extends(wall_time_t) :: snapshot_t
      logical :: is_filled = .false.
      type(base_motion_t), allocatable :: base
      !! allocated for a wall on a base that gives
      type(discrete_state_t) :: state
      type(hybrid_state_t) :: hybrid
      type(peaks_t) :: peaks
      !! maxima and counts of the recorder
      type(recorder_t), allocatable :: recorder
      !! the whole recorder; allocated if it has more than `peaks`
      integer(i8) :: rhs_evaluations = 0
      real(wp) :: h = 0
      !! step length of a one-step method [s]
      real(wp), allocatable :: f(:)
      !! (states) derivative at the beginning of its next step, or largest magnitudes so far of a
      !! Taylor series; not allocated: the method restarts
   end type snapshot_t

contains

   !> Initialise integrator, hybrid system and recorder.
   subroutine start_instance(instance, t_begin, peak, error)
      type(wall_instance_t), pointer, intent(in) :: instance
      real(wp), intent(in), optional :: t_begin
      !! [s]
      real(wp), intent(in), optional :: peak
      !! expected peak ground acceleration, which sets the tolerances. The default is the peak of
      !! the case's motion, or g/10 without one [m/s2]
      type(error_t), allocatable, intent(out) :: error
      !! the integrator cannot be created, or the history does not fit into memory

      associate (equation => instance%equation, case => instance%case)
         instance%identity = identity_of(equation)
         call instance%integrator%create(equation, tolerances(case, equation, &
            size_to_expect(instance, peak)), error)
         if (allocated(error)) return
         instance%t = 0
         if (present(t_begin)) instance%t = t_begin
         instance%mass = 1
         if (allocated(case%wall)) then
            if (allocated(case%wall%m_w)) instance%mass = case%wall%m_w
         else if (.not. has_floors(case) .and. case%unit_mass > 0) then
            instance%mass = case%unit_mass
         end if
         instance%hybrid%restitution = impact_law(case, equation%p%alpha)
         instance%hybrid%overturning_angle = case%model%overturning_angle
         instance%hybrid%rtol = case%solver%rtol
         instance%hybrid%max_steps = case%solver%max_steps
         call start_hybrid(instance%hybrid, equation, instance%t, initial_state(case, equation))
         instance%ground = acceleration(equation%motion, interval_of(equation), instance%t)
         call create_recorder(instance%recorder, case, equation, instance%t, instance%hybrid%y, &
            error)
         instance%recorder%keeps_events = .true.
      end associate
   end subroutine start_instance

   !> Initialise a wall on a base that gives.
   subroutine start_on_base(instance, t_begin, error)
      type(wall_instance_t), pointer, intent(in) :: instance
      real(wp), intent(in), optional :: t_begin
      !! [s]
      type(error_t), allocatable, intent(out) :: error
      !! those of `begin_on_base`

      instance%t = 0
      if (present(t_begin)) instance%t = t_begin
      instance%mass = 1
      if (allocated(instance%case%wall%m_w)) instance%mass = instance%case%wall%m_w
      instance%ground = acceleration(instance%own_motion, interval_at(instance%own_motion, &
         instance%t), instance%t)
      allocate (instance%base, instance%recorder%events(0))
      instance%recorder%n_events = 0
      call begin_on_base(instance%case, instance%t, instance%base, error)
      if (allocated(error)) return
      associate (scene => instance%base%scene)
         instance%identity = [scene%h, scene%b, scene%kappa, scene%delay, scene%eta_slope, &
            sum(scene%frame%m), real(scene%strips, wp), real(size(instance%base%y), wp)]
      end associate
   end subroutine start_on_base

   !> Expected sizes of theta and theta', which scale the absolute tolerances.
   function size_to_expect(instance, peak) result(size_guess)
      type(wall_instance_t), pointer, intent(in) :: instance
      real(wp), intent(in), optional :: peak
      real(wp) :: size_guess(2)
      !! [rad], [rad/s]
      real(wp) :: a
      real(wp) :: ratio
      !! ratio of the vertical motion to the host's motion [-]

      a = peak_acceleration(instance%own_motion)
      if (.not. a > 0) a = instance%case%model%g/10
      if (present(peak)) a = peak
      ratio = 0
      if (allocated(instance%case%upward)) then
         if (allocated(instance%case%upward%ratio)) ratio = instance%case%upward%ratio
      end if
      instance%given_motion = piecewise_linear_motion([0.0_wp], [a], ratio)
      instance%equation%motion => instance%given_motion
      size_guess = guess_size(instance%case, instance%equation)
      instance%equation%motion => instance%own_motion
   end function size_to_expect

   !> Apply the motion just given by the host, from the current time on.
   subroutine use_host_motion(instance, a)
      type(wall_instance_t), pointer, intent(in) :: instance
      real(wp), intent(in) :: a
      !! first value of the ground acceleration [m/s2]

      instance%equation%motion => instance%given_motion
      call enter_interval(instance%equation%model_t, instance%equation%state, 1)
      instance%follows_host = .true.
      ! A kink costs a multistep method less than a restart; a jump costs more.
      if (abs(a - instance%ground) > 1.0e4_wp*epsilon(a)*max(abs(a), abs(instance%ground))) then
         instance%hybrid%must_restart = .true.
      end if
   end subroutine use_host_motion

   !> Hold the ground acceleration at its current value until the host gives another motion.
   subroutine hold_ground_acceleration(instance)
      type(wall_instance_t), pointer, intent(in) :: instance

      call follow_samples(instance%given_motion, [instance%t], [instance%ground])
      instance%equation%motion => instance%given_motion
      call enter_interval(instance%equation%model_t, instance%equation%state, 1)
      instance%follows_host = .true.
   end subroutine hold_ground_acceleration

   !> Advance to a later time. A failure restores the state before the call.
   subroutine advance_instance(instance, t, error)
      type(wall_instance_t), pointer, intent(in) :: instance
      real(wp), intent(in) :: t
      !! [s]
      type(error_t), allocatable, intent(out) :: error
      type(snapshot_t) :: before

      call save_state(instance, before, goes_on=.false.)
      if (allocated(instance%base)) then
         if (instance%follows_host) then
            call advance_base(instance, instance%given_motion, t, error)
         else
            call advance_base(instance, instance%own_motion, t, error)
         end if
         if (.not. allocated(error)) return
         call restore_state(instance, before)
         if (instance%follows_host) call hold_ground_acceleration(instance)
         return
      end if
      instance%integrator%steps = 0_i8
      instance%recorder%n_events = 0
      instance%hybrid%is_stopped = .false.
      call advance(instance%hybrid, instance%equation, instance%integrator, instance%recorder, t, &
         instance%control, instance%batch, error)
      call check_numbers('the state of the wall', instance%hybrid%y, error)
      if (allocated(error)) then
         call restore_state(instance, before)
         instance%hybrid%must_restart = .true.
         if (instance%follows_host) call hold_ground_acceleration(instance)
         instance%recorder%n_events = 0
         return
      end if
      instance%steps = instance%steps + instance%integrator%steps
      instance%t = t
      if (instance%hybrid%is_stopped) instance%t = instance%hybrid%t
      if (.not. has_ended(instance%hybrid)) then
         instance%ground = acceleration(instance%equation%motion, interval_of(instance%equation), &
            instance%t)
      end if
   end subroutine advance_instance

   !> Advance a wall on a base that gives.
   subroutine advance_base(instance, motion, t, error)
      type(wall_instance_t), pointer, intent(in) :: instance
      type(motion_t), intent(in) :: motion
      real(wp), intent(in) :: t
      !! [s]
      type(error_t), allocatable, intent(out) :: error

      call advance_on_base(instance%case, motion, t, instance%control, instance%base, error)
      if (allocated(error)) return
      instance%steps = instance%base%steps
      associate (rates => instance%base%record%extremes(:, of_rate))
         instance%recorder%theta_dot_max = max(rates(2), -rates(1))
      end associate
      instance%t = t
      instance%ground = acceleration(motion, interval_at(motion, t), t)
   end subroutine advance_base

   !> Copy a wall on a base that gives, with the series of its present state.
   subroutine copy_base(instance, base)
      type(wall_instance_t), intent(in) :: instance
      type(base_motion_t), intent(out) :: base

      base = instance%base
      if (instance%follows_host) then
         call expand_present(instance%given_motion, base, base%record)
      else
         call expand_present(instance%own_motion, base, base%record)
      end if
   end subroutine copy_base

   !> Save the current state.
   subroutine save_state(instance, snapshot, goes_on)
      type(wall_instance_t), pointer, intent(in) :: instance
      type(snapshot_t), intent(out) :: snapshot
      logical, intent(in) :: goes_on
      !! a one-step method continues from this state without a restart

      snapshot%is_filled = .true.
      snapshot%wall_time_t = instance%wall_time_t
      if (allocated(instance%base)) then
         snapshot%base = instance%base
         return
      end if
      snapshot%state = instance%equation%state
      snapshot%hybrid = instance%hybrid%hybrid_state_t
      snapshot%peaks = instance%recorder%peaks_t
      if (has_more_than_peaks(instance%recorder)) snapshot%recorder = instance%recorder
      snapshot%rhs_evaluations = instance%equation%rhs_evaluations
      select type (method => instance%integrator)
      class is (one_step_t)
         snapshot%h = method%h
         if (goes_on) snapshot%f = method%f1
      class is (taylor_t)
         snapshot%f = method%largest
      end select
   end subroutine save_state

   !> Restore a state from `save_state`.
   subroutine restore_state(instance, snapshot)
      type(wall_instance_t), pointer, intent(in) :: instance
      type(snapshot_t), intent(in) :: snapshot

      instance%wall_time_t = snapshot%wall_time_t
      if (allocated(snapshot%base)) then
         instance%base = snapshot%base
         return
      end if
      instance%equation%state = snapshot%state
      if (.not. snapshot%follows_host) then
         instance%equation%motion => instance%own_motion
         call enter_interval(instance%equation%model_t, instance%equation%state, &
            interval_of(instance%equation))
      end if
      instance%hybrid%hybrid_state_t = snapshot%hybrid
      if (allocated(snapshot%recorder)) instance%recorder = snapshot%recorder
      instance%recorder%peaks_t = snapshot%peaks
      instance%equation%rhs_evaluations = snapshot%rhs_evaluations
      select type (method => instance%integrator)
      class is (one_step_t)
         method%h = snapshot%h
         if (allocated(snapshot%f)) method%f1(:) = snapshot%f
         method%t1 = snapshot%hybrid%t
         method%y1(:) = snapshot%hybrid%y
      class is (taylor_t)
         method%largest(:) = snapshot%f
         method%t1 = snapshot%hybrid%t
         method%y1(:) = snapshot%hybrid%y
      class default
         instance%hybrid%must_restart = .true.
      end select
   end subroutine restore_state

   !> Numbers that distinguish a newly created wall from others.
   pure function identity_of(equation) result(identity)
      type(equation_t), intent(in) :: equation
      real(wp) :: identity(8)
      integer :: i

      identity(:4) = [equation%p%alpha, equation%p%R, equation%p%omega_s, equation%p%gamma]
      ! A snapshot must have the state of each yielding part and the coefficients of each loop.
      identity(5:6) = 0
      if (has_elements(equation)) identity(5) = size(equation%elements)
      if (equation%has_bilinear_springs) identity(6) = 1 + size(equation%springs)
      if (allocated(equation%floors%springs)) identity(6) = identity(6) + 0.5_wp
      if (allocated(equation%floors%laws)) identity(6) = identity(6) + 0.25_wp
      associate (coef => equation%state%coef(1, :))
         identity(7:) = [real(size(coef), wp), sum([(i*coef(i), i=1, size(coef))])]
      end associate
   end function identity_of

end module rwmf_embedding_wall_instance
