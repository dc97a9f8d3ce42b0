!> Method 'fast': the same peaks as the general kernel, the same bits with any other ordinates.
program test_fast
   use check, only: checks_t
   use rwmf_core_control, only: control_t
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: wp
   use rwmf_model_assembly, only: build_equation, equation_t
   use rwmf_model_effects_loops, only: lane_rates
   use rwmf_model_lanes, only: lane_count, lane_motion_t
   use rwmf_model_scene, only: scene_t
   use rwmf_motion_ground_motion, only: motion_from_case, motion_t
   use rwmf_problem_case, only: case_t
   use rwmf_spectrum_fast_driver, only: begin_fast, exponential_t, run_fast
   use rwmf_spectrum_fast_reduced_equation, only: build_reduced_equation, is_reducible, probe_t
   use rwmf_spectrum_fast_shared_data, only: max_stages, shared_data_t, task_t
   use rwmf_spectrum_fast_simd_dispatch, only: best_level, kernels_of
   use rwmf_spectrum_fast_team, only: ordinate_result_t, run_team
   use rwmf_spectrum_fast_time_grid, only: build_grids
   use rwmf_spectrum_rows, only: rows_of_grid, rows_t
   use rwmf_spectrum_spectrum, only: compute_spectrum, spectrum_t, status_of
   use rwmf_text_strings, only: real_to_text
   use scenes, only: rwmf_scene
   implicit none

   real(wp), parameter :: periods(7) = [0.07_wp, 0.16_wp, 0.3_wp, 0.55_wp, 1.0_wp, 1.7_wp, 2.9_wp]
   !! [s]
   real(wp), parameter :: accuracy = 1.0e-8_wp
   !! of peaks that are no more sensitive than the motion: a tenth of what spectra promise
   real(wp), parameter :: amplified = 1.0e-7_wp
   !! 100 rtol, per unit of the sensitivity (relative change of the peak over that of the motion)
   type(checks_t) :: checks

   if (checks%wants('against_general')) call check_against_general('published', 'linear')
   if (checks%wants('against_general')) call check_against_general('symmetric', 'linear')
   if (checks%wants('against_general')) call check_against_general('exact', 'linear')
   if (checks%wants('against_general')) call check_against_general('symmetric', 'truss')
   if (checks%wants('against_general')) call check_against_general('exact', 'truss')
   if (checks%wants('jumps')) call check_jumps('published')
   if (checks%wants('jumps')) call check_jumps('exact')
   if (checks%wants('end_at_extremum')) call check_end_at_extremum()
   if (checks%wants('near_fault_pulses')) call check_near_fault_pulses()
   if (checks%wants('tiny_response')) call check_tiny_response()
   if (checks%wants('perfect_restitution')) call check_perfect_restitution()
   if (checks%wants('fallback')) call check_fallback()
   if (checks%wants('other_lanes')) call check_other_lanes()
   if (checks%wants('levels')) call check_levels()
   if (checks%wants('wide_motion')) call check_wide_motion()
   if (checks%wants('kinks')) call check_kinks()
   if (checks%wants('reducible')) call check_reducible()
   call checks%finish()

