!> Range checks of the numbers that a host passes.
!>
!> Numbers must be finite and of a plausible size, some of them also not negative. Times must leave
!> enough digits for a step. An earlier `error` is kept, so a call checks its numbers in sequence
!> and reports the first failure.
module rwmf_embedding_ranges
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use rwmf_core_error, only: err_input, error_t, fail
   use rwmf_core_kinds, only: wp
   use rwmf_text_strings, only: real_to_text
   implicit none
   private

   public :: any_number, not_negative, positive, a_time, is_number, is_time
   public :: require_number, require_numbers

   integer, parameter :: any_number = 0
   integer, parameter :: not_negative = 1
   integer, parameter :: positive = 2
   integer, parameter :: a_time = 3

   real(wp), parameter :: largest = 1.0e30_wp
   !! exceeds any length or force of a structure; its powers do not overflow
   real(wp), parameter :: latest = 1.0e10_wp
   !! three hundred years; adjacent numbers differ by two microseconds there [s]

contains

   !> True if a number is finite and of a plausible size.
   elemental logical function is_number(x)
      real(wp), intent(in) :: x
      !! number in any unit

      is_number = ieee_is_finite(x)
      if (is_number) is_number = abs(x) <= largest
   end function is_number

   !> True if a number is a valid time.
   elemental logical function is_time(t)
      real(wp), intent(in) :: t
      !! [s]

      is_time = is_number(t)
      if (is_time) is_time = abs(t) <= latest
   end function is_time

   !> Check a number against a range. Fails with `err_input`.
   pure subroutine require_number(x, name, range, error)
      real(wp), intent(in) :: x
      !! [any]
      character(*), intent(in) :: name
      !! name of the number, for the message
      integer, intent(in) :: range
      !! `any_number`, `not_negative`, `positive` or `a_time`
      type(error_t), allocatable, intent(inout) :: error

      if (allocated(error)) return
      if (.not. is_number(x)) then
         call fail(error, err_input, name//' = '//trim(real_to_text(x)) &
            //' is not a finite number of at most '//trim(real_to_text(largest))//' in size')
      else if (range == a_time .and. .not. is_time(x)) then
         call fail(error, err_input, name//' = '//trim(real_to_text(x)) &
            //' s, allowed are times of at most '//trim(real_to_text(latest))//' s in size')
      else if (range == not_negative .and. x < 0) then
         call fail(error, err_input, name//' = '//trim(real_to_text(x)) &
            //', allowed are values >= 0')
      else if (range == positive .and. .not. x > 0) then
         call fail(error, err_input, name//' = '//trim(real_to_text(x))//', allowed are values > 0')
      end if
   end subroutine require_number

   !> Check that several numbers are finite and of a plausible size.
   pure subroutine require_numbers(x, names, error)
      real(wp), intent(in) :: x(:)
      !! [any]
      character(*), intent(in) :: names(:)
      !! names of the numbers, padded with blanks
      type(error_t), allocatable, intent(inout) :: error
      !! `err_input` for the first one that is not
      integer :: i

      do i = 1, size(x)
         if (is_number(x(i))) cycle
         call require_number(x(i), trim(names(i)), any_number, error)
      end do
   end subroutine require_numbers

end module rwmf_embedding_ranges
