!> First event between two static states: the end of a branch or of contact, lift-off, a limit.
!>
!> Each candidate is a quantity with a level. The step that passes the level is repeated with the
!> quantity prescribed, which locates the event to round-off.
module rwmf_simulation_pushover_path_events
   use rwmf_core_kinds, only: wp
   use rwmf_simulation_events_storey_events, only: branch_limits
   use rwmf_simulation_pushover_static_scene, only: prescribed_t, control_value, of_decompression, &
      of_drift, of_rotation, of_smooth_frame, of_storey, of_uplift, static_scene_t
   implicit none
   private

   public :: path_event_t, find_first_event
   public :: no_event, at_window, at_storey, at_landing, at_uplift, at_decompression
   public :: at_overturning, at_collapse, at_smooth_yield

   integer, parameter :: no_event = 0
   integer, parameter :: at_window = 1
   !! a spring that follows the rotation ends its branch
   integer, parameter :: at_storey = 2
   !! a storey ends its branch
   integer, parameter :: at_landing = 3
   !! the wall returns to its base
   integer, parameter :: at_uplift = 4
   integer, parameter :: at_decompression = 5
   integer, parameter :: at_overturning = 6
   integer, parameter :: at_collapse = 7
   !! a drift reaches its limit
   integer, parameter :: at_smooth_yield = 8
   !! a smooth spring reaches its yield displacement for the first time

   !> Event of a path.
   type :: path_event_t
      integer :: kind = no_event
      !! one of the `at_` numbers
      type(prescribed_t) :: control
      !! quantity and level
      logical :: is_rising = .true.
      !! the quantity increases
      real(wp) :: part = 2
      !! estimated fraction of the step up to the event [-]
   end type path_event_t

   !> Step between two states.
   type :: static_step_t
      real(wp), allocatable :: y(:)
      !! (states) at the end
      real(wp) :: load = 0
      !! at the end [m/s2]
      type(path_event_t) :: first
      !! first event so far
   end type static_step_t

