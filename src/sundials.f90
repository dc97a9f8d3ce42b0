!> The integrators of SUNDIALS behind the `stepper_t` interface. The only file that names it.
!>
!> `cvode_t`: CVODE, Adams with functional iteration or BDF with Newton and the analytic Jacobian.
!> `erk_t`: ARKODE's ERKStep with the Dormand-Prince 5(4) pair, that of the paper's ode45.
!>
!> Each instance owns one SUNContext. Parameters reach the callbacks through the user data pointer.
!> SUNDIALS itself stays silent: its flags become our errors.
module rwmf_sundials
   use, intrinsic :: iso_c_binding, only: c_associated, c_double, c_f_pointer, c_funloc, c_int, &
      c_loc, c_long, c_null_ptr, c_ptr
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use farkode_erkstep_mod, only: FERKStepCreate, FERKStepEvolve, FERKStepFree, FERKStepReInit, &
      FERKStepReset, FERKStepSetErrHandlerFn, FERKStepSetFixedStep, FERKStepSetMaxNumSteps, &
      FERKStepSetStopTime, FERKStepSetTableNum, FERKStepSetUserData, FERKStepSVtolerances
   use farkode_mod, only: ARK_ONE_STEP, ARKODE_DORMAND_PRINCE_7_4_5
   use fcvode_mod, only: CV_ADAMS, CV_BDF, CV_ONE_STEP, FCVode, FCVodeCreate, FCVodeFree, &
      FCVodeGetDky, FCVodeInit, FCVodeReInit, FCVodeSetErrHandlerFn, FCVodeSetJacFn, &
      FCVodeSetLinearSolver, FCVodeSetNonlinearSolver, FCVodeSetStopTime, FCVodeSetUserData, &
      FCVodeSVtolerances
   use fnvector_serial_mod, only: FN_VNew_Serial
   use fsundials_context_mod, only: FSUNContext_Create, FSUNContext_Free
   use fsundials_linearsolver_mod, only: FSUNLinSolFree, SUNLinearSolver
   use fsundials_matrix_mod, only: FSUNMatDestroy, SUNMatrix
   use fsundials_nonlinearsolver_mod, only: FSUNNonlinSolFree, SUNNonlinearSolver
   use fsundials_nvector_mod, only: FN_VDestroy, N_Vector
   use fsunlinsol_dense_mod, only: FSUNLinSol_Dense
   use fsunmatrix_dense_mod, only: FSUNDenseMatrix, FSUNDenseMatrix_Data
   use fsunnonlinsol_fixedpoint_mod, only: FSUNNonlinSol_FixedPoint
   use rwmf_equation, only: equation_t, jacobian, rhs
   use rwmf_errors, only: error_t
   use rwmf_kinds, only: i8, wp
   use rwmf_stepper, only: fail_step, stepper_t, taylor_step, tolerance_t
   implicit none
   private

   public :: cvode_t, erk_t

   ! The local errors of thousands of short steps add up in a multistep method that restarts at each
   ! impact, and most in BDF. With these shares of the tolerance an rtol delivers about the same
   ! accuracy with every method (measured on random cases, docs/accuracy.md).
   real(wp), parameter :: adams_share = 0.25_wp
   real(wp), parameter :: bdf_share = 0.05_wp
   real(wp), parameter :: least_rtol = 1.0e-14_wp
   !! below, CVODE's error test sees nothing but round-off
   integer(c_int), parameter :: no_memory = -20
   !! flag of CVODE and ARKODE

   !> What both families share: context, vectors, equation.
   type, abstract, extends(stepper_t) :: sundials_t
      type(c_ptr) :: context = c_null_ptr
      type(c_ptr) :: memory = c_null_ptr
      type(equation_t), pointer :: equation => null()
      real(c_double), pointer :: state(:) => null()
      !! (states) data of `vector`
      real(c_double), pointer :: atol(:) => null()
      !! (states) data of `tolerances`
      type(N_Vector), pointer :: vector => null()
      type(N_Vector), pointer :: tolerances => null()
      logical :: is_initialised = .false.
      !! memory has seen its first initial value
      real(wp) :: rtol = 0
      real(wp) :: t_stop = 0
      !! stop time that the integrator knows; it forgets it when it gets there [s]
   end type sundials_t

   !> CVODE.
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

   !> ARKODE's ERKStep. A second instance with fixed step repeats a part of the last step, so that
   !> a state inside it is a solution of the method and not of an interpolant of lower order.
   type, extends(sundials_t) :: erk_t
      private
      type(c_ptr) :: scout = c_null_ptr
      real(c_double), pointer :: scout_state(:) => null()
      type(N_Vector), pointer :: scout_vector => null()
   contains
      procedure :: create => create_erk
      procedure :: start => start_erk
      procedure :: step => step_erk
      procedure :: state_at => state_at_erk
      procedure :: destroy => destroy_erk
   end type erk_t

   interface
      !> SUNDIALS' C function.
      type(c_ptr) function array_pointer(vector) bind(c, name='N_VGetArrayPointer')
         import :: c_ptr
         implicit none
         type(c_ptr), value :: vector
      end function array_pointer
   end interface

