!> Shortest digits of a double precision number, and decimals instead of their rounding errors.
module rwmf_text_decimal
   use, intrinsic :: iso_fortran_env, only: real128
   use rwmf_core_kinds, only: dp, i8, wp
   implicit none
   private

   public :: shortest_digits, short_decimal, digit_count

   integer, parameter :: digit_count = 17
   !! number of digits that distinguish every double precision number from its neighbours
   integer, parameter :: most_exponent = 290
   !! largest magnitude of the decimal exponent that this module handles

contains

   !> Find the decimal with the fewest digits, at least 15, that reads back as the same number.
   !>
   !> A number of digits suffices if the nearest decimal lies within half the gap to the
   !> neighbouring numbers. The product is not accurate enough close to a tie, or for powers of two,
   !> whose two gaps differ.
   pure subroutine shortest_digits(x, digits, exponent, is_decided)
      real(dp), intent(in) :: x
      !! > 0, finite, of any unit [-]
      integer(i8), intent(out) :: digits
      !! 10**16 <= digits < 10**17; trailing zeros replace the digits that are not needed
      integer, intent(out) :: exponent
      !! x = digits*10**(exponent - 16) to the accuracy of double precision
      logical, intent(out) :: is_decided
      !! .false. if the caller has to find the digits by another method
      real(dp), parameter :: tie = 1.0e-9_dp
      integer(i8), parameter :: lowest = 10_i8**(digit_count - 1)
      integer :: i
      real(real128), parameter :: ten_to(-300:310) = [(10.0_real128**i, i=-300, 310)]
      real(real128) :: scaled
      real(dp) :: half_gap, rest
      integer(i8) :: unit, whole

      digits = 0
      exponent = floor(log10(x))
      is_decided = abs(exponent) <= most_exponent .and. fraction(x) > 0.5_dp
      if (.not. is_decided) return
      scaled = x*ten_to(digit_count - 1 - exponent)
      ! correct the rounding of log10
      if (scaled < lowest) exponent = exponent - 1
      if (scaled >= 10*lowest) exponent = exponent + 1
      scaled = x*ten_to(digit_count - 1 - exponent)
      whole = int(scaled, i8)
      half_gap = real(ten_to(digit_count - 1 - exponent), dp)*spacing(x)/2
      unit = 100
      do
         digits = whole - mod(whole, unit)
         rest = real(whole - digits, dp) + real(scaled - whole, dp)
         is_decided = abs(2*rest - unit) > tie
         if (2*rest > unit) then
            digits = digits + unit
            rest = unit - rest
         end if
         is_decided = is_decided .and. abs(rest - half_gap) > tie
         if (.not. is_decided .or. rest < half_gap .or. unit == 1) exit
         unit = unit/10
      end do
      if (digits < 10*lowest) return
      digits = lowest
      exponent = exponent + 1
   end subroutine shortest_digits

   !> The decimal of at most twelve digits that lies within rounding errors of x, otherwise x.
   !>
   !> Labels such as 3*0.1 then equal the number that a user writes.
   elemental real(wp) function short_decimal(x) result(found)
      real(wp), intent(in) :: x
      !! of any unit [-]
      integer, parameter :: digits = 12
      real(wp) :: power

      found = x
      ! beyond these the power of ten is not exact
      if (abs(x) < 1.0e-10_wp .or. abs(x) >= 1.0e11_wp) return
      power = 10.0_wp**(digits - 1 - floor(log10(abs(x))))
      found = anint(x*power, wp)/power
      if (abs(found - x) > 4*spacing(x)) found = x
   end function short_decimal

end module rwmf_text_decimal
