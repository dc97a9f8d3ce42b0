!> Estimates of the reactions inside a short piece of a step, without a further step.
!>
!> They use the quintic through states and accelerations at both ends. Estimates locate peaks; the
!> reported values come from the integrator.
module rwmf_simulation_recorder_reaction_estimates
   use rwmf_core_kinds, only: wp
   use rwmf_math_roots, only: vertex_of_parabola
   use rwmf_model_equation, only: equation_t, ground, vertical_ground
   use rwmf_model_system_assembly, only: rates_at
   use rwmf_model_system_reactions_loop, only: demand, lane_reactions, low_normal, &
      n_quantities => reaction_count, shear
   use rwmf_simulation_events_step_quartic, only: quartic_of, quartic_t, quintic_of, slope_at, &
      value_at
   use rwmf_simulation_events_step_view, only: accelerations, is_short, step_view_t
   implicit none
   private

   public :: estimate_reactions, has_estimate, place_of_peak, fastest_of, &
      frequency_with_springs
   public :: largest_quotient, is_sharp, turns_of_quotient
   public :: n_nodes, node
   public :: nowhere, inside, at_first, at_last

   integer, parameter :: n_nodes = 5
   real(wp), parameter :: node(n_nodes) = [0.0_wp, 0.5_wp - sqrt(0.125_wp), 0.5_wp, &
      0.5_wp + sqrt(0.125_wp), 1.0_wp]
   !! Chebyshev-Lobatto nodes over a piece [-]

   integer, parameter :: nowhere = 0
   !! no peak reaches the level
   integer, parameter :: inside = 1
   !! a peak that may reach it may be inside the piece
   integer, parameter :: at_first = 2
   !! the peak is at the beginning of the piece
   integer, parameter :: at_last = 3
   !! the peak is at the end of the piece

