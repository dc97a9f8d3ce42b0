!> Steps by Taylor series: the state inside the last step is a polynomial of the time.
!>
!> The length follows from the last terms before the step is taken, so that none is rejected.
module rwmf_integrator_taylor
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use rwmf_core_error, only: err_numerical, error_t, fail
   use rwmf_core_kinds, only: i8, wp
   use rwmf_integrator_interface_integrator, only: even_share, fail_step, integrator_t, &
      step_too_small, tolerance_t
   use rwmf_model_effects_numbers, only: nl_damper_effect
   use rwmf_model_equation, only: equation_t, interval_of
   use rwmf_model_series_corner_series, only: negligible_time, rate_after
   use rwmf_model_series_scene_series, only: expand_states, series_memory, smooth_springs
   use rwmf_model_series_series_motion, only: highest_order, series_motion_t, set_ground
   use rwmf_motion_ground_motion, only: expand_ground
   implicit none
   private

   public :: taylor_t

   real(wp), parameter :: share = 0.3_wp
   !! part of the tolerance for the last term of a series [-]
   real(wp), parameter :: part = 0.1_wp
   !! part of the absolute tolerance beside that of the largest value so far [-]
   real(wp), parameter :: weight = 0.1_wp
   !! of the term before the last one [-]
   integer, parameter :: least_order = 6

   !> Integrator with Taylor series.
   type, extends(integrator_t) :: taylor_t
      type(equation_t), pointer :: equation => null()
      type(tolerance_t) :: tolerance
      integer :: highest = 8
      !! order beyond which steps become shorter instead
      integer :: order = 0
      !! order of the series of the last step
      integer :: damper = 0
      !! column of the first coefficient of nonlinear dampers; 0 for none
      real(wp) :: frequency = 1
      !! of the slowest vibration, over whose radian errors may reach the tolerance [rad/s]
      real(wp) :: span = huge(1.0_wp)
      !! longest next step [s]
      integer, allocatable :: springs(:, :)
      !! as of `smooth_springs`
      real(wp), allocatable :: largest(:)
      !! (states) largest magnitude so far at the ends of steps
      real(wp), allocatable :: series(:, :, :)
      !! (1, coefficients from 0, states) of the last step, in the time since its begin
      real(wp), allocatable :: memory(:, :, :)
      !! (1, coefficients from 0, `series_memory`)
      type(series_motion_t) :: motion
   contains
      procedure :: create => create_taylor
      procedure :: start => start_taylor
      procedure :: step => step_taylor
      procedure :: state_at => state_at_taylor
      procedure :: destroy => destroy_taylor
   end type taylor_t

