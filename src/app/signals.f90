!> Handling of Ctrl-C and of the queue's termination signal in the batch program. The running
!> computation is cancelled, so that no temporary file remains.
!>
!> This module is part of the program, not of the library. A signal handler receives only the number
!> of the signal, so that the flag must be a module variable.
module rwmf_app_signals
   use, intrinsic :: iso_c_binding, only: c_funloc, c_funptr, c_int, c_intptr_t, &
      c_null_funptr
   use rwmf_core_control, only: control_t
   use rwmf_core_kinds, only: i8
   implicit none
   private

   public :: ignore_file_limit, watch_interrupts, is_interrupted

   integer(i8), target :: interrupted = 0_i8
   !! non-zero after a signal

   interface
      function c_signal(number, handler) bind(c, name='signal') result(previous)
         import :: c_funptr, c_int
         implicit none
         integer(c_int), intent(in), value :: number
         type(c_funptr), intent(in), value :: handler
         type(c_funptr) :: previous
      end function c_signal
   end interface

contains

   !> Ignore the signal for a file over the user's size limit (ulimit -f), which would end the
   !> program. The write then fails as on a full disk: the unfinished file is removed and the error
   !> reported.
   subroutine ignore_file_limit()
      integer(c_int), parameter :: sigxfsz = 25_c_int
      integer(c_intptr_t), parameter :: sig_ign = 1_c_intptr_t
      type(c_funptr) :: previous

      previous = c_signal(sigxfsz, transfer(sig_ign, c_null_funptr))
   end subroutine ignore_file_limit

   !> Set the cancel flag of a control on a signal instead of ending the program.
   subroutine watch_interrupts(control)
      type(control_t), intent(inout) :: control
      integer(c_int), parameter :: sigint = 2_c_int, sigterm = 15_c_int
      type(c_funptr) :: previous

      control%cancel => interrupted
      ! if the handler cannot be set (an unusual system), a signal ends the program
      previous = c_signal(sigint, c_funloc(handle_signal))
      previous = c_signal(sigterm, c_funloc(handle_signal))
   end subroutine watch_interrupts

   !> Return whether a signal was received.
   logical function is_interrupted()
      integer(i8) :: flag

      !$omp atomic read
      flag = interrupted
      is_interrupted = flag /= 0_i8
   end function is_interrupted

   !> Set the flag and do nothing else: the signal handler.
   subroutine handle_signal(number) bind(c)
      integer(c_int), intent(in), value :: number

      !$omp atomic write
      interrupted = int(number, i8)
   end subroutine handle_signal

end module rwmf_app_signals
