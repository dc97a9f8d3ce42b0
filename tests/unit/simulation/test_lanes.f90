!> Order of the pairs in lanes, and bitwise identity for any batch and every instruction set.
program test_lanes
   use check, only: checks_t
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: pi, wp
   use rwmf_input_reader, only: read_case_text
   use rwmf_integrator_lane_kernels, only: best_level, lane_kernels_of, lane_kernels_t, &
      batch_width
   use rwmf_integrator_lane_step, only: attempt_one => attempt_step
   use rwmf_integrator_pairs, only: dormand_prince_853, most_stages, pair_t, &
      step_tolerance, tsitouras_papakostas_64
   use rwmf_model_lanes, only: of_input, of_plastic, of_viscous, power_count
   use rwmf_model_system_assembly, only: build_equation, equation_t
   use rwmf_model_system_energy, only: mechanical_energy
   use rwmf_motion_ground_motion, only: motion_from_case, motion_t
   use rwmf_problem_case, only: case_t
   implicit none

   character(*), parameter :: wall = '&wall h=2.0, b=0.5 / &frame T_s=0.8, gamma=3, xi_s=0.05 / ' &
      //"&model formulation='exact' / "
   character(*), parameter :: cable = '&cable eta_0=1.0, eta_alpha=5.0 / '
   character(*), parameter :: loss = "&impact rule='constant', e=0.9 / "
   character(*), parameter :: pulses = "&motion kind='sine', a_max_g=0.5, T_p=0.6, cycles=4 / "
   character(*), parameter :: storeys = "&wall h=2.0, b=0.5 / &frame xi_s=0.05 / &storeys " &
      //"m_over_m_w=3*2.0, k_over_m_w=3*600.0, height=1.5, 1.5, 1.0, coupling='full' / " &
      //"&model formulation='exact' / "
   character(*), parameter :: devices = '&damper c_over_m_w=0.5 / &inerter ' &
      //'inertance_over_m_w=0.2 / &vertical ratio=0.5 / &link L=5.0 / '
   character(*), parameter :: fuse = '&fuse eta_y=0.3, stroke_y=0.005, hardening=0.02 / '
   character(*), parameter :: yielding = '&yielding u_y=0.02, hardening=0.05'
   type(checks_t) :: checks

   ! the error of order 7 vanishes for linear equations
   call check_order(tsitouras_papakostas_64(), 7, 'Tsitouras-Papakostas 6(4)')
   call check_order(dormand_prince_853(), 8, 'Dormand-Prince 8')
   call check_work(tsitouras_papakostas_64(), 6, 'Tsitouras-Papakostas 6(4)')
   call check_work(dormand_prince_853(), 8, 'Dormand-Prince 8')
   call check_conditions(tsitouras_papakostas_64(), 6, 'Tsitouras-Papakostas 6(4)')
   call check_conditions(dormand_prince_853(), 8, 'Dormand-Prince 8')
   call check_bits(wall//cable//loss//pulses//devices//fuse, 'devices')
   call check_bits(wall//cable//loss//pulses//yielding//", law='bouc_wen', exponent=1.7 /", &
      'smooth hysteresis')
   call check_bits(storeys//cable//loss//pulses//"&yielding storey_u_y=0.01, law='bouc_wen' /", &
      'smooth storeys')
   call checks%finish()

contains

   subroutine read_scene(text, case)
      character(*), intent(in) :: text
      type(case_t), intent(out) :: case
      type(error_t), allocatable :: error

      call read_case_text(text, 'scene', case, error)
      call checks%no_error(error, 'scene')
   end subroutine read_scene

   !> Check that halving the step divides the error of a linear oscillator by two to the power of
   !> the order.
   subroutine check_order(pair, order, name)
      type(pair_t), intent(in) :: pair
      integer, intent(in) :: order
      character(*), intent(in) :: name
      type(case_t) :: case
      type(motion_t), target :: motion
      type(equation_t) :: equation
      real(wp) :: y(1, 2), y_new(1, 2), k(1, 2, most_stages), ground(1, most_stages, 2), norm(1)
      real(wp) :: error(2)
      integer :: i, j, steps

      if (.not. checks%wants('order, '//name)) return
      call read_scene('&frame T_s=1.0, xi_s=0.0 / &solver t_end=1.0 /', case)
      motion = motion_from_case(case)
      call build_equation(case, motion, equation)
      ground = 0
      do j = 1, 2
         steps = 10*2**j
         y(1, :) = [1.0_wp, 0.0_wp]
         do i = 1, steps
            call attempt_one(equation%scene, pair, equation%state%coef, ground, [1.0_wp/steps], &
               reshape([1.0_wp, 1.0_wp, 1.0_wp], [1, 3]), y, .false., k, y_new, norm)
            y = y_new
         end do
         error(j) = norm2([y(1, 1) - 1, y(1, 2)/(2*pi)])
      end do
      call checks%close_to(log(error(1)/error(2))/log(2.0_wp), real(order, wp), 'order of '//name, &
         atol=0.3_wp)
   end subroutine check_order

   !> Check the order conditions. Sums of stages are nodes, and powers of nodes are integrated
   !> exactly. An embedded solution differs from the solution by the order of the estimate.
   subroutine check_conditions(pair, order, name)
      type(pair_t), intent(in) :: pair
      integer, intent(in) :: order
      character(*), intent(in) :: name
      real(wp), parameter :: round_off = 1.0e-14_wp
      integer :: k, s

      if (.not. checks%wants('conditions, '//name)) return
      do s = 2, pair%stages
         associate (a => pair%a(s))
            call checks%close_to(sum(a%weight(:a%terms)), pair%c(s), 'nodes of '//name, &
               atol=40*round_off)
         end associate
      end do
      associate (c => pair%c(:pair%stages), b => pair%weight(:pair%stages), e => pair%e)
         do k = 1, order
            call checks%close_to(sum(b*c**(k - 1)), 1.0_wp/k, 'quadrature of '//name, &
               atol=round_off)
         end do
         if (pair%order == pair%error_order) return
         do k = 1, pair%error_order - 1
            call checks%close_to(sum(e%weight(:e%terms)*c(e%stage(:e%terms))**(k - 1)), 0.0_wp, &
               'estimate of '//name, atol=round_off)
         end do
         call checks%that(step_tolerance(pair, 1.0e-7_wp) > 1.0e-7_wp, 'tolerance of '//name)
      end associate
   end subroutine check_conditions

   !> Check that the work of the dampers, the energy loss of a free oscillator, has the order of the
   !> pair.
   subroutine check_work(pair, order, name)
      type(pair_t), intent(in) :: pair
      integer, intent(in) :: order
      character(*), intent(in) :: name
      type(case_t) :: case
      type(motion_t), target :: motion
      type(equation_t) :: equation
      real(wp) :: y(1, 2), y_new(1, 2), k(1, 2, most_stages), ground(1, most_stages, 2), norm(1)
      real(wp) :: work(1, power_count), missing(2), lost
      integer :: i, j, steps

      if (.not. checks%wants('work, '//name)) return
      call read_scene('&frame T_s=1.0, xi_s=0.1 / &solver t_end=1.0 /', case)
      motion = motion_from_case(case)
      call build_equation(case, motion, equation)
      ground = 0
      do j = 1, 2
         steps = 4*2**j
         y(1, :) = [1.0_wp, 0.0_wp]
         lost = mechanical_energy(equation, y(1, :))
         missing(j) = lost
         do i = 1, steps
            call attempt_one(equation%scene, pair, equation%state%coef, ground, [1.0_wp/steps], &
               reshape([1.0_wp, 1.0_wp, 1.0_wp], [1, 3]), y, .false., k, y_new, norm, work)
            y = y_new
            missing(j) = missing(j) - work(1, of_viscous)
         end do
         missing(j) = abs(missing(j) - mechanical_energy(equation, y(1, :)))
      end do
      call checks%that(missing(1) > 2.0_wp**(order - 0.5_wp)*missing(2), 'order of the work, ' &
         //name)
      call checks%that(missing(2) < 2.0e-5_wp*lost, 'work, '//name)
      call checks%that(all(abs(work(1, [of_input, of_plastic])) <= 0), 'no other work, '//name)
   end subroutine check_work

   !> Compare a step of sixteen lanes with a step of each lane on its own, for every instruction
   !> set.
   subroutine check_bits(text, name)
      character(*), intent(in) :: text
      character(*), intent(in) :: name
      integer, parameter :: levels(3) = [1, 3, 4]
      type(case_t) :: case
      type(motion_t), target :: motion
      type(equation_t) :: equation
      type(lane_kernels_t) :: kernels
      type(pair_t) :: pair
      real(wp), allocatable :: coef(:, :), y(:, :), y_new(:, :), k(:, :, :), tolerance(:, :)
      real(wp), allocatable :: alone(:, :), k_alone(:, :, :)
      real(wp) :: ground(batch_width, most_stages, 2), h(batch_width), norm(batch_width), one(1)
      real(wp) :: work(batch_width, power_count), work_alone(1, power_count)
      integer :: i, level, n

      if (.not. checks%wants('bits, '//name)) return
      call read_scene(text//' &solver t_end=4.0 /', case)
      motion = motion_from_case(case)
      call build_equation(case, motion, equation)
      n = equation%n
      pair = dormand_prince_853()
      coef = spread(equation%state%coef(1, :), 1, batch_width)
      allocate (y(batch_width, n), y_new(batch_width, n), k(batch_width, n, most_stages), &
         tolerance(batch_width, 0:n), alone(1, n), k_alone(1, n, most_stages))
      tolerance = 1.0e-6_wp
      do i = 1, batch_width
         y(i, :) = 0.01_wp*[(sin(real(7*i*level + i, wp)), level=1, n)]
         ground(i, :, 1) = sin(real(i, wp))
         ground(i, :, 2) = cos(real(i, wp))
         h(i) = 0.001_wp*i
      end do
      do level = 1, size(levels)
         if (levels(level) > best_level()) cycle
         kernels = lane_kernels_of(levels(level))
         call kernels%attempt_step(equation%scene, pair, coef, ground, h, tolerance, y, .false., &
            k, y_new, norm, work)
         do i = 1, batch_width
            call attempt_one(equation%scene, pair, equation%state%coef, ground(i:i, :, :), h(i:i), &
               tolerance(i:i, :), y(i:i, :), .false., k_alone, alone, one, work_alone)
            call checks%that(all(abs(work_alone(1, :) - work(i, :)) <= 0) &
               .and. sum(abs(work(i, :))) > 0, 'bits of its work, '//name)
            call checks%that(all(abs(alone(1, :) - y_new(i, :)) <= 0) &
               .and. abs(one(1) - norm(i)) <= 0, 'bits of a lane, '//name)
         end do
      end do
   end subroutine check_bits

end program test_lanes
