!> Procedures in use today for the same scenes, as a baseline for accuracy and cost.
!>
!> | name      | procedure                                                                       |
!> |-----------|---------------------------------------------------------------------------------|
!> | `ode45`   | the paper's: MATLAB's ode45 with its default tolerances, restarted after impacts |
!> | `rk4`     | Runge and Kutta's method with fixed steps                                       |
!> | `newmark` | Newmark's method, average acceleration, with fixed steps                        |
module rwmf_baseline_baseline_run
   use rwmf_baseline_fixed_step, only: follow_with_fixed_steps
   use rwmf_baseline_ode45, only: follow_with_ode45
   use rwmf_baseline_problem, only: baseline_t, create_problem, finish_problem, problem_t, &
      usual_interval
   use rwmf_core_error, only: err_input, err_numerical, error_t, fail
   use rwmf_core_kinds, only: wp
   use rwmf_embedding_ranges, only: positive, require_number
   use rwmf_motion_ground_motion, only: motion_from_case, motion_t
   use rwmf_problem_case, only: case_t
   use rwmf_problem_single_run, only: check_single_run
   implicit none
   private

   public :: baseline_t, run_baseline, usual_interval
   public :: ode45_rtol, ode45_atol

   real(wp), parameter :: ode45_rtol = 1.0e-3_wp
   !! MATLAB's default `RelTol` [-]
   real(wp), parameter :: ode45_atol = 1.0e-6_wp
   !! MATLAB's default `AbsTol` [rad] and [rad/s]

contains

   !> Compute the response of a scene by one of today's procedures.
   !>
   !> Errors: an unknown name; an invalid step; no period of the frame; the numerical failures of
   !> the procedure. Scenes with further states or with hysteretic springs are not supported.
   subroutine run_baseline(case, name, dt, rtol, atol, baseline, error)
      type(case_t), intent(in) :: case
      !! valid
      character(*), intent(in) :: name
      !! 'ode45', 'rk4' or 'newmark'
      real(wp), intent(in) :: dt
      !! step; for ode45 the interval of the checks for uplift; see `usual_interval` [s]
      real(wp), intent(in) :: rtol
      !! relative tolerance of ode45 [-]
      real(wp), intent(in) :: atol
      !! absolute tolerance of ode45 [rad] and [rad/s]
      type(baseline_t), intent(out) :: baseline
      type(error_t), allocatable, intent(out) :: error
      type(motion_t), target :: motion
      type(problem_t) :: scene
      real(wp) :: started
      real(wp) :: finished

      call check_single_run(case, error)
      call require_number(dt, 'dt', positive, error)
      if (allocated(error)) return
      motion = motion_from_case(case)
      call cpu_time(started)
      call create_problem(case, motion, scene)
      if (scene%equation%n > 2 .or. scene%equation%has_bilinear_springs) then
         call fail(error, err_numerical, 'today''s procedures know theta and its rate only: no ' &
            //'floors with all modes, and no springs that yield', 'not_practised')
         return
      end if
      select case (name)
      case ('ode45')
         call follow_with_ode45(scene, rtol, atol, dt, error)
      case ('rk4', 'newmark')
         call follow_with_fixed_steps(scene, name == 'newmark', dt, error)
      case default
         call fail(error, err_input, "practice '"//name//"': 'ode45', 'rk4' or 'newmark'")
      end select
      call cpu_time(finished)
      call finish_problem(scene, baseline)
      baseline%seconds = finished - started
   end subroutine run_baseline

end module rwmf_baseline_baseline_run
