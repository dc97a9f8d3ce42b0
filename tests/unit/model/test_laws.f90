!> Springs that lose strength, against closed forms, point by point.
program test_laws
   use check, only: checks_t
   use rwmf_core_kinds, only: wp
   use rwmf_model_hysteresis_spring_laws, only: loading_direction, new_branch, new_spring, &
      pass_limit, spring_energy, spring_force, spring_limits, spring_loss, spring_residual, &
      turn_spring
   use rwmf_model_spring, only: branch_t, spring_t
   use rwmf_problem_case, only: spring_law_t
   implicit none

   real(wp), parameter :: k = 3
   real(wp), parameter :: u_y = 0.2_wp
   real(wp), parameter :: f_y = k*u_y
   type(checks_t) :: checks

   if (checks%wants('envelope')) call check_envelope()
   if (checks%wants('peak_oriented')) call check_peak_oriented()
   if (checks%wants('wear')) call check_wear()
   if (checks%wants('pinched')) call check_pinched()
   if (checks%wants('exhausted')) call check_exhausted()
   call checks%finish()

contains

   !> Move a spring from the elongation a to b.
   subroutine move(spring, branch, a, b)
      type(spring_t), intent(in) :: spring
      type(branch_t), intent(inout) :: branch
      real(wp), intent(in) :: a
      real(wp), intent(in) :: b
      real(wp) :: low, high

      if (loading_direction(spring, branch)*(b - a) < 0) call turn_spring(spring, branch, a)
      do
         call spring_limits(spring, branch, low, high)
         if (b > a .and. b > high) then
            call pass_limit(spring, branch, is_rising=.true.)
         else if (b < a .and. b < low) then
            call pass_limit(spring, branch, is_rising=.false.)
         else
            exit
         end if
      end do
   end subroutine move

   !> Move a spring from the elongation x u_y to another one, and check its force there.
   subroutine pull(spring, branch, x, to, force, name, rtol, atol)
      type(spring_t), intent(in) :: spring
      type(branch_t), intent(inout) :: branch
      real(wp), intent(inout) :: x
      !! elongation over u_y [-]
      real(wp), intent(in) :: to
      real(wp), intent(in), optional :: force
      !! over f_y [-]
      character(*), intent(in), optional :: name
      real(wp), intent(in), optional :: rtol, atol

      call move(spring, branch, x*u_y, to*u_y)
      x = to
      if (present(force)) call checks%close_to(spring_force(spring, branch, x*u_y), force*f_y, &
         name, rtol, atol)
   end subroutine pull

   !> Spring of Ibarra, Medina and Krawinkler with the cap at 4 u_y, zero force 10 u_y beyond it,
   !> and a residual strength of one fifth.
   function worn_spring(name, lambda, pinch) result(spring)
      character(*), intent(in) :: name
      real(wp), intent(in), optional :: lambda
      real(wp), intent(in), optional :: pinch(2)
      type(spring_t) :: spring
      type(spring_law_t) :: law

      law = spring_law_t(name, cap=4.0_wp, post_cap=10.0_wp, residual=0.2_wp)
      if (present(lambda)) law%lambda = lambda
      if (present(pinch)) law%pinch_force = pinch(1)
      if (present(pinch)) law%pinch_displacement = pinch(2)
      spring = new_spring(k, f_y, 0.1_wp, law=law)
   end function worn_spring

   !> Check monotonic loading: slope k, hardening slope k/10, softening from 1.3 F_y, residual
   !> strength.
   subroutine check_envelope()
      real(wp), parameter :: to(6) = [0.5_wp, 1.0_wp, 4.0_wp, 9.0_wp, 4 + 11/1.3_wp, 30.0_wp]
      real(wp), parameter :: f(6) = [0.5_wp, 1.0_wp, 1.3_wp, 0.65_wp, 0.2_wp, 0.2_wp]
      type(spring_t) :: spring
      type(branch_t) :: branch
      real(wp) :: x
      integer :: i

      spring = worn_spring('peak_oriented')
      branch = new_branch(spring)
      x = 0
      do i = 1, size(f)
         call pull(spring, branch, x, to(i), f(i), 'envelope', rtol=1.0e-14_wp)
      end do
      call checks%close_to(spring_energy(spring, branch, 30*u_y) + spring_loss(spring, branch, &
         30*u_y), f_y*u_y*(0.5_wp + 1.15_wp*3 + 0.75_wp*11/1.3_wp &
         + 0.2_wp*(26 - 11/1.3_wp)), 'work of a push', rtol=1.0e-13_wp)
      call checks%close_to(spring_residual(spring, branch, 30*u_y), 29.8_wp*u_y, &
         'unloaded from there', rtol=1.0e-13_wp)
   end subroutine check_envelope

   !> Check the peak-oriented law without deterioration. Unloading has the stiffness k. Reloading
   !> aims at the peak of the other side, or at its point of first yield before it has yielded. If
   !> the line through the last turning point is stiffer, reloading follows that line.
   subroutine check_peak_oriented()
      type(spring_t) :: spring
      type(branch_t) :: branch
      real(wp) :: x

      spring = worn_spring('peak_oriented')
      branch = new_branch(spring)
      x = 0
      ! to 3 u_y, force 1.2 F_y, unloaded at 1.8 u_y, from there to (-1, -1)
      call pull(spring, branch, x, 3.0_wp)
      call pull(spring, branch, x, 1.8_wp, 0.0_wp, 'unloaded', atol=1.0e-14_wp)
      call pull(spring, branch, x, 0.4_wp, -0.5_wp, 'half way to yield', rtol=1.0e-13_wp)
      call pull(spring, branch, x, -2.0_wp, -1.1_wp, 'yields there', rtol=1.0e-13_wp)
      ! unloaded at -0.9 u_y, half way to (3, 1.2) at 1.05 u_y
      call pull(spring, branch, x, 1.05_wp, 0.6_wp, 'half way to the peak', rtol=1.0e-13_wp)
      ! unloaded at 0.45, half way to (-2, -1.1) at -0.775; unloaded from there at -0.225
      call pull(spring, branch, x, -0.775_wp, -0.55_wp, 'half way back', rtol=1.0e-13_wp)
      ! the line to the last turn (1.05, 0.6) is stiffer than that to the peak: 0.6/1.275 >
      ! 1.2/3.225
      call pull(spring, branch, x, 0.4125_wp, 0.3_wp, 'half way to the last turn', rtol=1.0e-13_wp)
      call pull(spring, branch, x, 2.025_wp, 0.9_wp, 'from there to the peak', rtol=1.0e-13_wp)
      ! partial unloading, then reloading
      call pull(spring, branch, x, 1.5_wp, 0.375_wp, 'in part', rtol=1.0e-13_wp)
      call pull(spring, branch, x, 3.5_wp, 1.25_wp, 'back on the envelope', rtol=1.0e-13_wp)
   end subroutine check_peak_oriented

   !> Compare the deterioration with its formula, evaluated by hand: E_1 is the area to 3 u_y and
   !> back to zero.
   subroutine check_wear()
      real(wp), parameter :: lambda = 40
      type(spring_t) :: spring
      type(branch_t) :: branch
      real(wp) :: x
      real(wp) :: e, beta, beta_k, stiffness, x_0, fy, slope, falling, cap, peak(2), goal(2)

      spring = worn_spring('peak_oriented', lambda)
      branch = new_branch(spring)
      x = 0
      ! all over u_y and F_y; the turn at (3, 1.2) includes the dissipation up to it
      e = 0.5_wp + 1.1_wp*2 - 1.2_wp**2/2
      beta_k = e/(lambda - e)
      stiffness = 1 - beta_k
      x_0 = 3 - 1.2_wp/stiffness
      call pull(spring, branch, x, 3.0_wp)
      call pull(spring, branch, x, 2.5_wp, 1.2_wp - stiffness/2, &
         'stiffness of unloading', rtol=1.0e-13_wp)
      e = 0.5_wp + 1.1_wp*2 - 1.2_wp*(3 - x_0)/2
      beta = e/(lambda - e)
      fy = 1 - beta
      slope = 0.1_wp*(1 - beta)
      falling = (1.3_wp + 0.13_wp*4)*(1 - beta)
      cap = (falling - fy*(1 - slope))/(slope + 0.13_wp)
      peak(1) = 1 + beta
      peak(2) = fy + slope*(peak(1) - fy)
      call pull(spring, branch, x, (x_0 - peak(1))/2, -peak(2)/2, &
         'reloading to the worn peak', rtol=1.0e-13_wp)
      call pull(spring, branch, x, -cap, -(fy + slope*(cap - fy)), 'the worn cap', rtol=1.0e-13_wp)
      goal = [cap + 1, fy + slope*(cap - fy) - 0.13_wp]
      call pull(spring, branch, x, -goal(1), -goal(2), 'beyond the worn cap', rtol=1.0e-13_wp)
   end subroutine check_wear

   !> Check the pinching point against its definition.
   subroutine check_pinched()
      real(wp), parameter :: pinch(2) = [0.4_wp, 0.25_wp]
      type(spring_t) :: spring
      type(branch_t) :: branch
      real(wp) :: x
      real(wp) :: x_p, f_p

      spring = worn_spring('pinched', pinch=pinch)
      branch = new_branch(spring)
      x = 0
      call pull(spring, branch, x, 3.0_wp)
      call pull(spring, branch, x, -3.0_wp)
      ! unloaded at -1.8; 0.75 of the plastic 1.8 and 0.4 of the line to (3, 1.2) there
      x_p = 0.75_wp*1.8_wp
      f_p = 0.4_wp*1.2_wp*(x_p + 1.8_wp)/4.8_wp
      call pull(spring, branch, x, (x_p - 1.8_wp)/2, f_p/2, &
         'half way to the pinching point', rtol=1.0e-12_wp)
      call pull(spring, branch, x, (x_p + 3)/2, (f_p + 1.2_wp)/2, &
         'from there to the peak', rtol=1.0e-12_wp)
   end subroutine check_pinched

   !> Check that an excursion beyond the remaining energy capacity breaks the spring, and that all
   !> work is dissipated.
   subroutine check_exhausted()
      type(spring_t) :: spring
      type(branch_t) :: branch
      real(wp) :: x
      real(wp) :: lost

      spring = worn_spring('peak_oriented', 5.0_wp)
      branch = new_branch(spring)
      x = 0
      call pull(spring, branch, x, 4.0_wp)
      call pull(spring, branch, x, -1.0_wp, 0.0_wp, 'exhausted')
      lost = (0.5_wp + 1.15_wp*3)*f_y*u_y
      call checks%close_to(spring_loss(spring, branch, -u_y), lost, 'and all of it lost', &
         rtol=1.0e-13_wp)
      call pull(spring, branch, x, 9.0_wp, 0.0_wp, 'for good')
   end subroutine check_exhausted

end program test_laws
