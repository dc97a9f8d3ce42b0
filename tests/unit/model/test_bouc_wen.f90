!> Frames with the smooth hysteresis of Bouc and Wen: closed forms, limits, energy.
program test_bouc_wen
   use check, only: checks_t
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: wp
   use rwmf_model_hysteresis_bouc_wen_backbone, only: unloaded_displacement, virgin_displacement
   use rwmf_problem_case, only: case_t
   use rwmf_simulation_simulate, only: simulate
   use rwmf_simulation_state_result, only: result_t
   use scenes, only: frame_scene, rwmf_scene
   implicit none

   type(checks_t) :: checks

   if (checks%wants('closed_forms')) call check_closed_forms()
   if (checks%wants('loading_on')) call check_loading_on()
   if (checks%wants('first_loading')) call check_first_loading(1.0_wp, 'n = 1')
   if (checks%wants('first_loading')) call check_first_loading(2.0_wp, 'n = 2')
   if (checks%wants('unloading')) call check_unloading()
   if (checks%wants('passage')) call check_passage(1.0_wp, 'n = 1')
   if (checks%wants('passage')) call check_passage(2.0_wp, 'n = 2')
   if (checks%wants('natural_exponents')) call check_natural_exponents()
   if (checks%wants('passage_at_impact')) call check_passage_at_impact()
   if (checks%wants('standstill')) call check_standstill()
   if (checks%wants('elastic_limit')) call check_elastic_limit()
   call checks%finish()

