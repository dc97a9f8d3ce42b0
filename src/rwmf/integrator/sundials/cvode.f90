!> CVODE behind the `integrator_t` interface: Adams with functional iteration, or BDF with Newton
!> and a Jacobian by central differences.
module rwmf_integrator_sundials_cvode
   use, intrinsic :: iso_c_binding, only: c_double, c_f_pointer, c_funloc, c_int, c_loc, c_ptr
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use fcvode_mod, only: CV_ADAMS, CV_BDF, CV_ONE_STEP, FCVode, FCVodeSetJacFn, &
      FCVodeSetLinearSolver, FCVodeSetNonlinConvCoef, FCVodeSetStopTime
   use fsundials_linearsolver_mod, only: FSUNLinSolFree, SUNLinearSolver
   use fsundials_matrix_mod, only: FSUNMatDestroy, SUNMatrix
   use fsundials_nvector_mod, only: N_Vector
   use fsunlinsol_dense_mod, only: FSUNLinSol_Dense
   use fsunmatrix_dense_mod, only: FSUNDenseMatrix, FSUNDenseMatrix_Data
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: i8, wp
   use rwmf_integrator_interface_integrator, only: tolerance_t
   use rwmf_integrator_sundials_common, only: create_common, data_of, destroy_common, &
      evaluate_rhs, has_failed, is_tiny, iterate_functionally, made, restart, step_by_hand, &
      sundials_t, too_small
   use rwmf_model_system_assembly, only: equation_t
   use rwmf_model_system_jacobian, only: find_jacobian
   implicit none
   private

   public :: cvode_t

   ! The local errors of thousands of short steps add up in a multistep method that restarts at each
   ! impact, and most in BDF. With these shares of the tolerance, rtol gives about equal accuracy
   ! with every method (measured on random cases, docs/validation/accuracy.md).
   real(wp), parameter :: adams_share = 0.03_wp
   real(wp), parameter :: bdf_share = 0.05_wp
   real(wp), parameter :: adams_iteration = 0.3_wp
   !! part of the Adams tolerance for the functional iteration. For so small a share of the caller's
   !! tolerance the iteration need not be more exact than the step.
   real(wp), parameter :: least_rtol = 1.0e-14_wp
   !! smallest relative tolerance: below it, CVODE's error test detects only round-off
   integer, parameter :: most_stuck = 100
   !! largest number of consecutive steps too short to advance the time

   !> Integrator with CVODE.
   type, extends(sundials_t) :: cvode_t
      private
      logical, public :: is_stiff = .false.
      !! BDF with Newton iteration instead of Adams with functional iteration
      real(wp) :: t_stop = 0
      !! stop time set in CVODE, which clears it on arrival [s]
      real(wp) :: t_first
      !! latest end of the first step after a start [s]
      type(SUNMatrix), pointer :: matrix => null()
      type(SUNLinearSolver), pointer :: linear_solver => null()
   contains
      procedure :: create => create_cvode
      procedure :: start => start_cvode
      procedure :: step => step_cvode
      procedure :: destroy => destroy_cvode
   end type cvode_t