contains

   !> A scene with a spectrum under a record without any pattern.
   function shaken_scene(formulation) result(case)
      character(*), intent(in) :: formulation
      type(case_t) :: case
      integer :: i

      case = rwmf_scene(formulation, 5.0_wp, 1.0_wp, 'fast')
      allocate (case%spectrum, case%record)
      case%spectrum%T_s = periods
      case%spectrum%gamma = [5.0_wp, 1800.0_wp]
      case%spectrum%b = [0.5_wp, 1.0_wp]
      case%motion%kind = 'record'
      deallocate (case%motion%a_max_g, case%motion%omega_p)
      case%record%t = [(0.02_wp*i, i=0, 500)]
      case%record%a = [(0.9_wp*(sin(6.1_wp*0.02_wp*i) + sin(1.7_wp + 14.3_wp*0.02_wp*i) &
         + 0.7_wp*sin(0.3_wp + 37.9_wp*0.02_wp*i)), i=0, 500)]
   end function shaken_scene

   !> Peaks of a case by `fast`, and by the general kernel at the limit of double precision.
   subroutine compare(case, name)
      type(case_t), intent(inout) :: case
      character(*), intent(in) :: name
      type(spectrum_t) :: fast
      type(spectrum_t) :: general
      type(error_t), allocatable :: error
      type(spectrum_t) :: harder
      real(wp), allocatable :: allowed(:, :, :)
      real(wp), allocatable :: excess(:, :, :)
      character(12) :: position
      type(rows_t), target :: rows
      type(exponential_t) :: method
      logical, allocatable :: is_done(:)
      real(wp), allocatable :: u_s_max(:)

      call compute_spectrum(case, 2, fast, error)
      call checks%no_error(error, name)
      call rows_of_grid(case, rows, error)
      call checks%no_error(error, name)
      call begin_fast(rows, 1, control_t(), method)
      allocate (u_s_max(rows%n), is_done(rows%n))
      call run_fast(method, 1, u_s_max, is_done)
      call checks%that(all(is_done), name//': all ordinates in lanes')
      case%solver%method = 'dop853'
      case%solver%rtol = 1.0e-13_wp
      call compute_spectrum(case, 2, general, error)
      call checks%no_error(error, name//', general kernel')
      call checks%that(all(status_of(fast) == status_of(general)), name//': status')
      call shake_harder(case, 1.0e-6_wp)
      call compute_spectrum(case, 2, harder, error)
      call checks%no_error(error, name//', larger motion')
      allowed = accuracy + amplified*abs(harder%values(:, :, :, 1)/general%values(:, :, :, 1) &
         - 1)/1.0e-6_wp
      excess = abs(fast%values(:, :, :, 1)/general%values(:, :, :, 1) - 1)/allowed
      write (position, '(3i4)') maxloc(excess)
      call checks%that(all(excess <= 1), name//': peaks', &
         'error over what is allowed '//trim(real_to_text(maxval(excess)))//' at '//position)
   end subroutine compare

   !> Enlarge the motion of a case.
   subroutine shake_harder(case, step)
      type(case_t), intent(inout) :: case
      real(wp), intent(in) :: step
      !! relative [-]

      case%record%a = (1 + step)*case%record%a
      if (allocated(case%motion%a_max_g)) case%motion%a_max_g = (1 + step)*case%motion%a_max_g
   end subroutine shake_harder

   subroutine check_against_general(formulation, law)
      character(*), intent(in) :: formulation
      character(*), intent(in) :: law
      type(case_t) :: case

      case = shaken_scene(formulation)
      case%cable%law = law
      call compare(case, formulation//', '//law//', record')
      case = shaken_scene(formulation)
      case%cable%law = law
      case%motion = pulse_of('one_sine')
      call compare(case, formulation//', '//law//', pulse')
   end subroutine check_against_general

   !> A cosine pulse begins and ends with a jump; once without a cable.
   subroutine check_jumps(formulation)
      character(*), intent(in) :: formulation
      type(case_t) :: case

      case = shaken_scene(formulation)
      case%motion = pulse_of('one_cosine')
      if (formulation == 'exact') deallocate (case%cable)
      case%solver%t_end = 3
      call compare(case, formulation//', one-cosine')
   end subroutine check_jumps

   !> The steps are as short as the shape of each pulse asks for.
   subroutine check_near_fault_pulses()
      character(23), parameter :: kinds(4) = [character(23) :: 'type_c', 'ricker', &
         'ricker_antisymmetric', 'mavroeidis_papageorgiou']
      type(case_t) :: case
      integer :: i

      do i = 1, size(kinds)
         case = shaken_scene('symmetric')
         case%motion = pulse_of(trim(kinds(i)))
         case%motion%n_pulses = 2
         case%motion%nu = 0.7_wp
         case%motion%gamma_p = 1.3_wp
         call compare(case, 'pulse '//trim(kinds(i)))
      end do
   end subroutine check_near_fault_pulses

   !> Pulse of the scenes of the other tests.
   function pulse_of(kind) result(motion)
      use rwmf_problem_case, only: motion_spec_t
      character(*), intent(in) :: kind
      type(motion_spec_t) :: motion
      type(case_t) :: case

      case = rwmf_scene('symmetric', 5.0_wp, 1.0_wp, 'fast')
      motion = case%motion
      motion%kind = kind
   end function pulse_of

   !> A pulse that ends with a jump at its extremum, which round-off puts a little before the end.
   subroutine check_end_at_extremum()
      integer :: i, k
      real(wp), parameter :: T_p(12) = [1.4047591485346191_wp, 1.1_wp, 1.7_wp, &
         (0.4_wp + 0.13_wp*k, k=1, 9)]
      !! [s]
      type(case_t) :: case
      type(shared_data_t), target :: shared

      allocate (shared%grid(1))
      do i = 1, size(T_p)
         case = shaken_scene('exact')
         case%motion = pulse_of('sine')
         case%motion%cycles = 1.25_wp
         case%motion%a_max_g = 0.2_wp
         case%motion%t_0 = 0.37_wp
         case%motion%omega_p = 2*acos(-1.0_wp)/T_p(i)
         case%solver%t_end = 5
         call build_grids(case, motion_from_case(case), 1, [0.02_wp], shared%ground, shared%grid)
         call checks%that(minval(shared%grid(1)%step%h) > 1.0e-9_wp, &
            'end at an extremum, no vanishing step: '//trim(real_to_text(T_p(i))))
         if (i <= 3) call compare(case, 'end at an extremum, '//trim(real_to_text(T_p(i))))
      end do
   end subroutine check_end_at_extremum

   !> A motion that barely lifts the wall: no absolute tolerance hides in the method.
   subroutine check_tiny_response()
      type(case_t) :: case

      case = shaken_scene('symmetric')
      case%motion = pulse_of('one_sine')
      case%spectrum%gamma = [5.0_wp]
      case%spectrum%b = [0.5_wp]
      ! 0.1 % above the threshold of lift-off
      case%motion%a_max_g = 1.001_wp*0.25_wp*2/11
      call compare(case, 'tiny response')
   end subroutine check_tiny_response

   subroutine check_perfect_restitution()
      type(case_t) :: case

      case = shaken_scene('symmetric')
      case%impact%e = 1
      case%spectrum%T_s = [0.5_wp, 1.0_wp, 2.0_wp]
      call compare(case, 'e = 1')
   end subroutine check_perfect_restitution

   !> Small mass ratios, overturning and effects beyond the method go to the general kernel.
   subroutine check_fallback()
      type(case_t) :: case
      type(spectrum_t) :: fast
      type(spectrum_t) :: general
      type(error_t), allocatable :: error

      case = shaken_scene('symmetric')
      case%spectrum%T_s = [0.5_wp, 2.5_wp]
      case%spectrum%gamma = [1.0_wp, 5.0_wp]
      case%spectrum%b = [0.15_wp]
      case%motion = pulse_of('one_sine')
      case%motion%a_max_g = 5
      deallocate (case%cable)
      call compute_spectrum(case, 1, fast, error)
      call checks%no_error(error, 'fallback')
      case%solver%method = 'dop853'
      call compute_spectrum(case, 1, general, error)
      call checks%that(any(status_of(general) == 'overturned'), 'fallback: something overturns')
      call checks%that(all(status_of(fast) == status_of(general)), 'fallback: status')
      call checks%that(all(abs(fast%values(:, 1, 1, 1) - general%values(:, 1, 1, 1)) &
         <= 10*case%solver%rtol*general%values(:, 1, 1, 1)), 'fallback: peaks in general lanes')
   end subroutine check_fallback

   !> An ordinate has the same bits alone, in any order and for any number of threads.
   subroutine check_other_lanes()
      type(case_t) :: case
      type(spectrum_t) :: together
      type(spectrum_t) :: alone
      type(error_t), allocatable :: error
      integer :: i

      case = shaken_scene('published')
      case%spectrum%T_s = [periods(7:1:-1), (0.5_wp + 0.01_wp*i, i=1, 90)]
      call compute_spectrum(case, 2, together, error)
      call checks%no_error(error, 'other lanes')
      do i = 1, size(periods)
         case%spectrum%T_s = [together%T_s(i)]
         call compute_spectrum(case, 1, alone, error)
         call checks%that(all(abs(alone%values(1, :, :, 1) - together%values(i, :, :, 1)) <= 0), &
            'other lanes: same bits')
      end do
   end subroutine check_other_lanes

   !> Ordinates that leave the range of the polynomials are repeated on wider ones: as accurate, and
   !> with the same bits alone and in two threads.
   subroutine check_wide_motion()
      real(wp), parameter :: narrow = 0.1_wp
      !! the first range ends there
      type(case_t) :: case
      type(spectrum_t) :: together, alone
      type(error_t), allocatable :: error
      integer :: i

      case = shaken_scene('exact')
      call shake_harder(case, 2.0_wp)
      call compute_spectrum(case, 2, together, error)
      call checks%no_error(error, 'wide motion')
      associate (length => 2*hypot(case%wall%h, 0.5_wp))
         call checks%that(maxval(together%values(:, :, 1, 1)) > narrow*length, &
            'wide motion: is wide')
      end associate
      do i = 1, size(periods)
         case%spectrum%T_s = [periods(i)]
         call compute_spectrum(case, 1, alone, error)
         call checks%that(all(abs(alone%values(1, :, :, 1) - together%values(i, :, :, 1)) <= 0), &
            'wide motion: same bits')
      end do
      case%spectrum%T_s = periods
      call compare(case, 'wide motion')
   end subroutine check_wide_motion

   !> Every instruction set gives the same bits, for every number of evaluations.
   subroutine check_levels()
      integer, parameter :: levels(3) = [1, 3, 4]
      type(shared_data_t), target :: shared
      type(task_t), allocatable :: task(:)
      type(ordinate_result_t) :: found(size(periods), size(levels))
      integer :: i, next, stages

      do stages = 1, max_stages
         call prepare(stages, shared, task)
         do i = 1, size(levels)
            shared%kernels = kernels_of(min(levels(i), best_level()))
            next = 0
            call run_team(shared, task, next, found(:, i))
         end do
         call checks%that(.not. any(found%failed), 'levels: nothing failed')
         call checks%that(all(abs(found(:, 2)%v_max - found(:, 1)%v_max) <= 0), 'levels: AVX2')
         call checks%that(all(abs(found(:, 3)%v_max - found(:, 1)%v_max) <= 0), 'levels: AVX-512')
      end do
   end subroutine check_levels

   !> Equal steps of a record differ by round-off; that is no jump of the acceleration.
   subroutine check_kinks()
      type(shared_data_t), target :: shared
      type(task_t), allocatable :: task(:)

      call prepare(1, shared, task)
      call checks%that(any(abs(shared%ground%kink) > 0), 'kinks: there are some')
      call checks%that(.not. any(shared%grid%has_jumps), 'kinks: no jumps')
   end subroutine check_kinks

   !> Only moments that are parabolas in phi' and straight lines in the ground motion are reduced.
   subroutine check_reducible()
      type(case_t) :: case
      type(equation_t) :: equation
      type(probe_t) :: probe
      real(wp), parameter :: phi(2) = [0.0_wp, 0.05_wp]
      !! [rad]
      integer :: i

      case = shaken_scene('exact')
      allocate (case%damper, case%inerter)
      case%damper%c_over_m_w = 3
      case%inerter%inertance_over_m_w = 0.2_wp
      call build_equation(case, motion_from_case(case), equation)
      probe%scene = equation%scene
      probe%coef = equation%state%coef
      probe%side = 1
      probe%gamma = case%frame%gamma
      probe%ratio = 0.3_wp
      do i = 1, size(phi)
         probe%rates => lane_rates
         call checks%that(is_reducible(probe, phi(i)), 'own effects are reduced')
         probe%rates => with_root
         call checks%that(.not. is_reducible(probe, phi(i)), 'a root of the rate is not')
         probe%rates => with_friction
         call checks%that(.not. is_reducible(probe, phi(i)), 'friction is not')
         probe%rates => with_cube
         call checks%that(.not. is_reducible(probe, phi(i)), 'a cube of the rate is not')
         probe%rates => with_limit
         call checks%that(.not. is_reducible(probe, phi(i)), 'a valve that opens is not')
         probe%rates => with_coupling
         call checks%that(.not. is_reducible(probe, phi(i)), 'ground times rate is not')
         probe%rates => with_inertia
         call checks%that(.not. is_reducible(probe, phi(i)), 'inertia that depends on it is not')
      end do
   end subroutine check_reducible

   !> The equation of motion with a damper of the power 0.5.
   subroutine with_root(scene, coef, y, motion, y_dot)
      type(scene_t), intent(in) :: scene
      real(wp), intent(in) :: coef(lane_count, scene%n_coef)
      real(wp), intent(in) :: y(lane_count, scene%n)
      type(lane_motion_t), intent(inout) :: motion
      real(wp), intent(out) :: y_dot(lane_count, scene%n)

      call lane_rates(scene, coef, y, motion, y_dot)
      motion%moment = motion%moment - 0.1_wp*sign(sqrt(abs(motion%rate)), motion%rate)
   end subroutine with_root

   !> The equation of motion with friction.
   subroutine with_friction(scene, coef, y, motion, y_dot)
      type(scene_t), intent(in) :: scene
      real(wp), intent(in) :: coef(lane_count, scene%n_coef)
      real(wp), intent(in) :: y(lane_count, scene%n)
      type(lane_motion_t), intent(inout) :: motion
      real(wp), intent(out) :: y_dot(lane_count, scene%n)

      call lane_rates(scene, coef, y, motion, y_dot)
      motion%moment = motion%moment - 0.01_wp*sign(1.0_wp, motion%rate)
   end subroutine with_friction

   !> The equation of motion with a cubic damper.
   subroutine with_cube(scene, coef, y, motion, y_dot)
      type(scene_t), intent(in) :: scene
      real(wp), intent(in) :: coef(lane_count, scene%n_coef)
      real(wp), intent(in) :: y(lane_count, scene%n)
      type(lane_motion_t), intent(inout) :: motion
      real(wp), intent(out) :: y_dot(lane_count, scene%n)

      call lane_rates(scene, coef, y, motion, y_dot)
      motion%moment = motion%moment - 0.01_wp*motion%rate**3
   end subroutine with_cube

   !> The equation of motion with a damper whose force is limited beyond 20 rad/s.
   subroutine with_limit(scene, coef, y, motion, y_dot)
      type(scene_t), intent(in) :: scene
      real(wp), intent(in) :: coef(lane_count, scene%n_coef)
      real(wp), intent(in) :: y(lane_count, scene%n)
      type(lane_motion_t), intent(inout) :: motion
      real(wp), intent(out) :: y_dot(lane_count, scene%n)

      call lane_rates(scene, coef, y, motion, y_dot)
      motion%moment = motion%moment - 0.01_wp*min(20.0_wp, max(-20.0_wp, motion%rate))
   end subroutine with_limit

   !> The equation of motion with a moment by ground motion times rate.
   subroutine with_coupling(scene, coef, y, motion, y_dot)
      type(scene_t), intent(in) :: scene
      real(wp), intent(in) :: coef(lane_count, scene%n_coef)
      real(wp), intent(in) :: y(lane_count, scene%n)
      type(lane_motion_t), intent(inout) :: motion
      real(wp), intent(out) :: y_dot(lane_count, scene%n)

      call lane_rates(scene, coef, y, motion, y_dot)
      motion%moment = motion%moment - 0.01_wp*motion%ground*motion%rate
   end subroutine with_coupling

   !> The equation of motion with an inertia that depends on the rate.
   subroutine with_inertia(scene, coef, y, motion, y_dot)
      type(scene_t), intent(in) :: scene
      real(wp), intent(in) :: coef(lane_count, scene%n_coef)
      real(wp), intent(in) :: y(lane_count, scene%n)
      type(lane_motion_t), intent(inout) :: motion
      real(wp), intent(out) :: y_dot(lane_count, scene%n)

      call lane_rates(scene, coef, y, motion, y_dot)
      motion%inertia = motion%inertia + 0.01_wp*motion%rate**2
   end subroutine with_inertia

   !> Shared data and tasks of the shaken wall.
   subroutine prepare(stages, shared, task)
      integer, intent(in) :: stages
      !! evaluations of N in a step
      type(shared_data_t), target, intent(out) :: shared
      type(task_t), allocatable, intent(out) :: task(:)
      type(case_t) :: case
      type(motion_t) :: motion
      integer :: i

      case = shaken_scene('exact')
      shared%kernels = kernels_of(best_level())
      shared%rtol = case%solver%rtol
      allocate (shared%grid(1), shared%equation(1))
      motion = motion_from_case(case)
      call build_grids(case, motion, 1, [0.005_wp], shared%ground, shared%grid)
      call build_reduced_equation(case, motion, 0.2_wp, 0.0_wp, shared%equation(1))
      task = [(task_t(periods(i), 1, 1, stages, case%frame%xi_s), i=1, size(periods))]
   end subroutine prepare

end program test_fast
