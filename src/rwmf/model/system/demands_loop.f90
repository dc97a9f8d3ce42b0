!> Loop over lanes that computes the demands of a building, as `rwmf_model_system_demands` does for
!> one state.
module rwmf_model_system_demands_loop
   use rwmf_core_kinds, only: wp
   use rwmf_model_effects_loops, only: follow_storeys
   use rwmf_model_effects_numbers, only: storeys_effect
   use rwmf_model_lanes, only: lane_count
   use rwmf_model_scene, only: first_wall, force_parts_t, term_t
   use rwmf_model_system_reactions_loop, only: lane_forces, lane_forces_t, reaction_count
   implicit none
   private

   public :: lane_demands, demand_constants, sections, section_terms

   integer, parameter :: of_unit = 1
   !! column in `building` of the reference mass of the floors [-]
   integer, parameter :: of_weight = 2
   !! column in `building` of the inverse weight of wall and floors [s2/m]
   integer, parameter :: of_floors = 2
   !! number of columns before those of the floors; each of these holds mass times height over that
   !! weight [s2]
   ! the columns of the inverse storey heights follow [1/m]

   integer, parameter :: sections = 2
   !! number of demands that are maxima along the wall: shear and moment
   integer, parameter :: section_terms = 4
   !! number of their coefficients, in columns behind all demands

