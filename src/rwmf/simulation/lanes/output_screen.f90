!> Screen for steps of a batch of lanes that certainly contain no extremum of reactions and demands.
module rwmf_simulation_lanes_output_screen
   use rwmf_core_kinds, only: wp
   use rwmf_integrator_lane_columns, only: of_calm, of_fastest_demand, of_frequency, &
      of_interval, of_known, of_limit, of_middle, of_plain, of_time, of_trial
   use rwmf_integrator_lane_screens, only: least_so_far, screen_one => screen_steps, so_far, &
      value_count
   use rwmf_model_equation, only: ground, vertical_ground
   use rwmf_model_system_demands_loop, only: demand_constants, section_terms, sections
   use rwmf_model_system_reactions_loop, only: demand, low_normal, reaction_count
   use rwmf_motion_ground_motion, only: turning_point
   use rwmf_simulation_lanes_batch, only: lane_state_t, batch_t
   use rwmf_simulation_recorder_demand_extremes, only: lanes_find, put_constants
   use rwmf_simulation_recorder_peak_search, only: has_search
   use rwmf_simulation_recorder_reaction_extremes, only: extremes_for_lanes
   implicit none
   private

   public :: begin_screen, restart_screen, note_extremes, screen_outputs

contains

   !> Initialise the screen for a lane with a new piece; data of its last step are no longer valid.
   subroutine restart_screen(lane, i, batch)
      type(lane_state_t), intent(in) :: lane
      integer, intent(in) :: i
      !! number of the lane in the batch
      type(batch_t), intent(inout) :: batch

      batch%table(i, of_plain) = 1
      batch%table(i, of_calm) = 1
      if (.not. batch%is_screened) return
      batch%table(i, of_known) = 0
      call note_extremes(lane, i, batch)
   end subroutine restart_screen

   !> Initialise the screen for a new run of a lane.
   subroutine begin_screen(lane, i, batch)
      type(lane_state_t), intent(in) :: lane
      integer, intent(in) :: i
      !! number of the lane in the batch
      type(batch_t), intent(inout) :: batch

      if (.not. allocated(batch%values)) call choose_screen(lane, batch)
      if (batch%screen%has_reactions) batch%table(i, of_frequency) = lane%recorder%forces%frequency
      if (.not. batch%screen%has_demands) return
      batch%table(i, of_fastest_demand) = lane%recorder%demands%frequency
      call put_constants(lane%recorder%demands, batch%constants(i, :))
   end subroutine begin_screen

   !> Set up the screen for the requested outputs of the lanes, which share one scene.
   subroutine choose_screen(lane, batch)
      type(lane_state_t), intent(in) :: lane
      type(batch_t), intent(inout) :: batch
      integer :: q

      associate (screen => batch%screen, recorder => lane%recorder, equation => lane%equation)
         allocate (screen%has_search(reaction_count), source=.false.)
         screen%has_reactions = allocated(recorder%forces)
         if (screen%has_reactions) screen%has_search = recorder%forces%leader(:reaction_count) > 0
         screen%has_demands = allocated(recorder%demands)
         if (screen%has_demands) screen%has_demands = any(recorder%demands%leader > 0)
         batch%seeks_demands = screen%has_demands
         if (screen%has_demands) screen%has_demands = lanes_find(recorder%demands, equation)
         if (screen%has_demands) then
            screen%demands = recorder%demands%list
            screen%has_search = [screen%has_search, (has_search(recorder%demands, q), q=1, &
               size(recorder%demands%largest))]
         end if
         screen%n = size(screen%has_search)
         screen%columns = screen%n + merge(sections*section_terms, 0, screen%has_demands)
         screen%is_used = [screen%has_search, spread(screen%demands%has_sections, 1, &
            screen%columns - screen%n)]
         ! the quotient |H|/N is bounded by N and itself
         screen%is_used(low_normal) = any(screen%has_search([low_normal, demand]))
         batch%is_screened = any(screen%has_search) .or. batch%seeks_demands
         allocate (batch%values(batch%width, screen%columns, value_count), source=0.0_wp)
         allocate (batch%constants(batch%width, demand_constants(screen%demands)), &
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
         call extremes_for_lanes(lane%recorder%forces, batch%values(i, :reaction_count, so_far), &
            batch%values(i, :reaction_count, least_so_far))
      end if
      if (batch%screen%has_demands) then
         associate (values => batch%values(i, reaction_count + 1:batch%screen%n, :))
            values(:, so_far) = lane%recorder%demands%level
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
   subroutine screen_outputs(lanes, batch)
      type(lane_state_t), intent(in) :: lanes(:)
      type(batch_t), intent(inout) :: batch
      real(wp) :: t
      integer :: i

      if (.not. batch%is_screened) return
      batch%table(:, of_plain) = 0
      batch%table(:, of_calm) = 0
      associate (parts => lanes(1)%equation%parts, last => batch%pair%stages)
         if (.not. parts%is_complete) return
         batch%table(:, of_middle:of_middle + 1) = (batch%ground(:, 1, :) + batch%ground(:, last, &
            :))/2
         do i = 1, batch%width
            if (.not. batch%has_curves .or. .not. batch%is_busy(i)) cycle
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
      if (batch%seeks_demands .and. .not. batch%screen%has_demands) batch%table(:, of_calm) = 0
      do i = 1, batch%width
         ! the next step covers values that grow up to the end, if it continues from there
         if (.not. abs(batch%table(i, of_calm) - 0.5_wp) < 0.25_wp) cycle
         if (.not. continues(i, batch)) batch%table(i, of_calm) = 0
      end do
      if (.not. batch%has_curves) return
      do i = 1, batch%width
         if (.not. batch%is_busy(i)) cycle
         associate (table => batch%table)
            t = turning_point(lanes(i)%equation%motion, int(table(i, of_interval)), &
               table(i, of_time))
            if (t < table(i, of_time) + table(i, of_trial)) table(i, [of_plain, of_calm]) = 0
         end associate
      end do
   end subroutine screen_outputs

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

end module rwmf_simulation_lanes_output_screen
