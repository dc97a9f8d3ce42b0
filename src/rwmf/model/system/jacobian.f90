!> Derivatives of the right-hand side for implicit methods.
module rwmf_model_system_jacobian
   use rwmf_core_kinds, only: wp
   use rwmf_model_system_assembly, only: equation_t, rates_at
   implicit none
   private

   public :: find_jacobian

contains

   !> Compute the derivatives of all rates with respect to all states by central differences. Their
   !> accuracy is sufficient for Newton's iteration.
   subroutine find_jacobian(equation, t, y, values)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp), intent(out) :: values(:, :)
      !! (rates, states)
      real(wp), parameter :: least = 1.0e-3_wp, slowest = 1.0e-20_wp
      !! least size of a state, and of a velocity that a steep law distinguishes from zero
      real(wp), dimension(size(y)) :: step, forward, backward
      real(wp) :: h
      integer :: i

      do i = 1, equation%n
         h = max(abs(y(i)), merge(slowest, least, i == 2 .and. equation%creep > 0))
         step = 0
         step(i) = epsilon(h)**(1.0_wp/3)*h
         call rates_at(equation, t, y + step, forward)
         call rates_at(equation, t, y - step, backward)
         values(:, i) = (forward - backward)/(2*step(i))
      end do
      ! A held wall (theta'' = 0 in every case) must stay exactly at zero. For this, the elimination
      ! must find only zeros below its two rows.
      if (all(abs(values(2, :)) <= 0)) values(3:, :2) = 0
   end subroutine find_jacobian

end module rwmf_model_system_jacobian
