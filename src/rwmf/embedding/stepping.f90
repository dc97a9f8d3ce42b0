!> One rocking wall-moment frame inside the time loop of a host program.
!>
!> The host creates an instance from a case and passes the ground acceleration piece by piece to
!> advance it. `query_state`, `query_forces` and `query_events` return the response. The host saves
!> and restores the state to repeat a rejected step. Any number of instances may exist, in any
!> threads; there is no other state. A call that fails changes nothing.
!>
!> With `taylor` and `dop853` the result is bitwise independent of the division of a motion into
!> calls, provided that the divisions are at knots. The history of CVODE cannot be saved, so both
!> saving and restoring restart it. A repeated step is therefore bitwise identical to the rejected
!> one.
module rwmf_embedding_stepping
   use rwmf_core_error, only: err_input, error_t, fail
   use rwmf_core_kinds, only: i8, wp
   use rwmf_embedding_ranges, only: a_time, any_number, is_number, is_time, positive, &
      require_number
   use rwmf_embedding_wall_instance, only: advance_instance, copy_base, hold_ground_acceleration, &
      restore_state, save_state, snapshot_t, start_instance, start_on_base, use_host_motion, &
      wall_instance_t
   use rwmf_simulation_base_base_record, only: of_theta, of_u
   use rwmf_simulation_base_base_run, only: base_motion_t
   use rwmf_simulation_factory, only: new_integrator
   use rwmf_model_equation, only: cable_force_at, frame_acceleration, frame_motion
   use rwmf_model_floor_motion, only: storey_motion
   use rwmf_model_floors_floor_forces, only: column_shears, forces_of_linked_floors, link_pulls, &
      resistance
   use rwmf_model_hysteresis_spring_set, only: uneven_plastic_part
   use rwmf_model_system_assembly, only: build_equation, enter_interval, rates_at
   use rwmf_model_system_contributions, only: effects_frame_force
   use rwmf_model_system_reactions, only: plastic_part
   use rwmf_motion_ground_motion, only: follow_ground, follow_samples, ground_t, interval_at, &
      interval_end, motion_from_case, motion_t
   use rwmf_problem_case, only: case_t
   use rwmf_problem_group_values, only: has_key
   use rwmf_problem_record, only: upward_group
   use rwmf_problem_rules, only: fail_key
   use rwmf_problem_single_run, only: check_single_run
   use rwmf_simulation_state_hybrid_state, only: is_at_rest, mode_collapsed, mode_overturned
   use rwmf_simulation_state_result, only: event_t
   use rwmf_text_strings, only: real_to_text
   implicit none
   private

   public :: stepping_t, snapshot_t
   public :: create_stepping, destroy_stepping, advance_stepping, save_stepping, restore_stepping
   public :: require, stop_at_impacts
   public :: wall_state_t, wall_forces_t, query_state, query_forces, query_events

   !> Handle of a wall. A copy refers to the same wall.
   type :: stepping_t
      type(wall_instance_t), pointer :: instance => null()
   end type stepping_t

   !> Advance to a later time under the motion of the case, samples, or a computed motion.
   interface advance_stepping
      module procedure advance_own
      module procedure advance_samples
      module procedure advance_ground
   end interface advance_stepping

   !> State of a wall. Components that do not apply to the scene are zero.
   type :: wall_state_t
      real(wp) :: t
      !! time of this state: end of the last advance, overturning or collapse [s]
      logical :: at_rest = .false.
      logical :: overturned = .false.
      logical :: collapsed = .false.
      !! a drift exceeded the limit of an effect
      real(wp) :: theta = 0
      !! rotation [rad]
      real(wp) :: theta_dot = 0
      !! [rad/s]
      real(wp) :: theta_ddot = 0
      !! [rad/s2]
      real(wp) :: u_s = 0
      !! displacement of the frame relative to the ground [m]
      real(wp) :: u_s_dot = 0
      !! [m/s]
      real(wp) :: u_s_ddot = 0
      !! [m/s2]
      real(wp) :: u_s_max = 0
      !! largest |u_s| so far [m]
      real(wp) :: theta_max = 0
      !! largest |theta| so far [rad]
      integer(i8) :: impacts = 0
      !! number of impacts so far
      integer(i8) :: lift_offs = 0
      !! number of uplifts so far
      integer(i8) :: steps
      !! steps of the integrator so far
   end type wall_state_t

   !> Forces in N, or without a mass in the case in N per kg of the wall (bare frame: of the frame).
   type :: wall_forces_t
      real(wp) :: link = 0
      !! force of the wall on the frame, positive towards positive u_s [N] or [N/kg]
      real(wp) :: frame_shear = 0
      !! force of the frame's spring and damper, with the sign of u_s [N] or [N/kg]
      real(wp) :: cable = 0
      !! tension [N] or [N/kg]
   end type wall_forces_t

