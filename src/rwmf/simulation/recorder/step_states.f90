!> Interpolated states inside a short piece of a step, at the cost of one further step.
!>
!> The polynomials use displacements, velocities and accelerations at both ends and in the middle.
!> They locate a maximum to far more digits than it needs; its value comes from the integrator.
module rwmf_simulation_recorder_step_states
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: wp
   use rwmf_model_system_assembly, only: equation_t, rates_at
   use rwmf_simulation_events_step_view, only: is_short, sample_state, step_view_t
   implicit none
   private

   public :: step_states_t, may_interpolate, fit_states, state_inside

   integer, parameter :: most = 9
   !! largest number of conditions on a polynomial

   !> Polynomials of a piece in Newton's form, over the relative position from 0 to 1.
   type :: step_states_t
      real(wp) :: t_a
      !! [s]
      real(wp) :: h
      !! length of the piece [s]
      real(wp), allocatable :: c(:, :)
      !! (conditions, states) coefficients for displacements, whose rates are the velocities. Other
      !! states have 6 conditions
      integer, allocatable :: displacement(:)
      !! (states) displacement whose velocity this state is; 0: none
   end type step_states_t

contains

   !> True if a piece is short enough to interpolate, but not so short that round-off governs.
   logical function may_interpolate(piece, frequency) result(may)
      type(step_view_t), intent(in) :: piece
      real(wp), intent(in) :: frequency
      !! frequency of the fastest vibration [rad/s]
      real(wp), parameter :: longest = 1.5_wp, shortest = 1.0e-3_wp
      !! [rad]

      may = (piece%t_b - piece%t_a)*frequency > shortest
      if (may) may = is_short(piece, longest, frequency)
   end function may_interpolate

   !> Compute the polynomials of a piece from the rates at both ends.
   subroutine fit_states(piece, rates, states, error)
      type(step_view_t), intent(in) :: piece
      real(wp), intent(in) :: rates(:, :)
      !! (states, 2)
      type(step_states_t), intent(out) :: states
      type(error_t), allocatable, intent(out) :: error
      !! the integrator fails
      real(wp) :: y(size(rates, 1), 3), f(size(rates, 1), 3)
      real(wp) :: t
      integer :: j, k

      states%t_a = piece%t_a
      states%h = piece%t_b - piece%t_a
      t = piece%t_a + states%h/2
      y(:, 1) = piece%y_a
      y(:, 3) = piece%y_b
      call sample_state(piece, t, y(:, 2), error)
      if (allocated(error)) return
      f(:, [1, 3]) = rates
      call rates_at(piece%equation, t, y(:, 2), f(:, 2))
      states%displacement = velocities(piece%equation)
      allocate (states%c(most, size(y, 1)))
      do j = 1, size(y, 1)
         k = findloc(states%displacement, j, dim=1)
         if (k > 0) then
            states%c(:, j) = newton_form(y(j, :), states%h*f(j, :), states%h**2/2*f(k, :))
         else if (states%displacement(j) == 0) then
            states%c(:, j) = newton_form(y(j, :), states%h*f(j, :))
         end if
      end do
   end subroutine fit_states

   !> Number of the displacement whose velocity each state is; 0: none.
   pure function velocities(equation) result(displacement)
      type(equation_t), intent(in) :: equation
      integer, allocatable :: displacement(:)
      integer :: j

      allocate (displacement(equation%n), source=0)
      displacement(2) = 1
      associate (n => equation%floors%free, first => equation%floors%first)
         do j = 0, n - 1
            displacement(first + n + j) = first + j
         end do
      end associate
   end function velocities

   !> Divided differences of a function at 0, 1/2 and 1, with its given derivatives.
   pure function newton_form(f, slope, bend) result(c)
      real(wp), intent(in) :: f(3), slope(3)
      !! values and first derivatives, in any unit
      real(wp), intent(in), optional :: bend(3)
      !! halves of the second derivatives
      real(wp) :: c(most), x(most)
      integer :: i, k, n, times

      times = merge(3, 2, present(bend))
      n = 3*times
      x = 0
      c = 0
      do i = 1, n
         k = (i - 1)/times + 1
         x(i) = (k - 1)*0.5_wp
         c(i) = f(k)
      end do
      do k = 2, n
         do i = n, k, -1
            if (x(i) > x(i - k + 1)) then
               c(i) = (c(i) - c(i - 1))/(x(i) - x(i - k + 1))
            else if (k == 2) then
               c(i) = slope((i - 1)/times + 1)
            else
               c(i) = bend((i - 1)/times + 1)
            end if
         end do
      end do
   end function newton_form

   !> Interpolate the state at a time inside the piece.
   pure subroutine state_inside(states, t, y)
      type(step_states_t), intent(in) :: states
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(out) :: y(:)
      !! (states)
      real(wp) :: x, value, rate
      integer :: i, j, n, times, velocity

      x = (t - states%t_a)/states%h
      do j = 1, size(y)
         if (states%displacement(j) > 0) cycle
         velocity = findloc(states%displacement, j, dim=1)
         times = merge(3, 2, velocity > 0)
         n = 3*times
         value = states%c(n, j)
         rate = 0
         do i = n - 1, 1, -1
            associate (from_node => x - ((i - 1)/times)*0.5_wp)
               rate = rate*from_node + value
               value = value*from_node + states%c(i, j)
            end associate
         end do
         y(j) = value
         if (velocity > 0) y(velocity) = rate/states%h
      end do
   end subroutine state_inside

end module rwmf_simulation_recorder_step_states
