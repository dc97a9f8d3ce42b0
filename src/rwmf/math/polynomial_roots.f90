!> First root and largest value of a polynomial in a span, with a proof.
!>
!> The Bernstein coefficients of a polynomial bound it. Their sign changes bound the number of its
!> roots (Descartes): none means no root, one means exactly one. Other spans are halved, from the
!> left. Powers of the position that vanish at the start are the caller's to divide out, so that a
!> known root there is never found again.
!>
!> All numbers are in the caller's units.
module rwmf_math_polynomial_roots
   use rwmf_core_kinds, only: wp
   use rwmf_math_roots, only: bracket_between, bracket_t, keep_inside, narrow
   implicit none
   private

   public :: first_negative, find_largest, evaluate, highest_degree

   integer, parameter :: most_halves = 48
   !! largest number of spans that wait for their turn
   integer, parameter :: highest_degree = 16

   !> Spans of a polynomial that remain to be examined, the leftmost on top.
   type :: spans_t
      integer :: n = 0
      !! degree
      integer :: count = 0
      real(wp) :: low(most_halves)
      !! begin of each span, as a part of the whole
      real(wp) :: width(most_halves)
      !! width of each span, as a part of the whole
      real(wp) :: b(0:highest_degree, most_halves)
      !! (coefficients, spans) Bernstein coefficients in each span
   end type spans_t

