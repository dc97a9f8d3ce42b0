!> Fits of the reduced equations: on a narrow range of v, and on wider ones for ordinates that leave
!> it.
module rwmf_spectrum_fast_polynomial_fit
   use rwmf_core_kinds, only: wp
   use rwmf_problem_case, only: case_t
   use rwmf_spectrum_fast_reduced_equation, only: build_reduced_equation
   use rwmf_spectrum_fast_shared_data, only: shared_data_t, task_t
   use rwmf_spectrum_fast_types, only: reduced_equation_t
   implicit none
   private

   public :: ranges, fit_equations, widen_range

   real(wp), parameter :: fit_range(4) = [0.1_wp, 0.14_wp, 0.2_wp, 0.3_wp]
   !! ends of the ranges of v [-]
   integer, parameter :: ranges = size(fit_range)
   real(wp), parameter :: fit_share = 0.1_wp
   !! error of the fit over the tolerance: a steady error of the acceleration is amplified by
   !! (g/R)/(omega_s**2 v), about 10 for flexible frames

contains

   !> Fit the equations that are wanted to begin with; the others are fitted by `widen_range`.
   subroutine fit_equations(threads, wanted, shared)
      integer, intent(in) :: threads
      logical, intent(in) :: wanted(:)
      !! (pairs*ranges)
      type(shared_data_t), intent(inout) :: shared
      !! in: with the models of the pairs
      integer :: i

      allocate (shared%equation(size(wanted)), shared%is_usable(size(wanted)))
      shared%is_fitted = wanted
      !$omp parallel do num_threads(threads) schedule(dynamic) default(shared) &
      !$omp if (count(wanted) > 2)
      do i = 1, size(wanted)
         if (wanted(i)) call fit_equation(i, shared)
      end do
      !$omp end parallel do
   end subroutine fit_equations

   !> Give a task the next wider range, once it has left its own; fit the equation if it is the
   !> first.
   subroutine widen_range(shared, task, is_possible)
      type(shared_data_t), intent(inout) :: shared
      !! shared by all threads
      type(task_t), intent(inout) :: task
      logical, intent(out) :: is_possible
      integer :: wider

      is_possible = .false.
      wider = task%equation + shared%pairs
      if (wider > size(shared%equation)) return
      !$omp critical (rwmf_fit_equation)
      if (.not. shared%is_fitted(wider)) then
         call fit_equation(wider, shared)
         shared%is_fitted(wider) = .true.
      end if
      is_possible = shared%is_usable(wider)
      !$omp end critical (rwmf_fit_equation)
      if (is_possible) task%equation = wider
   end subroutine widen_range

   !> Fit one equation.
   subroutine fit_equation(i, shared)
      integer, intent(in) :: i
      !! number of the equation
      type(shared_data_t), intent(inout) :: shared

      associate (case => shared%case(mod(i - 1, shared%pairs) + 1), equation => shared%equation(i))
         call build_reduced_equation(case, fit_range((i - 1)/shared%pairs + 1), &
            fit_share*shared%rtol, equation)
         shared%is_usable(i) = is_fit_sufficient(case, shared%rtol, equation)
      end associate
   end subroutine fit_equation

   !> Is the error of the fit within the tolerance, and its end before overturning?
   pure logical function is_fit_sufficient(case, rtol, equation)
      type(case_t), intent(in) :: case
      real(wp), intent(in) :: rtol
      type(reduced_equation_t), intent(in) :: equation
      real(wp) :: alpha
      !! slenderness [rad]

      alpha = atan2(case%wall%b, case%wall%h)
      is_fit_sufficient = equation%fit_error < fit_share*rtol .and. equation%e > 0 &
         .and. equation%v_high < sin(min(case%model%overturning_angle, 1.0_wp)/2)*cos(alpha)
   end function is_fit_sufficient

end module rwmf_spectrum_fast_polynomial_fit
