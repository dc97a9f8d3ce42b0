!> Version and instruction set for a caller that loads the extension without NumPy.
module rwmf_bindings_python_identity
   use, intrinsic :: iso_c_binding, only: c_char, c_null_char
   use rwmf_core_version, only: version
   use rwmf_integrator_lane_kernels, only: instruction_set
   implicit none
   private

   public :: identity

   integer, parameter :: size = 64

contains

   !> Version, and the instruction set that spectra use on this processor.
   subroutine identity(text) bind(c, name='rwmf_identity')
      character(kind=c_char), intent(out) :: text(size)
      !! '0.7.0 (x86-64-v4)', ended by a null character
      character(size) :: whole
      integer :: i

      whole = version//' ('//trim(instruction_set())//')'//c_null_char
      do i = 1, size
         text(i) = whole(i:i)
      end do
   end subroutine identity

end module rwmf_bindings_python_identity
