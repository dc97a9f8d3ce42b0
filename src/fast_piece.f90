!> Exponential collocation of one ordinate over a part of a step, after an impact or a lift-off.
!>
!> The scheme is that of `rwmf_fast_step`; here the linear equation is solved by its Taylor series,
!> which is also what events are located on.
module rwmf_fast_piece
   use rwmf_fast_law, only: fast_law_t
   use rwmf_fast_series, only: newton_to_powers, series, shifted, state_at, terms, terms_needed
   use rwmf_fast_lanes, only: c_2, c_3, degree, step_t
   use rwmf_kinds, only: wp
   implicit none
   private

   public :: end_state_t, ordinate_t, depart, linear_damping, linear_stiffness, weight_of_wall

   !> State at the end of a step.
   type :: end_state_t
      real(wp) :: v
      !! [-]
      real(wp) :: w
      !! [1/s]
      real(wp) :: n
      !! N [1/s2]
      real(wp) :: s
      !! its rate [1/s3]
      real(wp) :: drive
      !! v D2 [1/m]
   end type end_state_t

   !> One ordinate of a spectrum: constants, and what it has met so far.
   type :: ordinate_t
      real(wp) :: damping
      !! 2 xi_s omega_s [1/s]
      real(wp) :: stiffness
      !! omega_s**2 [1/s2]
      real(wp) :: rtol
      !! requested relative tolerance [-]
      integer :: side
      !! +1 or -1
      real(wp) :: v_max
      !! [-]
      real(wp) :: w_max
      !! largest rate at an impact [1/s]
      integer :: impacts
      logical :: rests
      integer :: wake_step
      real(wp) :: wake_x
      !! where it lifts off
      integer :: wake_side
      logical :: failed
      !! left to the general kernel
   end type ordinate_t

   real(wp), parameter :: negligible_n = 1.0e-4_wp
   !! part of the tolerance below which a change of v by N is left out