contains

   !> Create a wall (or bare frame) from a case, in its initial state.
   !>
   !> Fails with `err_input` if the case does not allow stepping.
   subroutine create_stepping(stepping, case, error, t_begin, peak)
      type(stepping_t), intent(inout) :: stepping
      !! empty handle, which refers to no wall
      type(case_t), intent(in) :: case
      !! valid; `&output dt`, `&spectrum` and `t_end` are ignored. The other requests of `&output`
      !! cost time, and only `query_outputs` shows their results
      type(error_t), allocatable, intent(out) :: error
      real(wp), intent(in), optional :: t_begin
      !! time of the initial state, 0 by default [s]
      real(wp), intent(in), optional :: peak
      !! expected peak ground acceleration, which sets the absolute tolerance unless `&solver atol`
      !! does. The default is the peak of the case's motion, or g/10 without one [m/s2]

      call check_case(stepping, case, t_begin, peak, error)
      if (allocated(error)) return
      allocate (stepping%instance)
      associate (instance => stepping%instance)
         instance%case = case
         instance%own_motion = motion_from_case(case)
         if (allocated(instance%case%record)) deallocate (instance%case%record)
         if (allocated(instance%case%upward_record)) deallocate (instance%case%upward_record)
         if (allocated(instance%case%output)) then
            associate (output => instance%case%output)
               if (allocated(output%dt)) deallocate (output%dt)
               ! reactions and demands take time: they need a request, without the default of a run
               if (.not. (has_key(case%values, 'output', 'reactions') &
                          .or. allocated(output%limited))) then
                  output%reactions = .false.
                  output%demands = .false.
                  output%envelopes = .false.
               end if
            end associate
         end if
         if (allocated(case%compliant_base)) then
            call start_on_base(stepping%instance, t_begin, error)
         else
            call build_equation(case, instance%own_motion, instance%equation)
            call new_integrator(case%solver%method, instance%integrator)
            call start_instance(stepping%instance, t_begin, peak, error)
         end if
      end associate
      if (allocated(error)) call destroy_stepping(stepping)
   end subroutine create_stepping

   subroutine check_case(stepping, case, t_begin, peak, error)
      type(stepping_t), intent(in) :: stepping
      type(case_t), intent(in) :: case
      real(wp), intent(in), optional :: t_begin
      real(wp), intent(in), optional :: peak
      type(error_t), allocatable, intent(out) :: error

      if (associated(stepping%instance)) then
         call fail(error, err_input, 'this handle holds a wall already: destroy it first')
      else if (allocated(case%solver%accuracy)) then
         call fail(error, err_input, '&solver: accuracy needs the whole motion; give rtol')
      else if (case%solver%method == 'paper') then
         call fail_key(case%values, 'solver', 'method', 'integrates whole runs; a host needs ' &
            //'another method', error)
      else
         call check_single_run(case, error)
      end if
      if (present(t_begin)) call require_number(t_begin, 't_begin', a_time, error)
      if (present(peak)) call require_number(peak, 'peak', positive, error)
   end subroutine check_case

   !> Destroy a wall and free its memory. A second call has no effect.
   subroutine destroy_stepping(stepping)
      type(stepping_t), intent(inout) :: stepping

      if (.not. associated(stepping%instance)) return
      if (allocated(stepping%instance%integrator)) call stepping%instance%integrator%destroy()
      deallocate (stepping%instance)
      stepping%instance => null()
   end subroutine destroy_stepping

   !> Check that a handle refers to a wall. Fails with `err_input`.
   subroutine require(stepping, error)
      type(stepping_t), intent(in) :: stepping
      type(error_t), allocatable, intent(out) :: error

      if (.not. associated(stepping%instance)) then
         call fail(error, err_input, 'no wall: it was never created, or it has been destroyed', &
            'no_wall')
      end if
   end subroutine require

   !> Advance under the motion of the case (none without `&motion`).
   subroutine advance_own(stepping, t, error)
      type(stepping_t), intent(inout) :: stepping
      real(wp), intent(in) :: t
      !! at or after the current time [s]
      type(error_t), allocatable, intent(out) :: error

      call check_target(stepping, t, error)
      if (allocated(error)) return
      associate (instance => stepping%instance)
         if (instance%follows_host .and. .not. allocated(instance%base)) then
            instance%equation%motion => instance%own_motion
            call enter_interval(instance%equation%model_t, instance%equation%state, &
               interval_at(instance%own_motion, instance%t))
            instance%hybrid%must_restart = .true.
         end if
         instance%follows_host = .false.
         call advance_instance(instance, near_knot(instance%own_motion, t), error)
         ! the host counts on by its own time
         if (.not. (allocated(error) .or. instance%hybrid%is_stopped)) instance%t = t
      end associate
   end subroutine advance_own

   !> Return the knot of a motion that a time means, and any other time unchanged [s].
   !>
   !> A host that sums up its steps misses the knots by round-off. Its results have the bits of a
   !> run none the less.
   pure real(wp) function near_knot(motion, t) result(knot)
      type(motion_t), intent(in) :: motion
      real(wp), intent(in) :: t
      !! [s]
      integer :: i, interval

      interval = interval_at(motion, t)
      do i = max(0, interval - 1), interval
         knot = interval_end(motion, i)
         if (abs(knot - t) <= 8*spacing(t)) return
      end do
      knot = t
   end function near_knot

   !> Advance to the last sample under linearly interpolated samples of the ground acceleration.
   !>
   !> If the first value differs from the last one of the previous call, the acceleration jumps.
   subroutine advance_samples(stepping, t, a, error)
      type(stepping_t), intent(inout) :: stepping
      real(wp), intent(in) :: t(:)
      !! (n >= 2) strictly increasing times, beginning with the current time [s]
      real(wp), intent(in) :: a(:)
      !! (n) ground accelerations [m/s2]
      type(error_t), allocatable, intent(out) :: error

      call check_samples(stepping, t, a, error)
      if (.not. allocated(error)) call refuse_vertical(stepping, error)
      if (allocated(error)) return
      associate (instance => stepping%instance)
         call follow_samples(instance%given_motion, t, a)
         call use_host_motion(instance, a(1))
         call advance_instance(instance, t(size(t)), error)
      end associate
   end subroutine advance_samples

   !> Advance under an acceleration that the host computes.
   !>
   !> The acceleration must be smooth between the current time and t. For a resting wall, uplift is
   !> checked at eighths of this interval. Use shorter intervals for a motion that turns more often.
   subroutine advance_ground(stepping, t, ground, error)
      type(stepping_t), intent(inout) :: stepping
      real(wp), intent(in) :: t
      !! at or after the current time [s]
      class(ground_t), intent(in), target :: ground
      !! used during this call only
      type(error_t), allocatable, intent(out) :: error

      call check_target(stepping, t, error)
      if (.not. allocated(error)) call refuse_vertical(stepping, error)
      if (allocated(error)) return
      associate (instance => stepping%instance)
         if (.not. t > instance%t) return
         call require_number(ground%acceleration_at(t), 'ground acceleration', any_number, error)
         call require_number(ground%acceleration_at(instance%t), 'ground acceleration', &
            any_number, error)
         if (allocated(error)) return
         call follow_ground(instance%given_motion, instance%t, t, ground)
         call use_host_motion(instance, ground%acceleration_at(instance%t))
         call advance_instance(instance, t, error)
         ! the host's `ground` may no longer exist at the next call
         if (instance%follows_host) call hold_ground_acceleration(instance)
      end associate
   end subroutine advance_ground

   !> Let every later advance end at its first impact, or not.
   !>
   !> The state is then that after the impact, and its time that of the impact. The next advance
   !> continues from there, with the bits of an advance that was not stopped.
   subroutine stop_at_impacts(stepping, stops, error)
      type(stepping_t), intent(inout) :: stepping
      logical, intent(in) :: stops
      !! true to end every later advance at its first impact
      type(error_t), allocatable, intent(out) :: error
      !! `err_input` if the handle refers to no wall

      call require(stepping, error)
      if (.not. allocated(error)) stepping%instance%hybrid%stops_at_impact = stops
   end subroutine stop_at_impacts

   !> Check that a wall can advance to a time.
   subroutine check_target(stepping, t, error)
      type(stepping_t), intent(in) :: stepping
      real(wp), intent(in) :: t
      type(error_t), allocatable, intent(out) :: error

      call require(stepping, error)
      if (allocated(error)) return
      call require_number(t, 'the time to advance to', a_time, error)
      if (allocated(error)) return
      if (t < stepping%instance%t) then
         call fail(error, err_input, 'cannot advance to t = '//trim(real_to_text(t))//' s from ' &
            //trim(real_to_text(stepping%instance%t))//' s: restore a saved state to go back', &
               'backwards')
      end if
   end subroutine check_target

   !> Refuse a vertical motion that does not follow from the horizontal one.
   !>
   !> A host passes only the horizontal motion. A vertical motion with a ratio follows from it, a
   !> separate vertical record does not.
   subroutine refuse_vertical(stepping, error)
      type(stepping_t), intent(in) :: stepping
      type(error_t), allocatable, intent(out) :: error

      if (.not. allocated(stepping%instance%case%upward)) return
      if (allocated(stepping%instance%case%upward%ratio)) return
      call fail(error, err_input, 'a host hands over the horizontal motion: a case with ' &
         //'&'//upward_group//' takes a ratio to it, or advances under its own motion')
   end subroutine refuse_vertical

   subroutine check_samples(stepping, t, a, error)
      type(stepping_t), intent(in) :: stepping
      real(wp), intent(in) :: t(:)
      real(wp), intent(in) :: a(:)
      type(error_t), allocatable, intent(out) :: error
      integer :: n

      call require(stepping, error)
      if (allocated(error)) return
      n = size(t)
      if (n < 2 .or. size(a) /= n) then
         call fail(error, err_input, 'times and accelerations must be two or more, and as many ' &
            //'of the one as of the other', 'wrong_length')
      else if (.not. (all(is_time(t)) .and. all(is_number(a)))) then
         call fail(error, err_input, 'a time or an acceleration is not a finite number, or too ' &
            //'large to be one', 'not_finite')
      else if (any(t(2:) <= t(:n - 1))) then
         call fail(error, err_input, 'the times do not increase strictly', 'backwards')
      else if (abs(t(1) - stepping%instance%t) > 8*spacing(max(abs(t(1)), abs(t(n))))) then
         call fail(error, err_input, 'the first time is '//trim(real_to_text(t(1))) &
            //' s, expected is the present time, '//trim(real_to_text(stepping%instance%t))//' s', &
            'wrong_time')
      end if
   end subroutine check_samples

   !> Save the current state.
   !>
   !> CVODE restarts in the next call (see above).
   subroutine save_stepping(stepping, snapshot, error)
      type(stepping_t), intent(inout) :: stepping
      type(snapshot_t), intent(out) :: snapshot
      type(error_t), allocatable, intent(out) :: error
      !! `err_input` if the handle refers to no wall

      call require(stepping, error)
      if (allocated(error)) return
      call save_state(stepping%instance, snapshot, goes_on=.true.)
      if (allocated(snapshot%f) .or. allocated(snapshot%base)) return
      stepping%instance%hybrid%must_restart = .true.
      snapshot%hybrid%must_restart = .true.
   end subroutine save_stepping

   !> Restore a state that `save_stepping` saved for this wall, or for one from the same case.
   !>
   !> The list of events becomes empty.
   subroutine restore_stepping(stepping, snapshot, error)
      type(stepping_t), intent(inout) :: stepping
      type(snapshot_t), intent(in) :: snapshot
      type(error_t), allocatable, intent(out) :: error
      !! `err_input` for a handle without a wall, an empty snapshot, or that of another wall

      call require(stepping, error)
      if (allocated(error)) return
      if (.not. snapshot%is_filled) then
         call fail(error, err_input, 'nothing was saved in this snapshot', 'empty_snapshot')
      else if (any(abs(snapshot%identity - stepping%instance%identity) > 0)) then
         call fail(error, err_input, 'the snapshot is that of another wall', 'other_wall')
      end if
      if (allocated(error)) return
      call restore_state(stepping%instance, snapshot)
      if (snapshot%follows_host) call hold_ground_acceleration(stepping%instance)
      stepping%instance%recorder%n_events = 0
   end subroutine restore_stepping

   !> Fill the state of a wall on a base that gives.
   subroutine fill_on_base(instance, state)
      type(wall_instance_t), intent(in) :: instance
      type(wall_state_t), intent(inout) :: state
      type(base_motion_t) :: base

      call copy_base(instance, base)
      associate (of => base%series, extremes => base%record%extremes)
         state%t = base%t
         state%overturned = base%has_overturned
         state%steps = base%steps
         state%theta = of%theta(0)
         state%theta_dot = of%theta_dot(0)
         state%theta_ddot = of%theta_ddot(0)
         state%theta_max = max(extremes(2, of_theta), -extremes(1, of_theta))
         if (base%scene%frame%n == 0) return
         state%u_s = of%x(0) + of%u(0)
         state%u_s_dot = of%x_dot(0) + of%u_dot(0)
         state%u_s_ddot = of%x_ddot(0) + of%u_ddot(0)
         state%u_s_max = max(extremes(2, of_u), -extremes(1, of_u))
      end associate
   end subroutine fill_on_base

   !> Forces of a wall on a base that gives: of all links, of the lowest storey, of the tendon.
   subroutine find_forces_on_base(instance, forces)
      type(wall_instance_t), intent(in) :: instance
      type(wall_forces_t), intent(inout) :: forces
      type(base_motion_t) :: base

      call copy_base(instance, base)
      associate (of => base%series, frame => base%scene%frame)
         forces%link = instance%mass*(frame%mass(1, 1)*of%x_ddot(0) + frame%mass(1, 2) &
            *of%u_ddot(0) + frame%excited(1)*of%ground(0) + of%force(0, 1))
         forces%frame_shear = instance%mass*(of%force(0, 1) + sum(of%force(0, 3:)))
         if (base%scene%has_tendon .and. base%regime%is_taut) forces%cable = instance%mass &
            *base%scene%g*of%tendon(0)
      end associate
   end subroutine find_forces_on_base

   !> Return the state at the current time.
   subroutine query_state(stepping, state, error)
      type(stepping_t), intent(in) :: stepping
      type(wall_state_t), intent(out) :: state
      type(error_t), allocatable, intent(out) :: error
      !! `err_input` if the handle refers to no wall

      call require(stepping, error)
      if (allocated(error)) return
      if (allocated(stepping%instance%base)) then
         call fill_on_base(stepping%instance, state)
         return
      end if
      associate (hybrid => stepping%instance%hybrid, recorder => stepping%instance%recorder)
         state%t = hybrid%t
         state%at_rest = is_at_rest(hybrid)
         state%overturned = hybrid%mode == mode_overturned
         state%collapsed = hybrid%mode == mode_collapsed
         state%impacts = recorder%impacts
         state%lift_offs = recorder%lift_offs
         state%steps = stepping%instance%steps
         if (stepping%instance%equation%has_wall) then
            state%theta_max = max(abs(hybrid%y(1)), recorder%theta_max, -recorder%theta_min)
         end if
      end associate
      call fill_motion(stepping%instance, state)
   end subroutine query_state

   !> Fill in rotation and displacement with their rates.
   subroutine fill_motion(instance, state)
      type(wall_instance_t), intent(in) :: instance
      type(wall_state_t), intent(inout) :: state
      real(wp) :: y_dot(size(instance%hybrid%y))

      associate (equation => instance%equation, y => instance%hybrid%y)
         y_dot = 0
         if (.not. state%at_rest .or. equation%beam%n > 0) call rates_at(equation, &
            instance%hybrid%t, y, y_dot)
         if (state%at_rest) y_dot(2) = 0
         if (.not. equation%has_wall) then
            state%u_s = y(1)
            state%u_s_dot = y(2)
            state%u_s_ddot = y_dot(2)
         else
            state%theta = y(1)
            state%theta_dot = y(2)
            state%theta_ddot = y_dot(2)
            if (equation%has_frame) then
               call frame_motion(equation, equation%state%side, y, state%u_s, state%u_s_dot)
               state%u_s_ddot = frame_acceleration(equation, equation%state%side, y, y_dot)
            end if
         end if
         if (equation%has_frame) state%u_s_max = max(abs(state%u_s), instance%recorder%u_max)
      end associate
   end subroutine fill_motion

   !> Return the forces at the current time.
   !>
   !> The force of rigid links balances the frame's inertia force and the force of its spring and
   !> damper. This applies to a resting wall, too.
   subroutine query_forces(stepping, forces, error)
      type(stepping_t), intent(in) :: stepping
      type(wall_forces_t), intent(out) :: forces
      type(error_t), allocatable, intent(out) :: error
      !! `err_input` if the handle refers to no wall
      type(wall_state_t) :: state
      real(wp) :: frame_mass
      !! [kg]
      real(wp) :: restoring
      !! force of spring and damper on the mass at the link [N]
      real(wp), allocatable :: floor_forces(:)
      !! (floors) resisting forces of `&storeys` with all modes [N]
      real(wp) :: on_frame(2)
      !! forces of effects on the frame over the mass of the wall [m/s2]

      call query_state(stepping, state, error)
      if (allocated(error)) return
      if (allocated(stepping%instance%base)) then
         call find_forces_on_base(stepping%instance, forces)
         return
      end if
      associate (instance => stepping%instance, equation => stepping%instance%equation, &
                 p => stepping%instance%equation%p, y => stepping%instance%hybrid%y)
         frame_mass = instance%mass
         if (equation%has_wall) frame_mass = p%gamma*instance%mass
         if (equation%has_frame) then
            restoring = frame_mass*p%omega_s*(p%omega_s*(state%u_s - plastic_part(equation, y)) &
               + 2*p%xi_s*state%u_s_dot)
            forces%frame_shear = equation%floors%base_shear_ratio*(restoring &
               + frame_mass*p%omega_squared*uneven_plastic_part(equation, y(1)))
         end if
         if (allocated(equation%floors%m)) then
            floor_forces = instance%mass*resistance(equation, y)
            forces%frame_shear = sum(floor_forces)
            restoring = floor_forces(size(floor_forces))
         end if
         if (allocated(equation%beam%floors)) then
            call find_forces_of_linked_floors(instance, state%at_rest, forces)
         else if (allocated(equation%floors%k_link)) then
            forces%link = instance%mass*sum(link_pulls(equation, y))
         else if (equation%floors%are_linked .and. equation%has_wall) then
            ! links at every floor: inertia forces of the floors plus the base shear
            forces%link = &
               instance%mass*(p%gamma*(equation%floors%excited_mass_ratio*state%u_s_ddot &
               + instance%ground) + equation%floors%mass*instance%ground) + forces%frame_shear
         else if (equation%has_frame .and. equation%has_wall) then
            forces%link = frame_mass*(state%u_s_ddot &
               + equation%floors%excited_mass_ratio*instance%ground) + restoring
         end if
         on_frame = effects_frame_force(equation, y)
         if (equation%has_wall) forces%link = forces%link + instance%mass*on_frame(1)
         if (equation%has_cable) then
            forces%cable = instance%mass*p%g*cable_force_at(equation, y(1), equation%state%side)
         end if
      end associate
   end subroutine query_forces

   !> Compute the link force and the force of the lowest storey, for floors linked one by one to a
   !> bending wall.
   subroutine find_forces_of_linked_floors(instance, at_rest, forces)
      type(wall_instance_t), intent(in) :: instance
      logical, intent(in) :: at_rest
      !! both corners of the wall are on the base
      type(wall_forces_t), intent(inout) :: forces
      real(wp) :: y_dot(size(instance%hybrid%y))
      real(wp), dimension(instance%equation%floors%n_storeys) :: shear, d, d_dot

      associate (equation => instance%equation, y => instance%hybrid%y, t => instance%hybrid%t, &
                 linked => instance%equation%beam%floors)
         call rates_at(equation, t, y, y_dot)
         if (at_rest) y_dot(2) = 0
         call storey_motion(equation, equation%state%side, y, d, d_dot)
         shear = column_shears(equation, y) + linked%viscous_time*linked%k*d_dot
         forces%link = -instance%mass*sum(forces_of_linked_floors(equation, t, y, y_dot))
         forces%frame_shear = instance%mass*shear(1)
      end associate
   end subroutine find_forces_of_linked_floors

   !> Return the events of the last advance in order of time.
   subroutine query_events(stepping, events, error)
      type(stepping_t), intent(in) :: stepping
      type(event_t), allocatable, intent(out) :: events(:)
      !! (events)
      type(error_t), allocatable, intent(out) :: error
      !! `err_input` if the handle refers to no wall

      call require(stepping, error)
      if (allocated(error)) return
      associate (recorder => stepping%instance%recorder)
         events = recorder%events(:recorder%n_events)
      end associate
   end subroutine query_events

end module rwmf_embedding_stepping
