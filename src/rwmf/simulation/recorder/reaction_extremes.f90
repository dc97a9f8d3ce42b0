!> Extrema of the reactions over a run, updated piece by piece.
!>
!> Reactions are smooth between two events or knots, but no event marks their extrema. Each span of
!> smooth motion is sampled at Chebyshev-Lobatto nodes. An extremum between the samples is then
!> refined to sqrt(epsilon) of the span in time. Its value is then exact to the integration
!> tolerance. Both ends of a span count with their one-sided values. The friction that the impulses
!> of impacts need has its own maximum.
!>
!> The friction demand |H|/N has sharp peaks where N is small, which samples can miss. They are
!> found near the minimum of N, where H N' = H' N.
module rwmf_simulation_recorder_reaction_extremes
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: wp
   use rwmf_math_roots, only: bracket_between, bracket_t, climb, is_wider, maximum_between, &
      maximum_t, narrow, vertex_of_parabola
   use rwmf_model_system_assembly, only: equation_t, interval_of, rates_at
   use rwmf_model_system_reactions_loop, only: demand, low_normal, &
      n_quantities => reaction_count, shear
   use rwmf_model_equation, only: ground, has_further_effects, vertical_ground
   use rwmf_model_system_reactions, only: friction_demand, reactions_at, reactions_t
   use rwmf_motion_ground_motion, only: turning_point
   use rwmf_problem_case, only: case_t, seeks
   use rwmf_problem_quantity_table, only: id
   use rwmf_simulation_events_step_view, only: count_parts, end_of_part, is_short, &
      step_view_t, turning_frequency
   use rwmf_simulation_recorder_reaction_estimates, only: at_first, at_last, estimate_reactions, &
      fastest_of, frequency_with_springs, has_estimate, inside, is_sharp, largest_quotient, &
      n_nodes, node, nowhere, place_of_peak, turns_of_quotient
   implicit none
   private

   public :: reaction_extremes_recorder_t, create_reaction_extremes
   public :: first_exceedance
   public :: observe_impulse, observe_instant, observe_last, observe_moving, observe_resting

   integer, parameter :: thrust = n_quantities + 1
   !! H with its sign, in addition to the maximised quantities [m/s2]
   integer, parameter :: n_found = n_quantities + 1

   !> Running maxima.
   type :: reaction_extremes_recorder_t
      real(wp) :: largest(n_quantities) = -huge(1.0_wp)
      !! [m/s2], [-] (with a shear key [m/s2]), [m/s2]
      real(wp) :: t_largest(n_quantities) = 0
      !! [s]
      real(wp) :: smallest(n_quantities) = huge(1.0_wp)
      !! smallest values, for the range of each quantity [m/s2], [-], [m/s2]
      logical :: is_sought(n_quantities) = .true.
      !! a requested quantity needs this one
      real(wp), allocatable :: limit
      !! coefficient of friction, as a limit of the demand [-]
      real(wp), allocatable :: t_exceeded
      !! first time at which the demand of the motion between impacts exceeds the limit [s]
      real(wp), allocatable :: t_impulse
      !! first time at which the demand of an impact exceeds the limit [s]
      logical :: sees_impulses = .false.
      !! the friction at impacts is requested
      real(wp) :: impact_demand = 0
      !! largest horizontal over vertical impulse of the base [-]
      real(wp) :: frequency = 0
      !! frequency of the fastest vibration before yielding [rad/s]
      real(wp) :: t_rest = -1
      !! end of the last observed span at rest [s]
      real(wp) :: ground_rest(2) = 0
      !! ground acceleration at that time, horizontal and vertical [m/s2]
   end type reaction_extremes_recorder_t

