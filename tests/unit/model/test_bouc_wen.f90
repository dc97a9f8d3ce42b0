!> Closed forms of the smooth hysteresis of Bouc and Wen.
program test_bouc_wen
   use check, only: checks_t
   use rwmf_core_kinds, only: wp
   use rwmf_model_hysteresis_bouc_wen_backbone, only: unloaded_displacement, virgin_displacement
   implicit none

   type(checks_t) :: checks

   if (checks%wants('closed_forms')) call check_closed_forms()
   if (checks%wants('loading_on')) call check_loading_on()
   call checks%finish()

contains

   !> Check the closed forms of the first loading, from far below yielding to far beyond, and their
   !> symmetry.
   subroutine check_closed_forms()
      real(wp), parameter :: x(6) = [1.0e-9_wp, 0.01_wp, 0.5_wp, 2.0_wp, 9.0_wp, 200.0_wp]
      integer :: i

      do i = 1, size(x)
         call checks%close_to(virgin_displacement(x(i), 1.0_wp), 1 - exp(-x(i)), 'n = 1', &
            rtol=1.0e-14_wp, atol=1.0e-16_wp)
         call checks%close_to(virgin_displacement(-x(i), 2.0_wp), -tanh(x(i)), 'n = 2', &
            rtol=1.0e-14_wp, atol=1.0e-16_wp)
         ! large n: the elastic-plastic law without a knee
         call checks%close_to(virgin_displacement(x(i), 1000.0_wp), min(x(i), 1.0_wp), 'n = 1000', &
            rtol=1.0e-6_wp)
      end do
      call checks%that(abs(virgin_displacement(0.0_wp, 3.0_wp)) <= 0, 'nothing')
   end subroutine check_closed_forms

   !> Check continued loading after hardening has turned the force against z: 1 - z decays with
   !> exp(-way) for n = 1, z = tanh(atanh(z_0) + way) for n = 2. A z of 1 to round-off stays 1.
   subroutine check_loading_on()
      real(wp), parameter :: x(3) = [-9.5_wp, -15.0_wp, -400.0_wp]
      real(wp), parameter :: left(5) = [0.4_wp, 1.0e-3_wp, 1.0e-9_wp, 4.0e-16_wp, 0.0_wp]
      !! 1 - z
      real(wp), parameter :: a = 0.1_wp
      real(wp) :: way
      integer :: i, j, n

      do i = 1, size(x)
         do j = 1, size(left)
            way = unloaded_displacement(x(i), 1 - left(j), a, 0.6_wp, 1.0_wp) - x(i)
            call checks%close_to(a*(x(i) + way), -(1 - a)*(1 - left(j)*exp(-way)), 'n = 1', &
               rtol=1.0e-13_wp)
            way = unloaded_displacement(-x(i), left(j) - 1, a, 0.6_wp, 2.0_wp) + x(i)
            call checks%close_to(a*(way - x(i)), (1 - a)*(1 - left(j) &
               *2*exp(2*way)/(2 - left(j) + left(j)*exp(2*way))), 'n = 2', rtol=1.0e-13_wp)
         end do
         do n = 1, 8
            call checks%close_to(unloaded_displacement(x(i), 1.0_wp, a, 1.0_wp, real(n, wp)), &
               -(1 - a)/a, 'no knee is left', rtol=1.0e-13_wp)
         end do
      end do
   end subroutine check_loading_on

end program test_bouc_wen