contains

   !> Find the first event of a step from the state of the scene.
   subroutine find_first_event(scene, overturning_angle, has_yielded, y, load, event)
      type(static_scene_t), intent(inout) :: scene
      real(wp), intent(in) :: overturning_angle
      !! [rad]
      logical, intent(in) :: has_yielded(:)
      !! (smooth springs) the yield displacement was reached before
      real(wp), intent(in) :: y(:)
      !! (states) at the end of the step
      real(wp), intent(in) :: load
      !! at the end of the step [m/s2]
      type(path_event_t), intent(out) :: event
      !! kind `no_event` if there is none
      type(static_step_t) :: step
      integer :: side

      step = static_step_t(y, load)
      if (scene%is_held) then
         do side = -1, 1, 2
            call try_upward(scene, step, at_uplift, prescribed_t(of_uplift, side))
            call try_upward(scene, step, at_decompression, prescribed_t(of_decompression, side))
         end do
      else
         call try_rotations(scene, overturning_angle, step)
      end if
      call try_storeys(scene, step)
      call try_smooth(scene, has_yielded, step)
      call try_drifts(scene, step)
      event = step%first
   end subroutine find_first_event

   !> Try the events of the rotation: landing, windows of the springs, overturning.
   subroutine try_rotations(scene, overturning_angle, step)
      type(static_scene_t), intent(inout) :: scene
      real(wp), intent(in) :: overturning_angle
      type(static_step_t), intent(inout) :: step
      integer :: direction

      associate (equation => scene%equation, state => scene%equation%state)
         ! a leg may end on the base, within round-off
         if (equation%has_impacts .and. state%side*step%y(1) <= epsilon(1.0_wp) &
             .and. state%side*(step%y(1) - scene%y(1)) < 0) call try_level(scene, step, &
            at_landing, prescribed_t(of_rotation, target_value=0.0_wp))
         if (equation%has_bilinear_springs) then
            ! a limit at theta = 0 is out of the range of the other side
            if (step%y(1) > scene%y(1) .and. step%y(1) > state%high) call try_level(scene, step, &
               at_window, prescribed_t(of_rotation, target_value=max(state%high, scene%y(1))))
            if (step%y(1) < scene%y(1) .and. step%y(1) < state%low) call try_level(scene, step, &
               at_window, prescribed_t(of_rotation, target_value=min(state%low, scene%y(1))))
         end if
         if (.not. equation%has_wall) return
         direction = merge(1, -1, step%y(1) > 0)
         if (abs(step%y(1)) >= overturning_angle) call try_level(scene, step, at_overturning, &
            prescribed_t(of_rotation, target_value=direction*overturning_angle))
      end associate
   end subroutine try_rotations

   !> Try the ends of the branches of storeys.
   subroutine try_storeys(scene, step)
      type(static_scene_t), intent(inout) :: scene
      type(static_step_t), intent(inout) :: step
      real(wp) :: before, after, low, high
      integer :: i

      associate (floors => scene%equation%floors)
         if (.not. allocated(floors%springs)) return
         do i = 1, floors%n_storeys
            before = control_value(scene, prescribed_t(of_storey, i), scene%y, scene%load)
            after = control_value(scene, prescribed_t(of_storey, i), step%y, step%load)
            call branch_limits(scene%equation, i, low, high)
            if (after > before .and. after > high) call try_level(scene, step, at_storey, &
               prescribed_t(of_storey, i, target_value=high))
            if (after < before .and. after < low) call try_level(scene, step, at_storey, &
               prescribed_t(of_storey, i, target_value=low))
         end do
      end associate
   end subroutine try_storeys

   !> Try the yield displacements of smooth springs.
   subroutine try_smooth(scene, has_yielded, step)
      type(static_scene_t), intent(inout) :: scene
      logical, intent(in) :: has_yielded(:)
      type(static_step_t), intent(inout) :: step
      type(prescribed_t) :: control
      real(wp) :: after, u_y
      integer :: i

      do i = 1, size(scene%z)
         if (has_yielded(i)) cycle
         if (scene%equation%has_loading_direction) then
            control = prescribed_t(of_smooth_frame, i)
            u_y = scene%equation%hysteresis%u_y
         else
            control = prescribed_t(of_storey, i)
            u_y = scene%equation%floors%laws(i)%u_y
         end if
         after = control_value(scene, control, step%y, step%load)
         control%target_value = sign(u_y, after)
         if (abs(after) >= u_y) call try_level(scene, step, at_smooth_yield, control)
      end do
   end subroutine try_smooth

   !> Try the drifts that end a run.
   subroutine try_drifts(scene, step)
      type(static_scene_t), intent(inout) :: scene
      type(static_step_t), intent(inout) :: step
      type(prescribed_t) :: control
      real(wp) :: after
      integer :: i, j

      if (.not. allocated(scene%equation%effects)) return
      do i = 1, size(scene%equation%effects)
         do j = 1, scene%equation%effects(i)%drifts
            control = prescribed_t(of_drift, j, i)
            after = control_value(scene, control, step%y, step%load)
            control%target_value = sign(1.0_wp, after)
            if (abs(after) >= 1) call try_level(scene, step, at_collapse, control)
         end do
      end do
   end subroutine try_drifts

   !> Try a quantity that passes its level upward.
   subroutine try_upward(scene, step, kind, control)
      type(static_scene_t), intent(inout) :: scene
      type(static_step_t), intent(inout) :: step
      integer, intent(in) :: kind
      type(prescribed_t), intent(in) :: control
      real(wp), parameter :: round_off = 1.0e-12_wp
      !! moment over g times the half width [-]
      real(wp) :: before, after, least

      before = control_value(scene, control, scene%y, scene%load)
      after = control_value(scene, control, step%y, step%load)
      least = round_off*scene%equation%p%g*scene%equation%p%R
      ! a wall that has just landed is at the level of its side
      if (before >= -least .and. kind /= at_uplift) return
      if (after > least .and. after > before) call try_level(scene, step, kind, control)
   end subroutine try_upward

   !> Keep an event if it is the first one so far.
   subroutine try_level(scene, step, kind, control)
      type(static_scene_t), intent(inout) :: scene
      type(static_step_t), intent(inout) :: step
      integer, intent(in) :: kind
      type(prescribed_t), intent(in) :: control
      real(wp) :: before, after, part

      before = control_value(scene, control, scene%y, scene%load)
      after = control_value(scene, control, step%y, step%load)
      part = 0
      if (abs(after - before) > 0) part = (control%target_value - before)/(after - before)
      part = min(max(part, 0.0_wp), 1.0_wp)
      if (part >= step%first%part) return
      step%first = path_event_t(kind, control, after > before, part)
   end subroutine try_level

end module rwmf_simulation_pushover_path_events
