!> Which steps of lanes plainly hold no extremum of the reactions.
module rwmf_integrator_lane_reactions
   use rwmf_core_kinds, only: wp
   use rwmf_integrator_lane_columns, only: at_limit, column_count, is_done, of_frequency, &
      of_ground_end, of_plain, of_trial
   use rwmf_integrator_pairs, only: most_stages
   use rwmf_model_reactions_loop, only: demand, lane_reactions, low_normal, reaction_count
   use rwmf_model_lanes, only: lane_count
   use rwmf_model_scene, only: force_parts_t
   implicit none
   private

   public :: screen_steps, find_plain_steps
   public :: at_begin, at_end, so_far, least_so_far, value_count, short_angle

   integer, parameter :: at_begin = 1
   integer, parameter :: at_end = 2
   !! of a step
   integer, parameter :: so_far = 3
   !! the largest
   integer, parameter :: least_so_far = 4
   !! which tells how far they vary
   integer, parameter :: value_count = 4

   real(wp), parameter :: short_angle = 0.4_wp
   !! of a step that may be plain: the second harmonic departs from a chord by (2*0.4)**2/8 of its
   !! amplitude [rad]

contains

   !> Reactions at the ends of the steps that the lanes have tried, and which of these are plain.
   !>
   !> What a step has come to is where the next one begins, unless the ground jumps in between.
   subroutine screen_steps(parts, last, coef, y_new, ground, mark, table, values)
      type(force_parts_t), intent(in) :: parts
      !! complete
      integer, intent(in) :: last
      !! stage at the end of the step
      real(wp), intent(in) :: coef(lane_count, parts%through_link%n_coef)
      !! coefficients of the loops, on the side and the branches in force
      real(wp), intent(in) :: y_new(lane_count, parts%through_link%n)
      !! (states)
      real(wp), intent(in) :: ground(lane_count, most_stages, 2)
      !! acceleration of the ground at the nodes, horizontal and vertical [m/s2]
      integer, intent(in) :: mark(lane_count)
      !! what became of the steps before
      real(wp), intent(inout) :: table(lane_count, column_count)
      !! one row a lane, with the columns and units of `rwmf_integrator_lane_columns`; sets
      !! `of_ground_end` and `of_plain`
      real(wp), intent(inout) :: values(lane_count, reaction_count, value_count)
      !! reactions at the ends of the step, and their extremes so far, which stay: -N [m/s2], |H|/N
      !! [-], |V| [m/s2]
      real(wp), parameter :: slack = 1.0e-9_wp
      real(wp), dimension(lane_count) :: angle, is_passed, jump
      real(wp) :: at_ends(lane_count, 2)
      integer :: i, m, q

      !$omp simd
      do i = 1, lane_count
         is_passed(i) = merge(1.0_wp, 0.0_wp, mark(i) == is_done .or. mark(i) == at_limit)
         jump(i) = 0
         angle(i) = table(i, of_trial)*table(i, of_frequency)
      end do
      do m = 1, 2
         !$omp simd
         do i = 1, lane_count
            jump(i) = max(jump(i), is_passed(i)*(abs(ground(i, 1, m) - table(i, of_ground_end + m &
               - 1)) - slack*(abs(ground(i, 1, m)) + abs(ground(i, last, m)))))
            table(i, of_ground_end + m - 1) = ground(i, last, m)
            at_ends(i, m) = ground(i, last, m)
         end do
      end do
      do q = 1, reaction_count
         !$omp simd
         do i = 1, lane_count
            values(i, q, at_begin) = merge(merge(huge(slack), values(i, q, at_end), jump(i) > 0), &
               values(i, q, at_begin), is_passed(i) > 0)
         end do
      end do
      call lane_reactions(parts, coef, y_new, at_ends, values(1, 1, at_end))
      call find_plain_steps(parts, angle, values, table(1, of_plain))
   end subroutine screen_steps

   !> Which steps can hold no extremum of the reactions? Most are so short, and so far from the
   !> extrema so far, that their ends say it. A quotient |H|/N is bounded by its parts, because it
   !> has a sharp peak wherever N is small.
   pure subroutine find_plain_steps(parts, angle, values, is_plain)
      type(force_parts_t), intent(in) :: parts
      real(wp), intent(in) :: angle(lane_count)
      !! that the fastest vibration of the scene goes through in the step [rad]
      real(wp), intent(in) :: values(lane_count, reaction_count, value_count)
      !! reactions at the ends of the step, and their extremes so far: -N [m/s2], |H|/N [-], |V|
      !! [m/s2]
      real(wp), intent(out) :: is_plain(lane_count)
      !! 1 where there is none, 0 where there may be one
      real(wp), parameter :: largest_margin = 0.25_wp
      !! of the range so far, of so long a step
      real(wp), parameter :: cap = sqrt(sqrt(huge(1.0_wp)))
      !! of factors of a product
      real(wp) :: margin, range, found, level, normal_a, normal_b
      integer :: i, q

      do q = 1, reaction_count
         !$omp simd private(margin, range, found, level, normal_a, normal_b)
         do i = 1, lane_count
            if (q == 1) is_plain(i) = merge(1.0_wp, 0.0_wp, angle(i) < short_angle)
            margin = max(0.01_wp, largest_margin*(angle(i)/short_angle)**2)
            range = values(i, q, so_far) - values(i, q, least_so_far)
            found = max(values(i, q, at_begin), values(i, q, at_end)) + margin*max(range, 0.0_wp)
            level = values(i, q, so_far)
            if (q == demand .and. parts%through_link%has_wall .and. .not. parts%has_shear_key) then
               ! |H| departs from its ends by a part of its range, which the largest quotient times
               ! the largest N exceeds
               normal_a = -min(values(i, low_normal, at_begin), cap)
               normal_b = -min(values(i, low_normal, at_end), cap)
               level = min(level, cap)
               found = max(normal_a*min(values(i, demand, at_begin), cap), &
                  normal_b*min(values(i, demand, at_end), cap)) &
                  + margin*level*min(-values(i, low_normal, least_so_far), cap)
               level = level*(min(normal_a, normal_b) - margin*max(0.0_wp, &
                  values(i, low_normal, so_far) - values(i, low_normal, least_so_far)))
               ! no demand is larger than that of a pivot that lifts
               if (values(i, demand, so_far) >= cap) found = -huge(found)
            end if
            is_plain(i) = merge(is_plain(i), 0.0_wp, found < level .and. range >= 0)
         end do
      end do
   end subroutine find_plain_steps

end module rwmf_integrator_lane_reactions