contains

   !> First position in [0, x_end] behind which a polynomial is negative; the largest number without
   !> one.
   !>
   !> A minimum within round-off of zero may count as a root or not.
   pure real(wp) function first_negative(c, x_end) result(x)
      real(wp), intent(in) :: c(0:)
      !! (degree) coefficients by rising powers
      real(wp), intent(in) :: x_end
      !! end of the span, positive
      real(wp), parameter :: narrowest = 1.0e-13_wp
      !! width of a span, as a part of the whole, in which several roots are a graze [-]
      type(spans_t) :: spans
      real(wp) :: a, e
      integer :: changes

      x = huge(x)
      if (c(0) < 0) then
         x = 0
         return
      end if
      call begin_spans(c, x_end, spans)
      do while (spans%count > 0)
         associate (b => spans%b(0:spans%n, spans%count))
            changes = sign_changes_of(b)
            if (changes == 0) then
               spans%count = spans%count - 1
               cycle
            end if
            a = spans%low(spans%count)*x_end
            e = a + spans%width(spans%count)*x_end
            if (changes == 1) then
               x = root_between(c, a, e, a + (e - a)*(b(1)/(b(1) - b(size(b)))))
               return
            end if
         end associate
         if (spans%width(spans%count) < narrowest .or. spans%count == most_halves) then
            x = a
            return
         end if
         call halve(spans)
      end do
   end function first_negative

   !> Find the largest value of a polynomial in [0, x_end], and its first place.
   pure subroutine find_largest(c, x_end, largest, place)
      real(wp), intent(in) :: c(0:)
      !! (degree) coefficients by rising powers
      real(wp), intent(in) :: x_end
      !! end of the span, positive
      real(wp), intent(out) :: largest
      real(wp), intent(out) :: place
      real(wp), parameter :: narrowest = 1.0e-7_wp
      !! width of a span, as a part of the whole, in which the polynomial is flat [-]
      type(spans_t) :: spans
      real(wp) :: slopes(0:size(c) - 2), rise(highest_degree), a, e, x, value, slope
      integer :: k

      largest = c(0)
      place = 0
      slopes = [(k*c(k), k=1, size(c) - 1)]
      call begin_spans(c, x_end, spans)
      do while (spans%count > 0)
         associate (b => spans%b(0:spans%n, spans%count), n => spans%n)
            a = spans%low(spans%count)*x_end
            e = a + spans%width(spans%count)*x_end
            call keep_larger(b(1), a, largest, place)
            call keep_larger(b(n + 1), e, largest, place)
            if (maxval(b) <= largest .or. spans%width(spans%count) < narrowest) then
               spans%count = spans%count - 1
               cycle
            end if
            rise(1:n) = b(2:) - b(:n)
            if (sign_changes_of(rise(:n)) == 1 .and. rise(1) > 0 .and. rise(n) < 0) then
               x = root_between(slopes, a, e, a + (e - a)*(rise(1)/(rise(1) - rise(n))))
               call evaluate(c, x, value, slope)
               call keep_larger(value, x, largest, place)
               spans%count = spans%count - 1
               cycle
            end if
         end associate
         if (spans%count == most_halves) return
         call halve(spans)
      end do
   end subroutine find_largest

   !> Keep a value and its place if it is larger.
   pure subroutine keep_larger(value, x, largest, place)
      real(wp), intent(in) :: value
      real(wp), intent(in) :: x
      real(wp), intent(inout) :: largest
      real(wp), intent(inout) :: place

      if (.not. value > largest) return
      largest = value
      place = x
   end subroutine keep_larger

   !> Number of sign changes in a sequence that begins as if it were positive. Zeros have no sign.
   pure integer function sign_changes_of(b) result(changes)
      real(wp), intent(in) :: b(:)
      real(wp) :: last
      integer :: k

      changes = 0
      last = 1
      do k = 1, size(b)
         if (b(k)*sign(1.0_wp, last) < 0) then
            changes = changes + 1
            last = b(k)
         end if
      end do
   end function sign_changes_of

   !> Root of a polynomial that is positive at one end of a bracket and negative at the other, by
   !> Newton's method.
   pure real(wp) function root_between(c, a, e, guess) result(x)
      real(wp), intent(in) :: c(0:)
      real(wp), intent(in) :: a, e
      real(wp), intent(in) :: guess
      integer, parameter :: most = 80
      type(bracket_t) :: bracket
      real(wp) :: value, slope, step
      integer :: i

      bracket = bracket_between(a, e)
      x = keep_inside(bracket, guess)
      do i = 1, most
         call evaluate(c, x, value, slope)
         call narrow(bracket, value < 0, x)
         if (.not. bracket%is_open) return
         step = e
         if (slope < 0) step = -value/slope
         if (abs(step) <= 4*epsilon(x)*x) return
         x = keep_inside(bracket, x + step)
      end do
   end function root_between

   !> Evaluate a polynomial and its derivative.
   pure subroutine evaluate(c, x, value, slope)
      real(wp), intent(in) :: c(0:)
      !! (degree) coefficients by rising powers
      real(wp), intent(in) :: x
      real(wp), intent(out) :: value
      real(wp), intent(out) :: slope
      integer :: k

      value = c(size(c) - 1)
      slope = 0
      do k = size(c) - 2, 0, -1
         slope = slope*x + value
         value = value*x + c(k)
      end do
   end subroutine evaluate

   !> Begin with the whole span.
   pure subroutine begin_spans(c, x_end, spans)
      real(wp), intent(in) :: c(0:)
      real(wp), intent(in) :: x_end
      type(spans_t), intent(out) :: spans
      real(wp) :: power, binomial
      integer :: k, m, n

      n = size(c) - 1
      spans%n = n
      spans%count = 1
      spans%low(1) = 0
      spans%width(1) = 1
      power = 1
      binomial = 1
      do k = 0, n
         spans%b(k, 1) = c(k)*power/binomial
         power = power*x_end
         binomial = binomial*(n - k)/(k + 1)
      end do
      do m = 1, n
         do k = n, m, -1
            spans%b(k, 1) = spans%b(k, 1) + spans%b(k - 1, 1)
         end do
      end do
   end subroutine begin_spans

   !> Halve the span on top; its left half is the next one (de Casteljau).
   pure subroutine halve(spans)
      type(spans_t), intent(inout) :: spans
      integer :: k, m

      associate (n => spans%n, top => spans%count)
         spans%width(top) = 0.5_wp*spans%width(top)
         spans%width(top + 1) = spans%width(top)
         spans%low(top + 1) = spans%low(top)
         spans%low(top) = spans%low(top) + spans%width(top)
         do m = 0, n
            spans%b(m, top + 1) = spans%b(0, top)
            do k = 0, n - m - 1
               spans%b(k, top) = 0.5_wp*(spans%b(k, top) + spans%b(k + 1, top))
            end do
         end do
         top = top + 1
      end associate
   end subroutine halve

end module rwmf_math_polynomial_roots
