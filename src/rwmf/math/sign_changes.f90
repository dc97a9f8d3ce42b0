!> Sign changes of a smooth function in a span, from its value and derivatives at both ends.
!>
!> The Hermite polynomial through both ends is written in Bernstein form, with its degree raised by
!> one. A polynomial has at most as many sign changes as its coefficients (Descartes): no change
!> means no root, one change means exactly one root.
!>
!> The interpolation error and all its known derivatives vanish at the ends, so the error affects
!> only the middle coefficients. If one of these lies within that error, the result is undecided and
!> the caller halves the span.
!>
!> All numbers are in the caller's units.
module rwmf_math_sign_changes
   use rwmf_core_kinds, only: wp
   use rwmf_math_roots, only: bracket_between, bracket_t, close_in, keep_inside, narrow, &
      secant_between, secant_t
   implicit none
   private

   public :: polygon_t, value_polygon, rate_polygon, roughness, changes_of, is_positive
   public :: root_of, newton_root_of
   public :: no_change, one_change, change_at_begin, unclear

   integer, parameter :: no_change = 0
   integer, parameter :: one_change = 1
   !! from positive to negative
   integer, parameter :: change_at_begin = 2
   !! the function is negative at the beginning of the span
   integer, parameter :: unclear = 3

   integer, parameter :: highest = 6

   !> Bernstein polygon of a function over a span; the function is positive before the event.
   type :: polygon_t
      integer :: n = 0
      !! degree
      real(wp) :: c(0:highest) = 0
      !! Bernstein coefficients
      real(wp) :: margin(0:highest) = 0
      !! interpolation error of each coefficient
   end type polygon_t

