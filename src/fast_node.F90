!> What the steps of `rwmf_fast_step` are made of: the state at a node, and N there.
!>
!> Loops to be vectorised, compiled once for each instruction set like that module: no operation
!> mixes two lanes, and all instruction sets give the same bits.
#ifndef FAST_NODE
#define FAST_NODE rwmf_fast_node
#endif
module FAST_NODE
   use rwmf_fast_lanes, only: c_2, c_3, lane_ground_t, lane_rate_t, seats, wp
   implicit none
   private

   public :: propagate, remainder, pass_jump

contains

   !> State at a node under the ground motion and N as far as it is known.
   pure subroutine propagate(modes, rate, ground, d, a, v_0, w_0, v, w)
      integer, intent(in) :: modes
      !! how many of the four modes of the forcing are not zero; two at least
      type(lane_rate_t), intent(in) :: rate
      type(lane_ground_t), intent(in) :: ground
      real(wp), intent(in) :: d(seats, 0:3)
      !! divided differences of N [1/s2]
      real(wp), intent(in) :: a(seats, 12)
      !! weights of the node
      real(wp), intent(in) :: v_0(seats)
      real(wp), intent(in) :: w_0(seats)
      real(wp), intent(out) :: v(seats)
      real(wp), intent(out) :: w(seats)
      real(wp) :: g_0, g_1, g_2, g_3, pull
      integer :: i

      associate (f => ground%f)
         select case (modes)
         case (2)
            !$omp simd private(g_0, g_1, pull)
            do i = 1, seats
               pull = -rate%m2(i)*rate%side(i)
               g_0 = (d(i, 0) - rate%m3(i)) + pull*f(i, 0)
               g_1 = d(i, 1) + pull*f(i, 1)
               v(i) = (a(i, 1)*v_0(i) + a(i, 2)*w_0(i)) + (a(i, 5)*g_0 + a(i, 6)*g_1)
               w(i) = (a(i, 3)*v_0(i) + a(i, 4)*w_0(i)) + (a(i, 9)*g_0 + a(i, 10)*g_1)
            end do
         case (3)
            !$omp simd private(g_0, g_1, g_2, pull)
            do i = 1, seats
               pull = -rate%m2(i)*rate%side(i)
               g_0 = (d(i, 0) - rate%m3(i)) + pull*f(i, 0)
               g_1 = d(i, 1) + pull*f(i, 1)
               g_2 = d(i, 2)
               v(i) = (a(i, 1)*v_0(i) + a(i, 2)*w_0(i)) + ((a(i, 5)*g_0 + a(i, 6)*g_1) &
                  + a(i, 7)*g_2)
               w(i) = (a(i, 3)*v_0(i) + a(i, 4)*w_0(i)) + ((a(i, 9)*g_0 + a(i, 10)*g_1) &
                  + a(i, 11)*g_2)
            end do
         case default
            !$omp simd private(g_0, g_1, g_2, g_3, pull)
            do i = 1, seats
               pull = -rate%m2(i)*rate%side(i)
               g_0 = (d(i, 0) - rate%m3(i)) + pull*f(i, 0)
               g_1 = d(i, 1) + pull*f(i, 1)
               g_2 = d(i, 2) + pull*f(i, 2)
               g_3 = d(i, 3) + pull*f(i, 3)
               v(i) = (a(i, 1)*v_0(i) + a(i, 2)*w_0(i)) + ((a(i, 5)*g_0 + a(i, 6)*g_1) &
                  + (a(i, 7)*g_2 + a(i, 8)*g_3))
               w(i) = (a(i, 3)*v_0(i) + a(i, 4)*w_0(i)) + ((a(i, 9)*g_0 + a(i, 10)*g_1) &
                  + (a(i, 11)*g_2 + a(i, 12)*g_3))
            end do
         end select
      end associate
   end subroutine propagate

   !> N at the states of all lanes.
   pure subroutine remainder(is_short, rate, ground, y, v, w, n, drive)
      logical, intent(in) :: is_short
      type(lane_rate_t), intent(in) :: rate
      type(lane_ground_t), intent(in) :: ground
      real(wp), intent(in) :: y
      !! position in the step [-]
      real(wp), intent(in) :: v(seats)
      real(wp), intent(in) :: w(seats)
      real(wp), intent(out) :: n(seats)
      real(wp), intent(out) :: drive(seats)

      if (is_short) then
         call remainder_of_four(rate, ground, y, v, w, n, drive)
      else
         call remainder_of_six(rate, ground, y, v, w, n, drive)
      end if
   end subroutine remainder

   !> N with polynomials of degree 4.
   pure subroutine remainder_of_four(rate, ground, y, v, w, n, drive)
      type(lane_rate_t), intent(in) :: rate
      type(lane_ground_t), intent(in) :: ground
      real(wp), intent(in) :: y
      real(wp), intent(in) :: v(seats)
      real(wp), intent(in) :: w(seats)
      real(wp), intent(out) :: n(seats)
      real(wp), intent(out) :: drive(seats)
      real(wp) :: x, x_2, x_4, q, d_1, d_2, h, g
      integer :: i

      associate (c => rate%coef, f => ground%f)
         !$omp simd private(x, x_2, x_4, q, d_1, d_2, h, g)
         do i = 1, seats
            x = v(i)
            x_2 = x*x
            x_4 = x_2*x_2
            q = ((c(i, 0, 1) + x*c(i, 1, 1)) + x_2*(c(i, 2, 1) + x*c(i, 3, 1))) &
               + x_4*c(i, 4, 1)
            d_1 = ((c(i, 0, 2) + x*c(i, 1, 2)) + x_2*(c(i, 2, 2) + x*c(i, 3, 2))) &
               + x_4*c(i, 4, 2)
            d_2 = ((c(i, 0, 3) + x*c(i, 1, 3)) + x_2*(c(i, 2, 3) + x*c(i, 3, 3))) &
               + x_4*c(i, 4, 3)
            h = ((c(i, 0, 4) + x*c(i, 1, 4)) + x_2*(c(i, 2, 4) + x*c(i, 3, 4))) &
               + x_4*c(i, 4, 4)
            g = f(i, 0) + y*(f(i, 1) + (y - c_2)*(f(i, 2) + (y - c_3)*f(i, 3)))
            drive(i) = x*d_2
            n(i) = q*w(i)*w(i) - x*(d_1*(rate%damping(i)*w(i) + rate%stiffness(i)*x) + h) &
               - drive(i)*(rate%side(i)*g)
         end do
      end associate
   end subroutine remainder_of_four

   !> N with polynomials of degree 6.
   pure subroutine remainder_of_six(rate, ground, y, v, w, n, drive)
      type(lane_rate_t), intent(in) :: rate
      type(lane_ground_t), intent(in) :: ground
      real(wp), intent(in) :: y
      real(wp), intent(in) :: v(seats)
      real(wp), intent(in) :: w(seats)
      real(wp), intent(out) :: n(seats)
      real(wp), intent(out) :: drive(seats)
      real(wp) :: x, x_2, x_4, q, d_1, d_2, h, g
      integer :: i

      associate (c => rate%coef, f => ground%f)
         !$omp simd private(x, x_2, x_4, q, d_1, d_2, h, g)
         do i = 1, seats
            x = v(i)
            x_2 = x*x
            x_4 = x_2*x_2
            q = ((c(i, 0, 1) + x*c(i, 1, 1)) + x_2*(c(i, 2, 1) + x*c(i, 3, 1))) &
               + x_4*((c(i, 4, 1) + x*c(i, 5, 1)) + x_2*c(i, 6, 1))
            d_1 = ((c(i, 0, 2) + x*c(i, 1, 2)) + x_2*(c(i, 2, 2) + x*c(i, 3, 2))) &
               + x_4*((c(i, 4, 2) + x*c(i, 5, 2)) + x_2*c(i, 6, 2))
            d_2 = ((c(i, 0, 3) + x*c(i, 1, 3)) + x_2*(c(i, 2, 3) + x*c(i, 3, 3))) &
               + x_4*((c(i, 4, 3) + x*c(i, 5, 3)) + x_2*c(i, 6, 3))
            h = ((c(i, 0, 4) + x*c(i, 1, 4)) + x_2*(c(i, 2, 4) + x*c(i, 3, 4))) &
               + x_4*((c(i, 4, 4) + x*c(i, 5, 4)) + x_2*c(i, 6, 4))
            g = f(i, 0) + y*(f(i, 1) + (y - c_2)*(f(i, 2) + (y - c_3)*f(i, 3)))
            drive(i) = x*d_2
            n(i) = q*w(i)*w(i) - x*(d_1*(rate%damping(i)*w(i) + rate%stiffness(i)*x) + h) &
               - drive(i)*(rate%side(i)*g)
         end do
      end associate
   end subroutine remainder_of_six

   !> A jump of the ground acceleration is one of v'' as well, by -M2 sigma. The slope of N jumps by
   !> that times dN/dv' = 2 Q v' - v D1 2 xi_s omega_s, and by -v' d(v D2)/dv sigma.
   pure subroutine pass_jump(rate, ground, v, w, drive, slope)
      type(lane_rate_t), intent(in) :: rate
      type(lane_ground_t), intent(in) :: ground
      real(wp), intent(in) :: v(seats)
      real(wp), intent(in) :: w(seats)
      real(wp), intent(in) :: drive(seats)
      real(wp), intent(inout) :: slope(seats)
      real(wp) :: x, q, d_1, bend
      integer :: i

      associate (c => rate%coef)
         !$omp simd private(x, q, d_1, bend)
         do i = 1, seats
            x = v(i)
            q = c(i, 0, 1) + x*(c(i, 1, 1) + x*(c(i, 2, 1) + x*(c(i, 3, 1) + x*(c(i, 4, 1) &
               + x*(c(i, 5, 1) + x*c(i, 6, 1))))))
            d_1 = c(i, 0, 2) + x*(c(i, 1, 2) + x*(c(i, 2, 2) + x*(c(i, 3, 2) + x*(c(i, 4, 2) &
               + x*(c(i, 5, 2) + x*c(i, 6, 2))))))
            bend = c(i, 0, 3) + x*(2*c(i, 1, 3) + x*(3*c(i, 2, 3) + x*(4*c(i, 3, 3) &
               + x*(5*c(i, 4, 3) + x*(6*c(i, 5, 3) + x*7*c(i, 6, 3))))))
            slope(i) = slope(i) - rate%h(i)*((2*q*w(i) - x*d_1*rate%damping(i)) &
               *(rate%m2(i) + drive(i)) + w(i)*bend)*rate%side(i)*ground%jump(i)
         end do
      end associate
   end subroutine pass_jump

end module FAST_NODE
