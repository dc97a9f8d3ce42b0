!> Which steps of the lanes of a team plainly hold no extremum of the reactions.
module rwmf_simulation_lanes_reaction_screen
   use rwmf_core_kinds, only: wp
   use rwmf_integrator_lane_columns, only: of_frequency, of_ground_end, of_interval, of_plain, &
      of_time, of_trial
   use rwmf_integrator_lane_reactions, only: at_begin, at_end, least_so_far, screen_one => &
      screen_steps, so_far
   use rwmf_model_reactions_loop, only: lane_reactions
   use rwmf_motion_ground_motion, only: turning_point
   use rwmf_simulation_lanes_team, only: lane_t, team_t
   use rwmf_simulation_recorder_reaction_estimates, only: fastest_of
   implicit none
   private

   public :: begin_reactions, note_extremes, screen_reactions

contains

   !> A lane begins anew: what is known of its last step no longer holds.
   subroutine begin_reactions(lane, i, team)
      type(lane_t), intent(in) :: lane
      integer, intent(in) :: i
      !! number of the lane in the team
      type(team_t), intent(inout) :: team

      team%table(i, of_plain) = 1
      team%screens = allocated(lane%recorder%forces)
      if (.not. team%screens) return
      team%is_known(i) = .false.
      team%table(i, of_frequency) = fastest_of(lane%equation)
      call note_extremes(lane, i, team)
   end subroutine begin_reactions

   !> The extrema of a lane so far.
   subroutine note_extremes(lane, i, team)
      type(lane_t), intent(in) :: lane
      integer, intent(in) :: i
      !! number of the lane in the team
      type(team_t), intent(inout) :: team

      if (.not. team%screens) return
      team%reactions(i, :, so_far) = lane%recorder%forces%largest
      team%reactions(i, :, least_so_far) = lane%recorder%forces%smallest
   end subroutine note_extremes

   !> Ask all lanes, by the reactions at both ends of the steps that they have tried.
   subroutine screen_reactions(lanes, team)
      type(lane_t), intent(in) :: lanes(:)
      type(team_t), intent(inout) :: team
      integer :: i

      if (.not. team%screens) return
      team%table(:, of_plain) = 0
      associate (parts => lanes(1)%equation%parts, last => team%pair%stages)
         if (.not. parts%is_complete) return
         do i = 1, team%width
            if (team%is_busy(i) .and. .not. team%is_known(i)) call find_begin(lanes(i), i, team)
         end do
         if (team%width == 1) then
            call screen_one(parts, last, team%coef, team%y_new, team%ground, team%mark, &
               team%table, team%reactions)
         else
            call team%kernels%screen_steps(parts, last, team%coef, team%y_new, team%ground, &
               team%mark, team%table, team%reactions)
         end if
      end associate
      if (.not. team%has_curves) return
      do i = 1, team%width
         if (.not. team%is_busy(i)) cycle
         associate (table => team%table)
            if (turning_point(lanes(i)%equation%motion, int(table(i, of_interval)), &
               table(i, of_time)) < table(i, of_time) + table(i, of_trial)) table(i, of_plain) = 0
         end associate
      end do
   end subroutine screen_reactions

   !> The reactions at the beginning of the first step of a lane, as if one before had come to them.
   subroutine find_begin(lane, i, team)
      type(lane_t), intent(in) :: lane
      integer, intent(in) :: i
      type(team_t), intent(inout) :: team
      real(wp) :: ground(1, 2), coef(1, size(team%coef, 2)), y(1, size(team%y, 2))
      real(wp) :: found(1, size(team%reactions, 2))

      ground(1, :) = team%ground(i, 1, :)
      coef(1, :) = team%coef(i, :)
      y(1, :) = team%y(i, :)
      call lane_reactions(lane%equation%parts, coef, y, ground, found)
      team%reactions(i, :, at_begin) = found(1, :)
      team%reactions(i, :, at_end) = found(1, :)
      team%table(i, of_ground_end:of_ground_end + 1) = ground(1, :)
      team%is_known(i) = .true.
   end subroutine find_begin

end module rwmf_simulation_lanes_reaction_screen
