!> Rotation of the wall at a displacement of its link, for elements of a host program.
!>
!> With phi = |theta|, w = sigma u = R u_phi(phi), w' = R j phi' and w'' = R (k phi'**2 + j phi'').
module rwmf_embedding_link_rotation
   use rwmf_core_error, only: err_input, error_t, fail
   use rwmf_core_kinds, only: wp
   use rwmf_math_roots, only: bracket_between, bracket_t, is_wider, keep_inside, narrow
   use rwmf_model_equation, only: equation_t, kinematics_at
   use rwmf_model_kinematics, only: kinematics_t
   use rwmf_text_strings, only: real_to_text
   implicit none
   private

   public :: find_rotation, slope_of_phi_ddot

contains

   !> Find the rotation at a displacement by Newton's method inside a bracket.
   subroutine find_rotation(equation, largest_angle, side, w, phi, kin, error)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: largest_angle
      !! rotation at which the wall counts as overturned [rad]
      integer, intent(in) :: side
      !! +1 or -1
      real(wp), intent(in) :: w
      !! sigma u [m]
      real(wp), intent(out) :: phi
      !! [rad]
      type(kinematics_t), intent(out) :: kin
      type(error_t), allocatable, intent(out) :: error
      !! `err_input` if the wall cannot reach this displacement
      integer, parameter :: most_iterations = 100
      type(bracket_t) :: bracket
      real(wp) :: rest
      real(wp) :: step
      integer :: i

      bracket = bracket_between(-min(largest_angle, merge(equation%p%alpha, huge(phi), &
         equation%has_impacts)), largest_angle)
      phi = 0
      do i = 1, most_iterations
         kin = kinematics_at(equation, side*phi, side)
         rest = w/equation%p%R - kin%u
         call narrow(bracket, .not. rest > 0, phi)
         step = rest/kin%j
         if (abs(step) <= 2*spacing(phi) .or. abs(rest) <= tiny(rest)) return
         phi = keep_inside(bracket, phi + step)
         if (.not. is_wider(bracket, 4)) exit
      end do
      if (abs(abs(phi) - largest_angle) > 1.0e-12_wp .and. phi > bracket%low) return
      call fail(error, err_input, 'a displacement of '//trim(real_to_text(w)) &
         //' m is more than the wall can follow', 'overturned')
   end subroutine find_rotation

   !> Derivative of phi'' by phi at fixed w', w'' [1/s2].
   pure real(wp) function slope_of_phi_ddot(kin, rates) result(slope)
      type(kinematics_t), intent(in) :: kin
      real(wp), intent(in) :: rates(2)
      !! phi' [rad/s], phi'' [rad/s2]

      slope = ((2*kin%k**2/kin%j - kin%k_1)*rates(1)**2 - kin%k*rates(2))/kin%j
   end function slope_of_phi_ddot

end module rwmf_embedding_link_rotation
