!> Requirements of a single run that a case with `&spectrum` may leave to its ordinates.
module rwmf_problem_single_run
   use rwmf_core_error, only: err_input, error_t, fail
   use rwmf_core_kinds, only: wp
   use rwmf_problem_case, only: case_t
   use rwmf_problem_group_values, only: has_group
   use rwmf_problem_rules, only: fail_group
   use rwmf_text_strings, only: real_to_text
   implicit none
   private

   public :: has_period, check_single_run, check_tolerance, check_corners

contains

   !> True if the case describes one structure. A frame without T_s has its periods in `&spectrum`.
   pure logical function has_period(case)
      type(case_t), intent(in) :: case

      has_period = .true.
      if (allocated(case%frame)) has_period = allocated(case%frame%T_s)
   end function has_period

   !> Check that the case defines a single run, not only the ordinates of a spectrum.
   !>
   !> All kinds of single runs make this check before they set up the equation of motion. Fails with
   !> `err_input`.
   subroutine check_single_run(case, error)
      type(case_t), intent(in) :: case
      !! valid case
      type(error_t), allocatable, intent(out) :: error
      character(*), parameter :: problem = 'the key T_s is missing (undamped period): must be ' &
         //'given for a single run, a number > 0 [s]; T_s of &spectrum serves spectra only'

      call check_tolerance(case, error)
      if (.not. allocated(error)) call check_rest(case, error)
      if (has_period(case) .or. allocated(error)) return
      if (has_group(case%values, 'frame')) then
         call fail_group(case%values, 'frame', problem, error)
      else
         call fail(error, err_input, '&frame: '//problem)
      end if
   end subroutine check_single_run

   !> Check that the wall rocks on two rigid corners. Fails with `err_input`.
   subroutine check_corners(case, user, error)
      type(case_t), intent(in) :: case
      character(*), intent(in) :: user
      !! analysis that needs the corners, for the message
      type(error_t), allocatable, intent(out) :: error

      if (allocated(case%compliant_base)) call fail(error, err_input, '&base: must not be given ' &
         //'for '//user//', which knows a wall on two rigid corners; runs, spectra, sweeps and ' &
         //'walls that step in a host know a base that gives')
   end subroutine check_corners

   !> Check that weight and tendons hold the wall on both corners of its base. Fails with
   !> `err_input`.
   subroutine check_rest(case, error)
      type(case_t), intent(in) :: case
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: moment(2)
      !! moment that holds the wall against theta > 0 and against theta < 0, over m_w g [m]

      if (.not. allocated(case%cable)) return
      if (.not. allocated(case%cable%offset)) return
      moment = case%wall%b*(1 + sum(case%cable%eta_0)) - [1, -1]*dot_product(case%cable%eta_0, &
         case%cable%offset)
      if (minval(moment) > 0) return
      call fail(error, err_input, '&cable: offset: the tendons tip the wall at rest to the ' &
         //trim(merge('right', 'left ', moment(1) < moment(2)))//', b (1 + sum eta_0) must be > ' &
         //'|sum eta_0 offset| = '//trim(real_to_text(abs(dot_product(case%cable%eta_0, &
         case%cable%offset))))//' m', 'tips_at_rest')
   end subroutine check_rest

   !> Check that double precision can attain the tolerance. The keys of a case are checked when it
   !> is read, but a host program may set the component directly. Fails with `err_input`.
   subroutine check_tolerance(case, error)
      type(case_t), intent(in) :: case
      type(error_t), allocatable, intent(out) :: error
      real(wp), parameter :: least = 45*epsilon(1.0_wp)
      !! 1e-14 in double precision [-]

      if (case%solver%rtol >= least) return
      call fail(error, err_input, '&solver: rtol = '//trim(real_to_text(case%solver%rtol)) &
         //' must be at least 1e-14: below it round-off governs the error of every method')
   end subroutine check_tolerance

end module rwmf_problem_single_run
