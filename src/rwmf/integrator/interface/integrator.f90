!> Interface of an integrator to the hybrid loop, and procedures for all integrators.
module rwmf_integrator_interface_integrator
   use rwmf_core_error, only: err_numerical, error_t, fail
   use rwmf_core_kinds, only: i8, wp
   use rwmf_model_system_assembly, only: equation_t, rhs
   use rwmf_text_strings, only: real_to_text
   implicit none
   private

   public :: even_share, fail_step, integrator_t, step_too_small, taylor_step, tolerance_t

   character(*), parameter :: step_too_small = 'the step has become too small: the response or ' &
      //'the motion is not smooth or not finite, or the tolerance too small'

   !> Local error allowed per step: rtol*|y_i| + atol_i.
   type :: tolerance_t
      real(wp) :: rtol
      !! [-]
      real(wp), allocatable :: atol(:)
      !! (states)
   end type tolerance_t

   !> Integrator of the equation of motion between two events.
   !>
   !> After `step` the solution is known in [t0, t1]: at the ends as `y0` and `y1`, inside through
   !> `state_at`. `start` begins a new initial value problem and discards the history.
   type, abstract :: integrator_t
      real(wp) :: t0
      !! beginning of the last step [s]
      real(wp) :: t1
      !! end of the last step [s]
      real(wp), allocatable :: y0(:)
      !! (states) at t0
      real(wp), allocatable :: y1(:)
      !! (states) at t1
      integer(i8) :: steps = 0
      !! number of accepted steps since `create`
      logical :: has_polynomial = .false.
      !! a state inside the last step is a polynomial; otherwise it costs a step
   contains
      procedure(create_i), deferred :: create
      procedure(start_i), deferred :: start
      procedure(step_i), deferred :: step
      procedure(state_at_i), deferred :: state_at
      procedure(destroy_i), deferred :: destroy
   end type integrator_t

   abstract interface
      !> Prepare for an equation, which must outlive the integrator.
      subroutine create_i(self, equation, tolerance, error)
         import :: integrator_t, equation_t, tolerance_t, error_t
         implicit none
         class(integrator_t), intent(inout) :: self
         type(equation_t), intent(inout), target :: equation
         type(tolerance_t), intent(in) :: tolerance
         type(error_t), allocatable, intent(out) :: error
      end subroutine create_i

      !> Start at time t from the state y.
      subroutine start_i(self, t, y, span, error)
         import :: integrator_t, error_t, wp
         implicit none
         class(integrator_t), intent(inout) :: self
         real(wp), intent(in) :: t
         !! [s]
         real(wp), intent(in) :: y(:)
         !! (states)
         real(wp), intent(in) :: span
         !! time within which the motion is expected to change its course: a much longer first step
         !! makes the event harder to find [s]
         type(error_t), allocatable, intent(out) :: error
      end subroutine start_i

      !> Take one step of the integrator's own choice, not beyond t_limit.
      subroutine step_i(self, t_limit, error)
         import :: integrator_t, error_t, wp
         implicit none
         class(integrator_t), intent(inout) :: self
         real(wp), intent(in) :: t_limit
         !! > t1 [s]
         type(error_t), allocatable, intent(out) :: error
      end subroutine step_i

      !> Return the state at a time inside the last step.
      subroutine state_at_i(self, t, y, error)
         import :: integrator_t, error_t, wp
         implicit none
         class(integrator_t), intent(inout) :: self
         real(wp), intent(in) :: t
         !! in [t0, t1] [s]
         real(wp), intent(out) :: y(:)
         !! (states)
         type(error_t), allocatable, intent(out) :: error
      end subroutine state_at_i

      !> Free the memory of the integrator. Safe to call twice.
      subroutine destroy_i(self)
         import :: integrator_t
         implicit none
         class(integrator_t), intent(inout) :: self
      end subroutine destroy_i
   end interface

contains

   !> Report the time and the state of a failed integration. Fails with `err_numerical`.
   subroutine fail_step(integrator, what, rtol, cause, error)
      class(integrator_t), intent(in) :: integrator
      character(*), intent(in) :: what
      !! name of the failed procedure
      real(wp), intent(in) :: rtol
      !! current relative tolerance [-]
      character(*), intent(in) :: cause
      !! cause and remedy
      type(error_t), allocatable, intent(out) :: error

      call fail(error, err_numerical, what//' failed at t = '//trim(real_to_text(integrator%t1)) &
         //' s, theta = '//trim(real_to_text(integrator%y1(1)))//', theta_dot = ' &
         //trim(real_to_text(integrator%y1(2)))//', rtol = '//trim(real_to_text(rtol))//': '//cause)
   end subroutine fail_step

   !> Divide the remaining time into equal parts not longer than h, so that no sliver remains before
   !> a knot [s].
   pure real(wp) function even_share(remaining, h) result(share)
      real(wp), intent(in) :: remaining
      !! [s]
      real(wp), intent(in) :: h
      !! [s]

      share = remaining
      if (h >= remaining) return
      share = h
      if (h > 1.0e-8_wp*remaining) share = remaining/real(ceiling(remaining/h, i8), wp)
   end function even_share

   !> Take a step of a few round-offs. The last flights of a decaying chatter are that short, and
   !> would gain energy without the second-order term.
   subroutine taylor_step(equation, t, h, y)
      type(equation_t), intent(inout) :: equation
      real(wp), intent(in) :: t
      !! beginning [s]
      real(wp), intent(in) :: h
      !! length [s]
      real(wp), intent(inout) :: y(:)
      !! (states) at t; on return at t + h
      real(wp) :: y_dot(size(y))

      call rhs(equation, t, y, y_dot)
      y = y + h*y_dot
      y(1) = y(1) + h**2/2*y_dot(2)
   end subroutine taylor_step

end module rwmf_integrator_interface_integrator
