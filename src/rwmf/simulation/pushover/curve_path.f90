!> Static path from one equilibrium to the next: steps of the roof, turns and ends of branches,
!> contact of the wall, marks.
!>
!> The displacement of the roof is prescribed. While a rigid wall on its base holds the roof, the
!> moment at its corner is prescribed instead. Where the strength falls so fast that the roof must
!> turn back, the path follows it.
module rwmf_simulation_pushover_curve_path
   use rwmf_core_kinds, only: wp
   use rwmf_model_elements, only: element_t, of_cable, of_coupling, of_fuse
   use rwmf_model_equation, only: discrete_state_t, model_t
   use rwmf_model_floor_motion, only: follows_roof, storey_motion
   use rwmf_model_hysteresis_spring_laws, only: branch_word
   use rwmf_model_hysteresis_spring_set, only: pass_window, renew_window
   use rwmf_model_system_assembly, only: enter_side
   use rwmf_model_system_energy, only: mechanical_energy
   use rwmf_simulation_events_storey_events, only: branch_limits, is_softening, &
      loading_direction_of, pass_storey_limit, storey_word
   use rwmf_simulation_pushover_curve, only: add_mark, mark_length, static_curve_t
   use rwmf_simulation_pushover_curve_row, only: dissipated_energy, record_row
   use rwmf_simulation_pushover_path_events, only: at_collapse, at_decompression, at_landing, &
      at_overturning, at_smooth_yield, at_storey, at_uplift, at_window, find_first_event, &
      no_event, path_event_t
   use rwmf_simulation_pushover_static_scene, only: prescribed_t, control_value, find_equilibrium, &
      find_tangent, follow_positions, loaded_displacements, loaded_slopes, of_load, of_roof, &
      of_uplift, roof_can_move, static_forces, static_scene_t
   use rwmf_simulation_static_rest, only: directions, turn_along, turn_springs
   use rwmf_text_strings, only: integer_to_text
   implicit none
   private

   public :: curve_path_t, begin_path, move_roof

   integer, parameter :: most_halvings = 30

   !> Path through equilibria.
   type :: curve_path_t
      type(static_scene_t) :: scene
      type(static_curve_t) :: curve
      real(wp) :: overturning_angle = 0
      !! [rad]
      logical, allocatable :: has_yielded(:)
      !! (smooth springs) the yield displacement was reached before
      real(wp) :: work = 0
      !! work of the load [J/kg]
      integer :: direction = 1
      !! direction of the present leg
      integer :: sense = 1
      !! direction in which the roof moves; opposite to `direction` where it turns back
      real(wp), allocatable :: rates(:)
      !! (positions) per displacement of the roof [rad/m], [-], or per load
      real(wp) :: load_rate = 0
      !! load per displacement of the roof [1/s2], or 1 [-]
      real(wp) :: moment_step = 0
      !! largest step of the moment at a corner while the wall holds the roof [m2/s2]
      logical :: has_ended = .false.
   end type curve_path_t

