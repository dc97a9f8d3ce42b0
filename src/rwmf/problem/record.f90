!> A recorded ground acceleration that has been read and checked.
module rwmf_problem_record
   use rwmf_core_kinds, only: wp
   implicit none
   private

   public :: record_t

   !> A record that has been read and checked.
   type :: record_t
      real(wp), allocatable :: t(:)
      !! (n) strictly increasing times [s]
      real(wp), allocatable :: a(:)
      !! (n) ground acceleration, `scale` applied [m/s2]
      integer :: n
      !! number of samples, at least 2
      real(wp), allocatable :: dt
      !! sampling interval [s]; absent when it is not uniform
      real(wp) :: peak
      !! largest magnitude of the acceleration [m/s2]
      real(wp) :: t_peak
      !! its first time [s]
      character(:), allocatable :: format
      !! 'one column', 'two columns' or 'AT2'
      character(8) :: crc32
      !! of the bytes of the file, hexadecimal
   end type record_t

end module rwmf_problem_record
