!> What a caller shares with a running computation: a counter of finished work and a stop flag.
module rwmf_core_control
   use rwmf_core_kinds, only: i8
   implicit none
   private

   public :: control_t, is_cancelled, count_done

   !> Both targets belong to the caller and may be read and set from another thread.
   type :: control_t
      integer(i8), pointer :: done => null()
      !! finished simulations of a spectrum; null: nobody asks
      integer(i8), pointer :: cancel => null()
      !! stop as soon as possible where it is not zero; null: cannot be stopped
   end type control_t

contains

   !> Does the caller want the computation to stop?
   logical function is_cancelled(control)
      type(control_t), intent(in) :: control
      integer(i8) :: flag

      is_cancelled = .false.
      if (associated(control%cancel)) then
         !$omp atomic read
         flag = control%cancel
         is_cancelled = flag /= 0_i8
      end if
   end function is_cancelled

   !> One more simulation is finished.
   subroutine count_done(control)
      type(control_t), intent(in) :: control

      if (associated(control%done)) then
         !$omp atomic update
         control%done = control%done + 1_i8
      end if
   end subroutine count_done

end module rwmf_core_control
