!> Function of a C host as a ground motion.
module rwmf_bindings_c_ground
   use, intrinsic :: iso_c_binding, only: c_associated, c_double, c_f_procpointer, c_funptr, c_ptr
   use rwmf_core_error, only: err_input, error_t, fail
   use rwmf_motion_ground_motion, only: ground_t
   implicit none
   private

   public :: c_ground_t, get_ground

   abstract interface
      !> Acceleration that the host computes [m/s2].
      pure function c_ground_i(t, data) result(a) bind(c)
         import :: c_double, c_ptr
         implicit none
         real(c_double), value :: t
         !! [s]
         type(c_ptr), value :: data
         real(c_double) :: a
      end function c_ground_i
   end interface

   !> Function of the host as a ground motion.
   type, extends(ground_t) :: c_ground_t
      private
      procedure(c_ground_i), pointer, nopass :: compute => null()
      type(c_ptr) :: data
   contains
      procedure :: acceleration_at
   end type c_ground_t

contains

   pure real(c_double) function acceleration_at(self, t)
      class(c_ground_t), intent(in) :: self
      real(c_double), intent(in) :: t

      acceleration_at = self%compute(t, self%data)
   end function acceleration_at

   !> Return the motion of a function of the host.
   subroutine get_ground(compute, data, ground, error)
      type(c_funptr), intent(in) :: compute
      type(c_ptr), intent(in) :: data
      !! argument of the function
      type(c_ground_t), intent(out) :: ground
      type(error_t), allocatable, intent(inout) :: error
      !! `err_input` for NULL

      if (.not. c_associated(compute)) then
         call fail(error, err_input, 'the function for the ground acceleration is NULL')
         return
      end if
      call c_f_procpointer(compute, ground%compute)
      ground%data = data
   end subroutine get_ground

end module rwmf_bindings_c_ground
