!> ARKODE's ERKStep behind the `integrator_t` interface, with the Dormand-Prince 5(4) pair of the
!> paper's ode45.
module rwmf_integrator_sundials_arkode
   use, intrinsic :: iso_c_binding, only: c_associated, c_double, c_funloc, c_loc, c_long, &
      c_null_ptr, c_ptr
   use farkode_erkstep_mod, only: FERKStepCreate, FERKStepEvolve, FERKStepFree, FERKStepReInit, &
      FERKStepReset, FERKStepSetErrHandlerFn, FERKStepSetFixedStep, FERKStepSetMaxNumSteps, &
      FERKStepSetStopTime, FERKStepSetTableNum, FERKStepSetUserData, FERKStepSVtolerances
   use farkode_mod, only: ARK_ONE_STEP, ARKODE_DORMAND_PRINCE_7_4_5
   use fnvector_serial_mod, only: FN_VNew_Serial
   use fsundials_nvector_mod, only: N_Vector
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: i8, wp
   use rwmf_integrator_interface_integrator, only: taylor_step, tolerance_t
   use rwmf_integrator_sundials_common, only: create_common, data_of, destroy_common, &
      evaluate_rhs, first_end, free_vector, has_failed, made, stay_silent, step_end, sundials_t
   use rwmf_model_system_assembly, only: equation_t
   implicit none
   private

   public :: erk_t

   !> Integrator with ARKODE's ERKStep. A second instance with fixed step repeats a part of the last
   !> step. Therefore a state inside it is a solution of the method and not of an interpolant of
   !> lower order.
   type, extends(sundials_t) :: erk_t
      private
      type(c_ptr) :: scout = c_null_ptr
      real(c_double), pointer, contiguous :: scout_state(:) => null()
      !! (states) data of `scout_vector`
      type(N_Vector), pointer :: scout_vector => null()
   contains
      procedure :: create => create_erk
      procedure :: start => start_erk
      procedure :: step => step_erk
      procedure :: state_at => state_at_erk
      procedure :: destroy => destroy_erk
   end type erk_t

contains

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

   !> Create one ERKStep instance with the tableau and the equation, without messages.
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

   subroutine start_erk(self, t, y, span, error)
      class(erk_t), intent(inout) :: self
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(:)
      real(wp), intent(in) :: span
      type(error_t), allocatable, intent(out) :: error

      self%t1 = t
      self%y1(:) = y
      self%state = y
      self%t_first = first_end(t, span)
      if (self%is_initialised) then
         if (has_failed(self, FERKStepReInit(self%memory, c_funloc(evaluate_rhs), t, &
            self%vector), 'ERKStepReInit', error)) return
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
      real(wp) :: t_end

      t_end = step_end(self, t_limit)
      if (t_end - self%t1 <= 1000*epsilon(t_end)*abs(t_end)) then
         call step_by_hand(self, t_end, error)
         return
      end if
      if (has_failed(self, FERKStepSetStopTime(self%memory, t_end), 'stop time', error)) return
      self%t0 = self%t1
      self%y0(:) = self%y1
      reached(1) = self%t1
      if (has_failed(self, FERKStepEvolve(self%memory, t_end, self%vector, reached, &
         ARK_ONE_STEP), 'ERKStepEvolve', error)) return
      self%t1 = reached(1)
      self%y1(:) = self%state
      self%steps = self%steps + 1_i8
   end subroutine step_erk

   !> Take a step so short that ARKODE would return the time of its end with the state of its
   !> beginning. Taylor's formula is exact there.
   subroutine step_by_hand(self, t_end, error)
      class(erk_t), intent(inout) :: self
      real(wp), intent(in) :: t_end
      !! [s]
      type(error_t), allocatable, intent(out) :: error

      self%t0 = self%t1
      self%y0(:) = self%y1
      call taylor_step(self%equation, self%t0, t_end - self%t0, self%y1)
      self%t1 = t_end
      self%state = self%y1
      self%steps = self%steps + 1_i8
      if (has_failed(self, FERKStepReInit(self%memory, c_funloc(evaluate_rhs), t_end, &
         self%vector), 'ERKStepReInit', error)) return
   end subroutine step_by_hand

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
      ! ARKODE rejects a step of a few round-offs, where Taylor's formula is exact
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

end module rwmf_integrator_sundials_arkode