contains

   !> Bernstein coefficients of the quintic through values, rates and second derivatives at both
   !> ends. If no second derivative is known, the cubic through values and rates is used.
   pure subroutine find_points(h, a, b, p)
      real(wp), intent(in) :: h
      !! length of the span
      real(wp), intent(in) :: a(0:), b(0:)
      !! value, rate and second derivative at the ends
      real(wp), intent(out) :: p(0:highest - 1)
      !! those of the cubic are the first four; the others are then 0

      ! one by one and in an array of fixed size, because most steps of yielding storeys come here
      p(0) = a(0)
      if (size(a) == 2) then
         p(1) = a(0) + h*a(1)/3
         p(2) = b(0) - h*b(1)/3
         p(3) = b(0)
         p(4:) = 0
      else
         p(1) = a(0) + h*a(1)/5
         p(2) = a(0) + 2*h*a(1)/5 + h**2*a(2)/20
         p(3) = b(0) - 2*h*b(1)/5 + h**2*b(2)/20
         p(4) = b(0) - h*b(1)/5
         p(5) = b(0)
      end if
   end subroutine find_points

   !> Bernstein coefficients of the rate of the cubic or quintic.
   pure subroutine find_rates(h, a, b, r)
      real(wp), intent(in) :: h
      !! length of the span
      real(wp), intent(in) :: a(0:), b(0:)
      !! value, rate and second derivative at the ends
      real(wp), intent(out) :: r(0:highest - 2)
      !! those of the cubic are the first three; the others are then 0
      real(wp) :: p(0:highest - 1)

      call find_points(h, a, b, p)
      r(0) = a(1)
      if (size(a) == 2) then
         r(1) = 3*(p(2) - p(1))/h
         r(2) = b(1)
         r(3:) = 0
      else
         r(1) = a(1) + h*a(2)/4
         r(2) = 5*(p(3) - p(2))/h
         r(3) = b(1) - h*b(2)/4
         r(4) = b(1)
      end if
   end subroutine find_rates

   !> Bound of the first unknown derivative, times the power of the length over the factorial.
   !>
   !> Each derivative of a motion of frequency w is larger by the factor w. The last known
   !> derivative may vanish where the next one is largest, so the bound includes the one before as
   !> well.
   pure real(wp) function roughness(angle, h, a, b)
      real(wp), intent(in) :: angle
      !! phase of the fastest vibration over the span, at least 1; the integrator's step length
      !! limits the phases of the others [rad]
      real(wp), intent(in) :: h
      !! length of the span
      real(wp), intent(in) :: a(0:), b(0:)
      !! value, rate and second derivative at the ends
      real(wp) :: p(0:highest - 1), first, last
      !! points; differences before the unknown derivative

      call find_points(h, a, b, p)
      if (size(a) == 2) then
         first = p(0) - 2*p(1) + p(2)
         last = p(1) - 2*p(2) + p(3)
      else
         first = p(0) - 4*p(1) + 6*p(2) - 4*p(3) + p(4)
         last = p(1) - 4*p(2) + 6*p(3) - 4*p(4) + p(5)
      end if
      roughness = angle*abs(last - first) + angle**2*max(abs(first), abs(last))
   end function roughness

   !> Polygon of a function, with its interpolation error.
   pure type(polygon_t) function value_polygon(h, a, b, rough) result(polygon)
      real(wp), intent(in) :: h
      !! length of the span
      real(wp), intent(in) :: a(0:), b(0:)
      !! value, rate and second derivative at the ends
      real(wp), intent(in) :: rough
      !! `roughness` of the function, or the largest one among similar functions
      real(wp) :: p(0:highest - 1)
      integer :: k, n

      call find_points(h, a, b, p)
      n = 2*size(a)
      polygon%n = n
      polygon%c(0) = p(0)
      do k = 1, n - 1
         polygon%c(k) = k*(p(k - 1)/n) + (n - k)*(p(k)/n)
      end do
      polygon%c(n) = p(n - 1)
      polygon%margin(n/2) = merge(rough/24, rough/120, n == 4)
   end function value_polygon

   !> Polygon of the rate of a function, with its interpolation error.
   pure type(polygon_t) function rate_polygon(h, a, b, rough) result(polygon)
      real(wp), intent(in) :: h
      !! length of the span
      real(wp), intent(in) :: a(0:), b(0:)
      !! value, rate and second derivative at the ends
      real(wp), intent(in) :: rough
      !! `roughness` of the function, or the largest one among similar functions
      real(wp) :: r(0:highest - 2)
      integer :: k, n

      call find_rates(h, a, b, r)
      n = 2*size(a) - 1
      polygon%n = n
      polygon%c(0) = r(0)
      do k = 1, n - 1
         polygon%c(k) = k*(r(k - 1)/n) + (n - k)*(r(k)/n)
      end do
      polygon%c(n) = r(n - 1)
      polygon%margin(n/2:n/2 + 1) = merge(rough/(6*h), rough/(20*h), n == 3)
   end function rate_polygon

   !> Return whether all Bernstein coefficients of a function, or of its rate, are positive.
   !>
   !> They then exceed interpolation error and round-off, and `changes_of` finds no change. This
   !> holds in most spans and takes a fraction of the time, because the degree stays.
   pure logical function is_positive(h, a, b, rough, noise, order)
      real(wp), intent(in) :: h
      !! length of the span
      real(wp), intent(in) :: a(0:), b(0:)
      !! value, rate and second derivative at the ends
      real(wp), intent(in) :: rough
      !! as in `value_polygon`
      real(wp), intent(in) :: noise
      !! round-off of the function, or of its rate
      integer, intent(in) :: order
      !! 0 for the function, 1 for its rate
      real(wp) :: c(0:highest - 1)

      if (order == 0) then
         call find_points(h, a, b, c)
         is_positive = minval(c(:2*size(a) - 1)) > max(merge(rough/24, rough/120, size(a) == 2), &
            noise)
      else
         call find_rates(h, a, b, c)
         is_positive = minval(c(:2*size(a) - 2)) > max(merge(rough/(6*h), rough/(20*h), &
            size(a) == 2), noise)
      end if
   end function is_positive

   !> Sign changes of the function of a polygon, as one of the constants above.
   !>
   !> Coefficients within round-off have no sign; those within their margin may have either sign.
   pure integer function changes_of(polygon, noise, noise_at_ends) result(changes)
      type(polygon_t), intent(in) :: polygon
      real(wp), intent(in) :: noise
      !! round-off of the coefficients
      real(wp), intent(in), optional :: noise_at_ends
      !! round-off of the first and the last one, which are values of the function; default: noise
      integer :: fewest, most, sign_now, k, open
      !! numbers of changes; last sign found; number of undecided coefficients since
      real(wp) :: at_ends, least
      !! the default or `noise_at_ends`; smallest coefficient with a sign
      logical :: begins_open

      fewest = 0
      most = 0
      sign_now = 0
      open = 0
      begins_open = .false.
      at_ends = noise
      if (present(noise_at_ends)) at_ends = noise_at_ends
      do k = 0, polygon%n
         least = merge(at_ends, noise, k == 0 .or. k == polygon%n)
         associate (c => polygon%c(k), margin => polygon%margin(k))
            if (abs(c) <= max(margin, least)) then
               if (margin > least) open = open + 1
               cycle
            end if
            if (sign_now == 0) begins_open = open > 0
            if (sign_now == 0 .and. open == 0 .and. c < 0) then
               changes = change_at_begin
               return
            end if
            call count_changes(merge(1, -1, c > 0), open, sign_now, fewest, most)
            open = 0
         end associate
      end do
      changes = unclear
      if (begins_open .or. open > 0) return
      if (most == 0) changes = no_change
      ! The root of a function that begins at zero has no bracket.
      if (fewest == 1 .and. most == 1) then
         if (polygon%c(0) > at_ends .and. polygon%c(polygon%n) < -at_ends) changes = one_change
      end if
   end function changes_of

   !> Count the changes up to the next coefficient with a sign.
   pure subroutine count_changes(sign_next, open, sign_now, fewest, most)
      integer, intent(in) :: sign_next
      integer, intent(in) :: open
      !! number of coefficients between them that may have either sign
      integer, intent(inout) :: sign_now
      !! sign of the last coefficient with a sign, 0 for none
      integer, intent(inout) :: fewest, most
      integer :: change

      change = merge(1, 0, sign_now*sign_next < 0)
      fewest = fewest + change
      ! The signs at both ends determine whether the number is odd or even.
      most = most + change + 2*((open + 1 - change)/2)
      sign_now = sign_next
   end subroutine count_changes

   !> Approximate position of the root of a polygon with one change, from 0 to 1.
   pure real(wp) function root_of(polygon) result(x)
      type(polygon_t), intent(in) :: polygon
      real(wp), parameter :: resolution = 1.0e-9_wp
      type(secant_t) :: secant
      real(wp) :: value, slope

      secant = secant_between([0.0_wp, 1.0_wp], [polygon%c(0), polygon%c(polygon%n)], resolution)
      do while (secant%is_open)
         call evaluate_polygon(polygon, secant%next, value, slope)
         call close_in(secant, value)
      end do
      x = secant%x(1) + (secant%x(2) - secant%x(1))/2
   end function root_of

   !> Approximate position of the last root of a polygon that ends below zero, from 0 to 1, in fewer
   !> points than `root_of`. The polygon may begin at zero.
   pure real(wp) function newton_root_of(polygon) result(x)
      type(polygon_t), intent(in) :: polygon
      real(wp), parameter :: resolution = 1.0e-10_wp
      integer, parameter :: most = 60
      type(bracket_t) :: bracket
      real(wp) :: value, slope, step
      integer :: i

      bracket = bracket_between(0.0_wp, 1.0_wp)
      x = keep_inside(bracket, polygon%c(0)/(polygon%c(0) - polygon%c(polygon%n)))
      do i = 1, most
         call evaluate_polygon(polygon, x, value, slope)
         call narrow(bracket, value <= 0, x)
         if (.not. bracket%is_open) return
         step = bracket%high
         if (slope < 0) step = -value/slope
         x = x + step
         if (abs(step) <= resolution) return
         x = keep_inside(bracket, x)
      end do
   end function newton_root_of

   !> Evaluate a polynomial by de Casteljau's scheme.
   pure subroutine evaluate_polygon(polygon, x, value, slope)
      type(polygon_t), intent(in) :: polygon
      real(wp), intent(in) :: x
      !! position in the span, from 0 to 1
      real(wp), intent(out) :: value
      real(wp), intent(out) :: slope
      !! derivative by the position
      real(wp) :: c(0:highest)
      integer :: i, k

      c = polygon%c
      do k = polygon%n, 2, -1
         do i = 0, k - 1
            c(i) = c(i) + x*(c(i + 1) - c(i))
         end do
      end do
      value = c(0) + x*(c(1) - c(0))
      slope = polygon%n*(c(1) - c(0))
   end subroutine evaluate_polygon

end module rwmf_math_sign_changes
