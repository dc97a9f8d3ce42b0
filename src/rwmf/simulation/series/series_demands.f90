!> Largest reactions, accelerations and drifts in the steps of a series batch.
!>
!> Each is a sum of terms whose series follow from that of phi. A loop over the lanes finds the
!> steps in which it may exceed its largest value so far. The polynomial then gives the instant, and
!> the equation of motion the value.
module rwmf_simulation_series_series_demands
   use rwmf_core_kinds, only: wp
   use rwmf_integrator_series_series_lanes, only: axial_terms, demand_terms, left, motion_terms, &
      of_constant, of_cosine, of_cosine_1, of_cosine_2, of_cosine_over, of_ground, &
      of_half_cosine, of_half_sine, of_inverse, of_phi, of_phi_cosine, of_phi_sine, of_rate, &
      of_sine, of_sine_1, of_sine_2, of_sine_over, of_upward, right, series_width
   use rwmf_math_polynomial_roots, only: evaluate, find_largest
   use rwmf_model_effects_numbers, only: inerter_effect, p_delta_effect
   use rwmf_model_elements, only: line_of_element
   use rwmf_model_equation, only: enter_interval, enter_side, equation_t, has_elements, interval_of
   use rwmf_model_stroke, only: along_axis, along_chord, along_line
   use rwmf_model_system_assembly, only: rates_at
   use rwmf_model_system_reactions_loop, only: demand, low_normal, shear
   use rwmf_motion_ground_motion, only: interval_last
   use rwmf_simulation_lanes_batch, only: lane_state_t
   use rwmf_simulation_recorder_force_envelopes, only: of_series
   use rwmf_simulation_recorder_peak_search, only: has_search, peak_search_t, search_state
   use rwmf_simulation_recorder_reaction_extremes, only: backward
   use rwmf_simulation_recorder_recorder, only: recorder_t
   use rwmf_simulation_series_series_batch, only: demand_t, of_building, of_envelopes, &
      of_reactions, series_batch_t
   implicit none
   private

   public :: serves_demands, list_demands, load_demands, search_demands, follow_lane

   integer, parameter :: of_horizontal = 1, of_normal = 2, of_shear = 3, of_frame = 4, of_link = 5
   !! sums of terms: forces of the pivot H and N, base shear, the frame's acceleration relative to
   !! the ground, and the force of the link, over m_w [m/s2]