contains

   !> Scene with a frame that yields smoothly.
   function hysteretic(scene, u_y, hardening, exponent, beta) result(case)
      type(case_t), intent(in) :: scene
      real(wp), intent(in) :: u_y
      !! [m]
      real(wp), intent(in) :: hardening
      real(wp), intent(in) :: exponent
      real(wp), intent(in) :: beta
      type(case_t) :: case

      case = scene
      allocate (case%yielding)
      case%yielding%u_y = u_y
      case%yielding%hardening = hardening
      case%yielding%law%exponent = exponent
      case%yielding%law%beta = beta
      case%yielding%law%name = 'bouc_wen'
   end function hysteretic

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

   !> Check the first loading: while u grows, z depends on u/u_y only. It is 1 - exp(-x) for n = 1
   !> and tanh(x) for n = 2.
   subroutine check_first_loading(exponent, name)
      real(wp), intent(in) :: exponent
      character(*), intent(in) :: name
      type(case_t) :: case
      type(result_t) :: result
      type(error_t), allocatable :: error
      real(wp) :: x

      case = hysteretic(frame_scene(0.7_wp, 'dop853'), 0.02_wp, 0.1_wp, exponent, 0.6_wp)
      case%motion%a_max_g = -case%motion%a_max_g
      case%solver%t_end = 0.3_wp
      case%solver%rtol = 1.0e-11_wp
      call simulate(case, result, error)
      call checks%no_error(error, 'first loading')
      x = result%final_state(1)/case%yielding%u_y
      call checks%that(x > 0.5_wp .and. result%final_state(2) > 0, 'still loading, '//name)
      if (exponent > 1) then
         call checks%close_to(result%final_state(3), tanh(x), 'first loading, '//name, &
            rtol=1.0e-9_wp)
      else
         call checks%close_to(result%final_state(3), 1 - exp(-x), 'first loading, '//name, &
            rtol=1.0e-9_wp)
      end if
      call check_residual(x, result%residual_displacement/case%yielding%u_y, exponent, name)
   end subroutine check_first_loading

   !> Check slow unloading from the first loading, with hardening 0.1 and beta = 0.6. z falls to
   !> zero at x_0, then follows the first loading up to 0.1 x + 0.9 z = 0.
   subroutine check_residual(x, rest, exponent, name)
      real(wp), intent(in) :: x
      !! displacement over u_y [-]
      real(wp), intent(in) :: rest
      !! residual displacement over u_y [-]
      real(wp), intent(in) :: exponent
      character(*), intent(in) :: name
      real(wp), parameter :: c = 2*0.6_wp - 1
      real(wp) :: x_0, z

      if (exponent > 1) then
         x_0 = x - atan(sqrt(c)*tanh(x))/sqrt(c)
         z = -tanh(x_0 - rest)
      else
         x_0 = x - log(1 + c*(1 - exp(-x)))/c
         z = exp(rest - x_0) - 1
      end if
      call checks%that(x_0 > rest .and. rest > 0, 'z changes its sign, '//name)
      call checks%close_to(0.1_wp*rest, -0.9_wp*z, 'residual displacement, '//name, &
         rtol=1.0e-8_wp)
   end subroutine check_residual

   !> Check unloading from the peak for n = 2. Until z changes its sign, dz/dx = 1 + (2 beta - 1)
   !> z**2. With c = sqrt(2 beta - 1), arctan(c z)/c therefore differs from its value at the peak by
   !> x - x_peak.
   subroutine check_unloading()
      type(case_t) :: case
      type(result_t) :: result
      type(error_t), allocatable :: error
      real(wp), parameter :: c = 1/sqrt(2.0_wp)
      !! for beta = 3/4
      real(wp) :: t_peak
      real(wp) :: peak(3)

      case = hysteretic(frame_scene(0.7_wp, 'dop853'), 0.02_wp, 0.1_wp, 2.0_wp, 0.75_wp)
      case%motion%a_max_g = -case%motion%a_max_g
      case%solver%rtol = 1.0e-11_wp
      case%solver%t_end = 0.635_wp
      call simulate(case, result, error)
      call checks%no_error(error, 'unloading')
      t_peak = result%t_u_s_max
      call checks%that(t_peak < 0.6_wp .and. result%final_state(2) < 0 &
         .and. result%final_state(3) > 0, 'unloading')
      case%solver%t_end = t_peak
      associate (x => result%final_state(1)/case%yielding%u_y, z => result%final_state(3))
         block
            type(result_t) :: at_peak

            call simulate(case, at_peak, error)
            peak = at_peak%final_state
         end block
         call checks%close_to(atan(c*z)/c - atan(c*peak(3))/c, x - peak(1)/case%yielding%u_y, &
            'unloading', rtol=1.0e-8_wp)
      end associate
   end subroutine check_unloading

   !> Check the passage of z through zero, where the law has a corner and every method starts a new
   !> piece of motion. Beyond the zero after the first peak, z(u) is known; the result agrees within
   !> a few tolerances.
   subroutine check_passage(exponent, name)
      real(wp), intent(in) :: exponent
      character(*), intent(in) :: name
      character(6), parameter :: methods(4) = [character(6) :: 'adams', 'bdf', 'taylor', 'dop853']
      type(case_t) :: case
      type(result_t) :: result
      type(error_t), allocatable :: error
      integer :: i

      case = hysteretic(frame_scene(0.7_wp, 'dop853'), 0.02_wp, 0.1_wp, exponent, 0.75_wp)
      case%motion%a_max_g = -case%motion%a_max_g
      case%solver%rtol = 1.0e-7_wp
      case%solver%t_end = 0.8_wp
      do i = 1, size(methods)
         case%solver%method = trim(methods(i))
         call simulate(case, result, error)
         call checks%no_error(error, 'passage')
         associate (x => result%final_state(1)/case%yielding%u_y, z => result%final_state(3))
            call checks%that(result%final_state(2) < 0 .and. z < -0.3_wp, 'beyond the passage')
            call checks%close_to(z, beyond_zero(exponent, result%u_s_max/case%yielding%u_y, x), &
               'passage, '//name//', '//trim(methods(i)), atol=4.0e-7_wp)
         end associate
      end do
   end subroutine check_passage

   !> Value of z beyond its first zero after the first peak, for beta = 3/4.
   pure real(wp) function beyond_zero(exponent, x_peak, x) result(z)
      real(wp), intent(in) :: exponent
      real(wp), intent(in) :: x_peak
      !! u/u_y at the peak [-]
      real(wp), intent(in) :: x
      !! u/u_y [-]
      real(wp) :: c
      real(wp) :: x_zero

      if (exponent > 1) then
         c = sqrt(0.5_wp)
         x_zero = x_peak - atan(c*tanh(x_peak))/c
         z = tanh(x - x_zero)
      else
         c = 0.5_wp
         x_zero = x_peak - log(1 + c*(1 - exp(-x_peak)))/c
         z = exp(x - x_zero) - 1
      end if
   end function beyond_zero

   !> Compare small integer exponents, computed by products, with neighbouring exponents, computed
   !> by powers.
   subroutine check_natural_exponents()
      real(wp), parameter :: exponents(5) = [1.0_wp, 2.0_wp, 3.0_wp, 4.0_wp, 8.0_wp]
      type(case_t) :: case
      type(result_t) :: result
      type(result_t) :: neighbour
      type(error_t), allocatable :: error
      integer :: i

      do i = 1, size(exponents)
         case = hysteretic(frame_scene(0.7_wp, 'dop853'), 0.02_wp, 0.1_wp, exponents(i), 0.75_wp)
         case%solver%rtol = 1.0e-10_wp
         call simulate(case, result, error)
         call checks%no_error(error, 'natural exponent')
         case%yielding%law%exponent = exponents(i) + 1.0e-8_wp
         call simulate(case, neighbour, error)
         call checks%close_to(neighbour%residual_displacement, result%residual_displacement, &
            'a natural exponent and its neighbour', atol=1.0e-8_wp*result%u_s_max)
      end do
   end subroutine check_natural_exponents

   !> Check an elastic frame, for which z passes zero at the instant of the impact: both are one
   !> event, at every tolerance.
   subroutine check_passage_at_impact()
      character(6), parameter :: methods(3) = [character(6) :: 'adams', 'taylor', 'dop853']
      type(case_t) :: case
      type(case_t) :: elastic_case
      type(result_t) :: result
      type(result_t) :: elastic
      type(error_t), allocatable :: error
      integer :: i, k

      elastic_case = rwmf_scene('exact', 5.0_wp, 0.6_wp, 'dop853')
      case = hysteretic(elastic_case, 1.0e9_wp, 0.1_wp, 2.0_wp, 0.5_wp)
      do i = 1, size(methods)
         do k = 15, 26
            elastic_case%solver%method = trim(methods(i))
            elastic_case%solver%rtol = 10**(-0.5_wp*k)
            case%solver = elastic_case%solver
            call simulate(elastic_case, elastic, error)
            call simulate(case, result, error)
            call checks%no_error(error, 'passage at an impact')
            call checks%close_to(result%u_s_max, elastic%u_s_max, 'passage at an impact, ' &
               //trim(methods(i)), rtol=300*case%solver%rtol)
         end do
      end do
   end subroutine check_passage_at_impact

   !> Check that a frame at rest takes few steps before the ground moves; it has no peaks.
   subroutine check_standstill()
      type(case_t) :: case
      type(result_t) :: result
      type(error_t), allocatable :: error

      case = hysteretic(frame_scene(0.7_wp, 'adams'), 0.02_wp, 0.1_wp, 2.0_wp, 0.6_wp)
      deallocate (case%motion)
      case%solver%t_end = 10
      call simulate(case, result, error)
      call checks%no_error(error, 'standstill')
      call checks%that(result%steps < 1000, 'a frame that stands still takes few steps')
   end subroutine check_standstill

   !> Compare the limit u_y -> infinity with the scene without the group.
   subroutine check_elastic_limit()
      type(case_t) :: case
      type(result_t) :: result
      type(result_t) :: elastic
      type(error_t), allocatable :: error

      case = hysteretic(rwmf_scene('exact', 5.0_wp, 1.0_wp, 'dop853'), 1.0e9_wp, 0.1_wp, 2.0_wp, &
         0.5_wp)
      call simulate(case, result, error)
      call checks%no_error(error, 'elastic limit')
      deallocate (case%yielding)
      call simulate(case, elastic, error)
      call checks%close_to(result%u_s_max, elastic%u_s_max, 'elastic limit', rtol=1.0e-9_wp)
   end subroutine check_elastic_limit

end program test_bouc_wen
