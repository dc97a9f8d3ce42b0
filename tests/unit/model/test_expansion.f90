!> Taylor series of all states: their derivative equals the rates of the equation of motion inside
!> a step, for every effect, law and coupling, on both sides.
program test_expansion
   use check, only: checks_t
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: wp
   use rwmf_input_reader, only: read_case_text
   use rwmf_model_equation, only: enter_interval, enter_side, equation_t, interval_of, &
      renew_coefficients
   use rwmf_model_series_scene_series, only: expand_states, series_memory
   use rwmf_model_series_series_motion, only: highest_order, series_motion_t, set_ground
   use rwmf_model_system_assembly, only: build_equation, rates_at
   use rwmf_motion_ground_motion, only: expand_ground, interval_at, motion_from_case, motion_t
   use rwmf_problem_case, only: case_t
   implicit none

   character(*), parameter :: wall = '&wall h=2.0, b=0.5 /', frame = ' &frame T_s=0.8, gamma=3, ' &
      //'xi_s=0.05 /', cable = ' &cable eta_0=1.0, eta_alpha=5.0 /', plain = wall//frame//cable, &
      smooth = " &yielding u_y=0.02, hardening=0.1, law='bouc_wen', ", &
      storeys = ' &frame xi_s=0.05 / &storeys m_over_m_w=3*0.5, k_over_m_w=300.0, 260.0, 200.0, ' &
      //'height=1.5, 1.25, 1.25, coupling=', &
      yields = " &yielding storey_u_y=0.01, hardening=0.1, law='bouc_wen', exponent=", &
      bending = ' &bending EI_over_m_w=5000.0, modes=2, xi=0.02 /'
   character(*), parameter :: sine = "kind='sine', a_max_g=0.5, T_p=0.6, cycles=4"
   real(wp), parameter :: begin = 0.4_wp
   !! of the step [s]
   type(checks_t) :: checks

   call check_scene('plain', plain, sine)
   call check_scene('exact', plain//" &model formulation='exact' /", sine)
   call check_scene('published', plain//" &model formulation='published' /", sine)
   call check_scene('frame alone', ' &frame T_s=0.8, xi_s=0.05 /', sine)
   call check_scene('pinned', "&wall h=2.0, b=0.5, base='pinned' /"//frame, sine)
   call check_scene('straight cable', wall//frame &
      //" &cable eta_0=0.0, eta_alpha=5.0, law='truss' /", sine)
   call check_scene('link', plain//' &link L=5.0 /', sine)
   call check_scene('devices', plain//' &damper c_over_m_w=0.5 / &inerter ' &
      //'inertance_over_m_w=0.2 / &vertical ratio=0.5 / &fuse eta_y=0.3, stroke_y=0.005, ' &
      //'hardening=0.02 / &p_delta /', sine)
   call check_scene('dampers, 0.4', plain//' &nl_damper eta_1=0.5, exponent=0.4 /', sine)
   call check_scene('dampers, 2', plain//' &nl_damper eta_1=0.5, exponent=2.0 /', sine)
   call check_scene('smooth frame, 2', plain//smooth//'exponent=2.0 /', sine)
   call check_scene('smooth frame, 5', plain//smooth//'exponent=5.0 /', sine)
   call check_scene('smooth frame, 1.5', plain//smooth//'exponent=1.5 /', sine)
   call check_scene('full', wall//cable//storeys//"'full' /", sine)
   call check_scene('reduced', wall//cable//storeys//"'reduced' /", sine)
   call check_scene('every floor', wall//cable//storeys//"'every_floor' /", sine)
   call check_scene('springs', wall//cable//storeys//"'springs', k_link_over_m_w=3*900.0 /", sine)
   call check_scene('full, P-Delta', wall//cable//storeys//"'full' / &p_delta /", sine)
   call check_scene('springs, P-Delta', wall//cable//storeys &
      //"'springs', k_link_over_m_w=3*900.0 / &p_delta /", sine)
   call check_scene('full, smooth', wall//cable//storeys//"'full' /"//yields//'1.5 /', sine)
   call check_scene('springs, smooth', wall//cable//storeys &
      //"'springs', k_link_over_m_w=3*900.0 /"//yields//'3.0 /', sine)
   call check_scene('storeys alone', storeys//"'full' /"//yields//'1.0 /', sine)
   call check_scene('bending', plain//bending, sine)
   call check_scene('bending, smooth frame', plain//bending//smooth//'exponent=1.5 /', sine)
   call check_scene('bending, vertical', plain//bending//' &vertical ratio=0.5 /', sine)
   call check_scene('bending, full', wall//cable//storeys//"'full' /"//bending, sine)
   call check_scene('bending, every floor', wall//cable//storeys//"'every_floor' /"//bending, sine)
   call check_scene('bending, every floor, smooth', wall//cable//storeys//"'every_floor' /" &
      //yields//'1.5 /'//bending, sine)
   call check_scene('bending, springs', wall//cable//storeys &
      //"'springs', k_link_over_m_w=3*900.0 /"//bending, sine)
   call check_scene('pulse', plain, "kind='ricker', a_max_g=0.5, T_p=0.6")
   call check_scene('antisymmetric pulse', plain, "kind='ricker_antisymmetric', a_max_g=0.5, " &
      //'T_p=0.6')
   call check_scene('pulse with cycles', plain, "kind='mavroeidis_papageorgiou', a_max_g=0.5, " &
      //'T_p=0.6, gamma_p=2.0, nu=0.7')
   call checks%finish()

contains

   !> Compare the derivative of the series with the rates at states on the series.
   subroutine check_scene(name, text, given)
      character(*), intent(in) :: name
      character(*), intent(in) :: text
      character(*), intent(in) :: given
      !! keys of `&motion`
      type(case_t) :: case
      type(error_t), allocatable :: error
      type(motion_t), target :: motion
      type(equation_t) :: equation
      real(wp), allocatable :: y(:), at_h(:), slope(:), rates(:)
      real(wp) :: worst
      integer :: i, side, step

      if (.not. checks%wants(name)) return
      call read_case_text(text//' &motion '//given//' / &solver t_end=1 /', '', case, error)
      call checks%that(.not. allocated(error), name//' is read')
      if (allocated(error)) return
      motion = motion_from_case(case)
      call build_equation(case, motion, equation)
      call enter_interval(equation%model_t, equation%state, interval_at(motion, begin))
      allocate (at_h(equation%n), slope(equation%n), rates(equation%n))
      y = [(0.3_wp + 0.2_wp*sin(1.7_wp*i), i=1, equation%n)]
      worst = 0
      do side = -1, 1, 2
         call enter_side(equation%model_t, equation%state, side)
         call renew_coefficients(equation%model_t, equation%state)
         y(:2) = side*[0.02_wp, 0.1_wp]
         do step = 0, 4
            call follow_series(equation, y, step*2.0e-5_wp, at_h, slope)
            call rates_at(equation, begin + step*2.0e-5_wp, at_h, rates)
            worst = max(worst, maxval(abs(slope - rates)/(1.0e-3_wp + abs(rates))))
         end do
      end do
      call checks%that(worst < 1.0e-9_wp, name//' satisfies its equation')
   end subroutine check_scene

   !> States and their derivatives on the series from a state.
   subroutine follow_series(equation, y, h, at_h, slope)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:), h
      real(wp), intent(out) :: at_h(:), slope(:)
      integer, parameter :: order = 12
      type(series_motion_t) :: motion
      real(wp), allocatable :: series(:, :, :), memory(:, :, :)
      real(wp) :: ground(0:order), upward(0:order)
      integer :: k, known

      allocate (series(1, 0:highest_order, size(y)), memory(1, 0:highest_order, &
         series_memory(equation%scene)))
      known = order
      call expand_ground(equation%motion, interval_of(equation), begin, 0.01_wp, known, ground, &
         upward)
      call set_ground(known, ground, upward, motion)
      series(1, 0, :) = y
      call expand_states(equation%scene, equation%state%coef, 0, order, motion, series, memory)
      at_h = series(1, order, :)
      slope = 0
      do k = order - 1, 0, -1
         slope = slope*h + at_h
         at_h = at_h*h + series(1, k, :)
      end do
   end subroutine follow_series

end program test_expansion
