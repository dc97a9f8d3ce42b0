!> Taylor series of a bending wall: kinematics of its top, its modes, and floors that are linked to
!> it one by one. The formulas are those of `rwmf_model_effects_bending_loop`.
!>
!> Each mode keeps its series between two coefficients in a memory (`mode_series`, and per shape
!> and storey).
module rwmf_model_series_bending_series
   use rwmf_core_kinds, only: wp
   use rwmf_model_effects_bending_loop, only: first_of_shape, first_smooth, fixed_columns, &
      mode_columns, shape_columns, spring_columns, smooth_columns
   use rwmf_model_lanes, only: lane_count, wall_coefficients
   use rwmf_model_scene, only: term_t
   use rwmf_model_series_series_motion, only: expand_weight, highest_order, product_of, &
      quotient_of, series_motion_t
   use rwmf_model_series_smooth_series, only: expand_power
   implicit none
   private

   public :: bend_series, expand_modes, release_series, bending_memory, locate_floors

   integer, parameter :: tip = 1, tip_rate = 2, tip_spin = 3, lean = 4, drag = 5, spin = 6, &
      square = 7, link = 8, gain = 9, heavy = 10, mass_before = 11, linked_mass = 12, common = 12
   !! series of the wall, and their number. Displacement of the tip over R [-], its rate [1/s], its
   !! product with phi' [1/s]. Sum of A_i q_i [m]. Half the rate of the inertia [m2/s]. phi'**2
   !! [1/s2]. cos(phi)**2 [-]. Force at the top [m/s2]. j cos(phi) [-]. g and vertical acceleration
   !! [m/s2]. Inertia of the wall [-]. Mass that moves with the top over m_w [-].
   integer, parameter :: place = 1, slope = 2, rate = 3, bias = 4, spun = 5, mass = 6, load = 7, &
      coupling = 8, force = 9, own_coupling = 10, own_force = 11, share = 12, rest = 13, own = 13
   !! series of each shape, and their number. Displacement [m], its derivative by phi [m], rate
   !! [m/s], acceleration for phi'' = 0 and q'' = 0 [m/s2]. q phi' [m/s]. Mass and force of linked
   !! floors. Coupling with phi'' [m] and force [m/s2] of the mode, both in the vectors V as well.
   !! Accelerations per phi'' [m] and for phi'' = 0 [m/s2].

