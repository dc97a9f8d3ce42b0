!> Procedure of the paper, section 2.2: Eqs (15a) and (15b), and sqrt(r) at each impact.
!>
!> The paper integrates with ode45 of MATLAB. An event function stops it at theta = 0, the velocity
!> is multiplied by sqrt(r), and the integration starts again. Here CVODE integrates by Adams
!> methods at the tolerances of the case, and `CVodeRootInit` defines the events. CVODE stops at
!> every knot of the motion, so no step contains a corner of a record. Peaks of theta are roots of
!> theta' in the same search.
!>
!> The paper has no rule for three situations:
!>
!> * Rest: Eq. (15) holds for theta /= 0. A wall rests until the acceleration of (15a) or (15b) at
!>   theta = 0 leads off its base (`rwmf_model_system_lift_off`).
!> * Chatter: infinitely many impacts precede rest. An impact ends in rest if all that follows is
!>   negligible (`rwmf_model_system_rest_after_chatter`).
!> * Two impacts in one step, which a root search does not see: theta has the wrong sign at the end.
!>   Up to ten times the absolute tolerance this counts as an impact; otherwise the run fails.
module rwmf_paper_paper_run
   use, intrinsic :: iso_c_binding, only: c_double, c_f_pointer, c_funloc, c_int, c_loc, c_ptr
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use fcvode_mod, only: CV_ADAMS, CV_ONE_STEP, CV_ROOT_RETURN, FCVode, FCVodeGetRootInfo, &
      FCVodeRootInit, FCVodeSetMaxStep, FCVodeSetRootDirection, FCVodeSetStopTime, &
      FCVodeSetUserData
   use fsundials_nvector_mod, only: N_Vector
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: i8, wp
   use rwmf_integrator_interface_integrator, only: fail_step, tolerance_t
   use rwmf_integrator_sundials_common, only: create_common, data_of, destroy_common, has_failed, &
      is_tiny, iterate_functionally, restart, step_by_hand, sundials_t
   use rwmf_model_system_assembly, only: enter_side, equation_t
   use rwmf_model_equation, only: ground
   use rwmf_model_system_rest_after_chatter, only: decelerations, may_rest
   use rwmf_paper_coefficients, only: coefficients_a, coefficients_b
   implicit none
   private

   public :: paper_t, at_impact, at_peak, at_overturning

   integer, parameter :: at_impact = 1
   !! root of theta
   integer, parameter :: at_peak = 2
   !! root of theta'
   integer, parameter :: at_overturning = 3
   !! root of |theta| - overturning angle
   integer, parameter :: n_roots = 3

   !> Data of CVODE's callbacks.
   type :: paper_scene_t
      type(equation_t), pointer :: equation => null()
      real(wp) :: overturning_angle = huge(1.0_wp)
      !! [rad]
   end type paper_scene_t

   !> Integrator of Eq. (15) whose steps end at roots.
   type, extends(sundials_t) :: paper_t
      integer :: root = 0
      !! root at the end of the last step, one of the `at_` numbers; 0 without one
      type(paper_scene_t), pointer :: scene => null()
   contains
      procedure :: create => create_paper
      procedure :: start => start_paper
      procedure :: step => step_paper
      procedure :: destroy => destroy_paper
      procedure :: land
   end type paper_t