contains

   !> Return whether the series know all demands that a run records.
   pure logical function serves_demands(recorder, equation) result(serves)
      type(recorder_t), intent(in) :: recorder
      type(equation_t), intent(in) :: equation
      integer :: q

      serves = .not. recorder%keeps_energy
      if (.not. serves) return
      if (allocated(recorder%envelopes)) then
         associate (leader => recorder%envelopes%leader, numbers => of_series(recorder%envelopes))
            serves = .not. recorder%envelopes%sums_strokes .and. has_plain_pivot(equation)
            if (serves) serves = count(leader > 0) == count(leader(numbers) > 0)
         end associate
      end if
      if (allocated(recorder%forces)) then
         associate (forces => recorder%forces, effects => equation%scene%terms%effect)
            serves = serves .and. .not. (forces%sees_impulses .or. allocated(forces%limit) &
               .or. any(effects == p_delta_effect))
            if (any(forces%leader([low_normal, demand, backward]) > 0)) serves = serves &
               .and. has_plain_pivot(equation)
         end associate
      end if
      if (.not. (serves .and. allocated(recorder%demands))) return
      associate (drifts => recorder%demands%building%drifts, floors => &
                 recorder%demands%building%floors)
         do q = 1, size(recorder%demands%leader)
            if (has_search(recorder%demands, q)) serves = serves .and. ((q == 1 .and. floors > 0) &
               .or. (q > 2*drifts .and. q <= 2*drifts + floors))
         end do
      end associate
   end function serves_demands

   !> Return whether the series know both forces of the pivot and that of the link.
   pure logical function has_plain_pivot(equation)
      type(equation_t), intent(in) :: equation

      associate (effects => equation%scene%terms%effect)
         has_plain_pivot = equation%walls == 1 .and. .not. (equation%floors%are_linked &
            .or. any(effects == inerter_effect .or. effects == p_delta_effect))
      end associate
      if (has_elements(equation)) has_plain_pivot = has_plain_pivot .and. count( &
         equation%elements%stroke%kind == along_line) <= 1
   end function has_plain_pivot

   !> List the demands that the runs of a batch record, if any.
   subroutine list_demands(recorder, equation, batch)
      type(recorder_t), intent(in) :: recorder
      type(equation_t), intent(in) :: equation
      !! of its first run
      type(series_batch_t), intent(inout) :: batch
      integer :: q

      allocate (batch%demands(0))
      batch%lanes%terms = motion_terms
      if (allocated(recorder%forces)) call add(of_reactions, [(q, q=1, backward)], &
         recorder%forces%leader(:backward), any_but=shear)
      if (allocated(recorder%demands)) then
         associate (leader => recorder%demands%leader, drifts => recorder%demands%building%drifts)
            call add(of_building, [(q, q=1, size(leader))], leader)
            if (any(leader(:drifts) > 0)) batch%lanes%terms = max(batch%lanes%terms, axial_terms)
         end associate
      end if
      if (allocated(recorder%envelopes)) then
         associate (numbers => of_series(recorder%envelopes))
            call add(of_envelopes, numbers, recorder%envelopes%leader(numbers), any_but=0)
         end associate
      end if
      if (batch%lanes%terms > motion_terms .and. has_elements(equation)) then
         if (any(equation%elements%stroke%kind == along_line &
            .or. equation%elements%stroke%kind == along_chord)) batch%lanes%terms = demand_terms - 1
      end if
      associate (n => size(batch%demands))
         if (n == 0) return
         allocate (batch%lanes%rows(series_width, demand_terms, left:right, n), &
            batch%lanes%level(series_width, n), batch%lanes%exceeds(series_width, n), &
            source=0.0_wp)
         batch%lanes%two_sided = [(merge(1.0_wp, 0.0_wp, has_two_signs(batch%demands(q), &
            recorder)), q=1, n)]
      end associate

   contains

      !> List the demands of a family that are searched.
      subroutine add(family, numbers, leader, any_but)
         integer, intent(in) :: family, numbers(:)
         integer, intent(in) :: leader(:)
         !! (numbers) of the search
         integer, intent(in), optional :: any_but
         !! all others need the terms of forces
         integer :: k

         do k = 1, size(numbers)
            if (leader(k) /= numbers(k)) cycle
            batch%demands = [batch%demands, demand_t(family, numbers(k))]
            if (.not. present(any_but)) cycle
            if (numbers(k) /= any_but) batch%lanes%terms = max(batch%lanes%terms, axial_terms)
         end do
      end subroutine add
   end subroutine list_demands

   !> Return whether the magnitude of a demand counts.
   pure logical function has_two_signs(of, recorder)
      type(demand_t), intent(in) :: of
      type(recorder_t), intent(in) :: recorder

      select case (of%family)
      case (of_reactions)
         has_two_signs = of%number == shear
      case (of_building)
         has_two_signs = .true.
      case default
         has_two_signs = .not. is_normal(of, recorder)
      end select
   end function has_two_signs

   !> The search that records a family of demands.
   function search_of(recorder, family) result(search)
      type(recorder_t), intent(in), target :: recorder
      integer, intent(in) :: family
      class(peak_search_t), pointer :: search

      select case (family)
      case (of_reactions)
         search => recorder%forces
      case (of_building)
         search => recorder%demands
      case default
         search => recorder%envelopes
      end select
   end function search_of

   !> Return whether a demand of the envelopes is the normal force of the pivot, not that of a link.
   pure logical function is_normal(of, recorder)
      type(demand_t), intent(in) :: of
      type(recorder_t), intent(in) :: recorder

      associate (numbers => of_series(recorder%envelopes))
         is_normal = of%number == numbers(1)
      end associate
   end function is_normal

   !> Load the factors of the terms and the levels of a lane's demands.
   subroutine load_demands(lane, i, batch)
      type(lane_state_t), intent(in) :: lane
      integer, intent(in) :: i
      !! number of the lane in the batch
      type(series_batch_t), intent(inout) :: batch
      class(peak_search_t), pointer :: search
      real(wp) :: sums(demand_terms, of_link), row(demand_terms), level
      integer :: m, n

      if (.not. allocated(batch%lanes%rows)) return
      do m = left, right
         sums = sums_of_terms(lane%equation, 2*m - 3)
         do n = 1, size(batch%demands)
            associate (of => batch%demands(n))
               search => search_of(lane%recorder, of%family)
               level = search%level(of%number)
               select case (of%family)
               case (of_reactions)
                  call load_reaction(lane, of%number, sums, row, level)
               case (of_building)
                  associate (building => lane%recorder%demands%building)
                     if (of%number <= 2*building%drifts) then
                        ! drift of the lowest storey
                        row = 0
                        row([of_sine, of_cosine]) = building%bend(1)/building%height(1) &
                           *sums([of_sine_2, of_cosine_2], of_frame)
                     else
                        row = building%share(of%number - 2*building%drifts)*sums(:, of_frame)
                        row(of_ground) = 1
                     end if
                  end associate
               case default
                  row = sums(:, merge(of_normal, of_link, is_normal(of, lane%recorder)))
               end select
            end associate
            batch%lanes%rows(i, :, m, n) = row
            batch%lanes%level(i, n) = level
         end do
      end do
   end subroutine load_demands

   !> Factors of the terms of both forces of the pivot, the base shear and the frame's acceleration
   !> on one side.
   pure function sums_of_terms(equation, side) result(sums)
      type(equation_t), intent(in) :: equation
      integer, intent(in) :: side
      !! +1 or -1
      real(wp) :: sums(demand_terms, of_link)
      real(wp) :: u(2)

      sums = 0
      associate (p => equation%p, geometry => equation%geometry, floors => equation%floors)
         ! the centroid moves R (sin(alpha) - sin(alpha - phi)) and rises R (cos(alpha - phi) -
         ! cos(alpha))
         sums([of_sine_2, of_cosine_2, of_ground], of_horizontal) = [side*p%R*p%cos_alpha, &
            side*p%R*geometry%sine_wall, 1.0_wp]
         sums(:, of_shear) = sums(:, of_horizontal)
         sums([of_sine_2, of_cosine_2, of_constant], of_normal) = [p%R*geometry%sine_wall, &
            -p%R*p%cos_alpha, p%g]
         if (equation%has_vertical) sums(of_upward, of_normal) = 1
         if (equation%has_frame) then
            u = 2*side*p%R*[p%cos_alpha, geometry%sine_link(side)]
            sums([of_sine_2, of_cosine_2], of_frame) = u
            sums([of_sine_2, of_cosine_2, of_ground], of_shear) = sums([of_sine_2, of_cosine_2, &
               of_ground], of_shear) + [p%gamma*floors%excited_mass_ratio*u, p%gamma + floors%mass]
            sums([of_sine_2, of_cosine_2, of_ground], of_link) = p%gamma*[u, &
               floors%excited_mass_ratio]
            sums([of_sine_1, of_cosine_1], of_link) = p%gamma*p%two_xi_omega*u
            sums([of_sine, of_cosine], of_link) = p%gamma*equation%state%frame_slope*u
            sums(of_constant, of_link) = p%gamma*equation%state%frame_offset
            sums(:, of_horizontal) = sums(:, of_horizontal) + sums(:, of_link)
         end if
      end associate
      if (has_elements(equation)) call add_elements(equation, side, sums(:, of_horizontal), &
         sums(:, of_normal))
   end function sums_of_terms

   !> Add the forces of the vertical elements to the factors of both forces of the pivot.
   pure subroutine add_elements(equation, side, horizontal, normal)
      type(equation_t), intent(in) :: equation
      integer, intent(in) :: side
      !! +1 or -1
      real(wp), dimension(demand_terms), intent(inout) :: horizontal, normal
      real(wp) :: line(2)
      integer :: i

      do i = 1, size(equation%elements)
         associate (element => equation%elements(i), a => equation%elements(i)%stroke%arm(side), &
                    z => equation%elements(i)%stroke%height, c => equation%elements(i)%c)
            line = line_of_element(element, equation%state%springs)
            if (element%is_signed) line(2) = side*line(2)
            select case (element%stroke%kind)
            case (along_axis)
               call add(horizontal, [of_sine, of_phi_sine], side*[line(1), a*line(2)])
               call add(normal, [of_constant, of_phi], [line(1), a*line(2)])
               call add(normal, [of_cosine, of_phi_cosine], -[line(1), a*line(2)])
            case (along_line)
               ! the force over the length is a constant and a part over the length
               line(1) = line(1) - line(2)*z
               call add(horizontal, [of_sine, of_cosine, of_sine_over, of_cosine_over], &
                  side*[line(2)*z, line(2)*a, line(1)*z, line(1)*a])
               call add(normal, [of_constant, of_sine, of_cosine], line(2)*[z, a, -z])
               call add(normal, [of_inverse, of_sine_over, of_cosine_over], line(1)*[z, a, -z])
            case (along_chord)
               if (abs(a) <= 0) then
                  call add(normal, [of_constant], line(:1))
                  cycle
               end if
               call add(horizontal, [of_half_sine, of_cosine, of_cosine_1], side*[line(1), &
                  a*line(2), a*c/2])
               call add(normal, [of_half_cosine, of_sine, of_rate, of_sine_1], [line(1), &
                  a*line(2), a*c/2, a*c/2])
            case default
               call add(normal, [of_constant, of_sine, of_cosine, of_sine_1, of_cosine_1], &
                  element%weight*[line(1), line(2)*a, -line(2)*z, c*a, -c*z])
            end select
         end associate
      end do

   contains

      !> Add factors of some terms.
      pure subroutine add(factors, terms, more)
         real(wp), intent(inout) :: factors(demand_terms)
         integer, intent(in) :: terms(:)
         real(wp), intent(in) :: more(:)

         factors(terms) = factors(terms) + more
      end subroutine add
   end subroutine add_elements

   !> Load the row of a reaction and its level.
   !>
   !> The friction demand |H|/N exceeds its largest value c where H - c N or -H - c N is positive.
   pure subroutine load_reaction(lane, q, sums, row, level)
      type(lane_state_t), intent(in) :: lane
      integer, intent(in) :: q
      !! number of the reaction
      real(wp), intent(in) :: sums(demand_terms, of_link)
      real(wp), intent(out) :: row(demand_terms)
      real(wp), intent(out) :: level

      associate (forces => lane%recorder%forces)
         level = forces%level(q)
         if (q == low_normal) then
            row = -sums(:, of_normal)
         else if (q == shear) then
            row = sums(:, of_shear)
         else
            row = merge(1, -1, q == demand)*sums(:, of_horizontal)
            if (lane%equation%parts%has_shear_key) return
            level = 0
            if (forces%largest_demand < 0 .or. forces%largest_demand >= huge(level)) then
               ! still unknown, or infinite
               row = 0
               row(of_constant) = -sign(1.0_wp, forces%largest_demand)
            else
               row = row - forces%largest_demand*sums(:, of_normal)
            end if
         end if
      end associate
   end subroutine load_reaction

   !> Search the step of a lane for larger demands.
   subroutine search_demands(lane, i, batch)
      type(lane_state_t), intent(inout) :: lane
      integer, intent(in) :: i
      !! number of the lane in the batch
      type(series_batch_t), intent(inout) :: batch
      integer :: n

      call follow_lane(lane, i, batch)
      do n = 1, size(batch%demands)
         if (.not. batch%lanes%exceeds(i, n) > 0) cycle
         call search_demand(lane, i, batch, n, 1)
         if (batch%lanes%two_sided(n) > 0) call search_demand(lane, i, batch, n, -1)
      end do
   end subroutine search_demands

   !> Search the step of a lane for a larger value of a demand in one direction.
   !>
   !> The largest H - c N shows a larger ratio, which is the next c, until none is larger.
   subroutine search_demand(lane, i, batch, n, direction)
      type(lane_state_t), intent(inout) :: lane
      integer, intent(in) :: i
      !! number of the lane in the batch
      type(series_batch_t), intent(inout) :: batch
      integer, intent(in) :: n
      !! number in the list
      integer, intent(in) :: direction
      !! +1 or -1
      integer, parameter :: most = 20
      real(wp), parameter :: same = 1.0e-13_wp
      class(peak_search_t), pointer :: search
      real(wp) :: c(0:batch%kernels%order - 2), largest, place, phi, slope, y(2), rates(2), before
      integer :: k, m, round

      associate (lanes => batch%lanes)
         m = merge(right, left, lanes%side(i) > 0)
         do round = 1, most
            do k = 0, ubound(c, 1)
               c(k) = direction*dot_product(lanes%rows(i, :of_constant - 1, m, n), &
                  lanes%base(i, k, :))
            end do
            c(0) = c(0) + direction*lanes%rows(i, of_constant, m, n)
            call find_largest(c, lanes%x(i), largest, place)
            if (.not. largest > lanes%level(i, n)) return
            call evaluate(lanes%p(i, :batch%kernels%order), place, phi, slope)
            y = lanes%side(i)*[max(phi, 0.0_wp), slope/lanes%h(i)]
            before = huge(before)
            associate (t => lanes%t(i) + place*lanes%h(i), of => batch%demands(n))
               search => search_of(lane%recorder, of%family)
               if (of%family == of_reactions .and. all(of%number /= [low_normal, shear]) &
                   .and. .not. lane%equation%parts%has_shear_key) then
                  before = lane%recorder%forces%largest_demand
               end if
               call rates_at(lane%equation, t, y, rates)
               call search_state(search, lane%equation, t, y, rates, of%number)
            end associate
            call load_demands(lane, i, batch)
            if (before >= huge(before)) return
            if (.not. lane%recorder%forces%largest_demand > before + same*abs(before)) return
         end do
      end associate
   end subroutine search_demand

   !> Move the equation of a lane to the side and the interval of its step.
   subroutine follow_lane(lane, i, batch)
      type(lane_state_t), intent(inout) :: lane
      integer, intent(in) :: i
      !! number of the lane in the batch
      type(series_batch_t), intent(in) :: batch
      integer :: side

      side = nint(batch%lanes%side(i))
      associate (equation => lane%equation)
         if (equation%state%side /= side) call enter_side(equation%model_t, equation%state, side)
         if (interval_of(equation) /= batch%interval(i)) call enter_interval(equation%model_t, &
            equation%state, min(batch%interval(i), interval_last(equation%motion)))
      end associate
   end subroutine follow_lane

end module rwmf_simulation_series_series_demands