contains

   !> True if the quintic of a piece is accurate enough for its reactions.
   logical function has_estimate(piece)
      type(step_view_t), intent(in) :: piece
      real(wp), parameter :: short = 1
      !! at this length the quintic differs from a sine by 2e-5 of its amplitude [rad]
      real(wp), parameter :: shortest = 1.0e-7_wp
      !! at this length the velocities of the quintic have eight digits left [rad]

      has_estimate = piece%equation%parts%is_complete .and. piece%equation%n == 2 &
         .and. (piece%t_b - piece%t_a)*fastest_of(piece%equation) > shortest
      if (has_estimate) has_estimate = is_short(piece, short, fastest_of(piece%equation))
   end function has_estimate

   !> Highest natural frequency of a scene [rad/s].
   pure real(wp) function fastest_of(equation) result(frequency)
      type(equation_t), intent(in) :: equation

      frequency = max(equation%p%omega_s, equation%floors%max_frequency, sqrt(equation%p%g &
         /equation%p%R))
   end function fastest_of

   !> Highest natural frequency, including that of the wall on its springs and cable [rad/s].
   real(wp) function frequency_with_springs(equation, y) result(frequency)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp), parameter :: small = 1.0e-6_wp
      !! [rad]
      real(wp), dimension(size(y)) :: beside, rates, rates_beside

      frequency = fastest_of(equation)
      if (.not. equation%has_wall) return
      beside = y
      beside(1) = y(1) + sign(small, y(1))
      call rates_at(equation, 0.0_wp, y, rates)
      call rates_at(equation, 0.0_wp, beside, rates_beside)
      frequency = max(frequency, sqrt(max(0.0_wp, (rates(2) - rates_beside(2)) &
         /(beside(1) - y(1)))))
   end function frequency_with_springs

   !> Estimate the reactions at the nodes of a piece.
   subroutine estimate_reactions(piece, found)
      type(step_view_t), intent(in) :: piece
      !! piece for which `has_estimate` is true
      real(wp), intent(out) :: found(n_quantities, n_nodes)
      !! -N [m/s2], |H|/N [-] and |V| [m/s2] at each node, from `lane_reactions`
      type(quartic_t) :: quintic
      real(wp) :: y_ddot(2), y(1, 2), acceleration(1, 2)
      real(wp) :: at(1, n_quantities)
      real(wp) :: h, t
      integer :: i

      h = piece%t_b - piece%t_a
      associate (equation => piece%equation, y_a => piece%y_a, y_b => piece%y_b)
         y_ddot = accelerations(piece)
         quintic = quintic_of(quartic_of(h, [y_a(1), y_b(1)], [y_a(2), y_b(2)], y_ddot(1)), &
            h**2*y_ddot(2))
         acceleration = 0
         do i = 1, n_nodes
            t = piece%t_a + h*node(i)
            y(1, 1) = value_at(quintic%c, node(i))
            y(1, 2) = slope_at(quintic%c, node(i))/h
            acceleration(1, 1) = ground(equation, t)
            if (equation%has_vertical) acceleration(1, 2) = vertical_ground(equation, t)
            call lane_reactions(equation%parts, equation%state%coef, y, acceleration, at)
            found(:, i) = [at(1, low_normal), abs(at(1, [demand, shear]))]
         end do
      end associate
   end subroutine estimate_reactions

   !> Place of a possible peak above a level, from values at the nodes.
   !>
   !> The peak follows from the parabola through the largest value and its neighbours. If an end is
   !> largest, the slope of the polynomial through all nodes shows a peak beside it.
   pure integer function place_of_peak(found, level) result(place)
      real(wp), intent(in) :: found(n_nodes)
      !! the quantity at the nodes, in any unit
      real(wp), intent(in) :: level
      !! value above which a peak counts, in the same unit
      real(wp), parameter :: margin = 0.1_wp
      !! tolerance over the range of the samples, and over the width of the parabola [-]
      real(wp) :: vertex, peak, width, slope, bend
      integer :: best, k

      place = nowhere
      if (.not. maxval(found) < huge(peak)) then
         if (level < huge(peak)) place = inside
         return
      end if
      best = maxloc(found, dim=1)
      k = min(max(best, 2), n_nodes - 1)
      width = node(k + 1) - node(k - 1)
      slope = (found(k) - found(k - 1))/(node(k) - node(k - 1))
      bend = ((found(k + 1) - found(k))/(node(k + 1) - node(k)) - slope)/width
      vertex = vertex_of_parabola(node(k - 1:k + 1), found(k - 1:k + 1))
      peak = found(best)
      if (bend < 0 .and. vertex > node(k - 1) - margin*width .and. vertex < node(k + 1) &
          + margin*width) then
         place = inside
         peak = max(peak, found(k - 1) + (vertex - node(k - 1))*(slope + bend*(vertex - node(k))))
      else if (best == 1) then
         place = at_first
      else if (best == n_nodes) then
         place = at_last
      else
         place = inside
      end if
      if (peak + margin*(maxval(found) - minval(found)) < level) then
         place = nowhere
      else if (place /= inside) then
         call derivatives(node, found, node(best), slope, bend)
         if (merge(slope, -slope, best == 1) > 0) place = inside
      end if
   end function place_of_peak

   !> True if |H|/N may have a peak that a parabola through its values at the nodes misses.
   !>
   !> Where N varies little, the quotient is as smooth as H and N.
   pure logical function is_sharp(normal)
      real(wp), intent(in) :: normal(n_nodes)
      !! N [m/s2]

      is_sharp = .not. maxval(normal) - minval(normal) < minval(normal)/2
   end function is_sharp

   !> Upper bound of |H|/N in a piece; `huge` if N may reach zero [-].
   pure real(wp) function largest_quotient(normal, thrust) result(largest)
      real(wp), intent(in) :: normal(n_nodes), thrust(n_nodes)
      !! N and |H| at the nodes [m/s2]
      real(wp), parameter :: margin = 0.1_wp
      !! tolerance between two neighbours, over the range of the samples [-]
      real(wp) :: low, high
      integer :: i

      largest = 0
      do i = 1, n_nodes - 1
         low = minval(normal(i:i + 1)) - margin*(maxval(normal) - minval(normal))
         high = maxval(thrust(i:i + 1)) + margin*(maxval(thrust) - minval(thrust))
         if (.not. high < low*sqrt(huge(low))) then
            largest = huge(largest)
            return
         end if
         largest = max(largest, high/low)
      end do
   end function largest_quotient

   !> Find the instants at which H/N is stationary, near an instant of small N.
   !>
   !> N is taken as a parabola and H as a straight line. Their derivatives are those of the
   !> polynomials through the nodes.
   pure subroutine turns_of_quotient(t, normal, thrust, t_low, low, thrust_low, turn, width)
      real(wp), intent(in) :: t(n_nodes)
      !! nodes [s]
      real(wp), intent(in) :: normal(n_nodes), thrust(n_nodes)
      !! N and H, with its sign, at the nodes [m/s2]
      real(wp), intent(in) :: t_low
      !! instant of the smallest known N [s]
      real(wp), intent(in) :: low, thrust_low
      !! N and H at this instant [m/s2]
      real(wp), intent(out) :: turn(2)
      !! instants [s]; `huge` without one
      real(wp), intent(out) :: width
      !! time in which N doubles [s]
      real(wp) :: slope(2), bend(2), a, b, c, q

      turn = huge(turn)
      width = t(n_nodes) - t(1)
      call derivatives(t, normal, t_low, slope(1), bend(1))
      call derivatives(t, thrust, t_low, slope(2), bend(2))
      if (t_low > t(1) .and. t_low < t(n_nodes)) slope(1) = 0
      if (.not. bend(1) > 0) return
      width = min(width, sqrt(2*low/bend(1)))
      a = slope(2)*bend(1)/2
      b = thrust_low*bend(1)/2
      c = thrust_low*slope(1) - slope(2)*low
      q = b**2 - a*c
      if (q < 0) return
      q = -(b + sign(sqrt(q), b))
      if (abs(q) < abs(a)*(t(n_nodes) - t(1))) turn(1) = t_low + q/a
      if (abs(c) < abs(q)*(t(n_nodes) - t(1))) turn(2) = t_low + c/q
   end subroutine turns_of_quotient

   !> Compute first and second derivative of the polynomial through the nodes, by Newton's form.
   pure subroutine derivatives(t, f, at, slope, bend)
      real(wp), intent(in) :: t(n_nodes), f(n_nodes)
      !! times [s] and values of f in any unit
      real(wp), intent(in) :: at
      !! [s]
      real(wp), intent(out) :: slope, bend
      real(wp) :: c(n_nodes), value
      integer :: i, j

      c = f
      do j = 2, n_nodes
         do i = n_nodes, j, -1
            c(i) = (c(i) - c(i - 1))/(t(i) - t(i - j + 1))
         end do
      end do
      value = c(n_nodes)
      slope = 0
      bend = 0
      do i = n_nodes - 1, 1, -1
         bend = bend*(at - t(i)) + 2*slope
         slope = slope*(at - t(i)) + value
         value = value*(at - t(i)) + c(i)
      end do
   end subroutine derivatives

end module rwmf_simulation_recorder_reaction_estimates
