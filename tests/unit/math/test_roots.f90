!> Searches of `rwmf_math_roots` against closed forms, at their ends and at round-off.
program test_roots
   use check, only: checks_t
   use rwmf_core_kinds, only: pi, wp
   use rwmf_math_roots, only: bracket_between, bracket_t, climb, close_in, is_wider, keep_inside, &
      maximum_between, maximum_t, narrow, secant_between, secant_t, stationary_point, &
      vertex_of_parabola
   implicit none

   real(wp), parameter :: root_2 = sqrt(2.0_wp)
   type(checks_t) :: checks

   if (checks%wants('bisection')) call check_bisection()
   if (checks%wants('bisection_at_ends')) call check_bisection_at_ends()
   if (checks%wants('spacings')) call check_spacings()
   if (checks%wants('newton')) call check_newton()
   if (checks%wants('secant')) call check_secant()
   if (checks%wants('secant_resolution')) call check_secant_resolution()
   if (checks%wants('maximum')) call check_maximum()
   if (checks%wants('near_maximum')) call check_near_maximum()
   if (checks%wants('maximum_at_ends')) call check_maximum_at_ends()
   if (checks%wants('stationary_points')) call check_stationary_points()
   call checks%finish()

contains

   !> Solve x**2 = 2 in a bracket and count the function values.
   subroutine bisect(bracket, count)
      type(bracket_t), intent(inout) :: bracket
      integer, intent(out) :: count

      count = 0
      do while (bracket%is_open)
         call narrow(bracket, bracket%middle**2 >= 2)
         count = count + 1
      end do
   end subroutine bisect

   !> Bisection ends with neighbouring numbers, for any initial bracket.
   subroutine check_bisection()
      type(bracket_t) :: bracket
      integer :: count

      bracket = bracket_between(1.0_wp, 2.0_wp)
      call bisect(bracket, count)
      call checks%that(bracket%high <= nearest(bracket%low, 1.0_wp), 'the ends are neighbours')
      call checks%that(bracket%low**2 < 2 .and. bracket%high**2 >= 2, 'the root is between them')
      call checks%close_to(bracket%high, root_2, 'bisection', rtol=epsilon(root_2))
      call checks%that(count == digits(root_2) - 1, 'one value a bit')
      bracket = bracket_between(0.3_wp, 1.0e9_wp)
      call bisect(bracket, count)
      call checks%that(bracket%high <= nearest(bracket%low, 1.0_wp), 'neighbours from far apart')
      call checks%close_to(bracket%high, root_2, 'bisection from far apart', rtol=epsilon(root_2))
   end subroutine check_bisection

   !> Functions beyond the level everywhere or nowhere, brackets of zero length, a root at zero.
   subroutine check_bisection_at_ends()
      type(bracket_t) :: bracket

      bracket = bracket_between(1.0_wp, 2.0_wp)
      do while (bracket%is_open)
         call narrow(bracket, .true.)
      end do
      call checks%that(bracket%high <= nearest(1.0_wp, 2.0_wp), 'beyond everywhere')
      bracket = bracket_between(1.0_wp, 2.0_wp)
      do while (bracket%is_open)
         call narrow(bracket, .false.)
      end do
      call checks%that(bracket%low >= nearest(2.0_wp, -1.0_wp), 'beyond nowhere')
      bracket = bracket_between(1.0_wp, 1.0_wp)
      call checks%that(.not. (bracket%is_open .or. is_wider(bracket, 0)), 'equal ends')
      bracket = bracket_between(1.0_wp, nearest(1.0_wp, 2.0_wp))
      call checks%that(.not. bracket%is_open, 'neighbouring ends')
      bracket = bracket_between(2.0_wp, 1.0_wp)
      call checks%that(.not. bracket%is_open, 'ends the wrong way round')
      bracket = bracket_between(-1.0_wp, 3.0_wp)
      do while (bracket%is_open)
         call narrow(bracket, bracket%middle >= 0)
      end do
      call checks%that(abs(bracket%high) <= 0 .and. bracket%low > -tiny(1.0_wp), 'a root at zero')
      bracket = bracket_between(-huge(1.0_wp)/2, huge(1.0_wp)/2)
      do while (bracket%is_open)
         call narrow(bracket, bracket%middle >= -3)
      end do
      call checks%close_to(bracket%high, -3.0_wp, 'from the largest numbers', &
         rtol=4*epsilon(1.0_wp))
   end subroutine check_bisection_at_ends

   !> A search can stop at a bracket of n spacings.
   subroutine check_spacings()
      type(bracket_t) :: bracket
      integer :: n

      do n = 1, 4
         bracket = bracket_between(1.0_wp, 2.0_wp)
         do while (is_wider(bracket, n))
            call narrow(bracket, bracket%middle**2 >= 2)
         end do
         call checks%that(bracket%high - bracket%low <= n*spacing(bracket%high), 'close enough')
         call checks%that(2*(bracket%high - bracket%low) > n*spacing(bracket%high), 'no closer')
         call checks%that(bracket%low**2 < 2 .and. bracket%high**2 >= 2, 'and the root inside')
      end do
   end subroutine check_spacings

   !> Newton's method for atan(x - 1) = 0 diverges from afar; with a bracket it converges.
   subroutine check_newton()
      type(bracket_t) :: bracket
      real(wp) :: x
      real(wp) :: step
      integer :: i

      bracket = bracket_between(-1000.0_wp, 5000.0_wp)
      x = 4000
      do i = 1, 100
         call narrow(bracket, x > 1, x)
         step = -atan(x - 1)*(1 + (x - 1)**2)
         if (abs(step) <= epsilon(x)) exit
         x = keep_inside(bracket, x + step)
      end do
      call checks%close_to(x, 1.0_wp, 'Newton in a bracket', rtol=2*epsilon(x))
      call checks%that(i < 30, 'in few steps')
      call checks%that(bracket%low <= 1 .and. bracket%high >= 1, 'the root stays inside')
      bracket = bracket_between(2.0_wp, 4.0_wp)
      call checks%close_to(keep_inside(bracket, 2.5_wp), 2.5_wp, 'inside')
      call checks%close_to(keep_inside(bracket, 5.0_wp), 3.0_wp, 'outside: the middle')
      call checks%close_to(keep_inside(bracket, huge(x)), 3.0_wp, 'far outside')
      call checks%close_to(keep_inside(bracket, 2.0_wp), 3.0_wp, 'an end is not inside')
      call checks%close_to(keep_inside(bracket, 2.0_wp, may_be_end=.true.), 2.0_wp, 'unless told')
      call checks%close_to(keep_inside(bracket, 4.1_wp, may_be_end=.true.), 3.0_wp, 'beyond it')
      call narrow(bracket, .true., 2.5_wp)
      call checks%close_to(bracket%middle, 2.25_wp, 'the middle of what is left')
   end subroutine check_newton

   !> Number of function values that the Illinois method needs for the root of x**n = a.
   integer function illinois(n, a, low, high, x) result(count)
      integer, intent(in) :: n
      real(wp), intent(in) :: a
      real(wp), intent(in) :: low
      real(wp), intent(in) :: high
      real(wp), intent(out) :: x
      type(secant_t) :: secant

      secant = secant_between([low, high], [low, high]**n - a)
      count = 0
      do while (secant%is_open)
         call close_in(secant, secant%next**n - a)
         count = count + 1
      end do
      x = secant%x(2)
      call checks%that(secant%x(2) - secant%x(1) <= 2*spacing(x), 'both ends close in')
   end function illinois

   subroutine check_secant()
      type(secant_t) :: secant
      real(wp) :: x

      call checks%that(illinois(2, 2.0_wp, 0.0_wp, 2.0_wp, x) < 20, 'regula falsi: a square root')
      call checks%close_to(x, root_2, 'its value', rtol=2*epsilon(x))
      call checks%that(illinois(1, 0.7_wp, 0.0_wp, 2.0_wp, x) <= 60, 'a straight line')
      call checks%close_to(x, 0.7_wp, 'where it is zero', rtol=2*epsilon(x))
      call checks%that(illinois(9, 1.0e-9_wp, 0.0_wp, 10.0_wp, x) < 200, 'a flat foot')
      call checks%close_to(x, 0.1_wp, 'and its root', rtol=8*epsilon(x))
      secant = secant_between([1.0_wp, 1.0_wp], [-1.0_wp, 1.0_wp])
      call checks%that(.not. secant%is_open, 'equal ends')
      secant = secant_between([0.0_wp, 1.0_wp], [0.0_wp, 0.0_wp])
      call checks%close_to(secant%next, 0.5_wp, 'no secant: the middle')
      secant = secant_between([0.0_wp, 1.0_wp], [3.0_wp, -1.0_wp])
      call checks%close_to(secant%next, 0.75_wp, 'a falling line')
   end subroutine check_secant

   subroutine check_secant_resolution()
      type(secant_t) :: secant
      real(wp), parameter :: wide = 1.0e-3_wp
      integer :: i

      secant = secant_between([0.0_wp, 2.0_wp], [-2.0_wp, 2.0_wp], resolution=wide)
      do i = 1, 20
         if (.not. secant%is_open) exit
         call checks%that(secant%next - secant%x(1) >= wide/2*(1 - 1.0e-9_wp) &
            .and. secant%x(2) - secant%next >= wide/2*(1 - 1.0e-9_wp), 'away from the ends')
         call close_in(secant, secant%next**2 - 2)
      end do
      call checks%that(i < 12, 'resolved soon')
      call checks%that(secant%x(2) - secant%x(1) <= wide, 'as wide as the resolution')
      call checks%that(secant%x(1) <= root_2 .and. secant%x(2) >= root_2, 'about the root')
   end subroutine check_secant_resolution

   !> The location of a maximum is accurate to sqrt(epsilon), because the function is flat there.
   subroutine check_maximum()
      type(maximum_t) :: search
      integer :: count

      search = maximum_between(0.0_wp, 3.0_wp, 1.0_wp)
      count = 0
      do while (search%is_open)
         call climb(search, sin(search%next))
         count = count + 1
      end do
      call checks%close_to(search%x(1), pi/2, 'the maximum of a sine', &
         atol=8*3*sqrt(epsilon(1.0_wp)))
      call checks%close_to(sin(search%x(1)), 1.0_wp, 'its value', rtol=512*epsilon(1.0_wp))
      call checks%that(count < 25, 'by parabolas')
      search = maximum_between(-1.0_wp, 2.0_wp, 1.5_wp)
      do while (search%is_open)
         call climb(search, -abs(search%next - 0.3_wp))
      end do
      call checks%close_to(search%x(1), 0.3_wp, 'a corner', atol=8*3*sqrt(epsilon(1.0_wp)))
   end subroutine check_maximum

   !> Near a maximum a parabola gives its value in a few points. Far from it, or without a parabola,
   !> the search continues until the bracket is closed.
   subroutine check_near_maximum()
      real(wp), parameter :: start(4) = pi/2 + [1.0e-3_wp, -0.02_wp, 0.2_wp, -1.5_wp]
      type(maximum_t) :: search
      integer :: count, i

      do i = 1, size(start)
         search = maximum_between(0.0_wp, 3.0_wp, start(i), is_near=.true.)
         count = 0
         do while (search%is_open)
            call climb(search, sin(search%next))
            count = count + 1
         end do
         call checks%close_to(sin(search%x(1)), 1.0_wp, 'value from near', rtol=8*epsilon(1.0_wp))
         if (i <= 2) call checks%that(count <= 6, 'in a few points')
      end do
      search = maximum_between(-1.0_wp, 2.0_wp, 0.31_wp, is_near=.true.)
      do while (search%is_open)
         call climb(search, -abs(search%next - 0.3_wp))
      end do
      call checks%close_to(search%x(1), 0.3_wp, 'a corner', atol=8*3*sqrt(epsilon(1.0_wp)))
      search = maximum_between(0.0_wp, 1.0_wp, 0.5_wp, is_near=.true.)
      do while (search%is_open)
         call climb(search, search%next)
      end do
      call checks%close_to(search%x(1), 1.0_wp, 'a function that grows', &
         atol=8*sqrt(epsilon(1.0_wp)))
   end subroutine check_near_maximum

   subroutine check_maximum_at_ends()
      type(maximum_t) :: search
      integer :: count

      search = maximum_between(0.0_wp, 1.0_wp, 0.5_wp)
      do while (search%is_open)
         call climb(search, search%next)
      end do
      call checks%close_to(search%x(1), 1.0_wp, 'a function that grows', &
         atol=8*sqrt(epsilon(1.0_wp)))
      search = maximum_between(0.0_wp, 1.0_wp, 0.5_wp)
      count = 0
      do while (search%is_open)
         call climb(search, 1.0_wp)
         count = count + 1
      end do
      call checks%that(search%x(1) >= 0 .and. search%x(1) <= 1, 'a constant')
      call checks%that(count <= 60, 'in as many steps as are allowed')
      search = maximum_between(0.0_wp, 1.0_wp, 0.5_wp)
      call climb(search, 0.0_wp)
      call climb(search, huge(1.0_wp))
      call checks%that(.not. search%is_open, 'nothing is above huge')
      call checks%that(abs(search%x(1) - 0.5_wp) > 0, 'it is the best')
   end subroutine check_maximum_at_ends

   !> Closed forms for a parabola and a cubic.
   subroutine check_stationary_points()
      real(wp), parameter :: x(3) = [0.0_wp, 1.0_wp, 4.0_wp]

      call checks%close_to(vertex_of_parabola(x, 5 - (x - 1.7_wp)**2), 1.7_wp, &
         'vertex of a parabola', rtol=8*epsilon(1.0_wp))
      call checks%that(vertex_of_parabola(x, x) >= huge(1.0_wp), 'a straight line has none')
      ! (x - 1/4)*(x - 5/4)*c: the integral's slopes
      call checks%close_to(stationary_point(0.0_wp, 5.0_wp/16, 1.0_wp/3 - 3.0_wp/4 + 5.0_wp/16, &
         -3.0_wp/16), 0.25_wp, 'extremum of a cubic', rtol=8*epsilon(1.0_wp))
      call checks%close_to(stationary_point(1.0_wp, -1.0_wp, 1.0_wp, 1.0_wp), 0.5_wp, &
         'of a parabola', rtol=epsilon(1.0_wp))
   end subroutine check_stationary_points

end program test_roots