contains

   !> Angular acceleration by Eq. (15a) on the left corner and Eq. (15b) on the right one [rad/s2].
   real(wp) function acceleration_of(equation, t, y) result(theta_ddot)
      type(equation_t), intent(in) :: equation
      !! in the interval of the motion that contains t
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: y(2)
      !! theta [rad] and theta' [rad/s], Eq. (13)
      real(wp) :: C(4)

      if (equation%state%side < 0) then
         C = coefficients_a(equation%p, y(1))
      else
         C = coefficients_b(equation%p, y(1))
      end if
      theta_ddot = C(1)*y(2)**2 + C(2)*y(2) + C(3)*ground(equation, t) + C(4)
   end function acceleration_of

   !> Evaluate the rates of Eq. (14) for CVODE.
   integer(c_int) function evaluate_rates(t, vector, vector_dot, user_data) bind(c, name='')
      real(c_double), value :: t
      type(N_Vector), intent(inout) :: vector
      type(N_Vector), intent(inout) :: vector_dot
      type(c_ptr), value :: user_data
      type(paper_scene_t), pointer :: scene
      real(c_double), pointer, contiguous :: y(:), y_dot(:)

      call c_f_pointer(user_data, scene)
      call data_of(vector, 2, y)
      call data_of(vector_dot, 2, y_dot)
      y_dot = [y(2), acceleration_of(scene%equation, t, y)]
      scene%equation%rhs_evaluations = scene%equation%rhs_evaluations + 1_i8
      evaluate_rates = merge(0_c_int, 1_c_int, ieee_is_finite(y_dot(2)))
   end function evaluate_rates

   !> Evaluate the root functions for CVODE.
   integer(c_int) function evaluate_roots(t, vector, values, user_data) bind(c, name='')
      real(c_double), value :: t
      type(N_Vector), intent(inout) :: vector
      real(c_double), intent(out) :: values(n_roots)
      type(c_ptr), value :: user_data
      type(paper_scene_t), pointer :: scene
      real(c_double), pointer, contiguous :: y(:)

      call c_f_pointer(user_data, scene)
      call data_of(vector, 2, y)
      values = [y(1), y(2), abs(y(1)) - scene%overturning_angle]
      evaluate_roots = 0
   end function evaluate_roots

   subroutine create_paper(self, equation, tolerance, error)
      class(paper_t), intent(inout) :: self
      type(equation_t), intent(inout), target :: equation
      type(tolerance_t), intent(in) :: tolerance
      type(error_t), allocatable, intent(out) :: error

      call self%destroy()
      call create_common(self, CV_ADAMS, c_funloc(evaluate_rates), equation, tolerance, error)
      if (allocated(error)) return
      allocate (self%scene)
      self%scene%equation => equation
      if (has_failed(self, FCVodeSetUserData(self%memory, c_loc(self%scene)), &
         'user data', error)) return
      call iterate_functionally(self, error)
      if (allocated(error)) return
      if (has_failed(self, FCVodeRootInit(self%memory, n_roots, c_funloc(evaluate_roots)), &
         'CVodeRootInit', error)) return
   end subroutine create_paper

   !> Start a flight. From theta = 0 its steps are short compared with the expected flight, which
   !> can be lower than the absolute tolerance.
   subroutine start_paper(self, t, y, span, error)
      class(paper_t), intent(inout) :: self
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(:)
      real(wp), intent(in) :: span
      !! not used
      type(error_t), allocatable, intent(out) :: error
      integer(c_int) :: directions(n_roots)
      real(wp) :: longest
      !! longest step [s]; 0 for no limit
      real(wp) :: pull
      !! deceleration [rad/s2]

      call restart(self, t, y, error)
      if (allocated(error)) return
      pull = -self%equation%state%side*acceleration_of(self%equation, t, y)
      longest = 0
      if (abs(y(1)) <= 0 .and. abs(y(2)) < pull) longest = 0.1_wp*abs(y(2))/pull
      if (has_failed(self, FCVodeSetMaxStep(self%memory, longest), 'longest step', error)) return
      directions = [-self%equation%state%side, 0, 1]
      if (has_failed(self, FCVodeSetRootDirection(self%memory, directions), &
         'root direction', error)) return
   end subroutine start_paper

   !> Take a step of CVODE, which ends at a root or at t_limit at the latest.
   subroutine step_paper(self, t_limit, error)
      class(paper_t), intent(inout) :: self
      real(wp), intent(in) :: t_limit
      type(error_t), allocatable, intent(out) :: error
      real(c_double) :: reached(1)
      integer(c_int) :: found(n_roots)
      integer(c_int) :: flag

      self%root = 0
      if (is_tiny(self%t1, t_limit)) then
         call step_by_hand(self, t_limit, error)
         return
      end if
      self%t0 = self%t1
      self%y0(:) = self%y1
      if (has_failed(self, FCVodeSetStopTime(self%memory, t_limit), 'stop time', error)) return
      flag = FCVode(self%memory, t_limit, self%vector, reached, CV_ONE_STEP)
      if (has_failed(self, flag, 'CVode', error)) return
      self%t1 = reached(1)
      self%y1(:) = self%state
      self%steps = self%steps + 1_i8
      if (flag == CV_ROOT_RETURN) then
         if (has_failed(self, FCVodeGetRootInfo(self%memory, found), 'root', error)) return
         self%root = findloc(found /= 0, .true., dim=1)
      end if
      if (self%root == at_impact .or. self%equation%state%side*self%y1(1) >= 0) return
      if (abs(self%y1(1)) > 10*self%atol(1)) call fail_step(self, 'method ''paper''', self%rtol, &
         'the root search of CVODE has missed an impact: lower rtol or use another method', error)
      ! a peak on the wrong side, as round-off gives at lift-off, is none
      self%root = merge(at_impact, 0, self%root == 0)
   end subroutine step_paper

   !> Apply an impact at the end of the last step: multiply the velocity by sqrt(r).
   !>
   !> The wall changes its corner, or rests if the flights that follow are negligible.
   subroutine land(self, root_of_r, y)
      class(paper_t), intent(inout) :: self
      real(wp), intent(in) :: root_of_r
      !! sqrt(r), angular velocity after over before the impact [-]
      real(wp), intent(out) :: y(:)
      !! theta [rad] and theta' [rad/s] after the impact; both are 0 if the wall rests

      y = [0.0_wp, root_of_r*self%y1(2)]
      associate (equation => self%equation, small => 0.01_wp*self%atol)
         call enter_side(equation%model_t, equation%state, int(sign(1.0_wp, y(2))))
         if (may_rest(equation, self%t1, y, abs(y(2)), root_of_r, small(1), small(2), &
            decelerations(equation, self%t1))) y = 0
      end associate
   end subroutine land

   subroutine destroy_paper(self)
      class(paper_t), intent(inout) :: self

      call destroy_common(self)
      if (associated(self%scene)) deallocate (self%scene)
      self%scene => null()
   end subroutine destroy_paper

end module rwmf_paper_paper_run
