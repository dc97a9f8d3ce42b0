!> Ground motion that a host program computes.
module rwmf_motion_host_motion
   use rwmf_core_kinds, only: wp
   implicit none
   private

   public :: ground_t

   !> Ground acceleration that a host program computes. Extend this type with the host's data.
   type, abstract :: ground_t
   contains
      procedure(ground_acceleration_i), deferred :: acceleration_at
   end type ground_t

   abstract interface
      !> Ground acceleration at an instant [m/s2]; smooth between the ends of an advance.
      pure real(wp) function ground_acceleration_i(self, t)
         import :: ground_t, wp
         implicit none
         class(ground_t), intent(in) :: self
         real(wp), intent(in) :: t
         !! [s]
      end function ground_acceleration_i
   end interface

end module rwmf_motion_host_motion