contains

   subroutine create_taylor(self, equation, tolerance, error)
      class(taylor_t), intent(inout) :: self
      type(equation_t), intent(inout), target :: equation
      type(tolerance_t), intent(in) :: tolerance
      type(error_t), allocatable, intent(out) :: error
      integer :: i, status

      call self%destroy()
      self%equation => equation
      self%tolerance = tolerance
      self%steps = 0_i8
      self%has_polynomial = .true.
      self%highest = min(max(8, 2*nint(-0.55_wp*log10(tolerance%rtol))), highest_order)
      self%damper = 0
      self%frequency = huge(1.0_wp)
      if (equation%has_frame) self%frequency = equation%p%omega_s
      if (equation%has_wall) self%frequency = min(self%frequency, sqrt(equation%p%g_over_R))
      do i = 1, size(equation%scene%terms)
         if (equation%scene%terms(i)%effect == nl_damper_effect) self%damper = &
            equation%scene%terms(i)%coef
      end do
      self%springs = smooth_springs(equation%scene)
      allocate (self%y0(equation%n), stat=status)
      if (status == 0) allocate (self%y1(equation%n), stat=status)
      if (status == 0) allocate (self%largest(equation%n), source=0.0_wp, stat=status)
      if (status == 0) allocate (self%memory(1, 0:highest_order, series_memory(equation%scene)), &
         stat=status)
      if (status == 0) allocate (self%series(1, 0:highest_order, equation%n), stat=status)
      if (status /= 0) call fail(error, err_numerical, 'out of memory for the integrator')
   end subroutine create_taylor

   subroutine start_taylor(self, t, y, span, error)
      class(taylor_t), intent(inout) :: self
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(:)
      real(wp), intent(in) :: span
      type(error_t), allocatable, intent(out) :: error

      self%t1 = t
      self%y1(:) = y
      self%largest(:) = max(self%largest, abs(y))
      self%span = span
      if (.not. all(ieee_is_finite(y))) call fail_step(self, 'integration', self%tolerance%rtol, &
         'the state is not finite', error)
   end subroutine start_taylor

   subroutine step_taylor(self, t_limit, error)
      class(taylor_t), intent(inout) :: self
      real(wp), intent(in) :: t_limit
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: longest, h, power
      integer :: i

      self%t0 = self%t1
      self%y0(:) = self%y1
      longest = min(t_limit - self%t0, self%span)
      self%span = huge(longest)
      if (self%damper > 0) call approach_turn(self, longest)
      ! The states of smooth springs at which their powers are negligible: until |z|, they change z
      ! by factor*|z|**(exponent + 1)/(exponent + 1).
      self%motion%laws%negligible_state = huge(1.0_wp)
      do i = 1, size(self%springs, 2)
         associate (column => self%springs(:, i), coef => self%equation%state%coef)
            power = coef(1, column(3)) + 1
            if (abs(coef(1, column(2))) > 0) self%motion%laws%negligible_state = &
               min(self%motion%laws%negligible_state, 0.5_wp*(allowed(self, column(1))*power &
               /abs(coef(1, column(2))))**(1/power))
         end associate
      end do
      call begin_series(self, longest)
      do
         call expand(self, min(max(self%order + 2, least_order), self%highest))
         if (self%order == self%highest .or. is_accurate(self, longest)) exit
      end do
      h = even_share(t_limit - self%t0, length_near_zero(self, allowed_length(self, longest)))
      if (.not. h > 8*spacing(self%t0)) then
         call fail_step(self, 'integration', self%tolerance%rtol, step_too_small, error)
         return
      end if
      self%t1 = self%t0 + h
      if (h >= t_limit - self%t0) self%t1 = t_limit
      call evaluate(self, h, self%y1)
      self%largest(:) = max(self%largest, abs(self%y1))
      self%steps = self%steps + 1_i8
      if (.not. all(ieee_is_finite(self%y1))) call fail_step(self, 'integration', &
         self%tolerance%rtol, 'the state is not finite', error)
   end subroutine step_taylor

   !> Drop the force of nonlinear dampers close to a turn, where it has no series, and limit the
   !> step to where it stays negligible.
   subroutine approach_turn(self, longest)
      class(taylor_t), intent(inout) :: self
      real(wp), intent(inout) :: longest
      !! longest step [s]
      integer, parameter :: terms = 4
      !! of the acceleration, of which the first ones vanish at a lift-off
      real(wp) :: turn(terms), time

      self%motion%laws%negligible_rate = huge(time)
      call begin_series(self, longest)
      call expand(self, terms)
      turn = abs(self%motion%turn(1, :terms - 1))
      time = negligible_time(self%equation%state%coef(1, self%damper:self%damper + 3), turn, &
         self%motion%inertia(1, 0), allowed(self, 2))
      self%motion%laws%negligible_rate = rate_after(turn, time)
      if (abs(self%y0(2)) <= self%motion%laws%negligible_rate(1)) longest = min(longest, 2*time)
   end subroutine approach_turn

   !> Length at which states that begin as negligible reach at most twice the limit [s]. Their power
   !> has no series, or one that begins beyond the last term.
   pure real(wp) function length_near_zero(self, longest) result(h)
      class(taylor_t), intent(in) :: self
      real(wp), intent(in) :: longest
      !! longest step [s]
      real(wp), parameter :: shorter = 0.7_wp
      real(wp) :: sum_of_terms
      integer :: i, k

      h = longest
      do i = 1, size(self%springs, 2)
         associate (z => self%series(1, :, self%springs(1, i)), &
                    limit => self%motion%laws%negligible_state(1))
            if (abs(z(1)) > limit) cycle
            do
               sum_of_terms = 0
               do k = self%order, 0, -1
                  sum_of_terms = sum_of_terms*h + abs(z(1 + k))
               end do
               if (.not. sum_of_terms > 2*limit) exit
               h = shorter*h
            end do
         end associate
      end do
   end function length_near_zero

   !> Begin series of order 0 with the states and the ground motion at the begin of the step.
   subroutine begin_series(self, span)
      class(taylor_t), intent(inout) :: self
      real(wp), intent(in) :: span
      !! length in which the series of a host's ground motion holds [s]
      real(wp) :: ground(0:highest_order), upward(0:highest_order)
      integer :: known
      !! order of the ground motion

      known = self%highest
      call expand_ground(self%equation%motion, interval_of(self%equation), self%t0, span, known, &
         ground, upward)
      call set_ground(known, ground, upward, self%motion)
      self%series(1, 0, :) = self%y0
      self%order = 0
   end subroutine begin_series

   !> Continue the series of the step to a higher order.
   subroutine expand(self, order)
      class(taylor_t), intent(inout) :: self
      integer, intent(in) :: order

      associate (equation => self%equation)
         call expand_states(equation%scene, equation%state%coef, self%order, order, self%motion, &
            self%series, self%memory)
         equation%rhs_evaluations = equation%rhs_evaluations + int(order - self%order, i8)
      end associate
      self%order = order
   end subroutine expand

   !> Return whether the last two terms are small parts of the tolerances. Below a radian of the
   !> slowest vibration the part shrinks with the length, so that errors do not add up.
   pure logical function is_accurate(self, h)
      class(taylor_t), intent(in) :: self
      real(wp), intent(in) :: h
      !! length of the step [s]
      real(wp) :: power, radians, tol
      integer :: i

      power = h**(self%order - 1)
      radians = min(1.0_wp, self%frequency*h)
      is_accurate = .false.
      do i = 1, size(self%y0)
         tol = allowed(self, i)
         if (.not. (weight*abs(self%series(1, self%order - 1, i))*power <= tol &
            .and. abs(self%series(1, self%order, i))*(power*h) <= tol*radians)) return
      end do
      is_accurate = .true.
   end function is_accurate

   !> Largest last term of the series of a state, in the unit of the state.
   pure real(wp) function allowed(self, i)
      class(taylor_t), intent(in) :: self
      integer, intent(in) :: i
      !! number of the state

      allowed = share*(self%tolerance%rtol*self%largest(i) + part*self%tolerance%atol(i))
   end function allowed

   !> Length at which the series is accurate [s].
   pure real(wp) function allowed_length(self, longest) result(h)
      class(taylor_t), intent(in) :: self
      real(wp), intent(in) :: longest
      !! longest step [s]
      real(wp) :: tol, last, before
      integer :: i

      h = longest
      if (is_accurate(self, h)) return
      associate (n => self%order)
         do i = 1, size(self%y0)
            tol = allowed(self, i)
            last = abs(self%series(1, n, i))
            before = weight*abs(self%series(1, n - 1, i))
            h = min(h, (tol/max(before, tiny(h)/epsilon(h)))**(1.0_wp/(n - 1)))
            if (last*h**n <= tol*min(1.0_wp, self%frequency*h)) cycle
            h = (tol/last)**(1.0_wp/n)
            if (h*self%frequency < 1) h = (tol*self%frequency/last)**(1.0_wp/(n - 1))
         end do
      end associate
   end function allowed_length

   !> Evaluate the series of all states at a time after the begin of the step.
   pure subroutine evaluate(self, h, y)
      class(taylor_t), intent(in) :: self
      real(wp), intent(in) :: h
      !! [s]
      real(wp), intent(out) :: y(:)
      !! (states)
      integer :: k

      y = self%series(1, self%order, :)
      do k = self%order - 1, 0, -1
         y = y*h + self%series(1, k, :)
      end do
   end subroutine evaluate

   subroutine state_at_taylor(self, t, y, error)
      class(taylor_t), intent(inout) :: self
      real(wp), intent(in) :: t
      real(wp), intent(out) :: y(:)
      type(error_t), allocatable, intent(out) :: error

      if (t <= self%t0) then
         y = self%y0
      else if (t >= self%t1) then
         y = self%y1
      else
         call evaluate(self, t - self%t0, y)
      end if
      if (.not. all(ieee_is_finite(y))) call fail_step(self, 'integration', self%tolerance%rtol, &
         'the state is not finite', error)
   end subroutine state_at_taylor

   subroutine destroy_taylor(self)
      class(taylor_t), intent(inout) :: self

      if (allocated(self%y0)) deallocate (self%y0)
      if (allocated(self%y1)) deallocate (self%y1)
      if (allocated(self%largest)) deallocate (self%largest)
      if (allocated(self%series)) deallocate (self%series)
      if (allocated(self%memory)) deallocate (self%memory)
   end subroutine destroy_taylor

end module rwmf_integrator_taylor
