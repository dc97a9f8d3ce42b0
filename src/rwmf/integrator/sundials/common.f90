!> Memory, callbacks and errors of CVODE. Only this folder and `paper` depend on SUNDIALS.
!>
!> Each instance owns one SUNContext. Parameters reach the callbacks through the user data pointer.
!> SUNDIALS itself prints nothing: its flags are converted to errors of this library.
module rwmf_integrator_sundials_common
   use, intrinsic :: iso_c_binding, only: c_associated, c_double, c_f_pointer, c_funloc, c_funptr, &
      c_int, c_loc, c_null_ptr, c_ptr
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use fcvode_mod, only: FCVodeCreate, FCVodeFree, FCVodeGetDky, FCVodeInit, FCVodeReInit, &
      FCVodeSetErrHandlerFn, FCVodeSetNonlinearSolver, FCVodeSetUserData, FCVodeSVtolerances
   use fnvector_serial_mod, only: FN_VNew_Serial
   use fsundials_context_mod, only: FSUNContext_Create, FSUNContext_Free
   use fsundials_nonlinearsolver_mod, only: FSUNNonlinSolFree, SUNNonlinearSolver
   use fsundials_nvector_mod, only: FN_VDestroy, N_Vector
   use fsunnonlinsol_fixedpoint_mod, only: FSUNNonlinSol_FixedPoint
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: i8, wp
   use rwmf_integrator_interface_integrator, only: fail_step, integrator_t, step_too_small, &
      taylor_step, tolerance_t
   use rwmf_model_system_assembly, only: equation_t, rhs
   use rwmf_text_strings, only: integer_to_text
   implicit none
   private

   public :: sundials_t, evaluate_rhs, data_of
   public :: has_failed, made, create_common, iterate_functionally, restart, destroy_common
   public :: is_tiny, step_by_hand, too_small

   integer(c_int), parameter :: no_memory = -20
   !! flag of CVODE
   integer(c_int), parameter :: too_small = -1000
   !! flag of this module: steps no longer advance the time

   !> Memory, vectors and equation of CVODE.
   type, abstract, extends(integrator_t) :: sundials_t
      type(c_ptr) :: context = c_null_ptr
      type(c_ptr) :: memory = c_null_ptr
      type(equation_t), pointer :: equation => null()
      real(c_double), pointer, contiguous :: state(:) => null()
      !! (states) data of `vector`
      real(c_double), pointer, contiguous :: atol(:) => null()
      !! (states) data of `tolerances`
      type(N_Vector), pointer :: vector => null()
      type(N_Vector), pointer :: tolerances => null()
      type(SUNNonlinearSolver), pointer :: iteration => null()
      !! functional iteration
      real(wp) :: rtol = 0
      !! relative tolerance [-]
   contains
      procedure :: state_at => state_at_common
   end type sundials_t

   interface
      !> C function of SUNDIALS.
      type(c_ptr) function array_pointer(vector) bind(c, name='N_VGetArrayPointer')
         import :: c_ptr
         implicit none
         type(c_ptr), value :: vector
      end function array_pointer
   end interface