contains

   !> Evaluate the Jacobian of the right-hand side for CVODE.
   integer(c_int) function evaluate_jacobian(t, vector, vector_dot, matrix, user_data, &
      work_1, work_2, work_3) bind(c, name='')
      real(c_double), value :: t
      type(N_Vector), intent(inout) :: vector
      type(N_Vector), intent(inout) :: vector_dot
      type(SUNMatrix), intent(inout) :: matrix
      type(c_ptr), value :: user_data
      type(N_Vector), intent(inout) :: work_1, work_2, work_3
      type(equation_t), pointer :: equation
      real(c_double), pointer, contiguous :: y(:)
      real(c_double), pointer :: first(:)
      real(c_double), pointer :: values(:, :)

      call c_f_pointer(user_data, equation)
      call data_of(vector, equation%n, y)
      first => FSUNDenseMatrix_Data(matrix)
      call c_f_pointer(c_loc(first(1)), values, [equation%n, equation%n])
      call find_jacobian(equation, t, y, values)
      evaluate_jacobian = merge(0_c_int, 1_c_int, all(ieee_is_finite(values)))
   end function evaluate_jacobian

   subroutine create_cvode(self, equation, tolerance, error)
      class(cvode_t), intent(inout) :: self
      type(equation_t), intent(inout), target :: equation
      type(tolerance_t), intent(in) :: tolerance
      type(error_t), allocatable, intent(out) :: error
      type(tolerance_t) :: shared
      real(wp) :: share

      call self%destroy()
      share = merge(bdf_share, adams_share, self%is_stiff)
      shared%rtol = max(share*tolerance%rtol, least_rtol)
      shared%atol = shared%rtol/tolerance%rtol*tolerance%atol
      call create_common(self, merge(CV_BDF, CV_ADAMS, self%is_stiff), c_funloc(evaluate_rhs), &
         equation, shared, error)
      if (allocated(error)) return
      if (self%is_stiff) then
         call attach_newton(self, error)
         return
      end if
      call iterate_functionally(self, error)
      if (allocated(error)) return
      if (has_failed(self, FCVodeSetNonlinConvCoef(self%memory, adams_iteration), &
         'end of the functional iteration', error)) return
   end subroutine create_cvode

   subroutine attach_newton(self, error)
      class(cvode_t), intent(inout) :: self
      type(error_t), allocatable, intent(out) :: error
      integer(i8) :: n

      n = int(self%equation%n, i8)
      self%matrix => FSUNDenseMatrix(n, n, self%context)
      if (has_failed(self, made(associated(self%matrix)), 'dense matrix', error)) return
      self%linear_solver => FSUNLinSol_Dense(self%vector, self%matrix, self%context)
      if (has_failed(self, made(associated(self%linear_solver)), 'dense solver', error)) return
      if (has_failed(self, FCVodeSetLinearSolver(self%memory, self%linear_solver, self%matrix), &
         'linear solver', error)) return
      if (has_failed(self, FCVodeSetJacFn(self%memory, c_funloc(evaluate_jacobian)), &
         'Jacobian', error)) return
   end subroutine attach_newton

   subroutine start_cvode(self, t, y, span, error)
      class(cvode_t), intent(inout) :: self
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(:)
      real(wp), intent(in) :: span
      type(error_t), allocatable, intent(out) :: error

      self%t_stop = t
      ! A first step has a low order. Across a whole flight below the tolerance it returns a
      ! velocity of the wrong sign, and the wall would hit its base again and again. Before the top
      ! of the flight this is impossible.
      self%t_first = t + max(0.4_wp*span, 16*spacing(t))
      call restart(self, t, y, error)
   end subroutine start_cvode

   subroutine step_cvode(self, t_limit, error)
      class(cvode_t), intent(inout) :: self
      real(wp), intent(in) :: t_limit
      type(error_t), allocatable, intent(out) :: error
      real(c_double) :: reached(1)
      real(wp) :: t_end
      integer :: stuck

      t_end = t_limit
      if (self%t1 < self%t_first) t_end = min(t_limit, self%t_first)
      if (is_tiny(self%t1, t_end)) then
         call step_by_hand(self, t_end, error)
         self%t_stop = t_end
         return
      end if
      if (abs(t_end - self%t_stop) > 0 .or. self%t1 >= self%t_stop) then
         if (has_failed(self, FCVodeSetStopTime(self%memory, t_end), 'stop time', error)) return
         self%t_stop = t_end
      end if
      self%t0 = self%t1
      self%y0(:) = self%y1
      reached(1) = self%t1
      do stuck = 1, most_stuck
         if (has_failed(self, FCVode(self%memory, t_end, self%vector, reached, CV_ONE_STEP), &
            'CVode', error)) return
         if (reached(1) > self%t0) exit
      end do
      if (has_failed(self, merge(too_small, 0_c_int, stuck > most_stuck), 'CVode', error)) return
      self%t1 = reached(1)
      self%y1(:) = self%state
      self%steps = self%steps + 1_i8
   end subroutine step_cvode

   subroutine destroy_cvode(self)
      class(cvode_t), intent(inout) :: self
      integer(c_int) :: flag

      if (associated(self%linear_solver)) flag = FSUNLinSolFree(self%linear_solver)
      if (associated(self%matrix)) call FSUNMatDestroy(self%matrix)
      self%linear_solver => null()
      self%matrix => null()
      call destroy_common(self)
   end subroutine destroy_cvode

end module rwmf_integrator_sundials_cvode
