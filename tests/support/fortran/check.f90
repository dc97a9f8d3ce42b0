!> Checks of one test program.
!>
!> A test program holds one `type(checks_t)` and calls `checks%wants(NAME)` before each group of
!> checks. It calls the procedures below with a name for each check and ends with `checks%finish()`.
!> This prints 'N passed, N failed' and stops with a non-zero status if a check failed or if there
!> was none.
!>
!>    test_roots                   all groups
!>    test_roots secant newton     those with one of these words in their names
!>    test_roots --list            the names
module check
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: wp
   implicit none
   private

   public :: checks_t

   type :: checks_t
      integer :: passed = 0
      integer :: failed = 0
      character(:), allocatable, private :: listed
      !! names that `--list` has printed, each between bars
   contains
      procedure :: wants
      procedure :: that
      procedure :: close_to
      procedure :: no_error
      procedure :: has_error
      procedure :: finish
   end type checks_t

contains

   !> Return whether a group of checks is to run. Without arguments every group runs, otherwise
   !> those that the words of the command line select. With `--list` none runs; the name is printed.
   logical function wants(self, name)
      class(checks_t), intent(inout) :: self
      character(*), intent(in) :: name
      !! of the group

      character(80) :: word
      integer :: i

      wants = command_argument_count() == 0
      do i = 1, command_argument_count()
         call get_command_argument(i, word)
         if (word == '--list' .and. .not. allocated(self%listed)) self%listed = '|'
         wants = wants .or. index(name, trim(word)) > 0
      end do
      if (.not. allocated(self%listed)) return
      if (index(self%listed, '|'//name//'|') == 0) then
         print '(a)', name
         self%listed = self%listed//name//'|'
      end if
   end function wants

   !> Count a condition and report its name if it is false.
   subroutine that(self, condition, name, detail)
      class(checks_t), intent(inout) :: self
      logical, intent(in) :: condition
      character(*), intent(in) :: name
      !! description of the check
      character(*), intent(in), optional :: detail
      !! the result found instead

      if (condition) then
         self%passed = self%passed + 1
         return
      end if
      self%failed = self%failed + 1
      print '(2a)', 'FAILED: ', name
      if (present(detail)) print '(2a)', '   ', detail
   end subroutine that

   !> Check abs(actual - expected) <= rtol*abs(expected) + atol; a NaN fails.
   subroutine close_to(self, actual, expected, name, rtol, atol)
      class(checks_t), intent(inout) :: self
      real(wp), intent(in) :: actual
      real(wp), intent(in) :: expected
      character(*), intent(in) :: name
      real(wp), intent(in), optional :: rtol
      !! relative tolerance, zero when absent [-]
      real(wp), intent(in), optional :: atol
      !! absolute tolerance, zero when absent, in the unit of the numbers

      character(120) :: detail
      real(wp) :: allowed

      allowed = 0.0_wp
      if (present(rtol)) allowed = rtol*abs(expected)
      if (present(atol)) allowed = allowed + atol
      write (detail, '(3(a, es24.16e3))') &
         'found', actual, ', expected', expected, ', allowed difference', allowed
      call self%that(abs(actual - expected) <= allowed, name, trim(detail))
   end subroutine close_to

   !> Check that the previous call succeeded.
   subroutine no_error(self, error, name)
      class(checks_t), intent(inout) :: self
      type(error_t), allocatable, intent(in) :: error
      character(*), intent(in) :: name

      if (allocated(error)) then
         call self%that(.false., name, 'error: '//error%message)
      else
         call self%that(.true., name)
      end if
   end subroutine no_error

   !> Check that the previous call failed with this status and with `text` in its message.
   subroutine has_error(self, error, stat, text, name)
      class(checks_t), intent(inout) :: self
      type(error_t), allocatable, intent(in) :: error
      integer, intent(in) :: stat
      !! one of the `err_` numbers
      character(*), intent(in) :: text
      !! expected part of the message
      character(*), intent(in) :: name

      if (.not. allocated(error)) then
         call self%that(.false., name, 'no error was reported')
      else
         call self%that(error%stat == stat .and. index(error%message, text) > 0, name, &
                        'message: '//error%message)
      end if
   end subroutine has_error

   !> Print the counts and end the program, with status 1 after a failure.
   subroutine finish(self)
      class(checks_t), intent(in) :: self

      if (allocated(self%listed)) return
      print '(i0, a, i0, a)', self%passed, ' passed, ', self%failed, ' failed'
      if (self%failed > 0 .or. self%passed == 0) stop 1, quiet=.true.
   end subroutine finish

end module check