contains

   !> The constant part of the forcing.
   pure function weight_of_wall(law) result(forcing)
      type(fast_law_t), intent(in) :: law
      real(wp) :: forcing(0:3)
      !! [1/s2]

      forcing = [law%m3, 0.0_wp, 0.0_wp, 0.0_wp]
   end function weight_of_wall

   pure real(wp) function linear_damping(ordinate, law) result(damping)
      type(ordinate_t), intent(in) :: ordinate
      type(fast_law_t), intent(in) :: law

      damping = ordinate%damping*law%m1
   end function linear_damping

   pure real(wp) function linear_stiffness(ordinate, law) result(stiffness)
      type(ordinate_t), intent(in) :: ordinate
      type(fast_law_t), intent(in) :: law

      stiffness = ordinate%stiffness*law%m1 + law%m3_1
   end function linear_stiffness

   !> N [1/s2] and v D2 [1/m] at a state.
   pure subroutine remainder(ordinate, c, f, v, w, n, drive)
      type(ordinate_t), intent(in) :: ordinate
      real(wp), intent(in) :: c(0:degree, 4)
      !! polynomials of the side
      real(wp), intent(in) :: f
      !! ground acceleration [m/s2]
      real(wp), intent(in) :: v
      real(wp), intent(in) :: w
      real(wp), intent(out) :: n
      real(wp), intent(out) :: drive
      real(wp) :: value(4)
      integer :: i

      value = c(degree, :)
      do i = degree - 1, 0, -1
         value = value*v + c(i, :)
      end do
      drive = v*value(3)
      n = value(1)*w**2 - v*(value(2)*(ordinate%damping*w + ordinate%stiffness*v) + value(4)) &
         - drive*(ordinate%side*f)
   end subroutine remainder

   !> Integrate a part of a step from v = 0 with the rate w.
   !>
   !> The higher differences of N are evaluated only where they are not negligible: late flights of
   !> a chatter need none.
   pure subroutine depart(ordinate, law, step, x, span, w, last, p, finish)
      type(ordinate_t), intent(in) :: ordinate
      type(fast_law_t), intent(in) :: law
      type(step_t), intent(in) :: step
      real(wp), intent(in) :: x
      !! position in the step [-]
      real(wp), intent(in) :: span
      !! length of the part [-]
      real(wp), intent(in) :: w
      !! [1/s]
      integer, intent(out) :: last
      !! highest power of the series
      real(wp), intent(out) :: p(0:terms)
      !! v in powers of the position in the part
      type(end_state_t), intent(out) :: finish
      real(wp), parameter :: node(3) = [c_2, c_3, 1.0_wp]
      real(wp) :: c(0:degree, 4)
      !! polynomials of the side
      real(wp) :: h
      !! [s]
      real(wp) :: small
      !! negligible N [1/s2]
      real(wp) :: f(0:3)
      real(wp) :: forcing(0:3)
      real(wp) :: n(0:3)
      !! divided differences of N
      real(wp) :: a
      !! v'' at the beginning [1/s2]
      real(wp) :: by_v
      !! derivative of N by v there [1/s2]
      real(wp) :: s
      !! rate of N there [1/s3]
      real(wp) :: change
      !! of N within the part, as far as it is not yet followed [1/s2]
      real(wp) :: highest
      real(wp) :: damping
      real(wp) :: stiffness
      integer :: i

      h = span*step%h
      damping = linear_damping(ordinate, law)
      stiffness = linear_stiffness(ordinate, law)
      last = terms_needed(damping, stiffness, h)
      f = shifted(newton_to_powers(step%f), x, span)
      forcing = -law%m2*ordinate%side*f - weight_of_wall(law)
      c = law%coef(:, :, merge(1, 2, ordinate%side > 0))
      n = [c(0, 1)*w**2, 0.0_wp, 0.0_wp, 0.0_wp]
      a = forcing(0) + n(0) - damping*w
      by_v = -c(0, 2)*ordinate%damping*w - c(0, 3)*ordinate%side*f(0) - c(0, 4)
      s = w*(c(1, 1)*w**2 + 2*c(0, 1)*a + by_v)
      n(1) = h*s
      highest = n(1)
      small = negligible_n*ordinate%rtol*ordinate%v_max
      ! From rest at the threshold both n(1) and a vanish: what counts is how far the forcing takes
      ! the wall within the part.
      change = abs(n(1)) + h**2*(abs(a) + sum(abs(forcing(1:))))*abs(2*c(0, 1)*a + by_v)
      do i = 1, 3
         if (h**2*change <= small) exit
         call series(damping, stiffness, h, 0.0_wp, w, forcing + newton_to_powers(n), last, p)
         call end_of_piece(ordinate, c, f, p(:last), h, node(i), finish)
         call refine(i, finish%n, highest, n)
         change = abs(n(min(i + 1, 3)))
      end do
      call series(damping, stiffness, h, 0.0_wp, w, forcing + newton_to_powers(n), last, p)
      if (i <= 3) then
         call end_of_piece(ordinate, c, f, p(:last), h, 1.0_wp, finish)
      else
         call state_at(p(:last), 1.0_wp, finish%v, finish%w)
         finish%w = finish%w/h
      end if
      finish%s = (n(1) + (2 - c_2)*n(2) &
         + ((1 - c_2)*(1 - c_3) + (1 - c_3) + (1 - c_2))*n(3))/h
      ! Differences over a very short time are round-off; there N has not changed its course.
      if (span < 1.0e-3_wp) finish%s = s
   end subroutine depart

   !> State and N at the position y of a piece.
   pure subroutine end_of_piece(ordinate, c, f, p, h, y, finish)
      type(ordinate_t), intent(in) :: ordinate
      real(wp), intent(in) :: c(0:degree, 4)
      real(wp), intent(in) :: f(0:3)
      !! ground acceleration in powers of y [m/s2]
      real(wp), contiguous, intent(in) :: p(0:)
      real(wp), intent(in) :: h
      !! [s]
      real(wp), intent(in) :: y
      type(end_state_t), intent(inout) :: finish

      call state_at(p, y, finish%v, finish%w)
      finish%w = finish%w/h
      call remainder(ordinate, c, f(0) + y*(f(1) + y*(f(2) + y*f(3))), finish%v, finish%w, &
         finish%n, finish%drive)
   end subroutine end_of_piece

   !> Enter the value of N at the next node into its divided differences; the slope at 0 supplies
   !> the highest one until the last value is known.
   pure subroutine refine(node, value, highest, n)
      integer, intent(in) :: node
      !! 1: c2, 2: c3, 3: 1
      real(wp), intent(in) :: value
      !! [1/s2]
      real(wp), intent(inout) :: highest
      !! highest difference with the slope at 0
      real(wp), intent(inout) :: n(0:3)

      select case (node)
      case (1)
         n(1) = (value - n(0))/c_2
         n(2) = (n(1) - highest)/c_2
         highest = n(2)
      case (2)
         n(2) = ((value - n(0))/c_3 - n(1))/(c_3 - c_2)
         n(3) = (n(2) - highest)/c_3
      case default
         n(3) = ((value - n(0) - n(1))/(1 - c_2) - n(2))/(1 - c_3)
      end select
   end subroutine refine

end module rwmf_fast_piece
