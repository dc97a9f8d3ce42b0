!> Gauss-Legendre quadrature.
module rwmf_math_gauss
   use rwmf_core_kinds, only: pi, wp
   implicit none
   private

   public :: gauss_node

contains

   !> Compute a node of the Gauss-Legendre rule and its weight.
   pure subroutine gauss_node(n, j, node, weight)
      integer, intent(in) :: n
      !! number of nodes
      integer, intent(in) :: j
      !! number of the node
      real(wp), intent(out) :: node
      !! place between -1 and 1 [-]
      real(wp), intent(out) :: weight
      !! weight; the sum of all is 2 [-]
      integer, parameter :: most_steps = 20
      !! more than Newton's iteration needs, in quadruple precision too
      real(wp) :: before, present, next, slope
      integer :: i, k

      node = cos(pi*(j - 0.25_wp)/(n + 0.5_wp))
      do k = 1, most_steps
         before = 1
         present = node
         do i = 2, n
            next = ((2*i - 1)*node*present - (i - 1)*before)/i
            before = present
            present = next
         end do
         slope = n*(node*present - before)/(node**2 - 1)
         node = node - present/slope
         if (abs(present/slope) <= 2*epsilon(node)) exit
      end do
      weight = 2/((1 - node**2)*slope**2)
   end subroutine gauss_node

end module rwmf_math_gauss
