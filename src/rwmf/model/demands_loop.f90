!> Loop over lanes of the demands of a building, as `rwmf_model_demands` finds them for one state.
module rwmf_model_demands_loop
   use rwmf_core_kinds, only: wp
   use rwmf_model_effects_numbers, only: storeys_effect
   use rwmf_model_effects_storeys_storeys_loop, only: no_hysteresis
   use rwmf_model_lanes, only: lane_count
   use rwmf_model_reactions_loop, only: lane_forces, lane_forces_t, reaction_count
   use rwmf_model_scene, only: first_wall, force_parts_t, term_t
   implicit none
   private

   public :: lane_demands, demand_constants

   integer, parameter :: of_unit = 1
   !! columns of the constants: the mass that those of the floors are over [-]
   integer, parameter :: of_weight = 2
   !! one over the weight of wall and floors [s2/m]
   integer, parameter :: of_floors = 2
   !! before mass times height of each floor over that weight [s2]
   ! then one over the height of each storey [1/m]

contains

   !> Number of constants of a building.
   pure integer function demand_constants(floors, storeys) result(n)
      integer, intent(in) :: floors, storeys

      n = of_floors + floors + storeys
   end function demand_constants

   !> Reactions, and behind them the magnitudes of the demands: drifts [-] and shears [m/s2] of the
   !> storeys, accelerations of the floors [m/s2], overturning moment [m], largest shear [m/s2] and
   !> moment [m2/s2] inside the wall.
   subroutine lane_demands(parts, floors, storeys, building, coef, y, ground, found)
      type(force_parts_t), intent(in) :: parts
      !! complete
      integer, intent(in) :: floors, storeys
      !! number of them; storeys move by themselves
      real(wp), intent(in) :: building(lane_count, demand_constants(floors, storeys))
      !! constants of the buildings
      real(wp), intent(in) :: coef(lane_count, parts%through_link%n_coef)
      !! coefficients of the loops, on the side and the branches in force
      real(wp), intent(in) :: y(lane_count, parts%through_link%n)
      !! (states)
      real(wp), intent(in) :: ground(lane_count, 2)
      !! acceleration of the ground, horizontal and vertical [m/s2]
      real(wp), intent(out) :: found(lane_count, reaction_count + 2*storeys + floors + 3)
      type(lane_forces_t) :: forces
      real(wp) :: rates(lane_count, parts%through_link%n)
      real(wp) :: roof(lane_count)
      !! displacement [m]
      real(wp) :: R
      integer :: i, j, last
      type(term_t) :: term

      call lane_forces(parts, coef, y, ground, found, forces, rates)
      last = reaction_count + 2*storeys + floors
      found(:, last + 1:) = 0
      if (storeys > 0) term = parts%through_link%terms(findloc(parts%through_link%terms%effect, &
         storeys_effect, dim=1))
      if (floors > 0) then
         !$omp simd private(R)
         do i = 1, lane_count
            R = 1
            if (parts%through_link%has_wall) R = 1/coef(i, first_wall + 1)
            associate (motion => forces%motion)
               roof(i) = R*motion%side(i)*motion%u(i)
               found(i, last) = R*motion%side(i)*(motion%k(i)*motion%rate(i)*motion%rate(i) &
                  + motion%j(i)*forces%phi_ddot(i)) + ground(i, 1)
            end associate
         end do
         do j = 1, floors - 1
            found(:, last - floors + j) = rates(:, term%state + floors - 2 + j) + ground(:, 1)
         end do
         do j = 1, floors
            !$omp simd
            do i = 1, lane_count
               found(i, last + 1) = found(i, last + 1) + building(i, of_floors + j) &
                  *found(i, last - floors + j)
               found(i, last - floors + j) = abs(found(i, last - floors + j))
            end do
         end do
      end if
      if (storeys > 0) call follow_storeys(storeys, term%law, building, coef(1, term%coef), &
         y(1, min(term%state, size(y, 2))), roof, found(1, reaction_count + 1))
      if (parts%through_link%has_wall) then
         call overturn_wall(coef, ground, forces, building(1, of_weight), found(1, last + 1))
         call find_sections(coef, ground, forces, found(1, last + 2))
      end if
      !$omp simd
      do i = 1, lane_count
         found(i, last + 1) = abs(found(i, last + 1))
      end do
   end subroutine lane_demands

   !> Drifts and shears of storeys that move by themselves.
   pure subroutine follow_storeys(n, law, building, coef, y, roof, found)
      integer, intent(in) :: n
      !! number of storeys and floors
      integer, intent(in) :: law
      !! of the storeys
      real(wp), intent(in) :: building(lane_count, demand_constants(n, n))
      real(wp), intent(in) :: coef(lane_count, *)
      !! of `add_floors`
      real(wp), intent(in) :: y(lane_count, *)
      !! states of the floors
      real(wp), intent(in) :: roof(lane_count)
      !! [m]
      real(wp), intent(inout) :: found(lane_count, 2*n)
      real(wp) :: drift(lane_count), shear(lane_count)
      integer :: i, j

      do j = 1, n
         drift = roof
         if (j < n) drift = y(:, j)
         if (j > 1) drift = drift - y(:, j - 1)
         !$omp simd
         do i = 1, lane_count
            shear(i) = coef(i, 1 + j)*drift(i) + coef(i, n + 1 + j)
            found(i, j) = abs(drift(i)*building(i, of_floors + n + j))
         end do
         if (law /= no_hysteresis) shear = shear + coef(:, 3*n + 1 + n**2 + j)*y(:, 2*n - 2 + j)
         !$omp simd
         do i = 1, lane_count
            found(i, n + j) = abs(shear(i)*building(i, of_unit))
         end do
      end do
   end subroutine follow_storeys

   !> Moment of the wall's horizontal inertia about the ground, over the weight.
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

   !> The largest shear and the largest moment along the wall, which the link holds at its top.
   pure subroutine find_sections(coef, ground, forces, found)
      real(wp), intent(in) :: coef(lane_count, first_wall + 7)
      real(wp), intent(in) :: ground(lane_count, 2)
      !! [m/s2]
      type(lane_forces_t), intent(in) :: forces
      real(wp), intent(inout) :: found(lane_count, 2)
      !! shear [m/s2] and moment [m2/s2]
      real(wp), parameter :: least = 1.0e-100_wp
      !! denominator
      real(wp) :: h, b, turn, push, sine, cosine, across, about, bend, slope, rest, root, s(4)
      integer :: i, j

      !$omp simd private(h, b, turn, push, sine, cosine, across, about, bend, slope, rest, root, s)
      do i = 1, lane_count
         associate (motion => forces%motion)
            h = coef(i, first_wall + 2)/coef(i, first_wall + 1)
            b = coef(i, first_wall + 3)/coef(i, first_wall + 1)
            sine = 2*motion%side(i)*motion%half_sine(i)*motion%half_cosine(i)
            cosine = 1 - 2*motion%half_sine(i)*motion%half_sine(i)
            turn = motion%side(i)*forces%phi_ddot(i)
            push = ground(i, 1)*cosine - (coef(i, first_wall + 7)/coef(i, first_wall + 1) &
               + ground(i, 2))*sine + motion%side(i)*b*motion%rate(i)*motion%rate(i)
            across = cosine*forces%cable(i, 1) - sine*forces%cable(i, 2)
            found(i, 1) = abs(across)
            root = cosine*forces%link(i, 1) - sine*forces%link(i, 2)
            about = 2*h*(across + root) - motion%side(i)*(b - 2*coef(i, first_wall + 5) &
               /coef(i, first_wall + 1))*(sine*forces%link(i, 1) + cosine*forces%link(i, 2))
            across = across + root
         end associate
         ! where shear or moment is stationary below the top, and both ends
         bend = -turn/2
         slope = push + 2*h*turn
         rest = turn*b*b/3 - 2*h*across
         root = slope*slope - 4*bend*rest
         root = -(slope + sign(sqrt(max(root, 0.0_wp)), slope))/2
         s(1) = 2*h + push/sign(max(abs(turn), least), turn)
         s(2) = root/sign(max(abs(bend), least), bend)
         s(3) = rest/sign(max(abs(root), least), root)
         s(4) = 2*h
         found(i, 1) = max(found(i, 1), abs(across))
         found(i, 2) = abs(about - 2*h*across)
         do j = 1, 4
            root = max(0.0_wp, min(2*h, s(j)))
            rest = push + turn*(2*h - root)
            found(i, 1) = max(found(i, 1), abs(root*(rest + turn*root/2)/(2*h) - across))
            found(i, 2) = max(found(i, 2), abs(root*(rest*root/2 + turn*(root*root + b*b)/3)/(2*h) &
               - (about - (2*h - root)*across)))
         end do
      end do
   end subroutine find_sections

end module rwmf_model_demands_loop
