!> Numbers that a host hands over: finite, of a size that structures have, not negative where
!> negative means nothing; times with digits left for a step.
!>
!> `error` enters with what was refused before and stays that, so that all numbers of a call are
!> checked one after the other.
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
   !! beyond any metre or newton of a structure, and its powers do not overflow
   real(wp), parameter :: latest = 1.0e10_wp
   !! three hundred years, where neighbouring numbers are two microseconds apart [s]

contains

   !> Is it a finite number of a possible size?
   elemental logical function is_number(x)
      real(wp), intent(in) :: x
      !! of any unit that a host hands over

      is_number = ieee_is_finite(x)
      if (is_number) is_number = abs(x) <= largest
   end function is_number

   !> Is it a time that a motion can stand at?
   elemental logical function is_time(t)
      real(wp), intent(in) :: t
      !! [s]

      is_time = is_number(t)
      if (is_time) is_time = abs(t) <= latest
   end function is_time

   !> Is a number acceptable? Fails with `err_input`.
   pure subroutine require_number(x, name, range, error)
      real(wp), intent(in) :: x
      !! [any]
      character(*), intent(in) :: name
      !! of the number, for the message
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

   !> Are several numbers numbers at all?
   pure subroutine require_numbers(x, names, error)
      real(wp), intent(in) :: x(:)
      !! [any]
      character(*), intent(in) :: names(:)
      !! of the numbers, with blanks behind
      type(error_t), allocatable, intent(inout) :: error
      !! `err_input` for one that is none
      integer :: i

      do i = 1, size(x)
         if (is_number(x(i))) cycle
         call require_number(x(i), trim(names(i)), any_number, error)
      end do
   end subroutine require_numbers

end module rwmf_embedding_ranges
