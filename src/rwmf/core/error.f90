!> Error value that every procedure that can fail returns as its last argument.
!>
!> | stat            | value | meaning                                                    |
!> |-----------------|-------|------------------------------------------------------------|
!> | `err_numerical` | 1     | the integration failed (too many steps, overflow)          |
!> | `err_input`     | 2     | invalid case, record or call, or a file I/O failure        |
!> | `err_interrupt` | 130   | the caller set the cancel flag                             |
!>
!> The programs return these numbers as their exit status.
module rwmf_core_error
   implicit none
   private

   public :: error_t, fail, add_context
   public :: err_numerical, err_input, err_interrupt

   integer, parameter :: err_numerical = 1
   integer, parameter :: err_input = 2
   integer, parameter :: err_interrupt = 130

   !> Description of a failure. A procedure has failed if its error argument is allocated.
   type :: error_t
      integer :: stat
      !! one of the `err_` numbers
      character(:), allocatable :: name
      !! one word for tables: 'input', 'interrupted', 'too_many_steps', ...
      character(:), allocatable :: message
      !! one line of text for the user
   end type error_t

contains

   !> Report a failure.
   pure subroutine fail(error, stat, message, name)
      type(error_t), allocatable, intent(out) :: error
      !! allocated on return
      integer, intent(in) :: stat
      !! one of the `err_` numbers
      character(*), intent(in) :: message
      !! the problem, the offending value and the allowed values
      character(*), intent(in), optional :: name
      !! one word for tables; the default depends on `stat`

      allocate (error)
      error%stat = stat
      error%message = message
      if (present(name)) then
         error%name = name
      else if (stat == err_input) then
         error%name = 'input'
      else if (stat == err_interrupt) then
         error%name = 'interrupted'
      else
         error%name = 'numerical_failure'
      end if
   end subroutine fail

   !> Put the caller's context (a file, a group) in front of the message of a failure.
   pure subroutine add_context(error, context)
      type(error_t), intent(inout) :: error
      character(*), intent(in) :: context
      !! context, for example the file's name

      error%message = context//': '//error%message
   end subroutine add_context

end module rwmf_core_error