contains

   !> Number of series that a bending wall keeps between two coefficients.
   pure integer function bending_memory(term) result(n)
      type(term_t), intent(in) :: term
      !! its law is the number of modes

      n = common + own*(term%law + 1) + 4*term%n
      if (term%floors == 0 .and. term%n_states > 2*term%law) n = n + term%n
   end function bending_memory

   !> Replace kinematics, inertia and weight of the rigid wall by those of the bending wall.
   pure subroutine bend_series(n, term, coef, wall, y, of, motion)
      integer, intent(in) :: n
      !! number of the coefficient
      type(term_t), intent(in) :: term
      real(wp), intent(in) :: coef(lane_count, term%n_coef)
      !! coefficients as of `add_modes`
      real(wp), intent(in) :: wall(lane_count, wall_coefficients)
      !! coefficients as of `move_wall`
      real(wp), intent(in) :: y(lane_count, 0:highest_order, 2*term%law)
      !! series of q_i [m] and q_i' [m/s]
      real(wp), intent(inout) :: of(lane_count, 0:highest_order, bending_memory(term))
      !! (coefficients, `bending_memory`)
      type(series_motion_t), intent(inout) :: motion
      real(wp) :: spread(lane_count)
      integer :: j

      associate (modes => term%law)
         of(:, n, tip:lean) = 0
         of(:, n, drag) = 0
         spread = 0
         do j = 1, modes
            associate (A => coef(:, fixed_columns + j), m => coef(:, fixed_columns + 2*modes + j))
               of(:, n, tip) = of(:, n, tip) + y(:, n, j)
               of(:, n, tip_rate) = of(:, n, tip_rate) + y(:, n, modes + j)
               of(:, n, lean) = of(:, n, lean) + A*y(:, n, j)
               spread = spread + m*product_of(n, y(1, 0, j), y(1, 0, j))
               of(:, n, drag) = of(:, n, drag) + m*product_of(n, y(1, 0, j), &
                  y(1, 0, modes + j)) - coef(:, 2)*A*motion%side*y(:, n, modes + j)
            end associate
         end do
         of(:, n, tip) = motion%side*of(:, n, tip)/coef(:, 1)
         of(:, n, tip_rate) = motion%side*of(:, n, tip_rate)/coef(:, 1)
         of(:, n, lean) = motion%side*of(:, n, lean)
         of(:, n, tip_spin) = product_of(n, of(1, 0, tip), motion%rate)
         motion%u(:, n) = motion%u(:, n) + product_of(n, motion%cosine, of(1, 0, tip))
         motion%j(:, n) = motion%j(:, n) - product_of(n, motion%sine, of(1, 0, tip))
         motion%lever(:, n) = motion%j(:, n)
         motion%u_rate(:, n) = motion%u_rate(:, n) + product_of(n, motion%cosine, &
            of(1, 0, tip_rate)) - product_of(n, motion%sine, of(1, 0, tip_spin))
         motion%bias(:, n) = motion%bias(:, n) - product_of(n, motion%cosine_rate, &
            of(1, 0, tip_spin)) - 2*product_of(n, motion%sine_rate, of(1, 0, tip_rate))
         motion%s(:, n) = motion%s(:, n) - product_of(n, motion%cosine, of(1, 0, lean))/coef(:, 1)
         motion%c(:, n) = motion%c(:, n) - product_of(n, motion%sine, of(1, 0, lean))/coef(:, 1)
         motion%inertia(:, n) = motion%inertia(:, n) + (spread - 2*coef(:, 2)*of(:, n, lean)) &
            /coef(:, 1)**2
         of(:, n, mass_before) = motion%inertia(:, n)
      end associate
      call expand_weight(n, wall, motion)
   end subroutine bend_series

   !> Subtract the share of the modes from inertia and moment; the terms so far act through the link
   !> on the top.
   pure subroutine expand_modes(n, term, coef, y, of, motion, rates)
      integer, intent(in) :: n
      !! number of the coefficient
      type(term_t), intent(in) :: term
      real(wp), intent(in) :: coef(lane_count, term%n_coef)
      !! coefficients as of `add_modes`
      real(wp), intent(in) :: y(lane_count, 0:highest_order, term%state + term%n_states - 1)
      !! series of all states of the scene
      real(wp), intent(inout) :: of(lane_count, 0:highest_order, bending_memory(term))
      !! (coefficients, `bending_memory`)
      type(series_motion_t), intent(inout) :: motion
      real(wp), intent(inout) :: rates(lane_count, term%state + term%n_states - 1)
      !! coefficients n of the rates of all states
      real(wp) :: top(lane_count), linked(lane_count), weight(lane_count), pushed_back(lane_count)
      integer :: j, q

      q = term%state - 1
      associate (modes => term%law, R => coef(:, 1))
         top = R*(motion%wall_moment(:, n) - motion%moment(:, n))
         of(:, n, link) = quotient_of(n, top, motion%lever, of(1, 0, link))
         of(:, n, spin) = product_of(n, motion%rate, motion%rate)
         of(:, n, square) = product_of(n, motion%cosine, motion%cosine)
         of(:, n, gain) = product_of(n, motion%j, motion%cosine)
         of(:, n, heavy) = motion%upward(:, n)
         if (n == 0) of(:, 0, heavy) = of(:, 0, heavy) + coef(:, 4)
         linked = (motion%inertia(:, 0) - of(:, 0, mass_before))/(motion%lever(:, 0)*motion%j(:, 0))
         if (n == 0) of(:, 0, linked_mass) = linked
         linked = of(:, 0, linked_mass)
         motion%moment(:, n) = motion%moment(:, n) &
            - 2*product_of(n, of(1, 0, drag), motion%rate)/R**2
         weight = product_of(n, of(1, 0, heavy), motion%sine) - R*product_of(n, motion%push, &
            motion%cosine)
         pushed_back = product_of(n, motion%cosine, of(1, 0, link))
         do j = 1, modes
            associate (A => coef(:, fixed_columns + j), S => coef(:, fixed_columns + modes + j), &
                       m => coef(:, fixed_columns + 2*modes + j), &
                       k => coef(:, fixed_columns + 3*modes + j), &
                       c => coef(:, fixed_columns + 4*modes + j))
               of(:, n, at(j, coupling)) = linked*R*of(:, n, gain)
               if (n == 0) of(:, 0, at(j, coupling)) = of(:, 0, at(j, coupling)) + S
               of(:, n, at(j, force)) = m*motion%side*product_of(n, of(1, 0, spin), &
                  y(1, 0, q + j)) - coef(:, 2)*A*of(:, n, spin) - motion%side*(k*y(:, n, q + j) &
                  + c*y(:, n, q + modes + j)) + weight*A - pushed_back
            end associate
         end do
         if (term%n > 0) call move_shapes(n, term, coef, y(1, 0, q + 1), of, motion)
         if (term%floors > 0) then
            call expand_springs(n, term, coef, y, of, motion, rates)
         else if (term%n > 0) then
            call expand_linked_floors(n, term, coef, of, motion)
            if (term%n_states > 2*modes) call expand_smooth_floors(n, term, coef, &
               y(1, 0, q + 1), of, motion, rates(1, q + 1))
         end if
         call eliminate(n, modes, coef, of, motion)
      end associate
   end subroutine expand_modes

   !> Place of a series of a mode, or of the straight wall (0), in the memory.
   pure integer function at(mode, series)
      integer, intent(in) :: mode, series

      at = common + own*mode + series
   end function at

   !> Expand the displacements of the shapes: the straight wall, number 0, and the modes.
   pure subroutine move_shapes(n, term, coef, y, of, motion)
      integer, intent(in) :: n
      type(term_t), intent(in) :: term
      real(wp), intent(in) :: coef(lane_count, term%n_coef)
      real(wp), intent(in) :: y(lane_count, 0:highest_order, 2*term%law)
      real(wp), intent(inout) :: of(lane_count, 0:highest_order, bending_memory(term))
      type(series_motion_t), intent(in) :: motion
      integer :: j

      associate (modes => term%law, R => coef(:, 1), side => motion%side)
         of(:, n, at(0, place)) = R*motion%u(:, n)
         of(:, n, at(0, slope)) = R*motion%j(:, n)
         of(:, n, at(0, rate)) = R*motion%u_rate(:, n)
         of(:, n, at(0, bias)) = R*motion%bias(:, n)
         do j = 1, modes
            of(:, n, at(j, spun)) = side*product_of(n, y(1, 0, j), motion%rate)
            of(:, n, at(j, place)) = side*product_of(n, motion%cosine, y(1, 0, j))
            of(:, n, at(j, slope)) = -side*product_of(n, motion%sine, y(1, 0, j))
            of(:, n, at(j, rate)) = side*product_of(n, motion%cosine, y(1, 0, modes + j)) &
               - product_of(n, motion%sine, of(1, 0, at(j, spun)))
            of(:, n, at(j, bias)) = -product_of(n, motion%cosine_rate, of(1, 0, at(j, spun))) &
               - 2*side*product_of(n, motion%sine_rate, y(1, 0, modes + j))
            of(:, n, at(0, place):at(0, bias)) = of(:, n, at(0, place):at(0, bias)) &
               - of(:, n, at(j, place):at(j, bias))
         end do
      end associate
   end subroutine move_shapes

   !> Add masses, storeys and dampers of floors that are linked one by one.
   pure subroutine expand_linked_floors(n, term, coef, of, motion)
      integer, intent(in) :: n
      type(term_t), intent(in) :: term
      real(wp), intent(in) :: coef(lane_count, term%n_coef)
      real(wp), intent(inout) :: of(lane_count, 0:highest_order, bending_memory(term))
      type(series_motion_t), intent(inout) :: motion
      integer :: j, k, row

      associate (modes => term%law, R => coef(:, 1))
         do j = 0, modes
            row = first_of_shape(modes, j) + shape_columns + 1
            of(:, n, at(j, load)) = coef(:, row - 2)*R*motion%push(:, n)
            if (n == 0) of(:, 0, at(j, load)) = of(:, 0, at(j, load)) + motion%side &
               *coef(:, row - 1)
            of(:, n, at(j, mass)) = 0
            do k = 0, modes
               of(:, n, at(j, load)) = of(:, n, at(j, load)) + coef(:, row + k) &
                  *of(:, n, at(k, bias)) + coef(:, row + modes + 1 + k)*of(:, n, at(k, place)) &
                  + coef(:, row + 2*(modes + 1) + k)*of(:, n, at(k, rate))
               of(:, n, at(j, mass)) = of(:, n, at(j, mass)) + coef(:, row + k) &
                  *of(:, n, at(k, slope))
            end do
            motion%moment(:, n) = motion%moment(:, n) - product_of(n, of(1, 0, at(j, slope)), &
               of(1, 0, at(j, load)))/R**2
            motion%inertia(:, n) = motion%inertia(:, n) + product_of(n, of(1, 0, at(j, slope)), &
               of(1, 0, at(j, mass)))/R**2
            if (j == 0) cycle
            of(:, n, at(j, coupling)) = of(:, n, at(j, coupling)) + product_of(n, motion%cosine, &
               of(1, 0, at(j, mass)))
            of(:, n, at(j, force)) = of(:, n, at(j, force)) - product_of(n, motion%cosine, &
               of(1, 0, at(j, load)))
         end do
      end associate
   end subroutine expand_linked_floors

   !> Add the hysteretic shears of smooth storeys and expand the rates of their states.
   pure subroutine expand_smooth_floors(n, term, coef, y, of, motion, rates)
      integer, intent(in) :: n
      type(term_t), intent(in) :: term
      real(wp), intent(in) :: coef(lane_count, term%n_coef)
      real(wp), intent(in) :: y(lane_count, 0:highest_order, term%n_states)
      !! series of q_i [m], q_i' [m/s] and z [-]
      real(wp), intent(inout) :: of(lane_count, 0:highest_order, bending_memory(term))
      type(series_motion_t), intent(inout) :: motion
      real(wp), intent(inout) :: rates(lane_count, term%n_states)
      integer :: first, drift, k, power, row, storey

      first = first_smooth(term)
      associate (modes => term%law, floors => term%n, R => coef(:, 1))
         do storey = 1, floors
            row = first + smooth_columns*floors + storey
            drift = at(modes, own) + 4*(storey - 1) + 1
            power = drift + 1
            of(:, n, drift) = 0
            do k = 0, modes
               of(:, n, drift) = of(:, n, drift) + coef(:, row + k*floors)*of(:, n, at(k, rate))
            end do
            call expand_power(n, 0, coef(1, first + 3*floors + storey), &
               motion%laws%negligible_state, y(1, 0, 2*modes + storey), of(1, 0, power))
            rates(:, 2*modes + storey) = motion%side*coef(:, first + floors + storey) &
               *(of(:, n, drift) - coef(:, first + 2*floors + storey)*product_of(n, &
               of(1, 0, drift), of(1, 0, power)))
            of(:, n, power + 1) = motion%side*coef(:, first + storey)*y(:, n, 2*modes + storey)
            call pull_shapes(n, modes, coef(1, row), floors, R, power + 1, of, motion)
         end do
      end associate
   end subroutine expand_smooth_floors

   !> Add the forces of springs between wall and floors, on both.
   pure subroutine expand_springs(n, term, coef, y, of, motion, rates)
      integer, intent(in) :: n
      type(term_t), intent(in) :: term
      real(wp), intent(in) :: coef(lane_count, term%n_coef)
      real(wp), intent(in) :: y(lane_count, 0:highest_order, term%state + term%n_states - 1)
      !! series of all states
      real(wp), intent(inout) :: of(lane_count, 0:highest_order, bending_memory(term))
      type(series_motion_t), intent(inout) :: motion
      real(wp), intent(inout) :: rates(lane_count, term%state + term%n_states - 1)
      !! coefficients n of the rates of all states
      real(wp) :: push(lane_count)
      integer :: floor, k, last, row

      last = term%floors - 1
      associate (modes => term%law, R => coef(:, 1))
         do floor = 1, term%n
            row = fixed_columns + (mode_columns + modes)*modes + (floor - 1)*(spring_columns &
               + modes + 1) + 3
            push = -motion%side*y(:, n, last + floor)
            do k = 0, modes
               push = push + coef(:, row + k)*of(:, n, at(k, place))
            end do
            push = coef(:, row - 1)*push
            associate (place => at(modes, own) + 4*(floor - 1) + 1)
               of(:, n, place) = push
               rates(:, last + term%n + floor) = rates(:, last + term%n + floor) &
                  + motion%side*push*coef(:, row - 2)
               call pull_shapes(n, modes, coef(1, row), 1, R, place, of, motion)
            end associate
         end do
      end associate
   end subroutine expand_springs

   !> Let a force on the displacement of the shapes at one height act on wall and modes.
   pure subroutine pull_shapes(n, modes, row, stride, R, pull, of, motion)
      integer, intent(in) :: n
      integer, intent(in) :: modes
      integer, intent(in) :: stride
      !! columns from shape to shape in `row`
      real(wp), intent(in) :: row(lane_count, 0:modes*stride)
      !! displacement of each shape at this height [-]
      real(wp), intent(in) :: R(lane_count)
      !! [m]
      integer, intent(in) :: pull
      !! place of the force in the memory
      real(wp), intent(inout) :: of(lane_count, 0:highest_order, max(pull, at(modes, own)))
      type(series_motion_t), intent(inout) :: motion
      integer :: k

      do k = 0, modes
         motion%moment(:, n) = motion%moment(:, n) - row(:, k*stride)*product_of(n, &
            of(1, 0, at(k, slope)), of(1, 0, pull))/R**2
         if (k > 0) of(:, n, at(k, force)) = of(:, n, at(k, force)) - row(:, k*stride) &
            *product_of(n, motion%cosine, of(1, 0, pull))
      end do
   end subroutine pull_shapes

   !> Solve for the accelerations of the modes in the vectors V, per phi'' and for phi'' = 0, and
   !> subtract their share from inertia and moment.
   pure subroutine eliminate(n, modes, coef, of, motion)
      integer, intent(in) :: n
      integer, intent(in) :: modes
      real(wp), intent(in) :: coef(lane_count, fixed_columns + (mode_columns + modes)*modes)
      real(wp), intent(inout) :: of(lane_count, 0:highest_order, at(modes, own))
      type(series_motion_t), intent(inout) :: motion
      real(wp) :: divisor(lane_count, 0:highest_order)
      integer :: j, k, row

      do j = 1, modes
         row = fixed_columns + (mode_columns + j - 1)*modes
         divisor(:, :n) = spread(coef(:, fixed_columns + 5*modes + j), 2, n + 1)*of(:, :n, square)
         divisor(:, 0) = divisor(:, 0) + 1
         of(:, n, at(j, own_coupling)) = 0
         of(:, n, at(j, own_force)) = 0
         do k = 1, modes
            of(:, n, at(j, own_coupling)) = of(:, n, at(j, own_coupling)) + coef(:, row + k) &
               *of(:, n, at(k, coupling))
            of(:, n, at(j, own_force)) = of(:, n, at(j, own_force)) + coef(:, row + k) &
               *of(:, n, at(k, force))
         end do
         of(:, n, at(j, share)) = quotient_of(n, of(:, n, at(j, own_coupling)), divisor, &
            of(1, 0, at(j, share)))
         of(:, n, at(j, rest)) = quotient_of(n, of(:, n, at(j, own_force)), divisor, &
            of(1, 0, at(j, rest)))
         motion%inertia(:, n) = motion%inertia(:, n) &
            - product_of(n, of(1, 0, at(j, own_coupling)), of(1, 0, at(j, share)))/coef(:, 1)**2
         motion%moment(:, n) = motion%moment(:, n) - product_of(n, of(1, 0, at(j, own_force)), &
            of(1, 0, at(j, share)))/coef(:, 1)**2
      end do
   end subroutine eliminate

   !> Expand the rates of the modes from the series of phi''.
   pure subroutine release_series(n, term, coef, y, of, motion, rates)
      integer, intent(in) :: n
      !! number of the coefficient
      type(term_t), intent(in) :: term
      real(wp), intent(in) :: coef(lane_count, term%n_coef)
      !! coefficients as of `add_modes`
      real(wp), intent(in) :: y(lane_count, 0:highest_order, 2*term%law)
      !! series of q_i [m] and q_i' [m/s]
      real(wp), intent(in) :: of(lane_count, 0:highest_order, bending_memory(term))
      !! (coefficients, series)
      type(series_motion_t), intent(in) :: motion
      real(wp), intent(inout) :: rates(lane_count, 2*term%law)
      !! coefficients n of the rates of these states [m/s], [m/s2]
      integer :: j, k

      associate (modes => term%law)
         rates(:, 1:modes) = y(:, n, modes + 1:2*modes)
         rates(:, modes + 1:2*modes) = 0
         do k = 1, modes
            associate (own => motion%side*(of(:, n, at(k, rest)) - product_of(n, &
                       of(1, 0, at(k, share)), motion%turn)))
               do j = 1, modes
                  rates(:, modes + j) = rates(:, modes + j) + coef(:, fixed_columns &
                     + (mode_columns + k - 1)*modes + j)*own
               end do
            end associate
         end do
      end associate
   end subroutine release_series

   !> Locate the smooth storeys, as `locate_spring`.
   pure subroutine locate_floors(term, n, first)
      type(term_t), intent(in) :: term
      integer, intent(out) :: n
      !! number of storeys
      integer, intent(out) :: first(3)
      !! numbers for the lowest storey; those of the others follow

      n = merge(term%n, 0, term%floors == 0 .and. term%n_states > 2*term%law)
      first = term%coef + first_smooth(term) + [0, 2*term%n, 3*term%n]
      first(1) = term%state + 2*term%law
   end subroutine locate_floors

end module rwmf_model_series_bending_series
