!> CVODE behind the `integrator_t` interface: Adams with functional iteration, or BDF with Newton
!> and a Jacobian by central differences.
module rwmf_integrator_sundials_cvode
   use, intrinsic :: iso_c_binding, only: c_associated, c_double, c_f_pointer, c_funloc, c_int, &
      c_loc, c_null_ptr, c_ptr
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use fcvode_mod, only: CV_ADAMS, CV_BDF, CV_ONE_STEP, FCVode, FCVodeCreate, FCVodeFree, &
      FCVodeGetDky, FCVodeInit, FCVodeReInit, FCVodeSetErrHandlerFn, FCVodeSetJacFn, &
      FCVodeSetLinearSolver, FCVodeSetNonlinConvCoef, FCVodeSetNonlinearSolver, &
      FCVodeSetStopTime, FCVodeSetUserData, FCVodeSVtolerances
   use fsundials_linearsolver_mod, only: FSUNLinSolFree, SUNLinearSolver
   use fsundials_matrix_mod, only: FSUNMatDestroy, SUNMatrix
   use fsundials_nonlinearsolver_mod, only: FSUNNonlinSolFree, SUNNonlinearSolver
   use fsundials_nvector_mod, only: N_Vector
   use fsunlinsol_dense_mod, only: FSUNLinSol_Dense
   use fsunmatrix_dense_mod, only: FSUNDenseMatrix, FSUNDenseMatrix_Data
   use fsunnonlinsol_fixedpoint_mod, only: FSUNNonlinSol_FixedPoint
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: i8, wp
   use rwmf_integrator_interface_integrator, only: taylor_step, tolerance_t
   use rwmf_integrator_sundials_common, only: create_common, data_of, destroy_common, &
      evaluate_rhs, first_end, has_failed, made, stay_silent, step_end, sundials_t, too_small
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
      type(SUNNonlinearSolver), pointer :: iteration => null()
      type(SUNMatrix), pointer :: matrix => null()
      type(SUNLinearSolver), pointer :: linear_solver => null()
   contains
      procedure :: create => create_cvode
      procedure :: start => start_cvode
      procedure :: step => step_cvode
      procedure :: state_at => state_at_cvode
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
      self%has_polynomial = .true.
      call create_common(self, equation, shared, error)
      if (allocated(error)) return
      self%memory = FCVodeCreate(merge(CV_BDF, CV_ADAMS, self%is_stiff), self%context)
      if (has_failed(self, made(c_associated(self%memory)), 'CVodeCreate', error)) return
   end subroutine create_cvode

   !> Set up CVODE at its first use, in the order required after CVodeInit.
   subroutine initialise_cvode(self, t, error)
      class(cvode_t), intent(inout) :: self
      real(wp), intent(in) :: t
      !! [s]
      type(error_t), allocatable, intent(out) :: error

      associate (memory => self%memory)
         if (has_failed(self, FCVodeSetErrHandlerFn(memory, c_funloc(stay_silent), c_null_ptr), &
            'error handler', error)) return
         if (has_failed(self, FCVodeInit(memory, c_funloc(evaluate_rhs), t, self%vector), &
            'CVodeInit', error)) return
         if (has_failed(self, FCVodeSetUserData(memory, c_loc(self%equation)), &
            'user data', error)) return
         if (has_failed(self, FCVodeSVtolerances(memory, self%rtol, self%tolerances), &
            'tolerances', error)) return
      end associate
      if (self%is_stiff) then
         call attach_newton(self, error)
         return
      end if
      self%iteration => FSUNNonlinSol_FixedPoint(self%vector, 0_c_int, self%context)
      if (has_failed(self, made(associated(self%iteration)), 'fixed point', error)) return
      if (has_failed(self, FCVodeSetNonlinearSolver(self%memory, self%iteration), &
         'functional iteration', error)) return
      if (has_failed(self, FCVodeSetNonlinConvCoef(self%memory, adams_iteration), &
         'end of the functional iteration', error)) return
   end subroutine initialise_cvode

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

      self%t1 = t
      self%y1(:) = y
      self%state = y
      self%t_stop = t
      self%t_first = first_end(t, span)
      if (self%is_initialised) then
         if (has_failed(self, FCVodeReInit(self%memory, t, self%vector), &
            'CVodeReInit', error)) return
      else
         call initialise_cvode(self, t, error)
         self%is_initialised = .not. allocated(error)
      end if
   end subroutine start_cvode

   subroutine step_cvode(self, t_limit, error)
      class(cvode_t), intent(inout) :: self
      real(wp), intent(in) :: t_limit
      type(error_t), allocatable, intent(out) :: error
      real(c_double) :: reached(1)
      real(wp) :: t_end
      integer :: stuck

      t_end = step_end(self, t_limit)
      if (is_tiny(self%t1, t_end)) then
         call step_by_hand(self, t_end, error)
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

   !> Return whether a step is so short that CVODE may return the time of its end with an earlier
   !> state. It ends a step early where the stop time is within a hundred round-offs.
   elemental logical function is_tiny(t_a, t_b)
      real(wp), intent(in) :: t_a, t_b
      !! [s]

      is_tiny = t_b - t_a <= 150*epsilon(t_b)*abs(t_b)
   end function is_tiny

   !> Take a tiny step by Taylor's formula, which is exact there.
   subroutine step_by_hand(self, t_end, error)
      class(cvode_t), intent(inout) :: self
      real(wp), intent(in) :: t_end
      !! [s]
      type(error_t), allocatable, intent(out) :: error

      self%t0 = self%t1
      self%y0(:) = self%y1
      call taylor_step(self%equation, self%t0, t_end - self%t0, self%y1)
      self%t1 = t_end
      self%t_stop = t_end
      self%state = self%y1
      self%steps = self%steps + 1_i8
      if (has_failed(self, FCVodeReInit(self%memory, t_end, self%vector), &
         'CVodeReInit', error)) return
   end subroutine step_by_hand

   !> Evaluate CVODE's own interpolant, which has the order of the step.
   subroutine state_at_cvode(self, t, y, error)
      class(cvode_t), intent(inout) :: self
      real(wp), intent(in) :: t
      real(wp), intent(out) :: y(:)
      type(error_t), allocatable, intent(out) :: error

      y = self%y1
      if (t >= self%t1) return
      if (t <= self%t0) then
         y = self%y0
         return
      end if
      if (is_tiny(self%t0, self%t1)) then
         y = self%y0
         call taylor_step(self%equation, self%t0, t - self%t0, y)
         return
      end if
      if (has_failed(self, FCVodeGetDky(self%memory, t, 0_c_int, self%vector), &
         'CVodeGetDky', error)) return
      y = self%state
   end subroutine state_at_cvode

   subroutine destroy_cvode(self)
      class(cvode_t), intent(inout) :: self
      integer(c_int) :: flag

      if (c_associated(self%memory)) call FCVodeFree(self%memory)
      self%memory = c_null_ptr
      if (associated(self%iteration)) flag = FSUNNonlinSolFree(self%iteration)
      if (associated(self%linear_solver)) flag = FSUNLinSolFree(self%linear_solver)
      if (associated(self%matrix)) call FSUNMatDestroy(self%matrix)
      self%iteration => null()
      self%linear_solver => null()
      self%matrix => null()
      call destroy_common(self)
   end subroutine destroy_cvode

end module rwmf_integrator_sundials_cvode