contains

   !> Initialise the extrema if the case requests reactions.
   subroutine create_reaction_extremes(forces, case, equation, y)
      type(reaction_extremes_recorder_t), allocatable, intent(out) :: forces
      type(case_t), intent(in) :: case
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      !! (states) at the beginning

      if (.not. allocated(case%output)) return
      if (.not. case%output%reactions) return
      allocate (forces)
      forces%frequency = frequency_with_springs(equation, y)
      forces%is_sought(low_normal) = seeks(case%output, [id%pivot_normal_min_over_m_w_g, &
         id%t_pivot_normal_min_s, id%pivot_lifts])
      forces%is_sought(demand) = seeks(case%output, [id%friction_demand_max, &
         id%t_friction_demand_max_s, id%shear_key_force_max_over_m_w_g, &
         id%t_shear_key_force_max_s, id%friction_exceeded, id%t_friction_exceeded_s])
      forces%is_sought(shear) = seeks(case%output, [id%base_shear_max_over_weight, &
         id%t_base_shear_max_s])
      forces%sees_impulses = equation%has_impacts .and. .not. equation%parts%has_shear_key &
         .and. seeks(case%output, [id%friction_demand_impact_max, id%friction_exceeded, &
         id%t_friction_exceeded_s])
      if (.not. (forces%is_sought(demand) .or. forces%sees_impulses)) return
      if (allocated(case%output%friction_limit)) forces%limit = case%output%friction_limit
   end subroutine create_reaction_extremes

   !> Update the friction demand of impacts with the impulse of the foundation at one of them.
   pure subroutine observe_impulse(forces, t, impulse)
      type(reaction_extremes_recorder_t), intent(inout) :: forces
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: impulse(2)
      !! horizontal and vertical, over m_w [m/s]
      real(wp) :: demand_of_impact

      if (.not. impulse(2) > 0) return
      demand_of_impact = abs(impulse(1))/impulse(2)
      forces%impact_demand = max(forces%impact_demand, demand_of_impact)
      if (.not. allocated(forces%limit) .or. allocated(forces%t_impulse)) return
      if (demand_of_impact > forces%limit) forces%t_impulse = t
   end subroutine observe_impulse

   !> First time at which any demand exceeds the limit; `huge` without one [s].
   !>
   !> The search of the demand between impacts ignores impulses. Its bits then do not depend on
   !> whether the friction at impacts is requested.
   pure real(wp) function first_exceedance(forces) result(t)
      type(reaction_extremes_recorder_t), intent(in) :: forces

      t = huge(t)
      if (allocated(forces%t_exceeded)) t = forces%t_exceeded
      if (allocated(forces%t_impulse)) t = min(t, forces%t_impulse)
   end function first_exceedance

   !> Update the extrema with the final state if there is no other, as in a run of zero duration.
   subroutine observe_last(forces, equation, t, y, y_dot)
      type(reaction_extremes_recorder_t), intent(inout) :: forces
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp), intent(in) :: y_dot(:)
      !! (states) their rates

      if (forces%largest(shear) >= 0) return
      call observe_instant(forces, equation, t, y, y_dot)
   end subroutine observe_last

   !> Update the extrema with one state.
   subroutine observe_instant(forces, equation, t, y, y_dot)
      type(reaction_extremes_recorder_t), intent(inout) :: forces
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp), intent(in) :: y_dot(:)
      !! (states) their rates

      call keep_largest(forces, t, quantities(equation, reactions_at(equation, t, y, y_dot)))
   end subroutine observe_instant

   !> Update the extrema over smooth motion inside the last step of the integrator.
   subroutine observe_moving(forces, piece, error)
      type(reaction_extremes_recorder_t), intent(inout) :: forces
      type(step_view_t), intent(in) :: piece
      type(error_t), allocatable, intent(out) :: error
      !! the integrator fails
      type(step_view_t) :: span
      logical :: is_left(n_quantities)
      !! the quantity is requested and not settled yet
      integer :: i, n

      is_left = forces%is_sought
      if (has_estimate(piece)) then
         call search_estimate(forces, piece, is_left, error)
      else
         call drop_plain(forces, piece, is_left)
      end if
      if (allocated(error) .or. .not. any(is_left)) return
      n = count_parts(piece)
      span = piece
      do i = 1, n
         span%t_b = end_of_part(piece, i, n)
         nullify (span%y_b)
         if (i == n) span%y_b => piece%y_b
         call search_span(forces, span, is_left, error)
         if (allocated(error)) return
         span%t_a = span%t_b
         nullify (span%y_a)
      end do
   end subroutine observe_moving

   !> Update the extrema with an end of a piece.
   subroutine observe_end(forces, piece, t, y)
      type(reaction_extremes_recorder_t), intent(inout) :: forces
      type(step_view_t), intent(in) :: piece
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: y(:)
      !! (states)

      call keep_largest(forces, t, quantities_at(piece%equation, t, y))
   end subroutine observe_end

   !> Update the extrema over a short piece, located with estimated reactions.
   subroutine search_estimate(forces, piece, is_left, error)
      type(reaction_extremes_recorder_t), intent(inout) :: forces
      type(step_view_t), intent(in) :: piece
      !! piece for which `has_estimate` is true
      logical, intent(inout) :: is_left(n_quantities)
      !! on input the requested quantities; on return those that need a complete search
      type(error_t), allocatable, intent(out) :: error
      real(wp), parameter :: slack = 0.01_wp
      !! part of the range so far, to allow for the error of the estimate [-]
      real(wp) :: found(n_quantities, n_nodes)
      real(wp) :: t_peak
      integer :: peak(n_quantities)
      logical :: is_steep
      integer :: q

      if (.not. all(forces%largest >= forces%smallest)) return
      call estimate_reactions(piece, found)
      is_steep = is_quotient(piece%equation) .and. is_left(demand)
      if (is_steep) is_steep = is_sharp(-found(low_normal, :))
      is_left = .false.
      if (is_steep) then
         is_left(demand) = bound(-found(low_normal, :), found(demand, :)) > forces%largest(demand)
      else if (allocated(forces%limit) .and. .not. allocated(forces%t_exceeded)) then
         is_left(demand) = .not. maxval(found(demand, :)) < 0.9_wp*forces%limit
      end if
      do q = 1, n_quantities
         peak(q) = place_of_peak(found(q, :), forces%largest(q) - slack*(forces%largest(q) &
            - forces%smallest(q)))
      end do
      if (is_steep .or. is_left(demand)) peak(demand) = nowhere
      where (.not. forces%is_sought) peak = nowhere
      forces%smallest = min(forces%smallest, minval(found, 2))
      if (all(peak == nowhere)) return
      if (any(peak == inside .or. peak == at_first)) call observe_end(forces, piece, piece%t_a, &
         piece%y_a)
      if (any(peak == inside .or. peak == at_last)) call observe_end(forces, piece, piece%t_b, &
         piece%y_b)
      do q = 1, n_quantities
         if (peak(q) /= inside) cycle
         call refine(forces, piece, q, piece%t_a + (piece%t_b - piece%t_a)*node, found(q, :), &
            t_peak, error)
         if (allocated(error)) return
      end do
   end subroutine search_estimate

   !> Drop the quantities whose values at both ends of a short step exclude an extremum inside.
   !>
   !> Most steps are short and far below the extrema so far, so they need no state inside. A
   !> quotient |H|/N is bounded by its parts, because it has a sharp peak wherever N is small.
   subroutine drop_plain(forces, piece, is_left)
      type(reaction_extremes_recorder_t), intent(in) :: forces
      type(step_view_t), intent(in) :: piece
      logical, intent(inout) :: is_left(n_quantities)
      !! the quantity still needs a search
      real(wp), parameter :: short_angle = 0.4_wp
      !! largest phase angle of a plain step: the second harmonic departs from a chord by
      !! (2*0.4)**2/8 of its amplitude [rad]
      real(wp), parameter :: largest_margin = 0.25_wp, least_margin = 0.01_wp
      !! margin over the range so far, for a step of `short_angle` and for a very short one [-]
      real(wp), parameter :: least_range = 0.25_wp
      !! least range so far over the magnitude of the level: after a start or an event, a vibration
      !! has not shown its range yet [-]
      real(wp), parameter :: cap = sqrt(sqrt(huge(1.0_wp)))
      !! bound of the factors of a product
      real(wp) :: at_ends(n_found, 2), normal(2), angle, margin
      real(wp), dimension(n_quantities) :: range, highest, level

      associate (equation => piece%equation, largest => forces%largest)
         if (.not. is_short(piece, short_angle, fastest_of(equation))) return
         angle = (piece%t_b - piece%t_a)*max(fastest_of(equation), turning_frequency(piece))
         if (.not. (angle < short_angle .and. all(largest >= forces%smallest))) return
         at_ends(:, 1) = quantities_at(equation, piece%t_a, piece%y_a)
         at_ends(:, 2) = quantities_at(equation, piece%t_b, piece%y_b)
         margin = max(least_margin, largest_margin*(angle/short_angle)**2)
         range = max(largest - forces%smallest, least_range*abs(largest))
         highest = maxval(at_ends(:n_quantities, :), dim=2) + margin*range
         level = largest
         if (is_quotient(equation)) then
            ! |H| departs from its ends by a part of its range, which is less than the largest
            ! quotient times the largest N
            normal = -min(at_ends(low_normal, :), cap)
            level(demand) = min(level(demand), cap)
            highest(demand) = maxval(normal*min(at_ends(demand, :), cap)) + margin*level(demand) &
               *min(-forces%smallest(low_normal), cap)
            level(demand) = level(demand)*(minval(normal) - margin*range(low_normal))
            ! a pivot that lifts has the largest possible demand
            if (largest(demand) >= cap) highest(demand) = -huge(1.0_wp)
         end if
      end associate
      is_left = is_left .and. .not. highest < level
   end subroutine drop_plain

   !> Compute the reactions at a state.
   function quantities_at(equation, t, y) result(found)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp) :: found(n_found)
      !! maxima of the first `n_quantities`, then H [m/s2], [-]
      real(wp) :: y_dot(size(y))

      call rates_at(equation, t, y, y_dot)
      found = quantities(equation, reactions_at(equation, t, y, y_dot))
   end function quantities_at

   !> Update the extrema over the current interval of the motion, with the wall at rest.
   subroutine observe_resting(forces, equation, y, t_a, t_b)
      type(reaction_extremes_recorder_t), intent(inout) :: forces
      type(equation_t), intent(in), target :: equation
      real(wp), intent(in), contiguous, target :: y(:)
      !! (states), of which the first two are zero
      real(wp), intent(in) :: t_a
      !! [s]
      real(wp), intent(in) :: t_b
      !! [s]
      type(error_t), allocatable :: error
      !! never set: no integrator is involved
      real(wp), parameter :: slack = 1.0e-12_wp
      real(wp), dimension(n_found) :: at_begin, at_end
      real(wp) :: acceleration(2)
      !! ground acceleration [m/s2]
      type(step_view_t) :: span

      span%equation => equation
      span%y_a => y
      span%t_a = t_a
      do while (span%t_a < t_b)
         span%t_b = min(turning_point(equation%motion, interval_of(equation), span%t_a), t_b)
         ! the previous span at rest includes this instant, unless the ground acceleration jumps
         at_begin = -huge(at_begin)
         acceleration = shaking(equation, span%t_a)
         if (abs(span%t_a - forces%t_rest) > 0 .or. any(abs(acceleration - forces%ground_rest) &
             > slack*abs(forces%ground_rest))) call sample(span, span%t_a, at_begin, error)
         call sample(span, span%t_b, at_end, error)
         forces%smallest = min(forces%smallest, at_end(:n_quantities))
         ! Without further effects only the ground acceleration varies over the span. Where it is
         ! linear, |H|, |V| and |H|/N are largest at an end.
         if ((has_further_effects(equation) .and. .not. equation%state%line%is_straight) &
             .or. any(max(at_begin(:n_quantities), at_end(:n_quantities)) > forces%largest)) then
            call search_span(forces, span, forces%is_sought, error)
         end if
         span%t_a = span%t_b
         forces%t_rest = span%t_b
         forces%ground_rest = shaking(equation, span%t_b)
      end do
   end subroutine observe_resting

   !> Acceleration of the ground, horizontal and vertical [m/s2].
   function shaking(equation, t) result(acceleration)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      !! [s]
      real(wp) :: acceleration(2)

      acceleration = 0
      acceleration(1) = ground(equation, t)
      if (equation%has_vertical) acceleration(2) = vertical_ground(equation, t)
   end function shaking

   !> Update the extrema over a span of at most a quarter of a period of motion and reactions.
   subroutine search_span(forces, span, is_left, error)
      type(reaction_extremes_recorder_t), intent(inout) :: forces
      type(step_view_t), intent(in) :: span
      logical, intent(in) :: is_left(n_quantities)
      !! the quantities to search
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: t(n_nodes)
      real(wp) :: found(n_found, n_nodes)
      type(step_view_t) :: part
      real(wp) :: t_peak
      integer :: i, q

      do i = 1, n_nodes
         t(i) = span%t_a + (span%t_b - span%t_a)*node(i)
         call sample(span, t(i), found(:, i), error)
         if (allocated(error)) return
      end do
      do i = 1, n_nodes
         call keep_largest(forces, t(i), found(:, i), is_left)
      end do
      do q = 1, n_quantities
         if (.not. is_left(q)) cycle
         if (q == demand .and. is_quotient(span%equation) .and. is_sharp(-found(low_normal, :))) &
            then
            call search_quotient(forces, span, t, found, t_peak, error)
         else
            call refine(forces, span, q, t, found(q, :), t_peak, error)
         end if
         if (allocated(error)) return
         if (q /= demand .or. .not. allocated(forces%limit)) cycle
         if (allocated(forces%t_exceeded) .or. .not. forces%largest(q) > forces%limit) cycle
         ! This is the first span whose largest demand exceeds the limit.
         i = findloc(found(q, :) > forces%limit, .true., dim=1)
         if (i > 0) t_peak = min(t_peak, t(i))
         part = span
         if (associated(span%integrator)) nullify (part%y_a, part%y_b)
         part%t_a = max(maxval(t, mask=t < t_peak .and. found(q, :) <= forces%limit), span%t_a)
         part%t_b = t_peak
         call find_exceedance(forces, part, error)
         if (allocated(error)) return
      end do
   end subroutine search_span

   !> True if the demand of a scene is |H|/N, not the force of a shear key.
   pure logical function is_quotient(equation)
      type(equation_t), intent(in) :: equation

      is_quotient = equation%has_wall .and. .not. equation%parts%has_shear_key
   end function is_quotient

   !> Upper bound of |H|/N in a piece, from N and the quotient at the nodes [-].
   pure real(wp) function bound(normal, quotient)
      real(wp), intent(in) :: normal(n_nodes), quotient(n_nodes)
      !! N [m/s2] and |H|/N [-]
      real(wp), parameter :: cap = sqrt(sqrt(huge(1.0_wp)))

      bound = largest_quotient(normal, abs(normal)*min(quotient, cap))
   end function bound

   !> Search for the largest |H|/N in a span where N varies by more than half of its minimum.
   !>
   !> `t_peak` is the time of the first peak above the limit, or else the end of the span.
   subroutine search_quotient(forces, span, t, found, t_peak, error)
      type(reaction_extremes_recorder_t), intent(inout) :: forces
      type(step_view_t), intent(in) :: span
      real(wp), intent(in) :: t(n_nodes)
      !! nodes [s]
      real(wp), intent(in) :: found(n_found, n_nodes)
      !! samples at the nodes
      real(wp), intent(out) :: t_peak
      type(error_t), allocatable, intent(out) :: error
      real(wp), parameter :: far = 0.25_wp
      !! samples below this part of the largest so far indicate no larger value [-]
      real(wp), parameter :: beside = 1.0e-4_wp
      !! distance of further samples from the ends over the width of a peak; they show a rise [-]
      real(wp) :: point(n_nodes + 5), value(n_nodes + 5), low(n_found), turn(2), width, t_low
      type(maximum_t) :: search
      integer :: i, n

      t_peak = t(n_nodes)
      if (bound(-found(low_normal, :), found(demand, :)) <= forces%largest(demand)) return
      call find_smallest_normal(forces, span, t, found, t_low, low, error)
      if (allocated(error)) return
      if (low(low_normal) >= 0) then
         t_peak = t_low
         return
      end if
      call turns_of_quotient(t, -found(low_normal, :), found(thrust, :), t_low, -low(low_normal), &
         low(thrust), turn, width)
      n = n_nodes
      point(:n) = t
      value(:n) = found(demand, :)
      call add_point(t_low)
      call add_point(turn(1))
      call add_point(turn(2))
      call add_point(t(1) + beside*width)
      call add_point(t(n_nodes) - beside*width)
      do i = 2, n - 1
         if (allocated(error)) return
         if (value(i) < maxval(value(i - 1:i + 1)) .or. value(i) < far*forces%largest(demand)) cycle
         search = maximum_between(max(point(i - 1), point(i) - width), min(point(i + 1), &
            point(i) + width), point(i), is_near=.true.)
         do while (search%is_open)
            call sample(span, search%next, low, error)
            if (allocated(error)) return
            call keep_largest(forces, search%next, low, only(demand))
            value(i) = max(value(i), low(demand))
            call climb(search, low(demand))
         end do
         if (.not. allocated(forces%limit)) cycle
         ! a later peak may be larger
         if (value(i) > forces%limit) t_peak = min(t_peak, search%x(1))
      end do

   contains

      !> Insert an instant inside the span, with its value.
      subroutine add_point(at)
         real(wp), intent(in) :: at
         real(wp) :: sampled(n_found)
         integer :: place

         if (allocated(error) .or. any(abs(at - point(:n)) <= 0) .or. .not. (at > t(1) &
            .and. at < t(n_nodes))) return
         call sample(span, at, sampled, error)
         if (allocated(error)) return
         call keep_largest(forces, at, sampled, only(demand))
         place = count(point(:n) < at) + 1
         point(place + 1:n + 1) = point(place:n)
         value(place + 1:n + 1) = value(place:n)
         point(place) = at
         value(place) = sampled(demand)
         n = n + 1
      end subroutine add_point
   end subroutine search_quotient

   !> Find the smallest N in a span with sampled nodes, and all quantities at this instant.
   subroutine find_smallest_normal(forces, span, t, found, t_low, low, error)
      type(reaction_extremes_recorder_t), intent(inout) :: forces
      type(step_view_t), intent(in) :: span
      real(wp), intent(in) :: t(n_nodes)
      !! nodes [s]
      real(wp), intent(in) :: found(n_found, n_nodes)
      !! samples at the nodes
      real(wp), intent(out) :: t_low
      real(wp), intent(out) :: low(n_found)
      type(error_t), allocatable, intent(out) :: error
      type(maximum_t) :: search
      real(wp) :: at_point(n_found), vertex
      integer :: k

      k = maxloc(found(low_normal, :), dim=1)
      t_low = t(k)
      low = found(:, k)
      k = min(max(k, 2), n_nodes - 1)
      vertex = vertex_of_parabola(t(k - 1:k + 1), found(low_normal, k - 1:k + 1))
      if (.not. (vertex > t(k - 1) .and. vertex < t(k + 1))) return
      search = maximum_between(t(k - 1), t(k + 1), vertex, is_near=.true.)
      do while (search%is_open)
         call sample(span, search%next, at_point, error)
         if (allocated(error)) return
         call keep_largest(forces, search%next, at_point, only(demand))
         if (at_point(low_normal) > low(low_normal)) then
            t_low = search%next
            low = at_point
         end if
         call climb(search, at_point(low_normal))
      end do
   end subroutine find_smallest_normal

   !> Refine the maximum of a quantity between the samples if it can be the largest so far.
   !>
   !> `t_peak` is the time of the maximum, or else the end of the span.
   subroutine refine(forces, span, q, t, found, t_peak, error)
      type(reaction_extremes_recorder_t), intent(inout) :: forces
      type(step_view_t), intent(in) :: span
      integer, intent(in) :: q
      !! number of the quantity
      real(wp), intent(in) :: t(n_nodes)
      real(wp), intent(in) :: found(n_nodes)
      !! samples of the quantity
      real(wp), intent(out) :: t_peak
      type(error_t), allocatable, intent(out) :: error
      type(maximum_t) :: search
      real(wp) :: at_point(n_found)
      real(wp) :: vertex
      integer :: k

      t_peak = t(n_nodes)
      if (maxval(found) >= huge(found)) return
      if (place_of_peak(found, forces%largest(q)) /= inside) return
      k = min(max(maxloc(found, dim=1), 2), n_nodes - 1)
      vertex = vertex_of_parabola(t(k - 1:k + 1), found(k - 1:k + 1))
      if (.not. (vertex > t(k - 1) .and. vertex < t(k + 1))) vertex = t(k)
      search = maximum_between(t(k - 1), t(k + 1), vertex)
      do while (search%is_open)
         call sample(span, search%next, at_point, error)
         if (allocated(error)) return
         call keep_largest(forces, search%next, at_point, only(q))
         call climb(search, at_point(q))
      end do
      t_peak = search%x(1)
   end subroutine refine

   !> Find the instant at which the demand exceeds the limit, by bisection.
   subroutine find_exceedance(forces, span, error)
      type(reaction_extremes_recorder_t), intent(inout) :: forces
      type(step_view_t), intent(in) :: span
      !! the demand exceeds the limit at the end, and is below it at the beginning or nowhere
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: found(n_found)
      type(bracket_t) :: bracket

      bracket = bracket_between(span%t_a, span%t_b)
      do while (is_wider(bracket, 2))
         call sample(span, bracket%middle, found, error)
         if (allocated(error)) return
         call narrow(bracket, found(demand) > forces%limit)
      end do
      forces%t_exceeded = bracket%high
   end subroutine find_exceedance

   !> Compute the maximised quantities at one instant.
   !>
   !> At the ends of the span the given states apply: an event there is located more exactly than
   !> the integrator's solution.
   subroutine sample(span, t, found, error)
      type(step_view_t), intent(in) :: span
      !! with the known states at its ends; at rest with the constant states
      real(wp), intent(in) :: t
      real(wp), intent(out) :: found(n_found)
      type(error_t), allocatable, intent(out) :: error
      real(wp), dimension(span%equation%n) :: y, y_dot

      y_dot = 0
      if (.not. associated(span%integrator)) then
         y = span%y_a
      else
         if (associated(span%y_a) .and. t <= span%t_a) then
            y = span%y_a
         else if (associated(span%y_b) .and. t >= span%t_b) then
            y = span%y_b
         else
            call span%integrator%state_at(t, y, error)
         end if
         if (allocated(error)) return
         call rates_at(span%equation, t, y, y_dot)
      end if
      found = quantities(span%equation, reactions_at(span%equation, t, y, y_dot))
   end subroutine sample

   !> Mask with one quantity.
   pure function only(q) result(mask)
      integer, intent(in) :: q
      !! number of the quantity
      logical :: mask(n_quantities)

      mask = .false.
      mask(q) = .true.
   end function only

   pure function quantities(equation, reactions) result(found)
      type(equation_t), intent(in) :: equation
      type(reactions_t), intent(in) :: reactions
      real(wp) :: found(n_found)

      found(thrust) = reactions%horizontal
      found(low_normal) = -reactions%normal
      if (equation%parts%has_shear_key) then
         found(demand) = abs(reactions%horizontal)
      else
         found(demand) = friction_demand(reactions)
      end if
      found(shear) = abs(reactions%base_shear)
   end function quantities

   !> Update the extrema with quantities at one instant.
   !>
   !> The points of a search update its own quantities only. The bits of an extremum then do not
   !> depend on the other quantities of the request. Quantities without a request are updated too,
   !> because N bounds the quotient |H|/N.
   pure subroutine keep_largest(forces, t, found, mask)
      type(reaction_extremes_recorder_t), intent(inout) :: forces
      real(wp), intent(in) :: t
      real(wp), intent(in) :: found(n_found)
      logical, intent(in), optional :: mask(n_quantities)
      !! the quantities to update; absent: all
      integer :: q

      do q = 1, n_quantities
         forces%smallest(q) = min(forces%smallest(q), found(q))
         if (present(mask)) then
            if (forces%is_sought(q) .and. .not. mask(q)) cycle
         end if
         if (.not. found(q) > forces%largest(q)) cycle
         forces%largest(q) = found(q)
         forces%t_largest(q) = t
      end do
   end subroutine keep_largest

end module rwmf_simulation_recorder_reaction_extremes