contains

   !> Evaluate the right-hand side for SUNDIALS. A value that is not finite requests a smaller step.
   integer(c_int) function evaluate_rhs(t, vector, vector_dot, user_data) bind(c, name='')
      real(c_double), value :: t
      !! [s]
      type(N_Vector), intent(inout) :: vector
      type(N_Vector), intent(inout) :: vector_dot
      type(c_ptr), value :: user_data
      type(equation_t), pointer :: equation
      real(c_double), pointer, contiguous :: y(:)
      real(c_double), pointer, contiguous :: y_dot(:)

      call c_f_pointer(user_data, equation)
      call data_of(vector, equation%n, y)
      call data_of(vector_dot, equation%n, y_dot)
      call rhs(equation, t, y, y_dot)
      evaluate_rhs = merge(0_c_int, 1_c_int, all(ieee_is_finite(y_dot(2:))))
   end function evaluate_rhs

   !> Return the states of a vector. The Fortran interface's own function returns a pointer of the
   !> wrong extent, and costs more than the rest of the wrapper.
   subroutine data_of(vector, n, values)
      type(N_Vector), intent(in), target :: vector
      integer, intent(in) :: n
      !! number of states
      real(c_double), pointer, contiguous, intent(out) :: values(:)
      !! (n) states, in the vector's own memory

      call c_f_pointer(array_pointer(c_loc(vector)), values, [n])
   end subroutine data_of

   !> Ignore an error report of SUNDIALS: flags are checked at each call.
   subroutine stay_silent(code, module_name, function_name, message, user_data) bind(c, name='')
      integer(c_int), value :: code
      !! number of the error in SUNDIALS
      type(c_ptr), value :: module_name, function_name, message, user_data
   end subroutine stay_silent

   !> Check a flag and convert a failure to an error with time, state and advice.
   logical function has_failed(self, flag, what, error)
      class(sundials_t), intent(in) :: self
      integer(c_int), intent(in) :: flag
      !! flag of SUNDIALS; >= 0 is success
      character(*), intent(in) :: what
      !! name of the call
      type(error_t), allocatable, intent(out) :: error
      character(:), allocatable :: cause

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
      case (-22)
         cause = 'illegal input, or two events too close for its root search: use another method'
      case (too_small)
         cause = step_too_small
      case (no_memory, -21, -28)
         cause = 'out of memory'
      case default
         cause = 'flag '//trim(integer_to_text(int(flag)))
      end select
      call fail_step(self, 'SUNDIALS '//what, self%rtol, cause, error)
   end function has_failed

   !> Flag of a constructor, which returns a null pointer without memory.
   pure integer(c_int) function made(is_there)
      logical, intent(in) :: is_there
      !! the constructor has returned an object

      made = merge(0_c_int, no_memory, is_there)
   end function made

   !> Create context, vectors and memory for a right-hand side with the equation as its data.
   subroutine create_common(self, method, right_hand_side, equation, tolerance, error)
      class(sundials_t), intent(inout) :: self
      integer(c_int), intent(in) :: method
      !! CV_ADAMS or CV_BDF
      type(c_funptr), value :: right_hand_side
      type(equation_t), intent(inout), target :: equation
      type(tolerance_t), intent(in) :: tolerance
      type(error_t), allocatable, intent(out) :: error
      !! out of memory, or a failure of SUNDIALS

      self%equation => equation
      self%has_polynomial = .true.
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
      self%memory = FCVodeCreate(method, self%context)
      associate (memory => self%memory)
         if (has_failed(self, made(c_associated(memory)), 'CVodeCreate', error)) return
         if (has_failed(self, FCVodeSetErrHandlerFn(memory, c_funloc(stay_silent), c_null_ptr), &
            'error handler', error)) return
         if (has_failed(self, FCVodeInit(memory, right_hand_side, self%t1, self%vector), &
            'CVodeInit', error)) return
         if (has_failed(self, FCVodeSetUserData(memory, c_loc(self%equation)), &
            'user data', error)) return
         if (has_failed(self, FCVodeSVtolerances(memory, self%rtol, self%tolerances), &
            'tolerances', error)) return
      end associate
   end subroutine create_common

   !> Solve the implicit equations of a step by functional iteration.
   subroutine iterate_functionally(self, error)
      class(sundials_t), intent(inout) :: self
      type(error_t), allocatable, intent(out) :: error
      !! a failure of SUNDIALS

      self%iteration => FSUNNonlinSol_FixedPoint(self%vector, 0_c_int, self%context)
      if (has_failed(self, made(associated(self%iteration)), 'fixed point', error)) return
      if (has_failed(self, FCVodeSetNonlinearSolver(self%memory, self%iteration), &
         'functional iteration', error)) return
   end subroutine iterate_functionally

   !> Start a new initial value problem.
   subroutine restart(self, t, y, error)
      class(sundials_t), intent(inout) :: self
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: y(:)
      !! (states)
      type(error_t), allocatable, intent(out) :: error
      !! a failure of SUNDIALS

      self%t1 = t
      self%y1(:) = y
      self%state = y
      if (has_failed(self, FCVodeReInit(self%memory, t, self%vector), 'CVodeReInit', error)) return
   end subroutine restart

   !> Return whether a step is so short that CVODE may return the time of its end with an earlier
   !> state. It ends a step early where the stop time is within a hundred round-offs.
   elemental logical function is_tiny(t_a, t_b)
      real(wp), intent(in) :: t_a, t_b
      !! [s]

      is_tiny = t_b - t_a <= 150*epsilon(t_b)*abs(t_b)
   end function is_tiny

   !> Take a tiny step by Taylor's formula, which is exact there.
   subroutine step_by_hand(self, t_end, error)
      class(sundials_t), intent(inout) :: self
      real(wp), intent(in) :: t_end
      !! [s]
      type(error_t), allocatable, intent(out) :: error
      !! a failure of SUNDIALS
      real(wp) :: y(size(self%y1))

      self%t0 = self%t1
      self%y0(:) = self%y1
      y = self%y1
      call taylor_step(self%equation, self%t0, t_end - self%t0, y)
      self%steps = self%steps + 1_i8
      call restart(self, t_end, y, error)
   end subroutine step_by_hand

   !> Evaluate CVODE's own interpolant, which has the order of the step.
   subroutine state_at_common(self, t, y, error)
      class(sundials_t), intent(inout) :: self
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
   end subroutine state_at_common

   !> Free the objects of `create_common`.
   subroutine destroy_common(self)
      class(sundials_t), intent(inout) :: self
      integer(c_int) :: flag

      if (c_associated(self%memory)) call FCVodeFree(self%memory)
      self%memory = c_null_ptr
      if (associated(self%iteration)) flag = FSUNNonlinSolFree(self%iteration)
      self%iteration => null()
      call free_vector(self%vector, self%state)
      call free_vector(self%tolerances, self%atol)
      if (c_associated(self%context)) flag = FSUNContext_Free(self%context)
      self%context = c_null_ptr
   end subroutine destroy_common

   !> Free a vector of SUNDIALS and its data; no effect on a null pointer.
   subroutine free_vector(vector, values)
      type(N_Vector), pointer, intent(inout) :: vector
      real(c_double), pointer, intent(inout) :: values(:)
      !! (states) data of the vector, null on return

      if (associated(vector)) call FN_VDestroy(vector)
      vector => null()
      values => null()
   end subroutine free_vector

end module rwmf_integrator_sundials_common
