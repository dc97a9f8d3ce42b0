!> Progress counter and stop flag that a caller shares with a running computation.
module rwmf_core_control
   use rwmf_core_kinds, only: i8
   implicit none
   private

   public :: control_t, is_cancelled, count_done

   !> Pointers to the caller's counter and flag, which another thread may read and set.
   type :: control_t
      integer(i8), pointer :: done => null()
      !! number of finished simulations of a spectrum; null: progress is not reported
      integer(i8), pointer :: cancel => null()
      !! a non-zero value stops the computation as soon as possible; null: it cannot be stopped
   end type control_t

contains

   !> True if the caller has set the stop flag.
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

   !> Add one finished simulation to the counter.
   subroutine count_done(control)
      type(control_t), intent(in) :: control

      if (associated(control%done)) then
         !$omp atomic update
         control%done = control%done + 1_i8
      end if
   end subroutine count_done

end module rwmf_core_control