contains

   !> Number of constants of one building.
   pure integer function demand_constants(floors, drifts) result(n)
      integer, intent(in) :: floors, drifts
      !! numbers of floors and of storey drifts

      n = of_floors + floors + drifts
   end function demand_constants

   !> Compute the reactions, followed by the demands with their signs.
   !>
   !> The demands are storey drifts [-], storey shears [m/s2], floor accelerations [m/s2] and
   !> overturning moment [m]. The magnitudes of the largest shear [m/s2] and moment [m2/s2] of the
   !> wall follow, each -1 without a wall. The last columns are the coefficients of `find_sections`.
   subroutine lane_demands(parts, floors, drifts, building, coef, y, ground, found)
      type(force_parts_t), intent(in) :: parts
      !! complete
      integer, intent(in) :: floors, drifts
      !! numbers of floors and of storey drifts; the storeys have states
      real(wp), intent(in) :: building(lane_count, demand_constants(floors, drifts))
      !! constants of the buildings
      real(wp), intent(in) :: coef(lane_count, parts%through_link%n_coef)
      !! coefficients of the loops, on the current side and the active branches
      real(wp), intent(in) :: y(lane_count, parts%through_link%n)
      !! (states)
      real(wp), intent(in) :: ground(lane_count, 2)
      !! horizontal and vertical ground acceleration [m/s2]
      real(wp), intent(out) :: found(lane_count, reaction_count + 2*drifts + floors + 1 &
         + sections*(1 + section_terms))
      !! reactions as in `lane_reactions`, then demands and coefficients, each in its unit
      type(lane_forces_t) :: forces
      real(wp) :: rates(lane_count, parts%through_link%n)
      real(wp), dimension(lane_count) :: roof, length
      !! displacement of the roof, and length that converts a rotation to a displacement [m]
      real(wp) :: R
      integer :: i, j, last
      type(term_t) :: term

      call lane_forces(parts, coef, y, ground, found, forces, rates)
      last = reaction_count + 2*drifts + floors
      found(:, last + 1) = 0
      found(:, last + 2:last + 1 + sections) = -1
      found(:, last + 2 + sections:) = 0
      if (drifts > 0) term = parts%through_link%terms(findloc(parts%through_link%terms%effect, &
         storeys_effect, dim=1))
      if (floors > 0) then
         length = 1
         if (parts%through_link%has_wall) length = 1/coef(:, first_wall + 1)
         !$omp simd private(R)
         do i = 1, lane_count
            R = length(i)
            roof(i) = R*forces%motion%side(i)*forces%motion%u(i)
            found(i, last) = R*forces%motion%side(i)*(forces%motion%k(i)*forces%motion%rate(i) &
               *forces%motion%rate(i) + forces%motion%j(i)*forces%phi_ddot(i)) + ground(i, 1)
         end do
         do j = 1, floors - 1
            found(:, last - floors + j) = rates(:, term%state + floors - 2 + j) + ground(:, 1)
         end do
         do j = 1, floors
            !$omp simd
            do i = 1, lane_count
               found(i, last + 1) = found(i, last + 1) + building(i, of_floors + j) &
                  *found(i, last - floors + j)
            end do
         end do
      end if
      if (drifts > 0) call follow_storeys(drifts, term%law, building(1, of_unit), &
         building(1, of_floors + floors + 1), coef(1, term%coef), y(1, min(term%state, &
         size(y, 2))), roof, found(1, reaction_count + 1))
      if (parts%through_link%has_wall) then
         call overturn_wall(coef, ground, forces, building(1, of_weight), found(1, last + 1))
         call find_sections(coef, ground, forces, found(1, last + 2))
      end if
   end subroutine lane_demands

   !> Add the moment of the wall's horizontal inertia about the ground, over the weight.
   pure subroutine overturn_wall(coef, ground, forces, over_weight, moment)
      real(wp), intent(in) :: coef(lane_count, first_wall + 7)
      real(wp), intent(in) :: ground(lane_count)
      !! [m/s2]
      type(lane_forces_t), intent(in) :: forces
      real(wp), intent(in) :: over_weight(lane_count)
      !! [s2/m]
      real(wp), intent(inout) :: moment(lane_count)
      !! [m]
      real(wp) :: h, b, s, c, turn, square, height
      integer :: i

      !$omp simd private(h, b, s, c, turn, square, height)
      do i = 1, lane_count
         associate (motion => forces%motion)
            h = coef(i, first_wall + 2)/coef(i, first_wall + 1)
            b = coef(i, first_wall + 3)/coef(i, first_wall + 1)
            s = 2*motion%half_sine(i)*motion%half_cosine(i)
            c = 1 - 2*motion%half_sine(i)*motion%half_sine(i)
            turn = motion%side(i)*forces%phi_ddot(i)
            square = motion%side(i)*motion%rate(i)*motion%rate(i)
            height = h*c + b*s
            moment(i) = moment(i) + over_weight(i)*((ground(i) + height*turn + (b*c - h*s)*square) &
               *height + (turn*(b*b*s*s + h*h*c*c) - square*(h*h - b*b)*s*c)/3)
         end associate
      end do
   end subroutine overturn_wall

   !> Find the largest shear and the largest moment along the wall, with the link at its top.
   !>
   !> Below the link, the shear is a parabola over the height and the moment a cubic. Their
   !> coefficients in Bernstein form bound the change of either between two instants. Above the link
   !> the shear is the part of the cable.
   pure subroutine find_sections(coef, ground, forces, found)
      real(wp), intent(in) :: coef(lane_count, first_wall + 7)
      real(wp), intent(in) :: ground(lane_count, 2)
      !! [m/s2]
      type(lane_forces_t), intent(in) :: forces
      real(wp), intent(inout) :: found(lane_count, sections*(1 + section_terms))
      !! shear [m/s2] and moment [m2/s2], then the coefficients of each from the link to the base.
      !! The part of the cable stands before the last coefficient of the shear.
      real(wp), parameter :: least = 1.0e-100_wp
      !! smallest denominator, against division by zero
      real(wp), dimension(lane_count) :: h, b, turn, push, across, about
      real(wp) :: s(lane_count, 4)
      !! distances below the top at which shear or moment may be largest [m]
      real(wp) :: sine, cosine, of_link, slope, rest, root, at
      integer :: i, j

      !$omp simd private(sine, cosine, of_link, slope, rest, root)
      do i = 1, lane_count
         h(i) = coef(i, first_wall + 2)/coef(i, first_wall + 1)
         b(i) = coef(i, first_wall + 3)/coef(i, first_wall + 1)
         sine = 2*forces%motion%side(i)*forces%motion%half_sine(i)*forces%motion%half_cosine(i)
         cosine = 1 - 2*forces%motion%half_sine(i)*forces%motion%half_sine(i)
         turn(i) = forces%motion%side(i)*forces%phi_ddot(i)
         push(i) = ground(i, 1)*cosine - (coef(i, first_wall + 7)/coef(i, first_wall + 1) &
            + ground(i, 2))*sine + forces%motion%side(i)*b(i)*forces%motion%rate(i) &
            *forces%motion%rate(i)
         across(i) = cosine*forces%cable(i, 1) - sine*forces%cable(i, 2)
         found(i, 1) = abs(across(i))
         found(i, 5) = across(i)
         of_link = cosine*forces%link(i, 1) - sine*forces%link(i, 2)
         across(i) = across(i) + of_link
         about(i) = 2*h(i)*across(i) - forces%motion%side(i)*(b(i) - 2*coef(i, first_wall + 5) &
            /coef(i, first_wall + 1))*(sine*forces%link(i, 1) + cosine*forces%link(i, 2))
         found(i, 1) = max(found(i, 1), abs(across(i)))
         found(i, 2) = abs(about(i) - 2*h(i)*across(i))
         slope = push(i) + 2*h(i)*turn(i)
         rest = turn(i)*b(i)*b(i)/3 - 2*h(i)*across(i)
         found(i, 3) = -across(i)
         found(i, 4) = slope/2 - across(i)
         found(i, 6) = slope - across(i) - h(i)*turn(i)
         found(i, 7) = 2*h(i)*across(i) - about(i)
         found(i, 8) = found(i, 7) + rest/3
         found(i, 9) = found(i, 8) + (rest + h(i)*slope)/3
         found(i, 10) = found(i, 7) + rest + h(i)*slope - h(i)*h(i)*turn(i)*2/3
         root = sqrt(max(slope*slope + 2*turn(i)*rest, 0.0_wp))
         root = -(slope + sign(root, slope))/2
         s(i, 1) = 2*h(i) + push(i)/sign(max(abs(turn(i)), least), turn(i))
         s(i, 2) = -2*root/sign(max(abs(turn(i)), least), turn(i))
         s(i, 3) = rest/sign(max(abs(root), least), root)
         s(i, 4) = 2*h(i)
      end do
      do j = 1, 4
         !$omp simd private(at, rest)
         do i = 1, lane_count
            at = max(0.0_wp, min(2*h(i), s(i, j)))
            rest = push(i) + turn(i)*(2*h(i) - at)
            found(i, 1) = max(found(i, 1), abs(at*(rest + turn(i)*at/2)/(2*h(i)) - across(i)))
            found(i, 2) = max(found(i, 2), abs(at*(rest*at/2 + turn(i)*(at*at + b(i)*b(i))/3) &
               /(2*h(i)) - (about(i) - (2*h(i) - at)*across(i))))
         end do
      end do
   end subroutine find_sections

end module rwmf_model_system_demands_loop
