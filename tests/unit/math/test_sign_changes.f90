!> Verdicts of `rwmf_math_sign_changes` on two vibrations over a short span against dense samples.
program test_sign_changes
   use check, only: checks_t
   use rwmf_core_kinds, only: wp
   use rwmf_math_sign_changes, only: change_at_begin, changes_of, no_change, one_change, &
      is_positive, polygon_t, rate_polygon, root_of, roughness, unclear, value_polygon
   implicit none

   integer, parameter :: scenes = 4000, samples = 400
   type(checks_t) :: checks

   if (checks%wants('two_changes')) call check_two_changes()
   if (checks%wants('vibrations')) call check_vibrations()
   if (checks%wants('begins_at_zero')) call check_begins_at_zero()
   if (checks%wants('known_ends')) call check_known_ends()
   if (checks%wants('root')) call check_root()
   call checks%finish()

contains

   !> A rate that dips below zero between two ends at which it is positive. For every width and
   !> position of the dip, the verdict is not "quiet".
   subroutine check_two_changes()
      real(wp) :: a(0:2), b(0:2), middle, width
      type(polygon_t) :: polygon
      integer :: i, k, missed

      missed = 0
      do i = 1, 19
         do k = 1, 12
            middle = i/20.0_wp
            width = 0.04_wp*0.5_wp**k
            ! the rate (x - middle)**2 - width**2
            a = [0.0_wp, middle**2 - width**2, -2*middle]
            b = [((1 - middle)**3 + middle**3)/3 - width**2, (1 - middle)**2 - width**2, &
               2*(1 - middle)]
            polygon = rate_polygon(1.0_wp, a, b, roughness(1.0_wp, 1.0_wp, a, b))
            if (changes_of(polygon, 0.0_wp) /= unclear) missed = missed + 1
            polygon = rate_polygon(1.0_wp, a(:1), b(:1), roughness(1.0_wp, 1.0_wp, a(:1), b(:1)))
            if (changes_of(polygon, 0.0_wp) /= unclear) missed = missed + 1
         end do
      end do
      call checks%that(missed == 0, 'no dip is missed')
   end subroutine check_two_changes

   !> Values and rates of two vibrations, of which the faster one covers up to 1.5 rad. A span with
   !> the verdict "quiet" has no sign change among dense samples; one with a single change has one.
   subroutine check_vibrations()
      real(wp) :: chance(7), f(0:2, 0:samples), angle, rough
      type(polygon_t) :: polygon
      integer :: i, k, order, verdict, changes, wrong, quiet, positive, without_change

      wrong = 0
      positive = 0
      without_change = 0
      quiet = 0
      call random_init(repeatable=.true., image_distinct=.false.)
      do i = 1, scenes
         call random_number(chance)
         angle = 0.2_wp + 1.3_wp*chance(1)
         do k = 0, samples
            f(:, k) = vibration(chance, angle, k/real(samples, wp))
         end do
         rough = roughness(max(1.0_wp, angle), 1.0_wp, f(:, 0), f(:, samples))
         do order = 0, 1
            if (f(order, 0) < 0) f = -f
            if (order == 0) polygon = value_polygon(1.0_wp, f(:, 0), f(:, samples), rough)
            if (order == 1) polygon = rate_polygon(1.0_wp, f(:, 0), f(:, samples), rough)
            verdict = changes_of(polygon, 0.0_wp)
            changes = count(f(order, 1:)*f(order, :samples - 1) < 0)
            if (verdict == no_change .and. changes > 0) wrong = wrong + 1
            if (verdict == one_change .and. changes /= 1) wrong = wrong + 1
            if (is_positive(1.0_wp, f(:, 0), f(:, samples), rough, 0.0_wp, order)) then
               positive = positive + 1
               if (verdict /= no_change) wrong = wrong + 1
            end if
            if (verdict == no_change) without_change = without_change + 1
            if (verdict /= unclear) quiet = quiet + 1
         end do
      end do
      call checks%that(wrong == 0, 'no verdict is wrong')
      call checks%that(quiet > 3*scenes/2, 'most spans are decided at once')
      call checks%that(positive > 0.8_wp*without_change, 'the short test decides most of them')
   end subroutine check_vibrations

   !> A fast and a slow vibration about a level that both may touch, with two derivatives.
   pure function vibration(chance, angle, x) result(f)
      real(wp), intent(in) :: chance(7)
      real(wp), intent(in) :: angle
      !! of the fast one in the span [rad]
      real(wp), intent(in) :: x
      real(wp) :: f(0:2)
      real(wp) :: slow, phase(2), amplitude

      slow = angle*chance(2)
      phase = 6.3_wp*chance(3:4)
      amplitude = 10**(2*chance(5) - 1)
      f(0) = sin(angle*x + phase(1)) + amplitude*sin(slow*x + phase(2)) + 2*chance(6) - 1 &
         + (2*chance(7) - 1)*x
      f(1) = angle*cos(angle*x + phase(1)) + amplitude*slow*cos(slow*x + phase(2)) &
         + 2*chance(7) - 1
      f(2) = -angle**2*sin(angle*x + phase(1)) - amplitude*slow**2*sin(slow*x + phase(2))
   end function vibration

   !> A function that begins at zero has a change there if it becomes negative, and none otherwise.
   subroutine check_begins_at_zero()
      real(wp), parameter :: up(0:2) = [0.0_wp, 1.0_wp, 0.0_wp], end_up(0:2) = [1.0_wp, 1.0_wp, &
         0.0_wp]

      call checks%that(changes_of(value_polygon(1.0_wp, up, end_up, 0.0_wp), 0.0_wp) == no_change, &
         'it rises from zero')
      call checks%that(changes_of(value_polygon(1.0_wp, -up, -end_up, 0.0_wp), 0.0_wp) &
         == change_at_begin, 'it falls from zero')
   end subroutine check_begins_at_zero

   !> The ends of a polygon may be known far better than its middle.
   subroutine check_known_ends()
      type(polygon_t) :: polygon

      polygon = rate_polygon(1.0e-6_wp, [1.0_wp, 1.0e-7_wp, 0.0_wp], [1.0_wp, 1.0e-7_wp, 0.0_wp], &
         0.0_wp)
      polygon%c(1:polygon%n - 1) = -1.0e-7_wp
      call checks%that(changes_of(polygon, 1.0e-6_wp, 1.0e-9_wp) == no_change, 'round-off inside')
      polygon%c(polygon%n) = -1.0e-7_wp
      call checks%that(changes_of(polygon, 1.0e-6_wp, 1.0e-9_wp) == one_change, 'a change inside')
      call checks%that(changes_of(polygon, 1.0e-6_wp) == no_change, 'all is round-off')
   end subroutine check_known_ends

   !> Location of a single change, that of 1/2 - x**3.
   subroutine check_root()
      type(polygon_t) :: polygon

      polygon = value_polygon(1.0_wp, [0.5_wp, 0.0_wp, 0.0_wp], [-0.5_wp, -3.0_wp, -6.0_wp], 0.0_wp)
      call checks%that(changes_of(polygon, 0.0_wp) == one_change, 'one change')
      call checks%close_to(root_of(polygon), 0.5_wp**(1.0_wp/3), 'its place', rtol=1.0e-8_wp)
   end subroutine check_root

end program test_sign_changes
