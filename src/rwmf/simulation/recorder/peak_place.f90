!> Place of a peak between samples at Chebyshev-Lobatto nodes.
module rwmf_simulation_recorder_peak_place
   use rwmf_core_kinds, only: wp
   use rwmf_math_roots, only: vertex_of_parabola
   implicit none
   private

   public :: has_peak_inside, n_nodes, node

   integer, parameter :: n_nodes = 5
   real(wp), parameter :: node(n_nodes) = [0.0_wp, 0.5_wp - sqrt(0.125_wp), 0.5_wp, &
      0.5_wp + sqrt(0.125_wp), 1.0_wp]
   !! Chebyshev-Lobatto nodes over a piece [-]

contains

   !> Return whether a peak that may reach a level lies between the ends, from values at the nodes.
   !>
   !> The peak follows from the parabola through the largest value and its neighbours. If an end is
   !> largest, the slope of the polynomial through all nodes shows a peak beside it.
   pure logical function has_peak_inside(found, level) result(has_peak)
      real(wp), intent(in) :: found(n_nodes)
      !! the quantity at the nodes, in any unit
      real(wp), intent(in) :: level
      !! value above which a peak counts, in the same unit
      real(wp), parameter :: margin = 0.1_wp
      !! tolerance over the range of the samples, and over the width of the parabola [-]
      real(wp) :: vertex, peak, width, slope, bend
      integer :: best, k

      best = maxloc(found, dim=1)
      k = min(max(best, 2), n_nodes - 1)
      width = node(k + 1) - node(k - 1)
      slope = (found(k) - found(k - 1))/(node(k) - node(k - 1))
      bend = ((found(k + 1) - found(k))/(node(k + 1) - node(k)) - slope)/width
      vertex = vertex_of_parabola(node(k - 1:k + 1), found(k - 1:k + 1))
      peak = found(best)
      has_peak = bend < 0 .and. vertex > node(k - 1) - margin*width .and. vertex < node(k + 1) &
         + margin*width
      if (has_peak) then
         peak = max(peak, found(k - 1) + (vertex - node(k - 1))*(slope + bend*(vertex - node(k))))
      else if (best > 1 .and. best < n_nodes) then
         has_peak = .true.
      else
         call derivatives(node, found, node(best), slope, bend)
         has_peak = merge(slope, -slope, best == 1) > 0
      end if
      has_peak = has_peak .and. peak + margin*(maxval(found) - minval(found)) >= level
   end function has_peak_inside

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

end module rwmf_simulation_recorder_peak_place