contains

   !> Right-hand side as SUNDIALS calls it. A value that is not finite asks for a smaller step.
   integer(c_int) function evaluate_rhs(t, vector, vector_dot, user_data) bind(c, name='')
      real(c_double), value :: t
      type(N_Vector), intent(inout) :: vector
      type(N_Vector), intent(inout) :: vector_dot
      type(c_ptr), value :: user_data
      type(equation_t), pointer :: equation
      real(c_double), pointer :: y(:)
      real(c_double), pointer :: y_dot(:)

      call c_f_pointer(user_data, equation)
      call data_of(vector, equation%n, y)
      call data_of(vector_dot, equation%n, y_dot)
      call rhs(equation, t, y, y_dot)
      evaluate_rhs = merge(0_c_int, 1_c_int, ieee_is_finite(y_dot(2)))
   end function evaluate_rhs

   !> Jacobian of the right-hand side as CVODE calls it.
   integer(c_int) function evaluate_jacobian(t, vector, vector_dot, matrix, user_data, &
      work_1, work_2, work_3) bind(c, name='')
      real(c_double), value :: t
      type(N_Vector), intent(inout) :: vector
      type(N_Vector), intent(inout) :: vector_dot
      type(SUNMatrix), intent(inout) :: matrix
      type(c_ptr), value :: user_data
      type(N_Vector), intent(inout) :: work_1, work_2, work_3
      type(equation_t), pointer :: equation
      real(c_double), pointer :: y(:)
      real(c_double), pointer :: first(:)
      real(c_double), pointer :: values(:, :)

      call c_f_pointer(user_data, equation)
      call data_of(vector, equation%n, y)
      first => FSUNDenseMatrix_Data(matrix)
      call c_f_pointer(c_loc(first(1)), values, [equation%n, equation%n])
      values(1, :) = [0.0_c_double, 1.0_c_double]
      call jacobian(equation, t, y, values(2, 1), values(2, 2))
      evaluate_jacobian = merge(0_c_int, 1_c_int, all(ieee_is_finite(values(2, :))))
   end function evaluate_jacobian

   !> States of a vector. The Fortran interface's own function returns a pointer of the wrong
   !> extent, and costs more than the rest of a right-hand side's wrapping.
   subroutine data_of(vector, n, values)
      type(N_Vector), intent(in), target :: vector
      integer, intent(in) :: n
      real(c_double), pointer, intent(out) :: values(:)

      call c_f_pointer(array_pointer(c_loc(vector)), values, [n])
   end subroutine data_of

   !> Error handler that says nothing: flags are checked where they are returned.
   subroutine stay_silent(code, module_name, function_name, message, user_data) bind(c, name='')
      integer(c_int), value :: code
      type(c_ptr), value :: module_name, function_name, message, user_data
   end subroutine stay_silent

   !> Check a flag; a failure becomes an error with time, state and advice.
   logical function has_failed(self, flag, what, error)
      class(sundials_t), intent(in) :: self
      integer(c_int), intent(in) :: flag
      !! of SUNDIALS; >= 0 is success
      character(*), intent(in) :: what
      !! the call
      type(error_t), allocatable, intent(out) :: error
      character(:), allocatable :: cause
      character(12) :: digits

      has_failed = flag < 0
      if (.not. has_failed) return
      select case (flag)
      case (-2)
         cause = 'the tolerance is too small for this precision: raise rtol'
      case (-3)
         cause = 'the error test fails at the smallest step: the response or the motion is not ' &
            //'smooth'
      case (-4, -6, -7)
         cause = 'the corrector iteration does not converge: try another method'
      case (-8, -9, -10, -11)
         cause = 'the right-hand side is not finite: check parameters and motion'
      case (no_memory, -21, -28)
         cause = 'out of memory'
      case default
         write (digits, '(i0)') flag
         cause = 'flag '//trim(digits)
      end select
      call fail_step(self, 'SUNDIALS '//what, self%rtol, cause, error)
   end function has_failed

   !> Flag of a constructor that returns a null pointer when memory is short.
   pure integer(c_int) function made(is_there)
      logical, intent(in) :: is_there

      made = merge(0_c_int, no_memory, is_there)
   end function made

   !> Context, vectors and the working state of both families.
   subroutine create_common(self, equation, tolerance, error)
      class(sundials_t), intent(inout) :: self
      type(equation_t), intent(inout), target :: equation
      type(tolerance_t), intent(in) :: tolerance
      type(error_t), allocatable, intent(out) :: error

      self%equation => equation
      self%steps = 0_i8
      self%rtol = tolerance%rtol
      self%t0 = 0
      self%t1 = 0
      self%y0 = 0*tolerance%atol
      self%y1 = self%y0
      if (has_failed(self, FSUNContext_Create(c_null_ptr, self%context), 'context', error)) return
      self%vector => FN_VNew_Serial(int(equation%n, i8), self%context)
      if (has_failed(self, made(associated(self%vector)), 'vector', error)) return
      self%tolerances => FN_VNew_Serial(int(equation%n, i8), self%context)
      if (has_failed(self, made(associated(self%tolerances)), 'tolerances', error)) return
      call data_of(self%vector, equation%n, self%state)
      call data_of(self%tolerances, equation%n, self%atol)
      self%state = 0
      self%atol = tolerance%atol
   end subroutine create_common

   !> Free what `create_common` made.
   subroutine destroy_common(self)
      class(sundials_t), intent(inout) :: self
      integer(c_int) :: flag

      call free_vector(self%vector, self%state)
      call free_vector(self%tolerances, self%atol)
      if (c_associated(self%context)) flag = FSUNContext_Free(self%context)
      self%context = c_null_ptr
      self%is_initialised = .false.
   end subroutine destroy_common

   subroutine free_vector(vector, values)
      type(N_Vector), pointer, intent(inout) :: vector
      real(c_double), pointer, intent(inout) :: values(:)

      if (associated(vector)) call FN_VDestroy(vector)
      vector => null()
      values => null()
   end subroutine free_vector

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
      call create_common(self, equation, shared, error)
      if (allocated(error)) return
      self%memory = FCVodeCreate(merge(CV_BDF, CV_ADAMS, self%is_stiff), self%context)
      if (has_failed(self, made(c_associated(self%memory)), 'CVodeCreate', error)) return
   end subroutine create_cvode

   !> First use: everything that CVODE wants after CVodeInit, in the order that it wants it.
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

   !> CVODE begins with tiny steps of order 1 by itself, whatever the span.
   subroutine start_cvode(self, t, y, span, error)
      class(cvode_t), intent(inout) :: self
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(:)
      real(wp), intent(in) :: span
      type(error_t), allocatable, intent(out) :: error
      integer(c_int) :: flag

      self%t1 = t
      self%y1(:) = y
      self%state = y
      self%t_stop = t
      if (self%is_initialised) then
         flag = FCVodeReInit(self%memory, t, self%vector)
         if (has_failed(self, flag, 'CVodeReInit', error)) return
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

      if (abs(t_limit - self%t_stop) > 0 .or. self%t1 >= self%t_stop) then
         if (has_failed(self, FCVodeSetStopTime(self%memory, t_limit), 'stop time', error)) return
         self%t_stop = t_limit
      end if
      self%t0 = self%t1
      self%y0(:) = self%y1
      reached(1) = self%t1
      if (has_failed(self, FCVode(self%memory, t_limit, self%vector, reached, CV_ONE_STEP), &
         'CVode', error)) return
      self%t1 = reached(1)
      self%y1(:) = self%state
      self%steps = self%steps + 1_i8
   end subroutine step_cvode

   !> CVODE's own interpolant has the order of the step.
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

   subroutine create_erk(self, equation, tolerance, error)
      class(erk_t), intent(inout) :: self
      type(equation_t), intent(inout), target :: equation
      type(tolerance_t), intent(in) :: tolerance
      type(error_t), allocatable, intent(out) :: error

      call self%destroy()
      call create_common(self, equation, tolerance, error)
      if (allocated(error)) return
      self%scout_vector => FN_VNew_Serial(int(equation%n, i8), self%context)
      if (has_failed(self, made(associated(self%scout_vector)), 'vector', error)) return
      call data_of(self%scout_vector, equation%n, self%scout_state)
      self%scout_state = 0
   end subroutine create_erk

   !> One ERKStep instance with our tableau, equation and silence.
   subroutine initialise_erk(self, t, vector, memory, error)
      class(erk_t), intent(inout) :: self
      real(wp), intent(in) :: t
      !! [s]
      type(N_Vector), intent(inout) :: vector
      !! initial state
      type(c_ptr), intent(out) :: memory
      type(error_t), allocatable, intent(out) :: error

      memory = FERKStepCreate(c_funloc(evaluate_rhs), t, vector, self%context)
      if (has_failed(self, made(c_associated(memory)), 'ERKStepCreate', error)) return
      if (has_failed(self, FERKStepSetErrHandlerFn(memory, c_funloc(stay_silent), c_null_ptr), &
         'error handler', error)) return
      if (has_failed(self, FERKStepSetTableNum(memory, ARKODE_DORMAND_PRINCE_7_4_5), &
         'Dormand-Prince pair', error)) return
      if (has_failed(self, FERKStepSetUserData(memory, c_loc(self%equation)), &
         'user data', error)) return
      if (has_failed(self, FERKStepSVtolerances(memory, self%rtol, self%tolerances), &
         'tolerances', error)) return
      if (has_failed(self, FERKStepSetMaxNumSteps(memory, -1_c_long), 'step limit', error)) return
   end subroutine initialise_erk

   !> ERKStep chooses its first step by itself, whatever the span.
   subroutine start_erk(self, t, y, span, error)
      class(erk_t), intent(inout) :: self
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(:)
      real(wp), intent(in) :: span
      type(error_t), allocatable, intent(out) :: error
      integer(c_int) :: flag

      self%t1 = t
      self%y1(:) = y
      self%state = y
      if (self%is_initialised) then
         flag = FERKStepReInit(self%memory, c_funloc(evaluate_rhs), t, self%vector)
         if (has_failed(self, flag, 'ERKStepReInit', error)) return
      else
         call initialise_erk(self, t, self%vector, self%memory, error)
         if (allocated(error)) return
         self%scout_state = y
         call initialise_erk(self, t, self%scout_vector, self%scout, error)
         self%is_initialised = .not. allocated(error)
      end if
   end subroutine start_erk

   subroutine step_erk(self, t_limit, error)
      class(erk_t), intent(inout) :: self
      real(wp), intent(in) :: t_limit
      type(error_t), allocatable, intent(out) :: error
      real(c_double) :: reached(1)

      if (has_failed(self, FERKStepSetStopTime(self%memory, t_limit), 'stop time', error)) return
      self%t0 = self%t1
      self%y0(:) = self%y1
      reached(1) = self%t1
      if (has_failed(self, FERKStepEvolve(self%memory, t_limit, self%vector, reached, &
         ARK_ONE_STEP), 'ERKStepEvolve', error)) return
      self%t1 = reached(1)
      self%y1(:) = self%state
      self%steps = self%steps + 1_i8
   end subroutine step_erk

   !> Repeat the step from t0 with the length t - t0.
   subroutine state_at_erk(self, t, y, error)
      class(erk_t), intent(inout) :: self
      real(wp), intent(in) :: t
      real(wp), intent(out) :: y(:)
      type(error_t), allocatable, intent(out) :: error
      real(c_double) :: reached(1)

      y = self%y1
      if (t >= self%t1) return
      y = self%y0
      ! ARKODE refuses a step of a few round-offs; there Taylor's formula is exact.
      if (t - self%t0 <= 100*epsilon(t)*abs(t)) then
         call taylor_step(self%equation, self%t0, max(0.0_wp, t - self%t0), y)
         return
      end if
      self%scout_state = self%y0
      if (has_failed(self, FERKStepReset(self%scout, self%t0, self%scout_vector), &
         'ERKStepReset', error)) return
      if (has_failed(self, FERKStepSetFixedStep(self%scout, t - self%t0), &
         'fixed step', error)) return
      if (has_failed(self, FERKStepEvolve(self%scout, t, self%scout_vector, reached, &
         ARK_ONE_STEP), 'ERKStepEvolve', error)) return
      y = self%scout_state
   end subroutine state_at_erk

   subroutine destroy_erk(self)
      class(erk_t), intent(inout) :: self

      if (c_associated(self%memory)) call FERKStepFree(self%memory)
      if (c_associated(self%scout)) call FERKStepFree(self%scout)
      self%memory = c_null_ptr
      self%scout = c_null_ptr
      call free_vector(self%scout_vector, self%scout_state)
      call destroy_common(self)
   end subroutine destroy_erk

end module rwmf_sundials
