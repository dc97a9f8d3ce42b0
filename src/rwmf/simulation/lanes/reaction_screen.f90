!> Screen for steps of a batch of lanes that certainly contain no extremum of reactions and demands.
module rwmf_simulation_lanes_reaction_screen
   use rwmf_core_kinds, only: wp
   use rwmf_integrator_lane_columns, only: of_calm, of_fastest_demand, of_frequency, &
      of_ground_end, of_interval, of_limit, of_middle, of_next, of_plain, of_time, of_trial
   use rwmf_integrator_lane_reactions, only: at_begin, at_end, find_values, least_so_far, &
      screen_one => screen_steps, so_far, value_count
   use rwmf_model_equation, only: ground, vertical_ground
   use rwmf_model_system_demands_loop, only: demand_constants, section_terms, sections
   use rwmf_model_system_reactions_loop, only: reaction_count
   use rwmf_motion_ground_motion, only: turning_point
   use rwmf_simulation_lanes_batch, only: lane_state_t, batch_t
   use rwmf_simulation_recorder_demand_extremes, only: count_demands, put_constants
   implicit none
   private

   public :: begin_reactions, note_extremes, screen_reactions

contains

   !> Initialise the screen for a lane with a new piece; data of its last step are no longer valid.
   subroutine begin_reactions(lane, i, batch)
      type(lane_state_t), intent(in) :: lane
      integer, intent(in) :: i
      !! number of the lane in the batch
      type(batch_t), intent(inout) :: batch

      batch%table(i, of_plain) = 1
      batch%table(i, of_calm) = 1
      if (.not. allocated(batch%values)) call choose_screen(lane, batch)
      if (.not. batch%screen%is_used) return
      batch%is_known(i) = .false.
      if (batch%screen%has_reactions) batch%table(i, of_frequency) = lane%recorder%forces%frequency
      if (batch%screen%has_demands) then
         batch%table(i, of_fastest_demand) = lane%recorder%demands%frequency
         call put_constants(lane%recorder%demands, batch%constants(i, :))
      end if
      call note_extremes(lane, i, batch)
   end subroutine begin_reactions

   !> Set up the screen for the requested outputs of the lanes, which share one scene.
   subroutine choose_screen(lane, batch)
      type(lane_state_t), intent(in) :: lane
      type(batch_t), intent(inout) :: batch

      associate (screen => batch%screen, recorder => lane%recorder, equation => lane%equation)
         screen%has_reactions = allocated(recorder%forces)
         screen%has_demands = allocated(recorder%demands) .and. equation%parts%is_complete
         screen%is_used = screen%has_reactions .or. allocated(recorder%demands)
         if (screen%has_demands) call count_demands(recorder%demands, equation, screen%floors, &
            screen%drifts, screen%has_demands)
         allocate (screen%is_led(reaction_count), source=.false.)
         if (screen%has_demands) screen%is_led = [screen%is_led, recorder%demands%is_led]
         screen%n = size(screen%is_led)
         screen%columns = screen%n + merge(sections*section_terms, 0, screen%has_demands)
         allocate (batch%values(batch%width, screen%columns, value_count), source=0.0_wp)
         allocate (batch%constants(batch%width, demand_constants(screen%floors, screen%drifts)), &
            source=0.0_wp)
      end associate
   end subroutine choose_screen

   !> Copy the current extrema of a lane.
   subroutine note_extremes(lane, i, batch)
      type(lane_state_t), intent(in) :: lane
      integer, intent(in) :: i
      !! number of the lane in the batch
      type(batch_t), intent(inout) :: batch
      integer :: q

      if (batch%screen%has_reactions) then
         batch%values(i, :reaction_count, so_far) = lane%recorder%forces%largest
         batch%values(i, :reaction_count, least_so_far) = lane%recorder%forces%smallest
      end if
      if (batch%screen%has_demands) then
         associate (values => batch%values(i, reaction_count + 1:batch%screen%n, :))
            values(:, so_far) = lane%recorder%demands%largest
            values(:, least_so_far) = lane%recorder%demands%smallest
         end associate
         associate (n => batch%screen%n)
            ! most of a section force may be static: no margin over its range so far
            do q = 1, sections
               batch%values(i, n + section_terms*(q - 1) + 1:n + section_terms*q, [so_far, &
                  least_so_far]) = batch%values(i, n - sections + q, so_far)
            end do
         end associate
      end if
   end subroutine note_extremes

   !> Screen the trial steps of all lanes for extrema of reactions and demands.
   subroutine screen_reactions(lanes, batch)
      type(lane_state_t), intent(in) :: lanes(:)
      type(batch_t), intent(inout) :: batch
      real(wp) :: t
      integer :: i

      if (.not. batch%screen%is_used) return
      batch%table(:, of_plain) = 0
      batch%table(:, of_calm) = 0
      associate (parts => lanes(1)%equation%parts, last => batch%pair%stages)
         if (.not. parts%is_complete) return
         batch%table(:, of_middle:of_middle + 1) = (batch%ground(:, 1, :) + batch%ground(:, last, &
            :))/2
         do i = 1, batch%width
            if (.not. batch%is_busy(i)) cycle
            if (.not. batch%is_known(i)) call find_begin(lanes(i), i, batch)
            batch%table(i, of_next) = merge(1, 0, continues(i, batch))
            if (.not. batch%has_curves) cycle
            t = batch%table(i, of_time) + batch%table(i, of_trial)/2
            batch%table(i, of_middle) = ground(lanes(i)%equation, t)
            if (lanes(i)%equation%has_vertical) batch%table(i, of_middle + 1) = vertical_ground( &
               lanes(i)%equation, t)
         end do
         if (batch%width == 1) then
            call screen_one(parts, batch%screen, last, batch%constants, batch%coef, batch%y, &
               batch%k, &
               batch%y_new, batch%ground, batch%mark, batch%table, batch%values)
         else
            call batch%kernels%screen_steps(parts, batch%screen, last, batch%constants, &
               batch%coef, &
               batch%y, batch%k, batch%y_new, batch%ground, batch%mark, batch%table, batch%values)
         end if
      end associate
      if (.not. batch%screen%has_demands) then
         do i = 1, batch%width
            if (batch%is_busy(i)) batch%table(i, of_calm) = merge(0, 1, &
               allocated(lanes(i)%recorder%demands))
         end do
      end if
      if (.not. batch%has_curves) return
      do i = 1, batch%width
         if (.not. batch%is_busy(i)) cycle
         associate (table => batch%table)
            t = turning_point(lanes(i)%equation%motion, int(table(i, of_interval)), &
               table(i, of_time))
            if (t < table(i, of_time) + table(i, of_trial)) table(i, [of_plain, of_calm]) = 0
         end associate
      end do
   end subroutine screen_reactions

   !> Return whether the ground motion continues without a jump at the end of a lane's step.
   pure logical function continues(i, batch)
      integer, intent(in) :: i
      !! number of the lane in the batch
      type(batch_t), intent(in) :: batch
      real(wp), parameter :: slack = 1.0e-9_wp
      real(wp) :: since
      integer :: k, next

      associate (table => batch%table, lines => batch%lines, last => batch%pair%stages)
         continues = table(i, of_trial) < table(i, of_limit) - table(i, of_time)
         if (continues) return
         next = min(int(table(i, of_interval)) + 1, ubound(lines, 2))
         if (.not. lines(1, next) > table(i, of_limit)) return
         since = table(i, of_limit) - lines(4, next)
         continues = .true.
         ! without array temporaries, because most steps end at a knot
         do k = 1, 2
            associate (a => batch%ground(i, last, k))
               continues = continues .and. abs(lines(3*k - 1, next) + since*lines(3*k, next) - a) &
                  <= slack*abs(a)
            end associate
         end do
      end associate
   end function continues

   !> Compute the values at the start of the first step of a lane, as if a previous step had ended
   !> there.
   subroutine find_begin(lane, i, batch)
      type(lane_state_t), intent(in) :: lane
      integer, intent(in) :: i
      type(batch_t), intent(inout) :: batch
      real(wp) :: acceleration(1, 2)
      ! not on the stack: the number of coefficients grows with the square of that of the storeys
      real(wp), allocatable, dimension(:, :) :: constants, coef, y, found

      acceleration(1, :) = batch%ground(i, 1, :)
      allocate (constants(1, size(batch%constants, 2)), coef(1, size(batch%coef, 2)))
      allocate (y(1, size(batch%y, 2)), found(1, size(batch%values, 2)))
      constants(1, :) = batch%constants(i, :)
      coef(1, :) = batch%coef(i, :)
      y(1, :) = batch%y(i, :)
      call find_values(lane%equation%parts, batch%screen, constants, coef, y, acceleration, found)
      batch%values(i, :, at_begin) = found(1, :)
      batch%values(i, :, at_end) = found(1, :)
      batch%table(i, of_ground_end:of_ground_end + 1) = acceleration(1, :)
      batch%is_known(i) = .true.
   end subroutine find_begin

end module rwmf_simulation_lanes_reaction_screen
