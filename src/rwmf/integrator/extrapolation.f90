!> Extrapolated midpoint rule (Gragg, Bulirsch, Stoer) of fixed high order.
!>
!> The rule needs only integer coefficients and therefore runs in any precision: it integrates the
!> quadruple-precision reference. Hairer, Norsett, Wanner: Solving Ordinary Differential Equations
!> I, section II.9, step numbers 2, 4, 6, ...
module rwmf_integrator_extrapolation
   use rwmf_core_kinds, only: dp, wp
   use rwmf_integrator_one_step, only: error_norm, one_step_t
   use rwmf_model_system_assembly, only: rhs
   implicit none
   private

   public :: extrapolation_t

   integer, parameter :: columns = merge(5, 9, wp == dp)
   !! order 2*columns: 10 in double precision, 18 in quadruple

   !> Gragg-Bulirsch-Stoer extrapolation.
   type, extends(one_step_t) :: extrapolation_t
      real(wp), allocatable :: table(:, :)
      !! (states, columns) buffer for the current row of the Aitken-Neville scheme; column i of row
      !! j holds T_{j, j+1-i}
   contains
      procedure :: attempt => attempt_extrapolation
   end type extrapolation_t

contains

   subroutine attempt_extrapolation(self, t, y, f, h, y_new, error)
      class(extrapolation_t), intent(inout) :: self
      real(wp), intent(in) :: t
      real(wp), intent(in), contiguous :: y(:)
      real(wp), intent(in), contiguous :: f(:)
      real(wp), intent(in) :: h
      real(wp), intent(out), contiguous :: y_new(:)
      real(wp), intent(out) :: error
      real(wp) :: previous(size(y))
      real(wp) :: fresh(size(y))
      integer :: i
      integer :: j

      self%error_order = 2*columns - 1
      if (allocated(self%table)) then
         if (size(self%table, 1) /= size(y)) deallocate (self%table)
      end if
      if (.not. allocated(self%table)) allocate (self%table(size(y), columns))
      self%table(:, :) = 0
      do j = 1, columns
         fresh = midpoint_rule(self, t, y, f, h, 2*j)
         do i = 1, j
            previous = self%table(:, i)
            self%table(:, i) = fresh
            if (i < j) fresh = fresh + (fresh - previous)/((real(j, wp)/real(j - i, wp))**2 - 1)
         end do
      end do
      y_new = self%table(:, columns)
      error = error_norm(self, y, y_new, self%table(:, columns) - self%table(:, columns - 1))
   end subroutine attempt_extrapolation

   !> Apply the explicit midpoint rule with n substeps, n even: its error has an expansion in
   !> (h/n)**2.
   function midpoint_rule(self, t, y, f, h, n) result(y_end)
      class(extrapolation_t), intent(inout) :: self
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(:)
      real(wp), intent(in) :: f(:)
      real(wp), intent(in) :: h
      integer, intent(in) :: n
      real(wp) :: y_end(size(y))
      real(wp) :: before(size(y))
      real(wp) :: here(size(y))
      real(wp) :: slope(size(y))
      integer :: i

      before = y
      here = y + h/n*f
      do i = 1, n - 1
         call rhs(self%equation, t + i*h/n, here, slope)
         y_end = before + 2*h/n*slope
         before = here
         here = y_end
      end do
      call rhs(self%equation, t + h, here, slope)
      ! Gragg's smoothing step.
      y_end = (here + before + h/n*slope)/2
   end function midpoint_rule

end module rwmf_integrator_extrapolation
