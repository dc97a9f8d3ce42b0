!> Step-size control of this project's own one-step methods.
!>
!> A method provides `attempt`: the solution after a step of given length and the norm of its local
!> error. States inside the last step come from repeating the step with a smaller length. Therefore
!> an event is located on the method's own solution and not on an interpolant.
module rwmf_integrator_one_step
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use rwmf_core_error, only: err_numerical, error_t, fail
   use rwmf_core_kinds, only: i8, wp
   use rwmf_integrator_interface_integrator, only: even_share, fail_step, integrator_t, &
      step_too_small, tolerance_t
   use rwmf_model_system_assembly, only: equation_t, rhs
   implicit none
   private

   public :: one_step_t, begin_at

   !> One-step method with error estimate.
   type, abstract, extends(integrator_t) :: one_step_t
      type(equation_t), pointer :: equation => null()
      type(tolerance_t) :: tolerance
      integer :: error_order = 1
      !! the estimated local error is proportional to h**error_order
      real(wp), allocatable :: f0(:)
      !! (states) derivative at t0
      real(wp), allocatable :: f1(:)
      !! (states) derivative at t1
      real(wp) :: h = 0
      !! length that the last error estimate allows [s]; 0 before the first step
   contains
      procedure :: create => create_one_step
      procedure :: start => start_one_step
      procedure :: step => step_one_step
      procedure :: state_at => state_at_one_step
      procedure :: destroy => destroy_one_step
      procedure(attempt_i), deferred :: attempt
   end type one_step_t

   abstract interface
      !> Advance from (t, y) by h.
      subroutine attempt_i(self, t, y, f, h, y_new, error)
         import :: one_step_t, wp
         implicit none
         class(one_step_t), intent(inout) :: self
         real(wp), intent(in) :: t
         !! [s]
         real(wp), intent(in), contiguous :: y(:)
         !! (states)
         real(wp), intent(in), contiguous :: f(:)
         !! (states) derivative at t
         real(wp), intent(in) :: h
         !! [s]
         real(wp), intent(out), contiguous :: y_new(:)
         !! (states)
         real(wp), intent(out) :: error
         !! norm of the local error over the tolerance [-]
      end subroutine attempt_i
   end interface

