!> Laws of the fast spectra: polynomials on a range of v, and on wider ones for those ordinates
!> that leave it.
module rwmf_spectrum_fast_polynomial_fit
   use rwmf_problem_case, only: case_t
   use rwmf_spectrum_fast_types, only: fast_law_t
   use rwmf_spectrum_fast_reduced_equation, only: build_law
   use rwmf_spectrum_fast_shared_data, only: fast_scope_t, fast_task_t
   use rwmf_core_kinds, only: wp
   implicit none
   private

   public :: ranges, fit_laws, widen

   real(wp), parameter :: fit_range(4) = [0.1_wp, 0.14_wp, 0.2_wp, 0.3_wp]
   !! of |u_s|/(2R) [-]
   integer, parameter :: ranges = size(fit_range)
   real(wp), parameter :: fit_share = 0.1_wp
   !! error of the fit over the tolerance: a steady error of the acceleration is amplified by
   !! (g/R)/(omega_s**2 v), about 10 for flexible frames

contains

   !> Fit the laws that are wanted to begin with; the others come when someone calls for them.
   subroutine fit_laws(threads, wanted, scope)
      integer, intent(in) :: threads
      logical, intent(in) :: wanted(:)
      !! (pairs*ranges)
      type(fast_scope_t), intent(inout) :: scope
      !! in: with its scenes
      integer :: i

      allocate (scope%law(size(wanted)), scope%holds(size(wanted)))
      scope%is_fitted = wanted
      !$omp parallel do num_threads(threads) schedule(dynamic) default(shared) &
      !$omp if (count(wanted) > 2)
      do i = 1, size(wanted)
         if (wanted(i)) call fit(i, scope)
      end do
      !$omp end parallel do
   end subroutine fit_laws

   !> The next wider range for an ordinate that has left its own.
   subroutine widen(scope, task, is_possible)
      type(fast_scope_t), intent(inout) :: scope
      !! shared by the threads
      type(fast_task_t), intent(inout) :: task
      logical, intent(out) :: is_possible
      integer :: wider

      is_possible = .false.
      wider = task%law + scope%pairs
      if (wider > size(scope%law)) return
      !$omp critical (rwmf_fast_law)
      if (.not. scope%is_fitted(wider)) then
         call fit(wider, scope)
         scope%is_fitted(wider) = .true.
      end if
      is_possible = scope%holds(wider)
      !$omp end critical (rwmf_fast_law)
      if (is_possible) task%law = wider
   end subroutine widen

   subroutine fit(i, scope)
      integer, intent(in) :: i
      !! number of the law
      type(fast_scope_t), intent(inout) :: scope

      associate (scene => scope%scene(mod(i - 1, scope%pairs) + 1), law => scope%law(i))
         call build_law(scene, fit_range((i - 1)/scope%pairs + 1), fit_share*scope%rtol, law)
         scope%holds(i) = holds(scene, scope%rtol, law)
      end associate
   end subroutine fit

   !> Does the fit hold what the tolerance asks, and end before the wall overturns?
   pure logical function holds(scene, rtol, law)
      type(case_t), intent(in) :: scene
      real(wp), intent(in) :: rtol
      type(fast_law_t), intent(in) :: law
      real(wp) :: alpha
      !! slenderness [rad]

      alpha = atan2(scene%wall%b, scene%wall%h)
      holds = law%fit_error < fit_share*rtol .and. law%e > 0 &
         .and. law%v_high < sin(min(scene%model%overturning_angle, 1.0_wp)/2)*cos(alpha)
   end function holds

end module rwmf_spectrum_fast_polynomial_fit
