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
   if (checks%wants('natural_exponents')) call check_natural_exponents()
   if (checks%wants('passage_at_impact')) call check_passage_at_impact()
   if (checks%wants('standstill')) call check_standstill()
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

end program test_bouc_wen