contains

   subroutine create_one_step(self, equation, tolerance, error)
      class(one_step_t), intent(inout) :: self
      type(equation_t), intent(inout), target :: equation
      type(tolerance_t), intent(in) :: tolerance
      type(error_t), allocatable, intent(out) :: error
      integer :: status

      call self%destroy()
      self%equation => equation
      self%tolerance = tolerance
      self%steps = 0_i8
      self%h = 0
      allocate (self%y0(equation%n), stat=status)
      if (status == 0) allocate (self%y1(equation%n), stat=status)
      if (status == 0) allocate (self%f0(equation%n), stat=status)
      if (status == 0) allocate (self%f1(equation%n), stat=status)
      if (status /= 0) call fail(error, err_numerical, 'out of memory for the integrator')
   end subroutine create_one_step

   !> Start at (t, y). The step length is kept: a one-step method has no history to rebuild.
   subroutine start_one_step(self, t, y, span, error)
      class(one_step_t), intent(inout) :: self
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(:)
      real(wp), intent(in) :: span
      type(error_t), allocatable, intent(out) :: error

      call begin_at(self, t, y, span, error)
   end subroutine start_one_step

   !> Start at (t, y), for callers that take the steps themselves and query the integrator.
   subroutine begin_at(self, t, y, span, error)
      class(one_step_t), intent(inout) :: self
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp), intent(in) :: span
      !! [s]
      type(error_t), allocatable, intent(out) :: error
      !! the right-hand side is not finite
      real(wp) :: scale(size(self%y1))
      real(wp) :: rate

      self%t1 = t
      self%y1(:) = y
      call rhs(self%equation, t, y, self%f1)
      if (.not. all(ieee_is_finite(self%f1))) then
         call report(self, 'the right-hand side is not finite', error)
      end if
      if (self%h <= 0) then
         ! a hundredth of the time for a change of the state by its own size
         scale = self%tolerance%atol + self%tolerance%rtol*abs(self%y1)
         rate = sqrt(sum((self%f1/scale)**2)/size(scale))*self%tolerance%rtol
         self%h = 0.01_wp/max(rate, 1.0_wp)
      end if
      self%h = min(self%h, span)
   end subroutine begin_at

   subroutine step_one_step(self, t_limit, error)
      class(one_step_t), intent(inout) :: self
      real(wp), intent(in) :: t_limit
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: y_new(size(self%y1))
      real(wp) :: h
      real(wp) :: local_error
      real(wp) :: shrink
      !! factor on the length after a rejected step [-]
      logical :: was_rejected

      self%t0 = self%t1
      self%y0(:) = self%y1
      self%f0(:) = self%f1
      was_rejected = .false.
      do
         h = even_share(t_limit - self%t0, self%h)
         call self%attempt(self%t0, self%y0, self%f0, h, y_new, local_error)
         if (local_error <= 1 .and. all(ieee_is_finite(y_new))) exit
         was_rejected = .true.
         shrink = 0.1_wp
         if (ieee_is_finite(local_error) .and. local_error > 1) then
            shrink = max(0.1_wp, 0.9_wp*local_error**(-1.0_wp/self%error_order))
         end if
         self%h = h*shrink
         if (self%h <= 8*spacing(self%t0)) then
            call report(self, step_too_small, error)
            return
         end if
      end do
      call accept(self, t_limit, h, y_new, local_error, was_rejected)
   end subroutine step_one_step

   subroutine accept(self, t_limit, h, y_new, local_error, was_rejected)
      class(one_step_t), intent(inout) :: self
      real(wp), intent(in) :: t_limit
      real(wp), intent(in) :: h
      real(wp), intent(in) :: y_new(:)
      real(wp), intent(in) :: local_error
      logical, intent(in) :: was_rejected
      real(wp) :: longer

      longer = h*min(6.0_wp, 0.9_wp*max(local_error, tiny(h))**(-1.0_wp/self%error_order))
      if (was_rejected) longer = min(longer, h)
      ! A step cut short by a knot or an event is no reason to reduce the allowed length.
      if (.not. was_rejected .and. h < self%h) longer = max(longer, self%h)
      self%h = longer
      self%t1 = self%t0 + h
      if (h >= t_limit - self%t0) self%t1 = t_limit
      self%y1(:) = y_new
      self%steps = self%steps + 1_i8
      call rhs(self%equation, self%t1, self%y1, self%f1)
   end subroutine accept

   subroutine state_at_one_step(self, t, y, error)
      class(one_step_t), intent(inout) :: self
      real(wp), intent(in) :: t
      real(wp), intent(out) :: y(:)
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: ignored

      if (t >= self%t1) then
         y = self%y1
      else if (t <= self%t0) then
         y = self%y0
      else
         call self%attempt(self%t0, self%y0, self%f0, t - self%t0, y, ignored)
      end if
      if (.not. all(ieee_is_finite(y))) call report(self, 'the state is not finite', error)
   end subroutine state_at_one_step

   subroutine report(self, cause, error)
      class(one_step_t), intent(in) :: self
      character(*), intent(in) :: cause
      type(error_t), allocatable, intent(out) :: error

      call fail_step(self, 'integration', self%tolerance%rtol, cause, error)
   end subroutine report

   subroutine destroy_one_step(self)
      class(one_step_t), intent(inout) :: self

      if (allocated(self%y0)) deallocate (self%y0)
      if (allocated(self%y1)) deallocate (self%y1)
      if (allocated(self%f0)) deallocate (self%f0)
      if (allocated(self%f1)) deallocate (self%f1)
   end subroutine destroy_one_step

end module rwmf_integrator_one_step