contains

   !> Begin a path at rest.
   subroutine begin_path(path)
      type(curve_path_t), intent(inout) :: path
      !! with scene, curve and overturning angle
      real(wp) :: moment(2)
      integer :: i

      allocate (path%has_yielded(size(path%scene%z)), source=.false.)
      allocate (path%rates(size(path%scene%q)))
      if (path%scene%is_held) then
         ! sixteen steps for the moment of the weight, at most 64 for that of weight and tendon
         do i = 1, 2
            moment(i) = control_value(path%scene, prescribed_t(of_uplift, 2*i - 3), path%scene%y, &
               path%scene%load)
         end do
         associate (p => path%scene%equation%p)
            path%moment_step = max(p%g*p%R*p%sin_alpha/16, maxval(abs(moment))/64)
         end associate
      end if
      call renew_window(path%scene%equation%model_t, path%scene%equation%state)
      call record_row(path%scene, path%work, path%curve)
   end subroutine begin_path

   !> Move the roof to a displacement, with equal steps.
   subroutine move_roof(path, u_end, spacing_of_rows, is_complete)
      type(curve_path_t), intent(inout) :: path
      real(wp), intent(in) :: u_end
      !! [m]
      real(wp), intent(in) :: spacing_of_rows
      !! largest distance between rows [m]
      logical, intent(out) :: is_complete
      !! false if the path is longer than the limit of its steps
      integer, parameter :: most = 200
      !! largest number of steps per row, for events
      real(wp), parameter :: reached = 1.0e-13_wp
      !! distance from the goal over the height [-]
      real(wp) :: u_begin, u
      integer :: n, i, k

      u_begin = roof_of(path)
      path%direction = merge(1, -1, u_end > u_begin)
      n = max(1, ceiling(abs(u_end - u_begin)/spacing_of_rows*(1 - epsilon(u))))
      is_complete = .true.
      do i = 1, n
         u = u_begin + (u_end - u_begin)*(real(i, wp)/n)
         if (i == n) u = u_end
         do k = 1, most
            call advance(path, u)
            if (path%has_ended) return
            if (path%direction*(u - roof_of(path)) <= reached*path%curve%height) exit
         end do
         is_complete = k <= most
         if (.not. is_complete) return
      end do
   end subroutine move_roof

   !> Displacement of the roof [m].
   real(wp) function roof_of(path)
      type(curve_path_t), intent(in) :: path
      real(wp) :: u(size(path%scene%pattern))

      u = loaded_displacements(path%scene, path%scene%y)
      roof_of = u(size(u))
   end function roof_of

   !> Advance to the goal, or to the first event on the way.
   subroutine advance(path, goal)
      type(curve_path_t), intent(inout) :: path
      real(wp), intent(in) :: goal
      !! displacement of the roof [m]
      type(prescribed_t) :: control
      type(path_event_t) :: event
      real(wp), allocatable :: y(:)
      real(wp) :: load
      logical :: is_found

      call settle(path, is_found)
      if (is_found) call choose_control(path, goal, control)
      if (is_found) call take_step(path, control, y, load, is_found)
      if (is_found) call stop_at_event(path, control, y, load, event, is_found)
      if (.not. is_found) then
         call end_path(path, 'no_equilibrium')
         return
      end if
      call commit(path, y, load)
      call apply_event(path, event)
   end subroutine advance

   !> End the path at its last row, with a mark.
   subroutine end_path(path, ending)
      type(curve_path_t), intent(inout) :: path
      character(*), intent(in) :: ending

      path%has_ended = .true.
      path%curve%ending = ending
      call add_mark(path%curve, ending)
   end subroutine end_path

   !> Find the rates of the path, and turn the springs that they reverse. Without consistent rates
   !> of the roof in the direction of the leg, it turns back.
   subroutine settle(path, is_found)
      type(curve_path_t), intent(inout) :: path
      logical, intent(out) :: is_found
      type(discrete_state_t) :: kept
      integer :: i

      kept = path%scene%equation%state
      path%sense = path%direction
      do i = 1, 2
         call turn_consistently(path, is_found)
         if (is_found .or. i == 2) return
         path%scene%equation%state = kept
         path%sense = -path%direction
      end do
   end subroutine settle

   !> Turn springs until their directions agree with the rates.
   subroutine turn_consistently(path, is_found)
      type(curve_path_t), intent(inout) :: path
      logical, intent(out) :: is_found
      type(prescribed_t) :: control
      type(discrete_state_t) :: kept
      integer :: i

      kept = path%scene%equation%state
      control = sense_of(path)
      associate (scene => path%scene, model => path%scene%equation%model_t, &
                 state => path%scene%equation%state)
         do i = 1, 2*(size(scene%q) + size(scene%z) + 2)
            call find_tangent(scene, control, path%rates, path%load_rate, is_found)
            if (.not. is_found) return
            call turn_along(model, state, scene%y, scene%v, path%rates, is_found)
            if (is_found) exit
         end do
         ! the rate of a smooth spring at its reversal vanishes, and its sign is round-off
         if (size(scene%z) > 0) is_found = .true.
         if (is_found .and. .not. scene%is_held .and. model%has_impacts) then
            if (abs(scene%y(1)) <= 0) is_found = state%side*path%rates(1) > 0
         end if
         if (is_found) is_found = is_consistent(path, kept)
      end associate
   end subroutine turn_consistently

   !> True if the rates of the storeys agree with their springs.
   !>
   !> No storey that has just begun to unload may move in its previous direction. Where the roof
   !> turns back, a storey on a falling branch must still move in its loading direction.
   logical function is_consistent(path, kept)
      type(curve_path_t), intent(in) :: path
      type(discrete_state_t), intent(in) :: kept
      !! state before the springs were turned
      real(wp), dimension(path%scene%equation%floors%n_storeys) :: d, d_dot
      real(wp) :: y(size(path%scene%y))
      integer :: before, now, i

      is_consistent = path%sense == path%direction
      associate (equation => path%scene%equation, state => path%scene%equation%state)
         if (.not. allocated(equation%floors%springs)) return
         y = path%scene%y
         y(path%scene%v) = path%rates
         call storey_motion(equation, state%side, y, d, d_dot)
         do i = 1, size(d)
            before = loading_direction_of(equation, kept, i)
            now = loading_direction_of(equation, state, i)
            if (before*d_dot(i) > 0 .and. before /= now) then
               is_consistent = .false.
               return
            end if
            is_consistent = is_consistent .or. (is_softening(state, i) .and. now*d_dot(i) > 0)
         end do
      end associate
   end function is_consistent

   !> Choose the quantity that the next step prescribes.
   subroutine choose_control(path, goal, control)
      type(curve_path_t), intent(inout) :: path
      real(wp), intent(in) :: goal
      !! [m]
      type(prescribed_t), intent(out) :: control

      if (.not. roof_can_move(path%scene)) then
         control = prescribed_t(of_uplift, path%direction)
         if (size(path%scene%q) > 1) then
            ! free floors move while the wall holds the roof
            control%target_value = min(0.0_wp, control_value(path%scene, control, path%scene%y, &
               path%scene%load) + path%moment_step)
         end if
      else if (path%sense == path%direction) then
         control = prescribed_t(of_roof, target_value=goal)
      else
         control = prescribed_t(of_roof, target_value=2*roof_of(path) - goal)
      end if
   end subroutine choose_control

   !> Take a step to a prescribed quantity, or a part of it that has a solution.
   subroutine take_step(path, control, y, load, is_found)
      type(curve_path_t), intent(inout) :: path
      type(prescribed_t), intent(inout) :: control
      !! its level is reduced if the step is shortened
      real(wp), allocatable, intent(out) :: y(:)
      !! (states)
      real(wp), intent(out) :: load
      !! [m/s2]
      logical, intent(out) :: is_found
      real(wp) :: from, slope, step
      integer :: i
      real(wp), parameter :: small = 1.0e-6_wp
      real(wp), allocatable :: change(:)

      associate (scene => path%scene)
         from = control_value(scene, control, scene%y, scene%load)
         ! rate of the quantity along the path
         allocate (change(size(scene%y)), source=0.0_wp)
         change(scene%q) = small*path%rates
         slope = (control_value(scene, control, scene%y + change, scene%load + small &
            *path%load_rate) - control_value(scene, control, scene%y - change, scene%load - small &
            *path%load_rate))/(2*small)
         step = control%target_value - from
         do i = 1, most_halvings
            control%target_value = from + step
            y = scene%y
            load = scene%load
            if (abs(slope) > 0) then
               y(scene%q) = y(scene%q) + path%rates*(step/slope)
               load = load + path%load_rate*(step/slope)
            end if
            call find_equilibrium(scene, control, y, load, is_found)
            if (is_found) return
            step = step/2
         end do
      end associate
   end subroutine take_step

   !> Shorten a step to its first turn or event.
   subroutine stop_at_event(path, control, y, load, event, is_found)
      type(curve_path_t), intent(inout) :: path
      type(prescribed_t), intent(in) :: control
      !! quantity prescribed in the step
      real(wp), allocatable, intent(inout) :: y(:)
      !! (states) at the end of the step
      real(wp), intent(inout) :: load
      !! at the end of the step [m/s2]
      type(path_event_t), intent(out) :: event
      logical, intent(out) :: is_found
      integer, parameter :: most = 50
      type(path_event_t) :: other
      integer :: i

      is_found = .true.
      call stop_at_turn(path, control, y, load)
      if (control%kind == of_uplift .and. control%target_value >= 0) then
         event = path_event_t(at_uplift, control, .true., 1.0_wp)
      end if
      do i = 1, most
         call find_first_event(path%scene, path%overturning_angle, path%has_yielded, y, load, other)
         if (other%kind == no_event .or. is_same(other, event)) return
         event = other
         y = path%scene%y + event%part*(y - path%scene%y)
         load = path%scene%load + event%part*(load - path%scene%load)
         call find_equilibrium(path%scene, event%control, y, load, is_found)
         if (.not. is_found) return
      end do
   end subroutine stop_at_event

   !> True if two events are the same.
   pure logical function is_same(one, other)
      type(path_event_t), intent(in) :: one, other

      is_same = one%kind == other%kind .and. one%control%number == other%control%number .and. &
         one%control%effect == other%control%effect .and. abs(one%control%target_value &
         - other%control%target_value) <= 0
   end function is_same

   !> Shorten a step to the point at which a spring on a loading branch reverses.
   subroutine stop_at_turn(path, control, y, load)
      type(curve_path_t), intent(inout) :: path
      type(prescribed_t), intent(in) :: control
      real(wp), allocatable, intent(inout) :: y(:)
      real(wp), intent(inout) :: load
      real(wp), parameter :: resolution = 1.0e-13_wp, least = 1.0e-11_wp
      !! of the fraction of the step [-]
      type(prescribed_t) :: part
      real(wp), allocatable :: y_part(:)
      real(wp) :: load_part, from, low, high, middle
      logical :: is_found

      if (.not. reverses(path, y, load)) return
      from = control_value(path%scene, control, path%scene%y, path%scene%load)
      low = 0
      high = 1
      part = control
      do while (high - low > resolution)
         middle = low + (high - low)/2
         part%target_value = from + middle*(control%target_value - from)
         y_part = path%scene%y + middle*(y - path%scene%y)
         load_part = path%scene%load + middle*(load - path%scene%load)
         call find_equilibrium(path%scene, part, y_part, load_part, is_found)
         if (.not. is_found) return
         if (reverses(path, y_part, load_part)) then
            high = middle
         else
            low = middle
         end if
         ! springs at rest within round-off do not turn
         if (high < least) return
      end do
      y = y_part
      load = load_part
   end subroutine stop_at_turn

   !> True if the rates at a state reverse a spring on a loading branch.
   logical function reverses(path, y, load)
      type(curve_path_t), intent(inout) :: path
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp), intent(in) :: load
      type(prescribed_t) :: control
      type(discrete_state_t) :: kept
      real(wp), allocatable :: rates(:), here(:), moving(:)
      real(wp) :: load_rate, load_here
      integer, allocatable :: before(:)
      logical :: is_found

      reverses = .false.
      associate (scene => path%scene, model => path%scene%equation%model_t)
         before = directions(model, scene%equation%state)
         if (all(before == 0)) return
         control = sense_of(path)
         here = scene%y
         load_here = scene%load
         scene%y = y
         scene%load = load
         allocate (rates(size(scene%q)))
         call find_tangent(scene, control, rates, load_rate, is_found)
         if (is_found) then
            kept = scene%equation%state
            moving = y
            moving(scene%v) = rates
            call turn_springs(model, scene%equation%state, moving)
            reverses = any(before /= 0 .and. before /= directions(model, scene%equation%state))
            scene%equation%state = kept
         end if
         scene%y = here
         scene%load = load_here
      end associate
   end function reverses

   !> Move the scene to the end of a step and record it.
   subroutine commit(path, y, load, held)
      type(curve_path_t), intent(inout) :: path
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp), intent(in) :: load
      !! [m/s2]
      real(wp), intent(in), optional :: held
      !! for a jump between two equilibria: energy stored and dissipated before it [J/kg]
      real(wp) :: spent, work
      real(wp), allocatable :: moved(:)

      moved = y
      call follow_positions(path%scene, moved, spent)
      work = work_of_step(path, moved, load, follows_rates=.not. present(held))
      associate (scene => path%scene)
         path%work = path%work + work
         scene%spent = scene%spent + spent
         scene%y = moved
         scene%load = load
         if (present(held)) scene%released = scene%released + work + held &
            - mechanical_energy(scene%equation, scene%y) - dissipated_energy(scene)
         call record_row(scene, path%work, path%curve)
      end associate
   end subroutine commit

   !> Work of the load over a step [J/kg].
   !>
   !> Between its ends, load and displacement along the load are cubics with their rates at the
   !> ends. A jump, or a step to a state without rates, has straight lines.
   real(wp) function work_of_step(path, y, load, follows_rates) result(work)
      type(curve_path_t), intent(inout) :: path
      !! at the beginning of the step; unchanged on return
      real(wp), intent(in) :: y(:)
      !! (states) at the end
      real(wp), intent(in) :: load
      !! at the end [m/s2]
      logical, intent(in) :: follows_rates
      !! false for a jump
      type(prescribed_t) :: control
      real(wp) :: rates(size(path%rates)), load_rate, moved, push, length, loads(2), moves(2)
      real(wp), allocatable :: before(:)
      logical :: is_found

      associate (scene => path%scene, pattern => path%scene%pattern)
         moved = dot_product(pattern, loaded_displacements(scene, y) &
            - loaded_displacements(scene, scene%y))
         push = load - scene%load
         work = (scene%load + load)/2*moved
         if (.not. follows_rates) return
         control = sense_of(path)
         length = path%sense*(control_value(scene, control, y, load) &
            - control_value(scene, control, scene%y, scene%load))
         loads(1) = length*path%load_rate
         moves(1) = length*dot_product(matmul(pattern, loaded_slopes(scene, scene%y)), path%rates)
         before = scene%y
         scene%y = y
         scene%load = load
         call find_tangent(scene, control, rates, load_rate, is_found)
         scene%y = before
         scene%load = load - push
         if (.not. is_found) return
         loads(2) = length*load_rate
         moves(2) = length*dot_product(matmul(pattern, loaded_slopes(scene, y)), rates)
         work = work + (push*(moves(2) - moves(1)) - moved*(loads(2) - loads(1)))/10 &
            + (loads(2)*moves(1) - loads(1)*moves(2))/60
      end associate
   end function work_of_step

   !> Unit rate of the roof in the present sense; of the load if the wall holds the roof.
   type(prescribed_t) function sense_of(path) result(control)
      type(curve_path_t), intent(in) :: path

      control = prescribed_t(of_roof, target_value=real(path%sense, wp))
      if (.not. roof_can_move(path%scene)) control%kind = of_load
   end function sense_of

   !> Apply an event at the present state.
   subroutine apply_event(path, event)
      type(curve_path_t), intent(inout) :: path
      type(path_event_t), intent(in) :: event

      associate (scene => path%scene, model => path%scene%equation%model_t, &
                 state => path%scene%equation%state, number => event%control%number)
         select case (event%kind)
         case (at_window)
            scene%y(1) = event%control%target_value
            call pass_rotation(path, event%is_rising)
         case (at_storey)
            call pass_storey_limit(model, state, number, event%is_rising)
            call mark_branch(path, spring_name(model, number), storey_word(model, state, number))
            call rebalance(path)
         case (at_landing)
            scene%y(1) = 0
            scene%is_held = .true.
            call add_mark(path%curve, 'contact')
         case (at_uplift)
            scene%is_held = .false.
            call enter_side(model, state, number)
            call renew_window(model, state)
            call add_mark(path%curve, 'uplift')
            if (number /= path%sense) call end_path(path, 'no_contact')
         case (at_decompression)
            call add_mark(path%curve, 'decompression')
         case (at_overturning)
            call end_path(path, 'overturned')
         case (at_collapse)
            call end_path(path, 'collapsed')
         case (at_smooth_yield)
            path%has_yielded(number) = .true.
            if (model%has_loading_direction) then
               call mark_branch(path, 'frame', 'yield')
            else
               call mark_branch(path, spring_name(model, number), 'yield')
            end if
         case default
            ! the step has reached its goal
         end select
      end associate
   end subroutine apply_event

   !> Let the springs that follow the rotation pass the end of their window, and mark new branches.
   subroutine pass_rotation(path, is_rising)
      type(curve_path_t), intent(inout) :: path
      logical, intent(in) :: is_rising
      type(discrete_state_t) :: before
      character(mark_length) :: name
      integer :: i

      associate (model => path%scene%equation%model_t, state => path%scene%equation%state)
         before = state
         call pass_window(model, state, is_rising)
         do i = 1, size(model%springs)
            if (state%springs(i)%kind == before%springs(i)%kind) cycle
            name = 'frame'
            if (model%springs(i)%element > 0) then
               name = element_name(model%elements, model%springs(i)%element, &
                  path%scene%has_offsets)
            else if (count(model%springs%element == 0) > 1) then
               name = 'storey_'//integer_to_text(i)
            end if
            call mark_branch(path, name, branch_word(model%springs(i)%spring, state%springs(i)))
         end do
      end associate
      call rebalance(path)
   end subroutine pass_rotation

   !> Name of a vertical element in marks, with its number unless it is the only one of its group.
   pure function element_name(elements, number, has_offsets) result(name)
      type(element_t), intent(in) :: elements(:)
      integer, intent(in) :: number
      !! number of the element
      logical, intent(in) :: has_offsets
      !! the case gives the places of the fuses
      character(mark_length) :: name
      integer :: k

      associate (group => elements(number)%group)
         k = count(elements(:number)%group == group)
         select case (group)
         case (of_cable)
            name = 'tendon'
         case (of_fuse)
            name = 'fuse'
            if (.not. has_offsets) name = trim(merge('fuse_left ', 'fuse_right', k == 1))
            if (.not. has_offsets) return
         case (of_coupling)
            name = 'coupling'
         case default
            name = 'restraint'
         end select
         if (count(elements%group == group) > 1) name = trim(name)//'_'//integer_to_text(k)
      end associate
   end function element_name

   !> Name of a storey in marks, or of the frame if it yields as one spring at the roof.
   pure function spring_name(model, number) result(name)
      type(model_t), intent(in) :: model
      integer, intent(in) :: number
      !! number of the storey, from the ground up
      character(mark_length) :: name

      name = 'storey_'//integer_to_text(number)
      if (follows_roof(model)) name = 'frame'
   end function spring_name

   !> Mark the beginning of a branch that has a name.
   subroutine mark_branch(path, name, word)
      type(curve_path_t), intent(inout) :: path
      character(*), intent(in) :: name
      character(*), intent(in) :: word
      !! name of the branch, or ''

      if (word /= '') call add_mark(path%curve, trim(name)//'_'//trim(word))
   end subroutine mark_branch

   !> Find the equilibrium at the same displacement of the roof after a force has dropped. Floors
   !> that are free jump; the energy that this releases would move them.
   subroutine rebalance(path)
      type(curve_path_t), intent(inout) :: path
      real(wp), parameter :: round_off = 1.0e-10_wp
      !! unbalanced force over g and a length of 1 m [-]
      integer, parameter :: most = 50
      type(prescribed_t) :: control
      real(wp), allocatable :: y(:)
      real(wp) :: load, held, force(size(path%scene%q))
      logical :: is_found, is_settled, has_landed
      integer :: i

      force = static_forces(path%scene, path%scene%y, path%scene%load)
      if (path%scene%is_held) force(1) = 0
      if (all(abs(force) <= round_off*path%scene%equation%p%g*path%scene%unit)) return
      held = mechanical_energy(path%scene%equation, path%scene%y) + dissipated_energy(path%scene)
      control = prescribed_t(of_roof, target_value=roof_of(path))
      if (.not. roof_can_move(path%scene)) control = prescribed_t(of_load, &
         target_value=path%scene%load)
      has_landed = .false.
      do i = 1, most
         y = path%scene%y
         if (has_landed) y(1) = 0
         load = path%scene%load
         call find_equilibrium(path%scene, control, y, load, is_found)
         if (.not. is_found) exit
         ! a wall that rocks would be below its base
         if (path%scene%equation%has_impacts .and. .not. path%scene%is_held &
            .and. path%scene%equation%state%side*y(1) < -epsilon(1.0_wp)) then
            ! the jump ends on the base
            path%scene%is_held = .true.
            has_landed = .true.
            cycle
         end if
         call follow_jump(path, y, is_settled)
         if (is_settled) exit
      end do
      if (is_found .and. is_settled) then
         call commit(path, y, load, held)
         if (has_landed) call add_mark(path%curve, 'contact')
      else
         call end_path(path, 'no_equilibrium')
      end if
   end subroutine rebalance

   !> Turn springs and pass the limits that a jump reverses or exceeds.
   subroutine follow_jump(path, y, is_settled)
      type(curve_path_t), intent(inout) :: path
      real(wp), intent(in) :: y(:)
      !! (states) after the jump
      logical, intent(out) :: is_settled
      !! no spring has changed its branch
      real(wp), dimension(path%scene%equation%floors%n_storeys) :: d, d_dot
      real(wp) :: low, high
      integer :: i

      associate (scene => path%scene, model => path%scene%equation%model_t, &
                 state => path%scene%equation%state)
         call turn_along(model, state, scene%y, scene%v, y(scene%q) - scene%y(scene%q), is_settled)
         if (.not. allocated(model%floors%springs)) return
         call storey_motion(model, state%side, y, d, d_dot)
         do i = 1, size(d)
            call branch_limits(scene%equation, i, low, high)
            if (d(i) <= high .and. d(i) >= low) cycle
            ! a branch that has just begun ends within round-off of its beginning
            if (max(low - d(i), d(i) - high) <= 1.0e-12_wp*abs(d(i))) cycle
            call pass_storey_limit(model, state, i, d(i) > high)
            call mark_branch(path, spring_name(model, i), storey_word(model, state, i))
            is_settled = .false.
         end do
      end associate
   end subroutine follow_jump

end module rwmf_simulation_pushover_curve_path
